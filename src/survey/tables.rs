//! The tables of a survey. Axes are counted from 1.

use super::{Survey, View, Views, pair};
use crate::accumulate::DISCREPANCIES;
use crate::estimate::Length;
use crate::statistics::Table;

/// `projections.csv`: all axes, then each pair.
pub(super) fn projections(survey: &Survey) -> Table {
    let rows: Vec<&View> = std::iter::once(&survey.whole).chain(&survey.each).collect();
    let name = |view: &&View| if std::ptr::eq(*view, &survey.whole) { "all".into() } else { pair(&view.axes) };
    scalars(Table::new().text("axes", rows.iter().map(name)).floats("n", rows.iter().map(|v| v.n)), &rows)
}

/// `prefixes.csv`: one row per number of points.
pub(super) fn prefixes(survey: &Survey) -> Table {
    let rows: Vec<&View> = survey.each.iter().collect();
    scalars(Table::new().floats("n", rows.iter().map(|v| v.n)), &rows)
}

fn scalars(mut table: Table, rows: &[&View]) -> Table {
    for (kind, name) in DISCREPANCIES.into_iter().enumerate() {
        let one = |view: &&View| view.discrepancies.as_ref().map(|d| d.each[kind]);
        table = table
            .optional(name, rows.iter().map(|v| Some(one(v)?.mean)))
            .optional(format!("{name}_se"), rows.iter().map(|v| one(v)?.mean_se))
            .optional(format!("{name}_squared"), rows.iter().map(|v| Some(one(v)?.squared)))
            .optional(format!("{name}_squared_se"), rows.iter().map(|v| one(v)?.squared_se));
    }
    let minimum = |view: &&View| -> Option<Length> { view.discrepancies.as_ref()?.minimum };
    let covering = |view: &&View| -> Option<Length> { view.discrepancies.as_ref()?.covering };
    let t = |view: &&View, worst: bool| {
        let t = view.discrepancies.as_ref().and_then(|d| d.t);
        t.map_or(String::new(), |t| if worst { t.largest } else { t.least }.to_string())
    };
    table
        .optional("minimum_distance", rows.iter().map(|v| Some(minimum(v)?.least)))
        .optional("minimum_distance_mean", rows.iter().map(|v| Some(minimum(v)?.mean)))
        .optional("minimum_distance_relative", rows.iter().map(|v| Some(minimum(v)?.relative)))
        .optional("covering_radius_mean", rows.iter().map(|v| Some(covering(v)?.mean)))
        .text("t", rows.iter().map(|v| t(v, false)))
        .text("t_largest", rows.iter().map(|v| t(v, true)))
}

/// Rows of all views behind each other, with what each is of; `None` where there are none.
fn long<'a, const N: usize>(
    survey: &'a Survey,
    rows: impl Fn(&'a View) -> &'a [[f64; N]],
    names: [&'static str; N],
) -> Option<Table> {
    let all: Vec<(&View, &[f64; N])> =
        survey.each.iter().flat_map(|v| rows(v).iter().map(move |row| (v, row))).collect();
    let mut table = match survey.views {
        Views::Projections => Table::new().text("axes", all.iter().map(|(view, _)| pair(&view.axes))),
        Views::Prefixes(_) => Table::new().floats("n", all.iter().map(|(view, _)| view.n)),
    };
    for (k, name) in names.into_iter().enumerate() {
        table = table.floats(name, all.iter().map(|(_, row)| row[k]));
    }
    (!all.is_empty()).then_some(table)
}

/// g(r) of each view.
pub(super) fn pcf(survey: &Survey) -> Option<Table> {
    long(survey, |view| &view.g, ["r", "g", "g_se"])
}

/// The radial mean of P of each view; `nu_relative` is in units of `lambda^(1/d)`.
pub(super) fn radial(survey: &Survey) -> Option<Table> {
    long(survey, |view| &view.p, ["nu", "nu_relative", "p", "p_se"])
}
