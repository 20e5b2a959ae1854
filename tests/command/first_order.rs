//! Counts and the intensity from the command line to their files.

use crate::shared::{Scratch, summary, table};

#[test]
fn counts_reach_the_files() {
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler jittered -n 64 -k 20 --stats counts --device cpu --out two");
    let rows = table(&scratch.path("two/counts.csv"));
    let number = |row: usize, column: &str| rows[column][row].parse::<f64>().unwrap();
    let n = rows["shape"].len();
    assert!(rows["shape"].iter().any(|s| s == "box") && rows["shape"].iter().any(|s| s == "ball"));
    (0..n).for_each(|row| {
        // Boxes are at every place of their lattice, and count every point as often.
        let slack = if rows["shape"][row] == "box" { 1e-9 } else { 6.0 * number(row, "mean_se") };
        assert!((number(row, "mean") - 64.0 * number(row, "measure")).abs() < slack);
        assert!((number(row, "random") - 1.0 + number(row, "measure")).abs() < 1e-12);
    });
    let found = &summary(&scratch.path("two"))["counts"];
    assert_eq!(found["errors"], "across-realizations");
    assert_eq!(found["sizes"], n);
    assert!(found["largest_ball"]["dispersion"].as_f64().unwrap() < 0.4, "{found}");
    let svg = std::fs::read_to_string(scratch.path("two/counts.svg")).unwrap();
    assert!(svg.contains("disks") && svg.contains("boxes") && svg.contains("Poisson: 1"));
    // One realization has no errors; the reference counts the same.
    for device in ["cpu", "reference"] {
        scratch.ok(&format!("analyze --sampler grid -n 16 --dim 1 --stats counts --device {device} --out {device}"));
    }
    let one = table(&scratch.path("cpu/counts.csv"));
    assert_eq!(one, table(&scratch.path("reference/counts.csv")));
    assert!(one["variance_se"].iter().all(String::is_empty));
    let found = &summary(&scratch.path("cpu"))["counts"];
    assert!(found["errors"].is_null() && found["largest_ball"].is_null());
    scratch.ok("plot two --figure counts --log-x --out again.svg");
}

#[test]
fn the_intensity_reaches_the_files() {
    let scratch = Scratch::new();
    // Twice as many on the left, every point with a weight that says nothing here.
    let points: String = (0..90)
        .map(|k| {
            let x = if k % 3 == 0 { 0.5 + 0.005 * f64::from(k) } else { 0.005 * f64::from(k) };
            format!("{x},{},{k}\n", f64::from(k * 37 % 90) / 90.0)
        })
        .collect();
    scratch.file("p.csv", &format!("x,y,w\n{points}"));
    let warnings = |dir: &str| summary(&scratch.path(dir))["warnings"].to_string();
    scratch.ok("analyze p.csv --columns x,y --window 0,1,0,1 --stats intensity --intensity-grid 10 --out scott");
    let found = summary(&scratch.path("scott"))["intensity"].clone();
    let values = |dir: &str, len: usize| {
        let bytes = std::fs::read(scratch.path(&format!("{dir}/intensity.npy"))).unwrap();
        let (values, _) = bytes[bytes.len() - 8 * len..].as_chunks::<8>();
        values.iter().map(|v| f64::from_le_bytes(*v)).collect::<Vec<_>>()
    };
    let lambda = values("scott", 100);
    // x slowest: the left half first.
    let [left, right] = [&lambda[..50], &lambda[50..]].map(|half| half.iter().sum::<f64>());
    assert!(left > 1.2 * right, "{left} {right}");
    assert!((found["mean"].as_f64().unwrap() - 90.0).abs() < 1e-12);
    let integral = lambda.iter().sum::<f64>() / 100.0;
    assert!((found["integral"].as_f64().unwrap() / integral - 1.0).abs() < 1e-12);
    // Scott's rule as it is written: the standard deviations of both columns, n^(-1/6).
    let columns: Vec<Vec<f64>> =
        (0..2).map(|c| points.lines().map(|l| l.split(',').nth(c).unwrap().parse().unwrap()).collect()).collect();
    let sd = |x: &Vec<f64>| {
        let mean = x.iter().sum::<f64>() / 90.0;
        (x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 89.0).sqrt()
    };
    let expected = (sd(&columns[0]) * sd(&columns[1])).sqrt() * 90f64.powf(-1.0 / 6.0);
    assert!((found["bandwidth"].as_f64().unwrap() / expected - 1.0).abs() < 1e-9, "{found}, not {expected}");
    assert!(scratch.path("scott/intensity.png").exists() && !scratch.path("scott/intensity_se.npy").exists());
    let line = "analyze p.csv --columns x,y --weight-column w --window 0,1,0,1 --stats intensity,counts,pcf --intensity-bandwidth";
    scratch.ok(&format!("{line} likelihood --out likelihood"));
    assert!(warnings("likelihood").contains("the intensity counts every point once"));
    assert!(warnings("likelihood").contains("counts count every point once"));
    let chosen = summary(&scratch.path("likelihood"))["intensity"]["bandwidth"].as_f64().unwrap();
    assert!((0.02..=0.25).contains(&chosen), "{chosen}");
    scratch.ok(&format!("{line} 0.001 --intensity-grid 20 --out thin"));
    assert!(warnings("thin").contains("less than half a cell"));
    // Several realizations in one and three dimensions, with errors and the plane in the middle.
    scratch.ok("analyze --sampler thomas -n 50 -k 3 --dim 3 --stats intensity --intensity-grid 8 --out three");
    assert!(scratch.path("three/intensity_se.npy").exists() && scratch.path("three/intensity.png").exists());
    scratch.ok("analyze --sampler random -n 50 -k 3 --dim 1 --stats intensity --out line");
    assert!(scratch.path("line/intensity.npy").exists() && !scratch.path("line/intensity.png").exists());
    // Both in a polygon.
    scratch.file("l.wkt", "POLYGON ((0 0, 1 0, 1 0.6, 0.6 0.6, 0.6 1, 0 1, 0 0))");
    scratch.file("in.csv", "0.1,0.2\n0.3,0.9\n0.8,0.3\n0.5,0.5\n");
    scratch.ok("analyze in.csv --window-polygon l.wkt --stats intensity,counts --intensity-grid 10 --out notched");
    let lambda = values("notched", 100);
    assert!(lambda[99] == 0.0 && lambda[0] > 0.0 && lambda.iter().all(|x| x.is_finite()));
}

/// Weighted by the inverse of an intensity: from a column, a function and the points themselves.
#[test]
fn an_inhomogeneous_process_reaches_the_files() {
    let scratch = Scratch::new();
    // Thrice as many on the left; a column that says so, up to a factor.
    let points: String = (0..120)
        .map(|k| {
            let x = f64::from(k * 53 % 120) / 240.0 + if k % 4 == 0 { 0.5 } else { 0.0 };
            format!("{x},{},{}\n", f64::from(k * 37 % 120) / 120.0, if x < 0.5 { 3 } else { 1 })
        })
        .collect();
    scratch.file("p.csv", &format!("x,y,lambda\n{points}"));
    let line = "analyze p.csv --columns x,y --window 0,1,0,1 --stats pcf,k-function,spectrum,neighbors --bins 10 --device cpu --out";
    scratch.ok(&format!("{line} plain"));
    scratch.ok(&format!("{line} column --intensity-column lambda"));
    scratch.ok(&format!("{line} formula --inhomogeneous formula:2-signum(x-0.5)"));
    scratch.ok(&format!("{line} estimate --inhomogeneous estimate --intensity-bandwidth 0.2"));
    let g = |dir: &str| table(&scratch.path(&format!("{dir}/pcf.csv")))["g"].clone();
    assert_eq!(g("column"), g("formula"));
    assert!(g("column") != g("plain") && g("estimate") != g("plain") && g("estimate") != g("column"));
    let of = |dir: &str| summary(&scratch.path(dir))["inhomogeneous"].clone();
    assert!(of("plain").is_null());
    assert_eq!(of("column")["intensity"], "column lambda");
    assert_eq!((&of("column")["least"], &of("column")["largest"]), (&1.0.into(), &3.0.into()));
    let left = points.lines().filter(|l| l.ends_with(",3")).count() as f64;
    let mean = left / 3.0 + 120.0 - left;
    assert!((of("column")["inverse_mean"].as_f64().unwrap() - mean).abs() < 1e-9);
    assert_eq!(of("formula")["intensity"], "formula:2-signum(x-0.5)");
    let estimate = of("estimate");
    assert_eq!(
        (&estimate["rule"], &estimate["bandwidth"], &estimate["others"]),
        (&"given".into(), &0.2.into(), &0.into())
    );
    assert!((estimate["inverse_mean"].as_f64().unwrap() - 1.0).abs() < 0.2, "{estimate}");
    for dir in ["column", "formula", "estimate"] {
        let said = summary(&scratch.path(dir))["warnings"].to_string();
        assert!(said.contains("are those of an inhomogeneous process; not neighbors"), "{said}");
        assert_eq!(said.contains("estimated from the points themselves"), dir == "estimate");
        for file in ["pcf.svg", "k_function.svg", "spectrum_radial.svg", "spectrum_axes.svg"] {
            let svg = std::fs::read_to_string(scratch.path(&format!("{dir}/{file}"))).unwrap();
            assert!(svg.contains(", inhomogeneous"), "{dir}/{file}");
        }
        let page = std::fs::read_to_string(scratch.path(&format!("{dir}/report.html"))).unwrap();
        assert!(page.contains("Points count 1/<i>λ</i> here") && page.contains("Weights 1/<i>λ</i>"));
    }
    assert!(!std::fs::read_to_string(scratch.path("plain/pcf.svg")).unwrap().contains("inhomogeneous"));
}
