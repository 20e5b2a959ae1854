//! One page of several results: what differs between them, their numbers side by side, and every figure with the curves of all.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io;
use std::path::{Component, Path};

use serde_json::Value as Json;

use super::headlines::headlines;
use super::{Look, Overlay, Stored};
use crate::display::figure::{Layer, Rgb, Stroke};
use crate::display::{Units, escape, human};
use crate::error::{Error, Result};
use crate::report::columns::{Columns, Place};
use crate::report::html::{Curve, Curves, Numbers, Page, Values};
use crate::report::{PAGE, SUMMARY};
use crate::statistics::axes::Drawn;

/// Keys of a summary that are no numbers of what was found.
const NO_NUMBERS: [&str; 14] = [
    "schema",
    "program",
    "version",
    "subject",
    "input",
    "parameters",
    "plan",
    "device",
    "backends",
    "accuracy",
    "warnings",
    "files",
    "timings_seconds",
    "domain",
];

/// What a page of results has besides them.
pub(crate) trait Additions {
    /// Sections before the figures.
    fn sections(&self, _: &mut Page) {}

    /// The tables, by their files without the ending, that it has figures of.
    fn tables(&self) -> Vec<&'static str> {
        Vec::new()
    }

    /// Draws those of a table, which stand behind the curves of it.
    ///
    /// # Errors
    /// What cannot be drawn.
    fn figures(&self, _page: &mut Page, _table: &str, _seen: &Seen<'_>) -> Result<()> {
        Ok(())
    }
}

impl Additions for () {}

/// How a page speaks of its results.
pub(crate) struct Seen<'a> {
    /// Their names, plain text.
    pub(crate) labels: &'a [String],
    pub(crate) units: &'a Units,
}

/// The page, which will be in a file, with what is added to it.
pub(super) fn page(
    look: &Look<'_>,
    drawn: &[&Drawn],
    results: &[Stored],
    warnings: &[String],
    file: &Path,
    add: &dyn Additions,
) -> Result<String> {
    let labels = &look.labels;
    let title = look.plot.title.clone().unwrap_or_else(|| labels.join(", "));
    let lead = match results.len() {
        1 => "One result of pairwave, drawn again".to_string(),
        several => format!("{several} results of pairwave over each other"),
    };
    let mut page = Page::new(&title, &lead);
    page.warnings(&warnings.iter().map(|difference| format!("measured otherwise: {difference}")).collect::<Vec<_>>());

    page.section("Results");
    let header = ["result", "subject", "<i>n</i>", "<i>K</i>", "<i>d</i>", "directory"].map(String::from);
    let rows: Vec<_> = results.iter().zip(labels).map(|(result, label)| row_of(result, label, file)).collect();
    page.table("Results", &header, &rows);

    let summaries: Vec<&Json> = results.iter().map(Stored::summary).collect();
    let named: Vec<String> = std::iter::once(String::new()).chain(labels.iter().map(|label| escape(label))).collect();
    let parameters = side_by_side(&summaries, |key| key.starts_with("parameters.") && key != "parameters.command");
    let all = side_by_side(&summaries, |key| !NO_NUMBERS.iter().any(|no| key.split('.').next() == Some(no)));
    let (same, differing): (Vec<_>, Vec<_>) = parameters.into_iter().partition(|row| alike(&row[1..]));
    let short = |rows: Vec<Vec<String>>| -> Vec<Vec<String>> {
        let name = |row: &mut Vec<String>| row[0] = row[0].trim_start_matches("parameters.").into();
        rows.into_iter().map(|mut row| (name(&mut row), row).1).collect()
    };
    if results.len() > 1 {
        page.section("What differs in parameters");
        match differing.is_empty() {
            true => page.paragraph("None do."),
            false => page.table("Parameters that differ", &named, &short(differing)),
        }
    }
    let first = headlines(results);
    if !first.is_empty() {
        page.section("Numbers side by side");
        page.table("Numbers side by side", &named, &first);
    }
    if !all.is_empty() {
        page.folded(&format!("All numbers of {SUMMARY}"), |page| page.table("All numbers", &named, &all));
    }

    add.sections(&mut page);
    if !drawn.is_empty() || !add.tables().is_empty() {
        page.section("Figures");
        figures(&mut page, look, drawn, results, add)?;
    }

    if !same.is_empty() {
        page.section(if results.len() > 1 { "Parameters of all" } else { "Parameters" });
        page.table(
            "Parameters of all",
            &[named[0].clone(), "value".into()],
            &short(same)
                .into_iter()
                .map(|mut row| {
                    row.truncate(2);
                    row
                })
                .collect::<Vec<_>>(),
        );
    }
    page.section("Commands");
    for (result, label) in results.iter().zip(labels) {
        if let Some(command) = result.value("/parameters/command").and_then(Json::as_str) {
            page.paragraph(&escape(label));
            page.typed(command);
        }
    }
    Ok(page.finish(concat!(
        "Drawn by pairwave ",
        env!("CARGO_PKG_VERSION"),
        " plot from stored results: nothing was computed."
    )))
}

/// A result in the table of all, with a link to its page.
fn row_of(result: &Stored, label: &str, file: &Path) -> Vec<String> {
    let value = |pointer: &str| match result.value(pointer) {
        Some(Json::String(text)) => escape(text),
        Some(Json::Number(number)) => number.as_f64().map_or(String::new(), human),
        _ => String::new(),
    };
    let path = escape(&result.dir.display().to_string());
    let there = result.dir.join(PAGE).is_file().then(|| link(file, &result.dir.join(PAGE))).flatten();
    let place = there.map_or(path.clone(), |href| format!("<a href=\"{href}\">{path}</a>"));
    vec![escape(label), value("/subject"), value("/n/mean"), value("/k"), value("/d"), place]
}

/// A file as a page in another file names it, if a way leads there.
fn link(from: &Path, to: &Path) -> Option<String> {
    let ground = from.parent().filter(|ground| !ground.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // The page's directory may not be there yet.
    let ground =
        ground.ancestors().find_map(|part| Some(part.canonicalize().ok()?.join(ground.strip_prefix(part).ok()?)))?;
    let to = to.canonicalize().ok()?;
    let shared = ground.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return None;
    }
    let up = ground.components().skip(shared).map(|_| "..".to_string());
    let down = to.components().skip(shared).map(|part| match part {
        Component::Normal(name) => name.to_string_lossy().bytes().fold(String::new(), |mut text, byte| {
            let plain = byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte);
            let _ = if plain { write!(text, "{}", char::from(byte)) } else { write!(text, "%{byte:02X}") };
            text
        }),
        other => other.as_os_str().to_string_lossy().into(),
    });
    Some(up.chain(down).collect::<Vec<_>>().join("/"))
}

fn alike(cells: &[String]) -> bool {
    cells.windows(2).all(|pair| pair[0] == pair[1])
}

/// Keys of summaries with the values of each, in the order of their names as the first that has them; those that none has a value of are left out.
fn side_by_side(summaries: &[&Json], wanted: impl Fn(&str) -> bool) -> Vec<Vec<String>> {
    let mut keys = Vec::new();
    let mut known = BTreeSet::new();
    let all: Vec<BTreeMap<String, String>> = summaries
        .iter()
        .map(|summary| {
            let mut leaves = Vec::new();
            flattened(summary, "", &mut leaves);
            leaves.retain(|(key, _)| wanted(key));
            keys.extend(leaves.iter().map(|leaf| leaf.0.clone()).filter(|key| known.insert(key.clone())));
            leaves.into_iter().collect()
        })
        .collect();
    let cell = |key: &String, of: &BTreeMap<String, String>| of.get(key).cloned().unwrap_or_default();
    keys.iter().map(|key| std::iter::once(escape(key)).chain(all.iter().map(|of| cell(key, of))).collect()).collect()
}

/// The values of a summary by their keys, joined by points: numbers, words and switches, and short lists of them.
fn flattened(value: &Json, key: &str, leaves: &mut Vec<(String, String)>) {
    /// A longer list is a table.
    const LIST: usize = 6;
    let plain = |value: &Json| match value {
        Json::Number(number) => number.as_f64().map(human),
        Json::String(text) => Some(escape(text)),
        Json::Bool(yes) => Some(yes.to_string()),
        _ => None,
    };
    match value {
        Json::Object(all) => {
            for (name, value) in all {
                let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                flattened(value, &key, leaves);
            }
        }
        Json::Array(all) if all.len() <= LIST => {
            let all: Option<Vec<String>> = all.iter().map(plain).collect();
            leaves.extend(all.filter(|all| !all.is_empty()).map(|all| (key.into(), all.join(", "))));
        }
        other => leaves.extend(plain(other).map(|value| (key.into(), value))),
    }
}

fn figures(page: &mut Page, look: &Look<'_>, drawn: &[&Drawn], results: &[Stored], add: &dyn Additions) -> Result<()> {
    let mut known: BTreeMap<(usize, &str), usize> = BTreeMap::new();
    let mut added = add.tables();
    let seen = Seen { labels: &look.labels, units: &look.units };
    for (k, each) in drawn.iter().enumerate() {
        let Overlay { mut figure, groups, curves } = look.overlay(each, results)?;
        figure.title = each.title.into();
        let lines = figure.layers[figure.layers.len() - curves.len()..].iter();
        let curve = |(layer, (which, (color, stroke), place)): (&Layer, (usize, (Rgb, Stroke), Place))| {
            let name = match layer {
                Layer::Line { name, .. } if !name.is_empty() => name.clone(),
                _ => escape(&look.labels[which]),
            };
            Curve { name, color, stroke, values: Values::Cells(which, place) }
        };
        let curves: Vec<Curve> = lines.zip(curves).map(curve).collect();
        let read = results.iter().map(|result| result.table(each.table)).collect::<Result<Vec<Option<Columns>>>>()?;
        let names: Vec<String> = look.labels.iter().map(|label| format!("{label}/{}", each.table)).collect();
        let numbered = read.iter().flatten().enumerate().map(|(which, columns)| Numbers {
            name: &names[which],
            columns,
            page: known.get(&(which, each.table)).copied(),
        });
        let tables: Vec<_> = numbered.collect();
        let numbers = page.curves(&Curves {
            name: each.stem,
            figure: &figure,
            curves: &curves,
            tables: &tables,
            x_factor: figure.numbers.map_or(1.0, |numbers| numbers.x_factor),
            groups: Some(&groups),
            caption: &format!("{}, from {}.", escape(each.title), each.table),
        });
        let numbers = numbers.map_err(|e| Error::file(each.table, io::Error::other(e)))?;
        known.extend(numbers.into_iter().enumerate().map(|(which, number)| ((which, each.table), number)));
        let is_last = drawn.get(k + 1).is_none_or(|next| next.table != each.table);
        let table = each.table.trim_end_matches(".csv");
        if is_last && let Some(at) = added.iter().position(|other| *other == table) {
            add.figures(page, added.remove(at), &seen)?;
        }
    }
    added.into_iter().try_for_each(|table| add.figures(page, table, &seen))
}
