//! Integrals, f_m and a(r) against sums over a fine grid of f alone, and against one another.

use super::*;

/// The largest difference of `coefficient` from the sum of `value` over cells.
fn coefficients_apart(dim: usize, value: impl Fn(&[f64]) -> f64, coefficient: impl Fn(&[i32]) -> Complex<f64>) -> f64 {
    let n = fine(dim);
    let modes = modes(dim, 3, 8);
    let mut sums = vec![Complex::default(); modes.len()];
    for x in centers(n, dim) {
        let f = value(&x);
        if f != 0.0 {
            for (sum, m) in sums.iter_mut().zip(&modes) {
                *sum += turn(dot(m, &x)) * f;
            }
        }
    }
    let count = (n as f64).powi(dim as i32);
    modes.iter().zip(sums).map(|(m, sum)| (coefficient(m) - sum / count).norm()).fold(0.0, f64::max)
}

/// The largest difference of `a` from the mean of f(x) f(x + r) over cells.
fn autocorrelations_apart(dim: usize, value: impl Fn(&[f64]) -> f64, a: impl Fn(&[f64]) -> f64) -> f64 {
    let n = fine(dim) / 2;
    let lags = lags(dim, 6);
    let mut sums = vec![0.0; lags.len()];
    for x in centers(n, dim) {
        let f = value(&x);
        if f != 0.0 {
            for (sum, r) in sums.iter_mut().zip(&lags) {
                let there: Vec<f64> = x.iter().zip(r).map(|(x, r)| (x + r).rem_euclid(1.0)).collect();
                *sum += f * value(&there);
            }
        }
    }
    let count = (n as f64).powi(dim as i32);
    lags.iter().zip(sums).map(|(r, sum)| (a(r) - sum / count).abs()).fold(0.0, f64::max)
}

/// What a sum over cells errs by: a jump along a surface by a fraction of the cells that it cuts, what is smooth but for the wrap by h^2. A
/// lag puts the wrap inside.
fn allowed(integrand: &Integrand, lagged: bool) -> f64 {
    let jumps_inside = !["gaussian", "cut-gaussian", "ramp", "monomial", "cosine", "zone-plate", "bump"]
        .contains(&integrand.entry().name);
    let scale = 1.0 + integrand.square_integral();
    scale
        * if jumps_inside || (lagged && integrand.smoothness() == 1.0) {
            [3e-5, 8e-4, 8e-3][integrand.dim() - 1]
        } else {
            [1e-8, 4e-5, 3e-3][integrand.dim() - 1]
        }
}

#[test]
fn coefficients_are_those_of_the_values() {
    for f in all() {
        let apart = coefficients_apart(f.dim(), |x| f.value(x), |m| f.coefficient(m));
        assert!(apart < allowed(&f, false), "{f:?}: {apart:e}, allowed {:e}", allowed(&f, false));
    }
}

#[test]
fn autocorrelations_are_those_of_the_values() {
    for f in all() {
        let apart = autocorrelations_apart(f.dim(), |x| f.value(x), |r| f.autocorrelation(r));
        assert!(apart < 2.0 * allowed(&f, true), "{f:?}: {apart:e}, allowed {:e}", 2.0 * allowed(&f, true));
    }
}

/// Planted: the other sign of the phase, the phase of a corner instead of the centre of a cell, a missing image.
#[test]
fn the_comparators_see_faults() {
    let f = made("disk:r=0.2,x=0.31,y=0.93", 2);
    let apart = coefficients_apart(2, |x| f.value(x), |m| f.coefficient(m).conj());
    assert!(apart > 10.0 * allowed(&f, false), "the other conjugate: {apart:e}");
    let off = |m: &[i32]| f.coefficient(m) * turn(0.5 / 100.0 * f64::from(m[0]));
    let apart = coefficients_apart(2, |x| f.value(x), off);
    assert!(apart > allowed(&f, false), "half a cell: {apart:e}");
    let f = made("disk:r=0.41,x=0.1,y=0.45", 2);
    let nearest_only = |r: &[f64]| {
        let d = r.iter().map(|r| (r - r.round()).powi(2)).sum::<f64>().sqrt();
        let (big, d) = (0.41f64, d.min(0.82));
        2.0 * big * big * (d / (2.0 * big)).acos() - 0.5 * d * (4.0 * big * big - d * d).sqrt()
    };
    let apart = autocorrelations_apart(2, |x| f.value(x), nearest_only);
    assert!(apart > 20.0 * allowed(&f, true), "one image of several: {apart:e}");
    // A ramp that does not wrap: int x (x + r) over [0, 1 - r).
    let f = made("ramp", 1);
    let not_wrapped = |r: &[f64]| {
        let r = r[0].rem_euclid(1.0);
        (1.0 - r).powi(3) / 3.0 + r * (1.0 - r).powi(2) / 2.0
    };
    let apart = autocorrelations_apart(1, |x| f.value(x), not_wrapped);
    assert!(apart > 100.0 * allowed(&f, true), "not periodic: {apart:e}");
}

/// a(0) = int f^2 = sum |f_m|^2, mean of a = I^2: up to what lies beyond the frequencies and between the lags that are summed.
#[test]
fn sums_of_squares_close() {
    for f in all() {
        let scale = 1e-12 * (1.0 + f.square_integral());
        assert!((f.autocorrelation(&[0.0; 3]) - f.square_integral()).abs() < scale, "{f:?}: a(0)");
        assert_eq!(f.coefficient(&[0; 3]).re, f.integral(), "{f:?}");
        let reach = [2000, 100, 12][f.dim() - 1];
        let power: f64 = f.coefficients(&vec![reach; f.dim()]).iter().map(|c| c.norm_sqr()).sum();
        let tail = f.square_integral() - power;
        // What jumps leaves an amount of the order of its surface / (2 pi^2 F) on each axis (a checker of 5: 10 lines).
        let most = if f.smoothness() == 1.0 { 5.0 * f.square_integral().max(1.0) / f64::from(reach) } else { 2e-4 };
        let complete = f.smoothness() == f64::INFINITY;
        let most = if complete { scale } else { most };
        assert!((-scale..most).contains(&tail), "{f:?}: {tail:e} is left, at most {most:e}");
        if !complete && f.entry().name != "bump" {
            assert!(tail > 1e-9, "{f:?}: {tail:e} is left of something that jumps");
        }
    }
}

/// The coefficients of a are |f_m|^2: its cosine sums over a grid of lags, up to aliases.
#[test]
fn autocorrelations_have_the_coefficients_squared() {
    for f in all() {
        let dim = f.dim();
        let n = [4000usize, 240, 40][dim - 1];
        let lags: Vec<[f64; 3]> = (0..n.pow(dim as u32))
            .map(|i| std::array::from_fn(|k| if k < dim { (i / n.pow(k as u32) % n) as f64 / n as f64 } else { 0.0 }))
            .collect();
        let mut a = vec![0.0; lags.len()];
        f.autocorrelations(&lags, &mut a);
        for m in modes(dim, 3, 6) {
            let sum: f64 = lags.iter().zip(&a).map(|(r, a)| a * (TAU * dot(&m, &r[..dim])).cos()).sum();
            let (found, expected) = (sum / lags.len() as f64, f.coefficient(&m).norm_sqr());
            let most = if f.smoothness() == 1.0 { [2e-6, 1e-4, 4e-3][dim - 1] } else { [1e-9, 1e-8, 1e-5][dim - 1] };
            let most = most * (1.0 + f.square_integral());
            assert!((found - expected).abs() < most, "{f:?} {m:?}: {found}, {expected}");
        }
    }
}

/// `sum |f_m|^2 cos(2 pi m.r)` over |m_k| <= F is a(r) but for at most what of int f^2 lies beyond F: by how much more, over all lags.
fn series_apart(f: &Integrand, a: impl Fn(&[f64]) -> f64, reach: u32) -> f64 {
    let dim = f.dim();
    let power: Vec<f64> = f.coefficients(&vec![reach; dim]).iter().map(|c| c.norm_sqr()).collect();
    let side = 2 * reach as usize + 1;
    let tail = f.square_integral() - power.iter().sum::<f64>();
    let apart = lags(dim, 8).into_iter().map(|r| {
        let mode = |i: usize| -> Vec<i32> {
            (0..dim).map(|k| (i / side.pow((dim - 1 - k) as u32) % side) as i32 - reach as i32).collect()
        };
        let sum: f64 = power.iter().enumerate().map(|(i, p)| p * (TAU * dot(&mode(i), &r)).cos()).sum();
        (a(&r) - sum).abs() - tail
    });
    apart.fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn autocorrelations_are_the_series_of_the_coefficients_squared() {
    for f in all() {
        let reach = [4000, 80, 12][f.dim() - 1];
        let more = series_apart(&f, |r| f.autocorrelation(r), reach);
        assert!(more < 1e-12 * (1.0 + f.square_integral()), "{f:?}: {more:e} more than the tail");
    }
    // Where the tail is below rounding, to rounding.
    for (spec, dim) in [
        ("bump:q=8,r=0.5", 1),
        ("bump:q=8,r=0.5,x=0.1", 2),
        ("bump:q=8,r=0.25", 2),
        ("bump:q=7,r=0.5", 2),
        ("gaussian:sigma=0.2", 3),
    ] {
        let f = made(spec, dim);
        let reach = [200, 60, 12][dim - 1];
        let more = series_apart(&f, |r| f.autocorrelation(r), reach);
        assert!(more.abs() < 1e-13, "{f:?}: {more:e}");
        // Planted: a little beside it.
        assert!(series_apart(&f, |r| f.autocorrelation(r) * (1.0 + 1e-9), reach) > 1e-12, "{f:?}");
    }
}

/// Slices: a disk is chords, a ball disks. The trapezoidal rule in the angle is exact to rounding for chords, whose square is smooth all around.
#[test]
fn disks_are_chords_and_balls_are_disks() {
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { (std::f64::consts::PI * x).sin() / (std::f64::consts::PI * x) };
    let steps = 400;
    for (r, c) in [(0.25, [0.5, 0.5, 0.5]), (0.41, [0.1, 0.45, 0.8])] {
        let disk = made(&format!("disk:r={r},x={},y={}", c[0], c[1]), 2);
        let ball = made(&format!("disk:r={r},x={},y={},z={}", c[0], c[1], c[2]), 3);
        for m in modes(3, 20, 40) {
            let (mut flat, mut solid) = (Complex::default(), Complex::default());
            for i in 0..steps {
                let t = TAU * (i as f64 + 0.5) / steps as f64 - TAU / 4.0;
                // Once around counts every chord twice.
                let weight = 0.5 * TAU / steps as f64 * r * t.cos().abs();
                let h = r * t.cos().abs();
                let along = turn(f64::from(m[0]) * (c[0] + r * t.sin()));
                flat += along * turn(f64::from(m[1]) * c[1]) * (weight * 2.0 * h * sinc(2.0 * h * f64::from(m[1])));
                // A slice of the ball is a disk of radius h, by its own slices.
                let mut slice = Complex::default();
                for j in 0..steps {
                    let s = TAU * (j as f64 + 0.5) / steps as f64 - TAU / 4.0;
                    let half = h * s.cos().abs();
                    let w = 0.5 * TAU / steps as f64 * half;
                    slice += turn(f64::from(m[1]) * (c[1] + h * s.sin()))
                        * turn(f64::from(m[2]) * c[2])
                        * (w * 2.0 * half * sinc(2.0 * half * f64::from(m[2])));
                }
                solid += along * slice * weight;
            }
            let apart = (disk.coefficient(&m[..2]) - flat).norm();
            assert!(apart < 1e-13, "disk {r} {m:?}: {apart:e}");
            let apart = (ball.coefficient(&m) - solid).norm();
            assert!(apart < 1e-7, "ball {r} {m:?}: {apart:e}");
        }
    }
}

#[test]
fn grids_and_lists_are_the_single_values() {
    let files = super::files::Files::new();
    for f in all().chain(files.all()) {
        let dim = f.dim();
        let max: Vec<u32> = [5, 3, 2][..dim].to_vec();
        let grid = f.coefficients(&max);
        let shape: Vec<usize> = max.iter().map(|f| 2 * *f as usize + 1).collect();
        assert_eq!(grid.len(), shape.iter().product::<usize>());
        for (i, found) in grid.iter().enumerate() {
            // The last axis fastest.
            let mut rest = i;
            let mut m = vec![0; dim];
            for k in (0..dim).rev() {
                m[k] = (rest % shape[k]) as i32 - max[k] as i32;
                rest /= shape[k];
            }
            let scale = 1e-14 * (1.0 + f.square_integral());
            assert!((found - f.coefficient(&m)).norm() <= scale, "{f:?} {m:?}");
            let minus: Vec<i32> = m.iter().map(|m| -m).collect();
            assert!((f.coefficient(&minus).conj() - found).norm() <= scale, "{f:?} {m:?}: not real");
        }
        let lags = lags(dim, 30);
        let padded: Vec<[f64; 3]> =
            lags.iter().map(|r| std::array::from_fn(|k| r.get(k).copied().unwrap_or(0.0))).collect();
        let mut out = vec![f64::NAN; lags.len()];
        f.autocorrelations(&padded, &mut out);
        for (r, found) in lags.iter().zip(out) {
            let scale = 1e-12 * (1.0 + f.square_integral()) + 2.0 * f.autocorrelation_error();
            assert!((found - f.autocorrelation(r)).abs() <= scale, "{f:?} {r:?}");
            let mirrored: Vec<f64> = r.iter().map(|r| 3.0 - r).collect();
            assert!((found - f.autocorrelation(&mirrored)).abs() <= scale, "{f:?} {r:?}: a(-r + 3)");
            assert!(found <= f.square_integral() + scale, "{f:?} {r:?}: above a(0)");
        }
        if let Some(parts) = f.separable() {
            let x = [0.31, 0.77, 0.12];
            let product: f64 = parts.factors().iter().zip(x).map(|(f, x)| f.value(x)).product();
            assert!((parts.offset() + parts.scale() * product - f.value(&x[..dim])).abs() < 1e-14);
        }
    }
}

/// Where edges coincide, a is what it is a little further.
#[test]
fn nothing_happens_where_edges_coincide() {
    let files = super::files::Files::new();
    for f in all().chain(files.all()) {
        let dim = f.dim();
        for step in [0.0, 0.125, 0.45, 0.25, 0.5, 0.66, 0.34, 0.75, 1.0] {
            for across in [0.0, 0.25, 0.66, 1.0] {
                let r: Vec<f64> = [step, across, 0.62][..dim].to_vec();
                let near: Vec<f64> = r.iter().map(|r| r + 1e-9).collect();
                let (at, by) = (f.autocorrelation(&r), f.autocorrelation(&near));
                let scale = 1e-8 * (1.0 + f.square_integral() * f.dim() as f64);
                assert!((at - by).abs() < 3.0 * scale, "{f:?} {r:?}: {at}, beside it {by}");
                assert!(at.is_finite() && at > -1e-9 - 9.0, "{f:?} {r:?}: {at}");
            }
        }
    }
}
