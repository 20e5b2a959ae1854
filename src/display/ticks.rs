//! Round numbers along an axis.

use std::ops::Range;

use super::text::tick;

/// With fewer ticks nobody can tell a scale.
const FEWEST: usize = 3;

/// Round numbers in a range, about `target` of them and never fewer than three, with their labels.
pub(crate) fn ticks(range: &Range<f64>, target: u32) -> Vec<(f64, String)> {
    let raw = (range.end - range.start) / f64::from(target);
    if !(raw > 0.0 && raw.is_finite()) {
        return Vec::new();
    }
    let decade = 10f64.powf(raw.log10().floor());
    let ends = |step: f64| ((range.start / step - 1e-9).ceil() as i64, (range.end / step + 1e-9).floor() as i64);
    let enough = |step: f64| ends(step).1 - ends(step).0 + 1 >= FEWEST as i64;
    let steps = [10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1].map(|m| m * decade);
    // From coarse to fine: the last that is coarse enough, unless it has too few.
    let coarse = steps.iter().rposition(|&s| s >= raw * 0.7).unwrap_or(0);
    let step = steps[coarse..].iter().copied().find(|&s| enough(s)).unwrap_or(steps[coarse]);
    let (first, last) = ends(step);
    // A product may be a rounding beyond the end.
    (first..=last).map(|k| (k as f64 * step).clamp(range.start, range.end)).map(|t| (t, tick(t, step))).collect()
}

/// Decades of a logarithmic range, and 2 and 5 of each where there are few; in less than a decade round numbers.
pub(crate) fn log_ticks(range: &Range<f64>) -> Vec<(f64, String)> {
    let (lo, hi) = (range.start.log10(), range.end.log10());
    let multiples: &[f64] = if hi - lo < 3.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let decades = lo.floor() as i32..=hi.ceil() as i32;
    let all = decades.flat_map(|e| multiples.iter().map(move |m| m * 10f64.powi(e)));
    let inside = range.start * (1.0 - 1e-9)..range.end * (1.0 + 1e-9);
    let found: Vec<_> = all.filter(|t| inside.contains(t)).map(|t| (t, super::human(t))).collect();
    if found.len() < FEWEST { ticks(range, FEWEST as u32) } else { found }
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
        let narrow = log_ticks(&(0.9..1.3)).into_iter().map(|t| t.1).collect::<Vec<_>>();
        assert_eq!(narrow, ["0.9", "1.0", "1.1", "1.2", "1.3"]);
    }

    #[test]
    fn there_are_never_fewer_than_three() {
        for (low, high) in
            [(0.0, 0.099), (-0.5, 0.5), (-7.9, 7.9), (0.95, 1.05), (3.0, 3.01), (-1e6, 1e6), (1e-9, 2e-9)]
        {
            for target in 1..9 {
                let linear = ticks(&(low..high), target);
                assert!(
                    linear.len() >= 3 && linear.iter().all(|t| (low..=high).contains(&t.0)),
                    "{low} {high}: {linear:?}"
                );
                if low > 0.0 {
                    assert!(log_ticks(&(low..high)).len() >= 3, "{low} {high}");
                }
            }
        }
    }
}
