//! What makes rings a polygon. Intersections and positions are those of `geo`, whose predicates are exact.

use geo::algorithm::coordinate_position::{CoordPos, CoordinatePosition};
use geo::algorithm::line_intersection::{LineIntersection, line_intersection};
use geo::{Coord, Line, LineString, Polygon};

use super::{Fault, Ring, point};

/// Whether the rings of all parts make a polygon.
pub(super) fn check(parts: &[Vec<Ring>]) -> Result<(), Fault> {
    let name = |part: usize, ring: usize| {
        let which = if ring == 0 { "outer ring".into() } else { format!("hole {ring}") };
        if parts.len() > 1 { format!("{which} of part {}", part + 1) } else { which }
    };
    let fault = |ring: String, reason: String| Err(Fault { ring, reason });
    if parts.is_empty() || parts.iter().any(Vec::is_empty) {
        return fault("polygon".into(), "has no ring; expected one of at least 3 vertices".into());
    }
    let rings: Vec<(usize, usize, &Ring)> = parts
        .iter()
        .enumerate()
        .flat_map(|(p, rings)| rings.iter().enumerate().map(move |(r, ring)| (p, r, ring)))
        .collect();
    for &(p, r, ring) in &rings {
        if let Some(k) = ring.iter().position(|v| !v.iter().all(|x| x.is_finite())) {
            let reason = format!("vertex {} is {}; expected finite numbers", k + 1, point(ring[k][0], ring[k][1]));
            return fault(name(p, r), reason);
        }
        if ring.len() < 3 {
            let vertices = if ring.len() == 1 { "vertex" } else { "vertices" };
            return fault(name(p, r), format!("{} {vertices}; expected at least 3 that differ", ring.len()));
        }
    }
    for &(p, r, ring) in &rings {
        let [x, y] = ring[0];
        let line = |v: &[f64; 2]| (ring[1][0] - x) * (v[1] - y) == (ring[1][1] - y) * (v[0] - x);
        if ring.iter().all(line) {
            return fault(name(p, r), "has no area: its vertices lie on a line".into());
        }
    }
    sides_apart(&rings, name)?;
    for (p, rings) in parts.iter().enumerate() {
        for (r, hole) in rings.iter().enumerate().skip(1) {
            if !within(hole, &rings[0]) {
                let reason = format!("is not inside the {} that it is a hole of", name(p, 0));
                return fault(name(p, r), reason);
            }
            if let Some(other) = (1..rings.len()).find(|&other| other != r && within(hole, &rings[other])) {
                return fault(name(p, r), format!("is inside {}; holes must not overlap", name(p, other)));
            }
        }
        for (q, others) in parts.iter().enumerate().filter(|(q, _)| *q != p) {
            // A part may lie in a hole of another.
            if within(&rings[0], &others[0]) && !others[1..].iter().any(|hole| within(&rings[0], hole)) {
                return fault(name(p, 0), format!("overlaps part {}; parts must not overlap", q + 1));
            }
        }
    }
    Ok(())
}

/// A side, and where it stands.
struct Standing {
    line: Line<f64>,
    ring: usize,
    side: usize,
}

/// Whether sides of one ring meet at their common vertices alone, and those of two rings at most in points where none crosses.
fn sides_apart(rings: &[(usize, usize, &Ring)], name: impl Fn(usize, usize) -> String) -> Result<(), Fault> {
    let mut sides = Vec::new();
    for (number, (_, _, ring)) in rings.iter().enumerate() {
        for k in 0..ring.len() {
            let [a, b] = [ring[k], ring[(k + 1) % ring.len()]].map(|[x, y]| Coord { x, y });
            sides.push(Standing { line: Line::new(a, b), ring: number, side: k });
        }
    }
    let low = |l: &Line<f64>| l.start.x.min(l.end.x);
    sides.sort_by(|a, b| low(&a.line).total_cmp(&low(&b.line)).then((a.ring, a.side).cmp(&(b.ring, b.side))));
    for (k, one) in sides.iter().enumerate() {
        let (high, y) = (one.line.start.x.max(one.line.end.x), [one.line.start.y, one.line.end.y]);
        for other in sides[k + 1..].iter().take_while(|other| low(&other.line) <= high) {
            let z = [other.line.start.y, other.line.end.y];
            if z[0].min(z[1]) > y[0].max(y[1]) || z[0].max(z[1]) < y[0].min(y[1]) {
                continue;
            }
            let Some(meeting) = line_intersection(one.line, other.line) else { continue };
            let at = match meeting {
                LineIntersection::SinglePoint { intersection, is_proper } => {
                    let n = rings[one.ring].2.len();
                    let neighbors = one.ring == other.ring && [1, n - 1].contains(&((one.side + n - other.side) % n));
                    if neighbors || (one.ring != other.ring && !is_proper) {
                        continue;
                    }
                    format!("meet at {}", point(intersection.x, intersection.y))
                }
                LineIntersection::Collinear { intersection } => {
                    if one.ring != other.ring && intersection.start == intersection.end {
                        continue;
                    }
                    format!("run along each other at {}", point(intersection.start.x, intersection.start.y))
                }
            };
            let (first, second) =
                if (one.ring, one.side) < (other.ring, other.side) { (one, other) } else { (other, one) };
            let [(p, r, _), (q, s, _)] = [first, second].map(|side| rings[side.ring]);
            let reason = if first.ring == second.ring {
                format!(
                    "sides {} and {} {at}; expected a ring that meets itself nowhere (side k begins at vertex k)",
                    first.side + 1,
                    second.side + 1
                )
            } else {
                format!(
                    "side {} and side {} of {} {at}; rings may touch in points but not cross",
                    first.side + 1,
                    second.side + 1,
                    name(q, s)
                )
            };
            return Err(Fault { ring: name(p, r), reason });
        }
    }
    Ok(())
}

/// Whether a ring lies in another that it does not cross.
fn within(ring: &Ring, other: &Ring) -> bool {
    let outline = LineString::from_iter(other.iter().map(|&[x, y]| Coord { x, y }));
    let outline = Polygon::new(outline, Vec::new());
    let next = ring.iter().cycle().skip(1);
    // Where they touch says nothing.
    let middles = ring.iter().zip(next).map(|(a, b)| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
    let positions = ring.iter().copied().chain(middles).map(|[x, y]| outline.coordinate_position(&Coord { x, y }));
    positions.into_iter().find(|p| *p != CoordPos::OnBoundary).is_some_and(|p| p == CoordPos::Inside)
}
