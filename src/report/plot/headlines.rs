//! What to see first of results side by side.

use std::collections::BTreeSet;

use serde_json::Value as Json;

use super::Stored;
use crate::display::{escape, with_error};

/// Keys of a summary, whose errors are beside them as `_se`, and what they are called, in HTML.
const SCALARS: [(&str, &str); 29] = [
    ("/n/mean", "Points per realization <i>n</i>"),
    ("/k", "Realizations <i>K</i>"),
    ("/domain/closest_packing_distance", "Closest-packing distance"),
    ("/neighbors/minimum", "Smallest nearest-neighbour distance"),
    ("/neighbors/mean_minimum", "The smallest of each realization, mean"),
    ("/neighbors/mean", "Mean nearest-neighbour distance"),
    ("/neighbors/mean_relative", "The same over the closest-packing distance"),
    ("/neighbors/clark_evans/index", "Clark–Evans index"),
    ("/neighbors/psi_6/local", "Bond order, mean of |<i>ψ</i><sub>6</sub>|"),
    ("/neighbors/psi_6/global", "Bond order, |mean of <i>ψ</i><sub>6</sub>|"),
    ("/spectrum/dc_p", "<i>P</i> at zero frequency"),
    ("/spectrum_scalars/effective_nyquist", "Effective Nyquist frequency over √<i>n</i>"),
    ("/spectrum_scalars/oscillation", "Oscillations"),
    ("/spectrum_scalars/low_frequency/hyperuniformity_index", "Hyperuniformity index"),
    ("/spectrum_scalars/low_frequency/exponent", "Exponent of <i>P</i> at low frequency"),
    ("/spectrum_scalars/high_frequency/p", "Mean of <i>P</i> at high frequency"),
    ("/spectrum_scalars/diaphony/diaphony", "Diaphony"),
    ("/covariance/off_diagonal_share", "Share of covariance off the diagonal"),
    ("/discrepancy/star_l2/mean", "Star L<sub>2</sub> discrepancy"),
    ("/discrepancy/centered_l2/mean", "Centred L<sub>2</sub> discrepancy"),
    ("/discrepancy/wrap_around_l2/mean", "Wrap-around L<sub>2</sub> discrepancy"),
    ("/discrepancy/minimum_distance/mean", "Least distance of a realization, mean"),
    ("/discrepancy/covering_radius/mean", "Covering radius"),
    ("/counts/largest_box/dispersion", "Variance over mean of counts, largest box"),
    ("/counts/largest_ball/dispersion", "Variance over mean of counts, largest ball"),
    ("/intensity/mean", "Intensity"),
    ("/intensity/least", "Least intensity on the grid"),
    ("/intensity/largest", "Largest intensity on the grid"),
    ("/duplicates", "Coinciding points"),
];

/// The same of every integrand; the number and its error are `value` and `se`.
const OF_INTEGRANDS: [(&str, &str); 3] =
    [("bias", "bias"), ("var_observed", "variance, as points are"), ("var_shifted", "variance, randomly shifted")];

/// Rows of a name and the values of every result, in HTML; only what some result has.
pub(crate) fn headlines(results: &[Stored]) -> Vec<Vec<String>> {
    let number = |of: &Stored, key: &str| of.value(key).and_then(Json::as_f64);
    let row = |name: String, value: &dyn Fn(&Stored) -> Option<f64>, error: &dyn Fn(&Stored) -> Option<f64>| {
        // An error that is rounding is none.
        let shown = |of, x: f64| with_error(x, error(of).filter(|se| *se > 1e-12 * x.abs()));
        let cells = results.iter().map(|of| value(of).map_or(String::new(), |x| shown(of, x)));
        let row: Vec<String> = std::iter::once(name).chain(cells).collect();
        row[1..].iter().any(|cell| !cell.is_empty()).then_some(row)
    };
    let scalar =
        |(key, name): (&str, &str)| row(name.into(), &|of| number(of, key), &|of| number(of, &format!("{key}_se")));
    let mut rows: Vec<_> = SCALARS.into_iter().filter_map(scalar).collect();
    let each = |of: &Stored| of.value("/integration/integrands").and_then(Json::as_array).cloned().unwrap_or_default();
    let spec = |of: &Json| of["integrand"].as_str().unwrap_or_default().to_string();
    let mut known = BTreeSet::new();
    let specs = results.iter().flat_map(each).map(|of| spec(&of)).filter(|spec| known.insert(spec.clone()));
    for wanted in specs.collect::<Vec<_>>() {
        for (key, name) in OF_INTEGRANDS {
            let found = |of: &Stored, part: &str| each(of).iter().find(|of| spec(of) == wanted)?[key][part].as_f64();
            rows.extend(row(format!("{}: {name}", escape(&wanted)), &|of| found(of, "value"), &|of| found(of, "se")));
        }
    }
    rows
}
