//! Points that keep apart, for which no closed form is known: distances, centroids and published figures, by programs that share nothing with
//! the library's.

use pairwave::control::Control;
use pairwave::samplers::Process;

use super::{distance, points, power};

fn sets(name: &str, given: &[&str], n: u64, dim: usize, k: u64) -> Vec<Vec<f64>> {
    let process = Process::new(name, n, k, dim, 21, given).unwrap();
    (0..k).map(|index| process.coordinates(index, &Control::default()).unwrap()).collect()
}

fn packed(n: u64, dim: usize) -> f64 {
    let n = n as f64;
    [1.0 / n, (2.0 / (3f64.sqrt() * n)).sqrt(), (2f64.sqrt() / n).cbrt()][dim - 1]
}

/// Distances to the nearest other point.
fn nearest(x: &[f64], dim: usize) -> Vec<f64> {
    let x: Vec<_> = x.chunks_exact(dim).collect();
    let of = |i: usize| (0..x.len()).filter(|j| *j != i).map(|j| distance(x[i], x[j])).fold(f64::INFINITY, f64::min);
    (0..x.len()).map(of).collect()
}

fn least(x: &[f64], dim: usize) -> f64 {
    nearest(x, dim).into_iter().fold(f64::INFINITY, f64::min)
}

/// The largest distance to the nearest point, of many places.
fn covering(x: &[f64], dim: usize, per_axis: usize) -> f64 {
    let place = |at: usize| -> Vec<f64> {
        (0..dim).map(|k| ((at / per_axis.pow(k as u32) % per_axis) as f64 + 0.5) / per_axis as f64).collect()
    };
    let of = |place: Vec<f64>| x.chunks_exact(dim).map(|p| distance(p, &place)).fold(f64::INFINITY, f64::min);
    (0..per_axis.pow(dim as u32)).map(|at| of(place(at))).fold(0.0, f64::max)
}

fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let k = values.len() as f64;
    let mean = values.iter().sum::<f64>() / k;
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (k * (k - 1.0))).sqrt())
}

#[test]
fn maximal_poisson_disk_leaves_no_place() {
    // Coverage at saturation, by disks of half the distance.
    for (dim, n, k, per_axis, covered) in
        [(1, 400, 60, 40_000, 0.747_598), (2, 400, 60, 250, 0.547_069), (3, 300, 60, 36, 0.384_131)]
    {
        let unit = [2.0, std::f64::consts::PI, 4.0 / 3.0 * std::f64::consts::PI][dim - 1];
        let distance = 2.0 * (covered / (n as f64 * unit)).powf(1.0 / dim as f64);
        let sets = sets("maximal-poisson-disk", &[], n, dim, k);
        for x in &sets[..4] {
            assert!(least(x, dim) >= distance * (1.0 - 1e-6), "{dim}D: {} below {distance}", least(x, dim));
            assert!(covering(x, dim, per_axis) < distance * (1.0 + 1e-6), "{dim}D: a place is left");
        }
        let counts: Vec<f64> = sets.iter().map(|x| (x.len() / dim) as f64).collect();
        let (mean, error) = mean_and_error(&counts);
        assert!((mean - n as f64).abs() < 4.0 * error + 1e-3 * n as f64, "{dim}D: {mean} +- {error} for {n}");
    }
}

/// The least distance and the mean nearest, relative to the closest packing: means and spreads of single sets, of 300 sets of a plain program.
#[test]
fn best_candidates_keep_the_distances_of_a_plain_program() {
    for (candidates, [least_mean, least_sd], [near_mean, near_sd]) in [
        ("candidates=1", [0.652, 0.018], [0.7956, 0.0062]),
        ("candidates=5", [0.701, 0.013], [0.8169, 0.0068]),
        ("candidates=10", [0.713, 0.013], [0.8228, 0.0063]),
    ] {
        let k = 60;
        let sets = sets("best-candidate", &[candidates], 128, 2, k);
        let unit = packed(128, 2);
        let near: Vec<Vec<f64>> = sets.iter().map(|x| nearest(x, 2)).collect();
        let smallest: Vec<f64> = near.iter().map(|r| r.iter().copied().fold(f64::INFINITY, f64::min) / unit).collect();
        let mean: Vec<f64> = near.iter().map(|r| r.iter().sum::<f64>() / 128.0 / unit).collect();
        for (values, expected, sd) in [(smallest, least_mean, least_sd), (mean, near_mean, near_sd)] {
            // Both sides are means of sets, of 60 and of 300.
            let reach = 4.0 * sd * (1.0 / k as f64 + 1.0 / 300.0).sqrt();
            let (found, _) = mean_and_error(&values);
            assert!((found - expected).abs() < reach, "{candidates}: {found}, expected {expected} +- {reach}");
        }
    }
}

/// The centroid of a Voronoi cell, by cutting a square with the bisectors to all other points and images.
fn centroid(x: &[f64], i: usize) -> [f64; 2] {
    let p = [x[2 * i], x[2 * i + 1]];
    let mut cell = vec![[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    for (j, q) in x.chunks_exact(2).enumerate() {
        for (dx, dy) in (-2..=2).flat_map(|a| (-2..=2).map(move |b| (f64::from(a), f64::from(b)))) {
            let d = [q[0] + dx - p[0], q[1] + dy - p[1]];
            if j == i && dx == 0.0 && dy == 0.0 {
                continue;
            }
            let half = 0.5 * (d[0] * d[0] + d[1] * d[1]);
            let beyond = |c: &[f64; 2]| c[0] * d[0] + c[1] * d[1] - half;
            let mut kept = Vec::new();
            for k in 0..cell.len() {
                let (a, b) = (cell[k], cell[(k + 1) % cell.len()]);
                let (fa, fb): (f64, f64) = (beyond(&a), beyond(&b));
                if fa <= 0.0 {
                    kept.push(a);
                }
                if (fa < 0.0) != (fb < 0.0) && fa != fb {
                    let t = fa / (fa - fb);
                    kept.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
                }
            }
            cell = kept;
        }
    }
    let (mut area, mut moment) = (0.0, [0.0; 2]);
    for k in 0..cell.len() {
        let (a, b) = (cell[k], cell[(k + 1) % cell.len()]);
        let cross = a[0] * b[1] - a[1] * b[0];
        area += cross;
        (0..2).for_each(|axis| moment[axis] += cross * (a[axis] + b[axis]));
    }
    moment.map(|m| m / (3.0 * area))
}

#[test]
fn lloyd_moves_points_to_their_centroids() {
    for n in [1, 2, 3, 7, 29, 30, 31, 60] {
        let at = |t: &str| points("lloyd", &[t], n, 2, 6, 1);
        for (before, after) in [("iterations=0", "iterations=1"), ("iterations=4", "iterations=5")] {
            let (x, y) = (at(before), at(after));
            for i in 0..n as usize {
                let by = centroid(&x, i);
                for axis in 0..2 {
                    let off = (y[2 * i + axis] - x[2 * i + axis] - by[axis]).rem_euclid(1.0);
                    assert!(off.min(1.0 - off) < 1e-9, "n = {n}, {after}: point {i} off by {off}");
                }
            }
        }
    }
    // On a line the cells end half way to the neighbours.
    let (x, y) = (points("lloyd", &["iterations=0"], 9, 1, 6, 1), points("lloyd", &["iterations=1"], 9, 1, 6, 1));
    for i in 0..9 {
        let to = |sign: f64| {
            let d = (0..9).filter(|j| *j != i).map(|j| (sign * (x[j] - x[i])).rem_euclid(1.0));
            d.fold(1.0, f64::min)
        };
        let off = (y[i] - x[i] - 0.25 * (to(1.0) - to(-1.0))).rem_euclid(1.0);
        assert!(off.min(1.0 - off) < 1e-12, "{i}: {off}");
    }
    for index in 0..4 {
        let ratio = least(&points("lloyd", &["iterations=50"], 256, 2, 6, index), 2) / packed(256, 2);
        assert!((0.74..0.85).contains(&ratio), "d_min / d_c = {ratio} after 50 steps; 0.756 to 0.832 were seen");
    }
}

#[test]
fn farthest_points_never_come_closer() {
    for n in [4, 5, 6, 8, 20, 100, 300] {
        let mut last = 0.0;
        for passes in 1..=6 {
            let x = points("fpo", &[&format!("iterations={passes}")], n, 2, 6, 1);
            assert_eq!(x.len(), 2 * n as usize);
            let found = least(&x, 2);
            assert!(found >= last * (1.0 - 1e-9), "n = {n}, pass {passes}: {found} after {last}");
            last = found;
            if passes == 6 && n >= 20 {
                assert!(covering(&x, 2, 200) <= found * (1.0 + 1e-9), "n = {n}: a farther place is left");
            }
        }
    }
    let x = points("fpo", &[], 1024, 2, 6, 1);
    let ratio = least(&x, 2) / packed(1024, 2);
    assert!(ratio >= 0.9, "d_min / d_c = {ratio}; 0.93 in the paper at n = 4096");
}

#[test]
fn stealthy_points_have_no_power_at_low_frequencies() {
    for (dim, n, nu0) in [(1, 60, 0.3), (2, 100, 0.5), (2, 60, 0.3), (3, 100, 0.5)] {
        let process = Process::new("stealthy", n, 3, dim, 2, &[&format!("nu0={nu0}")]).unwrap();
        for index in 0..3 {
            let x = process.coordinates(index, &Control::default()).unwrap();
            let nu0 = nu0 * (n as f64).powf(1.0 / dim as f64);
            let reach = (4.0 * (n as f64).powf(1.0 / dim as f64)) as i32;
            let (mut sum, mut count) = (0.0, 0.0);
            let axis = |used: bool| if used { -reach..=reach } else { 0..=0 };
            for (a, b, c) in
                axis(true).flat_map(|a| axis(dim > 1).flat_map(move |b| axis(dim > 2).map(move |c| (a, b, c))))
            {
                let nu = f64::from(a * a + b * b + c * c).sqrt();
                if nu == 0.0 || nu > f64::from(reach) || dim == 3 && nu > 2.0 * nu0 + 3.0 {
                    continue;
                }
                let p = power(&x, dim, [a, b, c]) / n as f64;
                if nu <= nu0 {
                    assert!(p < 1e-12, "{dim}D n = {n}: P({a}, {b}, {c}) = {p}");
                } else if nu >= 1.1 * nu0 {
                    (sum, count) = (sum + p, count + 1.0);
                }
            }
            if nu0 < 0.35 * (n as f64).sqrt() && dim == 2 {
                assert!((sum / count - 1.0f64).abs() < 0.1, "mean P above: {}", sum / count);
            }
        }
    }
    // Too much is refused, and what does not converge is an error.
    assert!(Process::new("stealthy", 100, 1, 2, 1, &["nu0=0.9"]).is_err());
    let hurried = Process::new("stealthy", 100, 1, 2, 1, &["iterations=3"]).unwrap();
    let message = hurried.coordinates(0, &Control::default()).err().unwrap().to_string();
    assert!(message.contains("did not converge"), "{message}");
}
