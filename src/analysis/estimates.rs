//! What is known of the realizations that were measured so far.

use std::borrow::Cow;

use super::Measurement;
use crate::accumulate::{Backend, ComputedBy};
use crate::control::{Control, Instant};
use crate::error::{Result, plural};
use crate::estimate::Analysis;
use crate::setting::Setting;
use crate::statistics::group::{Part, PartSums, Subject};
use crate::statistics::targets::Standing;

impl Measurement {
    /// The estimates of what was measured so far; `None` before the first step.
    pub fn analysis(&self) -> Option<Analysis> {
        let start = Instant::now();
        let mut found = self.estimates(&Control::default()).ok()??;
        let source = &self.source;
        found.subject = source.subject().to_string();
        found.parameters = self.request.parameters();
        found.unit = self.request.input.unit;
        found.input = source.input().cloned();
        found.plan = self.plan.to_string();
        found.duplicates = self.duplicates;
        let missed = |standing: &Standing| (!standing.reached).then(|| standing.short_of());
        found.warnings.extend(self.standings.iter().flat_map(|standings| standings.0.iter().filter_map(missed)));
        found.findings.add(self.standings.clone());
        found.warnings.splice(0..0, self.warnings.iter().cloned());
        let mut clock = self.clock.clone();
        clock.add("estimates", start.elapsed().as_secs_f64());
        found.timings = clock.stages;
        Some(found)
    }

    /// The estimates, without the words about how they came about; `None` before the first step.
    ///
    /// # Errors
    /// `Error::Cancelled`, which is looked for before each group of sums.
    pub(super) fn estimates(&self, control: &Control) -> Result<Option<Analysis>> {
        control.check()?;
        let Some(first) = self.first.clone() else { return Ok(None) };
        let (request, shape, source) = (&self.request, self.shape(), &self.source);
        let subject = Subject { request, domain: source.domain(), process: source.process(), shape };
        let sums: Vec<(&dyn Part, Cow<'_, dyn PartSums>)> = (self.plan.parts.iter())
            .filter_map(|part| {
                let track = self.tracks.iter().find(|t| t.wanted && t.part.name() == part.name())?;
                // Both parts are of whole leaves, and measured by one plan.
                Some((part, track.sums().ok()??))
            })
            .collect();
        let by = sums.iter().filter_map(|(_, sums)| sums.computed_by().cloned()).reduce(|a, b| a.merge(&b));
        let by = by.unwrap_or_else(|| ComputedBy::new(Backend::Cpu, "cpu"));
        let mut found = Analysis::new(source.subject(), shape, first, by);
        found.domain = source.domain().clone();
        found.findings.add(source.inhomogeneity().cloned());
        found.min_points = self.sizes.least();
        found.conventions = request.conventions();
        found.accuracy = request.accuracy;
        if let Some(process) = subject.closed_forms() {
            found.closed_form.name = process.name.clone();
        }
        for (part, sums) in &sums {
            control.check()?;
            part.estimate(sums.as_ref(), &subject, &mut found);
        }
        found.warnings.extend(self.unweighted());
        if self.duplicates > 0 {
            let duplicates = self.duplicates;
            let coincide = if duplicates == 1 { "coincides" } else { "coincide" };
            let points = plural(duplicates, "point");
            found.warnings.push(format!("{points} {coincide} with another point of their realization"));
        }
        for last in [false, true] {
            for (part, sums) in sums.iter().filter(|(part, _)| part.last_words() == last) {
                control.check()?;
                let warnings = part.warnings(sums.as_ref(), &subject, &self.plan.parts, &found);
                found.warnings.extend(warnings);
            }
        }
        Ok(Some(found))
    }

    /// What to know of points that are weighted by the inverse of their intensity.
    fn unweighted(&self) -> Vec<String> {
        let Some(found) = self.source.inhomogeneity() else { return Vec::new() };
        let weighted = Setting::Inhomogeneous.row().map_or(&[][..], |row| row.statistics);
        let others = self.request.stats.iter().filter(|s| !weighted.contains(s)).map(|s| s.name());
        let integrals = (!self.request.integrand.is_empty()).then_some("integrals");
        let others: Vec<&str> = others.chain(integrals).collect();
        let mut warnings = Vec::new();
        if !others.is_empty() {
            warnings.push(format!(
                "g(r), K, L, P and the covariance are those of an inhomogeneous process; not {}: they take all points alike",
                others.join(", ")
            ));
        }
        if let (Some(bandwidth), Some(0)) = (found.bandwidth, found.others) {
            warnings.push(format!(
                "the intensity is estimated from the points themselves: what is correlated over its bandwidth, {bandwidth:.4e}, and beyond \
                 is taken for intensity"
            ));
        }
        warnings
    }
}
