//! Distances -> their distribution function at the distances of the plan.
//!
//! On a torus the share of distances below r. In a window a distance longer than the way to the border is not known to be
//! the shortest, as nearer points may lie outside: it is censored there. The product-limit estimator of Kaplan and Meier
//! uses it as far as it goes, `1 - F(r) = prod (1 - deaths(s) / at risk(s))` over the uncensored distances `s < r`, at
//! risk being those whose distance and way to the border are both at least s (Baddeley and Gill, "Kaplan-Meier estimators
//! of distance distributions for spatial point processes", Annals of Statistics 25, 1997). Beyond the last distance
//! seen the estimate stays where it is.

use rayon::prelude::*;

use crate::accumulate::{COUNT_STEPS, DistributionCounts};
use crate::plan::NeighborPlan;

/// Distances this many steps apart are equal: coordinates were f64 fractions of the box, rounded to 2^-53 of it. Matters in a
/// window only, where coordinates given to few digits meet the border, or each other's distances, exactly.
const TIE: u128 = 1 << 12;

/// Of squared distances; `place(i)` is from where the i-th was taken. Comparisons with r are between integers.
pub(super) fn distribution(
    plan: &NeighborPlan,
    squares: &[u128],
    place: impl Fn(usize) -> [u64; 3] + Sync,
) -> DistributionCounts {
    let n = squares.len();
    let points = n as u64;
    if plan.domain.is_torus() {
        let mut below = vec![0; plan.thresholds.len() + 1];
        for square in squares {
            below[plan.thresholds.partition_point(|t| t <= square)] += 1u64;
        }
        let mut sum = 0;
        below.pop();
        below.iter_mut().for_each(|b| {
            sum += *b;
            *b = sum;
        });
        return DistributionCounts {
            points,
            counts: below.iter().map(|&b| u128::from(b) << 32).collect(),
            at_risk: below.iter().map(|b| points - b).collect(),
        };
    }
    let border = plan.domain.border();
    let observe = |(i, &square): (usize, &u128)| {
        let border = u128::from(border.distance(&place(i)[..plan.domain.dim()]));
        let seen = square <= (border + TIE).pow(2);
        (if seen { square } else { border * border }, seen)
    };
    let mut observed: Vec<(u128, bool)> = squares.par_iter().enumerate().map(observe).collect();
    observed.par_sort_unstable();
    let (mut counts, mut at_risk) = (Vec::new(), Vec::new());
    let mut survival = 1.0;
    let mut passed = 0;
    for &threshold in &plan.thresholds {
        while let Some(&(square, _)) = observed.get(passed).filter(|o| o.0 < threshold) {
            let tied_below = (((square as f64).sqrt() + TIE as f64) * (1.0 + f64::EPSILON)).powi(2);
            let tied = observed[passed..].iter().take_while(|o| o.0 as f64 <= tied_below);
            let (tied, deaths) = tied.fold((0, 0), |(tied, deaths), o| (tied + 1, deaths + usize::from(o.1)));
            survival *= (n - passed - deaths) as f64 / (n - passed) as f64;
            passed += tied;
        }
        counts.push(((1.0 - survival) * n as f64 * COUNT_STEPS).round_ties_even() as u128);
        at_risk.push((n - passed) as u64);
    }
    DistributionCounts { points, counts, at_risk }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{EnsembleShape, RadialBins};
    use crate::points::Domain;

    fn plan(domain: &Domain, edges: &[f64]) -> NeighborPlan {
        let shape = EnsembleShape { realizations: 1, mean_points: 10.0, max_points: 10 };
        NeighborPlan::new(domain, Some(&RadialBins::from_edges(edges.to_vec()).unwrap()), shape).unwrap()
    }

    fn square(r: f64, domain: &Domain) -> u128 {
        ((r / domain.length_unit() * 2f64.powi(64)) as u128).pow(2)
    }

    #[test]
    fn counts_below_each_distance_on_a_torus() {
        let domain = Domain::unit_torus(1);
        let plan = plan(&domain, &[0.125, 0.25, 0.5]);
        let squares = [0.0, 0.124, 0.125, 0.3].map(|r| square(r, &domain));
        let found = distribution(&plan, &[&squares[..], &[u128::MAX]].concat(), |_| [0; 3]);
        assert_eq!((found.points, found.at_risk), (5, vec![3, 2, 1]));
        assert_eq!(found.counts, [2u128, 3, 4].map(|c| c << 32));
    }

    /// Worked by hand: an uncensored distance 1, one censored at 2, ties of both kinds at 3, one uncensored at 4.
    #[test]
    fn kaplan_meier_by_hand() {
        let domain = Domain::window(&[(0.0, 32.0)]).unwrap();
        let plan = plan(&domain, &[0.5, 1.5, 2.5, 3.5, 4.5]);
        let (distances, borders) = ([1.0, 5.0, 3.0, 7.0, 4.0], [8.0, 2.0, 3.0, 3.0, 16.0]);
        let squares = distances.map(|r| square(r, &domain));
        let place = |i: usize| [(borders[i] / 64.0 * 2f64.powi(64)) as u64, 0, 0];
        let found = distribution(&plan, &squares, place);
        assert_eq!(found.at_risk, [5, 4, 3, 1, 0]);
        // 4/5, then nothing, then 2/3 of it, then 0.
        let expected = [0.0, 0.2, 0.2, 1.0 - 0.8 * 2.0 / 3.0, 1.0];
        for (count, expected) in found.counts.iter().zip(expected) {
            assert!((*count as f64 / COUNT_STEPS / 5.0 - expected).abs() < 1e-9, "{count} against {expected}");
        }
    }
}
