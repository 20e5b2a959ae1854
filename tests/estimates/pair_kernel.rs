//! Raw sums -> kernel estimates of g, directly and from counts in fine bins, against plain formulas written out here. Trusts the reference's raw sums.

use crate::common::*;
use crate::shared::{cpu, direct, kernel_plan};
use pairwave::compute::cpu::Cpu;
use pairwave::compute::reference::Reference;
use pairwave::compute::{Compute, binned_kernel_sums};
use pairwave::control::Control;
use pairwave::estimate::{ErrorSource, KernelEstimate, Normalization};
use pairwave::plan::{
    BinScale, Correction, Divisor, EnsembleShape, KernelMethod, KernelPlan, PairSettings, RadialBins, Smoothing,
    SmoothingKernel,
};
use pairwave::points::{Domain, Ensemble, RawPoints};

/// g at `r` from the kernel sum over all pairs, by the formula, on f64 coordinates.
fn exact_kernel_sum(points: &RawPoints, domain: &Domain, kernel: Smoothing, divisor: Divisor, r: f64) -> f64 {
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
                let kernel = Smoothing { shape, bandwidth: 0.012 };
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
            let kernel = Smoothing { shape: SmoothingKernel::Gaussian, bandwidth: 0.011 };
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
    let kernel = Smoothing { shape: SmoothingKernel::Epanechnikov, bandwidth: 0.02 };
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
    let kernel = Smoothing { shape: SmoothingKernel::Epanechnikov, bandwidth: 0.02 };
    let plan = kernel_plan(&e, kernel, Divisor::R, &[0.1, 0.2, 0.3], Correction::None, 50.0);
    let sums =
        |range: std::ops::Range<usize>| wait(cpu().kernel_sums(&plan, &e.slice(range), &Control::default())).unwrap();
    let whole = sums(0..40);
    let mut parts = sums(0..16);
    parts.merge(sums(16..40)).unwrap();
    assert_eq!(parts, whole);
    assert!(parts.merge(sums(16..40)).is_err(), "the same realizations twice");
}

/// The bound of fine bins is made of these: the oscillation of a kernel over an interval, against a search through it.
#[test]
fn oscillations_are_those_of_a_search() {
    let sides = [[-0.8, -0.3], [-0.3, 0.7], [-0.7, 0.3], [-0.4, 0.4], [-0.4, 0.0], [0.0, 0.4], [0.2, 0.6]];
    let ends = [[0.8, 1.3], [-1.2, -0.9], [-1.2, 0.3], [-1.5, 1.0], [1.1, 1.2]];
    for shape in SHAPES {
        let kernel = Smoothing { shape, bandwidth: 0.3 };
        for [lo, hi] in sides.into_iter().chain(ends).map(|of| of.map(|u| u * kernel.reach())) {
            // The peak is at one of them.
            let values = (0..=1000).map(|k| kernel.value(lo + (hi - lo) * f64::from(k) / 1000.0));
            let [least, most] = values.fold([f64::INFINITY, 0.0f64], |[l, m], v| [l.min(v), m.max(v)]);
            let found = kernel.oscillation(lo, hi);
            assert!((found - (most - least)).abs() < 1e-9 * kernel.peak(), "{shape:?}, {lo} to {hi}: {found}");
        }
    }
}

/// Fine bins are within their own bound of the direct sum, and the smooth kernels within 1e-5.
#[test]
fn binned_kernel_sums_keep_their_bound() {
    for (domain, correction) in kernel_domains(2) {
        let e = Ensemble::from_raw(&[stretched(uniform(2, 400, 77), &domain)], &domain, false, 0).unwrap();
        let r: Vec<f64> = (0..=60).map(|i| f64::from(i) * 0.005).collect();
        for shape in SHAPES {
            let kernel = Smoothing { shape, bandwidth: 0.01 };
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
        let kernel = Smoothing { shape: SmoothingKernel::Gaussian, bandwidth };
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
    let kernel = Smoothing { shape: SmoothingKernel::Epanechnikov, bandwidth: 0.02 };
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
    let kernel = Smoothing { shape: SmoothingKernel::Box, bandwidth: 0.02 };
    let plan = kernel_plan(&e, kernel, Divisor::R, &[0.4, 0.46, 0.47, 0.5], Correction::None, 100.0);
    let g = direct(&Reference, &plan, &e);
    assert_eq!(g.g.iter().map(Option::is_some).collect::<Vec<_>>(), [true, true, false, false]);
}

#[test]
fn coincident_points_are_left_out_where_d_divides() {
    let e = ensemble(&[raw(2, vec![0.25, 0.25, 0.25, 0.25, 0.3, 0.25])]);
    let kernel = Smoothing { shape: SmoothingKernel::Epanechnikov, bandwidth: 0.04 };
    for device in [&Reference as &dyn Compute, &cpu()] {
        for (divisor, left_out) in [(Divisor::D, 2), (Divisor::R, 0)] {
            let plan = kernel_plan(&e, kernel, divisor, &[0.01, 0.05], Correction::None, 3.0);
            let sums = wait(device.kernel_sums(&plan, &e, &Control::default())).unwrap();
            assert_eq!(sums.coincident, left_out, "ordered pairs");
            assert!(KernelEstimate::new(&plan, &sums, Normalization::Pairs).g.iter().all(|g| g.unwrap().is_finite()));
        }
    }
}
