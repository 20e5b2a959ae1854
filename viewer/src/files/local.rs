//! Files of the computer, asked for in its own dialogs.

use std::io::{ErrorKind, Write as _};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::{Answer, Choice, Files, PICTURES, made_of, read_session};

/// Those of the computer. Each dialog is waited for on a thread of its own.
pub struct LocalFiles {
    sender: Sender<Answer>,
    receiver: Receiver<Answer>,
    notify: Arc<dyn Fn() + Send + Sync>,
    has_dialogs: bool,
}

impl LocalFiles {
    /// `notify` is called from another thread when there is an answer.
    pub fn new(notify: impl Fn() + Send + Sync + 'static) -> Self {
        let (sender, receiver) = channel();
        Self { sender, receiver, notify: Arc::new(notify), has_dialogs: has_dialogs() }
    }

    fn answer(&self, answer: Answer) {
        // The other end is ours.
        let _ = self.sender.send(answer);
        (self.notify)();
    }

    /// Waits for what a person chooses, and answers.
    fn wait<T: Send + 'static>(
        &self,
        dialog: impl Future<Output = Option<T>> + Send + 'static,
        then: impl FnOnce(T) -> Answer + Send + 'static,
    ) {
        let (sender, notify) = (self.sender.clone(), self.notify.clone());
        let wait = move || {
            if let Some(chosen) = pollster::block_on(dialog) {
                let _ = sender.send(then(chosen));
                notify();
            }
        };
        if let Err(error) = std::thread::Builder::new().name("pairwave dialog".into()).spawn(wait) {
            self.answer(Answer::Failed(format!("no dialog could be opened: {error}")));
        }
    }
}

/// Whether this desktop can ask for files: through its portal, or zenity.
fn has_dialogs() -> bool {
    let portal = || std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some_and(|address| !address.is_empty());
    let zenity = || {
        let path = std::env::var_os("PATH").unwrap_or_default();
        std::env::split_paths(&path).any(|folder| folder.join("zenity").is_file())
    };
    cfg!(not(all(unix, not(target_os = "macos")))) || portal() || zenity()
}

impl Files for LocalFiles {
    fn choose(&mut self, what: Choice) {
        if !self.has_dialogs {
            let instead = match what {
                Choice::Integrand("image") => "drop the picture on the window, or type image:file=PATH as an integrand",
                Choice::Integrand(_) => "add another integrand and type NAME:file=PATH in its place",
                Choice::Session => "drop the session on the window, or start with --session FILE",
                _ => "drop files on the window, or type a path under Points",
            };
            return self
                .answer(Answer::Failed(format!("This desktop has no file dialogs (no portal, no zenity): {instead}")));
        }
        // Dialogs are made here, since some systems make them on the main thread only.
        let dialog = rfd::AsyncFileDialog::new();
        let paths = |files: Vec<rfd::FileHandle>| files.iter().map(|f| f.path().to_path_buf()).collect();
        match what {
            Choice::Points => {
                self.wait(dialog.set_title("Points").pick_files(), move |files| Answer::Points(paths(files)));
            }
            Choice::Folder => {
                let folder = dialog.set_title("A folder of points").pick_folder();
                self.wait(folder, |folder| Answer::Points(vec![folder.path().to_path_buf()]));
            }
            Choice::Integrand(name) => {
                let dialog = dialog.set_title("A function to integrate");
                let dialog = if name == "image" { dialog.add_filter("picture", &PICTURES) } else { dialog };
                self.wait(dialog.pick_file(), move |file| Answer::Integrand(made_of(name, file.path())));
            }
            Choice::Session => {
                let dialog = dialog.set_title("A session").add_filter("session", &["json"]);
                self.wait(dialog.pick_file(), |file| read_session(file.path()));
            }
        }
    }

    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        if self.has_dialogs {
            // It asks before it lets a file be replaced.
            let dialog = rfd::AsyncFileDialog::new().set_title("Save").set_file_name(name);
            self.wait(dialog.save_file(), move |file| write(file.path(), &bytes));
        } else {
            let folder = std::env::current_dir().unwrap_or_default();
            self.answer(write_beside(&folder, name, &bytes));
        }
    }

    fn answers(&mut self) -> Vec<Answer> {
        self.receiver.try_iter().collect()
    }
}

fn write(path: &Path, bytes: &[u8]) -> Answer {
    match std::fs::write(path, bytes) {
        Ok(()) => Answer::Saved(path.into()),
        Err(error) => Answer::Failed(format!("{}: {error}", path.display())),
    }
}

/// Writes into a folder, under the first of `name.csv`, `name-2.csv`, ... that is free.
fn write_beside(folder: &Path, name: &str, bytes: &[u8]) -> Answer {
    let given = Path::new(name);
    let (stem, extension) = (given.file_stem().unwrap_or_default(), given.extension().unwrap_or_default());
    for copy in 1..1000 {
        let number = if copy == 1 { String::new() } else { format!("-{copy}") };
        let path = folder.join(format!("{}{number}.{}", stem.to_string_lossy(), extension.to_string_lossy()));
        match std::fs::File::create_new(&path).and_then(|mut file| file.write_all(bytes)) {
            Ok(()) => return Answer::Saved(path),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Answer::Failed(format!("{}: {error}", path.display())),
        }
    }
    Answer::Failed(format!("{name}: a thousand files have this name already; remove some"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_saved_without_a_dialog_replaces_nothing() {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in [("a.csv", b"1"), ("a-2.csv", b"2"), ("a-3.csv", b"3")] {
            assert_eq!(write_beside(folder.path(), "a.csv", bytes), Answer::Saved(folder.path().join(name)));
        }
        assert_eq!(std::fs::read(folder.path().join("a.csv")).unwrap(), b"1");
        let nowhere = write_beside(&folder.path().join("nowhere"), "a.csv", b"1");
        assert!(matches!(nowhere, Answer::Failed(text) if text.contains("nowhere")));
    }
}
