//! The conventions of other programs: against figures of theirs.

use crate::shared::in_data;
use pairwave::plan::Convention;

/// A column of a CSV file; empty cells are NaN.
fn column(text: &str, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let at = reader.headers().unwrap().iter().position(|h| h == name).unwrap_or_else(|| panic!("no column {name}"));
    reader.records().map(|r| r.unwrap()[at].parse().unwrap_or(f64::NAN)).collect()
}

/// The first row whose values differ by more than `relative` and `absolute` allow; NaN differs from everything.
fn differs(ours: &[f64], theirs: &[f64], relative: f64, absolute: f64) -> Option<usize> {
    assert_eq!(ours.len(), theirs.len());
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= absolute + relative * b.abs();
    ours.iter().zip(theirs).position(|pair| !near(pair))
}

#[test]
fn psa_figures_are_reproduced() {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("out");
    let arguments = format!(
        "analyze jittered2d_n1024.npy --convention psa --accuracy high --device cpu --quiet --out {}",
        out.display()
    );
    let output = in_data(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();

    let (ours, theirs) = (read("spectrum_radial.csv"), include_str!("../data/jittered2d_n1024_psa_spectrum.csv"));
    for (name, relative, absolute) in
        [("nu", 0.0, 0.0), ("modes", 0.0, 0.0), ("p", 1e-9, 0.0), ("anisotropy_db", 0.0, 1e-6)]
    {
        let (mut ours, theirs) = (column(&ours, name), column(theirs, name));
        assert_eq!(differs(&ours, &theirs, relative, absolute), None, "{name}");
        // What is more than the tolerance off must be seen.
        ours[41] += 2.0 * (relative * ours[41].abs() + absolute) + 1e-9;
        assert_eq!(differs(&ours, &theirs, relative, absolute), Some(41), "{name}");
    }
    let (ours, theirs) = (read("pcf.csv"), include_str!("../data/jittered2d_n1024_psa_pcf.csv"));
    let ordered: Vec<f64> = column(theirs, "unordered_pairs").iter().map(|c| 2.0 * c).collect();
    assert_eq!(differs(&column(&ours, "count"), &ordered, 0.0, 0.0), None);
    assert_eq!(differs(&column(&ours, "r"), &column(theirs, "r"), 1e-10, 1e-13), None);
    assert_eq!(differs(&column(&ours, "r"), &column(&ours, "r_lo"), 0.0, 0.0), None, "left edges");
    assert_eq!(differs(&column(&ours, "g"), &column(theirs, "g"), 1e-9, 0.0), None);

    let summary: serde_json::Value = serde_json::from_str(&read("summary.json")).unwrap();
    let convention = &summary["convention"];
    assert_eq!(convention["name"], "psa");
    assert_eq!(convention["spectrum_radial"], Convention::Psa.resolve(false).labels);
    assert!((convention["effective_nyquist"].as_f64().unwrap() - 0.2).abs() < 5e-4, "{convention}");
    assert!((convention["oscillation"].as_f64().unwrap() - 0.22977).abs() < 1e-4, "{convention}");
    let distance = |name: &str| summary["neighbors"][name].as_f64().unwrap();
    assert!((distance("mean_minimum_relative") - 0.075).abs() < 6e-4);
    assert!((distance("mean_relative") - 0.565).abs() < 6e-4);
    // m from -160 to 159.
    let bytes = std::fs::read(out.join("spectrum.npy")).unwrap();
    let spectrum = npyz::NpyFile::new(&bytes[..]).unwrap();
    assert_eq!(spectrum.shape(), [320, 320]);
    let spectrum: Vec<f64> = spectrum.into_vec().unwrap();
    assert!((spectrum[160 * 320 + 160] - 1024.0).abs() < 1e-9, "P(0) = n at index F");
    let at = |m0: i32, m1: i32| spectrum[((m0 + 160) * 320 + m1 + 160) as usize];
    assert_eq!(at(-7, 5), at(7, -5));
    assert_ne!(at(-7, 5), at(7, 5));
}

/// g of few points reaches beyond half the side, where the square holds only parts of the rings.
#[test]
fn psa_g_beyond_half_the_side() {
    let scratch = tempfile::tempdir().unwrap();
    let g = |flag: &str| {
        let out = scratch.path().join(format!("out{flag}"));
        let arguments = format!(
            "analyze --sampler random -n 100 -k 400 --stats pcf --convention psa {flag} --device cpu --quiet --out {}",
            out.display()
        );
        let output = in_data(&arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read_to_string(out.join("pcf.csv")).unwrap();
        (column(&text, "r_lo"), column(&text, "g"), column(&text, "g_se"))
    };
    let (r, right, se) = g("");
    let (_, wrong, _) = g("--bug-compatible");
    for b in 0..r.len() {
        assert!((right[b] - 1.0).abs() < 5.0 * se[b].max(0.01), "g({}) = {} +- {}", r[b], right[b], se[b]);
        if r[b] > 0.55 {
            assert!(wrong[b] < 0.8, "g({}) = {}: rings are counted whole", r[b], wrong[b]);
        }
    }
    assert!(r.iter().any(|&r| r > 0.55));
}

#[test]
fn what_they_could_not_do_is_refused() {
    for (arguments, said) in [
        ("--bug-compatible", "--bug-compatible"),
        ("--convention pspec --bug-compatible", "no defect of pspec"),
        ("--convention psa --dim 3 -n 27", "two dimensions"),
        ("--convention psa --box 1,2", "equal sides"),
        ("--convention psa --r-max 0.1", "--r-max"),
        ("--convention psa --normalization intensity", "--normalization"),
        ("--convention utk --sectors 9", "--sectors"),
        ("--convention utk --max-frequency 4,5", "one number"),
        ("--convention utk --max-frequency 1", "at least 2"),
        ("--convention utk --stats pcf", "needs spectrum or radial"),
        ("--convention utk --sampler thomas", "as many points in every realization"),
    ] {
        let sampler = if arguments.contains("--sampler") { "" } else { "--sampler random" };
        let n = if arguments.contains("-n ") { "" } else { "-n 64" };
        let line = format!("analyze {sampler} {n} -k 3 {arguments} --device cpu --quiet --out never");
        let output = in_data(&line);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && errors.contains(said), "{line}: {errors}");
    }
    let window = in_data("analyze swedishpines.csv --window 0,96,0,100 --convention psa --quiet --out never");
    assert!(String::from_utf8(window.stderr).unwrap().contains("is for a torus"));
}
