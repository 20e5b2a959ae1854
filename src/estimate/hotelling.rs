//! Whether the mean of a vector is 0, whatever the correlation between its components (Hotelling, "The generalization of Student's
//! ratio", 1931).

use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

/// The test of a mean of 0.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Hotelling {
    /// `T^2 = K mean' S^-1 mean`, S the covariance of the samples.
    pub t2: f64,
    /// The probability of one as large if the mean is 0: `T^2 (K - R) / (R (K - 1))` has the F distribution with R and K - R
    /// degrees of freedom.
    pub p_value: f64,
    /// The largest |t| of a single component.
    pub largest: f64,
    /// The component with it.
    pub component: usize,
    /// The probability of one as large in any component, at most (Bonferroni).
    pub p_largest: f64,
}

impl Hotelling {
    /// Of K samples of R components; `None` unless K > R and the components vary independently of each other.
    pub fn new(samples: &[Vec<f64>]) -> Option<Self> {
        let (k, r) = (samples.len(), samples.first()?.len());
        if k <= r || r == 0 {
            return None;
        }
        let (count, width) = (k as f64, r as f64);
        let mean: Vec<f64> = (0..r).map(|i| samples.iter().map(|s| s[i]).sum::<f64>() / count).collect();
        let covariance = |i: usize, j: usize| {
            samples.iter().map(|s| (s[i] - mean[i]) * (s[j] - mean[j])).sum::<f64>() / (count - 1.0)
        };
        let t = (0..r).map(|i| mean[i] / (covariance(i, i) / count).sqrt());
        let (component, largest) = t.map(f64::abs).enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        // The Cholesky factor L of S, row by row, and L^-1 mean, whose square is mean' S^-1 mean.
        let mut factor = vec![vec![0.0; r]; r];
        let mut solved = vec![0.0; r];
        for i in 0..r {
            for j in 0..=i {
                let rest = covariance(i, j) - (0..j).map(|l| factor[i][l] * factor[j][l]).sum::<f64>();
                factor[i][j] = if i == j { rest.sqrt() } else { rest / factor[j][j] };
            }
            if factor[i][i].is_nan() || factor[i][i] <= 1e-7 * covariance(i, i).sqrt() {
                return None;
            }
            solved[i] = (mean[i] - (0..i).map(|l| factor[i][l] * solved[l]).sum::<f64>()) / factor[i][i];
        }
        let t2 = count * solved.iter().map(|x| x * x).sum::<f64>();
        let f = FisherSnedecor::new(width, count - width).ok()?;
        let student = StudentsT::new(0.0, 1.0, count - 1.0).ok()?;
        Some(Self {
            t2,
            p_value: f.sf(t2 * (count - width) / (width * (count - 1.0))),
            largest,
            component,
            p_largest: (2.0 * width * student.sf(largest)).min(1.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let found = Hotelling::new(&[vec![0.0, 0.0], vec![2.0, 1.0], vec![1.0, 0.5]]);
        assert_eq!(found, None, "components that are multiples of each other");
        let samples = [vec![1.0, 2.0], vec![3.0, -1.0], vec![-1.0, 1.0], vec![2.0, 2.0]];
        let found = Hotelling::new(&samples).unwrap();
        // Means 1.25 and 1; S = [[35, -12], [-12, 24]] / 12; adjugate by hand.
        let (a, b, c) = (35.0 / 12.0, -12.0 / 12.0, 24.0 / 12.0);
        let t2 = 4.0 * (1.25f64.powi(2) * c - 2.0 * 1.25 * b + a) / (a * c - b * b);
        assert!((found.t2 - t2).abs() < 1e-12 * t2, "{} against {t2}", found.t2);
        // F with 2 and 2 degrees of freedom is above x with probability 1 / (1 + x).
        let expected = 1.0 / (1.0 + t2 * 2.0 / (2.0 * 3.0));
        assert!((found.p_value - expected).abs() < 1e-9, "{} against {expected}", found.p_value);
    }
}
