//! Whose numbers these are, where not ours: a key of the summary.

use serde::Serialize;

use super::group::{Ask, Parts};
use super::{Keys, Room, psa};
use crate::error::Result;
use crate::estimate::{Analysis, PsaStatistics};
use crate::plan::Convention;

/// The convention in a report.
pub(crate) struct Here;

impl Room for Here {
    fn plan(&self, ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
        psa::plan(ask, parts)
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        keys.add("convention", &convention(a))
    }
}

/// Whose numbers these are, where not ours.
#[derive(Serialize)]
struct ConventionOut {
    name: Convention,
    bug_compatible: bool,
    /// What `nu_lo`, `nu` and `nu_hi` are.
    spectrum_radial: &'static str,
    /// What `r` of `pcf.csv` is.
    pcf: &'static str,
    /// By PSA's own route through the pair counts.
    #[serde(flatten)]
    psa: Option<PsaStatistics>,
}

/// Its names of columns, and PSA's own statistics.
fn convention(a: &Analysis) -> Option<ConventionOut> {
    let c = a.conventions;
    c.foreign.then(|| ConventionOut {
        name: c.of,
        bug_compatible: c.bug_compatible,
        spectrum_radial: c.labels,
        pcf: c.pair_labels,
        psa: a.psa().copied(),
    })
}
