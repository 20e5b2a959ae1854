//! What a person sets: the points, what is measured, how it is shown.

use eframe::egui;

use crate::app::Viewer;

/// What controls keep between frames: text that is being typed.
#[derive(Default)]
pub(crate) struct Controls {}

/// Draws the controls.
pub(crate) fn show(ui: &mut egui::Ui, viewer: &mut Viewer) {
    ui.horizontal(|ui| {
        ui.heading("pairwave");
        crate::session::menu(ui, viewer);
    });
}

/// A small button that shows a sign and says in words what it does.
pub(crate) fn icon(ui: &mut egui::Ui, sign: &str, text: &str) -> egui::Response {
    let response = ui.small_button(sign).on_hover_text(text);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, text));
    response
}
