//! Where points live: a torus that wraps, or a window that does not, a box or a polygon.

use std::sync::Arc;

use super::fixed_point::{difference, steps};
use super::polygon::{Polygon, Ring, as_box};
use crate::error::{Error, Result, number, numbers};
use crate::named::named;
use crate::setting::Setting;

/// What happens at the sides of the box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Boundary {
    /// Opposite sides are glued; distances are minimum-image distances.
    Torus,
    /// The pattern was observed through a window; distances are plain, edges need correction.
    Window,
}

named!(Boundary: Torus = "torus", Window = "window");

/// `unit torus`, `torus of sides 2, 1`, `torus of sides 4, 4 from -2, -2`, `window [0, 10] x [0, 5]`, `polygon of 6 vertices in [0, 10] x [0, 5]`.
impl std::fmt::Display for Domain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.boundary {
            Boundary::Torus => {
                let listed = |values: &[f64]| numbers(values.iter().copied()).replace(',', ", ");
                match self.sides.iter().all(|&s| s == 1.0) {
                    true => f.write_str("unit torus")?,
                    false => write!(f, "torus of sides {}", listed(&self.sides))?,
                }
                match self.origin.iter().all(|&o| o == 0.0) {
                    true => Ok(()),
                    false => write!(f, " from {}", listed(&self.origin)),
                }
            }
            Boundary::Window => {
                let range = |(&o, &s): (&f64, &f64)| format!("[{}, {}]", number(o), number(o + s));
                let ranges: Vec<_> = self.origin.iter().zip(&self.sides).map(range).collect();
                match &self.polygon {
                    Some(polygon) => write!(f, "polygon of {} in {}", polygon.words(), ranges.join(" x ")),
                    None => write!(f, "window {}", ranges.join(" x ")),
                }
            }
        }
    }
}

/// An axis-aligned box in 1, 2 or 3 dimensions. Torus: `[origin, origin + side)`; window: closed on both ends. Or a window that is a
/// polygon, in its bounding box.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(into = "Stored", try_from = "Stored")]
pub struct Domain {
    boundary: Boundary,
    origin: Vec<f64>,
    sides: Vec<f64>,
    /// What f64 drops of the sides of a window, the differences of its corners: no more than half of the last place. What is
    /// at the upper corner is at the sum.
    rests: Vec<f64>,
    /// What of the box is the window, if not all of it.
    polygon: Option<Arc<Polygon>>,
}

/// A domain as files have it, to the last bit.
#[derive(serde::Serialize, serde::Deserialize)]
struct Stored {
    boundary: Boundary,
    origin: Vec<f64>,
    sides: Vec<f64>,
    /// None where all are 0, as those of tori and of most windows are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    rests: Vec<f64>,
    /// Its rings, part by part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    polygon: Option<Vec<Vec<Ring>>>,
}

impl From<Domain> for Stored {
    fn from(domain: Domain) -> Self {
        let Domain { boundary, origin, sides, mut rests, polygon } = domain;
        if rests.iter().all(|&rest| rest == 0.0) {
            rests.clear();
        }
        Self { boundary, origin, sides, rests, polygon: polygon.map(|polygon| polygon.parts().to_vec()) }
    }
}

impl TryFrom<Stored> for Domain {
    type Error = Error;

    fn try_from(stored: Stored) -> Result<Self> {
        let Stored { boundary, origin, sides, mut rests, polygon } = stored;
        if rests.is_empty() {
            rests = vec![0.0; sides.len()];
        }
        let domain = Self::from_numbers(boundary, origin, sides, rests)?;
        let Some(parts) = polygon else { return Ok(domain) };
        let polygon = Self::polygon(parts)?;
        let box_of = |domain: &Self| (domain.boundary, domain.origin.clone(), domain.sides.clone());
        match box_of(&polygon) == box_of(&domain) {
            true => Ok(polygon),
            false => Err(Error::input("domain", "has a polygon that is not that of its window")),
        }
    }
}

impl Domain {
    /// The unit torus `[0, 1)^dim`. `dim` is clamped to 1..=3 by the callers' checks.
    pub fn unit_torus(dim: usize) -> Self {
        let (origin, sides, rests) = (vec![0.0; dim], vec![1.0; dim], vec![0.0; dim]);
        Self { boundary: Boundary::Torus, origin, sides, rests, polygon: None }
    }

    /// A torus `[0, L_k)` with the given sides.
    ///
    /// # Errors
    /// Sides that are not finite, too long, too short or too unequal; not 1 to 3 of them.
    pub fn torus(sides: &[f64]) -> Result<Self> {
        let zeros = vec![0.0; sides.len()];
        Self::checked(Boundary::Torus, zeros.clone(), sides.to_vec(), zeros, Setting::Sides, "L1,L2[,L3]")
    }

    /// A torus `[low, high)` per axis.
    ///
    /// # Errors
    /// As `torus`.
    pub fn torus_at(ranges: &[(f64, f64)]) -> Result<Self> {
        let (origin, sides) = ranges.iter().map(|&(low, high)| (low, high - low)).unzip();
        let rests = vec![0.0; ranges.len()];
        Self::checked(Boundary::Torus, origin, sides, rests, Setting::Sides, "L1,L2[,L3]")
    }

    /// A window given as `(low, high)` per axis.
    ///
    /// # Errors
    /// As `torus`, of the sides of the window.
    pub fn window(ranges: &[(f64, f64)]) -> Result<Self> {
        let origin = ranges.iter().map(|r| r.0).collect();
        let [sides, rests] = [0, 1].map(|part| ranges.iter().map(|r| difference(r.1, r.0)[part]).collect());
        Self::checked(Boundary::Window, origin, sides, rests, Setting::Window, "x0,x1,y0,y1[,z0,z1] with x0 < x1")
    }

    /// A window that is a polygon: per part its outer ring and its holes, closed or not, in either direction. One that is a box is
    /// the window of that box.
    ///
    /// ```
    /// use pairwave::points::Domain;
    ///
    /// let square = vec![[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]];
    /// let hole = vec![[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]];
    /// assert_eq!(Domain::polygon(vec![vec![square, hole]])?.measure(), 8.0);
    /// # Ok::<(), pairwave::Error>(())
    /// ```
    ///
    /// # Errors
    /// Rings that cross, holes outside their ring, parts that overlap, what has no area, each by its ring; as `window` of the
    /// bounding box.
    pub fn polygon(parts: Vec<Vec<Ring>>) -> Result<Self> {
        let parts = Polygon::checked(parts)
            .map_err(|fault| Error::setting(Setting::WindowPolygon, fault.ring, fault.reason))?;
        if let Some(ranges) = as_box(&parts) {
            return Self::window(&ranges);
        }
        let range = |axis: usize| {
            let along = parts.iter().flatten().flatten().map(move |v| v[axis]);
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let mut domain = Self::window(&[range(0), range(1)]).map_err(|e| match e {
            Error::Setting { value, reason, .. } => {
                Error::setting(Setting::WindowPolygon, "polygon", format!("its bounding box {value}: {reason}"))
            }
            other => other,
        })?;
        let polygon = Polygon::new(parts, [domain.origin[0], domain.origin[1]], domain.length_unit());
        // What is left of a sliver by the integers of points.
        if !(polygon.inner_diameter() > 0.0 && polygon.area() > 0.0) {
            let reason = "is too thin for its length: no circle fits into it";
            return Err(Error::setting(Setting::WindowPolygon, "polygon", reason));
        }
        domain.polygon = Some(Arc::new(polygon));
        Ok(domain)
    }

    /// The polygon that the window is, if it is no box.
    pub fn as_polygon(&self) -> Option<&Polygon> {
        self.polygon.as_deref()
    }

    fn checked(
        boundary: Boundary,
        origin: Vec<f64>,
        sides: Vec<f64>,
        rests: Vec<f64>,
        setting: Setting,
        form: &str,
    ) -> Result<Self> {
        if !(1..=3).contains(&sides.len()) {
            let reason = format!("1, 2 or 3 axes are supported; expected {form}");
            return Err(Error::setting(setting, format!("{} axes", sides.len()), reason));
        }
        let typed = || match boundary {
            Boundary::Torus => numbers(sides.iter().copied()),
            Boundary::Window => numbers(origin.iter().zip(&sides).flat_map(|(&o, &s)| [o, o + s])),
        };
        for (&o, &s) in origin.iter().zip(&sides) {
            // The square of a side and its inverse must stay normal numbers: distances are compared squared.
            if !(o.is_finite() && s.is_finite() && s > 1e-100 && s < 1e100 && o.abs() < 1e100) {
                let reason = format!("every side must be finite and between 1e-100 and 1e100; expected {form}");
                return Err(Error::setting(setting, typed(), reason));
            }
        }
        let (min, max) = (min_of(&sides), max_of(&sides));
        if max / min > 1e6 {
            let reason = "the longest side may be at most 1e6 times the shortest";
            return Err(Error::setting(setting, typed(), reason));
        }
        Ok(Self { boundary, origin, sides, rests, polygon: None })
    }

    /// By its corner, its sides and their rests.
    pub(crate) fn from_numbers(boundary: Boundary, origin: Vec<f64>, sides: Vec<f64>, rests: Vec<f64>) -> Result<Self> {
        if origin.len() != sides.len() || rests.len() != sides.len() {
            return Err(Error::input("domain", "has another number of corners than of sides"));
        }
        // Written so that NaN fails.
        if !rests.iter().zip(&sides).all(|(rest, side)| side + rest == *side) {
            return Err(Error::input("domain", "has sides that are no differences of corners"));
        }
        Self::checked(boundary, origin, sides, rests, Setting::Sides, "1 to 3 numbers")
    }

    /// Torus or window.
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// Whether the box wraps.
    pub fn is_torus(&self) -> bool {
        self.boundary == Boundary::Torus
    }

    /// Number of axes, 1 to 3.
    pub fn dim(&self) -> usize {
        self.sides.len()
    }

    /// Low corner, per axis.
    pub fn origin(&self) -> &[f64] {
        &self.origin
    }

    /// Side lengths, per axis.
    pub fn sides(&self) -> &[f64] {
        &self.sides
    }

    /// What f64 drops of the sides of a window.
    pub(crate) fn rests(&self) -> &[f64] {
        &self.rests
    }

    /// The shortest side of the box.
    pub fn shortest_side(&self) -> f64 {
        min_of(&self.sides)
    }

    /// Length, area or volume `|D|`.
    pub fn measure(&self) -> f64 {
        self.polygon.as_ref().map_or_else(|| self.sides.iter().product(), |polygon| polygon.area())
    }

    /// The diameter of the largest ball inside: the shortest side, or that of a polygon.
    pub fn inner_diameter(&self) -> f64 {
        self.polygon.as_ref().map_or_else(|| self.shortest_side(), |polygon| polygon.inner_diameter())
    }

    /// The radius of the ball about a window: half the diagonal, or that of a polygon.
    pub fn circumradius(&self) -> f64 {
        self.polygon.as_ref().map_or_else(|| self.half_diagonal(), |polygon| polygon.circumradius())
    }

    /// The border of a window.
    pub fn border(&self) -> Border<'_> {
        Border { sides: self.side_steps(), polygon: self.as_polygon() }
    }

    /// Whether all sides are equal.
    pub fn is_cubic(&self) -> bool {
        self.sides.iter().all(|&s| s == self.sides[0])
    }

    /// The length that 2^64 fixed-point steps stand for, the same on every axis: the longest side of a torus, twice
    /// the longest side of a window (so that a window fills at most half of the integer circle and never wraps).
    pub fn length_unit(&self) -> f64 {
        match self.boundary {
            Boundary::Torus => max_of(&self.sides),
            Boundary::Window => 2.0 * max_of(&self.sides),
        }
    }

    /// Period of each axis in fixed-point steps of `length_unit() / 2^64`; 0 stands for 2^64 (the natural wrap of a
    /// u64). A shorter side of a torus is its quotient by the longest as f64 has it, off by at most 2^-53 of itself; such
    /// periods are even, so that half a period is a whole number of steps.
    pub fn periods(&self) -> [u64; 3] {
        let mut periods = [0; 3];
        if self.is_torus() {
            for (p, &side) in periods.iter_mut().zip(&self.sides) {
                let ratio = side / self.length_unit();
                // f64 -> u128 is exact here: 2^64 * ratio has at most 53 significant bits and is at least 2^44.
                *p = if ratio == 1.0 { 0 } else { (ratio * 2f64.powi(64)) as u128 as u64 };
            }
        }
        periods
    }

    /// Side of each axis in fixed-point steps of `length_unit() / 2^64`: the period of a torus; of a window rounded to nearest,
    /// so that no position is beyond it. 0 stands for 2^64, the longest side of a torus.
    pub fn side_steps(&self) -> [u64; 3] {
        if self.is_torus() {
            return self.periods();
        }
        let mut sides = [0; 3];
        for (steps_of, (&side, &rest)) in sides.iter_mut().zip(self.sides.iter().zip(&self.rests)) {
            *steps_of = steps([side, rest], self.length_unit()) as u64;
        }
        sides
    }

    /// Half the diagonal of the box: the longest distance on a torus.
    pub fn half_diagonal(&self) -> f64 {
        self.sides.iter().map(|s| s * s).sum::<f64>().sqrt() / 2.0
    }

    /// Positions along each axis are below this many fixed-point steps: the period of a torus, the side of a window and
    /// its closed end; 1 on axes beyond the dimension.
    pub fn extents(&self) -> [u128; 3] {
        let mut extents = [1; 3];
        for (k, extent) in extents.iter_mut().enumerate().take(self.dim()) {
            *extent = match (self.boundary, self.periods()[k]) {
                (Boundary::Torus, 0) => 1 << 64,
                (Boundary::Torus, period) => u128::from(period),
                (Boundary::Window, _) => u128::from(self.side_steps()[k]) + 1,
            };
        }
        extents
    }

    /// Distance between neighbours in the closest packing of `n` points: hexagonal in 2D, `sqrt(2/(sqrt(3) lambda))`;
    /// face-centred cubic in 3D, `(sqrt(2)/lambda)^(1/3)`; even spacing in 1D.
    pub fn closest_packing_distance(&self, n: f64) -> f64 {
        closest_packing_distance(self.dim(), n / self.measure())
    }
}

/// The same of any intensity in 1 to 16 dimensions; from 4 on the densest packing known (Conway, Sloane, "Sphere Packings,
/// Lattices and Groups", 3rd edition, tables 1.2 and 1.3), by its centre density.
pub(crate) fn closest_packing_distance(dim: usize, intensity: f64) -> f64 {
    let [root_2, root_3] = [2f64.sqrt(), 3f64.sqrt()];
    let center_density = match dim {
        1 => return 1.0 / intensity,
        2 => return (2.0 / (root_3 * intensity)).sqrt(),
        3 => return (root_2 / intensity).cbrt(),
        4 => 1.0 / 8.0,
        5 => 1.0 / (8.0 * root_2),
        6 => 1.0 / (8.0 * root_3),
        7 | 8 | 16 => 1.0 / 16.0,
        9 | 15 => 1.0 / (16.0 * root_2),
        10 => 5.0 / 128.0,
        11 | 13 => 9.0 / 256.0,
        12 => 1.0 / 27.0,
        14 => 1.0 / (16.0 * root_3),
        _ => return f64::NAN,
    };
    2.0 * (center_density / intensity).powf(1.0 / dim as f64)
}

/// The border of a window, from which points have a distance.
#[derive(Debug, Clone, Copy)]
pub struct Border<'a> {
    sides: [u64; 3],
    polygon: Option<&'a Polygon>,
}

impl Border<'_> {
    /// The distance of a place in the window, per axis in fixed-point steps.
    pub fn distance(&self, place: &[u64]) -> u64 {
        match (self.polygon, place) {
            (Some(polygon), &[x, y]) => polygon.to_sides([x, y]),
            _ => place.iter().zip(self.sides).map(|(&x, side)| x.min(side.saturating_sub(x))).min().unwrap_or(0),
        }
    }

    /// The same of point `i` of some axes.
    pub fn distance_of(&self, axes: &[&[u64]], i: usize) -> u64 {
        let place: [u64; 3] = std::array::from_fn(|a| axes.get(a).map_or(0, |axis| axis[i]));
        self.distance(&place[..axes.len()])
    }
}

fn min_of(v: &[f64]) -> f64 {
    v.iter().copied().fold(f64::INFINITY, f64::min)
}

fn max_of(v: &[f64]) -> f64 {
    v.iter().copied().fold(0.0, f64::max)
}
