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

/// The page has z of every column along an axis, with the lines that p is read off by.
#[test]
fn differences_are_drawn_against_their_axes() {
    let scratch = Scratch::new();
    // Few realizations: the lines are those of Student's law.
    let run = RUN.replace("-k 40", "-k 6").replace("pcf,spectrum", "pcf,spectrum,counts,k-function");
    for (sampler, seed) in [("jittered", 1), ("jittered", 2), ("random", 3)] {
        scratch.ok(&format!("analyze --sampler {sampler} --seed {seed} {run} --out {sampler}{seed}"));
    }
    let (_, found) = json(&scratch, "jittered1 jittered2 random3 --alpha 0.05 --out all");
    let page = std::fs::read_to_string(scratch.path("all/report.html")).unwrap();
    let data = page.split("<script type=\"application/json\" id=\"table-").skip(1);
    let tables: Vec<Value> = data
        .map(|rest| rest.split_once("\">").unwrap().1.split_once("</script>").unwrap().0)
        .map(|text| serde_json::from_str(text).unwrap())
        .collect();
    let (mut passed, mut drawn) = (0, 0);
    for column in found["columns"].as_array().unwrap() {
        let figure = column["figure"].as_str().unwrap();
        let table = tables.iter().find(|table| table["name"] == format!("{figure} in comparison.csv"));
        assert_eq!(table.is_some(), !figure.starts_with("variance."), "{figure}");
        let Some(table) = table else { continue };
        drawn += 1;
        let result = found["results"][column["with"].as_u64().unwrap() as usize].as_str().unwrap();
        let mut reader = csv::Reader::from_reader(table["csv"].as_str().unwrap().as_bytes());
        let header = reader.headers().unwrap().clone();
        let rows: Vec<csv::StringRecord> =
            reader.records().map(Result::unwrap).filter(|row| &row[0] == result).collect();
        assert_eq!(rows.len() as u64, column["rows"].as_u64().unwrap(), "{figure}");
        for row in &rows {
            let number = |name: &str| {
                row[header.iter().position(|h| h == name).unwrap()].parse::<f64>().unwrap_or(f64::INFINITY)
            };
            let (z, p) = (number("z").abs(), number("p"));
            assert_eq!(z >= number("critical_single"), p <= 0.05, "{figure} {row:?}");
            assert_eq!(z >= number("critical_column"), p * rows.len() as f64 <= 0.05, "{figure} {row:?}");
            assert!(number("critical_single") > 1.96 && number("critical_single") < number("critical_column"));
            passed += usize::from(z >= number("critical_column"));
        }
    }
    assert!(passed > 10 && drawn > 12, "{passed} {drawn}");
    // Beside the curves that they are of.
    let at = |id: &str| page.find(&format!("<figure id=\"{id}\">")).unwrap_or_else(|| panic!("{id}"));
    let order = ["pcf", "difference_0", "k_function", "spectrum_radial"].map(at);
    assert!(order.is_sorted(), "{order:?}");
    assert!(page.contains("Difference of pcf.g, in standard errors") && page.contains("distance r"));
}

/// A table that is none ends the page too, by its line, though what is compared is whole.
#[test]
fn a_broken_table_is_named_where_its_curves_would_be() {
    let scratch = Scratch::new();
    let run = "--device cpu -n 64 -k 12 --bins 16 --stats k-function --quiet";
    scratch.ok(&format!("analyze --sampler jittered --seed 1 {run} --out a"));
    scratch.ok(&format!("analyze --sampler jittered --seed 2 {run} --out b"));
    let path = scratch.path("b/k_function.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let at = header.split(',').position(|name| name == "l_minus_r").unwrap();
    let mut cells: Vec<&str> = rows.lines().next().unwrap().split(',').collect();
    cells[at] = "much";
    let rest = rows.split_once('\n').unwrap().1;
    std::fs::write(&path, format!("{header}\n{}\n{rest}", cells.join(","))).unwrap();
    scratch.ok("compare a b");
    scratch.fails("compare a b --out both", 1, "b/k_function.csv:2: column l_minus_r holds much; expected a number");
    assert!(!scratch.path("both").exists());
    // Results without curves have a page all the same.
    for seed in [1, 2] {
        scratch.ok(&format!(
            "integrate --sampler jittered --seed {seed} -n 64 -k 12 --integrand disk --device cpu --quiet --out i{seed}"
        ));
    }
    scratch.ok("compare i1 i2 --out integrals");
    assert!(scratch.path("integrals/report.html").is_file());
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
fn what_marks_points_is_said_to_be_left_out_beside_a_sampler() {
    let scratch = Scratch::new();
    let points: String = (0..60)
        .map(f64::from)
        .map(|k| format!("{},{},{},{}\n", (0.618 * k).fract(), (0.755 * k).fract(), k % 2.0, 1.0 + k % 3.0))
        .collect();
    scratch.file("points.csv", &format!("x,y,kind,w\n{points}"));
    let run = "analyze points.csv --stats pcf --bins 8 --device cpu --beside random --beside points.csv";
    for (marks, said) in [
        (
            "--class-column kind --classes 0,1",
            "all/random: measured without --class-column kind and --classes 0,1: points of random have none",
        ),
        ("--weight-column w", "all/random: measured without --weight-column w: points of random have none"),
    ] {
        let output = scratch.run(&format!("{run} {marks} --out all --force"));
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && told.contains(said), "{told}");
        // The file beside has them.
        assert_eq!(told.matches("measured without").count(), 1, "{told}");
        let notes = crate::shared::summary(&scratch.path("all"))["warnings"].to_string();
        assert!(notes.contains("measured without"), "{notes}");
    }
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
