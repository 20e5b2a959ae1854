//! Values along the first axis of a panel: the one list behind the window's curves and the report's.

use std::ops::Range;

use super::Panel;
use super::ranges::{anisotropy_range, top_of};
use crate::estimate::Analysis;

/// Of a bin or ring: low end, label, high end.
pub(crate) type Interval = (f64, f64, f64);

/// A value of a bin or ring with the two ends of its band, and its closed form.
pub(crate) struct Sample {
    pub(crate) interval: Interval,
    pub(crate) value: Option<f64>,
    pub(crate) band: Option<(f64, f64)>,
    pub(crate) closed_form: Option<f64>,
}

/// What a panel of curves shows.
pub(crate) struct Samples {
    pub(crate) all: Vec<Sample>,
    /// What complete randomness would be.
    pub(crate) reference: f64,
    /// What is drawn on a linear scale.
    pub(crate) range: Range<f64>,
}

impl Samples {
    pub(crate) fn values(&self) -> impl Iterator<Item = (Interval, Option<f64>)> {
        self.all.iter().map(|s| (s.interval, s.value))
    }

    pub(crate) fn bands(&self) -> impl Iterator<Item = (Interval, Option<(f64, f64)>)> {
        self.all.iter().map(|s| (s.interval, s.band))
    }

    pub(crate) fn closed_form(&self) -> impl Iterator<Item = (Interval, Option<f64>)> {
        self.all.iter().map(|s| (s.interval, s.closed_form))
    }
}

impl Panel {
    /// `None` where the analysis has no such curve, or the panel is none of curves.
    pub(crate) fn samples(self, analysis: &Analysis) -> Option<Samples> {
        let finite = |value: f64| value.is_finite().then_some(value);
        let around = |value: f64, se: f64| (value.is_finite() && se.is_finite()).then_some((value - se, value + se));
        match self {
            Self::Pcf => {
                let pcf = analysis.pair_correlation()?;
                let closed = analysis.closed_form.g.as_deref().unwrap_or_default();
                let samples = pcf.r.iter().enumerate().map(|(b, &r)| Sample {
                    interval: (pcf.r_lo[b], r, pcf.r_hi[b]),
                    value: finite(pcf.g[b]),
                    band: around(pcf.g[b], pcf.g_se[b]),
                    closed_form: closed.get(b).copied(),
                });
                let values: Vec<_> = pcf.g.iter().copied().zip(pcf.g_se.iter().copied()).collect();
                Some(Samples { all: samples.collect(), reference: 1.0, range: 0.0..top_of(&values, closed) })
            }
            Self::Radial => {
                let radial = analysis.radial()?;
                let closed = analysis.closed_form.radial.as_deref().unwrap_or_default();
                let samples = radial.rings.iter().enumerate().map(|(k, ring)| Sample {
                    interval: (ring.nu_lo, ring.nu, ring.nu_hi),
                    value: finite(ring.p),
                    band: around(ring.p, ring.p_se),
                    closed_form: closed.get(k).copied(),
                });
                let values: Vec<_> = radial.rings.iter().map(|r| (r.p, r.p_se)).collect();
                Some(Samples { all: samples.collect(), reference: 1.0, range: 0.0..top_of(&values, closed) })
            }
            Self::Anisotropy if analysis.domain.dim() > 1 => {
                let radial = analysis.radial()?;
                let reference = radial.anisotropy_reference_db;
                let samples = radial.rings.iter().map(|ring| Sample {
                    interval: (ring.nu_lo, ring.nu, ring.nu_hi),
                    value: ring.anisotropy_db.and_then(finite),
                    band: ring.anisotropy_db_se.and_then(|se| around(reference, se)),
                    closed_form: None,
                });
                Some(Samples { all: samples.collect(), reference, range: anisotropy_range(radial) })
            }
            Self::Anisotropy | Self::Points | Self::Spectrum | Self::Vector | Self::Integration => None,
        }
    }
}
