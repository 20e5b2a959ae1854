//! Spectra of windows: tapers against quadrature, the reference against the formula written out in lengths and wave numbers,
//! the CPU path against the reference, and random points against what is known of them.

use std::f64::consts::{PI, SQRT_2, TAU};

use crate::common::{Rng, ensemble_in, raw, shape, uniform, wait};
use pairwave::accumulate::WavePower;
use pairwave::compute::Compute;
use pairwave::compute::cpu::Cpu;
use pairwave::compute::reference::Reference;
use pairwave::control::Control;
use pairwave::estimate::{AxisSlices, PowerSpectrum, RadialSpectrum};
use pairwave::plan::{Accuracy, Debias, Taper, TaperPlan, WaveGrid, WaveList, WaveMethod, WavePlan, WaveVectors};
use pairwave::points::{Domain, Ensemble};

const DEBIAS: [Debias; 3] = [Debias::Direct, Debias::Undirect, Debias::None];

fn plan(points: &Ensemble, waves: impl Into<WaveVectors>, taper: TaperPlan) -> WavePlan {
    WavePlan::new(points.domain(), waves, Accuracy::High, shape(points)).unwrap().with_taper(taper)
}

fn reference(plan: &WavePlan, points: &Ensemble) -> WavePower {
    wait(Reference.wave_power(plan, points, &Control::default())).unwrap()
}

/// Wave vectors between the allowed ones, in cycles per side.
fn off_grid(dim: usize) -> WaveList {
    let all =
        [[0.5, 0.25, 0.0], [1.0, 0.3, 0.7], [-2.25, 1.5, -0.5], [3.0, 0.0, 1.0], [0.0, -1.7, 0.1], [0.0, 0.0, 0.0]];
    let vectors = all.iter().map(|v| std::array::from_fn(|k| if k < dim { v[k] } else { 0.0 })).collect();
    WaveList { dim, vectors, mirrored: false }
}

/// Gauss-free and slow: the midpoint rule with Richardson's correction, good to 1e-12 for these functions.
fn quadrature(f: impl Fn(f64) -> f64) -> f64 {
    let midpoints = |n: usize| (0..n).map(|i| f((i as f64 + 0.5) / n as f64)).sum::<f64>() / n as f64;
    let (coarse, middle, fine) = (midpoints(2000), midpoints(4000), midpoints(8000));
    let [a, b] = [middle + (middle - coarse) / 3.0, fine + (fine - middle) / 3.0];
    b + (b - a) / 15.0
}

fn f_sine(p: usize, u: f64) -> f64 {
    SQRT_2 * (PI * p as f64 * u).sin()
}

#[test]
fn transforms_of_tapers_are_their_integrals() {
    let bartlett = TaperPlan::default();
    let sine = TaperPlan::new(Taper::Sine, Some(4), Debias::Direct, 1).unwrap();
    for m in [0.0, 0.5, 1.0, 1.5, 2.0, -2.3, 7.25, -12.0] {
        for p in 1..=4 {
            for (taper, f) in [(bartlett, None), (sine, Some(p))] {
                let value = |u: f64| f.map_or(1.0, |p| f_sine(p, u));
                let expected =
                    [quadrature(|u| value(u) * (TAU * m * u).cos()), quadrature(|u| -value(u) * (TAU * m * u).sin())];
                let found = taper.transform([p, 1, 1], [m, 0.0, 0.0], 1);
                for (a, b) in found.iter().zip(expected) {
                    assert!((a - b).abs() < 1e-10, "{taper}, p = {p}, m = {m}: {found:?}, {expected:?}");
                }
            }
        }
        if m.fract() == 0.0 && m != 0.0 {
            assert_eq!(bartlett.transform([1; 3], [m, 0.0, 0.0], 1), [0.0, 0.0], "exactly, at allowed m = {m}");
        }
    }
    // In 2D the transform is the product of those along the axes.
    let sine = TaperPlan::new(Taper::Sine, Some(3), Debias::Direct, 2).unwrap();
    let [a, b] = sine.transform([2, 1, 1], [0.7, 0.0, 0.0], 1);
    let [c, d] = sine.transform([3, 1, 1], [-1.2, 0.0, 0.0], 1);
    let [re, im] = sine.transform([2, 3, 1], [0.7, -1.2, 0.0], 2);
    assert!((re - (a * c - b * d)).abs() < 1e-15 && (im - (a * d + b * c)).abs() < 1e-15);
}

#[test]
fn tapers_are_orthonormal() {
    for p in 1..=3 {
        for q in 1..=3 {
            let product = quadrature(|u| f_sine(p, u) * f_sine(q, u));
            assert!((product - f64::from(u8::from(p == q))).abs() < 1e-12);
        }
    }
    let sine = TaperPlan::new(Taper::Sine, Some(2), Debias::Direct, 3).unwrap();
    assert_eq!(sine.all(3).len(), 8);
    assert_eq!(sine.all(2), [[1, 1, 1], [1, 2, 1], [2, 1, 1], [2, 2, 1]]);
    // What a plan gives points is what the formula says, at the far side too.
    let places = [0u64, 1 << 40, 1 << 62, 3 << 62, u64::MAX];
    for (j, &place) in places.iter().enumerate() {
        let u = place as f64 / 2f64.powi(64);
        let found = sine.value([2, 1, 1], &[&places], j);
        assert!((found - f_sine(2, u)).abs() < 1e-15 * (1.0 + 2.0 * u), "u = {u}: {found}");
    }
}

/// `S(k)` as structure-factor writes it: box centred, t = f / sqrt |W|, k = 2 pi nu.
fn structure_factor(points: &[[f64; 2]], sides: [f64; 2], nu: [f64; 2], taper: &TaperPlan) -> f64 {
    let area = sides[0] * sides[1];
    let rho = points.len() as f64 / area;
    let k = nu.map(|nu| TAU * nu);
    let t = |orders: [usize; 3], x: [f64; 2]| -> f64 {
        match taper.taper {
            Taper::Bartlett => 1.0 / area.sqrt(),
            Taper::Sine => (0..2)
                .map(|a| (2.0 / sides[a]).sqrt() * (PI * orders[a] as f64 * (x[a] / sides[a] + 0.5)).sin())
                .product(),
        }
    };
    let along = |a: usize, order: usize| {
        let value = |x: f64| match taper.taper {
            Taper::Bartlett => 1.0 / sides[a].sqrt(),
            Taper::Sine => (2.0 / sides[a]).sqrt() * (PI * order as f64 * (x / sides[a] + 0.5)).sin(),
        };
        let x = |u: f64| (u - 0.5) * sides[a];
        [
            sides[a] * quadrature(|u| value(x(u)) * (k[a] * x(u)).cos()),
            -sides[a] * quadrature(|u| value(x(u)) * (k[a] * x(u)).sin()),
        ]
    };
    let tapers = taper.all(2);
    let one = |orders: &[usize; 3]| {
        let (mut re, mut im) = (0.0, 0.0);
        for x in points {
            let centred = [x[0] - 0.5 * sides[0], x[1] - 0.5 * sides[1]];
            let phase = k[0] * centred[0] + k[1] * centred[1];
            re += t(*orders, centred) * phase.cos();
            im -= t(*orders, centred) * phase.sin();
        }
        let ([a, b], [c, d]) = (along(0, orders[0]), along(1, orders[1]));
        let mean = [rho * (a * c - b * d), rho * (a * d + b * c)];
        match taper.debias {
            Debias::Direct => ((re - mean[0]).powi(2) + (im - mean[1]).powi(2)) / rho,
            Debias::Undirect => (re * re + im * im - mean[0].powi(2) - mean[1].powi(2)) / rho,
            Debias::None => (re * re + im * im) / rho,
        }
    };
    tapers.iter().map(one).sum::<f64>() / tapers.len() as f64
}

#[test]
fn reference_is_the_formula() {
    let sides = [3.0, 0.5];
    let window = Domain::window(&[(-1.0, 2.0), (4.0, 4.5)]).unwrap();
    let unit = uniform(2, 30, 5);
    let points = ensemble_in(&window, std::slice::from_ref(&unit));
    let placed: Vec<[f64; 2]> = unit.coordinates.chunks_exact(2).map(|x| [x[0] * sides[0], x[1] * sides[1]]).collect();
    for (kind, orders) in [(Taper::Bartlett, None), (Taper::Sine, None), (Taper::Sine, Some(3))] {
        for debias in DEBIAS {
            let taper = TaperPlan::new(kind, orders, debias, 2).unwrap();
            let plan = plan(&points, off_grid(2), taper);
            let p = PowerSpectrum::new(&plan, &reference(&plan, &points)).p;
            for (index, p) in p.iter().enumerate() {
                let m = plan.waves.vector(index);
                let expected = structure_factor(&placed, sides, [m[0] / sides[0], m[1] / sides[1]], &taper);
                assert!((p - expected).abs() < 1e-8 * (1.0 + expected.abs()), "{taper}, {m:?}: {p}, {expected}");
            }
        }
    }
}

#[test]
fn bartlett_on_the_grid_is_the_periodogram() {
    let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    let points = ensemble_in(&window, &[uniform(2, 40, 1), uniform(2, 60, 2)]);
    let grid = WaveGrid::new(&[5, 4]).unwrap();
    let torus = points.stretched(&Domain::torus(&[2.0, 1.0]).unwrap());
    let periodogram = WavePlan::new(torus.domain(), grid, Accuracy::High, shape(&torus)).unwrap();
    let periodogram = PowerSpectrum::new(&periodogram, &reference(&periodogram, &torus));
    for debias in DEBIAS {
        let plan = plan(&points, grid, TaperPlan { debias, ..TaperPlan::default() });
        assert!(plan.tapered().is_none(), "nothing to weigh, so every backend takes it");
        let found = PowerSpectrum::new(&plan, &reference(&plan, &points));
        for index in (0..grid.half_len()).filter(|&i| i != grid.dc()) {
            let (a, b) = (found.p[index], periodogram.p[index]);
            assert!((a - b).abs() < 1e-9 * (1.0 + b), "{:?}: {a}, {b}", grid.mode(index));
        }
        let n = (40.0 * 40.0 + 60.0 * 60.0) / 100.0;
        assert_eq!(found.dc().unwrap().0, if debias == Debias::None { n } else { 0.0 }, "{debias}");
    }
}

#[test]
fn cpu_keeps_its_bound() {
    let cpu = Cpu::new(Some(2)).unwrap();
    for dim in 1..=3 {
        let sides: Vec<(f64, f64)> = (0..dim).map(|k| (-1.0, 0.5 + k as f64)).collect();
        let window = Domain::window(&sides).unwrap();
        let points = ensemble_in(&window, &[uniform(dim, 90, 7), uniform(dim, 200, 8)]);
        let mut rng = Rng(3);
        let weights: Vec<f64> = (0..points.total_points()).map(|_| 0.5 + rng.unit()).collect();
        let weighted = points.clone().with_weights(&weights);
        let grid = WaveGrid::new(&[[9, 7, 4][..dim].to_vec()].concat()).unwrap();
        for points in [&points, &weighted] {
            for (kind, orders) in [(Taper::Bartlett, None), (Taper::Sine, Some(2))] {
                for (debias, waves) in
                    DEBIAS.into_iter().zip([grid.into(), off_grid(dim).into(), WaveVectors::from(grid)])
                {
                    let plan = plan(points, waves, TaperPlan::new(kind, orders, debias, dim).unwrap());
                    let truth = PowerSpectrum::new(&plan, &reference(&plan, points)).p;
                    // By a transform too, which takes large realizations: to the promise of its accuracy.
                    for (method, accuracy) in [
                        (WaveMethod::DirectF64, Accuracy::High),
                        (WaveMethod::Nufft, Accuracy::High),
                        (WaveMethod::Nufft, Accuracy::Fast),
                    ] {
                        let plan = WavePlan { method: Some(method), accuracy, ..plan.clone() };
                        let sums = wait(cpu.wave_power(&plan, points, &Control::default())).unwrap();
                        let found = PowerSpectrum::new(&plan, &sums).p;
                        let worst = truth.iter().zip(&found).map(|(t, f)| (t - f).abs() / (1.0 + t.abs()));
                        let worst = worst.fold(0.0, f64::max);
                        let bound = if accuracy == Accuracy::High { 1e-11 } else { accuracy.power_bound().max_uniform };
                        let kept = found.iter().all(|p| p.is_finite()) && worst <= bound;
                        assert!(kept, "{dim}D {kind} {debias}, {}: {worst:e}", method.name());
                    }
                }
            }
        }
    }
}

/// n independent uniform points: `E |A - n F|^2 / n = 1 - |F|^2` whatever the wave vector, and without debiasing
/// `1 - |F|^2 + n |F|^2`.
#[test]
fn random_points_have_the_expected_mean() {
    let window = Domain::window(&[(0.0, 1.0), (0.0, 2.0)]).unwrap();
    let n = 40.0;
    let sets: Vec<_> = (0..1500).map(|s| uniform(2, 40, 1000 + s)).collect();
    let points = ensemble_in(&window, &sets);
    let cpu = Cpu::new(None).unwrap();
    for (kind, orders) in [(Taper::Bartlett, None), (Taper::Sine, Some(1)), (Taper::Sine, Some(2))] {
        for debias in DEBIAS {
            let taper = TaperPlan::new(kind, orders, debias, 2).unwrap();
            let plan = plan(&points, off_grid(2), taper);
            let sums = wait(cpu.wave_power(&plan, &points, &Control::default())).unwrap();
            let spectrum = PowerSpectrum::new(&plan, &sums);
            for index in 0..plan.waves.len() {
                let m = plan.waves.vector(index);
                let squared = |orders: &[usize; 3]| {
                    let [re, im] = taper.transform(*orders, m, 2);
                    re * re + im * im
                };
                let tapers = taper.all(2);
                let bias = tapers.iter().map(squared).sum::<f64>() / tapers.len() as f64;
                let expected = 1.0 - bias + if debias == Debias::None { n * bias } else { 0.0 };
                let (p, se) = (spectrum.p[index], spectrum.p_se[index]);
                assert!((p - expected).abs() < 5.0 * se + 1e-9, "{taper}, {m:?}: {p} +- {se}, not {expected}");
                // The bias is large enough to be seen where it is left in.
                if debias == Debias::None && m == [0.5, 0.25, 0.0] && orders != Some(2) {
                    assert!(p - 1.0 > 20.0 * se, "{taper}: {p} +- {se}");
                }
            }
        }
    }
}

/// One realization: what the theory says of the scatter of a ring bounds from above what many realizations show, and is
/// not far from it for the first taper, whose correlations reach only to the next frequency.
#[test]
fn errors_of_a_single_realization_are_those_of_many() {
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    let grid = WaveGrid::new(&[12, 12]).unwrap();
    let cpu = Cpu::new(None).unwrap();
    for (orders, least) in [(1, 0.7), (2, 0.5)] {
        let taper = TaperPlan::new(Taper::Sine, Some(orders), Debias::Direct, 2).unwrap();
        let rings = |points: &Ensemble| {
            let plan = plan(points, grid, taper);
            let sums = wait(cpu.wave_power(&plan, points, &Control::default())).unwrap();
            RadialSpectrum::new(&plan, &sums, &PowerSpectrum::new(&plan, &sums)).rings
        };
        let sets: Vec<_> = (0..300).map(|s| uniform(2, 200, 9000 + s)).collect();
        let many = rings(&ensemble_in(&window, &sets));
        let one = rings(&ensemble_in(&window, &sets[..1]));
        for k in [4, 7, 10] {
            // The standard deviation of one realization, from 300 of them, is known to about 1/24.
            let (seen, theory) = (many[k].p_se * 300f64.sqrt(), one[k].p_se / one[k].p);
            let ratio = seen / theory;
            assert!((least..1.1).contains(&ratio), "{orders} tapers, ring {k}: {seen}, {theory}");
        }
    }
}

/// A jittered lattice has little power at low frequencies. Between allowed frequencies Bartlett's taper leaks some back in,
/// sine tapers less.
#[test]
fn sine_tapers_leak_less() {
    let mut rng = Rng(11);
    let k = 24;
    let cells = (0..k * k).flat_map(|j| [j % k, j / k]);
    let points = raw(2, cells.map(|c| (c as f64 + 0.2 * rng.unit()) / k as f64).collect());
    let points = ensemble_in(&Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap(), &[points]);
    let vectors = (0..40).map(|i| [2.5 + 0.05 * f64::from(i), 4.5 - 0.06 * f64::from(i), 0.0]).collect();
    let waves = WaveList { dim: 2, vectors, mirrored: false };
    let mean = |taper| {
        let plan = plan(&points, waves.clone(), TaperPlan::new(taper, None, Debias::Direct, 2).unwrap());
        let p = PowerSpectrum::new(&plan, &reference(&plan, &points)).p;
        p.iter().sum::<f64>() / p.len() as f64
    };
    let [bartlett, sine] = [mean(Taper::Bartlett), mean(Taper::Sine)];
    assert!(sine < 0.5 * bartlett, "{sine}, {bartlett}");
}

/// The band of a mode of a single realization is that of as many exponential ordinates as tapers: chi-squared with 8 degrees of
/// freedom for 4 of them, whose quantiles are 2.17973 and 17.5345; on the axes and on the grid alike.
#[test]
fn tapers_narrow_bands() {
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    let points = ensemble_in(&window, &[uniform(2, 100, 3)]);
    let taper = TaperPlan::new(Taper::Sine, Some(2), Debias::Direct, 2).unwrap();
    let plan = plan(&points, WaveGrid::new(&[4, 4]).unwrap(), taper);
    let sums = reference(&plan, &points);
    let spectrum = PowerSpectrum::new(&plan, &sums);
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-5;
    for (p, band) in spectrum.p.iter().zip(spectrum.bands()).filter_map(|(p, band)| Some((p, band?))) {
        assert!(near(band.lo, p * 8.0 / 17.5345) && near(band.hi, p * 8.0 / 2.17973), "{p}: {band:?}");
    }
    for mode in AxisSlices::new(&plan, &spectrum).modes {
        assert!(near(mode.band.unwrap().lo, mode.p * 8.0 / 17.5345), "{mode:?}");
    }
    // Four tapers narrow the ring means less than they narrow modes: they correlate neighbours.
    let radial = RadialSpectrum::new(&plan, &sums, &spectrum);
    assert!((radial.anisotropy_reference_db + 10.0 * 4f64.log10()).abs() < 1e-12);
}
