//! What an analysis says at one place: the bin, ring, mode or cell there, with value, error and unit.

use super::lag_slices::{lag_planes, lag_slice_cells};
use super::units::{Axis, Units};
use super::{human, with_error};
use crate::error::plural;
use crate::estimate::Analysis;
use crate::points::UnitName;

/// g in a bin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BinAt {
    /// The bin, from 0.
    pub index: usize,
    /// Its lower end, in the domain's length unit.
    pub r_lo: f64,
    /// Its label.
    pub r: f64,
    /// Its upper end.
    pub r_hi: f64,
    /// Ordered pairs in it.
    pub count: u64,
    /// g.
    pub g: f64,
    /// Its standard error.
    pub se: f64,
    /// The closed form, where there is one.
    pub theory: Option<f64>,
}

/// P and anisotropy of a ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingAt {
    /// The ring, from 0.
    pub index: usize,
    /// Its lower end, in cycles per unit length.
    pub nu_lo: f64,
    /// Its label.
    pub nu: f64,
    /// Its upper end.
    pub nu_hi: f64,
    /// Modes in it.
    pub modes: u64,
    /// Mean of P.
    pub p: f64,
    /// Its standard error.
    pub se: f64,
    /// Anisotropy in dB, where defined.
    pub anisotropy_db: Option<f64>,
    /// Its standard error for an isotropic spectrum, in dB.
    pub anisotropy_db_se: Option<f64>,
    /// The closed form of P, where there is one.
    pub theory: Option<f64>,
}

/// P of a mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeAt {
    /// Cycles per side; 0 on axes the domain lacks.
    pub m: [i32; 3],
    /// Cycles per unit length.
    pub nu: [f64; 3],
    /// P.
    pub p: f64,
    /// Its standard error; `None` at m = 0, where P is no fluctuation.
    pub se: Option<f64>,
    dim: usize,
    unit: Option<UnitName>,
}

/// g in a cell of lags.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LagAt {
    /// Centre of the cell to the right and upward, in the domain's length unit.
    pub lag: [f64; 2],
    /// Which axes of the domain those are.
    pub axes: [usize; 2],
    /// g, in 3D of the slice shown: the mean of the cells that touch lag 0 of the third axis.
    pub g: f64,
    /// Its standard error; of the mean of two cells no more than this, which it is if they rise and fall together.
    pub se: f64,
    unit: Option<UnitName>,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// The bin of g(r) that holds `r`, in the domain's length unit.
pub fn bin_at(analysis: &Analysis, r: f64) -> Option<BinAt> {
    let g = analysis.pair_correlation()?;
    let index = g.r_hi.partition_point(|&hi| hi <= r);
    (*g.r_lo.get(index)? <= r).then(|| BinAt {
        index,
        r_lo: g.r_lo[index],
        r: g.r[index],
        r_hi: g.r_hi[index],
        count: g.count[index],
        g: g.g[index],
        se: g.g_se[index],
        theory: analysis.closed_form.g.as_ref().and_then(|theory| theory.get(index).copied()),
    })
}

/// The ring that holds the frequency `nu`, in cycles per unit length.
pub fn ring_at(analysis: &Analysis, nu: f64) -> Option<RingAt> {
    let rings = &analysis.radial()?.rings;
    let index = rings.iter().position(|ring| (ring.nu_lo..ring.nu_hi).contains(&nu))?;
    let ring = &rings[index];
    Some(RingAt {
        index,
        nu_lo: ring.nu_lo,
        nu: ring.nu,
        nu_hi: ring.nu_hi,
        modes: ring.modes,
        p: ring.p,
        se: ring.p_se,
        anisotropy_db: ring.anisotropy_db,
        anisotropy_db_se: ring.anisotropy_db_se,
        theory: analysis.closed_form.radial.as_ref().and_then(|theory| theory.get(index).copied()),
    })
}

/// The mode of the grid nearest to the frequency `nu`, in cycles per unit length; in 3D in the plane m_z = 0.
pub fn spectrum_at(analysis: &Analysis, nu: [f64; 2]) -> Option<ModeAt> {
    let spectrum = analysis.spectrum().filter(|_| analysis.grid_wanted)?;
    let grid = spectrum.waves.grid()?;
    let (sides, f) = (analysis.domain.sides(), grid.max_frequency());
    let mut m = [0; 3];
    for axis in 0..grid.dim().min(2) {
        let nearest = (nu[axis] * sides[axis]).round();
        // NaN is outside too.
        if !(0.0..=f64::from(f[axis])).contains(&nearest.abs()) {
            return None;
        }
        m[axis] = nearest as i32;
    }
    let index = grid.half_index(m);
    Some(ModeAt {
        unit: analysis.unit,
        m,
        nu: std::array::from_fn(|k| sides.get(k).map_or(0.0, |side| f64::from(m[k]) / side)),
        p: spectrum.p[index],
        se: (m != [0; 3]).then_some(spectrum.p_se[index]),
        dim: grid.dim(),
    })
}

/// The cell of lags that holds `lag`, in the domain's length unit, on a plane of `vector_pixels`.
pub fn vector_at(analysis: &Analysis, lag: [f64; 2], plane: usize) -> Option<LagAt> {
    let vector = analysis.vector()?;
    let grid = &vector.grid;
    let axes = *lag_planes(grid.dim()).get(plane)?;
    let bin = |h: f64, axis: usize| (0..grid.bins).find(|&k| (grid.edge(axis, k)..grid.edge(axis, k + 1)).contains(&h));
    let cells = lag_slice_cells(grid, axes, [bin(lag[0], axes[0])?, bin(lag[1], axes[1])?]);
    let mean = |values: &[f64]| 0.5 * (values[cells[0]] + values[cells[1]]);
    Some(LagAt {
        unit: analysis.unit,
        lag: axes.map(|axis| grid.centre(cells[0], axis)),
        axes,
        g: mean(&vector.g),
        se: mean(&vector.g_se),
    })
}

/// The closed form, as an appendix.
fn closed(theory: Option<f64>) -> String {
    theory.map_or(String::new(), |theory| format!(", closed form {}", human(theory)))
}

impl BinAt {
    /// Value, error and unit, r as along `axis`.
    pub fn text(&self, axis: Axis) -> String {
        let [lo, hi] = [self.r_lo, self.r_hi].map(|r| human(axis.in_unit(r)));
        let g = with_error(self.g, Some(self.se));
        format!("{} (bin {lo} to {hi}), g = {g}{}", axis.text(self.r), closed(self.theory))
    }

    /// g and its error alone, for little room: `0.98 ± 0.01`.
    pub fn brief(&self) -> String {
        with_error(self.g, Some(self.se))
    }
}

impl RingAt {
    /// Value, error and unit, nu as along `axis`.
    pub fn text(&self, axis: Axis) -> String {
        let db = self.anisotropy_db.map_or(String::new(), |db| {
            format!(", anisotropy {} dB (isotropic ± {})", human(db), human(self.anisotropy_db_se.unwrap_or(f64::NAN)))
        });
        let p = with_error(self.p, Some(self.se));
        format!("{}, P = {p}{} ({}){db}", axis.text(self.nu), closed(self.theory), plural(self.modes, "mode"))
    }

    /// P and its error alone, for little room.
    pub fn brief(&self) -> String {
        with_error(self.p, Some(self.se))
    }

    /// Anisotropy as along `axis`, and what that of an isotropic spectrum scatters by, alone.
    pub fn anisotropy_brief(&self, axis: Axis) -> String {
        match self.anisotropy_db {
            Some(db) => format!("{} dB", with_error(axis.in_unit(db), self.anisotropy_db_se)),
            None => "undefined".into(),
        }
    }
}

impl ModeAt {
    /// Value, error and unit.
    pub fn text(&self) -> String {
        let m = self.m[..self.dim].iter().map(|m| human(f64::from(*m))).collect::<Vec<_>>().join(", ");
        let nu = self.nu.iter().map(|nu| nu * nu).sum::<f64>().sqrt();
        let dc = if self.se.is_none() { " (DC)" } else { "" };
        format!(
            "m = ({m}){dc}, |ν| = {} {}, P = {}",
            human(nu),
            Units::named(self.unit).cycles,
            with_error(self.p, self.se)
        )
    }
}

impl LagAt {
    /// Value, error and unit.
    pub fn text(&self) -> String {
        let [a, b] = self.axes.map(|axis| AXES[axis]);
        let [h, v] = self.lag.map(human);
        format!(
            "(h_{a}, h_{b}) = ({h}, {v}) {}, g = {}",
            Units::named(self.unit).length,
            with_error(self.g, Some(self.se))
        )
    }
}
