//! The panels, in a grid that suits the window.

mod chart;
mod curves;
mod images;
mod integrals;
mod points;

use eframe::egui;
use pairwave::display::{Panel, overlays};

use crate::actions::Action;
use crate::export::{self, Exports};
use crate::hover::Hover;
use crate::set::Set;
use crate::view::View;
use crate::{colors, style};

/// What panels draw from, and what they may change.
pub(crate) struct Scene<'a> {
    pub(crate) sets: &'a [Set],
    /// The set whose pictures are shown.
    pub(crate) selected: usize,
    pub(crate) view: &'a View,
    pub(crate) hover: &'a mut Hover,
    pub(crate) exports: &'a mut Exports,
    pub(crate) paused: bool,
    /// Without buttons: a picture to take away.
    pub(crate) plain: bool,
    /// What is asked for by their buttons.
    pub(crate) actions: &'a mut Vec<Action>,
}

impl Scene<'_> {
    /// Why the first realization of a set is not there, if it is not.
    fn awaited(&self, set: &Set) -> Option<&'static str> {
        // Groups of sums come in one after the other.
        let first = |set: &Set| set.snapshot.as_ref()?.status.as_ref()?.tracks.iter().map(|track| track.done).min();
        if set.analysis().is_some() && first(set) != Some(0) {
            return None;
        }
        Some(match (set.cancelled, self.paused) {
            (true, _) => "cancelled",
            (_, true) => "paused",
            // Why is said where sets are listed, once.
            _ if set.snapshot.as_ref().is_some_and(|s| s.error.is_some()) => "not measured",
            _ => "measuring…",
        })
    }

    /// Whether one of the sets could have something to draw in a panel, as far as that is known.
    fn applies(&self, panel: Panel) -> bool {
        let mut sets = self.sets.iter().filter(|set| set.visible).peekable();
        if panel == Panel::Integration {
            return sets.any(|set| !set.request.integrand.is_empty());
        }
        sets.peek().is_none() || sets.any(|set| set.analysis().is_none_or(|analysis| panel.applies(analysis)))
    }
}

/// What panels keep between frames.
#[derive(Default)]
pub(crate) struct Panels {
    zoomed: chart::Zoomed,
    curves: curves::Curves,
    images: images::Images,
    points: points::Cloud,
}

impl Panels {
    /// All that are wanted, or the one that fills the window.
    pub(crate) fn show(&mut self, ui: &mut egui::Ui, scene: &mut Scene<'_>) {
        let shown: Vec<Panel> = match scene.view.maximized {
            Some(one) => vec![one],
            // Those that nothing could be drawn in leave their room to the others.
            None => Panel::ALL.into_iter().filter(|p| scene.view.panels.contains(p) && scene.applies(*p)).collect(),
        };
        if shown.is_empty() {
            let text = match scene.view.panels.as_slice() {
                [] => "No panel is shown: choose some under Panels.",
                _ => "None of the panels chosen suits these points: choose others under Panels.",
            };
            centered(ui, text, ui.visuals().text_color());
            return;
        }
        let area = ui.available_rect_before_wrap();
        let columns = columns(shown.len(), area.size());
        let rows = shown.len().div_ceil(columns);
        let gap = 6.0;
        let height = (area.height() - gap * (rows as f32 - 1.0)) / rows as f32;
        for (row, panels) in shown.chunks(columns).enumerate() {
            // The last row may hold fewer: they are wider.
            let width = (area.width() - gap * (panels.len() as f32 - 1.0)) / panels.len() as f32;
            for (column, &panel) in panels.iter().enumerate() {
                let corner = area.min + egui::vec2(column as f32 * (width + gap), row as f32 * (height + gap));
                let rect = egui::Rect::from_min_size(corner, egui::vec2(width, height));
                let builder = egui::UiBuilder::new().max_rect(rect).id_salt(panel.slug());
                ui.scope_builder(builder, |ui| self.frame(ui, panel, scene));
            }
        }
        ui.allocate_rect(area, egui::Sense::hover());
    }

    /// One panel as it is seen, without its buttons: in another context, for another device.
    pub(crate) fn picture(&self) -> Self {
        Self { zoomed: self.zoomed.clone(), ..Self::default() }
    }

    /// Shows all of every panel again.
    pub(crate) fn reset(&mut self) {
        Panel::ALL.iter().for_each(|panel| self.zoomed.reset(*panel));
    }

    /// A panel with its title and its buttons.
    pub(crate) fn frame(&mut self, ui: &mut egui::Ui, panel: Panel, scene: &mut Scene<'_>) {
        let drawn = egui::Frame::group(ui.style()).inner_margin(4).show(ui, |ui| {
            ui.set_min_size(ui.available_size());
            ui.horizontal(|ui| {
                let title =
                    ui.add(egui::Label::new(egui::RichText::new(panel.name()).strong()).sense(egui::Sense::click()));
                if scene.plain {
                    return;
                }
                if panel == Panel::Points {
                    ui.scope(|ui| points::realizations(ui, scene));
                }
                let full = scene.view.maximized == Some(panel);
                let mut toggled = title.on_hover_text(panel.definition()).double_clicked();
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    let (sign, text) = match full {
                        true => ("🗗", "Show all panels again (Escape)".to_string()),
                        false => ("🗖", format!("Fill the window with {} (double click on the title)", panel.name())),
                    };
                    toggled |= style::icon(ui, sign, &text).clicked();
                    if let Some(set) = scene.sets.get(scene.selected) {
                        let take = export::menu(ui, panel, set, scene.sets.len(), scene.exports.can_enlarge);
                        scene.actions.extend(take.map(|take| Action::Take(panel, take)));
                    }
                    if self.zoomed.is(panel) && style::icon(ui, "⟲", "Show all (double click, R)").clicked() {
                        self.zoomed.reset(panel);
                    }
                    if let Some(place) = curves::place(panel, scene) {
                        let label = egui::Label::new(egui::RichText::new(place).small().weak()).truncate();
                        let left = egui::Layout::left_to_right(egui::Align::Center);
                        ui.with_layout(left, |ui| ui.add(label));
                    }
                });
                if toggled {
                    scene.actions.push(Action::Maximize(if full { None } else { Some(panel) }));
                }
            });
            match panel {
                Panel::Points => self.points.show(ui, scene, &mut self.zoomed),
                Panel::Pcf | Panel::Radial | Panel::Anisotropy => self.curves.show(ui, panel, scene, &mut self.zoomed),
                Panel::Spectrum | Panel::Vector => self.images.show(ui, panel, scene, &mut self.zoomed),
                Panel::Integration => integrals::show(ui, scene, &mut self.zoomed),
            }
        });
        scene.exports.at(panel, drawn.response.rect);
    }
}

/// How many columns make panels closest to square.
fn columns(panels: usize, size: egui::Vec2) -> usize {
    let shape = |columns: usize| {
        let rows = panels.div_ceil(columns);
        let ratio = (size.x / columns as f32) / (size.y / rows as f32);
        ratio.ln().abs()
    };
    (1..=panels).min_by(|&a, &b| shape(a).total_cmp(&shape(b))).unwrap_or(1)
}

/// Rectangles for several charts, `gap` apart, as square as can be.
fn cells(area: egui::Rect, count: usize, gap: f32) -> Vec<egui::Rect> {
    let columns = columns(count.max(1), area.size());
    let rows = count.max(1).div_ceil(columns);
    let size = egui::vec2(area.width() / columns as f32, area.height() / rows as f32);
    let corner = |k: usize| area.min + egui::vec2((k % columns) as f32 * size.x, (k / columns) as f32 * size.y);
    (0..count).map(|k| egui::Rect::from_min_size(corner(k), size - egui::vec2(gap, 0.0))).collect()
}

/// Texts of sets in their colours, (colour, text, all of it), in a line or, where their `names` would not fit, in several: places
/// do not depend on what is said. Whether a text had to be cut.
fn line(ui: &mut egui::Ui, texts: Vec<(usize, String, String)>, names: Vec<String>) -> bool {
    let (dark, height) = (ui.visuals().dark_mode, ui.spacing().interact_size.y);
    let font = egui::TextStyle::Small.resolve(ui.style());
    let painter = ui.painter().clone();
    let width_of = |text: &str| {
        let galley = painter.layout_no_wrap(text.to_string(), font.clone(), egui::Color32::WHITE);
        galley.size().x + 6.0
    };
    let all = ui.available_width();
    let widest = names.iter().map(|name| width_of(name)).fold(1.0, f32::max);
    let columns = ((all / widest) as usize).clamp(1, texts.len().max(1));
    // The only one has all the room; several stand close together.
    let width = if columns > 1 { (all / columns as f32).min(widest.max(170.0)) } else { all };
    let rows = texts.len().div_ceil(columns).max(1);
    let (area, _) = ui.allocate_exact_size(egui::vec2(all, height * rows as f32), egui::Sense::hover());
    let cuts: Vec<bool> = texts.iter().map(|(_, text, _)| width_of(text) > width).collect();
    for (index, (color, text, long)) in texts.into_iter().enumerate() {
        let place = egui::vec2((index % columns) as f32 * width, (index / columns) as f32 * height);
        let rect = egui::Rect::from_min_size(area.min + place, egui::vec2(width - 6.0, height));
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        let text = egui::RichText::new(text).small().color(colors::set(color, dark));
        let label = egui::Label::new(text).truncate();
        ui.scope_builder(egui::UiBuilder::new().max_rect(rect).layout(layout), |ui| ui.add(label).on_hover_text(long));
    }
    cuts.contains(&true)
}

/// Why there is nothing to draw: what the sets that are visible say, or `otherwise`.
fn said_instead(ui: &mut egui::Ui, scene: &Scene<'_>, otherwise: &str) {
    let mut sets = scene.sets.iter().filter(|set| set.visible).peekable();
    let nothing_visible = sets.peek().is_none();
    let text = match sets.find_map(|set| scene.awaited(set)) {
        _ if nothing_visible => "all sets are hidden",
        Some(awaited) => awaited,
        None => otherwise,
    };
    centered(ui, text, ui.visuals().weak_text_color());
}

/// A text in the middle of what room there is, its lines centred.
fn centered(ui: &mut egui::Ui, text: &str, color: egui::Color32) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let mut job = egui::text::LayoutJob::simple(text.to_string(), font, color, ui.available_width());
    job.halign = egui::Align::Center;
    let galley = ui.fonts_mut(|fonts| fonts.layout_job(job));
    ui.centered_and_justified(|ui| ui.add(egui::Label::new(galley)));
}

/// In 3D, the planes to look at: a choice of them.
fn planes(ui: &mut egui::Ui, scene: &mut Scene<'_>) {
    let dims = scene.sets.iter().filter(|set| set.visible).filter_map(|set| set.analysis()).map(|a| a.domain.dim());
    let all = overlays::planes(dims.max().unwrap_or(2));
    if all.len() < 2 {
        return;
    }
    ui.horizontal(|ui| {
        for (index, plane) in all.iter().enumerate() {
            let name: String = plane.iter().map(|axis| ["x", "y", "z"][*axis]).collect();
            let help = format!("Look at {name}");
            if ui.selectable_label(scene.view.plane == index, name).on_hover_text(help).clicked() {
                scene.actions.push(Action::Plane(index));
            }
        }
    });
}
