//! Raw sums -> numbers with errors, against plain formulas written out here. Trusts the reference's raw sums.

mod common;

use common::*;
use pairwave::accumulate::{PairCounts, PairHistogram, WavePower};
use pairwave::compute::{Backend, ComputedBy};
use pairwave::estimate::{
    Bandwidth, CrossCorrelation, CrossCounts, ErrorSource, KFunction, Kernel, KernelEstimate, Normalization,
    PairCorrelation, PowerSpectrum, RadialSpectrum, SmoothingKernel,
};
use pairwave::plan::{Accuracy, BinScale, Correction, PairPlan, PairSettings, RadialBins, Rings, WaveGrid};
use pairwave::points::{Domain, Ensemble, RawPoints};

fn tag() -> ComputedBy {
    ComputedBy::new(Backend::Reference, "by hand")
}

#[test]
fn g_and_its_error_across_realizations() {
    let sets: Vec<_> = (0..7).map(|i| uniform(2, 50, i)).collect();
    let ensemble = ensemble(&sets);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 10).unwrap(), Correction::None);
    let g = PairCorrelation::new(&plan, &reference_counts(&plan, &ensemble), Normalization::Pairs);
    assert_eq!(g.errors, ErrorSource::AcrossRealizations);
    for b in 0..10 {
        let (lo, hi) = (0.05 * b as f64, 0.05 * (b + 1) as f64);
        let each: Vec<f64> = (0..7)
            .map(|k| {
                let one = ensemble.slice(k..k + 1);
                let count = reference_counts(&plan, &one).counts[b] as f64;
                count / (50.0 * 49.0 * std::f64::consts::PI * (hi * hi - lo * lo))
            })
            .collect();
        let mean = each.iter().sum::<f64>() / 7.0;
        let variance = each.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 6.0;
        assert!((g.g[b] - mean).abs() < 1e-12, "bin {b}: {} against {mean}", g.g[b]);
        let se = (variance / 7.0).sqrt();
        assert!((g.g_se[b] - se).abs() < 1e-10 * (1.0 + se), "bin {b}: {} against {se}", g.g_se[b]);
    }
}

#[test]
fn one_realization_gets_poisson_errors() {
    let plan_of = |e: &Ensemble| pair_plan(e, RadialBins::from_edges(vec![0.0, 0.1, 0.5]).unwrap(), Correction::None);
    let e = ensemble(&[uniform(2, 3, 1)]);
    let mut counts = PairCounts::new(tag(), &plan_of(&e));
    counts.add(&PairHistogram::new(100, vec![0, 7000], None));
    let g = PairCorrelation::new(&plan_of(&e), &counts, Normalization::Pairs);
    assert_eq!(g.errors, ErrorSource::Theory);
    let expected = 9900.0 * std::f64::consts::PI * 0.24;
    assert!((g.g_se[1] - (2.0 * 7000f64).sqrt() / expected).abs() < 1e-12, "sqrt(2 c): unordered pairs are Poisson");
    assert_eq!(g.g[0], 0.0);
    assert!(g.g_se[0] > 0.0, "an empty bin is not known exactly");
}

#[test]
fn identical_realizations_have_no_error() {
    let e = ensemble(&vec![uniform(2, 40, 3); 5]);
    let plan = pair_plan(&e, RadialBins::linear(0.5, 6).unwrap(), Correction::None);
    let g = PairCorrelation::new(&plan, &reference_counts(&plan, &e), Normalization::Pairs);
    assert_eq!(g.g_se, [0.0; 6]);
    let plan = wave_plan(&e, &[6, 6], Accuracy::High);
    let spectrum = PowerSpectrum::new(&plan, &reference_power(&plan, &e));
    assert!(spectrum.p_se.iter().zip(&spectrum.p).all(|(se, p)| *se <= 1e-6 * p), "rounding is not variance");
    assert_eq!(spectrum.dc(), (40.0, 0.0));
}

#[test]
fn unequal_n_is_a_ratio_of_sums() {
    // Twice as many points in half of the realizations, all of them independent and uniform: g = 1 and P = 1.
    let sets: Vec<_> = (0..40).map(|i| uniform(2, if i % 2 == 0 { 30 } else { 60 }, 50 + i)).collect();
    let e = ensemble(&sets);
    let plan = pair_plan(&e, RadialBins::linear(0.5, 1).unwrap(), Correction::None);
    let sums = reference_counts(&plan, &e);
    let g = PairCorrelation::new(&plan, &sums, Normalization::Pairs);
    let pairs = 20.0 * (30.0 * 29.0 + 60.0 * 59.0);
    assert!((g.g[0] - sums.counts[0] as f64 / (pairs * std::f64::consts::PI * 0.25)).abs() < 1e-12);
    assert!((g.g[0] - 1.0).abs() < 5.0 * g.g_se[0], "{} +- {}", g.g[0], g.g_se[0]);
    let plan = wave_plan(&e, &[10, 10], Accuracy::High);
    let spectrum = PowerSpectrum::new(&plan, &reference_power(&plan, &e));
    assert_eq!(spectrum.dc().0, (30.0 * 30.0 + 60.0 * 60.0) / 90.0, "P(0) = sum n^2 / sum n");
}

#[test]
fn power_and_rings_across_realizations() {
    let sets: Vec<_> = (0..6).map(|i| uniform(2, 30, 90 + i)).collect();
    let e = ensemble(&sets);
    let plan = wave_plan(&e, &[5, 5], Accuracy::High);
    let sums = reference_power(&plan, &e);
    let spectrum = PowerSpectrum::new(&plan, &sums);
    let radial = RadialSpectrum::new(&plan, &sums, &spectrum);
    let each: Vec<Vec<f64>> = (0..6)
        .map(|k| reference_power(&plan, &e.slice(k..k + 1)).mode_totals().q.iter().map(|q| q / 30.0).collect())
        .collect();
    let statistics = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / 6.0;
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 5.0;
        (mean, (variance / 6.0).sqrt())
    };
    for i in 0..plan.grid.half_len() {
        let (mean, se) = statistics(&each.iter().map(|p| p[i]).collect::<Vec<_>>());
        assert!((spectrum.p[i] - mean).abs() < 1e-12 * (1.0 + mean), "mode {i}");
        assert!((spectrum.p_se[i] - se).abs() < 1e-7 * (1.0 + mean), "mode {i}: {} against {se}", spectrum.p_se[i]);
    }
    for (k, ring) in radial.rings.iter().enumerate() {
        // Straight from the definition: all modes of the whole grid with |m| in [k + 1/2, k + 3/2).
        let mut members = Vec::new();
        for a in -5i32..=5 {
            for b in -5i32..=5 {
                let m = f64::from(a * a + b * b).sqrt();
                if (k as f64 + 0.5..k as f64 + 1.5).contains(&m) {
                    members.push(plan.grid.half_index([a, b, 0]));
                }
            }
        }
        assert_eq!(ring.modes, members.len() as u64, "ring {}", k + 1);
        let ring_means: Vec<f64> =
            each.iter().map(|p| members.iter().map(|&i| p[i]).sum::<f64>() / members.len() as f64).collect();
        let (mean, se) = statistics(&ring_means);
        assert!((ring.p - mean).abs() < 1e-12 && (ring.p_se - se).abs() < 1e-9, "ring {}", k + 1);
        // Anisotropy over one of each +-m.
        let mut independent = members.clone();
        independent.sort_unstable();
        independent.dedup();
        let half: Vec<f64> =
            independent.iter().filter(|&&i| plan.grid.mode(i) > [0, 0, 0]).map(|&i| spectrum.p[i]).collect();
        assert_eq!(half.len() as u64, ring.independent_modes);
        let variance = half.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / (half.len() as f64 - 1.0);
        let db = 10.0 * (variance / (mean * mean)).log10();
        assert!((ring.anisotropy_db.unwrap() - db).abs() < 1e-9, "ring {}", k + 1);
    }
    assert!((radial.anisotropy_reference_db + 10.0 * 6f64.log10()).abs() < 1e-12);
}

#[test]
fn anisotropy_of_isotropic_noise_is_its_reference() {
    // Exponential modes averaged over K: mean anisotropy over many rings = -10 log10 K within its stated error.
    let domain = Domain::unit_torus(2);
    let grid = WaveGrid::new(&[60, 60]).unwrap();
    let rings = Rings::new(&grid, &domain);
    let mut rng = Rng(5);
    let mut power = WavePower::new(tag(), grid.half_len(), &rings);
    let k = 10;
    for index in 0..k {
        let mut q: Vec<f64> = (0..grid.half_len()).map(|_| -100.0 * (1.0 - rng.unit()).ln()).collect();
        // The plane m_0 = 0 holds mirror images.
        for i in 0..grid.dc() {
            q[i] = q[2 * grid.dc() - i];
        }
        power.add(index, 100, &q, &rings);
    }
    let e = ensemble(&vec![uniform(2, 100, 1); k as usize]);
    let plan = wave_plan(&e, &[60, 60], Accuracy::High);
    let radial = RadialSpectrum::new(&plan, &power, &PowerSpectrum::new(&plan, &power));
    let deviations: Vec<f64> = radial.rings[4..]
        .iter()
        .map(|r| (r.anisotropy_db.unwrap() - radial.anisotropy_reference_db) / r.anisotropy_db_se.unwrap())
        .collect();
    let mean_square = deviations.iter().map(|z| z * z).sum::<f64>() / deviations.len() as f64;
    assert!((0.5..1.7).contains(&mean_square), "mean square deviation {mean_square} in stated errors");
}

#[test]
fn undefined_anisotropy_is_none_not_nan() {
    // All points equal: P = n everywhere, no spread. 1D: one independent mode per ring.
    for points in [raw(2, vec![0.3; 40]), uniform(1, 20, 1)] {
        let e = ensemble(&[points]);
        let plan = wave_plan(&e, &vec![4; e.domain().dim()], Accuracy::High);
        let sums = reference_power(&plan, &e);
        let radial = RadialSpectrum::new(&plan, &sums, &PowerSpectrum::new(&plan, &sums));
        for ring in &radial.rings {
            assert!(ring.anisotropy_db.is_none() && ring.p.is_finite() && ring.p_se.is_finite(), "{ring:?}");
        }
    }
}

#[test]
fn rings_of_unequal_sides_are_whole() {
    let torus = Domain::torus(&[2.0, 1.0]).unwrap();
    let default = WaveGrid::default_max_frequency(100.0, &torus);
    assert_eq!(default, [71, 36], "the same frequency per unit length on both axes");
    let grid = WaveGrid::new(&[12, 4]).unwrap();
    let rings = Rings::new(&grid, &torus);
    // The next mode along y outside the grid is m_y = 5 at nu = 5, ring 10 (in units of 1/2): rings to 9 are whole.
    assert_eq!((rings.count, rings.fundamental), (9, 0.5));
    assert_eq!(WaveGrid::default_max_frequency(4096.0, &Domain::unit_torus(2)), [320, 320]);
    assert_eq!(WaveGrid::default_max_frequency(1000.0, &Domain::unit_torus(3)), [50, 50, 50]);
}

/// The kernel sum over all pairs, by the formula.
fn exact_kernel_sum(points: &RawPoints, domain: &Domain, shape: SmoothingKernel, bw: f64, r: f64) -> f64 {
    let n = points.len();
    let sides = domain.sides();
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            if i == j {
                continue;
            }
            let (mut d2, mut weight) = (0.0, 1.0);
            for (a, side) in sides.iter().enumerate() {
                let mut d = (points.coordinates[2 * i + a] - points.coordinates[2 * j + a]).abs();
                if domain.is_torus() {
                    d = d.min(side - d);
                } else {
                    weight *= side / (side - d);
                }
                d2 += d * d;
            }
            let x = (r - d2.sqrt()) / bw;
            let k = match shape {
                SmoothingKernel::Epanechnikov => 0.75 / 5f64.sqrt() * (1.0 - x * x / 5.0).max(0.0),
                SmoothingKernel::Gaussian => (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt(),
                SmoothingKernel::Box => {
                    if x.abs() <= 3f64.sqrt() {
                        0.5 / 3f64.sqrt()
                    } else {
                        0.0
                    }
                }
            };
            sum += weight * k / bw;
        }
    }
    domain.measure() * sum / (std::f64::consts::TAU * r * (n * (n - 1)) as f64)
}

#[test]
fn kernel_estimates_are_the_exact_sums() {
    let window = Domain::window(&[(0.0, 1.0), (0.0, 2.0)]).unwrap();
    for (domain, correction) in [(Domain::unit_torus(2), Correction::None), (window, Correction::Translation)] {
        let mut points = uniform(2, 400, 77);
        points.coordinates.iter_mut().enumerate().for_each(|(i, x)| *x *= domain.sides()[i % 2]);
        let e = Ensemble::from_raw(&[points.clone()], &domain, false, 0).unwrap();
        for shape in [SmoothingKernel::Epanechnikov, SmoothingKernel::Gaussian, SmoothingKernel::Box] {
            let kernel = Kernel::new(shape, Some(Bandwidth::Given(0.01)), &domain, 400.0).unwrap();
            let plan = pair_plan(&e, kernel.fine_bins(0.3, &domain).unwrap(), correction);
            assert_eq!(plan.bins.scale(), BinScale::Linear);
            let r: Vec<f64> = (0..=60).map(|i| f64::from(i) * 0.005).collect();
            let g = KernelEstimate::new(kernel, &r, &plan, &reference_counts(&plan, &e), Normalization::Pairs);
            assert_eq!(g.g[0], None, "r = 0 is undefined");
            let exact: Vec<f64> = r[1..].iter().map(|&r| exact_kernel_sum(&points, &domain, shape, 0.01, r)).collect();
            let scale = exact.iter().fold(1.0, |a: f64, &b| a.max(b));
            let worst =
                r[1..].iter().zip(&exact).zip(&g.g[1..]).fold(0.0, |w: f64, ((_, e), g)| w.max((g.unwrap() - e).abs()));
            println!("{shape:?}, {:?}: worst {worst:.1e}, largest g {scale:.2}", domain.boundary());
            // The box kernel jumps: a pair at a jump is in or out.
            let bound = if shape == SmoothingKernel::Box { 5e-2 } else { 1e-5 };
            assert!(worst <= bound * scale, "{shape:?}: off by {worst}");
        }
    }
}

#[test]
fn a_kernel_that_reaches_past_half_the_box_is_undefined_there() {
    let e = ensemble(&[uniform(2, 100, 1)]);
    let kernel = Kernel::new(SmoothingKernel::Box, Some(Bandwidth::Given(0.02)), e.domain(), 100.0).unwrap();
    let plan = pair_plan(&e, kernel.fine_bins(0.5, e.domain()).unwrap(), Correction::None);
    let sums = reference_counts(&plan, &e);
    let g = KernelEstimate::new(kernel, &[0.4, 0.46, 0.47, 0.5], &plan, &sums, Normalization::Pairs);
    assert_eq!(g.g.iter().map(Option::is_some).collect::<Vec<_>>(), [true, true, false, false]);
}

/// Asserts that deviations in standard errors look like standard errors.
fn assert_standard(name: &str, deviations: &[f64]) {
    let mean_square = deviations.iter().map(|z| z * z).sum::<f64>() / deviations.len() as f64;
    let worst = deviations.iter().fold(0f64, |w, z| w.max(z.abs()));
    println!("{name}: mean square {mean_square:.3} of {}, worst {worst:.2}", deviations.len());
    assert!((0.5..1.6).contains(&mean_square) && worst < 6.0, "{name}: mean square {mean_square}, worst {worst}");
}

/// The measure of a ball.
fn ball(r: f64, dim: usize) -> f64 {
    [2.0 * r, std::f64::consts::PI * r * r, 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)][dim - 1]
}

/// Independent points in a window have g = 1 and the K of a ball, whatever the correction.
#[test]
fn independent_points_in_a_window() {
    let n = 60;
    for dim in 1..=3 {
        let window = Domain::window(&[(-1.0, 1.0), (0.0, 1.0), (5.0, 6.5)][..dim]).unwrap();
        let sets: Vec<_> = (0..80).map(|i| uniform(dim, n, 3000 + i)).collect();
        let plain = ensemble_in(&window, &sets);
        let mut rng = Rng(17);
        let weights: Vec<f64> = (0..plain.total_points()).map(|_| 0.2 + rng.unit()).collect();
        let weighted = plain.clone().with_weights(&weights);
        for correction in [Correction::Translation, Correction::Isotropic, Correction::Border] {
            if dim == 3 && correction == Correction::Isotropic {
                continue;
            }
            let (r_max, share) = match correction {
                // Lambda is n / |D| here, though a point sees n - 1 others.
                Correction::Border => (0.35 * window.shortest_side(), (n as f64 - 1.0) / n as f64),
                Correction::Isotropic => (0.9 * window.half_diagonal(), 1.0),
                _ => (0.8 * window.shortest_side(), 1.0),
            };
            for (ensemble, masses) in [(&plain, false), (&weighted, true)] {
                if masses && correction == Correction::Border {
                    continue;
                }
                let settings = PairSettings { cumulative: true, masses, ..correction.into() };
                let bins = RadialBins::linear(r_max, 25).unwrap();
                let plan = PairPlan::new(&window, bins, settings, shape(ensemble)).unwrap();
                let sums = reference_counts(&plan, ensemble);
                let name = format!("{correction}, {dim}D, weights of points: {masses}");
                let g = PairCorrelation::new(&plan, &sums, Normalization::Pairs);
                let known = (0..25).filter(|&b| g.count[b] > 200);
                assert_standard(
                    &format!("g, {name}"),
                    &known.map(|b| (g.g[b] - share) / g.g_se[b]).collect::<Vec<_>>(),
                );
                let k = KFunction::new(&plan, &sums, Normalization::Pairs, n as f64).unwrap();
                for b in (4..25).step_by(5) {
                    let z = (k.k[b] - share * ball(k.r[b], dim)) / k.k_se[b];
                    assert!(z.abs() < 4.0, "K, {name}: {} at {}, {z} standard errors off", k.k[b], k.r[b]);
                    let z = (k.l[b] - k.r[b] * share.powf(1.0 / dim as f64)) / k.l_se[b].unwrap();
                    assert!(z.abs() < 4.0, "L, {name}: {} at {}", k.l[b], k.r[b]);
                }
            }
        }
    }
}

/// Up to half the diagonal of a torus every pair is seen, and g of independent points is 1.
#[test]
fn independent_points_beyond_half_a_torus() {
    for sides in [&[1.0, 1.0][..], &[2.0, 0.6], &[1.0; 3], &[1.0, 1.5, 0.7]] {
        let torus = Domain::torus(sides).unwrap();
        let sets: Vec<_> = (0..60).map(|i| uniform(sides.len(), 70, 8000 + i)).collect();
        let ensemble = ensemble_in(&torus, &sets);
        let settings = PairSettings { beyond_half: true, ..Correction::None.into() };
        let bins = RadialBins::linear(torus.half_diagonal(), 24).unwrap();
        let plan = PairPlan::new(&torus, bins, settings, shape(&ensemble)).unwrap();
        let sums = reference_counts(&plan, &ensemble);
        assert_eq!(sums.counts.iter().sum::<u64>(), 60 * 70 * 69, "no pair is further apart");
        let g = PairCorrelation::new(&plan, &sums, Normalization::Pairs);
        let known = (0..24).filter(|&b| g.count[b] > 200);
        assert_standard(&format!("torus {sides:?}"), &known.map(|b| (g.g[b] - 1.0) / g.g_se[b]).collect::<Vec<_>>());
    }
}

#[test]
fn k_and_its_errors() {
    let sets: Vec<_> = (0..7).map(|i| uniform(2, 50, i)).collect();
    let e = ensemble(&sets);
    let settings = PairSettings { cumulative: true, ..Correction::None.into() };
    let plan = PairPlan::new(e.domain(), RadialBins::linear(0.5, 10).unwrap(), settings, shape(&e)).unwrap();
    let k = KFunction::new(&plan, &reference_counts(&plan, &e), Normalization::Pairs, 50.0).unwrap();
    assert_eq!(k.errors, ErrorSource::AcrossRealizations);
    for b in 0..10 {
        let each: Vec<f64> = (0..7)
            .map(|i| {
                reference_counts(&plan, &e.slice(i..i + 1)).counts[..=b].iter().sum::<u64>() as f64 / (50.0 * 49.0)
            })
            .collect();
        let mean = each.iter().sum::<f64>() / 7.0;
        let se = (each.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 42.0).sqrt();
        assert!((k.k[b] - mean).abs() < 1e-12 && (k.k_se[b] - se).abs() < 1e-12, "K({}) = {}", k.r[b], k.k[b]);
        assert!((k.neighbors[b] - 50.0 * mean).abs() < 1e-12, "lambda K");
        assert!((k.l[b].powi(2) * std::f64::consts::PI - mean).abs() < 1e-12, "L = sqrt(K / pi)");
    }
    // One realization: unordered pairs are Poisson.
    let one = KFunction::new(&plan, &reference_counts(&plan, &e.slice(0..1)), Normalization::Intensity, 50.0).unwrap();
    let closer = reference_counts(&plan, &e.slice(0..1)).counts.iter().sum::<u64>() as f64;
    assert_eq!(one.errors, ErrorSource::Theory);
    assert!((one.k[9] - closer / 2500.0).abs() < 1e-12);
    assert!((one.k_se[9] - (2.0 * closer).sqrt() / 2500.0).abs() < 1e-12);
    let no_k = pair_plan(&e, RadialBins::linear(0.5, 10).unwrap(), Correction::None);
    assert_eq!(KFunction::new(&no_k, &reference_counts(&no_k, &e), Normalization::Pairs, 50.0), None);
}

/// Pairs within two classes and between them, realization by realization.
fn cross_counts(plan: &PairPlan, ensemble: &Ensemble) -> CrossCounts {
    let [both, a, b] = [&[0, 1][..], &[0], &[1]].map(|classes| ensemble.of_classes(classes));
    let mut between = PairCounts::new(tag(), plan);
    for k in 0..ensemble.realizations() {
        let one = |set: &Ensemble| reference_counts(plan, &set.slice(k..k + 1));
        between.add_between(&one(&both), &one(&a), &one(&b));
    }
    CrossCounts { a: reference_counts(plan, &a), b: reference_counts(plan, &b), between }
}

/// g between two classes against a loop over the pairs of a point of each; a third class is left out.
#[test]
fn g_between_classes_is_its_definition() {
    let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    let sets: Vec<_> = (0..6).map(|i| uniform(2, 60, 400 + i)).collect();
    for (domain, correction) in [
        (Domain::unit_torus(2), Correction::None),
        (window.clone(), Correction::Translation),
        (window.clone(), Correction::None),
        (window, Correction::Border),
    ] {
        let classes: Vec<u32> = (0..360).map(|j| j % 3).collect();
        let e = ensemble_in(&domain, &sets).with_classes(classes);
        let plan = pair_plan(&e, RadialBins::linear(0.4, 4).unwrap(), correction);
        let names = ["oak".to_string(), "elm".to_string()];
        let cross = CrossCorrelation::new(names, &plan, &cross_counts(&plan, &e), Normalization::Pairs);
        let sides = domain.sides();
        for b in 0..4 {
            let (lo, hi) = (plan.bins.edges()[b], plan.bins.edges()[b + 1]);
            // Sums over realizations of weights from A to B and back, of pairs from A to B, of what is expected.
            let (mut sum, mut count, mut norm) = (0.0, 0, 0.0);
            let mut each = Vec::new();
            for k in 0..6 {
                let at: Vec<Vec<f64>> = (0..60).map(|j| e.position(k, j)).collect();
                let deep =
                    |j: usize| (0..2).map(|a| at[j][a].min(sides[a] - at[j][a])).fold(f64::INFINITY, f64::min) >= hi;
                let (mut s, mut m) = (0.0, 0.0);
                for i in (0..60).filter(|i| i % 3 < 2) {
                    for j in (0..60).filter(|j| j % 3 == 1 - i % 3) {
                        let (mut d2, mut weight) = (0.0, 1.0);
                        for a in 0..2 {
                            let mut d = (at[i][a] - at[j][a]).abs();
                            if domain.is_torus() {
                                d = d.min(sides[a] - d);
                            } else if correction == Correction::Translation {
                                weight *= sides[a] / (sides[a] - d);
                            }
                            d2 += d * d;
                        }
                        let seen = correction != Correction::Border || deep(i);
                        m += f64::from(u8::from(seen));
                        if (lo..hi).contains(&d2.sqrt()) {
                            count += usize::from(i % 3 == 0);
                            s += if seen { weight } else { 0.0 };
                        }
                    }
                }
                sum += s;
                norm += m;
                each.push((s, m));
            }
            let expected = norm * std::f64::consts::PI * (hi * hi - lo * lo) / domain.measure();
            let g = &cross.between;
            assert_eq!(g.count[b], count as u64, "{correction}, bin {b}");
            assert!((g.g[b] - sum / expected).abs() < 1e-8, "{correction}, bin {b}: {} not {}", g.g[b], sum / expected);
            let residuals: f64 = each.iter().map(|(s, m)| (s - sum / norm * m).powi(2)).sum();
            let se = (6.0 / 5.0 * residuals).sqrt() / expected;
            assert!((g.g_se[b] - se).abs() < 1e-4 * se, "{correction}, bin {b}: {} not {se}", g.g_se[b]);
        }
        let alone = reference_counts(&plan, &e.of_classes(&[1]));
        assert_eq!(cross.b, PairCorrelation::new(&plan, &alone, Normalization::Pairs));
    }
}

/// Equal weights are no weights.
#[test]
fn equal_weights_change_nothing() {
    let e = ensemble(&[uniform(2, 80, 5), uniform(2, 70, 6)]);
    let weighted = e.clone().with_weights(&[0.3; 150]);
    let g = |e: &Ensemble, masses| {
        let settings = PairSettings { masses, ..Correction::None.into() };
        let plan = PairPlan::new(e.domain(), RadialBins::linear(0.5, 8).unwrap(), settings, shape(e)).unwrap();
        PairCorrelation::new(&plan, &reference_counts(&plan, e), Normalization::Pairs)
    };
    let (plain, weighted) = (g(&e, false), g(&weighted, true));
    for b in 0..8 {
        assert!((plain.g[b] / weighted.g[b] - 1.0).abs() < 1e-8 && (plain.g_se[b] - weighted.g_se[b]).abs() < 1e-4);
    }
}
