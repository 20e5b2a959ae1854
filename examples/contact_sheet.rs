//! A contact sheet of all samplers in the plane, as SVG: points, P(m), and g(r) beside the radial mean of P, each with what is known in
//! closed form. `cargo run --release --example contact_sheet -- docs/pictures/samplers.svg`

use std::fmt::Write as _;

use base64::Engine as _;
use pairwave::control::Control;
use pairwave::request::PointsRequest;
use pairwave::samplers::{Entry, Process, registry};
use pairwave::{Error, Points, Request, Result, Statistic, measure};

/// Points, about.
const N: u64 = 256;
/// Realizations of g and P.
const K: u64 = 60;
/// The largest |m_j| of the picture.
const REACH: i32 = 40;
/// Width and height of a panel, and a row with its gap.
const SIDE: f64 = 162.0;
const ROW: f64 = 196.0;
/// Sheets of two samplers side by side.
const COLUMNS: usize = 2;
const WIDTH: f64 = 3.0 * (SIDE + 14.0) + 26.0;

fn main() -> Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "samplers.svg".into());
    let entries: Vec<&Entry> = registry().iter().copied().filter(|entry| entry.dims.contains(&2)).collect();
    let rows = entries.len().div_ceil(COLUMNS);
    let (width, height) = (COLUMNS as f64 * WIDTH + 10.0, rows as f64 * ROW + 16.0);
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" font-family="Helvetica, Arial, sans-serif" font-size="12" fill="#222">
<rect width="{width}" height="{height}" fill="#fff"/>
"##
    );
    for (index, entry) in entries.into_iter().enumerate() {
        let corner = [12.0 + WIDTH * (index / rows) as f64, 26.0 + ROW * (index % rows) as f64];
        eprintln!("{}", entry.name);
        sampler(&mut svg, entry, corner)?;
    }
    svg.push_str("</svg>\n");
    std::fs::write(&path, svg).map_err(|e| Error::file(&path, e))
}

fn sampler(svg: &mut String, entry: &Entry, [x, y]: [f64; 2]) -> Result<()> {
    let n = entry.nearest_size(N, 2);
    let input = PointsRequest {
        sampler: Some(entry.name.into()),
        points: Some(n),
        realizations: Some(K),
        ..PointsRequest::default()
    };
    let stats = vec![Statistic::Pcf, Statistic::Radial];
    let request = Request { input, stats, bins: Some(60), ..Request::default() };
    let found = measure(Points::open(&request.input)?, &request)?;
    let process = Process::new(entry.name, n, K, 2, 1, &[])?;
    let _ = writeln!(svg, r#"<text x="{x}" y="{}" font-weight="bold">{}, n = {n}</text>"#, y - 6.0, entry.name);
    let set = process.coordinates(0, &Control::default())?;
    frame(svg, [x, y]);
    for p in set.chunks_exact(2) {
        let _ = write!(svg, r#"<circle cx="{:.1}" cy="{:.1}" r="1.3"/>"#, x + SIDE * p[0], y + SIDE * (1.0 - p[1]));
    }
    let x = x + SIDE + 14.0;
    let _ = writeln!(
        svg,
        r#"<image x="{x}" y="{y}" width="{SIDE}" height="{SIDE}" image-rendering="pixelated" href="data:image/png;base64,{}"/>"#,
        picture(&process)?
    );
    frame(svg, [x, y]);
    let x = x + SIDE + 14.0;
    let unit = (n as f64).sqrt();
    // g in grey up to four closest-packing distances, P in blue up to four cycles per mean spacing, both from 0 to 2.
    let mut curve = |points: Vec<(f64, f64)>, look: &str| {
        let place = |(t, v): (f64, f64)| (x + SIDE * t / 4.0, y + SIDE * (1.0 - v.clamp(0.0, 2.0) / 2.0));
        let points: Vec<String> =
            points.into_iter().filter(|p| p.0 <= 4.0).map(place).map(|(a, b)| format!("{a:.1},{b:.1}")).collect();
        let _ = writeln!(svg, r#"<polyline fill="none" points="{}" {look}/>"#, points.join(" "));
    };
    curve(vec![(0.0, 1.0), (4.0, 1.0)], r##"stroke="#ccc""##);
    let spacing = (2.0 / 3f64.sqrt()).sqrt() / unit;
    if let Some(g) = found.pair_correlation() {
        curve(
            g.r.iter().map(|r| r / spacing).zip(g.g.iter().copied()).collect(),
            r##"stroke="#888" stroke-width="1.2""##,
        );
        let known = g.r.iter().filter_map(|&r| Some((r / spacing, process.pair_correlation(r)?))).collect();
        curve(known, r##"stroke="#000" stroke-dasharray="3 3""##);
    }
    if let Some(radial) = found.radial() {
        let rings = radial.rings.iter().map(|ring| (ring.nu / unit, ring.p)).collect();
        curve(rings, r##"stroke="#0072b2" stroke-width="1.4""##);
    }
    frame(svg, [x, y]);
    Ok(())
}

fn frame(svg: &mut String, [x, y]: [f64; 2]) {
    let _ = writeln!(svg, r##"<rect x="{x}" y="{y}" width="{SIDE}" height="{SIDE}" fill="none" stroke="#999"/>"##);
}

/// P(m) from 0, black, to 2, white; DC in the middle is grey. As PNG in base 64.
fn picture(process: &Process) -> Result<String> {
    let side = 2 * REACH as usize + 1;
    let mut power = vec![0.0; side * side];
    let mut total = 0.0;
    for index in 0..K {
        let set = process.coordinates(index, &Control::default())?;
        let mut sums = vec![(0.0, 0.0); side * side];
        total += (set.len() / 2) as f64;
        for p in set.as_chunks::<2>().0 {
            let waves = p.map(|x| {
                let wave = |k: i32| (std::f64::consts::TAU * (f64::from(k) * x).fract()).sin_cos();
                (-REACH..=REACH).map(wave).collect::<Vec<_>>()
            });
            for (b, (sb, cb)) in waves[1].iter().enumerate() {
                for ((sa, ca), sum) in waves[0].iter().zip(&mut sums[b * side..]) {
                    *sum = (sum.0 + ca * cb - sa * sb, sum.1 + sa * cb + ca * sb);
                }
            }
        }
        power.iter_mut().zip(&sums).for_each(|(p, s)| *p += s.0 * s.0 + s.1 * s.1);
    }
    let mut grey: Vec<u8> = power.iter().map(|p| (127.5 * (p / total).min(2.0)) as u8).collect();
    grey[side * side / 2] = 127;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side as u32, side as u32);
    encoder.set_color(png::ColorType::Grayscale);
    let failed = |e: png::EncodingError| Error::file("a picture", std::io::Error::other(e));
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&grey)).map_err(failed)?;
    Ok(base64::engine::general_purpose::STANDARD.encode(bytes))
}
