//! The table of neighbour functions.

use crate::estimate::Analysis;
use crate::statistics::Table;

/// `neighbor_functions_cross.csv`: F of each of two classes, G and J within each and from each to the other, with their names:
/// `g_function_oak_elm` is from oaks to elms.
pub(super) fn cross(analysis: &Analysis) -> Option<Table> {
    let cross = analysis.cross_neighbors()?;
    let mut table = Table::new().floats("r", cross.a.r.iter().copied());
    for (name, functions) in cross.classes.iter().zip([&cross.a, &cross.b]) {
        table = table
            .optional(format!("f_function_{name}"), functions.f.iter().copied())
            .optional(format!("f_function_{name}_se"), functions.f_se.iter().copied());
    }
    for ([from, to], functions) in cross.each() {
        table = table
            .optional(format!("g_function_{from}_{to}"), functions.g.iter().copied())
            .optional(format!("g_function_{from}_{to}_se"), functions.g_se.iter().copied())
            .optional(format!("j_function_{from}_{to}"), functions.j.iter().copied());
    }
    Some(table)
}

/// `neighbor_functions.csv`: r in the domain's length unit, the rest dimensionless.
pub(super) fn functions(analysis: &Analysis) -> Option<Table> {
    let functions = &analysis.neighbors()?.functions;
    Some(
        Table::new()
            .floats("r", functions.r.iter().copied())
            .optional("g_function", functions.g.iter().copied())
            .optional("g_function_se", functions.g_se.iter().copied())
            .optional("f_function", functions.f.iter().copied())
            .optional("f_function_se", functions.f_se.iter().copied())
            .optional("j_function", functions.j.iter().copied())
            .floats("poisson", functions.poisson.iter().copied()),
    )
}
