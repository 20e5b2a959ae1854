//! Spectra as papers on sampling print them: grey, linear from P = 0 to 2, up to 4 cycles per mean spacing, anisotropy above that of
//! an isotropic spectrum.

use super::{Axis, ColorMap, Frame, FrequencyUnit, Pixels, ToneMap, spectrum_pixels};
use crate::estimate::Analysis;

/// P = 1 is the middle of the greys.
pub const TONES: ToneMap = ToneMap::Linear { max: 2.0 };

/// Black to white.
pub const COLORS: ColorMap = ColorMap::Grey;

/// The largest frequency shown, in cycles per mean spacing.
pub const REACH: f64 = 4.0;

/// The largest frequency shown, in cycles per unit length.
pub fn reach(analysis: &Analysis) -> f64 {
    REACH * FrequencyUnit::SqrtN.size(&analysis.domain, analysis.shape.mean_points)
}

/// P on the grid, DC masked; as `spectrum_pixels`.
pub fn pixels(analysis: &Analysis, most: usize) -> Option<Pixels> {
    spectrum_pixels(analysis, TONES, None, COLORS, Some(reach(analysis)), most)
}

/// A frame along an axis of frequencies, cut off where they end.
pub fn frame(frame: Frame, analysis: &Analysis, x: Axis) -> Frame {
    let end = x.forward(reach(analysis)).filter(|end| *end > frame.x[0]);
    Frame { x: [frame.x[0], end.map_or(frame.x[1], |end| end.min(frame.x[1]))], ..frame }
}
