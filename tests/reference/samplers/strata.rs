//! Where points stand: nets, strata, rows and columns, distances of lattices, published values.

use pairwave::control::Control;
use pairwave::samplers::Process;

use super::{distance, points};

fn nearest(x: &[f64], dim: usize) -> f64 {
    let x: Vec<_> = x.chunks_exact(dim).collect();
    let all = (0..x.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    all.map(|(i, j)| distance(x[i], x[j])).fold(f64::INFINITY, f64::min)
}

/// The most points in any box of `counts[k]` equal intervals on axis k, and whether none is empty.
fn fullest(x: &[f64], counts: &[u64]) -> (usize, bool) {
    let mut boxes = vec![0; counts.iter().product::<u64>() as usize];
    for point in x.chunks_exact(counts.len()) {
        let cell = |k: usize| (point[k] * counts[k] as f64) as usize;
        boxes[(0..counts.len()).fold(0, |at, k| at * counts[k] as usize + cell(k))] += 1;
    }
    (*boxes.iter().max().unwrap(), boxes.iter().all(|&count| count > 0))
}

/// All `counts` of `2^levels` boxes.
fn shapes(levels: u32, dim: usize) -> Vec<Vec<u64>> {
    if dim == 1 {
        return vec![vec![1 << levels]];
    }
    let longer =
        |first: u32| shapes(levels - first, dim - 1).into_iter().map(move |rest| [vec![1 << first], rest].concat());
    (0..=levels).flat_map(longer).collect()
}

#[test]
fn sobol_sets_are_nets() {
    for scramble in ["scramble=owen", "scramble=digital-shift", "scramble=none"] {
        for index in 0..3 {
            let x = points("sobol", &[scramble, "shift=none"], 1024, 2, 3, index);
            for levels in 0..=10 {
                // Every prefix, and every block of the sequence.
                for block in x.chunks_exact(2 << levels) {
                    for counts in shapes(levels, 2) {
                        assert_eq!(fullest(block, &counts), (1, true), "{scramble} {counts:?}");
                    }
                }
            }
            let x = points("sobol", &[scramble, "shift=none"], 1024, 3, 3, index);
            for levels in 1..=10 {
                for counts in shapes(levels - 1, 3) {
                    assert_eq!(fullest(&x[..3 << levels], &counts), (2, true), "{scramble} {counts:?}: t = 1");
                }
            }
        }
    }
    let at = |scramble, index| points("sobol", &[scramble], 64, 2, 3, index);
    assert_ne!(at("scramble=owen", 0), at("scramble=owen", 1));
    // A digital shift moves all digits alike.
    let bits = |x: &f64| (x * 2f64.powi(53)) as u64;
    let (a, b) = (at("scramble=digital-shift", 0), at("scramble=digital-shift", 1));
    let xor: Vec<u64> = a.iter().zip(&b).map(|(a, b)| bits(a) ^ bits(b)).collect();
    assert!(xor.chunks_exact(2).all(|pair| pair == &xor[..2]) && xor[0] != 0 && xor[1] != 0);
}

/// Sums over points of (i^3 mod 1021) times each coordinate, from scipy's `qmc.Sobol(16, scramble=False)` put into natural order.
#[test]
fn sobol_has_the_direction_numbers_of_joe_and_kuo() {
    let x = points("sobol", &["scramble=none", "shift=none"], 1024, 16, 1, 0);
    for (axis, known) in SOBOL_SUMS.iter().enumerate() {
        let sum: f64 = x.chunks_exact(16).enumerate().map(|(i, point)| (i.pow(3) % 1021) as f64 * point[axis]).sum();
        assert!((sum - known).abs() < 1e-6, "axis {axis}: {sum} against {known}");
    }
}

#[test]
fn halton_boxes_hold_one_point() {
    for scramble in ["scramble=none", "scramble=permuted", "scramble=owen"] {
        for index in 0..3 {
            let x = points("halton", &[scramble, "shift=none"], 8 * 27 * 5, 3, 9, index);
            for counts in [[8, 27, 5], [8, 27, 1], [8, 1, 5], [1, 27, 5], [2, 3, 5], [4, 9, 1]] {
                let total = counts.iter().product::<u64>() as usize;
                for block in x.chunks_exact(3 * total) {
                    assert_eq!(fullest(block, &counts), (1, true), "{scramble} {counts:?}");
                }
            }
        }
    }
    // Permuted: every first digit of the origin equally often, on every axis (chi-squared, 6 standard deviations).
    let process = Process::new("halton", 1, 3000, 4, 5, &["scramble=permuted"]).unwrap();
    let sets: Vec<_> = (0..3000).map(|k| process.coordinates(k, &Control::default()).unwrap()).collect();
    for (axis, base) in [2, 3, 5, 7].into_iter().enumerate() {
        let mut counts = vec![0.0; base];
        sets.iter().for_each(|x| counts[(x[axis] * base as f64) as usize] += 1.0);
        let mean = 3000.0 / base as f64;
        let chi2: f64 = counts.iter().map(|c| (c - mean) * (c - mean) / mean).sum();
        let freedom = base as f64 - 1.0;
        assert!(chi2 < freedom + 6.0 * (2.0 * freedom).sqrt(), "base {base}: {chi2}");
    }
}

/// Against the digits one by one.
#[test]
fn radical_inverses_are_mirrored_digits() {
    let inverse = |base: u64, i: u64| {
        let (mut rest, mut mirrored, mut scale) = (i, 0u64, 1u64);
        while rest > 0 {
            (mirrored, scale) = (mirrored * base + rest % base, scale * base);
            rest /= base;
        }
        mirrored as f64 / scale as f64
    };
    let primes = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];
    let x = points("halton", &["shift=none"], 3000, 16, 1, 0);
    for (i, point) in x.chunks_exact(16).enumerate() {
        for (axis, base) in primes.into_iter().enumerate() {
            assert_eq!(point[axis], inverse(base, i as u64), "point {i}, axis {axis}");
        }
    }
    let x = points("hammersley", &["shift=none"], 1000, 3, 1, 0);
    for (i, point) in x.chunks_exact(3).enumerate() {
        assert_eq!(point, [i as f64 / 1000.0, inverse(2, i as u64), inverse(3, i as u64)]);
    }
}

#[test]
fn every_stratum_has_its_point() {
    for index in 0..20 {
        for permutations in ["permutations=shared", "permutations=independent"] {
            let x = points("cmj", &[permutations], 49, 2, 4, index);
            for counts in [[7, 7], [49, 1], [1, 49]] {
                assert_eq!(fullest(&x, &counts), (1, true), "{permutations} {counts:?}");
            }
        }
        let x = points("jittered", &[], 125, 3, 4, index);
        assert_eq!(fullest(&x, &[5, 5, 5]), (1, true));
        for place in ["place=random", "place=centre"] {
            let x = points("lhs", &[place], 37, 5, 4, index);
            for axis in 0..5 {
                let mut counts = [1; 5];
                counts[axis] = 37;
                assert_eq!(fullest(&x, &counts), (1, true), "{place} axis {axis}");
            }
        }
    }
    // Cells of 0, 1 and 10 points with probabilities 1/10, 8/9 and 1/90, and no others.
    let process = Process::new("cell", 400, 50, 2, 4, &[]).unwrap();
    let mut counts = [0.0; 3];
    for k in 0..50 {
        let mut cells = vec![0; 400];
        for point in process.coordinates(k, &Control::default()).unwrap().chunks_exact(2) {
            cells[(point[1] * 20.0) as usize * 20 + (point[0] * 20.0) as usize] += 1;
        }
        for count in cells {
            counts[match count {
                0 => 0,
                1 => 1,
                10 => 2,
                other => panic!("{other} points in a cell"),
            }] += 1.0;
        }
    }
    let expected = [0.1, 8.0 / 9.0, 1.0 / 90.0].map(|p| p * 20_000.0);
    let chi2: f64 = counts.iter().zip(expected).map(|(c, e)| (c - e) * (c - e) / e).sum();
    assert!(chi2 < 18.4, "{counts:?}: chi-squared {chi2}, 18.4 is passed once in 10,000");
}

#[test]
fn lattices_keep_their_distances() {
    let d = |name: &str, given: &[&str], n, dim| nearest(&points(name, given, n, dim, 1, 0), dim);
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} against {b}");
    let packed = |n: f64| (2f64.sqrt() / n).cbrt();
    close(d("fcc", &[], 108, 3), packed(108.0));
    close(d("bcc", &[], 128, 3), (3.0 * 3f64.sqrt() / (4.0 * 2f64.sqrt())).cbrt() * packed(128.0));
    // 30 rows of 26 points.
    close(d("hexagonal", &[], 780, 2), f64::min(1.0 / 26.0, (0.25 / 676.0 + 1.0 / 900.0f64).sqrt()));
    assert!(d("hexagonal", &[], 780, 2) > 0.9996 * (2.0 / (3f64.sqrt() * 780.0)).sqrt());
}

/// The shortest vector of every lattice, by going through its points.
#[test]
fn the_widest_lattice_is_the_widest() {
    let shortest2 = |n: u64, z: &[u64]| -> u64 {
        let of = |i: u64| z.iter().map(|z| (i * z % n).min(n - i * z % n).pow(2)).sum::<u64>();
        (1..n).map(of).min().unwrap().min(n * n)
    };
    let coprime = |a: u64, n: u64| (2..=a).all(|p| !a.is_multiple_of(p) || !n.is_multiple_of(p));
    for (dim, all) in
        [(2, (2..=96).chain([127, 128, 210, 256, 511, 512]).collect::<Vec<u64>>()), (3, vec![2, 5, 16, 30, 61, 128])]
    {
        for n in all {
            let z = |a: u64| [1, a, a * a % n][..dim].to_vec();
            let (mut best, mut at) = (0, 1);
            for a in (1..n).filter(|&a| coprime(a, n)) {
                let s = shortest2(n, &z(a));
                if s > best {
                    (best, at) = (s, a);
                }
            }
            let x = points("lattice", &["shift=none"], n, dim, 1, 0);
            // The first point after the origin is (1/n, a/n, ..).
            let a = (x[dim + 1] * n as f64).round() as u64;
            assert_eq!(a, at, "n = {n}, {dim}D");
        }
    }
}

/// The ratios solve their equation to the last bit: the sequence is what exact arithmetic would give, far out too.
#[test]
fn kronecker_sequences_keep_their_digits() {
    let x = points("kronecker", &["shift=none"], 1_000_000, 1, 1, 0);
    // 1/phi to 30 digits; i of it modulo 1, by whole numbers.
    let digits = 618_033_988_749_894_848_204_586_834_365u128;
    let one = 10u128.pow(30);
    for i in [1u128, 2, 1000, 123_456, 999_999] {
        let expected = (i * digits % one) as f64 / one as f64;
        assert!((x[i as usize] - expected).abs() < 1e-13, "{i}: {} against {expected}", x[i as usize]);
    }
    // phi_2 = 1.32471795724474602596..., the plastic number.
    let x = points("kronecker", &["shift=none"], 2, 2, 1, 0);
    let plastic = 1.324_717_957_244_746;
    assert!((x[2] - 1.0 / plastic).abs() < 1e-15 && (x[3] - 1.0 / (plastic * plastic)).abs() < 1e-15);
}

/// By axis.
const SOBOL_SUMS: [f64; 16] = [
    262362.414062,
    260704.332031,
    261273.402344,
    262514.242188,
    266235.753906,
    261346.125000,
    260087.027344,
    259999.476562,
    263222.820312,
    260197.730469,
    260185.683594,
    260652.101562,
    258194.460938,
    260813.757812,
    261327.136719,
    259744.941406,
];

#[test]
fn progressive_sets_are_nets_and_spread() {
    for index in 0..3 {
        let x = points("pmj02", &[], 1024, 2, 3, index);
        for levels in 0..=10 {
            for counts in shapes(levels, 2) {
                assert_eq!(fullest(&x[..2 << levels], &counts), (1, true), "{counts:?}");
            }
        }
        // Three quarters of a net: never two in a cell of the whole.
        for levels in [1, 2, 3, 4] {
            for counts in shapes(2 * levels, 2) {
                assert_eq!(fullest(&x[..6 << (2 * levels - 2)], &counts), (1, false), "{counts:?}");
            }
            let side = 1 << (levels - 1);
            for block in x[..8 << (2 * levels - 2)].chunks_exact(2 << (2 * levels - 2)) {
                assert_eq!(fullest(block, &[side, side]), (1, true), "one of each block in every cell");
            }
        }
    }
    assert_ne!(points("pmj02", &[], 8, 2, 3, 0), points("pmj02", &[], 8, 2, 3, 1));
}
