//! Plain implementations, as anybody would write them first: what the others are compared with. Points are shared among threads and nothing else is
//! done for speed.

use std::f64::consts::TAU;

use rayon::prelude::*;

/// Ordered pairs by distance on the unit torus in 2D, in f64: differences by `round`, a square root, a division. `bins` equal bins up to `r_max`.
pub(super) fn pairs_f64(points: &[[f64; 2]], r_max: f64, bins: usize) -> Vec<u64> {
    count(points.len(), bins, |i, counts| {
        let p = points[i];
        for q in &points[i + 1..] {
            let [mut dx, mut dy] = [p[0] - q[0], p[1] - q[1]];
            dx -= dx.round();
            dy -= dy.round();
            let bin = ((dx * dx + dy * dy).sqrt() / r_max * bins as f64) as usize;
            if let Some(count) = counts.get_mut(bin) {
                *count += 2;
            }
        }
    })
}

/// Pairs looked at before their bins are counted, so that the compiler makes vectors of the arithmetic.
const ROW: usize = 512;

/// The same in f32, without looking again at pairs near an edge.
pub(super) fn pairs_f32(points: &[[f64; 2]], r_max: f64, bins: usize) -> Vec<u64> {
    let axis = |a: usize| points.iter().map(|p| p[a] as f32).collect::<Vec<_>>();
    let (xs, ys) = (axis(0), axis(1));
    let scale = (bins as f64 / r_max) as f32;
    count(points.len(), bins, |i, counts| {
        let mut found = [0u32; ROW];
        for (xs_of, ys_of) in xs[i + 1..].chunks(ROW).zip(ys[i + 1..].chunks(ROW)) {
            bins_of_row([xs[i], ys[i]], xs_of, ys_of, scale, &mut found);
            for bin in &found[..xs_of.len()] {
                if let Some(count) = counts.get_mut(*bin as usize) {
                    *count += 2;
                }
            }
        }
    })
}

#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2+fma", "aarch64+neon"))]
fn bins_of_row(p: [f32; 2], xs: &[f32], ys: &[f32], scale: f32, found: &mut [u32; ROW]) {
    for ((x, y), bin) in xs.iter().zip(ys).zip(found.iter_mut()) {
        let [mut dx, mut dy] = [p[0] - x, p[1] - y];
        dx -= dx.round_ties_even();
        dy -= dy.round_ties_even();
        *bin = ((dx * dx + dy * dy).sqrt() * scale) as u32;
    }
}

/// Histograms of the pairs of each point and those after it, added up.
fn count(n: usize, bins: usize, row: impl Fn(usize, &mut [u64]) + Sync) -> Vec<u64> {
    let none = || vec![0u64; bins];
    (0..n)
        .into_par_iter()
        .fold(none, |mut counts, i| {
            row(i, &mut counts);
            counts
        })
        .reduce(none, |mut a, b| {
            a.iter_mut().zip(&b).for_each(|(a, b)| *a += b);
            a
        })
}

/// `|sum exp(-2 pi i m . x)|^2` of wave vectors one by one, in f64 by the library's sine and cosine.
pub(super) fn power_f64(points: &[[f64; 2]], waves: &[[i32; 2]]) -> Vec<f64> {
    let of = |m: &[i32; 2]| {
        let [mut re, mut im] = [0.0; 2];
        for p in points {
            let (sin, cos) = (TAU * (f64::from(m[0]) * p[0] + f64::from(m[1]) * p[1])).sin_cos();
            re += cos;
            im -= sin;
        }
        re * re + im * im
    };
    waves.par_iter().map(of).collect()
}

/// The same in f32, sums too.
pub(super) fn power_f32(points: &[[f64; 2]], waves: &[[i32; 2]]) -> Vec<f64> {
    let points: Vec<[f32; 2]> = points.iter().map(|p| p.map(|x| x as f32)).collect();
    let of = |m: &[i32; 2]| {
        let [mut re, mut im] = [0.0f32; 2];
        for p in &points {
            let (sin, cos) = (std::f32::consts::TAU * (m[0] as f32 * p[0] + m[1] as f32 * p[1])).sin_cos();
            re += cos;
            im -= sin;
        }
        f64::from(re * re + im * im)
    };
    waves.par_iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_counts_and_powers_are_those_of_a_lattice() {
        // 4 x 4 points: 4 neighbours each at 1/4, and P = n where m is a multiple of 4.
        let points: Vec<_> = (0..16).map(|k| [f64::from(k % 4) / 4.0, f64::from(k / 4) / 4.0]).collect();
        for counts in [pairs_f64(&points, 0.4, 8), pairs_f32(&points, 0.4, 8)] {
            // Bins of 0.05: 0.25 is an edge, 0.3536 is not.
            assert_eq!(counts.iter().sum::<u64>(), 16 * 8);
            assert_eq!(counts[7], 16 * 4);
        }
        let waves = [[4, 0], [1, 2], [0, -8]];
        for (power, tolerance) in [(power_f64(&points, &waves), 1e-12), (power_f32(&points, &waves), 1e-3)] {
            for (found, expected) in power.iter().zip([256.0, 0.0, 256.0]) {
                assert!((found - expected).abs() <= tolerance, "{found} {expected}");
            }
        }
    }
}
