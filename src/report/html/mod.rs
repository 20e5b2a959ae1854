//! `report.html`: one page that needs nothing else: no script, no font, no file beside it.

mod color_bar;

use std::collections::BTreeMap;
use std::fmt::Write as _;

pub(super) use color_bar::color_bar;

use super::outputs::{Picture, sections};
use crate::accumulate::Backend;
use crate::display::{Units, escape, human, packing_symbol, size};
use crate::estimate::Analysis;
use crate::statistics::Row;

const STYLE: &str = include_str!("style.css");

/// The page.
pub(super) fn page(analysis: &Analysis, pictures: &BTreeMap<&'static str, Picture>) -> String {
    let a = analysis;
    let mut html = String::new();
    let _ = write!(
        html,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{subject} – pairwave</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>{subject}</h1>\n<p class=\"lead\">{}; {}</p>\n",
        domain(a),
        size(a),
        subject = escape(&a.subject),
    );
    if !a.warnings.is_empty() {
        html.push_str("<div class=\"warnings\" role=\"note\"><strong>Warnings</strong>\n<ul>\n");
        for warning in &a.warnings {
            let _ = writeln!(html, "<li>{}</li>", escape(warning));
        }
        html.push_str("</ul></div>\n");
    }
    html.push_str("<h2>At a glance</h2>\n");
    table(&mut html, &glance(a));
    figures(&mut html, a, pictures);
    errors(&mut html, a);

    html.push_str("<h2>How it was computed</h2>\n");
    if let Some((_, command)) = a.parameters.iter().find(|(name, _)| name == "command") {
        let _ = writeln!(html, "<p>Command:</p>\n<pre>{}</pre>", escape(&plain(command)));
    }
    let _ = writeln!(html, "<pre>{}</pre>", escape(a.plan.trim_end()));
    let read = a.input.as_ref().map(|input| ("Read".into(), escape(&input.words())));
    let backends: Vec<_> = a.computed_by.backends.iter().map(|b| backend(*b)).collect();
    let mut rows = vec![
        ("Device".into(), escape(&a.computed_by.device())),
        ("Backend".into(), backends.join(", ")),
        ("Program".into(), concat!("pairwave ", env!("CARGO_PKG_VERSION")).into()),
    ];
    rows.splice(0..0, read);
    rows.extend(sections().filter_map(|section| section.accuracy(a)));
    let seconds: f64 = a.timings.iter().map(|t| t.1).sum();
    if !a.timings.is_empty() {
        let stages: Vec<_> = a.timings.iter().map(|(s, t)| format!("{} {t:.3}", escape(s))).collect();
        rows.push(("Time".into(), format!("{seconds:.3} s ({})", stages.join(", "))));
    }
    table(&mut html, &rows);
    if !a.parameters.is_empty() {
        html.push_str("<h2>Parameters</h2>\n");
        let rows: Vec<_> = a.parameters.iter().map(|(n, v)| (escape(n), escape(&plain(v)))).collect();
        table(&mut html, &rows);
    }
    html.push_str("<footer>The numbers behind the pictures are in the CSV and NPY files next to this page.</footer>\n");
    html.push_str("</body>\n</html>\n");
    html
}

/// Rows of (name, value), both HTML.
fn table(html: &mut String, rows: &[(String, String)]) {
    html.push_str("<table>\n");
    for (name, value) in rows {
        let _ = writeln!(html, "<tr><th scope=\"row\">{name}</th><td>{value}</td></tr>");
    }
    html.push_str("</table>\n");
}

fn backend(backend: Backend) -> &'static str {
    match backend {
        Backend::Reference => "reference",
        Backend::Cpu => "cpu",
        Backend::Gpu => "gpu",
    }
}

/// `unit torus in 2D`, `window [0, 2] × [1, 3]`.
fn domain(a: &Analysis) -> String {
    let domain = &a.domain;
    let dim = domain.dim();
    if domain.is_torus() {
        if domain.sides().iter().all(|&s| s == 1.0) {
            return format!("unit torus in {dim}D");
        }
        let sides: Vec<_> = domain.sides().iter().map(|&s| human(s)).collect();
        return format!("torus in {dim}D with sides {}", sides.join(" × "));
    }
    let ranges: Vec<_> = domain
        .origin()
        .iter()
        .zip(domain.sides())
        .map(|(&o, &s)| format!("[{}, {}]", human(o), human(o + s)))
        .collect();
    match domain.as_polygon() {
        Some(polygon) => format!("polygon of {} in {}", polygon.words(), ranges.join(" × ")),
        None => format!("window {}", ranges.join(" × ")),
    }
}

/// The unit of an intensity, in HTML.
fn per_measure(a: &Analysis) -> String {
    let dim = a.domain.dim();
    let power = |name: &str| if dim == 1 { format!("per {name}") } else { format!("per {name}<sup>{dim}</sup>") };
    match (a.unit, dim) {
        // A power of what is several words or has one of its own needs parentheses.
        (Some(unit), _) if dim == 1 || unit.as_str().chars().all(char::is_alphabetic) => power(&escape(unit.as_str())),
        (Some(unit), _) => power(&format!("({})", escape(unit.as_str()))),
        (None, 1) => "per unit length".into(),
        (None, 2) => "per unit area".into(),
        (None, _) => "per unit volume".into(),
    }
}

/// What to see first.
pub(super) fn glance(a: &Analysis) -> Vec<(String, String)> {
    let dim = a.domain.dim();
    let n = if a.min_points == a.shape.max_points {
        a.shape.max_points.to_string()
    } else {
        format!("{} to {}, mean {}", a.min_points, a.shape.max_points, human(a.shape.mean_points))
    };
    let (d, which) = packing_symbol(dim);
    let symbol = format!("<i>{d}</i><sub>{which}</sub>");
    let length = Units::of(a).escaped().length;
    let mut rows: Vec<(String, String)> = vec![
        ("Points per realization <i>n</i>".into(), n),
        ("Realizations <i>K</i>".into(), a.shape.realizations.to_string()),
        (
            "Intensity <i>λ</i>".into(),
            format!("{} {}", human(a.shape.mean_points / a.domain.measure()), per_measure(a)),
        ),
        (
            format!("Closest-packing distance {symbol}"),
            format!("{} {length}", human(a.domain.closest_packing_distance(a.shape.mean_points))),
        ),
    ];
    rows.extend(a.inhomogeneity().map(|found| {
        let of = escape(&found.words());
        ("Weights 1/<i>λ</i>".into(), format!("<i>λ</i> {of}: {} to {}", human(found.least), human(found.largest)))
    }));
    // Points before their pairs and frequencies.
    rows.extend(sections().rev().flat_map(|section| section.scalars(a)));
    rows.push(("Coinciding points".into(), a.duplicates.to_string()));
    if !a.closed_form.name.is_empty() {
        rows.push(("Closed form".into(), escape(&a.closed_form.name)));
    }
    rows
}

/// Every room's pictures with their captions, or its words where there is none.
fn figures(html: &mut String, a: &Analysis, pictures: &BTreeMap<&'static str, Picture>) {
    let mut heading = "";
    for section in sections() {
        let mut headed = |html: &mut String, new: &'static str| {
            if std::mem::replace(&mut heading, new) != new {
                let _ = writeln!(html, "<h2>{new}</h2>");
            }
        };
        if let Some((heading, words)) = section.words(a) {
            headed(html, heading);
            let _ = writeln!(html, "<p>{words}</p>");
        }
        for output in section.outputs() {
            let (Some(place), Some(picture)) = (&output.place, pictures.get(output.name)) else { continue };
            let Some(caption) = (place.caption)(a, &picture.seen) else { continue };
            headed(html, place.heading);
            let _ = write!(
                html,
                "<figure><div class=\"picture\">{}</div>\n<figcaption>{caption}</figcaption></figure>\n",
                picture.html
            );
        }
    }
}

/// What the error bars are.
fn errors(html: &mut String, a: &Analysis) {
    let rows: Vec<Row> = sections().flat_map(|section| section.errors(a)).collect();
    if !rows.is_empty() {
        html.push_str("<h2>Error bars</h2>\n<p>All are one standard error.</p>\n");
        table(html, &rows);
    }
}

/// A value of JSON as it is typed.
fn plain(value: &serde_json::Value) -> String {
    match value {
        serde_json::Value::String(text) => text.clone(),
        serde_json::Value::Array(values) => values.iter().map(plain).collect::<Vec<_>>().join(","),
        other => other.to_string(),
    }
}
