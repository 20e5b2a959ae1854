//! What is said in the same words wherever it is shown.

use super::{escape, human};
use crate::estimate::{Analysis, ErrorSource};
use crate::plan::SmoothingKernel;

/// `n = 1024, K = 20`.
pub(crate) fn size(analysis: &Analysis) -> String {
    let shape = &analysis.shape;
    let n = if analysis.min_points == shape.max_points {
        shape.max_points.to_string()
    } else {
        format!("{}–{} (mean {})", analysis.min_points, shape.max_points, human(shape.mean_points))
    };
    format!("n = {n}, K = {}", shape.realizations)
}

/// The same, and that points were weighted for g, K and P of an inhomogeneous process, if they were.
pub(crate) fn size_and_weights(analysis: &Analysis) -> String {
    let weights = if analysis.inhomogeneity().is_some() { " · points count 1/λ" } else { "" };
    size(analysis) + weights
}

/// What to add to the caption of a picture of g, K or P of an inhomogeneous process.
pub(crate) fn inhomogeneous_caption(analysis: &Analysis) -> String {
    analysis.inhomogeneity().map_or(String::new(), |found| {
        format!(
            " Points count 1/<i>λ</i> here and in what they are compared with, the intensity <i>λ</i> {}: of independent points it is \
             as if their intensity were the same everywhere.",
            escape(&found.words())
        )
    })
}

/// What a band around an estimate shows; `theory` names the theory used for K = 1.
pub(crate) fn error_note(source: ErrorSource, theory: &str) -> String {
    match source {
        ErrorSource::AcrossRealizations => "band: ±1 standard error across realizations".into(),
        ErrorSource::Theory => format!("band: ±1 standard error from theory ({theory})"),
        ErrorSource::SpectralTheory => {
            "band: ±1 standard error from theory (pairs correlated as their spectrum says)".into()
        }
        ErrorSource::ClusterTheory => "band: ±1 standard error from theory (of a fitted Thomas cluster process)".into(),
    }
}

/// How the kernel estimate is called.
pub(crate) fn kernel_name(shape: SmoothingKernel) -> &'static str {
    match shape {
        SmoothingKernel::Epanechnikov => "Epanechnikov",
        SmoothingKernel::Gaussian => "Gaussian",
        SmoothingKernel::Box => "box",
    }
}

/// The symbol of the closest-packing distance, as HTML/SVG-neutral (base, subscript).
pub(crate) fn packing_symbol(dim: usize) -> (&'static str, &'static str) {
    match dim {
        1 => ("d", "even"),
        2 => ("d", "hex"),
        _ => ("d", "fcc"),
    }
}
