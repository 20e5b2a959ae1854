//! Wave power -> P along each axis.

use super::confidence::Band;
use super::{ErrorSource, PowerSpectrum};
use crate::plan::{WavePlan, WaveVectors};

/// P at one mode `m e_axis`, which is also that at `-m e_axis`: one independent ordinate per realization and taper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisMode {
    /// The axis, 0 for x.
    pub axis: usize,
    /// Cycles per side, above 0.
    pub m: f64,
    /// `m / L`, in cycles per unit length.
    pub nu: f64,
    /// P.
    pub p: f64,
    /// Its standard error.
    pub p_se: f64,
    /// Its confidence band.
    pub band: Option<Band>,
}

/// P at the wave vectors with one component only: the power of the points' projections onto the axes, which tells
/// stratification along an axis from that along others.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSlices {
    /// Axis by axis, in rising m; none for a spectrum without such wave vectors.
    pub modes: Vec<AxisMode>,
    /// Where `p_se` comes from.
    pub errors: ErrorSource,
}

impl AxisSlices {
    /// The slices.
    pub fn new(plan: &WavePlan, spectrum: &PowerSpectrum) -> Self {
        let mut modes: Vec<_> = on_axes(&plan.waves)
            .into_iter()
            .filter(|&(_, _, index)| plan.computes(index))
            .map(|(axis, m, index)| {
                let (p, p_se) = (spectrum.p[index], spectrum.p_se[index]);
                let nu = m / plan.domain.sides()[axis];
                AxisMode { axis, m, nu, p, p_se, band: spectrum.band(index) }
            })
            .collect();
        modes.sort_by(|a, b| a.axis.cmp(&b.axis).then(a.m.total_cmp(&b.m)));
        modes.dedup_by(|a, b| (a.axis, a.m) == (b.axis, b.m));
        Self { modes, errors: spectrum.errors }
    }
}

/// Axis, |m| and place of every stored mode with one component.
fn on_axes(waves: &WaveVectors) -> Vec<(usize, f64, usize)> {
    match waves {
        WaveVectors::Grid(grid) => (0..grid.dim())
            .flat_map(|axis| (1..=grid.max_frequency()[axis]).map(move |m| (axis, m)))
            .map(|(axis, m)| {
                let vector = std::array::from_fn(|k| if k == axis { m as i32 } else { 0 });
                (axis, f64::from(m), grid.half_index(vector))
            })
            .collect(),
        WaveVectors::List(list) => (list.vectors.iter().enumerate())
            .filter_map(|(index, vector)| {
                let axis = vector.iter().position(|&m| m != 0.0)?;
                let lone = (0..3).all(|k| k == axis || vector[k] == 0.0);
                lone.then_some((axis, vector[axis].abs(), index))
            })
            .collect(),
    }
}
