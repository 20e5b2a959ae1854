//! Points of the unit torus in cells, for the distance to the nearest.

use super::torus_cells::distance_squared;

/// Points of the torus, which may be added and moved, in cells of a few each.
pub(super) struct TorusNearest<const D: usize> {
    points: Vec<[f64; D]>,
    per_axis: usize,
    cells: Vec<Vec<u32>>,
}

impl<const D: usize> TorusNearest<D> {
    /// Without points yet.
    pub(super) fn new() -> Self {
        Self::with_cells(1)
    }

    fn with_cells(per_axis: usize) -> Self {
        Self { points: Vec::new(), per_axis, cells: vec![Vec::new(); per_axis.pow(D as u32)] }
    }

    /// The points in the order in which they were added.
    pub(super) fn points(&self) -> &[[f64; D]] {
        &self.points
    }

    fn home(&self, point: &[f64; D]) -> [usize; D] {
        // `per_axis` is a power of 2: the product is exact.
        point.map(|x| (x * self.per_axis as f64) as usize)
    }

    fn cell(&self, point: &[f64; D]) -> usize {
        self.home(point).iter().rev().fold(0, |cell, h| cell * self.per_axis + h)
    }

    /// Adds a point.
    pub(super) fn push(&mut self, point: [f64; D]) {
        if self.points.len() > 4 * self.cells.len() {
            // Twice as many cells along every axis.
            let old = std::mem::replace(self, Self::with_cells(2 * self.per_axis));
            old.points.into_iter().for_each(|point| self.push(point));
        }
        self.points.push(point);
        self.put_back(self.points.len() - 1, point);
    }

    /// Takes point `i` out until it is put back.
    pub(super) fn take_out(&mut self, i: usize) {
        let cell = self.cell(&self.points[i]);
        self.cells[cell].retain(|&j| j as usize != i);
    }

    /// Puts point `i`, which was taken out, elsewhere.
    pub(super) fn put_back(&mut self, i: usize, point: [f64; D]) {
        self.points[i] = point;
        let cell = self.cell(&point);
        self.cells[cell].push(i as u32);
    }

    /// The square of the distance to the nearest, or of one that is at most `enough` away.
    pub(super) fn nearest2(&self, place: &[f64; D], enough: f64) -> f64 {
        let home = self.home(place);
        let side = 1.0 / self.per_axis as f64;
        let mut found = f64::INFINITY;
        // Cells in shells about the home, until what is beyond cannot be nearer; the last shell meets itself around the torus.
        for shell in 0..=(self.per_axis / 2) as i64 {
            let inner = (shell - 1) as f64 * side;
            if shell > 0 && inner > 0.0 && inner * inner > found {
                break;
            }
            self.each_of_shell(&home, shell, |cell| {
                for &j in &self.cells[cell] {
                    found = found.min(distance_squared(place, &self.points[j as usize]));
                }
                found <= enough
            });
            if found <= enough {
                break;
            }
        }
        found
    }

    /// The cells at a largest offset of `shell` from `home`, until one says that it is enough.
    fn each_of_shell(&self, home: &[usize; D], shell: i64, mut visit: impl FnMut(usize) -> bool) {
        let width = 2 * shell + 1;
        for at in 0..width.pow(D as u32) {
            let mut rest = at;
            let offset: [i64; D] = std::array::from_fn(|_| {
                let offset = rest % width - shell;
                rest /= width;
                offset
            });
            if offset.iter().all(|o| o.abs() < shell) {
                continue;
            }
            let m = self.per_axis as i64;
            let cell = (0..D).rev().fold(0, |cell, k| cell * m + (home[k] as i64 + offset[k]).rem_euclid(m));
            if visit(cell as usize) {
                return;
            }
        }
    }
}
