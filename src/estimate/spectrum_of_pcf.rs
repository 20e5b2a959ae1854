//! g -> P and P -> g, on a torus: two estimates of one thing, `P = lambda G + 1` with G the Fourier transform of `g - 1`.

use super::{Normalization, PairCorrelation, PowerSpectrum, RadialSpectrum};
use crate::points::Domain;

/// Each of g and P, and what the other makes of it.
///
/// With `lambda' = (P(0) - 1) / |D|`, which is `(n - 1) / |D|` for n unweighted points and the right mean where n or
/// weights differ, and g normalized by n(n - 1):
///
/// `P(nu) = 1 + lambda' sum_b (g_b - 1) K_b(nu)`, `g(r) = 1 + 1/lambda' sum_k (P_k - 1) K_k(r)`,
///
/// `K_b(nu)` being the Fourier transform of the shell of bin b, an exact integral: in one dimension
/// `[sin(2 pi nu r) / (pi nu)]`, in two `[r J_1(2 pi nu r) / nu]`, in three
/// `[(sin(k r) - k r cos(k r)) 4 pi / k^3]` with `k = 2 pi nu`, between its edges (Bracewell, The Fourier Transform and Its
/// Applications, 1986, chapter 12); and `K_k(r)` the same of ring k.
///
/// Truncation: pairs beyond the last bin count as uncorrelated, so that `p_from_g` is P smoothed over a width of `1 / r_max`,
/// with ripples where g is not 1 at `r_max`; bins beyond half the shortest side are left out. Frequencies beyond the last
/// ring count as P = 1, so that `g_from_p` is g smoothed over `1 / nu_max`, with ripples where P is not 1 at `nu_max`.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumOfPcf {
    /// Frequencies of the rings, in cycles per unit length.
    pub nu: Vec<f64>,
    /// Ring means of P.
    pub p: Vec<f64>,
    /// P from g.
    pub p_from_g: Vec<f64>,
    /// Centres of the bins, in length units.
    pub r: Vec<f64>,
    /// g.
    pub g: Vec<f64>,
    /// g from P, in the normalization of g.
    pub g_from_p: Vec<f64>,
    /// Largest distance that entered P.
    pub r_max: f64,
    /// Root mean square of `p_from_g - p` over rings.
    pub rms: f64,
    /// The same in units of what exponential ordinates make ring means scatter, `p / sqrt(K N)`: where g is smooth and 1 from `r_max` on,
    /// 1 or less, since `p_from_g` shares the scatter of p or averages it away.
    pub rms_in_standard_errors: f64,
}

impl SpectrumOfPcf {
    /// Both ways. `None` in a window, for bins that do not start at 0 or leave g undefined, without P(0), or without rings.
    pub fn new(
        domain: &Domain,
        pcf: &PairCorrelation,
        spectrum: &PowerSpectrum,
        radial: &RadialSpectrum,
    ) -> Option<Self> {
        let (dim, rings) = (domain.dim(), &radial.rings);
        let pairs_per_point = spectrum.dc()?.0 - 1.0;
        let whole = pcf.r_hi.iter().take_while(|&&r| r <= domain.shortest_side() / 2.0 * (1.0 + 1e-12)).count();
        let usable =
            domain.is_torus() && !rings.is_empty() && pcf.r_lo[0] == 0.0 && whole > 0 && pairs_per_point > 1e-12;
        // What turns n^2 into n(n - 1).
        let factor = match pcf.normalization {
            Normalization::Pairs => 1.0,
            Normalization::Intensity => 1.0 + 1.0 / pairs_per_point,
        };
        let excess: Vec<f64> = pcf.g[..whole].iter().map(|g| factor * g - 1.0).collect();
        if !usable || excess.iter().any(|e| !e.is_finite()) {
            return None;
        }
        let intensity = pairs_per_point / domain.measure();
        let p_from_g: Vec<f64> = (rings.iter())
            .map(|ring| {
                let shells = (0..whole).map(|b| excess[b] * shell(dim, ring.nu, pcf.r_lo[b], pcf.r_hi[b]));
                1.0 + intensity * shells.sum::<f64>()
            })
            .collect();
        let g_from_p = (pcf.r.iter())
            .map(|&r| {
                let shells = rings.iter().map(|ring| (ring.p - 1.0) * shell(dim, r, ring.nu_lo, ring.nu_hi));
                (1.0 + shells.sum::<f64>() / intensity) / factor
            })
            .collect();
        let mean_square = |f: &dyn Fn(usize) -> f64| (0..rings.len()).map(f).sum::<f64>() / rings.len() as f64;
        let difference = |k: usize| p_from_g[k] - rings[k].p;
        let scatter = |k: usize| rings[k].p / (radial.realizations * rings[k].independent_modes as f64).sqrt();
        Some(Self {
            rms: mean_square(&|k| difference(k).powi(2)).sqrt(),
            rms_in_standard_errors: (mean_square(&|k| difference(k).powi(2)) / mean_square(&|k| scatter(k).powi(2)))
                .sqrt(),
            nu: rings.iter().map(|r| r.nu).collect(),
            p: rings.iter().map(|r| r.p).collect(),
            p_from_g,
            r: pcf.r.clone(),
            g: pcf.g.clone(),
            g_from_p,
            r_max: pcf.r_hi[whole - 1],
        })
    }
}

/// The Fourier transform at `x > 0` of the shell between radii `lo` and `hi`.
fn shell(dim: usize, x: f64, lo: f64, hi: f64) -> f64 {
    ball(dim, x, hi) - ball(dim, x, lo)
}

/// The Fourier transform at `x > 0` of the ball of radius r.
pub(super) fn ball(dim: usize, x: f64, r: f64) -> f64 {
    let k = 2.0 * std::f64::consts::PI * x;
    match dim {
        1 => 2.0 * (k * r).sin() / k,
        2 => r * libm::j1(k * r) / x,
        _ => {
            let t = k * r;
            // The difference cancels where t is small; its series is t^3 / 3 (1 - t^2 / 10 + t^4 / 280).
            let part = if t < 0.02 {
                t.powi(3) / 3.0 * (1.0 - t * t / 10.0 + t.powi(4) / 280.0)
            } else {
                t.sin() - t * t.cos()
            };
            4.0 * std::f64::consts::PI / k.powi(3) * part
        }
    }
}

#[cfg(test)]
mod tests {
    use super::shell;

    /// Against the integral over the shell of the mean of cos(2 pi nu.x) over directions, by fine sums.
    #[test]
    fn shells_are_their_integrals() {
        let pi = std::f64::consts::PI;
        let wave = |dim: usize, t: f64| match dim {
            1 => t.cos(),
            2 => (0..400).map(|i| (t * ((f64::from(i) + 0.5) * pi / 400.0).sin()).cos()).sum::<f64>() / 400.0,
            _ if t == 0.0 => 1.0,
            _ => t.sin() / t,
        };
        for dim in 1..=3 {
            for (x, lo, hi) in [(3.0, 0.1, 0.15), (40.0, 0.0, 0.02), (1.0, 0.3, 0.5), (0.01, 0.0, 0.1)] {
                let steps = 2000;
                let dr = (hi - lo) / f64::from(steps);
                let sum: f64 = (0..steps)
                    .map(|i| lo + (f64::from(i) + 0.5) * dr)
                    .map(|r| [2.0, 2.0 * pi * r, 4.0 * pi * r * r][dim - 1] * wave(dim, 2.0 * pi * x * r) * dr)
                    .sum();
                let found = shell(dim, x, lo, hi);
                assert!((found - sum).abs() < 1e-6 * (hi - lo), "{dim}D {x} {lo} {hi}: {found} against {sum}");
            }
        }
    }
}
