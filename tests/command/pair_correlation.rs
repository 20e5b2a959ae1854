//! g(r), K and their kernels end to end, against counts of independent programs.

use crate::common::gpu_tests_skipped;
use crate::shared::{Scratch, column, csv, summary};
use std::path::Path;

/// Ordered pair counts of an independent program (freud's points, recounted in float64), on all three devices.
#[test]
fn counts_of_an_independent_program() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let expected = csv(&data.join("jittered3d_n2744_counts.csv"));
    let unordered: Vec<u64> = column(&expected, "unordered_pairs_f64");
    let scratch = Scratch::new();
    std::fs::copy(data.join("jittered3d_n2744.npy"), scratch.path("points.npy")).unwrap();
    let gpu = if gpu_tests_skipped("counts of an independent program") { None } else { Some("gpu") };
    for device in ["cpu", "reference"].into_iter().chain(gpu) {
        let out = format!("out-{device}");
        scratch.ok(&format!("analyze points.npy --stats pcf --r-max 0.3 --bins 100 --device {device} --out {out}"));
        let table = csv(&scratch.path(&out).join("pcf.csv"));
        assert_eq!(table.0, "r_lo,r,r_hi,count,g,g_se");
        let counts: Vec<u64> = column(&table, "count");
        assert!(counts.iter().eq(unordered.iter().map(|c| 2 * c).collect::<Vec<_>>().iter()), "on {device}");
    }
}

/// Kernel estimates summed by an independent program in float64, on cpu and gpu, at r chosen by the edges of bins.
#[test]
fn kernel_estimates_of_an_independent_program() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let expected = csv(&data.join("swedishpines_pcf.csv"));
    let r: Vec<f64> = column(&expected, "r");
    let scratch = Scratch::new();
    std::fs::copy(data.join("swedishpines.csv"), scratch.path("pines.csv")).unwrap();
    // Bins centred on multiples of r / 8: every eighth is in the table.
    let step = r[0] / 8.0;
    let edges: Vec<String> = (0..=256).map(|k| (step * (f64::from(k) + 0.5)).to_string()).collect();
    scratch.file("edges.txt", &edges.join("\n"));
    let gpu = if gpu_tests_skipped("kernel estimates of an independent program") { None } else { Some("gpu") };
    for device in ["cpu", "reference"].into_iter().chain(gpu) {
        for kernel in ["epanechnikov", "gaussian"] {
            for (name, flags) in [
                ("trans", ""),
                ("trans_divisor_d", "--divisor d --exact-kernel"),
                ("un", "--correction none --divisor r"),
            ] {
                let window = "--window 0,96,0,100 --stats pcf --edges edges.txt --force --out out";
                scratch.ok(&format!(
                    "analyze pines.csv {window} --device {device} --kernel {kernel} --bandwidth 0.78 {flags}"
                ));
                let table = csv(&scratch.path("out/pcf.csv"));
                let (at, g): (Vec<f64>, Vec<f64>) = (column(&table, "r"), column(&table, "g_kernel"));
                let truth: Vec<f64> = column(&expected, &format!("{kernel}_{name}"));
                let scale = truth.iter().fold(1.0, |m: f64, &g| m.max(g));
                for (k, (r, g0)) in r.iter().zip(&truth).enumerate() {
                    assert!((at[8 * k + 7] - r).abs() < 1e-12 * r);
                    let error = (g[8 * k + 7] - g0).abs() / scale;
                    assert!(error < 1e-9, "{device}, {kernel}_{name} at {r}: off by {error:e}");
                }
            }
        }
    }
}

#[test]
fn bandwidths_and_methods_reach_the_summary() {
    let scratch = Scratch::new();
    let thomas = "analyze --sampler thomas -n 150 -k 3 --stats pcf --bins 40 --device cpu --kernel epanechnikov";
    let plan = scratch.ok(&format!("{thomas} --bandwidth lscv --envelope 9 --explain"));
    for fact in ["cross-validation", "direct sum", "kernel values", "envelope: 9 simulations"] {
        assert!(plan.contains(fact), "{fact} is missing from\n{plan}");
    }
    let huge =
        "analyze --sampler random -n 200000 --stats pcf --r-max 0.4 --kernel gaussian --bandwidth 0.005 --explain";
    assert!(scratch.ok(huge).contains("fine bins"));
    assert!(scratch.ok(&format!("{huge} --exact-kernel")).contains("direct sum in f64"));

    scratch.ok(&format!("{thomas} --bandwidth lscv --out lscv"));
    let json = summary(&scratch.path("lscv"));
    let kernel = &json["pair_correlation"]["kernel"];
    assert_eq!(json["parameters"]["bandwidth"], "lscv");
    assert_eq!((kernel["method"].as_str(), kernel["errors"].as_str()), (Some("direct"), Some("across-realizations")));
    let found = &kernel["cross_validation"];
    assert_eq!(found["bandwidth"], kernel["bandwidth"]);
    let (b, lo, hi) = (&found["bandwidth"], &found["range"][0], &found["range"][1]);
    assert!(lo.as_f64() <= b.as_f64() && b.as_f64() <= hi.as_f64() && found["score"].is_f64(), "{found}");

    scratch.ok(&format!("{thomas} --bandwidth 0.02 --out given"));
    let json = summary(&scratch.path("given"));
    assert_eq!(
        (&json["parameters"]["bandwidth"], &json["pair_correlation"]["kernel"]["bandwidth"]),
        (&0.02.into(), &0.02.into())
    );
    assert!(json["pair_correlation"]["kernel"]["cross_validation"].is_null());
}

#[test]
fn k_alone_writes_no_g_and_classes_write_their_own() {
    let scratch = Scratch::new();
    let points: String =
        (0..40).map(|j| format!("0.{:02},0.{:02},{}\n", j * 37 % 100, j * 61 % 100, j % 2 + 1)).collect();
    scratch.file("trees.csv", &format!("x,y,kind\n{points}"));
    scratch.ok("analyze trees.csv --window 0,1,0,1 --stats k-function --r-max 0.25 --bins 10 --device cpu --out k");
    let files = std::fs::read_dir(scratch.path("k")).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap());
    let mut files: Vec<_> = files.collect();
    files.sort();
    assert_eq!(files, ["k_function.csv", "k_function.svg", "points.svg", "report.html", "run.toml", "summary.json"]);
    let common = "--window 0,1,0,1 --stats pcf,k-function --r-max 0.25 --bins 10 --device cpu";
    let said = scratch.ok(&format!("analyze trees.csv {common} --class-column kind --out both"));
    assert!(said.contains("g of 1 and 2: "), "{said}");
    let k = |dir: &str| std::fs::read(scratch.path(dir).join("k_function.csv")).unwrap();
    assert!(k("k") == k("both"), "one pass counts for g and for K");
    let (all, cross) = (csv(&scratch.path("both/pcf.csv")), csv(&scratch.path("both/pcf_cross.csv")));
    let sum = |name: &str| column::<u64>(&cross, name).iter().sum::<u64>();
    let whole: u64 = column::<u64>(&all, "count").iter().sum();
    assert_eq!(sum("count_1_1") + sum("count_2_2") + 2 * sum("count_1_2"), whole, "every pair is of some kind");
    // K alone has its classes too, and the same ones.
    let alone = "--window 0,1,0,1 --stats k-function --r-max 0.25 --bins 10 --device cpu --class-column kind";
    let said = scratch.ok(&format!("analyze trees.csv {alone} --out cross"));
    assert!(said.contains("L of 1 and 2: "), "{said}");
    let of_two = |dir: &str| std::fs::read(scratch.path(dir).join("k_function_cross.csv")).unwrap();
    assert!(of_two("cross") == of_two("both") && !scratch.path("cross").join("pcf_cross.csv").exists());
    // So have neighbours.
    let near = "--window 0,1,0,1 --stats neighbors --device cpu --class-column kind";
    scratch.ok(&format!("analyze trees.csv {near} --out near"));
    let near = csv(&scratch.path("near/neighbor_functions_cross.csv"));
    let g = column::<String>(&near, "g_function_1_2");
    assert_eq!((g.len(), g[0].as_str()), (257, "0.0"));
    assert!(column::<String>(&near, "f_function_2") != column::<String>(&near, "f_function_1"));
    // Classes by number, in the other order: the same g between them.
    scratch.ok(&format!("analyze trees.csv {common} --class-column 3 --classes 2,1 --out turned"));
    let turned = csv(&scratch.path("turned/pcf_cross.csv"));
    assert_eq!(column::<String>(&turned, "g_2_1"), column::<String>(&cross, "g_1_2"));
    assert_eq!(column::<String>(&turned, "g_2_2"), column::<String>(&cross, "g_2_2"));
    // Weights that are all alike, and a warning that P does not know them.
    scratch.file("sizes.txt", &points.replace(",1\n", ",4\n").replace(",2\n", ",4\n"));
    let weighted = "--weight-column 3 --stats pcf,neighbors";
    scratch
        .ok(&format!("analyze sizes.txt --window 0,1,0,1 --r-max 0.25 --bins 10 --device cpu {weighted} --out sizes"));
    let sizes = csv(&scratch.path("sizes/pcf.csv"));
    for (weighted, plain) in column::<f64>(&sizes, "g").iter().zip(column::<f64>(&all, "g")) {
        assert!((weighted - plain).abs() < 1e-8 * (1.0 + plain), "{weighted}, not {plain}");
    }
    assert!(
        summary(&scratch.path("sizes"))["warnings"].to_string().contains("weights of points enter g(r), K and P only")
    );
    // Nor do they change what deep points see.
    let deep = "--window 0,1,0,1 --r-max 0.2 --bins 5 --correction border --stats pcf,k-function";
    scratch.ok(&format!("analyze sizes.txt --columns 1,2 {deep} --device cpu --out deep"));
    for device in ["reference", "cpu"] {
        scratch.ok(&format!("analyze sizes.txt {deep} --weight-column 3 --device {device} --out deep-{device}"));
        for (file, name) in [("pcf.csv", "g"), ("k_function.csv", "k")] {
            let of = |dir: &str| column::<f64>(&csv(&scratch.path(dir).join(file)), name);
            let (plain, weighted) = (of("deep"), of(&format!("deep-{device}")));
            assert!(plain.iter().any(|&v| v > 0.0));
            for (weighted, plain) in weighted.iter().zip(plain) {
                assert!((weighted - plain).abs() < 1e-8 * (1.0 + plain), "{device}, {name}: {weighted}, not {plain}");
            }
        }
    }
    // To half the diagonal of a torus: every pair.
    scratch.ok("analyze sizes.txt --weight-column 3 --r-max 0.7071067811865476 --beyond-half --device cpu --out far");
    let far = csv(&scratch.path("far/pcf.csv"));
    assert_eq!(column::<u64>(&far, "count").iter().sum::<u64>(), 40 * 39);
}
