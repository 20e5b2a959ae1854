//! The line at the bottom: what computes, how far it is, and what was spared.

use eframe::egui;
use pairwave::display::Panel;

use crate::actions::{Action, Keyed};
use crate::engine::{Climbed, Snapshot};
use crate::state::State;
use crate::style;

/// Draws the line, of the selected set; `timings`: with the time it took. What is asked for by its buttons.
pub(crate) fn show(ui: &mut egui::Ui, state: &State, timings: bool) -> Vec<Action> {
    let mut actions = Vec::new();
    ui.horizontal(|ui| {
        let text = if state.view.controls { "Hide the controls (B)" } else { "Show the controls (B)" };
        if style::icon(ui, "☰", text).clicked() {
            actions.push(Action::Keyed(Keyed::Controls));
        }
        let (sign, text) = if state.paused { ("▶", "Go on (Space)") } else { ("⏸", "Pause (Space)") };
        if style::icon(ui, sign, text).clicked() {
            actions.push(Action::Keyed(Keyed::Pause));
        }
        let Some(set) = state.selected_set() else { return };
        let Some(snapshot) = &set.snapshot else {
            _ = ui.label(if state.paused { "paused" } else { "opening the device…" });
            return;
        };
        let climb = snapshot.climb.as_ref().filter(|_| state.climbs(set));
        let climbing = state.climbs(set) && !climb.is_some_and(Climbed::is_done);
        let (busy, cancelled) = ((!snapshot.done || climbing) && snapshot.error.is_none(), set.cancelled);
        if busy || cancelled {
            let (sign, text) = if cancelled {
                ("↻", "Go on with this set")
            } else {
                ("⏹", "Cancel this set: what is there stays")
            };
            if style::icon(ui, sign, text).clicked() {
                actions.push(Action::Cancel(set.id, !cancelled));
            }
        }
        // Said where sets are listed, if they are.
        if let Some(error) = snapshot.error.as_ref().filter(|_| !state.view.controls) {
            let text = egui::RichText::new(error).color(ui.visuals().error_fg_color);
            ui.add(egui::Label::new(text).truncate()).on_hover_text(error);
            return;
        }
        let Some(status) = &snapshot.status else {
            ui.add(egui::Label::new(&snapshot.device).truncate()).on_hover_text(&snapshot.device);
            return;
        };
        let before = match (state.paused, cancelled) {
            (_, true) => "cancelled at ",
            (true, _) if busy => "paused at ",
            _ => "",
        };
        let progress = format!("{before}{}", status.progress());
        // As wide as what is written in it.
        let font = egui::TextStyle::Button.resolve(ui.style());
        let written = ui.painter().layout_no_wrap(progress.clone(), font, egui::Color32::WHITE).size().x;
        let width = (written + 2.0 * ui.spacing().item_spacing.x + 8.0).max(120.0);
        let bar = egui::ProgressBar::new(status.fraction() as f32).desired_width(width).text(progress.as_str());
        let bar = ui.add(bar);
        bar.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, &progress));
        warnings(ui, snapshot);
        let hidden = Panel::ALL.iter().filter(|p| !state.view.is_shown(**p)).map(|p| p.name()).collect::<Vec<_>>();
        let skipped = if hidden.is_empty() { String::new() } else { format!("not computed: {}", hidden.join(", ")) };
        let time = if timings { status.time() } else { String::new() };
        let at = climb
            .filter(|_| busy)
            .map_or(String::new(), |climb| format!("against n: {} of {}", climb.progress.0, climb.progress.1));
        let parts = [&at, &snapshot.device, &status.work(), &time, &status.spared(), &skipped];
        let line = parts.into_iter().filter(|p| !p.is_empty()).cloned().collect::<Vec<_>>().join("  ·  ");
        let seconds = |(stage, s): &(&str, f64)| format!("\n{stage}: {:.3} s", s);
        let stages: String = status.timings.iter().map(seconds).collect();
        ui.add(egui::Label::new(&line).truncate()).on_hover_text(format!("{line}{stages}"));
    });
    actions
}

/// What is to be known of the numbers before they are believed: how many there are, and all of them when asked.
fn warnings(ui: &mut egui::Ui, snapshot: &Snapshot) {
    let all = snapshot.analysis.as_ref().map_or(&[][..], |analysis| &analysis.warnings);
    if all.is_empty() {
        return;
    }
    let many = if all.len() == 1 { "1 warning".to_string() } else { format!("{} warnings", all.len()) };
    let text = egui::RichText::new(format!("⚠ {many}")).color(ui.visuals().warn_fg_color);
    let menu = ui.menu_button(text, |ui| {
        ui.set_max_width(420.0);
        all.iter().for_each(|warning| _ = ui.label(warning));
    });
    menu.response.on_hover_text(all.join("\n"));
}
