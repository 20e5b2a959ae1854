//! The picture of G and F, and its caption.

use crate::display::figure::{BLUE, Figure, GREEN, INK, Layer, Of, Stroke, TopAxis, VERMILION, band_runs, runs, sub};
use crate::display::{Units, error_note, escape, extent, human, packing_symbol, shortened, size};
use crate::estimate::{Analysis, NeighborFunctions};
use crate::statistics::axes;
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
    let curve = |name: &str, color, stroke, column: &'static str, y: &[Option<f64>]| {
        let runs = runs(intervals().zip(y.iter().copied()));
        Layer::Line { name: name.into(), color, width: 1.6, stroke, runs, of: Of::Column(column.into()) }
    };
    let poisson: Vec<_> = functions.poisson.iter().copied().map(Some).collect();
    let at: Vec<_> = intervals().collect();
    let envelopes = analysis.envelopes();
    let random = |name, of| envelopes.and_then(|e| e.find(name)).map(|e| global_band(analysis, of, &at, e));
    let mut layers = Vec::new();
    layers.extend(random("neighbor_g", "G of "));
    layers.extend([
        Layer::Band { name: "G ±1 s.e.".into(), color: BLUE, runs: band(&functions.g, &functions.g_se) },
        Layer::Band { name: "F ±1 s.e.".into(), color: VERMILION, runs: band(&functions.f, &functions.f_se) },
        curve("G: point to nearest point", BLUE, Stroke::Solid, "g_function", &functions.g),
        curve("F: place to nearest point", VERMILION, Stroke::Solid, "f_function", &functions.f),
        curve("Poisson: G = F", INK, Stroke::Dashed, "poisson", &poisson),
    ]);
    let (d, which) = packing_symbol(analysis.domain.dim());
    let unit = analysis.domain.closest_packing_distance(analysis.shape.mean_points);
    let symbol = format!("{d}{}", sub(which));
    let edges = if analysis.domain.is_torus() { "" } else { " · Kaplan-Meier" };
    let units = Units::of(analysis).escaped();
    Some(Figure {
        title: axes::NEIGHBORS.title.into(),
        subject: analysis.subject.clone(),
        note: format!("{}{edges} · {}", size(analysis), error_note(functions.errors, "binomial")),
        x_label: axes::NEIGHBORS.x_label(&units),
        y_label: axes::NEIGHBORS.y_label(&units),
        x: r[0].min(0.0)..end,
        y: 0.0..1.06,
        log_x: false,
        log_y: false,
        top: Some(TopAxis { label: format!("r / {symbol} ({symbol} = {}, closest packing)", human(unit)), unit }),
        layers,
        numbers: axes::NEIGHBORS.numbers(),
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

/// J within two classes and between them, as far as F is below 0.95; 1 for independent points.
pub(super) fn cross(analysis: &Analysis) -> Option<Figure> {
    let cross = analysis.cross_neighbors()?;
    let r = &cross.a.r;
    // Beyond, J is a quotient of two small numbers.
    let known = |functions: &NeighborFunctions| {
        let below = |(j, f): (&Option<f64>, &Option<f64>)| j.filter(|_| f.is_some_and(|f| f < 0.95));
        functions.j.iter().zip(&functions.f).map(below).collect::<Vec<_>>()
    };
    let curves = cross.each().map(|(names, functions)| (names, known(functions)));
    let end = (0..r.len()).rev().find(|&i| curves.iter().any(|(_, j)| j[i].is_some())).map(|i| r[i])?;
    let values: Vec<f64> = curves.iter().flat_map(|(_, j)| j.iter().flatten().copied()).collect();
    let (lo, hi) = extent(&values.iter().copied().chain([0.9, 1.1]).collect::<Vec<_>>())?;
    let pad = 0.06 * (hi - lo);
    let mut layers = vec![Layer::Level { name: "independent: J = 1".into(), y: 1.0 }];
    for (([from, to], j), color) in curves.iter().zip([GREEN, VERMILION, BLUE, INK]) {
        layers.push(Layer::Line {
            name: [from, to].map(|name| escape(&shortened(name, 18))).join(" → "),
            color,
            width: 1.6,
            stroke: Stroke::Solid,
            runs: runs(r.iter().map(|&r| (r, r, r)).zip(j.iter().copied())),
            of: Of::Column(format!("j_function_{from}_{to}").into()),
        });
    }
    let units = Units::of(analysis).escaped();
    Some(Figure {
        title: axes::NEIGHBORS_CROSS.title.into(),
        subject: analysis.subject.clone(),
        note: size(analysis),
        x_label: axes::NEIGHBORS_CROSS.x_label(&units),
        y_label: axes::NEIGHBORS_CROSS.y_label(&units),
        x: r[0].min(0.0)..end,
        y: (lo - pad).max(0.0)..hi + pad,
        log_x: false,
        log_y: false,
        top: None,
        layers,
        numbers: axes::NEIGHBORS_CROSS.numbers(),
    })
}

/// What the picture of two classes shows.
pub(super) fn cross_caption(a: &Analysis, _: &str) -> Option<String> {
    let [a, b] = a.cross_neighbors()?.classes.each_ref().map(|name| escape(name));
    Some(format!(
        "<i>J<sub>AB</sub></i> = (1 − <i>G<sub>AB</sub></i>) / (1 − <i>F<sub>B</sub></i>) of the classes {a} and {b}, within \
         each and from each to the other: <i>G<sub>AB</sub></i>(<i>r</i>) is the probability that a point of <i>A</i> has one \
         of <i>B</i> closer than <i>r</i>, <i>F<sub>B</sub></i> that a fixed place has. 1 means that the classes are \
         independent, above 1 they keep apart, below they attract."
    ))
}
