//! Pairs by distance: what g(r) and K are read off.

use std::fmt;
use std::sync::Arc;

use serde_json::{Value, json};

use crate::accumulate::{ComputedBy, Decoder, Encoder, PairCounts, PairHistogram, Sums};
use crate::compute::Session;
use crate::error::{Error, Result, number};
use crate::estimate::{Analysis, ErrorSource, KFunction, Normalization, PairCorrelation, PairErrors};
use crate::plan::{Batch, BinScale, Correction, DeviceCosts, PairPlan, PairSettings, RadialBins};
use crate::points::{Domain, Ensemble};
use crate::request::{Request, Statistic};
use crate::setting::Setting;
use crate::statistics::group::{Ask, Effort, Group, Kept, Parts, Subject, digest};
use crate::statistics::lags::Lags;
use crate::statistics::neighbors::Neighborhood;

/// Most values kept for binning anew: histograms of all realizations.
const MOST_HISTOGRAMS: u64 = 1 << 22;

/// What rounding of the products of weights may move g by without a word.
const LOST: f64 = 1e-9;

/// The plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pairs {
    pub(crate) plan: PairPlan,
    /// Whether g is wanted, not only K.
    pub(crate) pcf: bool,
    /// Whether errors of one realization know that its points are correlated: those of simulations do not, since nobody reads them.
    correlated: bool,
    /// The finest bins that were asked for while the measurement goes on; every realization is counted in them and kept, so
    /// that it can be binned anew.
    finest: Option<PairPlan>,
}

/// The sums, and the histograms of all realizations in the finest bins as long as they are few.
#[derive(Debug, Clone)]
pub(crate) struct PairSums {
    pub(crate) counts: PairCounts,
    histograms: Option<Vec<Arc<PairHistogram>>>,
}

/// What all sums of pairs are asked for with.
pub(super) fn settings(ask: &Ask<'_>) -> Result<PairSettings> {
    let (request, domain) = (ask.request, ask.domain);
    if request.beyond_half && !domain.is_torus() {
        let reason = "is about a torus; a window has its edge correction";
        return Err(Error::setting(Setting::BeyondHalf, "(given)", reason));
    }
    Ok(PairSettings {
        correction: correction(request, domain),
        cumulative: ask.wants(Statistic::KFunction),
        beyond_half: request.beyond_half || request.conventions().pair_bins(ask.shape.max_points).is_some(),
        masses: request.input.is_weighted(),
    })
}

/// The edge correction, by default that of the domain.
pub(crate) fn correction(request: &Request, domain: &Domain) -> Correction {
    let default = if domain.is_torus() { Correction::None } else { Correction::Translation };
    request.correction.unwrap_or(default)
}

impl Pairs {
    /// In these bins.
    pub(super) fn new(ask: &Ask<'_>, bins: RadialBins, settings: PairSettings) -> Result<Self> {
        let plan = PairPlan::new(ask.domain, bins, settings, ask.shape).map_err(|e| match (e, &ask.request.edges) {
            (Error::Setting { setting: Setting::RMax, value, reason }, Some(path)) => {
                Error::setting(Setting::Edges, path.display(), format!("its last edge {value}: {reason}"))
            }
            (other, _) => other,
        })?;
        Ok(Self { plan, pcf: ask.wants(Statistic::Pcf), correlated: true, finest: None })
    }
}

/// The bins a request asks for.
pub(super) fn bins(ask: &Ask<'_>) -> Result<RadialBins> {
    let Ask { request, domain, shape, .. } = *ask;
    if let Some((bins, width)) = request.conventions().pair_bins(shape.mean_points as u64) {
        let width = width * domain.shortest_side();
        if bins == 0 {
            let reason = "has n/8 bins of g, so that it needs at least 8 points";
            return Err(Error::setting(Setting::Convention, request.convention, reason));
        }
        // Beyond half the diagonal of a torus there are no pairs.
        let edges = (0..=bins).map(|k| k as f64 * width);
        return RadialBins::from_edges(edges.take_while(|&r| r <= domain.half_diagonal()).collect());
    }
    if let Some(path) = &request.edges {
        // What is wrong with them is wrong in that file.
        let edges = ask.lists.edges(path)?.to_vec();
        return RadialBins::from_edges(edges).map_err(|e| e.in_file(Setting::Edges, path));
    }
    let mut default = PairPlan::default_r_max(domain, shape.mean_points);
    if request.correction == Some(Correction::Border) {
        // Enough points must be that far from the border.
        default = default.min(domain.inner_diameter() / 4.0);
    }
    let r_max = request.r_max.unwrap_or(default);
    // Written so that NaN fails.
    if !(r_max > 0.0 && r_max.is_finite()) {
        return Err(Error::setting(Setting::RMax, number(r_max), "expected a finite number above 0"));
    }
    let bins = request.bins.unwrap_or(256);
    match request.bin_scale.unwrap_or(BinScale::Linear) {
        BinScale::Log => RadialBins::logarithmic(r_max * 1e-3, r_max, bins),
        BinScale::Linear | BinScale::Given => RadialBins::linear(r_max, bins),
    }
}

/// K counts from 0 on, and L compares it with balls.
pub(super) fn check_bins_of_k(request: &Request, bins: &RadialBins, domain: &Domain) -> Result<()> {
    let first = bins.edges()[0];
    if first > 0.0 {
        let reason = format!("K counts all pairs closer than r: bins must start at 0, not at {first}");
        return Err(match &request.edges {
            Some(path) => Error::setting(Setting::Edges, path.display(), reason),
            None => Error::setting(Setting::BinScale, "log", reason),
        });
    }
    let limit = domain.shortest_side() / 2.0;
    if request.beyond_half && bins.r_max() > limit {
        let reason =
            format!("K and L compare with whole balls, which fit up to r = {limit}; expected `stats` pcf alone");
        return Err(Error::setting(Setting::BeyondHalf, "(given)", reason));
    }
    Ok(())
}

/// What counts of pairs depend on.
pub(crate) fn identity(plan: &PairPlan) -> Value {
    json!({
        "edges": digest(plan.bins.edges().iter().copied()),
        "correction": plan.correction,
        "cumulative": plan.cumulative,
        "weights": plan.masses,
    })
}

impl Group for Pairs {
    type Sums = PairSums;

    const NAME: &'static str = "g(r)";
    const STAGE: &'static str = "pair_counts";

    fn statistics(&self) -> Vec<Statistic> {
        let given = [(self.pcf, Statistic::Pcf), (self.plan.cumulative, Statistic::KFunction)];
        given.into_iter().filter_map(|(given, statistic)| given.then_some(statistic)).collect()
    }

    fn identity(&self) -> Value {
        identity(&self.plan)
    }

    fn batch(&self) -> Batch {
        self.plan.batch
    }

    fn suit(&mut self, device: &DeviceCosts) {
        self.plan = self.plan.clone().for_device(device.pairs);
    }

    fn none(&self, by: ComputedBy) -> PairSums {
        PairSums { counts: PairCounts::new(by, &self.plan), histograms: None }
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<PairSums> {
        if let Some((finest, edges)) = self.kept_bins(batch) {
            return self.measure_finest(finest, &edges, batch, session).await;
        }
        Ok(PairSums { counts: session.pair_counts(&self.plan, batch).await?, histograms: None })
    }

    fn estimate(&self, sums: &PairSums, subject: &Subject<'_>, found: &mut Analysis) {
        let (request, sums) = (subject.request, &sums.counts);
        found.correction = self.plan.correction;
        let errors = self.correlated.then(|| PairErrors::new(&self.plan, sums)).flatten();
        if self.pcf {
            let g = PairCorrelation::with_errors(&self.plan, sums, request.normalization, errors.as_ref());
            let g = g.labelled(&self.plan, &request.conventions());
            found.closed_form.g = closed_form(subject, &g);
            found.findings.insert(g);
        }
        let mean_points = subject.shape.mean_points;
        let (normalization, errors) = (request.normalization, errors.as_ref());
        found.findings.add(KFunction::with_errors(&self.plan, sums, normalization, mean_points, errors));
    }

    fn warnings(&self, sums: &PairSums, subject: &Subject<'_>, parts: &Parts, found: &Analysis) -> Vec<String> {
        let (sums, one) = (&sums.counts, subject.shape.realizations == 1);
        let mut warnings = Vec::new();
        let empty = sums.counts.iter().filter(|&&c| c == 0).count();
        if empty > 0 && !one && self.pcf {
            warnings.push(format!(
                "no realization has a pair in {empty} of {} bins: g = 0 there, and its standard error across realizations is 0",
                self.plan.bins.len()
            ));
        }
        let unseen = sums.bins.norms.iter().filter(|n| n[0].sum == 0).count();
        if unseen > 0 && unseen < sums.counts.len() {
            warnings
                .push(format!("no point is far enough from the border for {unseen} of the bins: they are left empty"));
        }
        let given = subject.request.input.weight_column.is_some();
        if given && (parts.get::<Neighborhood>().is_some() || parts.get::<Lags>().is_some()) {
            let warning =
                "weights of points enter g(r), K and P only: g of the vector and neighbours take every point alike";
            warnings.push(warning.to_string());
        }
        let pairs = subject.shape.realizations as f64 * subject.shape.mean_points.powi(2);
        // With border correction in the bin that has least.
        let least = sums.bins.norms.iter().map(|n| n[0].sum).filter(|&n| n > 0).min().unwrap_or(0);
        let lost = 0.5 * pairs / least as f64;
        if self.plan.masses && lost > LOST {
            warnings.push(format!(
                "weights of points differ so much that their products, in steps of 2^-64 of the largest squared, are off: g and K by \
                 up to {lost:.1e} of what they are without weights"
            ));
        }
        if self.plan.masses && one {
            let warning = "errors for a single realization take the pairs of a bin as of equal weight: with very unequal weights of \
                           points they are too small";
            warnings.push(warning.to_string());
        }
        let errors = found.pair_correlation().map(|g| g.errors).or(found.k_function().map(|k| k.errors));
        let apart = [
            ("the kernel estimate", found.kernel().is_some()),
            ("two classes", found.cross().is_some() || found.cross_k().is_some()),
            ("g of the vector", parts.get::<Lags>().is_some()),
            ("G and F", parts.get::<Neighborhood>().is_some()),
        ];
        let apart: Vec<&str> = apart.into_iter().filter_map(|(name, there)| there.then_some(name)).collect();
        if errors == Some(ErrorSource::ClusterTheory) && !apart.is_empty() {
            warnings.push(format!(
                "points are clustered: errors of {} take all that they count in a single realization as independent, and are several \
                 times too small; give more realizations, or an envelope",
                apart.join(", ")
            ));
        }
        if let Some(lags) = parts.get::<Lags>().filter(|lags| lags.lags.correction != self.plan.correction) {
            let (of_pairs, of_lags) = (self.plan.correction, lags.lags.correction);
            warnings.push(format!("{of_pairs} correction is for g(r); g of the vector has {of_lags}"));
        }
        warnings
    }

    fn effort(&self, n: u64) -> Effort {
        Effort { pairs: pairs_of(n), products: 0.0 }
    }

    fn seconds(&self, _: f64) -> f64 {
        self.plan.seconds()
    }

    fn in_simulations(&self) -> Option<Self> {
        Some(Self { correlated: false, ..self.clone() })
    }

    fn curve_values(&self) -> usize {
        // g, K and L.
        (usize::from(self.pcf) + 2 * usize::from(self.plan.cumulative)) * self.plan.bins.len()
    }

    fn keep_ready(&mut self) {
        let plain = !(self.plan.weighted() || self.plan.border() || self.plan.cumulative);
        self.finest = plain.then(|| self.plan.clone());
    }

    fn kept(&self, sums: &PairSums, wanted: &Self, _: &mut dyn Iterator<Item = u64>) -> Option<Kept<Self>> {
        let plan = Self { finest: self.finest.clone(), ..wanted.clone() };
        if Group::identity(self) == Group::identity(wanted) {
            return Some(Kept { plan, sums: sums.clone(), rebinned: false });
        }
        // Bins that each are some of the finest ones.
        let (finest, histograms) = (self.finest.as_ref()?, sums.histograms.as_ref()?);
        wanted.finest.as_ref()?;
        let edges = edges_among(finest, &wanted.plan)?;
        let mut counts = PairCounts::new(sums.counts.computed_by.clone(), &wanted.plan);
        histograms.iter().for_each(|h| counts.add(&coarse(h, &edges)));
        Some(Kept { plan, sums: PairSums { counts, histograms: Some(histograms.clone()) }, rebinned: true })
    }
}

/// Unordered pairs of `n` points.
pub(crate) fn pairs_of(n: u64) -> f64 {
    n as f64 * (n as f64 - 1.0) / 2.0
}

impl Pairs {
    /// The finest bins and where the edges of these are among them, as long as the histograms of all realizations are few.
    fn kept_bins(&self, batch: &Ensemble) -> Option<(&PairPlan, Vec<usize>)> {
        let finest = self.finest.as_ref()?;
        let all = batch.first_index() + batch.realizations() as u64;
        if all.saturating_mul(finest.bins.len() as u64) > MOST_HISTOGRAMS {
            return None;
        }
        Some((finest, edges_among(finest, &self.plan)?))
    }

    async fn measure_finest(
        &self,
        finest: &PairPlan,
        edges: &[usize],
        batch: &Ensemble,
        session: &mut Session<'_>,
    ) -> Result<PairSums> {
        let singles: Vec<Ensemble> = (0..batch.realizations()).map(|k| batch.slice(k..k + 1)).collect();
        let all = session.all_pair_counts(finest, &singles).await?;
        let by = all.iter().map(|c| c.computed_by.clone()).reduce(|a, b| a.merge(&b));
        let Some(by) = by else {
            return Ok(PairSums { counts: session.pair_counts(&self.plan, batch).await?, histograms: None });
        };
        let mut counts = PairCounts::new(by, &self.plan);
        let mut histograms = Vec::with_capacity(singles.len());
        for (one, single) in all.into_iter().zip(&singles) {
            let histogram = PairHistogram::new(single.points_in(0) as u64, one.counts, None);
            counts.add(&coarse(&histogram, edges));
            histograms.push(Arc::new(histogram));
        }
        Ok(PairSums { counts, histograms: Some(histograms) })
    }
}

/// Where the edges of other bins are among the finest; `None` if one is not there.
fn edges_among(finest: &PairPlan, plan: &PairPlan) -> Option<Vec<usize>> {
    plan.thresholds.iter().map(|edge| finest.thresholds.binary_search(edge).ok()).collect()
}

/// The same pairs in bins that each are some of those here.
fn coarse(fine: &PairHistogram, edges: &[usize]) -> PairHistogram {
    let counts = edges.windows(2).map(|w| fine.counts[w[0]..w[1]].iter().sum()).collect();
    PairHistogram::new(fine.n, counts, None)
}

/// What theory says of g at the bin centres, on a cubic torus.
fn closed_form(subject: &Subject<'_>, g: &PairCorrelation) -> Option<Vec<f64>> {
    let process = subject.closed_forms()?;
    let side = subject.domain.shortest_side();
    let n = process.n as f64;
    // Of E[n(n - 1)] and E[n^2].
    let factor = match subject.request.normalization {
        Normalization::Pairs => Some(1.0),
        Normalization::Intensity => {
            process.sampler.count_variance().map(|variance| (n * (n - 1.0) + variance) / (n * n + variance))
        }
    };
    g.r.iter().map(|r| Some(process.pair_correlation(r / side)? * factor?)).collect()
}

impl Sums for PairSums {
    fn merge(&mut self, other: Self) -> Result<()> {
        self.counts.merge(&other.counts)?;
        // Without those of one part there are not those of all.
        self.histograms = self.histograms.take().zip(other.histograms).map(|(mut a, b)| {
            a.extend(b);
            a
        });
        Ok(())
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        Some(&self.counts.computed_by)
    }

    fn encode(&self, out: &mut Encoder) {
        self.counts.encode(out);
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        Ok(Self { counts: PairCounts::decode(from)?, histograms: None })
    }
}

impl fmt::Display for Pairs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.plan.fmt(f)
    }
}
