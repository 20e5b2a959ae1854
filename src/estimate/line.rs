//! Weighted least-squares lines.

/// A weighted least-squares line; weights are inverse variances.
#[derive(Default)]
pub(super) struct Line {
    pub(super) at_zero: f64,
    pub(super) at_zero_se: f64,
    pub(super) slope: f64,
    pub(super) slope_se: f64,
    /// Weighted squares of residuals per degree of freedom: 1 where the weights are right. Of two points undefined.
    pub(super) scatter: f64,
}

impl Line {
    /// Through points that do not all stand at one x.
    pub(super) fn through(x: &[f64], y: &[f64], weights: &[f64]) -> Self {
        let sum = |f: &dyn Fn(usize) -> f64| (0..x.len()).map(|k| weights[k] * f(k)).sum::<f64>();
        let total = sum(&|_| 1.0);
        let (mean_x, mean_y) = (sum(&|k| x[k]) / total, sum(&|k| y[k]) / total);
        let spread = sum(&|k| (x[k] - mean_x).powi(2));
        let slope = sum(&|k| (x[k] - mean_x) * (y[k] - mean_y)) / spread;
        let at_zero = mean_y - slope * mean_x;
        let residuals = sum(&|k| (y[k] - at_zero - slope * x[k]).powi(2));
        Self {
            at_zero,
            at_zero_se: (1.0 / total + mean_x * mean_x / spread).sqrt(),
            slope,
            slope_se: (1.0 / spread).sqrt(),
            scatter: residuals / (x.len() as f64 - 2.0),
        }
    }
}
