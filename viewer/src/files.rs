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
    /// The file that an integrand of this name is made of.
    Integrand(&'static str),
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
    /// A function to integrate.
    Integrand(String),
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

/// Files that are no points: pictures to integrate.
const PICTURES: [&str; 3] = ["png", "pfm", "exr"];

/// The specification of an integrand that is made of a file.
fn made_of(name: &str, path: &Path) -> String {
    format!("{name}:file={}", path.display())
}

/// What was chosen, written or dropped since the last frame.
pub(crate) fn arrived(ctx: &egui::Context, files: &mut dyn Files) -> Vec<Answer> {
    let dropped = ctx.input(|i| i.raw.dropped_files.clone());
    let paths: Vec<PathBuf> = dropped.iter().map(|file| file.path().to_path_buf()).collect();
    let mut answers = files.answers();
    answers.extend(taken(&paths));
    answers
}

/// What dropped files are, by their names.
fn taken(paths: &[PathBuf]) -> Vec<Answer> {
    let ends_with = |path: &Path, all: &[&str]| {
        path.extension().is_some_and(|end| all.iter().any(|one| end.eq_ignore_ascii_case(one)))
    };
    let (mut answers, mut points) = (Vec::new(), Vec::new());
    for path in paths {
        match path {
            path if ends_with(path, &["json"]) => answers.push(read_session(path)),
            path if ends_with(path, &PICTURES) => answers.push(Answer::Integrand(made_of("image", path))),
            path => points.push(path.clone()),
        }
    }
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
        (true, 1) => "Drop to add this file or folder as a set; a picture is integrated, a session opens".to_string(),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_integrated_and_points_are_one_set() {
        let paths = ["a.csv", "b.PNG", "c", "d.exr"].map(PathBuf::from);
        let picture = |name: &str| Answer::Integrand(format!("image:file={name}"));
        let points = Answer::Points(["a.csv", "c"].map(PathBuf::from).to_vec());
        assert_eq!(taken(&paths), [picture("b.PNG"), picture("d.exr"), points]);
    }
}
