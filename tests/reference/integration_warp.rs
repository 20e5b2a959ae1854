//! Importance sampling by a warp: where points go, what is integrated then, and what is predicted of it.

use crate::integrals::{self, drawn, each, found, settings, sums};
use pairwave::Integrand;
use pairwave::compute::cpu::Cpu;
use pairwave::compute::reference::Reference;
use pairwave::integrand::Density;
use pairwave::plan::{By, IntegrationPlan, IntegrationSettings};
use pairwave::points::Ensemble;

/// Gauss's rule of five places, exact up to degree 9 (Abramowitz & Stegun 25.4.30).
const RULE: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// The integral of `f` over [0, end], by panels whose ends are multiples of 1 / `panels`.
fn quadrature(end: f64, panels: usize, f: &dyn Fn(f64) -> f64) -> f64 {
    let width = 1.0 / panels as f64;
    let panel = |i: usize| {
        let (lo, hi) = (i as f64 * width, end.min((i + 1) as f64 * width));
        let at = |(x, w): (f64, f64)| 0.5 * (hi - lo) * w * f(0.5 * (lo + hi) + 0.5 * (hi - lo) * x);
        if hi > lo { RULE.into_iter().map(at).sum() } else { 0.0 }
    };
    (0..panels).map(panel).sum()
}

/// The marginal and conditional distribution functions of p at `x`: where `x` came from.
fn came_from(p: &dyn Fn([f64; 3]) -> f64, dim: usize, panels: usize, x: [f64; 3]) -> [f64; 3] {
    let over_z = |x: f64, y: f64| if dim < 3 { p([x, y, 0.0]) } else { quadrature(1.0, panels, &|z| p([x, y, z])) };
    let over_yz = |x: f64| if dim < 2 { p([x, 0.0, 0.0]) } else { quadrature(1.0, panels, &|y| over_z(x, y)) };
    let part = |end: f64, f: &dyn Fn(f64) -> f64| quadrature(end, panels, f) / quadrature(1.0, panels, f);
    let mut u = [part(x[0], &over_yz), 0.0, 0.0];
    if dim > 1 {
        u[1] = part(x[1], &|y| over_z(x[0], y));
    }
    if dim > 2 {
        u[2] = part(x[2], &|z| p([x[0], x[1], z]));
    }
    u
}

fn spread(dim: usize, count: usize) -> impl Iterator<Item = [f64; 3]> {
    let steps = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];
    (0..count).map(move |i| std::array::from_fn(|k| if k < dim { ((i as f64 + 0.5) * steps[k]).fract() } else { 0.0 }))
}

/// The map of every kind of density, against integrals that the test takes itself.
#[test]
fn points_go_where_the_distribution_says() {
    for (spec, dim, tolerance) in [
        ("ramp", 1, 1e-12),
        ("monomial:x=3", 1, 1e-12),
        ("gaussian:sigma=0.1", 1, 1e-12),
        ("cut-gaussian", 1, 1e-12),
        ("steps:values=1;3;0;5;0.5", 1, 1e-12),
        ("interval:x0=0.2,x1=0.7", 1, 1e-12),
        ("formula:1+x+sin(9*x)^2", 1, 1e-10),
        ("monomial:x=1,y=2", 2, 1e-12),
        ("gaussian:sigma=0.12,x=0.3,y=0.6", 2, 1e-10),
        ("checker:cells=4", 2, 1e-12),
        ("formula:4*x*y", 2, 1e-12),
        ("formula:x+x*y^2+0.1", 2, 1e-12),
        ("formula:exp(-3*x*y)+y^2", 2, 1e-10),
        ("zone-plate:alpha=9", 2, 1e-10),
        ("monomial:x=1,y=2,z=1", 3, 1e-12),
        ("formula:0.2+x*y+z^2*y", 3, 1e-10),
        ("formula:exp(-x-y*y-3*z*x)", 3, 1e-10),
    ] {
        let density = Density::new(spec, dim).unwrap();
        assert_eq!(density.cells(), None, "{spec}");
        let given = Integrand::new(spec, dim).unwrap();
        let p = |x: [f64; 3]| given.value(&x[..dim]);
        let (panels, count) = ([40, 40, 10][dim - 1], [60, 20, 6][dim - 1]);
        let mut transposed = 0f64;
        for u in spread(dim, count) {
            let x = density.place(&u[..dim]);
            let back = came_from(&p, dim, panels, x);
            let off = (0..dim).map(|k| (back[k] - u[k]).abs()).fold(0.0, f64::max);
            assert!(off < tolerance, "{spec} {dim}D: {u:?} to {x:?}, which is of {back:?}");
            // Planted: the marginal of y and x given y.
            let swapped = |x: [f64; 3]| if dim == 2 { [x[1], x[0], 0.0] } else { x };
            let back = came_from(&|x| p(swapped(x)), dim, panels, swapped(x));
            transposed = transposed.max((0..dim).map(|k| (swapped(back)[k] - u[k]).abs()).fold(0.0, f64::max));
            let value = density.value(&x[..dim]) * given.integral() - p(x);
            assert!(value.abs() < 1e-12, "{spec}: the density is the function over its integral");
        }
        let one_way_alone = ["formula:x+x*y^2+0.1", "formula:exp(-3*x*y)+y^2"].contains(&spec);
        assert!(!one_way_alone || transposed > 1e-3, "{spec}: {transposed:e}");
    }
}

/// Two by two pixels, worked by hand: columns hold 6 and 4 of 10.
#[test]
fn pixels_are_picked_by_hand() {
    let file = tempfile::NamedTempFile::with_suffix(".pfm").unwrap();
    let mut bytes = b"Pf\n2 2\n-1.0\n".to_vec();
    // The bottom row first.
    bytes.extend([1f32, 3.0, 5.0, 1.0].iter().flat_map(|v| v.to_le_bytes()));
    std::fs::write(file.path(), bytes).unwrap();
    let density = Density::new(&format!("image:file={}", file.path().display()), 2).unwrap();
    for (u, x, p) in [
        ([0.3, 0.5], [0.25, 0.7], 2.0),
        ([0.8, 0.3], [0.75, 0.2], 1.2),
        ([0.0, 0.0], [0.0, 0.0], 0.4),
        ([0.9, 0.75], [0.875, 0.5], 0.4),
    ] {
        let at = density.place(&u);
        assert!((0..2).all(|k| (at[k] - x[k]).abs() < 1e-14), "{u:?}: {at:?}");
        assert!((density.value(&at[..2]) - p).abs() < 1e-14, "{u:?}");
    }
}

fn plan(ensemble: &Ensemble, integrands: &[&str], intensity: &str, f: &[u32]) -> IntegrationPlan {
    let settings =
        IntegrationSettings { intensity: Some(intensity), by: Some(By::Warp), max_frequency: Some(f), ..settings() };
    integrals::plan(ensemble, integrands, settings)
}

/// Where the density is as the function, there is no error at all, whatever the points.
#[test]
fn a_function_placed_by_itself_is_constant() {
    for (f, density, dim) in [
        ("formula:4*x*y", "formula:4*x*y", 2),
        ("monomial:x=1,y=1", "formula:4*x*y", 2),
        ("formula:7*x*y", "monomial:x=1,y=1", 2),
        ("gaussian", "gaussian", 2),
        ("gaussian", "gaussian", 3),
        ("ramp", "ramp", 1),
        ("formula:1+sin(7*x)^2", "formula:1+sin(7*x)^2", 1),
        ("disk", "disk", 2),
        ("checker:cells=3", "checker:cells=3", 2),
        ("steps:values=0;2;0;5", "steps:values=0;2;0;5", 1),
    ] {
        if f == "disk" {
            // Neither a product nor smooth: constant on small cells, so that it is one number but near the edge.
            let f = Integrand::new(f, dim).unwrap();
            let density = Density::new(density, dim).unwrap();
            assert_eq!(density.cells(), Some(512));
            let share = f.warped(&density).unwrap().variance() / f.variance();
            assert!(share > 0.0 && share < 0.01, "{share}");
            continue;
        }
        let ensemble = drawn("random", 20, dim, 3, &[]);
        let plan = plan(&ensemble, &[f], density, &vec![3; dim]);
        let integral = plan.integrands[0].integral();
        assert_eq!(plan.integrands[0].variance(), 0.0, "{f} by {density}");
        for realization in sums(&Cpu::new(Some(1)).unwrap(), &plan, &ensemble).realizations {
            let s = &realization.each[0];
            let off = [s.values / 20.0 - integral, s.shifted[1].sqrt(), s.grid, s.axes, s.pairs];
            assert!(off.iter().all(|off| off.abs() < 1e-12 * integral), "{f} by {density}: {off:?}");
        }
    }
}

/// Planted: another density is seen.
#[test]
fn a_function_placed_by_another_is_not_constant() {
    for (f, density, dim) in [("ramp", "formula:1+x", 1), ("gaussian", "gaussian:sigma=0.11", 2)] {
        let density = Density::new(density, dim).unwrap();
        assert!(Integrand::new(f, dim).unwrap().warped(&density).unwrap().variance() > 1e-6);
    }
}

/// Of a smooth function of u the variance over shifts is one number in frequency and in space.
#[test]
fn both_forms_are_one_number() {
    let smooth = "formula:2+cos(tau*x)";
    for (name, n, dim, f, density, tolerance) in [
        ("jittered", 32, 1, "gaussian:sigma=0.15", smooth, 1e-9),
        ("random", 20, 1, "cosine:x=2,phase=0.3", "gaussian:sigma=0.3", 1e-9),
        ("jittered", 36, 2, "gaussian:sigma=0.2", "gaussian:sigma=0.4", 1e-8),
        ("random", 30, 2, "gaussian:sigma=0.2", "formula:2+cos(tau*x)*sin(tau*y)", 1e-6),
        ("lhs", 30, 3, "gaussian:sigma=0.3", "gaussian:sigma=0.5", 1e-8),
    ] {
        let ensemble = drawn(name, n, dim, 2, &[]);
        let plan = plan(&ensemble, &[f], density, &vec![[60, 30, 14][dim - 1]; dim]);
        let h = &plan.integrands[0];
        for realization in sums(&Cpu::new(Some(2)).unwrap(), &plan, &ensemble).realizations {
            let (s, n) = (&realization.each[0], realization.n as f64);
            let (spectral, spatial) = ((s.grid + s.axes) / (n * n), h.variance() / n + 2.0 * s.pairs / (n * n));
            let off = (spectral - spatial).abs() * n / h.variance();
            assert!(off < tolerance, "{name} {dim}D {f} by {density}: {spectral} and {spatial}, {off:e}");
            // Planted: the function without the map has another variance.
            let f = Integrand::new(f, dim).unwrap();
            assert!((f.variance() / h.variance() - 1.0).abs() > 1e-3, "{f:?}: {} {}", f.variance(), h.variance());
        }
        let (fast, slow) = (sums(&Cpu::new(Some(2)).unwrap(), &plan, &ensemble), sums(&Reference, &plan, &ensemble));
        for (a, b) in fast.realizations.iter().zip(&slow.realizations) {
            let close = |a: f64, b: f64| (a - b).abs() < 1e-10 * h.square_integral() * (n * n) as f64;
            assert!(close(a.each[0].pairs, b.each[0].pairs) && close(a.each[0].grid, b.each[0].grid), "{name}");
        }
    }
}

/// x^2 y placed by 4 x y: `h = sqrt(u) / 4`, so that all is known by hand.
#[test]
fn jittered_points_by_hand() {
    for (f, density) in [("monomial:x=2,y=1", "monomial:x=1,y=1"), ("formula:x^2*y", "formula:4*x*y")] {
        let line = format!(
            "--sampler jittered -n 64 -k 1000 --integrand {f} --intensity {density} --by warp --device cpu --stats pcf --r-max 0.05"
        );
        let analysis = found(&line);
        let e = &each(&analysis)[0];
        assert!((e.v0 - (1.0 / 32.0 - 1.0 / 36.0)).abs() < 1e-7, "{}", e.v0);
        // In each of eight strips sqrt(u) / 4 has the variance of one point, of which eight are averaged.
        let moment = |i: i32, p: f64| {
            let at = |k: i32| (f64::from(k) / 8.0).powf(p / 2.0 + 1.0) / (p / 2.0 + 1.0) * 8.0 / 4f64.powf(p);
            at(i + 1) - at(i)
        };
        let as_is: f64 = (0..8).map(|i| (moment(i, 2.0) - moment(i, 1.0).powi(2)) / 512.0).sum();
        assert!((as_is - 1.50e-6).abs() < 0.01e-6, "{as_is}");
        let observed = e.observed.unwrap();
        assert!((observed.value - as_is).abs() < 4.0 * observed.se.unwrap(), "{observed:?}");
        let (predicted, shifted) = (analysis.integration().unwrap().predicted(e), e.shifted);
        for (what, v) in [("predicted", predicted), ("shifted", shifted)] {
            let off = (v.value - 1.50e-5).abs();
            assert!(off < 4.0 * v.se.unwrap() + 0.005e-5, "{what} {v:?}");
        }
        assert!((e.phase.value - (as_is - 1.50e-5)).abs() < 0.05e-5, "{:?}", e.phase);
        assert!((e.closed.value / e.spatial.unwrap().value - 1.0).abs() < 1e-2);
        assert!(e.z.unwrap().abs() < 4.5 && (e.bias.value / e.bias.se.unwrap()).abs() < 4.5);
    }
}

/// Of every kind of density and function: no bias, and what is observed is what was predicted.
#[test]
fn what_is_predicted_is_observed() {
    for (dim, f, density) in [
        (1, "gaussian", "cut-gaussian"),
        (1, "interval:x0=0.5,x1=0.9", "formula:0.1+sqrt(x)"),
        (2, "disk", "gaussian:sigma=0.2,x=0.5,y=0.5"),
        (2, "disk:r=0.2", "disk:r=0.3"),
        (2, "half-plane", "formula:0.3+x*y^2"),
        (2, "gaussian", "formula:1.5+0.5*signum(x-0.7)*signum(y-0.8)"),
        (2, "box", "formula:0.2+floor(x+0.5*y)"),
        (3, "gaussian:sigma=0.2", "formula:0.2+x*y+z^2*y"),
    ] {
        let n = [40, 64, 64][dim - 1];
        for sampler in ["random", "jittered"] {
            // The variance of random points is held against v0/n.
            let k = if sampler == "random" { 300 } else { 100 };
            let line = format!(
                "--sampler {sampler} --dim {dim} -n {n} -k {k} --integrand {f} --intensity {density} --by warp --device cpu --stats pcf --r-max 0.05 --max-frequency 8"
            );
            let analysis = found(&line);
            let e = &each(&analysis)[0];
            let bias = e.bias.value / e.bias.se.unwrap();
            assert!(bias.abs() < 4.5, "{sampler} {f} by {density}: bias {bias} standard errors");
            let z = e.z.unwrap();
            assert!(z.abs() < 4.5, "{sampler} {f} by {density}: z {z}, {:?} {:?}", e.shifted, e.spatial);
            if sampler == "random" {
                let ratio = e.shifted.value * n as f64 / e.v0;
                assert!((ratio - 1.0).abs() < 0.15, "{f} by {density}: {ratio}");
            }
        }
        // Planted, in the same test of bias: a weight of 1.
        let (p, f) = (Density::new(density, dim).unwrap(), Integrand::new(f, dim).unwrap());
        let far = |value: &dyn Fn(&[f64; 3]) -> f64| {
            let all: Vec<f64> = spread(dim, 50_000).map(|u| value(&u)).collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            let variance = all.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / all.len() as f64;
            (mean - f.integral()).abs() / (variance / all.len() as f64).sqrt()
        };
        let right = far(&|u| {
            let x = p.place(&u[..dim]);
            f.value(&x[..dim]) / p.value(&x[..dim])
        });
        let unweighted = far(&|u| f.value(&p.place(&u[..dim])[..dim]));
        assert!(right < 4.5 && unweighted > 8.0, "{f:?} by {density}: {right}, {unweighted}");
    }
    // The map of the transposed density, weighted by the right one.
    let (p, q) = (Density::new("formula:0.3+x*y^2", 2).unwrap(), Density::new("formula:0.3+y*x^2", 2).unwrap());
    let f = Integrand::new("ramp", 2).unwrap();
    let all: Vec<f64> =
        spread(2, 50_000).map(|u| q.place(&u[..2])).map(|x| f.value(&x[..2]) / p.value(&x[..2])).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    assert!((mean / f.integral() - 1.0).abs() > 0.02, "{mean}");
}
