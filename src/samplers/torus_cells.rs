//! Points of the unit torus in cells, for asking which are near a place.

/// Points in cells at least as wide as a distance, so that only a cell and its neighbours need be searched.
pub(super) struct TorusCells<const D: usize> {
    pub(super) points: Vec<[f64; D]>,
    per_axis: usize,
    /// The last point of each cell and the one before each point, as index + 1; 0 ends a list.
    last: Vec<u32>,
    before: Vec<u32>,
    distance_squared: f64,
}

impl<const D: usize> TorusCells<D> {
    /// For about `n` points and a distance.
    pub(super) fn new(n: usize, distance: f64) -> Self {
        // No more cells than about points, however small the distance.
        let by_number = (n as f64).powf(1.0 / D as f64).ceil();
        let per_axis = (1.0 / distance).floor().min(by_number).max(1.0) as usize;
        Self {
            points: Vec::with_capacity(n),
            per_axis,
            last: vec![0; per_axis.pow(D as u32)],
            before: Vec::with_capacity(n),
            // Differences of multiples of 2^-53 are exact; their squared sum is off by at most 2 ulp, so that with this
            // margin no pair that counts as far is closer than `distance`, exactly.
            distance_squared: distance * distance * (1.0 + 4.0 * f64::EPSILON),
        }
    }

    fn home(&self, point: &[f64; D]) -> [usize; D] {
        // `per_axis` times the largest f64 below 1 may round to `per_axis`.
        point.map(|x| ((x * self.per_axis as f64) as usize).min(self.per_axis - 1))
    }

    /// Adds a point.
    pub(super) fn push(&mut self, point: [f64; D]) {
        let home = self.home(&point);
        let cell = home.iter().rev().fold(0, |cell, h| cell * self.per_axis + h);
        self.points.push(point);
        self.before.push(self.last[cell]);
        self.last[cell] = self.points.len() as u32;
    }

    /// Whether a point closer to `place` than the distance passes a test, which is handed its index.
    pub(super) fn any_near(&self, place: &[f64; D], mut test: impl FnMut(usize) -> bool) -> bool {
        let home = self.home(place);
        // With fewer than three cells per axis, all of them are neighbours, once each.
        let width = self.per_axis.min(3);
        (0..width.pow(D as u32)).any(|neighbour| {
            let (mut rest, mut cell, mut stride) = (neighbour, 0, 1);
            for h in home {
                cell += (h + self.per_axis - 1 + rest % width) % self.per_axis * stride;
                rest /= width;
                stride *= self.per_axis;
            }
            let mut next = self.last[cell] as usize;
            while next != 0 {
                if distance_squared(place, &self.points[next - 1]) < self.distance_squared && test(next - 1) {
                    return true;
                }
                next = self.before[next - 1] as usize;
            }
            false
        })
    }
}

/// On the unit torus.
pub(super) fn distance_squared<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let along = |k: usize| {
        let d = (a[k] - b[k]).abs();
        d.min(1.0 - d)
    };
    (0..D).map(|k| along(k) * along(k)).sum()
}
