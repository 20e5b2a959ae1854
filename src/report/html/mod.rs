//! Pages that need nothing else, no font and no file beside them: `report.html`, and the builder of such pages.

mod builder;
mod color_bar;
mod data;

use std::collections::BTreeMap;
use std::path::PathBuf;

pub(crate) use builder::{Curves, Numbers, Page};
pub(super) use color_bar::color_bar;
pub(crate) use data::{Curve, Values};

use super::columns::Columns;
use super::outputs::{self, Picture, sections};
use crate::accumulate::Backend;
use crate::display::{Units, escape, human, packing_symbol, size};
use crate::estimate::Analysis;
use crate::statistics::Row;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// The page of a report.
///
/// # Errors
/// What cannot be drawn.
pub(super) fn page(analysis: &Analysis, pictures: &BTreeMap<&'static str, Picture>) -> Result<String> {
    let a = analysis;
    let mut page = Page::new(&a.subject, &format!("{}; {}", domain(a), size(a)));
    page.warnings(&a.warnings);
    page.section("At a glance");
    page.rows("At a glance", &glance(a));
    figures(&mut page, a, pictures)?;
    errors(&mut page, a);

    page.section("How it was computed");
    if let Some((_, command)) = a.parameters.iter().find(|(name, _)| name == "command") {
        page.paragraph("Command:");
        page.typed(&plain(command));
    }
    page.typed(&a.plan);
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
    page.rows("How it was computed", &rows);
    if !a.parameters.is_empty() {
        page.section("Parameters");
        let rows: Vec<_> = a.parameters.iter().map(|(n, v)| (escape(n), escape(&plain(v)))).collect();
        page.rows("Parameters", &rows);
    }
    Ok(page.finish("The numbers behind the pictures are in the CSV and NPY files next to this page."))
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
fn figures(page: &mut Page, a: &Analysis, pictures: &BTreeMap<&'static str, Picture>) -> Result<()> {
    let mut heading = "";
    let mut tables = BTreeMap::new();
    for section in sections() {
        let mut headed = |page: &mut Page, new: &'static str| {
            if std::mem::replace(&mut heading, new) != new {
                page.section(new);
            }
        };
        if let Some((heading, words)) = section.words(a) {
            headed(page, heading);
            page.paragraph(&words);
        }
        for output in section.outputs() {
            let (Some(place), Some(picture)) = (&output.place, pictures.get(output.name)) else { continue };
            let Some(caption) = (place.caption)(a, &picture.seen) else { continue };
            headed(page, place.heading);
            let name = output.name.split('.').next().unwrap_or(output.name);
            let Some(figure) = &picture.figure else {
                let cells: Vec<_> = picture.cells.iter().map(|(element, cells)| (*element, cells)).collect();
                // A picture that has a table of its name is of that.
                let table = format!("{name}.csv");
                let read =
                    outputs::bytes(&table, a)?.map(|bytes| Columns::read(PathBuf::from(&table), &bytes)).transpose()?;
                let numbers: Vec<_> =
                    read.iter().map(|columns| Numbers { name: &table, columns, page: None }).collect();
                page.picture(name, [&picture.html, &picture.below, &caption], &cells, &numbers)?;
                continue;
            };
            let table = figure.numbers.map(|numbers| numbers.table);
            let read = table.map(|table| outputs::bytes(table, a)).transpose()?.flatten();
            let read = table.zip(read).map(|(table, bytes)| Columns::read(PathBuf::from(table), &bytes)).transpose()?;
            let numbers = |(name, columns)| Numbers { name, columns, page: tables.get(name).copied() };
            let number = page.drawn(name, figure, table.zip(read.as_ref()).map(numbers), &caption)?;
            tables.extend(table.zip(number));
        }
    }
    Ok(())
}

/// What the error bars are.
fn errors(page: &mut Page, a: &Analysis) {
    let rows: Vec<Row> = sections().flat_map(|section| section.errors(a)).collect();
    if !rows.is_empty() {
        page.section("Error bars");
        page.paragraph("All are one standard error.");
        page.rows("Error bars", &rows);
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
