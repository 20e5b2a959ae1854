//! The plan for lag counts: pairs by the vector between their points, on a grid of lags.

use std::fmt;

use super::{Batch, Correction, EnsembleShape, refuse_polygon};
use crate::error::{Error, Result, number, numbers};
use crate::points::{Domain, mantissa_exponent};
use crate::setting::Setting;

/// Most bins per axis.
pub const MAX_LAG_BINS: usize = 1 << 16;
/// Most cells of a grid of lags, 128 per axis in 3D: their sums take 150 MB.
pub const MAX_LAG_CELLS: usize = 1 << 21;
/// Radii of lag rings where none are given, in closest-packing distances.
pub(crate) const DEFAULT_LAG_RINGS: [f64; 3] = [0.5, 1.0, 2.0];

/// The fewest and the most sectors of a lag ring.
const SECTORS: [usize; 2] = [4, 36];

/// Bins per axis where no number is given: odd, so that lag 0 and the lags along an axis lie in the middle of cells. On an edge
/// `h` and `-h` would fall into cells that are not each other's mirror images.
pub(crate) const DEFAULT_LAG_BINS: usize = 65;

/// How far lags go where nothing is given, in closest-packing distances.
const DEFAULT_LAG_REACH: f64 = 4.0;

/// How far lags go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LagReach {
    /// This far on every axis, in length units.
    Given(f64),
    /// All lags there are: half the sides of a torus, the sides of a window.
    Whole,
}

impl LagReach {
    /// Where nothing is given: 4 closest-packing distances, as far as they fit.
    pub fn usual(domain: &Domain, mean_points: f64) -> Self {
        let reach = DEFAULT_LAG_REACH * domain.closest_packing_distance(mean_points);
        Self::Given(reach.min(longest_lag(domain)))
    }

    /// The largest lag of a grid, `None` for all.
    pub fn limit(self) -> Option<f64> {
        match self {
            Self::Given(reach) => Some(reach),
            Self::Whole => None,
        }
    }
}

impl std::str::FromStr for LagReach {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "whole" => Ok(Self::Whole),
            number => number.parse().map(Self::Given).map_err(|_| "expected a number, or whole".into()),
        }
    }
}

impl fmt::Display for LagReach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Given(reach) => f.write_str(&number(*reach)),
            Self::Whole => f.write_str("whole"),
        }
    }
}

/// The longest lag that fits on every axis.
fn longest_lag(domain: &Domain) -> f64 {
    whole_lags(domain).into_iter().fold(f64::INFINITY, f64::min)
}

/// The longest lag of each axis.
fn whole_lags(domain: &Domain) -> Vec<f64> {
    domain.sides().iter().map(|&a| if domain.is_torus() { a / 2.0 } else { a }).collect()
}

/// `bins` half-open bins `[e_k, e_(k+1))` per axis, `e_k = H (2k - B) / B`, over lags `[-H, H)`.
#[derive(Debug, Clone, PartialEq)]
pub struct LagGrid {
    /// Bins per axis, B.
    pub bins: usize,
    /// Half-width H of each axis, in length units.
    pub half: Vec<f64>,
    /// Per axis and edge, the least lag at or beyond the edge, in steps of `length_unit / 2^64`: `ceil(e_k)`, exactly.
    pub thresholds: Vec<Vec<i128>>,
}

impl LagGrid {
    /// The grid over all lags of the domain, or over `[-lag_max, lag_max)` on every axis.
    ///
    /// # Errors
    /// Numbers of bins, largest lags or radii of lag rings that cannot be in the domain, or do not fit into memory.
    pub fn new(domain: &Domain, bins: usize, lag_max: Option<f64>) -> Result<Self> {
        refuse_polygon(domain, "pcf-vector")?;
        let dim = domain.dim() as u32;
        let fitting = (1..=MAX_LAG_BINS).contains(&bins) && bins.checked_pow(dim).is_some_and(|c| c <= MAX_LAG_CELLS);
        if !fitting {
            let most = (1..=MAX_LAG_BINS).rev().find(|b| b.checked_pow(dim).is_some_and(|c| c <= MAX_LAG_CELLS));
            let reason = format!("expected 1 to {} bins per axis in {dim}D", most.unwrap_or(1));
            return Err(Error::setting(Setting::LagBins, bins, reason));
        }
        let whole = whole_lags(domain);
        if let Some(h) = lag_max {
            let limit = longest_lag(domain);
            // Written so that NaN fails.
            if !(h > 0.0 && h <= limit) {
                let what = if domain.is_torus() { "half the shortest side" } else { "the shortest side of the window" };
                let reason = format!("expected a number above 0 and at most {what} ({limit})");
                return Err(Error::setting(Setting::LagMax, number(h), reason));
            }
        }
        let half: Vec<f64> = whole.iter().map(|&w| lag_max.unwrap_or(w)).collect();
        let thresholds = (half.iter().zip(&whole).zip(domain.periods()))
            .map(|((&half, &whole), period)| {
                // Half a torus is half its period, which for unequal sides is rounded to a step.
                let period = (domain.is_torus() && half == whole)
                    .then(|| if period == 0 { 1u128 << 64 } else { u128::from(period) });
                (0..=bins).map(|k| threshold(half, domain.length_unit(), period, k, bins)).collect()
            })
            .collect();
        Ok(Self { bins, half, thresholds })
    }

    /// Refuses cells that are narrower than positions are known, of which g says nothing.
    ///
    /// # Errors
    /// The largest lag, with the least that would do.
    pub fn check_cells(&self, domain: &Domain) -> Result<()> {
        if self.thresholds.iter().all(|axis| axis.is_sorted_by(|a, b| a < b)) {
            return Ok(());
        }
        let half = self.half.iter().copied().fold(f64::INFINITY, f64::min);
        let least = self.bins as f64 * domain.length_unit() * 2f64.powi(-63);
        let reason = format!("its cells are narrower than positions are known; expected at least {}", number(least));
        Err(Error::setting(Setting::LagMax, number(half), reason))
    }

    /// Number of axes.
    pub fn dim(&self) -> usize {
        self.half.len()
    }

    /// Number of cells, `B^d`.
    pub fn cells(&self) -> usize {
        self.bins.pow(self.dim() as u32)
    }

    /// Cells from one bin of an axis to the next: the x axis comes first, i.e. is the slowest. 0 for axes there are not.
    pub fn strides(&self) -> [usize; 3] {
        std::array::from_fn(|k| if k < self.dim() { self.bins.pow((self.dim() - 1 - k) as u32) } else { 0 })
    }

    /// The bin of a cell along an axis.
    pub fn bin(&self, cell: usize, axis: usize) -> usize {
        cell / self.strides()[axis] % self.bins
    }

    /// The cell of a lag, `None` outside the grid. A pair counts there and in the mirror cell.
    pub fn cell(&self, lag: [i128; 3]) -> Option<usize> {
        let mut cell = 0;
        for (h, thresholds) in lag.iter().zip(&self.thresholds) {
            let edges_below = thresholds.partition_point(|t| t <= h);
            if !(1..=self.bins).contains(&edges_below) {
                return None;
            }
            cell = cell * self.bins + edges_below - 1;
        }
        Some(cell)
    }

    /// The cell at `-h`: since the edges are symmetric, the one at the other end of the list.
    pub fn mirror(&self, cell: usize) -> usize {
        self.cells() - 1 - cell
    }

    /// Ordered pairs per cell from unordered ones, each counted at one of its two lags.
    pub(crate) fn with_mirror(&self, counts: &[u64]) -> Vec<u64> {
        counts.iter().zip(counts.iter().rev()).map(|(here, mirrored)| here + mirrored).collect()
    }

    /// Edge `k` of an axis, in length units.
    pub fn edge(&self, axis: usize, k: usize) -> f64 {
        let b = self.bins as f64;
        self.half[axis] * ((2.0 * k as f64 - b) / b)
    }

    /// Side of a cell.
    pub fn width(&self, axis: usize) -> f64 {
        2.0 * self.half[axis] / self.bins as f64
    }

    /// Centre of a cell along an axis.
    pub fn centre(&self, cell: usize, axis: usize) -> f64 {
        let b = self.bins as f64;
        self.half[axis] * ((2.0 * self.bin(cell, axis) as f64 + 1.0 - b) / b)
    }
}

/// `ceil(e_k)` in steps. `period` in steps where H is half of it.
fn threshold(half: f64, unit: f64, period: Option<u128>, k: usize, bins: usize) -> i128 {
    let twice = 2 * k as i128 - bins as i128;
    let share = twice.unsigned_abs();
    let (floor, exact) = match period {
        // e_k = (period / 2) (2k - B) / B
        Some(period) => ratio_floor(period * share, 2 * bins as u128, 0),
        // e_k = (H / unit) 2^64 (2k - B) / B, with H and unit as integers times powers of two
        None => {
            let ((h, h_exponent), (u, u_exponent)) = (mantissa_exponent(half), mantissa_exponent(unit));
            ratio_floor(u128::from(h) * share, u128::from(u) * bins as u128, h_exponent - u_exponent + 64)
        }
    };
    let floor = floor as i128;
    if twice < 0 { -floor } else { floor + i128::from(!exact) }
}

/// `floor(numerator 2^shift / denominator)` and whether that is exact, by long division. The quotient is below 2^127.
fn ratio_floor(numerator: u128, denominator: u128, shift: i32) -> (u128, bool) {
    let (mut quotient, mut remainder) = (numerator / denominator, numerator % denominator);
    if shift < 0 {
        let lost = shift.unsigned_abs();
        let down = quotient.checked_shr(lost).unwrap_or(0);
        return (down, remainder == 0 && down.checked_shl(lost).unwrap_or(0) == quotient);
    }
    for _ in 0..shift {
        // The denominator is below 2^71, so doubling the remainder cannot overflow.
        remainder <<= 1;
        quotient <<= 1;
        if remainder >= denominator {
            remainder -= denominator;
            quotient |= 1;
        }
    }
    (quotient, remainder == 0)
}

/// What f32 decides about a lag `d` in steps of `length_unit / 2^32`, whose coordinates were rounded to such steps. With
/// `t = d scale + offset`, which is the lag in bins from the first edge: outside the grid where `t` is not in
/// `[low, high]`, undecided within `guard` of an integer, else in bin `floor(t)`. Axes beyond the dimension have one bin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LagFilter {
    /// Bins per step.
    pub scale: [f32; 3],
    /// Bins from the first edge to lag 0.
    pub offset: [f32; 3],
    /// Surely outside below.
    pub low: [f32; 3],
    /// Surely outside above.
    pub high: [f32; 3],
    /// How far f32 and the rounded coordinates may be off, in bins.
    pub guard: [f32; 3],
}

impl LagFilter {
    fn new(grid: &LagGrid, domain: &Domain) -> Self {
        let mut filter = Self { scale: [0.0; 3], offset: [0.5; 3], low: [-1.0; 3], high: [2.0; 3], guard: [0.0; 3] };
        for axis in 0..grid.dim() {
            let b = grid.bins as f64;
            let half = grid.half[axis] / domain.length_unit() * 2f64.powi(32);
            let scale = b / (2.0 * half);
            // Two coordinates, a period and the side a lag is folded to are together off by less than 3 steps; and per operation of f32 (conversion, scale,
            // product, sum; devices may round twice as coarsely) a value of at most B is off by 2^-24 of itself.
            let guard = 3.0 * scale + 8.0 * b * 2f64.powi(-24);
            let hopeless = guard.is_nan() || guard > 0.25;
            let (scale, offset, high, guard) = if hopeless {
                // Bins of a few steps: f32 only tells what is far outside.
                (1.0 / (half + 4.0), 0.0, 1.0, 1.0)
            } else {
                (scale, b / 2.0, b + guard, guard)
            };
            filter.scale[axis] = scale as f32;
            filter.offset[axis] = offset as f32;
            filter.low[axis] = if hopeless { -1.0 } else { -guard as f32 };
            filter.high[axis] = high as f32;
            filter.guard[axis] = guard as f32;
        }
        filter
    }
}

/// The part of a lag ring within a sector: the cells whose centres lie in it, one of each mirror pair.
#[derive(Debug, Clone, PartialEq)]
pub struct LagSector {
    /// Inner radius, radius and outer radius of the ring, in length units.
    pub r: [f64; 3],
    /// First, central and last direction in radians from the x axis; opposite directions are the same.
    pub theta: [f64; 3],
    /// The cells, in rising order.
    pub cells: Vec<u32>,
}

/// Everything decided about counting pairs by their lag before any pair is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct LagPlan {
    /// The domain.
    pub domain: Domain,
    /// The grid.
    pub grid: LagGrid,
    /// The f32 filter in front of its thresholds.
    pub filter: LagFilter,
    /// `Translation`: expected counts follow the set covariance of the window; `None`: they do not.
    pub correction: Correction,
    /// Lag rings, along which g is followed round, sector by sector; 2D only.
    pub sectors: Vec<LagSector>,
    /// Number and size of realizations.
    pub shape: EnsembleShape,
    /// Realizations worked on at a time.
    pub batch: Batch,
}

impl LagPlan {
    /// Decides. `lag_rings`: radii, or `None` for half, 1 and 2 closest-packing distances as far as they fit.
    ///
    /// # Errors
    /// Numbers of bins, largest lags or radii of lag rings that cannot be in the domain, or do not fit into memory.
    pub fn new(
        domain: &Domain,
        grid: LagGrid,
        correction: Correction,
        lag_rings: Option<&[f64]>,
        shape: EnsembleShape,
    ) -> Result<Self> {
        match correction {
            Correction::None => {}
            other if domain.is_torus() => {
                return Err(Error::setting(Setting::Correction, other, "a torus has no edges; use none"));
            }
            Correction::Translation => {}
            other => {
                let reason = "the vector g is corrected by the set covariance of the window: use translation, or none";
                return Err(Error::setting(Setting::Correction, other, reason));
            }
        }
        let sectors = sectors(domain, &grid, lag_rings, shape)?;
        let filter = LagFilter::new(&grid, domain);
        // Points (three u64 axes twice) and a histogram, on the device and here.
        let batch = Batch::new(shape, shape.max_points * 48 + grid.cells() as u64 * 12);
        Ok(Self { domain: domain.clone(), grid, filter, correction, sectors, shape, batch })
    }

    /// Unordered pairs looked at in all realizations.
    pub fn pairs(&self) -> f64 {
        let n = self.shape.mean_points;
        self.shape.realizations as f64 * n * (n - 1.0).max(0.0) / 2.0
    }
}

/// The sectors of all lag rings, one after another. A lag ring is two cells wide (two longer sides of a cell). Sectors are centred on
/// multiples of pi / N, N a multiple of 4, so that the axes and the diagonals are centres and not borders.
fn sectors(domain: &Domain, grid: &LagGrid, lag_rings: Option<&[f64]>, shape: EnsembleShape) -> Result<Vec<LagSector>> {
    if domain.dim() != 2 {
        return match lag_rings {
            Some(r) => {
                let reason = format!("rings are followed round in 2D, the points have {} coordinates", domain.dim());
                Err(Error::setting(Setting::LagRings, numbers(r.iter().copied()), reason))
            }
            None => Ok(Vec::new()),
        };
    }
    let width = 2.0 * grid.width(0).max(grid.width(1));
    let (least, most) = (width / 2.0, grid.half[0].min(grid.half[1]) - width / 2.0);
    let fits = |r: f64| r > least && r <= most;
    let radii = match lag_rings {
        Some(radii) => {
            if let Some(&r) = radii.iter().find(|&&r| !fits(r)) {
                let reason = format!(
                    "rings are two cells wide ({width}) and fit into the grid of lags: expected more than {least} and \
                     at most {most}"
                );
                return Err(Error::setting(Setting::LagRings, number(r), reason));
            }
            radii.to_vec()
        }
        None => {
            let unit = domain.closest_packing_distance(shape.mean_points);
            DEFAULT_LAG_RINGS.map(|k| k * unit).into_iter().filter(|&r| fits(r)).collect()
        }
    };
    let pi = std::f64::consts::PI;
    let mut all = Vec::new();
    for r in radii {
        // About as wide as the ring.
        let count = ((pi * r / width) as usize).clamp(SECTORS[0], SECTORS[1]) / 4 * 4;
        let step = pi / count as f64;
        let annulus = [r - width / 2.0, r, r + width / 2.0];
        let first = all.len();
        all.extend((0..count).map(|s| {
            let theta = s as f64 * step;
            LagSector { r: annulus, theta: [theta - step / 2.0, theta, theta + step / 2.0], cells: Vec::new() }
        }));
        // Of each mirror pair the one with a direction in [0, pi), which is in the second half of the list or at its middle.
        for bx in 0..grid.bins {
            for by in grid.bins / 2..grid.bins {
                let cell = bx * grid.bins + by;
                let (x, y) = (grid.centre(cell, 0), grid.centre(cell, 1));
                if (y > 0.0 || x >= 0.0) && (annulus[0]..annulus[2]).contains(&x.hypot(y)) {
                    let sector = (y.atan2(x) / step + 0.5) as usize % count;
                    all[first + sector].cells.push(cell as u32);
                }
            }
        }
    }
    Ok(all)
}

impl fmt::Display for LagPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ranges: Vec<_> = self.grid.half.iter().map(|h| format!("[-{h}, {h})")).collect();
        let bins = vec![self.grid.bins.to_string(); self.grid.dim()];
        writeln!(
            f,
            "lag_counts: {:.3e} pairs, {} bins over lags {}",
            self.pairs(),
            bins.join(" x "),
            ranges.join(" x ")
        )?;
        writeln!(f, "  exact: f32 decides pairs clear of an edge, 64-bit integers the rest")?;
        writeln!(f, "  {}", self.batch)?;
        writeln!(f, "  skipped: half of the pairs (-h mirrors h)")?;
        match self.correction {
            Correction::None => writeln!(f, "  skipped: set covariance (not asked for or a torus)"),
            _ => writeln!(
                f,
                "  translation: expected counts are integrals of the window's set covariance over the cells"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_exact() {
        let unit = Domain::unit_torus(1);
        let of = |b, h| LagGrid::new(&unit, b, h).unwrap().thresholds.remove(0);
        assert_eq!(of(2, None), [-(1i128 << 63), 0, 1 << 63]);
        // -2^63 / 3 and 2^63 / 3 are no integers: the least integer at or above.
        let third = (1i128 << 63) / 3;
        assert_eq!(of(3, None), [-(1i128 << 63), -third, third + 1, 1 << 63]);
        assert_eq!(of(4, Some(0.25)), [-(1i128 << 62), -(1i128 << 61), 0, 1 << 61, 1 << 62]);
        assert_eq!(of(2, Some(2f64.powi(-66))), [0, 0, 1], "a quarter of a step");
        assert_eq!(of(1, Some(1e-300)), [0, 1]);
        // 0.1 is a little more than a tenth: its 53-bit integer times 2^(64 - 56).
        assert_eq!(of(1, Some(0.1))[1], 0x1999_9999_9999_9A00);
        // Half of an odd number of steps.
        assert_eq!(threshold(0.0, 1.0, Some(7), 0, 2), -3);
        assert_eq!(threshold(0.0, 1.0, Some(7), 2, 2), 4);
    }

    #[test]
    fn sectors_hold_one_of_each_mirror_pair() {
        let unit = Domain::unit_torus(2);
        let shape = EnsembleShape { realizations: 1, mean_points: 100.0, max_points: 100 };
        for bins in [20, 21] {
            let grid = LagGrid::new(&unit, bins, None).unwrap();
            let plan = LagPlan::new(&unit, grid, Correction::None, Some(&[0.2, 0.37]), shape).unwrap();
            for ring in plan.sectors.chunk_by(|a, b| a.r == b.r) {
                let mut seen: Vec<usize> = ring.iter().flat_map(|s| &s.cells).map(|&c| c as usize).collect();
                seen.extend(seen.clone().into_iter().map(|c| plan.grid.mirror(c)));
                seen.sort_unstable();
                let inside = |&c: &usize| {
                    let r = plan.grid.centre(c, 0).hypot(plan.grid.centre(c, 1));
                    (ring[0].r[0]..ring[0].r[2]).contains(&r)
                };
                let expected: Vec<usize> = (0..plan.grid.cells()).filter(inside).collect();
                assert_eq!(seen, expected, "{bins} bins");
            }
        }
    }
}
