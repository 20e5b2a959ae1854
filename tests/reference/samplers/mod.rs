//! Samplers against their closed forms, in standard errors of a direct simulation.
//!
//! Trusts: arithmetic, and the closed forms' derivations quoted in `src/samplers`. Proves: the samplers have the g and P they
//! claim, depend on nothing but their identity, and refuse what they cannot do. The sums below are written out here, on
//! f64, and share nothing with the library's. Cannot see: faults that leave first and second moments unchanged.

mod blue_noise;
mod proofs;
mod strata;

use pairwave::control::Control;
use pairwave::samplers::{Accepts, Entry, MAX_POINTS, Number, Parameter, ParameterValues, Process, find, registry};

fn process(name: &str, given: &[&str], n: u64, dim: usize, seed: u64) -> Process {
    Process::new(name, n, 1, dim, seed, given).unwrap()
}

fn points(name: &str, given: &[&str], n: u64, dim: usize, seed: u64, index: u64) -> Vec<f64> {
    process(name, given, n, dim, seed).coordinates(index, &Control::default()).unwrap()
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
    let process = process(name, given, n, dim, 1);
    let sets: Vec<_> = (0..realizations).map(|k| process.coordinates(k, &Control::default()).unwrap()).collect();
    for &m in modes {
        let expected = process.power(m).expect("a closed form");
        let samples: Vec<_> = sets.iter().map(|x| (power(x, dim, m), (x.len() / dim) as f64)).collect();
        let z = clearance(&samples, expected);
        assert!(z.abs() < STANDARD_ERRORS, "{name} {given:?} {dim}D, P({m:?}) = {expected}: {z} standard errors off");
    }
}

fn check_pair_correlation(name: &str, given: &[&str], n: u64, dim: usize, realizations: u64, bins: &[(f64, f64)]) {
    let process = process(name, given, n, dim, 2);
    let sets: Vec<_> = (0..realizations).map(|k| process.coordinates(k, &Control::default()).unwrap()).collect();
    for &(lo, hi) in bins {
        // The closed form averaged over the shell, by the midpoint rule in volume.
        let steps = 200;
        let shell = ball(dim, hi) - ball(dim, lo);
        let radius = |i: i32| {
            let inside = ball(dim, lo) + shell * (f64::from(i) + 0.5) / f64::from(steps);
            (inside / ball(dim, 1.0)).powf(1.0 / dim as f64)
        };
        let expected = (0..steps).map(|i| process.pair_correlation(radius(i)).unwrap()).sum::<f64>() / f64::from(steps);
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
fn a_grid_is_its_bragg_peaks() {
    for (dim, n, peaks) in [(1, 6, 6), (2, 36, 6), (3, 216, 6)] {
        let mut all = modes(dim);
        let mut peak = [0; 3];
        peak[..dim].fill(peaks);
        peak[0] = -2 * peaks;
        all.extend([peak, [peaks, 0, 0]]);
        check_power("grid", &[], n, dim, 2, &all);
        check_power("grid", &["shift=random"], n, dim, 3, &all);
        let grid = process("grid", &[], n, dim, 1);
        assert_eq!(grid.power(peak), Some(n as f64));
        assert_eq!(grid.power([1, 0, 0]), Some(0.0));
        assert_eq!(grid.pair_correlation(0.2), None);
    }
    assert_eq!(points("grid", &[], 4, 2, 0, 0), [0.25, 0.25, 0.75, 0.25, 0.25, 0.75, 0.75, 0.75]);
}

/// The comparator must ring: the closed form of a neighbouring process is caught.
#[test]
fn a_wrong_closed_form_is_caught() {
    let samples: Vec<_> =
        (0..3000).map(|k| (power(&points("jittered", &[], 49, 2, 1, k), 2, [2, 2, 0]), 49.0)).collect();
    for wrong_n in [36, 64] {
        let expected = process("jittered", &[], wrong_n, 2, 1).power([2, 2, 0]).unwrap();
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
    let jammed = |n, dim, radius| error(Process::new("poisson-disk", n, 1, dim, 1, &[radius]));
    assert_eq!(
        jammed(100_000, 2, "radius=0.8"),
        "params radius=0.8: dart throwing cannot place 100000 points this far apart in 2D; lower radius (many points jam \
         near 0.7767, the default is 0.7)"
    );
    // Allowed by the quick check, found out by throwing.
    let message = error(process("poisson-disk", &["radius=0.9"], 20, 2, 1).coordinates(0, &Control::default()));
    assert!(message.starts_with("params radius=0.9: dart throwing cannot place 20 points"), "{message}");
}

#[test]
fn halton_begins_as_published() {
    let set = points("halton", &["shift=none"], 6, 3, 0, 0);
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

/// The number of points nearest to 64 that a sampler makes, in the last of its dimensions up to 3.
fn some(sampler: &Entry) -> (u64, usize) {
    let dim = sampler.dims.clone().rfind(|dim| *dim <= 3).unwrap();
    (sampler.nearest_size(64, dim), dim)
}

#[test]
fn a_realization_depends_on_its_identity_alone() {
    for sampler in registry() {
        let name = sampler.name;
        let (n, dim) = some(sampler);
        // Unshifted nets and lattices are the same every time; their shifts are not.
        let given = ["shift=random"];
        let again = |seed, index| points(name, &given, n, dim, seed, index);
        assert_eq!(again(7, 3), again(7, 3), "{name}");
        let control = Control::default();
        let process = process(name, &given, n, dim, 7);
        let whole = process.ensemble(0..5, &control).unwrap();
        let part = process.ensemble(2..5, &control).unwrap();
        assert_eq!(whole.slice(2..5), part, "{name}");
        assert_eq!(part.first_index(), 2);
        assert_ne!(again(7, 3), again(8, 3), "{name}: the seed must matter");
        assert_ne!(again(7, 3), again(7, 4), "{name}: the index must matter");
        // A default given explicitly changes nothing.
        let explicit: Vec<String> = sampler.all_parameters().map(|p| format!("{}={}", p.name, p.default)).collect();
        let none: &[&str] = &[];
        assert_eq!(ParameterValues::parse(sampler, &explicit).unwrap(), ParameterValues::parse(sampler, none).unwrap());
        // An alias gives the bytes of the name.
        for alias in sampler.aliases {
            assert_eq!(points(alias, &given, n, dim, 7, 3), again(7, 3), "{alias}");
        }
        // Its number of points is what it says.
        for index in 0..20 {
            let drawn = process.coordinates(index, &control).unwrap().len() / dim;
            assert_eq!(process.count(index, &control).unwrap(), drawn as u64, "{name}");
        }
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
        ("thomas", [2_162_179_483_987_745, 6_341_968_030_263_894, 6_263_493_895_292_104, 1_658_141_356_636_782]),
    ];
    for (name, bits) in pinned {
        assert_eq!(start(name), bits, "{name}");
    }
}

#[test]
fn coordinates_stay_in_the_half_open_box() {
    for sampler in registry() {
        for dim in sampler.dims.clone() {
            let slow = ["best-candidate", "lloyd", "fpo", "stealthy", "gaussian-dpp", "fourier-dpp", "ginibre"];
            let many = if slow.contains(&sampler.name) { 200 } else { 20_000 };
            let n = sampler.nearest_size(many, dim);
            for shift in ["shift=none", "shift=random"] {
                // On a line, half of all frequencies are half of what there is.
                let given = if sampler.name == "stealthy" { vec![shift, "nu0=0.3"] } else { vec![shift] };
                let set = points(sampler.name, &given, n, dim, 1, 0);
                assert!(set.iter().all(|x| (0.0..1.0).contains(x)), "{} in {dim}D", sampler.name);
                assert!(!sampler.fixed_n() || set.len() == n as usize * dim);
            }
        }
    }
}

/// The first points of a sequence do not depend on how many follow.
#[test]
fn sequences_have_prefixes() {
    for sampler in registry().iter().filter(|s| s.number == Number::Sequence) {
        for dim in sampler.dims.clone() {
            let words = |p: &Parameter| match p.accepts {
                Accepts::OneOf(words) => words.iter().map(|word| format!("{}={word}", p.name)).collect(),
                _ => vec![format!("{}={}", p.name, p.default)],
            };
            for given in sampler.all_parameters().flat_map(words) {
                let whole = points(sampler.name, &[&given], 300, dim, 3, 1);
                for n in [1, 2, 40, 255, 256, 257] {
                    let part = points(sampler.name, &[&given], n, dim, 3, 1);
                    assert_eq!(part, whole[..n as usize * dim], "{} {given} {n}", sampler.name);
                }
            }
        }
    }
}

/// `shift=random` is a translate of `shift=none`, and `auto` is one of them.
#[test]
fn a_shift_is_a_translate() {
    for sampler in registry() {
        let (n, dim) = some(sampler);
        let with = |shift: &str| points(sampler.name, &[shift], n, dim, 5, 2);
        let (still, moved, auto) = (with("shift=none"), with("shift=random"), with("shift=auto"));
        assert_eq!(still.len(), moved.len());
        let shift: Vec<f64> = (0..dim).map(|k| (moved[k] - still[k]).rem_euclid(1.0)).collect();
        for (a, b) in still.chunks_exact(dim).zip(moved.chunks_exact(dim)) {
            for k in 0..dim {
                let off = (b[k] - a[k] - shift[k]).rem_euclid(1.0);
                assert!(off.min(1.0 - off) < 1e-14, "{}: {off}", sampler.name);
            }
        }
        let same = still == points(sampler.name, &["shift=none"], n, dim, 5, 3);
        let lattice = ["grid", "hexagonal", "fcc", "bcc"].contains(&sampler.name);
        assert_eq!(auto, if same && !lattice { moved } else { still }, "{}", sampler.name);
    }
}

#[test]
fn sizes_that_do_not_fit_are_refused_with_the_nearest_that_do() {
    let refused = |name: &str, n, dim| error(Process::new(name, n, 1, dim, 1, &[]));
    assert_eq!(refused("grid", 1000, 2), "points 1000: grid in 2D needs n = k^2; the nearest are 961 and 1024");
    assert_eq!(refused("jittered", 999, 3), "points 999: jittered in 3D needs n = k^3; the nearest are 729 and 1000");
    assert_eq!(
        refused("jittered", 99_999_999, 2),
        "points 99999999: jittered in 2D needs n = k^2; the nearest are 99980001 and 100000000"
    );
    assert_eq!(refused("random", 0, 2), "points 0: expected 1 to 100000000 points");
    assert_eq!(refused("random", 100_000_001, 2), "points 100000001: expected 1 to 100000000 points");
    assert_eq!(refused("hammersley", 10, 4), "dim 4: hammersley: expected 1, 2 or 3");
    assert_eq!(refused("thomas", 10, 0), "dim 0: thomas: expected 1, 2 or 3");
    assert_eq!(refused("halton", 10, 17), "dim 17: halton: expected 1 to 16");
    assert_eq!(refused("lattice", 10, 1), "dim 1: lattice: expected 2 or 3");
    assert_eq!(refused("fcc", 32, 2), "dim 2: fcc is there in 3 dimensions only");
    assert_eq!(
        refused("hexagonal", 1024, 2),
        "points 1024: hexagonal in 2D needs n = a b with b even and d_min at least 0.97 of the closest packing; the nearest are 1020 and 1044"
    );
    assert_eq!(
        refused("fibonacci", 1000, 2),
        "points 1000: fibonacci in 2D needs n = a Fibonacci number from 2 on; the nearest are 987 and 1597"
    );
    for k in 1..=464u64 {
        assert!(Process::new("grid", k * k * k, 1, 3, 1, &[]).is_ok(), "{k}^3");
    }
}

/// Few points are made or refused, in every dimension, and never run on.
#[test]
fn few_points_work_or_err() {
    for sampler in registry() {
        for dim in sampler.dims.clone() {
            for n in 0..=8 {
                let Ok(process) = Process::new(sampler.name, n, 1, dim, 1, &[]) else { continue };
                let set = process.coordinates(0, &Control::default());
                assert!(set.is_err() || !sampler.fixed_n() || set.is_ok_and(|set| set.len() == n as usize * dim));
                for r in [0.0, 0.2, 0.5] {
                    assert!(process.pair_correlation(r).is_none_or(f64::is_finite), "{} {n} {dim}", sampler.name);
                }
                for m in [[1, 0, 0], [3, -2, 5]] {
                    assert!(process.power(m).is_none_or(f64::is_finite), "{} {n} {dim}", sampler.name);
                }
            }
        }
    }
}

/// The rule of every sampler names numbers that it makes, and none nearer can be.
#[test]
fn the_nearest_numbers_can_be_had() {
    for sampler in registry() {
        for dim in sampler.dims.clone() {
            for n in [0, 1, 2, 3, 26, 27, 28, 1000, 65_000, 99_999_999, MAX_POINTS, u64::MAX] {
                let ends = sampler.nearest(n, dim);
                let fits = |n: u64| sampler.size.below(n, dim) == Some(n) && sampler.size.above(n, dim) == Some(n);
                for end in ends.into_iter().flatten() {
                    assert!(fits(end), "{} {n} {end}", sampler.name);
                }
                let (low, high) = (ends[0].unwrap_or(0), ends[1].unwrap_or(MAX_POINTS + 1));
                assert!(low <= n && n <= high || n > MAX_POINTS, "{} {n}: {low} {high}", sampler.name);
                let between = (low + 1).max(n.saturating_sub(40))..high.min(n.saturating_add(40));
                assert!(between.filter(|k| *k != n || low != n).all(|k| !fits(k)), "{} {n}", sampler.name);
            }
        }
    }
}

#[test]
fn wrong_parameters_are_refused_by_name() {
    let refused = |name: &str, given: &[&str]| error(ParameterValues::parse(find(name).unwrap(), given));
    let disk = "poisson-disk";
    let shift = "shift (auto, none or random, default auto)";
    assert_eq!(
        refused(disk, &["raduis=0.5"]),
        format!(
            "params raduis=0.5: poisson-disk has no parameter raduis (did you mean radius?); expected radius (a number above 0 \
             and at most 1, default 0.7), {shift}"
        )
    );
    for bad in ["1.5", "0", "-1", "NaN", "inf", "wide", ""] {
        assert_eq!(
            refused(disk, &[&format!("radius={bad}")]),
            format!("params radius={bad}: radius of poisson-disk is a number above 0 and at most 1 (default 0.7)")
        );
    }
    assert_eq!(refused(disk, &["radius"]), "params radius: expected key=value");
    assert_eq!(refused(disk, &["radius=0.5", "radius=0.6"]), "params radius=0.6: radius is given twice");
    assert_eq!(refused("random", &["x=1"]), format!("params x=1: random has no parameter x; expected {shift}"));
    assert_eq!(
        refused("grid", &["shift=left"]),
        "params shift=left: shift of grid is auto, none or random (default auto)"
    );
    assert_eq!(
        refused("lattice", &["a=0"]),
        "params a=0: a of lattice is widest or a whole number from 1 to 99999999 (default widest)"
    );
    assert_eq!(
        error(Process::new("lattice", 100, 1, 2, 1, &["a=100"])),
        "params a=100: a of lattice is a whole number from 1 to n - 1 = 99"
    );
    let all: Vec<&str> = registry().iter().map(|s| s.name).collect();
    let all = all.join(", ");
    assert_eq!(
        error(find("Jitered").map(|s| s.name)),
        format!("sampler Jitered: no such sampler (did you mean jittered?); expected one of {all}")
    );
    assert_eq!(error(find("zzz").map(|s| s.name)), format!("sampler zzz: no such sampler; expected one of {all}"));
}
