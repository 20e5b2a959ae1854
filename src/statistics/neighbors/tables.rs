//! The table of neighbour functions.

use crate::estimate::Analysis;
use crate::statistics::Table;

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
