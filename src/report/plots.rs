//! The pictures that plot curves: what is drawn in each, and over which range.

use std::ops::Range;

use super::figure::{
    BLUE, Figure, GREEN, GREY, INK, Layer, ORANGE, PURPLE, SKY, TopAxis, VERMILION, band_runs, runs, sub,
};
use super::text::{escape, human, shortened};
use super::units::FrequencyUnit;
use crate::analysis::Analysis;
use crate::estimate::{Envelope, ErrorSource, Normalization, RadialSpectrum};
use crate::plan::{Convention, SmoothingKernel};

pub(super) type Svg = Result<String, Box<dyn std::error::Error + Send + Sync>>;

/// `n = 1024, K = 20`.
pub(super) fn size(analysis: &Analysis) -> String {
    let shape = &analysis.shape;
    let n = if analysis.min_points == shape.max_points {
        shape.max_points.to_string()
    } else {
        format!("{}–{} (mean {})", analysis.min_points, shape.max_points, human(shape.mean_points))
    };
    format!("n = {n}, K = {}", shape.realizations)
}

/// What a band around an estimate shows; `theory` names the theory used for K = 1.
fn error_note(source: ErrorSource, theory: &str) -> String {
    match source {
        ErrorSource::AcrossRealizations => "band: ±1 standard error across realizations".into(),
        ErrorSource::Theory => format!("band: ±1 standard error from theory ({theory})"),
    }
}

/// How the kernel estimate is called.
pub(super) fn kernel_name(shape: SmoothingKernel) -> &'static str {
    match shape {
        SmoothingKernel::Epanechnikov => "Epanechnikov",
        SmoothingKernel::Gaussian => "Gaussian",
        SmoothingKernel::Box => "box",
    }
}

/// The symbol of the closest-packing distance, as HTML/SVG-neutral (base, subscript).
pub(super) fn packing_symbol(dim: usize) -> (&'static str, &'static str) {
    match dim {
        1 => ("d", "even"),
        2 => ("d", "hex"),
        _ => ("d", "fcc"),
    }
}

/// g against r, with its band, g = 1, the kernel estimate and the closed form.
pub(super) fn pcf(analysis: &Analysis) -> Option<Svg> {
    let pcf = analysis.pair_correlation()?;
    let intervals: Vec<_> = pcf.r.iter().enumerate().map(|(b, &r)| (pcf.r_lo[b], r, pcf.r_hi[b])).collect();
    let (first, last) = (*intervals.first()?, *intervals.last()?);
    // Bins that grow by much cover decades: on a linear axis the small ones would share a few pixels.
    let log_x = first.0 > 0.0 && last.2 > 20.0 * first.0 && last.2 - last.0 > 5.0 * (first.2 - first.0);
    let values: Vec<(f64, f64)> = pcf.g.iter().copied().zip(pcf.g_se.iter().copied()).collect();
    let closed = analysis.closed_form.g.as_deref();
    let kernel = analysis.kernel();
    let smooth: Vec<f64> = closed.unwrap_or_default().to_vec();
    let (y, log_y) = match decades(&values) {
        Some(range) => (range, true),
        None => (0.0..top_of(&values, &smooth), false),
    };
    let top = y.end;

    let at = |y: &[f64]| runs(intervals.iter().zip(y).map(|(&x, &y)| (x, Some(y))));
    let mut layers = vec![Layer::Level { name: "g = 1".into(), y: 1.0 }];
    let envelope = analysis.envelopes().and_then(|e| e.find("g"));
    layers.extend(envelope.map(|e| global_band("random, global", &intervals, e)));
    layers.extend([
        Layer::Band {
            name: "±1 s.e.".into(),
            color: BLUE,
            runs: band_runs(intervals.iter().zip(&values).map(|(&x, &(g, se))| (x, Some((g - se, g + se))))),
        },
        Layer::Line { name: "estimate".into(), color: BLUE, width: 1.6, dashed: false, runs: at(&pcf.g) },
    ]);
    if let Some(k) = kernel {
        let name = format!("{} kernel", kernel_name(k.kernel.shape));
        let samples = intervals.iter().zip(&k.g).map(|(&x, &g)| (x, g));
        layers.push(Layer::Line { name, color: VERMILION, width: 1.4, dashed: false, runs: runs(samples) });
    }
    if let Some(g) = closed {
        layers.push(Layer::Line { name: closed_name(analysis), color: INK, width: 1.4, dashed: true, runs: at(g) });
    }
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
    let x = 0.0..rings.last()?.nu_hi;
    let values: Vec<(f64, f64)> = rings.iter().map(|r| (r.p, r.p_se)).collect();
    let closed = analysis.closed_form.radial.as_deref();
    let top = top_of(&values, closed.unwrap_or_default());
    let samples = |y: &[f64]| runs(rings.iter().zip(y).map(|(r, &y)| ((r.nu_lo, r.nu, r.nu_hi), Some(y))));
    let band = rings.iter().map(|r| ((r.nu_lo, r.nu, r.nu_hi), Some((r.p - r.p_se, r.p + r.p_se))));
    let p: Vec<f64> = rings.iter().map(|r| r.p).collect();
    let confidence = rings.iter().map(|r| ((r.nu_lo, r.nu, r.nu_hi), r.band.map(|b| (b.lo, b.hi))));
    let mut layers = vec![
        Layer::Level { name: "P = 1".into(), y: 1.0 },
        Layer::Band { name: "95 %".into(), color: SKY, runs: band_runs(confidence) },
        Layer::Band { name: "±1 s.e.".into(), color: BLUE, runs: band_runs(band) },
        Layer::Line { name: "radial mean".into(), color: BLUE, width: 1.6, dashed: false, runs: samples(&p) },
    ];
    if let Some(p) = closed {
        let name = closed_name(analysis);
        layers.push(Layer::Line { name, color: INK, width: 1.4, dashed: true, runs: samples(p) });
    }
    layers.extend(mean_frequency(analysis, x.end));
    let figure = Figure {
        title: "Radial mean of the power spectrum P(ν)",
        subject: analysis.subject.clone(),
        note: format!(
            "{} · {}{}",
            size(analysis),
            error_note(radial.errors, "exponential ordinates"),
            cut(p.iter().copied(), top)
        ),
        x_label: frequency_label(analysis),
        y_label: "P(ν) (dimensionless)".into(),
        x,
        y: 0.0..top,
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
    if analysis.domain.dim() == 1 {
        return None;
    }
    let radial = analysis.radial()?;
    let rings = &radial.rings;
    let reference = radial.anisotropy_reference_db;
    let x = 0.0..rings.last()?.nu_hi;
    let defined = defined_anisotropy(radial);
    let y = anisotropy_range(radial);
    let outside = defined.iter().filter(|a| !y.contains(a)).count();

    let interval = |r: &crate::estimate::Ring| (r.nu_lo, r.nu, r.nu_hi);
    let scatter = rings.iter().map(|r| (interval(r), r.anisotropy_db_se.map(|se| (reference - se, reference + se))));
    let db = human(reference);
    let mut layers = vec![
        Layer::Band { name: "expected scatter, ±1 s.d.".into(), color: GREY, runs: band_runs(scatter) },
        Layer::Level { name: format!("isotropic: {db} dB"), y: reference },
        Layer::Line {
            name: "anisotropy".into(),
            color: BLUE,
            width: 1.6,
            dashed: false,
            runs: runs(rings.iter().map(|r| (interval(r), r.anisotropy_db))),
        },
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

fn defined_anisotropy(radial: &RadialSpectrum) -> Vec<f64> {
    radial.rings.iter().filter_map(|r| r.anisotropy_db).filter(|a| a.is_finite()).collect()
}

/// The range of anisotropy that is drawn.
pub(super) fn anisotropy_range(radial: &RadialSpectrum) -> Range<f64> {
    let reference = radial.anisotropy_reference_db;
    let defined = defined_anisotropy(radial);
    let (lowest, highest) = extent(&defined).unwrap_or((reference, reference));
    let (q_lo, q_hi) = (quantile(&defined, 0.03).unwrap_or(reference), quantile(&defined, 0.97).unwrap_or(reference));
    // The first rings hold few modes and scatter by many dB; they may leave the frame, the rest may not.
    let slack = (0.7 * (q_hi - q_lo)).max(1.5);
    let lo = lowest.max(q_lo - slack).min(reference - 4.0);
    let hi = highest.min(q_hi + slack).max(reference + 4.0);
    let pad = 0.04 * (hi - lo);
    lo - pad..hi + pad
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
fn global_band(name: &str, intervals: &[(f64, f64, f64)], envelope: &Envelope) -> Layer {
    let range = |(&lo, &hi): (&f64, &f64)| lo.is_finite().then_some((lo, hi));
    let band = envelope.global[0].iter().zip(&envelope.global[1]).map(range);
    Layer::Band { name: name.into(), color: GREY, runs: band_runs(intervals.iter().copied().zip(band)) }
}

fn closed_name(analysis: &Analysis) -> String {
    let name = &analysis.closed_form.name;
    if name.is_empty() { "closed form".into() } else { format!("closed form: {}", escape(&shortened(name, 28))) }
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

/// The upper end of an axis from 0: everything, unless a few values would squash the rest. Values whose error is of
/// their own size (the first, nearly empty bins) do not count; well measured ones may rise to 6 times the bulk.
pub(super) fn top_of(values: &[(f64, f64)], smooth: &[f64]) -> f64 {
    let finite: Vec<(f64, f64)> = values.iter().copied().filter(|(v, _)| v.is_finite()).collect();
    let calm: Vec<(f64, f64)> = finite.iter().copied().filter(|&(v, se)| se <= 0.3 * v.max(1.0)).collect();
    let (counted, headroom) = if 2 * calm.len() >= finite.len() { (calm, 6.0) } else { (finite, 2.5) };
    let bulk: Vec<f64> = counted.iter().map(|v| v.0).collect();
    let reach = |&(v, se): &(f64, f64)| if se.is_finite() { v + se } else { v };
    let all: Vec<f64> = counted.iter().map(reach).chain(smooth.iter().copied().filter(|v| v.is_finite())).collect();
    let limit = headroom * quantile(&bulk, 0.95).unwrap_or(1.0).max(1.0);
    let highest = extent(&all).map_or(1.0, |e| e.1);
    1.06 * highest.min(limit).max(1.3)
}

/// The range of a clustered pattern, whose g falls from far above 1: decades, since on a linear axis either the clusters
/// or the rest could be seen. Not for curves that are 0 in many places, such as a lattice's.
fn decades(values: &[(f64, f64)]) -> Option<Range<f64>> {
    let positive: Vec<f64> = values.iter().filter(|(v, se)| v.is_finite() && *v > 0.0 && se < v).map(|v| v.0).collect();
    let (lowest, highest) = extent(&positive)?;
    let whole = 5 * positive.len() >= 3 * values.len() && highest > 30.0;
    whole.then(|| (0.7 * lowest.min(0.5)).max(1e-3)..1.5 * highest)
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
pub(super) fn half_turn<S>(
    sectors: &[S],
    theta: impl Fn(&S) -> [f64; 3],
) -> impl Iterator<Item = ((f64, f64, f64), &S)> {
    let first = sectors.first().filter(|s| theta(s)[1] == 0.0).map(|s| (180.0, s));
    sectors.iter().map(|s| (0.0, s)).chain(first).map(move |(turn, s)| {
        let [lo, at, hi] = theta(s).map(|t| t.to_degrees() + turn);
        ((lo.max(0.0), at, hi.min(180.0)), s)
    })
}

/// The range of values about 1, which is part of the picture, and which noise does not fill.
pub(super) fn about_one(values: &[f64]) -> Option<Range<f64>> {
    let (lowest, highest) = extent(values)?;
    let (lowest, highest) = (lowest.clamp(0.0, 0.98), highest.max(1.02));
    let pad = 0.06 * (highest - lowest);
    Some((lowest - pad).max(0.0)..highest + pad)
}

pub(super) fn extent(values: &[f64]) -> Option<(f64, f64)> {
    let first = *values.first()?;
    Some(values.iter().fold((first, first), |(lo, hi), &v| (lo.min(v), hi.max(v))))
}

fn quantile(values: &[f64], q: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(((sorted.len().max(1) - 1) as f64 * q).round() as usize).copied()
}
