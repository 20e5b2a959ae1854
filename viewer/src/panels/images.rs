//! The 2D spectrum and the vector g: pictures with a colour bar.

use std::collections::HashMap;

use eframe::egui;
use egui_plot::{HLine, Line, PlotImage, PlotPoint, PlotPoints, PlotUi, VLine};
use glam::DVec2;
use pairwave::analysis::Analysis;
use pairwave::display::{
    Attribution, Axis, ColorMap, Frame, FrequencyUnit, Panel, Pixels, ToneMap, overlays, paper, spectrum_at,
    spectrum_pixels, vector_at, vector_pixels, vector_reach, vector_ticks,
};

use super::chart::{Chart, Zoomed};
use super::{Scene, cells, line, planes, said_instead};
use crate::engine::SetId;
use crate::hover::{Hover, Place};
use crate::set::Set;
use crate::view::View;

/// Pictures on the device that draws, kept until what they show changes.
#[derive(Default)]
pub(crate) struct Images {
    kept: HashMap<(Panel, SetId), KeptPicture>,
}

/// A picture of a snapshot.
struct KeptPicture {
    of: Shades,
    texture: egui::TextureHandle,
    extent: [[f64; 2]; 2],
    axes: [usize; 2],
}

/// What the pixels of a picture depend on.
#[derive(Clone, PartialEq)]
struct Shades {
    generation: u64,
    /// Pixels that there is room for, per axis.
    most: usize,
    looks: Looks,
}

#[derive(Clone, PartialEq)]
enum Looks {
    /// What frequencies add to the variance of an integral, with the largest part.
    Variance(String, ColorMap, f64),
    /// With the number of points at the upper end.
    Spectrum(ToneMap, ColorMap, f64),
    /// As papers print it.
    Paper,
    /// With the reach of the colours.
    Vector(ColorMap, f64, usize),
}

impl Shades {
    fn pixels(&self, analysis: &Analysis, attribution: Option<Attribution<'_>>) -> Option<Pixels> {
        match self.looks {
            Looks::Variance(_, colors, largest) => Some(attribution?.pixels(largest, colors, self.most)),
            Looks::Spectrum(tone_map, colors, white) => {
                spectrum_pixels(analysis, tone_map, Some(white), colors, None, self.most)
            }
            Looks::Paper => paper::pixels(analysis, self.most),
            Looks::Vector(colors, reach, plane) => {
                vector_pixels(analysis, Some(reach), colors, plane_of(analysis, plane), self.most)
            }
        }
    }

    /// The colour bar: its ticks, its colours, what they are values of, and what it says of itself.
    fn bar(
        &self,
        analysis: &Analysis,
        attribution: Option<Attribution<'_>>,
    ) -> (Vec<(f64, String)>, ColorMap, &'static str, String) {
        match self.looks {
            Looks::Variance(_, colors, largest) => {
                let text = attribution.map(|map| map.definition()).unwrap_or_default();
                (Attribution::ticks(largest), colors, "|f|²P/v₀", text)
            }
            Looks::Spectrum(tone_map, colors, white) => {
                let name = if matches!(tone_map, ToneMap::Decibel { .. }) { "P / dB" } else { "P" };
                (tone_map.ticks(white), colors, name, format!("colours of P: {}", tone_map.definition()))
            }
            Looks::Paper => {
                let text = format!("colours of P: {}", paper::TONES.definition());
                (paper::TONES.ticks(1.0), paper::COLORS, "P", text)
            }
            Looks::Vector(colors, reach, _) => {
                let text = "colours of g: they part at g = 1, as far as all but a few cells reach".to_string();
                (vector_ticks(analysis, Some(reach)).unwrap_or_default(), colors, "g", text)
            }
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
        let room = ui.available_size().min_elem() * ui.ctx().pixels_per_point();
        let shown = self.prepare(ui.ctx(), panel, scene, if zoomed.is(panel) { f32::INFINITY } else { room });
        let Some(&first) = shown.first() else {
            let measured = scene.sets.iter().filter(|set| set.visible).find_map(Set::analysis);
            return said_instead(ui, scene, measured.map_or("", |analysis| panel.without_picture(analysis)));
        };
        if panel == Panel::Vector {
            planes(ui, scene);
        }
        if !scene.view.side_by_side {
            readout(ui, panel, scene, first);
        }
        let Some(analysis) = scene.sets[first].analysis() else { return };
        let area = ui.available_rect_before_wrap();
        // The colour bar is where it leaves pictures the most room.
        let beside = area.split_left_right_at_x(area.max.x - 62.0);
        let below = area.split_top_bottom_at_y(area.max.y - 36.0);
        let side = |pictures: egui::Rect| (pictures.width() - 30.0).min(pictures.height() - 20.0);
        let (pictures, bar) = if side(beside.0) >= side(below.0) { beside } else { below };
        // Side by side they are looked at together.
        let frames = shown.iter().filter_map(|&s| self.axes(panel, &scene.sets[s], scene.view)).map(|found| found.1);
        let Some(frame) = frames.reduce(Frame::union) else { return };
        for (index, (&of, rect)) in shown.iter().zip(cells(pictures, shown.len(), 14.0)).enumerate() {
            let builder = egui::UiBuilder::new().max_rect(rect).id_salt(index);
            ui.scope_builder(builder, |ui| {
                if scene.view.side_by_side {
                    readout(ui, panel, scene, of);
                }
                self.picture(ui, panel, (index, of), frame, scene, zoomed);
            });
        }
        if let Some(kept) = self.kept.get(&(panel, scene.sets[first].id)) {
            color_bar(ui, bar, kept.of.bar(analysis, scene.sets[first].attribution(scene.view)));
        }
        ui.allocate_rect(area, egui::Sense::hover());
    }

    /// Brings up to date what is kept. The sets whose pictures are shown.
    fn prepare(&mut self, ctx: &egui::Context, panel: Panel, scene: &Scene<'_>, room: f32) -> Vec<usize> {
        let has = |set: &Set| set.analysis().is_some_and(|analysis| panel.has(analysis));
        let of_all = (0..scene.sets.len()).filter(|&s| scene.sets[s].visible && has(&scene.sets[s]));
        let mut shown: Vec<usize> = of_all.collect();
        if !scene.view.side_by_side {
            let chosen = shown.iter().copied().find(|&s| s == scene.selected).or(shown.first().copied());
            shown = chosen.into_iter().collect();
        }
        // One colour bar for all.
        let most_of = |value: fn(&Analysis) -> Option<f64>| {
            shown.iter().filter_map(|&s| scene.sets[s].analysis()).filter_map(value).reduce(f64::max).unwrap_or(1.0)
        };
        let maps = || shown.iter().filter_map(|&s| scene.sets[s].attribution(scene.view));
        let looks = match panel {
            Panel::Spectrum if scene.view.paper => Looks::Paper,
            Panel::Spectrum if maps().next().is_some() => {
                let spec = maps().next().map_or(String::new(), |map| map.spec().to_string());
                let largest = maps().map(|map| map.largest()).fold(0.0, f64::max);
                Looks::Variance(spec, scene.view.spectrum_colors, largest)
            }
            Panel::Spectrum => {
                let white = most_of(|analysis| Some(analysis.shape.mean_points));
                Looks::Spectrum(scene.view.tone_map, scene.view.spectrum_colors, white)
            }
            _ => Looks::Vector(scene.view.vector_colors, most_of(vector_reach), scene.view.plane),
        };
        // In steps, so that a window can be dragged without painting all anew.
        let most = ((room / 128.0).floor().max(1.0) * 128.0).min(ctx.input(|i| i.max_texture_side) as f32) as usize;
        self.kept.retain(|(of, id), _| *of != panel || shown.iter().any(|&s| scene.sets[s].id == *id));
        for &s in &shown {
            let set = &scene.sets[s];
            let (Some(analysis), Some(snapshot)) = (set.analysis(), &set.snapshot) else { continue };
            let of = Shades { generation: snapshot.generation, most, looks: looks.clone() };
            let key = (panel, set.id);
            if self.kept.get(&key).is_some_and(|kept| kept.of == of) {
                continue;
            }
            let Some(pixels) = of.pixels(analysis, set.attribution(scene.view)) else {
                self.kept.remove(&key);
                continue;
            };
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
                    self.kept.insert(key, KeptPicture { of, texture, extent: pixels.extent, axes: pixels.axes });
                }
            }
        }
        shown.retain(|&s| self.kept.contains_key(&(panel, scene.sets[s].id)));
        shown
    }

    /// The axes of a picture, and what it shows.
    fn axes(&self, panel: Panel, set: &Set, view: &View) -> Option<([Axis; 2], Frame)> {
        let (analysis, kept) = (set.analysis()?, self.kept.get(&(panel, set.id))?);
        let axes = match panel {
            Panel::Spectrum => {
                let unit = if view.paper { FrequencyUnit::SqrtN } else { view.frequency_unit };
                kept.axes.map(|axis| Axis::wave(analysis, unit, axis))
            }
            _ => kept.axes.map(|axis| Axis::lag(analysis, view.length_unit, axis)),
        };
        // Both are in one unit.
        let [x, y] = kept.extent.map(|ends| ends.map(|end| axes[0].in_unit(end)));
        Some((axes, Frame { x, y }))
    }

    fn picture(
        &self,
        ui: &mut egui::Ui,
        panel: Panel,
        (index, of): (usize, usize),
        frame: Frame,
        scene: &mut Scene<'_>,
        zoomed: &mut Zoomed,
    ) {
        let set = &scene.sets[of];
        let (Some(analysis), Some(kept)) = (set.analysis(), self.kept.get(&(panel, set.id))) else { return };
        let Some(([x_axis, y_axis], Frame { x, y })) = self.axes(panel, set, scene.view) else { return };
        let axis = x_axis;
        let described = format!(
            "{} of {}, a picture along {} and {}",
            panel.name(),
            set.described(),
            x_axis.label(),
            y_axis.label()
        );
        let chart = Chart {
            panel,
            index,
            x: x_axis,
            y: y_axis,
            frame,
            square: true,
            picture: true,
            described: &described,
            fit: None,
        };
        let ink = ui.visuals().text_color();
        let (texture, hover) = (kept.texture.id(), &*scene.hover);
        let shown = chart.show(ui, zoomed, |plot| {
            let (centre, size) = ([x[0] + x[1], y[0] + y[1]].map(|s| 0.5 * s), [x[1] - x[0], y[1] - y[0]]);
            let image = PlotImage::new("picture", texture, PlotPoint::from(centre), size.map(|s| s as f32));
            plot.image(image.allow_hover(false));
            mark(plot, panel, axis, hover, ink);
        });
        let pointer = shown.pointer().and_then(|at| Some([axis.backward(at.x)?, axis.backward(at.y)?]));
        let place = pointer.and_then(|at| match panel {
            Panel::Spectrum => spectrum_at(analysis, at).map(|mode| Place::Mode(DVec2::new(mode.nu[0], mode.nu[1]))),
            _ => vector_at(analysis, at, plane_of(analysis, scene.view.plane)).map(|lag| Place::Lag(lag.lag.into())),
        });
        if let Some(place) = place {
            scene.hover.at(panel, place);
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
    if let Some(DVec2 { x, y }) = own.map(|at| at.map(|v| axis.in_unit(v))) {
        plot.vline(VLine::new("pointer", x).color(color).width(1.0).allow_hover(false));
        plot.hline(HLine::new("pointer", y).color(color).width(1.0).allow_hover(false));
    }
    if let Some(radius) = radius.map(|r| axis.in_unit(r)) {
        let turn = |k: u32| radius * DVec2::from_angle(f64::from(k) / 128.0 * std::f64::consts::TAU);
        let circle: PlotPoints<'_> = (0..=128).map(|k| turn(k).to_array()).collect();
        plot.line(Line::new("pointer", circle).color(color).width(1.5).allow_hover(false));
    }
}

/// A line with the name of a set, or what it is at under the pointer.
fn readout(ui: &mut egui::Ui, panel: Panel, scene: &Scene<'_>, of: usize) {
    let set = &scene.sets[of];
    let attribution = set.attribution(scene.view).filter(|_| panel == Panel::Spectrum);
    let Some(analysis) = set.analysis() else { return };
    let said = match (panel, scene.hover.place()) {
        (Panel::Spectrum, Some(Place::Mode(nu))) => {
            spectrum_at(analysis, nu.to_array()).map(|mode| attribution.map_or_else(|| mode.text(), |a| a.text(&mode)))
        }
        (Panel::Vector, Some(Place::Lag(lag))) => {
            vector_at(analysis, lag.to_array(), plane_of(analysis, scene.view.plane)).map(|lag| lag.text())
        }
        _ => None,
    };
    let plane = if panel == Panel::Spectrum && analysis.domain.dim() > 2 { ", plane m_z = 0" } else { "" };
    let of_what = attribution.map_or(String::new(), |map| format!(", {}", map.spec()));
    let text = said.unwrap_or_else(|| format!("{}{plane}{of_what}", set.name()));
    line(ui, vec![(set.color, text.clone(), text)], Vec::new());
}

/// The colours with what they stand for.
fn color_bar(
    ui: &egui::Ui,
    rect: egui::Rect,
    (ticks, colors, name, described): (Vec<(f64, String)>, ColorMap, &str, String),
) {
    const STEPS: usize = 64;
    let font = egui::TextStyle::Small.resolve(ui.style());
    let (ink, painter) = (ui.visuals().text_color(), ui.painter());
    let upright = rect.height() > rect.width();
    let bar = if upright {
        let corner = rect.min + egui::vec2(0.0, 18.0);
        egui::Rect::from_min_max(corner, egui::pos2(corner.x + 10.0, rect.max.y - 22.0))
    } else {
        // After what they are.
        let named = painter.layout_no_wrap(name.to_string(), font.clone(), ink).size().x;
        let corner = rect.min + egui::vec2((named + 8.0).max(28.0), 6.0);
        egui::Rect::from_min_max(corner, egui::pos2(rect.max.x - 28.0, corner.y + 10.0))
    };
    if bar.size().max_elem() < 20.0 {
        return;
    }
    let response = ui.interact(rect, ui.scope_id().with("colour bar"), egui::Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &described));
    response.on_hover_text(described.as_str());
    let (corner, align) = match upright {
        true => (rect.min + egui::vec2(0.0, 2.0), egui::Align2::LEFT_TOP),
        false => (bar.left_center() - egui::vec2(6.0, 0.0), egui::Align2::RIGHT_CENTER),
    };
    painter.text(corner, align, name, font.clone(), ink);
    // Where a place is along the bar, and the slice between two.
    let at = |place: f64| match upright {
        true => egui::lerp(bar.max.y..=bar.min.y, place as f32),
        false => egui::lerp(bar.min.x..=bar.max.x, place as f32),
    };
    let slice = |low: f64, high: f64| match upright {
        true => egui::Rect::from_x_y_ranges(bar.x_range(), at(high)..=at(low) + 0.5),
        false => egui::Rect::from_x_y_ranges(at(low)..=at(high) + 0.5, bar.y_range()),
    };
    for step in 0..STEPS {
        let [low, high] = [step, step + 1].map(|k| k as f64 / STEPS as f64);
        let [r, g, b] = colors.color(0.5 * (low + high));
        painter.rect_filled(slice(low, high), 0.0, egui::Color32::from_rgb(r, g, b));
    }
    // The upper end comes first: it has its text in any case.
    let mut taken: Vec<egui::Rect> = Vec::new();
    for (place, text) in ticks.iter().rev() {
        let (end, align, apart) = match upright {
            true => (egui::pos2(bar.max.x, at(*place)), egui::Align2::LEFT_CENTER, egui::vec2(1.0, 0.0)),
            false => (egui::pos2(at(*place), bar.max.y), egui::Align2::CENTER_TOP, egui::vec2(0.0, 1.0)),
        };
        let written = painter.layout_no_wrap(text.clone(), font.clone(), ink);
        let room = align.anchor_size(end + 5.0 * apart, written.size());
        if taken.iter().any(|other| other.expand2(egui::vec2(3.0, 0.0)).intersects(room)) {
            continue;
        }
        painter.line_segment([end, end + 3.0 * apart], egui::Stroke::new(1.0, ink));
        painter.galley(room.min, written, ink);
        taken.push(room);
    }
}
