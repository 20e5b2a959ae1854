//! The variance of an integral: predicted from frequencies and from pairs, and observed.

use super::{Bench, Scene, Section, Way, sampled};
use crate::error::Result;
use crate::estimate::{IntegrationError, IntegrationErrors, Measured};
use crate::memory::Memory;
use crate::plan::{Accuracy, IntegrationPlan, IntegrationSettings, MEMORY_BUDGET, Spatial};
use crate::points::Ensemble;

/// Jittered points: a disk, whose coefficients fall slowly, and a Gaussian, whose coefficients end.
pub(super) fn scenes(bench: &Bench<'_>) -> Result<Vec<Scene>> {
    let n = bench.size(256, 1024);
    let k = bench.size(32, 64);
    let ensemble = sampled("jittered", n, k, 2, bench.control)?;
    ["disk", "gaussian:sigma=0.1"].into_iter().map(|integrand| scene(bench, integrand, &ensemble)).collect()
}

/// What of a plan makes a way, and which of its numbers it is.
struct Form {
    method: String,
    frequency: u32,
    spatial: Spatial,
    shifts: u32,
    of: fn(&IntegrationError) -> Option<Measured>,
    observed: bool,
}

fn scene(bench: &Bench<'_>, integrand: &str, ensemble: &Ensemble) -> Result<Scene> {
    let device = &bench.devices[0];
    let (shape, domain) = (ensemble.shape(), ensemble.domain());
    let (n, k) = (shape.mean_points, shape.realizations as f64);
    // Without frequencies and with one shift where these are not what is looked at.
    let predicted = |method: &str, spatial| Form {
        method: method.into(),
        frequency: 1,
        spatial,
        shifts: 1,
        of: |e| e.spatial,
        observed: false,
    };
    let mut forms = vec![
        predicted("pairs, each at its lag", Spatial::Pairs),
        predicted("pairs, deposited on lags", Spatial::Deposit),
        predicted("pairs, by distance: g(r)", Spatial::Radial),
    ];
    for factor in [1.0, 2.5, 5.0, 10.0] {
        let frequency = (factor * n.sqrt()).ceil() as u32;
        let method = format!("frequencies, up to {factor} sqrt(n)");
        forms.push(Form { method, frequency, of: |e| Some(e.closed), ..predicted("", Spatial::None) });
    }
    for shifts in [1, 4, 16, 64] {
        let method = format!("observed, at {shifts} random shift{}", if shifts == 1 { "" } else { "s" });
        forms.push(Form { method, shifts, of: |e| Some(e.shifted), observed: true, ..predicted("", Spatial::None) });
    }
    let method = "observed, as it is".into();
    forms.push(Form { method, of: |e| e.observed, observed: true, ..predicted("", Spatial::None) });

    let (mut ways, mut truth, mut statistical) = (Vec::new(), None, 0.0);
    for form in forms {
        let settings = IntegrationSettings {
            integrands: &[integrand.into()],
            estimator: None,
            shifts: form.shifts,
            spatial: Some(form.spatial),
            top: None,
            intensity: None,
            by: None,
            weighted: false,
            max_frequency: Some(&[form.frequency]),
            low_frequency: Some(1),
            accuracy: Accuracy::Fast,
            memory: Memory(MEMORY_BUDGET),
            equal: true,
        };
        let plan = IntegrationPlan::new(domain, settings, shape)?;
        let (seconds, sums) = bench.timed(device, async |on| on.integration(&plan, false, ensemble).await)?;
        let found = IntegrationErrors::new(&plan, &sums);
        let Some(value) = found.as_ref().and_then(|found| (form.of)(found.each.first()?)) else { continue };
        let exact = *truth.get_or_insert(value.value);
        // Of one realization, relative.
        let chance = value.se.map(|se| se / value.value * k.sqrt());
        if ways.is_empty() {
            statistical = chance.unwrap_or(0.0);
        }
        let error = (value.value / exact - 1.0).abs();
        ways.push(Way {
            method: form.method,
            device: sums.grid.computed_by.device(),
            seconds: seconds.each(k),
            work: None,
            gflop: None,
            error: (!form.observed).then_some([error; 2]),
            statistical: chance,
            front: false,
        });
    }
    let name = format!("variance of the integral of {integrand} by {n} jittered points");
    Ok(Scene { name, section: Section::Variance, error_of: "the variance, relative", ways, statistical })
}
