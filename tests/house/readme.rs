//! The README states what the code does: its accuracy table holds the constants, its map the files, its defaults are those of the
//! table of settings (which is compared with the help and the code beside it).

use std::collections::BTreeSet;
use std::path::Path;

use pairwave::Setting;
use pairwave::plan::Accuracy;

use crate::floors::FLOORS;

const README: &str = include_str!("../../README.md");

#[test]
fn the_accuracy_table_holds_the_constants() {
    let (fast, high) = (Accuracy::Fast.power_bound(), Accuracy::High.power_bound());
    for (row, fast, high) in [
        ("max \\|P - P_ref\\| / (1 + P_ref), uniform", fast.max_uniform, high.max_uniform),
        ("rms of P - P_ref", fast.rms_uniform, high.rms_uniform),
        ("largest P where a rank-1 lattice", fast.lattice_zero, high.lattice_zero),
        ("jittered lattice", fast.jittered_median, high.jittered_median),
        ("table of cosines and sines", fast.table_entry, high.table_entry),
        ("any points: the same, per", fast.max_any_per_root_n, high.max_any_per_root_n),
    ] {
        let line = README.lines().find(|l| l.contains(row)).unwrap_or_else(|| panic!("no row `{row}`"));
        assert!(line.ends_with(&format!("| {fast:e} | {high:e} |")), "{line} does not end in {fast:e}, {high:e}");
    }
}

#[test]
fn the_tolerances_are_those_of_the_plan() {
    let [fast, high] = [Accuracy::Fast, Accuracy::High].map(Accuracy::nufft_tolerance);
    assert!(README.contains(&format!("(tolerance {fast:e} for `fast`, {high:e} for `high`")));
}

#[test]
fn the_defaults_are_those_of_the_settings() {
    let said = [
        (Setting::Correction, "(Ohser 1983, the default)", "translation in a window"),
        (Setting::MaxFrequency, "F = ⌈5 n^(1/d)⌉", "ceil(5 n^(1/d))"),
        (Setting::CovarianceFrequency, "(8 in 2D, 64 in 1D, 2 in 3D)", "8 in 2D, 64 in 1D, 2 in 3D"),
        (Setting::Normalization, "`n²` with `--normalization intensity`", "pairs"),
    ];
    for (setting, sentence, words) in said {
        assert!(README.contains(sentence), "the README does not say {sentence}");
        let default = setting.row().unwrap().left_out(Setting::flag);
        assert!(default.contains(words), "{}: {default}, not {words}", setting.flag());
    }
    // Nothing else is called a default; `default()` in code calls nothing so.
    let lines = README.lines().filter(|line| line.replace("default()", "").contains("default"));
    let known = lines.clone().filter(|line| said.iter().any(|(_, sentence, _)| line.contains(sentence)));
    assert_eq!(lines.collect::<Vec<_>>(), known.collect::<Vec<_>>());
}

/// The lines of the map as paths.
fn map() -> Vec<String> {
    let map = README.split("```text").nth(1).unwrap().split("```").next().unwrap();
    let mut path: Vec<&str> = Vec::new();
    let mut named = Vec::new();
    for line in map.lines().filter(|l| !l.trim().is_empty()) {
        let depth = (line.len() - line.trim_start().len()) / 2;
        path.truncate(depth);
        path.push(line.split_whitespace().next().unwrap());
        named.push(path.concat());
    }
    named
}

#[test]
fn the_map_is_the_tree() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let map = map();
    for place in &map {
        assert!(root.join(place).exists(), "the map names {place}, which does not exist");
    }
    // All folders and files of src/, from the ground up.
    let named = |folder: &str| {
        let parts = map.iter().filter_map(|place| place.strip_prefix(folder));
        let parts = parts.map(|part| part.trim_end_matches('/').trim_end_matches(".rs"));
        parts.filter(|part| !part.is_empty() && !part.contains('/')).map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(named("src/"), FLOORS);
    // Its folders, and those of the repository, which all have a line.
    for folder in ["src/", "tests/", "src/compute/"] {
        let mut there = BTreeSet::new();
        for entry in std::fs::read_dir(root.join(folder)).unwrap().map(Result::unwrap) {
            let name = entry.file_name().into_string().unwrap();
            let file = folder == "src/" && !["lib.rs", "main.rs"].contains(&name.as_str());
            if file || entry.path().is_dir() {
                there.insert(name.trim_end_matches(".rs").to_string());
            }
        }
        assert_eq!(named(folder).into_iter().collect::<BTreeSet<_>>(), there, "{folder}");
    }
}

#[test]
fn the_trust_chain_names_every_room() {
    let chain = README.split("## Trust is a chain").nth(1).unwrap().split("\n## ").next().unwrap();
    for folder in ["tests", "viewer/tests"] {
        for room in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).unwrap().map(Result::unwrap) {
            let name = room.file_name().into_string().unwrap();
            let is_room = room.path().join("main.rs").exists();
            assert!(!is_room || chain.contains(&format!("`{name}`")), "the README's chain of trust lacks {name}");
        }
    }
}
