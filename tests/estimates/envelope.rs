//! Ranks and envelopes of simulations: by hand, and how often random patterns are rejected.

use crate::common::*;
use pairwave::estimate::{Curve, Envelope, Normalization, PairCorrelation};
use pairwave::plan::{Correction, RadialBins};
use pairwave::points::RawPoints;

fn envelope_of(values: &[f64], simulated: &[&[f64]]) -> Envelope {
    let r = (0..values.len()).map(|k| k as f64).collect();
    let simulated: Vec<Vec<f64>> = simulated.iter().map(|s| s.to_vec()).collect();
    Envelope::new(Curve { name: "g", r, values: values.to_vec() }, &simulated)
}

/// Four curves at three r, ranked by hand:
///
/// ```text
///             r = 0   1   2    ranks from the nearer end    sorted
/// observed        9   5   5        1   2   2                1 2 2
/// simulation 1    1   6   6        1   2   2                1 2 2
/// simulation 2    4   1   9        2   1   1                1 1 2
/// simulation 3    5   8   1        2   1   1                1 1 2
/// ```
#[test]
fn global_ranks_worked_by_hand() {
    let e = envelope_of(&[9.0, 5.0, 5.0], &[&[1.0, 6.0, 6.0], &[4.0, 1.0, 9.0], &[5.0, 8.0, 1.0]]);
    assert_eq!((e.p, e.p_interval), (1.0, [0.0, 1.0]), "all have extreme rank 1; two are longer, one ties");
    assert_eq!(e.pointwise, [vec![1.0, 1.0, 1.0], vec![5.0, 8.0, 9.0]]);
    // The least curve may be left out at level 1/4; the two least tie, so nothing can be.
    assert_eq!((e.alpha, e.global.clone()), (0.25, [vec![1.0, 1.0, 1.0], vec![9.0, 8.0, 9.0]]));

    // Lowest at both r, so the observed curve alone is the most extreme: 1 1 against 1 2 and 2 2 (of 5, ties are none).
    let e = envelope_of(&[0.0, 0.0], &[&[1.0, 4.0], &[2.0, 3.0], &[3.0, 2.0], &[4.0, 1.0]]);
    assert_eq!((e.p, e.p_interval), (0.2, [0.0, 0.6]));
    assert_eq!(e.global, [vec![1.0, 1.0], vec![4.0, 4.0]], "without the observed one");

    // Equal values share the mean rank: a bin where nobody has a pair says nothing. An undefined one is left out.
    let e = envelope_of(&[0.0, 5.0, f64::NAN], &[&[0.0, 1.0, 1.0], &[0.0, 2.0, 2.0]]);
    assert_eq!((e.p, e.p_interval), (2.0 / 3.0, [0.0, 2.0 / 3.0]));
    assert!(e.global[0][2].is_nan() && e.pointwise[0][2] == 1.0);
}

/// g of 30 points, uniform or jittered, among that of 39 uniform patterns, with fixed seeds.
#[test]
fn random_patterns_are_rejected_as_often_as_stated() {
    let plan = pair_plan(&ensemble(&[uniform(2, 36, 0)]), RadialBins::linear(0.5, 20).unwrap(), Correction::None);
    let g = |points: RawPoints| {
        PairCorrelation::new(&plan, &reference_counts(&plan, &ensemble(&[points])), Normalization::Pairs)
    };
    let among = |points: RawPoints, seed: u64| {
        let g_of = g(points);
        let simulated: Vec<_> = (0..39).map(|s| g(uniform(2, 36, 1000 * seed + s)).g).collect();
        Envelope::new(Curve { name: "g", r: g_of.r, values: g_of.g }, &simulated)
    };
    let outside = |e: &Envelope, [lo, hi]: &[Vec<f64>; 2], k: usize| {
        let value = e.observed.values[k];
        value < lo[k] || value > hi[k]
    };
    let (mut rejected, mut pointwise, mut sum) = (0, 0, 0.0);
    let sets = 400;
    for seed in 1..=sets {
        let e = among(uniform(2, 36, 1000 * seed + 999), seed);
        assert!(e.p_interval[0] < e.p_interval[1] && e.p <= e.p_interval[1] && e.p > e.p_interval[0]);
        let left = (0..20).any(|k| outside(&e, &e.global, k));
        assert!(!left || e.p <= e.alpha, "outside, but p = {}", e.p);
        rejected += u32::from(e.p <= 0.05);
        pointwise += u32::from(outside(&e, &e.pointwise, 15));
        sum += e.p;
    }
    println!("rejected {rejected}, pointwise {pointwise} of {sets}; mean p {}", sum / sets as f64);
    // Binomial(400, 0.05), four standard deviations; p is uniform on multiples of 1/40.
    assert!((3..=37).contains(&rejected) && (3..=37).contains(&pointwise), "{rejected} and {pointwise}");
    assert!((sum / sets as f64 - 0.5125).abs() < 4.0 * (1.0 / 12.0 / sets as f64).sqrt(), "mean p");

    for seed in 1..=5 {
        let mut rng = Rng(seed);
        let cells = (0..36).flat_map(|j| [j % 6, j / 6]);
        let jittered = raw(2, cells.map(|c| (f64::from(c) + 0.5 + 0.4 * (rng.unit() - 0.5)) / 6.0).collect());
        let e = among(jittered, seed);
        assert_eq!(e.p, 1.0 / 40.0, "the smallest there is");
        assert!((0..20).any(|k| outside(&e, &e.global, k)));
    }
}

/// p may be at its level without the curve being outside, where the border of the envelope is met exactly.
#[test]
fn ties_at_the_border_of_an_envelope() {
    let e = envelope_of(&[0.0, 0.0], &[&[0.0, 3.0], &[3.0, 0.0], &[9.0, 4.0], &[9.0, 5.0], &[4.0, 9.0], &[5.0, 9.0]]);
    assert_eq!((e.p, e.alpha), (1.0 / 7.0, 1.0 / 7.0));
    assert_eq!(e.global, [vec![0.0, 0.0], vec![9.0, 9.0]]);
}
