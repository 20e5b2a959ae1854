//! What a comparison says on a terminal.

use std::fmt::Write as _;

use super::{Compared, Comparison};
use crate::display::human;

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

impl Compared {
    /// Its cells in a table: figure, rows, the largest difference in words and in standard errors, p, p of all.
    pub(super) fn cells(&self) -> [String; 6] {
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
