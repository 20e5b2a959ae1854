//! Keyboard shortcuts and their overlay.

use eframe::egui;

use crate::app::Viewer;

/// Takes the keys of this frame.
pub(crate) fn shortcuts(ctx: &egui::Context, viewer: &mut Viewer) {
    let _ = (ctx, viewer);
}

/// The overlay, and messages.
pub(crate) fn show(ctx: &egui::Context, viewer: &mut Viewer) {
    let _ = (ctx, viewer);
}

impl Viewer {
    /// Files that were dropped on the window.
    pub(crate) fn take_dropped(&mut self, ctx: &egui::Context) {
        let _ = ctx;
    }
}
