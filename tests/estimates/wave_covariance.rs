//! Raw sums -> covariances of amplitudes with errors, against plain formulas written out here. Trusts the reference's raw sums.

use crate::common::*;
use pairwave::compute::Compute;
use pairwave::compute::cpu::Cpu;
use pairwave::compute::reference::Reference;
use pairwave::control::Control;
use pairwave::estimate::{AmplitudeCovariance, PowerSpectrum};
use pairwave::plan::{Accuracy, CovariancePlan, EnsembleShape};
use pairwave::points::{Domain, Ensemble};
use pairwave::samplers::Process;

/// The covariance of a sampler's amplitudes for |m_k| <= `b`, all points of a realization moved by a random shift if `shifted`.
fn covariance(name: &str, n: u64, k: u64, dim: usize, b: u32, shifted: bool) -> (Ensemble, AmplitudeCovariance) {
    let process = Process::new(name, n, k, dim, 5, &[]).unwrap();
    let mut sets = Vec::new();
    for index in 0..k {
        let mut coordinates = process.coordinates(index, &Control::default()).unwrap();
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
