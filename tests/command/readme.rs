//! The README states what the code does: its accuracy table holds the constants, its map the files.

use pairwave::plan::Accuracy;

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
fn the_map_names_what_exists() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let map = README.split("```text").nth(1).unwrap().split("```").next().unwrap();
    let mut path: Vec<&str> = Vec::new();
    let mut named = 0;
    for line in map.lines().filter(|l| !l.trim().is_empty()) {
        let depth = (line.len() - line.trim_start().len()) / 2;
        path.truncate(depth);
        path.push(line.split_whitespace().next().unwrap());
        let place = path.iter().fold(root.to_path_buf(), |p, part| p.join(part));
        assert!(place.exists(), "the map names {}, which does not exist", place.display());
        named += 1;
    }
    let folders = std::fs::read_dir(root.join("src")).unwrap().count();
    assert!(named > folders, "the map has fewer entries than src/");
}

#[test]
fn the_trust_chain_names_every_test() {
    for file in std::fs::read_dir(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests")).unwrap() {
        let name = file.unwrap().file_name().into_string().unwrap();
        if let Some(stem) = name.strip_suffix(".rs").filter(|s| *s != "readme_is_true") {
            assert!(README.contains(&format!("`{stem}`")), "the README's chain of trust lacks {stem}");
        }
    }
}
