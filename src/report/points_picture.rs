//! `points.svg`: the first realization, true to scale.

use std::fmt::Write as _;

use plotters::prelude::*;

use super::svg::{WIDTH, fine, frame, heading, hex, label, picture, thin};
use crate::display::figure::BLUE;
use crate::display::{Units, escape, human, ticks};
use crate::estimate::Analysis;
use crate::statistics::{Make, Output, Place, Room, Svg, Turn};

/// The points in a report.
pub(super) struct Here;

impl Room for Here {
    fn outputs(&self) -> &'static [Output] {
        const {
            let caption = |a: &Analysis, _: &str| Some(format!("The {}.", escape(&caption(a))));
            let place = Some(Place { heading: "Points", caption });
            &[Output { name: "points.svg", turn: Turn::Points, make: Make::Svg(|a| Some(svg(a))), place, shown: None }]
        }
    }
}

/// More points than this are a grey haze and a slow page: about as many stand for all.
const MAX_POINTS: usize = 20_000;

/// Longest side of the frame in px.
const SIDE: f64 = 732.0;
const TOP: f64 = 92.0;
/// A strip's height in px, for one dimension.
const STRIP: f64 = 60.0;

/// The points drawn: all, or a random choice. (The first ones, or every k-th, of an ordered file would draw a pattern that
/// is not there.)
fn shown(n: usize) -> impl Iterator<Item = usize> {
    let keep = if n > MAX_POINTS { (MAX_POINTS as u64 * (1 << 32)) / n as u64 } else { 1 << 32 };
    (0..n).filter(move |&j| {
        // SplitMix64's finalizer: the same choice for the same n, everywhere.
        let z = (j as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z >> 32) < keep
    })
}

/// What the picture shows, in words.
fn caption(analysis: &Analysis) -> String {
    let n = if analysis.first.realizations() > 0 { analysis.first.points_in(0) } else { 0 };
    let mut caption = if n > MAX_POINTS {
        format!("first realization, {} of its {n} points chosen at random", shown(n).count())
    } else {
        format!("first realization, {n} point{}", if n == 1 { "" } else { "s" })
    };
    if analysis.domain.dim() == 3 {
        caption.push_str(", projected along z onto the x-y plane");
    }
    caption.push_str(match analysis.domain.as_polygon() {
        _ if analysis.domain.is_torus() => "; torus",
        Some(_) => "; polygon",
        None => "; window",
    });
    caption
}

/// Round numbers along an axis of `length` px, as many as have room: none on a sliver.
fn labels(range: &std::ops::Range<f64>, length: f64) -> Vec<(f64, String)> {
    let room = (length / 60.0).floor().min(5.0) as u32;
    if room == 0 { Vec::new() } else { ticks(range, room) }
}

/// The picture.
fn svg(analysis: &Analysis) -> Svg {
    let domain = &analysis.domain;
    let (side_x, side_y) = (domain.sides()[0], domain.sides().get(1).copied());
    let longest = side_x.max(side_y.unwrap_or(0.0));
    let px = SIDE / longest;
    // Domains may be a million times longer than wide; a frame of 2 px still shows.
    let width = (side_x * px).max(2.0);
    let height = side_y.map_or(STRIP, |s| (s * px).max(2.0));
    let left = 0.5 * (f64::from(WIDTH) - width);
    let canvas_height = (TOP + height + 64.0).ceil() as u32;

    let n = if analysis.first.realizations() > 0 { analysis.first.points_in(0) } else { 0 };
    let chosen: Vec<usize> = shown(n).collect();
    let shown = chosen.len();
    // A fifth of the mean spacing apart at most, so that dots of a regular pattern never touch.
    let spacing = (width * height / shown.max(1) as f64).sqrt();
    let radius = (0.16 * spacing).clamp(0.5, 3.5);

    // One path for all points: a round cap on a line of no length is a dot.
    let mut dots = String::new();
    for j in chosen {
        let position = analysis.first.position(0, j);
        let x = left + (position[0] - domain.origin()[0]) / side_x * width;
        let _ = match side_y {
            Some(side) => {
                let y = TOP + (1.0 - (position[1] - domain.origin()[1]) / side) * height;
                write!(dots, "M{x:.2} {y:.2}h0")
            }
            None => write!(dots, "M{x:.2} {:.2}v{:.2}", TOP + 0.15 * height, 0.7 * height),
        };
    }
    let mut outline = String::new();
    for ring in domain.as_polygon().into_iter().flat_map(|polygon| polygon.parts()).flatten() {
        for (k, [vx, vy]) in ring.iter().enumerate() {
            let x = left + (vx - domain.origin()[0]) / side_x * width;
            let y = TOP + (1.0 - (vy - domain.origin()[1]) / side_y.unwrap_or(1.0)) * height;
            let _ = write!(outline, "{}{x:.2} {y:.2}", if k == 0 { "M" } else { "L" });
        }
        outline.push('Z');
    }
    let length = Units::of(analysis).escaped().length;
    let mut overlay = heading("Points", &analysis.subject, &caption(analysis));
    if !outline.is_empty() {
        let _ = writeln!(overlay, r##"<path d="{outline}" stroke="#444" stroke-width="1" fill="none"/>"##);
    }
    let stroke = if side_y.is_some() { 2.0 * radius } else { (0.5 * width / shown.max(1) as f64).clamp(0.3, 1.5) };
    let cap = if side_y.is_some() { "round" } else { "butt" };
    let color = hex(BLUE);
    if shown > 0 {
        let _ = writeln!(
            overlay,
            r#"<path d="{dots}" stroke="{color}" stroke-width="{stroke:.2}" stroke-linecap="{cap}" fill="none"/>"#
        );
    }
    let mut marks = Vec::new();
    let x_range = domain.origin()[0]..domain.origin()[0] + side_x;
    for (t, text) in labels(&x_range, width) {
        let x = left + (t - x_range.start) / side_x * width;
        label(&mut overlay, x, TOP + height + 20.0, "middle", &text);
        marks.push([(x, TOP + height), (x, TOP + height + 5.0)]);
    }
    label(&mut overlay, left + 0.5 * width, TOP + height + 44.0, "middle", &format!("x ({length})"));
    if let Some(side) = side_y {
        let y_range = domain.origin()[1]..domain.origin()[1] + side;
        for (t, text) in labels(&y_range, height) {
            let y = TOP + (1.0 - (t - y_range.start) / side) * height;
            label(&mut overlay, left - 9.0, y + 4.5, "end", &text);
            marks.push([(left - 5.0, y), (left, y)]);
        }
        let _ =
            writeln!(overlay, r#"<g transform="translate({:.1} {:.1}) rotate(-90)">"#, left - 56.0, TOP + 0.5 * height);
        label(&mut overlay, 0.0, 0.0, "middle", &format!("y ({length})"));
        overlay.push_str("</g>\n");
    }
    let description = format!("Points. {}. {}, n = {}", analysis.subject, caption(analysis), human(n as f64));
    picture((WIDTH, canvas_height), &escape(&description), &overlay, |root| {
        root.draw(&frame((left, TOP), (left + width, TOP + height)))?;
        for mark in marks {
            root.draw(&PathElement::new(mark.map(|(x, y)| (fine(x), fine(y))), thin()))?;
        }
        Ok(())
    })
}
