//! Files, behind one small interface: a browser will have another.

#[cfg(not(target_arch = "wasm32"))]
mod local;

use std::path::{Path, PathBuf};

use eframe::egui;

use crate::session::Session;
use crate::set::MOST_SETS;

#[cfg(not(target_arch = "wasm32"))]
pub use local::LocalFiles;

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    /// Files of points.
    Points,
    /// A folder of them.
    Folder,
    /// A session.
    Session,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// These were chosen.
    Points(Vec<PathBuf>),
    /// A session was chosen, and read.
    Session {
        /// Where it is.
        path: PathBuf,
        /// What is in it.
        text: String,
    },
    /// It was written, to there.
    Saved(PathBuf),
    /// It could not be read or written, for this reason.
    Failed(String),
}

/// Reading and writing on behalf of a person.
pub trait Files {
    /// Asks for files; the answer comes with `answers`, perhaps much later.
    fn choose(&mut self, what: Choice);
    /// Asks where to, and writes.
    fn save(&mut self, name: &str, bytes: Vec<u8>);
    /// What came of what was asked for.
    fn answers(&mut self) -> Vec<Answer>;
}

/// A session, if the file can be read.
pub(crate) fn read_session(path: &Path) -> Answer {
    match Session::read(path) {
        Ok(text) => Answer::Session { path: path.into(), text },
        Err(error) => Answer::Failed(error),
    }
}

/// What was chosen, written or dropped since the last frame.
pub(crate) fn arrived(ctx: &egui::Context, files: &mut dyn Files) -> Vec<Answer> {
    let dropped = ctx.input(|i| i.raw.dropped_files.clone());
    let paths: Vec<PathBuf> = dropped.iter().map(|file| file.path().to_path_buf()).collect();
    let is_session = |path: &&PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let mut answers = files.answers();
    answers.extend(paths.iter().filter(is_session).map(|path| read_session(path)));
    let points: Vec<PathBuf> = paths.iter().filter(|path| !is_session(path)).cloned().collect();
    if !points.is_empty() {
        answers.push(Answer::Points(points));
    }
    answers
}

/// While files are held over the window: says what dropping them does; `has_room`: whether there is room for a set.
pub(crate) fn announce_drop(ctx: &egui::Context, has_room: bool) {
    let hovering = ctx.input(|i| i.raw.hovered_files.len());
    if hovering == 0 {
        return;
    }
    let text = match (has_room, hovering) {
        (false, _) => format!("There is room for {MOST_SETS} sets: remove one first"),
        (true, 1) => "Drop to add this file or folder as a set; a session opens".to_string(),
        (true, many) => format!("Drop to add {many} files as one set"),
    };
    let painter = ctx.layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop")));
    let (all, visuals) = (ctx.content_rect(), ctx.global_style().visuals.clone());
    painter.rect_filled(all, 0.0, visuals.panel_fill.gamma_multiply(0.85));
    painter.rect_stroke(
        all.shrink(12.0),
        8.0,
        egui::Stroke::new(2.0, visuals.selection.bg_fill),
        egui::StrokeKind::Inside,
    );
    let font = egui::TextStyle::Heading.resolve(&ctx.global_style());
    painter.text(all.center(), egui::Align2::CENTER_CENTER, text, font, visuals.strong_text_color());
}
