//! Integration errors: the identity of their two forms, every way of computing, closed forms, and what is observed.

use crate::common::*;
use crate::integrals::{self, drawn, each, found, parts, settings, sums};
use pairwave::Points;
use pairwave::accumulate::IntegrandSums;
use pairwave::compute::Device;
use pairwave::compute::cpu::Cpu;
use pairwave::compute::reference::Reference;
use pairwave::estimate::{Analysis, IntegrationError, IntegrationErrors};
use pairwave::plan::{Accuracy, IntegrationPlan, IntegrationSettings, PairSum};
use pairwave::points::{Domain, Ensemble};

/// Smooth in any dimension: all of its spectrum is within the grid.
const SMOOTH: [&str; 2] = ["gaussian:sigma=0.12", "cosine:x=2,phase=0.3"];

fn plan(ensemble: &Ensemble, integrands: &[&str], accuracy: Accuracy, f: Option<&[u32]>) -> IntegrationPlan {
    integrals::plan(ensemble, integrands, IntegrationSettings { max_frequency: f, accuracy, ..settings() })
}

fn of<'a>(analysis: &'a Analysis, name: &str) -> &'a IntegrationError {
    each(analysis).iter().find(|e| e.integrand.spec().starts_with(name)).unwrap()
}

/// For any single set the variance over shifts is one number in frequency and in space, without statistics.
#[test]
fn both_forms_are_one_number() {
    let cases: &[(&str, u64, usize, &[&str])] = &[
        ("jittered", 32, 1, &[]),
        ("jittered", 64, 2, &[]),
        ("random", 50, 2, &[]),
        ("lhs", 64, 2, &[]),
        ("grid", 49, 2, &["shift=none"]),
        ("lattice", 55, 2, &[]),
        ("thomas", 40, 2, &[]),
        ("jittered", 27, 3, &[]),
        ("random", 20, 3, &[]),
    ];
    for (accuracy, tolerance) in [(Accuracy::High, 1e-11), (Accuracy::Fast, 2e-5)] {
        for &(name, n, dim, params) in cases {
            let ensemble = drawn(name, n, dim, 2, params);
            let frequencies = vec![if dim == 3 { 9 } else { 12 }; dim];
            let plan = plan(&ensemble, &SMOOTH, accuracy, Some(&frequencies));
            let cpu = Cpu::new(Some(2)).unwrap();
            for realization in sums(&cpu, &plan, &ensemble).realizations {
                for (integrand, s) in plan.integrands.iter().zip(&realization.each) {
                    let n = realization.n as f64;
                    let (spectral, spatial) =
                        ((s.grid + s.axes) / (n * n), integrand.variance() / n + 2.0 * s.pairs / (n * n));
                    let unit = integrand.variance() / n;
                    assert!(
                        (spectral - spatial).abs() < tolerance * unit,
                        "{name} {dim}D {integrand:?}: {spectral} in frequency, {spatial} in space, {accuracy:?}"
                    );
                    // Planted: a pair counted once instead of twice, or I^2 left in, is seen.
                    let fault = integrand.variance() / n + s.pairs / (n * n);
                    assert!(
                        (spectral - fault).abs() > 100.0 * tolerance * unit || s.pairs.abs() < 1e-3 * n,
                        "{name}: {fault}"
                    );
                }
            }
        }
    }
}

/// The CPU path against the definition, edges and all; weights 1 on a torus of unequal sides.
#[test]
fn cpu_equals_the_reference() {
    let all =
        ["disk", "box", "step", "ramp", "half-plane", "checker", "zone-plate", "bump", "gaussian", "formula:x^2*y"];
    let close =
        |a: f64, b: f64, unit: f64, what: &str| assert!((a - b).abs() <= 1e-11 * unit, "{what}: {a} is not {b}");
    for (name, n, dim) in [("jittered", 16, 1), ("lhs", 30, 2), ("thomas", 20, 2), ("random", 12, 3)] {
        let in_dim: Vec<&str> = all.into_iter().filter(|spec| pairwave::Integrand::new(spec, dim).is_ok()).collect();
        let ensemble = drawn(name, n, dim, 3, &[]);
        let stretched = ensemble.stretched(&Domain::torus(&[2.0, 0.7, 1.3][..dim]).unwrap());
        for ensemble in [ensemble, stretched] {
            let plan = plan(&ensemble, &in_dim, Accuracy::High, Some(&vec![4; dim]));
            assert_eq!(plan.pairs, PairSum::Exact);
            let (fast, slow) =
                (sums(&Cpu::new(Some(2)).unwrap(), &plan, &ensemble), sums(&Reference, &plan, &ensemble));
            for (a, b) in fast.realizations.iter().zip(&slow.realizations) {
                assert_eq!((a.index, a.n), (b.index, b.n));
                for ((i, a), b) in plan.integrands.iter().zip(&a.each).zip(&b.each) {
                    let what = format!("{name} {dim}D {i:?}");
                    let n2 = (n * n) as f64 * i.square_integral().max(1e-3);
                    for (k, (a, b)) in parts(a).into_iter().zip(parts(b)).enumerate() {
                        close(a, b, n2, &format!("{what}, part {k}"));
                    }
                }
            }
        }
    }
}

/// Pairs deposited on lags and extrapolated come to the exact sum, far closer than one realization differs from another: of smooth functions, and
/// where a bends between nodes.
#[test]
fn deposited_pairs_come_to_the_exact_sum() {
    let edges = &["gaussian:sigma=0.1", "disk", "box", "half-plane"];
    for (name, dim, n, integrands, tolerance) in [
        ("jittered", 1, 64, &edges[..1], 1e-4),
        ("jittered", 1, 64, &["interval"], 2e-3),
        ("jittered", 2, 256, &edges[..1], 5e-3),
        ("jittered", 2, 1024, &edges[1..], 1e-2),
        ("random", 3, 64, &edges[..1], 5e-3),
    ] {
        let ensemble = drawn(name, n, dim, 3, &[]);
        let exact = plan(&ensemble, integrands, Accuracy::High, Some(&vec![6; dim]));
        let deposited = exact.clone().with_deposit();
        let cpu = Cpu::new(Some(2)).unwrap();
        let [a, b] = [&exact, &deposited].map(|plan| sums(&cpu, plan, &ensemble));
        for (a, b) in a.realizations.iter().zip(&b.realizations) {
            for (i, integrand) in exact.integrands.iter().enumerate() {
                let v = |s: &IntegrandSums| integrand.variance() * n as f64 + 2.0 * s.pairs;
                let (a, b) = (v(&a.each[i]), v(&b.each[i]));
                assert!((a / b - 1.0).abs() < tolerance, "{name} {dim}D {integrand:?}: {b} deposited, {a}");
            }
        }
    }
}

/// g(r) up to half a side and the rest by its number: exact where f is isotropic, and in 1D; for random points whatever f is, within what one set scatters.
#[test]
fn pairs_counted_by_distance_come_to_the_exact_sum() {
    let line = |sampler: &str, rest: &str| found(&format!("--sampler {sampler} --device cpu --stats counts {rest}"));
    for (sampler, integrand, tolerance) in [
        ("jittered -n 32 --dim 1 -k 20", "gaussian:sigma=0.1", 1e-2),
        ("poisson-disk -n 256 -k 20", "gaussian:sigma=0.1", 2e-2),
        ("poisson-disk -n 256 -k 20", "disk", 1e-2),
        ("random -n 100 --dim 3 -k 20", "disk", 2e-2),
    ] {
        let [exact, radial] =
            ["pairs", "radial"].map(|way| line(sampler, &format!("--integrand {integrand} --spatial {way}")));
        let value = |a: &Analysis| a.integration().unwrap().each[0].spatial.unwrap().value;
        let (exact, radial) = (value(&exact), value(&radial));
        assert!(
            (radial / exact - 1.0).abs() < tolerance,
            "{sampler}, {integrand}: {radial} by distance, {exact} by pairs"
        );
    }
    let stretched =
        request("--sampler random -n 9 --box 1,2 --integrand disk --spatial radial --device cpu --stats counts");
    let wrong = pairwave::measure(Points::open(&stretched.input).unwrap(), &stretched).unwrap_err().to_string();
    assert!(wrong.contains("radial: is for a box of equal sides"), "{wrong}");
}

/// Of shifts on a line, any wave of fewer periods than there are shifts has mean 0.
#[test]
fn shifts_on_a_line_are_evenly_spread() {
    let ensemble = drawn("jittered", 8, 1, 1, &[]);
    for count in [1, 5, 8] {
        let plan = integrals::plan(&ensemble, &SMOOTH, IntegrationSettings { shifts: count, ..settings() });
        assert_eq!(plan.shifts.len(), count as usize);
        for m in 1..count {
            let turn = |shift: &f64| std::f64::consts::TAU * f64::from(m) * shift;
            let [re, im] = [f64::cos, f64::sin].map(|of| plan.shifts.iter().map(|s| of(turn(s))).sum::<f64>());
            assert!(re.hypot(im) < 1e-12, "{count} shifts, {m} periods: {re}, {im}");
        }
    }
}

/// Lags: single points, shells and what is not resolved add up to the spatial form; of jittered points all that matters is near.
#[test]
fn lags_add_up_to_the_spatial_form() {
    let analysis =
        found("--sampler jittered -n 256 -k 20 --integrand gaussian --integrand disk --device cpu --stats counts");
    for e in each(&analysis) {
        let sum: f64 = e.alone + e.lags.iter().map(|shell| shell.variance).sum::<f64>();
        let whole = e.spatial.unwrap().value;
        assert!((sum / whole - 1.0).abs() < 1e-2, "{:?}: {sum} {whole}", e.integrand);
        assert!((e.alone - e.v0 / 256.0).abs() < 1e-15 && whole < 0.2 * e.alone);
        // Cells of a sixteenth: beyond two of them nothing is added.
        let near: f64 = e.lags.iter().filter(|shell| shell.hi < 0.18).map(|shell| shell.variance).sum();
        assert!((e.alone + near - whole).abs() < 0.1 * e.alone, "{near} {whole}");
    }
}

/// Edges: what the grid leaves out is closed by axes and by P = 1.
#[test]
fn the_tail_closes_edges() {
    let line = "--integrand disk --integrand box --integrand half-plane --integrand step --integrand ramp --device cpu --stats pcf";
    for (sampler, bound) in [("jittered -n 256 -k 40", 1e-3), ("random -n 256 -k 40", 1e-3), ("lhs -n 256 -k 40", 5e-3)]
    {
        let analysis = found(&format!("--sampler {sampler} {line}"));
        for e in each(&analysis) {
            let spatial = e.spatial.unwrap().value;
            assert!(
                (e.closed.value / spatial - 1.0).abs() < bound,
                "{sampler} {:?}: {} for {spatial}",
                e.integrand,
                e.closed.value
            );
        }
        // Planted: without the tail it is off by percent.
        let step = of(&analysis, "step");
        assert!((step.spectral.value / step.spatial.unwrap().value - 1.0).abs() > 2e-3, "{sampler}");
    }
    // LHS: what lies on an axis is not random there.
    let lhs = found(&format!("--sampler lhs -n 256 -k 40 {line}"));
    for name in ["step", "ramp"] {
        let e = of(&lhs, name);
        let (closed, spatial) = (e.closed.value, e.spatial.unwrap().value);
        assert!((closed / spatial - 1.0).abs() < 1e-3, "{name}: {closed} for {spatial}");
        let random = e.spectral.value + (e.v0 / 256.0) * (e.tail_share + e.tail_axes / (e.v0 / 256.0) * 2.0);
        assert!((random / spatial - 1.0).abs() > 0.05, "{name}: closed with P = 1 along the axis it would be {random}");
    }
}

/// P where the grid ends: of a rank-1 lattice it is 610 at (21, 13) and (13, -21), 0 in the outermost tenth of a grid to 30, and along axes
/// 610 once in the last tenth of 2,440 frequencies, 2.5 on the mean.
#[test]
fn the_tail_is_bounded_by_p_at_the_end_of_the_grid() {
    let analysis = found(
        "--sampler lattice -n 610 --param a=377 -k 1 --integrand disk --max-frequency 30 --device cpu --stats spectrum",
    );
    let e = of(&analysis, "disk");
    let excess = e.tail_bound / (e.tail - e.tail_axes);
    assert!((excess - 1.5).abs() < 0.02, "P is off 1 by {excess}");
}

/// One point: P is 1, and a cosine has |f|^2 of 1/4 at two frequencies, each other's mirror image. Errors of exponential power are `sqrt(2) / 4`
/// of it whether these are in the grid or along an axis beyond.
#[test]
fn errors_of_one_realization_count_mirror_images() {
    for f in [1, 4] {
        let analysis = found(&format!(
            "--sampler random -n 1 -k 1 --integrand cosine:x=3 --max-frequency {f} --device cpu --stats spectrum"
        ));
        let se = of(&analysis, "cosine").closed.se.unwrap();
        assert!((se - 0.125f64.sqrt()).abs() < 1e-7, "grid to {f}: {se}");
    }
}

/// Of few estimates, by the unbiased formula: `(m_4 - (k - 3)/(k - 1) s^4) / k`.
#[test]
fn the_error_of_an_observed_variance_is_that_of_its_moments() {
    let analysis =
        found("--sampler random -n 16 -k 12 --integrand disk --max-frequency 6 --device cpu --stats spectrum");
    let e = of(&analysis, "disk");
    let center = e.estimates.iter().sum::<f64>() / 12.0;
    let moment = |power| e.estimates.iter().map(|x| (x - center).powi(power)).sum::<f64>();
    let variance = moment(2) / 11.0;
    let se = ((moment(4) / 12.0 - 9.0 / 11.0 * variance.powi(2)) / 12.0).sqrt();
    assert!(se > variance * (2.0f64 / 11.0).sqrt() / 2.0, "above the least that is said");
    let found = e.observed.unwrap();
    assert!((found.value / variance - 1.0).abs() < 1e-12 && (found.se.unwrap() / se - 1.0).abs() < 1e-12, "{found:?}");
}

/// Shifted points are as predicted, of every integrand and sampler, in standard errors of the differences.
#[test]
fn what_is_observed_is_what_was_predicted() {
    let line = "--integrand disk --integrand box --integrand half-plane --integrand gaussian --integrand ramp --integrand cosine:x=1,y=1 --device cpu --stats pcf --r-max 0.1";
    for sampler in [
        "random -n 64 -k 300",
        "jittered -n 64 -k 300",
        "sobol -n 64 -k 300",
        "thomas -n 64 -k 300",
        "poisson-disk -n 64 -k 300",
        "jittered --dim 1 -n 32 -k 300",
        "jittered --dim 3 -n 64 -k 200",
    ] {
        let dim3 = sampler.contains("--dim");
        let line = if dim3 {
            "--integrand gaussian --integrand ramp --integrand step --device cpu --stats pcf --r-max 0.1"
        } else {
            line
        };
        let analysis = found(&format!("--sampler {sampler} {line}"));
        for e in each(&analysis) {
            assert!(e.z.is_none_or(|z| z.abs() < 4.5), "{sampler} {:?}: z {:?}", e.integrand, e.z);
            // Planted: a prediction without 1/n of the slides, or of fewer points, is not taken for it.
            let wrong = e.closed.value * 1.25;
            let far = (e.shifted.value - wrong) / e.shifted.se.unwrap().max(1e-12);
            assert!(
                far.abs() > 3.0 || e.shifted.se.unwrap() > 0.05 * e.closed.value,
                "{sampler} {:?}: {far}",
                e.integrand
            );
        }
    }
}

/// Jittered points, as they are and shifted, by hand: a ramp of 8 x 8 has sd 1/(8 sqrt 12) in every column.
#[test]
fn jittered_points_by_hand() {
    let analysis = found(
        "--sampler jittered -n 64 -k 4000 --integrand ramp --integrand step:axis=x,at=0.25 --integrand cosine:x=1,y=1 --device cpu --stats pcf --r-max 0.05 --max-frequency 4 --shifts 1",
    );
    let e = of(&analysis, "ramp");
    let near = |m: pairwave::estimate::Measured, known: f64| {
        assert!((m.value - known).abs() < 3.5 * m.se.unwrap(), "{m:?} is not {known}");
    };
    // (1/64) (1/8)^2 / 12.
    near(e.observed.unwrap(), 1.0 / (64.0 * 64.0 * 12.0));
    // int f^2/n - int a prod (1 - 8 |r|)_+ dr = 1/192 - (2/64) (1/6 - (1/48)) ... : 3.0925e-4 by quadrature.
    near(e.shifted, 3.0924479166666667e-4);
    near(e.phase, 1.0 / 49152.0 - 3.0924479166666667e-4);
    // An edge on a side of the cells is exact: nothing is observed, and said so.
    let step = of(&analysis, "step");
    assert_eq!((step.observed.unwrap().value, step.bias.value), (0.0, 0.0));
}

/// Random n: the three estimators, each with its own count term.
#[test]
fn random_numbers_of_points() {
    let line = "--sampler poisson -n 50 -k 2000 --integrand disk --device cpu --stats pcf --r-max 0.05 --max-frequency 6 --shifts 4";
    let lambda = found(line);
    let e = of(&lambda, "disk");
    let errors: &IntegrationErrors = lambda.integration().unwrap();
    assert_eq!(errors.estimator.name(), "lambda");
    // int f^2 / lambda, and I^2 / lambda of it is the count.
    let (square, integral) = (e.integrand.square_integral(), e.integrand.integral());
    let within =
        |value: f64, known: f64, se: f64| assert!((value - known).abs() < 3.5 * se, "{value} +- {se} is not {known}");
    within(e.observed.unwrap().value, square / 50.0, e.observed.unwrap().se.unwrap());
    within(e.spatial.unwrap().value, square / 50.0, e.spatial.unwrap().se.unwrap());
    within(e.count_term, integral * integral / 50.0, 0.05 * integral * integral / 50.0);
    let ratio = found(&format!("{line} --estimator ratio"));
    let r = of(&ratio, "disk");
    assert_eq!(r.count_term, 0.0);
    // v0 E[1/N], 1.02 above v0/n.
    let mean: f64 = {
        let p = |k: i32| (f64::from(k) * 50f64.ln() - 50.0 - (1..=k).map(|j| f64::from(j).ln()).sum::<f64>()).exp();
        (1..300).map(|k| p(k) / f64::from(k)).sum()
    };
    within(r.spatial.unwrap().value, r.v0 * mean, r.spatial.unwrap().se.unwrap());
    assert!((r.spatial.unwrap().value / (r.v0 / 50.0) - 1.0) > 0.01);
    assert!(r.z.unwrap().abs() < 4.5 && e.z.unwrap().abs() < 4.5);
}

/// The truncated phase term from the covariance of amplitudes, `sum_(l != m) conj(f_m) f_l C_ml / n`: the other conjugation is another number.
#[test]
fn the_phase_of_low_frequencies_is_that_of_the_covariance() {
    let line = "--sampler jittered -n 16 -k 50 --integrand gaussian:sigma=0.1,x=0.3,y=0.6 --covariance-frequency 4 --stats covariance --device cpu";
    let analysis = found(line);
    let e = of(&analysis, "gaussian");
    let covariance = analysis.covariance().unwrap();
    let modes: Vec<[i32; 2]> = (-4..=4).flat_map(|x| (-4..=4).map(move |y| [x, y])).collect();
    let [mut right, mut wrong] = [0.0; 2];
    for (a, m) in modes.iter().enumerate() {
        for (b, l) in modes.iter().enumerate() {
            if m == l || *m == [0, 0] || *l == [0, 0] {
                continue;
            }
            let [re, im] = covariance.c[a * modes.len() + b];
            let product = e.integrand.coefficient(m).conj() * e.integrand.coefficient(l);
            right += product.re * re - product.im * im;
            wrong += product.re * re + product.im * im;
        }
    }
    let unit = e.v0 / 16.0;
    assert!((right / 16.0 - e.phase_low).abs() < 1e-12 * unit.max(1.0), "{} is not {}", right / 16.0, e.phase_low);
    assert!((wrong / 16.0 - e.phase_low).abs() > 1e-3 * unit, "{} conjugated otherwise", wrong / 16.0);
}

/// Standard errors of the prediction, over 100 repeats of 40 realizations.
#[test]
fn standard_errors_of_predictions_hold() {
    let mut values = Vec::new();
    let mut squares = 0.0;
    for seed in 0..100 {
        let analysis = found(&format!(
            "--sampler jittered -n 36 -k 40 --seed {seed} --integrand disk --device cpu --stats pcf --r-max 0.05 --max-frequency 12 --shifts 1"
        ));
        let closed = of(&analysis, "disk").closed;
        values.push(closed.value);
        squares += closed.se.unwrap().powi(2) / 100.0;
    }
    let mean = values.iter().sum::<f64>() / 100.0;
    let sd = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 99.0).sqrt();
    let ratio = sd / squares.sqrt();
    // 100 repeats know a ratio of 1 to 7 %.
    assert!((0.8..1.2).contains(&ratio), "sd {sd}, rms standard error {}", squares.sqrt());
}

/// Sums are written, read and merged like all others, to the bit.
#[test]
fn parts_are_the_whole() {
    let device = Device::new(Box::new(Cpu::new(Some(2)).unwrap()), None).unwrap();
    let ensemble = drawn("jittered", 16, 2, 40, &[]);
    let plan = plan(&ensemble, &["disk", "gaussian"], Accuracy::Fast, Some(&[6, 6]));
    let whole = sums(device.compute(), &plan, &ensemble);
    let mut parts = sums(device.compute(), &plan, &ensemble.slice(16..40));
    pairwave::accumulate::Sums::merge(&mut parts, sums(device.compute(), &plan, &ensemble.slice(0..16))).unwrap();
    assert_eq!(whole.realizations, parts.realizations);
    assert_eq!(whole.grid.mode_totals(), parts.grid.mode_totals());
    // On other lags they are other pairs.
    let [mut some, mut others] = [0..16, 16..32].map(|part| sums(device.compute(), &plan, &ensemble.slice(part)));
    others.lags.pop();
    let wrong = pairwave::accumulate::Sums::merge(&mut some, others).unwrap_err().to_string();
    assert!(wrong.contains("pairs on 33024 lags and on 33023"), "{wrong}");
}

/// Frequencies at which no integrand has a coefficient add nothing, whoever computes.
#[test]
fn what_has_no_coefficient_is_left_out() {
    const F: u32 = 20;
    let cases: &[(usize, &[&str], &[u32], usize)] = &[
        (1, &["cosine:x=2"], &[2], 3),
        (2, &["step:at=0.37"], &[F, 0], F as usize + 1),
        (2, &["cosine:x=3,y=1", "cosine:x=2"], &[3, 1], 12),
        (2, &["ramp", "ramp:axis=y"], &[F, F], 0),
        (2, &["disk", "gaussian:sigma=0.2"], &[F, F], 0),
        (3, &["monomial:z=1"], &[1, 0, F], 0),
    ];
    for &(dim, integrands, largest, modes) in cases {
        let ensemble = drawn("thomas", 40, dim, 2, &[]);
        for (accuracy, tolerance) in [(Accuracy::High, 1e-11), (Accuracy::Fast, 2e-5)] {
            let whole = plan(&ensemble, integrands, accuracy, Some(&vec![F; dim]));
            let narrow = whole.clone().narrowed().unwrap();
            assert_eq!((narrow.max_frequency(), &narrow.asked[..]), (largest, &vec![F; dim][..]), "{integrands:?}");
            let wanted =
                |plan: &IntegrationPlan| (0..plan.grid.waves.len()).filter(|&index| plan.grid.computes(index)).count();
            assert!(wanted(&narrow) < wanted(&whole) || integrands.contains(&"disk"), "{integrands:?}");
            if modes > 0 {
                assert_eq!(narrow.grid.waves.len(), modes, "{integrands:?}");
            }
            let cpu = Cpu::new(Some(2)).unwrap();
            let of_whole = sums(&Reference, &whole, &ensemble);
            // Without the last frequency there is a difference, where there is a coefficient.
            let short: Vec<u32> = largest.iter().map(|f| f.saturating_sub(1)).collect();
            let short = plan(&ensemble, integrands, accuracy, Some(&short));
            for (cut, equal) in [(&narrow, true), (&short, false)] {
                for found in [sums(&cpu, cut, &ensemble), sums(&Reference, cut, &ensemble)] {
                    let mut off = 0.0f64;
                    for (a, b) in found.realizations.iter().zip(&of_whole.realizations) {
                        for ((i, a), b) in cut.integrands.iter().zip(&a.each).zip(&b.each) {
                            off = off.max((a.grid - b.grid).abs() / b.grid.max(40.0 * i.variance()));
                        }
                    }
                    let right = if equal { off <= tolerance } else { accuracy == Accuracy::Fast || off > 1e-10 };
                    assert!(right, "{integrands:?}, {:?}: {off}", cut.max_frequency());
                }
            }
        }
    }
}

/// P and integration errors are of one transform where their frequencies are the same: the plan says so, and no byte of P differs.
#[test]
fn power_is_computed_once() {
    let line = "--sampler jittered -n 64 -k 40 --device cpu --stats spectrum,radial,pcf";
    let plan = |line: &str| {
        let request = request(line);
        pairwave::analysis::Plan::of(&request, &Points::open(&request.input).unwrap()).unwrap().to_string()
    };
    let said = "skipped: integration errors have it on the way";
    let with = format!("{line} --integrand disk --integrand ramp");
    assert!(plan(&with).contains(said) && !plan(line).contains(said), "{}", plan(&with));
    let (alone, together) = (files(&found(line)), files(&found(&with)));
    assert!(["spectrum.npy", "spectrum_radial.csv", "pcf.csv"].iter().all(|name| alone.contains_key(*name)));
    let differing: Vec<&String> =
        alone.iter().filter(|(name, bytes)| together[*name] != **bytes).map(|f| f.0).collect();
    assert!(differing.is_empty(), "{differing:?}");
    // Not where they are other sums: rings alone, weights of their own, another convention.
    for other in [
        "--sampler jittered -n 64 -k 40 --device cpu --stats radial --integrand disk",
        "--sampler jittered -n 64 -k 40 --device cpu --stats spectrum --integrand disk --intensity gaussian:sigma=0.5",
        "--sampler jittered -n 64 -k 40 --device cpu --stats spectrum --integrand disk --inhomogeneous gaussian:sigma=0.5",
    ] {
        assert!(!plan(other).contains(said), "{other}");
    }
    let line = "--sampler jittered -n 64 -k 20 --device cpu --stats spectrum";
    let weighted = format!("{line} --integrand disk --intensity gaussian:sigma=0.5");
    let (alone, together) = (files(&found(line)), files(&found(&weighted)));
    assert_eq!(alone["spectrum.npy"], together["spectrum.npy"]);
}
