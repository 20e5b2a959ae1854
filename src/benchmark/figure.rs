//! Figures of a benchmark, on logarithmic scales: error against time for each scene, for each integrand, and time against size.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::PathBuf;

use super::{Benchmark, Scene, tables};
use crate::display::figure::IN_TURN;
use crate::display::{escape, log_ticks, shortened};
use crate::report::{Asked, Columns, Numbers, Page};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// Figures by the names of their files, and the page.
pub(super) struct Made {
    pub(super) figures: Vec<(&'static str, String)>,
    pub(super) page: String,
}

/// What a panel shows.
struct Panel {
    title: String,
    x_label: &'static str,
    y_label: String,
    curves: Vec<Curve>,
    /// Horizontal lines with their names.
    levels: Vec<(f64, String)>,
}

/// Points with their names, joined or not.
struct Curve {
    name: String,
    points: Vec<[f64; 2]>,
    /// Names beside points; none where there are none.
    labels: Vec<Label>,
    joined: bool,
}

/// What a point is called, and whether no other beats it.
struct Label {
    text: String,
    front: bool,
}

const WIDTH: f64 = 960.0;
const PANEL: [f64; 2] = [960.0, 420.0];
const FRAME: [[f64; 2]; 2] = [[86.0, 40.0], [660.0, 366.0]];

/// Draws.
pub(super) fn page(all: &Benchmark, asked: &Asked) -> Result<Made> {
    let mut figures = Vec::new();
    let mut draw = |name, panels: Vec<Panel>| {
        if !panels.is_empty() {
            figures.push((name, svg(&panels)));
        }
    };
    draw("bench.svg", all.scenes.iter().map(of_scene).collect());
    draw("efficiency.svg", of_samplers(all));
    draw("growth.svg", of_growth(all));

    let mut page = Page::new("Run time against error", &escape(&all.machine.words()));
    page.warnings(&all.warnings);
    let tables: BTreeMap<&'static str, Columns> = tables::all(all)
        .into_iter()
        .map(|(name, table)| Ok((name, Columns::read(PathBuf::from(name), &table.csv()?)?)))
        .collect::<Result<_>>()?;
    for (name, svg) in &figures {
        let (heading, caption, of): (_, _, &[&str]) = match *name {
            "bench.svg" => (
                "Ways to the same numbers",
                "Difference from exact numbers against the time of one realization; ringed: no other way is both faster and as accurate. Dashed: what \
                 chance makes of the same numbers in K realizations: a way below the line of one's K is accurate enough. What is exact is drawn at the bottom.",
                &["bench.csv"],
            ),
            "efficiency.svg" => (
                "Efficiency of samplers",
                "Root mean squared error of an integral against the time of drawing points and evaluating the integrand at them, on one thread.",
                &["efficiency.csv"],
            ),
            _ => (
                "Growth",
                "Time against the size of a problem (points), and what its plan says (line), which is for the machine that its costs were taken on.",
                &["growth.csv", "growth_exponents.csv"],
            ),
        };
        page.section(heading);
        let numbers: Vec<_> = of
            .iter()
            .filter_map(|table| Some(Numbers { name: table, columns: tables.get(table)?, page: None }))
            .collect();
        page.picture(name.trim_end_matches(".svg"), [svg, "", caption], &[], &numbers)?;
    }
    for (name, columns) in tables.iter().filter(|(name, _)| **name == "skipped.csv") {
        page.section("Work that was not done");
        page.paragraph("What was counted while it was done, beside what a plain implementation does.");
        page.picture("skipped", ["", "", "Pairs, products and bytes."], &[], &[Numbers { name, columns, page: None }])?;
    }
    if let Some(pace) = all.pace() {
        let off: Vec<_> = all.mispredicted().map(|g| format!("{} at {} = {}", g.of, g.variable, g.value)).collect();
        let off = if off.is_empty() { "none".into() } else { off.join(", ") };
        let rows = [
            ("Off throughout, as a factor".into(), format!("{pace:.2}")),
            ("Off by more than 15 % beside that, in every run".into(), off),
        ];
        page.rows("Plans", &rows);
    }
    page.section("How it was computed");
    page.typed(&asked.command);
    let page = page.finish("The numbers behind the pictures are in the CSV files next to this page.");
    Ok(Made { figures, page })
}

fn of_scene(scene: &Scene) -> Panel {
    let levels = [1.0, 1e2, 1e4, 1e6].map(|k: f64| (scene.statistical / k.sqrt(), format!("K = {k}")));
    let errors = scene.ways.iter().map(|way| way.drawn(scene.statistical)).chain(levels.iter().map(|level| level.0));
    // What is 0 is drawn below all else.
    let floor = errors.filter(|error| *error > 0.0).fold(f64::INFINITY, f64::min) / 100.0;
    let several = scene.ways.iter().any(|way| way.device != scene.ways[0].device);
    let mut curves: Vec<Curve> = Vec::new();
    for way in &scene.ways {
        let error = way.drawn(scene.statistical);
        let on = if several && way.device != scene.ways[0].device { " (GPU)" } else { "" };
        let family = if way.error.is_none() { "by chance alone, K = 1" } else { family(&way.method) };
        let family = format!("{family}{on}");
        let exact = if error == 0.0 { ": exact" } else { "" };
        let label = Label { text: format!("{}{on}{exact}", way.method), front: way.front };
        let point = [way.seconds.median, error.max(floor)];
        match curves.iter_mut().find(|curve| curve.name == family) {
            Some(curve) => {
                curve.points.push(point);
                curve.labels.push(label);
            }
            None => curves.push(Curve { name: family, points: vec![point], labels: vec![label], joined: false }),
        }
    }
    Panel {
        title: scene.name.clone(),
        x_label: "seconds of one realization",
        y_label: format!("rms error of {}", scene.error_of),
        curves,
        levels: levels.into_iter().filter(|(level, _)| *level > 0.0).collect(),
    }
}

/// What ways are coloured by: their first words.
fn family(method: &str) -> &str {
    method.split([',', ':']).next().unwrap_or(method)
}

fn of_samplers(all: &Benchmark) -> Vec<Panel> {
    let mut panels: Vec<Panel> = Vec::new();
    for row in &all.efficiency {
        // What is left of some is rounding.
        if row.error <= super::ROUNDING {
            continue;
        }
        if !panels.iter().any(|p| p.title == row.integrand) {
            panels.push(Panel {
                title: row.integrand.clone(),
                x_label: "seconds of one realization, drawing and evaluating",
                y_label: "rms error of the integral".into(),
                curves: Vec::new(),
                levels: Vec::new(),
            });
        }
        let Some(panel) = panels.iter_mut().find(|p| p.title == row.integrand) else { continue };
        let point = [row.seconds(1.0), row.error];
        match panel.curves.iter_mut().find(|curve| curve.name == row.sampler) {
            Some(curve) => curve.points.push(point),
            None => panel.curves.push(Curve {
                name: row.sampler.clone(),
                points: vec![point],
                labels: Vec::new(),
                joined: true,
            }),
        }
    }
    panels
}

fn of_growth(all: &Benchmark) -> Vec<Panel> {
    let ladders = all.grown.chunk_by(|a, b| (a.of, a.variable) == (b.of, b.variable));
    let panel = |ladder: &[super::Grown]| {
        let curve = |name: &str, joined, of: fn(&super::Grown) -> f64| Curve {
            name: name.into(),
            points: ladder.iter().map(|g| [g.value, of(g)]).collect(),
            labels: Vec::new(),
            joined,
        };
        Panel {
            title: format!("{} against {}", ladder[0].of, ladder[0].variable),
            x_label: ladder[0].variable,
            y_label: "seconds".into(),
            curves: vec![curve("measured", false, |g| g.seconds.median), curve("planned", true, |g| g.planned)],
            levels: Vec::new(),
        }
    };
    ladders.map(panel).collect()
}

/// Panels below each other.
fn svg(panels: &[Panel]) -> String {
    let height = PANEL[1] * panels.len() as f64;
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:.0}" height="{height:.0}" viewBox="0 0 {WIDTH:.0} {height:.0}" font-family="Helvetica, Arial, sans-serif" font-size="12" fill="#222">
<rect width="100%" height="100%" fill="#fff"/>
"##
    );
    for (k, panel) in panels.iter().enumerate() {
        draw(&mut svg, panel, PANEL[1] * k as f64);
    }
    svg.push_str("</svg>\n");
    svg
}

/// A range about values, with some room.
fn about(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (lo, hi) = values
        .filter(|v| *v > 0.0 && v.is_finite())
        .fold((f64::INFINITY, 0.0f64), |(lo, hi), v| (lo.min(v), hi.max(v)));
    if lo > hi { 0.1..10.0 } else { lo / 2.0..hi * 2.0 }
}

fn draw(svg: &mut String, panel: &Panel, top: f64) {
    let points = || panel.curves.iter().flat_map(|curve| &curve.points);
    let (x_range, y_range) =
        (about(points().map(|p| p[0])), about(points().map(|p| p[1]).chain(panel.levels.iter().map(|level| level.0))));
    let [[left, up], [right, down]] = FRAME;
    let (up, down) = (top + up, top + down);
    let part = |range: &Range<f64>, v: f64| (v / range.start).ln() / (range.end / range.start).ln();
    let x = |v: f64| left + part(&x_range, v) * (right - left);
    let y = |v: f64| down - part(&y_range, v) * (down - up);
    let _ = writeln!(
        svg,
        r#"<text x="{left:.1}" y="{:.1}" font-size="14" font-weight="bold">{}</text>"#,
        up - 14.0,
        escape(&panel.title)
    );
    let ticks = log_ticks(&y_range);
    let every = ticks.len().div_ceil(9);
    for (v, label) in ticks.into_iter().rev().step_by(every) {
        let at = y(v);
        let _ = writeln!(
            svg,
            r##"<path d="M{left:.1} {at:.1}H{right:.1}" stroke="#e8e8e8"/><text x="{:.1}" y="{:.1}" text-anchor="end">{label}</text>"##,
            left - 7.0,
            at + 4.0
        );
    }
    for (v, label) in log_ticks(&x_range) {
        let at = x(v);
        let _ = writeln!(
            svg,
            r##"<path d="M{at:.1} {down:.1}v5" stroke="#5a5a5a"/><text x="{at:.1}" y="{:.1}" text-anchor="middle">{label}</text>"##,
            down + 19.0
        );
    }
    for (level, name) in &panel.levels {
        let at = y(*level);
        let _ = writeln!(
            svg,
            r##"<path d="M{left:.1} {at:.1}H{right:.1}" stroke="#9a9a9a" stroke-dasharray="5 4"/><text x="{:.1}" y="{:.1}" fill="#777" text-anchor="end" font-size="11">{name}</text>"##,
            right - 4.0,
            at - 3.0
        );
    }
    if let Some(front) = front(panel) {
        let line: Vec<String> = front.iter().map(|p| format!("{:.1} {:.1}", x(p[0]), y(p[1]))).collect();
        let _ = writeln!(
            svg,
            r##"<path d="M{}" fill="none" stroke="#c8c8c8" stroke-width="5" stroke-linejoin="round"/>"##,
            line.join("L")
        );
    }
    let mut row = up + 8.0;
    for (turn, (curve, color)) in panel.curves.iter().zip(IN_TURN.iter().cycle()).enumerate() {
        let color = color.to_string();
        // Colours come again hollow.
        let fill = if turn < IN_TURN.len() { &color } else { "#fff" };
        let place = |p: &[f64; 2]| [x(p[0]), y(p[1])];
        if curve.joined && curve.points.len() > 1 {
            let line: Vec<String> = curve.points.iter().map(place).map(|[x, y]| format!("{x:.1} {y:.1}")).collect();
            let _ = writeln!(svg, r#"<path d="M{}" fill="none" stroke="{color}" stroke-width="1.8"/>"#, line.join("L"));
        }
        let _ = writeln!(
            svg,
            r#"<circle cx="{:.1}" cy="{:.1}" r="4" fill="{fill}" stroke="{color}"/><text x="{:.1}" y="{row:.1}">{}</text>"#,
            right + 20.0,
            row - 4.0,
            right + 30.0,
            escape(&shortened(&curve.name, 38))
        );
        row += 18.0;
        for (k, point) in curve.points.iter().enumerate() {
            let [cx, cy] = place(point);
            let label = curve.labels.get(k);
            if label.is_some_and(|label| label.front) {
                let _ = writeln!(
                    svg,
                    r#"<circle cx="{cx:.1}" cy="{cy:.1}" r="7.5" fill="none" stroke="{color}" stroke-width="1.4"/>"#
                );
            }
            let _ = writeln!(svg, r#"<circle cx="{cx:.1}" cy="{cy:.1}" r="4" fill="{fill}" stroke="{color}"/>"#);
            if let Some(label) = label {
                // A number beside the point, explained in the legend: words would lie on each other.
                let _ = writeln!(
                    svg,
                    r#"<text x="{:.1}" y="{:.1}" font-size="11" fill="{color}">{}</text><text x="{:.1}" y="{row:.1}" font-size="11" fill="{color}">{}  {}</text>"#,
                    cx + 9.0,
                    cy - 6.0,
                    letter(panel, curve, k),
                    right + 40.0,
                    letter(panel, curve, k),
                    escape(&shortened(&label.text, 38))
                );
                row += 15.0;
            }
        }
    }
    let _ = writeln!(
        svg,
        r##"<rect x="{left:.1}" y="{up:.1}" width="{:.1}" height="{:.1}" fill="none" stroke="#5a5a5a"/><text x="{:.1}" y="{:.1}" text-anchor="middle">{}</text><text x="{:.1}" y="{:.1}" text-anchor="middle" transform="rotate(-90 {:.1} {:.1})">{}</text>"##,
        right - left,
        down - up,
        0.5 * (left + right),
        down + 40.0,
        panel.x_label,
        18.0,
        0.5 * (up + down),
        18.0,
        0.5 * (up + down),
        escape(&panel.y_label)
    );
}

/// The points that no other beats, from the fastest on; none where none is named so.
fn front(panel: &Panel) -> Option<Vec<[f64; 2]>> {
    let all = panel.curves.iter().flat_map(|curve| curve.points.iter().zip(&curve.labels));
    let mut front: Vec<[f64; 2]> = all.filter(|(_, label)| label.front).map(|(point, _)| *point).collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    (front.len() > 1).then_some(front)
}

/// The letter of a point among all of its panel.
fn letter(panel: &Panel, curve: &Curve, k: usize) -> char {
    let before: usize =
        panel.curves.iter().take_while(|other| other.name != curve.name).map(|other| other.points.len()).sum();
    char::from(b'a' + ((before + k) % 26) as u8)
}
