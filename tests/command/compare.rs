//! Results side by side. Cannot see: whether the level holds for every process; that of a few is in docs/compare.md.

use serde_json::Value;

use crate::shared::{Scratch, table};

const RUN: &str = "--device cpu -n 64 -k 40 --bins 16 --stats pcf,spectrum --integrand disk --quiet";

fn json(scratch: &Scratch, arguments: &str) -> (Option<i32>, Value) {
    let output = scratch.run(&format!("compare {arguments} --json"));
    (output.status.code(), serde_json::from_slice(&output.stdout).unwrap())
}

#[test]
fn equal_processes_agree_and_others_differ() {
    let scratch = Scratch::new();
    scratch.ok(&format!("analyze --sampler jittered --seed 1 {RUN} --out a"));
    scratch.ok(&format!("analyze --sampler jittered --seed 2 {RUN} --out b"));
    scratch.ok(&format!("analyze --sampler random --seed 3 {RUN} --out c"));
    let (code, same) = json(&scratch, "a b");
    assert_eq!((code, &same["differ"]), (Some(0), &Value::Bool(false)), "{same}");
    let (code, other) = json(&scratch, "a b c --out all");
    assert_eq!((code, &other["differ"]), (Some(3), &Value::Bool(true)));
    let columns = other["columns"].as_array().unwrap();
    let of = |with: u64, figure: &str| {
        columns.iter().find(|column| column["with"] == with && column["figure"] == figure).unwrap()
    };
    assert!(of(2, "pcf.g")["p_of_all"].as_f64().unwrap() < 0.01);
    assert!(of(2, "variance.var_spectral")["p_of_all"].as_f64().unwrap() < 0.01);
    assert!(of(1, "pcf.g")["p_of_all"].as_f64().unwrap() > 0.01);
    // The table by hand: z of a row is the difference over the root of the sum of squares.
    let all = table(&scratch.path("all/comparison.csv"));
    let number = |name: &str, row: usize| all[name][row].parse::<f64>().unwrap();
    let row = (0..all["figure"].len())
        .find(|&row| {
            all["figure"][row] == "spectrum_radial.p" && all["result"][row] == "c" && number("other_se", row) > 0.0
        })
        .unwrap();
    let z = (number("other", row) - number("first", row)) / number("first_se", row).hypot(number("other_se", row));
    assert!((z - number("z", row)).abs() < 1e-12, "{z}");
    let radial = table(&scratch.path("c/spectrum_radial.csv"));
    assert_eq!(all["other"][row], radial["p"][0]);
    // What is said where nothing is asked to be quiet, and the code of who is.
    assert!(scratch.ok("compare a b").contains("no difference beyond chance"));
    let quiet = scratch.run("compare a c --quiet");
    assert_eq!((quiet.status.code(), quiet.stdout.len(), quiet.stderr.len()), (Some(3), 0, 0));
}

#[test]
fn one_result_and_itself_are_one() {
    let scratch = Scratch::new();
    scratch.ok(&format!("analyze --sampler jittered --seed 1 {RUN} --out a"));
    scratch.ok(&format!("analyze --sampler jittered --seed 1 {RUN} --accuracy high --out b"));
    let (code, found) = json(&scratch, "a b");
    assert_eq!((code, &found["differ"]), (Some(0), &Value::Bool(false)));
    let notes = found["notes"].to_string();
    assert!(notes.contains("of the same points"), "{notes}");
    let of_counts = found["columns"].as_array().unwrap().iter().find(|column| column["figure"] == "pcf.g").unwrap();
    assert_eq!(of_counts["z"], 0.0);
}

#[test]
fn what_cannot_be_compared_is_said() {
    let scratch = Scratch::new();
    scratch.ok(&format!("analyze --sampler jittered {RUN} --out a"));
    scratch.ok("analyze --sampler jittered -n 64 -k 20 --device cpu --stats pcf --r-max 0.1 --quiet --out narrow");
    scratch.ok("analyze --sampler jittered -n 64 -k 20 --device cpu --stats counts --quiet --out counts");
    scratch.fails("compare a narrow", 1, "no row of one is a row of the other");
    scratch.fails("compare a counts", 1, "has no bins, rings or integrands in common");
    scratch.fails("compare a", 2, "2 values");
    scratch.fails("compare a nowhere", 1, "nowhere");
    scratch.fails("compare a a --alpha 1", 2, "--alpha 1: expected a level of significance between 0 and 1");
    let path = scratch.path("a/pcf.csv");
    let broken = std::fs::read_to_string(&path).unwrap().replacen('\n', "\nx,", 1);
    std::fs::write(&path, broken).unwrap();
    scratch.fails("compare a a", 1, "pcf.csv:2");
}

#[test]
fn points_beside_others_are_measured_by_the_same_settings() {
    let scratch = Scratch::new();
    scratch.ok("sample random -n 50 -k 6 --seed 5 --quiet --out mine.npy");
    let run =
        "analyze mine.npy --beside nosuch --beside poisson-disk --device cpu --stats pcf,spectrum --quiet --out all";
    scratch.fails(run, 2, "--beside nosuch: is neither a file nor a sampler");
    let run = run.replace("nosuch", "halton:shift=random");
    scratch.ok(&run);
    let found = crate::shared::summary(&scratch.path("all"));
    assert_eq!(found["comparison"]["results"].as_array().unwrap().len(), 3, "{found}");
    let of = |name: &str| crate::shared::summary(&scratch.path(&format!("all/{name}")));
    for name in ["mine", "halton-shift=random", "poisson-disk"] {
        let one = of(name);
        assert_eq!((&one["n"]["max"], &one["k"]), (&50.into(), &6.into()), "{name}");
        assert_eq!(one["pair_correlation"]["r_max"], of("mine")["pair_correlation"]["r_max"]);
        assert_eq!(one["spectrum"]["max_frequency"], of("mine")["spectrum"]["max_frequency"]);
    }
    // Each by itself, from the settings beside it.
    scratch.ok("analyze --config all/halton-shift=random/run.toml --quiet --out alone");
    let read = |path: &str| std::fs::read(scratch.path(path)).unwrap();
    for file in ["pcf.csv", "spectrum.npy", "run.toml"] {
        assert!(read(&format!("all/halton-shift=random/{file}")) == read(&format!("alone/{file}")), "{file}");
    }
    // What is whole is not measured again, what is missing is.
    std::fs::remove_dir_all(scratch.path("all/poisson-disk")).unwrap();
    let output = scratch.run(&format!("{} --resume", run.replace(" --quiet", "")));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && said.contains("all/mine is there already"), "{said}");
    assert!(scratch.path("all/poisson-disk/summary.json").is_file());
    // Not what other settings made, and not what is no comparison.
    scratch.fails(&format!("{run} --bins 8 --resume"), 2, "all/mine: holds a result of other settings");
    scratch.ok("analyze mine.npy --device cpu --stats pcf --quiet --out kept");
    scratch.fails(
        "analyze mine.npy --beside random --device cpu --stats pcf --quiet --checkpoint 60 --out kept",
        2,
        "kept",
    );
    assert!(scratch.path("kept/pcf.csv").is_file());
    scratch.fails("compare all/mine all/poisson-disk --out all/mine --force", 2, "is read, and would be replaced");
    scratch.fails(
        "analyze mine.npy --beside nosuch --device cpu --quiet --out b",
        2,
        "--beside nosuch: is neither a file nor a sampler",
    );
    scratch.fails(
        "analyze mine.npy --window 0,1,0,1 --beside jittered --device cpu --quiet --out c",
        2,
        "--beside jittered: is a sampler, which draws on a torus; expected files, or no --window",
    );
    scratch.fails("analyze mine.npy --beside random --shard 1/2 --out d", 2, "--shard (given): is of one measurement");
}

#[test]
fn columns_that_only_one_has_are_said() {
    let scratch = Scratch::new();
    scratch.ok(&format!("analyze --sampler jittered --seed 1 {RUN} --out a"));
    scratch.ok(&format!("analyze --sampler jittered --seed 2 {RUN} --kernel epanechnikov --bandwidth 0.01 --out b"));
    for (results, which) in [("a b", "other"), ("b a", "first")] {
        let notes = json(&scratch, results).1["notes"].to_string();
        assert!(notes.contains(&format!("is in the {which} alone")), "{notes}");
    }
}

/// Anisotropy is a tenth of it for ten times the realizations, of isotropic points too.
#[test]
fn numbers_of_realizations_alone_make_no_difference() {
    let scratch = Scratch::new();
    scratch.ok(&format!("analyze --sampler jittered --seed 1 {RUN} --out a"));
    scratch.ok(&format!("analyze --sampler jittered --seed 2 {} --out b", RUN.replace("-k 40", "-k 400")));
    let (code, found) = json(&scratch, "a b");
    assert_eq!(code, Some(0), "{found}");
    let notes = found["notes"].to_string();
    assert!(notes.contains("spectrum_radial.anisotropy_db falls with the number of realizations"), "{notes}");
    assert!(found["columns"].as_array().unwrap().iter().any(|column| column["figure"] == "spectrum_radial.p"));
}
