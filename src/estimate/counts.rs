//! Mean, variance and index of dispersion of the number of points in boxes and balls. See `docs/first-order.md`.

use crate::accumulate::{CountSums, Places};
use crate::estimate::{Analysis, ErrorSource};
use crate::plan::{CountPlan, CountShape, CountSize};

/// Counts in boxes and balls of all sizes.
#[derive(Debug, Clone, PartialEq)]
pub struct Counts {
    /// Sizes at which there were places, boxes first, each ascending.
    pub sizes: Vec<CountDispersion>,
    /// Where the errors come from; `None` for a single realization, which has none.
    pub errors: Option<ErrorSource>,
}

/// Counts in boxes or balls of one size.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct CountDispersion {
    /// Of what.
    pub shape: CountShape,
    /// The side of a box (the geometric mean of its sides), the radius of a ball.
    pub size: f64,
    /// Length, area or volume.
    pub measure: f64,
    /// Mean of N.
    pub mean: f64,
    /// Its standard error (K >= 2).
    pub mean_se: Option<f64>,
    /// Variance of N.
    pub variance: f64,
    /// Its standard error (K >= 2).
    pub variance_se: Option<f64>,
    /// Variance over mean; `None` without points.
    pub dispersion: Option<f64>,
    /// Its standard error (K >= 2).
    pub dispersion_se: Option<f64>,
    /// What independent points, as many per realization, would have: 1 - |B|/|D| of a fixed number, 1 of a Poisson one.
    pub random: f64,
}

impl Counts {
    /// Of the sums.
    pub fn new(plan: &CountPlan, sums: &CountSums) -> Self {
        let numbers: Vec<f64> = sums.realizations.iter().map(|r| r.n as f64).collect();
        let k = numbers.len() as f64;
        let mean = numbers.iter().sum::<f64>() / k;
        let variance = numbers.iter().map(|n| (n - mean).powi(2)).sum::<f64>() / (k - 1.0).max(1.0);
        // Fano's factor of n, 0 where all have as many.
        let fano = if mean > 0.0 { variance / mean } else { 0.0 };
        let of = |(index, size): (usize, &CountSize)| {
            let places: Vec<Places> = sums.realizations.iter().map(|r| r.sizes[index]).collect();
            let part = size.measure / plan.domain.measure();
            dispersion(size, &places, 1.0 - part + part * fano)
        };
        let errors = (numbers.len() >= 2).then_some(ErrorSource::AcrossRealizations);
        Self { sizes: plan.sizes.iter().enumerate().filter_map(of).collect(), errors }
    }

    /// The largest size of a shape.
    pub fn largest(&self, shape: CountShape) -> Option<&CountDispersion> {
        self.sizes.iter().rfind(|size| size.shape == shape)
    }
}

/// Ratios of sums over realizations; `None` without places. The square of the mean's error is added to the variance: the mean is
/// estimated too.
fn dispersion(size: &CountSize, each: &[Places], random: f64) -> Option<CountDispersion> {
    let total = |of: fn(&Places) -> u128| each.iter().map(of).fold(0u128, u128::saturating_add) as f64;
    let (places, sum) = (total(|p| p.places), total(|p| p.sum));
    if places == 0.0 {
        return None;
    }
    let mean = sum / places;
    // About a whole number near the mean, in integers: nothing cancels after them.
    let middle = mean.round();
    let centred = |p: &Places| {
        let m = middle as i128;
        let [places, sum, squares] = [p.places, p.sum, p.squares].map(|x| x as i128);
        [places as f64, (sum - m * places) as f64, (squares - 2 * m * sum + m * m * places) as f64]
    };
    let each: Vec<[f64; 3]> = each.iter().map(centred).collect();
    let [first, second] = [1, 2].map(|i| each.iter().map(|e| e[i]).sum::<f64>() / places);
    // Standard error of a ratio from what each realization adds to it (Cochran 1977, section 6.4).
    let k = each.len() as f64;
    let error = |residual: &dyn Fn(&[f64; 3]) -> f64| {
        let squares: f64 = each.iter().map(|e| residual(e).powi(2)).sum();
        (each.len() >= 2).then(|| (k / (k - 1.0) * squares).sqrt() / places)
    };
    let off = |[places, sum, _]: &[f64; 3]| sum - first * places;
    let mean_se = error(&off);
    let variance = (second - first * first + mean_se.map_or(0.0, |se| se * se)).max(0.0);
    let spread = |e: &[f64; 3]| e[2] - second * e[0] - 2.0 * first * off(e);
    let ratio = (mean > 0.0).then(|| variance / mean);
    Some(CountDispersion {
        shape: size.shape,
        size: size.size,
        measure: size.measure,
        mean,
        mean_se,
        variance,
        variance_se: error(&spread),
        dispersion: ratio,
        dispersion_se: ratio.and_then(|ratio| error(&|e| (spread(e) - ratio * off(e)) / mean)),
        random,
    })
}

impl Analysis {
    /// Counts in boxes and balls.
    pub fn counts(&self) -> Option<&Counts> {
        self.get()
    }
}
