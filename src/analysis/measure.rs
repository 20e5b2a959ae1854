//! The raw sums of all realizations, batch by batch.

use std::borrow::Cow;
use std::ops::Range;

use super::Plan;
use super::sums::{Sums, merge};
use crate::accumulate::PairCounts;
use crate::compute::WithFallback;
use crate::control::Clock;
use crate::control::Control;
use crate::error::{Error, Result};
use crate::estimate::{CrossValidation, Normalization};
use crate::plan::{BandwidthSearch, EnsembleShape};
use crate::points::Ensemble;
use crate::pool::Pool;

/// What there is to measure.
pub(super) struct Input<'a> {
    /// In words.
    pub(super) subject: &'a str,
    /// Number of realizations.
    pub(super) realizations: u64,
    /// Those of a range.
    pub(super) batch: &'a (dyn Fn(Range<u64>) -> Result<Ensemble> + Sync),
    /// The normalization of g, which a bandwidth found by cross-validation depends on.
    pub(super) normalization: Normalization,
}

/// What was measured.
pub(super) struct Measured<'a> {
    pub(super) sums: Sums,
    /// The plan, with the bandwidth that was found.
    pub(super) plan: Cow<'a, Plan>,
    pub(super) cross_validation: Option<CrossValidation>,
    /// Points per realization.
    pub(super) sizes: Vec<u64>,
    pub(super) duplicates: u64,
    /// The first realization.
    pub(super) first: Ensemble,
}

impl Measured<'_> {
    /// Number and size of realizations, now that those a sampler drew are known.
    pub(super) fn shape(&self) -> EnsembleShape {
        EnsembleShape::of(&self.sizes)
    }
}

/// Carries out a plan. `tell` hears what is being done, and how many realizations are finished.
pub(super) fn measure<'a>(
    plan: &'a Plan,
    input: &Input<'_>,
    device: &mut WithFallback<'_>,
    control: &Control,
    clock: &mut Clock,
    tell: &mut dyn FnMut(&'static str, u64),
) -> Result<Measured<'a>> {
    let mut plan = Cow::Borrowed(plan);
    let mut cross_validation = None;
    if let (Some(search), Some(kernel)) = (&plan.search, &plan.kernel) {
        let counts = search_counts(search, &plan, input, device, control, clock, tell)?;
        let (divisor, normalization) = (kernel.divisor, input.normalization);
        let find = || CrossValidation::new(search, &counts, divisor, normalization);
        let found = clock.time("cross-validation", || device.pool().install(find));
        let kernel = kernel.with_bandwidth(found.bandwidth)?;
        plan = Cow::Owned(Plan { kernel: Some(kernel), ..plan.into_owned() });
        cross_validation = Some(found);
    }
    let (mut sums, mut sizes, mut duplicates, mut first) = (Sums::default(), Vec::new(), 0, None);
    let pool = device.pool();
    each_batch(plan.batch, input, &pool, control, clock, tell, |batch, clock, tell| {
        duplicates += pool.install(|| batch.duplicates());
        sizes.extend((0..batch.realizations()).map(|k| batch.points_in(k) as u64));
        sums.merge(Sums::measure(&plan, batch, device, control, clock, tell)?)?;
        first.get_or_insert_with(|| batch.slice(0..1));
        Ok(())
    })?;
    let first = first.ok_or_else(|| Error::input(input.subject, "there are no realizations"))?;
    Ok(Measured { sums, plan, cross_validation, sizes, duplicates, first })
}

/// The pairs that cross-validation looks at.
fn search_counts(
    search: &BandwidthSearch,
    plan: &Plan,
    input: &Input<'_>,
    device: &mut WithFallback<'_>,
    control: &Control,
    clock: &mut Clock,
    tell: &mut dyn FnMut(&'static str, u64),
) -> Result<PairCounts> {
    let mut counts = None;
    let pool = device.pool();
    each_batch(plan.batch, input, &pool, control, clock, tell, |batch, clock, tell| {
        tell("pair_counts (bandwidth)");
        let next = clock.time("pair_counts (bandwidth)", || device.pair_counts(&search.pairs, batch, control))?;
        merge(&mut counts, Some(next), |a: &mut PairCounts, b| a.merge(&b))
    })?;
    counts.ok_or_else(|| Error::input(input.subject, "there are no realizations"))
}

/// Does `work` on one batch after the other.
fn each_batch(
    size: u64,
    input: &Input<'_>,
    pool: &Pool,
    control: &Control,
    clock: &mut Clock,
    tell: &mut dyn FnMut(&'static str, u64),
    mut work: impl FnMut(&Ensemble, &mut Clock, &mut dyn FnMut(&'static str)) -> Result<()>,
) -> Result<()> {
    let draw = input.batch;
    let mut start = 0;
    while start < input.realizations {
        control.check()?;
        let end = (start + size).min(input.realizations);
        let mut tell = |stage| tell(stage, start);
        tell("points");
        let batch = clock.time("points", || pool.install(|| draw(start..end)))?;
        work(&batch, clock, &mut tell)?;
        start = end;
    }
    Ok(())
}
