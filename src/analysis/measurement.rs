//! The one engine: a request that is carried out step by step.

use std::ops::Range;
use std::sync::Arc;

use super::Plan;
use super::ahead::Ahead;
use super::plan::{check_convention, check_points};
use super::ranges::Ranges;
use super::sizes::Sizes;
use super::status::{Status, TrackStatus};
use super::track::Track;
use crate::accumulate::WavePower;
use crate::compute::{Device, Session};
use crate::control::{Clock, Control, Instant, Progress};
use crate::error::{Error, Result};
use crate::plan::{EnsembleShape, LEAF};
use crate::points::Ensemble;
use crate::request::{PointsRequest, Request};
use crate::setting::Setting;
use crate::source::Points;
use crate::statistics::group::{Effort, PartSums};
use crate::statistics::targets::{Standing, Standings};

/// Seconds that a round of realizations aims at.
const ROUND: f64 = 2.0;

/// A request, and the raw sums of the realizations that were measured so far. It can be carried on step by step, looked at at
/// any time, written and read, and merged with one of other realizations. However it was cut, stopped or merged, the
/// estimates are in the end, to the bit, those of one run.
///
/// ```
/// use pairwave::analysis::Measurement;
/// use pairwave::compute::{Device, cpu::Cpu};
/// use pairwave::control::Control;
/// use pairwave::request::Request;
///
/// # fn main() -> pairwave::Result<()> {
/// let arguments = "--sampler jittered -n 64 -k 40 --stats pcf".split(' ').map(String::from);
/// let request = Request::parse(arguments)?;
/// let (device, control) = (Device::new(Box::new(Cpu::new(None)?), None)?, Control::default());
/// // Two shards, which may run on two machines.
/// let mut whole = Measurement::of(&request)?.within(0..16, &device)?;
/// let mut rest = Measurement::of(&request)?.within(16..40, &device)?;
/// for shard in [&mut whole, &mut rest] {
///     while shard.step(&device, &control)? {}
/// }
/// let bytes = rest.write();
/// whole.merge(Measurement::read("rest.sums", &bytes)?)?;
/// assert_eq!(whole.analysis().map(|found| found.shape.realizations), Some(40));
/// # Ok(())
/// # }
/// ```
pub struct Measurement {
    pub(super) request: Request,
    pub(super) source: Arc<Points>,
    pub(super) plan: Plan,
    /// The realizations that it is to hold.
    pub(super) span: Range<u64>,
    /// Realizations from here on are not measured for now.
    pause: u64,
    /// Whether it is looked at while it goes on: short steps, ready for other settings.
    live: bool,
    /// Wanted or not; one that is not keeps its sums for when it is again.
    pub(super) tracks: Vec<Track>,
    /// Points per realization.
    pub(super) sizes: Sizes,
    pub(super) duplicates: u64,
    /// The first realization, for pictures.
    pub(super) first: Option<Ensemble>,
    /// The realizations that the last step measured.
    batch: Option<Arc<Ensemble>>,
    /// Those of the next round, drawn while this one is measured.
    ahead: Option<Ahead>,
    /// Power of some of them that one group lends another.
    lent: Option<(Range<u64>, WavePower)>,
    /// Sums of realizations that not every group has yet: so that, whatever stops a run, all hold the same ones.
    round: Vec<(usize, Range<u64>, Box<dyn PartSums>)>,
    /// How the numbers stand that are to be known to an error.
    pub(super) standings: Option<Standings>,
    pub(super) clock: Clock,
    pub(super) warnings: Vec<String>,
}

impl Measurement {
    /// Of the points that the request names; for the CPU path until `for_device` says otherwise.
    ///
    /// # Errors
    /// Files that cannot be read, settings that cannot be.
    pub fn of(request: &Request) -> Result<Self> {
        let source = Arc::new(Points::open(&request.input)?);
        let plan = Plan::of(request, &source)?;
        Ok(Self::new(request.clone(), source, plan))
    }

    /// By a plan that was made of the request and these points.
    pub fn new(request: Request, source: Arc<Points>, plan: Plan) -> Self {
        let span = 0..source.shape().realizations;
        let tracks = plan.parts.iter().map(|part| Track::new(part.clone_part())).collect();
        let warnings = source.warnings().iter().cloned().chain(plan.left_out.map(String::from)).collect();
        Self {
            request,
            source,
            plan,
            span,
            pause: u64::MAX,
            live: false,
            tracks,
            sizes: Sizes::default(),
            duplicates: 0,
            first: None,
            batch: None,
            ahead: None,
            lent: None,
            round: Vec::new(),
            standings: None,
            clock: Clock::default(),
            warnings,
        }
    }

    /// One that is looked at while it goes on, and whose settings may change.
    ///
    /// # Errors
    /// As `of`; envelopes, which need all realizations at once, are refused.
    pub fn live(request: &Request, device: &Device) -> Result<Self> {
        let source = Arc::new(Points::open(&request.input)?);
        let plan = live_plan(request, &source, device)?;
        let mut new = Self { live: true, ..Self::new(request.clone(), source, plan) };
        new.tracks.iter_mut().for_each(|track| track.part.keep_ready());
        Ok(new)
    }

    /// The part of it that measures the realizations of a range, on a device: a shard. It is planned as part of the whole.
    ///
    /// # Errors
    /// A range that is not of the batch, or would cut a leaf of 16 realizations in two.
    pub fn within(mut self, span: Range<u64>, device: &Device) -> Result<Self> {
        let total = self.total();
        let cut = |k: u64| k.is_multiple_of(LEAF) || k == self.source.end();
        if span.is_empty() || span.end > total || !cut(span.start) || !cut(span.end) {
            let reason = format!("expected a part of 0..{total} that begins and ends at multiples of {LEAF}");
            return Err(Error::input(format!("realizations {}..{}", span.start, span.end), reason));
        }
        self.plan = self.plan.for_device(device.compute());
        self.tracks = self.plan.parts.iter().map(|part| Track::new(part.clone_part())).collect();
        (self.span, self.round) = (span, Vec::new());
        Ok(self)
    }

    /// The same, to hold the realizations of another range: to go on with one that was read.
    #[must_use]
    pub fn to(self, span: Range<u64>) -> Self {
        Self { span, ..self }
    }

    /// Takes other settings. Sums that they leave alone are kept; more realizations are added to those that are there. After
    /// an error nothing has changed.
    ///
    /// # Errors
    /// As `live`.
    pub fn change(&mut self, request: &Request, device: &Device) -> Result<()> {
        let of_one = |points: &PointsRequest| PointsRequest { realizations: None, ..points.clone() };
        let same_points = of_one(&request.input) == of_one(&self.request.input);
        let computes_alike = (request.device, request.threads) == (self.request.device, self.request.threads);
        // An estimate of the intensity is read off other realizations too.
        let same_weights = request.input == self.request.input || request.input.inhomogeneous.is_none();
        if !same_points || !same_weights || !computes_alike {
            *self = Self::live(request, device)?;
            return Ok(());
        }
        let source = match request.input == self.request.input {
            true => self.source.clone(),
            false => Arc::new(Points::open(&request.input)?),
        };
        let plan = live_plan(request, &source, device)?;
        (self.request, self.source, self.plan) = (request.clone(), source, plan);
        self.span = 0..self.total();
        if self.tracks.iter().any(|t| t.done.end() > self.span.end) || self.sizes.len() > self.span.end {
            // Fewer realizations: sums cannot be taken apart again.
            (self.tracks, self.sizes, self.duplicates) = (Vec::new(), Sizes::default(), 0);
        }
        (self.batch, self.ahead, self.lent, self.round) = (None, None, None, Vec::new());
        self.keep_tracks();
        Ok(())
    }

    /// Makes the tracks those of the plan.
    fn keep_tracks(&mut self) {
        let mut old = std::mem::take(&mut self.tracks);
        for part in self.plan.parts.iter() {
            let at = old.iter().position(|track| track.part.name() == part.name());
            let mut wanted = part.clone_part();
            wanted.keep_ready();
            let kept = at.map(|at| old.remove(at)).and_then(|track| track.kept(wanted.as_ref(), &self.sizes));
            self.tracks.push(kept.unwrap_or_else(|| Track::new(wanted)));
        }
        self.tracks.extend(old.into_iter().map(|track| Track { wanted: false, ..track }));
    }

    /// Measures some realizations of the sums that are furthest behind. Whether there is more to do. Waits until it is done.
    ///
    /// # Errors
    /// What the points or the device say; after `Error::Cancelled` it can go on.
    pub fn step(&mut self, device: &Device, control: &Control) -> Result<bool> {
        crate::control::wait(self.advance(device, control, &mut |_| ()))
    }

    /// As `step`, for who cannot wait. `tell` hears what is being done.
    ///
    /// # Errors
    /// As `step`.
    pub async fn advance(
        &mut self,
        device: &Device,
        control: &Control,
        tell: &mut dyn FnMut(Progress),
    ) -> Result<bool> {
        control.check()?;
        self.resolve(device)?;
        let Some((at, range)) = self.next() else {
            self.check(device, control)?;
            return Ok(false);
        };
        let total = self.span.end - self.span.start;
        let planned = self.planned();
        let (before, piece) = self.shares(at, &range);
        let mut told = |stage, piece| {
            control.begin();
            tell(Progress { stage, done: range.start - self.span.start, total, before, piece, planned, known: None });
        };
        let known = self
            .batch
            .as_ref()
            .filter(|b| b.first_index() == range.start && b.realizations() as u64 == range.end - range.start);
        let batch = match known {
            Some(batch) => batch.clone(),
            None => {
                told("points", 0.0);
                let start = Instant::now();
                let ahead = self.ahead.take().filter(|ahead| ahead.range == range);
                let drawn = match ahead.map(|ahead| ahead.points(control)).transpose()?.flatten() {
                    Some(drawn) => drawn,
                    None => device.pool().install(|| self.source.batch(range.clone(), control))?,
                };
                self.clock.add("points", start.elapsed().as_secs_f64());
                let next = self.after(&range);
                self.ahead = next.and_then(|next| Ahead::begin(&self.source, next, device.pool(), control));
                Arc::new(drawn)
            }
        };
        let track = &mut self.tracks[at];
        told(track.part.stage(), piece);
        let lent = self.lent.take().filter(|(of, _)| *of == range).map(|(_, power)| power);
        let mut session = Session::new(device, control, lent);
        let start = Instant::now();
        let sums = track.part.measure(&batch, &mut session).await?;
        let seconds = start.elapsed().as_secs_f64();
        track.each = seconds / batch.realizations() as f64;
        self.clock.add(track.part.stage(), seconds);
        let (warnings, lent) = session.into_parts();
        self.lent = lent.map(|power| (range.clone(), power));
        for warning in warnings {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
        self.batch = Some(batch);
        self.round.push((at, range.clone(), sums));
        // Where it is looked at while it goes on, each group is as far as it is.
        if self.live || self.partner(&range).is_none() {
            self.end_round(device)?;
        }
        Ok(true)
    }

    /// What to measure next, and of which realizations.
    fn next(&mut self) -> Option<(usize, Range<u64>)> {
        if let Some((_, range, _)) = self.round.first() {
            let range = range.clone();
            return self.partner(&range).map(|at| (at, range));
        }
        let at = self.furthest_behind()?;
        let (live, most) = (self.live, self.chunk());
        let within = self.within_reach();
        let mut range = self.tracks[at].next(&within, live, most)?;
        if !live {
            // One that is behind comes up to the others.
            let others = self.tracks.iter().filter(|track| track.wanted && track.part.waits_for().is_none());
            let fronts = others.filter_map(|track| track.done.gap(&within)).map(|gap| gap.start);
            let front = fronts.filter(|&front| front > range.start).fold(u64::MAX, u64::min);
            // What is drawn already is what is measured next.
            let gap = self.tracks[at].done.gap(&within).map_or(range.end, |gap| gap.end);
            let ahead = self.ahead.as_ref().map(|ahead| &ahead.range).filter(|ahead| ahead.start == range.start);
            range.end = ahead.map(|ahead| ahead.end).filter(|&end| end <= gap).unwrap_or(range.end).min(front);
        }
        Some((at, range))
    }

    /// The round after that of a range, where there is room for the points of both.
    fn after(&self, range: &Range<u64>) -> Option<Range<u64>> {
        /// Bytes of points that may wait.
        const ROOM: u64 = 256 << 20;
        let (start, end) = (range.end, self.within_reach().end);
        let size = match end.saturating_sub(start) {
            left if left < LEAF => left,
            left => self.chunk().min(left) / LEAF * LEAF,
        };
        let room = size.saturating_mul(self.source.shape().max_points).saturating_mul(48) <= ROOM;
        (!self.live && room && size > 0 && start.is_multiple_of(LEAF)).then(|| start..start + size)
    }

    /// What it is to hold for now.
    fn within_reach(&self) -> Range<u64> {
        self.span.start..self.span.end.min(self.pause)
    }

    /// Measures none from realization `k` on until this is called again.
    pub(super) fn pause_at(&mut self, k: u64) {
        self.pause = k;
    }

    /// Bytes that its sums, estimates and output take, about.
    pub(super) fn memory(&self) -> u128 {
        self.tracks.iter().map(|track| track.part.memory()).sum()
    }

    /// Whether it is to hold a part of the realizations only.
    pub(super) fn is_part(&self) -> bool {
        self.span != (0..self.total())
    }

    /// How the numbers stand that a run was to end by; none where there are none, or before the first look.
    pub fn standings(&self) -> &[Standing] {
        self.standings.as_ref().map_or(&[], |standings| &standings.0)
    }

    /// Keeps how they stand.
    pub(super) fn stand(&mut self, standings: Standings) {
        self.standings = Some(standings);
    }

    /// A track that lacks the realizations of this round.
    fn partner(&self, range: &Range<u64>) -> Option<usize> {
        let lacks = |track: &Track| {
            let gap = track.done.gap(&self.span).filter(|gap| gap.start == range.start && gap.end >= range.end);
            let cuts = track.part.whole_leaves() && !range.start.is_multiple_of(LEAF);
            track.wanted && track.part.waits_for().is_none() && gap.is_some() && !cuts
        };
        let held = |at: usize| self.round.iter().any(|(of, ..)| *of == at);
        (0..self.tracks.len()).find(|&at| !held(at) && lacks(&self.tracks[at]))
    }

    /// Adds the sums of a round, which every group has now.
    fn end_round(&mut self, device: &Device) -> Result<()> {
        for (at, range, sums) in std::mem::take(&mut self.round) {
            self.tracks[at].add(range, sums)?;
        }
        if let Some(batch) = self.batch.clone() {
            device.pool().install(|| self.see(&batch));
        }
        Ok(())
    }

    /// Leaves a round that something ended: what not every group has is measured again, and no more is drawn.
    pub(super) fn give_up_round(&mut self) {
        (self.ahead, self.round) = (None, Vec::new());
    }

    /// Realizations of a round: at first a leaf, then as many as are soon done, so that little is lost where it is stopped.
    fn chunk(&self) -> u64 {
        let each: f64 = self.tracks.iter().filter(|t| t.wanted && t.part.waits_for().is_none()).map(|t| t.each).sum();
        let most = self.plan.batch;
        if self.live {
            most
        } else if each.is_finite() {
            ((ROUND / each.max(1e-9)) as u64 / LEAF * LEAF).clamp(LEAF, most.max(LEAF))
        } else {
            LEAF
        }
    }

    /// Whether every group holds the same realizations: not within a round.
    pub fn is_even(&self) -> bool {
        let mut all = self.tracks.iter().filter(|t| t.wanted && t.part.waits_for().is_none()).map(|t| &t.done);
        let first = all.next();
        self.round.is_empty() && all.all(|done| Some(done) == first)
    }

    /// Whether all that it is to hold is there.
    pub(super) fn is_done(&self) -> bool {
        self.tracks.iter().all(|t| !t.wanted || t.done.gap(&self.span).is_none())
    }

    /// What cannot be had of a part of the realizations.
    pub fn needs_all(&self) -> Option<&'static str> {
        let waits = self.tracks.iter().any(|t| t.wanted && t.part.waits_for().is_some());
        if self.plan.simulations > 0 { Some("`envelope`") } else { waits.then_some("a bandwidth by cross-validation") }
    }

    /// How many realizations it holds.
    pub fn realizations(&self) -> u64 {
        self.sizes.len()
    }

    /// From the first realization that it holds to the last.
    pub fn reach(&self) -> Range<u64> {
        let starts = self.sizes.runs().map(|(run, _)| run.start);
        starts.min().unwrap_or(0)..self.sizes.runs().map(|(run, _)| run.end).max().unwrap_or(0)
    }

    /// The realizations that it lacks, `17-32, 65-80` counted from 1; `None` if it has all.
    pub fn missing(&self) -> Option<String> {
        let mut held = Ranges::default();
        self.sizes.runs().for_each(|(run, _)| held.add(run));
        let (mut gaps, mut from) = (Vec::new(), 0);
        while let Some(gap) = held.gap(&(from..self.total())) {
            gaps.push(if gap.end == gap.start + 1 {
                gap.end.to_string()
            } else {
                format!("{}-{}", gap.start + 1, gap.end)
            });
            from = gap.end;
        }
        (!gaps.is_empty()).then(|| gaps.join(", "))
    }

    /// Adds something that the user should know.
    pub fn note(&mut self, warning: String) {
        self.warnings.push(warning);
    }

    /// Seconds of one thread that the plan takes for all of it; above 0.
    pub(super) fn planned(&self) -> f64 {
        let parts = self.tracks.iter().map(|track| self.plan.seconds(track.part.as_ref()));
        (parts.sum::<f64>() + self.plan.simulated_seconds()).max(f64::MIN_POSITIVE)
    }

    /// The part of the run that is done, and the part that track `at` is for a range of realizations.
    fn shares(&self, at: usize, range: &Range<u64>) -> (f64, f64) {
        let total = (self.span.end - self.span.start) as f64;
        let part =
            |track: &Track, done: u64| self.plan.seconds(track.part.as_ref()) / self.planned() * done as f64 / total;
        let now = self.round.iter().map(|(of, range, _)| part(&self.tracks[*of], range.end - range.start));
        let before = self.tracks.iter().map(|track| part(track, track.done.count())).sum::<f64>() + now.sum::<f64>();
        (before, part(&self.tracks[at], range.end - range.start))
    }

    /// Notes the realizations of a batch, each once.
    fn see(&mut self, batch: &Ensemble) {
        let start = batch.first_index();
        let of = |k: usize| start + k as u64..start + k as u64 + 1;
        let new: Vec<usize> = (0..batch.realizations()).filter(|&k| self.sizes.count(&of(k)) == 0).collect();
        if let (Some(&first), Some(&last)) = (new.first(), new.last()) {
            self.duplicates += match last + 1 - first == batch.realizations() {
                true => batch.duplicates(),
                false => batch.slice(first..last + 1).duplicates(),
            };
        }
        for k in new {
            self.sizes.add(of(k), batch.points_in(k) as u64);
        }
        if self.first.as_ref().is_none_or(|first| start < first.first_index()) {
            self.first = Some(batch.slice(0..1));
        }
    }

    /// Gives groups that waited for the sums of another over all realizations what they waited for.
    fn resolve(&mut self, device: &Device) -> Result<()> {
        for at in 0..self.tracks.len() {
            let Some(name) = self.tracks[at].part.waits_for() else { continue };
            let Some(before) = self.tracks.iter().find(|t| t.part.name() == name && t.done.count() == self.total())
            else {
                continue;
            };
            let Some(sums) = before.sums()? else { continue };
            let start = Instant::now();
            let (waiting, request) = (&self.tracks[at].part, &self.request);
            let part = device.pool().install(|| waiting.after(sums.as_ref(), before.part.as_ref(), request))?;
            self.clock.add("cross-validation", start.elapsed().as_secs_f64());
            // Estimates are made by the plan, which has what was found too.
            let name = part.name();
            self.plan.parts.iter_mut().filter(|p| p.name() == name).for_each(|p| *p = part.clone_part());
            self.tracks[at].part = part;
        }
        Ok(())
    }

    /// The track that was measured least, of those for which there is something to measure.
    fn furthest_behind(&self) -> Option<usize> {
        let within = self.within_reach();
        let behind = |t: &Track| t.wanted && t.part.waits_for().is_none() && t.done.gap(&within).is_some();
        let all = self.tracks.iter().enumerate().filter(|(_, t)| behind(t));
        all.min_by_key(|(_, t)| t.done.count()).map(|(at, _)| at)
    }

    /// What is known only once every realization was seen.
    fn check(&mut self, device: &Device, control: &Control) -> Result<()> {
        if self.sizes.is_empty() {
            // No statistic is wanted: the points alone.
            let (source, first) = (&self.source, self.span.start);
            let batch = device.pool().install(|| source.batch(first..first + 1, control))?;
            self.see(&batch);
        }
        check_points(self.plan.parts.needs_pairs(), self.shape())?;
        check_convention(&self.request, self.source.domain(), self.shape())
    }

    /// One realization, drawn or read again for itself; nothing is measured.
    ///
    /// # Errors
    /// What the points say, `Error::Cancelled`.
    pub fn realization(&self, index: u64, device: &Device, control: &Control) -> Result<Ensemble> {
        let index = index.min(self.total().saturating_sub(1));
        device.pool().install(|| self.source.batch(index..index + 1, control))
    }

    /// Realizations of the whole batch.
    pub fn total(&self) -> u64 {
        self.source.shape().realizations
    }

    /// The same without any realization.
    #[must_use]
    pub fn emptied(&self) -> Self {
        Self::new(self.request.clone(), self.source.clone(), self.plan.clone())
    }

    /// What it measures.
    pub fn points(&self) -> &Points {
        &self.source
    }

    /// The plan that it is measured by.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The request.
    pub fn request(&self) -> &Request {
        &self.request
    }

    /// Whether every realization is in all sums that are wanted.
    pub fn is_whole(&self) -> bool {
        self.tracks.iter().filter(|t| t.wanted).all(|t| t.done.count() == self.total())
    }

    /// Number and size of the realizations that were measured.
    pub(super) fn shape(&self) -> EnsembleShape {
        self.sizes.shape()
    }

    /// How far it is.
    pub fn status(&self) -> Status {
        let wanted = || self.tracks.iter().filter(|t| t.wanted);
        let tracks = wanted().map(|t| TrackStatus {
            name: t.part.name(),
            done: t.done.count(),
            kept: t.kept.min(t.done.count()),
            rebinned: t.rebinned,
        });
        let effort = |t: &Track| {
            let done = t.done.iter().flat_map(|range| self.sizes.within(range));
            done.fold(Effort::default(), |all, (run, n)| {
                let (one, count) = (t.part.effort(n), (run.end - run.start) as f64);
                Effort { pairs: all.pairs + count * one.pairs, products: all.products + count * one.products }
            })
        };
        let efforts: Vec<Effort> = wanted().map(effort).collect();
        Status {
            tracks: tracks.collect(),
            total: self.span.end - self.span.start,
            pairs: efforts.iter().map(|e| e.pairs).sum(),
            products: efforts.iter().map(|e| e.products).sum(),
            timings: self.clock.stages.clone(),
        }
    }
}

fn live_plan(request: &Request, source: &Points, device: &Device) -> Result<Plan> {
    let plan = Plan::of(request, source)?.for_device(device.compute());
    if plan.simulations > 0 {
        let reason = "needs all realizations at once: not while they come in";
        return Err(Error::setting(Setting::Envelope, plan.simulations, reason));
    }
    Ok(plan)
}
