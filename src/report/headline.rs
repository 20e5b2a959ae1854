//! What was found, in a few lines for a terminal.

use super::outputs::sections;
use crate::estimate::Analysis;

/// Subject, device, and one line per statistic.
pub fn headline(a: &Analysis) -> String {
    let first = format!("{}, on {}", a.subject, a.computed_by.device());
    let lines: Vec<String> = [first].into_iter().chain(sections().flat_map(|section| section.headline(a))).collect();
    lines.join("\n") + "\n"
}
