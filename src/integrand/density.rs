//! Densities that points are placed by, and the map that does: marginal and conditional distributions, inverted.

use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;

use super::cells::Cells;
use super::entry::AXES;
use super::factors::Factor;
use super::inverse::Lines;
use super::panels::Panels;
use super::shape::Shape;
use super::stairs::Stairs;
use super::{Integrand, Separable};
use crate::error::{Error, Result};
use crate::setting::Setting;

/// A density on the unit box: an integrand over its integral. A clone shares what it holds.
#[derive(Clone)]
pub struct Density {
    spec: Arc<str>,
    dim: usize,
    integral: f64,
    smoothness: f64,
    error: f64,
    cells: Option<usize>,
    function: Function,
    map: Arc<Map>,
}

/// What it is proportional to.
#[derive(Clone)]
enum Function {
    Given(Integrand),
    Cells(Arc<Cells>),
}

/// What takes uniform points to it.
enum Map {
    Lines(Lines),
    Stairs(Stairs),
    Panels(Panels),
}

/// Series on panels that err by more are no map: a density that jumps or bends is taken as constant on cells.
const SMOOTH: f64 = 1e-7;

/// Cells per axis, and places per axis of each that its value is the mean of, by dimension.
const CELLS: [(usize, usize); 3] = [(1 << 16, 16), (512, 8), (64, 4)];

/// Within [0, 1), but for ends, where a density may be 0.
const FIRST: f64 = 1.0 / (1u64 << 54) as f64;

/// An integrand that is nowhere below 0 and not 0 everywhere, and its largest value.
///
/// # Errors
/// What is no integrand, is below 0 somewhere, or has no integral.
pub(crate) fn nonnegative(spec: &str, dim: usize) -> Result<(Integrand, f64)> {
    let given = Integrand::new(spec, dim).map_err(|error| match error {
        Error::Setting { setting: Setting::Integrand, value, reason } => {
            Error::setting(Setting::Intensity, value, reason)
        }
        other => other,
    })?;
    let wrong = |reason: String| Error::setting(Setting::Intensity, given.spec(), reason);
    let (maximum, (least, x)) = given.maximum();
    if least < 0.0 {
        let place: Vec<String> = (0..dim).map(|k| format!("{} = {}", AXES[k], x[k])).collect();
        return Err(wrong(format!("is {least} at {}; expected a density, 0 or more everywhere", place.join(", "))));
    }
    let integral = given.integral();
    if !(integral > 0.0 && integral.is_finite()) {
        return Err(wrong(format!("has the integral {integral}; expected a density, whose integral is above 0")));
    }
    Ok((given, maximum))
}

impl fmt::Debug for Density {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} in {}D", self.spec, self.dim)
    }
}

impl Density {
    /// The density that is proportional to the integrand `spec`, in `dim` dimensions.
    ///
    /// # Errors
    /// What is no integrand, is below 0 somewhere, or has no integral.
    pub fn new(spec: &str, dim: usize) -> Result<Self> {
        let (given, _) = nonnegative(spec, dim)?;
        let integral = given.integral();
        let mut density = Self {
            spec: given.spec().into(),
            dim,
            integral,
            smoothness: given.smoothness(),
            error: 0.0,
            cells: None,
            map: Arc::new(Map::Stairs(Stairs::new([1; 3], &[1.0]))),
            function: Function::Given(given.clone()),
        };
        density.map = Arc::new(if let Some(product) = given.separable() {
            Map::Lines(Lines::new(product))
        } else if let Some((shape, values)) = given.shape.cells() {
            Map::Stairs(Stairs::new(shape, values))
        } else {
            let panels = Panels::new(dim, |x| given.value(&x[..dim]));
            if panels.error <= SMOOTH {
                density.error = panels.error.max(given.integral_error() / integral);
                Map::Panels(panels)
            } else {
                density.constant_on_cells(&given)
            }
        });
        Ok(density)
    }

    /// Means over cells in place of the function.
    fn constant_on_cells(&mut self, given: &Integrand) -> Map {
        let dim = self.dim;
        let (cells, places) = CELLS[dim - 1];
        let shape: [usize; 3] = std::array::from_fn(|k| if k < dim { cells } else { 1 });
        let mean = |cell: usize| {
            let corner = [cell / (shape[1] * shape[2]), cell / shape[2] % shape[1], cell % shape[2]];
            let at = |i: usize| {
                let x: [f64; 3] = std::array::from_fn(|k| {
                    let part = (i / places.pow(k as u32) % places) as f64 + 0.5;
                    if k < dim { (corner[k] as f64 + part / places as f64) / cells as f64 } else { 0.0 }
                });
                given.value(&x[..dim])
            };
            let count = places.pow(dim as u32);
            (0..count).map(at).sum::<f64>() / count as f64
        };
        let values: Vec<f64> = (0..cells.pow(dim as u32)).into_par_iter().map(mean).collect();
        self.integral = values.iter().sum::<f64>() / values.len() as f64;
        self.smoothness = 1.0;
        self.cells = Some(cells);
        let map = Map::Stairs(Stairs::new(shape, &values));
        self.function = Function::Cells(Arc::new(Cells::new(shape, values)));
        map
    }

    /// Its specification with all parameters.
    pub fn spec(&self) -> &str {
        &self.spec
    }

    /// Cells per axis that it is taken as constant on, where it is: what jumps or bends, and is neither a product nor itself constant on cells.
    pub fn cells(&self) -> Option<usize> {
        self.cells
    }

    /// The cells per axis that it is constant on, its own or those it is taken on.
    pub(super) fn constant_on(&self) -> Option<[usize; 3]> {
        match &self.function {
            Function::Given(given) => given.shape.cells(),
            Function::Cells(cells) => cells.cells(),
        }
        .map(|(shape, _)| shape)
    }

    /// A bound of what the map errs by that is more than rounding, of the whole.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// The density at `x`, whose integral is 1.
    pub fn value(&self, x: &[f64]) -> f64 {
        let value = match &self.function {
            Function::Given(given) => given.value(x),
            Function::Cells(cells) => cells.value(super::padded(x)),
        };
        value / self.integral
    }

    /// Where a uniform point goes: x by its marginal distribution, y by that given x, z by that given both.
    pub fn place(&self, u: &[f64]) -> [f64; 3] {
        self.mapped(super::padded(u))
    }

    fn mapped(&self, u: [f64; 3]) -> [f64; 3] {
        let u = std::array::from_fn(|k| if k < self.dim { u[k].clamp(FIRST, 1f64.next_down()) } else { 0.0 });
        match &*self.map {
            Map::Lines(lines) => lines.place(u),
            Map::Stairs(stairs) => stairs.place(u),
            Map::Panels(panels) => panels.place(u),
        }
    }

    /// Where `u` goes, and the density there, which is above 0: no point comes to where it is 0, but for rounding at the edges of that.
    pub(super) fn sampled(&self, u: [f64; 3]) -> ([f64; 3], f64) {
        let dim = self.dim;
        let mut x = self.mapped(u);
        let mut p = self.value(&x[..dim]);
        for step in [1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6] {
            if p > 0.0 {
                break;
            }
            x = self.mapped(u.map(|u| u + step));
            p = self.value(&x[..dim]);
        }
        (x, p)
    }

    pub(super) fn smoothness(&self) -> f64 {
        self.smoothness
    }

    fn product(&self) -> Option<&Separable> {
        match &self.function {
            Function::Given(given) => given.separable().filter(|p| p.offset() == 0.0),
            Function::Cells(_) => None,
        }
    }

    /// Whether it is a product of functions of one coordinate each.
    pub(super) fn is_product(&self) -> bool {
        self.product().is_some()
    }

    fn factor(&self, axis: usize) -> &Factor {
        self.product().map_or(&Factor::One, |product| &product.factors()[axis])
    }

    /// Of a product, the factor of an axis.
    pub(super) fn along(&self, axis: usize, x: f64) -> f64 {
        self.factor(axis).value(x)
    }

    /// The integral of that.
    pub(super) fn integral_along(&self, axis: usize) -> f64 {
        self.factor(axis).integral()
    }

    /// Of a product: another factor over the density along an axis, where `v` is mapped to.
    pub(super) fn ratio_along(&self, axis: usize, other: &Factor, v: f64) -> f64 {
        let Map::Lines(lines) = &*self.map else { return 0.0 };
        let at = |step: f64| lines.quantile(axis, (v + step).clamp(FIRST, 1f64.next_down()));
        let steps = [0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6];
        let found = steps.into_iter().map(at).find(|x| self.along(axis, *x) > 0.0);
        found.map_or(0.0, |x| other.value(x) * self.integral_along(axis) / self.along(axis, x))
    }
}
