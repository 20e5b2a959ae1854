//! Pictures of grids as figures: with axes, a caption and a colour bar around them.

use std::fmt::Write as _;

use base64::Engine as _;
use plotters::prelude::*;

use super::png;
use super::svg::{WIDTH, fine, frame, heading, label, picture, thin};
use crate::display::{
    ColorMap, Pixels, ToneMap, Units, escape, size, spectrum_pixels, ticks, vector_pixels, vector_ticks,
};
use crate::estimate::Analysis;
use crate::statistics::waves::{spectrum_image, tone_text};
use crate::statistics::{Map, Svg};

const TOP: f64 = 92.0;
const LEFT: f64 = 84.0;
/// Where the last picture ends at most; the colour bar is to the right.
const RIGHT: f64 = 770.0;
/// Between pictures: room for ticks and a label.
const GAP: f64 = 84.0;
/// No picture is higher than this, one of several below each other not than that, nor thinner than this part of its longer side.
const HIGHEST: f64 = 640.0;
const HIGHEST_OF_SEVERAL: f64 = 420.0;
const THINNEST: f64 = 0.25;
/// The colour bar: how far right of the last picture, and how wide.
const BAR_GAP: f64 = 28.0;
const BAR_WIDTH: f64 = 14.0;
/// Characters per line of the caption.
const LINE: usize = 118;

/// A picture in its frame.
pub(super) struct Inset {
    pub(super) png: Vec<u8>,
    pub(super) extent: [[f64; 2]; 2],
    pub(super) labels: [String; 2],
}

/// `spectrum.png` with axes in cycles per unit length.
pub(super) fn spectrum(analysis: &Analysis) -> Option<Svg> {
    let image = spectrum_image(analysis)?;
    let Pixels { extent, axes, .. } =
        spectrum_pixels(analysis, ToneMap::Reinhard, None, ColorMap::Viridis, None, usize::MAX)?;
    let cycles = Units::of(analysis).escaped().cycles;
    let labels = axes.map(|axis| format!("ν_{} ({cycles})", ["x", "y", "z"][axis]));
    let caption = format!("P(m): {}. Tone map: {}.", image.seen, tone_text());
    let ticks = ToneMap::Reinhard.ticks(analysis.shape.mean_points);
    let title = match analysis.inhomogeneity() {
        None => "Power spectrum P(m)",
        Some(_) => "Power spectrum P(m), inhomogeneous",
    };
    Some(png::image(&image).map_err(Into::into).and_then(|png| {
        let insets = [Inset { png, extent, labels }];
        svg([title, &analysis.subject, &size(analysis)], &caption, &insets, ColorMap::Viridis, "P", &ticks)
    }))
}

/// g on each plane of lags, with axes in length units.
pub(super) fn vector(analysis: &Analysis) -> Option<Svg> {
    let ticks = vector_ticks(analysis, None)?;
    let length = Units::of(analysis).escaped().length;
    let mut insets = Vec::new();
    for pixels in (0..).map_while(|plane| vector_pixels(analysis, None, ColorMap::BlueRed, plane, usize::MAX)) {
        let labels = pixels.axes.map(|axis| format!("h_{} ({length})", ["x", "y", "z"][axis]));
        match png::encode(
            &pixels.rgb,
            [pixels.width as u32, pixels.height as u32],
            "g(h)",
            "one pixel per cell of lags",
        ) {
            Ok(png) => insets.push(Inset { png, extent: pixels.extent, labels }),
            Err(e) => return Some(Err(e.into())),
        }
    }
    let caption = "g(h) by cells of lags, lag 0 at the centre; white is g = 1 (Moreland 2009).";
    (!insets.is_empty()).then(|| {
        svg(
            ["Pair correlation function g(h)", &analysis.subject, &size(analysis)],
            caption,
            &insets,
            ColorMap::BlueRed,
            "g",
            &ticks,
        )
    })
}

/// Maps one below the other, as one picture.
pub(super) fn maps(all: &[Map<'_>]) -> Option<Svg> {
    let most = if all.len() > 1 { HIGHEST_OF_SEVERAL } else { HIGHEST };
    let one = |map: &Map<'_>| -> Result<(String, u32), Box<dyn std::error::Error + Send + Sync>> {
        let [title, subject, note] = &map.heading;
        let size = [map.pixels.width as u32, map.pixels.height as u32];
        let png = png::encode(&map.pixels.rgb, size, "Variance by frequency", "y up, DC grey")?;
        let inset = Inset { png, extent: map.pixels.extent, labels: map.labels.clone() };
        let heading = [title, subject, &*escape(note)];
        framed(heading, &map.caption, &[inset], ColorMap::Viridis, map.quantity, &map.bar, most)
    };
    let stacked = || {
        let (mut body, mut top) = (String::new(), 0);
        for map in all {
            let (svg, height) = one(map)?;
            body.push_str(&svg.replacen("<svg ", &format!(r#"<svg y="{top}" "#), 1));
            top += height;
        }
        Ok(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{top}\" viewBox=\"0 0 {WIDTH} {top}\">\n{body}</svg>\n"
        ))
    };
    (!all.is_empty()).then(stacked)
}

/// Title, subject and note above, which are escaped, pictures side by side, a colour bar, a caption below.
pub(super) fn svg(
    heading: [&str; 3],
    caption: &str,
    insets: &[Inset],
    colors: ColorMap,
    quantity: &str,
    bar: &[(f64, String)],
) -> Svg {
    framed(heading, caption, insets, colors, quantity, bar, HIGHEST).map(|(svg, _)| svg)
}

/// The same with pictures no higher than `most`, and the height of all.
fn framed(
    [title, subject, note]: [&str; 3],
    caption: &str,
    insets: &[Inset],
    colors: ColorMap,
    quantity: &str,
    bar: &[(f64, String)],
    most: f64,
) -> Result<(String, u32), Box<dyn std::error::Error + Send + Sync>> {
    let count = insets.len() as f64;
    let room = (RIGHT - LEFT - GAP * (count - 1.0)) / count;
    // The same length unit for all.
    let span = |inset: &Inset, axis: usize| inset.extent[axis][1] - inset.extent[axis][0];
    let widest = insets.iter().map(|i| span(i, 0)).fold(0.0, f64::max);
    let tallest = insets.iter().map(|i| span(i, 1)).fold(0.0, f64::max);
    let px = (room / widest).min(most / tallest);
    let sizes = insets.iter().map(|inset| {
        let [w, h] = [0, 1].map(|axis| span(inset, axis) * px);
        [w.max(THINNEST * h.min(room)), h.max(THINNEST * w.min(most))]
    });
    let sizes: Vec<[f64; 2]> = sizes.collect();
    let highest = sizes.iter().map(|s| s[1]).fold(0.0, f64::max);
    let bar_height = highest.max(180.0);
    let lines = wrapped(caption);
    let foot = TOP + bar_height.max(highest) + 74.0;
    let height = foot + 18.0 * lines.len() as f64;

    let mut overlay = heading(title, subject, note);
    let (mut frames, mut marks) = (Vec::new(), Vec::new());
    let mut left = LEFT;
    for (inset, [width, height]) in insets.iter().zip(sizes) {
        embed(&mut overlay, &inset.png, [left, TOP, width, height]);
        frames.push(((left, TOP), (left + width, TOP + height)));
        for (t, text) in axis_ticks(inset.extent[0], width) {
            let x = left + (t - inset.extent[0][0]) / span(inset, 0) * width;
            label(&mut overlay, x, TOP + height + 20.0, "middle", &text);
            marks.push([(x, TOP + height), (x, TOP + height + 5.0)]);
        }
        for (t, text) in axis_ticks(inset.extent[1], height) {
            let y = TOP + (inset.extent[1][1] - t) / span(inset, 1) * height;
            label(&mut overlay, left - 9.0, y + 4.5, "end", &text);
            marks.push([(left - 5.0, y), (left, y)]);
        }
        label(&mut overlay, left + 0.5 * width, TOP + height + 42.0, "middle", &escape(&inset.labels[0]));
        let (x, y) = (left - 54.0, TOP + 0.5 * height);
        let _ = writeln!(overlay, r#"<g transform="translate({x:.1} {y:.1}) rotate(-90)">"#);
        label(&mut overlay, 0.0, 0.0, "middle", &escape(&inset.labels[1]));
        overlay.push_str("</g>\n");
        left += width + GAP;
    }
    let (bar_left, bar_width) = (left - GAP + BAR_GAP, BAR_WIDTH);
    let stops: Vec<u8> = (0..256).rev().flat_map(|k| colors.color(f64::from(k) / 255.0)).collect();
    embed(
        &mut overlay,
        &png::encode(&stops, [1, 256], "Colours", "from low to high")?,
        [bar_left, TOP, bar_width, bar_height],
    );
    frames.push(((bar_left, TOP), (bar_left + bar_width, TOP + bar_height)));
    for (at, text) in bar {
        let y = TOP + (1.0 - at) * bar_height;
        label(&mut overlay, bar_left + bar_width + 9.0, y + 4.5, "start", &escape(text));
        marks.push([(bar_left + bar_width, y), (bar_left + bar_width + 5.0, y)]);
    }
    label(&mut overlay, bar_left, TOP - 11.0, "start", &escape(quantity));
    for (k, line) in lines.iter().enumerate() {
        label(&mut overlay, LEFT, foot + 18.0 * k as f64, "start", &escape(line));
    }
    let description = escape(&format!("{title}. {subject}. {note}"));
    let height = height.ceil() as u32;
    let drawn = picture((WIDTH, height), &description, &overlay, |root| {
        for (from, to) in frames {
            root.draw(&frame(from, to))?;
        }
        for mark in marks {
            root.draw(&PathElement::new(mark.map(|(x, y)| (fine(x), fine(y))), thin()))?;
        }
        Ok(())
    });
    Ok((drawn?, height))
}

/// As many round numbers as have room.
fn axis_ticks([low, high]: [f64; 2], length: f64) -> Vec<(f64, String)> {
    ticks(&(low..high), ((length / 70.0) as u32).clamp(2, 8))
}

fn embed(overlay: &mut String, png: &[u8], [x, y, width, height]: [f64; 4]) {
    let data = base64::engine::general_purpose::STANDARD.encode(png);
    let _ = writeln!(
        overlay,
        r#"<image x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}" preserveAspectRatio="none" style="image-rendering: pixelated" href="data:image/png;base64,{data}"/>"#
    );
}

/// Lines of whole words.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= LINE => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}
