//! Variances against the number of points, and predictions without points, end to end.

use std::collections::BTreeMap;

use pairwave::Integrand;
use pairwave::estimate::{Measured, PowerLaw, VarianceAt};

use crate::shared::{Scratch, csv, summary, table};

fn numbers(cells: &[String]) -> Vec<f64> {
    cells.iter().map(|cell| cell.parse().unwrap_or_else(|_| panic!("{cell} is no number"))).collect()
}

/// V of jittered points that are shifted, in the plane: `int f^2 / n - int a(r) prod_j (1 - k |r_j|)_+ dr`, by midpoints on the two triangles
/// `r_y < r_x` and `r_x < r_y` of a quarter, along rays, where a is smooth; a of both integrands is the same in every quarter.
fn shifted_jittered(f: &Integrand, k: f64) -> f64 {
    const STEPS: usize = 160;
    let at = |step: usize| (step as f64 + 0.5) / STEPS as f64;
    let mut sum = 0.0;
    for u in (0..STEPS).map(at) {
        for v in (0..STEPS).map(at) {
            let (long, short) = (u / k, u * v / k);
            // The two triangles are mirror images.
            let a = f.autocorrelation(&[long, short]) + f.autocorrelation(&[short, long]);
            sum += (a - 2.0 * f.square_integral()) * (1.0 - u) * (1.0 - u * v) * u;
        }
    }
    // The weights integrate to 1/n exactly: what is left is the deviation from a(0).
    -4.0 * sum / (k * k) / (STEPS * STEPS) as f64
}

#[test]
fn jittered_points_converge_as_the_closed_form_does() {
    let scratch = Scratch::new();
    let line = "convergence --sampler jittered --sampler random --integrand disk --integrand gaussian";
    scratch.ok(&format!("{line} -n 16,64,256,576 -k 120 --device cpu --quiet --out c"));
    let (header, _) = csv(&scratch.path("c/convergence.csv"));
    assert!(
        header.starts_with(
            "subject,integrand,n,k,var_observed,var_observed_se,var_predicted,var_predicted_se,local_slope,"
        )
    );
    let rows = reader(&scratch, "c/convergence.csv");
    let slopes = reader(&scratch, "c/slopes.csv");
    let column = |name: &str, subject: &str, integrand: &str| -> Vec<String> {
        let (s, i, c) = (place(&rows.0, "subject"), place(&rows.0, "integrand"), place(&rows.0, name));
        let wanted = rows.1.iter().filter(|row| row[s] == subject && row[i].starts_with(integrand));
        wanted.map(|row| row[c].clone()).collect()
    };
    for name in ["disk", "gaussian"] {
        let f = Integrand::new(name, 2).unwrap();
        let of = |column_name: &str| numbers(&column(column_name, "jittered", name));
        let n = of("n");
        assert_eq!(n, [16.0, 64.0, 256.0, 576.0]);
        let exact: Vec<f64> = n.iter().map(|n| shifted_jittered(&f, n.sqrt())).collect();
        for kind in ["predicted", "shifted"] {
            let (v, se) = (of(&format!("var_{kind}")), of(&format!("var_{kind}_se")));
            for ((v, se), exact) in v.iter().zip(&se).zip(&exact) {
                assert!((v - exact).abs() < 4.0 * se + 1e-3 * exact, "{name} {kind}: {v} ± {se}, not {exact}");
            }
            // The slope is that of the closed form at the same n with the same weights.
            let weighed: Vec<VarianceAt> = (0..n.len())
                .map(|k| VarianceAt {
                    n: n[k],
                    variance: Measured { value: exact[k], se: Some(se[k] / v[k] * exact[k]) },
                })
                .collect();
            let law = PowerLaw::fit(&weighed).unwrap();
            let [s, i, w] = ["subject", "integrand", "variance"].map(|c| place(&slopes.0, c));
            let row =
                slopes.1.iter().find(|row| row[s] == "jittered" && row[i].starts_with(name) && row[w] == kind).unwrap();
            let [slope, slope_se] = ["slope", "slope_se"].map(|c| row[place(&slopes.0, c)].parse::<f64>().unwrap());
            assert!(
                (slope - law.slope).abs() < 3.0 * slope_se,
                "{name} {kind}: {slope} ± {slope_se}, not {}",
                law.slope
            );
            let expected: f64 = row[place(&slopes.0, "expected_slope")].parse().unwrap();
            let known = if name == "disk" { -1.5 } else { -2.0 };
            assert!((expected - known).abs() < 0.05, "{name}: {expected}");
        }
        assert_eq!(column("local_slope", "jittered", name)[0], "");
        // Random points need as many random points.
        let random = numbers(&column("var_random", "random", name));
        let (v, se) = ("var_predicted", "var_predicted_se");
        let (v, se) = (numbers(&column(v, "random", name)), numbers(&column(se, "random", name)));
        assert!(v.iter().zip(&se).zip(&random).all(|((v, se), random)| (v - random).abs() < 4.5 * se));
    }
    let seeds: std::collections::BTreeSet<String> = column("seed", "jittered", "disk").into_iter().collect();
    assert_eq!(seeds.len(), 4, "each n has its own");
    let ranks = reader(&scratch, "c/ranks.csv");
    let firsts: Vec<_> = ranks.1.iter().map(|row| row[place(&ranks.0, "subject")].as_str()).collect();
    assert_eq!(firsts, ["jittered", "random", "jittered", "random"]);
    // Its seed is that of a run of its own.
    let seed = &column("seed", "random", "disk")[1];
    scratch.ok(&format!(
        "integrate --sampler random -n 64 -k 120 --seed {seed} --integrand disk --integrand gaussian --device cpu --quiet --out one"
    ));
    let one = reader(&scratch, "one/variance.csv");
    assert_eq!(one.1[0][place(&one.0, "var_spatial")], column("var_predicted", "random", "disk")[1]);
    let said = summary(&scratch.path("c"));
    assert_eq!(said["slopes"].as_array().unwrap().len(), 4);
    assert_eq!(said["slopes"][0]["smoothness"], 1.0);
    assert!(said["slopes"][1]["smoothness"].is_null(), "infinite, and JSON has no such number");
    let svg = std::fs::read_to_string(scratch.path("c/convergence.svg")).unwrap();
    let svg = roxmltree::Document::parse(&svg).unwrap();
    // Of each of 16 points a disc and a ring, and two discs of the legend.
    assert_eq!(svg.descendants().filter(|node| node.has_tag_name("circle")).count(), 34);
}

/// Header and rows; cells may hold commas.
fn reader(scratch: &Scratch, name: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = ::csv::Reader::from_path(scratch.path(name)).unwrap();
    let header = reader.headers().unwrap().iter().map(String::from).collect();
    (header, reader.records().map(|row| row.unwrap().iter().map(String::from).collect()).collect())
}

fn place(header: &[String], name: &str) -> usize {
    header.iter().position(|h| h == name).unwrap_or_else(|| panic!("no column {name}"))
}

#[test]
fn files_of_each_number_of_points_and_prefixes() {
    let scratch = Scratch::new();
    for n in [16, 32, 64] {
        scratch.ok(&format!("sample sobol -n {n} -k 12 --out n{n}.npy"));
    }
    let checker = "--integrand steps:values=1;2 --integrand cosine:x=1";
    scratch.ok("sample random -n 8 -k 12 --dim 1 --out a.npy");
    scratch.ok("sample random -n 24 -k 12 --dim 1 --out b.npy");
    scratch.ok(&format!("convergence b.npy a.npy {checker} --device cpu --quiet --out ab"));
    let rows = reader(&scratch, "ab/convergence.csv");
    let n: Vec<&str> = rows.1.iter().map(|row| row[place(&rows.0, "n")].as_str()).collect();
    assert_eq!(n, ["8.0", "24.0", "8.0", "24.0"], "rising, however they are given");
    scratch.ok("convergence n16.npy n32.npy n64.npy --integrand gaussian --device cpu --quiet --out groups");
    let said = scratch.run("convergence n64.npy --prefixes 16..64 --integrand gaussian --device cpu --out prefixes");
    assert!(String::from_utf8(said.stderr).unwrap().contains("prefixes are the same points again and again"));
    let [groups, prefixes] = ["groups/convergence.csv", "prefixes/convergence.csv"].map(|name| reader(&scratch, name));
    // The first points of a sequence are its sets of fewer points.
    let predicted = |of: &(Vec<String>, Vec<Vec<String>>)| -> Vec<String> {
        of.1.iter().map(|row| row[place(&of.0, "var_predicted")].clone()).collect()
    };
    assert_eq!(predicted(&groups), predicted(&prefixes));
    assert!(table(&scratch.path("groups/slopes.csv")).contains_key("asymptotic_slope"));
    // What cannot be made is said, and the nearest taken.
    let said = scratch.run("convergence --sampler jittered -n 16,20,64 -k 3 --integrand gaussian --device cpu");
    assert!(String::from_utf8(said.stderr).unwrap().contains("jittered: n = 16 for 20, the nearest that it can make"));
    // On a shifted grid a cosine below its frequency is integrated exactly: no variance, no slope, no word that is no number.
    let said =
        scratch.run("convergence --sampler grid -n 16,64,256 -k 3 --integrand cosine:x=1 --device cpu --out grid");
    assert!(said.status.success());
    assert!(
        String::from_utf8(said.stderr).unwrap().contains("the predicted variance is 0 at 3 of 3 numbers of points")
    );
    for name in ["convergence.csv", "slopes.csv", "ranks.csv", "summary.json", "convergence.svg"] {
        let text = std::fs::read_to_string(scratch.path(&format!("grid/{name}"))).unwrap();
        assert!(!text.contains("NaN") && !text.contains("inf"), "{name}");
    }
}

#[test]
fn a_spectrum_predicts_without_points() {
    let scratch = Scratch::new();
    let integrands = "--integrand disk --integrand gaussian";
    scratch.ok(&format!("integrate --p jittered -n 1024 {integrands} --out closed"));
    scratch.ok(&format!(
        "integrate --sampler jittered -n 256 -k 40 --stats spectrum {integrands} --device cpu --quiet --out measured"
    ));
    let closed = reader(&scratch, "closed/variance.csv");
    let measured = reader(&scratch, "measured/variance.csv");
    assert_eq!(closed.0, measured.0, "the same columns");
    let value = |of: &(Vec<String>, Vec<Vec<String>>), row: usize, name: &str| -> f64 {
        of.1[row][place(&of.0, name)].parse().unwrap_or(f64::NAN)
    };
    let whole =
        |of: &(Vec<String>, Vec<Vec<String>>), row: usize| value(of, row, "var_spectral") + value(of, row, "tail");
    for (row, name) in ["disk", "gaussian"].into_iter().enumerate() {
        let exact = shifted_jittered(&Integrand::new(name, 2).unwrap(), 32.0);
        // The tail of the disk has P = 1 where it is that but for some parts in a thousand.
        assert!((whole(&closed, row) / exact - 1.0).abs() < 2e-3, "{name}: {} is not {exact}", whole(&closed, row));
        assert!(value(&closed, row, "mean").is_nan() && value(&closed, row, "var_observed").is_nan());
    }
    // The spectrum of a result gives back what was predicted with its points.
    scratch.ok(&format!("integrate --p measured {integrands} --out again"));
    let again = reader(&scratch, "again/variance.csv");
    assert_eq!(value(&again, 0, "n"), 256.0);
    assert!((value(&again, 1, "var_spectral") / value(&measured, 1, "var_spectral") - 1.0).abs() < 1e-4);
    assert!((whole(&again, 0) / whole(&measured, 0) - 1.0).abs() < 0.01);
    let (se, across) = (value(&again, 0, "var_spectral_se"), value(&measured, 0, "var_spectral_se"));
    assert!((0.4..2.5).contains(&(se / across)), "theory {se}, across realizations {across}");
    scratch.fails(
        "integrate --p measured --integrand disk --out measured --force",
        2,
        "holds the spectrum that is read",
    );
    // At another number of points, and the rule is said.
    let said = scratch.run(&format!("integrate --p measured -n 1024 {integrands} --out scaled"));
    assert!(String::from_utf8(said.stderr).unwrap().contains("is taken as a function of m / n^(1/2)"));
    let scaled = reader(&scratch, "scaled/variance.csv");
    for row in 0..2 {
        assert!((whole(&scaled, row) / whole(&closed, row) - 1.0).abs() < 0.2, "{row}: {}", whole(&scaled, row));
    }
    assert_eq!(summary(&scratch.path("scaled"))["prediction"], "P as a function of m / n^(1/d)");
    // Rings alone will do for what is isotropic, and that is said.
    std::fs::remove_file(scratch.path("measured/spectrum.npy")).unwrap();
    let said = scratch.run("integrate --p measured --integrand disk --out rings");
    assert!(String::from_utf8(said.stderr).unwrap().contains("there is no spectrum.npy"));
    let rings = reader(&scratch, "rings/variance.csv");
    assert!((whole(&rings, 0) / whole(&measured, 0) - 1.0).abs() < 0.1);
    // The count of points has its term.
    scratch.ok("integrate --p poisson -n 100 --integrand disk --out poisson");
    let poisson = reader(&scratch, "poisson/variance.csv");
    let f = Integrand::new("disk", 2).unwrap();
    let all = whole(&poisson, 0) + value(&poisson, 0, "count_term");
    assert!((all * 100.0 / f.square_integral() - 1.0).abs() < 1e-9, "int f^2 / lambda");
    std::fs::remove_file(scratch.path("measured/spectrum_radial.csv")).unwrap();
    scratch.fails("integrate --p measured --integrand disk", 1, "measured: has neither spectrum.npy nor rings");
}

/// The columns of a table whose cells may hold commas.
fn quoted(path: &std::path::Path) -> BTreeMap<String, Vec<String>> {
    let mut reader = ::csv::Reader::from_path(path).unwrap();
    let names: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
    let rows: Vec<::csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let column = |k: usize| rows.iter().map(|row| row[k].to_string()).collect();
    names.into_iter().enumerate().map(|(k, name)| (name, column(k))).collect()
}

/// Importance sampling: what is in the table, in the summary and on the terminal is f and how points were placed.
#[test]
fn points_are_placed_by_a_warp() {
    let scratch = Scratch::new();
    let line = "--integrand monomial:x=2,y=1 --intensity monomial:x=1,y=1 --by warp --device cpu";
    let said = scratch.run(&format!("integrate --sampler jittered -n 64 -k 50 {line} --out warp"));
    assert!(said.status.success());
    let said = String::from_utf8_lossy(&said.stdout).into_owned() + &String::from_utf8_lossy(&said.stderr);
    assert!(
        said.contains("points are as dense as monomial:x=1,y=1, by warp; g, P and shifts are of points before that"),
        "{said}"
    );
    let columns = quoted(&scratch.path("warp/variance.csv"));
    let number = |name: &str| columns[name][0].parse::<f64>().unwrap();
    assert_eq!(columns["integrand"], ["monomial:x=2,y=1"]);
    assert!((number("exact") - 1.0 / 6.0).abs() < 1e-15);
    // h = sqrt(u) / 4.
    assert!((number("var_random") * 64.0 - (1.0 / 32.0 - 1.0 / 36.0)).abs() < 1e-9);
    assert!(number("bias").abs() < 5.0 * number("bias_se"));
    assert!((number("var_spatial") - 1.50e-5).abs() < 0.1e-5 && number("var_observed") < 0.3e-5);
    let summary: serde_json::Value =
        serde_json::from_slice(&std::fs::read(scratch.path("warp/summary.json")).unwrap()).unwrap();
    let found = &summary["integration"];
    assert_eq!((&found["intensity"], &found["by"]), (&"monomial:x=1,y=1".into(), &"warp".into()));

    // Points of files are where points were before, too.
    scratch.ok("sample jittered -n 64 -k 50 --out points.npy");
    scratch.ok(&format!("integrate points.npy {line} --quiet --out files"));
    let files = quoted(&scratch.path("files/variance.csv"));
    for name in ["mean", "var_observed", "var_spatial"] {
        let [a, b] = [&columns, &files].map(|t| t[name][0].parse::<f64>().unwrap());
        assert!((a / b - 1.0).abs() < 1e-6, "{name}: {a} and {b}");
    }

    // Placed by itself it has no error; without points, and against n.
    let same = "--integrand ramp --intensity ramp --by warp";
    scratch.ok(&format!("integrate --sampler random -n 20 -k 4 {same} --device cpu --quiet --out none"));
    let none = quoted(&scratch.path("none/variance.csv"));
    for name in ["var_observed", "var_spatial", "var_spectral", "tail", "var_random"] {
        assert_eq!(none[name][0].parse::<f64>().unwrap(), 0.0, "{name}");
    }
    assert_eq!(none["z"][0], "");
    scratch.ok(&format!("integrate --p jittered -n 64 {line} --out closed").replace(" --device cpu", ""));
    let closed = quoted(&scratch.path("closed/variance.csv"));
    let closed: f64 = ["var_spectral", "tail"].iter().map(|name| closed[*name][0].parse::<f64>().unwrap()).sum();
    assert!((closed - 1.50e-5).abs() < 0.05e-5, "{closed}");
    scratch.ok(&format!("convergence --sampler random -n 16,64 -k 20 {line} --quiet --out rates"));
    let rates = quoted(&scratch.path("rates/convergence.csv"));
    assert_eq!(rates["integrand"], ["monomial:x=2,y=1", "monomial:x=2,y=1"]);
}

/// A flag that says nothing about files, or about samplers, is no flag that is passed over.
#[test]
fn flags_of_samplers_go_with_samplers_and_those_of_files_with_files() {
    let scratch = Scratch::new();
    scratch.ok("sample jittered -n 64 -k 4 --quiet --out points.npy");
    for flag in ["-n 16,64", "-k 10", "--dim 3", "--seed 4", "--param radius=0.1"] {
        scratch.fails(&format!("convergence points.npy {flag} --integrand disk"), 2, "cannot be used with");
    }
    for flag in ["--prefixes 16,64", "--columns 1,2", "--wrap"] {
        let line = format!("convergence --sampler random -n 16,64 -k 4 {flag} --integrand disk");
        scratch.fails(&line, 2, "cannot be used with");
    }
}
