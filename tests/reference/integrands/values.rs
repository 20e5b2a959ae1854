//! Values of f by definition, edges, known integrals, what is refused.

use super::*;

/// Integrals and integrals of squares by scipy and mpmath.
#[test]
fn integrals_are_the_known_ones() {
    for (spec, dim, integral, square) in [
        ("disk", 2, 0.19634954084936207, 0.19634954084936207),
        ("ramp", 2, 0.5, 1.0 / 3.0),
        ("step", 2, 0.3, 0.3),
        ("box", 2, 0.297, 0.297),
        ("half-plane", 2, 0.2682290944274743, 0.2682290944274743),
        ("gaussian", 2, 0.06283185307179585, 0.03141592653764315),
        ("cosine:x=1,y=1,phase=0", 2, 0.0, 0.25),
        ("checker", 2, 0.5, 0.5),
        ("step", 1, 0.3, 0.3),
        ("interval", 1, 0.56, 0.56),
        ("ramp", 1, 0.5, 1.0 / 3.0),
        ("monomial:x=3", 1, 0.25, 0.14285714285714285),
        ("cosine:x=2", 1, 0.0, 0.5),
        ("gaussian", 1, 0.25066282746310004, 0.17724538509547477),
        ("cut-gaussian", 1, 0.46771686807090107, 0.34848293210477466),
        ("steps", 1, 1.5, 7.85),
    ] {
        let f = made(spec, dim);
        let off = |found: f64, known: f64| (found - known).abs() / known.abs().max(0.1);
        assert!(
            off(f.integral(), integral) < 1e-12 && off(f.square_integral(), square) < 1e-12,
            "{f:?}: {} {}",
            f.integral(),
            f.square_integral()
        );
        assert_eq!((f.integral_error(), f.coefficient_error(), f.autocorrelation_error()), (0.0, 0.0, 0.0), "{f:?}");
    }
}

#[test]
fn values_are_those_of_the_definition() {
    let below_half = 0.5f64.next_down();
    for (spec, dim, x, expected) in [
        // Half-open, and `<`, on the edge itself.
        ("interval:x0=0.25,x1=0.5", 1, vec![0.25], 1.0),
        ("interval:x0=0.25,x1=0.5", 1, vec![0.5], 0.0),
        ("interval:x0=0.25,x1=0.5", 1, vec![below_half], 1.0),
        ("step:at=0.5", 2, vec![0.5, 0.1], 0.0),
        ("step:at=0.5", 2, vec![0.0, 0.9], 1.0),
        ("box:x0=0.25,x1=0.5,y0=0.5,y1=1", 2, vec![0.25, 0.5], 1.0),
        ("box:x0=0.25,x1=0.5,y0=0.5,y1=1", 2, vec![0.25, below_half], 0.0),
        ("disk:r=0.25", 2, vec![0.75, 0.5], 0.0),
        ("disk:r=0.25", 2, vec![0.75f64.next_down(), 0.5], 1.0),
        ("half-plane:angle=0,offset=0.5", 2, vec![0.5, 0.3], 0.0),
        ("half-plane:angle=0,offset=0.5", 2, vec![below_half, 0.3], 1.0),
        // By the nearest image.
        ("disk:r=0.2,x=0.95,y=0.95", 2, vec![0.05, 0.05], 1.0),
        ("checker", 2, vec![0.1, 0.1], 1.0),
        ("checker", 2, vec![0.25, 0.1], 0.0),
        ("checker", 3, vec![0.3, 0.3, 0.3], 0.0),
        ("steps", 1, vec![0.4], -2.0),
        ("steps", 1, vec![1f64.next_down()], 0.5),
        ("ramp:axis=y", 2, vec![0.1, 0.7], 0.7),
        ("monomial", 2, vec![0.5, 0.5], 0.125),
        ("monomial:y=1", 2, vec![0.5, 0.25], 0.25),
        ("cosine:y=1", 2, vec![0.3, 0.25], (std::f64::consts::FRAC_PI_2 + 0.3).cos()),
        ("cosine", 2, vec![0.125, 0.0], (std::f64::consts::FRAC_PI_2 + 0.3).cos()),
        ("zone-plate:alpha=2", 2, vec![0.5, 0.5], 0.5 + 0.5 * 1f64.cos()),
        ("gaussian:sigma=0.1,x=0,y=0", 2, vec![0.9, 0.0], (-0.5f64).exp()),
        ("cut-gaussian:sigma=0.1,x=0,y=0,sigma-y=0.1", 2, vec![0.9, 0.0], (-40.5f64).exp()),
        ("bump:r=0.5,q=2", 1, vec![0.75], 0.5625),
        ("formula:x^2*y - z", 3, vec![0.5, 0.5, 0.25], -0.125),
    ] {
        let found = made(spec, dim).value(&x);
        assert!((found - expected).abs() < 1e-15, "{spec} at {x:?}: {found}, expected {expected}");
    }
    // Planted: a closed end is another value there.
    assert_ne!(
        made("interval:x0=0.25,x1=0.5", 1).value(&[0.5]),
        made("interval:x0=0.25,x1=0.5000000001", 1).value(&[0.5])
    );
}

#[test]
fn specifications_are_written_out() {
    for (spec, dim, canonical) in [
        ("disk", 2, "disk:r=0.25,x=0.5,y=0.5"),
        ("ball: r = 0.3", 3, "disk:r=0.3,x=0.5,y=0.5,z=0.5"),
        ("disk:y=.25,r=1e-1", 2, "disk:r=0.1,x=0.5,y=0.25"),
        ("box", 1, "box:x0=0.13,x1=0.58"),
        ("step:axis=y", 2, "step:axis=y,at=0.3"),
        ("cosine:y=3", 2, "cosine:x=0,y=3,phase=0.3"),
        ("monomial", 3, "monomial:x=2,y=1,z=0"),
        ("cut-gaussian", 2, "cut-gaussian:sigma=0.2,sigma-y=0.25,x=0.3,y=0.6"),
        ("formula: max(x, y) ", 2, "formula:max(x, y)"),
        ("steps:values=1;2", 1, "steps:values=1;2"),
    ] {
        let f = made(spec, dim);
        assert_eq!(f.spec(), canonical);
        // And read back, it is the same.
        assert_eq!(made(f.spec(), dim).spec(), canonical);
    }
}

#[test]
fn what_cannot_be_says_what_can() {
    let mut wrong = Vec::new();
    for (spec, dim, message) in [
        ("dsik", 2, "integrand dsik: no such integrand (did you mean disk?); expected one of disk, box, "),
        ("", 2, "integrand : no such integrand; expected one of disk"),
        (
            "disk:radius=0.2",
            2,
            "integrand disk:radius=0.2: disk has no parameter radius (did you mean r?); expected r (a number above 0 and at most 0.5, default 0.25), x",
        ),
        (
            "cut-gaussian:sigmay=1",
            2,
            "integrand cut-gaussian:sigmay=1: cut-gaussian has no parameter sigmay (did you mean sigma-y?)",
        ),
        ("disk:r=0.6", 2, "integrand disk:r=0.6: r=0.6: r of disk is a number above 0 and at most 0.5 (default 0.25)"),
        ("disk:r=0", 2, "integrand disk:r=0: r=0: r of disk is"),
        ("disk:r=NaN", 2, "integrand disk:r=NaN: r=NaN: r of disk is"),
        ("disk:r=0.1,r=0.2", 2, "integrand disk:r=0.1,r=0.2: r is given twice"),
        ("disk:0.1", 2, "integrand disk:0.1: 0.1: expected key=value"),
        ("disk:z=0.3", 2, "integrand disk:z=0.3: z of disk is there from 3D on, this is 2D"),
        ("interval", 2, "integrand interval: interval is there in 1D, this is 2D"),
        ("half-plane", 1, "integrand half-plane: half-plane is there in 2D or 3D, this is 1D"),
        ("disk", 4, "integrand disk: disk is there in 1D to 3D, this is 4D"),
        ("ramp:axis=z", 2, "integrand ramp:axis=z: axis=z: there are x, y in 2D"),
        ("ramp:axis=w", 2, "integrand ramp:axis=w: axis=w: axis of ramp is x, y or z (default x)"),
        ("box:x0=0.7,x1=0.2", 2, "integrand box:x0=0.7,x1=0.2: x0=0.7,x1=0.2 is empty; expected x0 below x1"),
        (
            "half-plane:angle=0,offset=1.2",
            2,
            "integrand half-plane:angle=0,offset=1.2: offset=1.2 leaves all of the box; expected one above 0.0000 and below 1.0000",
        ),
        ("half-plane:offset=-0.1", 2, "integrand half-plane:offset=-0.1: offset=-0.1 leaves none of the box"),
        ("steps:values=1;a", 1, "integrand steps:values=1;a: value 2 is \"a\"; expected a number"),
        ("steps:values=1;inf", 1, "integrand steps:values=1;inf: value 2 is \"inf\""),
        (
            "checker:cells=2.5",
            2,
            "integrand checker:cells=2.5: cells=2.5: cells of checker is a whole number from 1 to 4096 (default 4)",
        ),
        ("image", 2, "integrand image: image needs file=the path of a file"),
        ("formula", 2, "integrand formula: formula needs an expression of x, y and z"),
        ("formula:x +* y", 2, "integrand formula:x +* y: character 4 (*): expected a number"),
        ("formula:x*z", 2, "integrand formula:x*z: character 3 (z): there is no z in 2D"),
        (
            "formula:1/x",
            2,
            "integrand formula:1/x: it is infinite at x = 0, y = 0; expected an expression that is finite on [0, 1)^2",
        ),
        (
            "formula:1e155*x",
            2,
            "integrand formula:1e155*x: the integral of its square is inf: the squares of variances of it are no numbers",
        ),
        (
            "formula:1e-200*x",
            1,
            "integrand formula:1e-200*x: the integral of its square is 0e0: the squares of variances of it are no numbers",
        ),
        ("steps:values=1;1e200", 1, "integrand steps:values=1;1e200: the integral of its square is inf:"),
        ("formula:1/(x-0.5)", 1, "integrand formula:1/(x-0.5): it is infinite at x = 0.5;"),
        ("formula:ln(x-0.5)", 1, "integrand formula:ln(x-0.5): it is no number at x = 0;"),
        ("formula:sqrt(x-2*y)", 2, "integrand formula:sqrt(x-2*y): it is no number at x = 0, y = "),
        ("formula:1/(x-0.3)^2", 1, "integrand formula:1/(x-0.3)^2: it is infinite at x = 0.3;"),
        (
            "formula:1/abs(x-0.6*y-0.12345678901)^0.5",
            2,
            "integrand formula:1/abs(x-0.6*y-0.12345678901)^0.5: the integral of it or of its square does not converge",
        ),
    ] {
        match Integrand::new(spec, dim) {
            Err(error) if error.to_string().starts_with(message) => {}
            other => wrong.push(format!("{spec}: {other:?}")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Whatever the size of a function its integrals are as good.
#[test]
fn integrals_of_a_formula_do_not_know_its_size() {
    let of = |text: &str| {
        let f = Integrand::new(text, 1).unwrap();
        (f.integral(), f.square_integral(), f.integral_error())
    };
    let (one, small, large) = (of("formula:sin(300*x)"), of("formula:1e-9*sin(300*x)"), of("formula:1e9*sin(300*x)"));
    let exact = 0.5 - (600f64).sin() / 1200.0;
    assert!((one.1 - exact).abs() < 1e-12, "{}", one.1);
    for (found, scale) in [(small, 1e-9), (large, 1e9)] {
        assert!((found.0 / scale - one.0).abs() < 1e-12, "{scale}: {}", found.0);
        assert!((found.1 / (scale * scale) - exact).abs() < 1e-12, "{scale}: {}", found.1);
        assert!(found.2 < 1e-10 * scale.max(scale * scale), "{scale}: {}", found.2);
    }
}

#[test]
fn every_line_of_the_registry_can_be_made() {
    for entry in pairwave::integrand::registry() {
        assert!(!entry.formulas.is_empty() && !entry.source.is_empty() && !entry.summary.is_empty(), "{}", entry.name);
        for dim in entry.dims.clone() {
            for name in std::iter::once(entry.name).chain(entry.aliases.iter().copied()) {
                if !entry.needs_file() {
                    let f = made(if entry.example.is_empty() { name } else { entry.example }, dim);
                    assert!(f.variance() > 0.0 && f.entry().name == entry.name, "{f:?}");
                    assert_eq!(entry.closed, f.coefficient_error() == 0.0);
                }
            }
        }
    }
}

/// The page says of each what the registry says.
#[test]
fn the_page_holds_every_line() {
    let page = include_str!("../../../docs/integrands.md");
    for entry in pairwave::integrand::registry() {
        assert!(page.contains(&format!("\n### {}\n", entry.name)), "{} is missing", entry.name);
        for text in [entry.summary, entry.formulas, entry.source] {
            assert!(page.contains(text), "{}: {text} is missing", entry.name);
        }
        for p in entry.parameters {
            assert!(
                page.contains(&format!("`{}` | {} | {} |", p.shown(), p.help, p.takes)),
                "{}: {}",
                entry.name,
                p.shown()
            );
        }
    }
}
