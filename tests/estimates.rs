//! Raw sums -> numbers with errors, against plain formulas written out here. Trusts the reference's raw sums.

mod common;

use common::*;
use pairwave::accumulate::{Backend, ComputedBy};
use pairwave::accumulate::{CrossCounts, LagCounts, PairCounts, PairHistogram, WavePower};
use pairwave::compute::{Compute, binned_kernel_sums, cpu::Cpu, reference::Reference};
use pairwave::control::Control;
use pairwave::estimate::{
    AmplitudeCovariance, CrossCorrelation, CrossValidation, Curve, Envelope, ErrorSource, KFunction, KernelEstimate,
    Normalization, PairCorrelation, PowerSpectrum, RadialSpectrum, VectorCorrelation,
};
use pairwave::plan::{
    Accuracy, Bandwidth, BandwidthSearch, BinScale, Correction, CovariancePlan, Divisor, EnsembleShape, Kernel,
    KernelMethod, KernelPlan, PairPlan, PairSettings, RadialBins, Rings, SmoothingKernel, WaveGrid,
};
use pairwave::points::{Domain, Ensemble, RawPoints};
use pairwave::samplers::{ParameterValues, find};

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
    assert_eq!(spectrum.dc(), Some((40.0, 0.0)));
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
    assert_eq!(spectrum.dc().unwrap().0, (30.0 * 30.0 + 60.0 * 60.0) / 90.0, "P(0) = sum n^2 / sum n");
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
    for i in 0..plan.waves.len() {
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
                    members.push(plan.waves.grid().unwrap().half_index([a, b, 0]));
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
        let half: Vec<f64> = independent
            .iter()
            .filter(|&&i| plan.waves.grid().unwrap().mode(i) > [0, 0, 0])
            .map(|&i| spectrum.p[i])
            .collect();
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
    let rings = Rings::new(&grid.into(), &domain);
    let mut rng = Rng(5);
    let mut power = WavePower::new(tag(), grid.half_len(), &rings);
    let k = 10;
    for index in 0..k {
        let mut q: Vec<f64> = (0..grid.half_len()).map(|_| -100.0 * (1.0 - rng.unit()).ln()).collect();
        // The plane m_0 = 0 holds mirror images.
        for i in 0..grid.dc() {
            q[i] = q[2 * grid.dc() - i];
        }
        power.add(index, 100.0, &q, &rings);
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
    let rings = Rings::new(&grid.into(), &torus);
    // The next mode along y outside the grid is m_y = 5 at nu = 5, ring 10 (in units of 1/2): rings to 9 are whole.
    assert_eq!((rings.count, rings.fundamental), (9, 0.5));
    assert_eq!(WaveGrid::default_max_frequency(4096.0, &Domain::unit_torus(2)), [320, 320]);
    assert_eq!(WaveGrid::default_max_frequency(1000.0, &Domain::unit_torus(3)), [50, 50, 50]);
}

/// g at `r` from the kernel sum over all pairs, by the formula, on f64 coordinates.
fn exact_kernel_sum(points: &RawPoints, domain: &Domain, kernel: Kernel, divisor: Divisor, r: f64) -> f64 {
    let (n, dim, sides, bw) = (points.len(), domain.dim(), domain.sides(), kernel.bandwidth);
    let surface = |r: f64| [2.0, std::f64::consts::TAU * r, 2.0 * std::f64::consts::TAU * r * r][dim - 1];
    let mut sum = 0.0;
    for i in 0..n {
        for j in (0..n).filter(|&j| j != i) {
            let (mut d2, mut weight) = (0.0, 1.0);
            for (a, side) in sides.iter().enumerate() {
                let mut d = (points.coordinates[dim * i + a] - points.coordinates[dim * j + a]).abs();
                if domain.is_torus() {
                    d = d.min(side - d);
                } else {
                    weight *= side / (side - d);
                }
                d2 += d * d;
            }
            let x = (r - d2.sqrt()) / bw;
            let k = match kernel.shape {
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
            sum += weight * k / bw / if divisor == Divisor::D { surface(d2.sqrt()) } else { surface(r) };
        }
    }
    domain.measure() * sum / (n * (n - 1)) as f64
}

const SHAPES: [SmoothingKernel; 3] = [SmoothingKernel::Epanechnikov, SmoothingKernel::Gaussian, SmoothingKernel::Box];

/// Domains with their edge correction.
fn kernel_domains(dim: usize) -> [(Domain, Correction); 2] {
    let window = Domain::window(&[(0.0, 1.0), (0.0, 2.0), (0.0, 1.5)][..dim]).unwrap();
    [(Domain::torus(&[1.0, 0.8, 0.9][..dim]).unwrap(), Correction::None), (window, Correction::Translation)]
}

fn stretched(points: RawPoints, domain: &Domain) -> RawPoints {
    let dim = domain.dim();
    raw(dim, points.coordinates.iter().enumerate().map(|(i, x)| x * domain.sides()[i % dim]).collect())
}

/// A kernel plan for an ensemble; `mean_points` decides the method.
fn kernel_plan(
    e: &Ensemble,
    kernel: Kernel,
    divisor: Divisor,
    r: &[f64],
    correction: Correction,
    n: f64,
) -> KernelPlan {
    let shape = EnsembleShape { mean_points: n, ..shape(e) };
    KernelPlan::new(kernel, divisor, r.to_vec(), false, e.domain(), correction, shape).unwrap()
}

fn cpu() -> Cpu {
    Cpu::new(Some(2)).unwrap()
}

fn direct(device: &dyn Compute, plan: &KernelPlan, e: &Ensemble) -> KernelEstimate {
    assert_eq!(plan.method, KernelMethod::Direct);
    let sums = wait(device.kernel_sums(plan, e, &Control::default())).unwrap();
    KernelEstimate::new(plan, &sums, Normalization::Pairs)
}

/// The largest difference of two estimates, in units of max(1, max g); both are defined at the same r.
fn apart(a: &KernelEstimate, b: &[Option<f64>]) -> f64 {
    let scale = b.iter().flatten().fold(1.0, |m: f64, &g| m.max(g));
    assert!(a.g.iter().zip(b).all(|(a, b)| a.is_some() == b.is_some()));
    let differences = a.g.iter().zip(b).filter_map(|(a, b)| Some((a.as_ref()? - b.as_ref()?).abs()));
    // Written so that NaN is seen.
    differences.fold(0.0, |w: f64, d| if d <= w { w } else { d }) / scale
}

#[test]
fn direct_kernel_sums_are_the_formula() {
    for dim in 1..=3 {
        for (domain, correction) in kernel_domains(dim) {
            let points = stretched(uniform(dim, 150, 77), &domain);
            let e = Ensemble::from_raw(std::slice::from_ref(&points), &domain, false, 0).unwrap();
            let r: Vec<f64> = (1..=40).map(|i| f64::from(i) * 0.00741).collect();
            for (shape, divisor) in SHAPES.into_iter().flat_map(|s| [(s, Divisor::R), (s, Divisor::D)]) {
                let kernel = Kernel { shape, bandwidth: 0.012 };
                let plan = kernel_plan(&e, kernel, divisor, &r, correction, 150.0);
                let formula: Vec<_> =
                    r.iter().map(|&r| Some(exact_kernel_sum(&points, &domain, kernel, divisor, r))).collect();
                for device in [&Reference as &dyn Compute, &cpu()] {
                    let g = direct(device, &plan, &e);
                    let worst = apart(&g, &formula);
                    assert!(worst < 1e-9, "{dim}D {shape:?} {divisor:?} {:?}: {worst:e}", domain.boundary());
                    assert_eq!((g.bound, g.errors), (0.0, ErrorSource::Theory));
                }
            }
        }
    }
}

/// Sizes around blocks, several realizations, r that are not evenly spaced, and every number of threads.
#[test]
fn the_fast_direct_sum_is_the_reference() {
    for (dim, divisor) in [(1, Divisor::R), (2, Divisor::D), (2, Divisor::R), (3, Divisor::R)] {
        for (domain, correction) in kernel_domains(dim) {
            let sets = [0, 1, 2, 31, 32, 33, 700].map(|n| uniform(dim, n, n as u64));
            let sets = sets.into_iter().chain([clustered(dim, 300, 4), lattice(dim, 7)]);
            let e = ensemble_in(&domain, &sets.collect::<Vec<_>>());
            let kernel = Kernel { shape: SmoothingKernel::Gaussian, bandwidth: 0.011 };
            for r in [RadialBins::linear(0.3, 50).unwrap(), RadialBins::logarithmic(1e-3, 0.5, 30).unwrap()] {
                let plan = kernel_plan(&e, kernel, divisor, &r.centres(), correction, 100.0);
                let truth = direct(&Reference, &plan, &e);
                let fast = direct(&cpu(), &plan, &e);
                assert!(apart(&fast, &truth.g) < 1e-13 && truth.errors == ErrorSource::AcrossRealizations);
                let scale = truth.g_se.iter().flatten().fold(0.0, |m: f64, &s| m.max(s));
                for (a, b) in fast.g_se.iter().zip(&truth.g_se) {
                    assert!((a.unwrap_or(0.0) - b.unwrap_or(0.0)).abs() <= 1e-7 * scale, "{a:?} against {b:?}");
                }
                let sums = |threads, e: &Ensemble| {
                    wait(Cpu::new(Some(threads)).unwrap().kernel_sums(&plan, e, &Control::default())).unwrap()
                };
                let (one, three) = (sums(1, &e), sums(3, &e));
                assert_eq!(one.totals(), three.totals(), "bit for bit");
                assert_eq!(one.coincident, three.coincident);
            }
        }
    }
}

/// Isotropic weights, and points with weights: both backends, both methods, and equal weights as if there were none.
#[test]
fn kernel_sums_of_every_weight() {
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.5)]).unwrap();
    let plain = ensemble_in(&window, &[uniform(2, 300, 1), clustered(2, 90, 2), uniform(2, 1, 3)]);
    let mut rng = Rng(5);
    let random: Vec<f64> = (0..plain.total_points()).map(|_| rng.unit()).collect();
    let kernel = Kernel { shape: SmoothingKernel::Epanechnikov, bandwidth: 0.02 };
    let r: Vec<f64> = (1..=60).map(|i| f64::from(i) * 0.01).collect();
    let of = |e: &Ensemble, masses: bool, correction: Correction| {
        let settings = PairSettings { masses, ..correction.into() };
        let plan = KernelPlan::new(kernel, Divisor::R, r.clone(), false, &window, settings, shape(e)).unwrap();
        let truth = direct(&Reference, &plan, e);
        let fast = direct(&cpu(), &plan, e);
        assert!(apart(&fast, &truth.g) < 1e-13 && apart(&fast, &truth.g) >= 0.0, "{correction}");
        let errors = |g: &KernelEstimate| g.g_se.iter().flatten().sum::<f64>();
        assert!((errors(&fast) / errors(&truth) - 1.0).abs() < 1e-9);
        truth.g
    };
    for correction in [Correction::None, Correction::Translation, Correction::Isotropic] {
        let unweighted = of(&plain, false, correction);
        let equal = of(&plain.clone().with_weights(&vec![2.5; random.len()]), true, correction);
        let weighted = of(&plain.clone().with_weights(&random), true, correction);
        let worst = |a: &[Option<f64>]| {
            let differences = a.iter().zip(&unweighted).map(|(a, b)| (a.unwrap() - b.unwrap()).abs());
            differences.fold(0.0, f64::max)
        };
        assert!(worst(&equal) < 1e-6, "{correction}: equal weights cancel");
        assert!(worst(&weighted) > 1e-3, "{correction}: unequal ones do not");
    }
    // A uniform pattern whose edges are corrected has g = 1.
    let many = ensemble_in(&window, &(0..30).map(|i| uniform(2, 300, 50 + i)).collect::<Vec<_>>());
    let plan = kernel_plan(&many, kernel, Divisor::R, &[0.1, 0.3, 0.6], Correction::Isotropic, 300.0);
    let g = direct(&cpu(), &plan, &many);
    for (g, se) in g.g.iter().flatten().zip(g.g_se.iter().flatten()) {
        assert!((g - 1.0).abs() < 4.0 * se && *se < 0.1, "{g} +- {se}");
    }
}

#[test]
fn a_cut_batch_gives_the_same_kernel_sums() {
    let sets: Vec<_> = (0..40).map(|i| uniform(2, 30 + i as usize, i)).collect();
    let e = ensemble(&sets);
    let kernel = Kernel { shape: SmoothingKernel::Epanechnikov, bandwidth: 0.02 };
    let plan = kernel_plan(&e, kernel, Divisor::R, &[0.1, 0.2, 0.3], Correction::None, 50.0);
    let sums =
        |range: std::ops::Range<usize>| wait(cpu().kernel_sums(&plan, &e.slice(range), &Control::default())).unwrap();
    let whole = sums(0..40);
    let mut parts = sums(0..16);
    parts.merge(sums(16..40)).unwrap();
    assert_eq!(parts, whole);
    assert!(parts.merge(sums(16..40)).is_err(), "the same realizations twice");
}

/// Fine bins are within their own bound of the direct sum, and the smooth kernels within 1e-5.
#[test]
fn binned_kernel_sums_keep_their_bound() {
    for (domain, correction) in kernel_domains(2) {
        let e = Ensemble::from_raw(&[stretched(uniform(2, 400, 77), &domain)], &domain, false, 0).unwrap();
        let r: Vec<f64> = (0..=60).map(|i| f64::from(i) * 0.005).collect();
        for shape in SHAPES {
            let kernel = Kernel { shape, bandwidth: 0.01 };
            let many = kernel_plan(&e, kernel, Divisor::R, &r, correction, 1e7);
            assert_eq!((many.method, many.pairs.bins.scale()), (KernelMethod::Binned, BinScale::Linear));
            let binned = wait(binned_kernel_sums(&Reference, cpu().pool(), &many, &e, &Control::default())).unwrap();
            let binned = KernelEstimate::new(&many, &binned, Normalization::Pairs);
            let exact = direct(&cpu(), &kernel_plan(&e, kernel, Divisor::R, &r, correction, 400.0), &e);
            assert_eq!(binned.g[0], None, "r = 0 is undefined");
            let scale = exact.g.iter().flatten().fold(1.0, |m: f64, &g| m.max(g));
            let worst = apart(&binned, &exact.g);
            println!("{shape:?}, {:?}: off by {worst:.1e}, bound {:.1e}", domain.boundary(), binned.bound / scale);
            assert!(0.0 < worst && worst <= binned.bound / scale, "{shape:?}: off by {worst:e}");
            // The box kernel jumps: a pair at a jump is in or out.
            assert!(binned.bound < if shape == SmoothingKernel::Box { 0.1 } else { 1e-2 } * scale);
            assert!(worst <= if shape == SmoothingKernel::Box { 5e-2 } else { 1e-5 });
            for (a, b) in binned.g_se.iter().zip(&exact.g_se) {
                assert!((a.unwrap_or(0.0) - b.unwrap_or(0.0)).abs() <= 0.02 * scale, "{a:?} against {b:?}");
            }
        }
    }
}

#[test]
fn the_method_is_the_affordable_one() {
    let e = ensemble(&[uniform(2, 9, 1)]);
    let plan = |divisor, bandwidth, n, exact| {
        let kernel = Kernel { shape: SmoothingKernel::Gaussian, bandwidth };
        let shape = EnsembleShape { mean_points: n, max_points: n as u64, realizations: 1 };
        KernelPlan::new(kernel, divisor, vec![0.1, 0.2], exact, e.domain(), Correction::None, shape).unwrap().method
    };
    assert_eq!(plan(Divisor::R, 0.01, 1e4, false), KernelMethod::Direct);
    assert_eq!(plan(Divisor::R, 0.01, 1e7, false), KernelMethod::Binned);
    assert_eq!(plan(Divisor::R, 0.01, 1e7, true), KernelMethod::Direct, "asked for");
    assert_eq!(plan(Divisor::D, 0.01, 1e7, false), KernelMethod::Direct, "1 / S(d) is not even over a bin at 0");
    assert_eq!(plan(Divisor::R, 1e-6, 1e7, false), KernelMethod::Direct, "bins would be too coarse");
}

#[test]
fn kernel_errors_across_realizations() {
    let sets: Vec<_> = (0..7).map(|i| uniform(2, 50, i)).collect();
    let e = ensemble(&sets);
    let kernel = Kernel { shape: SmoothingKernel::Epanechnikov, bandwidth: 0.02 };
    let plan = kernel_plan(&e, kernel, Divisor::R, &[0.05, 0.1, 0.3], Correction::None, 50.0);
    let g = direct(&cpu(), &plan, &e);
    let each: Vec<_> = (0..7).map(|k| direct(&cpu(), &plan, &e.slice(k..k + 1))).collect();
    for k in 0..3 {
        let values: Vec<f64> = each.iter().map(|one| one.g[k].unwrap()).collect();
        let mean = values.iter().sum::<f64>() / 7.0;
        let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 6.0;
        assert!((g.g[k].unwrap() - mean).abs() < 1e-12);
        assert!((g.g_se[k].unwrap() - (variance / 7.0).sqrt()).abs() < 1e-7 * mean);
    }
    // Theory, for one: the same order of magnitude as what is seen between seven.
    let theory = each[0].g_se[2].unwrap() / 7f64.sqrt();
    assert!((0.4..2.5).contains(&(theory / g.g_se[2].unwrap())), "{theory} against {:?}", g.g_se[2]);
}

#[test]
fn a_kernel_that_reaches_past_half_the_box_is_undefined_there() {
    let e = ensemble(&[uniform(2, 100, 1)]);
    let kernel = Kernel { shape: SmoothingKernel::Box, bandwidth: 0.02 };
    let plan = kernel_plan(&e, kernel, Divisor::R, &[0.4, 0.46, 0.47, 0.5], Correction::None, 100.0);
    let g = direct(&Reference, &plan, &e);
    assert_eq!(g.g.iter().map(Option::is_some).collect::<Vec<_>>(), [true, true, false, false]);
}

#[test]
fn coincident_points_are_left_out_where_d_divides() {
    let e = ensemble(&[raw(2, vec![0.25, 0.25, 0.25, 0.25, 0.3, 0.25])]);
    let kernel = Kernel { shape: SmoothingKernel::Epanechnikov, bandwidth: 0.04 };
    for device in [&Reference as &dyn Compute, &cpu()] {
        for (divisor, left_out) in [(Divisor::D, 2), (Divisor::R, 0)] {
            let plan = kernel_plan(&e, kernel, divisor, &[0.01, 0.05], Correction::None, 3.0);
            let sums = wait(device.kernel_sums(&plan, &e, &Control::default())).unwrap();
            assert_eq!(sums.coincident, left_out, "ordered pairs");
            assert!(KernelEstimate::new(&plan, &sums, Normalization::Pairs).g.iter().all(|g| g.unwrap().is_finite()));
        }
    }
}

#[test]
fn rules_of_bandwidth() {
    let domain = Domain::torus(&[2.0, 3.0]).unwrap();
    let stoyan = Bandwidth::Stoyan.value(&domain, 24.0);
    assert!((stoyan - 0.15 / 5f64.sqrt() * 0.5).abs() < 1e-15, "half-width 0.15 / sqrt(lambda), lambda = 4");
    assert!((Bandwidth::Fiksel.value(&domain, 24.0) - 0.05).abs() < 1e-15);
    let typed = |text: &str| text.parse::<Bandwidth>().unwrap();
    assert_eq!(
        [typed("0.25"), typed("fiksel"), typed("lscv")],
        [Bandwidth::Given(0.25), Bandwidth::Fiksel, Bandwidth::Lscv]
    );
}

fn search(e: &Ensemble, shape_: SmoothingKernel, r: [f64; 2]) -> (BandwidthSearch, PairCounts) {
    let search = BandwidthSearch::new(shape_, r, e.domain(), Correction::None, shape(e)).unwrap();
    let counts = wait(cpu().pair_counts(&search.pairs, e, &Control::default())).unwrap();
    (search, counts)
}

/// Guan's score, pair by pair.
fn brute_force_score(e: &Ensemble, kernel: Kernel, divisor: Divisor, [from, to]: [f64; 2]) -> f64 {
    let surface = |r: f64| std::f64::consts::TAU * r;
    let (mut distances, mut norm) = (Vec::new(), 0.0);
    for k in 0..e.realizations() {
        let (axes, n) = (e.fractions(k), e.points_in(k));
        norm += (n * (n - 1)) as f64;
        for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let along = |x: &&[u64]| (x[i].wrapping_sub(x[j]) as i64 as f64 * 2f64.powi(-64)).powi(2);
            distances.push(axes.iter().map(along).sum::<f64>().sqrt());
        }
    }
    // Both orders of every pair but `without`.
    let g = |r: f64, without: Option<usize>| {
        let pairs = distances.iter().enumerate().filter(|(p, _)| Some(*p) != without);
        let divided = |d: f64| if divisor == Divisor::D { surface(d) } else { surface(r) };
        pairs.map(|(_, &d)| 2.0 * kernel.value(r - d) / divided(d)).sum::<f64>() / norm
    };
    let steps = 4000;
    let step = (to - from) / f64::from(steps);
    let integral: f64 =
        (0..steps).map(|i| from + step * (f64::from(i) + 0.5)).map(|r| g(r, None).powi(2) * surface(r) * step).sum();
    let inside = distances.iter().enumerate().filter(|(_, d)| (from..=to).contains(*d));
    integral - 2.0 * inside.map(|(p, &d)| 2.0 * g(d, Some(p))).sum::<f64>() / norm
}

#[test]
fn the_score_of_cross_validation_is_guans() {
    let cases = [
        (clustered(2, 30, 1), SmoothingKernel::Epanechnikov, Divisor::R),
        // Pairs nearer than a bin would be divided by the surface at its centre.
        (uniform(2, 30, 1), SmoothingKernel::Gaussian, Divisor::D),
    ];
    for (points, shape, divisor) in cases {
        let e = ensemble(&[points, uniform(2, 25, 2)]);
        let (search, counts) = search(&e, shape, [0.01, 0.3]);
        let [lo, hi] = search.range;
        for bandwidth in [lo, (lo * hi).sqrt(), hi] {
            let ours = CrossValidation::score(&search, &counts, divisor, Normalization::Pairs, bandwidth);
            let truth = brute_force_score(&e, Kernel { shape, bandwidth }, divisor, search.distances);
            assert!((ours - truth).abs() < 0.01 * truth.abs(), "{shape:?}, {bandwidth}: {ours} against {truth}");
        }
        let found = CrossValidation::new(&search, &counts, divisor, Normalization::Pairs);
        let scores = (0..=40).map(|k| lo * (hi / lo).powf(f64::from(k) / 40.0));
        let scores = scores.map(|b| CrossValidation::score(&search, &counts, divisor, Normalization::Pairs, b));
        assert!(found.score <= scores.fold(f64::INFINITY, f64::min) + 1e-3 * found.score.abs(), "{found:?}");
    }
}

/// On clusters much wider than Stoyan's bandwidth, against the closed form.
#[test]
fn cross_validation_beats_the_rule_of_thumb() {
    let sampler = find("thomas").unwrap();
    let values = ParameterValues::parse(sampler, &["mu=10", "sigma=1"]).unwrap();
    let mut errors = [0.0; 2];
    for seed in 1..=4 {
        let e = pairwave::samplers::ensemble(sampler, 400, 2, seed, 0..4, &values, &Control::default()).unwrap();
        let r: Vec<f64> = (0..200).map(|k| 0.03 + 0.0011 * f64::from(k)).collect();
        let (search, counts) = search(&e, SmoothingKernel::Epanechnikov, [r[0], r[199]]);
        let found = CrossValidation::new(&search, &counts, Divisor::R, Normalization::Pairs);
        assert!(!found.at_end && search.distances == [r[0], r[199]], "{found:?}");
        let squared_error = |bandwidth: f64| {
            let kernel = Kernel { shape: SmoothingKernel::Epanechnikov, bandwidth };
            let g = direct(&cpu(), &kernel_plan(&e, kernel, Divisor::R, &r, Correction::None, 400.0), &e);
            let error = |(r, g): (&f64, &Option<f64>)| {
                (g.unwrap() - sampler.pair_correlation(400, 2, *r, &values).unwrap()).powi(2) * r
            };
            g.r.iter().zip(&g.g).map(error).sum::<f64>()
        };
        let (ours, stoyan) =
            (squared_error(found.bandwidth), squared_error(Bandwidth::Stoyan.value(e.domain(), 400.0)));
        println!("seed {seed}: bandwidth {:.4}, squared error {ours:.3e}, Stoyan {stoyan:.3e}", found.bandwidth);
        errors = [errors[0] + ours, errors[1] + stoyan];
    }
    assert!(errors[0] < 0.9 * errors[1], "{errors:?}");
}

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

#[test]
fn vector_g_and_its_error_across_realizations() {
    let e = ensemble(&(0..6).map(|i| uniform(2, 40, 70 + i)).collect::<Vec<_>>());
    let plan = lag_plan(&e, 5, Some(0.4), Correction::None);
    let g = VectorCorrelation::new(&plan, &reference_lags(&plan, &e), Normalization::Pairs);
    assert_eq!(g.errors, ErrorSource::AcrossRealizations);
    // Of a cell, and of sectors by the cells they name.
    let statistics = |cells: &[usize]| {
        let of = |k: usize| {
            let counts = reference_lags(&plan, &e.slice(k..k + 1)).cells.sums;
            let sum: u128 = cells.iter().map(|&c| counts[c]).sum();
            sum as f64 / (40.0 * 39.0 * 0.16 * 0.16 * cells.len() as f64)
        };
        let each: Vec<f64> = (0..6).map(of).collect();
        let mean = each.iter().sum::<f64>() / 6.0;
        (mean, (each.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 5.0 / 6.0).sqrt())
    };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-10 * (1.0 + b), "{a} against {b}");
    for c in 0..25 {
        let (mean, se) = statistics(&[c]);
        close(g.g[c], mean);
        close(g.g_se[c], se);
    }
    assert!(!g.sectors.is_empty());
    for (sector, plan) in g.sectors.iter().zip(&plan.sectors) {
        match sector.g {
            Some(value) => {
                let (mean, se) = statistics(&plan.cells.iter().map(|&c| c as usize).collect::<Vec<_>>());
                close(value, mean);
                close(sector.g_se.unwrap(), se);
            }
            None => assert!(plan.cells.is_empty()),
        }
    }
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

#[test]
fn vector_g_of_one_realization_gets_poisson_errors() {
    let e = ensemble(&[uniform(1, 50, 1)]);
    let plan = lag_plan(&e, 3, None, Correction::None);
    let mut counts = LagCounts::new(tag(), &plan);
    counts.add(&plan, &PairHistogram::new(50, vec![900, 0, 900], None));
    let g = VectorCorrelation::new(&plan, &counts, Normalization::Intensity);
    assert_eq!(g.errors, ErrorSource::Theory);
    let expected = 2500.0 / 3.0;
    assert!((g.g[0] - 900.0 / expected).abs() < 1e-12, "n^2");
    assert!((g.g_se[0] - 30.0 / expected).abs() < 1e-12, "each of 900 unordered pairs is once in this cell");
    assert!((g.g_se[1] - 2.0 / expected).abs() < 1e-12, "the middle cell gets one pair twice");
}

/// Pairs expected in a window are integrals of its set covariance: with as many pairs as expected g is 1 in every cell.
#[test]
fn translation_correction_is_the_integral_of_the_set_covariance() {
    let window = Domain::window(&[(0.0, 2.0), (1.0, 2.0)]).unwrap();
    let e = ensemble_in(&window, &(0..50).map(|i| uniform(2, 30, 400 + i)).collect::<Vec<_>>());
    for (bins, lag_max) in [(6, None), (7, None), (5, Some(0.8))] {
        let plan = lag_plan(&e, bins, lag_max, Correction::Translation);
        let mut counts = LagCounts::new(tag(), &plan);
        let n = 1_000_000u64;
        let gamma = |x: f64, y: f64| (2.0 - x.abs()).max(0.0) * (1.0 - y.abs()).max(0.0);
        let integral = |c: usize| {
            let steps = 64;
            let at = |axis: usize, s: usize| {
                plan.grid.centre(c, axis) + plan.grid.width(axis) * ((s as f64 + 0.5) / steps as f64 - 0.5)
            };
            let sum: f64 = (0..steps * steps).map(|s| gamma(at(0, s / steps), at(1, s % steps))).sum();
            sum / (steps * steps) as f64 * plan.grid.width(0) * plan.grid.width(1)
        };
        let pairs = (n * (n - 1)) as f64;
        let expected: Vec<u64> = (0..plan.grid.cells()).map(|c| (pairs * integral(c) / 4.0) as u64).collect();
        counts.add(&plan, &PairHistogram::new(n, expected, None));
        let g = VectorCorrelation::new(&plan, &counts, Normalization::Pairs);
        // The middle rule is exact but where the integrand bends.
        assert!(g.g.iter().all(|g| (g - 1.0).abs() < 1e-3), "{bins} bins: {:?}", g.g);
        assert!(g.sectors.iter().all(|s| s.g.is_none_or(|g| (g - 1.0).abs() < 1e-3)), "{:?}", g.sectors);
        // And independent points have it.
        let g = VectorCorrelation::new(&plan, &reference_lags(&plan, &e), Normalization::Pairs);
        let z: Vec<f64> =
            (0..plan.grid.cells() / 2).filter(|&c| g.count[c] > 50).map(|c| (g.g[c] - 1.0) / g.g_se[c]).collect();
        let mean_square = z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64;
        assert!((0.4..1.9).contains(&mean_square), "mean square {mean_square} of {} deviations", z.len());
        // Without correction long lags are missed.
        let plain = lag_plan(&e, bins, lag_max, Correction::None);
        let plain = VectorCorrelation::new(&plain, &reference_lags(&plain, &e), Normalization::Pairs);
        assert!(plain.g[0] < 0.5 * g.g[0] || g.g[0] == 0.0, "{} against {}", plain.g[0], g.g[0]);
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
        let closer: u64 = reference_counts(&plan, &e).counts[..=b].iter().sum();
        assert!((k.neighbors[b] - closer as f64 / 350.0).abs() < 1e-12, "ordered pairs per point");
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

/// The covariance of a sampler's amplitudes for |m_k| <= `b`, all points of a realization moved by a random shift if `shifted`.
fn covariance(name: &str, n: u64, k: u64, dim: usize, b: u32, shifted: bool) -> (Ensemble, AmplitudeCovariance) {
    let sampler = find(name).unwrap();
    let values = ParameterValues::parse(sampler, &[] as &[&str]).unwrap();
    let mut sets = Vec::new();
    for index in 0..k {
        let which = pairwave::samplers::Realization { n, dim, seed: 5, index };
        let mut coordinates = sampler.generate(&which, &values).unwrap();
        let shift = uniform(dim, 1, 1_000_000 + index).coordinates;
        for (j, x) in coordinates.iter_mut().enumerate().filter(|_| shifted) {
            *x = (*x + shift[j % dim]).fract();
        }
        sets.push(raw(dim, coordinates));
    }
    let ensemble = ensemble(&sets);
    let plan = CovariancePlan::new(ensemble.domain(), Some(b), shape(&ensemble)).unwrap();
    let sums = wait(Cpu::new(Some(2)).unwrap().wave_covariance(&plan, &ensemble, &Control::default())).unwrap();
    (ensemble, AmplitudeCovariance::new(&plan, &sums))
}

/// The mode at an index of the matrix, in 2D.
fn mode_2d(index: usize, b: u32) -> [i32; 3] {
    let (b, side) = (b as i32, 2 * b as i32 + 1);
    [index as i32 / side - b, index as i32 % side - b, 0]
}

/// Every element by its definition, with its error; Hermitian; P on the diagonal.
#[test]
fn covariance_by_its_definition() {
    let sets: Vec<_> = (0..6).map(|k| uniform(2, 10 + k as usize % 2, k)).collect();
    let ensemble = ensemble(&sets);
    let plan = CovariancePlan::new(ensemble.domain(), Some(2), shape(&ensemble)).unwrap();
    let sums = wait(Reference.wave_covariance(&plan, &ensemble, &Control::default())).unwrap();
    let found = AmplitudeCovariance::new(&plan, &sums);
    let amplitude = |k: usize, m: [i32; 3]| {
        sets[k].coordinates.chunks_exact(2).fold([0.0, 0.0], |[re, im], x| {
            let phase = -std::f64::consts::TAU * (f64::from(m[0]) * x[0] + f64::from(m[1]) * x[1]);
            [re + phase.cos(), im + phase.sin()]
        })
    };
    let norm = |k: usize| (10 + k % 2) as f64;
    let total: f64 = (0..6).map(norm).sum();
    for (m, l) in [(0, 0), (3, 20), (20, 3), (12, 12), (12, 7), (24, 0), (13, 11), (5, 6), (18, 22)] {
        let products: Vec<[f64; 2]> = (0..6)
            .map(|k| {
                let ([a, b], [c, d]) = (amplitude(k, mode_2d(m, 2)), amplitude(k, mode_2d(l, 2)));
                [a * c + b * d, b * c - a * d]
            })
            .collect();
        let mean = [0, 1].map(|part| products.iter().map(|p| p[part]).sum::<f64>() / total);
        let residuals: f64 = (0..6)
            .map(|k| [0, 1].map(|part| (products[k][part] - mean[part] * norm(k)).powi(2)).iter().sum::<f64>())
            .sum();
        let at = m * 25 + l;
        assert!(
            (0..2).all(|part| (found.c[at][part] - mean[part]).abs() < 1e-12),
            "{m} {l}: {:?} {mean:?}",
            found.c[at]
        );
        let se = (6.0 / 5.0 * residuals).sqrt() / total;
        assert!((found.c_se.as_ref().unwrap()[at] - se).abs() < 1e-7, "{m} {l}: {se}");
        let mirrored = found.c[l * 25 + m];
        assert_eq!([mirrored[0], -mirrored[1]].map(|x| x + 0.0), found.c[at].map(|x| x + 0.0));
    }
    let plan = wave_plan(&ensemble, &[2, 2], Accuracy::High);
    let spectrum = PowerSpectrum::new(&plan, &reference_power(&plan, &ensemble));
    for m in 0..25 {
        let p = spectrum.at(mode_2d(m, 2)).unwrap();
        assert!((found.c[m * 26][0] - p).abs() < 1e-12 * (1.0 + p) && found.c[m * 26][1] == 0.0);
    }
}

/// Randomly shifted sets have none off the diagonal: as many standard errors as chance gives.
#[test]
fn shifted_sets_have_uncorrelated_amplitudes() {
    let (_, found) = covariance("jittered", 16, 2000, 2, 4, true);
    let s = found.scalars;
    let (rms, largest) = (s.rms_z.unwrap(), s.largest_z.unwrap());
    assert!((0.95..1.05).contains(&rms) && largest < 5.5, "{s:?}");
    assert!((s.off_diagonal_share / s.off_diagonal_share_by_chance.unwrap() - 1.0).abs() < 0.1, "{s:?}");
}

/// Jittered sets that stay where they are: strata are independent, a point of stratum j is at (j + u) / k. With
/// `f(m) = E exp(-2 pi i m . u / k)`,
/// `E[s_m conj(s_l)] = S_m f(m) conj(S_l f(l)) + [m = l mod k] n (f(m - l) - f(m) conj(f(l)))`, where S is n at multiples of k
/// and 0 elsewhere.
#[test]
fn jittered_sets_in_place_are_correlated() {
    let (k, b, n) = (4.0, 4, 16.0);
    let (_, found) = covariance("jittered", 16, 2000, 2, b, false);
    let multiply = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
    let f = |m: [i32; 3]| {
        m.into_iter().fold([1.0, 0.0], |product, m| {
            let x = std::f64::consts::PI * f64::from(m) / k;
            let sinc = if m == 0 { 1.0 } else { x.sin() / x };
            multiply(product, [sinc * x.cos(), -sinc * x.sin()])
        })
    };
    let periodic = |m: [i32; 3]| m.iter().all(|&m| f64::from(m) % k == 0.0);
    let conj = |[re, im]: [f64; 2]| [re, -im];
    let (modes, mut seen, mut squares, mut count) = (found.modes(), 0, 0.0, 0);
    for m in 0..modes {
        for l in 0..modes {
            let (vm, vl) = (mode_2d(m, b), mode_2d(l, b));
            let difference = std::array::from_fn(|a| vm[a] - vl[a]);
            let [fm, fl, fd] = [f(vm), f(vl), f(difference)];
            let product = multiply(fm, conj(fl));
            let coherent = if periodic(vm) && periodic(vl) { n } else { 0.0 };
            let strata = if periodic(difference) { 1.0 } else { 0.0 };
            let expected: [f64; 2] = [0, 1].map(|p| coherent * product[p] + strata * (fd[p] - product[p]));
            let (c, se) = (found.c[m * modes + l], found.c_se.as_ref().unwrap()[m * modes + l]);
            let off = (c[0] - expected[0]).hypot(c[1] - expected[1]);
            assert!(off <= 6.0 * se + 1e-9, "{vm:?} {vl:?}: {c:?}, expected {expected:?}, error {se}");
            if se > 1e-9 {
                (squares, count) = (squares + (off / se).powi(2), count + 1);
            }
            if m != l && expected[0].hypot(expected[1]) > 10.0 * se {
                seen += 1;
            }
        }
    }
    assert!((0.9..1.1).contains(&(squares / f64::from(count)).sqrt()), "{}", squares / f64::from(count));
    assert!(seen >= 30 && found.scalars.largest_z.unwrap() > 10.0, "{seen}");
}

/// A single realization has no expectation, and no error of it.
#[test]
fn one_realization_has_no_covariance_errors() {
    let (_, found) = covariance("jittered", 16, 1, 2, 2, false);
    assert!(found.c_se.is_none() && found.scalars.rms_z.is_none() && found.scalars.largest_z.is_none());
    let error = CovariancePlan::new(
        &Domain::unit_torus(2),
        Some(1000),
        EnsembleShape { realizations: 1, mean_points: 1.0, max_points: 1 },
    );
    assert!(error.unwrap_err().to_string().contains("bytes"));
}
