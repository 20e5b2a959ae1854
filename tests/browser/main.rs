//! Pages as a browser shows them: Chromium opens what the program wrote.
//!
//! Trusts the files that lie beside a page (the report's and command's tests judge them), Chromium, and axe-core for accessibility. Proves
//! that pages say nothing on the console and ask for nothing, that what a figure tells where it is pointed at, by keys and by touch is what its
//! CSV or NPY has there, that copies and saved tables are those numbers, that curves go and come back, that light, dark, a phone and paper
//! work. Every check is shown to see a planted fault.

#![cfg(unix)]

mod chrome;
#[path = "../command/shared.rs"]
#[allow(dead_code, reason = "of the room it is from some is not needed here")]
mod shared;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use chrome::{Chrome, Tab};
use serde_json::json;
use shared::{Scratch, npy, table};

/// The numbers of a picture as the page shows them.
fn number(text: &str) -> f64 {
    text.rsplit("= ").next().unwrap().trim().parse().unwrap_or_else(|_| panic!("{text}"))
}

/// Where an abscissa of a figure stands, in px of the window, by the labels of its axis, and the middle of its height.
fn place(tab: &mut Tab<'_>, figure: &str, x: f64) -> [f64; 2] {
    let marks = tab.js(&format!(
        "(() => {{ const svg = document.querySelector('#{figure} svg'); svg.scrollIntoView({{ block: 'center' }});
          const labels = [...svg.querySelectorAll('text[text-anchor=middle][font-size=\"13\"]')].filter(t => t.textContent.trim() && !isNaN(t.textContent));
          const low = Math.max(...labels.map(t => Number(t.getAttribute('y'))));
          const axis = labels.filter(t => Number(t.getAttribute('y')) === low).map(t => [Number(t.textContent), Number(t.getAttribute('x'))]);
          const r = svg.getBoundingClientRect();
          return [axis[0], axis[axis.length - 1], r.left, r.top + r.height / 2, r.width / 900]; }})()"
    ));
    let of = |k: usize, j: usize| marks[k][j].as_f64().unwrap();
    let one = |k: usize| marks[k].as_f64().unwrap();
    let at = of(0, 1) + (x - of(0, 0)) / (of(1, 0) - of(0, 0)) * (of(1, 1) - of(0, 1));
    [one(2) + at * one(4), one(3)]
}

/// What the box of a figure says: its heading, and its rows of cells.
fn said(tab: &mut Tab<'_>, figure: &str) -> (String, Vec<Vec<String>>) {
    let found = tab.js(&format!(
        "(() => {{ const box = document.querySelector('#{figure} .readout'); if (box.hidden) return ['', []];
          return [box.querySelector('p').textContent, [...box.querySelectorAll('tr')].map(r => [...r.cells].slice(1).map(c => c.textContent))]; }})()"
    ));
    serde_json::from_value(found).unwrap()
}

/// A value and its error as the page joins them.
fn joined(columns: &BTreeMap<String, Vec<String>>, name: &str, error: &str, row: usize) -> String {
    format!("{} ± {}", columns[name][row], columns[error][row])
}

const FLAT: &str = "analyze --sampler jittered -n 64 -k 4 --stats pcf,k-function,radial,spectrum,pcf-vector,neighbors,counts,intensity \
                    --max-frequency 12 --bins 40 --lag-bins 11 --device cpu --quiet --out flat";

/// Writes the pages of every kind of result.
fn pages(scratch: &Scratch) -> Vec<PathBuf> {
    let class = |k: u32| if k.is_multiple_of(2) { "oak & <elm>" } else { "ash" };
    let trees: String = (0..80u32)
        .map(|k| {
            format!(
                "{:.4},{:.4},{}\n",
                0.05 + 0.9 * (f64::from(k) * 0.618_034).fract(),
                0.05 + 0.9 * (f64::from(k) * 0.754_878).fract(),
                class(k)
            )
        })
        .collect();
    scratch.file("trees.csv", &format!("x,y,kind\n{trees}"));
    scratch.file("plot.wkt", "POLYGON ((0 0, 1 0, 1 1, 0 1, 0 0))");
    let small = "--bins 24 --device cpu --quiet --out";
    let lines = [
        FLAT.to_string(),
        format!("analyze --sampler random -n 64 -k 4 --stats pcf,radial --max-frequency 12 {small} other"),
        format!("analyze --sampler random --dim 1 -n 40 -k 3 --max-frequency 40 {small} line"),
        format!(
            "analyze --sampler random --dim 3 -n 60 -k 2 --stats pcf,spectrum,pcf-vector --max-frequency 3 --lag-bins 6 {small} space"
        ),
        format!(
            "analyze trees.csv --window-polygon plot.wkt --class-column kind --stats pcf,k-function,neighbors {small} classes"
        ),
        "analyze --sampler jittered -n 16 -k 8 --stats covariance --covariance-frequency 3 --device cpu --quiet --out covariance".into(),
        "integrate --sampler jittered -n 64 -k 4 --integrand disk --integrand gaussian:sigma=0.2 --max-frequency 12 --device cpu --quiet --out integral".into(),
    ];
    for line in &lines {
        scratch.ok(line);
    }
    scratch.ok("plot flat other --labels Cells,<None> --page pages/both.html");
    scratch.ok("analyze --sampler sobol -n 64 -k 2 --dim 4 --device cpu --quiet --out pairs");
    scratch.ok("analyze --sampler sobol -n 64 -k 2 --prefixes 8,16,32,64 --device cpu --quiet --out prefixes");
    // They differ: exit code 3.
    scratch.run("compare flat other --out compared");
    let dirs = ["flat", "line", "space", "classes", "covariance", "integral", "pairs", "prefixes", "compared"];
    let reports = dirs.iter().map(|dir| scratch.path(dir).join("report.html"));
    reports.chain([scratch.path("pages/both.html")]).collect()
}

/// A copy of a page with something in the place of something else.
fn altered(page: &Path, from: &str, to: &str) -> PathBuf {
    let text = std::fs::read_to_string(page).unwrap();
    assert!(text.contains(from), "{from}");
    let copy = page.with_file_name("altered.html");
    std::fs::write(&copy, text.replacen(from, to, 1)).unwrap();
    copy
}

#[test]
fn pages_are_quiet_accessible_and_printable() {
    let Some(mut chrome) = Chrome::start() else { return };
    let scratch = Scratch::new();
    let pages = pages(&scratch);
    for page in &pages {
        let name = page.display();
        let mut tab = chrome.open(page);
        assert_eq!(tab.faults(page), Vec::<String>::new(), "{name}");
        // With a table open, and a box.
        tab.js("document.querySelectorAll('details').forEach((d, k) => d.open = k === 0)");
        if tab.js("!!document.querySelector('.probe')") == true {
            tab.js("document.querySelector('.probe').focus()");
            tab.key("ArrowRight");
            assert_eq!(tab.js("document.querySelectorAll('.readout:not([hidden])').length"), 1, "{name}");
        }
        for theme in ["light", "dark"] {
            let media = json!({ "features": [{ "name": "prefers-color-scheme", "value": theme }] });
            tab.ask("Emulation.setEmulatedMedia", media);
            // Of colours alone it matters.
            let rules = if theme == "light" { "" } else { "runOnly: ['color-contrast'], " };
            assert_eq!(tab.violations(rules), Vec::<String>::new(), "{name}, {theme}");
        }
        // The switch is against what the system prefers.
        let ground = "getComputedStyle(document.body).backgroundColor";
        assert_eq!(tab.text(ground), "rgb(21, 24, 28)", "{name}");
        tab.click(".theme");
        assert_eq!(tab.text(ground), "rgb(255, 255, 255)", "{name}");
        tab.size(390, 800);
        let wide = tab.js("document.documentElement.scrollWidth").as_f64().unwrap();
        assert!(wide <= 390.0, "{name}: {wide}");
        let pdf = tab.pdf();
        assert!(pdf.starts_with(b"%PDF-") && pdf.len() > 5000, "{name}");
        assert_eq!(tab.faults(page), Vec::<String>::new(), "{name}");
        tab.close();
    }
    // Faults are seen.
    let page = &pages[0];
    for (from, to, seen) in [
        ("<main>", "<main><img alt=\"\" src=\"http://127.0.0.1:9/x.png\"/>", "127.0.0.1:9"),
        ("<main>", "<main><script>document.title = 'x'</script>", "Content Security Policy"),
        ("<main>", "<main style=\"color: red\">", "Content Security Policy"),
        ("'use strict';", "'use strict'; console.error('heard');", "Content Security Policy"),
    ] {
        let page = altered(page, from, to);
        let mut tab = chrome.open(&page);
        let faults = tab.faults(&page);
        assert!(faults.iter().any(|fault| fault.contains(seen)), "{to}: {faults:?}");
        tab.close();
    }
    let altered = altered(page, " lang=\"en\"", "");
    let mut tab = chrome.open(&altered);
    tab.js("console.error('heard')");
    assert!(tab.faults(&altered).iter().any(|fault| fault.contains("heard")));
    tab.js("document.body.style.color = '#aaa'");
    let violations = tab.violations("");
    for rule in ["html-has-lang", "color-contrast"] {
        assert!(violations.iter().any(|violation| violation.starts_with(rule)), "{rule}: {violations:?}");
    }
}

#[test]
fn figures_tell_the_numbers_of_their_tables() {
    let Some(mut chrome) = Chrome::start() else { return };
    let scratch = Scratch::new();
    scratch.ok(FLAT);
    let page = scratch.path("flat/report.html");
    let (g, p) = (table(&scratch.path("flat/pcf.csv")), table(&scratch.path("flat/spectrum_radial.csv")));
    let saved = chrome.downloads();
    let mut tab = chrome.open(&page);

    for row in [3, 20, 31] {
        let at = place(&mut tab, "pcf", g["r"][row].parse().unwrap());
        tab.point(at);
        let (heading, rows) = said(&mut tab, "pcf");
        assert_eq!(heading, format!("distance r (length units of the domain): {}", g["r"][row]));
        assert_eq!(rows[0], ["estimate".to_string(), joined(&g, "g", "g_se", row)], "{row}");
        assert_eq!(rows.iter().map(|row| row[0].as_str()).collect::<Vec<_>>(), ["estimate", "closed form: jittered"]);
    }
    // By touch; of two figures of one table.
    let row = p["nu"].len() / 2;
    for (figure, y, error) in [("spectrum_radial", "p", "p_se"), ("anisotropy", "anisotropy_db", "anisotropy_db_se")] {
        let at = place(&mut tab, figure, p["nu"][row].parse().unwrap());
        tab.touch(at);
        assert_eq!(said(&mut tab, figure).1[0][1], joined(&p, y, error, row), "{figure}");
    }
    // By keys.
    tab.js("document.querySelector('#spectrum_radial .probe').focus()");
    for (key, row) in [("Home", 0), ("ArrowRight", 1), ("ArrowRight", 2), ("ArrowLeft", 1), ("End", p["nu"].len() - 1)]
    {
        tab.key(key);
        if key == "Home" {
            tab.key(key);
        }
        assert_eq!(said(&mut tab, "spectrum_radial").1[0][1], joined(&p, "p", "p_se", row), "{key}");
    }
    let spoken = tab.text("document.querySelector('#spectrum_radial .probe').getAttribute('aria-valuetext')");
    assert!(spoken.contains(&joined(&p, "p", "p_se", p["nu"].len() - 1)), "{spoken}");
    tab.key("Escape");
    assert_eq!(said(&mut tab, "spectrum_radial").0, "");

    // Pictures, in single precision.
    let (shape, values) = npy(&scratch.path("flat/spectrum.npy"));
    let half = (shape[0] as i64 - 1) / 2;
    for m in [[3, -2], [-3, 2], [12, 12], [0, -7]] {
        let size = 2 * half + 1;
        let part = |k: i64| (k as f64 + 0.5) / size as f64;
        let at = inside(&mut tab, "spectrum", [part(m[0] + half), part(half - m[1])]);
        tab.point(at);
        let (heading, rows) = said(&mut tab, "spectrum");
        assert_eq!(heading, format!("m_x = {}, m_y = {}", m[0], m[1]));
        let value = values[((m[0] + half) * size + m[1] + half) as usize];
        assert!((number(&rows[0][1]) / value - 1.0).abs() < 1e-6, "{m:?}: {rows:?} {value}");
    }
    tab.js("document.querySelector('#spectrum .probe').focus()");
    for key in ["ArrowUp", "ArrowRight"] {
        tab.key(key);
    }
    assert!(said(&mut tab, "spectrum").0.starts_with("m_x = "));
    let (shape, values) = npy(&scratch.path("flat/pcf_vector.npy"));
    let at = inside(&mut tab, "pcf_vector", [2.5 / 11.0, 1.5 / 11.0]);
    tab.point(at);
    let value = values[2 * shape[1] as usize + 9];
    let (heading, rows) = said(&mut tab, "pcf_vector");
    assert!((number(&rows[0][1]) - value).abs() < 1e-6 * value, "{heading}: {rows:?} {value}");
    let (shape, values) = npy(&scratch.path("flat/intensity.npy"));
    let cells = shape[0] as f64;
    let at = inside(&mut tab, "intensity", [4.5 / cells, 0.5 / cells]);
    tab.point(at);
    let value = values[5 * shape[1] as usize - 1];
    let (heading, rows) = said(&mut tab, "intensity");
    assert!((number(&rows[0][1]) - value).abs() < 1e-6 * value, "{heading}: {rows:?} {value}");

    // Tables.
    let csv = std::fs::read_to_string(scratch.path("flat/pcf.csv")).unwrap();
    assert_eq!(tab.js("document.querySelector('#pcf details').open"), false);
    tab.click("#pcf summary");
    tab.wait("!!document.querySelector('#pcf .rows')");
    let shown = tab.text("[...document.querySelector('#pcf .rows table').rows].map(r => [...r.cells].map(c => c.textContent).join(',')).join('\\n') + '\\n'");
    assert_eq!(shown, csv);
    tab.click("#pcf .tools button");
    tab.wait("document.querySelector('#pcf .tools button').textContent === 'Copied'");
    assert_eq!(tab.text("navigator.clipboard.readText()"), csv.replace(',', "\t"));
    tab.click("#pcf .tools button:last-child");
    let file = saved.join("pcf.csv");
    tab.wait("document.querySelector('#pcf .tools button:last-child').textContent === 'Saved'");
    for _ in 0..500 {
        if !file.exists() {
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
    }
    assert_eq!(std::fs::read_to_string(file).unwrap(), csv);
    tab.click(".tools button");
    tab.wait("document.querySelector('.tools button').textContent === 'Copied'");
    let glance = tab.text("navigator.clipboard.readText()");
    assert!(glance.contains("Realizations K\t4\n"), "{glance}");
    assert_eq!(tab.faults(&page), Vec::<String>::new());
    tab.close();

    // A wrong value in the data is seen.
    let page = altered(&page, &joined(&g, "g", "g_se", 20).replace(" ± ", ","), "0.5,0.25");
    let mut tab = chrome.open(&page);
    let at = place(&mut tab, "pcf", g["r"][20].parse().unwrap());
    tab.point(at);
    assert_eq!(said(&mut tab, "pcf").1[0][1], "0.5 ± 0.25");
}

/// A part of a picture in px of the window.
fn inside(tab: &mut Tab<'_>, figure: &str, [x, y]: [f64; 2]) -> [f64; 2] {
    let r = tab.js(&format!(
        "(() => {{ const e = document.querySelector('#{figure} img'); e.scrollIntoView({{ block: 'center' }}); const r = e.getBoundingClientRect();
          return [r.x, r.y, r.width, r.height]; }})()"
    ));
    let of = |k: usize| r[k].as_f64().unwrap();
    [of(0) + x * of(2), of(1) + y * of(3)]
}

#[test]
fn curves_of_several_results_are_switched_and_told() {
    let Some(mut chrome) = Chrome::start() else { return };
    let scratch = Scratch::new();
    let of = |sampler: &str| {
        format!(
            "analyze --sampler {sampler} -n 64 -k 4 --stats pcf,radial --bins 40 --device cpu --quiet --out {sampler}"
        )
    };
    for sampler in ["jittered", "random"] {
        scratch.ok(&of(sampler));
    }
    // Long tables are cut, and say so.
    scratch.ok("analyze --sampler random -n 64 -k 2 --stats pcf --bins 9000 --device cpu --quiet --out long");
    scratch.ok("plot jittered random --page both.html");
    scratch.fails("plot jittered random --page both.html", 2, "--page both.html: is there already");
    let page = scratch.path("both.html");
    let [a, b] = ["jittered", "random"].map(|dir| table(&scratch.path(dir).join("pcf.csv")));
    let mut tab = chrome.open(&page);
    let at = place(&mut tab, "pcf", a["r"][12].parse().unwrap());
    tab.point(at);
    let expected =
        [("jittered", &a), ("random", &b)].map(|(name, of)| vec![name.to_string(), joined(of, "g", "g_se", 12)]);
    assert_eq!(said(&mut tab, "pcf").1, expected);

    let seen = "document.querySelector('#pcf svg [data-curve=\"0\"] polyline').getBoundingClientRect().width > 0";
    assert_eq!(tab.js(seen), true);
    tab.click("#pcf .legend button");
    assert_eq!(tab.js(seen), false);
    assert_eq!(tab.text("document.querySelector('#pcf .legend button').getAttribute('aria-pressed')"), "false");
    tab.point(at);
    let at = place(&mut tab, "pcf", a["r"][12].parse().unwrap());
    tab.point(at);
    assert_eq!(said(&mut tab, "pcf").1, expected[1..]);
    tab.click("#pcf .legend button");
    assert_eq!(tab.js(seen), true);
    // What differs comes first, and the pages of the results are a step away.
    let differ = tab.text("document.querySelector('[aria-label=\"Parameters that differ\"]').innerText");
    assert!(differ.contains("sampler") && !differ.contains("realizations"), "{differ}");
    let links = tab.text("[...document.querySelectorAll('a')].map(a => a.getAttribute('href')).join(' ')");
    assert_eq!(links, "jittered/report.html random/report.html");
    tab.close();

    let page = scratch.path("long/report.html");
    assert!(std::fs::metadata(&page).unwrap().len() < 1_500_000);
    let mut tab = chrome.open(&page);
    let g = table(&scratch.path("long/pcf.csv"));
    let summary = tab.text("document.querySelector('#pcf summary').textContent");
    assert_eq!(summary, "pcf.csv, the first 1000 of 9000 rows");
    let at = place(&mut tab, "pcf", 0.9 * g["r"][8999].parse::<f64>().unwrap());
    tab.point(at);
    let (heading, rows) = said(&mut tab, "pcf");
    let row = g["r"].iter().position(|r| heading.ends_with(&format!(": {r}"))).unwrap();
    assert!(row > 8000, "{row}");
    assert_eq!(rows[0][1], joined(&g, "g", "g_se", row));
}
