//! Lloyd's relaxation (Lloyd 1982): points move to the centroids of their Voronoi cells on the torus, again and again, towards
//! a centroidal tessellation (Du, Faber, Gunzburger 1999).
//!
//! Cells are exact polygons. Images within a margin of the box are triangulated with the points; where a circumcircle at a point of
//! the box reaches out of what was copied, the margin grows.

use std::sync::Arc;

use spade::{DelaunayTriangulation, Triangulation};

use super::periodic::{Site, copies, margin};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::samplers::{Accepts, Entry, Family, Parameter, Realization, Sampler, wrap};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    aliases: &["cvt"],
    source: "Lloyd 1982; Du, Faber, Gunzburger 1999",
    dims: 1..=2,
    parameters: &[Parameter::new(
        "iterations",
        "100",
        Accepts::Whole(0, 1_000_000),
        "steps; one more is one more step of the same points",
    )
    .no_identity()],
    ..Entry::new("lloyd", Family::BlueNoise, "random points relaxed to the centroids of their Voronoi cells", |given| {
        Ok(Arc::new(Lloyd { iterations: given.values.whole("iterations")?.unwrap_or(0) }))
    })
};

struct Lloyd {
    iterations: u64,
}

impl Sampler for Lloyd {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let mut stream = which.stream();
        let mut points: Vec<f64> = (0..which.n as usize * which.dim).map(|_| stream.uniform()).collect();
        for _ in 0..self.iterations {
            control.check()?;
            if which.dim == 1 {
                relax_line(&mut points);
            } else {
                relax_plane(&mut points)?;
            }
        }
        Ok(points)
    }
}

/// A cell reaches half way to either neighbour.
fn relax_line(points: &mut [f64]) {
    let n = points.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| points[*a].total_cmp(&points[*b]));
    let sorted: Vec<f64> = order.iter().map(|&i| points[i]).collect();
    for (k, &i) in order.iter().enumerate() {
        let after = if k + 1 < n { sorted[k + 1] } else { sorted[0] + 1.0 } - sorted[k];
        let before = sorted[k] - if k > 0 { sorted[k - 1] } else { sorted[n - 1] - 1.0 };
        points[i] = wrap(sorted[k] + 0.25 * (after - before));
    }
}

fn relax_plane(points: &mut [f64]) -> Result<()> {
    let places: Vec<[f64; 2]> = points.as_chunks::<2>().0.to_vec();
    let mut reach = margin(places.len());
    loop {
        let sites: Vec<Site> = places.iter().enumerate().flat_map(|(i, &p)| copies(i as u32, p, reach)).collect();
        let cells = DelaunayTriangulation::<Site>::bulk_load(sites)
            .map_err(|e| Error::input("lloyd", format!("points that cannot be triangulated: {e:?}")))?;
        if let Some(moves) = moves(&cells, places.len(), reach) {
            for (x, by) in points.iter_mut().zip(moves.into_flattened()) {
                *x = wrap(*x + by);
            }
            return Ok(());
        }
        if reach >= 1.0 {
            return Err(Error::input("lloyd", "two points came to lie in one place: they have no cells of their own"));
        }
        reach = (1.5 * reach).min(1.0);
    }
}

/// From every point to the centroid of its cell; `None` where a cell may depend on what was not copied.
fn moves(cells: &DelaunayTriangulation<Site>, n: usize, reach: f64) -> Option<Vec<[f64; 2]>> {
    let mut moves = vec![[0.0; 2]; n];
    let mut found = 0;
    for vertex in cells.vertices() {
        let Some(index) = vertex.data().own else { continue };
        found += 1;
        let at = vertex.position();
        // Corners seen from the point, so that nothing cancels.
        let mut corners = Vec::with_capacity(8);
        for edge in vertex.out_edges() {
            let centre = edge.face().as_inner()?.circumcenter();
            let corner = [centre.x - at.x, centre.y - at.y];
            let radius = corner[0].hypot(corner[1]);
            let inside = |x: f64| x - radius >= -reach && x + radius <= 1.0 + reach;
            // All nine copies hold every circle that is no wider than the torus.
            if !(inside(centre.x) && inside(centre.y)) && (reach < 1.0 || radius > 1.0) {
                return None;
            }
            corners.push(corner);
        }
        let (mut area, mut moment) = (0.0, [0.0; 2]);
        for (k, a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            let cross = a[0] * b[1] - a[1] * b[0];
            area += cross;
            (0..2).for_each(|axis| moment[axis] += cross * (a[axis] + b[axis]));
        }
        // The orientation cancels; a cell has an area.
        moves[index as usize] = moment.map(|m| m / (3.0 * area));
    }
    (found == n && moves.iter().flatten().all(|x| x.is_finite())).then_some(moves)
}
