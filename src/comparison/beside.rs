//! Other points measured as those of a result were, so that both can be compared row by row.

use std::path::Path;

use serde_json::Value;

use crate::error::{Error, Result};
use crate::report::Stored;
use crate::request::{Group, Request, SETTINGS};
use crate::samplers;
use crate::setting::Setting;

/// Whether a request can be made of other points, asked before the long work.
///
/// # Errors
/// What is neither a file nor a sampler; a window, which samplers do not draw in.
pub fn check_beside(request: &Request, spec: &str) -> Result<()> {
    sampler(request, spec).map(drop)
}

/// What marks the points of a request and is left out beside a sampler, whose points have none, in words; nothing where nothing is.
pub fn unmarked(request: &Request, beside: &Request) -> Option<String> {
    let marks = [Setting::WeightColumn, Setting::IntensityColumn, Setting::ClassColumn, Setting::Classes];
    let rows = marks.into_iter().filter_map(Setting::row);
    let lost = rows.filter(|row| row.is_given(request) && !row.is_given(beside));
    let words: Vec<String> =
        lost.map(|row| format!("{} {}", row.setting.mention(), request.value(row.setting))).collect();
    let name = beside.input.sampler.as_deref().unwrap_or_default();
    (!words.is_empty()).then(|| format!("measured without {}: points of {name} have none", words.join(" and ")))
}

/// The sampler that a specification names with its parameters; none where it is files.
fn sampler<'a>(request: &Request, spec: &'a str) -> Result<Option<(&'static str, Vec<&'a str>)>> {
    if Path::new(spec).exists() || spec.contains(['*', '/', '\\']) {
        return Ok(None);
    }
    let (entry, params) = samplers::find_with_parameters(spec).map_err(|error| match error {
        Error::Setting { reason, .. } => {
            Error::setting(Setting::Beside, spec, format!("is neither a file nor a sampler: {reason}"))
        }
        other => other,
    })?;
    for setting in [Setting::Window, Setting::WindowPolygon] {
        if setting.row().is_some_and(|row| row.is_given(request)) {
            let reason = format!("is a sampler, which draws on a torus; expected files, or no {}", setting.mention());
            return Err(Error::setting(Setting::Beside, spec, reason));
        }
    }
    Ok(Some((entry.name, params)))
}

/// The request of a result for other points: files, where there are such, or a sampler, NAME or NAME:key=value,..., that draws as many points and
/// realizations as the result has. Distances and frequencies reach as far as its.
///
/// # Errors
/// As `check_beside`; what is no result.
pub fn beside(request: &Request, spec: &str, result: &Path) -> Result<Request> {
    let stored = Stored::open(result)?;
    let number = |pointer: &str| stored.value(pointer).and_then(Value::as_f64);
    let mut other = request.clone();
    let sampler = sampler(request, spec)?;
    let as_many = request.input.realizations.filter(|_| request.input.sampler.is_some());
    for row in &SETTINGS {
        let left_out = match (row.setting, &sampler) {
            (Setting::Files | Setting::Sampler, _) => true,
            // It draws simulations too.
            (Setting::Seed, None) => request.envelope.is_none(),
            (_, None) => row.for_samplers,
            (Setting::Wrap, Some(_)) => true,
            (_, Some(_)) => row.group == Group::Points && row.conflicts.contains(&Setting::Sampler),
        };
        if left_out {
            other.set(row.setting, "")?;
        }
    }
    // What says more about something goes with it.
    for row in SETTINGS.iter().filter(|row| row.is_given(request)) {
        if row.needs.and_then(Setting::row).is_some_and(|needed| needed.is_given(request) && !needed.is_given(&other)) {
            other.set(row.setting, "")?;
        }
    }
    match sampler {
        None => other.input.files = vec![spec.into()],
        Some((name, params)) => {
            other.input.sampler = Some(name.into());
            other.input.params = params.into_iter().map(String::from).collect();
            other.input.points = number("/n/mean").map(|n| n.round() as u64);
            // The first may have ended early.
            other.input.realizations = as_many.or_else(|| number("/k").map(|k| k as u64));
            other.input.dim = number("/d").map(|d| d as usize);
            let sides = stored.value("/domain/sides").and_then(Value::as_array);
            let sides: Option<Vec<f64>> = sides.map(|sides| sides.iter().filter_map(Value::as_f64).collect());
            other.input.sides = other.input.sides.or(sides.filter(|sides| sides.iter().any(|side| *side != 1.0)));
        }
    }
    if other.edges.is_none() {
        let reach = number("/pair_correlation/r_max").or_else(|| number("/k_function/r_max"));
        other.r_max = other.r_max.or(reach);
    }
    if other.frequencies.is_none() && other.max_frequency.is_none() {
        let most = stored.value("/spectrum/max_frequency").and_then(Value::as_array);
        let most: Option<Vec<u32>> = most.map(|most| most.iter().filter_map(|f| Some(f.as_u64()? as u32)).collect());
        other.max_frequency = most.filter(|most| !most.is_empty());
    }
    Ok(other)
}
