//! How many points there are.

/// Number of points per realization, as far as a plan must know it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct EnsembleShape {
    /// Number of realizations.
    pub realizations: u64,
    /// Mean number of points per realization.
    pub mean_points: f64,
    /// Largest number of points in any realization (expected, where the sampler draws it).
    pub max_points: u64,
}

impl EnsembleShape {
    /// Of realizations with so many points.
    pub fn of(sizes: &[u64]) -> Self {
        Self::of_runs(sizes.iter().map(|&n| (1, n)))
    }

    /// Of so many realizations of so many points each, run after run.
    pub(crate) fn of_runs(runs: impl Iterator<Item = (u64, u64)>) -> Self {
        let (mut realizations, mut points, mut most) = (0u64, 0u128, 0);
        for (run, n) in runs {
            (realizations, points, most) = (realizations + run, points + u128::from(run) * u128::from(n), n.max(most));
        }
        Self { realizations, mean_points: points as f64 / realizations as f64, max_points: most }
    }
}
