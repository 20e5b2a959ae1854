//! Bin edges: numbers in a text file.

use std::path::Path;

use crate::error::{Error, Result};

/// Reads `--edges`: numbers separated by blanks, commas or line ends; `#` starts a comment.
///
/// # Errors
/// What the file system says; what is no number, by its line.
pub fn read_edges(path: &Path) -> Result<Vec<f64>> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e))?;
    let mut edges = Vec::new();
    for (line, content) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let content = content.split('#').next().unwrap_or_default();
        for word in content.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|w| !w.is_empty()) {
            edges.push(word.parse().map_err(|_| {
                Error::input(format!("{}:{}", path.display(), line + 1), format!("`{word}` is not a number"))
            })?);
        }
    }
    Ok(edges)
}
