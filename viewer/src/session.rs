//! A session as text: every set by its command, and the view.

use crate::app::Viewer;

/// The session as text.
pub(crate) fn write(viewer: &Viewer) -> String {
    let _ = viewer;
    String::new()
}

/// Takes a session; after an error nothing has changed.
pub(crate) fn read(viewer: &mut Viewer, text: &str) -> Result<(), String> {
    let _ = (viewer, text);
    Ok(())
}

/// The menu.
pub(crate) fn menu(_: &mut eframe::egui::Ui, _: &mut Viewer) {}
