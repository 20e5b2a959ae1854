//! g smoothed by a kernel: a second pass over the pairs, and a pass before that where its bandwidth is to be found.

use std::any::Any;
use std::fmt;

use serde_json::{Value, json};

use super::counts::identity;
use crate::accumulate::{ComputedBy, KernelSums, PairCounts};
use crate::compute::Session;
use crate::error::{Result, plural};
use crate::estimate::{Analysis, CrossValidation, KernelEstimate};
use crate::plan::{Bandwidth, BandwidthSearch, Batch, DeviceCosts, KernelPlan, PairSettings, RadialBins, Smoothing};
use crate::points::Ensemble;
use crate::request::{Request, Statistic};
use crate::statistics::group::{Ask, Group, Part, PartSums, Parts, Subject, digest, of};

/// The plan of the kernel estimate; until its bandwidth is found that is Stoyan's.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Smoothed {
    pub(crate) plan: KernelPlan,
    /// Whether the bandwidth is still to be found.
    searched: bool,
    found: Option<CrossValidation>,
}

/// The pairs that cross-validation looks at.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Search(BandwidthSearch);

/// Both plans, of which the second needs the first to be done.
pub(super) fn plans(
    ask: &Ask<'_>,
    bins: &RadialBins,
    settings: PairSettings,
) -> Result<Option<(Option<Search>, Smoothed)>> {
    let Ask { request, domain, shape, .. } = *ask;
    let Some(kernel) = request.kernel else { return Ok(None) };
    let rule = request.bandwidth.unwrap_or(Bandwidth::Stoyan);
    let (divisor, r) = (request.divisor.unwrap_or_default(), bins.centres());
    let ends = [r[0], r[r.len() - 1]];
    let kernel = Smoothing { shape: kernel, bandwidth: rule.value(domain, shape.mean_points) };
    let plan = KernelPlan::new(kernel, divisor, r, request.exact_kernel, domain, settings, shape)?;
    let search = (rule == Bandwidth::Lscv)
        .then(|| BandwidthSearch::new(kernel.shape, ends, domain, settings, shape))
        .transpose()?
        .map(Search);
    let searched = search.is_some();
    Ok(Some((search, Smoothed { plan, searched, found: None })))
}

impl Group for Search {
    type Sums = PairCounts;

    const NAME: &'static str = "bandwidth";
    const STAGE: &'static str = "pair_counts (bandwidth)";

    fn statistics(&self) -> Vec<Statistic> {
        Vec::new()
    }

    fn identity(&self) -> Value {
        let Self(search) = self;
        json!({ "range": search.range, "distances": search.distances, "pairs": identity(&search.pairs) })
    }

    fn batch(&self) -> Batch {
        self.0.pairs.batch
    }

    fn suit(&mut self, device: &DeviceCosts) {
        self.0.pairs = self.0.pairs.clone().for_device(device.pairs);
    }

    fn none(&self, by: ComputedBy) -> PairCounts {
        PairCounts::new(by, &self.0.pairs)
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<PairCounts> {
        session.pair_counts(&self.0.pairs, batch).await
    }

    fn estimate(&self, _: &PairCounts, _: &Subject<'_>, _: &mut Analysis) {}

    fn in_simulations(&self) -> Option<Self> {
        // Found anew, so that all curves are treated alike.
        Some(self.clone())
    }
}

impl Group for Smoothed {
    type Sums = KernelSums;

    const NAME: &'static str = "g smoothed";
    const STAGE: &'static str = "kernel_sums";
    const LAST_WORDS: bool = true;

    fn statistics(&self) -> Vec<Statistic> {
        Vec::new()
    }

    fn identity(&self) -> Value {
        let plan = &self.plan;
        json!({
            "kernel": plan.kernel,
            "divisor": plan.divisor,
            "r": digest(plan.r.iter().copied()),
            "method": plan.method,
            "pairs": identity(&plan.pairs),
            "bandwidth": if self.searched { "to be found" } else { "given" },
        })
    }

    fn batch(&self) -> Batch {
        self.plan.pairs.batch
    }

    fn suit(&mut self, device: &DeviceCosts) {
        self.plan.pairs = self.plan.pairs.clone().for_device(device.pairs);
    }

    fn seconds(&self, _: f64) -> f64 {
        self.plan.seconds()
    }

    fn none(&self, by: ComputedBy) -> KernelSums {
        KernelSums::new(by, self.plan.r.len())
    }

    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<KernelSums> {
        session.kernel_sums(&self.plan, batch).await
    }

    fn estimate(&self, sums: &KernelSums, subject: &Subject<'_>, found: &mut Analysis) {
        let estimate = KernelEstimate::new(&self.plan, sums, subject.request.normalization);
        found.findings.insert(KernelEstimate { cross_validation: self.found, ..estimate });
    }

    fn warnings(&self, sums: &KernelSums, _: &Subject<'_>, _: &Parts, found: &Analysis) -> Vec<String> {
        let mut warnings = Vec::new();
        let empty =
            found.kernel().map_or(0, |k| k.r.iter().zip(&k.g).filter(|(r, g)| **r > 0.0 && g.is_none()).count());
        if empty > 0 {
            warnings.push(format!(
                "the kernel reaches past the longest distance the domain allows at {empty} of the bins: g_kernel is left empty \
                 there; a smaller --bandwidth or --r-max avoids it"
            ));
        }
        if sums.coincident > 0 {
            let coincident = sums.coincident;
            warnings.push(format!(
                "left out of g_kernel: {} at distance 0, by which divisor d would divide",
                plural(coincident, "ordered pair")
            ));
        }
        if let Some(found) = self.found.filter(|f| f.at_end) {
            let ([lo, hi], b) = (found.range, found.bandwidth);
            warnings.push(format!(
                "cross-validation found no least score within bandwidths from {lo:.4e} to {hi:.4e}: {b:.4e} is the end of that range"
            ));
        }
        warnings
    }

    fn in_simulations(&self) -> Option<Self> {
        let again = self.searched || self.found.is_some();
        Some(Self { searched: again, found: None, ..self.clone() })
    }

    fn curve_values(&self) -> usize {
        self.plan.r.len()
    }

    fn waits_for(&self) -> Option<&'static str> {
        self.searched.then_some(Search::NAME)
    }

    fn after(&self, sums: &dyn PartSums, search: &dyn Part, request: &Request) -> Result<Self> {
        let search: Option<&Search> = (search as &dyn Any).downcast_ref();
        let Some((Search(search), counts)) = search.zip(of::<PairCounts>(sums)) else { return Ok(self.clone()) };
        let found = CrossValidation::new(search, counts, self.plan.divisor, request.normalization);
        Ok(Self { plan: self.plan.with_bandwidth(found.bandwidth)?, searched: false, found: Some(found) })
    }
}

impl fmt::Display for Search {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Display for Smoothed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.plan.fmt(f)
    }
}
