//! Bin edges: numbers in a text file.

use std::path::Path;

use crate::error::{Error, Result};
use crate::points::read::{has_decimal_comma, is_decimal_comma};

/// Reads `--edges`: numbers separated by blanks, commas, semicolons or line ends; `#` starts a comment.
///
/// # Errors
/// What the file system says; what is no number or an empty field, by its line; what may be decimal commas.
pub fn read_edges(path: &Path) -> Result<Vec<f64>> {
    let text = crate::input::read_text(path)?;
    let mut edges = Vec::new();
    let fail = |line: usize, reason: String| Error::input(format!("{}:{line}", path.display()), reason);
    // Lines that are one number with a decimal comma each, or two edges.
    let (mut commas, mut lines) = (None, 0);
    for (number, content) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
        let content = content.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        lines += 1;
        if is_decimal_comma(content.as_bytes()) {
            commas.get_or_insert((number, 0)).1 += 1;
        }
        if has_decimal_comma(content.as_bytes()) {
            return Err(fail(number, format!("decimal comma in `{content}`; write numbers with a point, as 0.5")));
        }
        // A comma or semicolon may end a line.
        let ended = content.strip_suffix([',', ';']).unwrap_or(content);
        for field in ended.split([',', ';']) {
            if field.trim().is_empty() {
                return Err(fail(number, format!("an empty field in `{content}`; expected a number")));
            }
            for word in field.split_whitespace() {
                edges.push(word.parse().map_err(|_| fail(number, format!("`{word}` is not a number")))?);
            }
        }
    }
    match commas {
        Some((first, count)) if lines > 1 && count == lines => {
            let reason =
                "decimal commas, or two edges in every line; write numbers with a point, as 0.5, or one in a line";
            Err(fail(first, reason.into()))
        }
        _ => Ok(edges),
    }
}
