//! What the colours of a picture stand for.

use std::fmt::Write as _;

use crate::display::{ColorMap, escape, human, untagged};
use crate::statistics::Bar;

/// Colours of a bar, each a strip.
const STRIPS: u32 = 128;

/// A bar of colours with its values, in HTML. It is as wide as there is room, its text always as large.
pub(in crate::report) fn color_bar(bar: &Bar) -> String {
    match bar {
        Bar::Sequential(ticks) => scale(ColorMap::Viridis, ticks, ["middle"; 2]),
        Bar::AboutOne(range) => {
            let [low, high] = range.map(human);
            let low = if range[0] == 0.0 { low } else { format!("≤ {low}") };
            scale(ColorMap::BlueRed, &[(0.0, low), (0.5, "g = 1".into()), (1.0, format!("≥ {high}"))], ["start", "end"])
        }
    }
}

/// `anchors`: how labels at the two ends stand.
fn scale(colors: ColorMap, ticks: &[(f64, String)], anchors: [&str; 2]) -> String {
    let values: Vec<_> = ticks.iter().map(|(_, label)| escape(&untagged(label))).collect();
    let mut svg = format!("<svg class=\"scale\" role=\"img\" aria-label=\"Colours from {}\">", values.join(", "));
    let width = 100.0 / f64::from(STRIPS);
    for k in 0..STRIPS {
        let [r, g, b] = colors.color(f64::from(k) / f64::from(STRIPS - 1));
        // A little wider, so that no line of the ground is between strips.
        let (x, wide) = (f64::from(k) * width, if k + 1 < STRIPS { width + 0.2 } else { width });
        let _ = write!(svg, "<rect x=\"{x:.3}%\" width=\"{wide:.3}%\" height=\"12\" fill=\"#{r:02x}{g:02x}{b:02x}\"/>");
    }
    for ((at, _), label) in ticks.iter().zip(values) {
        let anchor = match *at {
            0.0 => anchors[0],
            1.0 => anchors[1],
            _ => "middle",
        };
        let _ = write!(svg, "<text x=\"{:.2}%\" y=\"28\" text-anchor=\"{anchor}\">{label}</text>", 100.0 * at);
    }
    svg + "</svg>\n"
}
