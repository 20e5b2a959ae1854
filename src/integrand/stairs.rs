//! The map whose density is constant on cells: tables of sums, without any error.

/// Sums of the values of cells along each axis, of all behind it, and the inverse of what they say.
pub(super) struct Stairs {
    shape: [usize; 3],
    /// Along the last axis of each row of cells, along the second of each plane, along the first: one more than cells, from 0.
    sums: [Vec<f64>; 3],
}

impl Stairs {
    /// `values` with the last axis fastest, none below 0.
    pub(super) fn new(shape: [usize; 3], values: &[f64]) -> Self {
        let rising = |totals: &[f64], side: usize| -> Vec<f64> {
            let row = |row: &[f64]| {
                let mut sums = vec![0.0; side + 1];
                row.iter().enumerate().for_each(|(i, v)| sums[i + 1] = sums[i] + v);
                sums
            };
            totals.chunks_exact(side).flat_map(row).collect()
        };
        let ends =
            |sums: &[f64], side: usize| -> Vec<f64> { sums.chunks_exact(side + 1).map(|row| row[side]).collect() };
        let third = rising(values, shape[2]);
        let second = rising(&ends(&third, shape[2]), shape[1]);
        let first = rising(&ends(&second, shape[1]), shape[0]);
        Self { shape, sums: [first, second, third] }
    }

    pub(super) fn place(&self, u: [f64; 3]) -> [f64; 3] {
        let mut x = [0.0; 3];
        let mut row = 0;
        for k in 0..3 {
            let side = self.shape[k];
            if side == 1 {
                // An axis that the box lacks is 0 anyway; one of a single cell is uniform.
                x[k] = u[k];
                continue;
            }
            let sums = &self.sums[k][row * (side + 1)..(row + 1) * (side + 1)];
            let (cell, part) = pick(sums, u[k]);
            x[k] = inside(cell, part, side);
            row = row * side + cell;
        }
        x
    }
}

/// The cell where sums from 0 reach the part `v` of their last, never one of no value, and how far into it.
pub(super) fn pick(sums: &[f64], v: f64) -> (usize, f64) {
    let cells = sums.len() - 1;
    let target = v * sums[cells];
    let after = sums.partition_point(|sum| *sum <= target).clamp(1, cells);
    // Rounding may reach the end, where cells may have no value.
    let after =
        if target >= sums[cells] { sums.partition_point(|sum| *sum < sums[cells]).clamp(1, cells) } else { after };
    let (from, to) = (sums[after - 1], sums[after]);
    (after - 1, if to > from { ((target - from) / (to - from)).clamp(0.0, 1.0) } else { v })
}

/// A place in cell `cell` of `side` that is looked up as one of that cell.
fn inside(cell: usize, part: f64, side: usize) -> f64 {
    let n = side as f64;
    let mut x = (cell as f64 + part) / n;
    while ((x * n) as usize) < cell {
        x = x.next_up();
    }
    while (x * n) as usize > cell {
        x = x.next_down();
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_no_value_are_never_picked() {
        let sums = [0.0, 0.0, 1.0, 1.0, 3.0, 3.0];
        assert_eq!(pick(&sums, 0.0), (1, 0.0));
        assert_eq!(pick(&sums, 1.0 / 3.0), (3, 0.0));
        assert_eq!(pick(&sums, 2.0 / 3.0), (3, 0.5));
        assert_eq!(pick(&sums, 1.0), (3, 1.0));
        for side in 1..200 {
            for cell in 0..side {
                for part in [0.0, 0.3, 1.0] {
                    assert_eq!((inside(cell, part, side) * side as f64) as usize, cell, "{cell} of {side}");
                }
            }
        }
    }
}
