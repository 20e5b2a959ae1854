//! Tables of g, of two classes and of K.

use crate::estimate::Analysis;
use crate::statistics::Table;

/// `pcf.csv`: r in the domain's length unit, `count` ordered pairs over all realizations, g dimensionless.
pub(super) fn pcf(analysis: &Analysis) -> Option<Table> {
    let pcf = analysis.pair_correlation()?;
    let table = Table::new()
        .floats("r_lo", pcf.r_lo.iter().copied())
        .floats("r", pcf.r.iter().copied())
        .floats("r_hi", pcf.r_hi.iter().copied())
        .integers("count", pcf.count.iter().copied())
        .floats("g", pcf.g.iter().copied())
        .floats("g_se", pcf.g_se.iter().copied());
    Some(match analysis.kernel() {
        Some(kernel) => {
            table.optional("g_kernel", kernel.g.iter().copied()).optional("g_kernel_se", kernel.g_se.iter().copied())
        }
        None => table,
    })
}

/// `k_function.csv`: at distances r, in the domain's length unit; K in units of its measure.
pub(super) fn k_function(analysis: &Analysis) -> Option<Table> {
    let k = analysis.k_function()?;
    Some(
        Table::new()
            .floats("r", k.r.iter().copied())
            .floats("k", k.k.iter().copied())
            .floats("k_se", k.k_se.iter().copied())
            .floats("l", k.l.iter().copied())
            .optional("l_se", k.l_se.iter().copied())
            .floats("l_minus_r", k.l_minus_r.iter().copied())
            .floats("neighbors", k.neighbors.iter().copied()),
    )
}

/// `k_function_cross.csv`: as `k_function.csv` within each of two classes and between them, with their names as in
/// `pcf_cross.csv`.
pub(super) fn cross_k(analysis: &Analysis) -> Option<Table> {
    let cross = analysis.cross_k()?;
    let mut table = Table::new().floats("r", cross.between.r.iter().copied());
    let [first, second] = &cross.classes;
    for (from, to, k) in [(first, first, &cross.a), (second, second, &cross.b), (first, second, &cross.between)] {
        table = table
            .floats(format!("k_{from}_{to}"), k.k.iter().copied())
            .floats(format!("k_{from}_{to}_se"), k.k_se.iter().copied())
            .floats(format!("l_{from}_{to}"), k.l.iter().copied())
            .optional(format!("l_{from}_{to}_se"), k.l_se.iter().copied())
            .floats(format!("l_minus_r_{from}_{to}"), k.l_minus_r.iter().copied());
    }
    Some(table)
}

/// `pcf_cross.csv`: as `pcf.csv` within each of two classes and from the first to the second, with their names: of oaks and elms
/// `g_oak_oak`, `g_elm_elm`, `g_oak_elm`.
pub(super) fn cross(analysis: &Analysis) -> Option<Table> {
    let cross = analysis.cross()?;
    let [a, b, ab] = [&cross.a, &cross.b, &cross.between];
    let mut table = Table::new()
        .floats("r_lo", ab.r_lo.iter().copied())
        .floats("r", ab.r.iter().copied())
        .floats("r_hi", ab.r_hi.iter().copied());
    let [first, second] = &cross.classes;
    for (from, to, g) in [(first, first, a), (second, second, b), (first, second, ab)] {
        table = table
            .integers(format!("count_{from}_{to}"), g.count.iter().copied())
            .floats(format!("g_{from}_{to}"), g.g.iter().copied())
            .floats(format!("g_{from}_{to}_se"), g.g_se.iter().copied());
    }
    Some(table)
}
