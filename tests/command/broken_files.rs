//! A folder with broken files in it: the first is named before anything is measured, or all are left out and listed.

use crate::shared::{Scratch, summary};

/// Points of a file, another for each number.
fn points(k: usize) -> String {
    let place = |j: usize| (((j * 37 + k) % 64) as f64 / 64.0, ((j * j + 11 * k) * 13 % 64) as f64 / 64.0);
    (0..12).map(place).map(|(x, y)| format!("{x},{y}\n")).collect()
}

/// Files 1 to n, `x,y` each, in a folder.
fn folder(scratch: &Scratch, name: &str, n: usize) {
    std::fs::create_dir_all(scratch.path(name)).unwrap();
    for k in 1..=n {
        scratch.file(&format!("{name}/{k}.csv"), &format!("x,y\n{}", points(k)));
    }
}

fn tables(scratch: &Scratch, out: &str) -> [String; 2] {
    ["pcf.csv", "spectrum_radial.csv"].map(|name| std::fs::read_to_string(scratch.path(out).join(name)).unwrap())
}

#[test]
fn one_of_a_thousand_is_named_before_the_work_or_left_out() {
    let scratch = Scratch::new();
    folder(&scratch, "all", 1000);
    folder(&scratch, "good", 1000);
    scratch.file("all/617.csv", "x,y\n0.5,0.25\n0.5,oops\n");
    std::fs::remove_file(scratch.path("good/617.csv")).unwrap();
    let said = "all/617.csv:3: \"oops\" is not a number; expected 2 numbers per line as in line 1";
    scratch.fails("analyze all --device cpu --out o", 1, said);
    assert!(!scratch.path("o").exists());
    let output = scratch.run("analyze all --device cpu --keep-going --out o");
    let (out, errors) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(out.starts_with("n = 12, K = 999, 2D, unit torus; "), "{out}{errors}");
    let warning = format!("1 of 1000 files was left out: {said}");
    assert!(errors.lines().any(|line| line == format!("warning: {warning}")), "{errors}");
    let json = summary(&scratch.path("o"));
    assert_eq!(json["input"]["left_out"], serde_json::json!([{ "file": "all/617.csv", "reason": said }]));
    assert_eq!((&json["input"]["files"], &json["k"]), (&serde_json::json!(999), &serde_json::json!(999)));
    assert!(json["warnings"].as_array().unwrap().iter().any(|w| w.as_str() == Some(&warning)));
    let page = std::fs::read_to_string(scratch.path("o/report.html")).unwrap();
    assert!(page.contains("1 of 1000 files was left out"));
    scratch.ok("analyze good --device cpu --out g");
    assert_eq!(tables(&scratch, "o"), tables(&scratch, "g"));
    assert_eq!(summary(&scratch.path("g"))["input"]["left_out"], serde_json::json!([]));
}

#[test]
fn whatever_is_wrong_with_a_file_it_is_left_out() {
    let scratch = Scratch::new();
    folder(&scratch, "all", 9);
    folder(&scratch, "good", 9);
    let box_of = |numbers: &[f64]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    for (k, text) in [
        (2, "x,y,z\n0.5,0.25,0.5\n0.125,0.5,0.5\n"),
        (4, ""),
        (5, "x,y\n0.5,nan\n0.5,0.5\n"),
        (6, "x,y\n0.5,1.5\n0.5,0.5\n"),
        (8, "x,z\n0.5\n0.5\n"),
    ] {
        scratch.file(&format!("all/{k}.csv"), text);
        std::fs::remove_file(scratch.path(&format!("good/{k}.csv"))).unwrap();
    }
    std::fs::write(scratch.path("all/3.csv"), box_of(&[1e300, 1e10])).unwrap();
    std::fs::remove_file(scratch.path("good/3.csv")).unwrap();
    scratch.file("all/notes.md", "what was done\n");
    // An array of many realizations, of which the last is outside.
    let array = |last: f64| {
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2, 2), }\n";
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.bytes());
        bytes.extend(box_of(&[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.15, 0.25, last]));
        bytes
    };
    std::fs::write(scratch.path("all/outside.npy"), array(7.0)).unwrap();
    std::fs::write(scratch.path("all/within.npy"), array(0.5)).unwrap();
    std::fs::write(scratch.path("good/within.npy"), array(0.5)).unwrap();
    let measure = "--device cpu --stats pcf,spectrum --force";
    for (inputs, kept) in [("all", "good"), ("all/*.csv all/*.npy none.csv", "good/*")] {
        let errors = scratch.run(&format!("analyze {inputs} {measure} --keep-going --out o")).stderr;
        scratch.ok(&format!("analyze {kept} {measure} --out g"));
        assert_eq!(tables(&scratch, "o"), tables(&scratch, "g"), "{inputs}: {}", String::from_utf8(errors).unwrap());
        let json = summary(&scratch.path("o"));
        let left: Vec<(String, String)> = json["input"]["left_out"]
            .as_array()
            .unwrap()
            .iter()
            .map(|left| (left["file"].as_str().unwrap().into(), left["reason"].as_str().unwrap().into()))
            .collect();
        let mut expected = vec![
            ("all/2.csv", "all/2.csv: 3 coordinates per point, but all/1.csv has 2"),
            ("all/3.csv", "all/3.csv: neither text nor"),
            ("all/4.csv", "all/4.csv: the file is empty"),
            ("all/5.csv", "all/5.csv:2: \"nan\" is not finite"),
            ("all/6.csv", "all/6.csv:2: y = 1.5 is outside [0, 1)"),
            ("all/8.csv", "all/8.csv:2: 1 field, expected 2 as in line 1"),
        ];
        expected.push(match inputs {
            "all" => ("all/notes.md", "all/notes.md: not a kind of file that holds points"),
            _ => ("all/outside.npy", "all/outside.npy, realization 2, point 1: y = 7 is outside [0, 1)"),
        });
        expected.push(match inputs {
            "all" => ("all/outside.npy", "all/outside.npy, realization 2, point 1: y = 7 is outside [0, 1)"),
            _ => ("none.csv", "none.csv: No such file"),
        });
        assert_eq!(left.len(), expected.len(), "{left:?}");
        for ((file, reason), (name, said)) in left.iter().zip(expected) {
            assert!(file == name && reason.starts_with(said), "{file}: {reason}");
        }
        let warnings = json["warnings"].to_string();
        assert!(warnings.contains("8 of 12 files were left out: all/2.csv: 3 coordinates"), "{warnings}");
        assert!(warnings.contains("and 3 more, all in summary.json"), "{warnings}");
    }
    // The same where the files are not held.
    scratch.fails(
        "analyze all/2.csv all/4.csv --keep-going --window 0,1,0,1 --device cpu",
        1,
        "none of 2 files can be used; the first: all/2.csv: 3 coordinates",
    );
    // Columns that are not there, weights that are none.
    scratch.file("all/1.csv", "x,y,w\n0.5,0.25,1\n0.25,0.5,2\n");
    scratch.file("all/7.csv", "x,y,w\n0.5,0.25,inf\n0.25,0.5,2\n");
    scratch.ok(
        "analyze all/1.csv all/7.csv all/9.csv --weight-column w --keep-going --device cpu --stats spectrum --out w",
    );
    let left = summary(&scratch.path("w"))["input"]["left_out"].to_string();
    assert!(
        left.contains("weight inf; weights must be finite") && left.contains("no column of that name; there are x, y"),
        "{left}"
    );
    // What is wrong with a setting is no fault of a file.
    scratch.fails("analyze all --keep-going --domain window --device cpu", 2, "--domain window: needs --window");
    scratch.fails("analyze --sampler random -n 4 --keep-going", 2, "--keep-going");
    // What most files have is meant, not what the first has.
    scratch.file("all/0.csv", "x,y,z\n0.5,0.25,0.5\n0.125,0.5,0.5\n");
    let out = scratch.run("analyze all/0.csv good --keep-going --device cpu --stats neighbors");
    let errors = String::from_utf8(out.stderr).unwrap();
    assert!(
        errors.contains("1 of 5 files was left out: all/0.csv: 3 coordinates per point, but good/1.csv has 2"),
        "{errors}"
    );
    // By pairs of axes too.
    let out = scratch.run("analyze all --keep-going --projections --device cpu --out p");
    let errors = String::from_utf8(out.stderr).unwrap();
    assert!(errors.contains("files were left out: all/1.csv"), "{errors}");
}

/// Sums know which points they are of: a part that left out another file is no part of the same batch.
#[test]
fn parts_that_left_out_other_files_do_not_merge() {
    let scratch = Scratch::new();
    folder(&scratch, "all", 40);
    scratch.file("all/11.csv", "x,y\n0.5\n");
    let part = |k: usize, out: &str| {
        scratch.ok(&format!("analyze all --keep-going --shard {k}/2 --device cpu --out {out}"));
    };
    part(1, "parts/1");
    part(2, "parts/2");
    scratch.ok("merge parts/1 parts/2 --out merged");
    scratch.ok("analyze all --keep-going --device cpu --out whole");
    assert_eq!(tables(&scratch, "merged"), tables(&scratch, "whole"));
    assert_eq!(summary(&scratch.path("merged"))["input"], summary(&scratch.path("whole"))["input"]);
    // Another file breaks between two parts, or before a run goes on.
    scratch.ok("analyze all --keep-going --checkpoint 0 --time-limit 0 --device cpu --out late");
    scratch.file("all/12.csv", "x,y\n0.5\n");
    part(2, "parts/other");
    scratch.fails("merge parts/1 parts/other --out no", 1, "the parts are not of the same measurement: points, digest");
    scratch.fails("analyze all --keep-going --checkpoint 0 --resume --device cpu --out late", 1, "points, digest");
}

#[cfg(unix)]
#[test]
fn links_that_lead_nowhere_and_pipes_are_files_that_cannot_be_used() {
    let scratch = Scratch::new();
    folder(&scratch, "all", 3);
    std::os::unix::fs::symlink("nowhere", scratch.path("all/4.csv")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(scratch.path("all/5.csv")).status().unwrap().success());
    scratch.fails("analyze all --device cpu --stats pcf --out o", 1, "all/5.csv: is a pipe or a device");
    let left_out = |out: &str| {
        scratch.ok(&format!("analyze all --device cpu --stats pcf --keep-going --quiet --out {out}"));
        let json = summary(&scratch.path(out));
        (json["k"].as_u64().unwrap(), json["input"]["left_out"].as_array().unwrap().len())
    };
    assert_eq!(left_out("both"), (3, 2));
    std::fs::remove_file(scratch.path("all/5.csv")).unwrap();
    scratch.fails("analyze all --device cpu --stats pcf --out o", 1, "all/4.csv: No such file");
    assert_eq!(left_out("link"), (3, 1));
}
