//! Pictures of integration errors.

use std::borrow::Cow;
use std::fmt::Write as _;

use crate::display::escape;
use crate::display::figure::{BLUE, Figure, GREEN, INK, Layer, ORANGE, PURPLE, Rgb, SKY, Stroke, VERMILION};
use crate::display::{Attribution, ColorMap, Units, distance_sums, frequency_sums, human};
use crate::estimate::{Analysis, IntegrationError, IntegrationErrors, Measured};
use crate::statistics::{Map, Svg};

const COLORS: [Rgb; 7] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, INK];

const WIDTH: f64 = 900.0;
const LEFT: f64 = 250.0;
const RIGHT: f64 = 870.0;
const TOP: f64 = 96.0;
/// Height of an integrand.
const ROW: f64 = 66.0;

type Value = fn(&IntegrationError) -> Option<Measured>;

/// What is drawn of each integrand, from the top down.
const ROWS: [(&str, Rgb, Value); 4] = [
    ("predicted, spectral with its tail", BLUE, |e| Some(e.closed)),
    ("predicted, spatial", GREEN, |e| e.spatial),
    ("observed, shifted", VERMILION, |e| Some(e.shifted)),
    ("observed, as it is (variance)", INK, |e| e.observed),
];

/// `variance.svg`: predicted and observed variance over that of random points, with two standard errors, on a logarithmic scale.
pub(super) fn variance(a: &Analysis, found: &IntegrationErrors) -> Svg {
    let relative = |e: &IntegrationError, x: f64| if e.v0 > 0.0 { x * a.shape.mean_points / e.v0 } else { 0.0 };
    let values =
        found.each.iter().flat_map(|e| ROWS.iter().filter_map(move |row| Some(relative(e, (row.2)(e)?.value))));
    let (low, high) = values.filter(|v| *v > 0.0).fold((1.0f64, 1.0f64), |(a, b), v| (a.min(v), b.max(v)));
    let (low, high) = ((0.6 * low).log10(), (1.7 * high).log10());
    let place = |v: f64| LEFT + (v.log10() - low) / (high - low) * (RIGHT - LEFT);
    let bottom = TOP + ROW * found.each.len() as f64;
    let height = bottom + 76.0;
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:.0}" height="{height:.0}" viewBox="0 0 {WIDTH:.0} {height:.0}" font-family="Helvetica, Arial, sans-serif" font-size="13" fill="#222">
<rect width="100%" height="100%" fill="#fff"/>
<text x="24" y="30" font-size="18" font-weight="bold">Variance of the integral, over that of random points</text>
<text x="24" y="50" font-size="12" fill="#555">{}</text>
"##,
        escape(&a.subject)
    );
    for (k, (name, Rgb(r, g, b), _)) in ROWS.iter().enumerate() {
        let x = 24.0 + 215.0 * k as f64;
        let _ = writeln!(
            svg,
            r#"<circle cx="{x:.0}" cy="70" r="4.5" fill="rgb({r},{g},{b})"/><text x="{:.0}" y="74.5" font-size="12">{name}</text>"#,
            x + 10.0
        );
    }
    for power in (low.ceil() as i32)..=(high.floor() as i32) {
        let x = place(10f64.powi(power));
        let dash = if power == 0 { "" } else { r#" stroke-dasharray="2 3""# };
        let _ = writeln!(svg, r##"<path d="M{x:.1} {TOP}V{bottom:.1}" stroke="#999"{dash}/>"##);
        let label = if (-3..=3).contains(&power) { format!("{}", 10f64.powi(power)) } else { format!("1e{power}") };
        let _ = writeln!(svg, r#"<text x="{x:.1}" y="{:.1}" text-anchor="middle">{label}</text>"#, bottom + 18.0);
    }
    for (k, e) in found.each.iter().enumerate() {
        let top = TOP + ROW * k as f64;
        let _ = writeln!(svg, r##"<path d="M24 {top:.1}H{RIGHT}" stroke="#ddd"/>"##);
        let spec = e.integrand.spec();
        let (name, rest) = spec.split_once(':').unwrap_or((spec, ""));
        let shown: String = rest.chars().take(36).collect();
        let more = if rest.chars().count() > 36 { "…" } else { "" };
        let _ = writeln!(
            svg,
            r##"<text x="24" y="{:.1}" font-weight="bold">{}</text><text x="24" y="{:.1}" font-size="10.5" fill="#555">{}{more}</text>"##,
            top + 26.0,
            escape(name),
            top + 42.0,
            escape(&shown)
        );
        for (line, (_, Rgb(r, g, b), of)) in ROWS.iter().enumerate() {
            let y = top + 12.0 + 14.0 * line as f64;
            let Some(measured) = of(e) else { continue };
            let v = relative(e, measured.value);
            if v <= 0.0 {
                let _ = writeln!(
                    svg,
                    r#"<text x="{LEFT}" y="{:.1}" font-size="11" fill="rgb({r},{g},{b})">0</text>"#,
                    y + 4.0
                );
                continue;
            }
            let reach = 2.0 * relative(e, measured.se.unwrap_or(0.0));
            let ends = [(v - reach).max(10f64.powf(low)), v + reach].map(|v| place(v).clamp(LEFT, RIGHT));
            let color = format!("rgb({r},{g},{b})");
            let _ = writeln!(
                svg,
                r#"<path d="M{:.1} {y:.1}H{:.1}" stroke="{color}" stroke-width="1.6"/><circle cx="{:.1}" cy="{y:.1}" r="3.6" fill="{color}"><title>{} ± {}</title></circle>"#,
                ends[0],
                ends[1],
                place(v),
                human(measured.value),
                measured.se.map_or("?".into(), human)
            );
        }
    }
    let _ = writeln!(svg, r##"<path d="M24 {bottom:.1}H{RIGHT}" stroke="#ddd"/>"##);
    let _ = writeln!(
        svg,
        r#"<text x="{:.1}" y="{:.1}" text-anchor="middle">n × variance / (∫f² − I²); bars are two standard errors</text>"#,
        (LEFT + RIGHT) / 2.0,
        bottom + 42.0
    );
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// `attribution.svg`: the share of the predicted variance that frequencies up to |m| add.
pub(super) fn attribution(a: &Analysis) -> Option<Figure> {
    let found = a.integration()?;
    let mut layers = Vec::new();
    let mut end = 1f64;
    for (one, color) in found.each.iter().zip(COLORS.iter().cycle()) {
        let run: Vec<(f64, f64)> = frequency_sums(one).into_iter().map(|[m, share]| (m, share)).collect();
        if run.is_empty() {
            continue;
        }
        // As far as all but a hundredth.
        end = run.iter().find(|p| p.1 > 0.99).or(run.last()).map_or(end, |p| end.max(p.0));
        let name = one.integrand.spec().split(':').next().unwrap_or_default();
        let stroke = if layers.len() < COLORS.len() { Stroke::Solid } else { Stroke::Dashed };
        layers.push(Layer::Line { name: escape(name), color: *color, width: 2.0, stroke, runs: vec![run] });
    }
    (!layers.is_empty()).then(|| Figure {
        title: Cow::Borrowed("Which frequencies the variance comes from"),
        subject: escape(&a.subject),
        note: "predicted variance of frequencies up to |m|, over all with the tail".into(),
        x_label: "|m|, cycles per side".into(),
        y_label: "share of the variance".into(),
        x: 1.0..(1.05 * end).max(2.0),
        y: 0.0..1.05,
        log_x: true,
        log_y: false,
        top: None,
        layers,
    })
}

/// Pixels of a map per axis at most; one of several frequencies is that of the largest.
const MAP: usize = 640;

/// `attribution_map.svg`: what every frequency adds to the variance, an integrand below the other; in 3D the plane m_z = 0.
pub(super) fn maps(a: &Analysis) -> Vec<Map<'_>> {
    let found = a.integration().map_or(&[][..], |found| &found.each);
    let cycles = Units::of(a).cycles;
    let map = |e| {
        let map = Attribution::of(a, e)?;
        let ([x, y], largest) = (map.half(), map.largest());
        let pixels = map.pixels(largest, ColorMap::Viridis, MAP);
        let plane = if a.domain.dim() == 3 { ", the plane m_z = 0" } else { "" };
        let each = match pixels.width.max(pixels.height) < 2 * x.max(y) as usize + 1 {
            true => "each pixel the largest of several",
            false => "one pixel each",
        };
        let caption = format!(
            "Frequencies m_x = -{x}..{x} to the right, m_y = -{y}..{y} upward{plane}, {each}, DC (the centre) grey; logarithmic, from the \
             largest, {}, down six decades; viridis, from dark blue to yellow.",
            human(largest)
        );
        Some(Map {
            heading: [
                Cow::Borrowed(map.spec()),
                "what each frequency adds to the variance".into(),
                Cow::Borrowed(&a.subject),
            ],
            labels: pixels.axes.map(|axis| format!("ν_{} ({cycles})", ["x", "y", "z"][axis])),
            pixels,
            quantity: "|f_m|² P / v₀",
            bar: Attribution::ticks(largest),
            caption,
        })
    };
    found.iter().filter_map(map).collect()
}

/// `attribution_lags.svg`: the predicted variance of single points and of pairs up to a distance, over that of single points alone.
pub(super) fn lags(a: &Analysis) -> Option<Figure> {
    let found = a.integration()?;
    let mut layers = Vec::new();
    let (mut end, mut high, mut low) = (0.05f64, 1f64, 0f64);
    for (one, color) in found.each.iter().zip(COLORS.iter().cycle()) {
        let run: Vec<(f64, f64)> = distance_sums(one).into_iter().map(|[r, sum]| (r, sum)).collect();
        if run.is_empty() {
            continue;
        }
        let last = run.last().map_or(1.0, |p| p.1);
        high = run.iter().map(|p| p.1).fold(high, f64::max);
        low = run.iter().map(|p| p.1).fold(low, f64::min);
        // As far as it still changes.
        end = run.iter().rev().find(|p| (p.1 - last).abs() > 0.01 * (1.0 + last.abs())).map_or(end, |p| end.max(p.0));
        let name = one.integrand.spec().split(':').next().unwrap_or_default();
        let stroke = if layers.len() < COLORS.len() { Stroke::Solid } else { Stroke::Dashed };
        layers.push(Layer::Line { name: escape(name), color: *color, width: 2.0, stroke, runs: vec![run] });
    }
    (!layers.is_empty()).then(|| Figure {
        title: Cow::Borrowed("At which distances correlation acts"),
        subject: escape(&a.subject),
        note: "predicted variance of single points and pairs up to |r|, over that of single points".into(),
        x_label: "|r|, in sides of the box".into(),
        y_label: "variance, of as many random points".into(),
        x: 0.0..1.2 * end,
        y: (1.05 * low)..1.05 * high,
        log_x: false,
        log_y: false,
        top: None,
        layers,
    })
}
