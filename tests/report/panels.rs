//! What a viewer shows and hands out: panels, units, readouts, pixels and overlays of an `Analysis`.
//!
//! Trusts the analysis and the report (their own tests judge them). Proves that a panel hands out the very bytes of the report's
//! files, that values read out are the estimates, that pictures on a screen have the right place and the right way up, and that
//! what is drawn over points is where brute force finds it. The comparison of files is shown to fail on a planted difference.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use crate::common::*;
use pairwave::analysis::{self, Analysis, Plan};
use pairwave::compute::{Device, cpu::Cpu};
use pairwave::control::Control;
use pairwave::display::{self, Axis, AxisScale, ColorMap, FrequencyUnit, LengthUnit, Panel, ToneMap, overlays};
use pairwave::estimate::PowerSpectrum;
use pairwave::points::{Domain, Ensemble};
use pairwave::report::{self, panel};
use pairwave::source::Points;

fn analyze(arguments: &str) -> Analysis {
    let request = request(arguments);
    let source = Points::open(&request.input).unwrap();
    let plan = Plan::of(&request, &source).unwrap();
    let device = Device::new(Box::new(Cpu::new(None).unwrap()), None).unwrap();
    analysis::run(&request, Arc::new(source), plan, &device, &Control::default(), &mut |_| ()).unwrap()
}

/// Everything a panel may show.
const STATS: &str = "--stats pcf,pcf-vector,spectrum";

/// A rank-1 lattice of 16 points, whose spectrum and lags are not their own mirror images in the x axis: peaks at (3, -1), lags
/// (1, 3) / 16.
fn slanted() -> Analysis {
    let file = tempfile::Builder::new().suffix(".csv").tempfile().unwrap();
    let lines = rank1(16, 3).coordinates.chunks(2).map(|p| format!("{},{}\n", p[0], p[1])).collect::<String>();
    fs::write(file.path(), format!("x,y\n{lines}")).unwrap();
    analyze(&format!("{} {STATS} --max-frequency 9 --lag-bins 16", file.path().display()))
}

/// The files of a panel by name.
type Files = BTreeMap<String, Vec<u8>>;

fn files(panel: Panel, analysis: &Analysis) -> Files {
    let svg = panel::svg(panel, analysis).unwrap().map(String::into_bytes);
    let parts = [
        ("svg", svg),
        ("png", panel::png(panel, analysis).unwrap()),
        ("csv", panel::csv(panel, analysis).unwrap()),
        ("npy", panel::npy(panel, analysis).unwrap()),
    ];
    let named = |(end, bytes): (&str, Option<Vec<u8>>)| Some((format!("{}.{end}", panel.slug()), bytes?));
    parts.into_iter().filter_map(named).collect()
}

/// The first file that is there and differs.
fn difference(files: &Files, dir: &Path) -> Option<String> {
    let differs = |(name, bytes): (&String, &Vec<u8>)| {
        let path = dir.join(name);
        (path.exists() && fs::read(&path).unwrap() != *bytes).then(|| name.clone())
    };
    files.iter().find_map(differs)
}

#[test]
fn panels_hand_out_the_files_of_the_report() {
    for (scene, expected) in [
        (
            format!("--sampler jittered -n 64 -k 3 {STATS} --integrand disk"),
            "variance.csv variance.svg pcf.csv pcf.svg spectrum_radial.csv spectrum_radial.svg anisotropy.svg points.svg spectrum.npy spectrum.png pcf_vector.npy pcf_vector.png",
        ),
        (
            format!("--sampler random --dim 3 -n 40 {STATS} --max-frequency 3 --lag-bins 6"),
            "pcf.csv spectrum.npy spectrum.png pcf_vector.png",
        ),
        (format!("--sampler random --dim 1 -n 40 {STATS}"), "pcf.csv spectrum.npy pcf_vector.npy points.svg"),
        ("--sampler random -n 64 --stats radial".into(), "spectrum_radial.csv anisotropy.svg points.svg"),
    ] {
        let analysis = analyze(&scene);
        let out = tempfile::tempdir().unwrap();
        let dir = out.path().join("result");
        let written = report::write(&dir, &analysis, false).unwrap();
        let mut all = Files::new();
        for panel in Panel::ALL {
            let mut files = files(panel, &analysis);
            assert_eq!(difference(&files, &dir), None, "{scene}: {panel:?}");
            all.append(&mut files);
        }
        for name in expected.split(' ') {
            assert!(all.contains_key(name), "{scene}: no panel hands out {name}");
            assert!(written.contains(&dir.join(name)), "{scene}: the report lacks {name}");
        }
        // What the report wrote under a panel's name, a panel hands out.
        let slugs = Panel::ALL.map(Panel::slug);
        for path in written {
            let name = path.file_name().unwrap().to_str().unwrap();
            let (stem, _) = name.split_once('.').unwrap();
            assert!(!slugs.contains(&stem) || all.contains_key(name), "{scene}: {name} is in no panel");
        }
        // A planted difference of one byte is seen.
        let path = dir.join("points.svg");
        let mut bytes = fs::read(&path).unwrap();
        bytes[1000] ^= 1;
        fs::write(&path, bytes).unwrap();
        assert_eq!(difference(&files(Panel::Points, &analysis), &dir), Some("points.svg".into()));
    }
}

#[test]
fn panels_know_what_they_hand_out() {
    let list = tempfile::NamedTempFile::new().unwrap();
    fs::write(list.path(), "1,0\n2,3\n").unwrap();
    let list = format!("--sampler random -n 50 -k 2 --stats spectrum --frequencies {}", list.path().display());
    let mut found = Vec::new();
    for arguments in [
        &format!("--sampler random -n 20 -k 2 --dim 1 {STATS} --max-frequency 8"),
        &format!("--sampler random -n 20 -k 2 {STATS} --max-frequency 8 --integrand disk"),
        &format!("--sampler random -n 20 -k 2 --dim 3 {STATS} --max-frequency 3"),
        "--sampler random -n 20 -k 2 --stats radial --max-frequency 8",
        "--sampler random -n 20 -k 2 --stats neighbors",
        &list,
    ] {
        let analysis = analyze(arguments);
        for panel in Panel::ALL {
            let made = panel::Offers {
                svg: panel::svg(panel, &analysis).unwrap().is_some(),
                png: panel::png(panel, &analysis).unwrap().is_some(),
                csv: panel::csv(panel, &analysis).unwrap().is_some(),
                npy: panel::npy(panel, &analysis).unwrap().is_some(),
            };
            assert_eq!(panel::offers(panel, &analysis), made, "{panel:?} of {arguments}");
            found.push(made);
        }
    }
    let kinds: [fn(&panel::Offers) -> bool; 4] = [|o| o.svg, |o| o.png, |o| o.csv, |o| o.npy];
    for of in kinds {
        assert!(found.iter().any(of) && !found.iter().all(of));
    }
}

#[test]
fn pictures_of_grids_are_well_formed_and_hold_their_picture() {
    for scene in [
        format!("--sampler jittered -n 64 -k 3 {STATS}"),
        format!("--sampler random --dim 3 -n 40 {STATS} --max-frequency 3 --lag-bins 6"),
        format!("--sampler random --box 40,1 -n 64 {STATS}"),
    ] {
        // The sampler takes no subject that needs escaping; a person's file name may.
        let mut analysis = analyze(&scene);
        analysis.subject = "<a> & \"b\"".into();
        for (panel, pictures) in [(Panel::Spectrum, 2), (Panel::Vector, if scene.contains("--dim 3") { 4 } else { 2 })]
        {
            let svg = panel::svg(panel, &analysis).unwrap().unwrap();
            let document = roxmltree::Document::parse(&svg).unwrap();
            let images = || document.descendants().filter(|node| node.has_tag_name("image"));
            assert_eq!(images().count(), pictures, "{scene}: {panel:?}, colour bar included");
            let height: f64 = document.root_element().attribute("height").unwrap().parse().unwrap();
            for image in images() {
                let [x, y, w, h] =
                    ["x", "y", "width", "height"].map(|a| image.attribute(a).unwrap().parse::<f64>().unwrap());
                assert!(x > 0.0 && y > 0.0 && w > 5.0 && h > 5.0 && x + w < 900.0 && y + h < height, "{x} {y} {w} {h}");
            }
            if let Ok(gallery) = std::env::var("PAIRWAVE_GALLERY") {
                let name = format!("{}_{}.svg", panel.slug(), analysis.shape.max_points + analysis.domain.dim() as u64);
                fs::write(Path::new(&gallery).join(name), &svg).unwrap();
            }
        }
    }
}

#[test]
fn the_points_read_back() {
    let analysis = analyze("--sampler jittered -n 64 -k 2 --stats pcf");
    let csv = panel::csv(Panel::Points, &analysis).unwrap().unwrap();
    let file = tempfile::Builder::new().suffix(".csv").tempfile().unwrap();
    fs::write(file.path(), csv).unwrap();
    let sets = Points::open(&request(&file.path().display().to_string()).input).unwrap();
    let back = sets.batch(0..1, &Control::default()).unwrap();
    assert_eq!(back.fractions(0), analysis.first.fractions(0));
}

/// Curves are the estimates: every value, twice its error between the ends of the band, its closed form.
#[test]
fn curves_are_the_estimates_in_the_units_of_their_axes() {
    let analysis = analyze(&format!("--sampler jittered -n 64 -k 5 --max-frequency 12 --bins 40 {STATS}"));
    let (g, radial) = (analysis.pair_correlation().unwrap(), analysis.radial().unwrap());
    let r = Axis::distance(&analysis, LengthUnit::PackingDistance, AxisScale::Linear);
    let curve = Panel::Pcf.trace(&analysis, r, Axis::g(AxisScale::Linear)).unwrap();
    let unit = LengthUnit::PackingDistance.size(&analysis.domain, 64.0);
    let expected: Vec<[f64; 2]> = g.r.iter().zip(&g.g).map(|(r, &g)| [r / unit, g]).collect();
    assert_eq!(curve.line, [expected]);
    for (b, [x, low, high]) in curve.band[0].iter().copied().enumerate() {
        assert_eq!((x, low, high), (g.r[b] / unit, g.g[b] - g.g_se[b], g.g[b] + g.g_se[b]));
    }
    let theory: Vec<f64> = curve.closed_form[0].iter().map(|p| p[1]).collect();
    assert_eq!(theory, *analysis.closed_form.g.as_ref().unwrap());
    assert_eq!((curve.reference, curve.frame.x[0], curve.frame.y[0]), (Some(1.0), 0.0, 0.0));
    assert_eq!(curve.landmark, Some((1.0, "d_hex".into())));

    // Of the logarithm of 0 there is none: the line leaves the frame there, and is whole.
    let log = Panel::Pcf.trace(&analysis, r, Axis::g(AxisScale::Log)).unwrap();
    let positive = g.g.iter().filter(|g| **g > 0.0).count();
    assert!(positive < g.g.len());
    assert!(log.line.len() == 1 && log.line[0].len() == g.g.len());
    assert_eq!(log.line[0].iter().filter(|place| place[1] >= log.frame.y[0]).count(), positive);
    assert!(log.line.iter().flatten().chain(log.closed_form.iter().flatten()).flatten().all(|v| v.is_finite()));
    assert!(log.band.iter().flatten().flatten().all(|v| v.is_finite()));

    let nu = Axis::frequency(&analysis, FrequencyUnit::SqrtN, AxisScale::Log);
    let decibel = Panel::Radial.trace(&analysis, nu, Axis::p(AxisScale::Decibel)).unwrap();
    for (place, ring) in decibel.line[0].iter().zip(&radial.rings) {
        let expected = [(ring.nu / 8.0).log10(), 10.0 * ring.p.log10()];
        assert!(place.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{place:?} {expected:?}");
    }
    assert_eq!(decibel.landmark, Some((0.0, "√n".into())));
    let anisotropy = Panel::Anisotropy.trace(&analysis, nu, Axis::anisotropy()).unwrap();
    assert_eq!(anisotropy.reference, Some(radial.anisotropy_reference_db));
    let known = radial.rings.iter().filter_map(|ring| ring.anisotropy_db).collect::<Vec<_>>();
    assert_eq!(anisotropy.line.iter().flatten().map(|p| p[1]).collect::<Vec<_>>(), known);
    let [_, low, high] = anisotropy.band[0][3];
    assert!(((low + high) / 2.0 - radial.anisotropy_reference_db).abs() < 1e-12);
    assert!([Panel::Points, Panel::Spectrum, Panel::Vector].iter().all(|p| p.trace(&analysis, nu, nu).is_none()));
    let line = analyze("--sampler jittered -n 16 -k 2 --dim 1 --stats radial");
    let nu = Axis::frequency(&line, FrequencyUnit::Cycles, AxisScale::Linear);
    assert_eq!(Panel::Anisotropy.trace(&line, nu, Axis::anisotropy()), None);
    assert!(Panel::Anisotropy.without_curve(&line).contains("one dimension"));
    assert!(Panel::Radial.trace(&line, nu, Axis::p(AxisScale::Linear)).is_some());
    let list = tempfile::NamedTempFile::new().unwrap();
    fs::write(list.path(), "1,0\n2,3\n").unwrap();
    let list = analyze(&format!("--sampler random -n 50 --stats spectrum --frequencies {}", list.path().display()));
    assert_eq!(Panel::Radial.trace(&list, nu, Axis::p(AxisScale::Linear)), None);
    assert!(Panel::Radial.without_curve(&list).contains("list"));
}

/// The places of a curve that are not those of its table, by the columns (x, value, error).
fn misplaced(panel: Panel, analysis: &Analysis, columns: [&str; 3], curve: &display::Trace) -> usize {
    let table = String::from_utf8(panel::csv(panel, analysis).unwrap().unwrap()).unwrap();
    let lines: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
    let header: Vec<&str> = lines[0].split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap_or_else(|| panic!("{name} in {header:?}"));
    let [x, value, error] = columns.map(column);
    let number = |line: &str, at: usize| line.split(',').nth(at).unwrap().parse::<f64>().unwrap();
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs().max(1e-3);
    let (places, bands) = (curve.line.iter().flatten(), curve.band.iter().flatten());
    assert_eq!(
        (curve.line.iter().flatten().count(), curve.band.iter().flatten().count()),
        (lines.len() - 1, lines.len() - 1)
    );
    let wrong = |((line, place), [_, low, high]): ((&&str, &[f64; 2]), &[f64; 3])| {
        let (v, se) = (number(line, value), number(line, error));
        !(near(place[0], number(line, x)) && near(place[1], v) && near(*low, v - se) && near(*high, v + se))
    };
    lines[1..].iter().zip(places).zip(bands).filter(|row| wrong(*row)).count()
}

#[test]
fn curves_are_the_numbers_of_the_tables() {
    let analysis = analyze(&format!("--sampler random -n 64 -k 5 --max-frequency 12 --bins 40 {STATS}"));
    let linear = AxisScale::Linear;
    for (panel, x, columns) in [
        (Panel::Pcf, Axis::distance(&analysis, LengthUnit::Box, linear), ["r", "g", "g_se"]),
        (Panel::Radial, Axis::frequency(&analysis, FrequencyUnit::Cycles, linear), ["nu", "p", "p_se"]),
    ] {
        let mut curve = panel.trace(&analysis, x, Axis::g(linear)).unwrap();
        assert_eq!(misplaced(panel, &analysis, columns, &curve), 0, "{panel:?}");
        // Planted faults: one value, one end of a band.
        curve.line[0][3][1] *= 1.0 + 1e-6;
        curve.band[0][7][2] += 1e-6;
        assert_eq!(misplaced(panel, &analysis, columns, &curve), 2, "{panel:?}");
    }
}

#[test]
fn dots_and_sums_of_integrals_are_the_numbers_of_the_table() {
    let integrands = "--integrand disk --integrand gaussian";
    let analysis = analyze(&format!("--sampler jittered -n 64 -k 5 --max-frequency 12 --stats radial {integrands}"));
    let found = analysis.integration().unwrap();
    let all = display::error_bars(&analysis);
    assert_eq!(all.len(), 2);
    for (bars, e) in all.iter().zip(&found.each) {
        let [spectral, spatial, shifted, as_is] = bars.each.as_slice() else { panic!("{bars:?}") };
        let relative = |measured: pairwave::estimate::Measured| {
            let [value, se] = [measured.value, measured.se.unwrap()].map(|x| x * 64.0 / e.v0);
            [value, value - 2.0 * se, value + 2.0 * se]
        };
        for (bar, measured) in
            [(spectral, e.closed), (spatial, e.spatial.unwrap()), (shifted, e.shifted), (as_is, e.observed.unwrap())]
        {
            let [low, high] = bar.ends;
            let near = |(a, b): (f64, f64)| (a - b).abs() <= 1e-12 * b.abs();
            assert!([bar.value, low, high].into_iter().zip(relative(measured)).all(near), "{bar:?} {measured:?}");
        }
        assert!(spectral.form.is_predicted() && spatial.form.is_predicted() && !shifted.form.is_predicted());
    }
    let frequencies = display::Origin::Frequencies.shares(&analysis).unwrap();
    for (share, e) in frequencies.each.iter().zip(&found.each) {
        assert_eq!(share.spec, e.integrand.spec());
        let all: f64 = e.rings.iter().map(|ring| ring.variance).sum();
        let last = share.line.last().unwrap();
        assert!((last[1] - all / e.closed.value).abs() < 1e-12 && last[0] == e.rings.last().unwrap().m.log10());
        assert!(share.line.windows(2).all(|p| p[0][0] < p[1][0] && p[0][1] <= p[1][1]));
    }
    let distances = display::Origin::Distances.shares(&analysis).unwrap();
    for (k, e) in found.each.iter().enumerate() {
        // All pairs: what is predicted in space, but for what a grid of lags does not resolve.
        let (place, text) = distances.at(k, 10.0).unwrap();
        assert!((place[1] / (e.spatial.unwrap().value / e.alone) - 1.0).abs() < 0.05, "{place:?}: {text}");
        assert_eq!(distances.at(k, 0.0).unwrap().0, [0.0, 1.0]);
        assert_eq!(distances.at(k, -0.1), None);
    }
    // Without integrands there is nothing.
    let none = analyze("--sampler random -n 9 --stats radial");
    assert!(display::error_bars(&none).is_empty() && display::Origin::Distances.shares(&none).is_none());
}

#[test]
fn the_map_of_variance_is_that_of_its_modes() {
    let line = "--sampler jittered -n 16 -k 4 --max-frequency 6 --stats spectrum --integrand gaussian";
    let analysis = analyze(line);
    let error = &analysis.integration().unwrap().each[0];
    let map = display::Attribution::of(&analysis, error).unwrap();
    // The mode that adds most, with its mirror image; what it adds is said in the unit of the dots.
    let top = &error.modes[0];
    let part = 0.5 * top.variance * 16.0 / error.v0;
    let largest = map.largest();
    assert!((largest / part - 1.0).abs() < 1e-4, "{largest} {part}");
    let at = display::spectrum_at(&analysis, [f64::from(top.m[0]), f64::from(top.m[1])]).unwrap();
    assert!(map.text(&at).starts_with(&at.text()) && map.text(&at).contains("|f_m|² P / v₀ = "));
    // Its pixel is the brightest, y upward, and DC is grey.
    let grey = display::ColorMap::Grey;
    let pixels = map.pixels(largest, grey, 99);
    assert_eq!([pixels.width, pixels.height], [13, 13]);
    let pixel = |m: [i32; 2]| &pixels.rgb[3 * ((6 - m[1]) * 13 + m[0] + 6) as usize..][..3];
    assert_eq!((pixel([top.m[0], top.m[1]]), pixel([0, 0])), (&[255; 3][..], &[128; 3][..]));
    let small = pixel([6, 6])[0];
    assert!(small < pixel([1, 1])[0], "{small}");
    let ticks = display::Attribution::ticks(largest);
    assert!(ticks.len() >= 5 && ticks.windows(2).all(|t| t[0].0 < t[1].0), "{ticks:?}");
}

/// Whatever points weigh and whichever estimate they make, all frequencies together are the prediction without its tail.
#[test]
fn the_map_of_variance_adds_up() {
    let sum = |analysis: &Analysis| {
        let error = &analysis.integration().unwrap().each[0];
        let map = error.map.as_ref().unwrap();
        let [x, y] = map.half().map(|half| half as i32);
        let modes = (-x..=x).flat_map(|x| (-y..=y).map(move |y| [x, y])).filter(|m| *m != [0; 2]);
        let all: f64 = modes.map(|m| map.variance(m).unwrap()).sum();
        assert_eq!([map.variance([0, 0]), map.variance([x + 1, 0]), map.variance([0, -y - 1])], [None; 3]);
        let largest = map.variance([error.modes[0].m[0], error.modes[0].m[1]]).unwrap();
        assert!(map.largest() >= largest);
        all / error.spectral.value
    };
    let line = "--sampler thomas -n 16 -k 4 --max-frequency 6,4 --stats radial --integrand formula:x*y^2+x";
    for more in [
        "",
        "--estimator ratio",
        "--intensity formula:1+x",
        "--intensity formula:1+x --by removal",
        "--intensity formula:1+x --by removal --estimator ratio",
        "--intensity formula:1+x --by warp",
    ] {
        let all = sum(&analyze(&format!("{line} {more}")));
        assert!((all - 1.0).abs() < 1e-9, "{more}: {all}");
    }
    // In 3D a plane of them is less, in 1D there is no picture, and a constant has no variance.
    let all = sum(&analyze("--sampler random -n 8 -k 2 --dim 3 --max-frequency 3 --stats radial --integrand gaussian"));
    assert!(all > 0.01 && all < 0.9, "{all}");
    for none in ["--dim 1 --integrand ramp", "--integrand formula:3"] {
        let analysis = analyze(&format!("--sampler random -n 9 -k 2 --max-frequency 4 --stats radial {none}"));
        let error = &analysis.integration().unwrap().each[0];
        assert!(error.map.is_none() && display::Attribution::of(&analysis, error).is_none(), "{none}");
    }
}

/// The file has a picture per integrand that varies, under its name, with axes and the colours' values.
#[test]
fn maps_of_variance_are_a_file_and_in_the_page() {
    let line = "--sampler jittered -n 16 -k 4 --max-frequency 6 --stats radial --integrand disk --integrand formula:3 --integrand gaussian:sigma=0.2";
    let read = |line: &str| {
        let (root, analysis) = (tempfile::tempdir().unwrap(), analyze(line));
        report::write(&root.path().join("out"), &analysis, false).unwrap();
        let text = |name: &str| fs::read_to_string(root.path().join("out").join(name));
        (text("attribution_map.svg").ok(), text("report.html").unwrap())
    };
    let (map, page) = read(line);
    let map = map.unwrap();
    let ids = roxmltree::Document::parse(&map).unwrap();
    let texts: Vec<&str> = ids.descendants().filter(|n| n.has_tag_name("text")).filter_map(|n| n.text()).collect();
    for (wanted, times) in [
        ("disk", 1),
        ("gaussian:sigma=0.2,", 1),
        ("formula:3", 0),
        ("ν_x (cycles per unit length)", 2),
        ("ν_y (cycles per unit length)", 2),
        ("|f_m|² P / v₀", 2),
    ] {
        assert_eq!(texts.iter().filter(|text| text.starts_with(wanted)).count(), times, "{wanted}: {texts:?}");
    }
    assert!(page.contains(">gaussian:sigma=0.2,") && page.contains("what each adds to the variance"));
    let (none, page) = read(
        &line.replace("jittered", "random").replace("--integrand disk", "").replace("gaussian:sigma=0.2", "formula:4"),
    );
    assert!(none.is_none() && !page.contains("what each adds to the variance"));
}

#[test]
fn points_of_a_density_weigh_one_over_it() {
    use pairwave::display::overlays;
    let line = "--sampler jittered -n 400 -k 2 --stats radial --max-frequency 4 --integrand gaussian";
    assert_eq!(overlays::weights(&analyze(line), &analyze(line).first), None);
    let density = "formula:0.25+0.75*sin(pi*x)^2";
    let known = analyze(&format!("{line} --intensity {density}"));
    let removed = analyze(&format!("{line} --intensity {density} --by removal"));
    let f = pairwave::Integrand::new(density, 2).unwrap();
    for (analysis, all) in [(&known, true), (&removed, false)] {
        let weights = overlays::weights(analysis, &analysis.first).unwrap();
        let products: Vec<f64> = (0..400)
            .filter(|&j| weights[j] != 0.0)
            .map(|j| weights[j] * f.value(&analysis.first.position(0, j)))
            .collect();
        assert!(products.iter().all(|p| (p / products[0] - 1.0).abs() < 1e-9));
        assert_eq!(products.len() == 400, all);
        assert!((weights.iter().sum::<f64>() / products.len() as f64 - 1.0).abs() < 1e-12);
    }
    // Those that are kept are as many as were counted.
    let one = analyze(&format!("{line} --intensity {density} --by removal").replace("-k 2", "-k 1"));
    let kept = overlays::weights(&one, &one.first).unwrap().iter().filter(|w| **w != 0.0).count();
    assert_eq!(one.integration().unwrap().placed.as_ref().unwrap().points.value, kept as f64);
}

#[test]
fn rounding_does_not_set_the_range_of_decibels() {
    // A lattice: P is 0 at all but its peaks, in floating point about 1e-30.
    let analysis = analyze("--sampler grid -n 64 --stats radial --max-frequency 20");
    let nu = Axis::frequency(&analysis, FrequencyUnit::Cycles, AxisScale::Linear);
    let curve = Panel::Radial.trace(&analysis, nu, Axis::p(AxisScale::Decibel)).unwrap();
    let [low, high] = curve.frame.y;
    assert!((-125.0..0.0).contains(&low) && high > 0.0 && high < 40.0, "{low} to {high}");
}

#[test]
fn panels_say_what_they_need_and_mean() {
    let mut slugs = Vec::new();
    for panel in Panel::ALL {
        assert!(!panel.name().is_empty() && panel.definition().ends_with('.'), "{panel:?}");
        slugs.push(panel.slug());
        let back: Panel = serde_json::from_str(&serde_json::to_string(&panel).unwrap()).unwrap();
        assert_eq!(back, panel);
        // With what it asks for, and nothing else, it has something to show.
        let stats: Vec<_> = panel.statistics().iter().map(|s| s.name()).collect();
        let stats = if stats.is_empty() { "neighbors".into() } else { stats.join(",") };
        let integrand = if panel == Panel::Integration { "--integrand disk" } else { "" };
        let analysis = analyze(&format!("--sampler jittered -n 16 --stats {stats} {integrand}"));
        assert!(panel::svg(panel, &analysis).unwrap().is_some(), "{panel:?} with {stats}");
        for other in Panel::ALL.into_iter().filter(|p| *p != Panel::Points) {
            let covered = other.statistics().iter().all(|s| panel.statistics().contains(s));
            // P on the grid brings its rings.
            let covered = covered && (other != Panel::Integration || panel == other);
            let covered = covered || panel == Panel::Spectrum && other.statistics() == Panel::Radial.statistics();
            assert_eq!(panel::svg(other, &analysis).unwrap().is_some(), covered, "{other:?} with {stats}");
        }
    }
    slugs.sort_unstable();
    slugs.dedup();
    assert_eq!(slugs.len(), Panel::ALL.len());
}

#[test]
fn what_is_read_out_is_the_estimate() {
    let a = analyze(&format!("--sampler jittered -n 64 -k 4 {STATS} --bins 20"));
    let (g, rings) = (a.pair_correlation().unwrap(), &a.radial().unwrap().rings);
    for b in 0..g.g.len() {
        for r in [g.r_lo[b], g.r[b], 0.5 * (g.r[b] + g.r_hi[b])] {
            let at = display::bin_at(&a, r).unwrap();
            let found = (at.index, at.r_lo, at.r, at.r_hi, at.count, at.g, at.se);
            assert_eq!(found, (b, g.r_lo[b], g.r[b], g.r_hi[b], g.count[b], g.g[b], g.g_se[b]));
            assert_eq!(at.theory, a.closed_form.g.as_ref().map(|theory| theory[b]));
        }
    }
    for (k, ring) in rings.iter().enumerate() {
        let at = display::ring_at(&a, ring.nu).unwrap();
        assert_eq!((at.index, at.p, at.se, at.modes), (k, ring.p, ring.p_se, ring.modes));
        assert_eq!((at.anisotropy_db, at.anisotropy_db_se), (ring.anisotropy_db, ring.anisotropy_db_se));
        assert_eq!(at.theory, a.closed_form.radial.as_ref().map(|theory| theory[k]));
    }
    let spectrum = a.spectrum().unwrap();
    let grid = spectrum.waves.grid().unwrap();
    for (m0, m1) in [(3, -2), (-7, 1), (0, 5), (-40, 40)] {
        let at = display::spectrum_at(&a, [f64::from(m0) + 0.4, f64::from(m1) - 0.4]).unwrap();
        let index = grid.half_index([m0, m1, 0]);
        assert_eq!((at.m, at.p, at.se), ([m0, m1, 0], spectrum.p[index], Some(spectrum.p_se[index])));
    }
    assert_eq!(display::spectrum_at(&a, [0.2, -0.3]).unwrap().se, None);
    let vector = a.vector().unwrap();
    for cell in [0, 77, 2000, vector.g.len() - 1] {
        let lag = [vector.grid.centre(cell, 0), vector.grid.centre(cell, 1)];
        let at = display::vector_at(&a, lag, 0).unwrap();
        assert_eq!((at.lag, at.g, at.se), (lag, vector.g[cell], vector.g_se[cell]));
    }
    // Outside there is nothing.
    assert_eq!(display::bin_at(&a, -1e-9).or(display::bin_at(&a, *g.r_hi.last().unwrap())).map(|b| b.index), None);
    assert_eq!(display::ring_at(&a, 0.0).or(display::ring_at(&a, 1e9)).map(|r| r.index), None);
    assert_eq!(display::spectrum_at(&a, [41.0, 0.0]).or(display::spectrum_at(&a, [f64::NAN, 0.0])).map(|m| m.m), None);
    assert_eq!(display::vector_at(&a, [0.5, 0.0], 0).or(display::vector_at(&a, [0.0, 0.0], 1)).map(|l| l.lag), None);
}

#[test]
fn texts_state_value_error_and_unit() {
    let a = analyze(&format!("--sampler jittered -n 64 -k 4 {STATS} --bins 20"));
    let linear = AxisScale::Linear;
    let bin = display::bin_at(&a, 0.1).unwrap();
    let text = bin.text(Axis::distance(&a, LengthUnit::PackingDistance, linear));
    assert!(text.starts_with("r / d_hex = ") && text.contains("g = ") && text.contains(" ± "), "{text}");
    let shown: f64 = text.split(' ').nth(4).unwrap().parse().unwrap();
    assert!((shown / (bin.r / a.domain.closest_packing_distance(64.0)) - 1.0).abs() < 1e-3, "{text}");
    assert!(bin.text(Axis::distance(&a, LengthUnit::Box, linear)).contains("length units"), "the unit of r");
    let ring = display::ring_at(&a, 12.0).unwrap().text(Axis::frequency(&a, FrequencyUnit::SqrtN, linear));
    assert!(ring.starts_with("ν / √n = 1.5,") && ring.contains("closed form") && ring.contains(" dB"), "{ring}");
    let ring = display::ring_at(&a, 12.0).unwrap().text(Axis::frequency(&a, FrequencyUnit::Cycles, linear));
    assert!(ring.starts_with("ν = 12 cycles per unit length,"), "{ring}");
    let mode = display::spectrum_at(&a, [-3.0, 4.0]).unwrap().text();
    assert!(mode.starts_with("m = (−3, 4), |ν| = 5 cycles per unit length, P = ") && mode.contains(" ± "), "{mode}");
    let lag = display::vector_at(&a, [0.1, -0.2], 0).unwrap().text();
    assert!(lag.starts_with("(h_x, h_y) = (0.1077, −0.2)") && lag.contains("length units, g = "), "{lag}");
}

#[test]
fn axes_name_their_unit_and_are_in_it() {
    let components = analyze("--sampler random -n 9 -k 1 --stats pcf");
    let x = Axis::coordinate(&components, LengthUnit::Box, 0);
    assert_eq!((x.label(), x.symbol()), ("x (length units)".into(), "x".into()));
    assert_eq!(Axis::lag(&components, LengthUnit::PackingDistance, 1).symbol(), "h_y / d_hex");
    assert_eq!(Axis::wave(&components, FrequencyUnit::Cycles, 1).label(), "ν_y (cycles per unit length)");

    let a = analyze("--sampler random -n 100 --box 2,2 --stats pcf");
    let d = a.domain.closest_packing_distance(100.0);
    let axis = Axis::distance(&a, LengthUnit::PackingDistance, AxisScale::Linear);
    assert_eq!((axis.forward(d), axis.backward(2.0)), (Some(1.0), Some(2.0 * d)));
    assert!(axis.label().contains("d_hex"), "{}", axis.label());
    let axis = Axis::frequency(&a, FrequencyUnit::SqrtN, AxisScale::Log);
    assert_eq!((axis.forward(50.0), axis.forward(0.0)), (Some(1.0), None));
    assert_eq!(axis.symbol(), "ν / √λ");
    assert_eq!(Axis::g(AxisScale::Decibel).label(), "10 log10(g) (dB)");
    assert_eq!(Axis::anisotropy().text(-3.0), "anisotropy = −3 dB");
    // Frequencies of another program keep its unit.
    let psa = analyze("--sampler random -n 100 --stats radial --convention psa");
    let axis = Axis::frequency(&psa, FrequencyUnit::SqrtN, AxisScale::Linear);
    assert_eq!(axis.forward(50.0), Some(50.0));
    assert!(axis.label().contains("cycles per side"), "{}", axis.label());
}

/// The colour at a place, in units of the picture.
fn color_at(pixels: &display::Pixels, place: [f64; 2]) -> [u8; 3] {
    let part = |axis: usize| {
        let [low, high] = pixels.extent[axis];
        (place[axis] - low) / (high - low)
    };
    let column = (part(0) * pixels.width as f64) as usize;
    let row = ((1.0 - part(1)) * pixels.height as f64) as usize;
    let at = 3 * (row * pixels.width + column);
    pixels.rgb[at..at + 3].try_into().unwrap()
}

#[test]
fn pictures_have_their_peaks_in_place_and_y_upward() {
    let a = slanted();
    for map in ColorMap::SEQUENTIAL {
        for tones in ToneMap::ALL {
            let pixels = display::spectrum_pixels(&a, tones, None, map, None, 2048).unwrap();
            assert_eq!((pixels.width, pixels.height, pixels.rgb.len()), (19, 19, 3 * 19 * 19));
            assert_eq!(pixels.extent, [[-9.5, 9.5]; 2]);
            for m0 in -9..=9 {
                for m1 in -9..=9 {
                    let color = color_at(&pixels, [f64::from(m0), f64::from(m1)]);
                    let expected = match (m0, m1) {
                        (0, 0) => [128; 3],
                        _ if (m0 + 3 * m1) % 16 == 0 => map.color(tones.tone(16.0, 16.0)),
                        _ => map.color(0.0),
                    };
                    assert_eq!(color, expected, "{map:?} {tones:?} at ({m0}, {m1})");
                }
            }
        }
    }
    for map in ColorMap::DIVERGING {
        let pixels = display::vector_pixels(&a, None, map, 0, 2048).unwrap();
        assert_eq!((pixels.width, pixels.extent), (16, [[-0.5, 0.5]; 2]));
        assert_eq!(color_at(&pixels, [1.5 / 16.0, 3.5 / 16.0]), map.color(1.0), "a lag of the lattice");
        assert_eq!(color_at(&pixels, [1.5 / 16.0, -2.5 / 16.0]), map.color(0.0), "none");
        // 1 is in the middle, and no g is below 0.
        let ticks = display::vector_ticks(&a, Some(2.0)).unwrap();
        assert!(ticks.contains(&(0.5, "1.0".into())) && ticks[0] == (0.25, "0".into()), "{ticks:?}");
    }
    assert!(display::vector_pixels(&a, None, ColorMap::BlueRed, 1, 2048).is_none(), "one plane in 2D");
}

#[test]
fn pictures_with_little_room_keep_peaks_and_means() {
    let mut a = analyze(
        "--sampler random -n 64 -k 4 --stats spectrum,pcf-vector --max-frequency 20 --lag-bins 15 --lag-max 0.3",
    );
    let spectrum = a.findings.get_mut::<PowerSpectrum>().unwrap();
    let grid = *spectrum.waves.grid().unwrap();
    spectrum.p.fill(0.5);
    spectrum.p[grid.half_index([7, 12, 0])] = 60.0;
    // 41 modes in 14 pixels of 3; the peak and its mirror image, DC, and means.
    let pixels = display::spectrum_pixels(&a, ToneMap::Reinhard, Some(100.0), ColorMap::Viridis, None, 16).unwrap();
    assert_eq!((pixels.width, pixels.height, pixels.extent), (14, 14, [[-20.5, 21.5]; 2]));
    let tone = |p| ColorMap::Viridis.color(ToneMap::Reinhard.tone(p, 100.0));
    for (at, expected) in
        [([7.0, 12.0], tone(60.0)), ([-7.0, -12.0], tone(60.0)), ([0.0, 0.0], [128; 3]), ([12.0, 7.0], tone(0.5))]
    {
        assert_eq!(color_at(&pixels, at), expected, "{at:?}");
    }
    let count = pixels.rgb.chunks(3).filter(|pixel| *pixel == tone(60.0)).count();
    assert_eq!(count, 2, "one pixel each");
    // 15 cells in 5 pixels of 3, which are means.
    let pixels = display::vector_pixels(&a, Some(1.0), ColorMap::BlueRed, 0, 7).unwrap();
    let vector = a.vector().unwrap();
    assert_eq!((pixels.width, pixels.height), (5, 5));
    assert!(pixels.extent.iter().flatten().all(|end| (end.abs() - 0.3).abs() < 1e-12), "{:?}", pixels.extent);
    let strides = vector.grid.strides();
    let cells = (0..9).map(|k| (3 + k % 3) * strides[0] + (9 + k / 3) * strides[1]);
    let mean = cells.map(|cell| vector.g[cell]).sum::<f64>() / 9.0;
    assert_eq!(pixels.rgb[3 * (5 + 1)..][..3], ColorMap::BlueRed.color(0.5 * mean));
}

#[test]
fn pictures_of_space_are_slices() {
    let a = analyze(&format!("--sampler random --dim 3 -n 40 {STATS} --max-frequency 3 --lag-bins 6"));
    let pixels = display::spectrum_pixels(&a, ToneMap::Reinhard, None, ColorMap::Viridis, None, 2048).unwrap();
    let p = a.spectrum().unwrap().at([2, -1, 0]).unwrap();
    assert_eq!(color_at(&pixels, [2.0, -1.0]), ColorMap::Viridis.color(ToneMap::Reinhard.tone(p, 40.0)));
    let vector = a.vector().unwrap();
    let strides = vector.grid.strides();
    for (plane, [right, up]) in overlays::planes(3).iter().enumerate() {
        let pixels = display::vector_pixels(&a, Some(0.7), ColorMap::BlueRed, plane, 2048).unwrap();
        assert_eq!(pixels.axes, [*right, *up]);
        let cell = strides[*right] + 4 * strides[*up] + 2 * strides[3 - right - up];
        let (one, two) = (cell, cell + strides[3 - right - up]);
        let g = 0.5 * (vector.g[one] + vector.g[two]);
        let lag = [vector.grid.centre(one, *right), vector.grid.centre(one, *up)];
        let at = display::vector_at(&a, lag, plane).unwrap();
        assert_eq!((at.g, at.axes), (g, [*right, *up]));
        assert!(at.se <= 0.5 * (vector.g_se[one] + vector.g_se[two]));
        assert_eq!(color_at(&pixels, lag), ColorMap::BlueRed.color((g - 0.3) / 1.4));
    }
}

#[test]
fn links_lead_to_the_nearest_point() {
    let unequal = Domain::torus(&[2.0, 1.0, 3.0]).unwrap();
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    for (domain, dim, n) in [
        (Domain::unit_torus(1), 1, 30),
        (Domain::unit_torus(2), 2, 200),
        (Domain::unit_torus(2), 2, 5),
        (window, 2, 200),
        (unequal, 3, 100),
    ] {
        let points = Ensemble::from_raw(&[uniform(dim, n, 7)], &domain, true, 0).unwrap();
        for plane in overlays::planes(dim) {
            let links = overlays::neighbor_links(&points, *plane, &Control::default()).unwrap();
            assert_eq!(links.len(), n);
            let places = overlays::projected(&points, *plane);
            for (j, [from, to]) in links.iter().enumerate() {
                assert_eq!(*from, places[j]);
                let turns: &[f64] = if domain.is_torus() { &[-1.0, 0.0, 1.0] } else { &[0.0] };
                let x = points.position(0, j);
                // The nearest image of every other point, axis by axis.
                let offset = |i: usize| {
                    let y = points.position(0, i);
                    let axis = |a: usize| {
                        let steps = turns.iter().map(|t| y[a] + t * domain.sides()[a] - x[a]);
                        steps.min_by(|p, q| p.abs().total_cmp(&q.abs())).unwrap()
                    };
                    (0..dim).map(axis).collect::<Vec<_>>()
                };
                let square = |d: &[f64]| d.iter().map(|d| d * d).sum::<f64>();
                let nearest = (0..n).filter(|&i| i != j).map(offset).min_by(|p, q| square(p).total_cmp(&square(q)));
                let nearest = nearest.unwrap();
                for (k, &axis) in plane.iter().enumerate().filter(|(_, a)| **a < dim) {
                    assert!((to[k] - from[k] - nearest[axis]).abs() < 1e-12, "{domain:?}: point {j} along {axis}");
                }
            }
        }
    }
    let lone = ensemble(&[uniform(2, 1, 1)]);
    assert!(overlays::neighbor_links(&lone, [0, 1], &Control::default()).unwrap().is_empty());
    let together = ensemble(&[coincident(2, 3)]);
    assert_eq!(overlays::neighbor_links(&together, [0, 1], &Control::default()).unwrap().len(), 1, "the one apart");
}

#[test]
fn tiles_and_strata_are_in_place() {
    let points = ensemble(&[uniform(2, 9, 3)]);
    let places = overlays::projected(&points, [0, 1]);
    let tiles = overlays::tiles(points.domain(), [0, 1], &places).unwrap();
    assert_eq!(tiles.len(), 8 * 9);
    for place in &tiles {
        assert!(place.iter().all(|x| (-1.0..2.0).contains(x)) && !place.iter().all(|x| (0.0..1.0).contains(x)));
        let home = place.map(|x| x.rem_euclid(1.0));
        assert!(places.iter().any(|p| (p[0] - home[0]).abs() + (p[1] - home[1]).abs() < 1e-12));
    }
    assert_eq!(overlays::tiles(&Domain::unit_torus(1), [0, 1], &[[0.25, 0.0]]), Some(vec![[-0.75, 0.0], [1.25, 0.0]]));
    assert_eq!(overlays::tiles(&Domain::window(&[(0.0, 1.0)]).unwrap(), [0, 1], &[[0.25, 0.0]]), None);

    assert_eq!(
        [(64, 2), (63, 2), (27, 3), (5, 1), (0, 2)].map(|(n, d)| overlays::strata(n, d)),
        [Some(8), None, Some(3), Some(5), None]
    );
    let window = Domain::window(&[(1.0, 3.0), (0.0, 1.0)]).unwrap();
    let lines = overlays::strata_lines(&window, [0, 1], 4).unwrap();
    assert_eq!(lines.len(), 6);
    assert!(lines.contains(&[[2.0, 0.0], [2.0, 1.0]]) && lines.contains(&[[1.0, 0.5], [3.0, 0.5]]), "{lines:?}");
    assert_eq!(overlays::strata_lines(&window, [0, 1], 5), None);
}

#[test]
fn settings_of_a_session_read_back() {
    fn back<T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + std::fmt::Debug>(value: T) {
        let text = serde_json::to_string(&value).unwrap();
        assert_eq!(serde_json::from_str::<T>(&text).unwrap(), value, "{text}");
    }
    ToneMap::ALL.into_iter().for_each(back);
    ColorMap::SEQUENTIAL.into_iter().for_each(back);
    ColorMap::DIVERGING.into_iter().for_each(back);
    LengthUnit::ALL.into_iter().for_each(back);
    FrequencyUnit::ALL.into_iter().for_each(back);
    AxisScale::ALL.into_iter().for_each(back);
}
