//! What is integrated over the points of the selected set.

use eframe::egui;
use pairwave::integrand::{Entry, find, registry};
use pairwave::request::Request;
use pairwave::{Integrand, Setting};

use super::{Controls, Typed, choice, refusal, row};
use crate::actions::Action;
use crate::files::Choice;
use crate::set::{Set, with_integrands};
use crate::style;

/// Draws the list; `request` is what is asked of the set from now on.
pub(super) fn show(
    ui: &mut egui::Ui,
    controls: &mut Controls,
    set: &Set,
    request: &mut Request,
    actions: &mut Vec<Action>,
) {
    let dim = set.analysis().map_or(request.input.dim.unwrap_or(2), |analysis| analysis.domain.dim());
    let mut specs = request.integrand.clone();
    let mut removed = None;
    for (index, spec) in specs.iter_mut().enumerate() {
        if edit(ui, controls, set, (index, dim), spec) {
            removed = Some(index);
        }
    }
    if let Some(index) = removed {
        specs.remove(index);
        controls.specs.retain(|(id, _), _| *id != set.id);
    }
    // What only the making of it shows is said where sets are listed, and here.
    let error = set.snapshot.as_ref().filter(|s| s.setting == Some(Setting::Integrand)).and_then(|s| s.error.as_ref());
    if let Some(error) = error {
        refusal(ui, error);
    }
    let there: Vec<&str> =
        registry().iter().filter(|entry| entry.dims.contains(&dim)).map(|entry| entry.name).collect();
    let all: Vec<&str> = std::iter::once("").chain(there).collect();
    let mut name = "";
    let help = "Another function of which the error of the integral is predicted and observed\n--integrand";
    let text = |name: &str| if name.is_empty() { "choose…".to_string() } else { name.to_string() };
    if choice(ui, ("add integrand", help), &mut name, &all, text)
        && let Ok(entry) = find(name)
    {
        match first(entry) {
            Some(spec) => specs.push(spec),
            None => actions.push(Action::Choose(Choice::Integrand(entry.name))),
        }
    }
    if specs != request.integrand {
        *request = with_integrands(request, specs);
    }
}

/// The specification that an entry begins with; `None` where it must be given a file.
fn first(entry: &Entry) -> Option<String> {
    let spec = if entry.example.is_empty() { entry.name } else { entry.example };
    (!entry.needs_file()).then(|| spec.to_string())
}

/// A specification that can be edited. Whether it is to be removed.
fn edit(
    ui: &mut egui::Ui,
    controls: &mut Controls,
    set: &Set,
    (index, dim): (usize, usize),
    spec: &mut String,
) -> bool {
    let key = (set.id, index);
    let name = format!("integrand {}", index + 1);
    let mut removed = false;
    row(ui, &name, &help(spec, dim), |ui, label| {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            removed = style::icon(ui, "✖", &format!("Leave out {name}")).clicked();
            let mut text = controls.specs.get(&key).map_or(spec.clone(), |typed| typed.text.clone());
            let edit = egui::TextEdit::singleline(&mut text).desired_width(f32::INFINITY);
            let edit = ui.add(edit).labelled_by(label).on_hover_text(help(&text, dim));
            if edit.lost_focus() && text.trim() != spec {
                match checked(&text, dim) {
                    Ok(()) => {
                        *spec = text.trim().to_string();
                        controls.specs.remove(&key);
                    }
                    Err(error) => _ = controls.specs.insert(key, Typed { text, error: Some(error) }),
                }
            } else if edit.has_focus() || edit.changed() {
                controls.specs.insert(key, Typed { text, error: None });
            } else if controls.specs.get(&key).is_some_and(|typed| typed.error.is_none()) {
                controls.specs.remove(&key);
            }
        });
    });
    if let Some(error) = controls.specs.get(&key).and_then(|typed| typed.error.as_deref()) {
        refusal(ui, error);
    }
    removed || spec.is_empty()
}

/// What is wrong with a text. Of what is made of a file or a formula only the name is looked at: the rest is the worker's.
fn checked(text: &str, dim: usize) -> Result<(), String> {
    let name = text.split(':').next().unwrap_or_default().trim();
    let told = |error: pairwave::Error| error.told(super::title);
    match find(name) {
        _ if text.trim().is_empty() => Ok(()),
        Ok(entry) if entry.closed => Integrand::new(text, dim).map(|_| ()).map_err(told),
        Ok(_) => Ok(()),
        Err(error) => Err(told(error)),
    }
}

/// What the function is, and its parameters.
fn help(spec: &str, dim: usize) -> String {
    let name = spec.split(':').next().unwrap_or_default().trim();
    let Ok(entry) = find(name) else { return "NAME or NAME:key=value,...\n--integrand".into() };
    let parameters = entry.parameters(dim).map(|p| format!("{}: {}, {}", p.shown(), p.help, p.takes));
    std::iter::once(entry.summary.to_string())
        .chain(parameters)
        .chain(["--integrand".to_string()])
        .collect::<Vec<_>>()
        .join("\n")
}
