//! `pairwave bench`: its files, and what holds on any machine: exact ways have no error, errors of others are below what is promised.

use std::collections::BTreeMap;

use crate::shared::Scratch;

/// The rows of a table of a result, by column.
fn rows(dir: &std::path::Path, name: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(dir.join(name)).unwrap();
    let header = reader.headers().unwrap().clone();
    let row =
        |record: csv::StringRecord| header.iter().map(String::from).zip(record.iter().map(String::from)).collect();
    reader.records().map(|record| row(record.unwrap())).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} of {row:?}"))
}

#[test]
fn ways_to_the_same_numbers_are_as_far_from_the_exact_ones_as_they_are_known_to_be() {
    let scratch = Scratch::new();
    let out = scratch.path("bench");
    let text = scratch.ok("bench --quick --only pairs,kernel,spectrum --device cpu --out bench");
    assert!(text.contains("GFLOP/s of f32 multiply-adds"), "{text}");
    let ways = rows(&out, "bench.csv");
    let of = |section: &str, method: &str| {
        let found: Vec<_> =
            ways.iter().filter(|row| row["section"] == section && row["method"].starts_with(method)).collect();
        assert!(!found.is_empty(), "no {method} of {section}");
        found
    };
    // Counts are the integers of the reference, of the lattice too; a loop in f32 misplaces pairs of it.
    assert!(of("pairs", "exact").iter().all(|row| number(row, "error_max") == 0.0));
    assert!(of("pairs", "plain loop, f32").iter().any(|row| number(row, "error_max") > 1e-3));
    assert!(of("kernel", "pair by pair").iter().all(|row| number(row, "error_max") < 1e-12));
    let fine = of("kernel", "fine bins");
    let errors: Vec<f64> = fine.iter().map(|row| number(row, "error_rms")).collect();
    assert!(errors.first() > errors.last() && errors.iter().all(|&e| 0.0 < e && e < 0.1), "{errors:?}");
    // The promises of `fast` and `high`, which transforms keep by their tolerance.
    assert!(of("spectrum", "direct, f32").iter().all(|row| number(row, "error_max") < 1e-5));
    assert!(of("spectrum", "direct, f64").iter().all(|row| number(row, "error_max") < 1e-11));
    assert!(of("spectrum", "NUFFT, 1e-9").iter().all(|row| number(row, "error_max") < 1e-7));
    assert!(of("spectrum", "NUFFT, 1e-3").iter().all(|row| number(row, "error_rms") > 1e-9), "a coarse one errs");
    assert!(of("spectrum", "sine and cosine of each term, f32").iter().all(|row| number(row, "error_rms") > 1e-8));
    for row in &ways {
        let [least, median, most] = ["seconds_least", "seconds", "seconds_most"].map(|column| number(row, column));
        assert!(0.0 < least && least <= median && median <= most, "{row:?}");
        assert!(number(row, "error_statistical") > 0.0);
    }
    // No way of the front is beaten by another of its scene.
    for row in ways.iter().filter(|row| row["pareto"] == "yes" && !row["error_rms"].is_empty()) {
        let beats = |other: &&BTreeMap<String, String>| {
            if other["error_rms"].is_empty() || other["scene"] != row["scene"] {
                return false;
            }
            let of = |row: &BTreeMap<String, String>| [number(row, "seconds"), number(row, "error_rms")];
            let ([t, e], [other_t, other_e]) = (of(row), of(other));
            other_t <= t && other_e <= e && (other_t < t || other_e < e)
        };
        assert_eq!(ways.iter().find(beats), None, "{row:?}");
    }
    for name in ["bench.svg", "report.html", "summary.json", "run.toml"] {
        assert!(out.join(name).exists(), "{name}");
    }
    let svg = std::fs::read_to_string(out.join("bench.svg")).unwrap();
    roxmltree::Document::parse(&svg).unwrap();
    assert!(!out.join("growth.csv").exists(), "only what was asked for");
}

#[test]
fn predictions_and_observations_agree_and_samplers_are_ranked() {
    let scratch = Scratch::new();
    let out = scratch.path("bench");
    scratch.ok("bench --quick --only variance,samplers --device cpu --out bench");
    let ways = rows(&out, "bench.csv");
    for row in ways.iter().filter(|row| !row["method"].starts_with("observed")) {
        // Far below what chance makes of one realization.
        assert!(number(row, "error_rms") < 0.05 * number(row, "error_statistical"), "{row:?}");
    }
    assert!(ways.iter().filter(|row| row["method"].starts_with("observed")).all(|row| row["error_rms"].is_empty()));
    let efficiency = rows(&out, "efficiency.csv");
    let error = |sampler: &str, integrand: &str, n: &str| {
        let found = efficiency
            .iter()
            .find(|row| row["sampler"] == sampler && row["integrand"].starts_with(integrand) && row["n"] == n);
        number(found.unwrap(), "error_rms")
    };
    // Random: sqrt(v0 / n), v0 = 1/12 of the ramp; jittered: 1 / (12 n^2) of it, unshifted.
    assert!((error("random", "ramp", "1024") / (1.0f64 / 12.0 / 1024.0).sqrt() - 1.0).abs() < 0.4);
    assert!((error("jittered", "ramp", "1024") / ((1.0f64 / 12.0).sqrt() / 1024.0) - 1.0).abs() < 0.4);
    assert!(error("jittered", "disk", "1024") < error("random", "disk", "1024"));
    assert!(efficiency.iter().all(|row| number(row, "seconds_drawing") > 0.0));
}

#[test]
fn what_a_scene_does_not_need_is_not_done() {
    let scratch = Scratch::new();
    scratch.ok("bench --quick --only skipped --device cpu --out bench");
    let all = rows(&scratch.path("bench"), "skipped.csv");
    let of = |scene: &str| all.iter().find(|row| row["scene"].starts_with(scene)).unwrap_or_else(|| panic!("{scene}"));
    // Cells look at the pairs near each other, of which there are n (n - 1) / 2 pi r^2, and some around them.
    let near = of("g at distances below 0.1");
    let needed = std::f64::consts::PI * 0.1f64.powi(2) * number(near, "pairs_plain");
    assert!((needed..8.0 * needed).contains(&number(near, "pairs")), "{near:?}");
    assert!(number(of("g at distances below 0.01"), "pairs_part") < 0.05);
    // P by symmetry and transforms, by a part of the modes, and none of it again for pairs alone.
    assert!(number(of("radial mean of P, "), "products_part") < 0.5);
    assert!(number(of("radial mean of P by 8 directions"), "products_part") < 0.2);
    let again = of("g and P again");
    assert!(number(again, "pairs") == 0.0 && number(again, "products") > 0.0, "{again:?}");
    // A smooth integrand has few coefficients, and one of x alone none but along x.
    let [all, smooth, along] = ["an integral over a disk", "a smooth integrand", "a function of x alone"]
        .map(|of_| of(&format!("variance of {of_}")));
    for (some, most) in [(smooth, 0.3), (along, 0.1)] {
        assert!(number(some, "products") < most * number(all, "products"), "{some:?} against {all:?}");
    }
    // A batch that is known well enough is not gone on with.
    let enough = of("g(0.05) to 0.02");
    assert!(enough["scene"].contains(" of 400") && number(enough, "pairs_part") < 0.9, "{enough:?}");
}

/// Costs are measured into a file, plans choose by it, and parts that chose by others are not added up.
#[test]
fn measured_costs_are_what_plans_choose_by() {
    let scratch = Scratch::new();
    let text = scratch.ok("bench --quick --calibrate costs.json --only growth --device cpu --out bench");
    assert!(
        text.contains("what the parts of methods cost on cpu") && text.contains("times as long as the best"),
        "{text}"
    );
    let explained = rows(&scratch.path("bench"), "calibration.csv");
    assert!(explained.len() > 40 && explained.iter().all(|row| number(row, "seconds") > 0.0));
    for problem in explained.iter().map(|row| &row["problem"]) {
        let of =
            |column: &str| explained.iter().filter(|row| row["problem"] == *problem && row[column] == "yes").count();
        assert!(of("chosen") >= 1 && of("fastest") >= 1, "{problem}");
    }
    scratch.fails("bench --quick --calibrate costs.json", 2, "--calibrate costs.json: is there already");
    let explain = "analyze --sampler random -n 1000 -k 32 --stats spectrum --device cpu --max-frequency 40";
    let plan = scratch.ok(&format!("{explain} --explain --costs costs.json"));
    assert!(plan.contains("on the CPU, one thread, as measured here"), "{plan}");
    // What makes a method cheap makes it the choice.
    let path = scratch.path("costs.json");
    let mut costs: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    let road = |costs: &serde_json::Value| {
        std::fs::write(&path, costs.to_string()).unwrap();
        let plan = scratch.ok(&format!("{explain} --explain --costs costs.json"));
        plan.lines().find_map(|line| line.trim().strip_prefix("road: ")).unwrap().to_string()
    };
    for (values, method) in
        [([1e-3, 1e3, 1e9], "direct f32"), ([1e3, 1e-3, 1e9], "direct f64"), ([1e3, 1e3, 1e-3], "NUFFT")]
    {
        for (part, value) in ["f32_mode", "f64_mode", "nufft_cell"].into_iter().zip(values) {
            costs["devices"]["cpu"]["waves"][part] = value.into();
        }
        let road = road(&costs);
        assert!(road.starts_with(method), "{method}: {road}");
    }
    for (part, flags) in [(1, "--costs costs.json"), (2, "")] {
        scratch.ok(&format!("{explain} {flags} --shard {part}/2 --out parts/{part}"));
    }
    scratch.fails("merge parts/1 parts/2 --out whole", 1, "costs");
    costs["devices"]["cpu"]["waves"].as_object_mut().unwrap().remove("term");
    std::fs::write(&path, costs.to_string()).unwrap();
    scratch.fails(&format!("{explain} --costs costs.json"), 1, "costs.json: cpu has no term, in nanoseconds");
    scratch.fails(&format!("{explain} --costs nowhere.json"), 1, "nowhere.json");
}

#[test]
fn own_samplers_are_held_against_random_points() {
    let scratch = Scratch::new();
    let text = scratch.ok("bench --quick --sampler jittered --integrand step --device cpu --out bench");
    let of = rows(&scratch.path("bench"), "efficiency.csv");
    let names: std::collections::BTreeSet<_> = of.iter().map(|row| (&*row["sampler"], &*row["integrand"])).collect();
    assert!(names.iter().map(|(s, _)| *s).eq(["jittered", "random"]) && text.contains("jittered"), "{names:?}");
    assert!(names.iter().all(|(_, integrand)| integrand.starts_with("step")), "{names:?}");
    scratch.fails("bench --quick --sampler jitered", 2, "jittered");
    scratch.fails("bench --only pairs --integrand step", 2, "is of the section samplers");
}

#[test]
fn what_cannot_be_timed_says_why() {
    let scratch = Scratch::new();
    for (line, code, why) in [
        ("bench --device reference", 2, "is what the others are held against"),
        ("bench --quick --force", 2, "without it nothing is written"),
        ("bench --only everything", 2, "possible values: pairs, kernel, spectrum"),
        ("bench --threads 0", 2, "expected 1 to"),
    ] {
        scratch.fails(line, code, why);
    }
}
