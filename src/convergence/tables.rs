//! The tables of a run over numbers of points.

use super::{At, Convergence, Curve, Slope};
use crate::estimate::PowerLaw;
use crate::statistics::Table;

/// `convergence.csv`: a row per subject, integrand and n.
pub(super) fn variances(all: &Convergence) -> Table {
    let rows: Vec<(&Curve, &At)> = all.curves.iter().flat_map(|c| c.points.iter().map(move |at| (c, at))).collect();
    Table::new()
        .text("subject", rows.iter().map(|(c, _)| all.subjects[c.subject].name.clone()))
        .text("integrand", rows.iter().map(|(c, _)| all.integrands[c.integrand].spec().to_string()))
        .floats("n", rows.iter().map(|(_, at)| at.n))
        .integers("k", rows.iter().map(|(_, at)| at.k))
        .optional("var_observed", rows.iter().map(|(_, at)| Some(at.observed?.value)))
        .optional("var_observed_se", rows.iter().map(|(_, at)| at.observed?.se))
        .floats("var_predicted", rows.iter().map(|(_, at)| at.predicted.value))
        .optional("var_predicted_se", rows.iter().map(|(_, at)| at.predicted.se))
        .optional("local_slope", rows.iter().map(|(_, at)| Some(at.local?.value)))
        .optional("local_slope_se", rows.iter().map(|(_, at)| at.local?.se))
        .floats("var_shifted", rows.iter().map(|(_, at)| at.shifted.value))
        .optional("var_shifted_se", rows.iter().map(|(_, at)| at.shifted.se))
        .floats("var_random", rows.iter().map(|(c, at)| all.integrands[c.integrand].variance().max(0.0) / at.n))
        .text("seed", rows.iter().map(|(_, at)| at.seed.map_or(String::new(), |seed| seed.to_string())))
}

/// `slopes.csv`: a row per subject, integrand and kind of variance.
pub(super) fn slopes(all: &Convergence) -> Table {
    let rows: Vec<(&Curve, &Slope)> = all.curves.iter().flat_map(|c| c.slopes.iter().map(move |s| (c, s))).collect();
    let of = |value: fn(&PowerLaw) -> Option<f64>| rows.iter().map(move |(_, s)| value(s.law.as_ref()?));
    let end = |value: fn(&PowerLaw) -> Option<f64>| rows.iter().map(move |(_, s)| value(s.asymptote.as_ref()?));
    Table::new()
        .text("subject", rows.iter().map(|(c, _)| all.subjects[c.subject].name.clone()))
        .text("integrand", rows.iter().map(|(c, _)| all.integrands[c.integrand].spec().to_string()))
        .text("variance", rows.iter().map(|(_, s)| s.variance.name().into()))
        .optional("slope", of(|law| Some(law.slope)))
        .optional("slope_se", of(|law| Some(law.slope_se)))
        .optional("slope_lo", of(|law| Some(law.interval?[0])))
        .optional("slope_hi", of(|law| Some(law.interval?[1])))
        .optional("chi2_per_dof", of(|law| law.chi2_per_dof))
        .integers("points", rows.iter().map(|(_, s)| s.law.map_or(0, |law| law.points as u64)))
        .optional("asymptotic_slope", end(|law| Some(law.slope)))
        .optional("asymptotic_se", end(|law| Some(law.slope_se)))
        .optional("asymptotic_lo", end(|law| Some(law.interval?[0])))
        .optional("asymptotic_hi", end(|law| Some(law.interval?[1])))
        .optional("asymptotic_from_n", end(|law| Some(law.range[0])))
        .optional("expected_slope", rows.iter().map(|(c, _)| all.expected(c)))
        .optional("low_frequency_exponent", rows.iter().map(|(c, _)| all.exponent(c)))
        // Infinite where the integrand is smooth: empty.
        .optional("smoothness", rows.iter().map(|(c, _)| Some(all.integrands[c.integrand].smoothness())))
}

/// `ranks.csv`: at each subject's largest n, the least predicted variance per point first.
pub(super) fn ranks(all: &Convergence) -> Table {
    let mut rows: Vec<(u64, u64, &Curve, &At)> = Vec::new();
    for integrand in 0..all.integrands.len() {
        let of = all.curves.iter().filter(|c| c.integrand == integrand);
        let mut lasts: Vec<(&Curve, &At)> = of.filter_map(|c| Some((c, c.points.last()?))).collect();
        // Subjects whose largest n differ a little are as good as their variance times n says.
        let rank = |lasts: &mut Vec<(&Curve, &At)>, of: fn(&At) -> f64| {
            lasts.sort_by(|a, b| of(a.1).total_cmp(&of(b.1)));
        };
        rank(&mut lasts, |at| at.shifted.value * at.n);
        let observed: Vec<usize> = lasts.iter().map(|(c, _)| c.subject).collect();
        rank(&mut lasts, |at| at.predicted.value * at.n);
        for (place, (curve, at)) in lasts.into_iter().enumerate() {
            let other = observed.iter().position(|s| *s == curve.subject).unwrap_or(place);
            rows.push((place as u64 + 1, other as u64 + 1, curve, at));
        }
    }
    let v0 = |c: &Curve| all.integrands[c.integrand].variance().max(0.0);
    Table::new()
        .text("integrand", rows.iter().map(|r| all.integrands[r.2.integrand].spec().to_string()))
        .integers("rank", rows.iter().map(|r| r.0))
        .integers("rank_shifted", rows.iter().map(|r| r.1))
        .text("subject", rows.iter().map(|r| all.subjects[r.2.subject].name.clone()))
        .floats("n", rows.iter().map(|r| r.3.n))
        .floats("var_predicted", rows.iter().map(|r| r.3.predicted.value))
        .optional("var_predicted_se", rows.iter().map(|r| r.3.predicted.se))
        .floats("var_shifted", rows.iter().map(|r| r.3.shifted.value))
        .optional("var_shifted_se", rows.iter().map(|r| r.3.shifted.se))
        .optional("var_observed", rows.iter().map(|r| Some(r.3.observed?.value)))
        .optional("var_observed_se", rows.iter().map(|r| r.3.observed?.se))
        // Points of a random set with the same variance.
        .optional(
            "n_random",
            rows.iter().map(|r| {
                let v = r.3.predicted.value;
                (v > 0.0).then_some(v0(r.2) / v)
            }),
        )
}
