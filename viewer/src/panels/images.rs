//! The 2D spectrum and the vector g: pictures with a colour bar.

use eframe::egui;
use pairwave::report::Panel;

use super::Scene;

/// Pictures on the device that draws, kept until what they show changes.
#[derive(Default)]
pub(crate) struct Images {}

impl Images {
    /// Draws a picture.
    pub(super) fn show(&mut self, ui: &mut egui::Ui, panel: Panel, scene: &mut Scene<'_>) {
        let _ = (panel, scene);
        ui.label("");
    }
}
