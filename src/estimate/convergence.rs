//! How the variance of an integral falls with the number of points: power laws through V(n), and the one to be expected.
//!
//! ln V is fitted on ln n with weights `(V / se)^2`. The standard error of the slope is `1 / sqrt(sum w (x - xbar)^2)`, times
//! `sqrt(chi^2 / dof)` where that is above 1; its interval has the quantile of Student's t with `points - 2` degrees of freedom.
//! See `docs/convergence.md`.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::confidence::CONFIDENCE;
use super::line::Line;
use super::{Measured, mean};

/// A variance at a number of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VarianceAt {
    /// The number of points.
    pub n: f64,
    /// The variance; without a standard error it has no weight in a fit.
    pub variance: Measured,
}

/// `V = exp(level) n^slope`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// The exponent.
    pub slope: f64,
    /// Its standard error.
    pub slope_se: f64,
    /// Its 95 % interval; `None` of two points.
    pub interval: Option<[f64; 2]>,
    /// ln V at n = 1.
    pub level: f64,
    /// Weighted squares of residuals per degree of freedom; `None` of two points.
    pub chi2_per_dof: Option<f64>,
    /// Points in the fit.
    pub points: usize,
    /// Points left out because their variance is 0.
    pub zeros: usize,
    /// The smallest and the largest n.
    pub range: [f64; 2],
}

/// A variance is not taken to be known better than to this part of it: the same in every realization, as on a grid, it scatters by rounding.
const KNOWN: f64 = 1e-6;

/// Where residuals are what errors make them.
const FITS: f64 = 2.0;

impl VarianceAt {
    /// n, the variance and its standard error, where all of them are numbers above 0.
    fn usable(&self) -> Option<(f64, f64, f64)> {
        let (value, se) = (self.variance.value, self.variance.se?);
        let finite = value.is_finite() && se.is_finite() && self.n > 0.0;
        (finite && value > 0.0).then_some((self.n, value, se.max(KNOWN * value)))
    }
}

impl PowerLaw {
    /// Through all points that are above 0 and have an error; `None` of fewer than two.
    pub fn fit(points: &[VarianceAt]) -> Option<Self> {
        let usable: Vec<_> = points.iter().filter_map(VarianceAt::usable).collect();
        let x: Vec<f64> = usable.iter().map(|p| p.0.ln()).collect();
        let y: Vec<f64> = usable.iter().map(|p| p.1.ln()).collect();
        let weights: Vec<f64> = usable.iter().map(|p| (p.1 / p.2).powi(2)).collect();
        let ends = |values: &[f64]| values.iter().fold([f64::INFINITY, 0f64], |[a, b], v| [a.min(*v), b.max(*v)]);
        let range = ends(&usable.iter().map(|p| p.0).collect::<Vec<_>>());
        if range[0] >= range[1] {
            return None;
        }
        let line = Line::through(&x, &y, &weights);
        let dof = x.len() - 2;
        let chi2_per_dof = (dof > 0).then_some(line.scatter);
        let slope_se = line.slope_se * chi2_per_dof.unwrap_or(1.0).max(1.0).sqrt();
        let quantile = StudentsT::new(0.0, 1.0, dof as f64).map(|t| t.inverse_cdf(0.5 + 0.5 * CONFIDENCE)).ok();
        let interval = quantile.map(|t| [line.slope - t * slope_se, line.slope + t * slope_se]);
        Some(Self {
            slope: line.slope,
            slope_se,
            interval,
            level: line.at_zero,
            chi2_per_dof,
            points: x.len(),
            zeros: points.iter().filter(|p| p.variance.value == 0.0).count(),
            range,
        })
    }

    /// The same without so many of the smallest n that `chi^2 / dof < 2`; `None` where even three points are no line. Points rise in n.
    pub fn asymptote(points: &[VarianceAt]) -> Option<Self> {
        let fits = |law: &Self| law.points >= 3 && law.chi2_per_dof.is_some_and(|chi2| chi2 < FITS);
        (0..points.len()).filter_map(|first| Self::fit(&points[first..])).find(fits)
    }

    /// V at n.
    pub fn at(&self, n: f64) -> f64 {
        (self.level + self.slope * n.ln()).exp()
    }
}

/// The slope of ln V on ln n from each point's predecessor to it; `None` for the first and where one of the two is 0.
pub fn local_slopes(points: &[VarianceAt]) -> Vec<Option<Measured>> {
    let slope = |a: &VarianceAt, b: &VarianceAt| {
        let run = (b.n / a.n).ln();
        let value = (b.variance.value / a.variance.value).ln() / run;
        let part = |p: &VarianceAt| Some(p.variance.se? / p.variance.value);
        let se = part(a).zip(part(b)).map(|(a, b)| a.hypot(b) / run);
        (a.variance.value > 0.0 && b.variance.value > 0.0 && run > 0.0).then_some(Measured { value, se })
    };
    let first = (!points.is_empty()).then_some(None);
    first.into_iter().chain(points.windows(2).map(|pair| slope(&pair[0], &pair[1]))).collect()
}

/// `-1 - min(b, c) / d`: of P that rises like `nu^b` at low frequency, and `|f_m|^2` that falls like `|m|^(-d-c)`. A P that falls there has a
/// limit above 0, and b = 0.
pub fn expected_slope(b: f64, c: f64, dim: usize) -> f64 {
    -1.0 - b.max(0.0).min(c) / dim as f64
}

/// The largest scatter of ln P about a power of |m| at which P is still taken to be isotropic.
const ISOTROPIC: f64 = 0.35;

/// b of a closed form `P ~ |m|^b` at frequencies up to a fifth of `n^(1/d)`, at least 2 and at most 8; `None` where P is 0 somewhere there, or no
/// function of |m|.
pub fn isotropic_exponent(power: impl Fn([i32; 3]) -> Option<f64>, n: f64, dim: usize) -> Option<f64> {
    let reach = (0.2 * n.powf(1.0 / dim as f64)).clamp(2.0, 8.0);
    let span = |axis: usize| if axis < dim { -(reach as i32)..=reach as i32 } else { 0..=0 };
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for m_z in span(2) {
        for m_y in span(1) {
            for m_x in span(0) {
                let m = [m_x, m_y, m_z];
                let length = m.iter().map(|m| f64::from(*m).powi(2)).sum::<f64>().sqrt();
                if length > 0.0 && length <= reach {
                    x.push(length.ln());
                    y.push(power(m).filter(|p| *p > 1e-9)?.ln());
                }
            }
        }
    }
    let line = Line::through(&x, &y, &vec![1.0; x.len()]);
    let squares: Vec<f64> = x.iter().zip(&y).map(|(x, y)| (y - line.at_zero - line.slope * x).powi(2)).collect();
    (mean(&squares)?.sqrt() < ISOTROPIC && line.slope.is_finite()).then_some(line.slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(values: &[(f64, f64, f64)]) -> Vec<VarianceAt> {
        values.iter().map(|&(n, value, se)| VarianceAt { n, variance: Measured { value, se: Some(se) } }).collect()
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-10 * b.abs().max(1.0), "{a} is not {b}");
    }

    const SIX: [(f64, f64, f64); 6] = [
        (16.0, 2.4e-3, 6e-5),
        (64.0, 4.0e-4, 1.1e-5),
        (256.0, 5.4e-5, 1.3e-6),
        (1024.0, 6.7e-6, 2.1e-7),
        (2048.0, 2.4e-6, 0.6e-7),
        (4096.0, 8.3e-7, 2.9e-8),
    ];

    /// numpy.polyfit(log n, log V, 1, w = V / se, cov = "unscaled"), and scipy.stats.t.ppf(0.975, dof).
    #[test]
    fn a_fit_is_that_of_numpy() {
        let whole = PowerLaw::fit(&points(&SIX)).unwrap();
        near(whole.slope, -1.4401067572661441);
        near(whole.level, -1.9325961348340301);
        near(whole.chi2_per_dof.unwrap(), 13.341105298898146);
        near(whole.slope_se, 0.021107420044042414);
        let reach = 2.7764451051977987 * 0.021107420044042414;
        assert!((whole.interval.unwrap()[1] - whole.slope - reach).abs() < 1e-6 * reach);
        assert!((whole.slope - whole.interval.unwrap()[0] - reach).abs() < 1e-6 * reach);
        assert_eq!((whole.points, whole.zeros, whole.range), (6, 0, [16.0, 4096.0]));
        // The smallest n is off the line of the others.
        let rest = PowerLaw::asymptote(&points(&SIX)).unwrap();
        near(rest.slope, -1.4850629907733317);
        near(rest.slope_se, 0.00877145979018564);
        near(rest.chi2_per_dof.unwrap(), 1.0449170599410365);
        assert_eq!((rest.points, rest.range), (5, [64.0, 4096.0]));
        let reach = 3.182446305284263 * 0.00877145979018564;
        assert!((rest.interval.unwrap()[1] - rest.slope - reach).abs() < 1e-6 * reach);
        // Three points that are no line have no asymptote.
        assert_eq!(PowerLaw::asymptote(&points(&[(8.0, 1.0, 1e-3), (16.0, 0.4, 1e-3), (32.0, 0.3, 1e-3)])), None);
    }

    #[test]
    fn points_of_a_power_law_give_it_back() {
        let exact: Vec<_> = (4..10).map(|k| f64::from(1 << k)).map(|n| (n, 3.0 * n.powf(-1.5), n.powf(-1.5))).collect();
        let law = PowerLaw::fit(&points(&exact)).unwrap();
        near(law.slope, -1.5);
        near(law.level, 3f64.ln());
        near(law.at(100.0), 3e-3);
        assert!(law.chi2_per_dof.unwrap() < 1e-20);
        for local in &local_slopes(&points(&exact))[1..] {
            near(local.unwrap().value, -1.5);
            // Two relative errors of a third.
            near(local.unwrap().se.unwrap(), 2f64.sqrt() / 3.0 / 2f64.ln());
        }
    }

    #[test]
    fn zeros_and_values_without_errors_are_left_out() {
        let mut some = points(&[(4.0, 0.0, 0.0), (8.0, 2.0, 0.1), (16.0, 1.0, 0.1), (32.0, 0.5, 0.0)]);
        some.push(VarianceAt { n: 64.0, variance: Measured { value: 9.0, se: None } });
        let law = PowerLaw::fit(&some).unwrap();
        assert_eq!((law.points, law.zeros, law.range), (3, 1, [8.0, 32.0]));
        near(law.slope, -1.0);
        assert_eq!(
            local_slopes(&some).iter().map(Option::is_some).collect::<Vec<_>>(),
            [false, false, true, true, true]
        );
        let two = PowerLaw::fit(&some[1..3]).unwrap();
        assert_eq!((two.interval, two.chi2_per_dof), (None, None));
        near(two.slope, -1.0);
        near(two.slope_se, (0.05f64.powi(2) + 0.1f64.powi(2)).sqrt() / 2f64.ln());
        assert_eq!(PowerLaw::fit(&some[..2]), None);
        assert_eq!(PowerLaw::fit(&points(&[(8.0, 1.0, 0.1), (8.0, 2.0, 0.1)])), None, "one n has no slope");
        assert_eq!(local_slopes(&[]), []);
    }

    #[test]
    fn values_without_scatter_weigh_alike() {
        // On a shifted grid all realizations have one variance, up to rounding.
        let law = PowerLaw::fit(&points(&[(4.0, 1.0, 1e-17), (16.0, 0.3, 0.0), (64.0, 0.05, 1e-19)])).unwrap();
        near(law.slope, 0.05f64.ln() / 16f64.ln());
        assert!(law.slope_se > 0.05, "as they scatter about the line: {}", law.slope_se);
    }

    #[test]
    fn exponents_of_closed_forms() {
        near(expected_slope(2.0, 1.0, 2), -1.5);
        near(expected_slope(2.0, f64::INFINITY, 2), -2.0);
        near(expected_slope(-0.3, 1.0, 2), -1.0);
        let square = |m: [i32; 3]| m.iter().map(|m| f64::from(*m).powi(2)).sum::<f64>();
        near(isotropic_exponent(|m| Some(0.01 * square(m)), 1e4, 2).unwrap(), 2.0);
        near(isotropic_exponent(|_| Some(1.0), 100.0, 3).unwrap(), 0.0);
        assert_eq!(
            isotropic_exponent(|m| Some(if m[1] == 0 { 1e-4 } else { 1.0 }), 1e4, 2),
            None,
            "one axis is another"
        );
        assert_eq!(isotropic_exponent(|m| Some(f64::from(m[0] % 4 == 0)), 1e4, 2), None, "zero somewhere");
        assert_eq!(isotropic_exponent(|_| None, 1e4, 2), None);
    }
}
