//! Matrix products by `gemm`. The only place that hands it pointers.

#![expect(unsafe_code, reason = "gemm takes pointers; all lengths are asserted just before")]

use gemm_common::Parallelism;

/// Points of a product: below, `gemm` has other kernels for some widths; above, it cuts the sum.
pub(super) const FEWEST_POINTS: usize = 3;
const MOST_POINTS: usize = 512;

/// A product of `gemm`: rows, columns and depth, then each matrix with its steps from column to column and row to row.
type Gemm<T> = unsafe fn(
    usize,
    usize,
    usize,
    *mut T,
    isize,
    isize,
    bool,
    *const T,
    isize,
    isize,
    *const T,
    isize,
    isize,
    T,
    T,
    bool,
    bool,
    bool,
    Parallelism,
);

/// What is multiplied here.
pub(super) trait Element: Copy + 'static {
    const ONE: Self;

    /// The best product for this processor.
    fn gemm() -> Gemm<Self>;
}

impl Element for f32 {
    const ONE: Self = 1.0;

    fn gemm() -> Gemm<Self> {
        gemm_f32::gemm::f32::get_gemm_fn()
    }
}

impl Element for f64 {
    const ONE: Self = 1.0;

    fn gemm() -> Gemm<Self> {
        gemm_f64::gemm::f64::get_gemm_fn()
    }
}

/// A table with `width` values at each point, `stride` values from one point to the next.
#[derive(Clone, Copy)]
pub(super) struct Operand<'a, T> {
    pub(super) values: &'a [T],
    pub(super) stride: usize,
    pub(super) width: usize,
}

impl<T> Operand<'_, T> {
    fn holds(&self, points: usize) -> bool {
        let end = points.saturating_sub(1).checked_mul(self.stride).and_then(|last| last.checked_add(self.width));
        self.width <= self.stride && end.is_some_and(|end| end <= self.values.len())
    }
}

/// Writes `out[row * right.width + column]`: the sum over points of `left` at `row` times `right` at `column`, added to
/// what is there if `add`. Each sum is one chain of multiply-adds in the order of points, whatever the widths (2 or
/// more).
pub(super) fn product<T: Element>(
    left: Operand<'_, T>,
    right: Operand<'_, T>,
    points: usize,
    out: &mut [T],
    add: bool,
) {
    let columns = right.width;
    assert!((FEWEST_POINTS..=MOST_POINTS).contains(&points) && left.width.min(columns) >= 2, "one chain per sum");
    assert!(left.holds(points) && right.holds(points), "operands hold all points");
    assert!(left.width.checked_mul(columns).is_some_and(|len| len <= out.len()), "the result fits");
    // SAFETY: all that `gemm` reads and writes lies within the lengths just asserted; `out` is borrowed alone.
    unsafe {
        // Columns first: the transposed product, whose rows lie side by side.
        T::gemm()(
            columns,
            left.width,
            points,
            out.as_mut_ptr(),
            columns as isize,
            1,
            add,
            right.values.as_ptr(),
            right.stride as isize,
            1,
            left.values.as_ptr(),
            1,
            left.stride as isize,
            T::ONE,
            T::ONE,
            false,
            false,
            false,
            Parallelism::None,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(points: usize, stride: usize, seed: f64) -> Vec<f64> {
        (0..points * stride).map(|k| (seed + k as f64 * 0.618).sin()).collect()
    }

    /// The product of the whole tables, and of any part of them, is the same bit for bit, and right.
    fn parts_equal_the_whole<T: Element + PartialEq + Default + std::fmt::Debug + Into<f64>>(
        convert: fn(f64) -> T,
        error: f64,
    ) {
        for points in [3, 4, 5, 63, 192, 512] {
            let (rows, columns, stride) = (67, 150, 160);
            let [left, right] = [1.0, 2.0].map(|seed| table(points, stride, seed).into_iter().map(convert).collect());
            let (left, right): (Vec<T>, Vec<T>) = (left, right);
            let multiply = |row: usize, height: usize, column: usize, width: usize, add: bool| {
                let mut out = vec![T::default(); height * width];
                let left = Operand { values: &left[row..], stride, width: height };
                let right = Operand { values: &right[column..], stride, width };
                product(left, right, points, &mut out, add);
                out
            };
            let whole = multiply(0, rows, 0, columns, false);
            for (k, &value) in whole.iter().enumerate() {
                let (row, column) = (k / columns, k % columns);
                let truth: f64 =
                    (0..points).map(|p| left[p * stride + row].into() * right[p * stride + column].into()).sum();
                assert!((value.into() - truth).abs() <= error * points as f64, "{row}, {column} of {points} points");
            }
            for (row, height, column, width) in
                [(0, 2, 0, 16), (3, 48, 16, 16), (5, 62, 0, 150), (0, 7, 48, 64), (9, 2, 9, 2), (1, 66, 3, 33)]
            {
                for add in [false, true] {
                    let part = multiply(row, height, column, width, add);
                    for (k, part) in part.into_iter().enumerate() {
                        let at = (row + k / width) * columns + column + k % width;
                        assert_eq!(part, whole[at], "{points} points, {height} x {width} from {row}, {column}");
                    }
                }
            }
        }
    }

    #[test]
    fn widths_do_not_change_a_bit() {
        parts_equal_the_whole(|x| x as f32, 1e-6);
        parts_equal_the_whole(|x| x, 1e-15);
    }
}
