//! Raw sums -> P, its rings and their anisotropy with errors, against plain formulas written out here. Trusts the reference's raw sums.

use crate::common::*;
use crate::shared::tag;
use pairwave::accumulate::WavePower;
use pairwave::estimate::{PowerSpectrum, RadialSpectrum};
use pairwave::plan::{Accuracy, Rings, WaveGrid};
use pairwave::points::Domain;

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
    let default = WaveGrid::default_max_frequency(100.0, &torus, pairwave::Memory(1 << 31));
    assert_eq!(default, [71, 36], "the same frequency per unit length on both axes");
    let grid = WaveGrid::new(&[12, 4]).unwrap();
    let rings = Rings::new(&grid.into(), &torus);
    // The next mode along y outside the grid is m_y = 5 at nu = 5, ring 10 (in units of 1/2): rings to 9 are whole.
    assert_eq!((rings.count, rings.fundamental), (9, 0.5));
    assert_eq!(WaveGrid::default_max_frequency(1000.0, &Domain::unit_torus(1), pairwave::Memory(1 << 31)), [5000]);
    assert_eq!(WaveGrid::default_max_frequency(4096.0, &Domain::unit_torus(2), pairwave::Memory(1 << 31)), [320, 320]);
    assert_eq!(
        WaveGrid::default_max_frequency(1000.0, &Domain::unit_torus(3), pairwave::Memory(1 << 31)),
        [50, 50, 50]
    );
}
