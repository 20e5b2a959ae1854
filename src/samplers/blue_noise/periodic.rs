//! Delaunay triangulations of points on the unit torus: the points with the images that lie near the box.

use spade::{HasPosition, Point2};

/// A point of the torus or an image of one.
#[derive(Clone, Copy)]
pub(super) struct Site {
    pub(super) position: Point2<f64>,
    /// The index of a point in the box; none for images.
    pub(super) own: Option<u32>,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// Below so many points all nine copies are taken.
pub(super) const FEW: usize = 30;

/// How far out images are taken at first: more than the circles of a random pattern reach.
pub(super) fn margin(n: usize) -> f64 {
    if n < FEW { 1.0 } else { (4.0 / (n as f64).sqrt()).min(1.0) }
}

/// A point and its images within `margin` of the box.
pub(super) fn copies(index: u32, [x, y]: [f64; 2], margin: f64) -> impl Iterator<Item = Site> {
    let shifts = [0.0, -1.0, 1.0];
    let near = move |x: f64| (-margin..=1.0 + margin).contains(&x);
    shifts.into_iter().flat_map(move |dx| shifts.into_iter().map(move |dy| (dx, dy))).filter_map(move |(dx, dy)| {
        let own = (dx == 0.0 && dy == 0.0).then_some(index);
        (near(x + dx) && near(y + dy)).then(|| Site { position: Point2::new(x + dx, y + dy), own })
    })
}
