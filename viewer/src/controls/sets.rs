//! The sets: up to four, one colour each.

use eframe::egui;

use super::refusal;
use crate::actions::{Action, Keyed};
use crate::files::Choice;
use crate::set::MOST_SETS;
use crate::state::State;
use crate::style::icon;
use crate::{colors, help};

/// Draws the list of sets and what adds to it.
pub(super) fn show(ui: &mut egui::Ui, state: &State, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.heading("Sets");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if icon(ui, "?", "Help: keys and gestures (F1)").clicked() {
                actions.push(Action::Keyed(Keyed::Help));
            }
            session(ui, actions);
        });
    });
    let dark = ui.visuals().dark_mode;
    let alone = state.sets.len() == 1;
    for (index, set) in state.sets.iter().enumerate() {
        let name = set.name();
        ui.horizontal(|ui| {
            let (sign, text) =
                if set.visible { ("●", format!("Hide {name}")) } else { ("○", format!("Show {name}")) };
            let sign = egui::RichText::new(sign).color(colors::set(set.color, dark));
            let shown = ui.add(egui::Button::new(sign).small().frame(false)).on_hover_text(&text);
            shown.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, set.visible, &text));
            if shown.clicked() {
                actions.push(Action::Show(set.id, !set.visible));
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if !alone && icon(ui, "✖", &format!("Remove {name} (Delete)")).clicked() {
                    actions.push(Action::Remove(set.id));
                }
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    let chosen = state.selected == index;
                    let label = egui::Button::selectable(chosen, name.as_str()).truncate();
                    if ui.add(label).on_hover_text(set.request.command()).clicked() {
                        actions.push(Action::Select(set.id));
                    }
                });
            });
        });
        if let Some(error) = set.snapshot.as_ref().and_then(|s| s.error.as_deref()) {
            refusal(ui, error);
        }
    }
    let full = state.sets.len() >= MOST_SETS;
    ui.add_enabled_ui(!full, |ui| {
        ui.horizontal(|ui| {
            ui.menu_button("Add…", |ui| {
                for sampler in pairwave::samplers::registry() {
                    if ui.button(sampler.name).on_hover_text(sampler.summary).clicked() {
                        actions.push(Action::AddSampler(sampler.name));
                    }
                }
            })
            .response
            .on_hover_text("Another set from a sampler, measured like the one selected");
            if ui.button("Open…").on_hover_text("Point files, one batch; or drop them on the window").clicked() {
                actions.push(Action::Choose(Choice::Points));
            }
            if ui.button("Folder…").on_hover_text("All point files of a folder, one batch").clicked() {
                actions.push(Action::Choose(Choice::Folder));
            }
        });
    })
    .response
    .on_disabled_hover_text(format!("There is room for {MOST_SETS} sets: remove one first"));
}

/// The menu of sessions.
fn session(ui: &mut egui::Ui, actions: &mut Vec<Action>) {
    ui.menu_button("Session", |ui| {
        for (text, does, about) in [
            ("Save session…", Keyed::SaveSession, "Sets, view and theme, as JSON; no numbers"),
            ("Open session…", Keyed::OpenSession, "Replaces the sets and the view"),
        ] {
            let button = egui::Button::new(text).shortcut_text(help::keys(ui.ctx(), does));
            if ui.add(button).on_hover_text(about).clicked() {
                actions.push(Action::Keyed(does));
            }
        }
    });
}
