//! What a window and a page both show, and no files: panels and what is drawn in them, units, ranges, ticks, colours and words.

mod color_map;
mod decimate;
pub(crate) mod figure;
mod lag_slices;
pub mod overlays;
mod panel;
pub mod paper;
mod pixels;
mod ranges;
mod readout;
mod samples;
mod text;
mod ticks;
mod tone_map;
mod trace;
mod units;
mod words;

pub use color_map::ColorMap;
pub(crate) use color_map::{diverging, sequential};
pub use decimate::{thinned_band, thinned_line};
pub use figure::Stroke;
pub(crate) use lag_slices::{LAG_QUANTILE, lag_color_range, lag_planes, lag_slice};
pub use panel::Panel;
pub(crate) use pixels::{DC, middle, peak};
pub use pixels::{Pixels, spectrum_pixels, vector_pixels, vector_reach, vector_ticks};
pub(crate) use ranges::{about_one, decades, defined_anisotropy, extent, grow, top_of};
pub use readout::{BinAt, LagAt, ModeAt, RingAt, bin_at, ring_at, spectrum_at, vector_at};
pub(crate) use samples::{Interval, Samples};
pub(crate) use text::{escape, human, shortened, untagged, with_error};
pub(crate) use ticks::{log_ticks, ticks};
pub use tone_map::ToneMap;
pub use trace::{Drawn, Frame, Trace};
pub(crate) use units::Units;
pub use units::{Axis, AxisScale, FrequencyUnit, LengthUnit};
pub(crate) use words::{error_note, inhomogeneous_caption, kernel_name, packing_symbol, size, size_and_weights};
