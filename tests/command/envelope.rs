//! Envelopes end to end.

use crate::shared::{Scratch, csv, summary};

#[test]
fn envelopes_tell_random_from_jittered() {
    let scratch = Scratch::new();
    let p = |dir: &str, curve: usize| summary(&scratch.path(dir))["envelope"]["curves"][curve]["p"].as_f64().unwrap();
    let flags = "--stats pcf --bins 40 --device cpu --kernel epanechnikov --envelope 39";
    scratch.ok(&format!("analyze --sampler random -n 64 -k 2 --seed 5 {flags} --out random"));
    scratch.ok(&format!("analyze --sampler jittered -n 64 -k 2 --seed 5 {flags} --out jittered"));
    for curve in [0, 1] {
        assert_eq!(p("jittered", curve), 1.0 / 40.0, "the smallest there is");
        assert!(p("random", curve) > 0.05);
    }
    let table = csv(&scratch.path("random/envelope.csv"));
    assert_eq!(table.0, "curve,r,observed,lo,hi,global_lo,global_hi");
    assert_eq!(table.1.len(), 80, "g and g_kernel in 40 bins");
    let [lo, g, hi] = ["global_lo", "observed", "global_hi"].map(|name| {
        let k = table.0.split(',').position(|h| h == name).unwrap();
        table.1[..40].iter().map(|row| row[k].parse::<f64>().unwrap()).collect::<Vec<_>>()
    });
    assert!((0..40).all(|k| lo[k] <= g[k] && g[k] <= hi[k]), "inside, as p says");
    let page = std::fs::read_to_string(scratch.path("jittered/report.html")).unwrap();
    assert!(page.contains("differs from randomness at the 5 % level"));

    // Every other curve, beside its own figure, and G tells a grid with jitter from randomness.
    let flags = "--stats k-function,neighbors --bins 40 --device cpu --envelope 39";
    scratch.ok(&format!("analyze --sampler jittered -n 64 -k 2 --seed 5 {flags} --out others"));
    let curves: Vec<_> = csv(&scratch.path("others/envelope.csv")).1.into_iter().map(|row| row[0].clone()).collect();
    let count = |name: &str| curves.iter().filter(|c| *c == name).count();
    assert_eq!(["k", "l_minus_r", "neighbor_g", "neighbor_f"].map(count), [40, 40, 41, 41]);
    assert!((0..4).all(|curve| p("others", curve) <= 0.05));
    let page = std::fs::read_to_string(scratch.path("others/report.html")).unwrap();
    for name in ["<i>K</i>", "<i>L</i> − <i>r</i>", "<i>G</i>", "<i>F</i>"] {
        assert!(page.contains(&format!("{name} differs from randomness at the 5 % level")), "{name}");
    }
    assert!(!page.contains("the smoothed"), "nothing was smoothed");
    for picture in ["k_function.svg", "neighbor_functions.svg"] {
        let svg = std::fs::read_to_string(scratch.path(&format!("others/{picture}"))).unwrap();
        assert!(svg.contains("random, global"), "{picture}");
    }

    // A window, points in number drawn, and the same simulations every time.
    let points: Vec<String> =
        (0..50).map(|i| format!("{},{}", 7 + (i * 13) % 50, -2.0 + f64::from(i) / 50.0)).collect();
    scratch.file("window.csv", &points.join("\n"));
    for out in ["a", "b"] {
        scratch.ok(&format!("analyze window.csv --window 7,57,-2,-1 --r-max 0.5 {flags} --out {out}"));
    }
    let text = |dir: &str| std::fs::read_to_string(scratch.path(dir).join("envelope.csv")).unwrap();
    assert_eq!(text("a"), text("b"));
}

#[test]
fn simulations_may_be_given() {
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.path("simulations")).unwrap();
    let sample = |what: &str| scratch.ok(&format!("sample {what}"));
    sample("jittered -n 64 -k 40 --seed 1 --out simulations/a.npy");
    sample("jittered -n 64 -k 2 --seed 8 --out jittered.npy");
    sample("random -n 64 -k 2 --seed 9 --out random.npy");
    let flags = "--stats pcf,neighbors --bins 20 --device cpu --envelope-from simulations";
    let p = |dir: &str, curve: usize| summary(&scratch.path(dir))["envelope"]["curves"][curve]["p"].as_f64().unwrap();
    // Two realizations, so that each simulation has two: 20 of them.
    scratch.ok(&format!("analyze jittered.npy {flags} --out like"));
    scratch.ok(&format!("analyze random.npy {flags} --out unlike"));
    let envelope = &summary(&scratch.path("like"))["envelope"];
    assert_eq!((envelope["simulations"].as_u64(), envelope["given"].as_str()), (Some(20), Some("simulations")));
    for curve in [0, 1] {
        assert!(p("like", curve) > 1.0 / 21.0 && p("unlike", curve) == 1.0 / 21.0, "curve {curve}");
    }
    let page = std::fs::read_to_string(scratch.path("unlike/report.html")).unwrap();
    assert!(page.contains("20 simulations given (simulations)") && page.contains("differs from them at the 5 % level"));
    let svg = std::fs::read_to_string(scratch.path("unlike/pcf.svg")).unwrap();
    assert!(svg.contains("simulated, global"));
    // The bytes of the simulations are what counts: a simulation is compared with itself.
    scratch.ok("analyze simulations/a.npy --stats pcf --bins 20 --device cpu --envelope-from simulations --out own");
    let rows = csv(&scratch.path("own/envelope.csv")).1;
    assert!(rows.iter().all(|row| row[2] == row[3] && row[3] == row[4]), "one simulation, which is the data");
    let said = summary(&scratch.path("own"))["warnings"].to_string();
    assert!(said.contains("no p-value of 1 simulations is below 0.50"), "{said}");
}
