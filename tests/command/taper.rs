//! Spectra of windows end to end.

use crate::shared::in_data;

#[test]
fn flags_reach_the_spectrum_or_are_refused() {
    let scratch = tempfile::tempdir().unwrap();
    let frequencies = scratch.path().join("nu.csv");
    std::fs::write(&frequencies, "0.01,0.004\n0.02,0\n0,0\n").unwrap();
    let trees = "analyze swedishpines.csv --window 0,96,0,100 --stats spectrum --device cpu --quiet";
    let out = scratch.path().join("list");
    let line =
        format!("{trees} --frequencies {} --taper sine --tapers 2 --out {}", frequencies.display(), out.display());
    let output = in_data(&line);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    assert!(summary.contains("sine taper, orders 1 to 2 per axis averaged, debias direct"), "{summary}");

    for (arguments, said) in [
        ("--tapers 2", "--taper sine"),
        ("--taper bartlett --tapers 1", "--taper sine"),
        ("--taper sine --tapers 0", "expected 1 to 64"),
        ("--taper sine --tapers 65", "expected 1 to 64"),
    ] {
        let output = in_data(&format!("{trees} {arguments} --out never"));
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && errors.contains(said), "{arguments}: {errors}");
    }
    for flag in ["--taper sine", "--tapers 2", "--debias none"] {
        let line = format!("analyze --sampler random -n 64 --stats spectrum {flag} --device cpu --quiet --out never");
        let errors = String::from_utf8(in_data(&line).stderr).unwrap();
        assert!(errors.contains("is about a window"), "{flag}: {errors}");
    }
}
