//! What the colours of a picture stand for.

use crate::display::{ColorMap, human};
use crate::statistics::Bar;

/// A bar of colours with its values, in HTML.
pub(in crate::report) fn color_bar(bar: &Bar) -> String {
    match bar {
        Bar::Sequential(ticks) => {
            let label = |(at, label): &(f64, String)| format!("<i style=\"left: {:.2}%\">{label}</i>", 100.0 * at);
            let labels: String = ticks.iter().map(label).collect();
            scale(ColorMap::Viridis, &format!("<p>{labels}</p>"))
        }
        Bar::AboutOne(range) => {
            let [low, high] = range.map(human);
            let low = if range[0] == 0.0 { low } else { format!("≤ {low}") };
            scale(ColorMap::BlueRed, &format!("<div><i>{low}</i><i>g = 1</i><i>≥ {high}</i></div>"))
        }
    }
}

fn scale(colors: ColorMap, values: &str) -> String {
    let stops = (0..=16).map(|k| colors.color(f64::from(k) / 16.0)).map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"));
    let stops = stops.collect::<Vec<_>>().join(", ");
    format!("<div class=\"scale\"><span style=\"background: linear-gradient(to right, {stops})\"></span>{values}</div>")
}
