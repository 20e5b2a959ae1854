//! What a comparison says on the page of its results: sections before the figures, and the differences behind the curves that they are of.

use std::io;

use super::{Compared, Comparison, Difference, axis, critical};
use crate::display::figure::{Figure, IN_TURN, INK, Layer, Of, Stroke};
use crate::display::{escape, extent, grow, human};
use crate::error::{Error, Result};
use crate::report::{Additions, Columns, Curve, Curves, Numbers, Page, Place, Seen, Values};
use crate::statistics::Table;
use crate::statistics::measured::MEASURED;

/// The level of the line for a single value.
const SINGLE: f64 = 0.05;

impl Additions for Comparison {
    /// Each column of values, and the values that differ most.
    fn sections(&self, page: &mut Page) {
        /// Values that are shown.
        const MOST: usize = 100;
        page.section("Differences");
        let level = human(self.alpha);
        page.paragraph(&match self.differ {
            true => format!("They differ: the smallest <i>p</i>, corrected for everything that was compared, is at most {level}."),
            false => format!("No difference beyond chance: every <i>p</i>, corrected for everything that was compared, is above {level}."),
        });
        page.paragraph(
            "A difference is the other value less the first, over the root of the sum of both squared standard errors; <i>p</i> by Student's law \
             with Welch's degrees of freedom, corrected by Holm's rule for the rows of a column, and for all columns.",
        );
        if !self.notes.is_empty() {
            page.warnings(&self.notes);
        }
        let header =
            ["result", "figure", "rows", "largest difference", "standard errors", "<i>p</i>", "<i>p</i> of all"];
        let row = |column: &Compared| {
            let cells = column.cells().map(|cell| escape(&cell));
            std::iter::once(escape(&self.results[column.with])).chain(cells).collect()
        };
        let rows: Vec<Vec<String>> = self.columns.iter().map(row).collect();
        page.table("Columns of values", &header.map(String::from), &rows);
        let mut largest: Vec<&Difference> = self.values.iter().filter(|value| value.z != 0.0).collect();
        largest.sort_by(|a, b| a.p_adjusted.total_cmp(&b.p_adjusted).then(a.p.total_cmp(&b.p)));
        largest.truncate(MOST);
        let header = ["result", "figure", "place", "first", "other", "standard errors", "<i>p</i> of the column"];
        let row = |value: &&Difference| {
            let [a, b] = value.values.map(|(x, se)| format!("{} ± {}", human(x), human(se)));
            let z = format!("{:.1}", value.z);
            [
                self.results[value.with].clone(),
                value.figure.clone(),
                value.place.clone(),
                a,
                b,
                z,
                human(value.p_adjusted),
            ]
            .map(|cell| escape(&cell))
            .to_vec()
        };
        let rows: Vec<Vec<String>> = largest.iter().map(row).collect();
        let heading = format!("The {} values that differ most; all are in comparison.csv", rows.len());
        page.folded(&heading, |page| page.table("Values that differ most", &header.map(String::from), &rows));
    }

    fn tables(&self) -> Vec<&'static str> {
        let drawn = |stem: &&str| self.values.iter().any(|value| value.x.is_some() && stem_of(&value.figure) == *stem);
        MEASURED.iter().map(|measured| measured.stem).filter(drawn).collect()
    }

    /// z of each column of values of a table, with the lines that it passes by chance.
    fn figures(&self, page: &mut Page, table: &str, seen: &Seen<'_>) -> Result<()> {
        let mut names: Vec<&str> = Vec::new();
        for column in self.columns.iter().filter(|column| stem_of(&column.figure) == table) {
            if !names.contains(&column.figure.as_str()) {
                names.push(&column.figure);
            }
        }
        names.into_iter().try_for_each(|name| self.differences(page, name, seen))
    }
}

/// `pcf` of `pcf.g`.
fn stem_of(figure: &str) -> &str {
    figure.split('.').next().unwrap_or(figure)
}

impl Comparison {
    /// The figure of z of a column, if its rows are along an axis.
    fn differences(&self, page: &mut Page, name: &str, seen: &Seen<'_>) -> Result<()> {
        let axis = axis::of(stem_of(name));
        let along = |value: &&Difference| value.figure == name && value.x.is_some();
        // Curve by curve: in a table each is a range of rows.
        let mut values: Vec<&Difference> = self.values.iter().filter(along).collect();
        let mut order: Vec<(usize, &str)> = Vec::new();
        for value in &values {
            if !order.contains(&value.curve()) {
                order.push(value.curve());
            }
        }
        values.sort_by_key(|value| order.iter().position(|curve| *curve == value.curve()));
        let place = |value: &Difference| value.x.unwrap_or(f64::NAN) / axis.factor;
        let places: Vec<f64> = values.iter().map(|value| place(value)).collect();
        let runs: Vec<&[&Difference]> = values.chunk_by(|a, b| a.curve() == b.curve()).collect();
        let log = axis.log && runs.iter().all(|run| grow(run.iter().map(|v| (place(v), place(v), place(v)))));
        let Some((lo, hi)) = extent(&places).filter(|(lo, hi)| lo < hi && (!log || *lo > 0.0)) else { return Ok(()) };
        let rows =
            |with: usize| self.columns.iter().find(|of| of.with == with && of.figure == name).map_or(1, |of| of.rows);
        let lines = [(SINGLE, false, Stroke::Dashed), (self.alpha, true, Stroke::Dotted)];
        let level = |value: &Difference, (level, of_all, _): (f64, bool, Stroke)| {
            critical(if of_all { level / rows(value.with) as f64 } else { level }, value.degrees)
        };
        let table = Table::new()
            .text("result", values.iter().map(|value| self.results[value.with].clone()))
            .text("place", values.iter().map(|value| value.place.clone()))
            .floats(axis.column, values.iter().map(|value| value.x.unwrap_or(f64::NAN)))
            .floats("z", values.iter().map(|value| value.z))
            .floats("p", values.iter().map(|value| value.p))
            .floats("p_adjusted", values.iter().map(|value| value.p_adjusted))
            .floats("critical_single", values.iter().map(|value| level(value, lines[0])))
            .floats("critical_column", values.iter().map(|value| level(value, lines[1])));

        let (mut layers, mut groups) = (vec![Layer::Level { name: "no difference".into(), y: 0.0 }], vec![None]);
        let mut ends = Vec::new();
        for (line, words) in lines.into_iter().zip(["single value", "column, by Holm"]) {
            let mut name = format!("{words}: {} %", human(100.0 * line.0));
            let mut known: Vec<f64> = Vec::new();
            for of_result in values.chunk_by(|a, b| a.with == b.with) {
                let mut points: Vec<(f64, f64)> =
                    of_result.iter().map(|value| (place(value), level(value, line))).collect();
                let middle = points.len() / 2;
                let (_, &mut (_, median), _) = points.select_nth_unstable_by(middle, |a, b| a.1.total_cmp(&b.1));
                // Of results with as many realizations they are the same, but for what their errors differ.
                if known.iter().any(|other| (median - other).abs() < 0.03 * other) {
                    continue;
                }
                known.push(median);
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                ends.extend(points.iter().flat_map(|point| [point.1, -point.1]));
                let below = points.iter().map(|&(x, y)| (x, -y)).collect();
                for run in [points, below] {
                    let (name, stroke) = (std::mem::take(&mut name), line.2);
                    layers.push(Layer::Line { name, color: INK, width: 1.0, stroke, runs: vec![run], of: Of::Points });
                    groups.push(None);
                }
            }
        }
        let several = order.iter().any(|curve| !curve.1.is_empty());
        let (mut curves, mut first) = (Vec::new(), 0);
        for (k, run) in runs.iter().enumerate() {
            let (with, curve) = run[0].curve();
            let label = &seen.labels[with];
            let name = escape(&if several { format!("{label}, {curve}") } else { label.clone() });
            let turn = order[..k].iter().filter(|other| other.0 == with).count();
            let (color, stroke) = (IN_TURN[with % (IN_TURN.len() - 1)], Stroke::ALL[turn % Stroke::ALL.len()]);
            // What differs without error has no z, and ends a run.
            let finite = run.split(|value| !value.z.is_finite()).filter(|piece| !piece.is_empty());
            let drawn: Vec<Vec<(f64, f64)>> =
                finite.map(|piece| piece.iter().map(|value| (place(value), value.z)).collect()).collect();
            ends.extend(drawn.iter().flatten().map(|point| point.1));
            layers.push(Layer::Line { name: name.clone(), color, width: 1.6, stroke, runs: drawn, of: Of::Points });
            groups.push(Some(k));
            let rows = first..first + run.len();
            first = rows.end;
            curves.push(Curve {
                name,
                color,
                stroke,
                values: Values::Cells(0, Place { x: vec![2], y: 3, error: None, rows }),
            });
        }
        let (low, high) = extent(&ends).unwrap_or((-1.0, 1.0));
        let room = 0.04 * (high - low);
        let infinite = values.iter().filter(|value| value.z.is_infinite()).count();
        let figure = Figure {
            title: format!("Difference of {}, in standard errors", escape(name)).into(),
            subject: String::new(),
            note: String::new(),
            x_label: axis.label(seen.units),
            y_label: format!("z, against {}", escape(&seen.labels[0])),
            x: if log { lo } else { lo.min(0.0) }..hi,
            y: low - room..high + room,
            log_x: log,
            log_y: false,
            top: None,
            layers,
            numbers: None,
        };
        let mut caption = format!(
            "Difference of {} from {}, in standard errors of the difference. Where both are alike, a single value passes the dashed lines in {} % of \
             cases ({:.2} where errors are of many realizations), and the largest of a column the dotted ones in at most {} % (Holm).",
            escape(name),
            escape(&seen.labels[0]),
            human(100.0 * SINGLE),
            critical(SINGLE, f64::INFINITY),
            human(100.0 * self.alpha)
        );
        if infinite > 0 {
            caption += &format!(
                " {} without error differ, and are not drawn.",
                crate::error::plural(infinite as u64, "value")
            );
        }
        let file = format!("{name} in comparison.csv");
        let failed = |e| Error::file(&file, e);
        let columns = Columns::read(file.clone().into(), &table.csv().map_err(failed)?)?;
        let all = Curves {
            // Names of columns may have anything in them.
            name: &format!("difference_{}", self.columns.iter().position(|of| of.figure == name).unwrap_or(0)),
            figure: &figure,
            curves: &curves,
            tables: &[Numbers { name: &file, columns: &columns, page: None }],
            x_factor: axis.factor,
            groups: Some(&groups),
            caption: &caption,
        };
        page.curves(&all).map(drop).map_err(|e| failed(io::Error::other(e)))
    }
}

impl Difference {
    /// What its curve is of.
    fn curve(&self) -> (usize, &str) {
        (self.with, &self.curve)
    }
}
