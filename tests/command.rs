//! The commands end to end, on files: what a user types, what appears, what is said when it is wrong. Trusts the
//! library's own tests for the numbers; checks that the right ones reach the files.

mod common;

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;

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
        "pcf.csv",
        "pcf.svg",
        "points.svg",
        "report.html",
        "spectrum.npy",
        "spectrum.png",
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
    scratch.file("words.txt", "0 0.1\nx\n");
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
            "points: pcf, pcf-vector and neighbors need a realization of at least 2 points, the largest has 1; --stats spectrum works with 1",
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
            "--r-max 0.6: beyond half the shortest side (0.5) a ring does not fit into the torus and g would be under-counted; expected at most 0.5",
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
        ("analyze ok.csv --stats spectrum --bins 3", 2, "--bins 3: needs pcf among --stats"),
        ("analyze ok.csv --lag-bins 3", 2, "--lag-bins 3: needs pcf-vector among --stats"),
        ("analyze ok.csv --lag-max 0.1", 2, "--lag-max 0.1: needs pcf-vector among --stats"),
        ("analyze ok.csv --lag-rings 0.1,0.2", 2, "--lag-rings 0.1,0.2: needs pcf-vector among --stats"),
        (
            "analyze ok.csv --stats radial --correction none",
            2,
            "--correction none: needs pcf or pcf-vector among --stats",
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
            "--lag-rings 0.4999: rings are two cells wide (0.03125) and fit into the grid of lags: expected more than 0.015625 and at most 0.484375",
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
            "analyze ok.csv --kernel box --bandwidth 2",
            2,
            "--bandwidth 2: expected more than 0 and less than the shortest side (1)",
        ),
        (
            "analyze ok.csv --max-frequency 1,2,3",
            2,
            "--max-frequency 1,2,3: expected 1 or 2 numbers for points with 2 coordinates",
        ),
        ("analyze ok.csv --max-frequency 100000000", 2, "--max-frequency 100000000: expected at most 4194304"),
        (
            "analyze three.txt --max-frequency 2000",
            2,
            "--max-frequency 2000,2000,2000: 64048012001 wave vectors need about 1908 GiB; at most 536870912 are supported",
        ),
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
