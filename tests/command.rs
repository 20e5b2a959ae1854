//! The commands end to end, on files: what a user types, what appears, what is said when it is wrong. Trusts the
//! library's own tests for the numbers; checks that the right ones reach the files.

mod common;

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;
use clap::Args;
use pairwave::request::{Request, shell_words};

/// A fresh directory per test, removed at its end.
struct Scratch(tempfile::TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, name: &str, content: &str) -> PathBuf {
        std::fs::write(self.path(name), content).unwrap();
        self.path(name)
    }

    fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pairwave"));
        // Mesa complains on stderr without one.
        command.current_dir(self.0.path()).env("XDG_RUNTIME_DIR", self.0.path());
        command
    }

    /// Runs pairwave here; arguments are separated by blanks.
    fn run(&self, arguments: &str) -> Output {
        self.command().args(arguments.split_whitespace()).output().unwrap()
    }

    fn ok(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "`pairwave {arguments}` failed: {errors}");
        String::from_utf8(output.stdout).unwrap()
    }
}

/// A CSV file as header and columns of text.
fn csv(path: &Path) -> (String, Vec<Vec<String>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let header = text.lines().next().unwrap().to_string();
    let rows = text.lines().skip(1).map(|l| l.split(',').map(str::to_string).collect()).collect();
    (header, rows)
}

fn column<T: std::str::FromStr>(table: &(String, Vec<Vec<String>>), name: &str) -> Vec<T>
where
    T::Err: std::fmt::Debug,
{
    let k = table.0.split(',').position(|h| h == name).unwrap_or_else(|| panic!("no column {name} in {}", table.0));
    table.1.iter().map(|row| row[k].parse().unwrap()).collect()
}

fn npy(path: &Path) -> (Vec<u64>, Vec<f64>) {
    let file = npyz::NpyFile::new(std::io::BufReader::new(std::fs::File::open(path).unwrap())).unwrap();
    (file.shape().to_vec(), file.into_vec::<f64>().unwrap())
}

fn summary(dir: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(dir.join("summary.json")).unwrap()).unwrap()
}

/// Ordered pair counts of an independent program (freud's points, recounted in float64), on all three devices.
#[test]
fn counts_of_an_independent_program() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let expected = csv(&data.join("jittered3d_n2744_counts.csv"));
    let unordered: Vec<u64> = column(&expected, "unordered_pairs_f64");
    let scratch = Scratch::new();
    std::fs::copy(data.join("jittered3d_n2744.npy"), scratch.path("points.npy")).unwrap();
    let gpu = if common::gpu_tests_skipped("counts of an independent program") { None } else { Some("gpu") };
    for device in ["cpu", "reference"].into_iter().chain(gpu) {
        let out = format!("out-{device}");
        scratch.ok(&format!("analyze points.npy --stats pcf --r-max 0.3 --bins 100 --device {device} --out {out}"));
        let table = csv(&scratch.path(&out).join("pcf.csv"));
        assert_eq!(table.0, "r_lo,r,r_hi,count,g,g_se");
        let counts: Vec<u64> = column(&table, "count");
        assert!(counts.iter().eq(unordered.iter().map(|c| 2 * c).collect::<Vec<_>>().iter()), "on {device}");
    }
}

/// Ordered pairs per cell of lags of an independent program (NumPy), on all three devices, and g from them.
#[test]
fn lag_counts_of_an_independent_program() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let text = std::fs::read_to_string(data.join("poisson2d_n500_lags.csv")).unwrap();
    let expected: Vec<u64> = text.split([',', '\n']).filter(|c| !c.is_empty()).map(|c| c.parse().unwrap()).collect();
    let scratch = Scratch::new();
    std::fs::copy(data.join("poisson2d_n500.npy"), scratch.path("points.npy")).unwrap();
    let gpu = if common::gpu_tests_skipped("lag counts of an independent program") { None } else { Some("gpu") };
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
    // The cells of all lags are wider than what happens between neighbours.
    let coarse = scratch.run("analyze --sampler random -n 1024 --stats pcf-vector --device cpu --out coarse");
    let hint = "cells of lags are 0.47 closest-packing distances wide: --lag-max 0.134 would show 4 of these distances";
    assert!(String::from_utf8(coarse.stderr).unwrap().contains(hint));
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

#[test]
fn analyze_writes_what_it_promises() {
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler jittered -n 64 -k 20 --seed 3 --kernel epanechnikov --device cpu --out result");
    let dir = scratch.path("result");
    let mut files: Vec<_> =
        std::fs::read_dir(&dir).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    files.sort();
    let expected = [
        "anisotropy.svg",
        "neighbor_functions.csv",
        "neighbor_functions.svg",
        "pcf.csv",
        "pcf.svg",
        "pcf_from_spectrum.csv",
        "points.svg",
        "report.html",
        "spectrum.npy",
        "spectrum.png",
        "spectrum_angular.csv",
        "spectrum_angular.svg",
        "spectrum_axes.csv",
        "spectrum_axes.svg",
        "spectrum_from_pcf.csv",
        "spectrum_radial.csv",
        "spectrum_radial.svg",
        "spectrum_se.npy",
        "summary.json",
    ];
    assert_eq!(files, expected);

    let pcf = csv(&dir.join("pcf.csv"));
    assert_eq!(pcf.0, "r_lo,r,r_hi,count,g,g_se,g_kernel,g_kernel_se");
    assert_eq!(pcf.1.len(), 256);
    let (lo, r, hi): (Vec<f64>, Vec<f64>, Vec<f64>) = (column(&pcf, "r_lo"), column(&pcf, "r"), column(&pcf, "r_hi"));
    assert!(lo.iter().zip(&r).zip(&hi).all(|((lo, r), hi)| lo < r && r < hi) && lo[1..] == hi[..255]);
    assert_eq!(hi[255], 0.5, "8 closest-packing distances of 64 points exceed half the torus");
    let (count, g): (Vec<u64>, Vec<f64>) = (column(&pcf, "count"), column(&pcf, "g"));
    let ring = std::f64::consts::PI * (hi[200] * hi[200] - lo[200] * lo[200]);
    assert!((g[200] - count[200] as f64 / (20.0 * 64.0 * 63.0 * ring)).abs() < 1e-12);

    let (shape, p) = npy(&dir.join("spectrum.npy"));
    assert_eq!(shape, [81, 81], "F = ceil(5 sqrt(64)) = 40");
    assert_eq!(p[40 * 81 + 40], 64.0, "DC is n");
    assert!(p.iter().eq(p.iter().rev()), "P(-m) = P(m)");
    assert_eq!(npy(&dir.join("spectrum_se.npy")).0, shape);

    let radial = csv(&dir.join("spectrum_radial.csv"));
    let named = "nu_lo,nu,nu_hi,modes,p,p_se,anisotropy_db,anisotropy_reference_db";
    assert!(radial.0.starts_with(named), "{}", radial.0);
    assert_eq!(radial.1.len(), 40);
    assert_eq!(column::<u64>(&radial, "modes")[0], 8, "DC is in no ring");
    let mean = (0..81 * 81)
        .filter(|i| {
            let (a, b) = (i / 81 - 40, i % 81 - 40);
            let m = f64::from(a * a + b * b).sqrt();
            (4.5..5.5).contains(&m)
        })
        .map(|i| p[i as usize])
        .sum::<f64>()
        / column::<f64>(&radial, "modes")[4];
    assert!((column::<f64>(&radial, "p")[4] - mean).abs() < 1e-9);

    let json = summary(&dir);
    let text = json.to_string();
    for fact in ["\"cpu\"", "across-realizations", "jittered"] {
        assert!(text.contains(fact), "summary.json lacks {fact}: {text}");
    }
    let html = std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(!html.contains("src=\"http") && !html.contains("href=\"http"), "the page is self-contained");
}

#[test]
fn the_same_request_gives_the_same_bytes_on_any_number_of_threads() {
    let scratch = Scratch::new();
    for threads in [1, 2, 3] {
        scratch.ok(&format!("analyze --sampler thomas -n 80 -k 35 --device cpu --threads {threads} --out t{threads}"));
    }
    for file in ["pcf.csv", "spectrum_radial.csv", "spectrum.npy", "spectrum_se.npy"] {
        let bytes = |t: u32| std::fs::read(scratch.path(&format!("t{t}")).join(file)).unwrap();
        assert!(bytes(1) == bytes(2) && bytes(1) == bytes(3), "{file}");
    }
}

#[test]
fn a_sampled_file_gives_what_the_sampler_gives() {
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler random -n 50 -k 5 --seed 9 --device cpu --out direct");
    for format in ["csv", "txt", "npy", "npz", "bin"] {
        scratch.ok(&format!("sample random -n 50 -k 5 --seed 9 --out points.{format}"));
        scratch.ok(&format!("analyze points.{format} --device cpu --out {format}"));
        for file in ["pcf.csv", "spectrum_radial.csv", "spectrum.npy"] {
            let bytes = |d: &str| std::fs::read(scratch.path(d).join(file)).unwrap();
            assert!(bytes("direct") == bytes(format), "{file} by way of {format}");
        }
    }
}

#[test]
fn many_small_realizations_stay_within_memory() {
    // 2000 spectra of 64 x 161^2 would be 400 MB; the plan holds a few at a time. Here: it finishes, and P is right.
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler random -n 64 -k 2000 --device cpu --stats spectrum --out many");
    let radial = csv(&scratch.path("many/spectrum_radial.csv"));
    for (p, se) in column::<f64>(&radial, "p").iter().zip(column::<f64>(&radial, "p_se")) {
        assert!((p - 1.0).abs() < 6.0 * se, "P = {p} +- {se}");
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
    let gpu = if common::gpu_tests_skipped("kernel estimates of an independent program") { None } else { Some("gpu") };
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
    assert_eq!((kernel["road"].as_str(), kernel["errors"].as_str()), (Some("direct"), Some("across-realizations")));
    let found = &kernel["cross_validation"];
    assert_eq!(found["bandwidth"], kernel["bandwidth"]);
    let (b, lo, hi) = (&found["bandwidth"], &found["range"][0], &found["range"][1]);
    assert!(lo.as_f64() <= b.as_f64() && b.as_f64() <= hi.as_f64() && found["score"].is_f64(), "{found}");

    scratch.ok(&format!("{thomas} --bandwidth 0.02 --out given"));
    let json = summary(&scratch.path("given"));
    assert_eq!(
        (&json["parameters"]["bandwidth"], &json["pair_correlation"]["kernel"]["bandwidth"]),
        (&"0.02".into(), &0.02.into())
    );
    assert!(json["pair_correlation"]["kernel"]["cross_validation"].is_null());
}

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
fn explain_prints_the_plan_and_computes_nothing() {
    let scratch = Scratch::new();
    let plan = scratch.ok("analyze --sampler random -n 100000 -k 100 --stats pcf --device cpu --explain");
    for fact in ["pair_counts", "256 bins", "skipped: spectrum (not asked for)", "device: "] {
        assert!(plan.contains(fact), "{fact} is missing from\n{plan}");
    }
}

#[test]
fn samplers_and_devices_are_listed() {
    let scratch = Scratch::new();
    let samplers = scratch.ok("samplers");
    for name in ["random", "grid", "jittered", "poisson-disk", "halton", "thomas", "--param radius"] {
        assert!(samplers.contains(name), "{name} is missing from\n{samplers}");
    }
    assert!(scratch.ok("devices").starts_with("cpu "));
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
    assert_eq!(files, ["k_function.csv", "k_function.svg", "points.svg", "report.html", "summary.json"]);
    let common = "--window 0,1,0,1 --stats pcf,k-function --r-max 0.25 --bins 10 --device cpu";
    let said = scratch.ok(&format!("analyze trees.csv {common} --class-column kind --out both"));
    assert!(said.contains("g of 1 and 2: "), "{said}");
    let k = |dir: &str| std::fs::read(scratch.path(dir).join("k_function.csv")).unwrap();
    assert!(k("k") == k("both"), "one pass counts for g and for K");
    let (all, cross) = (csv(&scratch.path("both/pcf.csv")), csv(&scratch.path("both/pcf_cross.csv")));
    let sum = |name: &str| column::<u64>(&cross, name).iter().sum::<u64>();
    let whole: u64 = column::<u64>(&all, "count").iter().sum();
    assert_eq!(sum("count_aa") + sum("count_bb") + 2 * sum("count_ab"), whole, "every pair is of some kind");
    // Classes by number, in the other order: the same g between them.
    scratch.ok(&format!("analyze trees.csv {common} --class-column 3 --classes 2,1 --out turned"));
    let turned = csv(&scratch.path("turned/pcf_cross.csv"));
    assert_eq!(column::<String>(&turned, "g_ab"), column::<String>(&cross, "g_ab"));
    assert_eq!(column::<String>(&turned, "g_aa"), column::<String>(&cross, "g_bb"));
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
    // To half the diagonal of a torus: every pair.
    scratch.ok("analyze sizes.txt --weight-column 3 --r-max 0.7071067811865476 --beyond-half --device cpu --out far");
    let far = csv(&scratch.path("far/pcf.csv"));
    assert_eq!(column::<u64>(&far, "count").iter().sum::<u64>(), 40 * 39);
}

/// Every kind of wrong request or input, with its exact message and exit code. Nothing is written.
#[test]
fn errors_name_the_flag_the_value_and_what_would_be_right() {
    let scratch = Scratch::new();
    scratch.file("ok.csv", "x,y\n0.1,0.2\n0.3,0.9\n0.5,0.5\n");
    scratch.file("one.csv", "0.1 0.2\n");
    scratch.file("outside.txt", "0.1 0.2\n1.5 0.2\n");
    scratch.file("word.txt", "0.1 0.2\n0.3 abc\n");
    scratch.file("three.txt", "0.1 0.2 0.3\n0.4 0.5 0.6\n");
    scratch.file("edges.txt", "0 0.1 0.05\n");
    scratch.file("late.txt", "0.1 0.2\n");
    scratch.file("trees.csv", "x,y,kind,size\n0.1,0.2,oak,1\n0.3,0.9,elm,2\n0.5,0.5,fir,3\n");
    scratch.file("zero.csv", "x,y,size\n0.1,0.2,0\n0.3,0.9,0\n");
    scratch.file("words.txt", "0 0.1\nx\n");
    scratch.file("half.txt", "# m\n1 2\n0 1.5\n");
    scratch.file("huge.csv", "m_x,m_y\n3000000000,1\n");
    scratch.file("nothing.txt", "# m\n\n");
    scratch.file("five.txt", "5\n1 2\n");
    scratch.file("below.csv", "x,y,w\n0.1,0.2,1\n0.3,0.9,-0.5\n");
    let raw = |numbers: &[f64]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    std::fs::write(scratch.path("half.f64"), raw(&[1.0, 2.0, 1.5, 0.0])).unwrap();
    std::fs::write(scratch.path("odd.f64"), raw(&[1.0, 2.0, 3.0])).unwrap();
    std::fs::write(scratch.path("bytes"), [0, 1, 2, 255]).unwrap();
    std::fs::create_dir(scratch.path("taken")).unwrap();
    scratch.file("taken/summary.json", "{}");
    let table: &[(&str, i32, &str)] = &[
        ("analyze missing.csv", 1, "missing.csv: No such file or directory (os error 2)"),
        (
            "analyze outside.txt",
            1,
            "outside.txt:2: x = 1.5 is outside [0, 1); --wrap folds points in, --box sets the sides, --window a window",
        ),
        (
            "analyze outside.txt --window 0,1,0,1",
            1,
            "outside.txt:2: x = 1.5 is outside the window [0, 1]; --window x0,x1,y0,y1 sets it",
        ),
        (
            "analyze one.csv",
            1,
            "points: pcf, pcf-vector, k-function and neighbors need a realization of at least 2 points, the largest has 1; --stats spectrum works with 1",
        ),
        ("analyze ok.csv --window 0,1", 1, "ok.csv: 2 coordinates per point, but --box or --window has 1 axis"),
        ("analyze ok.csv --window 0,1,2", 2, "--window 0,1,2: expected two numbers per axis, x0,x1,y0,y1[,z0,z1]"),
        (
            "analyze ok.csv --window 0,1,1,0",
            2,
            "--window 0,1,1,0: every side must be finite and between 1e-100 and 1e100; expected x0,x1,y0,y1[,z0,z1] with x0 < x1",
        ),
        (
            "analyze ok.csv --domain window",
            2,
            "--domain window: needs --window x0,x1,y0,y1[,z0,z1]: a window is not guessed",
        ),
        (
            "analyze ok.csv --r-max 0.6",
            2,
            "--r-max 0.6: beyond half the shortest side (0.5) a ring does not fit into the torus and g would be under-counted; expected at most 0.5, or --beyond-half, which compares with the part that fits",
        ),
        (
            "analyze ok.csv --r-max 1 --window 0,1,0,1",
            2,
            "--r-max 1: expected less than the shortest side of the window (1): beyond, some directions are never seen",
        ),
        ("analyze ok.csv --r-max 0", 2, "--r-max 0: expected a finite number above 0"),
        ("analyze ok.csv --bins 0", 2, "--bins 0: expected 1 to 1048576"),
        (
            "analyze ok.csv --edges edges.txt",
            2,
            "--edges edges.txt: edges must be finite, at least 0 and strictly increasing; edge 1 is 1e-1, edge 2 is 5e-2",
        ),
        ("analyze ok.csv --edges words.txt", 1, "words.txt:2: `x` is not a number"),
        ("analyze ok.csv --edges nowhere.txt", 1, "nowhere.txt: No such file or directory (os error 2)"),
        ("analyze ok.csv --correction translation", 2, "--correction translation: a torus has no edges; use none"),
        (
            "analyze ok.csv --window -1,1,-1,0.5",
            1,
            "ok.csv:3: y = 0.9 is outside the window [-1, 0.5]; --window x0,x1,y0,y1 sets it",
        ),
        (
            "analyze ok.csv --box 1e-300,1",
            2,
            "--box 1e-300,1: every side must be finite and between 1e-100 and 1e100; expected L1,L2[,L3]",
        ),
        ("analyze ok.csv --r-max -1", 2, "--r-max -1: expected a finite number above 0"),
        ("analyze ok.csv --lag-bins 3", 2, "--lag-bins 3: needs pcf-vector among --stats"),
        ("analyze ok.csv --lag-max 0.1", 2, "--lag-max 0.1: needs pcf-vector among --stats"),
        ("analyze ok.csv --lag-rings 0.1,0.2", 2, "--lag-rings 0.1,0.2: needs pcf-vector among --stats"),
        (
            "analyze ok.csv --stats radial --correction none",
            2,
            "--correction none: needs pcf, k-function or pcf-vector among --stats",
        ),
        ("analyze ok.csv --stats pcf-vector --lag-bins 0", 2, "--lag-bins 0: expected 1 to 1448 bins per axis in 2D"),
        (
            "analyze ok.csv --stats pcf-vector --lag-bins 1449",
            2,
            "--lag-bins 1449: expected 1 to 1448 bins per axis in 2D",
        ),
        (
            "analyze three.txt --stats pcf-vector --lag-bins 129",
            2,
            "--lag-bins 129: expected 1 to 128 bins per axis in 3D",
        ),
        (
            "analyze ok.csv --stats pcf-vector --lag-max 0.6",
            2,
            "--lag-max 0.6: expected a number above 0 and at most half the shortest side (0.5)",
        ),
        (
            "analyze ok.csv --stats pcf-vector --lag-max nan",
            2,
            "--lag-max NaN: expected a number above 0 and at most half the shortest side (0.5)",
        ),
        (
            "analyze ok.csv --stats pcf-vector --lag-rings 0.4999",
            2,
            "--lag-rings 0.4999: rings are two cells wide (0.015625) and fit into the grid of lags: expected more than 0.0078125 and at most 0.4921875",
        ),
        (
            "analyze three.txt --stats pcf-vector --lag-rings 0.1",
            2,
            "--lag-rings 0.1: rings are followed round in 2D, the points have 3 coordinates",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --stats pcf-vector --correction border",
            2,
            "--correction border: the vector g is corrected by the set covariance of the window: use translation, or none",
        ),
        (
            "analyze ok.csv --stats pcf-vector --correction translation",
            2,
            "--correction translation: a torus has no edges; use none",
        ),
        ("analyze ok.csv --stats spectrum --bins 3", 2, "--bins 3: needs pcf or k-function among --stats"),
        (
            "analyze ok.csv --stats pcf --max-frequency 3",
            2,
            "--max-frequency 3: needs spectrum or radial among --stats",
        ),
        (
            "analyze ok.csv --kernel box --bandwidth 0",
            2,
            "--bandwidth 0: expected more than 0 and less than the shortest side (1)",
        ),
        (
            "analyze ok.csv --kernel box --bandwidth NaN",
            2,
            "--bandwidth NaN: expected more than 0 and less than the shortest side (1)",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --kernel box --correction border",
            2,
            "--correction border: a kernel estimate weighs pairs; expected translation, isotropic or none",
        ),
        ("analyze ok.csv --envelope 0", 2, "--envelope 0: expected 1 to 174307 simulations of 770 values each"),
        (
            "analyze ok.csv --stats spectrum --envelope 9",
            2,
            "--envelope 9: needs pcf, k-function or neighbors among --stats",
        ),
        (
            "analyze ok.csv --kernel box --bandwidth 2",
            2,
            "--bandwidth 2: expected more than 0 and less than the shortest side (1)",
        ),
        (
            "analyze ok.csv --max-frequency 1,2,3",
            2,
            "--max-frequency 1,2,3: expected 1 or 2 numbers for points with 2 coordinates",
        ),
        (
            "analyze ok.csv --box 1 --max-frequency 1,2",
            1,
            "ok.csv: 2 coordinates per point, but --box or --window has 1 axis",
        ),
        (
            "analyze --sampler random -n 9 --dim 1 --max-frequency 1,2",
            2,
            "--max-frequency 1,2: expected 1 number for points with 1 coordinate",
        ),
        (
            "analyze --sampler random -n 9 --dim 1 --stats radial --sectors 4",
            2,
            "--sectors 4: directions are followed in 2D, the points are in 1D",
        ),
        ("analyze ok.csv --max-frequency 100000000", 2, "--max-frequency 100000000: expected at most 4194304"),
        (
            "analyze three.txt --max-frequency 2000",
            2,
            "--max-frequency 2000: 64048012001 wave vectors need about 1908 GiB; at most 536870912 are supported (rings alone: --stats radial --ring-directions N)",
        ),
        (
            "analyze ok.csv --r-max 0.8 --beyond-half",
            2,
            "--r-max 0.8: expected at most half the diagonal of the torus (0.7071067811865476): no two points are further apart",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --beyond-half",
            2,
            "--beyond-half (given): is about a torus; a window has its edge correction",
        ),
        (
            "analyze ok.csv --stats k-function --beyond-half --r-max 0.6",
            2,
            "--beyond-half (given): K and L compare with whole balls, which fit up to r = 0.5; expected --stats pcf alone",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --correction isotropic --r-max 0.8",
            2,
            "--r-max 0.8: expected at most half the diagonal of the window (0.7071067811865476): beyond, some points see no circle",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --correction border --r-max 0.5",
            2,
            "--r-max 0.5: expected less than half the shortest side of the window (0.5): no point is further from the border",
        ),
        (
            "analyze three.txt --window 0,1,0,1,0,1 --correction isotropic",
            2,
            "--correction isotropic: the part of a sphere inside a box is not computed; 3D has translation, border and none",
        ),
        (
            "analyze trees.csv --window 0,1,0,1 --correction border --weight-column size",
            2,
            "--correction border: counts points, not weights; expected translation, isotropic or none",
        ),
        (
            "analyze ok.csv --stats k-function --bin-scale log",
            2,
            "--bin-scale log: K counts all pairs closer than r: bins must start at 0, not at 0.0005",
        ),
        (
            "analyze ok.csv --stats k-function --edges late.txt",
            2,
            "--edges late.txt: K counts all pairs closer than r: bins must start at 0, not at 0.1",
        ),
        ("analyze ok.csv --stats k-function --kernel box", 2, "--kernel box: needs pcf among --stats"),
        (
            "analyze trees.csv --stats neighbors --weight-column size",
            2,
            "--weight-column size: needs pcf, k-function, spectrum, radial or covariance among --stats",
        ),
        ("analyze trees.csv --stats k-function --class-column kind", 2, "--class-column kind: needs pcf among --stats"),
        ("analyze trees.csv --class-column kind", 2, "--classes (none): expected two of the 3 classes: oak, elm, fir"),
        (
            "analyze trees.csv --class-column kind --classes oak,ash",
            2,
            "--classes oak,ash: no point is of class ash; there are oak, elm, fir",
        ),
        (
            "analyze trees.csv --class-column kind --classes oak,oak",
            2,
            "--classes oak,oak: expected two different classes",
        ),
        (
            "analyze trees.csv --class-column kind --classes oak",
            2,
            "--classes oak: expected two classes, as in oak,elm",
        ),
        (
            "analyze trees.csv --class-column species",
            1,
            "trees.csv:1: --class-column species: no column of that name; there are x, y, kind, size",
        ),
        ("analyze zero.csv --weight-column 3", 2, "--weight-column 3: all weights are 0"),
        ("analyze ok.csv -n 5", 2, "-n 5: applies to --sampler NAME only, not to point files"),
        ("analyze ok.csv --param mu=3", 2, "--param mu=3: applies to --sampler NAME only, not to point files"),
        ("analyze ok.csv --device 99", 1, "--device 99:"),
        ("analyze ok.csv --threads 100000", 2, "--threads 100000:"),
        ("analyze ok.csv --threads 0", 2, "--threads 0:"),
        (
            "analyze --sampler jitterd -n 64",
            2,
            "--sampler jitterd: no such sampler (did you mean jittered?); expected one of random, grid, jittered, poisson-disk, halton, thomas",
        ),
        ("analyze --sampler jittered -n 65", 2, "-n 65: jittered in 2D needs n = k^2; the nearest are 64 and 81"),
        (
            "analyze ok.csv --stats spectrum --frequencies half.txt",
            1,
            "half.txt:3: m_y = 1.5; expected an integer with magnitude below 2^31: cycles per side of the torus",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies huge.csv",
            1,
            "huge.csv:2: m_x = 3000000000; expected an integer with magnitude below 2^31: cycles per side of the torus",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies three.txt",
            1,
            "three.txt:1: 3 numbers per wave vector, but the points have 2 coordinates",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies nothing.txt",
            1,
            "nothing.txt: no wave vectors: only blank lines and comments",
        ),
        ("analyze ok.csv --stats spectrum --frequencies five.txt", 1, "five.txt:1: announces 5 wave vectors, found 1"),
        (
            "analyze ok.csv --stats spectrum --frequencies half.f64",
            1,
            "half.f64, wave vector 1: m_x = 1.5; expected an integer with magnitude below 2^31: cycles per side of the torus",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies odd.f64",
            1,
            "odd.f64: 24 bytes are not a whole number of f64x2 wave vectors of 16 bytes: 8 left over",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies bytes",
            1,
            "bytes: neither text nor .npy, .npz or UTK .bin (no such header); raw numbers need a name that ends in .f32 or .f64",
        ),
        ("analyze ok.csv --stats spectrum --window 0,1,0,1 --tapers 0", 2, "--tapers 0: expected 1 to 64 per axis"),
        (
            "analyze ok.csv --stats spectrum --window 0,1,0,1 --tapers 2",
            2,
            "--tapers 2: needs --taper sine; Bartlett's taper is one",
        ),
        (
            "analyze below.csv --weight-column w",
            1,
            "below.csv:3: weight -0.5; g and K need weights of at least 0, P does not",
        ),
        (
            "analyze ok.csv --stats spectrum --max-frequency 1 --convention psa",
            2,
            "--max-frequency 1: --convention needs one number for all axes, and at least 2",
        ),
        ("analyze ok.csv --stats covariance --covariance-frequency 0", 2, "--covariance-frequency 0: expected 1 to 54"),
        (
            "analyze ok.csv --stats pcf --frequencies half.txt",
            2,
            "--frequencies half.txt: needs spectrum among --stats",
        ),
        (
            "analyze ok.csv --stats spectrum,radial --frequencies half.txt",
            2,
            "--frequencies half.txt: a list of wave vectors has no rings; expected --stats spectrum without radial",
        ),
        ("analyze ok.csv --stats radial --ring-directions 0", 2, "--ring-directions 0: expected at least 1"),
        (
            "analyze ok.csv --stats spectrum,radial --ring-directions 8",
            2,
            "--ring-directions 8: leaves wave vectors out, which --stats spectrum asks for; expected --stats radial without spectrum",
        ),
        ("analyze --sampler jittered -n 64 -k 0", 2, "-k 0: expected at least 1 realization"),
        (
            "analyze --sampler random -n 64 --domain window",
            2,
            "--domain window: samplers fill a torus; a window needs files",
        ),
        ("analyze --sampler random -n 64 --box 1", 2, "--box 1: expected 2 sides for points with 2 coordinates"),
        ("analyze", 2, "FILES (none): expected point files, or --sampler NAME -n N"),
    ];
    for (arguments, code, message) in table {
        let output = scratch.run(&format!("{arguments} --out result --quiet"));
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(*code), "`{arguments}`: {errors}");
        let exact = if message.ends_with(':') {
            errors.starts_with(&format!("error: {message}"))
        } else {
            errors == format!("error: {message}\n")
        };
        assert!(exact, "`{arguments}` said\n{errors}instead of\nerror: {message}");
        assert!(!scratch.path("result").exists(), "`{arguments}` left something behind");
    }
    // What clap itself refuses: exit code 2, the flag named.
    for (arguments, named) in [
        ("analyze ok.csv", "--out"),
        ("analyze ok.csv --out o --stats pcf,color", "color"),
        ("analyze ok.csv --out o --device tpu", "--device"),
        ("analyze ok.csv --out o --r-max 0.1 --edges edges.txt", "--edges"),
        ("analyze ok.csv --out o --bins many", "--bins"),
        ("analyze --sampler random --out o", "--points"),
        ("sample random -n 5", "--out"),
        ("paint", "paint"),
    ] {
        let output = scratch.run(arguments);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "`{arguments}`: {errors}");
        assert!(errors.contains(named), "`{arguments}` does not name {named}: {errors}");
    }
    // An existing result is not overwritten without --force.
    let output = scratch.run("analyze ok.csv --device cpu --out taken");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(scratch.path("taken/summary.json")).unwrap(), "{}");
    scratch.ok("analyze ok.csv --device cpu --out taken --force");
    assert!(scratch.path("taken/pcf.csv").exists());
}

#[test]
fn quiet_is_silent_and_stdin_is_a_file() {
    let scratch = Scratch::new();
    let output = scratch
        .command()
        .args(["analyze", "-", "--device", "cpu", "--quiet", "--out", "o"])
        .write_stdin("0.1 0.2\n0.3 0.4\n# next\n0.5 0.5\n0.6 0.7\n")
        .output()
        .unwrap();
    assert!(output.status.success() && output.stdout.is_empty() && output.stderr.is_empty(), "{output:?}");
    assert!(std::fs::read_to_string(scratch.path("o/summary.json")).unwrap().contains("2"));
}

/// The smallest inputs: one point, one realization, rings of one pair.
#[test]
fn spectra_of_next_to_nothing() {
    let scratch = Scratch::new();
    scratch.file("one.csv", "0.3,0.4\n");
    scratch.file("zero.csv", "0 0\n3 4\n0 0\n");
    scratch.ok("analyze one.csv --stats spectrum --frequencies zero.csv --device cpu --out list");
    let list = csv(&scratch.path("list/spectrum_list.csv"));
    // P(0) is n wherever the point is; elsewhere the error of an exponential ordinate is its mean.
    for (k, (p, se)) in column::<f64>(&list, "p").into_iter().zip(column::<f64>(&list, "p_se")).enumerate() {
        let expected = if k == 1 { 1.0 } else { 0.0 };
        assert!((p - 1.0).abs() < 1e-12 && (se - expected).abs() < 1e-12, "{p} +- {se}");
    }
    scratch.ok("analyze one.csv --stats spectrum --device cpu --out grid");
    let summary = std::fs::read_to_string(scratch.path("grid/summary.json")).unwrap();
    assert!(summary.contains("\"dc_p\": 1.0,\n    \"dc_p_se\": 0.0"), "{summary}");
    scratch.ok("analyze one.csv --stats spectrum --convention psa --device cpu --out psa");
    let summary = std::fs::read_to_string(scratch.path("psa/summary.json")).unwrap();
    assert!(summary.contains("PSA's route are left out: they need pairs of points"), "{summary}");
    // In one dimension rings are pairs, which the grid holds all.
    let points = "analyze --sampler random -n 50 --dim 1 --stats radial --max-frequency 40 --device cpu";
    scratch.ok(&format!("{points} --out whole"));
    scratch.ok(&format!("{points} --ring-directions 1 --out few"));
    let [whole, few] = ["whole", "few"].map(|name| csv(&scratch.path(&format!("{name}/spectrum_radial.csv"))));
    assert_eq!(whole, few);
}

/// P at the wave vectors of a list is that of the grid, in the order of the list, with its bands; DC has none.
#[test]
fn lists_of_wave_vectors() {
    let scratch = Scratch::new();
    let points = "--sampler jittered -n 64 -k 5 --box 2,1 --stats spectrum --accuracy high --threads 1";
    scratch.file("list.csv", "m_x,m_y # integers\n3,-2\n0 0\n\n-3; 2\n# on\n5.0,1e1\n100000,-99999\n");
    scratch.ok(&format!("analyze {points} --frequencies list.csv --out list"));
    scratch.ok(&format!("analyze {points} --max-frequency 5,10 --out grid"));
    let list = csv(&scratch.path("list/spectrum_list.csv"));
    assert_eq!(list.0, "m_x,m_y,nu_x,nu_y,nu,p,p_se,p_lo,p_hi,p_band");
    assert_eq!(column::<i64>(&list, "m_x"), [3, 0, -3, 5, 100_000]);
    assert_eq!(column::<i64>(&list, "m_y"), [-2, 0, 2, 10, -99_999]);
    assert_eq!(column::<f64>(&list, "nu_x")[..4], [1.5, 0.0, -1.5, 2.5]);
    assert_eq!(column::<f64>(&list, "nu")[0], 2.5);
    let (p, p_se) = (column::<f64>(&list, "p"), column::<f64>(&list, "p_se"));
    for (file, values) in [("grid/spectrum.npy", &p), ("grid/spectrum_se.npy", &p_se)] {
        let (shape, grid) = npy(&scratch.path(file));
        assert_eq!(shape, [11, 21]);
        for (k, m) in [[3, -2], [0, 0], [-3, 2], [5, 10]].into_iter().enumerate() {
            let at = ((m[0] + 5) * 21 + m[1] + 10) as usize;
            assert!(
                (values[k] - grid[at]).abs() <= 1e-10 * (1.0 + grid[at]),
                "{file}, {m:?}: {} {}",
                values[k],
                grid[at]
            );
        }
    }
    // 10 degrees of freedom: 10 / 20.4832 and 10 / 3.24697 (tables of chi-squared).
    for k in [0, 2, 3, 4] {
        let band = [&list.1[k][7], &list.1[k][8]].map(|cell| cell.parse::<f64>().unwrap() / p[k]);
        assert!((band[0] - 0.488_205).abs() < 1e-5 && (band[1] - 3.079_80).abs() < 1e-4, "{band:?}");
    }
    assert_eq!(list.1[1][7..], ["", "", ""]);
    let files: Vec<String> = summary(&scratch.path("list"))["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f.as_str().unwrap().into())
        .collect();
    assert_eq!(files, ["spectrum_list.csv", "points.svg", "report.html", "summary.json"]);

    // A window: cycles per unit length.
    scratch.file("points.csv", "0,10\n1,12\n3.5,13\n");
    scratch.file("nu.txt", "0.125 0\n0.3 -0.7\n");
    scratch.ok("analyze points.csv --window 0,4,10,14 --stats spectrum --frequencies nu.txt --out window");
    let list = csv(&scratch.path("window/spectrum_list.csv"));
    assert_eq!((column::<f64>(&list, "m_x"), column::<f64>(&list, "m_y")), (vec![0.5, 1.2], vec![0.0, -2.8]));
    assert!((column::<f64>(&list, "nu_y")[1] + 0.7).abs() < 1e-15);
}

/// A radial mean from some of the directions is that of the listed members, and says which they are.
#[test]
fn rings_of_some_directions() {
    let scratch = Scratch::new();
    let points = "--sampler jittered -n 100 -k 4 --stats radial --accuracy high";
    let radial = |out: &str, more: &str| {
        scratch.ok(&format!("analyze {points} {more} --out {out}"));
        csv(&scratch.path(out).join("spectrum_radial.csv"))
    };
    let whole = radial("whole", "--max-frequency 12");
    let all = radial("all", "--max-frequency 12 --ring-directions 1000");
    let some = radial("some", "--max-frequency 12 --ring-directions 6");
    assert_eq!(column::<u64>(&whole, "modes"), column::<u64>(&all, "modes"));
    for name in ["p", "p_se", "anisotropy_db"] {
        for (a, b) in column::<f64>(&whole, name).into_iter().zip(column::<f64>(&all, name)) {
            assert!((a - b).abs() <= 1e-9 * a.abs().max(1.0), "{name}: {a} {b}");
        }
    }
    let (modes, independent) = (column::<u64>(&some, "modes"), column::<u64>(&some, "independent_modes"));
    assert_eq!(modes[..2], column::<u64>(&whole, "modes")[..2]);
    assert!(independent.iter().zip(&modes).all(|(i, m)| *i <= 6 && 2 * i == *m), "{modes:?}");
    let radial = &summary(&scratch.path("some"))["radial"];
    assert_eq!(radial["modes"].as_u64().unwrap(), modes.iter().sum::<u64>());
    assert!(radial["directions"].as_str().unwrap().contains("golden ratio"));
    assert_eq!(summary(&scratch.path("whole"))["radial"]["directions"], "all");
    // The grid would be 1.6e9 modes.
    scratch.ok("analyze --sampler random -n 2 --stats radial --max-frequency 20000 --ring-directions 2 --out far");
    assert_eq!(csv(&scratch.path("far/spectrum_radial.csv")).1.len(), 20_000);
}

/// The covariance of amplitudes: the matrix, its errors, a picture and a few numbers; a single realization is told apart.
#[test]
fn covariances_reach_the_files() {
    let scratch = Scratch::new();
    let points = "analyze --sampler jittered -n 64 --dim 2 --stats covariance --covariance-frequency 3";
    scratch.ok(&format!("{points} -k 40 --out many --threads 1"));
    scratch.ok(&format!("{points} -k 40 --out again --threads 3"));
    scratch.ok(&format!("{points} -k 1 --out one"));
    let bytes = |dir: &str, file: &str| std::fs::read(scratch.path(dir).join(file)).unwrap();
    for file in ["covariance.npy", "covariance_se.npy", "covariance.png"] {
        assert!(bytes("many", file) == bytes("again", file), "{file}");
    }
    let header = String::from_utf8_lossy(&bytes("many", "covariance.npy")[..80]).into_owned();
    assert!(header.contains("'<c16'") && header.contains("(49, 49, )"), "{header}");
    let (shape, se) = npy(&scratch.path("many/covariance_se.npy"));
    assert!(shape == [49, 49] && se.iter().all(|x| x.is_finite()));
    let many = summary(&scratch.path("many"));
    let found = &many["covariance"];
    assert_eq!((found["modes"].as_u64(), found["max_frequency"].as_u64()), (Some(49), Some(3)));
    assert!(found["rms_z"].as_f64().unwrap() > 0.0 && found["off_diagonal_share"].as_f64().unwrap() < 1.0);
    assert!(std::fs::read_to_string(scratch.path("many/report.html")).unwrap().contains("Covariance of amplitudes"));
    let one = summary(&scratch.path("one"));
    assert!(one["covariance"]["rms_z"].is_null() && !scratch.path("one/covariance_se.npy").exists());
    assert!(one["warnings"][0].as_str().unwrap().contains("expectation over realizations"));
    let refused = scratch.run(&format!("{points}000 -k 2 --out huge"));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("bytes") && refused.status.code() == Some(2));
}

/// A request goes back to the line it was typed as; together the lines hold every flag and every word a flag takes.
#[test]
fn a_request_is_a_command_line() {
    let lines = [
        "--sampler jittered -n 100 -k 4 --dim 3 --seed 9 --param a=1 --param b=2 --domain torus --box 1,2.5,1e-7 --wrap",
        "--raw f32x2 --weight-column w --class-column=-3 --domain window --window=-1,1,0,2 a.txt - b.txt",
        "--class-column 3 --classes A,B --stats pcf,radial,pcf-vector,k-function,covariance --edges e.txt x.npy",
        "--r-max 0.25 --bins 12 --bin-scale log --beyond-half --lag-bins 8 --lag-max 0.125 --lag-rings 0.1,0.2 x",
        "--kernel gaussian --bandwidth 0.001 --divisor d --exact-kernel --correction border --envelope 19 x",
        "--normalization intensity --max-frequency 3,4 --ring-directions 6 --sectors 4 --covariance-frequency 3 x",
        "--frequencies f.txt --taper sine --tapers 3 --debias none --convention psa --bug-compatible x",
        "--r-max=-1 --bandwidth lscv --kernel box --device 0 --accuracy high --threads 2 -- x -y",
    ];
    let request = |arguments: &[String]| Request::parse(arguments.iter().cloned());
    let words = |line: &str| line.split(' ').map(str::to_string).collect::<Vec<_>>();
    let mut typed = Vec::new();
    for line in lines {
        let asked = request(&words(line)).unwrap();
        let (mut back, mut expected) = (asked.arguments(), words(line));
        assert_eq!(request(&back).unwrap(), asked, "{line}");
        assert_eq!(asked.command(), format!("pairwave analyze {}", back.join(" ")));
        typed.extend(back.iter().map(|word| word.split('=').next().unwrap().to_string()));
        back.sort();
        expected.sort();
        assert_eq!(back, expected);
    }
    for flag in Request::augment_args(clap::Command::new("")).get_arguments() {
        let Some(long) = flag.get_long().map(|long| format!("--{long}")) else { continue };
        let short = flag.get_short().map(|short| format!("-{short}"));
        assert!(typed.iter().any(|word| *word == long || Some(word) == short.as_ref()), "{long} is in no line");
        for value in flag.get_possible_values() {
            let mut line = words("--sampler random -n 2 --kernel box");
            let value = value.get_name();
            let defaults = flag.get_default_values();
            match value {
                // A flag without a value.
                "true" | "false" => continue,
                _ if long == "--kernel" => line[5] = value.into(),
                _ => line.extend([long.clone(), value.into()]),
            }
            let asked = request(&line).unwrap();
            let back = asked.arguments();
            assert_eq!(request(&back).unwrap(), asked);
            assert_eq!(back.contains(&long), defaults != [value], "{long} {value}: {back:?}");
            assert!(defaults == [value] || back.iter().any(|word| word == value), "{long} {value}: {back:?}");
        }
    }

    assert_eq!(Request::default().command(), "pairwave analyze");
    assert_eq!(request(&words("--stats pcf,spectrum,neighbors --device auto")).unwrap(), Request::default());
    assert_eq!(shell_words(["a b", "it's", "", "x=1"]), r"'a b' 'it'\''s' '' x=1");
    for (line, said) in [
        ("--bins 1 --bins", "--bins 1 --bins: a value is required for '--bins <B>' but none was supplied"),
        ("--nonsense", "--nonsense: unexpected argument '--nonsense' found"),
        ("--sampler random", "--sampler random: the following required arguments were not provided: --points <N>"),
        ("--help", "--help: unexpected argument '--help' found"),
    ] {
        let error = request(&words(line)).unwrap_err();
        assert_eq!((error.to_string(), error.exit_code()), (format!("pairwave analyze {said}"), 2));
    }
}
