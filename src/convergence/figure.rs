//! `convergence.svg`: a panel per integrand, variance against n on logarithmic scales, points with two standard errors, fitted lines, and
//! slopes to compare with.

use std::fmt::Write as _;

use super::Convergence;
use crate::display::figure::IN_TURN;
use crate::display::{Ladder, LadderFrame, Rung, RungMark, escape, log_ticks};

/// Of the whole, and of the frame of a panel within it, in px.
const WIDTH: f64 = 960.0;
const PANEL: [f64; 2] = [480.0, 400.0];
const FRAME: [[f64; 2]; 2] = [[74.0, 34.0], [456.0, 346.0]];
const LEGEND_ROW: f64 = 20.0;
/// How far beside n marks stand.
const BESIDE: f64 = 5.0;

/// A panel: where it stands and what it spans.
struct Panel {
    corner: [f64; 2],
    frame: LadderFrame,
}

impl Panel {
    fn x(&self, n: f64) -> f64 {
        let range = &self.frame.n;
        let part = (n / range.start).ln() / (range.end / range.start).ln();
        self.corner[0] + FRAME[0][0] + part * (FRAME[1][0] - FRAME[0][0])
    }

    fn y(&self, v: f64) -> f64 {
        let range = &self.frame.v;
        let part = (v / range.start).ln() / (range.end / range.start).ln();
        self.corner[1] + FRAME[1][1] - part * (FRAME[1][1] - FRAME[0][1])
    }

    fn line(&self, svg: &mut String, ends: [[f64; 2]; 2], look: &str) {
        let [a, b] = ends.map(|[n, v]| (self.x(n), self.y(v)));
        let _ = writeln!(svg, r#"<path d="M{:.1} {:.1}L{:.1} {:.1}" fill="none" {look}/>"#, a.0, a.1, b.0, b.1);
    }
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
        let color = color.to_string();
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
        let curves: Vec<(usize, Ladder)> = all.of_integrand(k).collect();
        panel(&mut svg, all, k, &curves, corner);
    }
    svg.push_str("</svg>\n");
    svg
}

fn shortened(text: &str, most: usize) -> String {
    let cut: String = text.chars().take(most).collect();
    if cut.len() < text.len() { format!("{cut}…") } else { cut }
}

fn panel(svg: &mut String, all: &Convergence, k: usize, curves: &[(usize, Ladder)], corner: [f64; 2]) {
    let left = corner[0] + FRAME[0][0];
    let _ = writeln!(
        svg,
        r#"<text x="{left:.1}" y="{:.1}" font-size="13" font-weight="bold">{}</text>"#,
        corner[1] + 22.0,
        escape(&shortened(all.integrands[k].spec(), 56))
    );
    let Some(frame) = LadderFrame::of(curves.iter().map(|(_, ladder)| ladder)) else {
        let _ = writeln!(svg, r#"<text x="{left:.1}" y="{:.1}">no variance above 0</text>"#, corner[1] + 60.0);
        return;
    };
    let panel = Panel { corner, frame };
    let (right, bottom) = (corner[0] + FRAME[1][0], corner[1] + FRAME[1][1]);
    let frame_top = corner[1] + FRAME[0][1];
    for (v, label) in log_ticks(&panel.frame.v) {
        let y = panel.y(v);
        let _ = writeln!(
            svg,
            r##"<path d="M{left:.1} {y:.1}H{right:.1}" stroke="#e8e8e8"/><text x="{:.1}" y="{:.1}" text-anchor="end">{label}</text>"##,
            left - 7.0,
            y + 4.0
        );
    }
    for (n, label) in log_ticks(&panel.frame.n) {
        let x = panel.x(n);
        let _ = writeln!(
            svg,
            r##"<path d="M{x:.1} {bottom:.1}v5" stroke="#5a5a5a"/><text x="{x:.1}" y="{:.1}" text-anchor="middle">{label}</text>"##,
            bottom + 19.0
        );
    }
    for (line, label) in panel.frame.references() {
        panel.line(svg, line, r##"stroke="#9a9a9a" stroke-dasharray="3 3""##);
        let [n, v] = line[1];
        let _ = writeln!(
            svg,
            r##"<text x="{:.1}" y="{:.1}" font-size="11" fill="#777">{label}</text>"##,
            panel.x(n) + 3.0,
            panel.y(v).min(bottom - 5.0) + 3.0
        );
    }
    for (subject, ladder) in curves {
        let color = IN_TURN[subject % IN_TURN.len()].to_string();
        if let Some(fit) = panel.frame.fit(ladder) {
            panel.line(svg, fit, &format!(r#"stroke="{color}" stroke-width="1.8""#));
        }
        for one in panel.frame.marks(ladder) {
            mark(svg, &panel, &one, &color);
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
fn mark(svg: &mut String, panel: &Panel, mark: &RungMark, color: &str) {
    let x = panel.x(mark.n) + BESIDE * mark.beside;
    let (y, [low, high]) = (panel.y(mark.value), mark.ends.map(|end| panel.y(end)));
    let _ = writeln!(svg, r#"<path d="M{x:.1} {low:.1}V{high:.1}" stroke="{color}" stroke-width="1"/>"#);
    let _ = match mark.rung {
        Rung::Predicted => writeln!(svg, r#"<circle cx="{x:.1}" cy="{y:.1}" r="3.6" fill="{color}"/>"#),
        Rung::Observed => writeln!(
            svg,
            r##"<circle cx="{x:.1}" cy="{y:.1}" r="3" fill="#fff" stroke="{color}" stroke-width="1.4"/>"##
        ),
        Rung::Shifted => writeln!(
            svg,
            r#"<path d="M{:.1} {:.1}l5 5m0 -5l-5 5" stroke="{color}" stroke-width="1.4"/>"#,
            x - 2.5,
            y - 2.5
        ),
    };
}
