//! The points of the first realization.

use eframe::egui;

use super::Scene;

/// What is drawn over points, kept until the points change.
#[derive(Default)]
pub(crate) struct Points {}

impl Points {
    /// Draws the points.
    pub(super) fn show(&mut self, ui: &mut egui::Ui, scene: &mut Scene<'_>) {
        let _ = scene;
        ui.label("");
    }
}
