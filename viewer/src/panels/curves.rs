//! g(r), radial P and anisotropy: a curve per set, with its error band.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use eframe::egui;
use egui_plot::{FilledArea, HLine, Line, LineStyle, PlotPoint, PlotPoints, PlotUi, Points, Text, VLine};
use pairwave::analysis::Analysis;
use pairwave::display::{Axis, Frame, FrequencyUnit, Panel, Trace, bin_at, paper, ring_at, thinned_band, thinned_line};

use super::chart::{Chart, Zoomed};
use super::{Scene, said_instead};
use crate::colors;
use crate::engine::SetId;
use crate::hover::Place;
use crate::set::Set;
use crate::view::View;

/// Curves as they were drawn last.
#[derive(Default)]
pub(crate) struct Curves {
    kept: HashMap<(Panel, SetId), KeptTraces>,
    frames: HashMap<Panel, ((Axis, Axis), Frame)>,
}

/// The curve of a snapshot along two axes, ready to be drawn.
struct KeptTraces {
    of: (u64, Axis, Axis),
    trace: Trace,
    line: Vec<Vec<PlotPoint>>,
    closed_form: Vec<Vec<PlotPoint>>,
}

impl KeptTraces {
    fn new(of: (u64, Axis, Axis), trace: Trace) -> Self {
        let points = |pieces: &[Vec<[f64; 2]>]| {
            pieces.iter().map(|piece| piece.iter().map(|p| PlotPoint::from(*p)).collect()).collect()
        };
        Self { of, line: points(&trace.line), closed_form: points(&trace.closed_form), trace }
    }
}

/// What of a plot is seen, and on how many pixels: more is not drawn.
struct Seen {
    x: RangeInclusive<f64>,
    bottom: f64,
    columns: usize,
}

impl Seen {
    /// What is seen, with a neighbour on either side.
    fn of<'a, T>(&self, all: &'a [T], x: impl Fn(&T) -> f64) -> &'a [T] {
        let first = all.partition_point(|p| x(p) < *self.x.start()).saturating_sub(1);
        let end = (all.partition_point(|p| x(p) <= *self.x.end()) + 1).min(all.len());
        all.get(first..end).unwrap_or_default()
    }

    fn column(&self, x: f64) -> i64 {
        ((x - self.x.start()) / (self.x.end() - self.x.start()) * self.columns as f64) as i64
    }

    /// Of many points in one column of pixels: the first, the lowest, the highest and the last, which look the same.
    fn line<'a>(&self, all: &'a [PlotPoint]) -> PlotPoints<'a> {
        let seen = self.of(all, |p| p.x);
        if seen.len() <= 4 * self.columns {
            return PlotPoints::Borrowed(seen);
        }
        PlotPoints::Owned(thinned_line(seen, |p| self.column(p.x), |p| p.y))
    }

    /// The same of a band, whose columns are as high as their highest.
    fn band(&self, all: &[[f64; 3]]) -> [Vec<f64>; 3] {
        let seen = self.of(all, |p| p[0]);
        let few = seen.len() <= 4 * self.columns;
        let kept = if few { seen.to_vec() } else { thinned_band(seen, |x| self.column(x)) };
        [0, 1, 2].map(|column| kept.iter().map(|part| part[column]).collect())
    }
}

impl Curves {
    /// Draws a panel of curves.
    pub(super) fn show(&mut self, ui: &mut egui::Ui, panel: Panel, scene: &mut Scene<'_>, zoomed: &mut Zoomed) {
        let drawn = self.prepare(panel, scene);
        let selected = drawn.iter().find(|&&index| index == scene.selected).or(drawn.last());
        let selected = selected.and_then(|&index| scene.sets[index].analysis());
        let Some((x, y)) = selected.map(|analysis| axes(panel, analysis, scene.view)) else {
            let measured = scene.sets.iter().filter(|set| set.visible).find_map(Set::analysis);
            said_instead(ui, scene, measured.map_or("", |analysis| panel.without_curve(analysis)));
            return;
        };
        let cut = legend(ui, panel, scene, x);
        let frames = drawn.iter().filter_map(|&s| self.kept.get(&(panel, scene.sets[s].id))).map(|k| k.trace.frame);
        let Some(mut wanted) = frames.reduce(Frame::union) else { return };
        if let Some(analysis) = selected.filter(|_| scene.view.paper && panel != Panel::Pcf) {
            wanted = paper::frame(wanted, analysis, x);
        }
        // While realizations come in curves stand still; in the end what is seen does not depend on how they came.
        let done = drawn.iter().all(|&s| scene.sets[s].snapshot.as_ref().is_some_and(|s| s.done));
        let frame = match self.frames.get(&panel) {
            Some((of, frame)) if *of == (x, y) && !done => frame.kept(wanted),
            _ => wanted,
        };
        self.frames.insert(panel, ((x, y), frame));
        let names: Vec<String> = drawn.iter().map(|&s| scene.sets[s].described()).collect();
        let described = format!("{} of {}, along {}", panel.name(), names.join(", "), x.label());
        let fit = |x: [f64; 2]| {
            let kept = drawn.iter().filter_map(|&s| self.kept.get(&(panel, scene.sets[s].id)));
            let ranges = kept.filter_map(|kept| kept.trace.fit(x)).map(|y| Frame { x, y });
            ranges.reduce(Frame::union).map(|frame| frame.y)
        };
        let chart = Chart {
            panel,
            index: 0,
            x,
            y,
            frame,
            square: false,
            picture: false,
            described: &described,
            fit: Some(&fit),
        };
        self.plot(ui, scene, zoomed, &drawn, chart, cut);
    }

    /// Brings up to date what is kept. The sets that have a curve.
    fn prepare(&mut self, panel: Panel, scene: &Scene<'_>) -> Vec<usize> {
        self.kept.retain(|(_, id), _| scene.sets.iter().any(|set| set.id == *id));
        let mut drawn = Vec::new();
        for (index, set) in scene.sets.iter().enumerate().filter(|(_, set)| set.visible) {
            let key = (panel, set.id);
            let (Some(analysis), Some(snapshot)) = (set.analysis(), &set.snapshot) else {
                self.kept.remove(&key);
                continue;
            };
            let (x, y) = axes(panel, analysis, scene.view);
            let of = (snapshot.generation, x, y);
            if self.kept.get(&key).is_none_or(|kept| kept.of != of) {
                match panel.trace(analysis, x, y) {
                    Some(trace) => _ = self.kept.insert(key, KeptTraces::new(of, trace)),
                    None => _ = self.kept.remove(&key),
                }
            }
            if self.kept.contains_key(&key) {
                drawn.push(index);
            }
        }
        drawn
    }

    fn plot(
        &self,
        ui: &mut egui::Ui,
        scene: &mut Scene<'_>,
        zoomed: &mut Zoomed,
        drawn: &[usize],
        chart: Chart<'_>,
        cut: bool,
    ) {
        let (panel, x, frame, dark) = (chart.panel, chart.x, chart.frame, ui.visuals().dark_mode);
        let (ink, weak) = (ui.visuals().strong_text_color(), ui.visuals().weak_text_color());
        let roomy = super::chart::is_roomy(ui.available_size());
        let (kept, sets, view, hover) = (&self.kept, scene.sets, scene.view, &*scene.hover);
        // The selected one over the others.
        let mut drawn = drawn.to_vec();
        drawn.sort_by_key(|&index| index == scene.selected);
        let chosen = zoomed.is(panel);
        let shown = chart.show(ui, zoomed, |plot| {
            let bounds = plot.plot_bounds();
            let (ends, bottom) = match chosen {
                true => (bounds.range_x(), bounds.min()[1]),
                false => (frame.x[0]..=frame.x[1], frame.y[0]),
            };
            let width = plot.response().rect.width() * plot.ctx().pixels_per_point();
            let seen = Seen { x: ends, bottom, columns: width.max(1.0) as usize };
            let curves: Vec<(&KeptTraces, egui::Color32)> = drawn
                .iter()
                .filter_map(|&index| {
                    let set = &sets[index];
                    Some((kept.get(&(panel, set.id))?, colors::set(set.color, dark)))
                })
                .collect();
            draw(plot, &curves, view, &seen, [ink, weak], roomy);
            let Some(at) = hover.along(panel).and_then(|at| x.forward(at)) else { return };
            plot.vline(VLine::new("pointer", at).color(ink.gamma_multiply(0.5)).width(1.0).allow_hover(false));
            for &index in &drawn {
                let set = &sets[index];
                let here = set.analysis().and_then(|analysis| {
                    let (x, y) = axes(panel, analysis, view);
                    let (at, value) = sample(panel, analysis, x.backward(at)?)?;
                    Some([x.forward(at)?, y.forward(value)?])
                });
                if let Some(here) = here {
                    let dot = Points::new("value", vec![here]).radius(3.5).color(colors::set(set.color, dark));
                    plot.points(dot.allow_hover(false));
                }
            }
        });
        if let Some(at) = shown.pointer().and_then(|at| x.backward(at.x)) {
            scene.hover.at(panel, if panel == Panel::Pcf { Place::Distance(at) } else { Place::Frequency(at) });
        }
        if cut && scene.hover.is_in(panel) {
            let dark = ui.visuals().dark_mode;
            shown.response.on_hover_ui_at_pointer(|ui| {
                for (color, _, long) in said(panel, scene, x) {
                    ui.colored_label(colors::set(color, dark), long);
                }
            });
        }
    }
}

/// Curves with what belongs to them; the last one is the one that is selected.
fn draw<'a>(
    plot: &mut PlotUi<'a>,
    curves: &[(&'a KeptTraces, egui::Color32)],
    view: &View,
    seen: &Seen,
    [ink, weak]: [egui::Color32; 2],
    roomy: bool,
) {
    if let Some((at, symbol)) = curves.last().and_then(|(kept, _)| kept.trace.landmark.as_ref()) {
        let line = VLine::new("landmark", *at).color(weak.gamma_multiply(0.6)).width(1.0).allow_hover(false);
        plot.vline(line.style(LineStyle::dotted_loose()));
        if roomy {
            let text = egui::RichText::new(format!(" {symbol}")).small();
            let label = Text::new("landmark", PlotPoint::new(*at, seen.bottom), text).color(weak);
            plot.text(label.anchor(egui::Align2::LEFT_BOTTOM).allow_hover(false));
        }
    }
    for (kept, _) in curves {
        if let Some(reference) = kept.trace.reference {
            let line = HLine::new("reference", reference).color(weak.gamma_multiply(0.8)).width(1.0);
            plot.hline(line.style(LineStyle::dotted_dense()).allow_hover(false));
        }
    }
    // Several over each other would be one grey: they are paler, and told apart by their edges.
    let alone = curves.len() == 1;
    for (index, (kept, color)) in curves.iter().enumerate().filter(|_| view.bands) {
        let same = |(other, _): &(&KeptTraces, egui::Color32)| other.trace.band == kept.trace.band;
        if curves[..index].iter().any(same) {
            continue;
        }
        // That of isotropic spectra belongs to all of as many realizations.
        let shared = curves[index + 1..].iter().any(same);
        let color = if shared { weak } else { *color };
        for piece in &kept.trace.band {
            let [xs, low, high] = seen.band(piece);
            let fill = color.gamma_multiply(if alone || shared { 0.25 } else { 0.12 });
            plot.add(FilledArea::new("band", &xs, &low, &high).fill_color(fill).allow_hover(false));
            for ends in [low, high].iter().filter(|_| !(alone || shared)) {
                let edge: PlotPoints<'_> = xs.iter().zip(ends).map(|(&x, &y)| [x, y]).collect();
                let line = Line::new("band", edge).color(color.gamma_multiply(0.5)).width(1.0);
                plot.line(line.allow_band(false).allow_hover(false));
            }
        }
    }
    for (index, (kept, color)) in curves.iter().enumerate() {
        let width = if index + 1 == curves.len() { 1.8 } else { 1.3 };
        for piece in &kept.line {
            // Where points are close, it would draw a band of a pixel's columns, which looks dashed: they are thinned already.
            let line = Line::new("estimate", seen.line(piece)).allow_band(false);
            plot.line(line.color(*color).width(width).allow_hover(false));
        }
    }
    // Over the estimates, which they may run along.
    for (kept, color) in curves.iter().filter(|_| view.closed_forms) {
        for piece in &kept.closed_form {
            let line = Line::new("closed form", seen.line(piece)).color(color.lerp_to_gamma(ink, 0.55)).width(1.2);
            plot.line(line.style(LineStyle::dashed_dense()).allow_hover(false));
        }
    }
}

/// Along which axes an analysis is drawn.
fn axes(panel: Panel, analysis: &Analysis, view: &View) -> (Axis, Axis) {
    let unit = if view.paper { FrequencyUnit::SqrtN } else { view.frequency_unit };
    let frequency = || Axis::frequency(analysis, unit, view.nu_scale);
    match panel {
        Panel::Pcf => (Axis::distance(analysis, view.length_unit, view.r_scale), Axis::g(view.g_scale)),
        Panel::Anisotropy if view.paper => (frequency(), Axis::anisotropy_above(analysis)),
        Panel::Anisotropy => (frequency(), Axis::anisotropy()),
        _ => (frequency(), Axis::p(view.p_scale)),
    }
}

/// The label and value of the bin or ring at a place.
fn sample(panel: Panel, analysis: &Analysis, at: f64) -> Option<(f64, f64)> {
    match panel {
        Panel::Pcf => bin_at(analysis, at).map(|bin| (bin.r, bin.g)),
        Panel::Anisotropy => ring_at(analysis, at).and_then(|ring| Some((ring.nu, ring.anisotropy_db?))),
        _ => ring_at(analysis, at).map(|ring| (ring.nu, ring.p)),
    }
}

/// What a set says at a place, in few words and in many.
fn readout(panel: Panel, analysis: &Analysis, [axis, y]: [Axis; 2], at: f64) -> Option<(String, String)> {
    match panel {
        Panel::Pcf => bin_at(analysis, at).map(|bin| (bin.brief(), bin.text(axis))),
        Panel::Anisotropy => ring_at(analysis, at).map(|ring| (ring.anisotropy_brief(y), ring.text(axis))),
        _ => ring_at(analysis, at).map(|ring| (ring.brief(), ring.text(axis))),
    }
}

/// Where the pointer is along the first axis, for the title: the bin or ring of the selected set, or of one that has one.
pub(super) fn place(panel: Panel, scene: &Scene<'_>) -> Option<String> {
    if !matches!(panel, Panel::Pcf | Panel::Radial | Panel::Anisotropy) {
        return None;
    }
    let at = scene.hover.along(panel)?;
    let selected = scene.sets.get(scene.selected).into_iter();
    selected.chain(scene.sets).filter(|set| set.visible).filter_map(Set::analysis).find_map(|analysis| {
        let label = match panel {
            Panel::Pcf => bin_at(analysis, at)?.r,
            _ => ring_at(analysis, at)?.nu,
        };
        Some(axes(panel, analysis, scene.view).0.text(label))
    })
}

/// What every visible set says, with its colour: its name, or what it is at under the pointer; in few words and in many.
fn said(panel: Panel, scene: &Scene<'_>, x: Axis) -> Vec<(usize, String, String)> {
    let at = scene.hover.along(panel).and_then(|at| x.forward(at));
    let visible: Vec<&Set> = scene.sets.iter().filter(|set| set.visible).collect();
    let alone = visible.len() == 1;
    let of = |set: &&Set| {
        let (name, tint) = (set.name(), set.color);
        let Some(analysis) = set.analysis() else {
            let text = scene.awaited(set).map_or_else(|| name.clone(), |awaited| format!("{name}: {awaited}"));
            return (tint, text.clone(), text);
        };
        let (x, y) = axes(panel, analysis, scene.view);
        match at.and_then(|at| readout(panel, analysis, [x, y], x.backward(at)?)) {
            Some((brief, long)) if alone => (tint, format!("{} = {brief}", y.symbol()), long),
            Some((brief, long)) => (tint, brief, format!("{name}: {long}")),
            None => (tint, name.clone(), format!("{name} ({})", set.request.command())),
        }
    };
    visible.iter().map(of).collect()
}

/// A line of it. Whether a reading had to be cut.
fn legend(ui: &mut egui::Ui, panel: Panel, scene: &Scene<'_>, x: Axis) -> bool {
    let names = scene.sets.iter().filter(|set| set.visible).map(Set::name).collect();
    super::line(ui, said(panel, scene, x), names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinned_curves_keep_their_extremes() {
        let all: Vec<PlotPoint> =
            (0..100_000).map(|i| PlotPoint::new(i, if i == 77_777 { 9.0 } else { f64::from(i % 7) })).collect();
        let seen = Seen { x: 0.0..=1e5, bottom: 0.0, columns: 200 };
        let thin = seen.line(&all);
        let points = thin.points();
        assert!(points.len() <= 804 && points.windows(2).all(|w| w[0].x <= w[1].x), "{}", points.len());
        assert_eq!((points[0], points[points.len() - 1]), (all[0], all[99_999]));
        assert!(points.contains(&all[77_777]) && points.iter().any(|p| p.y == 0.0));
        let band: Vec<[f64; 3]> = all.iter().map(|p| [p.x, p.y - 1.0, p.y + 1.0]).collect();
        let [x, low, high] = seen.band(&band);
        assert!(x.len() <= 402 && low.iter().all(|l| *l == -1.0) && high.contains(&10.0));
        // Of what is seen closely, nothing is left out.
        let near = Seen { x: 500.5..=600.5, ..seen };
        assert_eq!(near.line(&all).points(), &all[500..602]);
        assert_eq!(near.band(&band)[0].len(), 102);
    }
}
