//! Integrands as pictures.

use super::{ColorMap, Pixels};
use crate::integrand::Integrand;

/// The picture of a function: its pixels, and its values at the two ends of the colours.
#[derive(Debug, Clone, PartialEq)]
pub struct IntegrandPixels {
    /// `side` by `side` of them.
    pub pixels: Pixels,
    /// The least and the largest value; about a constant something.
    pub range: [f64; 2],
}

/// Values at the centres of `side` by `side` cells, of a plane through the middle of the box where that has three axes; `extent` is
/// what the box has along the axes of the plane. `None` in 1D.
pub fn integrand_pixels(
    integrand: &Integrand,
    colors: ColorMap,
    axes: [usize; 2],
    extent: [[f64; 2]; 2],
    side: usize,
) -> Option<IntegrandPixels> {
    let dim = integrand.dim();
    if axes.iter().any(|axis| *axis >= dim) {
        return None;
    }
    let at = |i: usize| (i as f64 + 0.5) / side as f64;
    // From the top row down.
    let places = (0..side).rev().flat_map(|j| (0..side).map(move |i| [i, j]));
    let value = |place: [usize; 2]| {
        let mut x = [0.5; 3];
        axes.iter().zip(place).for_each(|(axis, i)| x[*axis] = at(i));
        integrand.value(&x[..dim])
    };
    let values: Vec<f64> = places.map(value).collect();
    let [low, high] = integrand_range(&values);
    let rgb = values.iter().flat_map(|v| colors.color((v - low) / (high - low))).collect();
    Some(IntegrandPixels { pixels: Pixels { width: side, height: side, rgb, extent, axes }, range: [low, high] })
}

/// The range of values; something about a constant.
pub(crate) fn integrand_range(values: &[f64]) -> [f64; 2] {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    if low < high { [low, high] } else { [low - 0.5, low + 0.5] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_its_axes_in_place_and_y_upward() {
        let ramp = Integrand::new("formula:x+2*y+4*z", 3).unwrap();
        let picture = |axes| integrand_pixels(&ramp, ColorMap::Grey, axes, [[0.0, 1.0]; 2], 2).unwrap();
        let found = picture([0, 1]);
        assert_eq!(found.range, [0.75 + 2.0, 2.25 + 2.0]);
        let grey = |found: &IntegrandPixels, row: usize, column: usize| found.pixels.rgb[3 * (2 * row + column)];
        assert_eq!((grey(&found, 1, 0), grey(&found, 0, 1)), (0, 255));
        assert!(grey(&found, 0, 0) > grey(&found, 1, 1), "y counts twice");
        assert_eq!(picture([1, 2]).range, [0.5 + 1.5, 0.5 + 4.5]);
        let line = Integrand::new("formula:x", 1).unwrap();
        assert_eq!(integrand_pixels(&line, ColorMap::Grey, [0, 1], [[0.0, 1.0]; 2], 2), None);
    }
}
