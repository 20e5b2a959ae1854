//! Keyboard shortcuts and their overlay: both come from one table.

use eframe::egui;
use egui::{Key, KeyboardShortcut, Modifiers};
use pairwave::display::Panel;

use crate::actions::{Action, Keyed};
use crate::style;

/// Keys, and what any of them does.
#[derive(Debug, Clone, Copy)]
pub struct Shortcut {
    /// Each of them does it.
    pub keys: &'static [KeyboardShortcut],
    /// What they do.
    pub action: Keyed,
    /// The same in words.
    pub words: &'static str,
}

const fn key(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

const fn command(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const COMMAND_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

const fn shortcut(keys: &'static [KeyboardShortcut], action: Keyed, words: &'static str) -> Shortcut {
    Shortcut { keys, action, words }
}

/// The keys of the panels, in their order.
const PANELS: [KeyboardShortcut; Panel::ALL.len()] =
    [key(Key::Num1), key(Key::Num2), key(Key::Num3), key(Key::Num4), key(Key::Num5), key(Key::Num6), key(Key::Num7)];

/// All of them. Of two that share a key, the one with more modifiers comes first.
pub const SHORTCUTS: [Shortcut; 19] = [
    shortcut(&[key(Key::F1), key(Key::Questionmark)], Keyed::Help, "show or hide this help"),
    shortcut(&[key(Key::Escape)], Keyed::Leave, "close the help; else show all panels again"),
    shortcut(&[key(Key::Space)], Keyed::Pause, "pause measuring, go on"),
    shortcut(&PANELS, Keyed::Panel, "fill the window with one panel"),
    shortcut(&[key(Key::Num0)], Keyed::AllPanels, "show all panels again"),
    shortcut(&[key(Key::R)], Keyed::ResetZoom, "reset zoom and pan of all plots"),
    shortcut(&[key(Key::B)], Keyed::Controls, "hide the controls, show them again"),
    shortcut(&[key(Key::T)], Keyed::Theme, "next theme: system, light, dark"),
    shortcut(&[key(Key::Plus), key(Key::Equals)], Keyed::More, "double the realizations of the selected set"),
    shortcut(&[key(Key::Minus)], Keyed::Fewer, "halve them"),
    shortcut(&[key(Key::S)], Keyed::Seed, "new seed for the selected set"),
    shortcut(&[command(Key::N)], Keyed::Add, "add a set"),
    shortcut(&[command(Key::D)], Keyed::Duplicate, "duplicate the selected set"),
    shortcut(&[key(Key::Delete)], Keyed::Remove, "remove the selected set"),
    shortcut(&[key(Key::OpenBracket)], Keyed::Previous, "select the previous set"),
    shortcut(&[key(Key::CloseBracket)], Keyed::Next, "select the next set"),
    shortcut(
        &[KeyboardShortcut::new(COMMAND_SHIFT, Key::C)],
        Keyed::CopyCommand,
        "copy the command of the selected set",
    ),
    shortcut(&[command(Key::S)], Keyed::SaveSession, "save the session"),
    shortcut(&[command(Key::O)], Keyed::OpenSession, "open a session"),
];

/// What the mouse does.
const MOUSE: [(&str, &str); 9] = [
    ("point at", "mark the same distance or frequency in every panel, with value, error and unit"),
    ("drag", "pan"),
    ("wheel, pinch", "zoom; of curves along the first axis, upward to what is seen"),
    ("Shift and wheel", "zoom curves upward"),
    ("right drag", "zoom to a box in a plot of curves"),
    ("double click", "in a plot: reset its zoom; on a title: fill the window, show all again"),
    ("📤 of a panel", "take away its picture, figure, numbers or command"),
    ("any setting", "point at it: what it means, its unit and its flag"),
    ("drop files", "points as a set of their own, a picture to integrate, or a session"),
];

/// What is drawn.
const MARKS: [(&str, &str); 7] = [
    ("line", "estimate, in the colour of its set"),
    ("band", "± one standard error; shrinks as realizations come in"),
    ("dashed line", "closed form, where the sampler has one"),
    ("level", "complete randomness: g = 1, P = 1; of the anisotropy −10 log10 K dB"),
    ("grey centre", "of P(m): DC, which is the number of points and no fluctuation"),
    ("dot of a variance", "full where predicted, hollow where observed; ± two standard errors"),
    ("bar", "the values that the colours of a picture stand for"),
];

/// The keys of an action, as they are called here.
pub(crate) fn keys(ctx: &egui::Context, action: Keyed) -> String {
    let of = SHORTCUTS.iter().find(|s| s.action == action);
    of.map(|s| s.text(ctx)).unwrap_or_default()
}

impl Shortcut {
    /// The keys as text.
    pub fn text(&self, ctx: &egui::Context) -> String {
        let name = |key: &KeyboardShortcut| match key.modifiers {
            Modifiers::NONE => key.logical_key.symbol_or_name().to_string(),
            _ => ctx.format_shortcut(key),
        };
        match self.keys {
            [first, .., last] if self.keys.len() > 2 => format!("{} to {}", name(first), name(last)),
            keys => keys.iter().map(name).collect::<Vec<_>>().join(" or "),
        }
    }
}

/// Takes the keys of this frame; `is_open`: whether the overlay is. What is asked for by them.
pub(crate) fn shortcuts(ctx: &egui::Context, mut is_open: bool) -> Vec<Action> {
    let mut actions = Vec::new();
    // Escape and Tab take the focus from a text before this is asked.
    let typing_id = egui::Id::unique("a text had the focus");
    let typed = ctx.data_mut(|d| d.get_temp(typing_id)).unwrap_or(false);
    let types = ctx.text_edit_focused();
    ctx.data_mut(|d| d.insert_temp(typing_id, types));
    let other_modal = !is_open && ctx.memory(|m| m.top_modal_layer().is_some());
    let popup = egui::Popup::is_any_open(ctx);
    let focus = ctx.egui_wants_keyboard_input();
    for shortcut in &SHORTCUTS {
        if other_modal || (is_open && !matches!(shortcut.action, Keyed::Help | Keyed::Leave)) {
            continue;
        }
        for (index, key) in shortcut.keys.iter().enumerate() {
            let left_to_others = match key.logical_key {
                Key::F1 => false,
                Key::Escape => typed || popup,
                // It presses what has the focus.
                Key::Space => focus || popup,
                _ => key.modifiers.is_none() && (typed || types || popup),
            };
            if !left_to_others && ctx.input_mut(|i| i.consume_shortcut(key)) {
                actions.push(action(shortcut.action, index));
                is_open = match shortcut.action {
                    Keyed::Help => !is_open,
                    Keyed::Leave => false,
                    _ => is_open,
                };
            }
        }
    }
    actions
}

/// What a key is for; `index` says which of the keys it was.
fn action(keyed: Keyed, index: usize) -> Action {
    match keyed {
        Keyed::Panel => Action::Maximize(Panel::ALL.get(index).copied()),
        other => Action::Keyed(other),
    }
}

/// The overlay, while it is open. What is asked for in it.
pub(crate) fn show(ctx: &egui::Context) -> Option<Action> {
    let screen = ctx.content_rect().size();
    let width = (screen.x - 64.0).min(860.0);
    let frame = egui::Frame::popup(&ctx.global_style()).inner_margin(12);
    let modal = egui::Modal::new(egui::Id::unique("help")).frame(frame).show(ctx, |ui| {
        ui.set_width(width);
        ui.horizontal(|ui| {
            ui.heading("Keys, mouse and marks");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                style::icon(ui, "✖", "Close the help (Escape)").clicked()
            })
            .inner
        })
        .inner
        .then(|| ui.close());
        ui.separator();
        let most = screen.y - 120.0;
        let area = egui::ScrollArea::vertical().max_height(most).min_scrolled_height(most);
        area.show(ui, |ui| columns(ui, width));
    });
    ctx.accesskit_node_builder(modal.response.id, |node| {
        node.set_role(egui::accesskit::Role::Dialog);
        node.set_label("Help: keys, mouse and marks");
    });
    modal.should_close().then_some(Action::Keyed(Keyed::Leave))
}

/// Keys at the left, the rest at the right; one below the other where it is narrow.
fn columns(ui: &mut egui::Ui, width: f32) {
    let keys = |ui: &mut egui::Ui| {
        title(ui, "Keys");
        for shortcut in &SHORTCUTS {
            row(ui, &shortcut.text(ui.ctx()), shortcut.words);
        }
        row(ui, "Tab", "the next control; Space or Enter presses it");
    };
    let rest = |ui: &mut egui::Ui| {
        for (name, rows) in [("Mouse", MOUSE.as_slice()), ("Marks", &MARKS)] {
            title(ui, name);
            for (what, words) in rows {
                row(ui, what, words);
            }
            ui.add_space(8.0);
        }
    };
    if width < 560.0 {
        keys(ui);
        ui.add_space(8.0);
        rest(ui);
        return;
    }
    ui.columns_const(|[left, right]| {
        keys(left);
        rest(right);
    });
}

fn title(ui: &mut egui::Ui, text: &str) {
    ui.label(egui::RichText::new(text).strong().size(15.0));
    ui.add_space(2.0);
}

fn row(ui: &mut egui::Ui, what: &str, words: &str) {
    const FIRST: f32 = 104.0;
    ui.horizontal_top(|ui| {
        let left = ui.scope(|ui| {
            ui.set_width(FIRST);
            ui.label(egui::RichText::new(what).color(ui.visuals().strong_text_color()));
        });
        let rest = ui.available_width();
        ui.vertical(|ui| {
            ui.set_width(rest);
            ui.add(egui::Label::new(words).wrap()).labelled_by(left.response.id);
        });
    });
}
