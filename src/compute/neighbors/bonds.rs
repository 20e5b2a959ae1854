//! Bond-orientational order in the plane.
//!
//! ```text
//! psi_6(i) = (1 / N_i) sum_j exp(6 i theta_ij)
//! ```
//!
//! over the N_i neighbours of point i, `theta_ij` being the direction from i to j (Nelson and Halperin, "Dislocation-mediated
//! melting in two dimensions", Phys. Rev. B 19, 1979). 1 in a hexagonal lattice, 0 in a square one.
//!
//! Neighbours share an edge of the Delaunay triangulation that is dual to an edge of the Voronoi diagram, not to a mere
//! corner. Where four points or more lie on one circle the triangulation is not unique; it is without the edges between
//! triangles that have one circumcentre, to 1e-5 of the length of the edge (coordinates may be rounded to f32). So a
//! point of a square lattice has four neighbours, whichever way its squares were cut.
//!
//! On a torus the box is continued periodically into a margin around it. A triangle whose circumcircle lies in what was
//! filled is a triangle of the whole periodic pattern; the margin grows until that is so of every triangle at a point of
//! the box. A neighbour may be an image of the point itself. In a window the points on the convex hull, whose neighbours
//! were not all seen, are left out.

use spade::handles::{FixedFaceHandle, InnerTag, VertexHandle};
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::accumulate::{Bonds, NoBonds};
use crate::control::Control;
use crate::error::Result;
use crate::points::Domain;

/// Voronoi edges shorter than this, relative to the distance between the points they separate, are corners.
const CORNER: f64 = 1e-5;

/// A point in fixed-point steps, rounded to f64: points closer than about 2^-53 of the box count as one.
struct Site {
    position: Point2<f64>,
    /// Whether it lies in the box, and not in the margin.
    own: bool,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// Of one realization, or why there is none.
pub(super) fn bonds(axes: &[&[u64]], domain: &Domain, control: &Control) -> Result<Result<Bonds, NoBonds>> {
    let &[x, y] = axes else { return Ok(Err(NoBonds::NotPlanar)) };
    if domain.as_polygon().is_some() {
        return Ok(Err(NoBonds::InPolygon));
    }
    if x.len() < 3 {
        return Ok(Err(NoBonds::FewPoints));
    }
    // Not only pointless: points are triangulated fast if three of the first are no line.
    if on_a_line(x, y) {
        return Ok(Err(NoBonds::OneLine));
    }
    if many_on_a_line(x, y) {
        return Ok(Err(NoBonds::ManyOnOneLine));
    }
    if !domain.is_torus() {
        let sites = x.iter().zip(y).map(|(&x, &y)| Site { position: Point2::new(x as f64, y as f64), own: true });
        return Ok(order(&triangulate(sites.collect())));
    }
    let periods = [0, 1].map(|a| match domain.periods()[a] {
        0 => 1i128 << 64,
        period => i128::from(period),
    });
    let sides = periods.map(|p| p as f64);
    let diagonal = sides[0].hypot(sides[1]);
    // Circles that meet no point rarely reach further out of the box in a random pattern; none is wider than the diagonal.
    let mut margin = (2.5 * (sides[0] * sides[1] / x.len() as f64).sqrt()).min(diagonal);
    loop {
        control.check()?;
        let expected = x.len() as f64 * sides.iter().map(|side| 1.0 + 2.0 * margin / side).product::<f64>();
        if expected > 16.0 * x.len() as f64 + 1024.0 {
            return Ok(Err(NoBonds::EmptyOrThin));
        }
        let triangulation = triangulate(continued([x, y], periods, margin));
        if proven(&triangulation, sides, margin) {
            return Ok(order(&triangulation));
        }
        if margin >= diagonal {
            return Ok(Err(NoBonds::Empty));
        }
        margin = (1.5 * margin).min(diagonal * 1.001);
    }
}

/// Whether the points are within 1e-9 of their extent from one straight line.
fn on_a_line(x: &[u64], y: &[u64]) -> bool {
    let offset = |i: usize| [x, y].map(|axis| (i128::from(axis[i]) - i128::from(axis[0])) as f64);
    let square = |[dx, dy]: [f64; 2]| dx * dx + dy * dy;
    let far = (0..x.len()).map(offset).max_by(|a, b| square(*a).total_cmp(&square(*b))).unwrap_or([0.0; 2]);
    let beside = |[dx, dy]: [f64; 2]| (dx * far[1] - dy * far[0]).abs();
    (0..x.len()).map(offset).all(|p| beside(p) <= 1e-9 * square(far))
}

/// Whether a quarter of many points or more lie on one line, on which the triangulation would take quadratic time. Lines are
/// tried through pairs of points; one that holds a quarter is met by one pair in 16.
fn many_on_a_line(x: &[u64], y: &[u64]) -> bool {
    const MANY: usize = 2048;
    const TRIED: usize = 64;
    let n = x.len();
    let offset = |i: usize, j: usize| [x, y].map(|axis| (i128::from(axis[i]) - i128::from(axis[j])) as f64);
    let holds_many = |k: usize| {
        // Spread by the golden ratio, so that neither neighbours in a file nor every other point are favoured.
        let pick = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() * n as f64;
        let (i, j) = (pick(2 * k + 1) as usize, pick(2 * k + 2) as usize);
        let [ax, ay] = offset(j, i);
        let square = ax * ax + ay * ay;
        let on_line = |p: &usize| {
            let [dx, dy] = offset(*p, i);
            (dx * ay - dy * ax).abs() <= 1e-9 * square
        };
        square > 0.0 && (0..n).filter(on_line).count() >= n / 4
    };
    n >= MANY && (0..TRIED).any(holds_many)
}

fn triangulate(sites: Vec<Site>) -> DelaunayTriangulation<Site> {
    // The one error is a coordinate that is no number or beyond 2^201; these are integers up to 2^66.
    DelaunayTriangulation::bulk_load(sites).unwrap_or_default()
}

/// The points and those of their images that lie in the margin.
fn continued(axes: [&[u64]; 2], periods: [i128; 2], margin: f64) -> Vec<Site> {
    let images = |a: usize, i: usize| {
        let reach = (margin / periods[a] as f64).ceil() as i128;
        let inside = move |x: &(i128, i128)| {
            let x = x.1 as f64;
            (-margin..=periods[a] as f64 + margin).contains(&x)
        };
        (-reach..=reach).map(move |turns| (turns, i128::from(axes[a][i]) + turns * periods[a])).filter(inside)
    };
    let mut sites = Vec::new();
    for i in 0..axes[0].len() {
        for (turns_x, x) in images(0, i) {
            for (turns_y, y) in images(1, i) {
                sites.push(Site { position: Point2::new(x as f64, y as f64), own: (turns_x, turns_y) == (0, 0) });
            }
        }
    }
    sites
}

/// Whether every triangle at a point of the box has its circumcircle in what was filled.
fn proven(triangulation: &DelaunayTriangulation<Site>, sides: [f64; 2], margin: f64) -> bool {
    let inside = |center: f64, radius: f64, side: f64| center - radius >= -margin && center + radius <= side + margin;
    let mut own = triangulation.vertices().filter(|v| v.data().own).peekable();
    own.peek().is_some()
        && own.all(|vertex| {
            let mut faces = vertex.out_edges().map(|edge| edge.face()).peekable();
            faces.peek().is_some()
                && faces.all(|face| {
                    face.as_inner().is_some_and(|face| {
                        let (center, square) = face.circumcircle();
                        let radius = square.sqrt();
                        inside(center.x, radius, sides[0]) && inside(center.y, radius, sides[1])
                    })
                })
        })
}

/// Means over the points of the box that are not on the hull, in the order of the triangulation, which is a function of
/// the points alone.
fn order(triangulation: &DelaunayTriangulation<Site>) -> Result<Bonds, NoBonds> {
    let centers: Vec<Point2<f64>> = triangulation.inner_faces().map(|face| face.circumcenter()).collect();
    // Inner faces are numbered from 1.
    let center = |face: FixedFaceHandle<InnerTag>| centers[face.index() - 1];
    let mut bonds = Bonds { points: 0, with_neighbors: [0; 3], local: 0.0, global: 0.0 };
    let mut sum = [0.0; 2];
    for vertex in triangulation.vertices().filter(|v| v.data().own) {
        let Some((psi, neighbors)) = psi(vertex, center) else { continue };
        bonds.points += 1;
        if let 5..=7 = neighbors {
            bonds.with_neighbors[neighbors - 5] += 1;
        }
        bonds.local += psi[0].hypot(psi[1]);
        sum = [sum[0] + psi[0], sum[1] + psi[1]];
    }
    if bonds.points == 0 {
        return Err(NoBonds::AllOutside);
    }
    bonds.local /= bonds.points as f64;
    bonds.global = sum[0].hypot(sum[1]) / bonds.points as f64;
    Ok(bonds)
}

/// psi_6 of a point and its number of neighbours; `None` on the hull.
fn psi(
    vertex: VertexHandle<'_, Site>,
    center: impl Fn(FixedFaceHandle<InnerTag>) -> Point2<f64>,
) -> Option<([f64; 2], usize)> {
    let from = vertex.position();
    let mut sum = [0.0; 2];
    let mut neighbors = 0;
    for edge in vertex.out_edges() {
        let [left, right] = [edge.face(), edge.rev().face()].map(|face| face.as_inner().map(|f| center(f.fix())));
        let (left, right) = (left?, right?);
        let to = edge.to().position();
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let length = (dx * dx + dy * dy).sqrt();
        // Written so that circles of infinite radius, at sides that are all but a line, separate points.
        let (wx, wy) = (left.x - right.x, left.y - right.y);
        if (wx * wx + wy * wy).sqrt() <= CORNER * length {
            continue;
        }
        let (c, s) = (dx / length, dy / length);
        // Three times the angle, then six.
        let (c3, s3) = (c * (c * c - 3.0 * s * s), s * (3.0 * c * c - s * s));
        sum = [sum[0] + (c3 * c3 - s3 * s3), sum[1] + 2.0 * c3 * s3];
        neighbors += 1;
    }
    (neighbors > 0).then(|| (sum.map(|x| x / neighbors as f64), neighbors))
}
