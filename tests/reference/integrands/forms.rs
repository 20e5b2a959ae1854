//! The same function in two forms: closed, and by its values or its cells.

use std::f64::consts::FRAC_PI_4;

use super::*;

/// The largest difference of two integrands: integrals, f_m up to `reach`, a(r).
fn apart(f: &Integrand, g: &Integrand, reach: i32) -> [f64; 3] {
    let dim = f.dim();
    let integrals = (f.integral() - g.integral()).abs().max((f.square_integral() - g.square_integral()).abs());
    let coefficient = |m: &Vec<i32>| (f.coefficient(m) - g.coefficient(m)).norm();
    let a = |r: &Vec<f64>| (f.autocorrelation(r) - g.autocorrelation(r)).abs();
    let modes = modes(dim, reach, 60);
    [integrals, modes.iter().map(coefficient).fold(0.0, f64::max), lags(dim, 60).iter().map(a).fold(0.0, f64::max)]
}

/// Closed, and as somebody would type it.
const TYPED: [(&str, &str, usize, f64); 16] = [
    ("ramp", "formula:x", 1, 1e-12),
    ("monomial:x=3", "formula:x^3", 1, 1e-12),
    ("monomial:x=2,y=1", "formula:x^2*y", 2, 1e-10),
    ("monomial:x=1,y=2,z=3", "formula:x*y^2*z^3", 3, 1e-9),
    ("cosine:x=2,y=1,phase=0.3", "formula:cos(2*pi*2*x + 0.3)*cos(2*pi*y)", 2, 1e-6),
    ("cosine:x=3,phase=0", "formula:cos(3*tau*x)", 1, 1e-10),
    ("cut-gaussian", "formula:exp(-(x-0.3)^2/2/0.2^2)", 1, 1e-12),
    ("cut-gaussian", "formula:exp(-(x-0.3)^2/2/0.2^2 - (y-0.6)^2/2/0.25^2)", 2, 1e-8),
    (
        "cut-gaussian:sigma=0.4,sigma-y=0.5,sigma-z=0.6",
        "formula:exp(-(x-0.3)^2/2/0.4^2-(y-0.6)^2/2/0.5^2-(z-0.5)^2/2/0.6^2)",
        3,
        1e-6,
    ),
    ("zone-plate", "formula:0.5+0.5*cos(60*x^2)", 1, 1e-10),
    ("zone-plate:alpha=20", "formula:(1+cos(20*(x^2+y^2)))/2", 2, 1e-6),
    ("zone-plate:alpha=3.5", "formula:(1+cos(3.5*(x^2+y^2+z^2)))/2", 3, 2e-6),
    ("bump:r=0.4,q=3,x=0.5", "formula:max(0, 1-((x-0.5)/0.4)^2)^3", 1, 1e-10),
    ("bump:r=0.4,q=4", "formula:max(0, 1-((x-0.5)^2+(y-0.5)^2)/0.16)^4", 2, 2e-6),
    ("gaussian:sigma=0.05,x=0.5,y=0.5", "formula:exp(-((x-0.5)^2+(y-0.5)^2)/2/0.05^2)", 2, 2e-6),
    ("checker:cells=2", "formula:0.5+0.5*signum((x-0.5)*(y-0.5))", 2, 2e-3),
];

#[test]
fn closed_and_typed_are_the_same() {
    for (closed, typed, dim, tolerance) in TYPED {
        let (f, g) = (made(closed, dim), made(typed, dim));
        let [integrals, coefficients, a] = apart(&f, &g, 40);
        assert!(
            integrals <= g.integral_error() + 1e-13,
            "{typed}: integrals {integrals:e}, stated {:e}",
            g.integral_error()
        );
        assert!(coefficients < tolerance && a < tolerance, "{typed}: f_m {coefficients:e}, a {a:e}");
        // The errors are stated, and not by far too small.
        let (stated, stated_a) = (g.coefficient_error(), g.autocorrelation_error());
        assert!(
            coefficients <= stated + 1e-12 && stated < 30.0 * tolerance,
            "{typed}: f_m {coefficients:e}, stated {stated:e}"
        );
        assert!(a <= stated_a + 1e-12 && stated_a < 1000.0 * tolerance, "{typed}: a {a:e}, stated {stated_a:e}");
        for x in centers(7, dim) {
            assert!((f.value(&x) - g.value(&x)).abs() < 1e-12, "{typed} at {x:?}");
        }
    }
    // Planted: a little more than the tolerance beside it.
    let [.., coefficients, a] = apart(&made("ramp", 1), &made("formula:x + 1e-9*x^2", 1), 40);
    assert!(coefficients > 1e-11 && a > 1e-11);
}

/// What a formula says of its smoothness is what the closed form knows.
#[test]
fn smoothness_is_seen() {
    for (spec, dim, expected) in [
        ("formula:x^2*y", 2, 1.0),
        ("formula:cos(2*pi*x)", 2, f64::INFINITY),
        ("formula:x*(1-x)", 1, 3.0),
        ("formula:x*(1-x)*y*(1-y)", 2, 3.0),
        ("formula:signum(x-0.3)^2 + signum(x-0.3)", 1, 1.0),
        ("bump:q=2", 2, 5.0),
        ("disk", 2, 1.0),
        ("gaussian", 3, f64::INFINITY),
        ("cut-gaussian", 1, 1.0),
        ("step", 2, 1.0),
    ] {
        assert_eq!(made(spec, dim).smoothness(), expected, "{spec}");
    }
}

#[test]
fn half_spaces_are_boxes_and_one_another() {
    for (left, right, dim) in [
        ("half-plane:angle=0,offset=0.37", "step:at=0.37", 2),
        ("half-plane:angle=1.5707963267948966,offset=0.37", "step:axis=y,at=0.37", 2),
        ("half-plane:angle=3.141592653589793,offset=-0.37", "box:x0=0.37,x1=1,y0=0,y1=1", 2),
        ("half-plane:angle=0,offset=0.37", "step:at=0.37", 3),
        ("half-plane:angle=1,tilt=1.5707963267948966,offset=0.4", "step:axis=z,at=0.4", 3),
        ("half-plane:angle=1,tilt=-1.5707963267948966,offset=-0.4", "box:x0=0,x1=1,y0=0,y1=1,z0=0.4,z1=1", 3),
    ] {
        let apart = apart(&made(left, dim), &made(right, dim), 30);
        assert!(apart.iter().all(|x| *x < 2e-14), "{left}: {apart:?}");
    }
    // The polygon's two axes are any two of the polyhedron's.
    for (angle, offset) in [(0.6, 0.5), (2.2, 0.1), (0.79, 1.1), (-0.3, 0.45), (1e-9, 0.5)] {
        let flat = made(&format!("half-plane:angle={angle},offset={offset}"), 2);
        for (solid, axes) in [
            (format!("half-plane:angle={angle},offset={offset}"), [0, 1, 2]),
            (format!("half-plane:angle=0,tilt={angle},offset={offset}"), [0, 2, 1]),
            (format!("half-plane:angle=1.5707963267948966,tilt={angle},offset={offset}"), [1, 2, 0]),
        ] {
            let solid = made(&solid, 3);
            assert!((solid.integral() - flat.integral()).abs() < 1e-14, "{solid:?}");
            for m in modes(2, 20, 40) {
                for third in [0, 1] {
                    let mut all = [0; 3];
                    (all[axes[0]], all[axes[1]], all[axes[2]]) = (m[0], m[1], third);
                    let expected = if third == 0 { flat.coefficient(&m) } else { Complex::default() };
                    let apart = (solid.coefficient(&all) - expected).norm();
                    assert!(apart < 1e-13, "{solid:?} {all:?}: {apart:e}");
                }
            }
            for r in lags(2, 30) {
                let mut all = [0.3; 3];
                (all[axes[0]], all[axes[1]]) = (r[0], r[1]);
                let apart = (solid.autocorrelation(&all) - flat.autocorrelation(&r)).abs();
                assert!(apart < 1e-13, "{solid:?} {all:?}: {apart:e}");
            }
        }
    }
    // Both sides of a plane are the whole: opposite f_m, also where m is the normal.
    for (angle, tilt, offset) in [(FRAC_PI_4, 0.6154797086703873, 0.8), (0.3, 0.2, 0.7), (0.0, FRAC_PI_4, 0.7)] {
        let below = made(&format!("half-plane:angle={angle},tilt={tilt},offset={offset}"), 3);
        let (back, up, away) = (angle + std::f64::consts::PI, -tilt, -offset);
        let above = made(&format!("half-plane:angle={back},tilt={up},offset={away}"), 3);
        assert!((below.integral() + above.integral() - 1.0).abs() < 1e-14);
        for m in modes(3, 6, 60).into_iter().skip(1).chain([vec![2, 2, 2], vec![3, 3, 3], vec![1, 0, 1]]) {
            if m.iter().all(|m| *m == 0) {
                continue;
            }
            let sum = (below.coefficient(&m) + above.coefficient(&m)).norm();
            assert!(sum < 1e-14, "{below:?} {m:?}: {sum:e}");
        }
    }
}

#[test]
fn what_is_one_function_is_one() {
    for (left, right, dim) in [
        ("interval:x0=0,x1=0.3", "step", 1),
        ("disk:r=0.25,x=0.5", "interval:x0=0.25,x1=0.75", 1),
        ("steps:values=1;-1;1;-1;1", "steps:values=1;-1;1;-1;1", 1),
        ("checker:cells=2", "interval:x0=0,x1=0.5", 1),
        ("ramp", "monomial:x=1", 1),
        ("box:x0=0,x1=0.3,y0=0,y1=1", "step", 2),
        ("cut-gaussian:sigma=0.02,sigma-y=0.02,x=0.5,y=0.5", "gaussian:sigma=0.02,x=0.5,y=0.5", 2),
    ] {
        let apart = apart(&made(left, dim), &made(right, dim), 50);
        assert!(apart.iter().all(|x| *x < 1e-14), "{left} and {right}: {apart:?}");
    }
}
