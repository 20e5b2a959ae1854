//! Discrepancies against an independent program, nets against their definition, the covering radius against every circumcentre.

use crate::common::*;
use pairwave::accumulate::{DISCREPANCIES, DiscrepancySums, LevelCounts};
use pairwave::compute::Compute;
use pairwave::compute::cpu::{Cpu, SimdLevel};
use pairwave::compute::reference::Reference;
use pairwave::control::Control;
use pairwave::plan::DiscrepancyPlan;
use pairwave::points::{Domain, Ensemble};
use pairwave::samplers::Process;

fn sums(compute: &dyn Compute, ensemble: &Ensemble) -> DiscrepancySums {
    let plan = DiscrepancyPlan::new(ensemble.domain(), ensemble.shape()).unwrap();
    wait(compute.discrepancies(&plan, ensemble, &Control::default())).unwrap()
}

/// Every way there is.
fn ways() -> Vec<Box<dyn Compute>> {
    let level = |level| Box::new(Cpu::with_level(Some(2), level).unwrap()) as Box<dyn Compute>;
    let levels = [SimdLevel::Portable, SimdLevel::Avx2, SimdLevel::Avx512].map(level);
    levels.into_iter().chain([Box::new(Reference) as Box<dyn Compute>]).collect()
}

/// frac((i + 1) sqrt(p)), p the first primes.
fn irrational(n: usize, dim: usize) -> Vec<f64> {
    let x = |i: usize, p: f64| ((i as f64 + 1.0) * p.sqrt()) % 1.0;
    (0..n).flat_map(|i| [2.0, 3.0, 5.0][..dim].iter().map(move |&p| x(i, p))).collect()
}

fn set(coordinates: Vec<f64>, domain: &Domain) -> Ensemble {
    Ensemble::from_raw(&[raw(domain.dim(), coordinates)], domain, false, 0).unwrap()
}

fn drawn(name: &str, n: u64, dim: usize, k: u64, params: &[&str]) -> Ensemble {
    Process::new(name, n, k, dim, 7, params).unwrap().ensemble(0..k, &Control::default()).unwrap()
}

/// The values of scipy 1.17.1, `scipy.stats.qmc.discrepancy` with methods L2-star (a root), CD, WD and MD (squares), and
/// diaphony by numpy.
#[test]
fn equals_an_independent_program() {
    let known: [(usize, usize, [f64; 5]); 4] = [
        (
            7,
            1,
            [
                0.052165051071996135,
                0.0027211925533443537,
                0.005050547118371496,
                0.0038858698358579247,
                0.03030328271022991,
            ],
        ),
        (1, 2, [0.275381427661758, 0.24773682992947843, 0.4722222222222223, 0.48655950990514585, 0.9999999999999996]),
        (
            32,
            2,
            [
                0.02207331902431909,
                0.0012028927797957945,
                0.001618439301160901,
                0.0017860038082742058,
                0.00959948890447173,
            ],
        ),
        (
            100,
            3,
            [
                0.014541386998380876,
                0.0006168737857252804,
                0.0009678041565397422,
                0.001101718916662442,
                0.004289148332047601,
            ],
        ),
    ];
    for (n, dim, [star, rest @ ..]) in known {
        for domain in [Domain::unit_torus(dim), Domain::window(&vec![(0.0, 1.0); dim]).unwrap()] {
            for way in ways() {
                let found = sums(way.as_ref(), &set(irrational(n, dim), &domain)).realizations[0].squares;
                assert!((found[0].sqrt() - star).abs() < 1e-12, "{n} {dim}: star {} is not {star}", found[0].sqrt());
                for ((name, found), expected) in DISCREPANCIES[1..].iter().zip(&found[1..]).zip(rest) {
                    let by = way.computed_by().device();
                    assert!((found - expected).abs() < 1e-12, "{n} {dim}, {by}: {name} {found} is not {expected}");
                }
            }
        }
    }
}

/// More points than lanes, and sets so even that the textbook's sums cancel: the CPU path is no worse than them.
#[test]
fn ways_agree_on_every_process_and_domain() {
    let cases: &[(&str, u64, usize, &[&str])] = &[
        ("random", 77, 1, &[]),
        ("random", 130, 2, &[]),
        ("sobol", 256, 2, &["scramble=none"]),
        ("sobol", 128, 3, &["scramble=owen"]),
        ("grid", 64, 2, &[]),
        ("halton", 100, 3, &[]),
        ("thomas", 60, 2, &[]),
    ];
    for &(name, n, dim, params) in cases {
        let ensemble = drawn(name, n, dim, 3, params);
        let sides = [2.0, 0.7, 1.3];
        let window = Domain::window(&[(-3.0, -1.0), (5.0, 5.7), (0.0, 1.3)][..dim]).unwrap();
        let all: Vec<Vec<f64>> = (0..3)
            .map(|k| {
                let axes = ensemble.coordinates(k).unwrap();
                (0..axes[0].len())
                    .flat_map(|i| (0..dim).map(move |a| (a, i)))
                    .map(|(a, i)| window.origin()[a] + axes[a][i] * window.sides()[a])
                    .collect()
            })
            .collect();
        let sets: Vec<_> = all.into_iter().map(|x| raw(dim, x)).collect();
        let windowed = Ensemble::from_raw(&sets, &window, false, 0).unwrap();
        let stretched = Domain::torus(&sides[..dim]).unwrap();
        for ensemble in [ensemble.clone(), windowed, ensemble.stretched(&stretched)] {
            let reference = sums(&Reference, &ensemble);
            let mut levels = Vec::new();
            for way in &ways()[..3] {
                let found = sums(way.as_ref(), &ensemble);
                assert_eq!(found.levels, reference.levels, "{name}");
                for (a, b) in found.realizations.iter().zip(&reference.realizations) {
                    assert_eq!((a.index, a.n, a.strength), (b.index, b.n, b.strength), "{name}");
                    let (x, y) = (a.minimum.unwrap(), b.minimum.unwrap());
                    assert!((x - y).abs() <= 1e-14 * y.max(1.0), "{name}: minimum {x} is not {y}");
                    for (x, y) in a.squares.iter().zip(b.squares) {
                        assert!((x - y).abs() <= 1e-14, "{name}: {x} is not {y}");
                    }
                }
                levels.push(found);
            }
            assert!(levels.windows(2).all(|w| w[0] == w[1]), "{name}: every instruction set gives the same bits");
        }
    }
}

/// A (t, m, d)-net by its name has that t; one point moved by a cell has not.
#[test]
fn nets_have_their_quality() {
    let t = |ensemble: &Ensemble| {
        sums(&Cpu::new(None).unwrap(), ensemble).realizations.iter().map(|r| r.t()).collect::<Vec<_>>()
    };
    for params in [&["scramble=none", "shift=none"][..], &["scramble=owen"]] {
        for n in [1, 2, 16, 256] {
            assert_eq!(t(&drawn("sobol", n, 1, 1, params)), [Some(0)]);
            assert_eq!(t(&drawn("sobol", n, 2, 2, params)), [Some(0); 2]);
            // The first three axes of Joe and Kuo are a (0, 3)-sequence in no base 2: t is 1 from some n on.
            assert!(t(&drawn("sobol", n, 3, 1, params))[0] <= Some(1));
        }
    }
    assert_eq!(t(&drawn("pmj02", 64, 2, 3, &[])), [Some(0); 3]);
    assert_eq!(t(&drawn("random", 100, 2, 1, &[])), [None], "no power of 2");
    // Jittered points have one point per cell of a grid of 8 x 8, but not per column of 64.
    let jittered = drawn("jittered", 64, 2, 1, &[]);
    let found = sums(&Reference, &jittered);
    assert_eq!(found.levels[6], LevelCounts { shapes: 7, equidistributed: 1 });
    // A planted fault: one point of a net is moved to another column.
    let axes = drawn("sobol", 64, 2, 1, &["scramble=owen"]);
    let axes = axes.coordinates(0).unwrap();
    let mut moved: Vec<f64> = (0..64).flat_map(|i| [axes[0][i], axes[1][i]]).collect();
    moved[10] = (moved[10] + 1.0 / 64.0) % 1.0;
    assert!(t(&set(moved, &Domain::unit_torus(2)))[0] > Some(0));
}

#[test]
fn covering_radius_of_lattices() {
    let radius = |ensemble: &Ensemble| sums(&Cpu::new(None).unwrap(), ensemble).realizations[0].covering.unwrap();
    let mut known: Vec<(Ensemble, f64)> = Vec::new();
    for (n, dim, k) in [(10, 1, 10.0), (1, 2, 1.0), (64, 2, 8.0), (27, 3, 3.0)] {
        known.push((drawn("grid", n, dim, 1, &[]), (dim as f64).sqrt() / 2.0 / k));
    }
    // Of points in the middle of the box the corners are farthest; on a torus of unequal sides likewise.
    known.push((set(vec![0.5, 0.25], &Domain::window(&[(0.0, 1.0), (0.0, 0.5)]).unwrap()), 0.3125f64.sqrt()));
    known.push((set(vec![0.1, 0.3], &Domain::torus(&[1.0, 0.5]).unwrap()), 0.3125f64.sqrt()));
    for (ensemble, expected) in known {
        let [found, bound] = radius(&ensemble);
        assert!((found / expected - 1.0).abs() < 1e-8, "{found} is not {expected}");
        assert!(found <= expected * (1.0 + 1e-12) && bound >= expected);
    }
}

/// The farthest place of a torus is the centre of a circle through three points that holds none.
#[test]
fn covering_radius_is_that_of_the_widest_empty_circle() {
    for seed in 0..5 {
        let mut rng = Rng(seed);
        let points: Vec<[f64; 2]> = (0..9).map(|_| [rng.unit(), rng.unit()]).collect();
        let images: Vec<[f64; 2]> = (0..25)
            .flat_map(|c| points.iter().map(move |p| [p[0] + f64::from(c % 5) - 2.0, p[1] + f64::from(c / 5) - 2.0]))
            .collect();
        let mut widest = 0f64;
        for a in &points {
            let near: Vec<[f64; 2]> = images.iter().map(|p| [p[0] - a[0], p[1] - a[1]]).collect();
            for (j, b) in near.iter().enumerate() {
                for c in &near[j + 1..] {
                    let twice = 2.0 * (b[0] * c[1] - b[1] * c[0]);
                    if twice.abs() < 1e-9 {
                        continue;
                    }
                    let [bb, cc] = [b, c].map(|p| p[0] * p[0] + p[1] * p[1]);
                    let center = [(c[1] * bb - b[1] * cc) / twice, (b[0] * cc - c[0] * bb) / twice];
                    let square = center[0] * center[0] + center[1] * center[1];
                    let empty = |p: &[f64; 2]| (p[0] - center[0]).powi(2) + (p[1] - center[1]).powi(2) > square - 1e-9;
                    if square.sqrt() > widest && square < 1.0 && near.iter().all(empty) {
                        widest = square.sqrt();
                    }
                }
            }
        }
        let ensemble = set(points.concat(), &Domain::unit_torus(2));
        let [found, bound] = sums(&Cpu::new(None).unwrap(), &ensemble).realizations[0].covering.unwrap();
        assert!((found / widest - 1.0).abs() < 1e-8 && bound >= widest * (1.0 - 1e-12), "{found} is not {widest}");
    }
}

/// Independent points expect a squared diaphony of 1/n, and star discrepancies of (2^-d - 3^-d)/n.
#[test]
fn means_of_independent_points() {
    for dim in 1..=3 {
        let (n, k) = (20, if dim == 3 { 200 } else { 1000 });
        let found = sums(&Cpu::new(None).unwrap(), &drawn("random", n, dim, k, &[]));
        let d = dim as i32;
        let expected = [
            (0, 2f64.powi(-d) - 3f64.powi(-d)),
            (1, 1.25f64.powi(d) - (13.0 / 12.0f64).powi(d)),
            (2, 1.5f64.powi(d) - (4.0 / 3.0f64).powi(d)),
            (4, 1.0),
        ];
        for (kind, expected) in expected {
            let values: Vec<f64> = found.realizations.iter().map(|r| r.squares[kind] * n as f64).collect();
            let mean = values.iter().sum::<f64>() / k as f64;
            let se = (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (k * k) as f64).sqrt();
            assert!(
                (mean - expected).abs() < 4.0 * se,
                "{dim}D, {}: {mean} +- {se} is not {expected}",
                DISCREPANCIES[kind]
            );
        }
    }
}
