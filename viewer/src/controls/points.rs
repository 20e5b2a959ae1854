//! Where the points of the selected set come from.

use eframe::egui;
use pairwave::Setting;
use pairwave::request::Request;
use pairwave::samplers::{Accepts, Entry, MAX_POINTS, Parameter, find, registry};

use super::{Controls, choice, row, setting};
use crate::set::{Set, fitting, of_sampler};
use crate::style;

/// Settings of files.
pub(super) const OF_FILES: [(Setting, &str); 12] = [
    (Setting::Domain, "domain"),
    (Setting::Sides, "box"),
    (Setting::Window, "window"),
    (Setting::WindowPolygon, "polygon"),
    (Setting::Wrap, "fold points outside back in"),
    (Setting::Unit, "unit"),
    (Setting::Raw, "raw numbers"),
    (Setting::Array, "arrays"),
    (Setting::Columns, "columns"),
    (Setting::RealizationColumn, "realizations"),
    (Setting::WeightColumn, "weights"),
    (Setting::KeepGoing, "leave out broken files"),
];

/// Settings of samplers, whose controls are drawn by hand.
pub(super) const OF_SAMPLERS: [(Setting, &str); 5] = [
    (Setting::Sampler, "sampler"),
    (Setting::Points, "n"),
    (Setting::Realizations, "K"),
    (Setting::Seed, "seed"),
    (Setting::Dim, "dimension"),
];

/// Draws the controls of the points of a set; `request` is what is asked of it from now on.
pub(super) fn show(ui: &mut egui::Ui, controls: &mut Controls, set: &Set, request: &mut Request) {
    ui.heading("Points");
    let named = request.input.sampler.clone();
    let mut name = named.as_deref().unwrap_or("files");
    let mut all: Vec<&str> = registry().iter().map(|s| s.name).collect();
    if named.is_none() || !all.contains(&name) {
        all.insert(0, name);
    }
    let help = find(name).map_or("Points from files", |sampler| sampler.summary);
    if choice(ui, ("sampler", help), &mut name, &all, str::to_string) && name != "files" {
        *request = of_sampler(request, name);
    }
    if request.input.sampler.is_some() {
        sampler(ui, request);
    } else {
        files(ui, controls, set, request);
    }
}

/// A whole number, dragged or typed. Whether it changed.
fn number(
    ui: &mut egui::Ui,
    (name, help): (&str, &str),
    value: &mut u64,
    range: std::ops::RangeInclusive<u64>,
) -> bool {
    row(ui, name, help, |ui, label| {
        // A drag of a hundred points doubles it, about.
        let speed = (*value as f64 * 0.01).max(0.05);
        // A drag works on f64, which has no room for every number.
        let exact = *value;
        let text = move |x: f64, _| if x == exact as f64 { exact.to_string() } else { format!("{x}") };
        let drag = egui::DragValue::new(value).range(range).clamp_existing_to_range(false).speed(speed);
        let drag = drag.custom_formatter(text);
        let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
        ui.add_sized(size, drag).labelled_by(label).on_hover_text(help).changed()
    })
}

fn sampler(ui: &mut egui::Ui, request: &mut Request) {
    let known = request.input.sampler.as_deref().and_then(|name| find(name).ok());
    let input = &mut request.input;
    let mut changed = false;
    let mut n = input.points.unwrap_or(1024);
    if number(
        ui,
        ("n", "Points per realization; the nearest number that the sampler takes\n-n"),
        &mut n,
        1..=MAX_POINTS,
    ) {
        input.points = Some(n);
        changed = true;
    }
    let mut k = input.realizations.unwrap_or(1);
    if number(ui, ("K", "Number of realizations: errors shrink with its root\n-k"), &mut k, 1..=10_000_000) {
        input.realizations = Some(k);
    }
    let mut seed = input.seed.unwrap_or(1);
    if number(ui, ("seed", "Other seeds make other points of the same kind\n--seed"), &mut seed, 0..=u64::MAX) {
        input.seed = Some(seed).filter(|seed| *seed != 1);
    }
    let mut dim = input.dim.unwrap_or(2);
    let dims: Vec<usize> = known.map_or(1..=3, |sampler| sampler.dims.clone()).filter(|dim| *dim <= 3).collect();
    if choice(ui, ("dimension", "--dim"), &mut dim, &dims, |d| format!("{d}D")) {
        input.dim = Some(dim).filter(|d| *d != 2);
        changed = true;
    }
    for parameter in known.into_iter().flat_map(Entry::all_parameters) {
        self::parameter(ui, &mut input.params, parameter);
    }
    if changed {
        *request = fitting(request.clone());
    }
}

/// A parameter of a sampler; written into `params` unless it has its default.
fn parameter(ui: &mut egui::Ui, params: &mut Vec<String>, parameter: &Parameter) {
    let help = format!("{}: {}\n--param {}=", parameter.help, parameter.accepts, parameter.name);
    let given = params.iter().find_map(|p| p.split_once('=').filter(|(key, _)| *key == parameter.name)).map(|(_, v)| v);
    let value = given.unwrap_or(parameter.default).to_string();
    let new = match parameter.accepts {
        Accepts::OneOf(words) => {
            let mut word = value.as_str();
            choice(ui, (parameter.name, &help), &mut word, words, str::to_string).then(|| word.to_string())
        }
        Accepts::Whole(..) | Accepts::WordOrWhole(..) => row(ui, parameter.name, &help, |ui, label| {
            let mut text = value.clone();
            let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
            let typed =
                ui.add_sized(size, egui::TextEdit::singleline(&mut text)).labelled_by(label).on_hover_text(&help);
            typed.changed().then_some(text)
        }),
        Accepts::Above(low, high) | Accepts::Between(low, high) => row(ui, parameter.name, &help, |ui, label| {
            let mut x = value.parse::<f64>().unwrap_or(low);
            let speed = (x.abs() * 0.01).max(1e-3);
            let drag = egui::DragValue::new(&mut x)
                .range(low..=high)
                .clamp_existing_to_range(false)
                .speed(speed)
                .max_decimals(6);
            let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
            ui.add_sized(size, drag).labelled_by(label).on_hover_text(&help).changed().then(|| x.to_string())
        }),
    };
    if let Some(new) = new {
        params.retain(|p| p.split_once('=').is_none_or(|(key, _)| key != parameter.name));
        if new != parameter.default {
            params.push(format!("{}={new}", parameter.name));
        }
    }
}

fn files(ui: &mut egui::Ui, controls: &mut Controls, set: &Set, request: &mut Request) {
    let input = &mut request.input;
    let mut removed = None;
    for (index, file) in input.files.iter().enumerate() {
        let path = file.display().to_string();
        ui.horizontal(|ui| {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if input.files.len() > 1 && style::icon(ui, "✖", &format!("Leave out {path}")).clicked() {
                    removed = Some(index);
                }
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    ui.add(egui::Label::new(&path).truncate()).on_hover_text(&path);
                });
            });
        });
    }
    if let Some(index) = removed {
        input.files.remove(index);
    }
    row(ui, "add a path", "A file or folder, added to this batch on Enter", |ui, label| {
        let edit =
            egui::TextEdit::singleline(&mut controls.path).hint_text("file or folder").desired_width(f32::INFINITY);
        let edit = ui.add(edit).labelled_by(label);
        if edit.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter)) && !controls.path.trim().is_empty() {
            input.files.push(controls.path.trim().into());
            controls.path.clear();
        }
    });
    for (name, title) in OF_FILES {
        setting(ui, controls, set, request, name, title);
    }
}
