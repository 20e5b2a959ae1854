//! `convergence.svg`: a panel per integrand, variance against n on logarithmic scales, points with two standard errors, fitted lines, and
//! slopes to compare with.

use std::fmt::Write as _;
use std::ops::Range;

use super::{Convergence, Curve};
use crate::display::figure::{IN_TURN, Rgb};
use crate::display::{escape, log_ticks};
use crate::estimate::Measured;

/// Of the whole, and of the frame of a panel within it, in px.
const WIDTH: f64 = 960.0;
const PANEL: [f64; 2] = [480.0, 400.0];
const FRAME: [[f64; 2]; 2] = [[74.0, 34.0], [456.0, 346.0]];
const LEGEND_ROW: f64 = 20.0;

/// Slopes to compare with.
const REFERENCES: [(f64, &str); 3] = [(-1.0, "−1"), (-1.5, "−3/2"), (-2.0, "−2")];

/// A panel: where it stands and what it spans.
struct Panel {
    corner: [f64; 2],
    n: Range<f64>,
    v: Range<f64>,
}

impl Panel {
    fn x(&self, n: f64) -> f64 {
        let part = (n / self.n.start).ln() / (self.n.end / self.n.start).ln();
        self.corner[0] + FRAME[0][0] + part * (FRAME[1][0] - FRAME[0][0])
    }

    fn y(&self, v: f64) -> f64 {
        let part = (v / self.v.start).ln() / (self.v.end / self.v.start).ln();
        self.corner[1] + FRAME[1][1] - part * (FRAME[1][1] - FRAME[0][1])
    }

    /// A line of the power `slope` through a point, as far as it is in the panel; its right end.
    fn line(&self, svg: &mut String, at: [f64; 2], slope: f64, ends: &Range<f64>, look: &str) -> [f64; 2] {
        let value = |n: f64| at[1] * (n / at[0]).powf(slope);
        // Where it leaves through the bottom or the top.
        let cross = |v: f64| at[0] * (v / at[1]).powf(1.0 / slope);
        let mut span = ends.clone();
        for (v, outside) in [(self.v.start, value(span.end) < self.v.start), (self.v.end, value(span.end) > self.v.end)]
        {
            if outside {
                span.end = cross(v);
            }
        }
        for (v, outside) in
            [(self.v.start, value(span.start) < self.v.start), (self.v.end, value(span.start) > self.v.end)]
        {
            if outside {
                span.start = cross(v);
            }
        }
        if span.start < span.end {
            let [a, b] = [span.start, span.end].map(|n| (self.x(n), self.y(value(n))));
            let _ = writeln!(svg, r#"<path d="M{:.1} {:.1}L{:.1} {:.1}" fill="none" {look}/>"#, a.0, a.1, b.0, b.1);
        }
        [span.end, value(span.end)]
    }
}

fn rgb(Rgb(r, g, b): Rgb) -> String {
    format!("rgb({r},{g},{b})")
}

/// The figure as SVG.
pub(super) fn svg(all: &Convergence) -> String {
    let panels = all.integrands.len();
    let names: Vec<String> = all.subjects.iter().map(|s| escape(&shortened(&s.name, 40))).collect();
    let mut legend = Vec::new();
    let (mut x, mut y) = (24.0, 58.0);
    for name in &names {
        let width = 34.0 + 7.2 * name.chars().count() as f64;
        if x + width > WIDTH - 20.0 && x > 24.0 {
            (x, y) = (24.0, y + LEGEND_ROW);
        }
        legend.push([x, y]);
        x += width + 12.0;
    }
    let top = y + LEGEND_ROW + 16.0;
    let columns = if panels > 1 { 2 } else { 1 };
    let height = top + PANEL[1] * panels.div_ceil(columns) as f64 + 10.0;
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:.0}" height="{height:.0}" viewBox="0 0 {WIDTH:.0} {height:.0}" font-family="Helvetica, Arial, sans-serif" font-size="12" fill="#222">
<rect width="100%" height="100%" fill="#fff"/>
<text x="24" y="30" font-size="18" font-weight="bold">Variance of integrals against the number of points</text>
"##
    );
    for ((name, [x, y]), color) in names.iter().zip(&legend).zip(IN_TURN.iter().cycle()) {
        let color = rgb(*color);
        let _ = writeln!(
            svg,
            r#"<path d="M{x:.1} {:.1}h22" stroke="{color}" stroke-width="2"/><circle cx="{:.1}" cy="{:.1}" r="3.6" fill="{color}"/><text x="{:.1}" y="{y:.1}">{name}</text>"#,
            y - 4.0,
            x + 11.0,
            y - 4.0,
            x + 28.0
        );
    }
    let _ = writeln!(
        svg,
        r##"<text x="24" y="{:.1}" fill="#555">Discs and lines: predicted, with the fit; rings: observed as it is; crosses: observed, shifted. Bars are two standard errors. Grey: slopes.</text>"##,
        y + LEGEND_ROW
    );
    for k in 0..panels {
        let corner = [(k % columns) as f64 * PANEL[0], top + (k / columns) as f64 * PANEL[1]];
        let curves: Vec<&Curve> = all.curves.iter().filter(|c| c.integrand == k).collect();
        panel(&mut svg, all, k, &curves, corner);
    }
    svg.push_str("</svg>\n");
    svg
}

fn shortened(text: &str, most: usize) -> String {
    let cut: String = text.chars().take(most).collect();
    if cut.len() < text.len() { format!("{cut}…") } else { cut }
}

fn panel(svg: &mut String, all: &Convergence, k: usize, curves: &[&Curve], corner: [f64; 2]) {
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.filter(|v| *v > 0.0).fold([f64::INFINITY, 0f64], |[a, b], v| [a.min(v), b.max(v)])
    };
    let points = || curves.iter().flat_map(|c| &c.points);
    let [n0, n1] = ends(&mut points().map(|at| at.n));
    let variances = points().flat_map(|at| [Some(at.predicted), Some(at.shifted), at.observed].into_iter().flatten());
    let [v0, v1] = ends(&mut variances.map(|v| v.value));
    let left = corner[0] + FRAME[0][0];
    let _ = writeln!(
        svg,
        r#"<text x="{left:.1}" y="{:.1}" font-size="13" font-weight="bold">{}</text>"#,
        corner[1] + 22.0,
        escape(&shortened(all.integrands[k].spec(), 56))
    );
    if v0 > v1 {
        let _ = writeln!(svg, r#"<text x="{left:.1}" y="{:.1}">no variance above 0</text>"#, corner[1] + 60.0);
        return;
    }
    let panel = Panel { corner, n: n0 / 1.25..n1 * (n1 / n0).powf(0.15), v: v0 / 2.5..v1 * 2.5 };
    let (right, bottom) = (corner[0] + FRAME[1][0], corner[1] + FRAME[1][1]);
    let frame_top = corner[1] + FRAME[0][1];
    for (v, label) in log_ticks(&panel.v) {
        let y = panel.y(v);
        let _ = writeln!(
            svg,
            r##"<path d="M{left:.1} {y:.1}H{right:.1}" stroke="#e8e8e8"/><text x="{:.1}" y="{:.1}" text-anchor="end">{label}</text>"##,
            left - 7.0,
            y + 4.0
        );
    }
    for (n, label) in log_ticks(&panel.n) {
        let x = panel.x(n);
        let _ = writeln!(
            svg,
            r##"<path d="M{x:.1} {bottom:.1}v5" stroke="#5a5a5a"/><text x="{x:.1}" y="{:.1}" text-anchor="middle">{label}</text>"##,
            bottom + 19.0
        );
    }
    // Slopes to compare with leave one point, above all that is drawn.
    let from = [n0, v1 * 1.6];
    for (slope, label) in REFERENCES {
        let span = n0..n1 * (n1 / n0).powf(0.05);
        let [n, v] = panel.line(svg, from, slope, &span, r##"stroke="#9a9a9a" stroke-dasharray="3 3""##);
        let _ = writeln!(
            svg,
            r##"<text x="{:.1}" y="{:.1}" font-size="11" fill="#777">{label}</text>"##,
            panel.x(n) + 3.0,
            panel.y(v).min(bottom - 5.0) + 3.0
        );
    }
    for curve in curves {
        let color = rgb(IN_TURN[curve.subject % IN_TURN.len()]);
        if let Some(law) = curve.slopes.iter().find(|s| s.variance == "predicted").and_then(|s| s.law) {
            let look = format!(r#"stroke="{color}" stroke-width="1.8""#);
            panel.line(svg, [law.range[0], law.at(law.range[0])], law.slope, &(law.range[0]..law.range[1]), &look);
        }
        for at in &curve.points {
            let x = panel.x(at.n);
            // Side by side, so that each can be seen.
            let each = [(Some(at.predicted), 0.0, 0), (at.observed, 5.0, 1), (Some(at.shifted), -5.0, 2)];
            for (measured, beside, kind) in each {
                if let Some(measured) = measured.filter(|m| m.value > 0.0) {
                    mark(svg, &panel, x + beside, measured, &color, kind);
                }
            }
        }
    }
    let _ = writeln!(
        svg,
        r##"<rect x="{left:.1}" y="{frame_top:.1}" width="{:.1}" height="{:.1}" fill="none" stroke="#5a5a5a"/><text x="{:.1}" y="{:.1}" text-anchor="middle">number of points n</text><text x="{:.1}" y="{:.1}" text-anchor="middle" transform="rotate(-90 {:.1} {:.1})">variance</text>"##,
        right - left,
        bottom - frame_top,
        0.5 * (left + right),
        bottom + 38.0,
        corner[0] + 16.0,
        0.5 * (frame_top + bottom),
        corner[0] + 16.0,
        0.5 * (frame_top + bottom)
    );
}

/// A value with two standard errors.
fn mark(svg: &mut String, panel: &Panel, x: f64, measured: Measured, color: &str, kind: u8) {
    let reach = 2.0 * measured.se.unwrap_or(0.0);
    let end = |v: f64| panel.y(v.clamp(panel.v.start, panel.v.end));
    let (low, y, high) = (end(measured.value - reach), end(measured.value), end(measured.value + reach));
    let _ = writeln!(svg, r#"<path d="M{x:.1} {low:.1}V{high:.1}" stroke="{color}" stroke-width="1"/>"#);
    let _ = match kind {
        0 => writeln!(svg, r#"<circle cx="{x:.1}" cy="{y:.1}" r="3.6" fill="{color}"/>"#),
        1 => writeln!(
            svg,
            r##"<circle cx="{x:.1}" cy="{y:.1}" r="3" fill="#fff" stroke="{color}" stroke-width="1.4"/>"##
        ),
        _ => writeln!(
            svg,
            r#"<path d="M{:.1} {:.1}l5 5m0 -5l-5 5" stroke="{color}" stroke-width="1.4"/>"#,
            x - 2.5,
            y - 2.5
        ),
    };
}
