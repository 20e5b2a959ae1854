//! A request, carried out: points -> plan -> compute -> accumulate -> estimate, in batches. The command line and the
//! viewer both call this and hold no arithmetic of their own.

use crate::compute::ComputedBy;
use crate::estimate::{KernelEstimate, NeighborDistances, PairCorrelation, PowerSpectrum, RadialSpectrum};
use crate::plan::{Accuracy, EnsembleShape, Rings};
use crate::points::{Domain, Ensemble};

/// Everything `analyze` found.
#[derive(Debug)]
pub struct Analysis {
    /// What was analyzed, in words: `sampler jittered, n 1024, K 20, seed 1` or the input files.
    pub subject: String,
    /// Settings as (name, value), in a fixed order, for the summary.
    pub parameters: Vec<(String, String)>,
    /// The domain.
    pub domain: Domain,
    /// Number and size of realizations.
    pub shape: EnsembleShape,
    /// Smallest number of points in a realization.
    pub min_points: u64,
    /// g per bin.
    pub pair_correlation: Option<PairCorrelation>,
    /// g smoothed, at the bin centres.
    pub kernel: Option<KernelEstimate>,
    /// P on the grid.
    pub spectrum: Option<PowerSpectrum>,
    /// Radial mean and anisotropy.
    pub radial: Option<RadialSpectrum>,
    /// The rings behind `radial`.
    pub rings: Option<Rings>,
    /// Nearest-neighbour distances.
    pub neighbors: Option<NeighborDistances>,
    /// What theory says, where the process has a closed form.
    pub closed_form: ClosedForm,
    /// The accuracy asked for.
    pub accuracy: Accuracy,
    /// Who computed the sums.
    pub computed_by: ComputedBy,
    /// The plans, printed.
    pub plan: String,
    /// Wall time per stage, seconds.
    pub timings: Vec<(&'static str, f64)>,
    /// Points that coincide with an earlier one of their realization.
    pub duplicates: u64,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// The first realization, for pictures.
    pub first: Ensemble,
}

/// Curves known in closed form, at the abscissae of the estimates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ClosedForm {
    /// The process, for legends.
    pub name: String,
    /// g at the bin centres, in the normalization of the estimate.
    pub g: Option<Vec<f64>>,
    /// Mean of P over each ring.
    pub radial: Option<Vec<f64>>,
}
