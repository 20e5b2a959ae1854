//! The bottom of the chain of trust: the reference against hand-worked cases, closed forms, and rustfft on points that
//! sit on a grid. Trusts nothing but arithmetic; cannot see an error that reference and closed form share.

use crate::common::*;
use pairwave::compute::reference::isotropic_weight;
use pairwave::estimate::{KFunction, Normalization, PairCorrelation, PowerSpectrum, VectorCorrelation};
use pairwave::plan::{Accuracy, Correction, PairPlan, PairSettings, RadialBins, WaveGrid};
use pairwave::points::{Domain, Ensemble, RawPoints};

fn counts(points: RawPoints, edges: &[f64]) -> Vec<u64> {
    let ensemble = ensemble(&[points]);
    let bins = RadialBins::from_edges(edges.to_vec()).unwrap();
    reference_counts(&pair_plan(&ensemble, bins, Correction::None), &ensemble).counts
}

/// `|s_m|^2` of one realization by the reference, at any m of the grid.
fn power(points: RawPoints, max_frequency: &[u32]) -> (WaveGrid, Vec<f64>) {
    let ensemble = ensemble(&[points]);
    let plan = wave_plan(&ensemble, max_frequency, Accuracy::High);
    (*plan.waves.grid().unwrap(), reference_power(&plan, &ensemble).mode_totals().q)
}

#[test]
fn one_two_and_three_points_by_hand() {
    let edges = [0.0, 0.125, 0.25, 0.375, 0.5];
    assert_eq!(counts(raw(2, vec![0.5, 0.5]), &edges), [0; 4], "one point has no pairs");
    // Across the corner of the torus: dx = dy = 1/8, r = 0.1768.
    let corner = vec![0.0625, 0.0625, 0.9375, 0.9375];
    assert_eq!(counts(raw(2, corner), &edges), [0, 2, 0, 0], "one pair, counted from both ends");
    // Distances 1/4 (an edge: it belongs to the bin above), 1/8 + 1/4 = 3/8 across the side, and 3/8.
    let three = vec![0.0, 0.0, 0.25, 0.0, 0.625, 0.0];
    assert_eq!(counts(raw(2, three), &edges), [0, 0, 2, 4], "half-open bins: edges belong above");
    // 3D: the Pythagorean quadruple 1, 2, 2 -> 3, in sixteenths: r = 3/16.
    let quadruple = vec![0.0, 0.0, 0.0, 0.0625, 0.125, 0.125];
    assert_eq!(counts(raw(3, quadruple.clone()), &[0.0, 0.1875, 0.5]), [0, 2]);
    assert_eq!(counts(raw(3, quadruple), &[0.0, 0.187_500_000_000_000_03, 0.5]), [2, 0]);
    // The same place twice: r = 0 belongs to the first bin.
    assert_eq!(counts(raw(1, vec![0.3, 0.3]), &edges), [2, 0, 0, 0]);
}

#[test]
fn spectra_of_one_two_and_three_points_by_hand() {
    let (_, q) = power(raw(2, vec![0.3, 0.7]), &[3, 2]);
    assert!(q.iter().all(|q| (q - 1.0).abs() < 1e-14), "one point: |s|^2 = 1 everywhere");
    // Two points 1/4 apart along x: |s|^2 = 2 + 2 cos(pi m / 2).
    let (grid, q) = power(raw(2, vec![0.0, 0.0, 0.25, 0.0]), &[4, 1]);
    for (index, q) in q.iter().enumerate() {
        let expected = [4.0, 2.0, 0.0, 2.0][grid.mode(index)[0] as usize % 4];
        assert!((q - expected).abs() < 1e-14, "m = {:?}: {q}, not {expected}", grid.mode(index));
    }
    // Three points at thirds: 9 where 3 divides m, else 0. Thirds are rounded to 2^-64, phases with them.
    let (grid, q) = power(raw(1, vec![0.0, 1.0 / 3.0, 2.0 / 3.0]), &[9]);
    for (index, q) in q.iter().enumerate() {
        let expected = if grid.mode(index)[0] % 3 == 0 { 9.0 } else { 0.0 };
        assert!((q - expected).abs() < 1e-12, "m = {:?}: {q}", grid.mode(index));
    }
}

#[test]
fn lattice_counts_by_hand() {
    // Each point of a 10 x 10 lattice has 4 neighbours at 0.1, 4 at 0.1414, 4 at 0.2, 8 at 0.2236, 4 at 0.2828.
    let edges = [0.05, 0.12, 0.15, 0.21, 0.25, 0.29];
    assert_eq!(counts(lattice(2, 10), &edges), [400, 400, 400, 800, 400]);
    // 1D, dyadic so that 1/2 is exactly 1/2: it is outside [0, 1/2).
    let all: u64 = counts(lattice(1, 8), &[0.0, 0.5]).iter().sum();
    assert_eq!(all, 8 * 6, "each point sees all others but the antipodal one");
}

#[test]
fn rustfft_agrees_on_grid_points() {
    use rustfft::{FftPlanner, num_complex::Complex};
    let (size, n) = (64usize, 500);
    let mut rng = Rng(11);
    let sites: Vec<(usize, usize)> =
        (0..n).map(|_| ((rng.unit() * size as f64) as usize, (rng.unit() * size as f64) as usize)).collect();
    let mut field = vec![Complex::new(0.0f64, 0.0); size * size];
    for &(x, y) in &sites {
        field[x * size + y].re += 1.0;
    }
    let fft = FftPlanner::new().plan_fft_forward(size);
    fft.process(&mut field);
    let mut transposed: Vec<_> = (0..size * size).map(|i| field[i % size * size + i / size]).collect();
    fft.process(&mut transposed);

    let place = |i: usize| i as f64 / size as f64;
    let points = raw(2, sites.iter().flat_map(|&(x, y)| [place(x), place(y)]).collect());
    let (grid, q) = power(points, &[31, 31]);
    for (index, q) in q.iter().enumerate() {
        let m = grid.mode(index);
        let wrap = |m: i32| m.rem_euclid(size as i32) as usize;
        let opinion = transposed[wrap(m[1]) * size + wrap(m[0])].norm_sqr();
        assert!((q - opinion).abs() <= 1e-9 * (1.0 + opinion), "m = {m:?}: {q} against rustfft's {opinion}");
    }
}

#[test]
fn rank_1_lattice_is_n_on_its_dual_and_0_elsewhere() {
    let (n, z) = (610, 377);
    let (grid, q) = power(rank1(n, z), &[40, 40]);
    for (index, q) in q.iter().enumerate() {
        let m = grid.mode(index);
        let dual = (i64::from(m[0]) + i64::from(m[1]) * z as i64).rem_euclid(n as i64) == 0;
        let expected = if dual { (n * n) as f64 } else { 0.0 };
        assert!((q - expected).abs() <= 1e-20 + 1e-12 * expected, "m = {m:?}: {q}, not {expected}");
    }
}

/// `sinc(t) = sin(pi t) / (pi t)`.
fn sinc(t: f64) -> f64 {
    if t == 0.0 { 1.0 } else { (std::f64::consts::PI * t).sin() / (std::f64::consts::PI * t) }
}

/// `k x k` strata with one uniform point each.
fn jittered(k: usize, seed: u64) -> RawPoints {
    let mut rng = Rng(seed);
    let cell = |i: usize, rng: &mut Rng| (i as f64 + rng.unit()) / k as f64;
    raw(2, (0..k * k).flat_map(|j| [cell(j % k, &mut rng), cell(j / k, &mut rng)]).collect())
}

/// A Latin hypercube: one point in each of n rows and n columns.
fn latin_hypercube(n: usize, seed: u64) -> RawPoints {
    let mut rng = Rng(seed);
    let mut columns: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        columns.swap(i, (rng.unit() * (i + 1) as f64) as usize);
    }
    let cell = |i: usize, rng: &mut Rng| (i as f64 + rng.unit()) / n as f64;
    raw(2, (0..n).flat_map(|i| [cell(i, &mut rng), cell(columns[i], &mut rng)]).collect())
}

/// Asserts that deviations in standard errors look like standard errors: mean square near 1, none absurd.
fn assert_standard(name: &str, deviations: &[f64]) {
    let mean_square = deviations.iter().map(|z| z * z).sum::<f64>() / deviations.len() as f64;
    let worst = deviations.iter().fold(0f64, |w, z| w.max(z.abs()));
    println!("{name}: mean square {mean_square:.3} of {} deviations, worst {worst:.2}", deviations.len());
    assert!((0.6..1.5).contains(&mean_square) && worst < 6.0, "{name}: mean square {mean_square}, worst {worst}");
}

fn power_deviations(sets: &[RawPoints], max_frequency: u32, theory: impl Fn([i32; 3]) -> f64) -> Vec<f64> {
    let ensemble = ensemble(sets);
    let plan = wave_plan(&ensemble, &[max_frequency; 2], Accuracy::High);
    let spectrum = PowerSpectrum::new(&plan, &reference_power(&plan, &ensemble));
    (plan.waves.dc().unwrap() + 1..plan.waves.len())
        .map(|i| (spectrum.p[i] - theory(plan.waves.grid().unwrap().mode(i))) / spectrum.p_se[i])
        .collect()
}

#[test]
fn jittered_power_is_its_closed_form() {
    let k = 8;
    let sets: Vec<_> = (0..300).map(|i| jittered(k, 100 + i)).collect();
    let theory = |m: [i32; 3]| 1.0 - (sinc(f64::from(m[0]) / k as f64) * sinc(f64::from(m[1]) / k as f64)).powi(2);
    assert_standard("jittered P", &power_deviations(&sets, 10, theory));
}

#[test]
fn latin_hypercube_power_is_its_closed_form() {
    let n = 40;
    let sets: Vec<_> = (0..400).map(|i| latin_hypercube(n, 500 + i)).collect();
    let s = |m: i32| sinc(f64::from(m) / n as f64).powi(2);
    let theory = |m: [i32; 3]| match (m[0], m[1]) {
        (0, m) | (m, 0) => 1.0 - s(m),
        (a, b) => 1.0 + s(a) * s(b) / (n as f64 - 1.0),
    };
    assert_standard("LHS P", &power_deviations(&sets, 8, theory));
}

#[test]
fn jittered_pair_correlation_is_its_closed_form() {
    // Isotropic mean of 1 - (1 - |x|)(1 - |y|) over a circle of radius rho = k r, integrated over the bin with its
    // measure; normalized by n^2, as the closed form is.
    let k = 8usize;
    let sets: Vec<_> = (0..300).map(|i| jittered(k, 900 + i)).collect();
    let ensemble = ensemble(&sets);
    let bins = RadialBins::linear(0.25, 40).unwrap();
    let plan = pair_plan(&ensemble, bins.clone(), Correction::None);
    let g = PairCorrelation::new(&plan, &reference_counts(&plan, &ensemble), Normalization::Intensity);
    let theory = |rho: f64| {
        let steps = 400;
        let mean_overlap: f64 = (0..steps)
            .map(|i| {
                let angle = (f64::from(i) + 0.5) / f64::from(steps) * std::f64::consts::FRAC_PI_2;
                (1.0 - rho * angle.cos()).max(0.0) * (1.0 - rho * angle.sin()).max(0.0)
            })
            .sum::<f64>()
            / f64::from(steps);
        1.0 - mean_overlap
    };
    let in_bin = |b: usize| {
        let (lo, hi) = (bins.edges()[b], bins.edges()[b + 1]);
        let steps = 20;
        let (mut sum, mut weight) = (0.0, 0.0);
        for i in 0..steps {
            let r = lo + (hi - lo) * (f64::from(i) + 0.5) / f64::from(steps);
            sum += r * theory(k as f64 * r);
            weight += r;
        }
        sum / weight
    };
    let deviations: Vec<f64> =
        (0..bins.len()).filter(|&b| g.count[b] > 50).map(|b| (g.g[b] - in_bin(b)) / g.g_se[b]).collect();
    assert_standard("jittered g", &deviations);
}

#[test]
fn independent_points_have_g_1_and_p_1() {
    for dim in 1..=3 {
        let sets: Vec<_> = (0..60).map(|i| uniform(dim, 60, 7000 + i)).collect();
        let ensemble = ensemble(&sets);
        let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 25).unwrap(), Correction::None);
        let sums = reference_counts(&plan, &ensemble);
        let g = PairCorrelation::new(&plan, &sums, Normalization::Pairs);
        let deviations: Vec<f64> = (0..25).filter(|&b| g.count[b] > 50).map(|b| (g.g[b] - 1.0) / g.g_se[b]).collect();
        assert_standard(&format!("random g, {dim}D"), &deviations);
        let intensity = PairCorrelation::new(&plan, &sums, Normalization::Intensity);
        assert!(
            g.g.iter().zip(&intensity.g).all(|(a, b)| (b / a - 59.0 / 60.0).abs() < 1e-12),
            "n^2 instead of n(n-1): smaller by (n-1)/n"
        );
        let max_frequency = [40, 6, 3][dim - 1];
        let plan = wave_plan(&ensemble, &vec![max_frequency; dim], Accuracy::High);
        let spectrum = PowerSpectrum::new(&plan, &reference_power(&plan, &ensemble));
        let deviations: Vec<f64> = (plan.waves.dc().unwrap() + 1..plan.waves.len())
            .map(|i| (spectrum.p[i] - 1.0) / spectrum.p_se[i])
            .collect();
        assert_standard(&format!("random P, {dim}D"), &deviations);
    }
}

#[test]
fn translation_weights_by_hand() {
    // Window 2 x 1, points (0.5, 0.5) and (1.0, 0.75): weight (2 * 1) / ((2 - 0.5) (1 - 0.25)) = 16/9 for both orders.
    let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    let ensemble = Ensemble::from_raw(&[raw(2, vec![0.5, 0.5, 1.0, 0.75])], &window, false, 0).unwrap();
    let plan = pair_plan(&ensemble, RadialBins::linear(0.8, 2).unwrap(), Correction::Translation);
    let sums = reference_counts(&plan, &ensemble);
    assert_eq!(sums.counts, [0, 2]);
    let steps = (16.0 / 9.0 * 2f64.powi(32)).round_ties_even() as u128;
    assert_eq!(sums.bins.sums, vec![0, 2 * steps]);
    let g = PairCorrelation::new(&plan, &sums, Normalization::Pairs);
    let ring = std::f64::consts::PI * (0.8f64.powi(2) - 0.4f64.powi(2));
    let expected = 2.0 * (2.0 * 16.0 / 9.0) / (2.0 * ring);
    assert!((g.g[1] - expected).abs() < 1e-9, "{} against {expected}", g.g[1]);
}

/// The isotropic weight of the pair of points `a` and `b` of a window, seen from `a`.
fn isotropic(window: &Domain, a: &[f64], b: &[f64]) -> f64 {
    let ensemble = Ensemble::from_raw(&[raw(a.len(), [a, b].concat())], window, false, 0).unwrap();
    isotropic_weight(&ensemble.lengths(0), window.side_steps(), 0, 1) as f64 / 2f64.powi(32)
}

#[test]
fn isotropic_weights_by_hand() {
    let square = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * b;
    for (a, b, expected) in [
        // The whole circle is inside, or touches all four sides.
        ([0.5, 0.5], [0.6, 0.7], 1.0),
        ([0.5, 0.5], [1.0, 0.5], 1.0),
        // Half of it, a quarter.
        ([0.0, 0.5], [0.1, 0.5], 2.0),
        ([0.0, 0.0], [0.3, 0.4], 4.0),
        ([1.0, 1.0], [1.0, 0.25], 4.0),
        // A side at half the radius cuts off 2 acos(1/2), a third.
        ([0.1, 0.5], [0.3, 0.5], 1.5),
        // Two such sides in a corner: each a third, and what they share once: from the corner's quadrant nothing is left,
        // from its neighbours 1/12 each, and 1/4.
        ([0.1, 0.1], [0.3, 0.1], 12.0 / 5.0),
        // The same place twice.
        ([0.0, 0.0], [0.0, 0.0], 1.0),
    ] {
        let found = isotropic(&square, &a, &b);
        assert!(near(found, expected), "{a:?} to {b:?}: {found}, expected {expected}");
    }
    // Nothing caps it. In the middle of a strip both ends of the circle keep 2 asin(b / 2r).
    let strip = Domain::window(&[(0.0, 3000.0), (0.0, 10.0)]).unwrap();
    let expected = std::f64::consts::TAU / (4.0 * (5.0f64 / 750.0).asin());
    assert!(near(isotropic(&strip, &[1500.0, 5.0], &[2250.0, 5.0]), expected) && expected > 235.0);
    // About the middle of the square, e short of a corner along both axes, each quarter keeps 4 e of a turn of 2 pi.
    for bits in [10, 20, 26] {
        let e = 2f64.powi(-bits);
        let found = isotropic(&square, &[0.5, 0.5], &[1.0 - e, 1.0 - e]) * 16.0 * e / std::f64::consts::TAU;
        assert!((found - 1.0).abs() < 4.0 * e + 1e-9, "2^-{bits}: {found}");
    }
    let line = Domain::window(&[(-1.0, 3.0)]).unwrap();
    for (a, b, expected) in [(0.0, 0.5, 1.0), (0.0, 1.0, 1.0), (0.0, 1.5, 2.0), (-1.0, 0.0, 2.0), (1.0, 3.0, 1.0)] {
        assert_eq!(isotropic(&line, &[a], &[b]), expected, "{a} to {b}");
    }
    // Any circle: the part of 100,000 directions that stays inside.
    let window = Domain::window(&[(-3.0, -1.0), (10.0, 11.0)]).unwrap();
    let mut rng = Rng(8);
    for _ in 0..50 {
        let mut point = || [-3.0 + 2.0 * rng.unit(), 10.0 + rng.unit()];
        let (a, b) = (point(), point());
        let r = (a[0] - b[0]).hypot(a[1] - b[1]);
        let inside = |k: &i32| {
            let (sin, cos) = (f64::from(*k) * 1e-5 * std::f64::consts::TAU).sin_cos();
            (-3.0..=-1.0).contains(&(a[0] + r * cos)) && (10.0..=11.0).contains(&(a[1] + r * sin))
        };
        let expected = 1e5 / (0..100_000).filter(inside).count() as f64;
        let found = isotropic(&window, &a, &b);
        assert!((found / expected - 1.0).abs() < 1e-4 * expected, "{a:?} to {b:?}: {found}, not {expected}");
    }
}

/// No isotropic weight is above what the plan says, and some come near it.
#[test]
fn isotropic_weights_keep_their_bound() {
    let mut rng = Rng(21);
    for (ranges, r) in [
        ([(0.0, 1.0), (0.0, 1.0)], 0.3),
        ([(0.0, 1.0), (0.0, 1.0)], 0.5),
        ([(0.0, 1.0), (0.0, 1.0)], 0.6),
        ([(0.0, 1.0), (0.0, 1.0)], 0.7),
        ([(0.0, 1.5), (0.0, 1.0)], 0.74),
        ([(0.0, 1.5), (0.0, 1.0)], 0.85),
        ([(-1.0, 2.0), (0.0, 0.01)], 0.007),
        ([(-1.0, 2.0), (0.0, 0.01)], 1.2),
    ] {
        let window = Domain::window(&ranges).unwrap();
        let some = ensemble_in(&window, &[uniform(2, 2, 1)]);
        let plan = pair_plan(&some, RadialBins::linear(r, 1).unwrap(), Correction::Isotropic);
        let (mut largest, bound) = (0.0f64, plan.largest_isotropic());
        // Pairs about the middle, a corner and the middle of each side, at the longest distance and in every direction.
        for _ in 0..20_000 {
            let at = |k: usize, u: f64| ranges[k].0 + u * (ranges[k].1 - ranges[k].0);
            let near = |u: f64, rng: &mut Rng| (u + 1e-3 * (rng.unit() - 0.5)).clamp(0.0, 1.0);
            let places = [0.0, 0.5, 1.0].map(|u| near(u, &mut rng));
            let a = [0, 1].map(|k| at(k, places[rng.bits() as usize % 3]));
            let y = at(1, [rng.unit(), near(1.0, &mut rng), near(0.0, &mut rng)][rng.bits() as usize % 3]);
            let x = a[0] + (r * r - (y - a[1]).powi(2)).sqrt() * [1.0, -1.0][rng.bits() as usize % 2];
            // Written so that NaN fails.
            if (ranges[0].0..=ranges[0].1).contains(&x) {
                largest = largest.max(isotropic(&window, &a, &[x, y]));
            }
        }
        assert!(largest <= bound * (1.0 + 1e-9), "{ranges:?}, r = {r}: {largest}, bound {bound}");
        // The bound for long distances takes one quarter of four.
        assert!(largest >= 0.2 * bound, "{ranges:?}, r = {r}: {largest}, bound {bound}");
    }
}

#[test]
fn border_correction_by_hand() {
    // Points at 1, 2, 4 and 15 of [0, 16]: 1, 2, 4 and 1 from the border. Edges 0, 1, 2, 4: they are 1, 2, 3 and 1 bins deep.
    let window = Domain::window(&[(0.0, 16.0)]).unwrap();
    let ensemble = Ensemble::from_raw(&[raw(1, vec![1.0, 2.0, 4.0, 15.0])], &window, false, 0).unwrap();
    let bins = RadialBins::from_edges(vec![0.0, 1.0, 2.0, 4.0]).unwrap();
    let settings = PairSettings { cumulative: true, ..Correction::Border.into() };
    let plan = PairPlan::new(&window, bins, settings, shape(&ensemble)).unwrap();
    let sums = reference_counts(&plan, &ensemble);
    // Distances 1, 2 and 3 between the first three, the fourth is too far. An edge belongs above it.
    assert_eq!(sums.counts, [0, 2, 4]);
    // Bin [1, 2): 2 looks at 1, but 1 not at 2. Bin [2, 4): 4 looks at 2 and at 1.
    assert_eq!(sums.bins.sums, [0, 1, 2]);
    let inside: Vec<u128> = sums.bins.norms.iter().map(|n| n[0].sum / 4).collect();
    assert_eq!(inside, [4, 2, 1], "points at least as deep as the upper edge");
    // Closer than 2: 2 looks at 1, 4 at none. Closer than 4: 4 looks at 2 and 1, and 2 no more at 1.
    assert_eq!(sums.cumulative.unwrap().sums, [0, 1, 2]);
    // In 2D the nearest of four sides counts: a point in the middle of a long window sees as far as half its width.
    let window = Domain::window(&[(0.0, 10.0), (0.0, 2.0)]).unwrap();
    let ensemble = Ensemble::from_raw(&[raw(2, vec![5.0, 1.0, 5.5, 1.5])], &window, false, 0).unwrap();
    let bins = RadialBins::from_edges(vec![0.0, 0.75, 0.99]).unwrap();
    let plan = pair_plan(&ensemble, bins, Correction::Border);
    let sums = reference_counts(&plan, &ensemble);
    assert_eq!((sums.counts, sums.bins.sums), (vec![2, 0], vec![1, 0]));
}

#[test]
fn weighted_points_by_hand() {
    // Weights 3, 1 and 0 of three points, in units of 4.
    let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    let points = [raw(2, vec![0.5, 0.5, 1.0, 0.75, 1.0, 0.75])];
    let ensemble = Ensemble::from_raw(&points, &window, false, 0).unwrap().with_weights(&[3.0, 1.0, 0.0]);
    for (correction, weight) in [(Correction::None, 1.0), (Correction::Translation, 16.0 / 9.0)] {
        let settings = PairSettings { masses: true, ..correction.into() };
        let bins = RadialBins::linear(0.8, 2).unwrap();
        let plan = PairPlan::new(&window, bins, settings, shape(&ensemble)).unwrap();
        let sums = reference_counts(&plan, &ensemble);
        assert_eq!(sums.counts, [2, 4], "counts are of points");
        assert!((sums.sum(1) - 2.0 * 3.0 / 16.0 * weight).abs() < 1e-9);
        assert_eq!(sums.bins.sums[0], 0);
        let norms = sums.bins.norm(0).map(|n| n.sum as f64 / 2f64.powi(64));
        assert_eq!(norms, [(16.0 - 10.0) / 16.0, 1.0], "(sum u)^2 - sum u^2, and (sum u)^2");
        let g = PairCorrelation::new(&plan, &sums, Normalization::Pairs);
        let ring = std::f64::consts::PI * (0.8f64.powi(2) - 0.4f64.powi(2));
        assert!((g.g[1] - 2.0 * weight / ring * 6.0 / 6.0).abs() < 1e-8, "{}", g.g[1]);
    }
    // Seen from deep inside: the first two points are 1/2 from the border, the last 1/4.
    let bins = RadialBins::from_edges(vec![0.0, 0.2, 0.3, 0.49]).unwrap();
    let settings = PairSettings { masses: true, cumulative: true, ..Correction::Border.into() };
    let near = [raw(2, vec![0.5, 0.5, 0.75, 0.5, 0.5, 0.25])];
    let near = Ensemble::from_raw(&near, &window, false, 0).unwrap().with_weights(&[2.0, 1.0, 1.0]);
    let plan = PairPlan::new(&window, bins, settings, shape(&near)).unwrap();
    let sums = reference_counts(&plan, &near);
    assert_eq!(sums.counts, [0, 4, 2], "the first and either of the others 1/4 apart, those sqrt(2)/4");
    // All weigh 1 and 1/2. From 0.2 to 0.3 the first looks at both, and the second, 1/2 deep, at the first.
    let steps = |quarters: u128| quarters << 62;
    assert_eq!(sums.bins.sums, [0, steps(2 + 2 + 2), steps(1)]);
    assert_eq!(sums.cumulative.unwrap().sums, [0, steps(6), steps(6 + 1)]);
    // All are 0.2 deep: 3/2 (1 1 + 2 1/2 3/2), and 2 2. The last is not 0.3 deep: 3/2 (1 1 + 1/2 3/2), and (1 + 1/2) 2.
    let norms: Vec<_> = sums.bins.norms.iter().map(|n| n.map(|n| n.sum)).collect();
    assert_eq!(norms, [[15 << 62, 16 << 62], [21 << 61, 12 << 62], [21 << 61, 12 << 62]]);
    // A largest weight that is a power of two is exactly 1.
    let powers = Ensemble::from_raw(&points, &window, false, 0).unwrap().with_weights(&[0.25, 0.125, 1e-9]);
    assert_eq!(powers.weights(0).unwrap(), [1.0, 0.5, 4e-9]);
}

/// A heavy point among light ones: g in plain f64 from coordinates and weights, over all spreads that are promised.
#[test]
fn light_points_count_beside_a_heavy_one() {
    let points = uniform(2, 60, 77);
    let ensemble = ensemble(std::slice::from_ref(&points));
    for (light, within) in [(1.0, 1e-12), (1e-5, 1e-12), (1e-9, 1e-7), (1e-15, 1e-2)] {
        let weights: Vec<f64> =
            (0..60).map(|j| if j == 7 { 1.0 } else { light * (1.0 + 0.1 * f64::from(j)) }).collect();
        let weighted = ensemble.clone().with_weights(&weights);
        let settings = PairSettings { masses: true, ..Correction::None.into() };
        let bins = RadialBins::linear(0.4, 4).unwrap();
        let plan = PairPlan::new(weighted.domain(), bins, settings, shape(&weighted)).unwrap();
        let g = PairCorrelation::new(&plan, &reference_counts(&plan, &weighted), Normalization::Pairs);
        let (mut sums, mut all) = ([0.0; 4], 0.0);
        for i in 0..60 {
            for j in (0..60).filter(|&j| j != i) {
                let away = |k: usize| {
                    let d = (points.coordinates[2 * i + k] - points.coordinates[2 * j + k]).abs();
                    d.min(1.0 - d)
                };
                all += weights[i] * weights[j];
                if let Some(sum) = sums.get_mut((away(0).hypot(away(1)) / 0.1) as usize) {
                    *sum += weights[i] * weights[j];
                }
            }
        }
        for (b, sum) in sums.iter().enumerate() {
            let ring = std::f64::consts::PI * 0.01 * (2.0 * b as f64 + 1.0);
            let off = (g.g[b] - sum / (all * ring)).abs();
            assert!(off < within, "light {light:e}, bin {b}: {} is off by {off:e}", g.g[b]);
        }
    }
}

/// Pairs per cell of lags of one set of points, by the reference.
fn lags(domain: &Domain, dim: usize, points: &[f64], bins: usize, lag_max: Option<f64>) -> Vec<u128> {
    let ensemble = Ensemble::from_raw(&[raw(dim, points.to_vec())], domain, false, 0).unwrap();
    reference_lags(&lag_plan(&ensemble, bins, lag_max, Correction::None), &ensemble).cells.sums
}

/// The cells that hold pairs, and how many.
fn filled(counts: &[u128]) -> Vec<(usize, u128)> {
    counts.iter().copied().enumerate().filter(|c| c.1 > 0).collect()
}

#[test]
fn lags_on_a_line_by_hand() {
    // Edges -1/2, -1/4, 0, 1/4 and 1/2.
    let of = |a: f64, b: f64| lags(&Domain::unit_torus(1), 1, &[a, b], 4, None);
    assert_eq!(of(0.1, 0.2), [0, 1, 1, 0], "0.1 and its mirror image");
    assert_eq!(of(0.2, 0.1), [0, 1, 1, 0]);
    assert_eq!(of(0.05, 0.85), [0, 1, 1, 0], "across the side");
    assert_eq!(of(0.5, 0.75), [1, 0, 0, 1], "1/4 is on an edge: right of it, and its mirror image left of -1/4");
    assert_eq!(of(0.75, 0.5), [1, 0, 0, 1]);
    assert_eq!(of(0.25, 0.75), [1, 0, 0, 1], "half a period is -1/2, and mirrored in the last bin");
    assert_eq!(of(0.3, 0.3), [0, 1, 1, 0], "lag 0 is right of the edge 0, and mirrored left of it");
    // Edges -3/8, -1/8, 1/8 and 3/8: lag 0 in the middle of a bin that is its own mirror image.
    let odd = |a: f64, b: f64| lags(&Domain::unit_torus(1), 1, &[a, b], 3, Some(0.375));
    assert_eq!(odd(0.3, 0.3), [0, 2, 0]);
    assert_eq!(odd(0.3, 0.35), [0, 2, 0]);
    assert_eq!(odd(0.25, 0.375), [1, 0, 1], "1/8 is on an edge: outside the middle on both sides");
    assert_eq!(odd(0.0, 0.375), [0, 0, 0], "3/8 is beyond the last bin, and so is its mirror image");
    assert_eq!(odd(0.0, 0.5), [0, 0, 0]);
}

#[test]
fn lags_in_2d_and_3d_by_hand() {
    // Two bins per axis: cell 2 x + y with x, y = 0 for negative, 1 for positive components.
    let of = |points: [f64; 4]| filled(&lags(&Domain::unit_torus(2), 2, &points, 2, None));
    let (diagonal, other) = (vec![(0, 1), (3, 1)], vec![(1, 1), (2, 1)]);
    assert_eq!(of([0.0, 0.0, 0.1, 0.2]), diagonal);
    assert_eq!(of([0.0, 0.2, 0.1, 0.0]), other);
    assert_eq!(of([0.1, 0.0, 0.0, 0.2]), other, "the same lag from the other end");
    assert_eq!(of([0.5, 0.0, 0.5, 0.2]), diagonal, "(0, 0.2): 0 is its own negative, so the second component decides");
    assert_eq!(of([0.5, 0.2, 0.5, 0.0]), diagonal);
    assert_eq!(of([0.0, 0.0, 0.5, 0.2]), other, "(-1/2, 0.2): so is half a period");
    assert_eq!(of([0.5, 0.2, 0.0, 0.0]), other);
    assert_eq!(of([0.0, 0.0, 0.2, 0.5]), other, "(0.2, -1/2)");
    assert_eq!(of([0.0, 0.0, 0.5, 0.5]), diagonal, "(-1/2, -1/2) is its own negative as a whole");
    assert_eq!(of([0.3, 0.3, 0.3, 0.3]), diagonal, "and so is lag 0");
    // Four bins: (0.3, -1/4), whose second component is on the edge between bins 0 and 1.
    let four = lags(&Domain::unit_torus(2), 2, &[0.0, 0.25, 0.3, 0.0], 4, None);
    assert_eq!(filled(&four), [(2, 1), (3 * 4 + 1, 1)]);
    // The last edge of a shorter grid.
    let short = |points: [f64; 4]| filled(&lags(&Domain::unit_torus(2), 2, &points, 2, Some(0.25)));
    assert_eq!(short([0.0, 0.25, 0.1, 0.0]), other, "(0.1, -1/4) is inside, so its mirror image counts, too");
    assert_eq!(short([0.0, 0.0, 0.1, 0.25]), [], "(0.1, 1/4) is not");
    assert_eq!(short([0.0, 0.0, 0.25, 0.1]), []);
    // Unequal sides: 0.05 to 0.45 is -0.1 on a side of 1/2.
    let torus = Domain::torus(&[1.0, 0.5]).unwrap();
    assert_eq!(filled(&lags(&torus, 2, &[0.0, 0.05, 0.1, 0.45], 2, None)), other);
    assert_eq!(filled(&lags(&torus, 2, &[0.0, 0.0, 0.1, 0.25], 2, None)), other, "(0.1, -1/4): half of that period");
    // Three components, cell 4 x + 2 y + z.
    let of = |points: [f64; 6]| filled(&lags(&Domain::unit_torus(3), 3, &points, 2, None));
    assert_eq!(of([0.5, 0.5, 0.1, 0.5, 0.5, 0.2]), [(0, 1), (7, 1)]);
    assert_eq!(of([0.5, 0.4, 0.1, 0.5, 0.3, 0.2]), [(1, 1), (6, 1)]);
    assert_eq!(of([0.0, 0.0, 0.0, 0.1, 0.9, 0.5]), [(3, 1), (4, 1)]);
}

#[test]
fn lags_in_a_window_by_hand() {
    let window = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    let of = |points: [f64; 4]| filled(&lags(&window, 2, &points, 2, None));
    assert_eq!(of([0.0, 0.0, 1.5, 0.5]), [(0, 1), (3, 1)], "no minimum image");
    assert_eq!(of([1.5, 0.0, 0.0, 0.5]), [(1, 1), (2, 1)]);
    // Sides are closed, so lags may span them.
    assert_eq!(of([0.0, 1.0, 0.5, 0.0]), [(1, 1), (2, 1)], "(1/2, -1) is in the first bin of y");
    assert_eq!(of([0.0, 0.0, 0.5, 1.0]), [], "(1/2, 1) is beyond the last");
    assert_eq!(of([0.0, 0.0, 2.0, 0.5]), [], "and (2, 1/2) beyond that of x");
    assert_eq!(of([0.0, 0.5, 2.0, 0.0]), [], "(2, -1/2) as well: a window has no half period");
    let line = Domain::window(&[(-1.0, 1.0)]).unwrap();
    assert_eq!(lags(&line, 1, &[-1.0, 0.5], 4, None), [1, 0, 0, 1]);
    assert_eq!(lags(&line, 1, &[-1.0, 1.0], 4, None), [0; 4]);
}

#[test]
fn jittered_vector_g_is_its_closed_form() {
    // g(h) = n / (n - 1) (1 - (1 - k |x|)+ (1 - k |y|)+), whose mean over a cell is a product of means: each side of a
    // cell lies within a linear piece, so that its mean is the value in the middle.
    let k = 4usize;
    let n = (k * k) as f64;
    let sets: Vec<_> = (0..600).map(|i| jittered(k, 3000 + i)).collect();
    let ensemble = ensemble(&sets);
    let plan = lag_plan(&ensemble, 16, None, Correction::None);
    let g = VectorCorrelation::new(&plan, &reference_lags(&plan, &ensemble), Normalization::Pairs);
    let tent = |h: f64| (1.0 - k as f64 * h.abs()).max(0.0);
    let theory = |c: usize| (1.0 - tent(plan.grid.centre(c, 0)) * tent(plan.grid.centre(c, 1))) * n / (n - 1.0);
    // Half of the cells: the others are mirror images.
    let deviations: Vec<f64> = (0..128).map(|c| (g.g[c] - theory(c)) / g.g_se[c]).collect();
    assert_standard("jittered g(h)", &deviations);
    let least = (0..256).min_by(|&a, &b| g.g[a].total_cmp(&g.g[b])).unwrap();
    assert!(g.g[least] < 0.4 && [7 * 16 + 7, 7 * 16 + 8].contains(&least), "lowest at lag 0: {least}");
}

/// K of 71 trees in a window, by an independent program (spatstat), with each of its edge corrections.
#[test]
fn k_of_an_independent_program() {
    let rows = |text: &str| -> Vec<Vec<f64>> {
        text.lines().skip(1).map(|l| l.split(',').map(|x| x.trim().parse().unwrap()).collect()).collect()
    };
    let trees = raw(2, rows(include_str!("../data/swedishpines.csv")).concat());
    let expected = rows(include_str!("../data/swedishpines_k.csv"));
    let window = Domain::window(&[(0.0, 96.0), (0.0, 100.0)]).unwrap();
    let ensemble = Ensemble::from_raw(&[trees], &window, false, 0).unwrap();
    let corrections = [Correction::Translation, Correction::Isotropic, Correction::Border, Correction::None];
    for (column, correction) in corrections.into_iter().enumerate() {
        let settings = PairSettings { cumulative: true, ..correction.into() };
        let bins = RadialBins::linear(23.7036, 256).unwrap();
        let plan = PairPlan::new(&window, bins, settings, shape(&ensemble)).unwrap();
        let k = KFunction::new(&plan, &reference_counts(&plan, &ensemble), Normalization::Pairs, 71.0).unwrap();
        for (row, at) in expected.iter().zip((15..256).step_by(16)) {
            assert!((k.r[at] - row[0]).abs() < 1e-9, "{} against {}", k.r[at], row[0]);
            let (found, expected) = (k.k[at], row[column + 1]);
            assert!((found - expected).abs() <= 1e-9 * expected, "{correction} at {}: {found}, not {expected}", row[0]);
        }
    }
}
