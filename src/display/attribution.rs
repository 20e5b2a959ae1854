//! What every frequency adds to the variance of an integral.

use super::color_map::ColorMap;
use super::human;
use super::pixels::{DC, Pixels, grid_pixels};
use super::readout::ModeAt;
use crate::estimate::{Analysis, IntegrationError, ModeMap};

/// Colours go from the largest so many decades down.
const DECADES: f64 = 6.0;

/// The map of `|f_m|^2 P(m)` of an integrand over frequencies, in 3D over the plane m_z = 0. P is that of what was summed for the integrand:
/// of parents where points are removed, of points before they are warped, of weights where there are some.
#[derive(Debug, Clone, Copy)]
pub struct Attribution<'a> {
    error: &'a IntegrationError,
    map: &'a ModeMap,
    sides: &'a [f64],
}

impl<'a> Attribution<'a> {
    /// Of an integrand of an analysis; `None` in 1D, and where no frequency adds anything.
    pub fn of(analysis: &'a Analysis, error: &'a IntegrationError) -> Option<Self> {
        let map = error.map.as_ref().filter(|_| error.alone > 0.0)?;
        Some(Self { error, map, sides: analysis.domain.sides() })
    }

    /// The integrand.
    pub fn spec(&self) -> &'a str {
        self.error.integrand.spec()
    }

    /// The largest frequencies m_x and m_y.
    pub fn half(&self) -> [u32; 2] {
        self.map.half()
    }

    /// The part of a mode: its variance over that of as many random points.
    pub(crate) fn part(&self, m: [i32; 2]) -> Option<f64> {
        self.map.variance(m).map(|variance| variance / self.error.alone)
    }

    /// The largest part.
    pub fn largest(&self) -> f64 {
        self.map.largest() / self.error.alone
    }

    /// The map, a pixel per mode with DC grey, its colours from `largest` down 6 decades; a pixel of several modes is that of the largest. As
    /// `spectrum_pixels`.
    pub fn pixels(&self, largest: f64, colors: ColorMap, most: usize) -> Pixels {
        grid_pixels(self.map.half().map(|half| half as i32), self.sides, None, most, |columns, rows| {
            if columns.contains(&0) && rows.contains(&0) {
                return DC;
            }
            let modes = rows.clone().flat_map(|y| columns.clone().map(move |x| [x, y]));
            colors.color(tone(modes.filter_map(|m| self.part(m)).fold(0.0, f64::max), largest))
        })
    }

    /// The colour bar: places from 0 to 1, and the parts they stand for.
    pub fn ticks(largest: f64) -> Vec<(f64, String)> {
        let first = largest.log10().floor();
        if !first.is_finite() {
            return Vec::new();
        }
        let all = (0..=DECADES as i32).rev().map(|k| 10f64.powf(first - f64::from(k)));
        all.map(|part| (tone(part, largest), human(part))).filter(|(place, _)| *place > 0.0).collect()
    }

    /// What the colours are.
    pub fn definition(&self) -> String {
        format!(
            "|f_m|² P(m) / v₀ of {}, what a frequency adds to the variance over that of random points, down {DECADES} decades from the largest",
            self.spec()
        )
    }

    /// The part of a mode, in words.
    pub fn text(&self, mode: &ModeAt) -> String {
        match self.part([mode.m[0], mode.m[1]]) {
            None => mode.text(),
            Some(part) => format!("{}, |f_m|² P / v₀ = {}", mode.text(), human(part)),
        }
    }
}

/// Where a part is between the ends of the colours.
fn tone(part: f64, largest: f64) -> f64 {
    if part > 0.0 { (1.0 + (part / largest).log10() / DECADES).clamp(0.0, 1.0) } else { 0.0 }
}
