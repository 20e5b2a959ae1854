//! Pictures of g, of two classes and of K, and their captions.

use crate::display::figure::{BLUE, Figure, GREEN, Layer, Of, Stroke, TopAxis, VERMILION, band_runs, runs, sub};
use crate::display::{
    Panel, Units, decades, error_note, escape, extent, grow, human, inhomogeneous_caption, kernel_name, packing_symbol,
    shortened, size_and_weights, top_of,
};
use crate::estimate::{Analysis, KFunction, Normalization};
use crate::plan::{Correction, SmoothingKernel};
use crate::statistics::axes;
use crate::statistics::envelope;
use crate::statistics::envelope::global_band;
use crate::statistics::layers::{closed_form, cut};

/// g against r, with its band, g = 1, the kernel estimate and the closed form.
pub(super) fn pcf(analysis: &Analysis) -> Option<Figure> {
    let pcf = analysis.pair_correlation()?;
    let samples = Panel::Pcf.samples(analysis)?;
    let (first, last) = (samples.all.first()?.interval, samples.all.last()?.interval);
    let log_x = first.0 > 0.0 && grow(samples.all.iter().map(|s| s.interval));
    let values: Vec<(f64, f64)> = pcf.g.iter().copied().zip(pcf.g_se.iter().copied()).collect();
    let kernel = analysis.kernel();
    let (y, log_y) = match decades(&values) {
        Some(range) => (range, true),
        None => (samples.range.clone(), false),
    };
    let top = y.end;

    let mut layers = vec![Layer::Level { name: "g = 1".into(), y: 1.0 }];
    let envelope = analysis.envelopes().and_then(|e| e.find("g"));
    let intervals: Vec<_> = samples.all.iter().map(|s| s.interval).collect();
    layers.extend(envelope.map(|e| global_band(analysis, "", &intervals, e)));
    layers.extend([
        Layer::Band { name: "±1 s.e.".into(), color: BLUE, runs: band_runs(samples.bands()) },
        Layer::Line {
            name: "estimate".into(),
            color: BLUE,
            width: 1.6,
            stroke: Stroke::Solid,
            runs: runs(samples.values()),
            of: Of::Column("g".into()),
        },
    ]);
    if let Some(k) = kernel {
        let name = format!("{} kernel", kernel_name(k.kernel.shape));
        let smoothed = intervals.iter().zip(&k.g).map(|(&x, &g)| (x, g));
        layers.push(Layer::Line {
            name,
            color: VERMILION,
            width: 1.4,
            stroke: Stroke::Solid,
            runs: runs(smoothed),
            of: Of::Column("g_kernel".into()),
        });
    }
    layers.extend(closed_form(analysis, &samples, analysis.closed_form.g.is_some()));
    let (d, which) = packing_symbol(analysis.domain.dim());
    let unit = analysis.domain.closest_packing_distance(analysis.shape.mean_points);
    let symbol = format!("{d}{}", sub(which));
    let normalization = match pcf.normalization {
        Normalization::Pairs => "",
        Normalization::Intensity => ", normalized by n²",
    };
    let below = if log_y && pcf.g.iter().any(|&g| g < y.start) { " · g near 0 lies below the frame" } else { "" };
    let bandwidth = kernel.map_or(String::new(), |k| format!("; kernel s.d. {}", human(k.kernel.bandwidth)));
    let random =
        envelope.map_or(String::new(), |e| format!("; grey: global envelope, {} %", human(100.0 * (1.0 - e.alpha))));
    let units = Units::of(analysis).escaped();
    Some(Figure {
        title: axes::PCF.title_of(analysis),
        subject: analysis.subject.clone(),
        note: format!(
            "{}{normalization} · {}{random}{bandwidth}{}{below}",
            size_and_weights(analysis),
            error_note(pcf.errors, "Poisson counts"),
            cut(pcf.g.iter().copied(), top)
        ),
        x_label: axes::PCF.x_label(&units),
        y_label: axes::PCF.y_label(&units),
        x: if log_x { first.0..last.2 } else { 0f64.min(first.0)..last.2 },
        y,
        log_x,
        log_y,
        top: Some(TopAxis { label: format!("r / {symbol} ({symbol} = {}, closest packing)", human(unit)), unit }),
        layers,
        numbers: axes::PCF.numbers(),
    })
}

/// What the picture of g shows.
pub(super) fn pcf_caption(a: &Analysis, _: &str) -> Option<String> {
    let pcf = a.pair_correlation()?;
    let pairs = match pcf.normalization {
        Normalization::Pairs => "<i>n</i>(<i>n</i> − 1)",
        Normalization::Intensity => "<i>n</i><sup>2</sup>",
    };
    let kernel = a.kernel().map_or(String::new(), |k| {
        format!(
            " The second curve is smoothed with {} {} kernel whose standard deviation is {} {}.",
            if k.kernel.shape == SmoothingKernel::Epanechnikov { "an" } else { "a" },
            kernel_name(k.kernel.shape),
            human(k.kernel.bandwidth),
            Units::of(a).escaped().length
        )
    });
    let weights = match a.correction {
        Correction::None => "",
        Correction::Translation => {
            " (each weighing |<i>D</i>| / |<i>D</i> ∩ (<i>D</i> + <i>h</i>)|, <i>h</i> being the vector between the points)"
        }
        Correction::Isotropic => {
            " (each weighing the inverse of the part inside <i>D</i> of the sphere about the first point through the second)"
        }
        Correction::Border => " (seen from points at least as far from the border)",
    };
    let caption = format!(
        "<i>g</i>(<i>r</i>) = |<i>D</i>| ∑<sub><i>k</i></sub> <i>c<sub>k</sub></i> / \
         (<i>v</i> ∑<sub><i>k</i></sub> {pairs}): <i>c<sub>k</sub></i> ordered pairs{weights} of realization <i>k</i> at \
         distance <i>r</i> ± half a bin, over the number expected of independent points, with <i>v</i> the \
         measure of the shell and |<i>D</i>| that of the domain; 1 means no correlation.{kernel}"
    );
    Some(caption + &inhomogeneous_caption(a) + &envelope::caption(a, &["g", "g_kernel"]))
}

/// g within two classes and between them, with the band of the last, and g = 1.
pub(super) fn cross(analysis: &Analysis) -> Option<Figure> {
    let cross = analysis.cross()?;
    let between = &cross.between;
    let intervals: Vec<_> = between.r.iter().enumerate().map(|(b, &r)| (between.r_lo[b], r, between.r_hi[b])).collect();
    let values: Vec<(f64, f64)> = between.g.iter().copied().zip(between.g_se.iter().copied()).collect();
    let own: Vec<f64> =
        [&cross.a, &cross.b].iter().filter_map(|g| extent(&settled(&g.g, &g.g_se))).map(|e| e.1).collect();
    let top = top_of(&values, &own);
    let [a, b] = cross.classes.each_ref().map(|name| escape(&shortened(name, 18)));
    let at = |g: &[f64]| runs(intervals.iter().zip(g).map(|(&x, &g)| (x, Some(g))));
    let line = |[from, to]: [usize; 2], color, g: &[f64]| Layer::Line {
        name: format!("{} – {}", [&a, &b][from], [&a, &b][to]),
        color,
        width: 1.6,
        stroke: Stroke::Solid,
        runs: at(g),
        of: Of::Column(format!("g_{}_{}", cross.classes[from], cross.classes[to]).into()),
    };
    let layers = vec![
        Layer::Level { name: "g = 1".into(), y: 1.0 },
        Layer::Band {
            name: "±1 s.e.".into(),
            color: BLUE,
            runs: band_runs(intervals.iter().zip(&values).map(|(&x, &(g, se))| (x, Some((g - se, g + se))))),
        },
        line([0, 0], GREEN, &cross.a.g),
        line([1, 1], VERMILION, &cross.b.g),
        line([0, 1], BLUE, &between.g),
    ];
    let units = Units::of(analysis).escaped();
    Some(Figure {
        title: axes::PCF_CROSS.title_of(analysis),
        subject: analysis.subject.clone(),
        note: format!(
            "{} · {}{}",
            size_and_weights(analysis),
            error_note(between.errors, "Poisson counts"),
            cut([&cross.a.g, &cross.b.g, &between.g].into_iter().flatten().copied(), top)
        ),
        x_label: axes::PCF_CROSS.x_label(&units),
        y_label: axes::PCF_CROSS.y_label(&units),
        x: 0f64.min(intervals.first()?.0)..intervals.last()?.2,
        y: 0.0..top,
        log_x: false,
        log_y: false,
        top: None,
        layers,
        numbers: axes::PCF_CROSS.numbers(),
    })
}

/// Values known to better than themselves.
fn settled(values: &[f64], errors: &[f64]) -> Vec<f64> {
    values.iter().zip(errors).filter(|(v, se)| v.is_finite() && **se <= 0.3 * v.max(1.0)).map(|(v, _)| *v).collect()
}

/// What the picture of two classes shows.
pub(super) fn cross_caption(a: &Analysis, _: &str) -> Option<String> {
    let [a, b] = a.cross()?.classes.each_ref().map(|name| escape(name));
    Some(format!(
        "<i>g</i> of the classes {a} (<i>A</i>) and {b} (<i>B</i>) alone, as above, and between them: \
         <i>g<sub>AB</sub></i>(<i>r</i>) = |<i>D</i>| ∑<sub><i>k</i></sub> <i>c<sub>AB</sub></i> / \
         (<i>v</i> ∑<sub><i>k</i></sub> <i>n<sub>A</sub> n<sub>B</sub></i>) with <i>c<sub>AB</sub></i> ordered pairs \
         from <i>A</i> to <i>B</i>, both directions averaged; 1 means that the classes are independent of each other."
    ))
}

/// L - r against r, with its band; 0 for complete spatial randomness.
pub(super) fn k_function(analysis: &Analysis) -> Option<Figure> {
    let k = analysis.k_function()?;
    let intervals: Vec<_> =
        k.r.iter().enumerate().map(|(b, &r)| (if b == 0 { 0.0 } else { k.r[b - 1] }, r, r)).collect();
    let values: Vec<(f64, f64)> = k.l_minus_r.iter().zip(&k.l_se).map(|(&l, se)| (l, se.unwrap_or(0.0))).collect();
    let reach = values.iter().filter(|v| v.0.is_finite()).flat_map(|&(l, se)| [l - se, l + se]);
    let random = analysis.envelopes().and_then(|e| e.find("l_minus_r"));
    // Curve and envelope are compared: both are in the frame.
    let band = random.iter().flat_map(|e| e.global.iter().flatten().copied()).filter(|l| l.is_finite());
    let (lo, hi) = extent(&reach.chain(band).chain([0.0]).collect::<Vec<_>>())?;
    let pad = (0.06 * (hi - lo)).max(1e-3 * intervals.last()?.2);
    let defined = |&(l, se): &(f64, f64)| l.is_finite().then_some((l - se, l + se));
    let mut layers = vec![Layer::Level { name: "random: L = r".into(), y: 0.0 }];
    layers.extend(random.map(|e| global_band(analysis, "", &intervals, e)));
    layers.extend([
        Layer::Band {
            name: "±1 s.e.".into(),
            color: BLUE,
            runs: band_runs(intervals.iter().zip(&values).map(|(&x, v)| (x, defined(v)))),
        },
        Layer::Line {
            name: "L(r) − r".into(),
            color: BLUE,
            width: 1.6,
            stroke: Stroke::Solid,
            runs: runs(intervals.iter().zip(&values).map(|(&x, v)| (x, v.0.is_finite().then_some(v.0)))),
            of: Of::Column("l_minus_r".into()),
        },
    ]);
    let (d, which) = packing_symbol(analysis.domain.dim());
    let unit = analysis.domain.closest_packing_distance(analysis.shape.mean_points);
    let symbol = format!("{d}{}", sub(which));
    let units = Units::of(analysis).escaped();
    Some(Figure {
        title: axes::K_FUNCTION.title_of(analysis),
        subject: analysis.subject.clone(),
        note: format!("{} · {}", size_and_weights(analysis), error_note(k.errors, "Poisson counts")),
        x_label: axes::K_FUNCTION.x_label(&units),
        y_label: axes::K_FUNCTION.y_label(&units),
        x: 0.0..intervals.last()?.2,
        y: lo - pad..hi + pad,
        log_x: false,
        log_y: false,
        top: Some(TopAxis { label: format!("r / {symbol} ({symbol} = {}, closest packing)", human(unit)), unit }),
        layers,
        numbers: axes::K_FUNCTION.numbers(),
    })
}

/// What the picture of K shows.
pub(super) fn k_caption(a: &Analysis, _: &str) -> Option<String> {
    let (root, ball) = match a.domain.dim() {
        1 => ("<i>K</i> / 2", "length of an interval"),
        2 => ("√(<i>K</i> / π)", "area of a disk"),
        _ => ("∛(3 <i>K</i> / 4π)", "volume of a ball"),
    };
    Some(format!(
        "<i>L</i>(<i>r</i>) − <i>r</i> with <i>L</i> = {root}: <i>λK</i>(<i>r</i>) is the mean number of further points \
         within <i>r</i> of a point. For independent points <i>K</i> is the {ball} of radius <i>r</i>, and \
         <i>L</i> = <i>r</i>; above 0 points have more neighbours than that, below fewer. Values at different <i>r</i> \
         share their pairs: they are correlated.{}{}",
        inhomogeneous_caption(a),
        envelope::caption(a, &["k", "l_minus_r"])
    ))
}

/// L - r within two classes and between them, with the band of the last; 0 for independent points.
pub(super) fn cross_k(analysis: &Analysis) -> Option<Figure> {
    let cross = analysis.cross_k()?;
    let between = &cross.between;
    let start = |b: usize| if b == 0 { 0.0 } else { between.r[b - 1] };
    let intervals: Vec<_> = between.r.iter().enumerate().map(|(b, &r)| (start(b), r, r)).collect();
    let band = |k: &KFunction| -> Vec<Option<(f64, f64)>> {
        let ends = |(&l, se): (&f64, &Option<f64>)| (l - se.unwrap_or(0.0), l + se.unwrap_or(0.0));
        k.l_minus_r.iter().zip(&k.l_se).map(|each| each.0.is_finite().then(|| ends(each))).collect()
    };
    let all = [&cross.a, &cross.b, between].map(band);
    let ends = all.iter().flatten().flatten().flat_map(|&(lo, hi)| [lo, hi]);
    let (lo, hi) = extent(&ends.chain([0.0]).collect::<Vec<_>>())?;
    let pad = (0.06 * (hi - lo)).max(1e-3 * intervals.last()?.2);
    let [a, b] = cross.classes.each_ref().map(|name| escape(&shortened(name, 18)));
    let at = |k: &KFunction| runs(intervals.iter().zip(&k.l_minus_r).map(|(&x, &l)| (x, l.is_finite().then_some(l))));
    let line = |[from, to]: [usize; 2], color, k: &KFunction| Layer::Line {
        name: format!("{} – {}", [&a, &b][from], [&a, &b][to]),
        color,
        width: 1.6,
        stroke: Stroke::Solid,
        runs: at(k),
        of: Of::Column(format!("l_minus_r_{}_{}", cross.classes[from], cross.classes[to]).into()),
    };
    let layers = vec![
        Layer::Level { name: "independent: L = r".into(), y: 0.0 },
        Layer::Band {
            name: "±1 s.e.".into(),
            color: BLUE,
            runs: band_runs(intervals.iter().copied().zip(all[2].iter().copied())),
        },
        line([0, 0], GREEN, &cross.a),
        line([1, 1], VERMILION, &cross.b),
        line([0, 1], BLUE, between),
    ];
    let units = Units::of(analysis).escaped();
    Some(Figure {
        title: axes::K_FUNCTION_CROSS.title_of(analysis),
        subject: analysis.subject.clone(),
        note: format!("{} · {}", size_and_weights(analysis), error_note(between.errors, "Poisson counts")),
        x_label: axes::K_FUNCTION_CROSS.x_label(&units),
        y_label: axes::K_FUNCTION_CROSS.y_label(&units),
        x: 0.0..intervals.last()?.2,
        y: lo - pad..hi + pad,
        log_x: false,
        log_y: false,
        top: None,
        layers,
        numbers: axes::K_FUNCTION_CROSS.numbers(),
    })
}

/// What the picture of K of two classes shows.
pub(super) fn cross_k_caption(a: &Analysis, _: &str) -> Option<String> {
    let [a, b] = a.cross_k()?.classes.each_ref().map(|name| escape(name));
    Some(format!(
        "<i>L</i>(<i>r</i>) − <i>r</i> of the classes {a} (<i>A</i>) and {b} (<i>B</i>) alone, and between them: \
         <i>λ<sub>B</sub> K<sub>AB</sub></i>(<i>r</i>) is the mean number of points of <i>B</i> within <i>r</i> of a point \
         of <i>A</i>. Between them 0 means that the classes are independent of each other, above 0 they attract."
    ))
}
