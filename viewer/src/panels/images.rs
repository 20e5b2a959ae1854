//! The 2D spectrum and the vector g: pictures with a colour bar.

use std::collections::HashMap;

use eframe::egui;
use egui_plot::{HLine, Line, PlotImage, PlotPoint, PlotPoints, PlotUi, VLine};
use pairwave::analysis::Analysis;
use pairwave::report::{
    Axis, ColorMap, Frame, Panel, Pixels, overlays, spectrum_at, spectrum_pixels, vector_at, vector_pixels,
    vector_reach, vector_ticks,
};

use super::chart::{Chart, Zoomed};
use super::{Scene, colored_line, planes, said_instead};
use crate::engine::SetId;
use crate::hover::{Hover, Place};
use crate::set::Set;
use crate::view::View;

/// Pictures on the device that draws, kept until what they show changes.
#[derive(Default)]
pub(crate) struct Images {
    kept: HashMap<(Panel, SetId), Kept>,
}

/// A picture of a snapshot.
struct Kept {
    of: Shades,
    texture: egui::TextureHandle,
    extent: [[f64; 2]; 2],
    axes: [usize; 2],
}

/// What the pixels of a picture depend on: the snapshot, and the looks.
#[derive(Clone, PartialEq)]
struct Shades {
    generation: u64,
    view: View,
    reach: Option<f64>,
}

impl Shades {
    /// Without the looks that no pixel depends on.
    fn new(generation: u64, view: &View, reach: Option<f64>) -> Self {
        let of_pixels = View {
            tone_map: view.tone_map,
            spectrum_colors: view.spectrum_colors,
            vector_colors: view.vector_colors,
            plane: view.plane,
            ..View::default()
        };
        Self { generation, view: of_pixels, reach }
    }

    fn pixels(&self, panel: Panel, analysis: &Analysis) -> Option<Pixels> {
        let View { tone_map, spectrum_colors, vector_colors, plane, .. } = self.view;
        match panel {
            Panel::Spectrum => spectrum_pixels(analysis, tone_map, spectrum_colors),
            _ => vector_pixels(analysis, self.reach, vector_colors, plane_of(analysis, plane)),
        }
    }
}

/// The plane that is looked at, of those there are.
fn plane_of(analysis: &Analysis, plane: usize) -> usize {
    plane.min(overlays::planes(analysis.domain.dim()).len() - 1)
}

impl Images {
    /// Draws a picture, or one of every set.
    pub(super) fn show(&mut self, ui: &mut egui::Ui, panel: Panel, scene: &mut Scene<'_>, zoomed: &mut Zoomed) {
        let shown = self.prepare(ui.ctx(), panel, scene);
        let Some(&first) = shown.first() else {
            let none = "of points in 2D and 3D there is a picture; not of a list of wave vectors";
            return said_instead(ui, scene, none);
        };
        if panel == Panel::Vector {
            planes(ui, scene);
        }
        readouts(ui, panel, scene, &shown);
        let Some(analysis) = scene.sets[first].analysis() else { return };
        let bar = 52.0;
        let area = ui.available_rect_before_wrap();
        let width = (area.width() - bar) / shown.len() as f32;
        for (index, &of) in shown.iter().enumerate() {
            let corner = area.min + egui::vec2(width * index as f32, 0.0);
            let rect = egui::Rect::from_min_size(corner, egui::vec2(width - 14.0, area.height()));
            let builder = egui::UiBuilder::new().max_rect(rect).id_salt(index);
            ui.scope_builder(builder, |ui| self.picture(ui, panel, index, of, scene, zoomed));
        }
        let (ticks, colors, name) = match panel {
            Panel::Spectrum => {
                let ticks = scene.view.tone_map.ticks(analysis.shape.mean_points);
                (ticks, scene.view.spectrum_colors, "P")
            }
            _ => {
                let reach = self.kept.get(&(panel, scene.sets[first].id)).and_then(|kept| kept.of.reach);
                (vector_ticks(analysis, reach).unwrap_or_default(), scene.view.vector_colors, "g")
            }
        };
        let rect = egui::Rect::from_min_max(egui::pos2(area.max.x - bar, area.min.y), area.max);
        color_bar(ui, rect, colors, &ticks, name);
        ui.allocate_rect(area, egui::Sense::hover());
    }

    /// Brings up to date what is kept. The sets whose pictures are shown.
    fn prepare(&mut self, ctx: &egui::Context, panel: Panel, scene: &Scene<'_>) -> Vec<usize> {
        let has = |set: &Set| match (panel, set.analysis()) {
            (_, None) => false,
            (Panel::Spectrum, Some(a)) => a.grid_wanted && a.domain.dim() > 1 && a.spectrum.is_some(),
            (_, Some(a)) => a.vector.is_some() && a.domain.dim() > 1,
        };
        let of_all = (0..scene.sets.len()).filter(|&s| scene.sets[s].visible && has(&scene.sets[s]));
        let mut shown: Vec<usize> = of_all.collect();
        if !scene.view.side_by_side {
            let chosen = shown.iter().copied().find(|&s| s == scene.selected).or(shown.first().copied());
            shown = chosen.into_iter().collect();
        }
        // One colour bar for all.
        let reaches = shown.iter().filter_map(|&s| scene.sets[s].analysis()).filter_map(vector_reach);
        let reach = reaches.reduce(f64::max).filter(|_| panel == Panel::Vector);
        self.kept.retain(|(of, id), _| *of != panel || shown.iter().any(|&s| scene.sets[s].id == *id));
        for &s in &shown {
            let set = &scene.sets[s];
            let (Some(analysis), Some(snapshot)) = (set.analysis(), &set.snapshot) else { continue };
            let of = Shades::new(snapshot.generation, scene.view, reach);
            let key = (panel, set.id);
            if self.kept.get(&key).is_some_and(|kept| kept.of == of) {
                continue;
            }
            let Some(pixels) = of.pixels(panel, analysis) else { continue };
            let image = egui::ColorImage::from_rgb([pixels.width, pixels.height], &pixels.rgb);
            let options =
                egui::TextureOptions { magnification: egui::TextureFilter::Nearest, ..egui::TextureOptions::LINEAR };
            match self.kept.get_mut(&key) {
                Some(kept) => {
                    kept.texture.set(image, options);
                    (kept.of, kept.extent, kept.axes) = (of, pixels.extent, pixels.axes);
                }
                None => {
                    let texture = ctx.load_texture(panel.slug(), image, options);
                    self.kept.insert(key, Kept { of, texture, extent: pixels.extent, axes: pixels.axes });
                }
            }
        }
        shown.retain(|&s| self.kept.contains_key(&(panel, scene.sets[s].id)));
        shown
    }

    fn picture(
        &self,
        ui: &mut egui::Ui,
        panel: Panel,
        index: usize,
        of: usize,
        scene: &mut Scene<'_>,
        zoomed: &mut Zoomed,
    ) {
        let set = &scene.sets[of];
        let (Some(analysis), Some(kept)) = (set.analysis(), self.kept.get(&(panel, set.id))) else { return };
        let [x_axis, y_axis] = match panel {
            Panel::Spectrum => kept.axes.map(|axis| Axis::wave(analysis, scene.view.frequency_unit, axis)),
            _ => kept.axes.map(|axis| Axis::lag(analysis, scene.view.length_unit, axis)),
        };
        // Both are in one unit.
        let axis = x_axis;
        let [x, y] = kept.extent.map(|ends| ends.map(|end| axis.in_unit(end)));
        let frame = Frame { x, y };
        let described =
            format!("{} of {}, a picture along {} and {}", panel.name(), set.name(), x_axis.label(), y_axis.label());
        let chart =
            Chart { panel, index, x: x_axis, y: y_axis, frame, square: true, picture: true, described: &described };
        let ink = ui.visuals().text_color();
        let (texture, hover) = (kept.texture.id(), &*scene.hover);
        let shown = chart.show(ui, zoomed, |plot| {
            let (centre, size) = ([x[0] + x[1], y[0] + y[1]].map(|s| 0.5 * s), [x[1] - x[0], y[1] - y[0]]);
            let image = PlotImage::new("picture", texture, PlotPoint::from(centre), size.map(|s| s as f32));
            plot.image(image.allow_hover(false));
            mark(plot, panel, axis, hover, ink);
        });
        if let Some([x, y]) = shown.pointer()
            && let (Some(x), Some(y)) = (axis.backward(x), axis.backward(y))
        {
            scene.hover.at(panel, if panel == Panel::Spectrum { Place::Mode([x, y]) } else { Place::Lag([x, y]) });
        }
    }
}

/// Marks the place under the pointer: with a cross if it is one of this panel, else with the circle it is on.
fn mark(plot: &mut PlotUi<'_>, panel: Panel, axis: Axis, hover: &Hover, ink: egui::Color32) {
    let color = ink.gamma_multiply(0.6);
    let (own, radius) = match (panel, hover.place()) {
        (Panel::Spectrum, Some(Place::Mode(at))) | (Panel::Vector, Some(Place::Lag(at))) => (Some(at), None),
        (Panel::Spectrum, _) => (None, hover.frequency()),
        _ => (None, hover.distance()),
    };
    if let Some([x, y]) = own.map(|at| at.map(|v| axis.in_unit(v))) {
        plot.vline(VLine::new("pointer", x).color(color).width(1.0).allow_hover(false));
        plot.hline(HLine::new("pointer", y).color(color).width(1.0).allow_hover(false));
    }
    if let Some(radius) = radius.map(|r| axis.in_unit(r)) {
        let turn = |k: u32| (f64::from(k) / 128.0 * std::f64::consts::TAU).sin_cos();
        let circle: Vec<[f64; 2]> = (0..=128).map(turn).map(|(sin, cos)| [radius * cos, radius * sin]).collect();
        plot.line(Line::new("pointer", PlotPoints::from(circle)).color(color).width(1.5).allow_hover(false));
    }
}

/// A line with the names of the sets shown, or what they are at under the pointer.
fn readouts(ui: &mut egui::Ui, panel: Panel, scene: &Scene<'_>, shown: &[usize]) {
    let texts = shown.iter().filter_map(|&s| {
        let set = &scene.sets[s];
        let analysis = set.analysis()?;
        let said = match (panel, scene.hover.place()) {
            (Panel::Spectrum, Some(Place::Mode(nu))) => spectrum_at(analysis, nu).map(|mode| mode.text()),
            (Panel::Vector, Some(Place::Lag(lag))) => {
                vector_at(analysis, lag, plane_of(analysis, scene.view.plane)).map(|lag| lag.text())
            }
            _ => None,
        };
        let text = said.unwrap_or_else(|| set.name());
        Some((set.color, text.clone(), text))
    });
    colored_line(ui, texts.collect());
}

/// The colours with what they stand for.
fn color_bar(ui: &egui::Ui, rect: egui::Rect, colors: ColorMap, ticks: &[(f64, String)], name: &str) {
    const STEPS: usize = 64;
    let font = egui::TextStyle::Small.resolve(ui.style());
    let (ink, painter) = (ui.visuals().text_color(), ui.painter());
    let bar =
        egui::Rect::from_min_max(rect.min + egui::vec2(0.0, 18.0), egui::pos2(rect.min.x + 10.0, rect.max.y - 22.0));
    if bar.height() < 20.0 {
        return;
    }
    painter.text(rect.min + egui::vec2(0.0, 2.0), egui::Align2::LEFT_TOP, name, font.clone(), ink);
    let at = |place: f64| bar.max.y - bar.height() * place as f32;
    for step in 0..STEPS {
        let [low, high] = [step, step + 1].map(|k| k as f64 / STEPS as f64);
        let [r, g, b] = colors.color(0.5 * (low + high));
        let slice = egui::Rect::from_min_max(egui::pos2(bar.min.x, at(high)), egui::pos2(bar.max.x, at(low) + 0.5));
        painter.rect_filled(slice, 0.0, egui::Color32::from_rgb(r, g, b));
    }
    let mut free = f32::INFINITY;
    for (place, text) in ticks {
        let y = at(*place);
        if y > free {
            continue;
        }
        free = y - 13.0;
        painter.line_segment([egui::pos2(bar.max.x, y), egui::pos2(bar.max.x + 3.0, y)], egui::Stroke::new(1.0, ink));
        painter.text(egui::pos2(bar.max.x + 5.0, y), egui::Align2::LEFT_CENTER, text, font.clone(), ink);
    }
}
