//! A result replaced file by file, and what a killed run began, finished by the next one.
//!
//! The stage holds the `new` files, room for the `old` ones, and, from the moment when the new ones are whole, a note of what
//! was to be done: from then on the way is forward only.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::swap::take_back;

/// What was to be done.
#[derive(Serialize, Deserialize)]
struct Note {
    /// Where the result goes.
    dir: PathBuf,
    /// The names of the new files, if they are moved one by one; `None` if the directory is swapped.
    moved: Option<Vec<String>>,
}

const NOTE: &str = "note.json";

/// Writes the note, whole or not at all.
pub(super) fn note(stage: &Path, dir: &Path, moved: Option<&[&str]>) -> io::Result<()> {
    let moved = moved.map(|names| names.iter().map(|name| name.to_string()).collect());
    let note = Note { dir: dir.to_path_buf(), moved };
    fs::write(stage.join("note"), serde_json::to_vec(&note).map_err(io::Error::other)?)?;
    fs::rename(stage.join("note"), stage.join(NOTE))
}

/// Drops the note of what is done: while a stage is removed, a part of it must not be taken for a beginning.
pub(super) fn settle(stage: &Path) -> io::Result<()> {
    match fs::remove_file(stage.join(NOTE)) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}

/// Puts the new files of a stage in `dir`, of all that there may be, in place of those that are there. On failure everything is
/// put back.
pub(super) fn replace(names: &[&str], dir: &Path, stage: &Path, new: &[&str]) -> io::Result<()> {
    let old = stage.join("old");
    fs::create_dir_all(&old)?;
    note(stage, dir, Some(new))?;
    let mut moved = Vec::new();
    forward(names, dir, stage, new, &mut moved).inspect_err(|_| {
        // Nothing better can be done about a second failure than to go on with the rest.
        moved.iter().rev().for_each(|(from, to)| _ = fs::rename(to, from));
    })
}

/// All moves that are left of a replacement, from whatever point it had come to: the mark, which is last in both lists, goes
/// first and comes last.
fn forward(
    names: &[&str],
    dir: &Path,
    stage: &Path,
    new: &[&str],
    moved: &mut Vec<(PathBuf, PathBuf)>,
) -> io::Result<()> {
    let there = |path: &Path| path.symlink_metadata().is_ok();
    let mut go = |from: PathBuf, to: PathBuf| -> io::Result<()> {
        fs::rename(&from, &to)?;
        moved.push((from, to));
        Ok(())
    };
    let (staged, old) = (stage.join("new"), stage.join("old"));
    for name in names.iter().rev() {
        // What is new and no longer staged has arrived.
        let arrived = new.contains(name) && !there(&staged.join(name));
        if !arrived && there(&dir.join(name)) {
            go(dir.join(name), old.join(name))?;
        }
    }
    for name in new.iter().filter(|name| there(&staged.join(name))) {
        go(staged.join(name), dir.join(name))?;
    }
    Ok(())
}

/// Finishes what the writer of a stage had begun, and says whether nothing is in there that somebody may miss.
pub(super) fn done(stage: &Path, names: &[&str]) -> bool {
    let known = |entry: fs::DirEntry| ["new", "old", "note", NOTE].iter().any(|name| entry.file_name() == **name);
    if !fs::read_dir(stage).is_ok_and(|entries| entries.flatten().all(known)) {
        return false;
    }
    let Some(note) = fs::read(stage.join(NOTE)).ok().and_then(|text| serde_json::from_slice::<Note>(&text).ok()) else {
        // Nothing had been moved yet.
        return true;
    };
    let finished = match note.moved {
        // Before the swap there are only files of ours.
        None => take_back(names, &stage.join("new"), &note.dir),
        Some(new) => {
            let new: Vec<&str> = new.iter().map(String::as_str).collect();
            forward(names, &note.dir, stage, &new, &mut Vec::new())
        }
    };
    finished.and_then(|()| settle(stage)).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 4] = ["pcf.csv", "pcf.svg", "gone.csv", "summary.json"];
    const NEW: [&str; 3] = ["pcf.csv", "pcf.svg", "summary.json"];

    /// A directory with an old result and somebody's notes, and a stage with a new one.
    fn set_up(root: &Path) -> (PathBuf, PathBuf) {
        let (dir, stage) = (root.join("dir"), root.join(".pairwave-x"));
        for path in [&dir, &stage, &stage.join("new"), &stage.join("old")] {
            fs::create_dir_all(path).unwrap();
        }
        for name in ["pcf.csv", "gone.csv", "summary.json", "notes.txt"] {
            fs::write(dir.join(name), format!("old {name}")).unwrap();
        }
        NEW.iter().for_each(|name| fs::write(stage.join("new").join(name), format!("new {name}")).unwrap());
        (dir, stage)
    }

    fn texts(dir: &Path) -> Vec<String> {
        let mut all: Vec<_> =
            fs::read_dir(dir).unwrap().map(|e| fs::read_to_string(e.unwrap().path()).unwrap()).collect();
        all.sort();
        all
    }

    const WHOLE: [&str; 4] = ["new pcf.csv", "new pcf.svg", "new summary.json", "old notes.txt"];

    #[test]
    fn a_failed_replacement_restores_the_old_result() {
        let root = tempfile::tempdir().unwrap();
        let (dir, stage) = set_up(root.path());
        let before = texts(&dir);
        // Where a file should go there is a directory that is not empty.
        fs::create_dir_all(stage.join("old/gone.csv/x")).unwrap();
        assert!(replace(&NAMES, &dir, &stage, &NEW).is_err());
        assert_eq!(texts(&dir), before);
        fs::remove_dir_all(stage.join("old/gone.csv")).unwrap();
        replace(&NAMES, &dir, &stage, &NEW).unwrap();
        assert_eq!(texts(&dir), WHOLE);
    }

    /// Killed after any of its moves, a replacement is finished by the next run, and what is not ours stays.
    #[test]
    fn a_killed_replacement_is_finished() {
        for kept in 0..=6 {
            let root = tempfile::tempdir().unwrap();
            let (dir, stage) = set_up(root.path());
            note(&stage, &dir, Some(&NEW)).unwrap();
            let mut moved = Vec::new();
            forward(&NAMES, &dir, &stage, &NEW, &mut moved).unwrap();
            assert_eq!(moved.len(), 6);
            moved[kept..].iter().rev().for_each(|(from, to)| fs::rename(to, from).unwrap());
            crate::stage::sweep(root.path(), |left| done(left, &NAMES));
            assert_eq!(texts(&dir), WHOLE, "killed after {kept} moves");
            assert!(!stage.exists());
        }
    }

    /// Killed while it removes what it no longer needs, a run leaves what the next one can remove, in whatever order files go.
    #[test]
    fn a_killed_removal_is_finished() {
        for moved in [None, Some(&NEW[..])] {
            for gone in ["new", "old"] {
                let root = tempfile::tempdir().unwrap();
                let (dir, stage) = set_up(root.path());
                let before = texts(&dir);
                note(&stage, &dir, moved).unwrap();
                settle(&stage).unwrap();
                fs::remove_dir_all(stage.join(gone)).unwrap();
                crate::stage::sweep(root.path(), |left| done(left, &NAMES));
                assert_eq!(texts(&dir), before, "{moved:?} without {gone}");
                assert!(!stage.exists(), "{moved:?} without {gone}");
            }
        }
    }

    #[test]
    fn a_killed_swap_gives_back_what_is_not_ours() {
        let root = tempfile::tempdir().unwrap();
        let (dir, stage) = set_up(root.path());
        note(&stage, &dir, None).unwrap();
        fs::rename(&dir, root.path().join("away")).unwrap();
        fs::rename(stage.join("new"), &dir).unwrap();
        fs::rename(root.path().join("away"), stage.join("new")).unwrap();
        crate::stage::sweep(root.path(), |left| done(left, &NAMES));
        assert_eq!(texts(&dir), WHOLE);
        assert!(!stage.exists());
    }

    #[test]
    fn a_stage_without_a_note_is_dropped_and_others_are_left_alone() {
        let root = tempfile::tempdir().unwrap();
        let (dir, stage) = set_up(root.path());
        let before = texts(&dir);
        assert!(done(&stage, &NAMES));
        assert_eq!(texts(&dir), before);
        fs::write(stage.join("mine.txt"), "somebody's").unwrap();
        assert!(!done(&stage, &NAMES));
    }
}
