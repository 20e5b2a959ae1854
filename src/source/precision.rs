//! Whether the coordinates that were read can say what is measured of them: numbers stored in steps that are no longer small beside
//! the distances between points, and axes along which nothing differs.

use crate::error::number;
use crate::points::read::Input;
use crate::points::{Domain, RawPoints};

/// Steps above this share of the mean distance to the nearest neighbour are worth a word.
const COARSE: f64 = 0.01;

const AXES: [&str; 3] = ["x", "y", "z"];

/// How far coordinates reach, per axis.
#[derive(Debug, Clone, Default)]
pub(super) struct Extent {
    points: u64,
    axes: Vec<Axis>,
    /// The fewest binary digits that numbers were stored with, if that is fewer than those of f64.
    digits: Option<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
    /// Whether all are numbers of float32, and the exponent of the lowest bit that any of them has.
    single: bool,
    lowest: i32,
}

impl Axis {
    const NONE: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY, single: true, lowest: i32::MAX };

    /// Whether the numbers passed through float32, whatever they are stored as now: they are in its steps. Larger steps, such as
    /// whole metres, are what was measured.
    fn rounded_to_single(&self) -> bool {
        let largest = self.low.abs().max(self.high.abs());
        self.single && largest > 0.0 && self.lowest <= libm::ilogb(largest) - 23
    }
}

/// The exponent of the lowest bit of a number.
fn lowest_bit(x: f64) -> i32 {
    let zeros = (x.to_bits() | 1 << 52).trailing_zeros() as i32;
    if x == 0.0 || !x.is_finite() { i32::MAX } else { libm::ilogb(x) - 52 + zeros }
}

impl Extent {
    /// Takes another realization into account.
    pub(super) fn see(&mut self, set: &RawPoints, digits: Option<u32>) {
        self.points += set.len() as u64;
        self.axes.resize(set.dim, Axis::NONE);
        self.digits = self.digits.into_iter().chain(digits).min();
        for point in set.coordinates.chunks_exact(set.dim) {
            for (axis, &x) in self.axes.iter_mut().zip(point) {
                axis.low = axis.low.min(x);
                axis.high = axis.high.max(x);
                axis.single &= f64::from(x as f32) == x;
                axis.lowest = axis.lowest.min(lowest_bit(x));
            }
        }
    }

    /// Axes along which every point has the same coordinate.
    pub(super) fn flat(&self, input: &Input) -> Vec<String> {
        if self.points < 2 || self.axes.len() < 2 {
            return Vec::new();
        }
        let flat = (0..self.axes.len()).filter(|&k| self.axes[k].low == self.axes[k].high);
        let dim = self.axes.len();
        flat.map(|k| {
            let (axis, value) = (AXES[k], number(self.axes[k].low));
            let others = (0..dim).filter(|&other| other != k);
            let name = |k: usize| input.columns.get(k).cloned().unwrap_or_else(|| (k + 1).to_string());
            let others = others.map(name).collect::<Vec<_>>().join(",");
            format!("every {axis} is {value}, and the points are measured in {dim}D all the same; `columns` {others} leaves {axis} out")
        })
        .collect()
    }

    /// Coordinates stored in steps that matter.
    pub(super) fn coarse(&self, domain: &Domain, points: f64) -> Option<String> {
        let rounded = self.axes.iter().any(Axis::rounded_to_single).then_some(24);
        let digits = self.digits.or(rounded)?;
        let steps: Vec<f64> = self.axes.iter().map(|axis| step(axis.low.abs().max(axis.high.abs()), digits)).collect();
        let distance = mean_neighbor_distance(domain, points);
        if points < 2.0 || !steps.iter().any(|step| *step > COARSE * distance) {
            return None;
        }
        let each = steps.iter().zip(AXES).map(|(step, axis)| format!("{axis} in steps of {}", short(*step)));
        let each = each.collect::<Vec<_>>().join(", ");
        let bits = if digits == 24 { "32" } else { "16" };
        Some(format!(
            "coordinates are {bits}-bit floats: {each}, beside a mean distance to the nearest neighbour of about {}; \
             store them as 64-bit floats, or subtract an offset before rounding",
            short(distance)
        ))
    }
}

/// The distance between two neighbouring numbers of so many binary digits, at a magnitude.
fn step(magnitude: f64, digits: u32) -> f64 {
    if magnitude == 0.0 || !magnitude.is_finite() {
        return 0.0;
    }
    2f64.powi(libm::ilogb(magnitude) + 1 - digits as i32)
}

/// Of as many points at random: Gamma(1 + 1/d) / (lambda b)^(1/d), b the unit ball.
fn mean_neighbor_distance(domain: &Domain, points: f64) -> f64 {
    let intensity = points / domain.measure();
    match domain.dim() {
        1 => 0.5 / intensity,
        2 => 0.5 / intensity.sqrt(),
        _ => 0.55396 / intensity.cbrt(),
    }
}

/// Two digits are enough.
fn short(value: f64) -> String {
    match format!("{value:.1e}").parse::<f64>() {
        Ok(rounded) => number(rounded),
        Err(_) => number(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_the_distance_of_neighbouring_floats() {
        for magnitude in [1.0, 0.999, 500_101.0, 4_649_877.0, 3.5e-6, 1e30] {
            let narrow = magnitude as f32;
            let next = f32::from_bits(narrow.to_bits() + 1);
            assert_eq!(step(f64::from(narrow), 24), f64::from(next) - f64::from(narrow), "{magnitude}");
        }
        assert_eq!((step(1.0, 11), step(0.0, 24)), (2f64.powi(-10), 0.0));
    }

    #[test]
    fn numbers_that_passed_through_float32_are_known_whatever_they_are_stored_as() {
        let window = Domain::window(&[(4_649_775.0, 4_649_877.0), (0.0, 100.0)]).unwrap();
        let exact: Vec<f64> = (0..200).map(|k| 4_649_776.0 + 0.4999 * f64::from(k)).collect();
        let told = |x: &dyn Fn(f64) -> f64| {
            let coordinates = exact.iter().flat_map(|&e| [x(e), 0.3 * (e - 4_649_776.0)]).collect();
            let mut extent = Extent::default();
            extent.see(&RawPoints { dim: 2, coordinates, source: "here".into(), lines: Vec::new() }, None);
            extent.coarse(&window, 200.0)
        };
        assert_eq!(told(&|x| x), None);
        assert!(told(&|x| f64::from(x as f32)).is_some_and(|text| text.contains("x in steps of 0.5")));
        assert_eq!(told(&f64::round), None, "whole metres");
    }

    #[test]
    fn neighbours_of_random_points_are_so_far() {
        let domain = Domain::torus(&[2.0, 2.0, 2.0]).unwrap();
        // Gamma(4/3) (3 / (4 pi lambda))^(1/3), lambda = 1.
        let expected = libm::tgamma(4.0 / 3.0) * (3.0 / (4.0 * std::f64::consts::PI)).cbrt();
        assert!((mean_neighbor_distance(&domain, 8.0) - expected).abs() < 1e-5);
    }
}
