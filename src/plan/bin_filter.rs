//! The f32 filter in front of exact integer binning: it decides every pair that is clear of a bin edge and hands the
//! rest to integer arithmetic. Shared by the CPU and the GPU kernels.
//!
//! A *slot* is the number of edges at or below a distance: 0 is below the first bin, `k + 1` is bin `k`, and
//! `bins + 1` is beyond the last. For an input `r2`, the f32 value of the squared distance in steps of
//! `length_unit / 2^32` (from coordinates rounded to 32 bits), the filter answers with an edge index `e` and a verdict:
//! slot `e` (below edge `e`), slot `e + 1` (at or above it), or *undecided*, to be settled by
//! `R2 >= thresholds[e]` in integers.
//!
//! How wrong can `r2` be? Rounding both coordinates to 32 bits moves each difference by at most one step, rounding the
//! period of a shorter side by half a step more, so `r` by at most `1.5 sqrt(dim)` steps: the absolute guard. Converting, squaring and adding in f32 costs at most 5 roundings of
//! 2^-24 relative in `r2`: the relative guard, doubled for devices whose sqrt is off by several ulp.

use super::{BinScale, RadialBins};
use crate::points::Domain;

/// How a kernel finds the slot of a pair.
#[derive(Debug, Clone, PartialEq)]
pub enum BinFilter {
    /// Equal bins from 0, wide against the guards: `t = sqrt(r2) * bins_per_step`, `e = round(t)`; beyond the last bin iff
    /// `t >= bins + 1/2`; undecided iff `e >= 1 && |t - e| <= relative_guard * t + absolute_guard`, else slot
    /// `floor(t) + 1`.
    Linear {
        /// Bins per step of `length_unit / 2^32`.
        bins_per_step: f32,
        /// Guard in units of `t`, relative.
        relative_guard: f32,
        /// Guard in bins, absolute.
        absolute_guard: f32,
    },
    /// Any edges: `cell = clamp((bits(r2) >> CELL_SHIFT) - first_cell)`, `e = cells[cell]`. If `e` has the
    /// `SEARCH` bit, several edges are near and the integer thresholds must be searched; else undecided iff
    /// `low[e] <= r2 && r2 <= high[e]`, else slot `e + (r2 > high[e])`.
    Table(BinTable),
}

/// The table of `BinFilter::Table`: cells of equal width in the *bits* of r2, 2^10 per octave of r2.
#[derive(Debug, Clone, PartialEq)]
pub struct BinTable {
    /// `bits(r2) >> CELL_SHIFT` of the first cell.
    pub first_cell: u32,
    /// The only edge that can be near, or `SEARCH`.
    pub cells: Vec<u32>,
    /// Per edge, in steps of 2^-32 squared: every `r2 < low` is surely below it.
    pub low: Vec<f32>,
    /// Per edge, above = `r2 > high`.
    pub high: Vec<f32>,
}

impl BinTable {
    /// Bits of an f32 dropped to get its cell: 2^10 cells per octave.
    pub const CELL_SHIFT: u32 = 13;
    /// Marks a cell near which several edges lie.
    pub const SEARCH: u32 = 1 << 31;

    /// The bin of `r2` (the number of bins for none); `None` where f32 does not decide it.
    pub fn bin(&self, r2: f32) -> Option<u32> {
        let cell = (r2.to_bits() >> Self::CELL_SHIFT).saturating_sub(self.first_cell) as usize;
        // The slot is the number of edges at or below, if no edge is in doubt.
        let slot = match self.cells[cell.min(self.cells.len() - 1)] {
            Self::SEARCH => self.high.partition_point(|&high| high < r2),
            edge => edge as usize + usize::from(self.high[edge as usize] < r2),
        };
        let decided = self.low.get(slot).is_none_or(|&low| r2 < low);
        decided.then(|| slot.wrapping_sub(1).min(self.low.len() - 1) as u32)
    }
}

/// Relative error bound of `t = sqrt(r2) * bins_per_step`, with a factor of two in hand (kernels differ in sqrt).
pub const RELATIVE_GUARD: f32 = 1e-6;

impl BinFilter {
    /// The filter for these bins in this domain.
    pub fn new(bins: &RadialBins, domain: &Domain) -> Self {
        let steps_per_length = 2f64.powi(32) / domain.length_unit();
        let displaced = Self::displaced(domain);
        let bins_per_step = bins.len() as f64 / (bins.r_max() * steps_per_length);
        let widest_guard = f64::from(RELATIVE_GUARD) * bins.len() as f64 + bins_per_step * displaced;
        // Beyond half a bin the nearest edge is not the only one in doubt; the table knows what to do then.
        if bins.scale() == BinScale::Linear && widest_guard < 0.45 {
            return Self::Linear {
                bins_per_step: bins_per_step as f32,
                relative_guard: RELATIVE_GUARD,
                absolute_guard: (bins_per_step * displaced) as f32 * 1.000_001,
            };
        }
        let (low, high): (Vec<f32>, Vec<f32>) = bins
            .edges()
            .iter()
            .map(|&edge| {
                let r = edge * steps_per_length;
                let g = f64::from(RELATIVE_GUARD);
                let low = (r * (1.0 - g) - displaced).max(0.0);
                let high = r * (1.0 + g) + displaced;
                // An edge at 0 has nothing below it: no r2 is < 0 or undecided about it.
                if edge == 0.0 { (-2.0, -1.0) } else { ((low * low) as f32, (high * high) as f32) }
            })
            .unzip();
        let first_positive = high.iter().copied().find(|&h| h > 0.0).unwrap_or(1.0);
        let first = low.iter().zip(&high).find(|(_, h)| **h > 0.0).map_or(first_positive, |(l, _)| *l);
        let cell_of = |r2: f32| r2.max(0.0).to_bits() >> BinTable::CELL_SHIFT;
        let first_cell = cell_of(first).saturating_sub(1);
        let last_cell = cell_of(high[bins.len()]) + 1;
        let cells = (first_cell..=last_cell)
            .map(|cell| {
                // Everything below the first cell and above the last is clamped into them.
                let from = if cell == first_cell { 0.0 } else { f32::from_bits(cell << BinTable::CELL_SHIFT) };
                let to = f32::from_bits(((cell + 1) << BinTable::CELL_SHIFT) - 1);
                let to = if cell == last_cell { f32::INFINITY } else { to };
                // Edges whose undecided band touches the cell.
                let begin = high.partition_point(|&h| h < from);
                let end = low.partition_point(|&l| l <= to);
                match end.saturating_sub(begin) {
                    // No edge: compare with the next one above (surely below) or, past the last, the last one.
                    0 => begin.min(bins.len()) as u32,
                    1 => begin as u32,
                    _ => BinTable::SEARCH,
                }
            })
            .collect();
        Self::Table(BinTable { first_cell, cells, low, high })
    }

    /// How far rounding coordinates to 32 bits moves a distance at most, in steps of `length_unit / 2^32`.
    pub fn displaced(domain: &Domain) -> f64 {
        let per_axis = if domain.periods().iter().all(|&p| p == 0) { 1.01 } else { 1.51 };
        (domain.dim() as f64).sqrt() * per_axis
    }

    /// What the filter says about `r2`: `Ok(slot)`, or `Err(Some(e))` to be settled at edge `e`, or `Err(None)` to be
    /// searched. The rule in plain code, tested against the edges themselves; the kernels unroll it, and are tested by
    /// their counts.
    ///
    /// # Errors
    /// The edge that is too near to decide by f32, or `None` where there is no bin.
    pub fn slot(&self, r2: f32, bins: usize) -> Result<usize, Option<usize>> {
        match self {
            Self::Linear { bins_per_step, relative_guard, absolute_guard } => {
                let t = r2.sqrt() * bins_per_step;
                // There is no edge beyond the last to be settled at, and half a bin is more than the guard.
                if t >= bins as f32 + 0.5 {
                    return Ok(bins + 1);
                }
                let e = t.round_ties_even();
                if e >= 1.0 && (t - e).abs() <= relative_guard * t + absolute_guard {
                    return Err(Some(e as usize));
                }
                Ok((t.floor() as usize + 1).min(bins + 1))
            }
            Self::Table(table) => {
                let cell = (r2.to_bits() >> BinTable::CELL_SHIFT).saturating_sub(table.first_cell);
                let e = table.cells[(cell as usize).min(table.cells.len() - 1)];
                if e == BinTable::SEARCH {
                    return Err(None);
                }
                let e = e as usize;
                if r2 < table.low[e] {
                    Ok(e)
                } else if r2 > table.high[e] {
                    Ok(e + 1)
                } else {
                    Err(Some(e))
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The filter's verdicts are right for every f32 near every edge, whatever the edges.
    #[test]
    fn verdicts_agree_with_the_edges() {
        let domain = Domain::unit_torus(3);
        let cases = [
            RadialBins::linear(0.5, 256).unwrap(),
            RadialBins::linear(1e-6, 3).unwrap(),
            RadialBins::linear(1e-9, 256).unwrap(),
            RadialBins::linear(0.5, 500_000).unwrap(),
            RadialBins::logarithmic(1e-3, 0.49, 24).unwrap(),
            RadialBins::logarithmic(1e-9, 0.5, 1000).unwrap(),
            RadialBins::from_edges(vec![0.0, 0.1, 0.100_000_1, 0.3]).unwrap(),
            RadialBins::from_edges(vec![0.2, 0.4]).unwrap(),
            RadialBins::from_edges((0..=1000).map(|k| 0.49 + f64::from(k) * 1e-5).collect()).unwrap(),
        ];
        let steps = 2f64.powi(32);
        for bins in &cases {
            let filter = BinFilter::new(bins, &domain);
            let mut settled = 0;
            let probes = bins.edges().iter().flat_map(|&e| {
                let offsets = [-0.3, -1e-2, -1e-4, -1e-5, -1e-6, -1e-7, 0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-2, 0.3, 40.0];
                offsets.map(move |o| e * (1.0 + o) * steps)
            });
            for r in probes.chain([0.0, 1.0, 2.0, 1e3, 2f64.powi(32)]) {
                let r2 = (r * r) as f32;
                let true_slot = bins.edges().partition_point(|&e| e * steps <= r);
                if let BinFilter::Table(table) = &filter {
                    let bin = table.bin(r2).map(|bin| bin as usize);
                    assert!(bin.is_none_or(|bin| bin == true_slot.wrapping_sub(1).min(bins.len())), "{r} in {bins:?}");
                }
                match filter.slot(r2, bins.len()) {
                    Ok(slot) => {
                        settled += 1;
                        assert_eq!(slot, true_slot, "r = {r} in {bins:?}");
                    }
                    Err(Some(e)) => assert!(true_slot == e || true_slot == e + 1, "edge {e}, r = {r} in {bins:?}"),
                    Err(None) => {}
                }
            }
            assert!(settled > 0, "the filter never decides anything for {bins:?}");
        }
    }
}
