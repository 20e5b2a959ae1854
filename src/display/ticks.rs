//! Round numbers along an axis.

use std::ops::Range;

use super::text::tick;

/// Round numbers in a range, about `target` of them, with their labels.
pub(crate) fn ticks(range: &Range<f64>, target: u32) -> Vec<(f64, String)> {
    let raw = (range.end - range.start) / f64::from(target);
    if !(raw > 0.0 && raw.is_finite()) {
        return Vec::new();
    }
    let decade = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].iter().map(|m| m * decade).find(|&s| s >= raw * 0.7).unwrap_or(10.0 * decade);
    let (first, last) = ((range.start / step - 1e-9).ceil() as i64, (range.end / step + 1e-9).floor() as i64);
    (first..=last).map(|k| k as f64 * step).map(|t| (t, tick(t, step))).collect()
}

/// Decades of a logarithmic range, and 2 and 5 of each where there are few.
pub(crate) fn log_ticks(range: &Range<f64>) -> Vec<(f64, String)> {
    let (lo, hi) = (range.start.log10(), range.end.log10());
    let multiples: &[f64] = if hi - lo < 3.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let decades = lo.floor() as i32..=hi.ceil() as i32;
    let all = decades.flat_map(|e| multiples.iter().map(move |m| m * 10f64.powi(e)));
    let inside = range.start * (1.0 - 1e-9)..range.end * (1.0 + 1e-9);
    all.filter(|t| inside.contains(t)).map(|t| (t, super::human(t))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |r: Range<f64>| ticks(&r, 6).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(labels(0.0..0.27), ["0", "0.05", "0.10", "0.15", "0.20", "0.25"]);
        assert_eq!(labels(-50.0..5.0), ["−50", "−40", "−30", "−20", "−10", "0"]);
        assert!(labels(1.0..1.0).is_empty());
        let decades = log_ticks(&(1e-3..0.5)).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(decades[..4], ["0.001", "0.002", "0.005", "0.01"]);
    }
}
