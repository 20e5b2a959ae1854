//! The sets: up to four, one colour each.

use eframe::egui;
use pairwave::request::Request;

use super::{icon, of_sampler, refusal};
use crate::app::Viewer;
use crate::colors;
use crate::files::Choice;
use crate::set::MOST_SETS;

/// Draws the list of sets and what adds to it.
pub(super) fn show(ui: &mut egui::Ui, viewer: &mut Viewer) {
    ui.horizontal(|ui| {
        ui.heading("Sets");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if icon(ui, "?", "Help: keys and gestures (F1)").clicked() {
                viewer.help = !viewer.help;
            }
            crate::session::menu(ui, viewer);
        });
    });
    let dark = ui.visuals().dark_mode;
    let mut removed = None;
    for index in 0..viewer.sets.len() {
        let alone = viewer.sets.len() == 1;
        let set = &mut viewer.sets[index];
        let name = set.name();
        ui.horizontal(|ui| {
            let (sign, text) =
                if set.visible { ("●", format!("Hide {name}")) } else { ("○", format!("Show {name}")) };
            let sign = egui::RichText::new(sign).color(colors::set(set.color, dark));
            let shown = ui.add(egui::Button::new(sign).small().frame(false)).on_hover_text(&text);
            shown.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, set.visible, &text));
            if shown.clicked() {
                set.visible = !set.visible;
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if !alone && icon(ui, "✖", &format!("Remove {name} (Delete)")).clicked() {
                    removed = Some(index);
                }
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    let chosen = viewer.selected == index;
                    let label = egui::Button::selectable(chosen, name.as_str()).truncate();
                    if ui.add(label).on_hover_text(set.request.command()).clicked() {
                        viewer.selected = index;
                    }
                });
            });
        });
        if let Some(error) = set.snapshot.as_ref().and_then(|s| s.error.as_deref()) {
            refusal(ui, error);
        }
    }
    if let Some(index) = removed {
        viewer.remove(index);
    }
    let full = viewer.sets.len() >= MOST_SETS;
    ui.add_enabled_ui(!full, |ui| {
        ui.horizontal(|ui| {
            ui.menu_button("Add…", |ui| {
                for sampler in pairwave::samplers::registry() {
                    if ui.button(sampler.name()).on_hover_text(sampler.summary()).clicked() {
                        viewer.add_sampler(sampler.name());
                    }
                }
            })
            .response
            .on_hover_text("Another set from a sampler, measured like the one selected");
            if ui.button("Open…").on_hover_text("Point files, one batch; or drop them on the window").clicked() {
                viewer.files.choose(Choice::Points);
            }
            if ui.button("Folder…").on_hover_text("All point files of a folder, one batch").clicked() {
                viewer.files.choose(Choice::Folder);
            }
        });
    })
    .response
    .on_disabled_hover_text(format!("There is room for {MOST_SETS} sets: remove one first"));
}

impl Viewer {
    /// Adds a set of a sampler, measured like the one that is selected.
    pub(crate) fn add_sampler(&mut self, name: &str) {
        let like = self.sets.get(self.selected).map_or_else(Self::first_request, |set| set.request.clone());
        let request: Request = of_sampler(&like, name);
        self.add(super::points::fitting(request));
    }
}
