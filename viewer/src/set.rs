//! One of the sets that are looked at.

use std::sync::Arc;

use pairwave::Integrand;
use pairwave::analysis::Analysis;
use pairwave::display::Attribution;
use pairwave::estimate::IntegrationError;
use pairwave::points::Ensemble;
use pairwave::request::Request;
use pairwave::samplers::find;

use crate::engine::{SetId, Snapshot};
use crate::view::View;

/// How many sets are shown at most.
pub(crate) const MOST_SETS: usize = 4;

/// A set that is to be shown: what is asked for, colour and visibility.
pub(crate) type Wanted = (Request, usize, bool);

/// A set with what is asked of it and what is known of it.
pub(crate) struct Set {
    pub(crate) id: SetId,
    /// Which of the set colours it has.
    pub(crate) color: usize,
    /// Whether it is drawn, and so measured.
    pub(crate) visible: bool,
    /// Whether measuring it was cancelled: what is there stays.
    pub(crate) cancelled: bool,
    /// What is asked for; statistics follow from the panels.
    pub(crate) request: Request,
    pub(crate) snapshot: Option<Arc<Snapshot>>,
    /// The realization whose points are drawn, from 0.
    pub(crate) realization: u64,
}

impl Set {
    /// What there is to draw.
    pub(crate) fn analysis(&self) -> Option<&Analysis> {
        self.snapshot.as_ref()?.analysis.as_deref()
    }

    /// The points that are drawn: of the realization that was chosen, as soon as it is there.
    pub(crate) fn points(&self) -> Option<&Ensemble> {
        let snapshot = self.snapshot.as_ref()?;
        snapshot.points.as_deref().or(snapshot.analysis.as_deref().map(|analysis| &analysis.first))
    }

    /// The integrand that is drawn where there is room for one: that of this number, or the last.
    pub(crate) fn integrand(&self, index: usize) -> Option<&Integrand> {
        self.integration(index).map(|error| &error.integrand)
    }

    /// What is known of its integral.
    fn integration(&self, index: usize) -> Option<&IntegrationError> {
        let each = &self.analysis()?.integration()?.each;
        each.get(index).or(each.last())
    }

    /// What frequencies add to the variance of that integral, where it is to be seen.
    pub(crate) fn attribution(&self, view: &View) -> Option<Attribution<'_>> {
        let error = self.integration(view.integrand).filter(|_| view.attribution && !view.paper)?;
        Attribution::of(self.analysis()?, error)
    }

    /// The last realization there is.
    pub(crate) fn last_realization(&self) -> u64 {
        let status = self.snapshot.as_ref().and_then(|snapshot| snapshot.status.as_ref());
        status.map_or(0, |status| status.total.saturating_sub(1))
    }

    /// Its name with what was measured, for those who cannot see it.
    pub(crate) fn described(&self) -> String {
        match self.analysis() {
            Some(analysis) => {
                format!("{} (n = {}, K = {})", self.name(), analysis.shape.mean_points, analysis.shape.realizations)
            }
            None => self.name(),
        }
    }

    /// In a few words, for legends.
    pub(crate) fn name(&self) -> String {
        let input = &self.request.input;
        match (&input.sampler, input.files.as_slice()) {
            (Some(sampler), _) => sampler.clone(),
            (None, [file]) => file.file_name().map_or_else(|| "-".into(), |f| f.to_string_lossy().into_owned()),
            (None, files) => format!("{} files", files.len()),
        }
    }
}

/// A request of a sampler, in place of whatever points there were, as many as it can have.
pub(crate) fn of_sampler(request: &Request, name: &str) -> Request {
    let mut request = request.clone();
    let old = std::mem::take(&mut request.input);
    request.input.sampler = Some(name.into());
    request.input.points = old.points.or(Some(1024));
    request.input.realizations = old.realizations;
    (request.input.dim, request.input.seed) = (old.dim, old.seed);
    fitting(request)
}

/// The request of other integrands; without any, what is said of their integrals says nothing.
pub(crate) fn with_integrands(request: &Request, specs: Vec<String>) -> Request {
    let mut request = if specs.is_empty() { request.without_integrals() } else { request.clone() };
    request.integrand = specs;
    request
}

/// The request with the number of points nearest to its own that its sampler takes.
pub(crate) fn fitting(mut request: Request) -> Request {
    let input = &mut request.input;
    if let Some(sampler) = input.sampler.as_deref().and_then(|name| find(name).ok()) {
        input.points = input.points.map(|n| sampler.nearest_size(n, input.dim.unwrap_or(2)));
    }
    request
}
