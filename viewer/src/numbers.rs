//! The scalars of all sets, one below the other.

use eframe::egui;
use pairwave::report::panel;

use crate::colors;
use crate::set::Set;

/// Draws them: each with its value of every visible set, in the set's colour.
pub(crate) fn show(ui: &mut egui::Ui, sets: &[Set]) {
    let dark = ui.visuals().dark_mode;
    let shown = sets.iter().filter(|set| set.visible).filter_map(|set| Some((set, panel::scalars(set.analysis()?))));
    let shown: Vec<_> = shown.collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in shown.iter().flat_map(|(_, rows)| rows) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    ui.heading("Numbers");
    ui.horizontal_wrapped(|ui| {
        shown.iter().for_each(|(set, _)| _ = ui.colored_label(colors::set(set.color, dark), set.name()));
    });
    if shown.is_empty() {
        ui.weak("nothing is measured yet");
    }
    ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
    egui::ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
        for name in names {
            ui.add(egui::Label::new(egui::RichText::new(name).strong()).wrap());
            for (set, rows) in &shown {
                let Some((_, value)) = rows.iter().find(|(other, _)| other == name) else { continue };
                let color = colors::set(set.color, dark);
                let value = egui::Label::new(egui::RichText::new(value).color(color)).wrap().selectable(true);
                ui.add(value).on_hover_text(set.name());
            }
            ui.add_space(4.0);
        }
    });
}
