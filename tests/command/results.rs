//! A result is whole or absent, whatever happens to the processes that write it.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::shared::{Scratch, summary};

/// The names in a directory, stages of killed runs apart.
fn names(dir: &Path) -> BTreeSet<String> {
    let names = std::fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    names.filter(|name| !name.starts_with(".pairwave-")).collect()
}

/// What a run into `dir` is started with.
fn analyze(scratch: &Scratch, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pairwave"));
    command.current_dir(scratch.0.path()).args(format!("analyze {arguments} --device cpu --quiet").split(' '));
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

#[test]
fn killed_at_any_moment_a_replacement_leaves_the_old_or_the_new() {
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler random -n 9 --stats spectrum --device cpu --quiet --out out");
    std::fs::create_dir(scratch.path("out/own")).unwrap();
    for (name, text) in [("out/notes.txt", "mine"), ("out/own/too.txt", "mine too")] {
        scratch.file(name, text);
    }
    for wait in 0..40 {
        // A run takes some 20 ms.
        let n = 9 + wait % 3;
        let mut run = analyze(&scratch, &format!("--sampler random -n {n} --stats pcf,spectrum --force --out out"));
        let mut run = run.spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait));
        run.kill().unwrap();
        run.wait().unwrap();
        let summary = summary(&scratch.path("out"));
        let files = summary["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap().to_string());
        let mut expected: BTreeSet<String> = files.collect();
        // What is not ours is there, or where the next run finds it.
        for (own, text) in [("notes.txt", "mine"), ("own/too.txt", "mine too")] {
            let staged = std::fs::read_dir(scratch.0.path()).unwrap().map(|e| e.unwrap().path().join("new"));
            let mut places = std::iter::once(scratch.path("out")).chain(staged);
            let place =
                places.find(|place| place.join(own).exists()).unwrap_or_else(|| panic!("{own} after {wait} ms"));
            assert_eq!(std::fs::read_to_string(place.join(own)).unwrap(), text);
            if place == scratch.path("out") {
                expected.extend(own.split('/').next().map(str::to_string));
            }
        }
        assert_eq!(names(&scratch.path("out")), expected, "killed after {wait} ms");
    }
    // The next run tidies up.
    scratch.ok("analyze --sampler random -n 9 --device cpu --quiet --force --out out");
    let here = std::fs::read_dir(scratch.0.path()).unwrap().map(|e| e.unwrap().file_name()).collect::<Vec<_>>();
    assert_eq!(here, ["out"]);
    for (own, text) in [("notes.txt", "mine"), ("own/too.txt", "mine too")] {
        assert_eq!(std::fs::read_to_string(scratch.path(&format!("out/{own}"))).unwrap(), text);
    }
}

#[test]
fn of_two_runs_into_one_directory_one_wins() {
    for there in [false, true] {
        let scratch = Scratch::new();
        if there {
            std::fs::create_dir(scratch.path("out")).unwrap();
        }
        let run = |sampler: &str| analyze(&scratch, &format!("--sampler {sampler} -n 9 --out out")).spawn().unwrap();
        let runs = [run("random"), run("jittered"), run("random"), run("jittered")];
        let codes = runs.map(|mut run| run.wait().unwrap().code().unwrap());
        assert_eq!(codes.iter().filter(|code| **code == 0).count(), 1, "{codes:?}");
        let summary = summary(&scratch.path("out"));
        let files = summary["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap().to_string());
        assert_eq!(names(&scratch.path("out")), files.collect());
    }
}

/// Nobody can be told that standard error is closed or full: the work is done all the same.
#[test]
fn a_full_standard_error_harms_nothing() {
    let Ok(full) = std::fs::OpenOptions::new().write(true).open("/dev/full") else { return };
    let scratch = Scratch::new();
    let mut run = analyze(&scratch, "--sampler random -n 9 --out out");
    assert_eq!(run.stderr(full.try_clone().unwrap()).status().unwrap().code(), Some(0));
    let mut run = analyze(&scratch, "nowhere.csv --out another");
    assert_eq!(run.stderr(full).status().unwrap().code(), Some(1));
}

/// Without memory there is an error that says how much was wanted, and no trace of calls.
#[test]
#[cfg(unix)]
fn no_memory_is_an_error() {
    let scratch = Scratch::new();
    let program = env!("CARGO_BIN_EXE_pairwave");
    let line = format!(
        "ulimit -v 400000; exec {program} analyze --sampler random -n 99 --stats spectrum --max-frequency 5000 \
         --device cpu --out out"
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(scratch.0.path()).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("error: memory: ") && said.contains(" bytes more were wanted"), "{said}");
    assert!(names(scratch.0.path()).is_empty());
}

/// An integral that is looked for in vain, for many times the time that is waited.
#[cfg(unix)]
#[test]
fn an_interrupt_ends_what_does_not_look_for_it() {
    use std::io::{BufRead, BufReader};

    let scratch = Scratch::new();
    let mut command = Command::new(env!("CARGO_BIN_EXE_pairwave"));
    command.current_dir(scratch.0.path()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.args("integrate --sampler jittered -n 64 --integrand formula:1+x --device cpu".split(' '));
    command.args("--intensity formula:x^3 --by removal --out out".split(' '));
    let mut run = command.spawn().unwrap();
    // By its first line it listens.
    let mut first = String::new();
    BufReader::new(run.stdout.take().unwrap()).read_line(&mut first).unwrap();
    assert!(first.starts_with("n = 64"), "{first}");
    assert!(Command::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap().success());
    let found = run.wait_with_output().unwrap();
    let said = String::from_utf8(found.stderr).unwrap();
    assert_eq!(found.status.code(), Some(130), "{said}");
    assert!(said.contains("error: cancelled"), "{said}");
    assert_eq!(std::fs::read_dir(scratch.0.path()).unwrap().count(), 0);
}
