//! Radial bins: the single owner of "which bin does a distance fall into".

use crate::error::{Error, Result};
use crate::named::named;
use crate::points::{Domain, mantissa_exponent};
use crate::setting::Setting;

/// How bin edges are spaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum BinScale {
    /// Equal widths from 0.
    Linear,
    /// Equal ratios.
    Log,
    /// Edges given one by one.
    #[cfg_attr(feature = "cli", value(skip))]
    Given,
}

named!(BinScale: Linear = "linear", Log = "log"; Given = "given");

/// Half-open bins `[edge_k, edge_(k+1))` over distances in the domain's own units.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct RadialBins {
    edges: Vec<f64>,
    scale: BinScale,
}

/// More bins than this are refused: their counts alone would not fit the memory budget of a batch.
pub const MAX_BINS: usize = 1 << 20;

impl RadialBins {
    /// `bins` equal bins over `[0, r_max)`.
    ///
    /// # Errors
    /// Edges that do not increase, are negative or not finite; too many bins.
    pub fn linear(r_max: f64, bins: usize) -> Result<Self> {
        check_count(bins)?;
        let edges = (0..=bins).map(|k| r_max * (k as f64 / bins as f64)).collect();
        Self::checked(edges, BinScale::Linear)
    }

    /// `bins` bins of equal ratio over `[r_min, r_max)`.
    ///
    /// # Errors
    /// Edges that do not increase, are negative or not finite; too many bins.
    pub fn logarithmic(r_min: f64, r_max: f64, bins: usize) -> Result<Self> {
        check_count(bins)?;
        let ratio = r_max / r_min;
        let mut edges: Vec<f64> = (0..=bins).map(|k| r_min * ratio.powf(k as f64 / bins as f64)).collect();
        edges[bins] = r_max;
        Self::checked(edges, BinScale::Log)
    }

    /// Bins with the given edges. Edges that are equal steps from 0 are recognised as linear.
    ///
    /// # Errors
    /// Edges that do not increase, are negative or not finite; too many bins.
    pub fn from_edges(edges: Vec<f64>) -> Result<Self> {
        if edges.len() < 2 {
            return Err(Error::setting(Setting::Edges, edges.len(), "at least two edges are needed"));
        }
        check_count(edges.len() - 1)?;
        let mut bins = Self::checked(edges, BinScale::Given)?;
        let (n, last) = (bins.len() as f64, bins.r_max());
        // The tolerance is far inside the guard band within which the filter decides in integers anyway.
        if bins.edges.iter().enumerate().all(|(k, e)| (e - last * (k as f64 / n)).abs() <= 1e-12 * last) {
            bins.scale = BinScale::Linear;
        }
        Ok(bins)
    }

    fn checked(edges: Vec<f64>, scale: BinScale) -> Result<Self> {
        let setting = if scale == BinScale::Given { Setting::Edges } else { Setting::RMax };
        for (k, pair) in edges.windows(2).enumerate() {
            // Written so that NaN fails.
            if !(pair[0] >= 0.0 && pair[1] > pair[0] && pair[1].is_finite()) {
                let reason = format!(
                    "edges must be finite, at least 0 and strictly increasing; edge {} is {:e}, edge {} is {:e}",
                    k,
                    pair[0],
                    k + 1,
                    pair[1]
                );
                return Err(Error::setting(setting, format!("{:e}", pair[1]), reason));
            }
        }
        Ok(Self { edges, scale })
    }

    /// How the edges are spaced.
    pub fn scale(&self) -> BinScale {
        self.scale
    }

    /// All edges, one more than there are bins.
    pub fn edges(&self) -> &[f64] {
        &self.edges
    }

    /// The centre of each bin.
    pub fn centres(&self) -> Vec<f64> {
        self.edges.windows(2).map(|e| 0.5 * (e[0] + e[1])).collect()
    }

    /// Number of bins.
    pub fn len(&self) -> usize {
        self.edges.len() - 1
    }

    /// Never: there is at least one bin.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Upper end of the last bin.
    pub fn r_max(&self) -> f64 {
        self.edges[self.len()]
    }

    /// Exact measure of the shell between the edges of bin `k`: length of two intervals, area of a ring, volume of a
    /// spherical shell. (The circumference is 2 pi r in 2D.)
    pub fn shell_measure(&self, k: usize, dim: usize) -> f64 {
        let (lo, hi) = (self.edges[k], self.edges[k + 1]);
        let pi = std::f64::consts::PI;
        // Factored differences keep their digits where the edges are close.
        match dim {
            1 => 2.0 * (hi - lo),
            2 => pi * (hi - lo) * (hi + lo),
            _ => 4.0 / 3.0 * pi * (hi - lo) * (hi * hi + hi * lo + lo * lo),
        }
    }

    /// Integer thresholds: a squared distance `R2` in fixed-point steps is at or beyond edge `k` iff
    /// `R2 >= thresholds[k]`, where `thresholds[k] = ceil((2^64 edge_k / length_unit)^2)`, exactly.
    ///
    /// # Errors
    /// Edges too near to each other to be told apart in steps of the domain.
    pub fn thresholds(&self, domain: &Domain) -> Result<Vec<u128>> {
        let unit = domain.length_unit();
        self.edges
            .iter()
            .map(|&edge| {
                squared_ratio_ceil(edge, unit).ok_or_else(|| {
                    let reason = format!("is beyond the longest distance in a box with length unit {unit}");
                    Error::setting(Setting::RMax, edge, reason)
                })
            })
            .collect()
    }
}

fn check_count(bins: usize) -> Result<()> {
    if (1..=MAX_BINS).contains(&bins) {
        return Ok(());
    }
    Err(Error::setting(Setting::Bins, bins, format!("expected 1 to {MAX_BINS}")))
}

/// `ceil(2^128 (r / unit)^2)`, or `None` where that needs more than 128 bits. Exact: both are integers times powers
/// of two, so the quotient is found by long division, one bit at a time.
fn squared_ratio_ceil(r: f64, unit: f64) -> Option<u128> {
    if r == 0.0 {
        return Some(0);
    }
    let ((a, ea), (b, eb)) = (mantissa_exponent(r), mantissa_exponent(unit));
    // r^2 2^128 / unit^2 = (a/b)^2 2^shift
    let shift = 2 * (ea - eb) + 128;
    let (num, den) = (u128::from(a) * u128::from(a), u128::from(b) * u128::from(b));
    let (mut quotient, mut remainder) = (num / den, num % den);
    if shift < 0 {
        // Far below one step: num/den < 2^54, so shifting right loses only what the ceiling puts back.
        let lost = shift.unsigned_abs();
        let down = if lost >= 128 { 0 } else { quotient >> lost };
        let exact = remainder == 0 && lost < 128 && (down << lost) == quotient;
        return Some(if exact { down } else { down + 1 });
    }
    for _ in 0..shift {
        if quotient >> 127 != 0 {
            return None;
        }
        // den < 2^106, so doubling the remainder cannot overflow.
        remainder <<= 1;
        quotient <<= 1;
        if remainder >= den {
            remainder -= den;
            quotient |= 1;
        }
    }
    if remainder == 0 { Some(quotient) } else { quotient.checked_add(1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_of_dyadic_edges_are_exact() {
        let domain = Domain::unit_torus(2);
        let bins = RadialBins::from_edges(vec![0.0, 0.25, 0.5]).unwrap();
        assert_eq!(bins.thresholds(&domain).unwrap(), vec![0, 1 << 124, 1 << 126]);
        assert_eq!(squared_ratio_ceil(3.0, 3.0), None, "2^128 itself does not fit");
        assert_eq!(squared_ratio_ceil(1.0, 3.0), Some(u128::MAX / 9 + 1), "ceil(2^128 / 9)");
        assert_eq!(squared_ratio_ceil(1e-200, 1.0), Some(1));
        assert_eq!(squared_ratio_ceil(2f64.powi(-64), 1.0), Some(1));
        assert_eq!(squared_ratio_ceil(f64::from_bits(2f64.powi(-64).to_bits() + 1), 1.0), Some(2));
    }

    #[test]
    fn equal_steps_are_recognised_as_linear() {
        let edges = (0..=50).map(|k| f64::from(k) * 0.002).collect();
        assert_eq!(RadialBins::from_edges(edges).unwrap().scale(), BinScale::Linear);
        assert_eq!(RadialBins::from_edges(vec![0.0, 0.1, 0.3]).unwrap().scale(), BinScale::Given);
    }
}
