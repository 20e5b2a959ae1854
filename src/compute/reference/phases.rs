//! Phases, from what was given: coordinates where there are coordinates, integers where there are integers. Nothing here is
//! shared with the other ways of computing.
//!
//! ```text
//! turns = sum_k m_k (x_k - o_k) / L_k     modulo 1, o the corner of the box
//! ```
//!
//! Of a coordinate, `x - o` and the product with m are taken without rounding, as sums of two numbers (Dekker, "A
//! floating-point technique for extending the available precision", 1971); what remains of the product after whole sides is exact,
//! and only its quotient by the side is rounded, to 2^-53 of a turn. A fraction that is an integer, in steps of 2^-64, is
//! multiplied in wrapping u64 arithmetic, exact for integer m; of any other m the part below 1 is multiplied in f64.

use crate::points::{Domain, Ensemble};

/// Where the points of a realization are.
pub(super) enum Places<'a> {
    /// Coordinates as they were given.
    Given { axes: Vec<&'a [f64]>, domain: &'a Domain },
    /// Fractions of the sides in steps of 2^-64.
    Fractions(Vec<&'a [u64]>),
}

impl<'a> Places<'a> {
    /// Those of realization `k`.
    pub(super) fn of(ensemble: &'a Ensemble, k: usize) -> Self {
        match ensemble.coordinates(k) {
            Some(axes) => Self::Given { axes, domain: ensemble.domain() },
            None => Self::Fractions(ensemble.fractions(k)),
        }
    }

    /// How many.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Given { axes, .. } => axes[0].len(),
            Self::Fractions(axes) => axes[0].len(),
        }
    }

    /// `m . x_j / L` modulo 1, in turns, in [-1/2, 1/2].
    pub(super) fn turns(&self, m: [f64; 3], j: usize) -> f64 {
        match self {
            Self::Given { axes, domain } => {
                let mut turns = 0.0;
                for (k, (axis, m)) in axes.iter().zip(m).enumerate() {
                    turns += coordinate_turns(axis[j], domain.origin()[k], domain.sides()[k], m);
                }
                turns - turns.round()
            }
            Self::Fractions(axes) => phase_turns(axes, m, j),
        }
    }

    /// `(x_j - o) / L` along each axis.
    pub(super) fn fractions(&self, j: usize) -> Vec<f64> {
        match self {
            Self::Given { axes, domain } => {
                let sides = domain.sides().iter().zip(domain.origin());
                axes.iter().zip(sides).map(|(axis, (side, origin))| (axis[j] - origin) / side).collect()
            }
            Self::Fractions(axes) => axes.iter().map(|axis| axis[j] as f64 / 2f64.powi(64)).collect(),
        }
    }
}

/// `m (x - origin) / side` modulo 1, in turns, in [-1/2, 1/2] but for rounding.
fn coordinate_turns(x: f64, origin: f64, side: f64, m: f64) -> f64 {
    // x - origin = way + rest
    let way = x - origin;
    let of_origin = x - way;
    let rest = (x - (way + of_origin)) + (of_origin - origin);
    // m way = product + error
    let product = m * way;
    let error = m.mul_add(way, -product);
    // The remainder of a division by a nearby integer is a number of f64.
    let remainder = (-(product / side).round()).mul_add(side, product);
    (remainder + (error + m * rest)) / side
}

/// `m . x_j / L mod 1`, in turns, in [-1/2, 1/2), of fractions `axes[k][j]` in steps of 2^-64.
pub fn phase_turns(axes: &[&[u64]], m: [f64; 3], j: usize) -> f64 {
    let (mut phase, mut rest) = (0u64, 0.0);
    for (axis, m_k) in axes.iter().zip(m) {
        phase = phase.wrapping_add(axis[j].wrapping_mul(m_k.floor() as i64 as u64));
        rest += (m_k - m_k.floor()) * (axis[j] as f64 / 2f64.powi(64));
    }
    let turns = phase as i64 as f64 / 2f64.powi(64) + rest;
    turns - turns.round()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked by hand: dyadic numbers, and thirds of a side that f64 does not hold.
    #[test]
    fn turns_of_coordinates() {
        for (x, origin, side, m, expected) in [
            (0.0, 0.0, 1.0, 7.0, 0.0),
            (0.25, 0.0, 1.0, 1.0, 0.25),
            (0.25, 0.0, 1.0, 3.0, -0.25),
            (10.0, 0.0, 10.0, 0.3, 0.3),
            (10.0, 0.0, 10.0, 3.0, 0.0),
            (10.0, 0.0, 10.0, 3.7, -0.3),
            (-2.0, -3.0, 4.0, 5.0, 0.25),
            // Many turns: 2^30 / 8 + 1/8 sides of 1/2 each.
            (1.0625, 1.0, 0.5, 1_073_741_825.0, 0.125),
            // 1.1 - 0.1 is 1 and 3/8 of 2^-52 as f64 has them; 2^50 times it, 3/32 of a turn.
            (1.1, 0.1, 1.0, 2f64.powi(50), 0.09375),
            // A coordinate before the origin, as folding leaves it.
            (-0.25, 0.0, 1.0, 1.0, -0.25),
        ] {
            let found = coordinate_turns(x, origin, side, m);
            assert!((found - expected).abs() < 1e-15, "{x}, {origin}, {side}, {m}: {found}, expected {expected}");
        }
        // m = 3 at (as near as f64 comes to) a third: what f64 is off by, and nothing else.
        assert_eq!(coordinate_turns(1.0 / 3.0, 0.0, 1.0, 3.0), -2f64.powi(-54));
    }
}
