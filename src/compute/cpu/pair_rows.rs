//! Rows of pairs: one point against a piece of the points that follow, in coordinates of 32 bits. `histogram_rows` and `r2_rows`
//! are the inner loops over them, once per instruction set.

use std::ops::Range;

/// Columns a row kernel takes at a time.
pub(super) const COLUMNS: usize = 1024;

/// Most lanes any kernel uses; rounded coordinates have this much padding behind them.
pub(super) const LANES: usize = 16;

/// The pairs (i in `rows`, o in `0..columns`) of points with 32-bit coordinates.
pub(super) struct Rows<'a> {
    /// Per axis, the coordinates that `rows` index.
    pub(super) own: &'a [&'a [u32]],
    pub(super) rows: Range<usize>,
    /// Per axis, the coordinates of the columns, and `LANES` more behind the last one.
    pub(super) others: &'a [&'a [u32]],
    /// At most `COLUMNS` of them.
    pub(super) columns: usize,
    /// The columns begin with the rows themselves: of these, only pairs with later ones.
    pub(super) triangle: bool,
    /// Per axis, the period; 0 stands for 2^32.
    pub(super) periods: [u32; 3],
}

impl Rows<'_> {
    /// The first column of row `i`.
    #[inline(always)]
    pub(super) fn first(&self, i: usize) -> usize {
        if self.triangle { i - self.rows.start + 1 } else { 0 }
    }
}

/// A pair f32 cannot decide (a row and a column), and a bin at the edge in question.
#[derive(Debug, Clone, Copy)]
pub(super) struct Undecided {
    pub(super) i: u32,
    pub(super) column: u32,
    pub(super) place: u32,
}

/// Squared distance in f32, in squared steps of 2^-32.
#[inline(always)]
pub(super) fn squared<const D: usize, const UNEQUAL: bool>(a: [u32; D], b: [u32; D], periods: [u32; 3]) -> f32 {
    let mut r2 = 0.0;
    for k in 0..D {
        let d = if UNEQUAL {
            let apart = a[k].abs_diff(b[k]);
            apart.min(periods[k].wrapping_sub(apart)) as i32
        } else {
            a[k].wrapping_sub(b[k]) as i32
        };
        let d = d as f32;
        r2 += d * d;
    }
    r2
}

/// Runs `$f::<D, UNEQUAL>` for the number of axes at hand.
macro_rules! by_shape {
    ($job:expr, $f:ident $([$($rule:tt),*])?, $($arg:expr),*) => {
        match ($job.own.len(), $job.periods == [0; 3]) {
            (1, true) => $f::<1, false $($(, $rule)*)?>($($arg),*),
            (2, true) => $f::<2, false $($(, $rule)*)?>($($arg),*),
            (_, true) => $f::<3, false $($(, $rule)*)?>($($arg),*),
            (1, false) => $f::<1, true $($(, $rule)*)?>($($arg),*),
            (2, false) => $f::<2, true $($(, $rule)*)?>($($arg),*),
            (_, false) => $f::<3, true $($(, $rule)*)?>($($arg),*),
        }
    };
}
pub(super) use by_shape;
