//! What every frequency of the grid of P adds to the variance of an integral.

use super::color_map::ColorMap;
use super::human;
use super::pixels::{DC, Pixels, grid_pixels};
use super::readout::ModeAt;
use crate::estimate::Analysis;
use crate::integrand::Integrand;
use crate::plan::{By, Estimator};

/// Colours go from the largest so many decades down.
const DECADES: f64 = 6.0;

/// `|f_m|^2` of an integrand on the grid of P of an analysis, in 3D of the plane m_z = 0: what a map of `|f_m|^2 P(m)` is made of while P
/// changes.
#[derive(Debug, Clone)]
pub struct Attribution {
    spec: String,
    half: [u32; 2],
    /// Over v0: index `(m_x + half_x) (2 half_y + 1) + m_y + half_y`.
    squares: Vec<f64>,
}

/// Whether the variance is the sum of `|f_m|^2 P(m)`, of parents where points are removed.
fn is_sum(analysis: &Analysis) -> bool {
    let Some(found) = analysis.integration() else { return true };
    match &found.placed {
        None => true,
        Some(placed) => {
            placed.by == Some(By::Removal) && matches!(found.estimator, Estimator::Mean | Estimator::Lambda)
        }
    }
}

/// The largest frequencies of the grid along the axes of the picture.
fn half_of(analysis: &Analysis) -> Option<[u32; 2]> {
    let grid = analysis.spectrum().filter(|_| analysis.grid_wanted)?.waves.grid()?;
    let [x, y, _] = grid.max_frequency();
    (grid.dim() >= 2).then_some([x, y])
}

impl Attribution {
    /// Of an integrand; `None` where P is on no grid in a plane, nothing varies, or the variance is no sum of `|f_m|^2 P(m)`: of points with
    /// weights one over their density, and of ratios of them.
    pub fn new(analysis: &Analysis, integrand: &Integrand) -> Option<Self> {
        let half = half_of(analysis).filter(|_| is_sum(analysis))?;
        let v0 = integrand.variance();
        if !(v0 > 0.0 && integrand.dim() == analysis.domain.dim()) {
            return None;
        }
        let max = [half[0], half[1], 0];
        let coefficients = integrand.coefficients(&max[..integrand.dim()]);
        let squares = coefficients.iter().map(|f| f.norm_sqr() / v0).collect();
        Some(Self { spec: integrand.spec().into(), half, squares })
    }

    /// Whether it is that of this integrand on the grid of an analysis.
    pub fn suits(&self, analysis: &Analysis, integrand: &Integrand) -> bool {
        self.spec == integrand.spec() && half_of(analysis) == Some(self.half)
    }

    /// What a mode and P there come to: its part of the variance, over that of as many random points.
    fn part(&self, m: [i32; 3], p: f64) -> f64 {
        let at = |k: usize| (m[k] + self.half[k] as i32) as usize;
        self.squares.get(at(0) * (2 * self.half[1] as usize + 1) + at(1)).map_or(0.0, |square| square * p)
    }

    /// Part after part, DC left out.
    fn parts<'a>(&'a self, analysis: &'a Analysis) -> impl Iterator<Item = f64> + 'a {
        let [x, y] = self.half.map(|half| half as i32);
        let found = analysis.spectrum().and_then(|spectrum| Some((spectrum, spectrum.waves.grid()?)));
        found.into_iter().flat_map(move |(spectrum, grid)| {
            // The other half is its mirror image.
            let modes = (0..=x).flat_map(move |a| (-y..=y).map(move |b| [a, b, 0])).filter(|m| *m != [0; 3]);
            modes.map(move |m| self.part(m, spectrum.p[grid.half_index(m)]))
        })
    }

    /// The largest part.
    pub fn largest(&self, analysis: &Analysis) -> f64 {
        self.parts(analysis).filter(|part| part.is_finite()).fold(0.0, f64::max)
    }

    /// The map, a pixel per mode with DC grey, its colours from `largest` down 6 decades; a pixel of several modes is that of the largest. As
    /// `spectrum_pixels`.
    pub fn pixels(&self, analysis: &Analysis, largest: f64, colors: ColorMap, most: usize) -> Option<Pixels> {
        let spectrum = analysis.spectrum()?;
        let grid = spectrum.waves.grid().filter(|_| half_of(analysis) == Some(self.half))?;
        grid_pixels(analysis, None, most, |columns, rows| {
            if columns.contains(&0) && rows.contains(&0) {
                return DC;
            }
            let modes = rows.clone().flat_map(|y| columns.clone().map(move |x| [x, y, 0]));
            let part = modes.map(|m| self.part(m, spectrum.p[grid.half_index(m)])).fold(0.0, f64::max);
            colors.color(tone(part, largest))
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
            self.spec
        )
    }

    /// The part of a mode, in words.
    pub fn text(&self, mode: &ModeAt) -> String {
        let beyond = mode.m.iter().zip(self.half).any(|(m, half)| m.unsigned_abs() > half);
        match beyond || mode.m == [0; 3] {
            true => mode.text(),
            false => format!("{}, |f_m|² P / v₀ = {}", mode.text(), human(self.part(mode.m, mode.p))),
        }
    }
}

/// Where a part is between the ends of the colours.
fn tone(part: f64, largest: f64) -> f64 {
    if part > 0.0 { (1.0 + (part / largest).log10() / DECADES).clamp(0.0, 1.0) } else { 0.0 }
}
