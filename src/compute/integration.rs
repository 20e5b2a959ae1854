//! Integration errors by a device that computes power, a realization at a time, and the CPU path for what points and pairs add.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::Compute;
use super::cpu::{self, Cpu};
use super::shifts::weighted;
use crate::accumulate::IntegrationSums;
use crate::control::Control;
use crate::error::Result;
use crate::plan::{IntegrationPlan, WavePlan};
use crate::points::Ensemble;

/// Zeros in a row that are worth a jump.
const GAP: usize = 64;

/// Where a table is not 0: few integrands have more than a part of the frequencies.
fn runs(table: &[f64]) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for at in (0..table.len()).filter(|&at| table[at] != 0.0) {
        match runs.last_mut() {
            Some(run) if at < run.end + GAP => run.end = at + 1,
            _ => runs.push(at..at + 1),
        }
    }
    runs
}

/// The sums of every realization. Power along axes alone is a small transform, which the CPU path does.
pub(super) async fn integration(
    device: &dyn Compute,
    cpu: &Cpu,
    plan: &IntegrationPlan,
    ensemble: &Ensemble,
    control: &Control,
) -> Result<IntegrationSums> {
    // The grid, one transform per axis, and the points.
    control.in_pieces(2 + plan.axes.len());
    let ensemble = weighted(plan, ensemble)?;
    let unit = ensemble.weight_unit();
    let seen = async |device: &dyn Compute, waves: &WavePlan, points: &Ensemble, tables: &[&[f64]]| {
        let dots = Mutex::new(vec![Vec::new(); points.realizations()]);
        let runs: Vec<Vec<Range<usize>>> = tables.iter().map(|table| runs(table)).collect();
        let see = |k: usize, power: &[f64]| {
            let product = |(table, runs): (&&[f64], &Vec<Range<usize>>)| {
                let of_run = |run: &Range<usize>| cpu::dot(&table[run.clone()], &power[run.clone()]);
                runs.iter().map(of_run).sum::<f64>() * unit * unit
            };
            let of_all = tables.iter().zip(&runs).map(product).collect();
            dots.lock().unwrap_or_else(PoisonError::into_inner)[k] = of_all;
        };
        let sums = device.wave_power_seen(waves, points, &see, control).await?;
        Ok::<_, crate::error::Error>((sums, dots.into_inner().unwrap_or_else(PoisonError::into_inner)))
    };
    let tables: Vec<&[f64]> = plan.tables.iter().map(|table| &*table.grid).collect();
    let (grid, on_grid) = seen(device, &plan.grid, &ensemble, &tables).await?;
    let mut axes = Vec::new();
    let mut on_axes = vec![vec![0.0; plan.tables.len()]; ensemble.realizations()];
    for (a, waves) in plan.axes.iter().enumerate() {
        let tables: Vec<&[f64]> = plan.tables.iter().map(|table| &*table.axes[a]).collect();
        let (sums, dots) = seen(cpu, waves, &ensemble.on_axis(a, &waves.domain), &tables).await?;
        axes.push(sums);
        on_axes.iter_mut().zip(dots).for_each(|(all, more)| all.iter_mut().zip(more).for_each(|(a, b)| *a += b));
    }
    let (mut realizations, lags) = cpu::realizations(cpu, plan, &ensemble, control)?;
    for (sums, (on_grid, on_axes)) in realizations.iter_mut().zip(on_grid.into_iter().zip(on_axes)) {
        for (sums, (grid, axes)) in sums.each.iter_mut().zip(on_grid.into_iter().zip(on_axes)) {
            (sums.grid, sums.axes) = (grid, axes);
        }
    }
    Ok(IntegrationSums { grid, axes, integrands: plan.tables.len(), unit, lags, realizations })
}

#[cfg(test)]
mod tests {
    use super::runs;

    #[test]
    fn zeros_are_jumped_over() {
        let mut table = vec![0.0; 300];
        assert!(runs(&table).is_empty() && runs(&[]).is_empty());
        for at in [3, 5, 200, 299] {
            table[at] = 1.0;
        }
        assert_eq!(runs(&table), [3..6, 200..201, 299..300]);
        assert!(matches!(&*runs(&[1.0; 80]), [all] if *all == (0..80)));
    }
}
