//! Shared by the tests of this room.

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;

/// A fresh directory per test, removed at its end.
pub struct Scratch(pub tempfile::TempDir);

impl Scratch {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn file(&self, name: &str, content: &str) -> PathBuf {
        std::fs::write(self.path(name), content).unwrap();
        self.path(name)
    }

    pub fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pairwave"));
        // Mesa complains on stderr without one.
        command.current_dir(self.0.path()).env("XDG_RUNTIME_DIR", self.0.path());
        command
    }

    /// Runs pairwave here; arguments are separated by blanks.
    pub fn run(&self, arguments: &str) -> Output {
        self.command().args(arguments.split_whitespace()).output().unwrap()
    }

    pub fn ok(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "`pairwave {arguments}` failed: {errors}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs what must fail, with this code, saying this.
    pub fn fails(&self, arguments: &str, code: i32, said: &str) {
        let output = self.run(arguments);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "`pairwave {arguments}`: {errors}");
        assert!(errors.contains(said), "`pairwave {arguments}`: {errors}");
    }
}

/// The columns of a CSV file by name.
pub fn table(path: &Path) -> std::collections::BTreeMap<String, Vec<String>> {
    let (header, rows) = csv(path);
    let column = |k: usize| rows.iter().map(|row| row[k].clone()).collect();
    header.split(',').enumerate().map(|(k, name)| (name.to_string(), column(k))).collect()
}

/// A CSV file as header and columns of text.
pub fn csv(path: &Path) -> (String, Vec<Vec<String>>) {
    let text = std::fs::read_to_string(path).unwrap();
    let header = text.lines().next().unwrap().to_string();
    let rows = text.lines().skip(1).map(|l| l.split(',').map(str::to_string).collect()).collect();
    (header, rows)
}

pub fn column<T: std::str::FromStr>(table: &(String, Vec<Vec<String>>), name: &str) -> Vec<T>
where
    T::Err: std::fmt::Debug,
{
    let k = table.0.split(',').position(|h| h == name).unwrap_or_else(|| panic!("no column {name} in {}", table.0));
    table.1.iter().map(|row| row[k].parse().unwrap()).collect()
}

pub fn npy(path: &Path) -> (Vec<u64>, Vec<f64>) {
    let file = npyz::NpyFile::new(std::io::BufReader::new(std::fs::File::open(path).unwrap())).unwrap();
    (file.shape().to_vec(), file.into_vec::<f64>().unwrap())
}

pub fn summary(dir: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(dir.join("summary.json")).unwrap()).unwrap()
}

/// Runs pairwave where the committed data lie.
pub fn in_data(arguments: &str) -> Output {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data");
    Command::new(env!("CARGO_BIN_EXE_pairwave")).current_dir(data).args(arguments.split_whitespace()).output().unwrap()
}
