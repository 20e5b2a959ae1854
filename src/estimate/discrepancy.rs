//! Discrepancies in a few numbers. See `docs/discrepancy.md`.

use crate::accumulate::{DISCREPANCIES, DiscrepancySums, LevelCounts, RealizationDiscrepancy};
use crate::estimate::{Analysis, mean, standard_error};

/// All that `discrepancy` stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct Discrepancies {
    /// In the order of `DISCREPANCIES`.
    pub each: [Discrepancy; DISCREPANCIES.len()],
    /// Least distance of two points, over the realizations that have two.
    pub minimum: Option<Length>,
    /// Covering radius, in 1 to 3 dimensions.
    pub covering: Option<Length>,
    /// The largest bound of the covering radius over realizations.
    pub covering_bound: Option<f64>,
    /// The quality t of nets in base 2, over the realizations of 2^m points.
    pub t: Option<NetQuality>,
    /// Per level k, the kinds of elementary intervals of volume 2^-k and those with as many points each, over realizations.
    pub levels: Vec<LevelCounts>,
    /// What they are of, realization by realization.
    pub realizations: Vec<RealizationDiscrepancy>,
}

/// One discrepancy D over realizations.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Discrepancy {
    /// Mean of D.
    pub mean: f64,
    /// Its standard error (K >= 2).
    pub mean_se: Option<f64>,
    /// Mean of D squared.
    pub squared: f64,
    /// Its standard error (K >= 2).
    pub squared_se: Option<f64>,
}

/// A length of each realization.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Length {
    /// The least over realizations.
    pub least: f64,
    /// The largest.
    pub largest: f64,
    /// Mean over realizations.
    pub mean: f64,
    /// Its standard error (K >= 2).
    pub mean_se: Option<f64>,
    /// The mean of it over the distance of neighbours in the closest packing known of as many points.
    pub relative: f64,
}

/// t over realizations.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct NetQuality {
    /// The best.
    pub least: u32,
    /// The worst.
    pub largest: u32,
    /// Mean.
    pub mean: f64,
    /// How many realizations have 2^m points.
    pub realizations: u64,
}

impl Discrepancies {
    /// Of the sums; `None` without realizations.
    pub fn new(sums: &DiscrepancySums) -> Option<Self> {
        let all = &sums.realizations;
        let each = |kind: usize| {
            let squares: Vec<f64> = all.iter().map(|r| r.squares[kind]).collect();
            let roots: Vec<f64> = squares.iter().map(|square| square.sqrt()).collect();
            Some(Discrepancy {
                mean: mean(&roots)?,
                mean_se: standard_error(&roots),
                squared: mean(&squares)?,
                squared_se: standard_error(&squares),
            })
        };
        let [Some(a), Some(b), Some(c), Some(d), Some(e)] = std::array::from_fn(each) else { return None };
        let t: Vec<u32> = all.iter().filter_map(RealizationDiscrepancy::t).collect();
        let quality = || {
            let mean = mean(&t.iter().map(|&t| f64::from(t)).collect::<Vec<_>>())?;
            Some(NetQuality { least: *t.iter().min()?, largest: *t.iter().max()?, mean, realizations: t.len() as u64 })
        };
        let bounds = all.iter().filter_map(|r| Some(r.covering?[1]));
        Some(Self {
            each: [a, b, c, d, e],
            minimum: length(all.iter().filter_map(|r| Some((r.minimum?, r.closest_packing)))),
            covering: length(all.iter().filter_map(|r| Some((r.covering?[0], r.closest_packing))))
                .map(Length::within_search),
            covering_bound: bounds.reduce(f64::max),
            t: quality(),
            levels: sums.levels.clone(),
            realizations: all.clone(),
        })
    }
}

impl Length {
    /// Of radii that were searched for to 1e-9: they scatter by no less.
    fn within_search(self) -> Self {
        Self { mean_se: self.mean_se.map(|se| se.max(1e-9 * self.mean)), ..self }
    }
}

/// Of lengths, each with what it is relative to.
fn length(values: impl Iterator<Item = (f64, f64)>) -> Option<Length> {
    let (values, relative): (Vec<f64>, Vec<f64>) = values.map(|(x, to)| (x, x / to)).unzip();
    Some(Length {
        least: values.iter().copied().fold(f64::INFINITY, f64::min),
        largest: values.iter().copied().fold(0.0, f64::max),
        mean: mean(&values)?,
        mean_se: standard_error(&values),
        relative: mean(&relative)?,
    })
}

impl Analysis {
    /// Discrepancies.
    pub fn discrepancies(&self) -> Option<&Discrepancies> {
        self.get()
    }
}
