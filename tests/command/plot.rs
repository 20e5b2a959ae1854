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
        ("jittered --figure pcf --y -1,2 --log-y --out a.svg", "--y -1,2: a logarithmic axis begins above 0"),
        (
            "jittered --figure spectrum --out a.svg",
            "--figure spectrum: is no curve; expected one of pcf, spectrum_radial",
        ),
        (
            "jittered --figure pcf --out a.gif",
            "--out a.gif: expected a directory, or a file that ends with .svg, .pdf, .png",
        ),
        ("jittered --figure pcf --format pdf --out a.svg", "--format pdf: is not that of a.svg"),
    ] {
        let run = scratch.run(&format!("plot {arguments}"));
        let said = String::from_utf8(run.stderr).unwrap();
        assert!(!run.status.success() && said.starts_with(&format!("error: {message}")), "{arguments}: {said}");
        assert!(!scratch.path("a.svg").exists());
    }
}

/// Text comes out without a font of the machine, and the size is that of the paper.
#[test]
fn figures_are_written_for_print() {
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler random -n 64 -k 3 --stats radial --device cpu --quiet --out a");
    let asked = "plot a --figure spectrum_radial --size 100x50mm --out";
    scratch.ok(&format!("{asked} fig.pdf"));
    let pdf = std::fs::read(scratch.path("fig.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF-"));
    let text = String::from_utf8_lossy(&pdf);
    let page = text.split_once("/MediaBox [").unwrap().1.split_once(']').unwrap().0;
    let page: Vec<f64> = page.split_whitespace().map(|n| n.parse().unwrap()).collect();
    assert!((page[2] - 100.0 / 25.4 * 72.0).abs() < 0.5 && (page[3] - 50.0 / 25.4 * 72.0).abs() < 0.5, "{page:?}");
    scratch.ok(&format!("{asked} fig.png"));
    let file = std::fs::File::open(scratch.path("fig.png")).unwrap();
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let [width, height] = [info.width as usize, info.height as usize];
    assert_eq!((width, height), (1181, 590), "300 pixels per inch");
    let dark = |columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| {
        let at = |x: usize, y: usize| pixels[3 * (y * width + x)];
        rows.flat_map(|y| columns.clone().map(move |x| (x, y))).filter(|&(x, y)| at(x, y) < 128).count()
    };
    // The label of the ordinate is left of all else; the ground is white to its ends.
    assert!(dark(20..75, 0..height) > 200, "{}", dark(20..75, 0..height));
    assert_eq!((dark(width - 1..width, 0..height), dark(0..width, height - 1..height)), (0, 0));
}

/// The texts of a figure.
fn texts(scratch: &Scratch, name: &str) -> Vec<String> {
    let text = std::fs::read_to_string(scratch.path(name)).unwrap();
    let picture = roxmltree::Document::parse(&text).unwrap();
    let texts = picture.descendants().filter(|node| node.has_tag_name("text"));
    texts.filter_map(|node| node.text().map(str::to_string)).collect()
}

/// Labels of one row that lie over each other, as far as the number of their letters tells.
fn overlap(scratch: &Scratch, name: &str) -> Option<String> {
    let text = std::fs::read_to_string(scratch.path(name)).unwrap();
    let picture = roxmltree::Document::parse(&text).unwrap();
    let number = |node: roxmltree::Node<'_, '_>, name| node.attribute(name).and_then(|n: &str| n.parse::<f64>().ok());
    let labels = picture.descendants().filter(|node| node.attribute("text-anchor") == Some("middle"));
    let labels =
        labels.filter(|node| node.attribute("transform").is_none() && node.attribute("font-size") == Some("13"));
    let places: Vec<_> =
        labels.filter_map(|node| Some((number(node, "x")?, number(node, "y")?, node.text()?.to_string()))).collect();
    let width = |text: &str| 6.6 * text.chars().count() as f64;
    places.iter().enumerate().find_map(|(k, (x, y, a))| {
        let near =
            |other: &&(f64, f64, String)| other.1 == *y && (other.0 - x).abs() < 0.5 * (width(a) + width(&other.2));
        places[k + 1..].iter().find(near).map(|other| format!("{a} lies over {}", other.2))
    })
}

#[test]
fn axes_are_those_of_the_result() {
    let scratch = Scratch::new();
    let clusters = "analyze --sampler thomas --param sigma=0.003 -n 400 -k 20 --stats pcf,neighbors --bin-scale log";
    scratch.ok(&format!("{clusters} --device cpu --quiet --out clusters"));
    scratch.ok("analyze --sampler random -n 400 -k 4 --stats pcf,neighbors --device cpu --quiet --out flat");
    for name in ["clusters", "flat"] {
        scratch.ok(&format!("plot {name} --size 80x60mm --out of_{name}"));
        for figure in ["pcf", "neighbor_functions"] {
            assert_eq!(overlap(&scratch, &format!("of_{name}/{figure}.svg")), None, "{name}");
        }
    }
    let has = |name: &str, label: &str| texts(&scratch, name).iter().any(|text| text == label);
    // Along r by factors, upward over decades.
    assert!(has("of_clusters/pcf.svg", "0.001") && has("of_clusters/pcf.svg", "0.1"));
    assert!(has("of_clusters/pcf.svg", "10") && has("of_clusters/pcf.svg", "1") && !has("of_clusters/pcf.svg", "0"));
    assert!(has("of_flat/pcf.svg", "0") && !has("of_flat/pcf.svg", "0.001"));
    scratch.ok("plot clusters --figure pcf --log-x=false --log-y=false --out linear.svg");
    assert!(has("linear.svg", "0") && !has("linear.svg", "0.001"));
    scratch.ok("plot flat --figure pcf --log-x --out log.svg");
    assert!(has("log.svg", "0.01") && has("log.svg", "0.1"));
    // G and F end where they are 1: at n = 400 before 0.1, while the table goes on to 0.43.
    let far = texts(&scratch, "of_flat/neighbor_functions.svg");
    assert!(far.iter().any(|text| text == "0.08") && !far.iter().any(|text| text == "0.2"), "{far:?}");
    scratch.ok("plot flat --figure neighbor_functions --x 0,0.4 --out whole.svg");
    assert!(texts(&scratch, "whole.svg").iter().any(|text| text.starts_with("0.4")));
}

#[test]
fn what_is_missing_or_differs_is_said() {
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler random -n 64 -k 2 --stats pcf --device cpu --quiet --out a");
    scratch.ok("analyze --sampler random -n 64 -k 2 --stats pcf --unit mm --device cpu --quiet --out b");
    scratch.ok("plot a --figure pcf --out fig.svg");
    let before = std::fs::read(scratch.path("fig.svg")).unwrap();
    let failed = |arguments: &str| {
        let run = scratch.run(&format!("plot {arguments}"));
        assert!(!run.status.success(), "{arguments}");
        String::from_utf8(run.stderr).unwrap()
    };
    let said = failed("a --figure pcf --title x --out fig.svg");
    assert!(said.starts_with("error: --out fig.svg: there is a file fig.svg already"), "{said}");
    assert_eq!(std::fs::read(scratch.path("fig.svg")).unwrap(), before);
    scratch.ok("plot a --figure pcf --title x --out fig.svg --force");
    assert_ne!(std::fs::read(scratch.path("fig.svg")).unwrap(), before);

    let run = scratch.run("plot a b --figure pcf --out both.svg");
    let said = String::from_utf8(run.stderr).unwrap();
    assert!(run.status.success() && said.contains("warning: measured otherwise: length unit: a: "), "{said}");
    assert!(said.contains("b: mm"), "{said}");
    // Neither is the unit of both.
    assert!(!texts(&scratch, "both.svg").iter().any(|text| text.contains("mm")));
    scratch.ok("plot b --figure pcf --out one.svg");
    assert!(texts(&scratch, "one.svg").iter().any(|text| text == "distance r (mm)"));

    let said = failed("a --figure spectrum_radial --out c.svg");
    assert!(said.contains("--figure spectrum_radial: a has no spectrum_radial.csv; expected one of pcf"), "{said}");
    let table = std::fs::read_to_string(scratch.path("a/pcf.csv")).unwrap();
    std::fs::write(scratch.path("a/pcf.csv"), table.replacen(",g,", ",h,", 1)).unwrap();
    let said = failed("a --out c.svg");
    assert!(said.contains("a: has no table that all results have"), "{said}");
    let said = failed("b a --figure pcf --out c.svg");
    assert!(said.contains("a: has no table that all results have") || said.contains("has no column g"), "{said}");
    assert!(!scratch.path("c.svg").exists());
}
