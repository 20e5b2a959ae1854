//! What is measured of the selected set, and by what.

use eframe::egui;

use super::setting;
use crate::app::Viewer;

/// Settings of requests with their titles, in groups that fold.
pub(super) const GROUPS: [(&str, &[(&str, &str)]); 5] = [
    (
        "Distances",
        &[
            ("r_max", "largest r"),
            ("bins", "bins"),
            ("bin_scale", "spacing"),
            ("edges", "edges from file"),
            ("correction", "correction"),
            ("normalization", "divide by"),
            ("beyond_half", "beyond half the torus"),
        ],
    ),
    (
        "Frequencies",
        &[
            ("max_frequency", "largest ν"),
            ("frequencies", "list from file"),
            ("ring_directions", "directions"),
            ("convention", "convention"),
            ("bug_compatible", "with that program's defects"),
        ],
    ),
    ("Lags", &[("lag_bins", "bins per axis"), ("lag_max", "largest lag")]),
    ("Window", &[("taper", "taper"), ("tapers", "sine tapers"), ("debias", "debias")]),
    ("Computing", &[("device", "device"), ("accuracy", "accuracy"), ("threads", "threads")]),
];

/// Draws the groups.
pub(super) fn show(ui: &mut egui::Ui, viewer: &mut Viewer) {
    ui.heading("Measure");
    let Some(set) = viewer.sets.get_mut(viewer.selected) else { return };
    let window = set.request.input.sampler.is_none();
    for (group, settings) in GROUPS.iter().filter(|(group, _)| *group != "Window" || window) {
        let blamed = set.snapshot.as_ref().and_then(|s| s.setting);
        let blamed = blamed.is_some_and(|blamed| settings.iter().any(|(name, _)| *name == blamed.name()));
        // What is refused must be seen.
        let header = egui::CollapsingHeader::new(*group).open(blamed.then_some(true));
        header.show(ui, |ui| {
            for (name, title) in *settings {
                setting(ui, &mut viewer.controls, set, name, title);
            }
        });
    }
}
