//! What a person sets: the sets, their points, what is measured, how it is shown.

mod looks;
mod measure;
mod points;
mod sets;

use std::collections::BTreeMap;

use eframe::egui;
use pairwave::request::{Request, Setting};

use crate::app::Viewer;
use crate::engine::SetId;
use crate::set::Set;

/// Width of the column of names.
const NAMES: f32 = 92.0;

/// What controls keep between frames.
pub(crate) struct Controls {
    settings: Vec<Setting>,
    /// Text that is being typed or was refused, by set and setting.
    typed: BTreeMap<(SetId, String), Typed>,
    /// A path that is being typed.
    path: String,
}

#[derive(Default)]
struct Typed {
    text: String,
    /// Why it was refused.
    error: Option<String>,
}

impl Default for Controls {
    fn default() -> Self {
        Self { settings: Setting::all(), typed: BTreeMap::new(), path: String::new() }
    }
}

/// Draws the controls.
pub(crate) fn show(ui: &mut egui::Ui, viewer: &mut Viewer) {
    ui.spacing_mut().item_spacing.y = 4.0;
    ui.add_space(4.0);
    sets::show(ui, viewer);
    ui.separator();
    points::show(ui, viewer);
    ui.separator();
    measure::show(ui, viewer);
    looks::show(ui, viewer);
    let ids: Vec<SetId> = viewer.sets.iter().map(|s| s.id).collect();
    viewer.controls.typed.retain(|(id, _), _| ids.contains(id));
}

/// A small button that shows a sign and says in words what it does.
pub(crate) fn icon(ui: &mut egui::Ui, sign: &str, text: &str) -> egui::Response {
    let response = ui.small_button(sign).on_hover_text(text);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, text));
    response
}

/// A name and, beside it, what it names.
fn row<R>(ui: &mut egui::Ui, name: &str, help: &str, control: impl FnOnce(&mut egui::Ui, egui::Id) -> R) -> R {
    ui.horizontal(|ui| {
        let size = egui::vec2(NAMES, ui.spacing().interact_size.y);
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        let label = ui.allocate_ui_with_layout(size, layout, |ui| {
            ui.set_min_size(size);
            ui.add(egui::Label::new(name).truncate()).on_hover_text(help)
        });
        control(ui, label.inner.id)
    })
    .inner
}

/// One of several: a combo box with a name beside it. Whether another one was chosen.
fn choice<T: Copy + PartialEq>(
    ui: &mut egui::Ui,
    (name, help): (&str, &str),
    value: &mut T,
    all: &[T],
    text: impl Fn(T) -> String,
) -> bool {
    row(ui, name, help, |ui, label| {
        let before = *value;
        let combo =
            egui::ComboBox::from_id_salt(name).selected_text(text(*value)).width(ui.available_width()).truncate();
        let shown = combo.show_ui(ui, |ui| all.iter().for_each(|&one| _ = ui.selectable_value(value, one, text(one))));
        shown.response.labelled_by(label).on_hover_text(help);
        *value != before
    })
}

/// A setting of a set: what it takes decides what it looks like. What was refused is said below it.
fn setting(ui: &mut egui::Ui, controls: &mut Controls, set: &mut Set, name: &str, title: &str) {
    let Some(setting) = controls.settings.iter().find(|s| s.name == name) else { return };
    let key = (set.id, setting.name.clone());
    let value = set.request.value(setting);
    let help = format!("{}\n{}", setting.help, setting.flag);
    let otherwise = setting.otherwise.as_deref().unwrap_or("");
    let mut wanted = None;
    if setting.is_switch {
        let mut on = !value.is_empty();
        if ui.checkbox(&mut on, title).on_hover_text(help).changed() {
            wanted = Some(if on { "true".to_string() } else { String::new() });
        }
    } else if setting.choices.is_empty() {
        row(ui, title, &help, |ui, label| {
            let typed = controls.typed.get(&key);
            let mut text = typed.map_or(value.clone(), |t| t.text.clone());
            let edit = egui::TextEdit::singleline(&mut text).hint_text(otherwise).desired_width(f32::INFINITY);
            let edit = ui.add(edit).labelled_by(label).on_hover_text(&help);
            if edit.lost_focus() && text != value {
                wanted = Some(text);
            } else if edit.has_focus() || edit.changed() {
                controls.typed.insert(key.clone(), Typed { text, error: None });
            } else if controls.typed.get(&key).is_some_and(|t| t.error.is_none()) {
                controls.typed.remove(&key);
            }
        });
    } else {
        // Left out, it is what its help says.
        let left_out = setting.default.is_none().then(String::new);
        let all: Vec<&str> =
            left_out.iter().map(String::as_str).chain(setting.choices.iter().map(String::as_str)).collect();
        let mut chosen = value.as_str();
        let said = |one: &str| match (one, otherwise) {
            ("", "") => "automatic".to_string(),
            ("", otherwise) => otherwise.to_string(),
            (one, _) => one.to_string(),
        };
        if choice(ui, (title, &help), &mut chosen, &all, said) {
            wanted = Some(chosen.to_string());
        }
    }
    if let Some(text) = wanted {
        match set.request.with(setting, &text) {
            Ok(request) => {
                set.request = request;
                controls.typed.remove(&key);
            }
            Err(error) => {
                _ = controls.typed.insert(key.clone(), Typed { text, error: Some(error.told(pairwave::Setting::flag)) })
            }
        }
    }
    let failed = set
        .snapshot
        .as_ref()
        .filter(|s| s.setting.is_some_and(|s| s.name() == setting.name))
        .and_then(|s| s.error.clone());
    if let Some(error) = controls.typed.get(&key).and_then(|t| t.error.clone()).or(failed) {
        refusal(ui, &error);
    }
}

/// What is wrong, where it is wrong.
fn refusal(ui: &mut egui::Ui, error: &str) {
    let color = ui.visuals().error_fg_color;
    ui.add(egui::Label::new(egui::RichText::new(error).color(color).small()).wrap());
}

/// A request of a sampler, in place of whatever points there were.
fn of_sampler(request: &Request, name: &str) -> Request {
    let mut request = request.clone();
    let old = std::mem::take(&mut request.input);
    request.input.sampler = Some(name.into());
    request.input.points = old.points.or(Some(1024));
    request.input.realizations = old.realizations;
    (request.input.dim, request.input.seed) = (old.dim, old.seed);
    request
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Why some settings have no control.
    const WITHOUT: [&str; 12] = [
        // What panels are shown decides.
        "stats",
        // Panels show none of these.
        "kernel",
        "bandwidth",
        "divisor",
        "exact_kernel",
        "class_column",
        "classes",
        "lag_rings",
        "envelope",
        "sectors",
        "covariance_frequency",
        // The list of files is edited as a whole.
        "files",
    ];

    /// Settings of samplers, each drawn by hand.
    const OF_SAMPLERS: [&str; 6] = ["sampler", "points", "realizations", "dim", "seed", "params"];

    /// The settings of requests that have a control; the others are about what no panel shows.
    fn has_control(setting: &str) -> bool {
        let of_points = OF_SAMPLERS.iter().chain(points::OF_FILES.iter().map(|(name, _)| name));
        let measured = measure::GROUPS.iter().flat_map(|(_, settings)| settings.iter().map(|(name, _)| name));
        of_points.chain(measured).any(|name| *name == setting)
    }

    #[test]
    fn every_setting_has_a_control_or_a_reason_to_have_none() {
        for setting in Setting::all() {
            assert_ne!(has_control(&setting.name), WITHOUT.contains(&setting.name.as_str()), "{}", setting.name);
        }
    }
}
