//! g of the vector end to end, against counts of an independent program.

use crate::common::gpu_tests_skipped;
use crate::shared::{Scratch, csv, npy, summary};
use std::path::Path;

/// Ordered pairs per cell of lags of an independent program (NumPy), on all three devices, and g from them.
#[test]
fn lag_counts_of_an_independent_program() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let text = std::fs::read_to_string(data.join("poisson2d_n500_lags.csv")).unwrap();
    let expected: Vec<u64> = text.split([',', '\n']).filter(|c| !c.is_empty()).map(|c| c.parse().unwrap()).collect();
    let scratch = Scratch::new();
    std::fs::copy(data.join("poisson2d_n500.npy"), scratch.path("points.npy")).unwrap();
    let gpu = if gpu_tests_skipped("lag counts of an independent program") { None } else { Some("gpu") };
    for device in ["cpu", "reference"].into_iter().chain(gpu) {
        let out = format!("out-{device}");
        scratch.ok(&format!(
            "analyze points.npy --stats pcf-vector --lag-bins 21 --lag-max 0.45 --device {device} --out {out}"
        ));
        let file = std::fs::File::open(scratch.path(&out).join("pcf_vector_counts.npy")).unwrap();
        let file = npyz::NpyFile::new(std::io::BufReader::new(file)).unwrap();
        assert_eq!(file.shape(), [21, 21]);
        let counts = file.into_vec::<u64>().unwrap();
        assert_eq!(counts, expected, "on {device}");
        let (_, g) = npy(&scratch.path(&out).join("pcf_vector.npy"));
        let area = (0.9f64 / 21.0).powi(2);
        assert!(g.iter().zip(&counts).all(|(g, &c)| (g - c as f64 / (500.0 * 499.0 * area)).abs() < 1e-12));
    }
}

#[test]
fn vector_g_on_its_own_and_with_everything() {
    let scratch = Scratch::new();
    let said = scratch.ok(
        "analyze --sampler jittered -n 64 -k 3 --stats pcf-vector --lag-bins 16 --lag-rings 0.2,0.3 --device cpu --out own",
    );
    assert!(said.contains("g(h): 16 x 16 cells of lags, 12096 ordered pairs"), "{said}");
    let angular = csv(&scratch.path("own/pcf_angular.csv"));
    assert_eq!(angular.0, "r_lo,r,r_hi,theta_lo,theta,theta_hi,cells,count,g,g_se");
    let json = summary(&scratch.path("own"));
    assert_eq!(json["vector_correlation"]["rings"], serde_json::json!([0.2, 0.3]));
    assert_eq!(json["vector_correlation"]["ordered_pairs"], 3 * 64 * 63);
    let plan =
        scratch.ok("analyze --sampler random -n 100 --dim 3 --stats pcf-vector --lag-bins 20 --device cpu --explain");
    assert!(plan.contains("lag_counts: ") && plan.contains("20 x 20 x 20 bins over lags [-0.5, 0.5) x"), "{plan}");
    // An odd number of cells as far as neighbours are seen, or all lags.
    let plan = |more: &str| {
        scratch.ok(&format!("analyze --sampler random -n 1024 --stats pcf-vector {more} --device cpu --explain"))
    };
    let usual = plan("");
    assert!(usual.contains("65 x 65 bins over lags [-0.1343") && !usual.contains("[-0.5, 0.5)"), "{usual}");
    let whole = plan("--lag-max whole");
    assert!(whole.contains("65 x 65 bins over lags [-0.5, 0.5) x [-0.5, 0.5)"), "{whole}");
    // In a window with another correction of g(r) the vector g keeps its own.
    scratch.file("w.csv", "0.1,0.1\n0.4,0.2\n0.3,0.9\n0.8,0.8\n");
    scratch.ok("analyze w.csv --window 0,1,0,1 --stats pcf,pcf-vector --correction border --lag-bins 4 --explain");
    scratch.ok("analyze w.csv --window 0,1,0,1 --stats pcf,pcf-vector --lag-bins 4 --device cpu --out w");
    assert_eq!(summary(&scratch.path("w"))["vector_correlation"]["correction"], "translation");
    for threads in [1, 3] {
        scratch.ok(&format!(
            "analyze --sampler thomas -n 80 -k 35 --stats pcf-vector --device cpu --threads {threads} --out t{threads}"
        ));
    }
    for file in ["pcf_vector.npy", "pcf_vector_se.npy", "pcf_vector_counts.npy", "pcf_vector.png", "pcf_angular.csv"] {
        let bytes = |t: u32| std::fs::read(scratch.path(&format!("t{t}")).join(file)).unwrap();
        assert!(bytes(1) == bytes(3), "{file}");
    }
}

/// Of a lattice g(h) has the symmetries of the square, whatever lags are asked for: no lag of it lies on an edge.
#[test]
fn g_of_a_lattice_is_symmetric() {
    let scratch = Scratch::new();
    for (name, more) in [("usual", ""), ("whole", "--lag-max whole")] {
        scratch.ok(&format!("analyze --sampler grid -n 1024 --stats pcf-vector {more} --device cpu --out {name}"));
        let (shape, g) = npy(&scratch.path(name).join("pcf_vector.npy"));
        assert_eq!(shape, [65, 65]);
        let at = |x: usize, y: usize| g[65 * x + y];
        assert!((0..65 * 65).all(|k| {
            let (x, y) = (k / 65, k % 65);
            let half = name == "whole" && (x % 64 == 0 || y % 64 == 0);
            half || (at(x, y) == at(64 - x, y) && at(x, y) == at(y, x))
        }));
        assert_eq!(at(32, 32), 0.0, "lag 0 is the middle of a cell");
        assert!(g.iter().any(|g| *g > 1.0));
    }
}
