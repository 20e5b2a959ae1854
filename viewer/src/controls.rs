//! What a person sets: the sets, their points, what is measured, how it is shown.

mod integrands;
mod looks;
mod measure;
mod points;
mod sets;

use std::collections::BTreeMap;

use eframe::egui;
use pairwave::Setting;
use pairwave::display::Panel;
use pairwave::request::{self, Request, SETTINGS};

use crate::actions::Action;
use crate::engine::SetId;
use crate::set::Set;
use crate::state::State;

/// Width of the column of names.
const NAMES: f32 = 92.0;

/// What controls keep between frames.
pub(crate) struct Controls {
    /// What the help says of each setting.
    help: BTreeMap<Setting, String>,
    /// Text that is being typed or was refused, by set and setting.
    typed: BTreeMap<(SetId, Setting), Typed>,
    /// The same of integrands, by set and place in its list.
    specs: BTreeMap<(SetId, usize), Typed>,
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
        let help = SETTINGS.iter().map(|row| (row.setting, request::help(row.setting))).collect();
        Self { help, typed: BTreeMap::new(), specs: BTreeMap::new(), path: String::new() }
    }
}

impl Controls {
    /// Draws the controls. What is asked for by them.
    pub(crate) fn show(&mut self, ui: &mut egui::Ui, state: &State) -> Vec<Action> {
        let mut actions = Vec::new();
        ui.spacing_mut().item_spacing.y = 4.0;
        ui.add_space(4.0);
        sets::show(ui, state, &mut actions);
        ui.separator();
        let mut view = state.view.clone();
        if let Some(set) = state.selected_set() {
            let mut request = set.request.clone();
            points::show(ui, self, set, &mut request);
            ui.separator();
            measure::show(ui, self, set, &mut request, &mut actions);
            if set.request.integrand.is_empty() && !request.integrand.is_empty() {
                view.show(Panel::Integration);
            }
            if request != set.request {
                actions.push(Action::Ask(set.id, Box::new(request)));
            }
        }
        looks::show(ui, state.selected_set(), &mut view);
        if view != state.view {
            actions.push(Action::Look(Box::new(view)));
        }
        self.typed.retain(|(id, _), _| state.sets.iter().any(|set| set.id == *id));
        self.specs.retain(|(id, _), _| state.sets.iter().any(|set| set.id == *id));
        actions
    }
}

/// What a setting is called here: as its control, or else as its flag.
pub(crate) fn title(setting: Setting) -> &'static str {
    let titled = points::OF_FILES.iter().chain(&points::OF_SAMPLERS).chain(&measure::TITLES);
    titled.clone().find(|(one, _)| *one == setting).map_or_else(|| setting.flag(), |(_, title)| title)
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
        let combo = egui::ComboBox::from_id_salt(name)
            .selected_text(text(*value))
            .width(ui.available_width())
            .truncate()
            .height(600.0);
        let shown = combo.show_ui(ui, |ui| all.iter().for_each(|&one| _ = ui.selectable_value(value, one, text(one))));
        shown.response.labelled_by(label).on_hover_text(help);
        *value != before
    })
}

/// A rule in more words than a control has room for is told when it is pointed at.
const ROOM: usize = 16;

/// A setting of a set: what it takes decides what it looks like. What could not be read is said below it; what cannot be measured is
/// said where sets are listed, and marked here.
fn setting(
    ui: &mut egui::Ui,
    controls: &mut Controls,
    set: &Set,
    request: &mut Request,
    setting: Setting,
    title: &str,
) {
    let Some(row) = setting.row() else { return };
    let key = (set.id, setting);
    let value = request.value(setting);
    let help = format!("{}\n{}", controls.help.get(&setting).map_or("", String::as_str), row.flag);
    let (choices, otherwise) = (row.choices(), row.left_out(Setting::flag));
    let otherwise = if otherwise.chars().count() > ROOM { "automatic".to_string() } else { otherwise };
    let failed = set.snapshot.as_ref().is_some_and(|s| s.setting == Some(setting));
    let mut wanted = None;
    if row.is_switch() {
        let mut on = !value.is_empty();
        if ui.checkbox(&mut on, title).on_hover_text(help).changed() {
            wanted = Some(if on { "true".to_string() } else { String::new() });
        }
    } else if choices.is_empty() {
        self::row(ui, title, &help, |ui, label| {
            let typed = controls.typed.get(&key);
            let mut text = typed.map_or(value.clone(), |t| t.text.clone());
            let mut edit = egui::TextEdit::singleline(&mut text).hint_text(&otherwise).desired_width(f32::INFINITY);
            if failed {
                edit = edit.text_color(ui.visuals().error_fg_color);
            }
            let edit = ui.add(edit).labelled_by(label).on_hover_text(&help);
            if edit.lost_focus() && text != value {
                wanted = Some(text);
            } else if edit.has_focus() || edit.changed() {
                controls.typed.insert(key, Typed { text, error: None });
            } else if controls.typed.get(&key).is_some_and(|t| t.error.is_none()) {
                controls.typed.remove(&key);
            }
        });
    } else {
        // Left out, it is what its help says, unless it has a value even then.
        let left_out = Request::default().value(setting).is_empty().then_some("");
        let all: Vec<&str> = left_out.into_iter().chain(choices).collect();
        let mut chosen = value.as_str();
        let said = |one: &str| match (one, otherwise.as_str()) {
            ("", "") => "automatic".to_string(),
            ("", otherwise) => otherwise.to_string(),
            (one, _) => one.to_string(),
        };
        if choice(ui, (title, &help), &mut chosen, &all, said) {
            wanted = Some(chosen.to_string());
        }
    }
    if let Some(text) = wanted {
        match request.with(setting, &text) {
            Ok(changed) => {
                *request = changed;
                controls.typed.remove(&key);
            }
            Err(error) => _ = controls.typed.insert(key, Typed { text, error: Some(error.told(self::title)) }),
        }
    }
    if let Some(error) = controls.typed.get(&key).and_then(|t| t.error.as_deref()) {
        refusal(ui, error);
    }
}

/// What is wrong, where it is wrong.
fn refusal(ui: &mut egui::Ui, error: &str) {
    let color = ui.visuals().error_fg_color;
    ui.add(egui::Label::new(egui::RichText::new(error).color(color).small()).wrap());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Why some settings have no control.
    const WITHOUT: [Setting; 20] = [
        // What panels are shown decides.
        Setting::Stats,
        // Panels show none of these.
        Setting::Kernel,
        Setting::Bandwidth,
        Setting::Divisor,
        Setting::ExactKernel,
        Setting::ClassColumn,
        Setting::Classes,
        Setting::LagRings,
        Setting::Envelope,
        Setting::EnvelopeFrom,
        Setting::Sectors,
        Setting::CovarianceFrequency,
        Setting::Spatial,
        Setting::Top,
        Setting::IntensityColumn,
        Setting::Inhomogeneous,
        Setting::IntensityBandwidth,
        Setting::IntensityGrid,
        // It is for long runs.
        Setting::Costs,
        // The list of files is edited as a whole.
        Setting::Files,
    ];

    /// Whether a setting has a control: those of samplers are drawn by hand.
    fn has_control(row: &request::Row) -> bool {
        let titled = points::OF_FILES.iter().chain(&measure::TITLES).any(|(setting, _)| *setting == row.setting);
        titled || row.for_samplers || row.setting == Setting::Sampler
    }

    #[test]
    fn every_setting_has_a_control_or_a_reason_to_have_none() {
        for row in &SETTINGS {
            assert_ne!(has_control(row), WITHOUT.contains(&row.setting), "{}", row.setting);
        }
        for (setting, _) in measure::TITLES {
            let groups = measure::GROUPS.iter().filter(|(group, _)| setting.row().is_some_and(|r| r.group == *group));
            assert_eq!(groups.count(), 1, "{setting}");
        }
    }
}
