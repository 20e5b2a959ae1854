//! One look at the files of a batch, for parts of it. Cannot see: files that change within a second to others of the same size.

use crate::shared::{Scratch, summary};

fn numbers(scratch: &Scratch, dir: &str) -> Vec<Vec<u8>> {
    ["pcf.csv", "spectrum.npy", "spectrum_radial.csv"]
        .map(|file| std::fs::read(scratch.path(dir).join(file)).unwrap())
        .into()
}

#[test]
fn parts_of_a_scanned_batch_read_their_own_files_only() {
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.path("runs")).unwrap();
    for k in 0..40 {
        scratch.ok(&format!("sample random -n {} -k 1 --seed {k} --quiet --out runs/{k:02}.csv", 50 + k / 20));
    }
    let run = "--stats pcf,spectrum --device cpu --quiet";
    scratch.ok(&format!("analyze runs {run} --out whole"));
    scratch.ok("scan runs --out batch.scan");
    scratch.fails("scan runs --out batch.scan", 2, "batch.scan: is there already; --force replaces it");
    // The first part needs none of the last files.
    for k in 32..40 {
        std::fs::rename(scratch.path(&format!("runs/{k}.csv")), scratch.path(&format!("{k}.csv"))).unwrap();
    }
    scratch.ok(&format!("analyze batch.scan {run} --shard 1/2 --out parts/1"));
    scratch.fails(&format!("analyze batch.scan {run} --shard 2/2 --out parts/2"), 1, "32.csv");
    for k in 32..40 {
        std::fs::rename(scratch.path(&format!("{k}.csv")), scratch.path(&format!("runs/{k}.csv"))).unwrap();
    }
    scratch.ok(&format!("analyze batch.scan {run} --shard 2/2 --resume --out parts/2"));
    scratch.ok("merge parts/1 parts/2 --quiet --out merged");
    assert!(numbers(&scratch, "whole") == numbers(&scratch, "merged"));
    assert_eq!(
        (&summary(&scratch.path("merged"))["k"], &summary(&scratch.path("merged"))["n"]["max"]),
        (&40.into(), &51.into())
    );
    // The whole by the scan, and parts of the files themselves, are of the same measurement.
    scratch.ok(&format!("analyze batch.scan {run} --out scanned"));
    assert!(numbers(&scratch, "whole") == numbers(&scratch, "scanned"));
    scratch.ok(&format!("analyze runs {run} --shard 2/2 --out parts/3"));
    scratch.ok("merge parts/1 parts/3 --quiet --out mixed");
    assert!(numbers(&scratch, "whole") == numbers(&scratch, "mixed"));
    // A file that was changed since.
    std::fs::write(scratch.path("runs/07.csv"), "0.5,0.5\n").unwrap();
    scratch.fails(&format!("analyze batch.scan {run} --out changed"), 1, "07.csv: is not the file that was scanned");
}

#[test]
fn settings_by_which_files_were_read_are_those_of_the_scan() {
    let scratch = Scratch::new();
    scratch.file("a.csv", "x,y,kind,w\n0.1,0.2,a,1\n0.5,0.5,b,2\n0.9,0.3,a,1\n0.4,0.8,b,3\n");
    scratch.file("b.csv", "x,y,kind,w\n0.2,0.2,b,5\n0.6,0.5,b,2\n0.8,0.3,a,1\n0.3,0.8,c,4\n");
    let run = "--stats pcf --r-max 0.4 --bins 8 --classes a,b --device cpu --quiet";
    scratch.ok(&format!("analyze a.csv b.csv --class-column kind --window 0,1,0,2 {run} --out whole"));
    scratch.ok("scan a.csv b.csv --class-column kind --window 0,1,0,2 --quiet --out ab.scan");
    scratch.ok(&format!("analyze ab.scan {run} --out scanned"));
    let read = |dir: &str| std::fs::read(scratch.path(dir).join("pcf_cross.csv")).unwrap();
    assert!(read("whole") == read("scanned"));
    assert_eq!(summary(&scratch.path("scanned"))["parameters"]["class-column"], "kind");
    scratch.fails(
        &format!("analyze ab.scan --window 0,1,0,1 {run} --out other"),
        2,
        "--window 0,1,0,1: ab.scan was read with 0,1,0,2; expected that, or none",
    );
    scratch.fails(
        &format!("analyze ab.scan --weight-column w {run} --out other"),
        2,
        "--weight-column w: ab.scan was read without it; scan again with it",
    );
    // The scale of weights is that of all files.
    scratch.ok("scan a.csv b.csv --weight-column w --quiet --out w.scan");
    scratch.ok("analyze a.csv b.csv --weight-column w --stats pcf --device cpu --quiet --out weighted");
    scratch.ok("analyze w.scan --stats pcf --device cpu --quiet --out weighted_scan");
    let read = |dir: &str| std::fs::read(scratch.path(dir).join("pcf.csv")).unwrap();
    assert!(read("weighted") == read("weighted_scan"));
    scratch.fails("scan --sampler random -n 4 --out s.scan", 2, "samplers need no scan");
    scratch.fails("scan nowhere.csv --out s.scan", 1, "nowhere.csv");
    let text = std::fs::read_to_string(scratch.path("ab.scan")).unwrap();
    scratch.file("cut.scan", &text[..text.len() / 2]);
    scratch.fails("analyze cut.scan --device cpu", 1, "cut.scan: is no whole scan");
    scratch.file("headless.scan", &text[..text.find("settings").unwrap()]);
    scratch.fails("analyze headless.scan --device cpu", 1, "headless.scan: is no whole scan");
    scratch.file("old.scan", &text.replacen("{\"pairwave_scan\":1", "{\"pairwave_scan\":9", 1));
    scratch.fails("analyze old.scan --device cpu", 1, "is of version 9 of scans; this program reads version 1");
}

#[test]
fn a_scan_stands_for_its_files_wherever_they_are_given() {
    let scratch = Scratch::new();
    for (dir, n) in [("few", 16), ("many", 64)] {
        std::fs::create_dir(scratch.path(dir)).unwrap();
        for k in 0..5 {
            scratch.ok(&format!("sample random --dim 3 -n {n} -k 1 --seed {k} --quiet --out {dir}/{k}.csv"));
        }
        scratch.ok(&format!("scan {dir} --box 1,1,2 --quiet --out {dir}.scan"));
    }
    let tables = |dir: &str| {
        let files = std::fs::read_dir(scratch.path(dir)).unwrap().map(|file| file.unwrap().path());
        let tables = files.filter(|path| path.extension().is_some_and(|end| end == "csv"));
        tables.map(|path| (path.file_name().unwrap().to_owned(), std::fs::read(&path).unwrap())).collect::<Vec<_>>()
    };
    for (k, (of_files, of_scan)) in [
        ("analyze many --box 1,1,2 --projections", "analyze many.scan --projections"),
        ("analyze many --box 1,1,2 --prefixes 16,64", "analyze many.scan --prefixes 16,64"),
        ("convergence few many --box 1,1,2 --integrand disk", "convergence few.scan many.scan --integrand disk"),
        (
            "convergence many --box 1,1,2 --prefixes 8,32 --integrand disk",
            "convergence many.scan --prefixes 8,32 --integrand disk",
        ),
        ("integrate many --box 1,1,2 --integrand disk", "integrate many.scan --integrand disk"),
    ]
    .into_iter()
    .enumerate()
    {
        let (a, b) = (format!("files{k}"), format!("scan{k}"));
        scratch.ok(&format!("{of_files} --device cpu --quiet --out {a}"));
        scratch.ok(&format!("{of_scan} --device cpu --quiet --out {b}"));
        let (mut a, mut b) = (tables(&a), tables(&b));
        a.sort();
        b.sort();
        // The name of a subject is that of what was given.
        if of_files.starts_with("convergence few") {
            let named = |(name, bytes): (std::ffi::OsString, Vec<u8>)| {
                (name, String::from_utf8(bytes).unwrap().replace("few.scan", "few").into_bytes())
            };
            b = b.into_iter().map(named).collect();
        }
        assert!(!a.is_empty() && a == b, "{of_scan}");
    }
    scratch.fails(
        "convergence many.scan --box 1,1,1 --prefixes 8,32 --integrand disk",
        2,
        "--box 1,1,1: many.scan was read with 1,1,2; expected that, or none",
    );
    // What it cannot stand for is said.
    scratch.fails(
        "analyze few.scan many/0.csv --device cpu",
        1,
        "few.scan: a scan of other files, which is not read here; give it alone, in place of them, or give the files",
    );
    scratch.ok("analyze few --box 1,1,2 --stats pcf --device cpu --keep-sums --quiet --out kept");
    scratch.ok("scan few many --box 1,1,2 --quiet --out both.scan");
    scratch.fails(
        "analyze both.scan --stats pcf --device cpu --extend kept --out more",
        1,
        "were scanned, and of the first of them alone nothing is known; expected the files themselves, to add to a result",
    );
    scratch.fails(
        "analyze few --stats pcf --envelope-from many.scan --device cpu",
        2,
        "--box (none): many.scan was read with 1,1,2; expected that",
    );
    scratch.file("kinds.csv", "x,y,kind\n0.1,0.2,a\n0.5,0.5,b\n0.9,0.3,a\n0.4,0.8,b\n");
    scratch.ok("scan kinds.csv --class-column kind --quiet --out kinds.scan");
    for (run, said) in [
        ("analyze kinds.scan --prefixes 2,4 --device cpu", "the files themselves, or a scan that was made without it"),
        (
            "convergence kinds.scan --prefixes 2,4 --integrand disk",
            "the files themselves, or a scan that was made without it",
        ),
        (
            "convergence kinds.scan few.scan --integrand disk",
            "kinds.scan was made with it, and convergence is measured without",
        ),
    ] {
        scratch.fails(
            run,
            2,
            &format!("--class-column kind: {}", if said.starts_with("the") { "is not there" } else { said }),
        );
        scratch.fails(run, 2, said);
    }
    // A file that was changed since, there too.
    std::fs::write(scratch.path("many/3.csv"), "x,y,z\n0.5,0.5,0.5\n").unwrap();
    scratch.fails("analyze many.scan --prefixes 1,2 --device cpu", 1, "3.csv: is not the file that was scanned");
}

#[test]
fn a_scan_that_cannot_be_is_an_error() {
    let scratch = Scratch::new();
    scratch.ok("sample random -n 20 -k 20 --quiet --out batch.npy");
    scratch.ok("scan batch.npy --quiet --out batch.scan");
    let text = std::fs::read_to_string(scratch.path("batch.scan")).unwrap();
    assert!(text.contains("[[20,20]]"), "{text}");
    scratch.file("huge.scan", &text.replace("[[20,20]]", "[[20,4611686018427387904]]"));
    scratch.fails("analyze huge.scan --device cpu", 1, "huge.scan: has files whose realizations cannot be");
}

#[cfg(target_os = "linux")]
#[test]
fn a_name_that_a_scan_cannot_hold_is_an_error() {
    use std::os::unix::ffi::OsStrExt;
    let scratch = Scratch::new();
    let name = std::ffi::OsStr::from_bytes(b"\xff.csv");
    std::fs::write(scratch.0.path().join(name), "0.1 0.2\n0.3 0.4\n").unwrap();
    let output = scratch.command().arg("scan").arg(name).args(["--out", "a.scan"]).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && errors.contains("has a name that is no UTF-8"), "{errors}");
    assert!(!scratch.path("a.scan").exists());
}
