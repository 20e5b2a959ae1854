//! What `summary.json` says of P.

use serde::Serialize;

use super::scalars::BandsOut;
use crate::estimate::{Analysis, ErrorSource};
use crate::plan::{RING_DIRECTIONS_RULE, WaveGrid, WaveVectors};

#[derive(Serialize)]
pub(super) struct SpectrumOut {
    /// Of a grid; a list has none.
    max_frequency: Option<Vec<u32>>,
    modes: usize,
    errors: ErrorSource,
    dc_p: Option<f64>,
    dc_p_se: Option<f64>,
}

#[derive(Serialize)]
pub(super) struct RadialOut {
    rings: usize,
    /// Wave vectors of all rings, opposite ones counted both.
    modes: u64,
    /// Which wave vectors of a ring were taken.
    directions: &'static str,
    errors: ErrorSource,
    anisotropy_reference_db: f64,
    bands: BandsOut,
}

/// Of P.
pub(super) fn spectrum(a: &Analysis) -> Option<SpectrumOut> {
    a.spectrum().map(|s| SpectrumOut {
        max_frequency: s.waves.grid().map(|grid| grid.max_frequency()[..grid.dim()].to_vec()),
        modes: s.waves.grid().map_or(s.waves.len(), WaveGrid::full_len),
        errors: s.errors,
        dc_p: s.dc().map(|dc| dc.0),
        dc_p_se: s.dc().map(|dc| dc.1),
    })
}

/// Of its rings.
pub(super) fn radial(a: &Analysis) -> Option<RadialOut> {
    a.radial().map(|r| RadialOut {
        rings: r.rings.len(),
        modes: r.rings.iter().map(|ring| ring.modes).sum(),
        directions: match a.spectrum().map(|s| &s.waves) {
            Some(WaveVectors::List(_)) => RING_DIRECTIONS_RULE,
            _ => "all",
        },
        errors: r.errors,
        anisotropy_reference_db: r.anisotropy_reference_db,
        bands: BandsOut::new(r),
    })
}
