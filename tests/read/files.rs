//! Files of every format, many of them, and damaged ones.

use std::path::PathBuf;

use crate::shared::{NO_OPTIONS, data, npy, npy_f64, read, utk, zipped};
use pairwave::points::RawPoints;
use pairwave::points::read::{ReadOptions, read_all};
use tempfile::TempDir;

fn points(set: &RawPoints) -> Vec<&[f64]> {
    set.coordinates.chunks_exact(set.dim).collect()
}

#[test]
fn committed_files_read_as_written() {
    let inputs = ["psa.txt", "trees.csv", "utk.dat"].map(data);
    let sets = read_all(&inputs, &NO_OPTIONS).unwrap();
    let expected: [&[f64]; 4] =
        [&[0.5, 0.25, 0.125, 0.75, 0.0625, 0.375], &[0.5, 0.25, 0.125, 0.75], &[0.5, 0.25, 0.125, 0.75], &[0.1, 0.2]];
    assert_eq!(sets.iter().map(|s| &s.coordinates[..]).collect::<Vec<_>>(), expected);
    assert_eq!(sets[1].lines, [2, 3]);
}

#[test]
fn directories_patterns_and_lists() {
    let folder = TempDir::new().unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    for k in [10, 9, 1] {
        put(&format!("set_{k}.txt"), &format!("{k} 0\n"));
    }
    put(".hidden", "junk");
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    let firsts = |inputs: &[PathBuf]| -> Vec<f64> {
        read_all(inputs, &NO_OPTIONS).unwrap().iter().map(|s| s.coordinates[0]).collect()
    };
    let at = |name: &str| folder.path().join(name);
    assert_eq!(firsts(&[folder.path().to_owned()]), [1.0, 9.0, 10.0]);
    assert_eq!(firsts(&[at("set_*.txt")]), [1.0, 9.0, 10.0]);
    assert_eq!(firsts(&[at("set_?.txt"), at("set_10.txt")]), [1.0, 9.0, 10.0]);
    assert_eq!(firsts(&[at("set_9.txt"), at("set_1.txt")]), [9.0, 1.0]);

    // A file whose name has a pattern's characters is a file.
    put("odd[1]*.txt", "7 0\n");
    assert_eq!(firsts(&[at("odd[1]*.txt")]), [7.0]);

    let fails = |inputs: &[PathBuf]| {
        let message = read_all(inputs, &NO_OPTIONS).unwrap_err().to_string();
        message.replace(&format!("{}/", folder.path().display()), "").replace(&*folder.path().to_string_lossy(), "DIR")
    };
    assert_eq!(
        fails(&[at("set_9.txt"), at("set_1.txt"), at("sub/../set_9.txt")]),
        "sub/../set_9.txt: is given twice (before as set_9.txt): its realizations would count twice; give it once"
    );
    assert_eq!(fails(&[at("none_*.txt")]), "none_*.txt: no file matches this pattern");
    assert_eq!(fails(&[at("none.txt")]), "none.txt: No such file or directory (os error 2)");
    assert_eq!(fails(&[at("sub")]), "sub: no files in this directory");
    let form = "expected files, a directory, a pattern such as 'set_*.npy', or - for standard input";
    assert_eq!(fails(&[]), format!("files (none): {form}"));
    assert_eq!(fails(&["-".into(), "-".into()]), "files - -: standard input can be read only once");

    put("third.txt", "1 2 3\n");
    assert_eq!(fails(&[at("set_1.txt"), at("third.txt")]), "third.txt: 3 coordinates per point, but set_1.txt has 2");
    let options = ReadOptions { dim: Some(2), raw: None };
    let message = read_all(&[at("third.txt")], &options).unwrap_err().to_string();
    assert!(
        message.ends_with(
            "third.txt: 3 coordinates per point, but `sides` or `window` has 2 axes; `columns` chooses fewer, as in 1,2"
        ),
        "{message}"
    );

    std::fs::remove_file(at("third.txt")).unwrap();
    put("broken.csv", "x,y\n1,oops\n");
    let message = fails(&[folder.path().to_owned()]);
    assert_eq!(message, r#"broken.csv:2: "oops" is not a number; expected 2 numbers per line as in line 1"#);
    std::fs::rename(at("broken.csv"), at("notes.md")).unwrap();
    let message = fails(&[folder.path().to_owned()]);
    assert!(message.starts_with("notes.md: not a kind of file that holds points; expected .csv, .tsv,"), "{message}");
}

#[test]
fn ten_thousand_realizations() {
    let text: String = (0..10_000).map(|k| format!("{k} 0\n0 {k}\n#\n")).collect();
    let sets = read("a.txt", text).unwrap();
    assert_eq!(sets.len(), 10_000);
    assert_eq!(points(&sets[9_999]), [[9_999.0, 0.0], [0.0, 9_999.0]]);
    assert_eq!(sets[9_999].lines, [29_998, 29_999]);
}

#[test]
fn damaged_files_never_panic() {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below.max(1) as u64) as usize
    };
    let set = npy("<f8", npyz::Order::Fortran, &[2, 3, 2], &[0.5; 12]);
    let seeds: Vec<(&str, Vec<u8>)> = vec![
        ("a.txt", b"# a\n0.5 0.25\n0.125,1e-3\n#\n2\n(0.5 0.25)\n0.1 0.2\n".to_vec()),
        ("a.csv", std::fs::read(data("trees.csv")).unwrap()),
        ("a.txt", std::fs::read(data("psa.txt")).unwrap()),
        ("a.npz", zipped(&[("a.npy", &set), ("b.npy", &set)], zip::CompressionMethod::Deflated)),
        ("a.npz", zipped(&[("a.npy", &set)], zip::CompressionMethod::Stored)),
        ("a.npy", set),
        ("a.npy", npy_f64("(3, 2)", 48)),
        ("a.bin", utk(5, 0, [2, 1, 2], &(0..32).collect::<Vec<u8>>())),
        ("a.rps", [0.5f32, 0.25].iter().flat_map(|x| x.to_le_bytes()).collect()),
        ("points", [0.5f32, 0.25].iter().flat_map(|x| x.to_le_bytes()).collect()),
    ];
    let folder = TempDir::new().unwrap();
    let alphabet = b"0123456789.,;#\"()[]{}'-+eExyzn \t\r\n\0\xff\x80PK";
    let (mut good, mut bad) = (0, 0);
    for (name, seed) in &seeds {
        let path = folder.path().join(name);
        for _ in 0..200 {
            let mut bytes = seed.clone();
            for _ in 0..=random(4) {
                let at = random(bytes.len());
                match random(6) {
                    0 => bytes.truncate(at),
                    1 if !bytes.is_empty() => bytes[at] = random(256) as u8,
                    2 if !bytes.is_empty() => bytes[at] ^= 1 << random(8),
                    3 => bytes.insert(at, alphabet[random(alphabet.len())]),
                    4 if !bytes.is_empty() => _ = bytes.remove(at),
                    _ if !bytes.is_empty() => bytes[at] = alphabet[random(alphabet.len())],
                    _ => {}
                }
            }
            std::fs::write(&path, &bytes).unwrap();
            match read_all(std::slice::from_ref(&path), &NO_OPTIONS) {
                Ok(sets) => {
                    good += 1;
                    for set in &sets {
                        assert!((1..=3).contains(&set.dim));
                        assert_eq!(set.coordinates.len() % set.dim, 0);
                        assert!(set.lines.is_empty() || set.lines.len() == set.len());
                    }
                    assert!(!sets.is_empty());
                }
                Err(error) => {
                    bad += 1;
                    assert!(error.to_string().contains(name), "{error}");
                }
            }
        }
    }
    assert!(good > 100 && bad > 100, "both happen: {good} read, {bad} refused");
}
