//! What a comparison says on a terminal.

use std::fmt::Write as _;

use super::{Compared, Comparison, Difference};
use crate::display::{escape, human};
use crate::report::Page;

impl Comparison {
    /// Everything but single values, as JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// A line for each column of values, the largest difference of it, and what follows.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let first = &self.results[0];
        for (k, other) in self.results.iter().enumerate().skip(1) {
            let _ = writeln!(text, "{other} against {first}");
            let columns: Vec<&Compared> = self.columns.iter().filter(|column| column.with == k).collect();
            let mut lines = vec![["figure", "rows", "largest difference", "s.e.", "p", "p of all"].map(String::from)];
            lines.extend(columns.iter().map(|column| column.cells()));
            let widths: [usize; 6] =
                std::array::from_fn(|cell| lines.iter().map(|line| line[cell].chars().count()).max().unwrap_or(0));
            for line in &lines {
                let padded: Vec<String> = (line.iter().zip(widths).enumerate())
                    .map(
                        |(cell, (word, width))| {
                            if cell == 1 || cell > 2 { format!("{word:>width$}") } else { format!("{word:<width$}") }
                        },
                    )
                    .collect();
                let _ = writeln!(text, "  {}", padded.join("  ").trim_end());
            }
        }
        let level = human(self.alpha);
        let _ = match self.differ {
            true => writeln!(text, "they differ (p of all at most {level})"),
            false => writeln!(text, "no difference beyond chance (p of all above {level})"),
        };
        text
    }
}

impl Comparison {
    /// The sections of a page: each column of values, and the values that differ most.
    pub(super) fn sections(&self, page: &mut Page) {
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
}

impl Compared {
    fn cells(&self) -> [String; 6] {
        let [a, b] = self.values.map(human);
        let largest = if self.z == 0.0 { "none".into() } else { format!("{a} and {b} at {}", self.place) };
        [
            self.figure.clone(),
            self.rows.to_string(),
            largest,
            format!("{:.1}", self.z.abs()),
            human(self.p),
            human(self.p_of_all),
        ]
    }
}
