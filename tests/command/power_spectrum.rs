//! P, lists, rings and covariances end to end.

use crate::shared::{Scratch, column, csv, npy, summary};

/// The smallest inputs: one point, one realization, rings of one pair.
#[test]
fn spectra_of_next_to_nothing() {
    let scratch = Scratch::new();
    scratch.file("one.csv", "0.3,0.4\n");
    scratch.file("zero.csv", "0 0\n3 4\n0 0\n");
    scratch.ok("analyze one.csv --stats spectrum --frequencies zero.csv --device cpu --out list");
    let list = csv(&scratch.path("list/spectrum_list.csv"));
    // P(0) is n wherever the point is; elsewhere the error of an exponential ordinate is its mean.
    for (k, (p, se)) in column::<f64>(&list, "p").into_iter().zip(column::<f64>(&list, "p_se")).enumerate() {
        let expected = if k == 1 { 1.0 } else { 0.0 };
        assert!((p - 1.0).abs() < 1e-12 && (se - expected).abs() < 1e-12, "{p} +- {se}");
    }
    scratch.ok("analyze one.csv --stats spectrum --device cpu --out grid");
    let summary = std::fs::read_to_string(scratch.path("grid/summary.json")).unwrap();
    assert!(summary.contains("\"dc_p\": 1.0,\n    \"dc_p_se\": 0.0"), "{summary}");
    scratch.ok("analyze one.csv --stats spectrum --convention psa --device cpu --out psa");
    let summary = std::fs::read_to_string(scratch.path("psa/summary.json")).unwrap();
    assert!(summary.contains("PSA's route are left out: they need pairs of points"), "{summary}");
    // In one dimension rings are pairs, which the grid holds all.
    let points = "analyze --sampler random -n 50 --dim 1 --stats radial --max-frequency 40 --device cpu";
    scratch.ok(&format!("{points} --out whole"));
    scratch.ok(&format!("{points} --ring-directions 1 --out few"));
    let [whole, few] = ["whole", "few"].map(|name| csv(&scratch.path(&format!("{name}/spectrum_radial.csv"))));
    assert_eq!(whole, few);
}

/// P at the wave vectors of a list is that of the grid, in the order of the list, with its bands; DC has none.
#[test]
fn lists_of_wave_vectors() {
    let scratch = Scratch::new();
    let points = "--sampler jittered -n 64 -k 5 --box 2,1 --stats spectrum --accuracy high --threads 1";
    scratch.file("list.csv", "m_x,m_y # integers\n3,-2\n0 0\n\n-3; 2\n# on\n5.0,1e1\n100000,-99999\n");
    scratch.ok(&format!("analyze {points} --frequencies list.csv --out list"));
    scratch.ok(&format!("analyze {points} --max-frequency 5,10 --out grid"));
    let list = csv(&scratch.path("list/spectrum_list.csv"));
    assert_eq!(list.0, "m_x,m_y,nu_x,nu_y,nu,p,p_se,p_lo,p_hi,p_band");
    assert_eq!(column::<i64>(&list, "m_x"), [3, 0, -3, 5, 100_000]);
    assert_eq!(column::<i64>(&list, "m_y"), [-2, 0, 2, 10, -99_999]);
    assert_eq!(column::<f64>(&list, "nu_x")[..4], [1.5, 0.0, -1.5, 2.5]);
    assert_eq!(column::<f64>(&list, "nu")[0], 2.5);
    let (p, p_se) = (column::<f64>(&list, "p"), column::<f64>(&list, "p_se"));
    for (file, values) in [("grid/spectrum.npy", &p), ("grid/spectrum_se.npy", &p_se)] {
        let (shape, grid) = npy(&scratch.path(file));
        assert_eq!(shape, [11, 21]);
        for (k, m) in [[3, -2], [0, 0], [-3, 2], [5, 10]].into_iter().enumerate() {
            let at = ((m[0] + 5) * 21 + m[1] + 10) as usize;
            assert!(
                (values[k] - grid[at]).abs() <= 1e-10 * (1.0 + grid[at]),
                "{file}, {m:?}: {} {}",
                values[k],
                grid[at]
            );
        }
    }
    // 10 degrees of freedom: 10 / 20.4832 and 10 / 3.24697 (tables of chi-squared).
    for k in [0, 2, 3, 4] {
        let band = [&list.1[k][7], &list.1[k][8]].map(|cell| cell.parse::<f64>().unwrap() / p[k]);
        assert!((band[0] - 0.488_205).abs() < 1e-5 && (band[1] - 3.079_80).abs() < 1e-4, "{band:?}");
    }
    assert_eq!(list.1[1][7..], ["", "", ""]);
    let files: Vec<String> = summary(&scratch.path("list"))["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f.as_str().unwrap().into())
        .collect();
    assert_eq!(files, ["spectrum_list.csv", "points.svg", "run.toml", "report.html", "summary.json"]);

    // A window: cycles per unit length.
    scratch.file("points.csv", "0,10\n1,12\n3.5,13\n");
    scratch.file("nu.txt", "0.125 0\n0.3 -0.7\n");
    scratch.ok("analyze points.csv --window 0,4,10,14 --stats spectrum --frequencies nu.txt --out window");
    let list = csv(&scratch.path("window/spectrum_list.csv"));
    assert_eq!((column::<f64>(&list, "m_x"), column::<f64>(&list, "m_y")), (vec![0.5, 1.2], vec![0.0, -2.8]));
    assert!((column::<f64>(&list, "nu_y")[1] + 0.7).abs() < 1e-15);
}

/// A radial mean from some of the directions is that of the listed members, and says which they are.
#[test]
fn rings_of_some_directions() {
    let scratch = Scratch::new();
    let points = "--sampler jittered -n 100 -k 4 --stats radial --accuracy high";
    let radial = |out: &str, more: &str| {
        scratch.ok(&format!("analyze {points} {more} --out {out}"));
        csv(&scratch.path(out).join("spectrum_radial.csv"))
    };
    let whole = radial("whole", "--max-frequency 12");
    let all = radial("all", "--max-frequency 12 --ring-directions 1000");
    let some = radial("some", "--max-frequency 12 --ring-directions 6");
    assert_eq!(column::<u64>(&whole, "modes"), column::<u64>(&all, "modes"));
    for name in ["p", "p_se", "anisotropy_db"] {
        for (a, b) in column::<f64>(&whole, name).into_iter().zip(column::<f64>(&all, name)) {
            assert!((a - b).abs() <= 1e-9 * a.abs().max(1.0), "{name}: {a} {b}");
        }
    }
    let (modes, independent) = (column::<u64>(&some, "modes"), column::<u64>(&some, "independent_modes"));
    assert_eq!(modes[..2], column::<u64>(&whole, "modes")[..2]);
    assert!(independent.iter().zip(&modes).all(|(i, m)| *i <= 6 && 2 * i == *m), "{modes:?}");
    let radial = &summary(&scratch.path("some"))["radial"];
    assert_eq!(radial["modes"].as_u64().unwrap(), modes.iter().sum::<u64>());
    assert!(radial["directions"].as_str().unwrap().contains("golden ratio"));
    assert_eq!(summary(&scratch.path("whole"))["radial"]["directions"], "all");
    // The grid would be 1.6e9 modes.
    scratch.ok("analyze --sampler random -n 2 --stats radial --max-frequency 20000 --ring-directions 2 --out far");
    assert_eq!(csv(&scratch.path("far/spectrum_radial.csv")).1.len(), 20_000);
}

/// The covariance of amplitudes: the matrix, its errors, a picture and a few numbers; a single realization is told apart.
#[test]
fn covariances_reach_the_files() {
    let scratch = Scratch::new();
    let points = "analyze --sampler jittered -n 64 --dim 2 --stats covariance --covariance-frequency 3";
    scratch.ok(&format!("{points} -k 40 --out many --threads 1"));
    scratch.ok(&format!("{points} -k 40 --out again --threads 3"));
    scratch.ok(&format!("{points} -k 1 --out one"));
    let bytes = |dir: &str, file: &str| std::fs::read(scratch.path(dir).join(file)).unwrap();
    for file in ["covariance.npy", "covariance_se.npy", "covariance.png"] {
        assert!(bytes("many", file) == bytes("again", file), "{file}");
    }
    let header = String::from_utf8_lossy(&bytes("many", "covariance.npy")[..80]).into_owned();
    assert!(header.contains("'<c16'") && header.contains("(49, 49, )"), "{header}");
    let (shape, se) = npy(&scratch.path("many/covariance_se.npy"));
    assert!(shape == [49, 49] && se.iter().all(|x| x.is_finite()));
    let many = summary(&scratch.path("many"));
    let found = &many["covariance"];
    assert_eq!((found["modes"].as_u64(), found["max_frequency"].as_u64()), (Some(49), Some(3)));
    assert!(found["rms_z"].as_f64().unwrap() > 0.0 && found["off_diagonal_share"].as_f64().unwrap() < 1.0);
    assert!(std::fs::read_to_string(scratch.path("many/report.html")).unwrap().contains("Covariance of amplitudes"));
    let one = summary(&scratch.path("one"));
    assert!(one["covariance"]["rms_z"].is_null() && !scratch.path("one/covariance_se.npy").exists());
    assert!(one["warnings"][0].as_str().unwrap().contains("expectation over realizations"));
    let refused = scratch.run(&format!("{points}000 -k 2 --out huge"));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("bytes") && refused.status.code() == Some(2));
}
