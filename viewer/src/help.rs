//! Keyboard shortcuts and their overlay: both come from one table.

use eframe::egui;
use egui::{Key, KeyboardShortcut, Modifiers};
use pairwave::display::Panel;

use crate::app::Viewer;
use crate::files::Choice;
use crate::view::Theme;

/// What a key does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Opens or closes the overlay.
    Help,
    /// Closes what is open.
    Leave,
    /// Stops measuring, or goes on.
    Pause,
    /// One panel fills the window, by the number of the key.
    Panel,
    /// All panels again.
    AllPanels,
    /// Plots and pictures show all they have.
    ResetZoom,
    /// The next theme.
    Theme,
    /// Twice the realizations.
    More,
    /// Half of them.
    Fewer,
    /// Other random numbers.
    Seed,
    /// A set more.
    Add,
    /// The selected set once more.
    Duplicate,
    /// One set fewer.
    Remove,
    /// Selects the one before.
    Previous,
    /// Selects the one after.
    Next,
    /// Writes the session.
    SaveSession,
    /// Reads one.
    OpenSession,
    /// The equivalent command to the clipboard.
    CopyCommand,
}

/// Keys, and what any of them does.
#[derive(Debug, Clone, Copy)]
pub struct Shortcut {
    /// Each of them does it.
    pub keys: &'static [KeyboardShortcut],
    /// What they do.
    pub action: Action,
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

const fn shortcut(keys: &'static [KeyboardShortcut], action: Action, words: &'static str) -> Shortcut {
    Shortcut { keys, action, words }
}

/// The keys of the panels, in their order.
const PANELS: [KeyboardShortcut; Panel::ALL.len()] =
    [key(Key::Num1), key(Key::Num2), key(Key::Num3), key(Key::Num4), key(Key::Num5), key(Key::Num6)];

/// All of them. Of two that share a key, the one with more modifiers comes first.
pub const SHORTCUTS: [Shortcut; 18] = [
    shortcut(&[key(Key::F1), key(Key::Questionmark)], Action::Help, "show or hide this help"),
    shortcut(&[key(Key::Escape)], Action::Leave, "close the help; else show all panels again"),
    shortcut(&[key(Key::Space)], Action::Pause, "pause measuring, go on"),
    shortcut(&PANELS, Action::Panel, "fill the window with one panel"),
    shortcut(&[key(Key::Num0)], Action::AllPanels, "show all panels again"),
    shortcut(&[key(Key::R)], Action::ResetZoom, "reset zoom and pan of all plots"),
    shortcut(&[key(Key::T)], Action::Theme, "next theme: system, light, dark"),
    shortcut(&[key(Key::Plus), key(Key::Equals)], Action::More, "double the realizations of the selected set"),
    shortcut(&[key(Key::Minus)], Action::Fewer, "halve them"),
    shortcut(&[key(Key::S)], Action::Seed, "new seed for the selected set"),
    shortcut(&[command(Key::N)], Action::Add, "add a set"),
    shortcut(&[command(Key::D)], Action::Duplicate, "duplicate the selected set"),
    shortcut(&[key(Key::Delete)], Action::Remove, "remove the selected set"),
    shortcut(&[key(Key::OpenBracket)], Action::Previous, "select the previous set"),
    shortcut(&[key(Key::CloseBracket)], Action::Next, "select the next set"),
    shortcut(
        &[KeyboardShortcut::new(COMMAND_SHIFT, Key::C)],
        Action::CopyCommand,
        "copy the command of the selected set",
    ),
    shortcut(&[command(Key::S)], Action::SaveSession, "save the session"),
    shortcut(&[command(Key::O)], Action::OpenSession, "open a session"),
];

/// What the mouse does.
const MOUSE: [(&str, &str); 8] = [
    ("point at", "mark the same distance or frequency in every panel, with value, error and unit"),
    ("drag", "pan"),
    ("wheel, pinch", "zoom"),
    ("right drag", "zoom to a box in a plot of curves"),
    ("double click", "in a plot: reset its zoom; on a title: fill the window, show all again"),
    ("📤 of a panel", "take away its picture, figure, numbers or command"),
    ("any setting", "point at it: what it means, its unit and its flag"),
    ("drop files", "points as a set of their own, or a session"),
];

/// What is drawn.
const MARKS: [(&str, &str); 6] = [
    ("line", "estimate, in the colour of its set"),
    ("band", "± one standard error; shrinks as realizations come in"),
    ("dashed line", "closed form, where the sampler has one"),
    ("level", "complete randomness: g = 1, P = 1; of the anisotropy −10 log10 K dB"),
    ("grey centre", "of P(m): DC, which is the number of points and no fluctuation"),
    ("bar", "the values that the colours of a picture stand for"),
];

/// Realizations are not doubled beyond this.
const MOST_REALIZATIONS: u64 = 1 << 30;

/// The keys of an action, as they are called here.
pub(crate) fn keys(ctx: &egui::Context, action: Action) -> String {
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

/// Takes the keys of this frame.
pub(crate) fn shortcuts(ctx: &egui::Context, viewer: &mut Viewer) {
    // Escape and Tab take the focus from a text before this is asked.
    let typing_id = egui::Id::unique("a text had the focus");
    let typed = ctx.data_mut(|d| d.get_temp(typing_id)).unwrap_or(false);
    let types = ctx.text_edit_focused();
    ctx.data_mut(|d| d.insert_temp(typing_id, types));
    let other_modal = !viewer.help && ctx.memory(|m| m.top_modal_layer().is_some());
    let popup = egui::Popup::is_any_open(ctx);
    let focus = ctx.egui_wants_keyboard_input();
    for shortcut in &SHORTCUTS {
        if other_modal || (viewer.help && !matches!(shortcut.action, Action::Help | Action::Leave)) {
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
                act(ctx, viewer, shortcut.action, index);
            }
        }
    }
}

/// Does what a key is for; `index` says which of the keys it was.
fn act(ctx: &egui::Context, viewer: &mut Viewer, action: Action, index: usize) {
    let selected = viewer.selected;
    match action {
        Action::Help => viewer.help = !viewer.help,
        Action::Leave if viewer.help => viewer.help = false,
        Action::Leave | Action::AllPanels => viewer.view.maximized = None,
        Action::Pause => viewer.pause(!viewer.paused),
        Action::Panel => viewer.view.maximized = Panel::ALL.get(index).copied(),
        Action::ResetZoom => viewer.panels.reset(),
        Action::Theme => {
            let at = Theme::ALL.iter().position(|theme| *theme == viewer.view.theme).unwrap_or_default();
            viewer.view.theme = Theme::ALL[(at + 1) % Theme::ALL.len()];
        }
        Action::More => generated(viewer, |k, _| *k = k.saturating_mul(2).min(MOST_REALIZATIONS.max(*k))),
        Action::Fewer => generated(viewer, |k, _| *k = (*k / 2).max(1)),
        Action::Seed => generated(viewer, |_, seed| *seed = seed.wrapping_add(1)),
        Action::Add => add(viewer),
        Action::Duplicate => {
            if let Some(set) = viewer.sets.get(selected) {
                viewer.add(set.request.clone());
            }
        }
        Action::Remove if viewer.sets.len() == 1 => viewer.note("The last set stays"),
        Action::Remove => viewer.remove(selected),
        Action::Previous => viewer.selected = selected.saturating_sub(1),
        Action::Next => viewer.selected = (selected + 1).min(viewer.sets.len().saturating_sub(1)),
        Action::SaveSession => viewer.save_session(),
        Action::OpenSession => viewer.files.choose(Choice::Session),
        Action::CopyCommand => viewer.copy_command(ctx),
    }
}

/// Adds a set of a sampler that no other set is of.
fn add(viewer: &mut Viewer) {
    let names = || pairwave::samplers::registry().iter().map(|sampler| sampler.name());
    let other = |name: &&str| viewer.sets.iter().all(|set| set.request.input.sampler.as_deref() != Some(*name));
    if let Some(name) = names().find(other).or_else(|| names().next()) {
        viewer.add_sampler(name);
    }
}

/// Changes the number of realizations or the seed of the selected set; files have what they have.
fn generated(viewer: &mut Viewer, change: impl FnOnce(&mut u64, &mut u64)) {
    let Some(set) = viewer.sets.get_mut(viewer.selected) else { return };
    let input = &mut set.request.input;
    if input.sampler.is_none() {
        viewer.note("The realizations of a file are those in it: only samplers make others");
        return;
    }
    // Those that the command line takes where none are given.
    let before = (input.realizations.unwrap_or(1), input.seed.unwrap_or(1));
    let (mut realizations, mut seed) = before;
    change(&mut realizations, &mut seed);
    if realizations != before.0 {
        input.realizations = Some(realizations);
    }
    if seed != before.1 {
        input.seed = Some(seed);
    }
}

/// The overlay.
pub(crate) fn show(ctx: &egui::Context, viewer: &mut Viewer) {
    if !viewer.help {
        return;
    }
    let screen = ctx.content_rect().size();
    let width = (screen.x - 64.0).min(860.0);
    let frame = egui::Frame::popup(&ctx.global_style()).inner_margin(12);
    let modal = egui::Modal::new(egui::Id::unique("help")).frame(frame).show(ctx, |ui| {
        ui.set_width(width);
        ui.horizontal(|ui| {
            ui.heading("Keys, mouse and marks");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                crate::controls::icon(ui, "✖", "Close the help (Escape)").clicked()
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
    if modal.should_close() {
        viewer.help = false;
    }
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
