//! Which range of values is drawn.

use std::ops::Range;

use super::Interval;
use crate::estimate::RadialSpectrum;

/// The upper end of an axis from 0: everything, unless a few values would squash the rest. Values whose error is of
/// their own size (the first, nearly empty bins) do not count; well measured ones may rise to 6 times the bulk.
pub(crate) fn top_of(values: &[(f64, f64)], smooth: &[f64]) -> f64 {
    let finite: Vec<(f64, f64)> = values.iter().copied().filter(|(v, _)| v.is_finite()).collect();
    let calm: Vec<(f64, f64)> = finite.iter().copied().filter(|&(v, se)| se <= 0.3 * v.max(1.0)).collect();
    let (counted, headroom) = if 2 * calm.len() >= finite.len() { (calm, 6.0) } else { (finite, 2.5) };
    let bulk: Vec<f64> = counted.iter().map(|v| v.0).collect();
    let reach = |&(v, se): &(f64, f64)| if se.is_finite() { v + se } else { v };
    let all: Vec<f64> = counted.iter().map(reach).chain(smooth.iter().copied().filter(|v| v.is_finite())).collect();
    let limit = headroom * quantile(&bulk, 0.95).unwrap_or(1.0).max(1.0);
    let highest = extent(&all).map_or(1.0, |e| e.1);
    1.06 * highest.min(limit).max(1.3)
}

/// The range of a clustered pattern, whose g falls from far above 1: decades, since on a linear axis either the clusters
/// or the rest could be seen. Not for curves that are 0 in many places, such as a lattice's.
pub(crate) fn decades(values: &[(f64, f64)]) -> Option<Range<f64>> {
    let positive: Vec<f64> = values.iter().filter(|(v, se)| v.is_finite() && *v > 0.0 && se < v).map(|v| v.0).collect();
    let (lowest, highest) = extent(&positive)?;
    let whole = 5 * positive.len() >= 3 * values.len() && highest > 30.0;
    whole.then(|| (0.7 * lowest.min(0.5)).max(1e-3)..1.5 * highest)
}

/// Whether places grow by much from one to the next, and so cover decades: on a linear axis the small ones would share a few pixels.
pub(crate) fn grow(places: impl IntoIterator<Item = Interval>) -> bool {
    let all: Vec<f64> = places.into_iter().map(|place| place.1).collect();
    match all[..] {
        [first, second, .., before, last] => {
            first > 0.0 && last > 20.0 * first && last - before > 5.0 * (second - first).abs()
        }
        _ => false,
    }
}

/// Anisotropy in dB, where it is defined.
pub(crate) fn defined_anisotropy(radial: &RadialSpectrum) -> Vec<f64> {
    radial.rings.iter().filter_map(|r| r.anisotropy_db).filter(|a| a.is_finite()).collect()
}

/// The range of anisotropy that is drawn.
pub(crate) fn anisotropy_range(radial: &RadialSpectrum) -> Range<f64> {
    let reference = radial.anisotropy_reference_db;
    let defined = defined_anisotropy(radial);
    let (lowest, highest) = extent(&defined).unwrap_or((reference, reference));
    let (q_lo, q_hi) = (quantile(&defined, 0.03).unwrap_or(reference), quantile(&defined, 0.97).unwrap_or(reference));
    // The first rings hold few modes and scatter by many dB; they may leave the frame, the rest may not.
    let slack = (0.7 * (q_hi - q_lo)).max(1.5);
    let lo = lowest.max(q_lo - slack).min(reference - 4.0);
    let hi = highest.min(q_hi + slack).max(reference + 4.0);
    let pad = 0.04 * (hi - lo);
    lo - pad..hi + pad
}

/// The range of values about 1, which is part of the picture, and which noise does not fill.
pub(crate) fn about_one(values: &[f64]) -> Option<Range<f64>> {
    let (lowest, highest) = extent(values)?;
    let (lowest, highest) = (lowest.clamp(0.0, 0.98), highest.max(1.02));
    let pad = 0.06 * (highest - lowest);
    Some((lowest - pad).max(0.0)..highest + pad)
}

/// The smallest and the largest.
pub(crate) fn extent(values: &[f64]) -> Option<(f64, f64)> {
    let first = *values.first()?;
    Some(values.iter().fold((first, first), |(lo, hi), &v| (lo.min(v), hi.max(v))))
}

fn quantile(values: &[f64], q: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(((sorted.len().max(1) - 1) as f64 * q).round() as usize).copied()
}
