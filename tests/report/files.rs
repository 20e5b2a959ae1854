//! The report stage: an `Analysis` in, files out.
//!
//! Trusts the reference sums and the estimates (their own tests judge them). Proves which files appear, that tables and
//! grids read back as the very numbers of the analysis, that JSON, SVG and PNG are well-formed whatever the numbers and
//! names are, and that files appear whole or not at all. It cannot see whether a picture is beautiful: with
//! `PAIRWAVE_GALLERY=DIR` the scenes are larger and are left in DIR for a person to look at.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::common::*;
use pairwave::accumulate::{Backend, ComputedBy};
use pairwave::accumulate::{CrossCounts, PairCounts};
use pairwave::compute::neighbors::neighbor_sums;
use pairwave::compute::{Compute, reference::Reference};
use pairwave::control::Control;
use pairwave::estimate::{
    Analysis, CrossCorrelation, CrossK, Curve, Envelope, Envelopes, ErrorSource, Findings, KFunction, KernelEstimate,
    Neighbors, Normalization, PairCorrelation, PowerSpectrum, RadialSpectrum, SpectrumDetails, VectorCorrelation,
};
use pairwave::plan::{
    Accuracy, Bandwidth, Correction, Divisor, KernelMethod, KernelPlan, NeighborPlan, PairPlan, PairSettings,
    RadialBins, Rings, Smoothing, SmoothingKernel, WaveGrid,
};
use pairwave::points::{Domain, Ensemble, RawPoints};
use pairwave::report;
use pairwave::{Error, Setting};

/// The stages after compute, for points in `domain`.
fn analyze(subject: &str, domain: &Domain, sets: &[RawPoints], bins: RadialBins, f: &[u32]) -> Analysis {
    let ensemble = Ensemble::from_raw(sets, domain, true, 0).unwrap();
    let shape = shape(&ensemble);
    let correction = if domain.is_torus() { Correction::None } else { Correction::Translation };
    let pair_plan = pair_plan(&ensemble, bins, correction);
    let counts = reference_counts(&pair_plan, &ensemble);
    let lag_plan = lag_plan(&ensemble, 24, None, correction);
    let lags = reference_lags(&lag_plan, &ensemble);
    let mut wave_plan = wave_plan(&ensemble, f, Accuracy::High);
    if domain.dim() == 2 {
        wave_plan = wave_plan.with_sectors(18).unwrap();
    }
    let power = reference_power(&wave_plan, &ensemble);
    let spectrum = PowerSpectrum::new(&wave_plan, &power);
    let radial = RadialSpectrum::new(&wave_plan, &power, &spectrum);
    let pcf = PairCorrelation::new(&pair_plan, &counts, Normalization::Pairs);
    let vector = VectorCorrelation::new(&lag_plan, &lags, Normalization::Pairs);
    let details = SpectrumDetails::new(&wave_plan, &power, &spectrum, &radial, Some(&pcf), Some(&vector));
    let by = ComputedBy::new(Backend::Reference, "one core, f64 and exact integers");
    let mut found = Analysis::new(subject, shape, ensemble.slice(0..1), by);
    found.parameters = vec![("--seed".into(), "1".into()), ("command".into(), "pairwave analyze --out out".into())];
    found.min_points = (0..ensemble.realizations()).map(|k| ensemble.points_in(k)).min().unwrap() as u64;
    (found.correction, found.grid_wanted, found.accuracy) = (correction, true, Accuracy::High);
    found.plan = format!("{pair_plan}{wave_plan}");
    found.timings = vec![("pair_counts", 0.25), ("wave_power", 1.5)];
    found.duplicates = ensemble.duplicates();
    found.findings.insert(pcf);
    found.findings.insert(vector);
    found.findings.insert(spectrum);
    found.findings.insert(radial);
    found.findings.insert(details);
    found.findings.insert(neighbors(&ensemble));
    found
}

/// Takes P and what was made of it out.
fn remove_spectrum(a: &mut Analysis) {
    a.findings.remove::<PowerSpectrum>();
    a.findings.remove::<RadialSpectrum>();
    a.findings.remove::<SpectrumDetails>();
}

fn neighbors(ensemble: &Ensemble) -> Neighbors {
    let plan = NeighborPlan::new(ensemble.domain(), None, shape(ensemble)).unwrap();
    let sums = neighbor_sums(&plan, ensemble, &Control::default()).unwrap();
    Neighbors::new(&plan, &sums, shape(ensemble))
}

/// One point in each cell of a k x k grid: P = 1 - sinc^2 sinc^2, g from the overlap of cells.
fn jittered(k: usize, seed: u64) -> RawPoints {
    let mut rng = Rng(seed);
    let cells = (0..k * k).flat_map(|j| [j % k, j / k]);
    raw(2, cells.map(|c| (c as f64 + rng.unit()) / k as f64).collect())
}

/// Mean of a function of m over every ring.
fn ring_means(analysis: &Analysis, p: impl Fn([i32; 3]) -> f64) -> Vec<f64> {
    let grid = *analysis.spectrum().unwrap().waves.grid().unwrap();
    let rings = Rings::new(&grid.into(), &analysis.domain);
    let mut sums = vec![0.0; rings.count];
    for i in 0..grid.half_len() {
        if let Some(k) = (rings.ring_of[i] as usize).checked_sub(1) {
            sums[k] += f64::from(grid.multiplicity(i)) * p(grid.mode(i));
        }
    }
    sums.iter().zip(&rings.modes).map(|(s, &m)| s / m as f64).collect()
}

fn sinc_squared(x: f64) -> f64 {
    let x = std::f64::consts::PI * x;
    if x == 0.0 { 1.0 } else { (x.sin() / x).powi(2) }
}

/// Mean over directions of the probability that two points r apart share no cell, as a density ratio: g of jittered
/// points is 1 - (triangle(x) triangle(y)) k^2 / n-normalization, triangles of half-width 1/k.
fn jittered_g(k: usize, r: f64) -> f64 {
    let n = (k * k) as f64;
    let triangle = |x: f64| (1.0 - x.abs() * k as f64).max(0.0);
    let mean = (0..720)
        .map(|i| (f64::from(i) + 0.5) / 720.0 * std::f64::consts::TAU)
        .map(|a| triangle(r * a.cos()) * triangle(r * a.sin()))
        .sum::<f64>()
        / 720.0;
    (1.0 - mean) * n / (n - 1.0)
}

/// Dart throwing: no two points closer than `distance` on the unit torus.
fn darts(n: usize, distance: f64, seed: u64) -> RawPoints {
    let mut rng = Rng(seed);
    let mut points: Vec<[f64; 2]> = Vec::new();
    for _ in 0..n * 400 {
        let p = [rng.unit(), rng.unit()];
        let near = |q: &[f64; 2]| {
            let d = |k: usize| ((p[k] - q[k]).abs()).min(1.0 - (p[k] - q[k]).abs());
            d(0).powi(2) + d(1).powi(2) < distance * distance
        };
        if points.len() < n && !points.iter().any(near) {
            points.push(p);
        }
    }
    raw(2, points.concat())
}

fn gallery() -> Option<PathBuf> {
    std::env::var_os("PAIRWAVE_GALLERY").map(PathBuf::from)
}

/// Every kind of input the pictures must cope with.
fn scenes() -> Vec<(&'static str, Analysis)> {
    let unit = Domain::unit_torus;
    let large = gallery().is_some();
    let side = if large { 24 } else { 8 };
    let n = side * side;
    let f = if large { 72 } else { 12 };
    let r_max = |n: usize| (8.0 * unit(2).closest_packing_distance(n as f64)).min(0.5);
    let linear = |r: f64, b: usize| RadialBins::linear(r, b).unwrap();
    let mut scenes = Vec::new();

    let sets: Vec<_> = (0..20).map(|k| jittered(side, 100 + k)).collect();
    let subject = format!("sampler jittered, n {n}, K 20, seed 1");
    let mut a = analyze(&subject, &unit(2), &sets, linear(r_max(n), 256), &[f, f]);
    a.closed_form.name = "jittered".into();
    a.closed_form.g = Some(a.pair_correlation().unwrap().r.iter().map(|&r| jittered_g(side, r)).collect());
    let s = side as f64;
    a.closed_form.radial =
        Some(ring_means(&a, |m| 1.0 - sinc_squared(f64::from(m[0]) / s) * sinc_squared(f64::from(m[1]) / s)));
    let whole = ensemble(&sets);
    let bandwidth = Bandwidth::Stoyan.value(&unit(2), n as f64);
    let kernel = Smoothing { shape: SmoothingKernel::Epanechnikov, bandwidth };
    let r = a.pair_correlation().unwrap().r.clone();
    let plan = KernelPlan::new(kernel, Divisor::R, r, false, &unit(2), Correction::None, shape(&whole)).unwrap();
    let sums = wait(Reference.kernel_sums(&plan, &whole, &Control::default())).unwrap();
    a.findings.insert(KernelEstimate::new(&plan, &sums, Normalization::Pairs));
    a.findings.insert(envelopes(&a, 19));
    scenes.push(("jittered", a));

    let sets = [uniform(2, n, 5)];
    scenes.push(("random K=1", analyze("sampler random, n 576, K 1", &unit(2), &sets, linear(r_max(n), 256), &[f, f])));

    let sets: Vec<_> = (0..10).map(|k| darts(n, 0.75 * unit(2).closest_packing_distance(n as f64), k)).collect();
    let subject = "plantation_with_a_rather_long_name/plot_0001.csv, plot_0002.csv, plot_0003.csv and 7 more files of \
                   the same survey, 1987 to 2003";
    let mut a = analyze(subject, &unit(2), &sets, linear(r_max(n), 256), &[f, f]);
    a.warnings = vec!["3 points coincide with an earlier point of their realization".into()];
    scenes.push(("darts", a));

    let sets = [lattice(2, side), lattice(2, side)];
    scenes.push(("lattice", analyze("lattice", &unit(2), &sets, linear(r_max(n), 256), &[f, f])));

    let k = if large { 8 } else { 4 };
    let sets: Vec<_> = (0..4).map(|s| uniform(3, k * k * k, s)).collect();
    scenes.push(("uniform 3D", analyze("random 3D", &unit(3), &sets, linear(0.5, 64), &[2 * k as u32; 3])));

    let sets: Vec<_> = (0..8).map(|s| uniform(1, 100, s)).collect();
    scenes.push(("uniform 1D", analyze("random 1D", &unit(1), &sets, linear(0.04, 40), &[500])));

    let window = Domain::window(&[(-100.0, 300.0), (50.0, 150.0)]).unwrap();
    let stretch = |set: RawPoints| {
        let xy = set.coordinates.chunks_exact(2).flat_map(|p| [400.0 * p[0] - 100.0, 100.0 * p[1] + 50.0]);
        raw(2, xy.collect())
    };
    let sets = [300, 280, 341].map(|n| stretch(clustered(2, n, n as u64)));
    let bins = RadialBins::logarithmic(0.01, 60.0, 40).unwrap();
    scenes.push(("window log", analyze("trees <a & \"b\">.csv", &window, &sets, bins, &[40, 10])));

    for (name, sides) in [("wide", [1e6, 1.0]), ("tall", [1.0, 900.0])] {
        let domain = Domain::torus(&sides).unwrap();
        let xy =
            uniform(2, 50, 1).coordinates.chunks_exact(2).flat_map(|p| [p[0] * sides[0], p[1] * sides[1]]).collect();
        scenes.push((name, analyze(name, &domain, &[raw(2, xy)], linear(0.5, 4), &[4, 4])));
    }

    let mut a = analyze("one bin, P = 0", &unit(2), &[uniform(2, 6, 1), uniform(2, 4, 2)], linear(0.5, 1), &[1, 1]);
    zero(&mut a);
    scenes.push(("one bin", a));

    let a = analyze("one point", &unit(2), &[uniform(2, 1, 1)], linear(0.5, 8), &[3, 3]);
    // 0/0, as the estimate documents it.
    assert!(a.pair_correlation().unwrap().g[0].is_nan());
    scenes.push(("one point", a));

    scenes.push(("two classes", with_classes(if large { 400 } else { 60 })));

    let many = if large { 30_000 } else { 20_001 };
    let mut a = analyze("sampler random, n 30000, K 1", &unit(2), &[uniform(2, 9, 1)], linear(0.5, 4), &[1, 1]);
    a.first = ensemble(&[uniform(2, many, 1)]);
    (a.min_points, a.shape.max_points, a.shape.mean_points) = (many as u64, many as u64, many as f64);
    a.findings.remove::<PairCorrelation>();
    remove_spectrum(&mut a);
    scenes.push(("many points", a));
    scenes
}

/// Envelopes of g from curves about 1.
fn envelopes(a: &Analysis, simulations: u64) -> Envelopes {
    let g = a.pair_correlation().unwrap();
    let curve = |s| g.r.iter().enumerate().map(|(k, _)| 0.9 + 0.2 * Rng(1000 * s + k as u64).unit()).collect();
    let simulated: Vec<Vec<f64>> = (0..simulations).map(curve).collect();
    let observed = Curve { name: "g", r: g.r.clone(), values: g.g.clone() };
    Envelopes { simulations, given: None, curves: vec![Envelope::new(observed, &simulated)] }
}

/// P = 0 everywhere, and with it no anisotropy.
fn zero(a: &mut Analysis) {
    let spectrum = a.findings.get_mut::<PowerSpectrum>().unwrap();
    spectrum.p.fill(0.0);
    spectrum.p_se.fill(0.0);
    for ring in &mut a.findings.get_mut::<RadialSpectrum>().unwrap().rings {
        (ring.p, ring.p_se, ring.anisotropy_db, ring.anisotropy_db_se) = (0.0, 0.0, None, None);
    }
}

fn small() -> Analysis {
    analyze("two small sets", &Domain::unit_torus(2), &[uniform(2, 9, 1), uniform(2, 7, 2)], bins(), &[3, 4])
}

/// Two classes of points with names that need escaping, and K, in a window.
fn with_classes(n: usize) -> Analysis {
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    let sets = [uniform(2, n, 3), uniform(2, n, 4)];
    let mut a = analyze("a & b <c>", &window, &sets, bins(), &[3, 4]);
    let e = Ensemble::from_raw(&sets, &window, false, 0).unwrap();
    let e = e.with_classes((0..2 * n as u32).map(|j| j % 2).collect());
    let settings = PairSettings { cumulative: true, ..Correction::Translation.into() };
    let plan = PairPlan::new(&window, bins(), settings, shape(&e)).unwrap();
    let sums = reference_counts(&plan, &e);
    a.findings.add(KFunction::new(&plan, &sums, Normalization::Pairs, n as f64));
    let [one, other] = [0, 1].map(|class| reference_counts(&plan, &e.of_classes(&[class])));
    let mut between = PairCounts::new(one.computed_by.clone(), &plan);
    for k in 0..2 {
        let count = |classes: &[u32]| reference_counts(&plan, &e.of_classes(classes).slice(k..k + 1));
        between.add_between(&plan, &count(&[0, 1]), &count(&[0]), &count(&[1]));
    }
    let counts = CrossCounts { a: one, b: other, between };
    let names = ["a<b".to_string(), "c & d".to_string()];
    a.findings.insert(CrossCorrelation::new(names.clone(), &plan, &counts, Normalization::Pairs));
    a.findings.add(CrossK::new(names, &plan, &counts, Normalization::Pairs));
    a
}

fn bins() -> RadialBins {
    RadialBins::linear(0.5, 16).unwrap()
}

fn listing(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The summary, held against its schema.
fn json(dir: &Path) -> serde_json::Value {
    static SCHEMA: LazyLock<jsonschema::Validator> =
        LazyLock::new(|| jsonschema::validator_for(&summary_schema()).unwrap());
    let summary = serde_json::from_slice(&fs::read(dir.join("summary.json")).unwrap()).unwrap();
    let faults: Vec<_> = SCHEMA.iter_errors(&summary).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    summary
}

fn summary_schema() -> serde_json::Value {
    serde_json::from_str(include_str!("../../docs/summary.schema.json")).unwrap()
}

/// Every key of the schema is described, there and on the page, and a fault is seen.
#[test]
fn the_schema_of_the_summary_is_the_page_about_it() {
    fn keys(schema: &serde_json::Value, path: &str, all: &mut Vec<(String, String)>) {
        for (key, of) in schema["properties"].as_object().into_iter().flatten() {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            all.push((path.clone(), of["description"].as_str().unwrap_or_else(|| panic!("{path}")).to_string()));
            keys(of, &path, all);
            keys(&of["items"], &format!("{path}[]"), all);
        }
    }
    let page = include_str!("../../docs/summary.md");
    let mut all = Vec::new();
    keys(&summary_schema(), "", &mut all);
    let rows: Vec<_> = page.lines().filter(|line| line.starts_with("| `")).collect();
    assert_eq!(rows.len(), all.len());
    for (path, description) in &all {
        let (start, end) = (format!("| `{path}` |"), format!("| {} |", description.replace('|', "\\|")));
        assert!(rows.iter().any(|row| row.starts_with(&start) && row.ends_with(&end)), "{start} {end}");
    }
    let validator = jsonschema::validator_for(&summary_schema()).unwrap();
    let root = tempfile::tempdir().unwrap();
    report::write(root.path(), &small(), false).unwrap();
    let right = json(root.path());
    for (key, wrong) in [("k", "2".into()), ("schema", 1.into()), ("new", 1.into()), ("warnings", vec![1].into())] {
        let mut summary = right.clone();
        summary[key] = wrong;
        assert!(!validator.is_valid(&summary), "{key}");
    }
}

fn columns(path: &Path) -> (Vec<String>, BTreeMap<String, Vec<String>>) {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let header: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
    let mut columns: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for record in reader.records() {
        for (name, cell) in header.iter().zip(record.unwrap().iter()) {
            columns.entry(name.clone()).or_default().push(cell.into());
        }
    }
    (header, columns)
}

fn floats(cells: &[String]) -> Vec<f64> {
    cells.iter().map(|c| c.parse().unwrap()).collect()
}

/// Pictures and page of every scene are well-formed, and nothing in them refers to the outside.
#[test]
fn every_scene_is_rendered() {
    let temporary = tempfile::tempdir().unwrap();
    let root = gallery().unwrap_or(temporary.path().into());
    for (name, analysis) in scenes() {
        let dir = root.join(name.replace([' ', '='], "-"));
        let files = report::write(&dir, &analysis, true).unwrap();
        assert!(files.iter().all(|f| f.is_file()), "{name}");
        let summary = json(&dir);
        assert_eq!(summary["subject"], analysis.subject.as_str(), "{name}");
        for file in &files {
            let bytes = fs::read(file).unwrap();
            match file.extension().unwrap().to_str().unwrap() {
                "svg" => {
                    let svg = String::from_utf8(bytes).unwrap();
                    let svg = roxmltree::Document::parse(&svg).unwrap();
                    assert!(!svg.root_element().descendants().any(|n| n.attribute("href").is_some()), "{name}");
                    for node in svg.descendants() {
                        for a in node.attributes() {
                            assert!(!a.value().contains("NaN") && !a.value().contains("inf"), "{name}: {a:?}");
                        }
                    }
                }
                "html" => page_is_self_contained(name, &String::from_utf8(bytes).unwrap()),
                "json" | "csv" => {
                    let text = String::from_utf8(bytes).unwrap();
                    assert!(!text.contains("NaN") && !text.contains("inf,"), "{name}: {}", file.display());
                }
                _ => {}
            }
        }
    }
}

fn page_is_self_contained(name: &str, page: &str) {
    // The head is HTML (void elements); the body is written so that it is XML too, but for the image.
    let body = page.split_once("<body>").unwrap().1.split_once("</body>").unwrap().0;
    let body = body.replace("&nbsp;", " ");
    let mut closed = body;
    while let Some((before, rest)) = closed.split_once("<img ") {
        let (attributes, after) = rest.split_once('>').unwrap();
        assert!(attributes.contains("src=\"data:image/png;base64,"), "{name}");
        closed = format!("{before}{after}");
    }
    let parsed = format!("<body>{closed}</body>");
    let body = roxmltree::Document::parse(&parsed).unwrap_or_else(|e| panic!("{name}: {e}"));
    for node in body.descendants() {
        let tag = node.tag_name().name();
        assert!(!["script", "link", "iframe", "object", "img"].contains(&tag), "{name}: {tag}");
        assert!(node.attribute("src").is_none() && node.attribute("href").is_none(), "{name}: {tag}");
    }
    assert!(!page.contains("@import") && !page.contains("url("), "{name}");
}

#[test]
fn files_for_what_there_is() {
    let root = tempfile::tempdir().unwrap();
    let all = [
        "anisotropy.svg",
        "neighbor_functions.csv",
        "neighbor_functions.svg",
        "pcf.csv",
        "pcf.svg",
        "pcf_angular.csv",
        "pcf_angular.svg",
        "pcf_from_spectrum.csv",
        "pcf_vector.npy",
        "pcf_vector.png",
        "pcf_vector_counts.npy",
        "pcf_vector_se.npy",
        "points.svg",
        "report.html",
        "spectrum.npy",
        "spectrum.png",
        "spectrum_angular.csv",
        "spectrum_angular.svg",
        "spectrum_axes.csv",
        "spectrum_axes.svg",
        "spectrum_from_pcf.csv",
        "spectrum_grey.png",
        "spectrum_radial.csv",
        "spectrum_radial.svg",
        "spectrum_se.npy",
        "summary.json",
    ];
    let dir = root.path().join("a/b/out");
    let files = report::write(&dir, &small(), false).unwrap();
    assert_eq!(listing(&dir), all);
    assert_eq!(files.len(), all.len());
    assert_eq!(files.last().unwrap(), &dir.join("summary.json"));
    assert_eq!(listing(dir.parent().unwrap()), ["out"]);

    // K = 1: no file of errors; one dimension: no picture of the grid.
    let one = analyze("1D", &Domain::unit_torus(1), &[uniform(1, 9, 1)], bins(), &[5]);
    let dir = root.path().join("one");
    report::write(&dir, &one, false).unwrap();
    let not = [
        "spectrum_se.npy",
        "spectrum.png",
        "spectrum_grey.png",
        "anisotropy.svg",
        "pcf_vector_se.npy",
        "pcf_vector.png",
        "pcf_angular.csv",
        "pcf_angular.svg",
        "spectrum_angular.csv",
        "spectrum_angular.svg",
    ];
    assert!(!listing(&dir).iter().any(|f| not.contains(&f.as_str())));
    assert!(listing(&dir).contains(&"spectrum_axes.svg".to_string()));

    let mut bare = small();
    bare.findings = Findings::default();
    let dir = root.path().join("bare");
    report::write(&dir, &bare, false).unwrap();
    assert_eq!(listing(&dir), ["points.svg", "report.html", "summary.json"]);
    for key in ["accuracy", "pair_correlation", "vector_correlation", "spectrum", "radial", "neighbors", "consistency"]
    {
        assert!(json(&dir)[key].is_null(), "{key}");
    }
}

/// What is had of an analysis without files is what files have.
#[test]
fn every_file_can_be_had_without_being_written() {
    let (a, dir) = (small(), tempfile::tempdir().unwrap());
    let out = dir.path().join("out");
    report::write(&out, &a, false).unwrap();
    let mut there = 0;
    for name in report::file_names().into_iter().chain(["report.html"]) {
        let made = report::file(name, &a).unwrap();
        there += u32::from(made.is_some());
        assert_eq!(made, fs::read(out.join(name)).ok(), "{name}");
    }
    assert!(there > 5);
    assert_eq!(report::file("results.npz", &a).unwrap(), None);
    let summary: serde_json::Value =
        serde_json::from_slice(&report::file("summary.json", &a).unwrap().unwrap()).unwrap();
    assert_eq!(summary["k"], json(&out)["k"]);
    let g = report::table("pcf", &a).unwrap();
    let columns: BTreeMap<&str, report::Column> = g.values().collect();
    assert!(matches!(&columns["count"], report::Column::Integer(counts) if counts.len() == g.rows()));
    assert_eq!(columns["g"], report::Column::Real(a.pair_correlation().unwrap().g.clone()));
    assert_eq!(report::array("spectrum", &a).unwrap().shape.len(), 2);
    assert!(report::table("spectrum", &a).is_none() && report::array("pcf", &a).is_none());
}

#[test]
fn neighbor_functions_read_back_as_the_same_numbers() {
    let root = tempfile::tempdir().unwrap();
    let mut a = small();
    let functions = &mut a.findings.get_mut::<Neighbors>().unwrap().functions;
    (functions.g[3], functions.j[4]) = (None, None);
    let functions = functions.clone();
    report::write(&root.path().join("out"), &a, false).unwrap();
    let text = fs::read_to_string(root.path().join("out/neighbor_functions.csv")).unwrap();
    let mut lines = text.lines();
    let header = "r,g_function,g_function_se,f_function,f_function_se,j_function,poisson";
    assert_eq!(lines.next(), Some(header));
    let mut rows = 0;
    for (i, line) in lines.enumerate() {
        let found: Vec<Option<f64>> = line.split(',').map(|cell| cell.parse().ok()).collect();
        let f = &functions;
        let row = [Some(f.r[i]), f.g[i], f.g_se[i], f.f[i], f.f_se[i], f.j[i], Some(f.poisson[i])];
        assert_eq!(found, row.map(|x| x.filter(|x| x.is_finite())), "row {i}");
        rows += 1;
    }
    assert_eq!(rows, functions.r.len());
    let neighbors = &json(&root.path().join("out"))["neighbors"];
    assert_eq!(neighbors["functions"]["test_points"], functions.probes);
    assert!(neighbors["psi_6"]["local"].is_number() && neighbors["psi_6_undefined"].is_null());
}

#[test]
fn tables_read_back_as_the_same_numbers() {
    let root = tempfile::tempdir().unwrap();
    let mut a = small();
    let g = a.findings.get_mut::<PairCorrelation>().unwrap();
    (g.g[0], g.g_se[0], g.g[1]) = (f64::NAN, f64::INFINITY, 1.0 / 3.0 * 1e-7);
    let r = g.r.clone();
    let kernel = Smoothing { shape: SmoothingKernel::Box, bandwidth: 0.01 };
    let half: Vec<_> = (0..16).map(|b| (b >= 2).then_some(f64::from(b) / 3.0)).collect();
    a.findings.insert(KernelEstimate {
        kernel,
        divisor: Divisor::R,
        method: KernelMethod::Binned,
        r,
        g: half.clone(),
        g_se: half,
        errors: ErrorSource::AcrossRealizations,
        bound: 1e-6,
        cross_validation: None,
    });
    a.findings.insert(envelopes(&a, 19));
    a.findings.get_mut::<RadialSpectrum>().unwrap().rings[0].anisotropy_db = None;
    report::write(root.path(), &a, false).unwrap();

    let (header, c) = columns(&root.path().join("pcf.csv"));
    assert_eq!(header, ["r_lo", "r", "r_hi", "count", "g", "g_se", "g_kernel", "g_kernel_se"]);
    let g = a.pair_correlation().unwrap();
    for (name, values) in [("r_lo", &g.r_lo), ("r", &g.r), ("r_hi", &g.r_hi)] {
        assert_eq!(&floats(&c[name]), values, "{name}");
    }
    assert_eq!((c["g"][0].as_str(), c["g_se"][0].as_str()), ("", ""));
    assert_eq!(floats(&c["g"][1..]), g.g[1..]);
    assert_eq!(floats(&c["g_se"][1..]), g.g_se[1..]);
    assert_eq!(c["count"].iter().map(|n| n.parse().unwrap()).collect::<Vec<u64>>(), g.count);
    assert_eq!((c["g_kernel"][1].as_str(), c["g_kernel_se"][1].as_str()), ("", ""));
    assert_eq!(c["g_kernel"][4].parse::<f64>().unwrap(), 4.0 / 3.0);

    let kernel = &json(root.path())["pair_correlation"]["kernel"];
    assert_eq!(
        (&kernel["method"], &kernel["divisor"], &kernel["bound"]),
        (&"binned".into(), &"r".into(), &1e-6.into())
    );
    assert_eq!(kernel["errors"], "across-realizations");

    let (header, c) = columns(&root.path().join("envelope.csv"));
    assert_eq!(header, ["curve", "r", "observed", "lo", "hi", "global_lo", "global_hi"]);
    let e = &a.envelopes().unwrap().curves[0];
    assert!(c["curve"].iter().all(|name| name == "g"));
    assert_eq!(c["observed"][0], "", "undefined, as in pcf.csv");
    for (name, values) in
        [("lo", &e.pointwise[0]), ("hi", &e.pointwise[1]), ("global_lo", &e.global[0]), ("global_hi", &e.global[1])]
    {
        assert_eq!(floats(&c[name][1..]), values[1..], "{name}");
    }
    let summary = &json(root.path())["envelope"];
    assert_eq!((&summary["simulations"], &summary["pointwise_significance"]), (&19.into(), &0.1.into()));
    assert_eq!((&summary["curves"][0]["curve"], &summary["curves"][0]["p"]), (&"g".into(), &e.p.into()));

    let (header, c) = columns(&root.path().join("spectrum_radial.csv"));
    let names = "nu_lo,nu,nu_hi,modes,p,p_se,anisotropy_db,anisotropy_reference_db,anisotropy_db_se,independent_modes,\
                 p_lo,p_hi,p_band,m,nu_mean,m_mean";
    assert_eq!(header.join(","), names);
    let rings = &a.radial().unwrap().rings;
    assert_eq!(floats(&c["p"]), rings.iter().map(|r| r.p).collect::<Vec<_>>());
    // |m| = 1 four times and sqrt(2) four times.
    let first = (1.0 + 2f64.sqrt()) / 2.0;
    assert!((floats(&c["m_mean"])[0] - first).abs() < 1e-15 && (rings[0].nu_mean - first).abs() < 1e-15);
    assert_eq!(floats(&c["p_se"]), rings.iter().map(|r| r.p_se).collect::<Vec<_>>());
    assert_eq!(c["anisotropy_db"][0], "");
    assert_eq!(c["anisotropy_db"][1].parse::<f64>().ok(), rings[1].anisotropy_db);
    // n = 9 and 7 know as much as 256 / 130 realizations of equal n.
    let reference = -10.0 * (256f64 / 130.0).log10();
    assert!(floats(&c["anisotropy_reference_db"]).iter().all(|&db| (db - reference).abs() < 1e-12));
    for (ring, row) in rings.iter().zip(0..) {
        let band = ring.band.unwrap();
        assert_eq!([&c["p_lo"], &c["p_hi"]].map(|c| c[row].parse::<f64>().unwrap()), [band.lo, band.hi]);
        assert!(band.lo < ring.p && ring.p < band.hi && c["p_band"][row] == "chi-squared");
        assert_eq!(c["m"][row], format!("{:?}", (row + 1) as f64));
    }
    assert_eq!(json(root.path())["radial"]["bands"]["chi_squared_rings"], rings.len());
}

#[test]
fn details_of_the_spectrum_read_back() {
    let root = tempfile::tempdir().unwrap();
    let torus = Domain::torus(&[2.0, 1.0]).unwrap();
    let stretch = |seed| {
        let xy = uniform(2, 40, seed).coordinates;
        raw(2, xy.iter().enumerate().map(|(i, x)| x * [2.0, 1.0][i % 2]).collect())
    };
    let mut a = analyze("unequal sides", &torus, &[stretch(1), stretch(2)], bins(), &[40, 20]);
    let details = a.findings.get_mut::<SpectrumDetails>().unwrap();
    details.axes.modes[1].band = None;
    details.angular.as_mut().unwrap().sectors[2].ratio = None;
    let details = details.clone();
    report::write(root.path(), &a, false).unwrap();

    let (header, c) = columns(&root.path().join("spectrum_axes.csv"));
    assert_eq!(header, ["axis", "m", "nu", "p", "p_se", "p_lo", "p_hi", "p_band"]);
    assert_eq!(c["axis"].iter().filter(|a| *a == "x").count(), 40);
    assert_eq!((c["m"][39].as_str(), c["nu"][39].as_str(), c["nu"][59].as_str()), ("40", "20.0", "20.0"));
    assert_eq!(floats(&c["p"]), details.axes.modes.iter().map(|m| m.p).collect::<Vec<_>>());
    assert_eq!((c["p_lo"][1].as_str(), c["p_band"][1].as_str()), ("", ""));

    let (header, c) = columns(&root.path().join("spectrum_angular.csv"));
    let names = "theta_lo,theta_hi,modes,p,p_se,p_lo,p_hi,p_band,ratio,ratio_se";
    assert_eq!(header.join(","), names);
    let sectors = &details.angular.as_ref().unwrap().sectors;
    assert_eq!(floats(&c["p"]), sectors.iter().map(|s| s.p).collect::<Vec<_>>());
    assert_eq!(c["ratio"][2], "");
    assert!((floats(&c["theta_lo"])[1] - 5.0).abs() < 1e-12 && (floats(&c["theta_hi"])[1] - 15.0).abs() < 1e-12);
    let modes: u64 = a.radial().unwrap().rings.iter().map(|r| r.modes).sum();
    assert_eq!(c["modes"].iter().map(|m| m.parse::<u64>().unwrap()).sum::<u64>(), modes);

    let of_pcf = details.of_pcf.as_ref().unwrap();
    let (header, c) = columns(&root.path().join("spectrum_from_pcf.csv"));
    assert_eq!(header, ["nu", "p", "p_from_g"]);
    assert_eq!(floats(&c["p_from_g"]), of_pcf.p_from_g);
    let (header, c) = columns(&root.path().join("pcf_from_spectrum.csv"));
    assert_eq!(header, ["r", "g", "g_from_p"]);
    assert_eq!(floats(&c["g_from_p"]), of_pcf.g_from_p);

    let summary = json(root.path());
    let (scalars, s) = (&summary["spectrum_scalars"], &details.scalars);
    // The reader of JSON may be off by the last bit.
    let same = |found: &serde_json::Value, expected: Option<f64>| match (found.as_f64(), expected) {
        (Some(a), Some(b)) => assert!((a - b).abs() <= 1e-15 * b.abs(), "{a} against {b}"),
        (a, b) => assert_eq!(a, b),
    };
    same(&scalars["effective_nyquist"], s.blue_noise.unwrap().effective_nyquist);
    same(&scalars["oscillation"], s.blue_noise.unwrap().oscillation);
    same(&scalars["high_frequency"]["p"], s.high_frequency.map(|h| h.p));
    same(&scalars["diaphony"]["diaphony"], s.diaphony.map(|d| d.diaphony));
    same(&scalars["low_frequency"]["exponent"], s.low_frequency.unwrap().exponent);
    same(&summary["consistency"]["radial"]["rms"], Some(of_pcf.rms));
    same(&summary["consistency"]["lags"]["ratio"], details.lags.map(|l| l.ratio));
    assert!(details.lags.is_some() && s.high_frequency.is_some() && s.diaphony.is_some());
    let page = fs::read_to_string(root.path().join("report.html")).unwrap();
    for text in ["Effective Nyquist", "Hyperuniformity", "Diaphony", "Power by direction", "along the axes"] {
        assert!(page.contains(text), "{text}");
    }
}

#[test]
fn k_and_two_classes_read_back() {
    let root = tempfile::tempdir().unwrap();
    let mut a = with_classes(60);
    a.findings.get_mut::<KFunction>().unwrap().l_se[0] = None;
    a.findings.get_mut::<CrossCorrelation>().unwrap().a.g[0] = f64::NAN;
    report::write(root.path(), &a, false).unwrap();
    for file in ["k_function.csv", "k_function.svg", "pcf_cross.csv", "pcf_cross.svg", "k_function_cross.svg"] {
        assert!(listing(root.path()).contains(&file.to_string()), "{file}");
    }
    let (header, c) = columns(&root.path().join("k_function.csv"));
    assert_eq!(header, ["r", "k", "k_se", "l", "l_se", "l_minus_r", "neighbors"]);
    let k = a.k_function().unwrap();
    for (name, values) in [("r", &k.r), ("k", &k.k), ("k_se", &k.k_se), ("l", &k.l), ("neighbors", &k.neighbors)] {
        assert_eq!(&floats(&c[name]), values, "{name}");
    }
    assert_eq!(c["l_se"][0], "");
    assert_eq!(c["l_se"][5].parse::<f64>().ok(), k.l_se[5]);
    assert_eq!(floats(&c["l_minus_r"])[5], k.l[5] - k.r[5]);
    let (header, c) = columns(&root.path().join("pcf_cross.csv"));
    let of = ["a<b_a<b", "c & d_c & d", "a<b_c & d"].map(|of| format!("count_{of},g_{of},g_{of}_se"));
    assert_eq!(header.join(","), format!("r_lo,r,r_hi,{}", of.join(",")));
    let cross = a.cross().unwrap();
    assert_eq!(c["g_a<b_a<b"][0], "");
    assert_eq!(floats(&c["g_c & d_c & d"]), cross.b.g);
    assert_eq!(floats(&c["g_a<b_c & d"]), cross.between.g);
    assert_eq!(floats(&c["g_a<b_c & d_se"]), cross.between.g_se);
    assert_eq!(c["count_a<b_c & d"].iter().map(|n| n.parse().unwrap()).collect::<Vec<u64>>(), cross.between.count);
    let (header, c) = columns(&root.path().join("k_function_cross.csv"));
    let columns_of = |of| format!("k_{of},k_{of}_se,l_{of},l_{of}_se,l_minus_r_{of}");
    let of = ["a<b_a<b", "c & d_c & d", "a<b_c & d"].map(columns_of);
    assert_eq!(header.join(","), format!("r,{}", of.join(",")));
    let cross = a.cross_k().unwrap();
    assert_eq!(floats(&c["k_a<b_c & d"]), cross.between.k);
    assert_eq!(floats(&c["l_minus_r_c & d_c & d"]), cross.b.l_minus_r);
    let summary = json(root.path());
    assert_eq!(summary["cross_k_function"]["classes"][1], "c & d");
    assert_eq!(summary["cross_correlation"]["classes"][0], "a<b");
    assert_eq!(summary["k_function"]["correction"], "translation");
    let page = fs::read_to_string(root.path().join("report.html")).unwrap();
    assert!(page.contains("a&lt;b (<i>A</i>) and c &amp; d") && page.contains("Ripley"));
}

#[test]
fn grids_read_back_with_x_first_and_dc_in_the_middle() {
    let root = tempfile::tempdir().unwrap();
    let a = small();
    report::write(root.path(), &a, false).unwrap();
    let spectrum = a.spectrum().unwrap();
    for (file, half) in [("spectrum.npy", &spectrum.p), ("spectrum_se.npy", &spectrum.p_se)] {
        let bytes = fs::read(root.path().join(file)).unwrap();
        let npy = npyz::NpyFile::new(&bytes[..]).unwrap();
        assert_eq!(npy.shape(), [7, 9]);
        assert_eq!(npy.order(), npyz::Order::C);
        let values: Vec<f64> = npy.into_vec().unwrap();
        for (m0, m1) in [(0, 0), (3, 4), (-3, 4), (1, -2), (-1, 2), (-2, -3)] {
            let at = ((m0 + 3) * 9 + m1 + 4) as usize;
            assert_eq!(
                values[at],
                half[spectrum.waves.grid().unwrap().half_index([m0, m1, 0])],
                "{file} at {m0}, {m1}"
            );
        }
    }
}

/// One cell off the diagonals, at a quarter to the right and three quarters up, is told from all others in every file.
#[test]
fn the_vector_g_has_x_first_and_y_upward() {
    let root = tempfile::tempdir().unwrap();
    let mut a = small();
    let vector = a.findings.get_mut::<VectorCorrelation>().unwrap();
    let (x, y) = (5, 17);
    vector.g.fill(1.0);
    vector.g[x * 24 + y] = 7.25;
    (vector.g[0], vector.g[1], vector.count[3]) = (0.25, 0.25, 12_345);
    let sector = vector.sectors[1];
    report::write(root.path(), &a, false).unwrap();
    let bytes = fs::read(root.path().join("pcf_vector.npy")).unwrap();
    let npy = npyz::NpyFile::new(&bytes[..]).unwrap();
    assert_eq!((npy.shape(), npy.order()), (&[24, 24][..], npyz::Order::C));
    assert_eq!(npy.into_vec::<f64>().unwrap()[x * 24 + y], 7.25);
    let bytes = fs::read(root.path().join("pcf_vector_counts.npy")).unwrap();
    assert_eq!(npyz::NpyFile::new(&bytes[..]).unwrap().into_vec::<u64>().unwrap()[3], 12_345);

    let (_, angular) = columns(&root.path().join("pcf_angular.csv"));
    assert_eq!(floats(&angular["theta"])[1], sector.theta[1]);
    assert_eq!(floats(&angular["g"])[1], sector.g.unwrap());
    assert_eq!(angular["count"][1], sector.count.to_string());

    let mut reader =
        png::Decoder::new(std::io::BufReader::new(fs::File::open(root.path().join("pcf_vector.png")).unwrap()))
            .read_info()
            .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let zoom = info.width as usize / 24;
    let at = |x: usize, y: usize| -> [u8; 3] {
        let pixel = 3 * ((zoom * (23 - y) + zoom / 2) * info.width as usize + zoom * x + zoom / 2);
        pixels[pixel..pixel + 3].try_into().unwrap()
    };
    assert!(at(x, y)[0] > 150 && at(x, y)[2] < 80, "red: {:?}", at(x, y));
    assert!(at(0, 0)[2] > 150 && at(0, 1)[0] < 80, "blue: {:?}", at(0, 0));
    assert!(at(23 - x, y)[1] > 200 && at(x, 23 - y)[1] > 200 && at(y, x)[1] > 200, "all others are white");
    // All but one in a thousand: two cells reach 0.75 from 1, so that is where colours end.
    assert_eq!(json(root.path())["vector_correlation"]["picture_range"], serde_json::json!([0.25, 1.75]));
}

#[test]
fn the_summary_holds_the_scalars() {
    let root = tempfile::tempdir().unwrap();
    let mut a = small();
    a.parameters = vec![("z".into(), 1.into()), ("a".into(), vec!["2", "3"].into())];
    a.warnings = vec!["mind \"this\"".into()];
    a.findings.get_mut::<Neighbors>().unwrap().distances.mean_se = Some(f64::NAN);
    report::write(root.path(), &a, false).unwrap();
    let summary = json(root.path());
    assert_eq!(summary["schema"], 2);
    assert_eq!(summary["n"], serde_json::json!({"min": 7, "mean": 8.0, "max": 9}));
    assert_eq!((&summary["k"], &summary["d"]), (&2.into(), &2.into()));
    assert_eq!(summary["parameters"], serde_json::json!({"z": 1, "a": ["2", "3"]}));
    assert_eq!(summary["domain"]["boundary"], "torus");
    assert_eq!(summary["accuracy"]["power_bound"]["max_uniform"], 1e-11);
    assert_eq!(summary["pair_correlation"]["errors"], "across-realizations");
    assert_eq!(summary["spectrum"]["dc_p"].as_f64().unwrap(), a.spectrum().unwrap().dc().unwrap().0);
    assert!(summary["neighbors"]["mean_se"].is_null());
    assert_eq!(summary["warnings"][0], "mind \"this\"");
    assert_eq!(summary["timings_seconds"]["wave_power"], 1.5);
    let text = fs::read_to_string(root.path().join("summary.json")).unwrap();
    let at = |key: &str| text.find(key).unwrap();
    assert!(at("\"schema\"") < at("\"subject\"") && at("\"z\"") < at("\"a\"") && at("\"n\"") < at("\"plan\""));
}

#[test]
fn user_text_is_escaped() {
    let root = tempfile::tempdir().unwrap();
    let mut a = small();
    let hostile = "</title><script>alert('&')</script>\u{1b}\"x\".csv";
    a.subject = hostile.into();
    a.closed_form.name = hostile.into();
    a.closed_form.g = Some(vec![1.0; 16]);
    a.plan = hostile.into();
    a.warnings = vec![hostile.into()];
    a.parameters = vec![(hostile.into(), hostile.into()), ("command".into(), hostile.into())];
    a.computed_by.devices = vec![hostile.into()];
    report::write(root.path(), &a, false).unwrap();
    for name in ["pcf.svg", "points.svg", "report.html", "spectrum_radial.svg"] {
        let text = fs::read_to_string(root.path().join(name)).unwrap();
        // Of a page, its own script, and what that reads.
        let scripts: Vec<_> = text.split("<script").skip(1).collect();
        let own = |rest: &&str| {
            rest.starts_with(" type=\"application/json\" id=\"") || rest.starts_with(">// What a page does")
        };
        assert!(scripts.iter().all(own) && (scripts.is_empty() || name.ends_with("html")), "{name}");
        assert!(scripts.iter().filter(|rest| rest.starts_with('>')).count() <= 1, "{name}");
        assert!(!text.contains("</title><script") && !text.contains('\u{1b}'), "{name}");
        assert!(text.contains("&lt;script&gt;"), "{name}");
        if name.ends_with("svg") {
            roxmltree::Document::parse(&text).unwrap();
        }
    }
    assert_eq!(json(root.path())["subject"], hostile);
}

#[test]
fn an_existing_result_needs_force() {
    let root = tempfile::tempdir().unwrap();
    let dir = root.path().join("out");
    report::check_out(&dir, false).unwrap();
    assert!(listing(root.path()).is_empty());
    report::write(&dir, &small(), false).unwrap();
    // Asked before, it is a mistake of whoever asks; found when all is computed, somebody was faster.
    let refusal = report::check_out(&dir, false).unwrap_err();
    assert_eq!(refusal.exit_code(), 2);
    assert_eq!(refusal.to_string(), format!("out {}: holds a result already; `force` replaces it", dir.display()));
    let refusal = report::write(&dir, &small(), false).unwrap_err();
    assert_eq!(refusal.exit_code(), 1);
    assert_eq!(refusal.to_string(), format!("{}: holds a result already; `force` replaces it", dir.display()));
    report::check_out(&dir, true).unwrap();

    // Forced: ours that the new result lacks go away, what is not ours stays.
    fs::write(dir.join("notes.txt"), "mine").unwrap();
    let mut less = small();
    remove_spectrum(&mut less);
    less.findings.remove::<VectorCorrelation>();
    less.findings.remove::<Neighbors>();
    less.subject = "the second".into();
    report::write(&dir, &less, true).unwrap();
    let kept = ["notes.txt", "pcf.csv", "pcf.svg", "points.svg", "report.html", "summary.json"];
    assert_eq!(listing(&dir), kept);
    assert_eq!(json(&dir)["subject"], "the second");
    assert_eq!(listing(root.path()), ["out"]);
}

#[test]
fn a_file_of_ours_by_name_alone_is_not_lost() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("pcf.csv"), "somebody's own").unwrap();
    let refusal = report::write(root.path(), &small(), false).unwrap_err();
    assert!(refusal.to_string().contains("holds a file pcf.csv already; `force` replaces it"), "{refusal}");
    // Nor a whole directory, not even by force.
    fs::remove_file(root.path().join("pcf.csv")).unwrap();
    fs::create_dir(root.path().join("pcf.csv")).unwrap();
    assert!(report::write(root.path(), &small(), true).is_err());
    fs::remove_dir(root.path().join("pcf.csv")).unwrap();
    // Other files are no obstacle.
    fs::write(root.path().join("points.csv"), "input").unwrap();
    report::write(root.path(), &small(), false).unwrap();
    assert!(listing(root.path()).contains(&"points.csv".into()));
}

#[test]
fn bad_paths_fail_early_and_name_the_flag() {
    let root = tempfile::tempdir().unwrap();
    let file = root.path().join("file");
    fs::write(&file, "x").unwrap();
    for path in [file.clone(), file.join("below"), PathBuf::new(), "/proc/nothing/here".into()] {
        for force in [false, true] {
            let refusal = report::check_out(&path, force).unwrap_err();
            assert!(matches!(refusal, Error::Setting { setting: Setting::Out, .. }), "{refusal}");
            assert!(report::write(&path, &small(), force).is_err());
        }
    }
    assert_eq!(fs::read(&file).unwrap(), b"x");
    assert_eq!(listing(root.path()), ["file"]);
}

#[test]
fn a_failure_leaves_everything_as_it_was() {
    // A spectrum whose store is too short cannot be written: the run dies in the middle, after the first tables.
    let mut broken = small();
    broken.findings.get_mut::<PowerSpectrum>().unwrap().p_se.truncate(3);
    let root = tempfile::tempdir().unwrap();
    let attempt = |dir: &Path, force| {
        std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| report::write(dir, &broken, force)))
    };
    assert!(!matches!(attempt(&root.path().join("a/b"), false), Ok(Ok(_))));
    assert!(listing(root.path()).is_empty(), "{:?}", listing(root.path()));

    let dir = root.path().join("out");
    report::write(&dir, &small(), false).unwrap();
    let before: Vec<_> = listing(&dir).into_iter().map(|f| fs::read(dir.join(f)).unwrap()).collect();
    assert!(!matches!(attempt(&dir, true), Ok(Ok(_))));
    let after: Vec<_> = listing(&dir).into_iter().map(|f| fs::read(dir.join(f)).unwrap()).collect();
    assert!(before == after);
}

#[test]
fn the_same_analysis_gives_the_same_bytes() {
    let root = tempfile::tempdir().unwrap();
    let a = small();
    let first = report::write(&root.path().join("a"), &a, false).unwrap();
    let second = report::write(&root.path().join("b"), &a, false).unwrap();
    for (a, b) in first.iter().zip(&second) {
        assert!(fs::read(a).unwrap() == fs::read(b).unwrap(), "{}", a.display());
    }
}

/// The picture says what its colours mean, and they do: P = 0 and P = n at the ends of viridis, 1 in the middle, y up, DC grey.
#[test]
fn the_picture_keeps_its_tone_map() {
    let root = tempfile::tempdir().unwrap();
    let mut a = small();
    let n = a.shape.mean_points;
    let spectrum = a.findings.get_mut::<PowerSpectrum>().unwrap();
    spectrum.waves = WaveGrid::new(&[3, 4]).unwrap().into();
    spectrum.p.fill(0.0);
    for (m, p) in [([0, 0, 0], 1e6), ([1, 0, 0], 1.0), ([0, 4, 0], 1e9), ([3, -4, 0], n)] {
        let at = spectrum.waves.grid().unwrap().half_index(m);
        spectrum.p[at] = p;
    }
    report::write(root.path(), &a, false).unwrap();
    let (size, said, pixels) = picture(&root.path().join("spectrum.png"));
    assert!(said.contains("P (1 + P / n^2) / (1 + P)") && said.contains("m_y = -4..4 upward"), "{said}");
    let zoom = size[0] / 7;
    assert_eq!(size, [7 * zoom, 9 * zoom]);
    assert!((512..=1024).contains(&size[1]));
    let at = |m0: i32, m1: i32| {
        let (x, y) = ((m0 + 3) as u32 * zoom + zoom / 2, (4 - m1) as u32 * zoom + zoom / 2);
        pixels[(y * size[0] + x) as usize]
    };
    let (low, high) = ([68, 1, 84], [253, 231, 37]);
    assert_eq!((at(0, 0), at(2, 2), at(3, 4)), ([128; 3], low, low));
    assert_eq!((at(0, 4), at(3, -4), at(-3, 4)), (high, high, high));
    // Viridis at 1/2: (33, 145, 140).
    assert!(at(1, 0).iter().zip([33, 145, 140]).all(|(&a, b): (&u8, u8)| a.abs_diff(b) <= 4), "{:?}", at(1, 0));
    assert_eq!(at(1, 0), at(-1, 0));
    assert!(fs::read_to_string(root.path().join("report.html")).unwrap().contains(&format!("n = {n}")));
}

/// As papers print it: grey, linear from 0 to 2, up to 4 cycles per mean spacing, DC masked.
#[test]
fn the_grey_spectrum_is_that_of_papers() {
    let root = tempfile::tempdir().unwrap();
    let mut a = small();
    a.shape.mean_points = 9.0;
    let spectrum = a.findings.get_mut::<PowerSpectrum>().unwrap();
    let grid = WaveGrid::new(&[20, 20]).unwrap();
    spectrum.p = vec![0.0; grid.half_len()];
    spectrum.p_se = spectrum.p.clone();
    for (m, p) in [([0, 0, 0], 9.0), ([1, 0, 0], 1.0), ([0, -12, 0], 2.0), ([0, -13, 0], 2.0)] {
        spectrum.p[grid.half_index(m)] = p;
    }
    spectrum.waves = grid.into();
    a.grid_wanted = true;
    a.findings.remove::<RadialSpectrum>();
    a.findings.remove::<SpectrumDetails>();
    report::write(root.path(), &a, false).unwrap();
    let (size, said, pixels) = picture(&root.path().join("spectrum_grey.png"));
    assert!(said.contains("m_x = -12..12") && said.contains("v = P / 2"), "{said}");
    let zoom = size[0] / 25;
    assert_eq!(size, [25 * zoom, 25 * zoom]);
    let at = |m0: i32, m1: i32| {
        let (x, y) = ((m0 + 12) as u32 * zoom + zoom / 2, (12 - m1) as u32 * zoom + zoom / 2);
        pixels[(y * size[0] + x) as usize]
    };
    // L* = 50 is 119 of 255.
    assert_eq!((at(0, 0), at(1, 0), at(0, -12), at(5, 5)), ([128; 3], [119; 3], [255; 3], [0; 3]));
    let page = fs::read_to_string(root.path().join("report.html")).unwrap();
    assert!(!page.contains("in grey"));
}

/// A peak of one mode on a large grid is several pixels wide, and does not hide what is beside it.
#[test]
fn isolated_peaks_are_seen() {
    let root = tempfile::tempdir().unwrap();
    let mut a = small();
    a.shape.mean_points = 4096.0;
    let spectrum = a.findings.get_mut::<PowerSpectrum>().unwrap();
    let grid = WaveGrid::new(&[1000, 600]).unwrap();
    spectrum.waves = grid.into();
    spectrum.p = vec![0.0; grid.half_len()];
    spectrum.p_se = spectrum.p.clone();
    spectrum.p[grid.half_index([100, -50, 0])] = 4096.0;
    a.grid_wanted = true;
    a.findings.remove::<RadialSpectrum>();
    a.findings.remove::<SpectrumDetails>();
    report::write(root.path(), &a, false).unwrap();
    let (size, _, pixels) = picture(&root.path().join("spectrum.png"));
    assert_eq!(size, [2001, 1201]);
    let bright = pixels.iter().filter(|&&p| p == [253, 231, 37]).count();
    assert_eq!(bright, 2 * 25);
    for (dx, dy) in [(0, 0), (2, -2), (-2, 2)] {
        assert_eq!(pixels[((600 + 50 + dy) * 2001 + 1000 + 100 + dx) as usize], [253, 231, 37]);
    }
}

/// Size, text and pixels of an RGB picture.
fn picture(path: &Path) -> ([u32; 2], String, Vec<[u8; 3]>) {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let said = reader.info().uncompressed_latin1_text.iter().map(|t| t.text.clone()).collect();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    ([info.width, info.height], said, pixels.as_chunks::<3>().0.to_vec())
}
