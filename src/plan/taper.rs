//! Tapers: functions of the window that points are weighted by, so that what the window cuts off leaks less into other
//! frequencies (Rajala, Olhede & Murrell, "Spectral estimation for spatial point patterns", 2020; Hawat, Gautier, Bardenet &
//! Lachieze-Rey, "On estimating the structure factor of a point process, with applications to hyperuniformity", 2023).

use super::{WavePlan, WaveVectors};
use crate::error::{Error, Result};
use crate::named::named;
use crate::setting::Setting;
use crate::sinc::{sin_pi, sinc};

/// The taper of a window's spectrum. A taper t has `integral t^2 = 1`; here it is held as `f = t sqrt |W|`, the product over
/// axes of functions of `u = x_k / L_k` with `integral f^2 du = 1`, x from the corner of the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Taper {
    /// `f = 1`: Bartlett's periodogram.
    #[default]
    Bartlett,
    /// `f = prod_k sqrt(2) sin(pi p_k u_k)`.
    Sine,
}

named!(Taper: Bartlett = "bartlett", Sine = "sine");

/// How the transform of the taper, which the mean intensity brings in, is removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Debias {
    /// From the amplitude, before it is squared.
    #[default]
    Direct,
    /// Its square from the power: may fall below 0.
    Undirect,
    /// Not at all.
    None,
}

named!(Debias: Direct = "direct", Undirect = "undirect", None = "none");

/// The tapers of a window's spectrum, over which it is averaged, and what is removed from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct TaperPlan {
    /// Their kind.
    pub taper: Taper,
    /// Orders `p = 1 ..= orders` along each axis; 1 for Bartlett.
    pub orders: usize,
    /// What is removed.
    pub debias: Debias,
}

/// More tapers than this are refused: each is a spectrum of its own.
const MAX_TAPERS: usize = 4096;

impl Default for TaperPlan {
    fn default() -> Self {
        Self { taper: Taper::Bartlett, orders: 1, debias: Debias::Direct }
    }
}

impl TaperPlan {
    /// The first `orders` tapers per axis, for a window with `dim` axes.
    ///
    /// # Errors
    /// A number of tapers that is 0, too large or of a taper there is only one of.
    pub fn new(taper: Taper, orders: Option<usize>, debias: Debias, dim: usize) -> Result<Self> {
        let given = orders.filter(|_| taper == Taper::Bartlett);
        let orders = orders.unwrap_or(1);
        if !(1..=MAX_TAPERS).contains(&orders) || orders.pow(dim as u32) > MAX_TAPERS {
            let most = (1..=MAX_TAPERS).take_while(|n| n.pow(dim as u32) <= MAX_TAPERS).count();
            return Err(Error::setting(Setting::Tapers, orders, format!("expected 1 to {most} per axis")));
        }
        if let Some(n) = given {
            return Err(Error::setting(Setting::Tapers, n, "needs `taper` sine; Bartlett's taper is one"));
        }
        Ok(Self { taper, orders, debias })
    }

    /// The orders of every taper along each axis.
    pub fn all(&self, dim: usize) -> Vec<[usize; 3]> {
        let along = |k: usize| 1..=if k < dim { self.orders } else { 1 };
        along(0).flat_map(|p| along(1).flat_map(move |q| along(2).map(move |r| [p, q, r]))).collect()
    }

    /// f of a point's fractions `u = axes[k][j] / 2^64`. f is 0 on both sides of a window, so it does not matter that 1 is 0.
    pub fn value(&self, orders: [usize; 3], axes: &[&[u64]], j: usize) -> f64 {
        let along = |(axis, p): (&&[u64], usize)| match self.taper {
            Taper::Bartlett => 1.0,
            Taper::Sine => {
                // Modulo 2 in integers, so that u near a zero of the sine keeps its digits.
                let turns = (axis[j] >> 1).wrapping_mul(p as u64) as i64 as f64 / 2f64.powi(64);
                std::f64::consts::SQRT_2 * (std::f64::consts::TAU * turns).sin()
            }
        };
        axes.iter().zip(orders).map(along).product()
    }

    /// The same of fractions `u` as numbers.
    pub fn value_at(&self, orders: [usize; 3], u: &[f64]) -> f64 {
        let along = |(&u, p): (&f64, usize)| match self.taper {
            Taper::Bartlett => 1.0,
            Taper::Sine => std::f64::consts::SQRT_2 * sin_pi(u * p as f64),
        };
        u.iter().zip(orders).map(along).product()
    }

    /// `F(m) = prod_k integral_0^1 f(u) exp(-2 pi i m_k u) du`, real and imaginary part, m in cycles per side.
    pub fn transform(&self, orders: [usize; 3], m: [f64; 3], dim: usize) -> [f64; 2] {
        let along = |k: usize| match self.taper {
            Taper::Bartlett => integral(-m[k]),
            Taper::Sine => {
                // sqrt(2) sin(pi p u) = (exp(i pi p u) - exp(-i pi p u)) / (sqrt(2) i)
                let p = orders[k] as f64;
                let ([a, b], [c, d]) = (integral(p / 2.0 - m[k]), integral(-p / 2.0 - m[k]));
                [(b - d) / std::f64::consts::SQRT_2, (c - a) / std::f64::consts::SQRT_2]
            }
        };
        (0..dim).map(along).fold([1.0, 0.0], |[a, b], [c, d]| [a * c - b * d, a * d + b * c])
    }

    /// Tapers on the whole.
    pub fn count(&self, dim: usize) -> usize {
        self.orders.pow(dim as u32)
    }

    /// How much larger tapers make the variance of a mean of P over many neighbouring frequencies m / L, which they correlate:
    /// the sum over lags of the squared correlation of amplitudes, averaged over tapers, `prod_k integral (mean_p f_p^2)^2
    /// du = (1 + 1 / (2 N))^d` by Parseval for N sine tapers per axis. An upper bound for rings, out of which part of the lags
    /// leads.
    pub fn ring_variance(&self, dim: usize) -> f64 {
        match self.taper {
            Taper::Bartlett => 1.0,
            Taper::Sine => (1.0 + 0.5 / self.orders as f64).powi(dim as i32),
        }
    }
}

/// `integral_0^1 exp(2 pi i x u) du = exp(i pi x) sin(pi x) / (pi x)`.
fn integral(x: f64) -> [f64; 2] {
    [sin_pi(x + 0.5) * sinc(x), sin_pi(x) * sinc(x)]
}

impl WavePlan {
    /// The same with tapers. On a torus there is nothing to taper.
    pub fn with_taper(self, taper: TaperPlan) -> Self {
        Self { taper: (!self.domain.is_torus()).then_some(taper), ..self }
    }

    /// The tapers by which points are weighted or whose transform is removed. None where P is the plain periodogram: on a
    /// torus, and for Bartlett's taper on the grid m / L, where the transform of the window is 0 but at m = 0.
    pub fn tapered(&self) -> Option<&TaperPlan> {
        let plain = |t: &TaperPlan| t.taper == Taper::Bartlett && matches!(self.waves, WaveVectors::Grid(_));
        self.taper.as_ref().filter(|t| !plain(t))
    }

    /// Tapers that P is averaged over.
    pub fn tapers(&self) -> f64 {
        self.tapered().map_or(1.0, |t| t.count(self.domain.dim()) as f64)
    }

    /// What divides the number of independent modes of a ring: see `TaperPlan::ring_variance`.
    pub fn ring_variance(&self) -> f64 {
        self.tapered().map_or(1.0, |t| t.ring_variance(self.domain.dim()))
    }
}

impl std::fmt::Display for TaperPlan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} taper, ", self.taper)?;
        if self.taper == Taper::Sine {
            write!(f, "orders 1 to {} per axis averaged, ", self.orders)?;
        }
        write!(f, "debias {}", self.debias)
    }
}
