//! Curves of results drawn again.

use crate::shared::Scratch;

#[test]
fn results_are_drawn_again_and_over_each_other() {
    let scratch = Scratch::new();
    for sampler in ["jittered", "sobol"] {
        scratch.ok(&format!("analyze --sampler {sampler} -n 64 -k 8 --stats pcf,radial --device cpu --out {sampler}"));
    }
    let printed = scratch.ok("plot jittered sobol --figure spectrum_radial --labels Cells,Net --log-x --out both.svg");
    assert_eq!(printed.trim_end(), "both.svg");
    let text = std::fs::read_to_string(scratch.path("both.svg")).unwrap();
    let picture = roxmltree::Document::parse(&text).unwrap();
    let texts: Vec<&str> = picture.descendants().filter_map(|node| node.text()).collect();
    for name in ["Cells", "Net", "P = 1"] {
        assert!(texts.contains(&name), "{name} is missing: {texts:?}");
    }
    // One curve per result, beside levels and ticks.
    scratch.ok("plot jittered --out all");
    assert!(scratch.path("all/pcf.svg").exists() && scratch.path("all/spectrum_radial.svg").exists());
    for (arguments, message) in [
        ("nowhere --out a.svg", "nowhere: "),
        ("jittered --figure zzz --out a.svg", "--figure zzz: expected one of pcf, spectrum_radial"),
        ("jittered --figure pcf --x 5,1 --out a.svg", "--x 5,1: expected two numbers LO,HI, the first the smaller"),
        ("jittered --figure pcf --x 0,1 --log-x --out a.svg", "--x 0,1: a logarithmic axis begins above 0"),
        ("jittered --figure pcf --out a.gif", "--out a.gif: expected a directory, or a file that ends with .svg"),
    ] {
        let run = scratch.run(&format!("plot {arguments}"));
        let said = String::from_utf8(run.stderr).unwrap();
        assert!(!run.status.success() && said.starts_with(&format!("error: {message}")), "{arguments}: {said}");
        assert!(!scratch.path("a.svg").exists());
    }
}
