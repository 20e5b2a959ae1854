//! What is read off a power spectrum besides its rings: bands, slices, sectors, scalars, and g against P, against closed forms
//! and plain formulas written out here. Trusts the reference's raw sums and the ring means (`power_spectrum.rs`).

use std::f64::consts::PI;

use crate::common::*;
use pairwave::accumulate::WavePower;
use pairwave::accumulate::{Backend, ComputedBy};
use pairwave::compute::{Compute, cpu::Cpu};
use pairwave::control::Control;
use pairwave::estimate::{
    BandLaw, BlueNoise, LagConsistency, Normalization, PairCorrelation, PowerSpectrum, PsaStatistics, RadialSpectrum,
    SpectrumDetails, VectorCorrelation,
};
use pairwave::plan::{Accuracy, Correction, EnsembleShape, RadialBins, WaveGrid, WaveMethod, WavePlan};
use pairwave::points::{Domain, Ensemble, RawPoints};

/// Spectrum, rings and details of an ensemble, with g of distances and of lags, all by the fast path.
fn details(e: &Ensemble, f: &[u32], bins: usize, lag_bins: usize) -> (PowerSpectrum, RadialSpectrum, SpectrumDetails) {
    let (cpu, control) = (Cpu::new(Some(2)).unwrap(), Control::default());
    let plan = sectors(wave_plan(e, f, Accuracy::High), 18);
    let power = wait(cpu.wave_power(&plan, e, &control)).unwrap();
    let spectrum = PowerSpectrum::new(&plan, &power);
    let radial = RadialSpectrum::new(&plan, &power, &spectrum);
    let pairs = pair_plan(e, RadialBins::linear(e.domain().shortest_side() / 2.0, bins).unwrap(), Correction::None);
    let g = PairCorrelation::new(&pairs, &wait(cpu.pair_counts(&pairs, e, &control)).unwrap(), Normalization::Pairs);
    let lags = lag_plan(e, lag_bins, None, Correction::None);
    let vector =
        VectorCorrelation::new(&lags, &wait(cpu.lag_counts(&lags, e, &control)).unwrap(), Normalization::Pairs);
    let details = SpectrumDetails::new(&plan, &power, &spectrum, &radial, Some(&g), Some(&vector));
    (spectrum, radial, details)
}

fn sectors(plan: WavePlan, count: usize) -> WavePlan {
    if plan.domain.dim() == 2 { plan.with_sectors(count).unwrap() } else { plan }
}

/// One point in each cell of a k x k grid: P = 1 - sinc^2(m_x / k) sinc^2(m_y / k).
fn jittered(k: usize, seed: u64) -> RawPoints {
    let mut rng = Rng(seed);
    let cells = (0..k * k).flat_map(|j| [j % k, j / k]);
    raw(2, cells.map(|c| (c as f64 + rng.unit()) / k as f64).collect())
}

/// A made-up spectrum: `q(realization, m)` with norm n for every stored mode.
fn made_up(
    domain: &Domain,
    f: &[u32],
    n: f64,
    k: u64,
    mut q: impl FnMut(u64, [i32; 3]) -> f64,
) -> (WavePlan, WavePower) {
    let shape = EnsembleShape { realizations: k, mean_points: n, max_points: n as u64 };
    let plan = sectors(WavePlan::new(domain, WaveGrid::new(f).unwrap(), Accuracy::High, shape).unwrap(), 18);
    let grid = *plan.waves.grid().unwrap();
    let mut power = WavePower::new(ComputedBy::new(Backend::Reference, "by hand"), grid.half_len(), &plan.rings);
    for index in 0..k {
        let mut values: Vec<f64> = (0..grid.half_len()).map(|i| n * q(index, grid.mode(i))).collect();
        // Mirror images on the plane m_0 = 0.
        for i in 0..grid.dc() {
            values[i] = values[2 * grid.dc() - i];
        }
        values[grid.dc()] = n * n;
        power.add(index, n, &values, &plan.rings);
    }
    (plan, power)
}

fn estimates(plan: &WavePlan, power: &WavePower) -> (PowerSpectrum, RadialSpectrum, SpectrumDetails) {
    let spectrum = PowerSpectrum::new(plan, power);
    let radial = RadialSpectrum::new(plan, power, &spectrum);
    let details = SpectrumDetails::new(plan, power, &spectrum, &radial, None, None);
    (spectrum, radial, details)
}

/// Exponential ordinates of expectation 1: 95 % of bands hold it, of both laws, for rings, single modes and sectors.
#[test]
fn bands_hold_the_truth_as_often_as_they_say() {
    for (k, law) in [(1, BandLaw::ChiSquared), (6, BandLaw::ChiSquared), (40, BandLaw::StandardError)] {
        let mut rng = Rng(k);
        let (mut inside, mut all, mut shrunk) = ([0.0; 3], [0.0; 3], 0.0);
        for _ in 0..4 {
            let (plan, power) = made_up(&Domain::unit_torus(2), &[40, 40], 64.0, k, |_, _| -(1.0 - rng.unit()).ln());
            let (_, radial, details) = estimates(&plan, &power);
            let rings = radial.rings.iter().map(|r| r.band.unwrap());
            let axes = details.axes.modes.iter().map(|m| m.band.unwrap());
            let angular = details.angular.as_ref().unwrap().sectors.iter().map(|s| s.band.unwrap());
            for (which, bands) in [rings.collect::<Vec<_>>(), axes.collect(), angular.collect()].iter().enumerate() {
                all[which] += bands.len() as f64;
                inside[which] += bands.iter().filter(|b| b.lo < 1.0 && 1.0 < b.hi).count() as f64;
                // A planted fault: bands of half the width must not pass.
                let half = |b: &&pairwave::estimate::Band| (b.lo + b.hi - 2.0).abs() < 0.5 * (b.hi - b.lo);
                shrunk += bands.iter().filter(half).count() as f64;
            }
            let last = radial.rings.last().unwrap().band.unwrap();
            assert_eq!(last.law, law);
        }
        for (inside, all) in inside.into_iter().zip(all) {
            let sigma = (0.95 * 0.05 / all).sqrt();
            assert!((inside / all - 0.95).abs() < 4.0 * sigma + 0.005, "K = {k}: {inside} of {all}");
        }
        let all: f64 = all.iter().sum();
        assert!((shrunk / all - 0.95).abs() > 0.05, "half the width covers {shrunk} of {all}");
    }
}

#[test]
fn slices_and_sectors_are_their_modes() {
    // Sides 2 and 1: the direction is that of nu = m / L, 45 degrees for m = (2, 1).
    let domain = Domain::torus(&[2.0, 1.0]).unwrap();
    let e = ensemble_in(&domain, &[uniform(2, 30, 1), uniform(2, 30, 2), uniform(2, 30, 3)]);
    let (spectrum, radial, details) = details(&e, &[16, 8], 20, 16);
    let grid = spectrum.waves.grid().unwrap();
    assert_eq!(details.axes.modes.len(), 24);
    for mode in &details.axes.modes {
        let m = mode.m as i32;
        let vector = if mode.axis == 0 { [m, 0, 0] } else { [0, m, 0] };
        assert_eq!((mode.p, mode.nu), (spectrum.at(vector).unwrap(), mode.m / domain.sides()[mode.axis]));
    }
    let angular = details.angular.unwrap();
    assert_eq!(angular.sectors.len(), 18);
    let last = radial.rings.last().unwrap().nu_hi;
    for (s, sector) in angular.sectors.iter().enumerate() {
        let (mut modes, mut sum, mut rings) = (0, 0.0, 0.0);
        for a in -16..=16 {
            for b in -8..=8 {
                let (x, y) = (f64::from(a) / 2.0, f64::from(b));
                let nu = x.hypot(y);
                let degrees = y.atan2(x).to_degrees();
                let away = (degrees - 10.0 * s as f64).rem_euclid(180.0);
                if nu > 0.0 && nu < last && !(5.0..175.0).contains(&away) {
                    modes += 1;
                    sum += spectrum.p[grid.half_index([a, b, 0])];
                    rings += radial.rings[(2.0 * nu + 0.5) as usize - 1].p;
                }
            }
        }
        assert_eq!(sector.modes, modes, "sector {s}");
        assert!((sector.p - sum / modes as f64).abs() < 1e-12, "sector {s}");
        assert!((sector.ratio.unwrap() - sum / rings).abs() < 1e-12, "sector {s}");
    }
}

/// A steep isotropic profile has ratios of 1; a pattern whose power rises along x has not.
#[test]
fn steep_is_not_anisotropic() {
    let steep = |m: [i32; 3]| (f64::from(m[0]).powi(2) + f64::from(m[1]).powi(2)).sqrt().round().powi(-3);
    let unit = Domain::unit_torus(2);
    let (plan, power) = made_up(&unit, &[30, 30], 100.0, 2, |_, m| steep(m));
    let isotropic = estimates(&plan, &power).2.angular.unwrap();
    assert!(isotropic.sectors.iter().all(|s| (s.ratio.unwrap() - 1.0).abs() < 1e-9), "{:?}", isotropic.sectors);
    let along = |m: [i32; 3]| steep(m) * (1.0 + (2.0 * f64::from(m[1]).atan2(f64::from(m[0]))).cos());
    let (plan, power) = made_up(&unit, &[30, 30], 100.0, 2, |_, m| along(m));
    let sectors = estimates(&plan, &power).2.angular.unwrap().sectors;
    assert!(sectors[0].ratio.unwrap() > 1.5 && sectors[9].ratio.unwrap() < 0.5);
}

/// P of jittered points in closed form: ring means give the mean over a disk, and with it the effective Nyquist frequency, near
/// 1/4; an ideal step at sqrt(n / pi) has 1 / sqrt(0.9 pi); independent points have 0.
#[test]
fn the_effective_nyquist_frequency_of_known_spectra() {
    let unit = Domain::unit_torus(2);
    let n = 64f64 * 64.0;
    let nyquist = |p: &dyn Fn([i32; 3]) -> f64| {
        let (plan, power) = made_up(&unit, &[160, 160], n, 2, |_, m| p(m));
        estimates(&plan, &power).2.scalars.blue_noise.unwrap()
    };
    let sinc = |m: i32| {
        if m == 0 {
            1.0
        } else {
            let x = PI * f64::from(m) / 64.0;
            (x.sin() / x).powi(2)
        }
    };
    let jittered = nyquist(&|m| 1.0 - sinc(m[0]) * sinc(m[1]));
    // E(nu) = pi^2 nu^2 / (6 n) - ..., the next term by a fine sum over the closed form: 0.2519.
    assert!((jittered.effective_nyquist.unwrap() - 0.2519).abs() < 0.002, "{jittered:?}");
    let radius = |m: [i32; 3]| f64::from(m[0]).hypot(f64::from(m[1]));
    let step = nyquist(&|m| if radius(m) < (n / PI).sqrt() { 0.0 } else { 1.0 });
    assert!((step.effective_nyquist.unwrap() - 1.0 / (0.9 * PI).sqrt()).abs() < 0.005, "{step:?}");
    assert!(step.oscillation.unwrap() < 0.2, "{step:?}");
    let random = nyquist(&|_| 1.0);
    assert_eq!((random.effective_nyquist, random.oscillation), (Some(0.0), Some(0.0)));
    // P = 1 + a from the first ring on: the integral is a^2 (nu_1^2 - nu_0^2) / 2, the oscillation 10 a.
    let raised = nyquist(&|_| 1.25);
    assert!((raised.oscillation.unwrap() - 2.5).abs() < 1e-3, "{raised:?}");
    let dark = nyquist(&|_| 0.0);
    assert_eq!((dark.effective_nyquist, dark.oscillation), (None, None));
    let (plan, power) = made_up(&Domain::unit_torus(3), &[8, 8, 8], 64.0, 1, |_, _| 1.0);
    let (spectrum, radial, _) = estimates(&plan, &power);
    assert_eq!(BlueNoise::new(&plan, &spectrum, &radial), None);
}

/// Counts of an ideal gas: g = 1, P = 1, no oscillation. And a hole in g of known transform.
#[test]
fn psa_statistics_of_known_counts() {
    let n = 400;
    let bins = PsaStatistics::bins(n);
    assert_eq!(bins, 2000);
    let (points, dr) = (n as f64, 0.5 / bins as f64);
    let ring = |i: usize| 0.5 * points * (points - 1.0) * PI * dr * dr * (2 * i + 1) as f64;
    // Scaled up, so that rounding to integers does not matter; n (n - 1) scales with it.
    let counts = |g: &dyn Fn(f64) -> f64| {
        vec![(0..bins).map(|i| (ring(i) * g(i as f64 * dr)).round() as u64).collect::<Vec<_>>()]
    };
    let random = PsaStatistics::new(n, &counts(&|_| 1.0)).unwrap();
    assert_eq!(random.effective_nyquist, 0.0);
    assert!(random.oscillation < 0.5, "rounded counts: {random:?}");
    // g = 1 - (nu_0 / (n r)) J_1(2 pi nu_0 r): P = 0 below nu_0, 1 above, smoothed.
    let edge = (points / PI).sqrt();
    let hole = move |r: f64| if r == 0.0 { 0.0 } else { 1.0 - edge / (points * r) * libm::j1(2.0 * PI * edge * r) };
    let step = PsaStatistics::new(n, &counts(&hole)).unwrap();
    assert!((0.45..0.65).contains(&step.effective_nyquist), "{step:?}");
    assert_eq!(PsaStatistics::new(1, &[vec![0; 100]]), None);
    assert_eq!(PsaStatistics::new(n, &[vec![0; 3]]), None);
}

/// P = nu^b with exponential scatter: the interval holds b as often as it says, and a wrong b hardly ever.
#[test]
fn the_exponent_at_low_frequency() {
    let unit = Domain::unit_torus(2);
    for b in [0.0, 1.0, 2.0, -1.0] {
        let (mut inside, mut wrong, runs) = (0, 0, 60);
        for seed in 0..runs {
            let mut rng = Rng(1000 + seed);
            let profile = |m: [i32; 3]| (f64::from(m[0]).hypot(f64::from(m[1])) / 40.0).powf(b);
            let (plan, power) = made_up(&unit, &[12, 12], 1600.0, 4, |_, m| -profile(m) * (1.0 - rng.unit()).ln());
            let low = estimates(&plan, &power).2.scalars.low_frequency.unwrap();
            assert_eq!(low.rings, 8);
            let [lo, hi] = low.exponent_interval.unwrap();
            inside += u32::from(lo <= b && b <= hi);
            wrong += u32::from(lo <= b + 1.0 && b + 1.0 <= hi);
        }
        assert!(inside >= 51 && wrong <= 12, "b = {b}: {inside} of {runs}, the wrong exponent {wrong}");
    }
}

#[test]
fn the_hyperuniformity_index_is_a_line() {
    let unit = Domain::unit_torus(2);
    let line = |m: [i32; 3]| 0.03 + 0.01 * f64::from(m[0]).hypot(f64::from(m[1])).round();
    let (plan, power) = made_up(&unit, &[40, 40], 400.0, 2, |_, m| if m[0] == 30 && m[1] == 0 { 2.0 } else { line(m) });
    let (_, radial, details) = estimates(&plan, &power);
    let low = details.scalars.low_frequency.unwrap();
    let peak = radial.rings.iter().map(|r| r.p).fold(1.0, f64::max);
    assert!((low.hyperuniformity_index - 0.03 / peak).abs() < 1e-9 && low.rings == 4, "{low:?}");
    // P = 0: no exponent, an index of 0; too few rings: nothing.
    let (plan, power) = made_up(&unit, &[40, 40], 400.0, 2, |_, _| 0.0);
    let low = estimates(&plan, &power).2.scalars.low_frequency.unwrap();
    assert_eq!((low.hyperuniformity_index, low.exponent, low.exponent_interval), (0.0, None, None));
    let (plan, power) = made_up(&unit, &[3, 3], 400.0, 2, |_, _| 1.0);
    assert_eq!(estimates(&plan, &power).2.scalars.low_frequency, None);
}

/// Its error across realizations is that of the realizations' own means.
#[test]
fn the_level_at_high_frequency() {
    let sets: Vec<_> = (0..5).map(|s| uniform(2, 20, s)).collect();
    let e = ensemble(&sets);
    let (_, _, all) = details(&e, &[20, 20], 20, 8);
    let high = all.scalars.high_frequency.unwrap();
    assert_eq!(high.range, [10.5, 20.5]);
    let each: Vec<f64> = (0..5)
        .map(|k| {
            let (_, radial, _) = details(&e.slice(k..k + 1), &[20, 20], 20, 8);
            let (sum, modes) =
                radial.rings[10..].iter().fold((0.0, 0.0), |(s, n), r| (s + r.p * r.modes as f64, n + r.modes as f64));
            sum / modes
        })
        .collect();
    let mean = each.iter().sum::<f64>() / 5.0;
    let se = (each.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / 20.0).sqrt();
    assert!((high.p - mean).abs() < 1e-12 && (high.p_se - se).abs() < 1e-9, "{high:?}: {mean} +- {se}");
    let (_, _, low) = details(&e, &[6, 6], 20, 8);
    assert_eq!(low.scalars.high_frequency, None, "nothing is beyond one cycle per mean spacing");
}

/// The sum over the grid and its tail against the sum over all pairs, with weights of both signs and without.
#[test]
fn diaphony_is_the_sum_over_pairs() {
    for (dim, f, tolerance) in [(1, 4000, 2e-4), (2, 200, 2e-2), (3, 20, 8e-2)] {
        for weighted in [false, true] {
            let set = uniform(dim, 50, 9);
            let weights: Vec<f64> = (0..50).map(|j| if weighted { f64::from(j % 7) - 1.5 } else { 1.0 }).collect();
            let mut e = ensemble(std::slice::from_ref(&set));
            if weighted {
                e = e.with_weights(&weights);
            }
            let plan = wave_plan(&e, &vec![f; dim], Accuracy::High);
            let found = estimates(&plan, &reference_power(&plan, &e)).2.scalars.diaphony.unwrap();
            let mut sum = 0.0;
            for (i, a) in set.coordinates.chunks(dim).enumerate() {
                for (j, b) in set.coordinates.chunks(dim).enumerate() {
                    let term = |k: usize| {
                        let x = (a[k] - b[k]).rem_euclid(1.0);
                        1.0 + 2.0 * PI * PI * (x * x - x + 1.0 / 6.0)
                    };
                    sum += weights[i] * weights[j] * ((0..dim).map(term).product::<f64>() - 1.0);
                }
            }
            let total: f64 = weights.iter().sum();
            let exact = sum / (total * total) / ((1.0 + PI * PI / 3.0).powi(dim as i32) - 1.0);
            let squared = found.diaphony * found.diaphony;
            let apart = (squared / exact - 1.0).abs();
            assert!(apart < tolerance, "{dim}D, weighted {weighted}: {squared} against {exact}");
            assert!(found.tail_squared > 0.0 && found.tail_squared < squared);
        }
    }
}

/// P from g and g from P where both are known: jittered points. Without the integral over bins, with another normalization, or
/// with P - 1 of the wrong sign the difference would be tens of errors.
#[test]
fn g_and_p_give_each_other() {
    let sets: Vec<_> = (0..40).map(|s| jittered(16, s)).collect();
    let e = ensemble(&sets);
    let (_, radial, all) = details(&e, &[60, 60], 256, 32);
    let of_pcf = all.of_pcf.unwrap();
    println!("rms {}, in errors {}", of_pcf.rms, of_pcf.rms_in_standard_errors);
    assert!(of_pcf.rms_in_standard_errors < 1.3, "{}", of_pcf.rms_in_standard_errors);
    let scatter = radial.rings.iter().map(|r| (r.p_se / 1.0).powi(2)).sum::<f64>() / radial.rings.len() as f64;
    assert!(of_pcf.rms < 2.0 * scatter.sqrt(), "{}", of_pcf.rms);
    // g of jittered points, mean over directions: 1 - (4 x - x^2) / pi for x = 16 r <= 1, subtracted from 1.
    for (i, &r) in of_pcf.r.iter().enumerate().filter(|(_, r)| (0.02..0.06).contains(*r)) {
        let x = 16.0 * r;
        let exact = (4.0 * x - x * x) / PI * 256.0 / 255.0;
        assert!((of_pcf.g_from_p[i] - exact).abs() < 0.05, "r = {r}: {} against {exact}", of_pcf.g_from_p[i]);
    }
}

/// Independent points in one, two and three dimensions, on unequal sides: both figures are what theory says, and a few pairs in
/// the wrong cell are seen.
#[test]
fn lag_counts_and_wave_power_agree_within_aliasing() {
    for (dim, n, f, bins) in [(1, 300, 60, 64), (2, 300, 24, 32), (3, 200, 8, 12)] {
        let domain = Domain::torus(&[1.5, 1.0, 0.8][..dim]).unwrap();
        let sets: Vec<_> = (0..6).map(|s| uniform(dim, n, 70 + s)).collect();
        let e = ensemble_in(&domain, &sets);
        let (_, _, all) = details(&e, &vec![f; dim], 64, bins);
        let lags = all.lags.unwrap();
        println!("{dim}D: {lags:?}");
        assert!((0.6..1.5).contains(&lags.ratio), "{dim}D: {lags:?}");
        assert!(all.of_pcf.unwrap().rms_in_standard_errors < 1.6, "{dim}D");
    }
    let e = ensemble(&(0..20).map(|s| jittered(20, s)).collect::<Vec<_>>());
    let plan = wave_plan(&e, &[30, 30], Accuracy::High);
    let (cpu, control) = (Cpu::new(Some(2)).unwrap(), Control::default());
    let spectrum = PowerSpectrum::new(&plan, &wait(cpu.wave_power(&plan, &e, &control)).unwrap());
    let lags = lag_plan(&e, 40, None, Correction::None);
    let vector =
        VectorCorrelation::new(&lags, &wait(cpu.lag_counts(&lags, &e, &control)).unwrap(), Normalization::Pairs);
    let right = LagConsistency::new(e.domain(), shape(&e), &vector, &spectrum).unwrap();
    assert!((0.6..1.5).contains(&right.ratio), "{right:?}");
    let mut wrong = vector.clone();
    wrong.count.rotate_right(1);
    let seen = LagConsistency::new(e.domain(), shape(&e), &wrong, &spectrum).unwrap();
    assert!(seen.ratio > 2.0 * right.ratio, "{seen:?}");
}

#[test]
fn hostile_spectra_are_defined_or_absent() {
    let finite = |d: &SpectrumDetails, r: &RadialSpectrum| {
        let band = |b: Option<pairwave::estimate::Band>| b.is_none_or(|b| b.lo.is_finite() && b.hi.is_finite());
        assert!(d.axes.modes.iter().all(|m| m.p.is_finite() && band(m.band)));
        assert!(r.rings.iter().all(|r| r.p.is_finite() && band(r.band) && r.anisotropy_db.is_none_or(f64::is_finite)));
        let sectors = d.angular.iter().flat_map(|a| &a.sectors);
        assert!(sectors.into_iter().all(|s| s.p.is_finite() && band(s.band) && s.ratio.is_none_or(f64::is_finite)));
        let s = &d.scalars;
        assert!(s.diaphony.is_none_or(|d| d.diaphony.is_finite()));
        assert!(s.high_frequency.is_none_or(|h| h.p.is_finite() && h.p_se.is_finite()));
        let low = s.low_frequency;
        assert!(low.is_none_or(|l| l.hyperuniformity_index.is_finite() && l.exponent.is_none_or(f64::is_finite)));
        let of_pcf = d.of_pcf.as_ref();
        assert!(
            of_pcf.is_none_or(|s| s.p_from_g.iter().chain(&s.g_from_p).all(|v| v.is_finite()) && s.rms.is_finite())
        );
    };
    // All points equal: P = n for every m; F = 0: no ring; a single ring; one dimension: single modes.
    for (set, f) in [
        (raw(2, vec![0.3; 40]), vec![9, 9]),
        (uniform(2, 30, 1), vec![0, 0]),
        (uniform(2, 30, 1), vec![1, 1]),
        (uniform(2, 30, 1), vec![1, 0]),
        (uniform(1, 30, 1), vec![40]),
        (uniform(3, 30, 1), vec![6, 6, 6]),
        (lattice(2, 6), vec![30, 30]),
    ] {
        let (spectrum, radial, all) = details(&ensemble(&[set]), &f, 16, 8);
        finite(&all, &radial);
        assert_eq!(all.axes.modes.len() as u32, f.iter().sum::<u32>());
        if f == [9, 9] {
            assert!(spectrum.p.iter().all(|p| (p - 20.0).abs() < 1e-9));
            assert!(radial.rings.iter().all(|r| r.anisotropy_db.is_none()));
        }
        if f[0] == 0 {
            assert!(radial.rings.is_empty() && all.angular.is_none() && all.of_pcf.is_none());
            assert_eq!((all.scalars.blue_noise, all.scalars.low_frequency), (None, None));
        }
    }
    // Weights that sum to 0 leave P(0) = 0, and with it no diaphony and no transforms.
    let e = ensemble(&[uniform(2, 4, 1)]).with_weights(&[1.0, -1.0, 2.0, -2.0]);
    let plan = sectors(wave_plan(&e, &[8, 8], Accuracy::High), 18);
    let (_, radial, all) = estimates(&plan, &reference_power(&plan, &e));
    finite(&all, &radial);
    assert_eq!(all.scalars.diaphony, None);
}

#[test]
fn sectors_are_refused_where_there_are_none() {
    let e = ensemble(&[uniform(3, 30, 1)]);
    assert!(wave_plan(&e, &[4, 4, 4], Accuracy::High).with_sectors(18).is_err());
    let e = ensemble(&[uniform(2, 30, 1)]);
    for count in [0, 3601] {
        let refusal = wave_plan(&e, &[4, 4], Accuracy::High).with_sectors(count).unwrap_err();
        assert!(refusal.to_string().starts_with(&format!("sectors {count}: expected 1 to 3600")), "{refusal}");
    }
}

/// Where only rings are computed, nothing is read from the corners of the grid, which stay 0.
#[test]
fn rings_alone_are_enough_or_nothing_is_said() {
    let domain = Domain::torus(&[3.0, 1.0]).unwrap();
    let mut rng = Rng(5);
    let points: Vec<f64> = (0..400).map(|j| rng.unit() * if j % 2 == 0 { 3.0 } else { 1.0 }).collect();
    let e = Ensemble::from_raw(&[raw(2, points)], &domain, false, 0).unwrap();
    let whole =
        WavePlan { method: Some(WaveMethod::DirectF64), ..sectors(wave_plan(&e, &[60, 30], Accuracy::High), 18) };
    let rings = WavePlan { rings_only: true, ..whole.clone() };
    let cpu = Cpu::new(Some(1)).unwrap();
    let [whole, rings] =
        [whole, rings].map(|plan| estimates(&plan, &wait(cpu.wave_power(&plan, &e, &Control::default())).unwrap()).2);
    assert_eq!(rings.angular, whole.angular);
    assert!(rings.axes.modes.len() < whole.axes.modes.len());
    for mode in &rings.axes.modes {
        assert!(whole.axes.modes.contains(mode), "{mode:?}");
    }
    let [a, b] = [&rings, &whole].map(|d| d.scalars.blue_noise.unwrap());
    assert_eq!(a.effective_nyquist, b.effective_nyquist);
    // Independent points: what remains is noise, near 100 / (pi (nu_0 + nu_1)) squared.
    assert!(a.oscillation.is_none_or(|o| o < 2.0 * b.oscillation.unwrap()), "{a:?}, {b:?}");
    let [a, b] = [&rings, &whole].map(|d| d.scalars.diaphony.unwrap().diaphony);
    assert!((a / b - 1.0).abs() < 0.05 && a != b, "{a}, {b}");
}
