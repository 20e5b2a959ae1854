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
        Self {
            realizations: sizes.len() as u64,
            mean_points: sizes.iter().sum::<u64>() as f64 / sizes.len() as f64,
            max_points: sizes.iter().copied().max().unwrap_or(0),
        }
    }
}
