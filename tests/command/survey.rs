//! Discrepancies, pairs of axes and prefixes, end to end.

use crate::shared::{Scratch, npy, summary, table};

/// scipy 1.17.1 of the first 50 points frac((i + 1) sqrt(p)), p = 2, 3, 5, 7, 11, 13: L2-star, CD, WD, MD; and of axes 2 and 5.
const SIX: [f64; 4] = [0.012182831099576557, 0.011343667692855552, 0.02768787687605112, 0.05415158258544572];

fn points(scratch: &Scratch, name: &str, n: u32) {
    let x = |i: u32, p: f64| ((f64::from(i) + 1.0) * p.sqrt()) % 1.0;
    let row = |i| [2.0, 3.0, 5.0, 7.0, 11.0, 13.0].map(|p| format!("{:?}", x(i, p))).join(",");
    let rows: Vec<String> = (0..n).map(row).collect();
    std::fs::write(scratch.path(name), format!("a,b,c,d,e,f\n{}\n", rows.join("\n"))).unwrap();
}

fn number(cell: &str) -> f64 {
    cell.parse().unwrap()
}

#[test]
fn discrepancies_reach_the_files() {
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler sobol -n 64 -k 3 --stats discrepancy --device cpu --out net");
    let rows = table(&scratch.path("net/discrepancy.csv"));
    assert_eq!(rows["t"], ["0", "0", "0"]);
    let found = &summary(&scratch.path("net"))["discrepancy"];
    let mean = rows["star_l2"].iter().map(|cell| number(cell)).sum::<f64>() / 3.0;
    assert!((found["star_l2"]["mean"].as_f64().unwrap() - mean).abs() < 1e-15);
    for name in ["star_l2", "centered_l2", "wrap_around_l2", "mixture_l2", "diaphony"] {
        for (root, square) in rows[name].iter().zip(&rows[format!("{name}_squared").as_str()]) {
            assert!((number(root).powi(2) / number(square) - 1.0).abs() < 1e-14, "{name}");
        }
        assert!(found[name]["squared_se"].as_f64().unwrap() > 0.0);
    }
    assert_eq!(found["t"]["largest"], 0);
    let levels = table(&scratch.path("net/elementary_intervals.csv"));
    assert_eq!(
        (levels["level"].len(), &levels["shapes"][6], &levels["share"][6]),
        (7, &"21".to_string(), &"1.0".to_string())
    );
    // The same numbers from a file and by the reference.
    scratch.ok("sample sobol -n 64 -k 3 --out net.npy");
    scratch.ok("analyze net.npy --stats discrepancy --device reference --out again");
    let again = table(&scratch.path("again/discrepancy.csv"));
    for (a, b) in rows["mixture_l2"].iter().zip(&again["mixture_l2"]) {
        assert!((number(a) - number(b)).abs() < 1e-13);
    }
    scratch.fails("analyze net.npy --window-polygon p.wkt --stats discrepancy", 1, "p.wkt");
}

#[test]
fn every_pair_of_axes() {
    let scratch = Scratch::new();
    points(&scratch, "six.csv", 50);
    scratch.ok("analyze six.csv --projections --device cpu --out six");
    let rows = table(&scratch.path("six/projections.csv"));
    assert_eq!(rows["axes"].len(), 16);
    assert_eq!(rows["axes"][..3], ["all", "1-2", "1-3"]);
    let of = |name: &str, row: usize| number(&rows[name][row]);
    let names = ["star_l2", "centered_l2_squared", "wrap_around_l2_squared", "mixture_l2_squared"];
    for (name, expected) in names.into_iter().zip(SIX) {
        assert!((of(name, 0) - expected).abs() < 1e-12, "{name}: {} is not {expected}", of(name, 0));
    }
    // A pair is what it is alone.
    let row = rows["axes"].iter().position(|name| name == "2-5").unwrap();
    scratch.ok("analyze six.csv --columns b,e --stats pcf,radial,discrepancy --device cpu --out pair");
    let alone = &summary(&scratch.path("pair"))["discrepancy"];
    assert_eq!(alone["centered_l2"]["mean"].as_f64().unwrap(), of("centered_l2", row));
    for (file, alone, columns) in [
        ("projections_pcf.csv", "pcf.csv", &["r", "g", "g_se"][..]),
        ("projections_radial.csv", "spectrum_radial.csv", &["nu", "p", "p_se"]),
    ] {
        let (all, alone) =
            (table(&scratch.path(&format!("six/{file}"))), table(&scratch.path(&format!("pair/{alone}"))));
        for &name in columns {
            let pair: Vec<&String> =
                all["axes"].iter().zip(&all[name]).filter(|(axes, _)| *axes == "2-5").map(|(_, cell)| cell).collect();
            assert!(pair.iter().copied().eq(&alone[name]), "{file} {name}");
        }
    }
    let sheet = std::fs::read_to_string(scratch.path("six/projections.svg")).unwrap();
    let sheet = roxmltree::Document::parse(&sheet).unwrap();
    let count = |name: &str| sheet.descendants().filter(|node| node.has_tag_name(name)).count();
    assert_eq!((count("image"), count("path")), (15, 15));
    // What is not asked for is not guessed; samplers of more than 3 dimensions have nothing else.
    scratch.fails("analyze six.csv --out no", 1, "--columns");
    scratch.ok("analyze --sampler halton -n 32 --dim 4 --device cpu --out four");
    assert_eq!(table(&scratch.path("four/projections.csv"))["axes"].len(), 7);
    scratch.fails("analyze six.csv --projections --stats covariance", 2, "--stats covariance: ");
    scratch.fails("analyze six.csv --projections --box 1,1", 1, "--columns chooses fewer");
    scratch.fails("analyze six.csv --projections --box 1,1,1,1,1,0.5", 1, "coordinate 6 = ");
    scratch.fails("analyze --sampler random -n 9 --dim 1 --projections", 2, "--projections");
}

#[test]
fn prefixes_are_the_first_points() {
    let scratch = Scratch::new();
    let line = "--stats radial,discrepancy --device cpu";
    scratch.ok(&format!("analyze --sampler sobol -k 3 --prefixes 2^3..2^6 {line} --out all"));
    let rows = table(&scratch.path("all/prefixes.csv"));
    assert_eq!(rows["n"], ["8.0", "16.0", "32.0", "64.0"]);
    assert_eq!(rows["t"], ["0"; 4]);
    // A prefix of a sequence is its set of fewer points.
    for (row, n) in [8, 16, 32, 64].into_iter().enumerate() {
        scratch.ok(&format!("analyze --sampler sobol -n {n} -k 3 {line} --out {n}"));
        let alone = &summary(&scratch.path(&n.to_string()))["discrepancy"];
        assert_eq!(alone["star_l2"]["mean"].as_f64().unwrap(), number(&rows["star_l2"][row]));
        assert_eq!(alone["covering_radius"]["mean"].as_f64().unwrap(), number(&rows["covering_radius_mean"][row]));
    }
    let radial = table(&scratch.path("all/prefixes_radial.csv"));
    assert_eq!(radial["n"].iter().filter(|n| *n == "64.0").count(), 40);
    assert!(scratch.path("all/prefixes.svg").exists() && scratch.path("all/prefixes_radial.svg").exists());
    points(&scratch, "six.csv", 50);
    scratch.ok("analyze six.csv --prefixes 10,50 --device cpu --out six");
    let rows = table(&scratch.path("six/prefixes.csv"));
    assert!((number(&rows["star_l2"][1]) - SIX[0]).abs() < 1e-12, "of all six axes");
    scratch.fails("analyze six.csv --prefixes 10,51", 2, "--prefixes 51: a realization has only 50 points");
    for wrong in ["5,3", "x", "2^80..2^90", "8..4", "0,4"] {
        scratch.fails(&format!("analyze six.csv --prefixes {wrong}"), 2, "expected two numbers of points");
    }
    let said = scratch.run("analyze --sampler jittered -n 64 --prefixes 16,64 --device cpu");
    assert!(String::from_utf8(said.stderr).unwrap().contains("is no sequence"));
    let (shape, _) = {
        scratch.ok("sample sobol -n 64 --out s.npy");
        npy(&scratch.path("s.npy"))
    };
    assert_eq!(shape, [64, 2]);
}
