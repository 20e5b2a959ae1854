//! A look at all points, once, before any is used.

use std::collections::HashMap;

use serde_json::json;
use xxhash_rust::xxh3::Xxh3Default;

use super::files::{Files, Marking};
use super::weights::Weights;
use super::{Kind, Points, domain};
use crate::error::{Error, Result};
use crate::points::read::MarkedPoints;
use crate::points::{Domain, Ensemble, EnsembleShape};
use crate::request::PointsRequest;
use crate::setting::Setting;

/// What a look at all points, once, finds out.
pub(super) struct FirstPass<'a> {
    pub(super) request: &'a PointsRequest,
    pub(super) dim: Option<usize>,
    pub(super) sizes: Vec<u64>,
    pub(super) hash: Xxh3Default,
    pub(super) weights: Weights,
    pub(super) names: Vec<String>,
    pub(super) numbers: HashMap<String, u32>,
}

impl<'a> FirstPass<'a> {
    pub(super) fn new(request: &'a PointsRequest) -> Self {
        Self {
            request,
            dim: None,
            sizes: Vec::new(),
            hash: Xxh3Default::new(),
            weights: Weights::default(),
            names: Vec::new(),
            numbers: HashMap::new(),
        }
    }

    pub(super) fn domain(&self) -> Result<Domain> {
        let nothing = || Error::input("points", "the files hold no realizations");
        domain(self.request, self.dim.ok_or_else(nothing)?)
    }

    pub(super) fn see(&mut self, sets: &[MarkedPoints]) {
        for set in sets {
            self.dim.get_or_insert(set.points.dim);
            self.sizes.push(set.points.len() as u64);
            self.hash.update(&(set.points.len() as u64).to_le_bytes());
            for x in set.points.coordinates.iter().chain(&set.weights) {
                self.hash.update(&x.to_le_bytes());
            }
            self.weights.see(&set.weights, |j| set.points.place(j));
            for label in &set.labels {
                self.hash.update(&(label.len() as u64).to_le_bytes());
                self.hash.update(label.as_bytes());
                if !self.numbers.contains_key(label) {
                    self.numbers.insert(label.clone(), self.names.len() as u32);
                    self.names.push(label.clone());
                }
            }
        }
    }

    /// Whether points that are not held can be used.
    pub(super) fn check(&self, sets: &[MarkedPoints]) -> Result<()> {
        let domain = self.domain()?;
        for set in sets {
            Ensemble::from_raw(std::slice::from_ref(&set.points), &domain, self.request.wrap, 0)?;
        }
        Ok(())
    }

    pub(super) fn finish(
        self,
        subject: String,
        held: Option<Vec<MarkedPoints>>,
        files: impl FnOnce(Marking) -> Files,
    ) -> Result<Points> {
        let domain = self.domain()?;
        let Self { request, sizes, hash, weights, names, numbers, .. } = self;
        let mut marks = Marking {
            wrap: request.wrap,
            largest: request.weight_column.is_some().then_some(weights.largest),
            classes: request.class_column.is_some().then_some(numbers),
        };
        let no_weight = marks.largest == Some(0.0);
        if no_weight {
            // What is wrong with the points is said first.
            marks.largest = None;
        }
        let kind = match held {
            Some(sets) => Kind::Held(marks.ensemble(sets, &domain, 0)?),
            None => Kind::Files(files(marks)),
        };
        if let Some(column) = request.weight_column.as_ref().filter(|_| no_weight) {
            return Err(Error::setting(Setting::WeightColumn, column, "all weights are 0"));
        }
        let identity = json!({
            "digest": format!("{:032x}", hash.digest128()),
            "weights": request.weight_column,
            "classes": request.class_column,
            "wrap": request.wrap,
        });
        Ok(Points { subject, domain, shape: EnsembleShape::of(&sizes), identity, classes: names, weights, kind })
    }
}
