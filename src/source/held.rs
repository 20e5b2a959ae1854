//! Points in memory with their marks: all of a batch, or some realizations of a stream.

use serde_json::json;

use super::files::Files;
use super::first_pass::FirstPass;
use super::{Kind, Points};
use crate::control::Control;
use crate::error::{Error, Result};
use crate::plan::LEAF;
use crate::points::EnsembleShape;
use crate::points::read::{Columns, MarkedPoints, ReadOptions};
use crate::request::{PointsRequest, Request, Row, SETTINGS};
use crate::setting::Setting;

/// What of a request says how points are read, and nothing of points that are there.
const OF_READING: [Setting; 7] = [
    Setting::Files,
    Setting::Sampler,
    Setting::Raw,
    Setting::Array,
    Setting::Columns,
    Setting::RealizationColumn,
    Setting::KeepGoing,
];

impl Points {
    /// Realizations in memory, in the domain of the request, folded as it says. `weight_column`, `intensity_column` and
    /// `class_column` say that the sets have such marks; their values are names for them.
    ///
    /// # Errors
    /// A point outside the domain, by its place; marks that are none; settings that say how files are read; no realizations.
    pub fn marked(sets: Vec<MarkedPoints>, request: &PointsRequest, control: &Control) -> Result<Self> {
        Self::marked_alone(sets, request)?.with_intensity(request, control)?.with_simulations(request, control)
    }

    fn marked_alone(sets: Vec<MarkedPoints>, request: &PointsRequest) -> Result<Self> {
        let asked = Request { input: request.clone(), ..Request::default() };
        let says = |row: &&Row| row.for_samplers || OF_READING.contains(&row.setting);
        // A seed is of simulations too.
        let given = |row: &&Row| row.setting != Setting::Seed && row.is_given(&asked);
        if let Some(row) = SETTINGS.iter().filter(says).find(given) {
            let reason = "says where points come from, and they are here";
            return Err(Error::setting(row.setting, asked.value(row.setting), reason));
        }
        if sets.is_empty() {
            return Err(Error::input("points in memory", "there are no realizations; expected one or more"));
        }
        same_dim(&sets)?;
        let mut pass = FirstPass::new(request)?;
        pass.see(&sets)?;
        pass.finish("points in memory".into(), Some(sets), |marks| {
            Files::none(ReadOptions::default(), Columns::default(), marks)
        })
    }

    /// Whether realizations in memory can be used, before any of them is.
    ///
    /// # Errors
    /// As `marked`.
    pub fn check_sets(sets: &[MarkedPoints], request: &PointsRequest) -> Result<()> {
        same_dim(sets)?;
        FirstPass::new(request)?.accepts(sets)
    }

    /// Realizations of a stream, from `first` on: parts of a stream are measured apart and merged, whatever the others are. What
    /// is planned by the number and size of realizations follows from `whole`, which all parts of it share. `name` tells streams
    /// apart.
    ///
    /// # Errors
    /// As `marked`; marks, which are relative to those of all realizations; a part that does not begin at a multiple of 16.
    pub fn of_stream(
        name: &str,
        sets: Vec<MarkedPoints>,
        first: u64,
        whole: EnsembleShape,
        request: &PointsRequest,
    ) -> Result<Self> {
        let marks = [
            Setting::WeightColumn,
            Setting::IntensityColumn,
            Setting::ClassColumn,
            Setting::Inhomogeneous,
            Setting::EnvelopeFrom,
        ];
        let asked = Request { input: request.clone(), ..Request::default() };
        let given = |setting: &&Setting| setting.row().is_some_and(|row| row.is_given(&asked));
        if let Some(setting) = marks.iter().find(given) {
            let reason = "is relative to all realizations, and of a stream only some are known; expected all at once";
            return Err(Error::setting(*setting, asked.value(*setting), reason));
        }
        let place = format!("realizations from {first} on");
        if !first.is_multiple_of(LEAF) || first.saturating_add(sets.len() as u64) > whole.realizations {
            let reason = format!("expected a part of 0..{} that begins at a multiple of {LEAF}", whole.realizations);
            return Err(Error::input(place, reason));
        }
        let part = Self::marked_alone(sets, request)?;
        let Kind::Held(ensemble) = part.kind else { return Err(Error::input(place, "are not in memory")) };
        if ensemble.shape().max_points > whole.max_points {
            let reason =
                format!("up to {} points; the whole has up to {}", ensemble.shape().max_points, whole.max_points);
            return Err(Error::input(place, reason));
        }
        Ok(Self {
            identity: json!({ "stream": name, "wrap": request.wrap }),
            shape: whole,
            prefixes: Vec::new(),
            sizes: Vec::new(),
            kind: Kind::Part(ensemble.numbered_from(first)),
            ..part
        })
    }
}

/// Whether all points have as many coordinates.
fn same_dim(sets: &[MarkedPoints]) -> Result<()> {
    let Some(first) = sets.first().map(|set| set.points.dim) else { return Ok(()) };
    match sets.iter().find(|set| set.points.dim != first) {
        Some(set) => {
            let reason = format!("has {} coordinates per point, the first realization {first}", set.points.dim);
            Err(Error::input(&set.points.source, reason))
        }
        None => Ok(()),
    }
}
