//! The builder of pages: a heading, what should be looked out for, sections of figures that tell their numbers, tables that can be copied.
//!
//! A page needs nothing but itself: no network, no file. Its script and style are the only ones that its policy admits, and what it
//! says and shows is there without the script.

use std::fmt::Write as _;

use base64::Engine as _;
use serde_json::Value;
use sha2::{Digest as _, Sha256};

use super::super::columns::Columns;
use super::super::svg;
use super::data::{self, Curve, Sheet};
use crate::display::escape;
use crate::display::figure::{Figure, GREY, Layer};
use crate::statistics::{Cells, Row};

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("page.js");

/// A page that is being written. What it is given is HTML unless it is said to be plain text.
pub(crate) struct Page {
    title: String,
    body: String,
    /// What the script reads, by its id.
    data: Vec<(String, Value)>,
    tables: Vec<Sheet>,
    sections: usize,
}

/// A table with the name of its file; `page` is its number where the page has it already.
pub(crate) struct Numbers<'a> {
    pub(crate) name: &'a str,
    pub(crate) columns: &'a Columns,
    pub(crate) page: Option<usize>,
}

/// A figure of curves for a page.
pub(crate) struct Curves<'a> {
    /// One word of ASCII letters, digits and _ that no other figure of the page has.
    pub(crate) name: &'a str,
    pub(crate) figure: &'a Figure,
    pub(crate) curves: &'a [Curve],
    /// The tables with its numbers.
    pub(crate) tables: &'a [Numbers<'a>],
    /// What of an abscissa in the tables is a unit of the axis.
    pub(crate) x_factor: f64,
    /// The number of the curve that each layer belongs to, where curves can be switched off.
    pub(crate) groups: Option<&'a [Option<usize>]>,
    pub(crate) caption: &'a str,
}

impl Page {
    /// `title` is plain text.
    pub(crate) fn new(title: &str, lead: &str) -> Self {
        let title = escape(title);
        let body = format!("<header>\n<h1>{title}</h1>\n<p class=\"lead\">{lead}</p>\n</header>\n<main>\n");
        Self { title, body, data: Vec::new(), tables: Vec::new(), sections: 0 }
    }

    /// Warnings, plain text.
    pub(crate) fn warnings(&mut self, warnings: &[String]) {
        if warnings.is_empty() {
            return;
        }
        self.html("<div class=\"warnings\" role=\"note\"><strong>Warnings</strong>\n<ul>\n");
        for warning in warnings {
            let _ = writeln!(self.body, "<li>{}</li>", escape(warning));
        }
        self.html("</ul></div>\n");
    }

    /// Begins a section.
    pub(crate) fn section(&mut self, heading: &str) {
        if self.sections > 0 {
            self.html("</section>\n");
        }
        self.sections += 1;
        let id = self.sections;
        let _ =
            writeln!(self.body, "<section aria-labelledby=\"section-{id}\">\n<h2 id=\"section-{id}\">{heading}</h2>");
    }

    /// Any HTML.
    pub(crate) fn html(&mut self, html: &str) {
        self.body.push_str(html);
    }

    /// A paragraph.
    pub(crate) fn paragraph(&mut self, html: &str) {
        let _ = writeln!(self.body, "<p>{html}</p>");
    }

    /// Text as it is typed, plain.
    pub(crate) fn typed(&mut self, text: &str) {
        let _ = writeln!(self.body, "<pre>{}</pre>", escape(text.trim_end()));
    }

    /// Names and values, which can be copied. `label`, plain text, says what they are.
    pub(crate) fn rows(&mut self, label: &str, rows: &[Row]) {
        let _ = writeln!(self.body, "<div class=\"table\"><table data-copy=\"\" aria-label=\"{}\">", escape(label));
        for (name, value) in rows {
            let _ = writeln!(self.body, "<tr><th scope=\"row\">{name}</th><td>{value}</td></tr>");
        }
        self.html("</table></div>\n");
    }

    /// A table with a header, whose first column names its rows; it can be copied. `label`, plain text, says what it is.
    pub(crate) fn table(&mut self, label: &str, header: &[String], rows: &[Vec<String>]) {
        let label = escape(label);
        let _ = writeln!(
            self.body,
            "<div class=\"table\"><table class=\"grid\" data-copy=\"\" aria-label=\"{label}\">\n<thead><tr>"
        );
        for cell in header {
            // A header without words is none.
            let _ = match cell.as_str() {
                "" => write!(self.body, "<td></td>"),
                cell => write!(self.body, "<th scope=\"col\">{cell}</th>"),
            };
        }
        self.html("</tr></thead>\n<tbody>\n");
        for row in rows {
            self.html("<tr>");
            for (k, cell) in row.iter().enumerate() {
                let _ = match k {
                    0 => write!(self.body, "<th scope=\"row\">{cell}</th>"),
                    _ => write!(self.body, "<td>{cell}</td>"),
                };
            }
            self.html("</tr>\n");
        }
        self.html("</tbody></table></div>\n");
    }

    /// A figure of curves, which tells their values where it is pointed at, with its tables. The numbers of those in the page.
    ///
    /// # Errors
    /// What cannot be drawn.
    pub(crate) fn curves(&mut self, of: &Curves<'_>) -> Result<Vec<usize>, Box<dyn std::error::Error + Send + Sync>> {
        let drawn = match of.groups {
            Some(groups) => svg::grouped(of.figure, groups)?,
            None => svg::svg(of.figure)?,
        };
        let mut numbers = Vec::new();
        for (k, table) in of.tables.iter().enumerate() {
            let abscissa = |curve: &Curve| match &curve.values {
                data::Values::Cells(other, place) if *other == k => Some(place.x.clone()),
                _ => None,
            };
            let x = of.curves.iter().find_map(abscissa).unwrap_or_default();
            let px = |row| Some(svg::place_of(of.figure, table.columns.abscissa(row, &x)? / of.x_factor));
            numbers.push(self.sheet(table, px)?);
        }
        let sheets: Vec<_> = numbers.iter().map(|&number| (number, &self.tables[number])).collect();
        let json = data::figure(of.figure, of.groups.is_some(), of.x_factor, of.curves, &sheets);
        let legend = of.groups.map_or(String::new(), |groups| legend(of.figure, groups, of.curves));
        self.figure(of.name, &drawn, &legend, of.caption, Some(json));
        Ok(numbers)
    }

    /// A figure of curves that say where their numbers stand in its table. The number of that in the page.
    ///
    /// # Errors
    /// What cannot be drawn.
    pub(crate) fn drawn(
        &mut self,
        name: &str,
        figure: &Figure,
        table: Option<Numbers<'_>>,
        caption: &str,
    ) -> Result<Option<usize>, Box<dyn std::error::Error + Send + Sync>> {
        let curves = data::curves(figure, table.as_ref().map(|table| table.columns));
        let tables: Vec<_> = table.into_iter().collect();
        let x_factor = figure.numbers.map_or(1.0, |numbers| numbers.x_factor);
        let all = Curves { name, figure, curves: &curves, tables: &tables, x_factor, groups: None, caption };
        Ok(self.curves(&all)?.first().copied())
    }

    /// A picture, as an `img` or `svg` element, with what stands below it, a caption, and the values behind it: each with the turn of its
    /// element among those of pictures.
    ///
    /// # Errors
    /// A table that cannot be written.
    pub(crate) fn picture(
        &mut self,
        name: &str,
        [html, below, caption]: [&str; 3],
        cells: &[(usize, &Cells)],
        tables: &[Numbers<'_>],
    ) -> std::io::Result<()> {
        let tables = tables.iter().map(|table| self.sheet(table, |_| None)).collect::<std::io::Result<Vec<_>>>()?;
        let json = (!cells.is_empty() || !tables.is_empty()).then(|| data::cells(cells, &tables));
        self.figure(name, html, below, caption, json);
        Ok(())
    }

    /// The number of a table in the page.
    fn sheet(&mut self, table: &Numbers<'_>, px: impl Fn(usize) -> Option<f64>) -> std::io::Result<usize> {
        if let Some(number) = table.page {
            return Ok(number);
        }
        self.tables.push(Sheet::new(table.name, table.columns, px)?);
        Ok(self.tables.len() - 1)
    }

    /// What is seen when it is asked for.
    pub(crate) fn folded(&mut self, summary: &str, fill: impl FnOnce(&mut Self)) {
        let _ = writeln!(self.body, "<details><summary>{summary}</summary>");
        fill(self);
        self.html("</details>\n");
    }

    fn figure(&mut self, name: &str, drawn: &str, below: &str, caption: &str, json: Option<Value>) {
        // The policy admits no style of an element; that of pictures is in the sheet.
        let mut drawn = drawn.replace(" style=\"image-rendering: pixelated\"", "");
        if !drawn.contains("role=\"img\"") {
            drawn =
                drawn.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{}\" ", name.replace('_', " ")), 1);
        }
        let _ = write!(
            self.body,
            "<figure id=\"{name}\"><div class=\"picture\"><div class=\"stage\">{drawn}</div></div>\n{below}<figcaption>{caption}</figcaption></figure>\n"
        );
        self.data.extend(json.map(|json| (format!("data-{name}"), json)));
    }

    /// The whole page. `footer` stands below.
    pub(crate) fn finish(mut self, footer: &str) -> String {
        if self.sections > 0 {
            self.html("</section>\n");
        }
        let policy = format!(
            "default-src 'none'; script-src '{}'; style-src '{}'; img-src data:; base-uri 'none'; form-action 'none'",
            digest(SCRIPT),
            digest(STYLE)
        );
        let mut html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n\
             <title>{} – pairwave</title>\n<style>{STYLE}</style>\n",
            self.title
        );
        let tables = self.tables.iter().enumerate().map(|(k, sheet)| (format!("table-{k}"), sheet.json()));
        for (id, value) in tables.chain(self.data.iter().map(|(id, value)| (id.clone(), value))) {
            // What could end the element, or begin another, is written otherwise.
            let json = value.to_string().replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026");
            let _ = writeln!(html, "<script type=\"application/json\" id=\"{id}\">{json}</script>");
        }
        let _ = write!(
            html,
            "<script>{SCRIPT}</script>\n</head>\n<body>\n{}</main>\n<footer>{footer}</footer>\n</body>\n</html>\n",
            self.body
        );
        html
    }
}

/// The entries of a legend, by which curves are switched off and on.
fn legend(figure: &Figure, groups: &[Option<usize>], curves: &[Curve]) -> String {
    let mut html = String::from("<ul class=\"legend\" aria-label=\"Curves\">\n");
    for (k, curve) in curves.iter().enumerate() {
        let dashes = curve.stroke.dashes().map(|(dash, gap)| format!(" stroke-dasharray=\"{dash} {gap}\""));
        let _ = writeln!(
            html,
            "<li><button type=\"button\" data-curve=\"{k}\" aria-pressed=\"true\">{}{}</button></li>",
            sample(&svg::hex(curve.color), &format!("stroke-width=\"2.5\"{}", dashes.unwrap_or_default())),
            curve.name
        );
    }
    for layer in figure.layers.iter().zip(groups).filter(|(_, group)| group.is_none()).map(|(layer, _)| layer) {
        let (name, color, look) = match layer {
            Layer::Band { name, color, .. } => (name, *color, "stroke-width=\"9\" stroke-opacity=\"0.22\""),
            Layer::Line { name, color, stroke, .. } => {
                let dashes = stroke.dashes().map(|(dash, gap)| format!(" stroke-dasharray=\"{dash} {gap}\""));
                (name, *color, &*format!("stroke-width=\"1.2\"{}", dashes.unwrap_or_default()))
            }
            Layer::Level { name, .. } => (name, GREY, "stroke-width=\"1.2\""),
            Layer::Hint { .. } => continue,
        };
        if !name.is_empty() {
            let _ = writeln!(html, "<li>{}{name}</li>", sample(&svg::hex(color), look));
        }
    }
    html + "</ul>\n"
}

/// A piece of a curve.
fn sample(color: &str, look: &str) -> String {
    format!(
        "<svg class=\"sample\" width=\"26\" height=\"10\" viewBox=\"0 0 26 10\" aria-hidden=\"true\"><path d=\"M0 5h26\" stroke=\"{color}\" {look}/></svg>"
    )
}

/// A script or style as a policy names it.
fn digest(text: &str) -> String {
    format!("sha256-{}", base64::engine::general_purpose::STANDARD.encode(Sha256::digest(text)))
}
