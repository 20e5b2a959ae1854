//! Settings from a file, and the file that repeats a run.

use std::collections::BTreeMap;
use std::path::Path;

use crate::shared::{Scratch, summary};

/// Everything that does not tell of times and of what was typed.
fn bytes(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = std::fs::read_dir(dir).unwrap().map(|file| file.unwrap().path());
    let named =
        files.map(|path| (path.file_name().unwrap().to_str().unwrap().to_string(), std::fs::read(&path).unwrap()));
    named.filter(|(name, _)| !["summary.json", "report.html"].contains(&name.as_str())).collect()
}

/// Runs a command, and again by the settings beside its result: the same bytes, the settings among them.
fn repeats(scratch: &Scratch, arguments: &str) {
    let command = arguments.split(' ').next().unwrap();
    scratch.ok(&format!("{arguments} --quiet --out first"));
    scratch.ok(&format!("{command} --config first/run.toml --quiet --out second"));
    // The file alone says which command it is of.
    scratch.ok("--config first/run.toml --quiet --out third");
    let first = bytes(&scratch.path("first"));
    assert!(first.contains_key("run.toml"));
    for other in ["second", "third"] {
        let other = bytes(&scratch.path(other));
        let differing: Vec<_> = first.keys().filter(|name| other.get(*name) != first.get(*name)).collect();
        assert!(differing.is_empty() && other.len() == first.len(), "{arguments}: {differing:?}");
    }
    for dir in ["first", "second", "third"] {
        std::fs::remove_dir_all(scratch.path(dir)).unwrap();
    }
}

#[test]
fn the_settings_beside_a_result_repeat_it() {
    let scratch = Scratch::new();
    scratch.file("points.csv", "x,y,kind\n0.1,0.2,a b\n0.5,0.5,c\n0.9,0.3,a b\n0.4,0.8,c\n");
    for arguments in [
        "analyze --sampler jittered -n 64 -k 5 --stats pcf,spectrum --r-max 0.25 --device cpu --threads 1",
        "analyze points.csv --columns x,y --class-column kind --window -1,1,0,1 --device cpu --bins 16 --unit m",
        "analyze --sampler poisson-disk -n 64 -k 3 --param radius=0.6 --stats radial --ring-directions 8 --device cpu",
        "integrate --sampler jittered -n 64 -k 5 --integrand disk:r=0.2 --integrand formula:x*y --shifts 4 --device cpu",
        "convergence --sampler jittered --sampler random -n 16,64 -k 4 --integrand disk --device cpu",
        "analyze --sampler sobol --prefixes 16,32 -k 1 --device cpu",
    ] {
        repeats(&scratch, arguments);
    }
}

#[test]
fn what_is_typed_wins() {
    let scratch = Scratch::new();
    scratch.file(
        "run.toml",
        "sampler = \"jittered\"\npoints = 64\nrealizations = 2\nstats = [\"pcf\"]\nbins = 16\nr_max = 0.25\ndevice = \"cpu\"\nquiet = true\n\
         force = false\n",
    );
    scratch.ok("analyze --config run.toml --out a");
    scratch.ok("analyze -k 3 --config=run.toml --bins 32 --out b");
    let of = |dir: &str, key: &str| summary(&scratch.path(dir))["parameters"][key].clone();
    assert_eq!((of("a", "realizations"), of("b", "realizations")), (2.into(), 3.into()));
    assert_eq!((of("a", "bins"), of("b", "bins")), (16.into(), 32.into()));
    // Over what it cannot be given with, too.
    scratch.file("edges.txt", "0 0.1 0.2");
    scratch.file("points.csv", "0.1,0.2\n0.5,0.5\n0.9,0.3\n");
    scratch.ok("analyze --config run.toml --edges edges.txt --out c");
    assert_eq!(of("c", "r_max"), serde_json::Value::Null);
    scratch.ok("analyze points.csv --config run.toml --out d");
    assert_eq!(of("d", "sampler"), serde_json::Value::Null);
}

#[test]
fn mistakes_are_named_with_their_line() {
    let scratch = Scratch::new();
    for (text, code, said) in [
        (
            "points = 64\nsamplr = \"jittered\"\n",
            1,
            "run.toml:2: samplr: is no setting of analyze; did you mean sampler?",
        ),
        ("points = 64\nzzz = 1\n", 1, "run.toml:2: zzz: is no setting of analyze"),
        ("points = \n", 1, "run.toml:1: is no TOML"),
        ("points = 64\npoints = 65\n", 1, "run.toml:2: is no TOML"),
        ("wrap = 3\n", 1, "run.toml:1: wrap: is 3; expected true or false"),
        ("r-max = nan\n", 1, "run.toml:1: r-max: is nan; expected a number"),
        ("r-max = 2026-01-01\n", 1, "run.toml:1: r-max: is 2026-01-01; expected a number"),
        ("r-max = [[1]]\n", 1, "run.toml:1: r-max: is [1]"),
        ("command = \"sample\"\n", 1, "holds settings of sample; expected those of analyze"),
        ("\n\nbins = \"many\"\n", 2, "is set in run.toml:3"),
        ("sampler = \"jittered\"\npoints = 64\nr-max = -1.5\n", 2, "--r-max -1.5"),
    ] {
        scratch.file("run.toml", text);
        scratch.fails("analyze --config run.toml --device cpu", code, said);
    }
    scratch.file("run.toml", "points = 64\n");
    scratch.fails("--config run.toml", 1, "does not say which command it is of");
    scratch.fails("analyze --config nowhere.toml", 1, "nowhere.toml");
    scratch.fails("analyze --config", 1, "expected a file of settings");
    scratch.fails("analyze --config run.toml --config run.toml", 1, "given twice");
}

/// Keys that have nothing to do without a place for the result, and the place in the file.
#[test]
fn what_needs_a_place_for_the_result_says_so() {
    let scratch = Scratch::new();
    let settings = "command = \"analyze\"\nsampler = \"jittered\"\npoints = 16\nquiet = true\nstats = [\"pcf\"]\ndevice = \"cpu\"\n";
    for (key, value) in [("keep-sums", "true"), ("npz", "true"), ("beside", "[\"random\"]"), ("checkpoint", "60")] {
        scratch.file("run.toml", &format!("{settings}{key} = {value}\n"));
        scratch.fails(
            "--config run.toml",
            2,
            &format!("{key} is set in run.toml:7, and needs --out <DIR>: type it, or set it there too"),
        );
        scratch.ok(&format!("--config run.toml --out typed_{key}"));
        scratch.file("run.toml", &format!("{settings}{key} = {value}\nout = \"set_{key}\"\n"));
        scratch.ok("--config run.toml");
        assert!(scratch.path(&format!("set_{key}/summary.json")).is_file());
    }
    // What is missing whatever a file says is not said of it.
    scratch.file("run.toml", "command = \"merge\"\nquiet = true\nkeep-sums = true\n");
    let output = scratch.run("--config run.toml");
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && said.contains("--out <DIR>") && !said.contains("is set in"), "{said}");
}

#[test]
fn the_manual_has_a_page_for_each_command() {
    let scratch = Scratch::new();
    scratch.ok("man pages");
    let page = std::fs::read_to_string(scratch.path("pages/pairwave-analyze.1")).unwrap();
    assert!(page.contains("r\\-max") && page.contains("until\\-error"), "{page}");
    assert!(scratch.path("pages/pairwave.1").is_file() && scratch.path("pages/pairwave-compare.1").is_file());
}
