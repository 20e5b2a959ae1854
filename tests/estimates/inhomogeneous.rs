//! g, K and P of points that are weighted by the inverse of their intensity.

use std::f64::consts::{PI, TAU};

use crate::common::*;
use pairwave::analysis::Measurement;
use pairwave::compute::{Device, cpu::Cpu};
use pairwave::control::Control;
use pairwave::estimate::Analysis;
use pairwave::measure;
use pairwave::points::Domain;
use pairwave::source::Points;

fn l_shape() -> Domain {
    let ring = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    Domain::polygon(vec![vec![ring]]).unwrap()
}

fn in_l(x: f64, y: f64) -> bool {
    x < 1.0 || y < 1.0
}

/// What a line makes of sets of points.
fn found(domain: &Domain, sets: &[Vec<f64>], line: &str) -> Analysis {
    let request = request(&format!("{line} --device cpu"));
    let points = Points::new(domain.clone(), sets).unwrap();
    measure(points.with_intensity(&request.input, &Control::default()).unwrap(), &request).unwrap()
}

/// The intensity of the tests, in fractions of the box, from 0.2 to 1; and as it is typed.
fn lambda(x: f64, y: f64) -> f64 {
    0.6 + 0.4 * (TAU * x).sin() * (PI * y).cos()
}
const LAMBDA: &str = "--inhomogeneous formula:3*(0.6+0.4*sin(2*pi*x)*cos(pi*y))";

/// Independent points of that intensity: uniform ones, of which a part is removed.
fn thinned(domain: &Domain, sets: u64, parents: usize) -> Vec<Vec<f64>> {
    let mut rng = Rng(77);
    let set = |_| {
        let mut points = Vec::new();
        for _ in 0..parents {
            let [u, v] = [rng.unit(), rng.unit()];
            let [x, y] = [0, 1].map(|a| domain.origin()[a] + [u, v][a] * domain.sides()[a]);
            let inside = domain.as_polygon().is_none() || in_l(x, y);
            if rng.unit() < lambda(u, v) && inside {
                points.extend([x, y]);
            }
        }
        points
    };
    (0..sets).map(set).collect()
}

/// Three points in a window, their pairs over what they are compared with; and how spatstat's numbers follow.
#[test]
fn three_points_by_hand() {
    // Distances 1, 2 and 3; weights 1, 1/2 and 1/4.
    let file = "x,y,l\n1,1,1\n1,2,2\n1,4,4\n";
    for (normalization, over) in [("pairs", 1.75), ("intensity", 1.75 * 1.75)] {
        let line = format!(
            "--window 0,10,0,10 --intensity-column l --stats pcf,k-function --correction none --device cpu --r-max 4.4 --bins 4 --normalization {normalization}"
        );
        let request = request(&line);
        let a = measure(Points::from_bytes("a.csv", file.as_bytes(), &request.input).unwrap(), &request).unwrap();
        let k = a.k_function().unwrap();
        // Of each pair twice: 1/2 at 1, 1/8 at 2, 1/4 at 3; all closer than 1.1, 2.2, 3.3 and 4.4.
        for (found, sum) in k.k.iter().zip([1.0, 1.25, 1.75, 1.75]) {
            assert!((found - 100.0 * sum / over).abs() < 1e-9, "{normalization}: {:?}", k.k);
        }
        let g = a.pair_correlation().unwrap();
        for (b, sum) in [1.0, 0.25, 0.5, 0.0].into_iter().enumerate() {
            let shell = 1.21 * PI * (2 * b + 1) as f64;
            assert!((g.g[b] - 100.0 * sum / over / shell).abs() < 1e-9, "{normalization}: {:?}", g.g);
        }
        let how = a.inhomogeneity().unwrap();
        assert_eq!((how.intensity.as_str(), how.least, how.largest, how.bandwidth), ("column l", 1.0, 4.0, None));
        assert!((how.inverse_mean - 1.75 / 100.0).abs() < 1e-15);
        if normalization == "intensity" {
            // spatstat's K with normpower 1, sum / sum of 1/lambda; and without renormalisation, sum / |D|.
            assert!((k.k[3] * how.inverse_mean - 1.75 / 1.75).abs() < 1e-9);
            assert!((k.k[3] * how.inverse_mean.powi(2) - 1.75 / 100.0).abs() < 1e-9);
        }
    }
    // Amplitudes at m = (0, 1), in quarters of turns: 0, 1 and 2.
    let file = "x,y,l\n0.1,0,1\n0.1,0.25,2\n0.1,0.5,4\n";
    let request = request("--intensity-column l --stats spectrum --max-frequency 1 --device cpu");
    let a = measure(Points::from_bytes("a.csv", file.as_bytes(), &request.input).unwrap(), &request).unwrap();
    let p = a.spectrum().unwrap().at([0, 1, 0]).unwrap();
    assert!((p - (0.75f64.powi(2) + 0.25) / (1.0 + 0.25 + 0.0625)).abs() < 1e-6, "{p}");
}

/// Where every point has the same intensity, all is as without, on either kind of normalization; and a factor drops out.
#[test]
fn a_constant_intensity_is_none() {
    let sets: Vec<Vec<f64>> = (0..3).map(|k| clustered(2, 90, k).coordinates).collect();
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    for domain in [Domain::unit_torus(2), window] {
        let corrections: &[&str] =
            if domain.is_torus() { &["none"] } else { &["translation", "isotropic", "border", "none"] };
        for correction in corrections {
            for normalization in ["pairs", "intensity"] {
                let line = format!(
                    "--stats pcf,k-function,radial --bins 20 --correction {correction} --normalization {normalization}"
                );
                let plain = found(&domain, &sets, &line);
                let all = ["formula:3", "formula:1/1024"].map(|f| format!("{line} --inhomogeneous {f}"));
                for weighted in all.map(|line| found(&domain, &sets, &line)) {
                    let [a, b] = [&plain, &weighted].map(|a| {
                        let (g, k) = (a.pair_correlation().unwrap(), a.k_function().unwrap());
                        let p = a.radial().unwrap().rings.iter().map(|r| r.p);
                        // Sums of weights are in steps of 2^-32 where there are none of points.
                        [g.g.clone(), k.k.iter().map(|k| 10.0 * k).collect(), p.collect()].concat()
                    });
                    for (x, y) in a.iter().zip(&b).filter(|(x, _)| x.is_finite()) {
                        assert!((x - y).abs() <= 1e-6 * x.abs().max(1.0), "{correction}, {normalization}: {x}, {y}");
                    }
                    if *correction == "none" {
                        let [a, b] = [&plain, &weighted].map(|a| a.pair_correlation().unwrap());
                        let same = |(x, y): (&f64, &f64)| (x - y).abs() <= 1e-12 * x.abs();
                        assert!(a.g.iter().zip(&b.g).all(same), "{:?} {:?}", a.g, b.g);
                    }
                }
            }
        }
    }
}

/// Independent points of an intensity that varies: uncorrelated where it is known, and not where it is forgotten.
#[test]
fn independent_points_are_uncorrelated() {
    let torus = Domain::torus(&[2.0, 1.0]).unwrap();
    let window = Domain::window(&[(10.0, 12.0), (-1.0, 0.0)]).unwrap();
    for (name, domain) in [("torus", torus), ("window", window), ("polygon", l_shape())] {
        let sets = thinned(&domain, 160, 300);
        let p = if name == "polygon" { "" } else { ",radial" };
        let line = format!("--stats pcf,k-function{p} --bins 12 --r-max 0.3");
        let line = if name == "polygon" { line } else { format!("{line} --max-frequency 8") };
        // How far g, K and P are from 1, pi r^2 and 1, in standard errors.
        let off = |a: &Analysis| -> [f64; 3] {
            let largest = |z: &mut dyn Iterator<Item = f64>| z.fold(0.0, |l: f64, z| l.max(z.abs()));
            let (g, k) = (a.pair_correlation().unwrap(), a.k_function().unwrap());
            let z_g = largest(&mut g.g.iter().zip(&g.g_se).map(|(g, se)| (g - 1.0) / se));
            let z_k = largest(&mut k.r.iter().zip(&k.k).zip(&k.k_se).map(|((r, k), se)| (k - PI * r * r) / se));
            let rings = a.radial().map_or(&[][..], |r| &r.rings);
            [z_g, z_k, largest(&mut rings.iter().map(|r| (r.p - 1.0) / r.p_se))]
        };
        let corrections: &[&str] = if name == "torus" { &["none"] } else { &["translation", "isotropic", "border"] };
        for correction in corrections {
            let line = format!("{line} --correction {correction}");
            let known = off(&found(&domain, &sets, &format!("{line} {LAMBDA}")));
            assert!(known.iter().all(|z| *z < 4.5), "{name}, {correction}: {known:?}");
            let forgotten = off(&found(&domain, &sets, &line));
            let seen = &forgotten[..if name == "polygon" { 2 } else { 3 }];
            assert!(seen.iter().all(|z| *z > 6.0), "{name}, {correction}: {forgotten:?}");
        }
        // An estimate sees most of it.
        let estimated =
            found(&domain, &sets[..40], &format!("{line} --inhomogeneous estimate --intensity-bandwidth 0.12"));
        let plain = found(&domain, &sets[..40], &line);
        let first = |a: &Analysis| a.pair_correlation().unwrap().g[1..4].iter().map(|g| g - 1.0).sum::<f64>() / 3.0;
        assert!(first(&estimated).abs() < 0.5 * first(&plain), "{name}: {} {}", first(&estimated), first(&plain));
        assert_eq!(estimated.inhomogeneity().unwrap().others, Some(39));
    }
}

/// A Gaussian kernel at a distance, over the images of a torus, and the part of it that is between two ends.
fn kernel(x: f64, h: f64, side: Option<f64>) -> f64 {
    let at = |x: f64| (-0.5 * (x / h).powi(2)).exp() / (h * TAU.sqrt());
    side.map_or_else(|| at(x), |side| (-9..=9).map(|k| at(x + f64::from(k) * side)).sum())
}

fn part(x: f64, h: f64, lo: f64, hi: f64) -> f64 {
    let steps = 4000;
    let at = |k: i32| lo + (f64::from(k) + 0.5) * (hi - lo) / f64::from(steps);
    (0..steps).map(|k| kernel(at(k) - x, h, None)).sum::<f64>() * (hi - lo) / f64::from(steps)
}

/// Estimates against direct sums: of one realization all points but the one, of several all but the realization.
#[test]
fn an_estimate_leaves_out_what_it_is_for() {
    let h = 0.3;
    let window = Domain::window(&[(0.0, 2.0), (0.0, 2.0)]).unwrap();
    for (name, domain) in [("torus", Domain::torus(&[2.0, 2.0]).unwrap()), ("window", window), ("polygon", l_shape())] {
        for realizations in [1, 3] {
            let sets: Vec<Vec<f64>> = thinned(&domain, realizations, 40);
            let request = request("--inhomogeneous estimate --intensity-bandwidth 0.3");
            let points = Points::new(domain.clone(), &sets).unwrap();
            let points = points.with_intensity(&request.input, &Control::default()).unwrap();
            let batch = points.batch(0..realizations, &Control::default()).unwrap();
            let side = (name == "torus").then_some(2.0);
            let [mut ratios, mut least, mut inverses] = [Vec::new(), vec![f64::INFINITY], vec![0.0]];
            for k in 0..sets.len() {
                for (i, x) in sets[k].chunks(2).enumerate() {
                    let mut sum = 0.0;
                    for (l, other) in sets.iter().enumerate().filter(|(l, _)| realizations == 1 || *l != k) {
                        for (j, y) in other.chunks(2).enumerate().filter(|(j, _)| (l, *j) != (k, i)) {
                            assert!((l, j) != (k, i));
                            sum += kernel(x[0] - y[0], h, side) * kernel(x[1] - y[1], h, side);
                        }
                    }
                    let rows = |lo, hi| part(x[1], h, lo, hi);
                    let mass = match name {
                        "torus" => 1.0,
                        "window" => part(x[0], h, 0.0, 2.0) * rows(0.0, 2.0),
                        _ => part(x[0], h, 0.0, 2.0) * rows(0.0, 1.0) + part(x[0], h, 0.0, 1.0) * rows(1.0, 2.0),
                    };
                    let lambda = sum / mass / if realizations == 1 { 1.0 } else { 2.0 };
                    least[0] = least[0].min(lambda);
                    inverses[0] += 1.0 / lambda;
                    // Weights have a power of two as their unit.
                    ratios.push(batch.weights(k).unwrap()[i] * lambda);
                }
            }
            let far = ratios.iter().map(|r| (r / ratios[0] - 1.0).abs()).fold(0.0, f64::max);
            assert!(far < 1e-6, "{name}, {realizations}: {far}");
            let how = points.inhomogeneity().unwrap();
            assert!((how.least / least[0] - 1.0).abs() < 1e-6, "{name}: {how:?}, {least:?}");
            let mean = inverses[0] / realizations as f64 / domain.measure();
            assert!((how.inverse_mean / mean - 1.0).abs() < 1e-6, "{name}: {how:?}, {mean}");
            assert_eq!((how.bandwidth, how.others), (Some(h), Some(realizations - 1)));
        }
    }
}

/// The rule of the picture of the intensity is that of the weights.
#[test]
fn the_bandwidth_is_that_of_the_picture() {
    let domain = Domain::window(&[(0.0, 2.0), (0.0, 1.0)]).unwrap();
    let sets = thinned(&domain, 3, 200);
    for rule in ["scott", "likelihood"] {
        let line =
            format!("--stats pcf,intensity --intensity-grid 8 --inhomogeneous estimate --intensity-bandwidth {rule}");
        let a = found(&domain, &sets, &line);
        let how = a.inhomogeneity().unwrap();
        assert_eq!(how.bandwidth, Some(a.intensity().unwrap().bandwidth), "{rule}");
        assert_eq!(how.rule.as_deref(), Some(rule));
    }
}

/// The reference finds the same; so do the halves of a batch, written, read and merged, which still know how it came.
#[test]
fn the_reference_and_shards_agree() {
    let line = "--sampler poisson -n 60 -k 20 --stats pcf,k-function,radial --bins 9 --inhomogeneous";
    let device = Device::new(Box::new(Cpu::new(Some(2)).unwrap()), None).unwrap();
    for how in ["estimate", "formula:1+x"] {
        let all = ["cpu", "reference"].map(|device| {
            let request = request(&format!("{line} {how} --device {device}"));
            measure(Points::open(&request.input).unwrap(), &request).unwrap()
        });
        let [cpu, reference] = all.each_ref().map(|a| (a.pair_correlation().unwrap(), a.k_function().unwrap()));
        assert_eq!((&cpu.0.g, &cpu.1.k), (&reference.0.g, &reference.1.k), "{how}");
        assert!(all.iter().all(|a| a.closed_form.name.is_empty() && a.closed_form.g.is_none()), "{how}");
        let request = request(&format!("{line} {how}"));
        let part = |range| {
            let mut part = Measurement::of(&request).unwrap().within(range, &device).unwrap();
            while part.step(&device, &Control::default()).unwrap() {}
            part
        };
        let mut whole = part(0..16);
        whole.merge(Measurement::read("rest", &part(16..20).write()).unwrap()).unwrap();
        let merged = whole.analysis().unwrap();
        assert_eq!(files(&merged), files(&all[0]), "{how}");
        assert_eq!(merged.inhomogeneity(), all[0].inhomogeneity(), "{how}");
    }
    // Points that are not there any more.
    let request = request("--intensity-column 3 --stats pcf");
    let text = "0.1 0.2 1\n0.3 0.4 2\n0.5 0.5 3\n";
    let source = Points::from_bytes("a.txt", text.as_bytes(), &request.input).unwrap();
    let plan = pairwave::analysis::Plan::of(&request, &source).unwrap();
    let mut measurement = Measurement::new(request, source.into(), plan);
    while measurement.step(&device, &Control::default()).unwrap() {}
    let read = Measurement::read("file", &measurement.write()).unwrap();
    let how = read.analysis().unwrap().inhomogeneity().unwrap().clone();
    assert_eq!((how.intensity.as_str(), how.least, how.largest), ("column 3", 1.0, 3.0));
}

/// An intensity that no point can be weighted by is an error that names the point; and so is one that was forgotten.
#[test]
fn what_cannot_be() {
    let domain = Domain::unit_torus(2);
    let said = |line: &str, sets: &[Vec<f64>]| {
        let points = Points::new(domain.clone(), sets).unwrap();
        points.with_intensity(&request(line).input, &Control::default()).err().unwrap().to_string()
    };
    let sets = [vec![0.5, 0.5, 0.75, 0.25], vec![0.25, 0.5, 0.9, 0.9]];
    for (spec, value) in [("x-0.25", "0"), ("0.5-x", "0"), ("1/(x-0.25)^2", "inf")] {
        // A formula that is not finite is refused as such.
        let said = said(&format!("--inhomogeneous formula:{spec}"), &sets);
        let named = said.contains("points in memory, realization") && said.contains(&format!("is {value}"));
        assert!(named || spec.starts_with('1'), "{said}");
    }
    let far = [vec![0.1, 0.1, 0.6, 0.6]];
    assert_eq!(
        said("--inhomogeneous estimate --intensity-bandwidth 0.01", &far),
        "points in memory, realization 0, point 0 at 0.1,0.1: the intensity there is 0; expected a finite number above 0: a larger \
         `intensity_bandwidth` reaches more points"
    );
    let request = request("--inhomogeneous formula:1+x --stats pcf");
    let error = measure(Points::new(domain.clone(), &far).unwrap(), &request).err().unwrap().to_string();
    assert!(error.contains("these points have no intensity"), "{error}");
    let mut weighted = ensemble(&[raw(2, far[0].clone())]);
    weighted = weighted.with_weights(&[1.0, 2.0]);
    let error = Points::of(weighted).with_intensity(&request.input, &Control::default()).err().unwrap().to_string();
    assert!(error.contains("weights of their own"), "{error}");
}
