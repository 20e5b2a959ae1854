//! `.csv` (a header, commas) and `.txt` (blanks): one point per line, a `#` line between realizations.

use std::io::{self, Write};

use super::{Format, Refusal, axis_names};
use crate::points::RawPoints;

pub(super) enum Style {
    Csv,
    Blanks,
}

pub(super) struct Text<W> {
    output: W,
    style: Style,
}

impl<W: Write> Text<W> {
    pub(super) fn new(output: W, style: Style) -> Self {
        Self { output, style }
    }
}

impl<W: Write> Format for Text<W> {
    fn add(&mut self, k: u64, set: &RawPoints) -> Result<(), Refusal> {
        if set.is_empty() {
            let reason =
                format!("realization {k} has no points, which text cannot show; .npz holds empty realizations");
            return Err(Refusal::Format(reason));
        }
        let separator = match self.style {
            Style::Csv => ",",
            Style::Blanks => " ",
        };
        match (k, &self.style) {
            (0, Style::Csv) => writeln!(self.output, "{}", axis_names(set.dim).join(","))?,
            (0, Style::Blanks) => {}
            _ => writeln!(self.output, "#")?,
        }
        for point in set.coordinates.chunks_exact(set.dim) {
            for (axis, x) in point.iter().enumerate() {
                // Debug writes the shortest text that reads back as the same number, with an exponent when long.
                write!(self.output, "{}{x:?}", if axis == 0 { "" } else { separator })?;
            }
            self.output.write_all(b"\n")?;
        }
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}
