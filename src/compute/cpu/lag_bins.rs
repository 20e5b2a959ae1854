//! The inner loop of lag counting: plain Rust that the compiler vectorizes, once per instruction set. `unsafe` are calls
//! across a `target_feature` boundary, made after asking the processor.

#![cfg_attr(
    target_arch = "x86_64",
    expect(unsafe_code, reason = "calls into functions for a detected instruction set")
)]

use std::ops::Range;

use super::pair_rows::{COLUMNS, LANES};
use super::simd::SimdLevel;
use crate::plan::{LagFilter, LagGrid};

/// 1.5 * 2^23: adding and subtracting it rounds to the nearest integer, which its lower bits then hold.
const ROUND: f32 = 12_582_912.0;

/// The filter with what turns bins into places of a histogram.
pub(super) struct Places {
    filter: LagFilter,
    strides: [u32; 3],
    /// Pairs outside the grid and undecided ones are counted from here on, at places that differ between lanes, since
    /// increments of one counter wait for each other.
    dump: u32,
}

impl Places {
    pub(super) fn new(filter: &LagFilter, grid: &LagGrid) -> Self {
        Self { filter: *filter, strides: grid.strides().map(|s| s as u32), dump: grid.cells() as u32 }
    }

    /// Counters a histogram needs.
    pub(super) fn counters(&self) -> usize {
        self.dump as usize + LANES
    }
}

/// The unordered pairs (i in `rows`, j in `columns`, i < j) of points with 32-bit coordinates.
pub(super) struct Rows<'a> {
    /// Per axis, the coordinates, with `LANES` more behind the last column.
    pub(super) axes: &'a [&'a [u32]],
    /// Per axis, the period; 0 stands for 2^32.
    pub(super) periods: [u32; 3],
    pub(super) rows: Range<usize>,
    /// At most `COLUMNS` of them.
    pub(super) columns: Range<usize>,
}

/// Runs `$f::<D, UNEQUAL>` for the number of axes at hand.
macro_rules! by_shape {
    ($job:expr, $f:ident, $($arg:expr),*) => {
        match ($job.axes.len(), $job.periods == [0; 3]) {
            (1, true) => $f::<1, false>($($arg),*),
            (2, true) => $f::<2, false>($($arg),*),
            (_, true) => $f::<3, false>($($arg),*),
            (1, false) => $f::<1, true>($($arg),*),
            (2, false) => $f::<2, true>($($arg),*),
            (_, false) => $f::<3, true>($($arg),*),
        }
    };
}

/// Counts the lags `x_j - x_i` that are clear of an edge into `histogram`, and lists the pairs whose lag is not.
pub(super) fn count(
    level: SimdLevel,
    job: &Rows<'_>,
    places: &Places,
    histogram: &mut [u32],
    undecided: &mut Vec<(u32, u32)>,
) {
    assert!(job.columns.len() <= COLUMNS, "a piece fits the buffer");
    assert!(histogram.len() >= places.counters(), "places for pairs outside");
    match level {
        // SAFETY: the level was detected.
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx512 => unsafe { by_shape!(job, count_avx512, job, places, histogram, undecided) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        SimdLevel::Avx2 => unsafe { by_shape!(job, count_avx2, job, places, histogram, undecided) },
        _ => by_shape!(job, count_any, job, places, histogram, undecided),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn count_avx512<const D: usize, const UNEQUAL: bool>(
    job: &Rows<'_>,
    places: &Places,
    histogram: &mut [u32],
    undecided: &mut Vec<(u32, u32)>,
) {
    count_any::<D, UNEQUAL>(job, places, histogram, undecided);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn count_avx2<const D: usize, const UNEQUAL: bool>(
    job: &Rows<'_>,
    places: &Places,
    histogram: &mut [u32],
    undecided: &mut Vec<(u32, u32)>,
) {
    count_any::<D, UNEQUAL>(job, places, histogram, undecided);
}

#[inline(always)]
fn count_any<const D: usize, const UNEQUAL: bool>(
    job: &Rows<'_>,
    places: &Places,
    histogram: &mut [u32],
    undecided: &mut Vec<(u32, u32)>,
) {
    let (f, dump) = (&places.filter, places.dump);
    let mut slots = [[0u32; LANES]; COLUMNS / LANES + 1];
    // Where groups with undecided pairs begin, and which of them: kept for later, so that the loop has no branches.
    let mut flagged = [(0usize, [0u32; LANES]); COLUMNS / LANES + 1];
    for i in job.rows.clone() {
        let first = job.columns.start.max(i + 1);
        let len = job.columns.end.saturating_sub(first);
        let own: [u32; D] = std::array::from_fn(|k| job.axes[k][i]);
        // Groups kept, because a pair of theirs is within the grid, and groups with undecided pairs.
        let (mut groups, mut flags) = (0, 0);
        for begin in (0..len).step_by(LANES) {
            let (mut place, mut near) = ([0u32; LANES], [0u32; LANES]);
            // Lanes past the last column are outside.
            let mut outside: [u32; LANES] = std::array::from_fn(|l| u32::from(l >= len - begin));
            for (k, &own) in own.iter().enumerate() {
                let others = &job.axes[k][first + begin..first + begin + LANES];
                for l in 0..LANES {
                    let mut d = others[l].wrapping_sub(own);
                    if UNEQUAL {
                        let period = job.periods[k];
                        d = d.wrapping_add(if others[l] < own { period } else { 0 });
                        let back = period.wrapping_sub(d);
                        d = if d >= back { d.wrapping_sub(period) } else { d };
                    }
                    let t = d as i32 as f32 * f.scale[k] + f.offset[k];
                    let shifted = t + ROUND;
                    let above = t - (shifted - ROUND);
                    let bin = (shifted.to_bits().wrapping_sub(ROUND.to_bits())).wrapping_sub(u32::from(above < 0.0));
                    place[l] = place[l].wrapping_add(bin.wrapping_mul(places.strides[k]));
                    outside[l] |= u32::from((t < f.low[k]) | (t > f.high[k]));
                    near[l] |= u32::from(above.abs() <= f.guard[k]);
                }
            }
            let (mut any_inside, mut any_near) = (0, 0);
            let slots = &mut slots[groups];
            for l in 0..LANES {
                near[l] &= !outside[l];
                any_inside |= 1 - outside[l];
                any_near |= near[l];
                slots[l] = if (outside[l] | near[l]) != 0 { dump + l as u32 } else { place[l] };
            }
            groups += any_inside as usize;
            flagged[flags] = (begin, near);
            flags += any_near as usize;
        }
        for (begin, near) in &flagged[..flags] {
            for (l, &near) in near.iter().enumerate() {
                if near != 0 {
                    undecided.push((i as u32, (first + begin + l) as u32));
                }
            }
        }
        for &slot in slots[..groups].as_flattened() {
            let count = &mut histogram[slot as usize];
            *count = count.wrapping_add(1);
        }
    }
}
