//! Pictures of integration errors.

use std::borrow::Cow;
use std::fmt::Write as _;

use crate::display::escape;
use crate::display::figure::{Figure, IN_TURN, Layer, Numbers, Of, Rgb, Stroke};
use crate::display::{
    Attribution, ColorMap, Decades, Form, Pixels, Units, distance_sums, error_bars, frequency_sums, human,
};
use crate::estimate::{Analysis, IntegrationError};
use crate::statistics::{At, Cells, Map, Steps, Svg};

const WIDTH: f64 = 900.0;
const LEFT: f64 = 250.0;
const RIGHT: f64 = 870.0;
const TOP: f64 = 96.0;
/// Height of an integrand.
const ROW: f64 = 66.0;

/// `variance.svg`: predicted and observed variance over that of random points, with two standard errors, on a logarithmic scale.
pub(super) fn variance(a: &Analysis) -> Svg {
    let all = error_bars(a);
    let decades = Decades::of(&all);
    let place = |part: f64| LEFT + part * (RIGHT - LEFT);
    let bottom = TOP + ROW * all.len() as f64;
    let height = bottom + 76.0;
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:.0}" height="{height:.0}" viewBox="0 0 {WIDTH:.0} {height:.0}" font-family="Helvetica, Arial, sans-serif" font-size="13" fill="#222">
<rect width="100%" height="100%" fill="#fff"/>
<text x="24" y="30" font-size="18" font-weight="bold">Variance of the integral, over that of random points</text>
<text x="24" y="50" font-size="12" fill="#555">{}</text>
"##,
        escape(&a.subject)
    );
    for (k, form) in Form::ALL.iter().enumerate() {
        let (x, Rgb(r, g, b)) = (24.0 + 215.0 * k as f64, form.color());
        let _ = writeln!(
            svg,
            r#"<circle cx="{x:.0}" cy="70" r="4.5" fill="rgb({r},{g},{b})"/><text x="{:.0}" y="74.5" font-size="12">{}</text>"#,
            x + 10.0,
            form.title()
        );
    }
    let _ = writeln!(svg, r##"<path d="M{:.1} {TOP}V{bottom:.1}" stroke="#999"/>"##, place(decades.place(1.0)));
    for (at, label) in decades.ticks() {
        let x = place(at);
        let _ = writeln!(
            svg,
            r##"<path d="M{x:.1} {TOP}V{bottom:.1}" stroke="#999" stroke-dasharray="2 3"/><text x="{x:.1}" y="{:.1}" text-anchor="middle">{label}</text>"##,
            bottom + 18.0
        );
    }
    for (k, bars) in all.iter().enumerate() {
        let top = TOP + ROW * k as f64;
        let _ = writeln!(svg, r##"<path d="M24 {top:.1}H{RIGHT}" stroke="#ddd"/>"##);
        let (name, rest) = bars.spec.split_once(':').unwrap_or((&bars.spec, ""));
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
        for bar in &bars.each {
            let line = Form::ALL.iter().position(|form| *form == bar.form).unwrap_or_default();
            let (y, Rgb(r, g, b)) = (top + 12.0 + 14.0 * line as f64, bar.form.color());
            let color = format!("rgb({r},{g},{b})");
            if bar.value <= 0.0 {
                let _ = writeln!(svg, r#"<text x="{LEFT}" y="{:.1}" font-size="11" fill="{color}">0</text>"#, y + 4.0);
                continue;
            }
            let ends = bar.ends.map(|end| place(decades.place(end)));
            let _ = writeln!(
                svg,
                r#"<path d="M{:.1} {y:.1}H{:.1}" stroke="{color}" stroke-width="1.6"/><circle cx="{:.1}" cy="{y:.1}" r="3.6" fill="{color}"><title>{}</title></circle>"#,
                ends[0],
                ends[1],
                place(decades.place(bar.value)),
                escape(&bar.text)
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

/// The curve of an integrand, by its place in the list.
fn line(one: &IntegrationError, k: usize, run: Vec<(f64, f64)>) -> Layer {
    let name = one.integrand.spec().split(':').next().unwrap_or_default();
    let stroke = if k < IN_TURN.len() { Stroke::Solid } else { Stroke::Dashed };
    let color = IN_TURN[k % IN_TURN.len()];
    Layer::Line { name: escape(name), color, width: 2.0, stroke, runs: vec![run], of: Of::Points }
}

/// `attribution.svg`: the share of the predicted variance that frequencies up to |m| add.
pub(super) fn attribution(a: &Analysis) -> Option<Figure> {
    let found = a.integration()?;
    let mut layers = Vec::new();
    let mut end = 1f64;
    for (k, one) in found.each.iter().enumerate() {
        let run: Vec<(f64, f64)> = frequency_sums(one).into_iter().map(|[m, share]| (m, share)).collect();
        if run.is_empty() {
            continue;
        }
        // As far as all but a hundredth.
        end = run.iter().find(|p| p.1 > 0.99).or(run.last()).map_or(end, |p| end.max(p.0));
        layers.push(line(one, k, run));
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
        numbers: Some(Numbers { table: "attribution.csv", x: "m", x_factor: 1.0 }),
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
            cells: cells(&map, &pixels),
            quantity: "|f_m|² P / v₀",
            pixels,
            bar: Attribution::ticks(largest),
            caption,
        })
    };
    found.iter().filter_map(map).collect()
}

/// What each pixel of a map stands for.
fn cells(map: &Attribution<'_>, pixels: &Pixels) -> Cells {
    let [x, y] = map.half().map(|half| half as i32);
    let each = (2 * x.max(y) as usize + 1).div_ceil(MAP).max(1);
    let part = |m: [i32; 2]| if m == [0, 0] { None } else { map.part(m) };
    if each == 1 {
        return Cells::of_modes([x, y], "|f_m|² P / v₀", |m| part(m).unwrap_or(f64::NAN));
    }
    let modes = |cell: usize, half: i32| {
        let first = (cell * each) as i32 - half;
        first..(first + each as i32).min(half + 1)
    };
    let largest = |[column, row]: [usize; 2]| {
        let all = modes(row, y).flat_map(|m1| modes(column, x).map(move |m0| [m0, m1]));
        all.filter_map(part).reduce(f64::max).unwrap_or(f64::NAN)
    };
    let along = |name: &str, half: i32, count: usize, up: bool| {
        let (first, step) = (f64::from(-half), each as f64);
        let (first, step) = if up { (first + step * (count - 1) as f64, -step) } else { (first, step) };
        Steps { name: name.into(), at: At::Even { first, step, count, each } }
    };
    let places = (0..pixels.height).rev().flat_map(|row| (0..pixels.width).map(move |column| [column, row]));
    Cells {
        place: [0.0, 0.0, 1.0, 1.0],
        axes: [along("m_x", x, pixels.width, false), along("m_y", y, pixels.height, true)],
        quantity: "|f_m|² P / v₀",
        values: places.map(largest).collect(),
    }
}

/// `attribution_lags.svg`: the predicted variance of single points and of pairs up to a distance, over that of single points alone.
pub(super) fn lags(a: &Analysis) -> Option<Figure> {
    let found = a.integration()?;
    let mut layers = Vec::new();
    let (mut end, mut high, mut low) = (0.05f64, 1f64, 0f64);
    for (k, one) in found.each.iter().enumerate() {
        let run: Vec<(f64, f64)> = distance_sums(one).into_iter().map(|[r, sum]| (r, sum)).collect();
        if run.is_empty() {
            continue;
        }
        let last = run.last().map_or(1.0, |p| p.1);
        high = run.iter().map(|p| p.1).fold(high, f64::max);
        low = run.iter().map(|p| p.1).fold(low, f64::min);
        // As far as it still changes.
        end = run.iter().rev().find(|p| (p.1 - last).abs() > 0.01 * (1.0 + last.abs())).map_or(end, |p| end.max(p.0));
        layers.push(line(one, k, run));
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
        numbers: Some(Numbers { table: "attribution_lags.csv", x: "r", x_factor: 1.0 }),
    })
}
