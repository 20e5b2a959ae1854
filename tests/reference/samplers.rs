//! Samplers against their closed forms, in standard errors of a direct simulation.
//!
//! Trusts: arithmetic, and the closed forms' derivations quoted in `src/samplers`. Proves: the samplers have the g and P they
//! claim, depend on nothing but their identity, and refuse what they cannot do. The sums below are written out here, on
//! f64, and share nothing with the library's. Cannot see: faults that leave first and second moments unchanged.

use pairwave::control::Control;
use pairwave::samplers::{ParameterValues, Realization, Sampler, ensemble, find, registry};

fn values(name: &str, given: &[&str]) -> ParameterValues {
    ParameterValues::parse(find(name).unwrap(), given).unwrap()
}

fn points(name: &str, given: &[&str], n: u64, dim: usize, seed: u64, index: u64) -> Vec<f64> {
    find(name).unwrap().generate(&Realization { n, dim, seed, index }, &values(name, given)).unwrap()
}

fn error(result: pairwave::Result<impl Sized>) -> String {
    result.err().expect("an error").to_string()
}

/// |s_m|^2.
fn power(points: &[f64], dim: usize, m: [i32; 3]) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for x in points.chunks_exact(dim) {
        let phase: f64 = x.iter().zip(m).map(|(x, m)| x * f64::from(m)).sum();
        let (sin, cos) = (std::f64::consts::TAU * phase).sin_cos();
        re += cos;
        im += sin;
    }
    re * re + im * im
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let along = |(a, b): (&f64, &f64)| {
        let d = (a - b).abs();
        d.min(1.0 - d).powi(2)
    };
    a.iter().zip(b).map(along).sum::<f64>().sqrt()
}

/// Ordered pairs at a distance in [lo, hi).
fn pairs(points: &[f64], dim: usize, lo: f64, hi: f64) -> f64 {
    let points: Vec<_> = points.chunks_exact(dim).collect();
    let mut count = 0;
    for (i, a) in points.iter().enumerate() {
        for b in &points[..i] {
            let r = distance(a, b);
            count += i32::from(lo <= r && r < hi);
        }
    }
    2.0 * f64::from(count)
}

fn ball(dim: usize, r: f64) -> f64 {
    [2.0 * r, std::f64::consts::PI * r * r, 4.0 / 3.0 * std::f64::consts::PI * r.powi(3)][dim - 1]
}

/// `sum a / sum b` and its standard error (ratio estimate, delta method).
fn ratio(samples: &[(f64, f64)]) -> (f64, f64) {
    let k = samples.len() as f64;
    let (a, b): (f64, f64) = samples.iter().fold((0.0, 0.0), |s, x| (s.0 + x.0, s.1 + x.1));
    let estimate = a / b;
    let spread: f64 = samples.iter().map(|(a, b)| (a - estimate * b).powi(2)).sum();
    (estimate, (spread / (k * (k - 1.0))).sqrt() / (b / k))
}

/// Every expectation of every test is compared at this many standard errors: some 200 comparisons with fixed seeds.
const STANDARD_ERRORS: f64 = 4.0;

/// `(estimate - expected) / standard error`.
fn clearance(samples: &[(f64, f64)], expected: f64) -> f64 {
    let (estimate, error) = ratio(samples);
    // Where the process leaves no freedom, only rounding is left.
    (estimate - expected) / error.max(1e-9)
}

fn check_power(name: &str, given: &[&str], n: u64, dim: usize, realizations: u64, modes: &[[i32; 3]]) {
    let (sampler, values) = (find(name).unwrap(), values(name, given));
    let sets: Vec<_> = (0..realizations).map(|k| points(name, given, n, dim, 1, k)).collect();
    for &m in modes {
        let expected = sampler.power(n, m, dim, &values).expect("a closed form");
        let samples: Vec<_> = sets.iter().map(|x| (power(x, dim, m), (x.len() / dim) as f64)).collect();
        let z = clearance(&samples, expected);
        assert!(z.abs() < STANDARD_ERRORS, "{name} {given:?} {dim}D, P({m:?}) = {expected}: {z} standard errors off");
    }
}

fn check_pair_correlation(name: &str, given: &[&str], n: u64, dim: usize, realizations: u64, bins: &[(f64, f64)]) {
    let (sampler, values) = (find(name).unwrap(), values(name, given));
    let sets: Vec<_> = (0..realizations).map(|k| points(name, given, n, dim, 2, k)).collect();
    for &(lo, hi) in bins {
        // The closed form averaged over the shell, by the midpoint rule in volume.
        let steps = 200;
        let shell = ball(dim, hi) - ball(dim, lo);
        let radius = |i: i32| {
            let inside = ball(dim, lo) + shell * (f64::from(i) + 0.5) / f64::from(steps);
            (inside / ball(dim, 1.0)).powf(1.0 / dim as f64)
        };
        let expected = (0..steps).map(|i| sampler.pair_correlation(n, dim, radius(i), &values).unwrap()).sum::<f64>()
            / f64::from(steps);
        let samples: Vec<_> = sets
            .iter()
            .map(|x| {
                let n = (x.len() / dim) as f64;
                (pairs(x, dim, lo, hi), n * (n - 1.0) * shell)
            })
            .collect();
        let z = clearance(&samples, expected);
        assert!(
            z.abs() < STANDARD_ERRORS,
            "{name} {given:?} {dim}D, g in [{lo}, {hi}) = {expected}: {z} standard errors off"
        );
    }
}

const MODES: [[i32; 3]; 7] = [[1, 0, 0], [2, 0, 0], [0, 3, 0], [1, -2, 0], [4, 4, 4], [5, 7, -3], [-8, 1, 2]];

fn modes(dim: usize) -> Vec<[i32; 3]> {
    let cut = |m: [i32; 3]| std::array::from_fn(|k| if k < dim { m[k] } else { 0 });
    MODES.into_iter().map(cut).filter(|&m| m != [0; 3]).collect()
}

const BINS: [(f64, f64); 6] = [(0.0, 0.08), (0.08, 0.1), (0.1, 0.15), (0.15, 0.25), (0.25, 0.35), (0.35, 0.5)];

#[test]
fn random_is_white() {
    for dim in 1..=3 {
        check_power("random", &[], 60, dim, 2000, &modes(dim));
        check_pair_correlation("random", &[], 60, dim, 1000, &BINS);
    }
}

#[test]
fn jittered_has_its_power_and_pair_correlation() {
    for (dim, n) in [(1, 8), (2, 49), (3, 64), (2, 4), (3, 8), (2, 1)] {
        check_power("jittered", &[], n, dim, 3000, &modes(dim));
        if n > 1 {
            check_pair_correlation("jittered", &[], n, dim, 100_000 / n, &BINS);
        }
    }
}

#[test]
fn thomas_has_its_power_and_pair_correlation() {
    let few_tight: &[&str] = &["mu=4", "sigma=0.2"];
    for dim in 1..=3 {
        check_power("thomas", &[], 60, dim, 3000, &modes(dim));
        check_pair_correlation("thomas", few_tight, 60, dim, 3000, &BINS);
    }
    // Clusters so wide that they wrap: the images count.
    check_power("thomas", &["sigma=0.9"], 30, 2, 3000, &modes(2));
    for (dim, sigma) in [(1, "sigma=5.5"), (2, "sigma=1.05"), (3, "sigma=0.6")] {
        check_pair_correlation("thomas", &[sigma], 30, dim, 4000, &BINS);
    }
}

#[test]
fn thomas_counts_have_the_variance_of_clusters() {
    let (n, mu) = (50.0, 10.0);
    let counts: Vec<_> = (0..4000).map(|k| points("thomas", &[], 50, 1, 3, k).len() as f64).collect();
    let mean: Vec<_> = counts.iter().map(|&c| (c, 1.0)).collect();
    let square: Vec<_> = counts.iter().map(|&c| ((c - n).powi(2), 1.0)).collect();
    assert!(clearance(&mean, n).abs() < STANDARD_ERRORS);
    assert!(clearance(&square, n * (1.0 + mu)).abs() < STANDARD_ERRORS);
}

#[test]
fn a_grid_is_its_bragg_peaks() {
    for (dim, n, peaks) in [(1, 6, 6), (2, 36, 6), (3, 216, 6)] {
        let mut all = modes(dim);
        let mut peak = [0; 3];
        peak[..dim].fill(peaks);
        peak[0] = -2 * peaks;
        all.extend([peak, [peaks, 0, 0]]);
        check_power("grid", &[], n, dim, 2, &all);
        check_power("grid", &["shift=random"], n, dim, 3, &all);
        let (grid, values) = (find("grid").unwrap(), values("grid", &[]));
        assert_eq!(grid.power(n, peak, dim, &values), Some(n as f64));
        assert_eq!(grid.power(n, [1, 0, 0], dim, &values), Some(0.0));
        assert_eq!(grid.pair_correlation(n, dim, 0.2, &values), None);
    }
    assert_eq!(points("grid", &[], 4, 2, 0, 0), [0.25, 0.25, 0.75, 0.25, 0.25, 0.75, 0.75, 0.75]);
}

/// The comparator must ring: the closed form of a neighbouring process is caught.
#[test]
fn a_wrong_closed_form_is_caught() {
    let (jittered, values) = (find("jittered").unwrap(), values("jittered", &[]));
    let samples: Vec<_> =
        (0..3000).map(|k| (power(&points("jittered", &[], 49, 2, 1, k), 2, [2, 2, 0]), 49.0)).collect();
    for wrong_n in [36, 64] {
        let expected = jittered.power(wrong_n, [2, 2, 0], 2, &values).unwrap();
        assert!(clearance(&samples, expected).abs() > 2.0 * STANDARD_ERRORS, "{wrong_n}");
    }
    assert!(clearance(&samples, 1.0).abs() > 2.0 * STANDARD_ERRORS);
}

#[test]
fn poisson_disk_keeps_its_distance() {
    for (dim, n, radius) in [
        (1, 300, 0.7),
        (2, 500, 0.7),
        (3, 500, 0.7),
        (2, 200, 0.74),
        (2, 5, 0.7),
        (1, 4, 0.7),
        (3, 2, 0.7),
        (2, 400, 0.01),
    ] {
        // sqrt(2 / (sqrt(3) n)) in 2D, the cube root of sqrt(2) / n in 3D.
        let n_f = n as f64;
        let packed = [1.0 / n_f, (2.0 / (3f64.sqrt() * n_f)).sqrt(), (2f64.sqrt() / n_f).cbrt()][dim - 1];
        for index in 0..5 {
            let set = points("poisson-disk", &[&format!("radius={radius}")], n, dim, 5, index);
            assert_eq!(set.len(), n as usize * dim);
            let set: Vec<_> = set.chunks_exact(dim).collect();
            let mut minimum = f64::INFINITY;
            for (i, a) in set.iter().enumerate() {
                for b in &set[..i] {
                    minimum = minimum.min(distance(a, b));
                }
            }
            assert!(minimum >= radius * packed, "{dim}D, n = {n}: {minimum} < {}", radius * packed);
            if n >= 200 && radius > 0.5 {
                assert!(minimum < 1.05 * radius * packed, "{dim}D, n = {n}: {minimum} is far above the radius");
            }
        }
    }
}

/// Against a second implementation of the definition, without cells: a dart is kept if it is far from all before it. The
/// statistic is the fraction of darts kept, seen through g just above the radius.
#[test]
fn poisson_disk_cells_change_nothing() {
    let (n, dim) = (40, 2);
    let packed = (2.0 / (3f64.sqrt() * 40.0)).sqrt();
    let radius = 0.6 * packed;
    let mut state = 1u64;
    let mut uniform = move || {
        // SplitMix64: a generator that has nothing to do with the library's.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / 2f64.powi(53)
    };
    let mut plain = || {
        let mut kept: Vec<f64> = Vec::new();
        while kept.len() < 2 * n {
            let dart = [uniform(), uniform()];
            if kept.chunks_exact(2).all(|p| distance(p, &dart) >= radius) {
                kept.extend(dart);
            }
        }
        kept
    };
    for (lo, hi) in [(1.0, 1.1), (1.3, 1.6), (2.0, 2.2)] {
        let count = |x: &[f64]| (pairs(x, dim, lo * radius, hi * radius), 1.0);
        let ours: Vec<_> =
            (0..2000).map(|k| count(&points("poisson-disk", &["radius=0.6"], n as u64, dim, 9, k))).collect();
        let theirs: Vec<_> = (0..2000).map(|_| count(&plain())).collect();
        let ((a, a_error), (b, b_error)) = (ratio(&ours), ratio(&theirs));
        let z = (a - b) / a_error.hypot(b_error);
        assert!(z.abs() < STANDARD_ERRORS, "pairs in [{lo}, {hi}): {a} against {b}, {z} standard errors");
    }
}

#[test]
fn poisson_disk_says_when_it_cannot() {
    let disk = find("poisson-disk").unwrap();
    let jammed = |n, dim, radius| error(disk.check(n, dim, &values("poisson-disk", &[radius])));
    assert_eq!(
        jammed(100_000, 2, "radius=0.8"),
        "params radius=0.8: dart throwing cannot place 100000 points this far apart in 2D; lower radius (many points jam \
         near 0.7767, the default is 0.7)"
    );
    // Allowed by the quick check, found out by throwing.
    let values = values("poisson-disk", &["radius=0.9"]);
    assert!(disk.check(20, 2, &values).is_ok());
    let message = error(disk.generate(&Realization { n: 20, dim: 2, seed: 1, index: 0 }, &values));
    assert!(message.starts_with("params radius=0.9: dart throwing cannot place 20 points"), "{message}");
}

#[test]
fn halton_begins_as_published() {
    let set = points("halton", &["scramble=none"], 6, 3, 0, 0);
    let known = [
        [0.0, 0.0, 0.0],
        [1.0 / 2.0, 1.0 / 3.0, 1.0 / 5.0],
        [1.0 / 4.0, 2.0 / 3.0, 2.0 / 5.0],
        [3.0 / 4.0, 1.0 / 9.0, 3.0 / 5.0],
        [1.0 / 8.0, 4.0 / 9.0, 4.0 / 5.0],
        [5.0 / 8.0, 7.0 / 9.0, 1.0 / 25.0],
    ];
    assert_eq!(set, known.as_flattened());
    // The default is the same set, moved.
    let moved = points("halton", &[], 6, 3, 0, 0);
    for (a, b) in moved.chunks_exact(3).zip(known) {
        for k in 0..3 {
            let expected = (b[k] + moved[k]) % 1.0;
            assert!((a[k] - expected).abs() < 1e-15, "{} against {expected}", a[k]);
        }
    }
    assert_ne!(moved, points("halton", &[], 6, 3, 0, 1));
}

fn small_n(name: &str) -> u64 {
    if name == "thomas" { 200 } else { 64 }
}

#[test]
fn a_realization_depends_on_its_identity_alone() {
    for sampler in registry() {
        let name = sampler.name();
        let n = small_n(name);
        for dim in 1..=3 {
            assert!(dim == 2 || sampler.check(n, dim, &values(name, &[])).is_ok());
        }
        let again = |seed, index| points(name, &[], n, 3, seed, index);
        assert_eq!(again(7, 3), again(7, 3), "{name}");
        let values = values(name, &[]);
        let control = Control::default();
        let whole = ensemble(*sampler, n, 3, 7, 0..5, &values, &control).unwrap();
        let part = ensemble(*sampler, n, 3, 7, 2..5, &values, &control).unwrap();
        assert_eq!(whole.slice(2..5), part, "{name}");
        assert_eq!(part.first_index(), 2);
        if name != "grid" {
            assert_ne!(again(7, 3), again(8, 3), "{name}: the seed must matter");
            assert_ne!(again(7, 3), again(7, 4), "{name}: the index must matter");
        }
        // A default given explicitly changes nothing.
        let explicit: Vec<String> = sampler.parameters().iter().map(|p| format!("{}={}", p.name, p.default)).collect();
        assert_eq!(ParameterValues::parse(*sampler, &explicit).unwrap(), values, "{name}");
    }
    assert_eq!(points("poisson-disk", &["radius=0.70"], 20, 2, 1, 0), points("poisson-disk", &[], 20, 2, 1, 0));
    assert_ne!(points("poisson-disk", &["radius=0.5"], 20, 2, 1, 0)[0], points("poisson-disk", &[], 20, 2, 1, 0)[0]);
    // n and dim are part of the identity, too: the first points of a larger set are others.
    assert_ne!(points("random", &[], 4, 2, 1, 0)[0], points("random", &[], 5, 2, 1, 0)[0]);
    assert_ne!(points("random", &[], 4, 2, 1, 0)[0], points("random", &[], 4, 1, 1, 0)[0]);
}

/// Results that users published depend on these bits.
#[test]
fn the_bits_stay() {
    let start = |name: &str| {
        let set = points(name, &[], 64, 3, 42, 7);
        [set[0], set[1], set[2], set[3]].map(|x| (x * 2f64.powi(53)) as u64)
    };
    let pinned = [
        ("random", [6_191_395_160_463_350, 6_170_016_881_516_373, 7_785_943_990_078_652, 5_706_171_610_752_924]),
        ("jittered", [1_907_535_232_833_225, 2_071_814_566_676_328, 2_108_266_391_446_542, 2_921_418_835_026_221]),
        ("poisson-disk", [1_895_467_313_948_662, 3_771_412_668_742_321, 216_202_923_644_271, 3_815_512_481_862_319]),
        ("halton", [634_483_774_260_106, 6_600_546_778_500_363, 5_295_543_103_761_137, 5_138_083_401_630_602]),
        ("thomas", [2_162_179_483_987_745, 6_341_968_030_263_894, 6_263_493_895_292_104, 1_658_141_356_636_782]),
    ];
    for (name, bits) in pinned {
        assert_eq!(start(name), bits, "{name}");
    }
}

#[test]
fn coordinates_stay_in_the_half_open_box() {
    for sampler in registry() {
        for (dim, n) in [(1, 100_000), (2, 316 * 316), (3, 46 * 46 * 46)] {
            let set = points(sampler.name(), &[], n, dim, 1, 0);
            assert!(set.iter().all(|x| (0.0..1.0).contains(x)), "{} in {dim}D", sampler.name());
            assert!(!sampler.fixed_n() || set.len() == n as usize * dim);
        }
    }
}

#[test]
fn sizes_that_do_not_fit_are_refused_with_the_nearest_that_do() {
    let none: &[&str] = &[];
    let refused = |name: &str, n, dim| error(find(name).unwrap().check(n, dim, &values(name, none)));
    assert_eq!(refused("grid", 1000, 2), "points 1000: grid in 2D needs n = k^2; the nearest are 961 and 1024");
    assert_eq!(refused("jittered", 999, 3), "points 999: jittered in 3D needs n = k^3; the nearest are 729 and 1000");
    assert_eq!(
        refused("jittered", 99_999_999, 2),
        "points 99999999: jittered in 2D needs n = k^2; the nearest are 99980001 and 100000000"
    );
    assert_eq!(refused("random", 0, 2), "points 0: expected 1 to 100000000 points");
    assert_eq!(refused("random", 100_000_001, 2), "points 100000001: expected 1 to 100000000 points");
    assert_eq!(refused("halton", 10, 4), "dim 4: expected 1, 2 or 3");
    assert_eq!(refused("thomas", 10, 0), "dim 0: expected 1, 2 or 3");
    for k in 1..=464u64 {
        assert!(find("grid").unwrap().check(k * k * k, 3, &values("grid", none)).is_ok(), "{k}^3");
    }
    for sampler in registry() {
        let one = points(sampler.name(), none, 1, 2, 1, 0);
        assert!(!sampler.fixed_n() || one.len() == 2, "{}: one point", sampler.name());
        assert_eq!(sampler.pair_correlation(1, 2, 0.2, &values(sampler.name(), none)).filter(|g| !g.is_finite()), None);
        assert!(
            sampler.generate(&Realization { n: 0, dim: 2, seed: 0, index: 0 }, &values(sampler.name(), none)).is_err()
        );
    }
}

#[test]
fn wrong_parameters_are_refused_by_name() {
    let refused = |name: &str, given: &[&str]| error(ParameterValues::parse(find(name).unwrap(), given));
    let disk = "poisson-disk";
    assert_eq!(
        refused(disk, &["raduis=0.5"]),
        "params raduis=0.5: poisson-disk has no parameter raduis (did you mean radius?); expected radius (a number above 0 \
         and at most 1, default 0.7)"
    );
    for bad in ["1.5", "0", "-1", "NaN", "inf", "wide", ""] {
        assert_eq!(
            refused(disk, &[&format!("radius={bad}")]),
            format!("params radius={bad}: radius of poisson-disk is a number above 0 and at most 1 (default 0.7)")
        );
    }
    assert_eq!(refused(disk, &["radius"]), "params radius: expected key=value");
    assert_eq!(refused(disk, &["radius=0.5", "radius=0.6"]), "params radius=0.6: radius is given twice");
    assert_eq!(refused("random", &["x=1"]), "params x=1: random has no parameters");
    assert_eq!(refused("grid", &["shift=left"]), "params shift=left: shift of grid is none or random (default none)");
    assert_eq!(
        error(find("Jitered").map(|s| s.name())),
        "sampler Jitered: no such sampler (did you mean jittered?); expected one of random, grid, jittered, poisson-disk, halton, thomas"
    );
    assert_eq!(
        error(find("zzz").map(|s| s.name())),
        "sampler zzz: no such sampler; expected one of random, grid, jittered, poisson-disk, halton, thomas"
    );
    // Values made for another sampler are an error, not a default.
    let grid: &dyn Sampler = find("grid").unwrap();
    assert!(grid.generate(&Realization { n: 4, dim: 2, seed: 0, index: 0 }, &values("random", &[])).is_err());
}
