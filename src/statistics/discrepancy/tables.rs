//! The tables of discrepancies.

use crate::accumulate::{DISCREPANCIES, RealizationDiscrepancy};
use crate::estimate::Analysis;
use crate::statistics::Table;

/// `discrepancy.csv`: a row per realization. Discrepancies are dimensionless, each with its square; distances in length units.
pub(super) fn discrepancies(a: &Analysis) -> Option<Table> {
    let all = &a.discrepancies()?.realizations;
    let mut table =
        Table::new().integers("realization", all.iter().map(|r| r.index)).integers("n", all.iter().map(|r| r.n));
    for (kind, name) in DISCREPANCIES.into_iter().enumerate() {
        let square = move |r: &RealizationDiscrepancy| r.squares[kind];
        table = table.floats(name, all.iter().map(move |r| square(r).sqrt()));
        table = table.floats(format!("{name}_squared"), all.iter().map(square));
    }
    let t = |r: &RealizationDiscrepancy| r.t().map_or(String::new(), |t| t.to_string());
    let table = table
        .optional("minimum_distance", all.iter().map(|r| r.minimum))
        .optional("minimum_distance_relative", all.iter().map(|r| Some(r.minimum? / r.closest_packing)))
        .optional("covering_radius", all.iter().map(|r| Some(r.covering?[0])))
        .text("t", all.iter().map(t));
    Some(table)
}

/// `elementary_intervals.csv`: per level k, over the realizations of at least 2^k points, the kinds of intervals of volume 2^-k, and
/// the share of kinds that hold as many points in every interval.
pub(super) fn intervals(a: &Analysis) -> Option<Table> {
    let levels = Some(&a.discrepancies()?.levels).filter(|levels| !levels.is_empty())?;
    Some(
        Table::new()
            .integers("level", 0..levels.len() as u64)
            .integers("shapes", levels.iter().map(|l| l.shapes))
            .integers("equidistributed", levels.iter().map(|l| l.equidistributed))
            .floats("share", levels.iter().map(|l| l.equidistributed as f64 / l.shapes as f64)),
    )
}
