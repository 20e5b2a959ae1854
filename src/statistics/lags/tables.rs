//! The table of g along rings.

use crate::estimate::Analysis;
use crate::statistics::Table;

/// `pcf_angular.csv`: one row per ring and sector, angles in radians; `cells` and `count` are of one of each mirror pair.
pub(super) fn angular(analysis: &Analysis) -> Option<Table> {
    let sectors = &analysis.vector()?.sectors;
    if sectors.is_empty() {
        return None;
    }
    Some(
        Table::new()
            .floats("r_lo", sectors.iter().map(|s| s.r[0]))
            .floats("r", sectors.iter().map(|s| s.r[1]))
            .floats("r_hi", sectors.iter().map(|s| s.r[2]))
            .floats("theta_lo", sectors.iter().map(|s| s.theta[0]))
            .floats("theta", sectors.iter().map(|s| s.theta[1]))
            .floats("theta_hi", sectors.iter().map(|s| s.theta[2]))
            .integers("cells", sectors.iter().map(|s| s.cells))
            .integers("count", sectors.iter().map(|s| s.count))
            .optional("g", sectors.iter().map(|s| s.g))
            .optional("g_se", sectors.iter().map(|s| s.g_se)),
    )
}
