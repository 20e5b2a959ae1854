//! Tables and arrays of integration errors.

use crate::estimate::{Analysis, IntegrationError, IntegrationErrors, Measured};
use crate::statistics::{Array, Table, Values};

/// How the spatial form was summed.
pub(super) fn method(found: &IntegrationErrors) -> &'static str {
    use crate::plan::PairSum;
    match found.pairs {
        PairSum::Exact => "pairs",
        PairSum::Deposit(_) => "deposit",
        PairSum::Radial(_) => "radial",
        PairSum::None => "",
    }
}

/// `variance.csv`: a row per integrand.
pub(super) fn variance(a: &Analysis) -> Option<Table> {
    let found = a.integration()?;
    let each = &found.each;
    let rows = each.len();
    let text = |value: String| (0..rows).map(move |_| value.clone());
    let value = |of: fn(&IntegrationError) -> Measured| each.iter().map(move |e| of(e).value);
    let se = |of: fn(&IntegrationError) -> Measured| each.iter().map(move |e| of(e).se);
    Some(
        Table::new()
            .text("subject", text(a.subject.clone()))
            .floats("n", (0..rows).map(|_| a.shape.mean_points))
            .integers("k", (0..rows).map(|_| found.realizations))
            .text("integrand", each.iter().map(|e| e.integrand.spec().to_string()))
            .text("estimator", text(found.estimator.name().into()))
            .floats("exact", each.iter().map(|e| e.integrand.integral()))
            .floats("mean", value(|e| e.mean))
            .optional("mean_se", se(|e| e.mean))
            .floats("bias", value(|e| e.bias))
            .optional("bias_se", se(|e| e.bias))
            .optional("var_observed", each.iter().map(|e| Some(e.observed?.value)))
            .optional("var_observed_se", each.iter().map(|e| e.observed?.se))
            .floats("mse", each.iter().map(|e| e.mse))
            .floats("var_shifted", value(|e| e.shifted))
            .optional("var_shifted_se", se(|e| e.shifted))
            .optional("var_spatial", each.iter().map(|e| Some(e.spatial?.value)))
            .optional("var_spatial_se", each.iter().map(|e| e.spatial?.se))
            .text("spatial_method", text(method(found).into()))
            .floats("var_spectral", value(|e| e.spectral))
            .optional("var_spectral_se", se(|e| e.spectral))
            .floats("tail", each.iter().map(|e| e.tail))
            .floats("tail_bound", each.iter().map(|e| e.tail_bound))
            .floats("phase", value(|e| e.phase))
            .optional("phase_se", se(|e| e.phase))
            .optional("z", each.iter().map(|e| e.z))
            .floats("count_term", each.iter().map(|e| e.count_term))
            .optional("var_observed_lo", each.iter().map(|e| Some(e.observed_interval?[0])))
            .optional("var_observed_hi", each.iter().map(|e| Some(e.observed_interval?[1])))
            .floats("var_random", each.iter().map(|e| e.v0 / a.shape.mean_points))
            .floats("phase_low", each.iter().map(|e| e.phase_low))
            .floats("tail_axes", each.iter().map(|e| e.tail_axes))
            .floats("removal", each.iter().map(|e| e.removal.map_or(0.0, |r| r.variance)))
            .optional("mse_predicted", each.iter().map(|e| Some(e.removal?.as_is?.value)))
            .optional("mse_predicted_se", each.iter().map(|e| e.removal?.as_is?.se))
            .optional("z_as_is", each.iter().map(|e| e.removal?.z_as_is))
            .optional("var_low", each.iter().map(|e| e.var_low)),
    )
}

/// `attribution.csv`: what each ring of frequencies adds to the predicted variance, then what closes it.
pub(super) fn attribution(a: &Analysis) -> Option<Table> {
    let found = a.integration()?;
    let mut rows: Vec<(String, String, Option<f64>, f64, f64, f64)> = Vec::new();
    for one in &found.each {
        let spec = one.integrand.spec();
        let mut sum = 0.0;
        for ring in &one.rings {
            sum += ring.variance;
            rows.push((spec.into(), "ring".into(), Some(ring.m), ring.coefficients, ring.variance, sum));
        }
        let removal = one.removal.map_or(0.0, |r| r.variance);
        for (part, coefficients, variance) in [
            ("tail", one.tail_share * one.v0, one.tail - one.tail_axes),
            ("count", 0.0, one.count_term),
            ("removal", 0.0, removal),
        ] {
            sum += variance;
            rows.push((spec.into(), part.into(), None, coefficients, variance, sum));
        }
    }
    Some(
        Table::new()
            .text("integrand", rows.iter().map(|r| r.0.clone()))
            .text("part", rows.iter().map(|r| r.1.clone()))
            .optional("m", rows.iter().map(|r| r.2))
            .floats("coefficients", rows.iter().map(|r| r.3))
            .floats("variance", rows.iter().map(|r| r.4))
            .floats("cumulative", rows.iter().map(|r| r.5)),
    )
}

/// An integrand and a part; both ends of a shell and the mean of a - I^2 there; what it adds, and the sum so far.
type LagRow<'a> = (&'a str, &'a str, [Option<f64>; 3], [f64; 2]);

/// `attribution_lags.csv`: what single points add to the predicted variance, then pairs in each shell of lags, then what that does not resolve.
pub(super) fn lags(a: &Analysis) -> Option<Table> {
    let found = a.integration()?;
    let mut rows: Vec<LagRow<'_>> = Vec::new();
    for one in found.each.iter().filter(|one| !one.lags.is_empty()) {
        let spec = one.integrand.spec();
        let mut sum = one.alone;
        rows.push((spec, "alone", [None, None, Some(one.v0)], [one.alone, sum]));
        for shell in &one.lags {
            sum += shell.variance;
            rows.push((spec, "lags", [shell.lo, shell.hi, shell.excess].map(Some), [shell.variance, sum]));
        }
        let removal = one.removal.map_or(0.0, |r| r.variance);
        let whole = one.spatial.map_or(sum, |spatial| spatial.value);
        let unresolved = whole - one.count_term - removal - sum;
        for (part, variance) in [("unresolved", unresolved), ("count", one.count_term), ("removal", removal)] {
            sum += variance;
            rows.push((spec, part, [None; 3], [variance, sum]));
        }
    }
    (!rows.is_empty()).then(|| {
        Table::new()
            .text("integrand", rows.iter().map(|r| r.0.to_string()))
            .text("part", rows.iter().map(|r| r.1.to_string()))
            .optional("r_lo", rows.iter().map(|r| r.2[0]))
            .optional("r_hi", rows.iter().map(|r| r.2[1]))
            .optional("excess", rows.iter().map(|r| r.2[2]))
            .floats("variance", rows.iter().map(|r| r.3[0]))
            .floats("cumulative", rows.iter().map(|r| r.3[1]))
    })
}

/// `attribution_modes.csv`: the frequencies that add most, each with its mirror image.
pub(super) fn modes(a: &Analysis) -> Option<Table> {
    let found = a.integration()?;
    let rows: Vec<_> = found.each.iter().flat_map(|e| e.modes.iter().map(move |mode| (e, mode))).collect();
    let mut table = Table::new().text("integrand", rows.iter().map(|(e, _)| e.integrand.spec().to_string()));
    for axis in 0..a.domain.dim() {
        table = table.floats(["m_x", "m_y", "m_z"][axis], rows.iter().map(move |(_, mode)| f64::from(mode.m[axis])));
    }
    Some(
        table
            .floats("coefficient", rows.iter().map(|(_, mode)| mode.coefficient))
            .floats("p", rows.iter().map(|(_, mode)| mode.p))
            .floats("variance", rows.iter().map(|(_, mode)| mode.variance)),
    )
}

/// `(K, integrands)`.
fn by_realization(a: &Analysis, of: fn(&IntegrationError) -> &[f64]) -> Option<Array<'_>> {
    let each = &a.integration()?.each;
    let count = each.first().map_or(0, |e| of(e).len());
    let values = (0..count).flat_map(move |k| each.iter().map(move |e| of(e)[k]));
    Some(Array { shape: vec![count as u64, each.len() as u64], values: Values::Real(Box::new(values)) })
}

/// `estimates.npy`: of each realization the estimate of each integral.
pub(super) fn estimates(a: &Analysis) -> Option<Array<'_>> {
    by_realization(a, |e| &e.estimates)
}

/// `stationarised.npy`: its squared error averaged over all shifts, as predicted.
pub(super) fn stationarised(a: &Analysis) -> Option<Array<'_>> {
    by_realization(a, |e| &e.stationarised)
}
