//! The line at the bottom: what computes, how far it is, and what was spared.

use eframe::egui;

use crate::app::Viewer;

/// Draws the line.
pub(crate) fn show(ui: &mut egui::Ui, viewer: &mut Viewer) {
    let _ = viewer;
    ui.label("");
}
