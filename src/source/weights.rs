//! What must be known of the weights of points.

use crate::points::Ensemble;

/// What must be known of all weights before any is used.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Weights {
    /// The largest magnitude.
    pub(super) largest: f64,
    /// The largest that is the second largest of its realization; `None` where no realization has two points.
    pub(super) second: Option<f64>,
    /// The first below 0, and where it stands.
    pub(super) negative: Option<(String, f64)>,
}

impl Weights {
    /// Of points that are there; every point weighs 1 where there are none.
    pub(super) fn of(ensemble: &Ensemble) -> Self {
        let mut all = Self::default();
        for k in 0..ensemble.realizations() {
            let place = |j| format!("realization {k}, point {j}");
            match ensemble.weights(k) {
                Some(weights) => all.see(weights, place),
                None => all.see(&[1.0, 1.0], place),
            }
        }
        all
    }

    /// Takes another realization into account.
    pub(super) fn see(&mut self, weights: &[f64], place: impl Fn(usize) -> String) {
        let [mut first, mut second] = [None::<f64>; 2];
        for (j, &w) in weights.iter().enumerate() {
            self.largest = self.largest.max(w.abs());
            if w < 0.0 && self.negative.is_none() {
                self.negative = Some((place(j), w));
            }
            (first, second) = match (first, second) {
                (Some(a), _) if w <= a => (first, Some(second.map_or(w, |b| b.max(w)))),
                _ => (Some(w), first),
            };
        }
        self.second = self.second.into_iter().chain(second).reduce(f64::max);
    }
}
