//! What g, K and P of an inhomogeneous process were weighted by. See `docs/inhomogeneous.md`.

use super::Analysis;

/// The intensity lambda at the points, by whose inverse they were weighted, and how it came.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Inhomogeneity {
    /// `estimate`, `column NAME`, or the specification of a function of the place.
    pub intensity: String,
    /// Standard deviation of the kernel, of an estimate.
    pub bandwidth: Option<f64>,
    /// How that was chosen: given, scott or likelihood.
    pub rule: Option<String>,
    /// Realizations that an estimate is read off, besides the one whose points are weighted; 0: from the other points of the same.
    pub others: Option<u64>,
    /// The least at any point.
    pub least: f64,
    /// The largest at any point.
    pub largest: f64,
    /// The mean over realizations of `sum 1/lambda` over |D|: 1 on average where lambda is the intensity itself.
    pub inverse_mean: f64,
}

impl Inhomogeneity {
    /// How lambda came, in words to be put behind it.
    pub fn words(&self) -> String {
        let Some(bandwidth) = self.bandwidth else {
            let sign = if self.intensity.starts_with("column ") { "of" } else { "=" };
            return format!("{sign} {}", self.intensity);
        };
        let from = match self.others {
            Some(others) if others > 0 => "other realizations",
            _ => "the other points",
        };
        format!("estimated from {from}, kernel s.d. {bandwidth:.4}")
    }
}

impl Analysis {
    /// How lambda came, where g, K and P are those of an inhomogeneous process.
    pub fn inhomogeneity(&self) -> Option<&Inhomogeneity> {
        self.get()
    }
}
