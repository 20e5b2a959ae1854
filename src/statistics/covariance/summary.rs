//! What `summary.json` says of the covariance.

use serde::Serialize;

use crate::estimate::{Analysis, CovarianceScalars};

#[derive(Serialize)]
pub(super) struct CovarianceOut {
    /// B: all |m_k| and |l_k| up to it.
    max_frequency: u32,
    /// Rows and columns.
    modes: usize,
    /// Their order in rows and columns.
    order: &'static str,
    #[serde(flatten)]
    scalars: CovarianceScalars,
}

/// Of the matrix.
pub(super) fn covariance(a: &Analysis) -> Option<CovarianceOut> {
    a.covariance().map(|c| CovarianceOut {
        max_frequency: c.grid.max_frequency()[0],
        modes: c.modes(),
        order: "m_x slowest, each m_k from -B to B; m = 0 in the middle, left out of covariance.png and of the numbers here",
        scalars: c.scalars,
    })
}
