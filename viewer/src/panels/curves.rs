//! g(r), radial P and anisotropy: a curve per set, with its error band.

use std::collections::HashMap;

use eframe::egui;
use egui_plot::{FilledArea, HLine, Line, LineStyle, PlotPoint, PlotPoints, Points, VLine};
use pairwave::analysis::Analysis;
use pairwave::report::{Axis, Curve, Frame, Panel, bin_at, ring_at};

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
    kept: HashMap<(Panel, SetId), Kept>,
    frames: HashMap<Panel, Frame>,
}

/// The curve of a snapshot along two axes, ready to be drawn.
struct Kept {
    of: (u64, Axis, Axis),
    curve: Curve,
    line: Vec<Vec<PlotPoint>>,
    closed_form: Vec<Vec<PlotPoint>>,
    band: Vec<[Vec<f64>; 3]>,
}

impl Kept {
    fn new(of: (u64, Axis, Axis), curve: Curve) -> Self {
        let points = |pieces: &[Vec<[f64; 2]>]| {
            pieces.iter().map(|piece| piece.iter().map(|p| PlotPoint::from(*p)).collect()).collect()
        };
        let column = |piece: &[[f64; 3]], k: usize| piece.iter().map(|p| p[k]).collect();
        let band = curve.band.iter().map(|piece| [0, 1, 2].map(|k| column(piece, k))).collect();
        Self { of, line: points(&curve.line), closed_form: points(&curve.closed_form), band, curve }
    }
}

impl Curves {
    /// The name of the first axis, for where there is no room for it beside the axis.
    pub(super) fn caption(panel: Panel, scene: &Scene<'_>) -> Option<String> {
        let analysis = scene.sets.iter().filter(|set| set.visible).find_map(Set::analysis)?;
        Some(axes(panel, analysis, scene.view).0.label())
    }

    /// Draws a panel of curves.
    pub(super) fn show(&mut self, ui: &mut egui::Ui, panel: Panel, scene: &mut Scene<'_>, zoomed: &mut Zoomed) {
        let drawn = self.prepare(panel, scene);
        let Some(first) = drawn.first().copied() else {
            said_instead(ui, scene, "these settings give no such curve");
            return;
        };
        let Some(axes) = scene.sets[first].analysis().map(|a| axes(panel, a, scene.view)) else { return };
        legend(ui, panel, scene, &drawn);
        let frames = drawn.iter().filter_map(|&s| self.kept.get(&(panel, scene.sets[s].id))).map(|k| k.curve.frame);
        let Some(wanted) = frames.reduce(Frame::union) else { return };
        let frame = self.frames.get(&panel).map_or(wanted, |frame| frame.kept(wanted));
        self.frames.insert(panel, frame);
        let names: Vec<String> = drawn.iter().map(|&s| scene.sets[s].name()).collect();
        let (x, y) = axes;
        let described = format!("{} of {}, along {}", panel.name(), names.join(", "), x.label());
        let chart = Chart { panel, index: 0, x, y, frame, square: false, picture: false, described: &described };
        self.plot(ui, scene, zoomed, &drawn, chart);
    }

    /// Brings up to date what is kept. The sets that have a curve, the selected one last.
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
                match panel.curve(analysis, x, y) {
                    Some(curve) => _ = self.kept.insert(key, Kept::new(of, curve)),
                    None => _ = self.kept.remove(&key),
                }
            }
            if self.kept.contains_key(&key) {
                drawn.push(index);
            }
        }
        drawn.sort_by_key(|&index| index == scene.selected);
        drawn
    }

    fn plot(
        &mut self,
        ui: &mut egui::Ui,
        scene: &mut Scene<'_>,
        zoomed: &mut Zoomed,
        drawn: &[usize],
        chart: Chart<'_>,
    ) {
        let (panel, x, y, dark) = (chart.panel, chart.x, chart.y, ui.visuals().dark_mode);
        let ink = ui.visuals().text_color();
        let (kept, sets, view, hover, selected) = (&self.kept, scene.sets, &*scene.view, &*scene.hover, scene.selected);
        let shown = chart.show(ui, zoomed, |plot| {
            for &index in drawn {
                let set = &sets[index];
                let Some(kept) = kept.get(&(panel, set.id)) else { continue };
                curve(plot, kept, view, colors::set(set.color, dark), index == selected);
            }
            let Some(at) = hover.along(panel) else { return };
            if let Some(at) = x.forward(at) {
                plot.vline(VLine::new("pointer", at).color(ink.gamma_multiply(0.5)).width(1.0).allow_hover(false));
            }
            for &index in drawn {
                let set = &sets[index];
                let here = set.analysis().and_then(|analysis| place(panel, analysis, at));
                if let Some((at, value)) = here.and_then(|(at, value)| Some((x.forward(at)?, y.forward(value)?))) {
                    let dot = Points::new("value", vec![[at, value]]).radius(3.5).color(colors::set(set.color, dark));
                    plot.points(dot.allow_hover(false));
                }
            }
        });
        if let Some(at) = shown.pointer().and_then(|[at, _]| x.backward(at)) {
            scene.hover.at(panel, if panel == Panel::Pcf { Place::Distance(at) } else { Place::Frequency(at) });
        }
    }
}

/// A curve with what belongs to it.
fn curve<'a>(plot: &mut egui_plot::PlotUi<'a>, kept: &'a Kept, view: &View, color: egui::Color32, selected: bool) {
    let reference = kept.curve.reference;
    if let Some(reference) = reference {
        let line = HLine::new("reference", reference).color(egui::Color32::GRAY.gamma_multiply(0.7)).width(1.0);
        plot.hline(line.style(LineStyle::dotted_dense()).allow_hover(false));
    }
    for [xs, low, high] in kept.band.iter().filter(|_| view.bands) {
        let area = FilledArea::new("band", xs, low, high).fill_color(color.gamma_multiply(0.22));
        plot.add(area.allow_hover(false));
    }
    let closed = kept.closed_form.iter().filter(|_| view.closed_forms);
    for piece in closed {
        let line = Line::new("closed form", PlotPoints::Borrowed(piece)).color(color.gamma_multiply(0.75)).width(1.2);
        plot.line(line.style(LineStyle::dashed_dense()).allow_hover(false));
    }
    for piece in &kept.line {
        let width = if selected { 2.0 } else { 1.4 };
        plot.line(Line::new("estimate", PlotPoints::Borrowed(piece)).color(color).width(width).allow_hover(false));
    }
}

/// Along which axes an analysis is drawn.
fn axes(panel: Panel, analysis: &Analysis, view: &View) -> (Axis, Axis) {
    let frequency = || Axis::frequency(analysis, view.frequency_unit, view.nu_scale);
    match panel {
        Panel::Pcf => (Axis::distance(analysis, view.length_unit, view.r_scale), Axis::g(view.g_scale)),
        Panel::Anisotropy => (frequency(), Axis::anisotropy()),
        _ => (frequency(), Axis::p(view.p_scale)),
    }
}

/// The label and value of the bin or ring at a place.
fn place(panel: Panel, analysis: &Analysis, at: f64) -> Option<(f64, f64)> {
    match panel {
        Panel::Pcf => bin_at(analysis, at).map(|bin| (bin.r, bin.g)),
        Panel::Anisotropy => ring_at(analysis, at).and_then(|ring| Some((ring.nu, ring.anisotropy_db?))),
        _ => ring_at(analysis, at).map(|ring| (ring.nu, ring.p)),
    }
}

/// What a set says at a place, in few words and in many.
fn readout(panel: Panel, analysis: &Analysis, axis: Axis, at: f64) -> Option<(String, String)> {
    match panel {
        Panel::Pcf => bin_at(analysis, at).map(|bin| (bin.brief(axis), bin.text(axis))),
        Panel::Anisotropy => ring_at(analysis, at).map(|ring| (ring.anisotropy_text(axis), ring.text(axis))),
        _ => ring_at(analysis, at).map(|ring| (ring.brief(axis), ring.text(axis))),
    }
}

/// A line with the name of every set, or what it is at under the pointer.
fn legend(ui: &mut egui::Ui, panel: Panel, scene: &Scene<'_>, drawn: &[usize]) {
    let mut sets: Vec<&Set> = drawn.iter().map(|&index| &scene.sets[index]).collect();
    sets.sort_by_key(|set| set.id);
    let at = scene.hover.along(panel);
    let texts = sets.into_iter().filter_map(|set| {
        let analysis = set.analysis()?;
        let axis = axes(panel, analysis, scene.view).0;
        let said = at.and_then(|at| readout(panel, analysis, axis, at));
        let (brief, long) = said.unwrap_or_else(|| (set.name(), format!("{} ({})", set.name(), set.request.command())));
        Some((set.color, brief, long))
    });
    super::colored_line(ui, texts.collect());
}
