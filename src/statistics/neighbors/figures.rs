//! The picture of G and F, and its caption.

use crate::display::figure::{BLUE, Figure, INK, Layer, TopAxis, VERMILION, band_runs, runs, sub};
use crate::display::{error_note, human, packing_symbol, size};
use crate::estimate::Analysis;
use crate::statistics::envelope;
use crate::statistics::envelope::global_band;

/// G and F against r, with their bands, and what both are for a Poisson process.
pub(super) fn functions(analysis: &Analysis) -> Option<Figure> {
    let functions = &analysis.neighbors()?.functions;
    let r = &functions.r;
    // Past where all three have come to 1 there is nothing to see.
    let high = |y: Option<f64>| y.is_none_or(|y| y > 0.9999);
    let settled = |i: &usize| high(functions.g[*i]) && high(functions.f[*i]) && high(Some(functions.poisson[*i]));
    let end = (0..r.len()).rev().take_while(settled).last().map_or(*r.last()?, |i| r[i]);
    let intervals = || r.iter().map(|&r| (r, r, r));
    let band = |y: &[Option<f64>], se: &[Option<f64>]| {
        let range = |(y, se): (&Option<f64>, &Option<f64>)| y.zip(*se).map(|(y, se)| (y - se, y + se));
        band_runs(intervals().zip(y.iter().zip(se).map(range)))
    };
    let curve = |name: &str, color, dashed, y: &[Option<f64>]| {
        let runs = runs(intervals().zip(y.iter().copied()));
        Layer::Line { name: name.into(), color, width: 1.6, dashed, runs }
    };
    let poisson: Vec<_> = functions.poisson.iter().copied().map(Some).collect();
    let at: Vec<_> = intervals().collect();
    let envelopes = analysis.envelopes();
    let random = |name, label| envelopes.and_then(|e| e.find(name)).map(|e| global_band(label, &at, e));
    let mut layers = Vec::new();
    layers.extend(random("neighbor_g", "G of random, global"));
    layers.extend([
        Layer::Band { name: "G ±1 s.e.".into(), color: BLUE, runs: band(&functions.g, &functions.g_se) },
        Layer::Band { name: "F ±1 s.e.".into(), color: VERMILION, runs: band(&functions.f, &functions.f_se) },
        curve("G: point to nearest point", BLUE, false, &functions.g),
        curve("F: place to nearest point", VERMILION, false, &functions.f),
        curve("Poisson: G = F", INK, true, &poisson),
    ]);
    let (d, which) = packing_symbol(analysis.domain.dim());
    let unit = analysis.domain.closest_packing_distance(analysis.shape.mean_points);
    let symbol = format!("{d}{}", sub(which));
    let edges = if analysis.domain.is_torus() { "" } else { " · Kaplan-Meier" };
    Some(Figure {
        title: "Nearest-neighbour and empty-space functions",
        subject: analysis.subject.clone(),
        note: format!("{}{edges} · {}", size(analysis), error_note(functions.errors, "binomial")),
        x_label: "distance r (length units of the domain)".into(),
        y_label: "probability".into(),
        x: r[0].min(0.0)..end,
        y: 0.0..1.06,
        log_x: false,
        log_y: false,
        top: Some(TopAxis { label: format!("r / {symbol} ({symbol} = {}, closest packing)", human(unit)), unit }),
        layers,
    })
}

/// What the picture shows.
pub(super) fn caption(a: &Analysis, _: &str) -> Option<String> {
    let edges = if a.domain.is_torus() {
        ""
    } else {
        " Distances longer than the way to the border are censored there (Kaplan-Meier)."
    };
    Some(format!(
        "<i>G</i>(<i>r</i>): the probability that a point has another closer than <i>r</i>. <i>F</i>(<i>r</i>): that a \
         fixed place has a point closer than <i>r</i>, from a lattice of {} test points. Of independent points both are \
         1 − exp(−<i>λ v r<sup>d</sup></i>), with <i>v</i> the measure of the unit ball; <i>G</i> below <i>F</i> means \
         that points keep apart.{edges}{}",
        a.neighbors()?.functions.probes,
        envelope::caption(a, &["neighbor_g", "neighbor_f"])
    ))
}
