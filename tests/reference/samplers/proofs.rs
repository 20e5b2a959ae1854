//! Every closed form against a direct simulation, by Hotelling's T^2 over rings, axes and bins, and by the largest single
//! mode: false alarms 1e-4 each. And every one against planted faults, which must be caught.

use std::collections::BTreeMap;

use pairwave::control::Control;
use pairwave::estimate::Hotelling;
use pairwave::samplers::Process;

use super::{ball, pairs, power};

/// How often a test fails that should hold.
const FALSE_ALARM: f64 = 1e-4;

/// What is claimed of a process, and drawn from it.
struct Case {
    name: &'static str,
    given: &'static [&'static str],
    n: u64,
    dim: usize,
    realizations: u64,
}

impl Case {
    fn process(&self) -> Process {
        let Self { name, given, n, dim, realizations } = *self;
        Process::new(name, n, realizations, dim, 11, given).unwrap()
    }

    fn sets(&self) -> Vec<Vec<f64>> {
        let process = self.process();
        (0..self.realizations).map(|k| process.coordinates(k, &Control::default()).unwrap()).collect()
    }

    /// As it is, with another n or with other parameters.
    fn wrong(&self, n: u64, given: &'static [&'static str]) -> Self {
        Self { n, given, ..*self }
    }
}

/// Modes of a half space up to |m_j| = `reach`.
fn half_space(dim: usize, reach: i32) -> Vec<[i32; 3]> {
    let axis = |used: bool| if used { -reach..=reach } else { 0..=0 };
    let all = axis(true).flat_map(|x| axis(dim > 1).flat_map(move |y| axis(dim > 2).map(move |z| [x, y, z])));
    all.filter(|m| m.iter().find(|m| **m != 0).is_some_and(|m| *m > 0)).collect()
}

/// Groups of modes: rings of |m|, at most 11 of them, or the two ends of each axis.
fn groups(dim: usize, reach: i32) -> Vec<Vec<[i32; 3]>> {
    let mut rings: BTreeMap<i32, Vec<[i32; 3]>> = BTreeMap::new();
    let width = (f64::from(reach) * (dim as f64).sqrt() / 11.0).max(1.0);
    let mut axes = vec![Vec::new(); dim];
    for m in half_space(dim, reach) {
        let length = f64::from(m.iter().map(|m| m * m).sum::<i32>()).sqrt();
        rings.entry((length / width) as i32).or_default().push(m);
        let along: Vec<usize> = (0..dim).filter(|&k| m[k] != 0).collect();
        if let [axis] = along[..] {
            axes[axis].push(m);
        }
    }
    rings.into_values().filter(|ring| !ring.is_empty()).chain(axes).collect()
}

/// Probabilities of what was drawn under what is claimed: of rings and axes together, and of the worst mode.
fn power_test(sets: &[Vec<f64>], claimed: &Process, reach: i32) -> [f64; 2] {
    let dim = claimed.dim;
    let groups: Vec<_> = groups(dim, reach)
        .into_iter()
        .map(|group| group.into_iter().filter_map(|m| Some((m, claimed.power(m)?))).collect::<Vec<_>>())
        .filter(|group| !group.is_empty())
        .collect();
    assert!(!groups.is_empty(), "{}: no closed form", claimed.name);
    // Every mode once.
    let mut modes: BTreeMap<[i32; 3], f64> = groups.iter().flatten().copied().collect();
    let order: Vec<[i32; 3]> = modes.keys().copied().collect();
    let deviations: Vec<Vec<f64>> = sets
        .iter()
        .map(|x| order.iter().map(|&m| power(x, dim, m) - modes[&m] * (x.len() / dim) as f64).collect())
        .collect();
    let at = |m: [i32; 3]| order.binary_search(&m).unwrap();
    let rows = |groups: &[Vec<([i32; 3], f64)>]| -> Vec<Vec<f64>> {
        let sum = |y: &[f64], group: &[([i32; 3], f64)]| group.iter().map(|(m, _)| y[at(*m)]).sum::<f64>();
        deviations.iter().map(|y| groups.iter().map(|group| sum(y, group)).collect()).collect()
    };
    let (rings, axes) = groups.split_at(groups.len() - groups.len().min(dim));
    let mut together = 1.0f64;
    for some in [rings, axes] {
        // What never varies is right to rounding or wrong.
        let rows = rows(some);
        let exact = |r: usize| rows.iter().all(|row| (row[r] - rows[0][r]).abs() < 1e-6);
        let free: Vec<usize> = (0..some.len()).filter(|&r| !exact(r)).collect();
        for r in (0..some.len()).filter(|r| exact(*r)) {
            if rows[0][r].abs() > 1e-6 {
                return [0.0; 2];
            }
        }
        let varied: Vec<Vec<f64>> = rows.iter().map(|row| free.iter().map(|&r| row[r]).collect()).collect();
        if let Some(test) = Hotelling::new(&varied) {
            together = together.min(2.0 * test.p_value);
        }
    }
    let mut worst = 1.0f64;
    modes.retain(|m, _| deviations.iter().any(|y| (y[at(*m)] - deviations[0][at(*m)]).abs() > 1e-6));
    for m in modes.keys() {
        let one: Vec<Vec<f64>> = deviations.iter().map(|y| vec![y[at(*m)]]).collect();
        worst = worst.min(Hotelling::new(&one).map_or(1.0, |t| t.p_value) * modes.len() as f64);
    }
    [together, worst]
}

/// The probability of the pairs in ten bins up to 0.45, under what is claimed.
fn pair_test(sets: &[Vec<f64>], claimed: &Process) -> Option<f64> {
    // That of a log-Gaussian Cox process is what it tends to as its cells shrink.
    if claimed.name == "lgcp" {
        return None;
    }
    claimed.pair_correlation(0.2)?;
    let dim = claimed.dim;
    let edges: Vec<f64> = (0..=9).map(|b| 0.05 * f64::from(b)).collect();
    let expected: Vec<f64> = edges
        .windows(2)
        .map(|bin| {
            // The mean over the shell, by the midpoint rule in volume.
            let [inner, outer] = [ball(dim, bin[0]), ball(dim, bin[1])];
            let at = |i: i32| inner + (outer - inner) * (f64::from(i) + 0.5) / 400.0;
            let radius = |volume: f64| (volume / ball(dim, 1.0)).powf(1.0 / dim as f64);
            let sum: f64 = (0..400).map(|i| claimed.pair_correlation(radius(at(i))).unwrap()).sum();
            sum / 400.0 * (outer - inner)
        })
        .collect();
    let deviation = |x: &Vec<f64>| -> Vec<f64> {
        let n = (x.len() / dim) as f64;
        let counts = edges.windows(2).map(|bin| pairs(x, dim, bin[0], bin[1]));
        counts.zip(&expected).map(|(count, expected)| count - expected * n * (n - 1.0)).collect()
    };
    let rows: Vec<Vec<f64>> = sets.iter().map(deviation).collect();
    // Bins that are always empty, as they should be.
    let free: Vec<usize> = (0..expected.len()).filter(|&b| rows.iter().any(|row| row[b] != rows[0][b])).collect();
    let varied: Vec<Vec<f64>> = rows.iter().map(|row| free.iter().map(|&b| row[b]).collect()).collect();
    Hotelling::new(&varied).map(|test| test.p_value)
}

/// The probability of the variance of the number of points.
fn count_test(sets: &[Vec<f64>], claimed: &Process) -> Option<f64> {
    let variance = claimed.sampler.count_variance()?;
    let n = claimed.n as f64;
    let of = |x: &Vec<f64>| {
        let number = (x.len() / claimed.dim) as f64;
        vec![number - n, (number - n).powi(2) - variance]
    };
    if variance == 0.0 {
        return Some(if sets.iter().all(|x| of(x)[0] == 0.0) { 1.0 } else { 0.0 });
    }
    Hotelling::new(&sets.iter().map(of).collect::<Vec<_>>()).map(|test| test.p_value)
}

/// The smallest of all probabilities.
fn smallest(sets: &[Vec<f64>], claimed: &Process, reach: i32) -> f64 {
    let [together, worst] = power_test(sets, claimed, reach);
    let others = [pair_test(sets, claimed), count_test(sets, claimed)];
    others.into_iter().flatten().fold(together.min(worst), f64::min)
}

const fn case(name: &'static str, given: &'static [&'static str], n: u64, dim: usize, realizations: u64) -> Case {
    Case { name, given, n, dim, realizations }
}

/// What is proven, how far the modes reach, and claims that are wrong: another n and other parameters.
type Proof = (Case, i32, &'static [(u64, &'static [&'static str])]);

const PROOFS: &[Proof] = &[
    (case("random", &[], 40, 1, 400), 20, &[]),
    (case("random", &[], 40, 2, 400), 8, &[]),
    (case("random", &[], 40, 3, 400), 3, &[]),
    (case("poisson", &[], 40, 2, 600), 8, &[(45, &[])]),
    (case("cell", &[], 36, 2, 600), 8, &[(49, &[])]),
    (case("cell", &[], 27, 3, 600), 3, &[(64, &[])]),
    (
        case("perturbed-grid", &[], 36, 2, 400),
        8,
        &[(49, &[]), (36, &["width=0.275"]), (36, &["kernel=box", "width=0.866"])],
    ),
    (case("perturbed-grid", &["kernel=box", "width=0.7"], 36, 2, 400), 8, &[(36, &["kernel=box", "width=0.77"])]),
    (case("perturbed-grid", &["width=0.4"], 27, 3, 800), 4, &[(27, &["width=0.44"])]),
    (case("perturbed-grid", &["width=0.5"], 9, 1, 800), 12, &[(9, &["width=0.55"]), (10, &["width=0.5"])]),
    (case("jittered", &[], 12, 1, 400), 24, &[(13, &[])]),
    (case("jittered", &[], 36, 2, 400), 9, &[(49, &[]), (25, &[])]),
    (case("jittered", &[], 27, 3, 400), 4, &[(64, &[])]),
    (case("cmj", &[], 25, 2, 400), 10, &[(36, &[]), (25, &["permutations=independent"])]),
    (case("cmj", &["permutations=independent"], 25, 2, 400), 10, &[(25, &["permutations=shared"])]),
    (case("lhs", &[], 12, 2, 400), 12, &[(13, &[]), (12, &["place=centre"])]),
    (case("lhs", &["place=centre"], 12, 2, 400), 12, &[(13, &["place=centre"]), (12, &[])]),
    (case("lhs", &[], 8, 3, 400), 5, &[(9, &[])]),
    (case("halton", &["scramble=owen"], 32, 2, 400), 20, &[]),
    (case("halton", &["scramble=owen"], 27, 2, 400), 20, &[]),
    (case("halton", &["scramble=owen"], 25, 3, 400), 9, &[]),
    (case("sobol", &[], 16, 2, 400), 12, &[(32, &[]), (8, &[])]),
    (case("sobol", &[], 32, 2, 400), 12, &[(64, &[])]),
    (case("sobol", &[], 256, 2, 400), 12, &[(128, &[])]),
    (case("pmj02", &[], 16, 2, 400), 12, &[(32, &[]), (8, &[])]),
    (case("pmj02", &[], 32, 2, 400), 12, &[(64, &[])]),
    (case("sobol", &[], 16, 3, 400), 5, &[(32, &[]), (8, &[])]),
    (case("thomas", &[], 50, 2, 600), 6, &[(60, &[]), (50, &["mu=11"]), (50, &["sigma=0.55"])]),
    (case("thomas", &["mu=5"], 40, 1, 600), 12, &[(40, &["mu=5.5"])]),
    (case("matern-i", &[], 40, 1, 4000), 20, &[(44, &[]), (40, &["radius=0.165"])]),
    (case("matern-i", &[], 40, 2, 600), 9, &[(46, &[]), (40, &["radius=0.18"])]),
    (case("matern-i", &["radius=0.3"], 40, 3, 600), 5, &[(40, &["radius=0.33"])]),
    (case("matern-ii", &[], 40, 1, 600), 20, &[(44, &[]), (40, &["radius=0.44"])]),
    (case("matern-ii", &[], 40, 2, 600), 9, &[(46, &[]), (40, &["radius=0.44"])]),
    (case("matern-ii", &[], 40, 3, 600), 5, &[(40, &["radius=0.46"])]),
    (
        case("matern-cluster", &["mu=4", "radius=0.8"], 40, 1, 1500),
        12,
        &[(40, &["mu=4", "radius=0.9"]), (40, &["mu=5", "radius=0.8"])],
    ),
    (case("matern-cluster", &[], 50, 2, 800), 6, &[(60, &[]), (50, &["mu=11.5"]), (50, &["radius=1.1"])]),
    (case("matern-cluster", &["mu=4", "radius=0.6"], 40, 3, 800), 4, &[(40, &["mu=4", "radius=0.66"])]),
    (case("cauchy-cluster", &["mu=5"], 40, 1, 1500), 12, &[(40, &["mu=5.8"]), (40, &["mu=5", "scale=0.29"])]),
    (case("cauchy-cluster", &[], 50, 2, 1500), 6, &[(50, &["mu=11.5"]), (50, &["scale=0.29"])]),
    (case("cauchy-cluster", &["mu=5"], 40, 3, 1500), 4, &[(40, &["mu=5", "scale=0.29"])]),
    (case("lgcp", &[], 40, 1, 2000), 10, &[(40, &["variance=1.2"]), (40, &["scale=2.5"])]),
    (case("lgcp", &[], 40, 2, 2000), 6, &[(40, &["variance=1.15"]), (40, &["scale=2.4"])]),
    (case("lgcp", &["covariance=gaussian", "scale=1"], 40, 2, 2000), 6, &[(40, &["covariance=gaussian", "scale=1.1"])]),
    (case("gaussian-dpp", &[], 30, 1, 600), 20, &[(33, &[]), (30, &["alpha=0.85"])]),
    (case("gaussian-dpp", &[], 30, 2, 600), 9, &[(34, &[]), (30, &["alpha=0.87"])]),
    (case("gaussian-dpp", &["alpha=0.8"], 30, 3, 600), 5, &[(30, &["alpha=0.9"])]),
    (case("fourier-dpp", &[], 15, 1, 400), 20, &[(17, &[])]),
    (case("fourier-dpp", &[], 25, 2, 400), 8, &[(49, &[])]),
    (case("fourier-dpp", &[], 27, 3, 400), 4, &[(125, &[])]),
    (case("ginibre", &[], 20, 2, 400), 9, &[(22, &[]), (18, &[])]),
    (case("thomas", &["mu=4", "sigma=0.3"], 40, 3, 600), 4, &[(40, &["mu=4", "sigma=0.33"])]),
];

/// What does not hold, or would hold of something else.
fn failures((case, reach, wrong): &Proof) -> Vec<String> {
    let sets = case.sets();
    let what = format!("{} {:?} n = {} {}D", case.name, case.given, case.n, case.dim);
    let p = smallest(&sets, &case.process(), *reach);
    let mut failures = Vec::new();
    if p <= FALSE_ALARM {
        failures.push(format!("{what}: p = {p:.2e}"));
    }
    for &(n, given) in *wrong {
        let p = smallest(&sets, &case.wrong(n, given).process(), *reach);
        if p >= FALSE_ALARM {
            failures.push(format!("{what} passes for n = {n} {given:?}: p = {p:.2e}"));
        }
    }
    failures
}

#[test]
fn closed_forms_hold() {
    let next = std::sync::atomic::AtomicUsize::new(0);
    let work = || {
        let mut found = Vec::new();
        while let Some(proof) = PROOFS.get(next.fetch_add(1, std::sync::atomic::Ordering::Relaxed)) {
            found.extend(failures(proof));
        }
        found
    };
    let found: Vec<String> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..2).map(|_| scope.spawn(work)).collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Lattices have the P they claim at every m, to rounding.
#[test]
fn lattices_have_their_peaks() {
    let cases: &[(&str, &[&str], u64, usize)] = &[
        ("grid", &[], 49, 2),
        ("hexagonal", &[], 30, 2),
        ("hexagonal", &[], 120, 2),
        ("fcc", &[], 32, 3),
        ("fcc", &[], 108, 3),
        ("bcc", &[], 54, 3),
        ("lattice", &[], 101, 2),
        ("lattice", &["a=12"], 144, 2),
        ("lattice", &[], 60, 3),
        ("fibonacci", &[], 55, 2),
        ("kronecker", &[], 40, 1),
        ("kronecker", &[], 40, 2),
        ("kronecker", &[], 40, 3),
        ("hammersley", &[], 32, 2),
        ("halton", &[], 27, 2),
        ("sobol", &["scramble=none"], 32, 2),
    ];
    for &(name, given, n, dim) in cases {
        let process = Process::new(name, n, 1, dim, 1, given).unwrap();
        let x = process.coordinates(0, &Control::default()).unwrap();
        for m in half_space(dim, if dim == 3 { 8 } else { 40 }) {
            if let Some(expected) = process.power(m) {
                let found = power(&x, dim, m) / n as f64;
                assert!((found - expected).abs() < 1e-9 * n as f64, "{name} n = {n} {m:?}: {found} against {expected}");
            }
        }
    }
}
