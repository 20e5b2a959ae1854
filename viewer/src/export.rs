//! What is taken away: a panel as PNG, SVG, CSV or NPY, the equivalent command to the clipboard.

use eframe::egui;
use pairwave::report::Panel;

use crate::app::Viewer;

/// Exports asked for in this frame.
#[derive(Default)]
pub(crate) struct Exports {}

impl Exports {
    /// The menu of a panel.
    pub(crate) fn menu(&mut self, ui: &mut egui::Ui, panel: Panel) {
        let _ = (ui, panel);
    }
}

impl Viewer {
    /// Writes what was asked for.
    pub(crate) fn carry_out_exports(&mut self, ctx: &egui::Context) {
        let _ = ctx;
    }
}
