//! Lag counts against wave power: is `P = lambda G + 1` on the grid?

use rustfft::{FftPlanner, num_complex::Complex};

use super::{PowerSpectrum, VectorCorrelation};
use crate::plan::EnsembleShape;
use crate::points::Domain;
use crate::sinc::sinc;

/// Modes up to this part of the bins per axis are compared.
const PART: usize = 4;

/// How far two independent measurements of the same thing are apart: P(m) from the wave vectors, and from the pairs,
///
/// `P'(m) = 1 + 1/(sum n S(m)) sum_h c_h exp(-2 pi i m.h / L)`, `S(m) = prod_j sinc(m_j / B)`,
///
/// over the cells h of lags, B per axis, with c ordered pairs counted in each and h its centre. A cell collects the pairs of its
/// whole width, which multiplies their transform by the sinc of the cell; that is divided out. What is left is
/// aliasing: `P'(m) - P(m) = sum_(q != 0) (P(m + q B) - 1) prod_j sinc(m_j / B + q_j) / S(m)`. Since
/// `sum_q sinc^2(x + q) = 1`, its mean square is `v (1 / S(m)^2 - 1)`, with `v = E[(P - 1)^2]` at frequencies beyond B / 2. So
/// the difference is not 0 but of a known size.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct LagConsistency {
    /// Modes compared, those with `|m_j| <= B / 4` on the grid.
    pub modes: usize,
    /// Root mean square of `P' - P` over them.
    pub rms: f64,
    /// What aliasing makes of it.
    pub expected_rms: f64,
    /// `rms / expected_rms`: near 1 where both are right, unless P beyond B / 2 is far from what it is just there.
    pub ratio: f64,
}

impl LagConsistency {
    /// On a torus, for unweighted points, lags over the whole of it, and a grid of wave vectors; else `None`.
    pub fn new(
        domain: &Domain,
        shape: EnsembleShape,
        vector: &VectorCorrelation,
        spectrum: &PowerSpectrum,
    ) -> Option<Self> {
        let (lags, grid, dim) = (&vector.grid, spectrum.waves.grid()?, domain.dim());
        let bins = lags.bins;
        let whole = (0..dim).all(|k| lags.half[k] == domain.sides()[k] / 2.0);
        if !domain.is_torus() || !whole {
            return None;
        }
        let transform = transform(&vector.count, bins, dim);
        let points = shape.mean_points * shape.realizations as f64;
        let (mut modes, mut squares, mut aliasing) = (0, 0.0, 0.0);
        let (mut beyond, mut deviation) = (0.0, 0.0);
        for (index, &p) in spectrum.p.iter().enumerate().filter(|(index, _)| *index != grid.dc()) {
            let m = &grid.mode(index)[..dim];
            let largest = m.iter().map(|m| m.unsigned_abs() as usize).max().unwrap_or(0);
            if 2 * largest > bins {
                beyond += 1.0;
                deviation += (p - 1.0).powi(2);
            }
            if PART * largest > bins {
                continue;
            }
            // Cells are counted from lag -L/2 and seen from their centres: half a cell less half a turn.
            let (mut at, mut turns, mut attenuation) = (0, 0.0, 1.0);
            for &m in m {
                at = at * bins + m.rem_euclid(bins as i32) as usize;
                turns += f64::from(m) * (0.5 - 0.5 / bins as f64);
                attenuation *= sinc(f64::from(m) / bins as f64);
            }
            let phase = Complex::from_polar(1.0, 2.0 * std::f64::consts::PI * turns);
            let from_pairs = 1.0 + (transform[at] * phase).re / (points * attenuation);
            modes += 1;
            squares += (from_pairs - p).powi(2);
            aliasing += 1.0 / (attenuation * attenuation) - 1.0;
        }
        // Where the grid ends before: exponential ordinates.
        let scatter = if beyond > 0.0 { deviation / beyond } else { 1.0 / shape.realizations as f64 };
        let (rms, expected_rms) = ((squares / modes as f64).sqrt(), (scatter * aliasing / modes as f64).sqrt());
        (modes > 0 && expected_rms > 0.0).then(|| Self { modes, rms, expected_rms, ratio: rms / expected_rms })
    }
}

/// The discrete Fourier transform of a cube of counts, axis by axis.
fn transform(counts: &[u64], bins: usize, dim: usize) -> Vec<Complex<f64>> {
    let fft = FftPlanner::new().plan_fft_forward(bins);
    let mut values: Vec<Complex<f64>> = counts.iter().map(|&c| Complex::new(c as f64, 0.0)).collect();
    let mut line = vec![Complex::default(); bins];
    for axis in 0..dim {
        let stride = bins.pow((dim - 1 - axis) as u32);
        for start in (0..values.len()).filter(|i| (i / stride).is_multiple_of(bins)) {
            line.iter_mut().enumerate().for_each(|(k, v)| *v = values[start + k * stride]);
            fft.process(&mut line);
            line.iter().enumerate().for_each(|(k, v)| values[start + k * stride] = *v);
        }
    }
    values
}
