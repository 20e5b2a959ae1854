//! The scalars of a spectrum, for `summary.json` and for the page.

use serde::Serialize;

use crate::display::{human, with_error};
use crate::estimate::{
    BandLaw, CONFIDENCE, Diaphony, LagConsistency, LowFrequency, MANY_ORDINATES, MANY_REALIZATIONS, RadialSpectrum,
    SpectrumDetails,
};

/// What the confidence bands rest on.
#[derive(Serialize)]
pub(super) struct BandsOut {
    confidence: f64,
    /// Rings whose band takes ordinates as exponential.
    chi_squared_rings: usize,
    /// Rings whose band is a multiple of the standard error across realizations.
    standard_error_rings: usize,
    /// The least numbers of realizations and of ordinates for the latter.
    standard_error_from: (u64, f64),
}

impl BandsOut {
    pub(super) fn new(radial: &RadialSpectrum) -> Self {
        let rings = |law| radial.rings.iter().filter(|r| r.band.is_some_and(|b| b.law == law)).count();
        Self {
            confidence: CONFIDENCE,
            chi_squared_rings: rings(BandLaw::ChiSquared),
            standard_error_rings: rings(BandLaw::StandardError),
            standard_error_from: (MANY_REALIZATIONS, MANY_ORDINATES),
        }
    }
}

/// Frequencies in cycles per unit length, the rest dimensionless; `null` where undefined.
#[derive(Serialize)]
pub(super) struct ScalarsOut {
    /// In units of `sqrt(lambda) / 2`.
    effective_nyquist: Option<f64>,
    oscillation: Option<f64>,
    oscillation_range: Option<[f64; 2]>,
    low_frequency: Option<LowFrequency>,
    high_frequency: Option<HighOut>,
    diaphony: Option<Diaphony>,
}

#[derive(Serialize)]
struct HighOut {
    range: [f64; 2],
    p: f64,
    p_se: f64,
    p_band: Option<[f64; 2]>,
    band: Option<BandLaw>,
}

/// Whether g and P agree.
#[derive(Serialize)]
pub(super) struct ConsistencyOut {
    /// P(nu) from g(r), against the ring means.
    radial: Option<RadialConsistency>,
    /// P(m) from lag counts, against P(m).
    lags: Option<LagConsistency>,
}

#[derive(Serialize)]
struct RadialConsistency {
    r_max: f64,
    rms: f64,
    rms_in_standard_errors: f64,
}

impl ScalarsOut {
    pub(super) fn new(details: &SpectrumDetails) -> Self {
        let s = &details.scalars;
        Self {
            effective_nyquist: s.blue_noise.and_then(|b| b.effective_nyquist),
            oscillation: s.blue_noise.and_then(|b| b.oscillation),
            oscillation_range: s.blue_noise.and_then(|b| b.oscillation_range),
            low_frequency: s.low_frequency,
            high_frequency: s.high_frequency.map(|h| HighOut {
                range: h.range,
                p: h.p,
                p_se: h.p_se,
                p_band: h.band.map(|b| [b.lo, b.hi]),
                band: h.band.map(|b| b.law),
            }),
            diaphony: s.diaphony,
        }
    }
}

impl ConsistencyOut {
    /// `None` where g and P were not both measured.
    pub(super) fn new(details: &SpectrumDetails) -> Option<Self> {
        let radial = details.of_pcf.as_ref().map(|s| RadialConsistency {
            r_max: s.r_max,
            rms: s.rms,
            rms_in_standard_errors: s.rms_in_standard_errors,
        });
        (radial.is_some() || details.lags.is_some()).then_some(Self { radial, lags: details.lags })
    }
}

/// Rows of (name, value) in HTML, for what is defined.
pub(super) fn rows(details: &SpectrumDetails) -> Vec<(String, String)> {
    let s = &details.scalars;
    let mut rows = Vec::new();
    let mut row = |name: &str, value: String| rows.push((name.to_string(), value));
    if let Some(nyquist) = s.blue_noise.and_then(|b| b.effective_nyquist) {
        row("Effective Nyquist frequency", format!("{} · √<i>λ</i> / 2", human(nyquist)));
    }
    if let Some((value, [lo, hi])) = s.blue_noise.and_then(|b| b.oscillation.zip(b.oscillation_range)) {
        row("Oscillations", format!("{} (<i>ν</i> from {} to {})", human(value), human(lo), human(hi)));
    }
    if let Some(low) = &s.low_frequency {
        let [lo, hi] = low.range.map(human);
        // As in structure-factor, whose own example is below 0 too.
        let below = match low.hyperuniformity_index < 0.0 {
            true => {
                "; below 0: the line through a curve that bends upward from 0; at most 10<sup>-3</sup> counts as hyperuniform"
            }
            false => "",
        };
        let h = with_error(low.hyperuniformity_index, Some(low.hyperuniformity_index_se));
        row(
            "Hyperuniformity index <i>P</i>(0) / <i>P</i>(peak)",
            format!("{h} (line through {} rings, <i>ν</i> from {lo} to {hi}){below}", low.rings),
        );
        let exponent = match (low.exponent, low.exponent_interval) {
            (Some(b), Some([from, to])) => {
                format!("{} (95 %: {} to {}; the same rings)", human(b), human(from), human(to))
            }
            _ => "undefined: <i>P</i> is 0 in a ring".into(),
        };
        row("Exponent <i>b</i> of <i>P</i> ~ <i>ν<sup>b</sup></i> at low frequency", exponent);
    }
    if let Some(high) = &s.high_frequency {
        let [lo, hi] = high.range.map(human);
        let value = with_error(high.p, Some(high.p_se));
        row("Mean of <i>P</i> at high frequency", format!("{value} (<i>ν</i> from {lo} to {hi})"));
    }
    if let Some(d) = &s.diaphony {
        let tail = human(d.tail_squared / (d.tail_squared + d.grid_squared));
        row("Diaphony", format!("{} (part of its square beyond the grid: {tail})", human(d.diaphony)));
    }
    if let Some(c) = &details.of_pcf {
        row(
            "<i>P</i>(<i>ν</i>) from <i>g</i>(<i>r</i>) against <i>P</i>(<i>ν</i>)",
            format!("rms difference {}, {} standard errors", human(c.rms), human(c.rms_in_standard_errors)),
        );
    }
    if let Some(c) = &details.lags {
        row(
            "<i>P</i>(<b>m</b>) from <i>g</i>(<b>h</b>) against <i>P</i>(<b>m</b>)",
            format!("rms difference {}, expected of aliasing {}", human(c.rms), human(c.expected_rms)),
        );
    }
    rows
}
