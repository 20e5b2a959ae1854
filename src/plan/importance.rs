//! Points as dense as a function, and what estimates integrals from them: each point weighs one over the intensity there.

use std::sync::OnceLock;

use rayon::prelude::*;

use super::Estimator;
use crate::error::{Error, Result};
use crate::integrand::{DIVERGES, FLOORS, Integral, Integrand, nested, nonnegative, over_cells};
use crate::setting::Setting;

/// Points of a parent are kept with probability `density / maximum`, and then weigh `maximum / density`, over what the parent's weigh.
#[derive(Debug, Clone)]
pub struct Removal {
    /// The density, up to a factor.
    pub density: Integrand,
    /// Its largest value.
    pub maximum: f64,
    /// The part of the parent's points that is kept.
    pub kept: f64,
    /// Per integrand, `int g^2 (1/q - 1)`: times the parent's weight, what removal adds to the variance. g is f, or for ratios what stands for it.
    pub(crate) terms: Vec<Integral>,
}

impl Removal {
    /// Finds the largest value and the integrals.
    pub(super) fn new(spec: &str, dim: usize, integrands: &[Integrand], estimator: Estimator) -> Result<Self> {
        let (density, maximum) = nonnegative(spec, dim)?;
        let kept = density.integral() / maximum;
        let q = |x: [f64; 3]| density.value(&x[..dim]) / maximum;
        let never = |x: [f64; 3], f: &Integrand| {
            let place: Vec<String> = x[..dim].iter().map(|x| format!("{x:.4}")).collect();
            let less = if estimator == Estimator::Ratio { " less its integral" } else { "" };
            let reason = format!(
                "is 0 at ({}), where {}{less} is not: there no point is ever kept, and estimates are biased; expected a density above 0 there",
                place.join(", "),
                f.spec()
            );
            Error::setting(Setting::Intensity, spec, reason)
        };
        let term = |f: &Integrand| {
            let g = |x: [f64; 3]| match estimator {
                Estimator::Ratio => f.value(&x[..dim]) - f.integral(),
                Estimator::CountRatio => f.value(&x[..dim]) - f.integral() / kept * q(x),
                _ => f.value(&x[..dim]),
            };
            let never_sampled = OnceLock::new();
            let value = |x: [f64; 3], floor: f64| {
                let (q, g) = (q(x), g(x));
                if g == 0.0 {
                    return 0.0;
                }
                if q <= 0.0 {
                    never_sampled.get_or_init(|| x);
                    return 0.0;
                }
                g * g * (1.0 / q.max(floor) - 1.0)
            };
            // What jumps at every pixel is no work for halvings.
            let [rough, found] = FLOORS.map(|floor| match density.cells() {
                Some(cells) => over_cells(dim, cells, |x| value(x, floor)),
                None => nested(dim, |x| value(x, floor)),
            });
            if let Some(x) = never_sampled.get() {
                return Err(never(*x, f));
            }
            // An integral that converges does not depend on how near to 0 the density is looked at.
            let apart = (found.value - rough.value).abs();
            let scale = f.square_integral().max(f64::MIN_POSITIVE);
            if apart > DIVERGES * found.value.abs()
                || !found.value.is_finite()
                || found.error > 1e-3 * found.value.abs() + 1e-7 * scale
            {
                let reason = format!(
                    "the integral of f^2 over it does not converge for {}: the variance is infinite, or not known; expected a density that is nowhere so much less than f^2, or smoother",
                    f.spec()
                );
                return Err(Error::setting(Setting::Intensity, spec, reason));
            }
            Ok(found)
        };
        let terms = integrands.par_iter().map(term).collect::<Result<_>>()?;
        Ok(Self { density, maximum, kept, terms })
    }

    /// The probability that a point at each place is kept.
    ///
    /// # Errors
    /// One above 1: the maximum was not found.
    pub(crate) fn probabilities(&self, x: &[[f64; 3]], out: &mut [f64]) -> Result<()> {
        self.density.values(x, out);
        out.iter_mut().for_each(|q| *q /= self.maximum);
        match out.iter().position(|q| q.is_nan() || *q > 1.0 + 1e-6) {
            None => Ok(()),
            Some(at) => {
                let reason = format!(
                    "is {} at {:?}, above {}, its largest value that was found; expected a density that can be bounded",
                    out[at] * self.maximum,
                    &x[at][..self.density.dim()],
                    self.maximum
                );
                Err(Error::setting(Setting::Intensity, self.density.spec(), reason))
            }
        }
    }
}
