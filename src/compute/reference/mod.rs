//! The slow truth everything answers to: one loop per sum of the formula, exact integers or f64, never optimized. Phases are of
//! coordinates as they were given; pairs are of the integers that `points` makes of them, which has its own tests against
//! coordinates (tests/reference/coordinates.rs).

mod counts;
mod discrepancy;
mod integration;
mod intensity;
mod kernel_sums;
mod lag_counts;
mod neighbors;
mod pair_counts;
mod phases;
mod polygon;
mod tapered_power;
mod wave_covariance;
mod wave_power;

pub use pair_counts::{isotropic_weight, translation_weight};
pub use phases::phase_turns;

use phases::Places;

use super::{Compute, NotHere, Pending, Work, at_once};
use crate::accumulate::{Backend, ComputedBy};
use crate::accumulate::{
    CountSums, CovarianceSums, DiscrepancySums, IntegrationSums, IntensitySums, KernelSums, LagCounts, NeighborSums,
    PairCounts, WaveCovariance, WavePower,
};
use crate::control::Control;
use crate::error::Result;
use crate::plan::LEAF;
use crate::plan::{
    CountPlan, CovariancePlan, DiscrepancyPlan, IntegrationPlan, IntensityPlan, KernelPlan, LagPlan, NeighborPlan,
    PairPlan, WavePlan,
};
use crate::points::Ensemble;

/// The reference implementation.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reference;

impl Compute for Reference {
    fn computed_by(&self) -> ComputedBy {
        ComputedBy::new(Backend::Reference, "reference (f64 and integers, one thread)")
    }

    fn supports(&self, _work: Work<'_>) -> Result<(), NotHere> {
        Ok(())
    }

    fn pair_counts<'a>(
        &'a self,
        plan: &'a PairPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, PairCounts> {
        at_once(|| {
            let mut sums = PairCounts::new(self.computed_by(), plan);
            for k in 0..ensemble.realizations() {
                sums.add(&pair_counts::pair_counts(plan, &ensemble.lengths(k), ensemble.weights(k), control)?);
            }
            Ok(sums)
        })
    }

    fn lag_counts<'a>(
        &'a self,
        plan: &'a LagPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, LagCounts> {
        at_once(|| {
            let mut sums = LagCounts::new(self.computed_by(), plan);
            for k in 0..ensemble.realizations() {
                sums.add(plan, &lag_counts::lag_counts(plan, &ensemble.lengths(k), control)?);
            }
            Ok(sums)
        })
    }

    fn wave_power<'a>(
        &'a self,
        plan: &'a WavePlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, WavePower> {
        at_once(|| {
            let mut sums = WavePower::new(self.computed_by(), plan.waves.len(), &plan.rings);
            for k in 0..ensemble.realizations() {
                let (places, weights) = (Places::of(ensemble, k), ensemble.weights(k));
                let power = match plan.tapered() {
                    Some(taper) => tapered_power::tapered_power(taper, &plan.waves, &places, weights, control)?,
                    None => wave_power::wave_power(&plan.waves, &places, weights, control)?,
                };
                sums.add(ensemble.first_index() + k as u64, ensemble.norm(k), &power, &plan.rings);
            }
            sums.close_leaf();
            Ok(sums)
        })
    }

    fn kernel_sums<'a>(
        &'a self,
        plan: &'a KernelPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, KernelSums> {
        at_once(|| {
            let mut sums = KernelSums::new(self.computed_by(), plan.r.len());
            for k in 0..ensemble.realizations() {
                let curve = kernel_sums::kernel_sums(plan, &ensemble.lengths(k), ensemble.weights(k), control)?;
                sums.add(ensemble.first_index() + k as u64, &curve);
            }
            sums.close_leaf();
            Ok(sums)
        })
    }

    fn wave_covariance<'a>(
        &'a self,
        plan: &'a CovariancePlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, WaveCovariance> {
        at_once(|| {
            let mut sums = WaveCovariance::new(self.computed_by(), plan.stored());
            let indices: Vec<usize> = (0..ensemble.realizations()).collect();
            let leaf_of = |k: usize| (ensemble.first_index() + k as u64) / LEAF;
            for leaf in indices.chunk_by(|&a, &b| leaf_of(a) == leaf_of(b)) {
                let mut part = CovarianceSums::new(plan.stored());
                for &k in leaf {
                    let (places, weights) = (Places::of(ensemble, k), ensemble.weights(k));
                    let all = wave_power::amplitudes(&plan.grid.into(), &places, weights, control)?;
                    wave_covariance::add(&mut part, &all[plan.grid.dc()..], ensemble.norm(k));
                }
                sums.add_leaf(leaf_of(leaf[0]), leaf.len() as u64, part);
            }
            Ok(sums)
        })
    }

    fn neighbors<'a>(
        &'a self,
        plan: &'a NeighborPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, NeighborSums> {
        at_once(|| neighbors::neighbors(plan, ensemble, control))
    }

    fn discrepancies<'a>(
        &'a self,
        plan: &'a DiscrepancyPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, DiscrepancySums> {
        at_once(|| discrepancy::discrepancies(plan, ensemble, control))
    }

    fn integration<'a>(
        &'a self,
        plan: &'a IntegrationPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, IntegrationSums> {
        at_once(|| integration::integration(plan, ensemble, control))
    }

    fn counts<'a>(
        &'a self,
        plan: &'a CountPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, CountSums> {
        at_once(|| counts::counts(plan, ensemble, control))
    }

    fn intensity<'a>(
        &'a self,
        plan: &'a IntensityPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, IntensitySums> {
        at_once(|| intensity::intensity(plan, ensemble, control))
    }
}
