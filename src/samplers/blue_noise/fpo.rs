//! Farthest-point optimization (Schlomer, Heck, Deussen, "Farthest-point optimized point sets with maximized minimum distance",
//! 2011): one point after the other is taken out and put where the others leave the largest empty circle.
//!
//! That circle is never smaller than the one that the point itself lay in, so the least distance never falls.
//!
//! Centres of empty circles are the corners of the Voronoi diagram. A heap holds those of all triangles there ever were; the topmost that still
//! is empty is the largest.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

use spade::{DelaunayTriangulation, Point2, Triangulation};

use super::periodic::{FEW, Site, copies};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::samplers::torus_nearest::TorusNearest;
use crate::samplers::{Accepts, Entry, Family, Parameter, Realization, Sampler, Size, wrap};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["farthest-point"],
    source: "Schlomer, Heck, Deussen 2011",
    size: Size::at_least::<4>("4 or more"),
    dims: 2..=2,
    parameters: &[Parameter::new(
        "iterations",
        "20",
        Accepts::Whole(0, 100_000),
        "passes over all points; one more goes on from the same points",
    )
    .no_identity()],
    ..Entry::new(
        "fpo",
        Family::BlueNoise,
        "farthest-point optimization: points move to the largest empty circles",
        |given| Ok(Arc::new(FarthestPoint { passes: given.values.whole("iterations")?.unwrap_or(0) })),
    )
};

struct FarthestPoint {
    passes: u64,
}

impl Sampler for FarthestPoint {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let n = which.n as usize;
        let start: Vec<[f64; 2]> = (0..n).map(|_| [stream.uniform(), stream.uniform()]).collect();
        let mut pattern = Pattern::new(start)?;
        for pass in 0..self.passes {
            for i in 0..n {
                if i % 64 == 0 {
                    control.check()?;
                }
                pattern.optimize(i)?;
            }
            // What the heap remembers in vain is forgotten.
            if pass + 1 < self.passes {
                pattern.refill();
            }
        }
        Ok(pattern.points.points().as_flattened().to_vec())
    }
}

/// An empty circle by the square of its radius.
struct Circle {
    radius2: f64,
    centre: [f64; 2],
}

impl PartialEq for Circle {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Circle {}

impl PartialOrd for Circle {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Circle {
    fn cmp(&self, other: &Self) -> Ordering {
        // Of equal circles one is chosen by where it is, not by the order in which it was found.
        let place = |c: &Self| (c.radius2, c.centre[0], c.centre[1]);
        let (a, b) = (place(self), place(other));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2))
    }
}

struct Pattern {
    points: TorusNearest<2>,
    triangulation: DelaunayTriangulation<Site>,
    circles: BinaryHeap<Circle>,
    /// How far images reach out of the box.
    margin: f64,
}

impl Pattern {
    fn new(points: Vec<[f64; 2]>) -> Result<Self> {
        let n = points.len();
        // Circles among random points are below 3 / sqrt(n), and only shrink.
        let margin = if n < 4 * FEW { 1.0 } else { (8.0 / (n as f64).sqrt()).min(1.0) };
        let sites = points.iter().enumerate().flat_map(|(i, &p)| copies(i as u32, p, margin)).collect();
        let triangulation = DelaunayTriangulation::bulk_load(sites)
            .map_err(|e| Error::input("fpo", format!("points that cannot be triangulated: {e:?}")))?;
        let mut near = TorusNearest::new();
        points.into_iter().for_each(|point| near.push(point));
        let mut pattern = Self { points: near, triangulation, circles: BinaryHeap::new(), margin };
        pattern.refill();
        Ok(pattern)
    }

    /// The circles of the triangulation as it is.
    fn refill(&mut self) {
        self.circles.clear();
        let circles: Vec<Circle> =
            self.triangulation.inner_faces().filter_map(|face| circle(face.positions())).collect();
        self.circles.extend(circles);
    }

    fn optimize(&mut self, i: usize) -> Result<()> {
        let old = self.points.points()[i];
        self.points.take_out(i);
        for site in copies(i as u32, old, self.margin) {
            self.take_out(site.position);
        }
        let place = loop {
            let Some(largest) = self.circles.pop() else {
                return Err(Error::input("fpo", "no empty circle is left among the points"));
            };
            let almost = largest.radius2 * (1.0 - 1e-12);
            if self.points.nearest2(&largest.centre, almost) > almost {
                break largest.centre;
            }
        };
        self.points.put_back(i, place);
        for site in copies(i as u32, place, self.margin) {
            let inserted = self.triangulation.insert(site);
            let vertex =
                inserted.map_err(|e| Error::input("fpo", format!("a place that cannot be triangulated: {e:?}")))?;
            let faces = self.triangulation.vertex(vertex).out_edges().filter_map(|edge| edge.face().as_inner());
            let circles: Vec<Circle> = faces.filter_map(|face| circle(face.positions())).collect();
            self.circles.extend(circles);
        }
        Ok(())
    }

    /// Removes a vertex; the triangles that fill its place are at its neighbours.
    fn take_out(&mut self, position: Point2<f64>) {
        let Some(vertex) = self.triangulation.locate_vertex(position) else { return };
        let around: Vec<Point2<f64>> = vertex.out_edges().map(|edge| edge.to().position()).collect();
        let vertex = vertex.fix();
        self.triangulation.remove(vertex);
        let mut circles = Vec::new();
        for position in around {
            if let Some(neighbour) = self.triangulation.locate_vertex(position) {
                let faces = neighbour.out_edges().filter_map(|edge| edge.face().as_inner());
                circles.extend(faces.filter_map(|face| circle(face.positions())));
            }
        }
        self.circles.extend(circles);
    }
}

/// The circle of a triangle, on the torus, if its centre is in the box; those of images are others.
fn circle(corners: [Point2<f64>; 3]) -> Option<Circle> {
    let [a, b, c] = corners;
    let (bx, by, cx, cy) = (b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y);
    let (b2, c2, twice) = (bx * bx + by * by, cx * cx + cy * cy, 2.0 * (bx * cy - by * cx));
    let from = [(cy * b2 - by * c2) / twice, (bx * c2 - cx * b2) / twice];
    let centre = [a.x + from[0], a.y + from[1]];
    // A little beyond, so that no rounding loses one at a side.
    let inside = centre.iter().all(|x| (-1e-9..=1.0 + 1e-9).contains(x));
    inside.then(|| Circle { radius2: from[0] * from[0] + from[1] * from[1], centre: centre.map(wrap) })
}
