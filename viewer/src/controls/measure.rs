//! What is measured of the selected set, and by what.

use eframe::egui;
use pairwave::Setting;
use pairwave::plan::LagReach;
use pairwave::request::{Group, Request};

use super::{Controls, integrands, setting};
use crate::actions::Action;
use crate::set::Set;

/// Groups that fold, with their titles.
pub(super) const GROUPS: [(Group, &str); 6] = [
    (Group::Distances, "Distances"),
    (Group::Frequencies, "Frequencies"),
    (Group::Lags, "Lags"),
    (Group::Integration, "Integrals"),
    (Group::Tapers, "Window"),
    (Group::Computing, "Computing"),
];

/// Settings of requests with their titles, in the order in which they are shown.
pub(super) const TITLES: [(Setting, &str); 26] = [
    (Setting::RMax, "largest r"),
    (Setting::Bins, "bins"),
    (Setting::BinScale, "spacing"),
    (Setting::Edges, "edges from file"),
    (Setting::Correction, "correction"),
    (Setting::Normalization, "divide by"),
    (Setting::BeyondHalf, "beyond half the torus"),
    (Setting::MaxFrequency, "largest ν"),
    (Setting::Frequencies, "list from file"),
    (Setting::RingDirections, "directions"),
    (Setting::Convention, "convention"),
    (Setting::BugCompatible, "with that program's defects"),
    (Setting::LagBins, "bins per axis"),
    (Setting::LagMax, "largest lag"),
    (Setting::Integrand, "integrand"),
    (Setting::Estimator, "estimator"),
    (Setting::Shifts, "shifts"),
    (Setting::Intensity, "density"),
    (Setting::By, "by"),
    (Setting::Taper, "taper"),
    (Setting::Tapers, "sine tapers"),
    (Setting::Debias, "debias"),
    (Setting::Device, "device"),
    (Setting::Accuracy, "accuracy"),
    (Setting::Threads, "threads"),
    (Setting::Memory, "memory"),
];

/// Draws the groups of a set; `request` is what is asked of it from now on.
pub(super) fn show(
    ui: &mut egui::Ui,
    controls: &mut Controls,
    set: &Set,
    request: &mut Request,
    actions: &mut Vec<Action>,
) {
    ui.heading("Measure");
    let window = request.input.sampler.is_none();
    let group_of = |setting: Setting| setting.row().map(|row| row.group);
    for (group, title) in GROUPS.iter().filter(|(group, _)| *group != Group::Tapers || window) {
        let settings = TITLES.iter().filter(|(setting, _)| group_of(*setting) == Some(*group));
        let blamed = set.snapshot.as_ref().and_then(|s| s.setting);
        let blamed = settings.clone().any(|(setting, _)| Some(*setting) == blamed);
        // What is refused must be seen.
        let header = egui::CollapsingHeader::new(*title).open(blamed.then_some(true));
        header.show(ui, |ui| {
            for (one, title) in settings {
                if *one == Setting::Integrand {
                    integrands::show(ui, controls, set, request, actions);
                    continue;
                }
                setting(ui, controls, set, request, *one, title);
                if *one == Setting::LagMax {
                    let mut whole = request.lag_max == Some(LagReach::Whole);
                    let help = "Lags as far as they go: half the sides of a torus, the sides of a window";
                    if ui.checkbox(&mut whole, "all lags").on_hover_text(help).changed() {
                        request.lag_max = whole.then_some(LagReach::Whole);
                    }
                }
            }
        });
    }
}
