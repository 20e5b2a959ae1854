//! Parts of a batch that are merged, runs that are stopped, killed and gone on with: the bytes are those of one run. Cannot see: a power
//! failure.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::shared::{Scratch, summary};

/// What is measured: pairs, power, neighbours, amplitudes and integrals, of 70 realizations, which are no whole leaves.
const RUN: &str = "--sampler jittered -n 64 -k 70 --device cpu --stats pcf,spectrum,neighbors,covariance,counts --covariance-frequency 2 \
                   --integrand disk --quiet";

/// Everything that does not tell of times and commands.
fn bytes(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = std::fs::read_dir(dir).unwrap().map(|file| file.unwrap().path());
    let named =
        files.map(|path| (path.file_name().unwrap().to_str().unwrap().to_string(), std::fs::read(&path).unwrap()));
    named
        .filter(|(name, _)| !["summary.json", "report.html", "partial.sums", "run.toml"].contains(&name.as_str()))
        .collect()
}

/// The summary without what differs between runs.
fn said(dir: &Path) -> serde_json::Value {
    let mut summary = summary(dir);
    let all = summary.as_object_mut().unwrap();
    for differs in ["timings_seconds", "parameters"] {
        all.remove(differs);
    }
    summary
}

fn assert_same(scratch: &Scratch, whole: &str, other: &str) {
    let (whole, other) = (scratch.path(whole), scratch.path(other));
    let (a, b) = (bytes(&whole), bytes(&other));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>(), "{}", other.display());
    let differing: Vec<&String> = a.keys().filter(|name| a[*name] != b[*name]).collect();
    assert!(differing.is_empty(), "{}: {differing:?}", other.display());
    assert_eq!(said(&whole), said(&other), "{}", other.display());
}

#[test]
fn shards_in_any_order_are_the_whole() {
    let scratch = Scratch::new();
    scratch.ok(&format!("analyze {RUN} --out whole"));
    for part in 1..=3 {
        scratch.ok(&format!("analyze {RUN} --shard {part}/3 --out parts/{part}"));
        assert_eq!(std::fs::read_dir(scratch.path(&format!("parts/{part}"))).unwrap().count(), 1);
    }
    for (k, order) in ["parts/1 parts/2 parts/3", "parts/3 parts/1 parts/2", "parts/2/partial.sums parts/3 parts/1"]
        .iter()
        .enumerate()
    {
        scratch.ok(&format!("merge {order} --out merged{k}"));
        assert_same(&scratch, "whole", &format!("merged{k}"));
    }
    // A merge may be merged again.
    scratch.ok("merge parts/3 parts/2 --partial --keep-sums --out some --quiet");
    let few = summary(&scratch.path("some"));
    let warnings = few["warnings"].to_string();
    assert!(warnings.contains("54 of 70 realizations were merged; the others, 1-16, are missing"), "{warnings}");
    scratch.ok("merge some parts/1 --out again --quiet");
    let (a, b) = (bytes(&scratch.path("whole")), bytes(&scratch.path("again")));
    assert!(a == b, "a merge of a merge");
    scratch.fails(
        "merge parts/1 parts/3 --out x",
        1,
        "merge: no part has the realizations 17-48; --partial does without them",
    );
    scratch.fails("merge parts/1 parts/2 parts/1 --out x", 1, "parts/1: merge: both parts hold realizations 1 to 16");
    scratch.ok(&format!("analyze {} --shard 2/3 --out other", RUN.replace("-n 64", "-n 81")));
    scratch.fails(
        "merge parts/1 other --out x",
        1,
        "other: merge: the parts are not of the same measurement: points, n: 64, against 81",
    );
    scratch.fails("merge nowhere --out x", 1, "nowhere: No such file");
    scratch.fails("merge whole --out x", 1, "whole: holds no partial.sums; expected a directory that --shard");
    std::fs::write(scratch.path("parts/1/partial.sums"), b"nothing").unwrap();
    scratch.fails("merge parts/1 parts/2 --out x", 1, "partial.sums: ");
    assert!(!scratch.path("x").exists());
}

#[test]
fn what_cannot_be_a_part_is_said() {
    let scratch = Scratch::new();
    for (arguments, said) in [
        (
            format!("{RUN} --shard 6/6 --out x"),
            "--shard 6/6: expected I/N with 1 <= I <= N <= 5: 70 realizations are summed 16 at a time",
        ),
        (format!("{RUN} --shard 3/2 --out x"), "expected I/N with 1 <= I <= N, as 3/20"),
        (format!("{RUN} --envelope 19 --shard 1/2 --out x"), "--shard 1/2: --envelope needs all realizations at once"),
        (format!("{RUN} --time-limit soon"), "expected a number of seconds, 0 or more"),
        (format!("{RUN} --checkpoint 1"), "--out"),
        (format!("{RUN} --prefixes 4..8 --time-limit 1"), "--time-limit (given): is of one measurement"),
    ] {
        scratch.fails(&format!("analyze {arguments}"), 2, said);
    }
    assert!(!scratch.path("x").exists());
}

#[test]
fn out_of_time_it_is_gone_on_with() {
    let scratch = Scratch::new();
    scratch.ok(&format!("analyze {RUN} --out whole"));
    let first = scratch.run(&format!("analyze {RUN} --time-limit 0 --out out"));
    let told = String::from_utf8(first.stderr).unwrap();
    assert!(
        first.status.success()
            && told.contains("16 of 70 realizations are kept in out: the same command with --resume goes on"),
        "{told}"
    );
    let part = summary(&scratch.path("out"));
    assert_eq!(part["k"], 16, "{part}");
    assert!(
        part["warnings"]
            .to_string()
            .contains("this is not all that was asked for: 16 of 70 realizations were measured")
    );
    scratch.fails(&format!("analyze {RUN} --out out"), 2, "--out out: holds a result already; --force replaces it");
    scratch.fails(
        &format!("analyze {} --resume --out out", RUN.replace("-n 64", "-n 81")),
        1,
        "points, n: 81, against 64",
    );
    // As often as it takes.
    for _ in 0..2 {
        scratch.ok(&format!("analyze {RUN} --time-limit 0 --resume --out out"));
    }
    scratch.ok(&format!("analyze {RUN} --resume --out out"));
    assert_same(&scratch, "whole", "out");
    scratch.fails(&format!("analyze {RUN} --resume --out out"), 2, "holds a result that is whole");
    // A shard too; and where nothing was begun, it begins.
    for part in 1..=2 {
        scratch.ok(&format!("analyze {RUN} --shard {part}/2 --time-limit 0 --resume --out part{part}"));
        scratch.fails(
            &format!("analyze {RUN} --shard {part}/2 --out part{part}"),
            2,
            "holds a run that is not over: --resume goes on with it",
        );
        scratch.ok(&format!("analyze {RUN} --shard {part}/2 --resume --out part{part}"));
    }
    scratch.fails(&format!("analyze {RUN} --shard 1/2 --resume --out part2"), 1, "expected realizations 1 to 32 only");
    scratch.ok("merge part1 part2 --out merged --quiet");
    assert_same(&scratch, "whole", "merged");
}

#[test]
fn realizations_are_added_to_a_result() {
    let scratch = Scratch::new();
    // Points that F is looked at from and windows that are counted in depend on K: they stay those of the first.
    let run = RUN.replace("neighbors,covariance,counts", "covariance");
    scratch.ok(&format!("analyze {run} --out whole"));
    scratch.ok(&format!("analyze {} --keep-sums --out few", run.replace("-k 70", "-k 37")));
    scratch.ok(&format!("analyze {run} --extend few --out more"));
    let (whole, more) = (scratch.path("whole"), scratch.path("more"));
    assert!(bytes(&whole) == bytes(&more) && summary(&whole)["integration"] == summary(&more)["integration"]);
    assert_eq!(summary(&whole)["warnings"], summary(&more)["warnings"]);
    let fewer = run.replace("-k 70", "-k 20");
    scratch.fails(&format!("analyze {fewer} --extend few --out less"), 1, "expected realizations 1 to 20 only");
    scratch.ok(&format!("analyze {} --keep-sums --out all", RUN.replace("-k 70", "-k 37")));
    scratch.ok(&format!("analyze {RUN} --extend all --out all70"));
    assert_eq!(summary(&scratch.path("all70"))["k"], 70);
    let finer = RUN.replace("--quiet", "--quiet --bins 17");
    scratch.fails(
        &format!("analyze {finer} --extend all --out less"),
        1,
        "all: merge: the parts are not of the same measurement: sums, g(r), edges",
    );
    // Of files, the same first and others after them.
    for (k, name) in [(20, "20.npy"), (40, "40.npy")] {
        scratch.ok(&format!("sample jittered -n 64 -k {k} --quiet --out {name}"));
    }
    scratch.ok("sample jittered -n 64 -k 40 --seed 2 --quiet --out others.npy");
    let files = "--stats pcf,spectrum --device cpu --quiet";
    scratch.ok(&format!("analyze 40.npy {files} --out of_files"));
    scratch.ok(&format!("analyze 20.npy {files} --keep-sums --out of_few"));
    scratch.ok(&format!("analyze 40.npy {files} --extend of_few --out of_more"));
    let (whole, more) = (scratch.path("of_files"), scratch.path("of_more"));
    assert!(bytes(&whole) == bytes(&more));
    assert_eq!((&summary(&whole)["subject"], &summary(&whole)["k"]), (&summary(&more)["subject"], &40.into()));
    scratch.fails(
        &format!("analyze others.npy {files} --extend of_few --out less"),
        1,
        "of_few: merge: the parts are not",
    );
    // Other points are not added to.
    let other = run.replace("jittered", "random");
    scratch.fails(
        &format!("analyze {other} --extend few --out less"),
        1,
        "few: merge: the parts are not of the same measurement: points",
    );
    assert!(!scratch.path("less").exists());
}

/// Whether something half-written is left in a directory.
fn stages(dir: &Path) -> bool {
    std::fs::read_dir(dir).unwrap().any(|entry| entry.unwrap().file_name().to_string_lossy().starts_with(".pairwave-"))
}

/// A run that writes its sums as often as it can, killed again and again.
#[test]
fn killed_at_any_moment_nothing_that_was_kept_is_lost() {
    let scratch = Scratch::new();
    let run = RUN.replace("-k 70", "-k 600");
    scratch.ok(&format!("analyze {run} --out whole"));
    let mut kills = 0;
    for attempt in 0.. {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pairwave"));
        command
            .current_dir(scratch.0.path())
            .args(format!("analyze {run} --checkpoint 0 --resume --out out").split_whitespace());
        let mut run = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // At first at random moments, then as long as it takes.
        if attempt < 12 {
            std::thread::sleep(Duration::from_millis(15 + 37 * attempt % 120));
        } else {
            run.wait().unwrap();
        }
        match run.try_wait().unwrap() {
            Some(status) => {
                assert!(status.success(), "after {kills} kills: {status}");
                break;
            }
            None => {
                run.kill().unwrap();
                run.wait().unwrap();
                kills += 1;
                // Killed when all was written: there is nothing to go on with.
                let there = |name: &str| scratch.path("out").join(name).exists();
                if there("summary.json") && !there("partial.sums") {
                    break;
                }
            }
        }
    }
    assert!(kills > 3, "{kills} kills");
    assert_same(&scratch, "whole", "out");
    assert!(!scratch.path("out/partial.sums").exists() && !stages(&scratch.path("out")));
    assert_eq!(std::fs::read_dir(scratch.0.path()).unwrap().count(), 2, "nothing else is left");
}

/// Ctrl-C and the end of a job: what is done is a result, and is gone on with.
#[cfg(unix)]
#[test]
fn interrupted_it_leaves_a_result() {
    for signal in ["INT", "TERM"] {
        let scratch = Scratch::new();
        let run = RUN.replace("-k 70", "-k 100000");
        let mut command = Command::new(env!("CARGO_BIN_EXE_pairwave"));
        command
            .current_dir(scratch.0.path())
            .args(format!("analyze {run} --checkpoint 0 --out out").split_whitespace());
        let running = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        // The first sums are written.
        while !scratch.path("out/partial.sums").exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        Command::new("kill").args([format!("-{signal}"), running.id().to_string()]).status().unwrap();
        let output = running.wait_with_output().unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(130), "{told}");
        assert!(
            told.contains("error: cancelled; ")
                && told.contains(" of 100000 realizations are kept in out: the same command with --resume goes on"),
            "{told}"
        );
        let done = summary(&scratch.path("out"))["k"].as_u64().unwrap();
        assert!((16..100_000).contains(&done) && done.is_multiple_of(16), "{done}");
        // Fewer than were asked for are a result like any other, but for what is planned by their number.
        scratch.ok(&format!("analyze {} --out whole", RUN.replace("-k 70", &format!("-k {done}"))));
        let (whole, out) = (bytes(&scratch.path("whole")), bytes(&scratch.path("out")));
        for name in ["pcf.csv", "spectrum.npy"] {
            assert!(whole[name] == out[name], "{name}");
        }
    }
}

/// The steps of an array of jobs, one after the other where there is no cluster; a second time nothing is done again.
#[cfg(unix)]
#[test]
fn a_cluster_is_an_array_of_parts() {
    let scratch = Scratch::new();
    let run = RUN.replace(" --quiet", "");
    scratch.ok(&format!("analyze {run} --quiet --out whole"));
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/slurm/run.sh");
    let steps = || {
        let mut command = Command::new("bash");
        command.arg(script).args(["3", "out"]).args(run.split_whitespace()).current_dir(scratch.0.path());
        command.env("PAIRWAVE", env!("CARGO_BIN_EXE_pairwave")).env("PATH", "/usr/bin:/bin").output().unwrap()
    };
    let first = steps();
    assert!(first.status.success(), "{}", String::from_utf8_lossy(&first.stderr));
    assert_same(&scratch, "whole", "out");
    let second = String::from_utf8(steps().stderr).unwrap();
    assert!(second.contains("--out out: holds a result already"), "{second}");
}

/// Files are scanned once, before the parts, which read their own; by processes one after the other, and by jobs that wait for each other.
#[cfg(unix)]
#[test]
fn a_cluster_scans_files_once() {
    /// A queue that runs each job as it comes, and notes what it was asked for.
    const SBATCH: &str = r#"#!/bin/bash
        echo "$*" >>"$0.log"
        while (($#)); do
            case $1 in --array=1-*) last=${1#--array=1-} ;; --wrap) wrap=$2 && shift ;; esac
            shift
        done
        for ((k = 1; k <= ${last:-1}; k++)); do SLURM_ARRAY_TASK_ID=$k bash -c "$wrap" >&2 || exit 1; done
        wc -l <"$0.log"
    "#;
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.path("runs")).unwrap();
    std::fs::create_dir(scratch.path("queue")).unwrap();
    for k in 0..40 {
        scratch.ok(&format!("sample random -n 50 -k 1 --seed {k} --quiet --out runs/{k:02}.csv"));
    }
    let run = "--stats pcf,spectrum --device cpu";
    scratch.ok(&format!("analyze runs --box 1,1 {run} --quiet --out whole"));
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/slurm/run.sh");
    let steps = |out: &str, path: &str| {
        let mut command = Command::new("bash");
        let arguments = format!("{script} 2 {out} runs --box 1,1 -- {run}");
        command.args(arguments.split_whitespace()).current_dir(scratch.0.path());
        command.env("PAIRWAVE", env!("CARGO_BIN_EXE_pairwave")).env("PATH", format!("{path}/usr/bin:/bin"));
        let output = command.output().unwrap();
        (output.status.success(), String::from_utf8(output.stderr).unwrap())
    };
    let (done, told) = steps("alone", "");
    assert!(done, "{told}");
    assert_same(&scratch, "whole", "alone");

    let queue = scratch.file("queue/sbatch", SBATCH);
    std::fs::set_permissions(&queue, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let (done, told) = steps("queued", &format!("{}:", scratch.path("queue").display()));
    assert!(done, "{told}");
    // A job has the threads that the queue gives it, which the device says.
    assert!(bytes(&scratch.path("whole")) == bytes(&scratch.path("queued")));
    let jobs = std::fs::read_to_string(scratch.path("queue/sbatch.log")).unwrap();
    let jobs: Vec<&str> = jobs.lines().collect();
    assert!(jobs.len() == 3 && jobs[0].contains("scan runs --box 1\\,1 "), "{jobs:?}");
    assert!(jobs[1].contains("--dependency=afterok:1 ") && jobs[1].contains("analyze queued.scan "), "{jobs:?}");
    assert!(jobs[2].contains("--dependency=afterok:2 "), "{jobs:?}");
    // Again, the scan that is there does.
    let before = std::fs::metadata(scratch.path("alone.scan")).unwrap().modified().unwrap();
    std::fs::remove_dir_all(scratch.path("alone")).unwrap();
    assert!(steps("alone", "").0);
    assert_eq!(std::fs::metadata(scratch.path("alone.scan")).unwrap().modified().unwrap(), before);
}

/// A disk that takes no file beyond 4 KiB: what was kept before stays, and what failed is said.
#[cfg(unix)]
#[test]
fn a_full_disk_takes_nothing_that_was_kept() {
    let scratch = Scratch::new();
    scratch.ok(&format!("analyze {RUN} --out whole"));
    scratch.ok(&format!("analyze {RUN} --time-limit 0 --out out"));
    let before = (bytes(&scratch.path("out")), std::fs::read(scratch.path("out/partial.sums")).unwrap());
    let full = |arguments: &str| {
        let line = format!("trap '' XFSZ; ulimit -f 8; exec {} {arguments}", env!("CARGO_BIN_EXE_pairwave"));
        let output = Command::new("sh").args(["-c", &line]).current_dir(scratch.0.path()).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, told) = full(&format!("analyze {RUN} --resume --out out"));
    assert!(
        code == Some(1) && told.contains("File too large") && told.contains("70 of 70 realizations could not be kept"),
        "{code:?} {told}"
    );
    let after = (bytes(&scratch.path("out")), std::fs::read(scratch.path("out/partial.sums")).unwrap());
    assert!(before == after, "what was there is there");
    assert!(!stages(&scratch.path("out")));
    assert_eq!(std::fs::read_dir(scratch.0.path()).unwrap().count(), 2);
    // A checkpoint that fails ends nothing, and is said with the result.
    let (code, told) = full(&format!("analyze {RUN} --checkpoint 0 --out other"));
    assert!(code == Some(1) && told.contains("File too large"), "{code:?} {told}");
    scratch.ok(&format!("analyze {RUN} --resume --out out"));
    assert_same(&scratch, "whole", "out");
}

/// A file system of its own that is too small for a result. Mounting it needs rights that not every machine gives.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_without_room_keeps_the_sums() {
    /// In a folder of its own: a run whose sums fit alone, and one whose first checkpoint leaves no room for another; both gone on with when there is room.
    const STEPS: &str = r#"
        mkdir full && mount -t tmpfs -o "size=$SMALL" none full || exit 77
        run() { name=$1; shift; "$PAIRWAVE" analyze $RUN "$@" --out "full/$name" 2>>"$name.told"; echo $? >>"$name.codes"; }
        for name in sums checkpoint; do
            [ $name = sums ] && every= || every="--checkpoint 0"
            run $name $every
            { ls -A full; ls -A "full/$name"; } >"$name.names"
            mount -o remount,size=64m full
            run $name --resume
            cp -r "full/$name" . && rm -r "full/$name"
            mount -o remount,size="$SMALL" full
        done
    "#;
    let scratch = Scratch::new();
    let run = RUN.replace(",covariance,counts --covariance-frequency 2 --integrand disk", "");
    scratch.ok(&format!("analyze {run} --out whole"));
    scratch.ok(&format!("analyze {run} --keep-sums --out kept"));
    scratch.ok(&format!("analyze {run} --time-limit 0 --out begun"));
    let size = |dir: &str| std::fs::metadata(scratch.path(dir).join("partial.sums")).unwrap().len();
    let result: u64 =
        std::fs::read_dir(scratch.path("whole")).unwrap().map(|e| e.unwrap().metadata().unwrap().len()).sum();
    let small = size("kept") + (48 << 10);
    assert!(size("begun") > 64 << 10 && result > small, "{} {result}", size("begun"));
    let tried = [&["--user", "--map-root-user", "--mount"][..], &["--mount"]].into_iter().any(|rights| {
        let mut command = Command::new("unshare");
        command.args(rights).args(["sh", "-c", STEPS]).current_dir(scratch.0.path()).env("RUN", &run);
        command.env("PAIRWAVE", env!("CARGO_BIN_EXE_pairwave")).env("SMALL", small.to_string());
        let output = command.output();
        if let Ok(output) = &output
            && output.status.success()
        {
            return true;
        }
        eprintln!("no file system of its own by unshare {}: {output:?}", rights.join(" "));
        let _ = std::fs::remove_dir(scratch.path("full"));
        false
    });
    if !tried {
        eprintln!("the disk that is full is a limit on the size of files");
        let line = format!(
            "trap '' XFSZ; ulimit -f 100; exec {} analyze {run} --checkpoint 0 --out limited",
            env!("CARGO_BIN_EXE_pairwave")
        );
        let output = Command::new("sh").args(["-c", &line]).current_dir(scratch.0.path()).output().unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(1) && told.contains("File too large"), "{told}");
        return;
    }
    let read = |name: &str| std::fs::read_to_string(scratch.path(name)).unwrap();
    for (name, said) in [
        ("sums", "70 of 70 realizations are kept in full/sums: the same command with --resume goes on"),
        ("checkpoint", " of 70 realizations of the last checkpoint are in full/checkpoint: --resume goes on with them"),
    ] {
        let told = read(&format!("{name}.told"));
        assert!(told.contains("No space left on device") && told.contains(said), "{name}: {told}");
        assert_eq!(read(&format!("{name}.codes")), "1\n0\n", "{name}: {told}");
        assert_eq!(read(&format!("{name}.names")), format!("{name}\npartial.sums\n"), "nothing else is left");
        assert_same(&scratch, "whole", name);
    }
}

#[test]
fn progress_is_told_as_json() {
    let scratch = Scratch::new();
    let run = RUN.replace("--quiet", "--progress json").replace("-k 70", "-k 30000");
    let output = scratch.run(&format!("analyze {run} --time-limit 2.5"));
    let told = String::from_utf8(output.stderr).unwrap();
    let lines: Vec<serde_json::Value> = told.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    assert!(!lines.is_empty(), "{told}");
    for line in &lines {
        let number = |key: &str| line[key].as_f64().unwrap_or_else(|| panic!("{key} in {line}"));
        assert!(
            line["stage"].is_string() && number("total") == 30_000.0 && (0.0..=1.0).contains(&number("fraction")),
            "{line}"
        );
        assert!(number("elapsed_s") > 0.0 && number("left_s") >= 0.0 && number("realizations_per_s") >= 0.0, "{line}");
    }
}

#[test]
fn a_merge_replaces_none_of_its_parts() {
    let scratch = Scratch::new();
    let run = "analyze --sampler jittered -n 64 -k 40 --device cpu --stats pcf --quiet";
    scratch.ok(&format!("{run} --shard 1/2 --out 1"));
    scratch.ok(&format!("{run} --shard 2/2 --out 2"));
    let before = bytes(&scratch.path("1"));
    for part in ["1", "1/partial.sums"] {
        scratch.fails(&format!("merge {part} 2 --out 1 --force"), 2, "is read, and would be replaced");
    }
    assert!(bytes(&scratch.path("1")) == before);
    scratch.ok("merge 1 2 --out whole --quiet");
    scratch.fails("plot whole --page whole/pcf.csv --force", 2, "is a file of a result that is drawn");
    scratch.ok("plot whole --page whole/again.html");
    scratch.ok("plot whole --page whole/again.html --force");
}

/// Two runs of one request that were given one directory: neither breaks what the other keeps there.
#[test]
fn two_runs_in_one_directory_keep_whole_sums() {
    let scratch = Scratch::new();
    scratch.ok(&format!("analyze {RUN} --out whole"));
    let start = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pairwave"));
        command.current_dir(scratch.0.path()).env("XDG_RUNTIME_DIR", scratch.0.path());
        command.args(format!("analyze {RUN} --checkpoint 0 --out out").split_whitespace());
        command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let two = [start(), start()].map(|run| run.wait_with_output().unwrap());
    let told = two.map(|output| (output.status.code(), String::from_utf8(output.stderr).unwrap()));
    assert!(told.iter().any(|(code, _)| *code == Some(0)), "{told:?}");
    assert!(bytes(&scratch.path("whole")) == bytes(&scratch.path("out")));
    assert!(!stages(&scratch.path("out")));
}

/// Parts that were given one directory by mistake: the first keeps what it wrote, the second says so.
#[test]
fn a_part_replaces_no_other() {
    let scratch = Scratch::new();
    let run = RUN.replace("-k 70", "-k 100000");
    let mut command = Command::new(env!("CARGO_BIN_EXE_pairwave"));
    command.current_dir(scratch.0.path()).env("XDG_RUNTIME_DIR", scratch.0.path());
    command.args(format!("analyze {run} --shard 1/2 --time-limit 1 --out out").split_whitespace());
    let running = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    // Before the second is over, which its time sees to.
    std::thread::sleep(Duration::from_millis(300));
    std::fs::create_dir_all(scratch.path("out")).unwrap();
    scratch.file("out/partial.sums", "another part");
    let output = running.wait_with_output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && told.contains("holds "), "{told}");
    assert_eq!(std::fs::read_to_string(scratch.path("out/partial.sums")).unwrap(), "another part");
}
