//! Figures as SVG, and how they look: one frame, bands, lines, levels and a legend that stands outside the frame.
//!
//! plotters lays out and draws the geometry. Its SVG backend counts in whole pixels, so a figure is drawn ten times too
//! large and scaled down. Text is written here: plotters knows neither the width of a glyph nor a subscript.

use std::fmt::Write as _;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::display::figure::{Figure, GREY, Layer, Rgb, Stroke};
use crate::display::{escape, log_ticks, shortened, thinned_band, thinned_line, ticks};
use crate::statistics::Svg;

/// Width of a figure in px.
pub(super) const WIDTH: u32 = 900;
/// Height of a figure with curves in px.
const HEIGHT: u32 = 600;
/// Backend pixels per px.
const FINE: i32 = 10;

/// Columns per px of which a curve shows four points at most: more cannot be told apart.
const COLUMNS: f64 = 2.0;

const LEFT: f64 = 84.0;
const RIGHT_MARGIN: f64 = 28.0;
const BOTTOM_MARGIN: f64 = 68.0;
/// Height of a row of the legend.
const ROW: f64 = 18.0;

const GRID: RGBColor = RGBColor(232, 232, 232);
const FRAME: RGBColor = RGBColor(90, 90, 90);

pub(super) type DrawResult = Result<(), Box<dyn std::error::Error + Send + Sync>>;
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Px of a drawing for paper per mm: its labels are then 8 points high.
const PER_MM: f64 = 4.6;

/// The figure as SVG text.
pub(crate) fn svg(figure: &Figure) -> Svg {
    Drawing::page(figure).svg()
}

/// The same without a legend, and each layer that has the number of a curve in an element with that number: it can be hidden.
pub(super) fn grouped(figure: &Figure, groups: &[Option<usize>]) -> Svg {
    Drawing { groups: Some(groups), ..Drawing::page(figure) }.svg()
}

/// Left, top, right and bottom of the frame of `svg` and `grouped`, in px.
pub(super) fn frame_of(figure: &Figure, grouped: bool) -> [f64; 4] {
    let drawing = Drawing { groups: grouped.then_some(&[][..]), ..Drawing::page(figure) };
    [LEFT, drawing.frame_top(), drawing.right(), drawing.bottom()]
}

/// Where an abscissa stands in `svg`, in px.
pub(super) fn place_of(figure: &Figure, x: f64) -> f64 {
    Drawing::page(figure).px_x(x)
}

/// The figure as SVG text of so many mm.
pub(super) fn for_paper(figure: &Figure, [width, height]: [f64; 2]) -> Svg {
    let [px_width, px_height] = [width, height].map(|mm| (mm * PER_MM).round() as u32);
    let drawing = Drawing { figure, width: px_width, height: px_height, groups: None };
    let px = format!(r#"width="{}" height="{}""#, drawing.width, drawing.height);
    Ok(drawing.svg()?.replacen(&px, &format!(r#"width="{width}mm" height="{height}mm""#), 1))
}

/// A figure that is being drawn.
struct Drawing<'a> {
    figure: &'a Figure,
    width: u32,
    height: u32,
    /// The curve that each layer belongs to, where curves can be hidden; the legend is then beside the figure.
    groups: Option<&'a [Option<usize>]>,
}

impl<'a> Drawing<'a> {
    fn page(figure: &'a Figure) -> Self {
        Self { figure, width: WIDTH, height: HEIGHT, groups: None }
    }

    fn right(&self) -> f64 {
        f64::from(self.width) - RIGHT_MARGIN
    }

    fn bottom(&self) -> f64 {
        f64::from(self.height) - BOTTOM_MARGIN
    }

    /// Where the first row of the legend stands, below what there is of a heading.
    fn legend_top(&self) -> f64 {
        match (&*self.figure.title, &*self.figure.subject, &*self.figure.note) {
            ("", "", "") => 22.0,
            (_, "", "") => 56.0,
            _ => 94.0,
        }
    }

    /// Where the frame begins.
    fn frame_top(&self) -> f64 {
        let rows = self.legend_rows().len().max(1) as f64;
        let top = self.legend_top() + ROW * (rows - 1.0) + 18.0;
        if self.figure.top.is_some() { top + 38.0 } else { top }
    }

    /// Layers with names, as many in a row as fit, and where they begin.
    fn legend_rows(&self) -> Vec<Vec<(f64, &Layer)>> {
        let mut rows: Vec<Vec<(f64, &Layer)>> = Vec::new();
        let mut x = f64::INFINITY;
        for layer in self.figure.layers.iter().filter(|_| self.groups.is_none()) {
            let (Layer::Band { name, .. } | Layer::Line { name, .. } | Layer::Level { name, .. }) = layer else {
                continue;
            };
            if name.is_empty() {
                continue;
            }
            let width = 33.0 + width_of(name);
            if x + width > self.right() {
                rows.push(Vec::new());
                x = LEFT;
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, layer));
            }
            x += width + 24.0;
        }
        rows
    }

    /// The abscissa as it is drawn.
    fn place(&self, x: f64) -> f64 {
        if self.figure.log_x { x.ln() } else { x }
    }

    /// The ordinate as it is drawn.
    fn place_y(&self, y: f64) -> f64 {
        if self.figure.log_y { y.max(self.figure.y.start * 1e-3).ln() } else { y }
    }

    fn drawn_y(&self) -> Range<f64> {
        self.place_y(self.figure.y.start)..self.place_y(self.figure.y.end)
    }

    fn drawn_x(&self) -> Range<f64> {
        self.place(self.figure.x.start)..self.place(self.figure.x.end)
    }

    fn px_x(&self, x: f64) -> f64 {
        let drawn = self.drawn_x();
        LEFT + (self.place(x) - drawn.start) / (drawn.end - drawn.start) * (self.right() - LEFT)
    }

    fn px_y(&self, y: f64) -> f64 {
        let drawn = self.drawn_y();
        self.bottom() - (self.place_y(y) - drawn.start) / (drawn.end - drawn.start) * (self.bottom() - self.frame_top())
    }

    fn svg(&self) -> Svg {
        let mut text = heading(&self.figure.title, &self.figure.subject, &self.figure.note);
        // As many ticks as there is room for their labels.
        let across = ((self.right() - LEFT) / 87.0).round().max(2.0) as u32;
        let upward = ((self.bottom() - self.frame_top()) / 60.0).round().max(2.0) as u32;
        let mut x_ticks = if self.figure.log_x { log_ticks(&self.figure.x) } else { ticks(&self.figure.x, across) };
        let mut y_ticks = if self.figure.log_y { log_ticks(&self.figure.y) } else { ticks(&self.figure.y, upward) };
        keep_apart(&mut x_ticks, |x, text| (self.px_x(x), 10.0 + width_of(text)));
        keep_apart(&mut y_ticks, |y, _| (self.px_y(y), 17.0));
        for &(x, ref label) in &x_ticks {
            write_text(&mut text, self.px_x(x), self.bottom() + 21.0, "middle", LABEL, label);
        }
        for &(y, ref label) in &y_ticks {
            write_text(&mut text, LEFT - 9.0, self.px_y(y) + 4.5, "end", LABEL, label);
        }
        let middle = 0.5 * (LEFT + self.right());
        write_text(&mut text, middle, self.bottom() + 50.0, "middle", AXIS, &self.figure.x_label);
        let y_middle = 0.5 * (self.bottom() + self.frame_top());
        let turned = format!(r#"{AXIS} transform="rotate(-90 24 {y_middle})""#);
        write_text(&mut text, 24.0, y_middle, "middle", &turned, &self.figure.y_label);
        let mut top_ticks = Vec::new();
        if let Some(top) = &self.figure.top {
            let range = self.figure.x.start / top.unit..self.figure.x.end / top.unit;
            top_ticks = if self.figure.log_x { log_ticks(&range) } else { ticks(&range, across) };
            keep_apart(&mut top_ticks, |t, text| (self.px_x(t * top.unit), 10.0 + width_of(text)));
            for (t, label) in &mut top_ticks {
                *t *= top.unit;
                write_text(&mut text, self.px_x(*t), self.frame_top() - 11.0, "middle", LABEL, label);
            }
            write_text(&mut text, middle, self.frame_top() - 32.0, "middle", LABEL, &top.label);
        }
        self.legend(&mut text);
        for layer in &self.figure.layers {
            if let Layer::Hint { x, label } = layer {
                // The label stays inside the frame: it turns to the left of its line near the right end.
                let at = self.px_x(*x);
                let (dx, anchor) = if at > self.right() - 150.0 { (-6.0, "end") } else { (6.0, "start") };
                write_text(&mut text, at + dx, self.bottom() - 10.0, anchor, HINT, label);
            }
        }
        let x_values = x_ticks.iter().map(|t| t.0).collect::<Vec<_>>();
        let y_values = y_ticks.iter().map(|t| t.0).collect::<Vec<_>>();
        let top_values = top_ticks.iter().map(|t| t.0).collect::<Vec<_>>();
        let description = [escape(&self.figure.title), escape(&self.figure.subject), self.figure.note.clone()];
        let description: Vec<_> = description.into_iter().filter(|text| !text.is_empty()).collect();
        let description = description.join(". ");
        let size = (self.width, self.height);
        let body = match self.groups {
            None => geometry(size, |root| {
                self.ground(root, &y_values)?;
                self.figure.layers.iter().try_for_each(|layer| self.layer(root, layer))?;
                self.frame(root, &x_values, &y_values, &top_values)?;
                self.figure.layers.iter().try_for_each(|layer| self.marks(root, layer))
            })?,
            Some(groups) => {
                let mut body = geometry(size, |root| self.ground(root, &y_values))?;
                for (layer, group) in self.figure.layers.iter().zip(groups) {
                    let drawn = geometry(size, |root| {
                        self.layer(root, layer)?;
                        self.marks(root, layer)
                    })?;
                    match group {
                        Some(k) => _ = writeln!(body, r#"<g data-curve="{k}">{drawn}</g>"#),
                        None => body.push_str(&drawn),
                    }
                }
                body + &geometry(size, |root| self.frame(root, &x_values, &y_values, &top_values))?
            }
        };
        Ok(document(size, &description, &text, &body))
    }

    fn chart<'b>(&self, root: &Area<'b>) -> Result<Chart<'b>, Box<dyn std::error::Error + Send + Sync>> {
        let px = |v: f64| fine(v) as u32;
        let mut chart = ChartBuilder::on(root);
        chart.margin_left(px(LEFT)).margin_right(px(RIGHT_MARGIN));
        chart.margin_top(px(self.frame_top())).margin_bottom(px(BOTTOM_MARGIN));
        Ok(chart.build_cartesian_2d(self.drawn_x(), self.drawn_y())?)
    }

    /// A horizontal line through the frame.
    fn level(&self, y: f64) -> [(f64, f64); 2] {
        [(self.drawn_x().start, self.place_y(y)), (self.drawn_x().end, self.place_y(y))]
    }

    /// The lines of the grid.
    fn ground(&self, root: &Area<'_>, y_ticks: &[f64]) -> DrawResult {
        let mut chart = self.chart(root)?;
        for &y in y_ticks {
            chart.draw_series(LineSeries::new(self.level(y), GRID.stroke_width(FINE as u32)))?;
        }
        Ok(())
    }

    fn layer(&self, root: &Area<'_>, layer: &Layer) -> DrawResult {
        let px = |v: f64| fine(v) as u32;
        let mut chart = self.chart(root)?;
        match layer {
            Layer::Band { color, runs, .. } => {
                for run in runs {
                    let run = thinned_band(run, |x| (COLUMNS * self.px_x(x)).floor());
                    let there = run.iter().map(|&[x, lo, _]| (self.place(x), self.place_y(lo)));
                    let back = run.iter().rev().map(|&[x, _, hi]| (self.place(x), self.place_y(hi)));
                    let polygon = clipped_polygon(there.chain(back).collect(), &self.drawn_y());
                    chart.draw_series([Polygon::new(polygon, rgb(*color).mix(0.22))])?;
                }
            }
            Layer::Line { color, width, stroke, runs, .. } => {
                let style = rgb(*color).stroke_width(px(*width));
                for run in runs {
                    let run = thinned_line(run, |p| (COLUMNS * self.px_x(p.0)).floor(), |p| p.1);
                    let run: Vec<_> = run.iter().map(|&(x, y)| (self.place(x), self.place_y(y))).collect();
                    for piece in clipped_line(&run, &self.drawn_y()) {
                        match stroke.dashes() {
                            Some((dash, gap)) => {
                                chart.draw_series(DashedLineSeries::new(piece, fine(dash), fine(gap), style))?;
                            }
                            None => {
                                chart.draw_series(LineSeries::new(piece, style))?;
                            }
                        }
                    }
                }
            }
            Layer::Level { y, .. } if self.figure.y.contains(y) => {
                chart.draw_series(LineSeries::new(self.level(*y), rgb(GREY).stroke_width(px(1.2))))?;
            }
            Layer::Hint { x, .. } => {
                let line = [self.drawn_y().start, self.drawn_y().end].map(|y| (self.place(*x), y));
                chart.draw_series(DashedLineSeries::new(line, 20, 40, rgb(GREY).stroke_width(px(1.0))))?;
            }
            Layer::Level { .. } => {}
        }
        Ok(())
    }

    /// The frame with its ticks.
    fn frame(&self, root: &Area<'_>, x_ticks: &[f64], y_ticks: &[f64], top_ticks: &[f64]) -> DrawResult {
        let at = |x: f64, y: f64| (fine(x), fine(y));
        let thin = thin();
        root.draw(&frame((LEFT, self.frame_top()), (self.right(), self.bottom())))?;
        for &x in x_ticks {
            let x = self.px_x(x);
            root.draw(&PathElement::new([at(x, self.bottom()), at(x, self.bottom() + 5.0)], thin))?;
        }
        for &x in top_ticks {
            let x = self.px_x(x);
            root.draw(&PathElement::new([at(x, self.frame_top() - 5.0), at(x, self.frame_top())], thin))?;
        }
        for &y in y_ticks {
            let y = self.px_y(y);
            root.draw(&PathElement::new([at(LEFT - 5.0, y), at(LEFT, y)], thin))?;
        }
        Ok(())
    }

    /// Where a curve leaves the frame at the top: a mark at the edge.
    fn marks(&self, root: &Area<'_>, layer: &Layer) -> DrawResult {
        let at = |x: f64, y: f64| (fine(x), fine(y));
        if let Layer::Line { color, runs, stroke: Stroke::Solid, .. } = layer {
            let mut last = f64::NEG_INFINITY;
            for &(x, _) in runs.iter().flatten().filter(|p| p.1 > self.figure.y.end) {
                let (x, y) = (self.px_x(x), self.frame_top());
                // Marks that would touch are one mark.
                if x - last >= 9.0 {
                    let mark = vec![at(x - 4.0, y + 8.0), at(x + 4.0, y + 8.0), at(x, y + 1.0)];
                    root.draw(&Polygon::new(mark, rgb(*color)))?;
                    last = x;
                }
            }
        }
        Ok(())
    }

    /// Rows above the frame.
    fn legend(&self, text: &mut String) {
        for (row, layers) in self.legend_rows().into_iter().enumerate() {
            let y = self.legend_top() + ROW * row as f64;
            for (x, layer) in layers {
                let (name, color, height, look) = match layer {
                    Layer::Band { name, color, .. } => (name, color, 11.0, r#" stroke-opacity="0.22""#.into()),
                    Layer::Line { name, color, width, stroke, .. } => {
                        let dashes = stroke.dashes().map(|(dash, gap)| format!(r#" stroke-dasharray="{dash} {gap}""#));
                        (name, color, *width, dashes.unwrap_or_default())
                    }
                    Layer::Level { name, .. } => (name, &GREY, 1.2, String::new()),
                    Layer::Hint { .. } => continue,
                };
                let _ = writeln!(
                    text,
                    r#"<path d="M{x:.1} {:.1}h26" stroke="{}" stroke-width="{height}" fill="none"{look}/>"#,
                    y - 4.5,
                    hex(*color),
                );
                write_text(text, x + 33.0, y, "start", LABEL, name);
            }
        }
    }
}

/// Takes away labels that would lie over others: those of decades come first. `room`: the middle of a label, and what it takes.
fn keep_apart(ticks: &mut [(f64, String)], room: impl Fn(f64, &str) -> (f64, f64)) {
    let is_decade = |value: f64| (value.abs().log10() - value.abs().log10().round()).abs() < 1e-9;
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for decades in [true, false] {
        for (value, label) in ticks.iter_mut().filter(|tick| is_decade(tick.0) == decades) {
            let (middle, width) = room(*value, label);
            if kept.iter().all(|other| (other.0 - middle).abs() >= 0.5 * (other.1 + width)) {
                kept.push((middle, width));
            } else {
                label.clear();
            }
        }
    }
}

/// The style of frames and ticks.
pub(super) fn thin() -> ShapeStyle {
    FRAME.stroke_width(FINE as u32)
}

/// A frame between two corners in px. Not a plotters rectangle, whose line has no width in SVG.
pub(super) fn frame((x0, y0): (f64, f64), (x1, y1): (f64, f64)) -> PathElement<(i32, i32)> {
    let corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)];
    PathElement::new(corners.map(|(x, y)| (fine(x), fine(y))), thin())
}

/// Attributes of the kinds of text.
const TITLE: &str = r##"font-size="19" font-weight="bold" fill="#222222""##;
const NOTE: &str = r##"font-size="13" fill="#555555""##;
const LABEL: &str = r##"font-size="13" fill="#333333""##;
const AXIS: &str = r##"font-size="15" fill="#222222""##;
const HINT: &str =
    r##"font-size="13" fill="#555555" stroke="#ffffff" stroke-width="3" paint-order="stroke" stroke-opacity="0.85""##;

/// Title, subject and note at the top left. `note` is SVG text; the others are escaped here.
pub(super) fn heading(title: &str, subject: &str, note: &str) -> String {
    let mut text = String::new();
    write_text(&mut text, LEFT, 29.0, "start", TITLE, &escape(title));
    write_text(&mut text, LEFT, 49.0, "start", NOTE, &escape(&shortened(subject, 115)));
    write_text(&mut text, LEFT, 67.0, "start", NOTE, note);
    text
}

/// Small text of the kind used for tick labels.
pub(super) fn label(text: &mut String, x: f64, y: f64, anchor: &str, content: &str) {
    write_text(text, x, y, anchor, LABEL, content);
}

fn write_text(text: &mut String, x: f64, y: f64, anchor: &str, attributes: &str, content: &str) {
    if content.is_empty() {
        return;
    }
    let _ = writeln!(text, r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" {attributes}>{content}</text>"#);
}

/// Rough width in px of SVG text at 13 px: tags do not count, an entity counts once.
fn width_of(svg_text: &str) -> f64 {
    let (mut width, mut hidden) = (0.0, None);
    for c in svg_text.chars() {
        match (hidden, c) {
            (None, '<') => hidden = Some('>'),
            (None, '&') => hidden = Some(';'),
            (Some(end), c) if c == end => {
                hidden = None;
                width += if end == ';' { 7.0 } else { 0.0 };
            }
            (None, _) => width += 6.6,
            _ => {}
        }
    }
    width
}

fn rgb(color: Rgb) -> RGBColor {
    RGBColor(color.0, color.1, color.2)
}

/// As in SVG.
pub(super) fn hex(color: Rgb) -> String {
    format!("#{:02x}{:02x}{:02x}", color.0, color.1, color.2)
}

/// Backend pixels of a length in px.
pub(super) fn fine(px: f64) -> i32 {
    (px * f64::from(FINE)).round() as i32
}

/// Geometry by plotters, then `overlay` (in px), as one SVG document without references to anything outside. No ids: a
/// page may hold several.
pub(super) fn picture(
    size: (u32, u32),
    description: &str,
    overlay: &str,
    draw: impl FnOnce(&Area<'_>) -> DrawResult,
) -> Svg {
    Ok(document(size, description, overlay, &geometry(size, draw)?))
}

/// What plotters draws, in backend pixels and without a root element.
fn geometry((width, height): (u32, u32), draw: impl FnOnce(&Area<'_>) -> DrawResult) -> Svg {
    let mut drawn = String::new();
    {
        let root = SVGBackend::with_string(&mut drawn, (width * FINE as u32, height * FINE as u32)).into_drawing_area();
        draw(&root)?;
        root.present()?;
    }
    // The backend's own root element gives way to one in px.
    Ok(drawn.split_once('>').map_or("", |(_, rest)| rest).trim_end().trim_end_matches("</svg>").to_string())
}

fn document((width, height): (u32, u32), description: &str, overlay: &str, body: &str) -> String {
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" role="img" font-family="Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif" stroke-linejoin="round">
<title>{}</title>
<rect width="{width}" height="{height}" fill="#ffffff"/>
<g transform="scale({})">{body}</g>
{overlay}</svg>
"##,
        description_text(description),
        1.0 / f64::from(FINE),
    )
}

/// SVG text without its tags.
fn description_text(svg_text: &str) -> String {
    let mut plain = String::new();
    let mut rest = svg_text;
    while let Some((before, tagged)) = rest.split_once('<') {
        plain.push_str(before);
        rest = tagged.split_once('>').map_or("", |(_, after)| after);
    }
    plain.push_str(rest);
    plain.replace("&#8203;", "")
}

/// The pieces of a polyline inside a horizontal strip.
fn clipped_line(run: &[(f64, f64)], strip: &Range<f64>) -> Vec<Vec<(f64, f64)>> {
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
    for pair in run.windows(2) {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        // The segment's parameters where it is between the two levels.
        let cross = |level: f64| (level - y0) / (y1 - y0);
        let (t0, t1) = if y0 == y1 {
            if y0 < strip.start || y0 > strip.end {
                continue;
            }
            (0.0, 1.0)
        } else {
            let (a, b) = (cross(strip.start), cross(strip.end));
            (a.min(b).max(0.0), a.max(b).min(1.0))
        };
        if t0 > t1 {
            continue;
        }
        let at = |t: f64| (x0 + t * (x1 - x0), (y0 + t * (y1 - y0)).clamp(strip.start, strip.end));
        match pieces.last_mut() {
            Some(piece) if t0 == 0.0 && piece.last() == Some(&at(0.0)) => piece.push(at(t1)),
            _ => pieces.push(vec![at(t0), at(t1)]),
        }
    }
    pieces
}

/// A polygon cut to a horizontal strip (Sutherland and Hodgman 1974, two of its four sides).
fn clipped_polygon(polygon: Vec<(f64, f64)>, strip: &Range<f64>) -> Vec<(f64, f64)> {
    let cut = |polygon: Vec<(f64, f64)>, level: f64, above: bool| {
        let inside = |p: (f64, f64)| if above { p.1 >= level } else { p.1 <= level };
        let mut kept = Vec::with_capacity(polygon.len() + 4);
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            if inside(p) {
                kept.push(p);
            }
            if inside(p) != inside(q) {
                kept.push((p.0 + (level - p.1) / (q.1 - p.1) * (q.0 - p.0), level));
            }
        }
        kept
    };
    cut(cut(polygon, strip.start, true), strip.end, false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_do_not_lie_over_each_other() {
        let mut ticks = log_ticks(&(0.011..7.0));
        let before = ticks.clone();
        keep_apart(&mut ticks, |x, text| (40.0 * x.log10(), width_of(text)));
        let labels: Vec<&str> = ticks.iter().map(|t| t.1.as_str()).filter(|text| !text.is_empty()).collect();
        assert!(labels.len() < before.len() && labels.contains(&"0.1") && labels.contains(&"1"), "{labels:?}");
        // Where there is room, all stay.
        keep_apart(&mut ticks, |x, text| (400.0 * x.log10(), width_of(text)));
        let mut wide = before.clone();
        keep_apart(&mut wide, |x, text| (400.0 * x.log10(), width_of(text)));
        assert_eq!(wide, before);
    }

    #[test]
    fn curves_are_cut_at_the_frame() {
        let pieces = clipped_line(&[(0.0, 0.0), (1.0, 2.0), (2.0, 0.0)], &(0.0..1.0));
        assert_eq!(pieces, [vec![(0.0, 0.0), (0.5, 1.0)], vec![(1.5, 1.0), (2.0, 0.0)]]);
        assert!(clipped_line(&[(0.0, 5.0), (1.0, 5.0)], &(0.0..1.0)).is_empty());
        let band = clipped_polygon(vec![(0.0, -1.0), (2.0, -1.0), (2.0, 3.0), (0.0, 3.0)], &(0.0..1.0));
        assert!(band.len() == 4 && band.iter().all(|p| p.1 == 0.0 || p.1 == 1.0), "{band:?}");
    }
}
