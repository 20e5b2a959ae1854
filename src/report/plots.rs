//! The pictures that plot curves: what is drawn in each, and over which range.

use super::figure::{
    BLUE, Figure, GREEN, GREY, INK, Layer, ORANGE, PURPLE, SKY, TopAxis, VERMILION, band_runs, runs, sub,
};
use crate::display::{
    FrequencyUnit, Interval, Panel, Samples, about_one, decades, defined_anisotropy, error_note, escape, extent, human,
    kernel_name, packing_symbol, shortened, size, top_of,
};
use crate::estimate::{Analysis, Envelope, Normalization};
use crate::plan::Convention;

pub(super) type Svg = Result<String, Box<dyn std::error::Error + Send + Sync>>;

/// g against r, with its band, g = 1, the kernel estimate and the closed form.
pub(super) fn pcf(analysis: &Analysis) -> Option<Svg> {
    let pcf = analysis.pair_correlation()?;
    let samples = Panel::Pcf.samples(analysis)?;
    let (first, last) = (samples.all.first()?.interval, samples.all.last()?.interval);
    // Bins that grow by much cover decades: on a linear axis the small ones would share a few pixels.
    let log_x = first.0 > 0.0 && last.2 > 20.0 * first.0 && last.2 - last.0 > 5.0 * (first.2 - first.0);
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
    layers.extend(envelope.map(|e| global_band("random, global", &intervals, e)));
    layers.extend([
        Layer::Band { name: "±1 s.e.".into(), color: BLUE, runs: band_runs(samples.bands()) },
        Layer::Line { name: "estimate".into(), color: BLUE, width: 1.6, dashed: false, runs: runs(samples.values()) },
    ]);
    if let Some(k) = kernel {
        let name = format!("{} kernel", kernel_name(k.kernel.shape));
        let smoothed = intervals.iter().zip(&k.g).map(|(&x, &g)| (x, g));
        layers.push(Layer::Line { name, color: VERMILION, width: 1.4, dashed: false, runs: runs(smoothed) });
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
    let figure = Figure {
        title: "Pair correlation function g(r)",
        subject: analysis.subject.clone(),
        note: format!(
            "{}{normalization} · {}{random}{bandwidth}{}{below}",
            size(analysis),
            error_note(pcf.errors, "Poisson counts"),
            cut(pcf.g.iter().copied(), top)
        ),
        x_label: "distance r (length units of the domain)".into(),
        y_label: "g(r) (dimensionless)".into(),
        x: if log_x { first.0..last.2 } else { 0f64.min(first.0)..last.2 },
        y,
        log_x,
        log_y,
        top: Some(TopAxis { label: format!("r / {symbol} ({symbol} = {}, closest packing)", human(unit)), unit }),
        layers,
    };
    Some(figure.svg())
}

/// g within two classes and between them, with the band of the last, and g = 1.
pub(super) fn cross(analysis: &Analysis) -> Option<Svg> {
    let cross = analysis.cross()?;
    let between = &cross.between;
    let intervals: Vec<_> = between.r.iter().enumerate().map(|(b, &r)| (between.r_lo[b], r, between.r_hi[b])).collect();
    let values: Vec<(f64, f64)> = between.g.iter().copied().zip(between.g_se.iter().copied()).collect();
    let own: Vec<f64> =
        [&cross.a, &cross.b].iter().filter_map(|g| extent(&settled(&g.g, &g.g_se))).map(|e| e.1).collect();
    let top = top_of(&values, &own);
    let [a, b] = cross.classes.each_ref().map(|name| escape(&shortened(name, 18)));
    let at = |g: &[f64]| runs(intervals.iter().zip(g).map(|(&x, &g)| (x, Some(g))));
    let line = |name, color, g: &[f64]| Layer::Line { name, color, width: 1.6, dashed: false, runs: at(g) };
    let layers = vec![
        Layer::Level { name: "g = 1".into(), y: 1.0 },
        Layer::Band {
            name: "±1 s.e.".into(),
            color: BLUE,
            runs: band_runs(intervals.iter().zip(&values).map(|(&x, &(g, se))| (x, Some((g - se, g + se))))),
        },
        line(format!("{a} – {a}"), GREEN, &cross.a.g),
        line(format!("{b} – {b}"), VERMILION, &cross.b.g),
        line(format!("{a} – {b}"), BLUE, &between.g),
    ];
    let figure = Figure {
        title: "Pair correlation functions of two classes",
        subject: analysis.subject.clone(),
        note: format!(
            "{} · {}{}",
            size(analysis),
            error_note(between.errors, "Poisson counts"),
            cut([&cross.a.g, &cross.b.g, &between.g].into_iter().flatten().copied(), top)
        ),
        x_label: "distance r (length units of the domain)".into(),
        y_label: "g(r) (dimensionless)".into(),
        x: 0f64.min(intervals.first()?.0)..intervals.last()?.2,
        y: 0.0..top,
        log_x: false,
        log_y: false,
        top: None,
        layers,
    };
    Some(figure.svg())
}

/// Values known to better than themselves.
fn settled(values: &[f64], errors: &[f64]) -> Vec<f64> {
    values.iter().zip(errors).filter(|(v, se)| v.is_finite() && **se <= 0.3 * v.max(1.0)).map(|(v, _)| *v).collect()
}

/// L - r against r, with its band; 0 for complete spatial randomness.
pub(super) fn k_function(analysis: &Analysis) -> Option<Svg> {
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
    layers.extend(random.map(|e| global_band("random, global", &intervals, e)));
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
            dashed: false,
            runs: runs(intervals.iter().zip(&values).map(|(&x, v)| (x, v.0.is_finite().then_some(v.0)))),
        },
    ]);
    let (d, which) = packing_symbol(analysis.domain.dim());
    let unit = analysis.domain.closest_packing_distance(analysis.shape.mean_points);
    let symbol = format!("{d}{}", sub(which));
    let figure = Figure {
        title: "L(r) − r, from Ripley's K function",
        subject: analysis.subject.clone(),
        note: format!("{} · {}", size(analysis), error_note(k.errors, "Poisson counts")),
        x_label: "distance r (length units of the domain)".into(),
        y_label: "L(r) − r (length units of the domain)".into(),
        x: 0.0..intervals.last()?.2,
        y: lo - pad..hi + pad,
        log_x: false,
        log_y: false,
        top: Some(TopAxis { label: format!("r / {symbol} ({symbol} = {}, closest packing)", human(unit)), unit }),
        layers,
    };
    Some(figure.svg())
}

/// g against direction along every ring, with bands. Opposite directions are the same, so 0 to 180 degrees are all.
pub(super) fn pcf_angular(analysis: &Analysis) -> Option<Svg> {
    let vector = analysis.vector()?;
    let values: Vec<(f64, f64)> = vector.sectors.iter().filter_map(|s| Some((s.g?, s.g_se?))).collect();
    let ends: Vec<f64> = values.iter().flat_map(|&(g, se)| [g - se, g + se]).filter(|v| v.is_finite()).collect();
    let y = about_one(&ends)?;
    let mut layers = vec![Layer::Level { name: "g = 1".into(), y: 1.0 }];
    let colors = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY];
    for (ring, color) in vector.sectors.chunk_by(|a, b| a.r == b.r).zip(colors.into_iter().cycle()) {
        let samples: Vec<_> = half_turn(ring, |s| s.theta).map(|(x, s)| (x, s.g.zip(s.g_se))).collect();
        let band = samples.iter().map(|&(x, y)| (x, y.map(|(g, se)| (g - se, g + se))));
        layers.push(Layer::Band { name: String::new(), color, runs: band_runs(band) });
        let name = format!("r = {}", human(ring[0].r[1]));
        let line = runs(samples.iter().map(|&(x, y)| (x, y.map(|y| y.0))));
        layers.push(Layer::Line { name, color, width: 1.6, dashed: false, runs: line });
    }
    let figure = Figure {
        title: "Pair correlation function along rings g(r, θ)",
        subject: analysis.subject.clone(),
        note: format!("{} · {}", size(analysis), error_note(vector.errors, "Poisson counts")),
        x_label: "direction θ of the lag (degrees from the x axis)".into(),
        y_label: "g(r, θ) (dimensionless)".into(),
        x: 0.0..180.0,
        y,
        log_x: false,
        log_y: false,
        top: None,
        layers,
    };
    Some(figure.svg())
}

/// P against nu, with its band, P = 1, the closed form and the mean sampling frequency.
pub(super) fn spectrum_radial(analysis: &Analysis) -> Option<Svg> {
    let radial = analysis.radial()?;
    let rings = &radial.rings;
    let samples = Panel::Radial.samples(analysis)?;
    let x = 0.0..rings.last()?.nu_hi;
    let confidence = rings.iter().map(|r| ((r.nu_lo, r.nu, r.nu_hi), r.band.map(|b| (b.lo, b.hi))));
    let mut layers = vec![
        Layer::Level { name: "P = 1".into(), y: 1.0 },
        Layer::Band { name: "95 %".into(), color: SKY, runs: band_runs(confidence) },
        Layer::Band { name: "±1 s.e.".into(), color: BLUE, runs: band_runs(samples.bands()) },
        Layer::Line {
            name: "radial mean".into(),
            color: BLUE,
            width: 1.6,
            dashed: false,
            runs: runs(samples.values()),
        },
    ];
    layers.extend(closed_form(analysis, &samples, analysis.closed_form.radial.is_some()));
    layers.extend(mean_frequency(analysis, x.end));
    let figure = Figure {
        title: "Radial mean of the power spectrum P(ν)",
        subject: analysis.subject.clone(),
        note: format!(
            "{} · {}{}",
            size(analysis),
            error_note(radial.errors, "exponential ordinates"),
            cut(rings.iter().map(|r| r.p), samples.range.end)
        ),
        x_label: frequency_label(analysis),
        y_label: "P(ν) (dimensionless)".into(),
        x,
        y: samples.range,
        log_x: false,
        log_y: false,
        top: None,
        layers,
    };
    Some(figure.svg())
}

/// Anisotropy against nu, with the level of an isotropic spectrum and the scatter expected around it. In one dimension a
/// ring is a single independent mode: there is nothing to draw.
pub(super) fn anisotropy(analysis: &Analysis) -> Option<Svg> {
    let samples = Panel::Anisotropy.samples(analysis)?;
    let radial = analysis.radial()?;
    let rings = &radial.rings;
    let reference = radial.anisotropy_reference_db;
    let x = 0.0..rings.last()?.nu_hi;
    let defined = defined_anisotropy(radial);
    let y = samples.range.clone();
    let outside = defined.iter().filter(|a| !y.contains(a)).count();

    let db = human(reference);
    let mut layers = vec![
        Layer::Band { name: "expected scatter, ±1 s.d.".into(), color: GREY, runs: band_runs(samples.bands()) },
        Layer::Level { name: format!("isotropic: {db} dB"), y: reference },
        Layer::Line { name: "anisotropy".into(), color: BLUE, width: 1.6, dashed: false, runs: runs(samples.values()) },
    ];
    layers.extend(mean_frequency(analysis, x.end));
    let mut note = format!("{} · grey band: ±1 s.d. of an isotropic spectrum, from theory", size(analysis));
    if defined.is_empty() {
        note.push_str(" · undefined in every ring: no spread, or single modes");
    } else if outside > 0 {
        note.push_str(&format!(" · outside the frame: {outside} of {} rings", rings.len()));
    }
    let figure = Figure {
        title: "Anisotropy of the power spectrum",
        subject: analysis.subject.clone(),
        note,
        x_label: frequency_label(analysis),
        y_label: "anisotropy (dB)".into(),
        x,
        y,
        log_x: false,
        log_y: false,
        top: None,
        layers,
    };
    Some(figure.svg())
}

/// G and F against r, with their bands, and what both are for a Poisson process.
pub(super) fn neighbor_functions(analysis: &Analysis) -> Option<Svg> {
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
    let figure = Figure {
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
    };
    Some(figure.svg())
}

/// The global envelope of complete spatial randomness.
fn global_band(name: &str, intervals: &[Interval], envelope: &Envelope) -> Layer {
    let range = |(&lo, &hi): (&f64, &f64)| lo.is_finite().then_some((lo, hi));
    let band = envelope.global[0].iter().zip(&envelope.global[1]).map(range);
    Layer::Band { name: name.into(), color: GREY, runs: band_runs(intervals.iter().copied().zip(band)) }
}

/// The closed form, where there is one.
fn closed_form(analysis: &Analysis, samples: &Samples, known: bool) -> Option<Layer> {
    let name = match analysis.closed_form.name.as_str() {
        "" => "closed form".into(),
        name => format!("closed form: {}", escape(&shortened(name, 28))),
    };
    known.then(|| Layer::Line { name, color: INK, width: 1.4, dashed: true, runs: runs(samples.closed_form()) })
}

/// What ν is, by whose convention.
fn frequency_label(analysis: &Analysis) -> String {
    let unit = analysis.convention.labels().split(';').next().unwrap_or_default();
    match analysis.convention {
        Convention::Ours => format!("frequency ν ({unit})"),
        other => format!("frequency ν ({unit}; rings of {other})"),
    }
}

/// The frequency of one cycle per mean spacing, `lambda^(1/d)`, if it lies in the frame.
pub(super) fn mean_frequency(analysis: &Analysis, end: f64) -> Option<Layer> {
    if analysis.convention != Convention::Ours {
        return None;
    }
    let unit = FrequencyUnit::SqrtN;
    let nu = unit.size(&analysis.domain, analysis.shape.mean_points);
    let symbol = unit.symbol(&analysis.domain);
    (nu > 0.0 && nu < end).then(|| Layer::Hint { x: nu, label: format!("{symbol} = {}", human(nu)) })
}

/// Says so where values lie above the axis, or where there is none.
pub(super) fn cut(values: impl Iterator<Item = f64> + Clone, top: f64) -> String {
    if !values.clone().any(f64::is_finite) {
        return " · undefined everywhere".into();
    }
    let above: Vec<f64> = values.filter(|&v| v > top).collect();
    match extent(&above) {
        Some((_, largest)) => format!(" · ▲ {} above the frame, up to {}", above.len(), human(largest)),
        None => String::new(),
    }
}

/// The directions of sectors in degrees, from 0 to 180: opposite directions are the same, so one about 0 is at both ends.
pub(super) fn half_turn<S>(sectors: &[S], theta: impl Fn(&S) -> [f64; 3]) -> impl Iterator<Item = (Interval, &S)> {
    let first = sectors.first().filter(|s| theta(s)[1] == 0.0).map(|s| (180.0, s));
    sectors.iter().map(|s| (0.0, s)).chain(first).map(move |(turn, s)| {
        let [lo, at, hi] = theta(s).map(|t| t.to_degrees() + turn);
        ((lo.max(0.0), at, hi.min(180.0)), s)
    })
}
