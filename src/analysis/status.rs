//! How far a measurement is, in numbers and in words.

use crate::display::human;

/// How far a `Measurement` is, and what it was spared.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Status {
    /// What each group of sums is at.
    pub tracks: Vec<TrackStatus>,
    /// Realizations asked for.
    pub total: u64,
    /// Unordered pairs in the realizations done, looked at or not.
    pub pairs: f64,
    /// Points times stored wave vectors in the realizations done.
    pub products: f64,
    /// Seconds per stage.
    pub timings: Vec<(&'static str, f64)>,
}

/// Of one group of sums.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct TrackStatus {
    /// Its name.
    pub name: &'static str,
    /// Realizations it holds.
    pub done: u64,
    /// How many of them were there before the last change of settings, which did not touch them.
    pub kept: u64,
    /// Whether they were binned anew rather than counted.
    pub rebinned: bool,
}

impl Status {
    /// Realizations that are in all sums that are wanted.
    pub fn done(&self) -> u64 {
        self.tracks.iter().map(|t| t.done).min().unwrap_or(self.total).min(self.total)
    }

    /// The part of the work that is done, 0 to 1, every group of sums counted alike.
    pub fn fraction(&self) -> f64 {
        let part = |done: u64| done.min(self.total) as f64 / self.total.max(1) as f64;
        let parts: Vec<f64> = self.tracks.iter().map(|t| part(t.done)).collect();
        if parts.is_empty() { 1.0 } else { parts.iter().sum::<f64>() / parts.len() as f64 }
    }

    /// `K = 37 of 200`.
    pub fn progress(&self) -> String {
        if self.done() == self.total {
            format!("K = {}", self.total)
        } else {
            format!("K = {} of {}", self.done(), self.total)
        }
    }

    /// `1.05×10⁸ pairs, 2.1×10⁹ point-frequency products`; what there is none of is left out.
    pub fn work(&self) -> String {
        let parts = [(self.pairs, "pairs"), (self.products, "point-frequency products")];
        let said =
            parts.into_iter().filter(|(count, _)| *count > 0.0).map(|(count, of)| format!("{} {of}", human(count)));
        said.collect::<Vec<_>>().join(", ")
    }

    /// Seconds in all stages, `0.35 s`.
    pub fn time(&self) -> String {
        format!("{} s", human((self.timings.iter().map(|(_, s)| s).sum::<f64>() * 1e3).round() / 1e3))
    }

    /// What a change of settings was spared: `pairs: 200 realizations kept, binned anew`. Empty where everything is new.
    pub fn spared(&self) -> String {
        let kept = self.tracks.iter().filter(|t| t.kept > 0);
        let said = kept.map(|t| {
            let anew = if t.rebinned { ", binned anew" } else { "" };
            format!("{}: {} kept{anew}", t.name, t.kept)
        });
        said.collect::<Vec<_>>().join("; ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_reads_well() {
        let track = |name, done, kept, rebinned| TrackStatus { name, done, kept, rebinned };
        let tracks = vec![track("pairs", 200, 100, true), track("waves", 50, 0, false)];
        let timings = vec![("points", 0.25), ("pair_counts", 0.1004)];
        let status = Status { tracks, total: 200, pairs: 1.05e8, products: 0.0, timings };
        assert_eq!((status.done(), status.fraction()), (50, 0.625));
        assert_eq!(status.progress(), "K = 50 of 200");
        assert_eq!(status.work(), "1.05×10⁸ pairs");
        assert_eq!(status.time(), "0.35 s");
        assert_eq!(status.spared(), "pairs: 100 kept, binned anew");
        let nothing = Status { tracks: Vec::new(), total: 1, pairs: 0.0, products: 0.0, timings: Vec::new() };
        assert_eq!((nothing.done(), nothing.fraction(), nothing.progress()), (1, 1.0, "K = 1".into()));
        assert_eq!((nothing.work(), nothing.spared()), (String::new(), String::new()));
    }
}
