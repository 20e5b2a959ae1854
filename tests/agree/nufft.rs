//! The nonuniform FFT against the definition: exact phases, sines and cosines in f64, term by term.

use pairwave::compute::cpu::SimdLevel;
use pairwave::compute::cpu::nufft::{Nonuniform, Nufft, Scratch};
use pairwave::compute::reference::phase_turns;
use pairwave::control::Control;
use pairwave::plan::{Accuracy, WaveGrid};
use rustfft::num_complex::Complex;

/// So few and so many points that the plan takes the coarsest and the finest of its grids.
const COARSE: f64 = 1.0;
const FINE: f64 = 1e12;

/// SplitMix64.
struct Rng(u64);

impl Rng {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / 2f64.powi(53)
    }
}

/// Points of any kind, weighted or not.
struct Case {
    axes: Vec<Vec<u64>>,
    weights: Option<Vec<f64>>,
}

impl Case {
    fn uniform(dim: usize, n: usize, seed: u64) -> Self {
        let mut rng = Rng(seed);
        Self { axes: (0..dim).map(|_| (0..n).map(|_| rng.bits()).collect()).collect(), weights: None }
    }

    fn weighted(mut self, seed: u64) -> Self {
        let mut rng = Rng(seed);
        self.weights = Some(self.axes[0].iter().map(|_| 2.0 * rng.unit() - 1.0).collect());
        self
    }

    fn views(&self) -> Vec<&[u64]> {
        self.axes.iter().map(Vec::as_slice).collect()
    }

    /// The sum of all `|w|`: no amplitude is larger.
    fn scale(&self) -> f64 {
        self.weights.as_ref().map_or(self.axes[0].len() as f64, |w| w.iter().map(|w| w.abs()).sum())
    }

    /// The definition, at one mode.
    fn amplitude(&self, m: [i32; 3]) -> Complex<f64> {
        let axes = self.views();
        let term = |j: usize| {
            let (sin, cos) = (std::f64::consts::TAU * phase_turns(&axes, m.map(f64::from), j)).sin_cos();
            Complex::new(cos, -sin) * self.weights.as_ref().map_or(1.0, |w| w[j])
        };
        (0..self.axes[0].len()).map(term).sum()
    }

    fn reference(&self, grid: &WaveGrid) -> Vec<Complex<f64>> {
        (0..grid.half_len()).map(|index| self.amplitude(grid.mode(index))).collect()
    }

    fn amplitudes_by(&self, nufft: &Nufft, grid: &WaveGrid, pool: Option<&pairwave::Pool>) -> Vec<Complex<f64>> {
        // NaN, so that whatever is not written cannot pass.
        let mut out = vec![Complex::new(f64::NAN, f64::NAN); grid.half_len()];
        let points = Nonuniform { axes: &self.views(), weights: self.weights.as_deref() };
        nufft.amplitudes(&points, &mut Scratch::default(), pool, &Control::default(), &mut out).unwrap();
        out
    }

    fn amplitudes(&self, grid: &WaveGrid, tolerance: f64, points: f64) -> Vec<Complex<f64>> {
        let nufft = Nufft::new(grid, tolerance, points, SimdLevel::detect()).unwrap();
        self.amplitudes_by(&nufft, grid, None)
    }

    fn power(&self, grid: &WaveGrid, tolerance: f64, points: f64) -> Vec<f64> {
        let nufft = Nufft::new(grid, tolerance, points, SimdLevel::detect()).unwrap();
        let mut out = vec![f64::NAN; grid.half_len()];
        let points = Nonuniform { axes: &self.views(), weights: self.weights.as_deref() };
        nufft.power(&points, &mut Scratch::default(), None, &Control::default(), &mut out).unwrap();
        out
    }
}

fn grid(f: &[u32]) -> WaveGrid {
    WaveGrid::new(f).unwrap()
}

/// The relative l2 error of all amplitudes but DC, which is exact and would hide the others.
fn l2_error(a: &[Complex<f64>], reference: &[Complex<f64>], dc: usize) -> f64 {
    let pairs = || a.iter().zip(reference).enumerate().filter(|&(index, _)| index != dc);
    let off: f64 = pairs().map(|(_, (a, r))| (a - r).norm_sqr()).sum();
    (off / pairs().map(|(_, (_, r))| r.norm_sqr()).sum::<f64>()).sqrt()
}

/// The largest error of an amplitude.
fn max_error(a: &[Complex<f64>], reference: &[Complex<f64>]) -> f64 {
    // `max` would drop a NaN.
    a.iter().zip(reference).map(|(a, r)| (a - r).norm()).fold(0.0, |max, e| if e <= max { max } else { e })
}

/// Why amplitudes break the promise of a tolerance, if they do.
fn broken(a: &[Complex<f64>], reference: &[Complex<f64>], dc: usize, scale: f64, tolerance: f64) -> Option<String> {
    let (l2, max) = (l2_error(a, reference, dc), max_error(a, reference) / scale);
    let kept = l2 <= tolerance && max <= tolerance;
    (!kept).then(|| format!("tolerance {tolerance:e}: l2 {l2:e}, max {max:e}"))
}

#[test]
fn the_error_keeps_every_tolerance() {
    for f in [&[45][..], &[23, 17], &[9, 7, 8]] {
        let grid = grid(f);
        for (kind, case) in
            [("uniform", Case::uniform(f.len(), 400, 1)), ("weighted", Case::uniform(f.len(), 300, 2).weighted(3))]
        {
            let reference = case.reference(&grid);
            for tolerance in (2..=28).map(|half| 10f64.powf(-0.5 * f64::from(half))) {
                for points in [COARSE, FINE] {
                    let found = case.amplitudes(&grid, tolerance, points);
                    let l2 = l2_error(&found, &reference, grid.dc());
                    let max = max_error(&found, &reference) / case.scale();
                    println!(
                        "{}D {kind}, {tolerance:.1e}: l2 {l2:.1e} (clearance {:.1}), max {max:.1e} of the sum of |w|",
                        f.len(),
                        tolerance / l2
                    );
                    let why = broken(&found, &reference, grid.dc(), case.scale(), tolerance);
                    assert_eq!(why, None, "{}D {kind}", f.len());
                }
            }
        }
    }
}

#[test]
fn a_planted_fault_is_caught() {
    let (grid, case) = (grid(&[20, 15]), Case::uniform(2, 500, 4));
    let (reference, tolerance) = (case.reference(&grid), 1e-6);
    let check = |a: &[Complex<f64>]| broken(a, &reference, grid.dc(), case.scale(), tolerance);
    let good = case.amplitudes(&grid, tolerance, FINE);
    assert_eq!(check(&good), None);
    let index = grid.half_index([7, -3, 0]);
    for wrong in [good[index].conj(), good[index] * (1.0 + 1e-2), Complex::new(f64::NAN, 0.0)] {
        let mut bad = good.clone();
        bad[index] = wrong;
        assert!(check(&bad).is_some(), "{wrong} passes for {}", good[index]);
    }
    let mut moved = Case { axes: case.axes.clone(), weights: None };
    moved.axes[1][17] = moved.axes[1][17].wrapping_add(1 << 54);
    assert!(check(&moved.amplitudes(&grid, tolerance, FINE)).is_some(), "a point 1/1024 off passes");
}

#[test]
fn every_shape_of_grid_and_every_kind_of_points() {
    let end = u64::MAX;
    for f in [
        &[0][..],
        &[1],
        &[2],
        &[3],
        &[100],
        &[1000],
        &[0, 0],
        &[0, 5],
        &[5, 0],
        &[1, 1],
        &[2, 31],
        &[40, 3],
        &[0, 0, 0],
        &[0, 3, 4],
        &[4, 0, 3],
        &[3, 4, 0],
        &[0, 0, 6],
        &[6, 0, 0],
        &[1, 2, 9],
        &[12, 2, 1],
    ] {
        let (dim, grid) = (f.len(), grid(f));
        // Cells have corners at multiples of 1 / 5-smooth numbers; powers of two are such points whatever the grid.
        let corners: Vec<u64> =
            vec![0, 1, 1 << 63, (1 << 63) - 1, 1 << 62, 3 << 60, 7 << 55, end, end - 1, end / 3, end / 5];
        let same = |x: u64, n: usize| Case { axes: vec![vec![x; n]; dim], weights: None };
        let turned = |a: usize| corners.iter().cycle().skip(4 * a).take(corners.len()).copied().collect();
        let cases = [
            ("no points", same(0, 0)),
            ("one", same(end / 7, 1)),
            ("all equal", same(end / 3, 50)),
            ("all at the origin", same(0, 50)),
            ("all at the far end", same(end, 50)),
            ("corners", Case { axes: (0..dim).map(turned).collect(), weights: None }),
            ("uniform", Case::uniform(dim, 33, 5)),
            ("weighted", Case::uniform(dim, 33, 6).weighted(7)),
        ];
        for (name, case) in cases {
            let reference = case.reference(&grid);
            for (tolerance, points) in [(1e-4, COARSE), (1e-4, FINE), (1e-12, COARSE), (1e-12, FINE)] {
                let found = case.amplitudes(&grid, tolerance, points);
                let error = max_error(&found, &reference);
                assert!(error <= 2.0 * tolerance * case.scale(), "{name}, |m| <= {f:?}, {tolerance:e}: {error:e}");
                assert!(
                    (found[grid.dc()].re - reference[grid.dc()].re).abs() <= 1e-15 * case.scale()
                        && found[grid.dc()].im == 0.0
                );
                let power = case.power(&grid, tolerance, points);
                for (index, (p, s)) in power.iter().zip(&found).enumerate() {
                    assert_eq!(*p, s.norm_sqr(), "{name}, mode {:?}", grid.mode(index));
                }
            }
        }
    }
}

#[test]
fn high_frequencies_lose_nothing() {
    // 65,537 is no frequency of the fine grid's length, so neighbouring points are told apart by the fraction alone.
    let (grid, case) = (grid(&[65_537]), Case::uniform(1, 1000, 8));
    let found = case.amplitudes(&grid, Accuracy::High.nufft_tolerance(), FINE);
    let worst = (0..400)
        .map(|k| 65_537 - k * k % 65_000)
        .map(|m: i32| (found[m as usize] - case.amplitude([m, 0, 0])).norm() / 1000f64.sqrt());
    let worst = worst.fold(0.0, |max: f64, e| if e <= max { max } else { e });
    println!("worst error to |m| = 65,537: {worst:.1e}");
    assert!(worst <= 1e-13);
}

/// `max |P - P_ref| / (1 + P_ref)` and the rms of `P - P_ref`, at `count` modes all over the grid.
fn power_errors(case: &Case, grid: &WaveGrid, tolerance: f64, count: usize) -> (f64, f64) {
    let n = case.axes[0].len() as f64;
    let power = case.power(grid, tolerance, n);
    let (mut max, mut squares, mut rng) = (0f64, 0.0, Rng(9));
    for _ in 0..count {
        let index = (rng.bits() % grid.half_len() as u64) as usize;
        let (p, r) = (power[index] / n, case.amplitude(grid.mode(index)).norm_sqr() / n);
        let error = (p - r).abs() / (1.0 + r);
        assert!(error.is_finite(), "P = {p} where the reference has {r}");
        max = max.max(error);
        squares += (p - r).powi(2);
    }
    (max, (squares / count as f64).sqrt())
}

#[test]
fn the_tolerances_of_the_accuracy_levels_keep_their_promises() {
    for (name, tolerance, max, rms, lattice_zero) in [
        ("fast", Accuracy::Fast.nufft_tolerance(), 1e-5, 1.5e-7, 1e-12),
        ("high", Accuracy::High.nufft_tolerance(), 1e-11, 1e-12, 1e-24),
    ] {
        for (f, n, count) in [(&[200, 200][..], 65_536, 100), (&[24, 20, 22], 10_000, 300), (&[20_000], 10_000, 300)] {
            let grid = grid(f);
            let (found_max, found_rms) = power_errors(&Case::uniform(f.len(), n, 10), &grid, tolerance, count);
            println!("{name}, {}D uniform: max {found_max:.1e} of {max:e}, rms {found_rms:.1e} of {rms:e}", f.len());
            assert!(found_max <= max && found_rms <= rms, "{name}, {}D: max {found_max:e}, rms {found_rms:e}", f.len());
        }
        // P = 0 is exact where m is not in the dual lattice, and n where it is.
        let n = 65_536u64;
        for z in [19_463, 17_797, 25_245] {
            let axes = [1, z].map(|z| (0..n).map(|i| (i * z % n) << 48).collect()).to_vec();
            let grid = grid(&[256, 256]);
            let power = Case { axes, weights: None }.power(&grid, tolerance, n as f64);
            let mut worst = 0f64;
            for (index, p) in power.iter().enumerate() {
                let m = grid.mode(index);
                if (i64::from(m[0]) + i64::from(m[1]) * z as i64).rem_euclid(n as i64) != 0 {
                    worst = if p / n as f64 <= worst { worst } else { p / n as f64 };
                }
            }
            println!("{name}, rank-1 lattice (1, {z}): largest P where P = 0 is {worst:.1e} of {lattice_zero:e}");
            assert!(worst <= lattice_zero, "{name}: {worst:e}");
        }
    }
}

#[test]
fn jittered_lattices_keep_their_smallest_powers() {
    // P grows from 1e-11 with the square of the frequency.
    let (k, grid) = (64, grid(&[128, 128]));
    for (name, tolerance, bound) in
        [("fast", Accuracy::Fast.nufft_tolerance(), 3e-4), ("high", Accuracy::High.nufft_tolerance(), 1e-9)]
    {
        let mut rng = Rng(11);
        let mut place = |i: usize| (((i as f64 + 0.5 + 1.5e-4 * (rng.unit() - 0.5)) / k as f64) * 2f64.powi(64)) as u64;
        let (x, y) = (0..k * k).map(|j| (place(j % k), place(j / k))).unzip();
        let case = Case { axes: vec![x, y], weights: None };
        let (power, n) = (case.power(&grid, tolerance, (k * k) as f64), (k * k) as f64);
        let mut errors = Vec::new();
        let mut least = f64::INFINITY;
        for _ in 0..1500 {
            let index = (rng.bits() % grid.half_len() as u64) as usize;
            let reference = case.amplitude(grid.mode(index)).norm_sqr();
            least = least.min(reference / n);
            errors.push((power[index] - reference).abs() / reference);
        }
        errors.sort_by(f64::total_cmp);
        let median = errors[errors.len() / 2];
        println!("{name}: median relative error {median:.1e} of {bound:e}, smallest P {least:.1e}");
        assert!(median <= bound && least < 1e-10);
    }
}

#[test]
fn threads_memory_and_scratch_do_not_change_a_bit() {
    let mut scratch = Scratch::default();
    for (f, n) in [(&[30_000][..], 100_000), (&[90, 170], 70_000), (&[10, 33, 25], 40_000)] {
        let grid = grid(f);
        for weighted in [false, true] {
            let case = Case::uniform(f.len(), n, 12);
            let case = if weighted { case.weighted(13) } else { case };
            let nufft = Nufft::new(&grid, 1e-7, n as f64, SimdLevel::detect()).unwrap();
            let one = case.amplitudes_by(&nufft, &grid, None);
            for threads in [1, 2, 3, 7] {
                let pool = pairwave::Pool::new(Some(threads)).unwrap();
                assert_eq!(one, case.amplitudes_by(&nufft, &grid, Some(&pool)), "{f:?} on {threads} threads");
            }
            // In bands and in blocks of frequencies, down to one of each at a time.
            for memory in [pairwave::Memory(0), pairwave::Memory(1 << 21)] {
                let nufft = Nufft::new(&grid, 1e-7, n as f64, SimdLevel::detect()).unwrap().within(memory);
                for pool in [None, Some(&pairwave::Pool::new(Some(3)).unwrap())] {
                    assert_eq!(one, case.amplitudes_by(&nufft, &grid, pool), "{f:?} within {memory}");
                }
            }
            // What another plan and other points left behind.
            let mut out = vec![Complex::default(); grid.half_len()];
            let points = Nonuniform { axes: &case.views(), weights: case.weights.as_deref() };
            nufft.amplitudes(&points, &mut scratch, None, &Control::default(), &mut out).unwrap();
            assert_eq!(one, out, "{f:?} with used scratch");
        }
    }
}

#[test]
fn every_instruction_set_agrees() {
    for f in [&[300][..], &[40, 30], &[9, 12, 8]] {
        let (grid, case) = (grid(f), Case::uniform(f.len(), 2000, 14).weighted(15));
        for tolerance in [1e-5, 1e-12] {
            let by = |level: SimdLevel| {
                let nufft = Nufft::new(&grid, tolerance, FINE, level.min(SimdLevel::detect())).unwrap();
                case.amplitudes_by(&nufft, &grid, None)
            };
            let portable = by(SimdLevel::Portable);
            for level in [SimdLevel::Avx2, SimdLevel::Avx512] {
                let error = max_error(&by(level), &portable) / case.scale();
                assert!(error <= 1e-15, "{f:?}, {}: {error:e}", level.name());
            }
        }
    }
}

#[test]
fn extreme_weights_keep_the_relative_error() {
    let grid = grid(&[20, 20]);
    let plain = Case::uniform(2, 100, 16).weighted(17);
    let expected = plain.amplitudes(&grid, 1e-9, FINE);
    for factor in [1e30, 1e-30] {
        let weights = plain.weights.as_ref().map(|w| w.iter().map(|w| w * factor).collect());
        let found = Case { axes: plain.axes.clone(), weights }.amplitudes(&grid, 1e-9, FINE);
        let scaled: Vec<_> = expected.iter().map(|s| s * factor).collect();
        let error = max_error(&found, &scaled) / (factor * plain.scale());
        assert!(error <= 1e-14, "weights of {factor:e}: {error:e}");
    }
}

#[test]
fn impossible_tolerances_are_errors_that_name_the_possible() {
    for tolerance in [0.0, -1e-6, 1e-15, 3.9e-15, 0.5, 1.0, f64::NAN, f64::INFINITY] {
        let why = Nufft::new(&grid(&[8, 8]), tolerance, 100.0, SimdLevel::detect()).err().map(|e| e.to_string());
        let why = why.unwrap_or_else(|| panic!("{tolerance} is accepted"));
        assert!(why.contains("4e-15") && why.contains("0.1"), "{why}");
    }
}

#[test]
fn cancelled_work_says_so() {
    let (grid, case) = (grid(&[20, 20]), Case::uniform(2, 100, 18));
    let nufft = Nufft::new(&grid, 1e-6, 100.0, SimdLevel::detect()).unwrap();
    let control = Control::default();
    control.cancel();
    let points = Nonuniform { axes: &case.views(), weights: None };
    let result = nufft.power(&points, &mut Scratch::default(), None, &control, &mut vec![0.0; grid.half_len()]);
    assert!(matches!(result, Err(pairwave::Error::Cancelled)));
}
