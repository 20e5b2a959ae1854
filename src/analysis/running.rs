//! A measurement that can be looked at while it goes on, and whose settings may change: what a change leaves alone is kept.

use std::collections::HashSet;
use std::sync::Arc;

use super::measure::Measured;
use super::sums::Sums;
use super::{Analysis, Estimates, Found, Plan, analysis, check_convention, check_points};
use crate::accumulate::{PairCounts, PairHistogram};
use crate::compute::{Compute, WithFallback};
use crate::control::Control;
use crate::control::{Clock, Instant};
use crate::error::{Error, Result};
use crate::plan::LEAF;
use crate::plan::{Batch, EnsembleShape, PairPlan, WavePlan};
use crate::points::Ensemble;
use crate::request::{PointsRequest, Request};
use crate::setting::Setting;
use crate::source::Source;

/// Seconds that a step aims at, so that whoever takes steps can look up between them.
const STEP: f64 = 0.05;

/// Most values kept for binning anew: histograms of all realizations.
const MOST_HISTOGRAMS: usize = 1 << 22;

/// A request that is carried out step by step. Its estimates can be had at any time; once it is done they are, to the bit,
/// those of `analysis::run`.
///
/// Envelopes and bandwidths by cross-validation need all realizations at once: requests for them are refused.
pub struct Running {
    request: Request,
    source: Arc<Source>,
    plan: Plan,
    /// Wanted or not; one that is not keeps its sums for when it is again.
    tracks: Vec<Track>,
    sizes: Vec<u64>,
    duplicates: u64,
    first: Option<Ensemble>,
    batch: Option<Ensemble>,
    clock: Clock,
    warnings: Vec<String>,
}

/// How far a `Running` is, and what it was spared.
#[derive(Debug, Clone, PartialEq)]
pub struct Status {
    /// What each group of sums is at.
    pub tracks: Vec<TrackStatus>,
    /// Realizations asked for.
    pub total: u64,
    /// Unordered pairs in the realizations done, looked at or not.
    pub pairs: f64,
    /// Points times stored wave vectors in the realizations done.
    pub products: f64,
    /// Seconds per stage.
    pub timings: Vec<(&'static str, f64)>,
}

/// Of one group of sums.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TrackStatus {
    /// Its name.
    pub name: &'static str,
    /// Realizations it holds.
    pub done: u64,
    /// How many of them were there before the last change of settings, which did not touch them.
    pub kept: u64,
    /// Whether they were binned anew rather than counted.
    pub rebinned: bool,
}

/// Sums that are measured together, because the same settings touch them.
#[derive(Debug)]
struct Track {
    kind: Kind,
    /// What the sums are of.
    plan: Plan,
    wanted: bool,
    /// Of whole leaves of realizations.
    whole: Sums,
    /// Of those after, fewer than a leaf.
    leaf: Sums,
    done: u64,
    kept: u64,
    rebinned: bool,
    /// Of pairs, as long as they are few.
    finest: Option<Finest>,
    /// What a realization took, in seconds.
    each: f64,
}

/// Pairs of every realization in the finest bins that were asked for: they can be binned anew.
#[derive(Debug)]
struct Finest {
    plan: PairPlan,
    histograms: Vec<PairHistogram>,
}

impl Finest {
    /// Where the edges of other bins are among those of these; `None` if one is not there.
    fn edges(&self, plan: &PairPlan) -> Option<Vec<usize>> {
        plan.thresholds.iter().map(|edge| self.plan.thresholds.binary_search(edge).ok()).collect()
    }
}

/// The same pairs in bins that each are some of those here.
fn coarse(fine: &PairHistogram, edges: &[usize]) -> PairHistogram {
    let counts = edges.windows(2).map(|w| fine.counts[w[0]..w[1]].iter().sum()).collect();
    PairHistogram::new(fine.n, counts, None)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Pairs,
    Lags,
    Waves,
    Covariance,
    Neighbors,
}

impl Kind {
    const ALL: [Self; 5] = [Self::Pairs, Self::Lags, Self::Waves, Self::Covariance, Self::Neighbors];

    fn name(self) -> &'static str {
        match self {
            Self::Pairs => "g(r)",
            Self::Lags => "g of the vector",
            Self::Waves => "P",
            Self::Covariance => "covariance",
            Self::Neighbors => "neighbours",
        }
    }

    /// The part of a plan that these sums are of, without what sums do not depend on; `None` if it has none.
    fn part(self, plan: &Plan) -> Option<Plan> {
        let none = Plan {
            psa: None,
            pairs: None,
            classes: None,
            kernel: None,
            search: None,
            lags: None,
            rings: None,
            waves: None,
            covariance: None,
            neighbors: None,
            simulations: 0,
            ..plan.clone()
        };
        let plan = plan.clone();
        Some(match self {
            Self::Pairs => {
                plan.pairs.as_ref()?;
                let Plan { pairs, classes, kernel, psa, .. } = plan;
                Plan { pairs, classes, kernel, psa, ..none }
            }
            Self::Lags => Plan { lags: Some(plan.lags?), rings: plan.rings, ..none },
            Self::Waves => Plan { waves: Some(plan.waves?), ..none },
            Self::Covariance => Plan { covariance: Some(plan.covariance?), ..none },
            Self::Neighbors => Plan { neighbors: Some(plan.neighbors?), ..none },
        })
    }
}

/// Whether sums of one plan are sums of the other: the number of realizations is no part of them.
fn same_sums(a: &Plan, b: &Plan) -> bool {
    let alike = |plan: &Plan| {
        let mut plan = plan.clone();
        let pairs = [plan.pairs.as_mut(), plan.psa.as_mut(), plan.classes.as_mut().map(|c| &mut c.pairs)];
        let pairs = pairs.into_iter().chain([plan.kernel.as_mut().map(|k| &mut k.pairs)]).flatten();
        pairs.for_each(|p| (p.shape.realizations, p.batch) = (0, Batch::NONE));
        let lags = [&mut plan.lags, &mut plan.rings].into_iter().flatten();
        lags.for_each(|l| (l.shape.realizations, l.batch) = (0, Batch::NONE));
        plan.waves.iter_mut().for_each(|w| (w.shape.realizations, w.batch) = (0, Batch::NONE));
        plan.covariance.iter_mut().for_each(|c| (c.shape.realizations, c.batch) = (0, Batch::NONE));
        plan.neighbors.iter_mut().for_each(|n| n.batch = Batch::NONE);
        // What is read off the sums, not what is summed.
        Plan { pcf: true, psa_bins: false, bug_compatible: false, grid_wanted: false, batch: 0, ..plan }
    };
    alike(a) == alike(b)
}

impl Running {
    /// Opens the points and plans, for a device.
    pub fn new(request: Request, compute: &dyn Compute) -> Result<Self> {
        let source = Arc::new(Source::open(&request.input)?);
        let plan = plan(&request, &source, compute)?;
        let mut new = Self {
            request,
            source,
            plan,
            tracks: Vec::new(),
            sizes: Vec::new(),
            duplicates: 0,
            first: None,
            batch: None,
            clock: Clock::default(),
            warnings: Vec::new(),
        };
        new.keep_tracks();
        Ok(new)
    }

    /// Takes other settings. Sums that they leave alone are kept; more realizations are added to those that are there. After
    /// an error nothing has changed.
    pub fn change(&mut self, request: Request, compute: &dyn Compute) -> Result<()> {
        let of_one = |points: &PointsRequest| PointsRequest { realizations: None, ..points.clone() };
        let same_points = of_one(&request.input) == of_one(&self.request.input);
        let computes_alike = (request.device, request.threads) == (self.request.device, self.request.threads);
        if !same_points || !computes_alike {
            *self = Self::new(request, compute)?;
            return Ok(());
        }
        let source = match request.input == self.request.input {
            true => self.source.clone(),
            false => Arc::new(Source::open(&request.input)?),
        };
        let plan = plan(&request, &source, compute)?;
        (self.request, self.source, self.plan) = (request, source, plan);
        let total = self.total();
        if self.tracks.iter().any(|t| t.done > total) || self.sizes.len() as u64 > total {
            // Fewer realizations: sums cannot be taken apart again.
            (self.tracks, self.sizes, self.duplicates) = (Vec::new(), Vec::new(), 0);
        }
        self.batch = None;
        self.keep_tracks();
        Ok(())
    }

    /// Makes the tracks those of the plan.
    fn keep_tracks(&mut self) {
        for kind in Kind::ALL {
            let old = self.tracks.iter().position(|t| t.kind == kind);
            let Some(part) = kind.part(&self.plan) else {
                old.into_iter().for_each(|at| self.tracks[at].wanted = false);
                continue;
            };
            let track = old.map(|at| self.tracks.remove(at)).and_then(|track| track.kept(&part, &self.sizes));
            self.tracks.push(track.unwrap_or_else(|| Track::new(kind, part)));
        }
        self.tracks.sort_by_key(|t| Kind::ALL.iter().position(|&k| k == t.kind));
    }

    /// Measures some realizations of the sums that are furthest behind: about a twentieth of a second, or one realization.
    /// Whether there is more to do.
    pub fn step(&mut self, compute: &dyn Compute, control: &Control) -> Result<bool> {
        let total = self.total();
        let behind = |t: &&mut Track| t.wanted && t.done < total;
        let Some(track) = self.tracks.iter_mut().filter(behind).min_by_key(|t| t.done) else {
            self.check()?;
            return Ok(false);
        };
        let mut device = WithFallback::new(compute, self.request.threads)?;
        let size = track.next_step(total);
        let start = track.done;
        let known = self.batch.as_ref().filter(|b| b.first_index() == start && b.realizations() as u64 == size);
        let batch = match known {
            Some(batch) => batch.clone(),
            None => {
                let (source, range) = (&self.source, start..start + size);
                self.clock.time("points", || device.pool().install(|| source.batch(range, control)))?
            }
        };
        track.measure(&batch, &mut device, control, &mut self.clock)?;
        if start == self.sizes.len() as u64 {
            self.sizes.extend((0..batch.realizations()).map(|k| batch.points_in(k) as u64));
            self.duplicates += device.pool().install(|| batch.duplicates());
        }
        self.first.get_or_insert_with(|| batch.slice(0..1));
        self.batch = Some(batch);
        for warning in device.into_warnings() {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
        Ok(true)
    }

    /// What is known only once every realization was seen.
    fn check(&mut self) -> Result<()> {
        if self.sizes.is_empty() {
            // No statistic is wanted: the points alone.
            let batch = self.source.batch(0..1, &Control::default())?;
            self.sizes.push(batch.points_in(0) as u64);
            self.first = Some(batch);
        }
        let (plan, shape) = (&self.plan, EnsembleShape::of(&self.sizes));
        check_points(plan.pairs.is_some() || plan.lags.is_some() || plan.neighbors.is_some(), shape)?;
        check_convention(&self.request, self.source.domain(), shape)
    }

    /// Realizations asked for.
    pub fn total(&self) -> u64 {
        self.source.shape().realizations
    }

    /// The request.
    pub fn request(&self) -> &Request {
        &self.request
    }

    /// How far it is.
    pub fn status(&self) -> Status {
        let wanted = || self.tracks.iter().filter(|t| t.wanted);
        let tracks = wanted().map(|t| TrackStatus {
            name: t.kind.name(),
            done: t.done,
            kept: t.kept.min(t.done),
            rebinned: t.rebinned,
        });
        let sum = |kind: Kind, each: &dyn Fn(u64) -> f64| -> f64 {
            let done = wanted().filter(|t| t.kind == kind).map(|t| t.done).sum::<u64>();
            self.sizes.iter().take(done as usize).map(|&n| each(n)).sum()
        };
        let pairs = |n: u64| n as f64 * (n as f64 - 1.0) / 2.0;
        let modes = self.plan.waves.as_ref().map_or(0, |w| w.waves.len()) as f64;
        Status {
            tracks: tracks.collect(),
            total: self.total(),
            pairs: sum(Kind::Pairs, &pairs) + sum(Kind::Lags, &pairs),
            products: sum(Kind::Waves, &|n| n as f64 * modes),
            timings: self.clock.stages.clone(),
        }
    }

    /// The estimates of what was measured so far; `None` before the first step.
    pub fn analysis(&self) -> Option<Analysis> {
        let measured = self.measured()?;
        let mut clock = self.clock.clone();
        let estimates = clock.time("estimates", || Estimates::new(&measured, self.request.normalization));
        let found = Found { estimates, envelopes: None, warnings: self.warnings.clone(), clock };
        Some(analysis(&self.request, &self.source, measured, found))
    }

    fn measured(&self) -> Option<Measured<'_>> {
        let mut sums = Sums::default();
        for track in self.tracks.iter().filter(|t| t.wanted) {
            // Both merges are of whole leaves, and tracks have no sums in common.
            for part in [&track.whole, &track.leaf] {
                sums.merge(part.clone()).ok()?;
            }
        }
        Some(Measured {
            sums,
            plan: std::borrow::Cow::Borrowed(&self.plan),
            cross_validation: None,
            sizes: self.sizes.clone(),
            duplicates: self.duplicates,
            first: self.first.clone()?,
        })
    }
}

fn plan(request: &Request, source: &Source, compute: &dyn Compute) -> Result<Plan> {
    let plan = Plan::of(request, source)?.for_device(compute);
    if plan.search.is_some() {
        return Err(Error::setting(
            Setting::Bandwidth,
            "lscv",
            "needs all realizations at once: not while they come in",
        ));
    }
    if plan.simulations > 0 {
        return Err(Error::setting(
            Setting::Envelope,
            plan.simulations,
            "needs all realizations at once: not while they come in",
        ));
    }
    Ok(plan)
}

impl Track {
    fn new(kind: Kind, plan: Plan) -> Self {
        let plain = |p: &&PairPlan| !(p.weighted() || p.border() || p.cumulative);
        let alone = plan.classes.is_none() && plan.kernel.is_none() && plan.psa.is_none();
        let finest = plan.pairs.as_ref().filter(plain).filter(|_| alone);
        let finest = finest.map(|pairs| Finest { plan: pairs.clone(), histograms: Vec::new() });
        Self {
            kind,
            plan,
            wanted: true,
            whole: Sums::default(),
            leaf: Sums::default(),
            done: 0,
            kept: 0,
            rebinned: false,
            finest,
            each: f64::INFINITY,
        }
    }

    /// The same sums as those of another plan, if they are: as they are, or from finer bins. `sizes` are the numbers of
    /// points of the realizations.
    fn kept(self, plan: &Plan, sizes: &[u64]) -> Option<Self> {
        let kept = Self { wanted: true, kept: self.done, ..self };
        if same_sums(&kept.plan, plan) {
            return Some(Self { plan: plan.clone(), rebinned: false, ..kept });
        }
        if let (Some(had), Some(wanted)) = (&kept.plan.waves, &plan.waves) {
            // More than is wanted, by the same methods.
            let trimmed =
                Plan { waves: Some(WavePlan { rings_only: wanted.rings_only, ..had.clone() }), ..kept.plan.clone() };
            let by = |n: u64| had.method(n as usize) == wanted.method(n as usize);
            let distinct: HashSet<u64> = sizes.iter().copied().collect();
            if wanted.rings_only && same_sums(&trimmed, plan) && distinct.into_iter().all(by) {
                return Some(kept);
            }
        }
        kept.binned_anew(plan)
    }

    /// The sums in bins that are each some of the finest ones.
    fn binned_anew(self, plan: &Plan) -> Option<Self> {
        let wanted = plan.pairs.as_ref()?;
        let finest = self.finest.as_ref()?;
        let edges = finest.edges(wanted)?;
        let by = self.pair_counts()?.computed_by.clone();
        let new = Self::new(self.kind, plan.clone());
        new.finest.as_ref()?;
        let mut sums = PairCounts::new(by, wanted);
        finest.histograms.iter().for_each(|h| sums.add(&coarse(h, &edges)));
        // Integers may stand with the whole leaves though the last of them is not full.
        let whole = Sums { pairs: Some(sums), ..Sums::default() };
        Some(Self {
            whole,
            finest: self.finest,
            done: self.done,
            kept: self.done,
            rebinned: true,
            each: self.each,
            ..new
        })
    }

    fn pair_counts(&self) -> Option<&PairCounts> {
        self.whole.pairs.as_ref().or(self.leaf.pairs.as_ref())
    }

    /// How many realizations of `total` to measure next: whole leaves if they are quick, else one.
    fn next_step(&mut self, total: u64) -> u64 {
        if self.kind == Kind::Covariance {
            // Realizations cannot be added to a leaf that is one product: it is made anew.
            self.done = self.done / LEAF * LEAF;
            self.leaf = Sums::default();
            return (total - self.done).min(LEAF);
        }
        let left = total - self.done;
        if !self.done.is_multiple_of(LEAF) {
            return 1;
        }
        let quick = (STEP / self.each) as u64;
        match quick.min(left) {
            0 | 1 => 1,
            few if few < LEAF => few,
            many => (many / LEAF * LEAF).min(self.plan.batch.max(LEAF) / LEAF * LEAF),
        }
    }

    fn measure(
        &mut self,
        batch: &Ensemble,
        device: &mut WithFallback<'_>,
        control: &Control,
        clock: &mut Clock,
    ) -> Result<()> {
        let start = Instant::now();
        let realizations = batch.realizations();
        let next = match self.measure_finest(batch, device, control, clock)? {
            Some(next) => next,
            None => Sums::measure(&self.plan, batch, device, control, clock, &mut |_| ())?,
        };
        let into_leaf = self.done.is_multiple_of(LEAF);
        self.done += realizations as u64;
        match (into_leaf, self.done.is_multiple_of(LEAF)) {
            (true, true) => self.whole.merge(next)?,
            (true, false) => self.leaf = next,
            (false, full) => {
                self.leaf.append(next)?;
                if full {
                    self.whole.merge(std::mem::take(&mut self.leaf))?;
                }
            }
        }
        self.each = start.elapsed().as_secs_f64() / realizations as f64;
        Ok(())
    }

    /// Counts in the finest bins; `None` where there are none, or not any more.
    fn measure_finest(
        &mut self,
        batch: &Ensemble,
        device: &mut WithFallback<'_>,
        control: &Control,
        clock: &mut Clock,
    ) -> Result<Option<Sums>> {
        let fits = |f: &Finest| (f.histograms.len() + batch.realizations()) * f.plan.bins.len() <= MOST_HISTOGRAMS;
        self.finest = self.finest.take().filter(fits);
        let (Some(finest), Some(plan)) = (&mut self.finest, &self.plan.pairs) else { return Ok(None) };
        let Some(edges) = finest.edges(plan) else { return Ok(None) };
        let singles: Vec<Ensemble> = (0..batch.realizations()).map(|k| batch.slice(k..k + 1)).collect();
        let counts = clock.time("pair_counts", || device.all_pair_counts(&finest.plan, &singles, control))?;
        let Some(by) = counts.first().map(|c| c.computed_by.clone()) else { return Ok(None) };
        let mut sums = PairCounts::new(by, plan);
        for (counts, single) in counts.into_iter().zip(&singles) {
            let histogram = PairHistogram::new(single.points_in(0) as u64, counts.counts, None);
            sums.add(&coarse(&histogram, &edges));
            finest.histograms.push(histogram);
        }
        Ok(Some(Sums { pairs: Some(sums), ..Sums::default() }))
    }
}
