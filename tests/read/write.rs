//! What is written reads back.

use std::path::Path;

use crate::shared::NO_OPTIONS;

use pairwave::points::RawPoints;
use pairwave::points::read::{Columns, ReadOptions, TypedColumns, read_all, read_marked};
use pairwave::points::write::write;
use tempfile::TempDir;

/// Numbers that are hard to write: shortest texts, extremes of the exponent, signed zero, neighbours of 1.
fn hard(n: usize, dim: usize, seed: u64) -> RawPoints {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state >> 11
    };
    let special = [0.0, -0.0, 0.1, 1.0 - 2f64.powi(-53), 5e-324, f64::MIN_POSITIVE, 1e300, -1e-5, 123_456_789.125];
    let number = |i: usize| special.get(i).copied().unwrap_or_else(|| next() as f64 / 2f64.powi(53));
    let coordinates = (0..n * dim).map(number).collect();
    RawPoints { dim, coordinates, source: "hard".into(), lines: Vec::new() }
}

fn write_all(path: &Path, sets: &[RawPoints]) -> Result<(), String> {
    let folder = format!("{}/", path.parent().unwrap().display());
    write(path, &mut sets.iter().cloned().map(Ok), false).map_err(|e| e.to_string().replace(&folder, ""))
}

fn bits(sets: &[RawPoints]) -> Vec<(usize, Vec<u64>)> {
    sets.iter().map(|s| (s.dim, s.coordinates.iter().map(|x| x.to_bits()).collect())).collect()
}

#[test]
fn written_points_read_back_bit_for_bit() {
    let folder = TempDir::new().unwrap();
    for dim in 1..=3 {
        let batch: Vec<RawPoints> = (0..3).map(|k| hard(20, dim, k)).collect();
        let uneven = [hard(20, dim, 1), hard(3, dim, 2), hard(7, dim, 3)];
        let options = ReadOptions { dim: Some(dim), raw: None };
        for extension in ["csv", "txt", "npy", "npz", "bin", "f64"] {
            let mut cases = vec![&batch[..1], &batch[..2], &batch[..]];
            match extension {
                "csv" | "txt" | "npz" => cases.push(&uneven),
                "f64" => cases.truncate(1),
                _ => {}
            }
            for (case, sets) in cases.into_iter().enumerate() {
                let path = folder.path().join(format!("{dim}_{case}.{extension}"));
                write_all(&path, sets).unwrap();
                let back = read_all(std::slice::from_ref(&path), &options).unwrap();
                assert_eq!(bits(&back), bits(sets), "{}", path.display());
            }
        }
    }
    // Formats of space have all three coordinates.
    let options = ReadOptions { dim: Some(3), raw: None };
    let empty = RawPoints { dim: 3, coordinates: vec![], source: "e".into(), lines: vec![] };
    for (name, sets) in [("a.ply", &[hard(20, 3, 1)][..]), ("a.xyz", &[hard(20, 3, 1), empty, hard(7, 3, 2)][..])] {
        let path = folder.path().join(name);
        write_all(&path, sets).unwrap();
        assert_eq!(bits(&read_all(&[path], &options).unwrap()), bits(sets), "{name}");
    }
    for name in ["flat.ply", "flat.xyz"] {
        let (path, flat) = (folder.path().join(name), hard(20, 2, 1));
        write_all(&path, std::slice::from_ref(&flat)).unwrap();
        let back = read_all(std::slice::from_ref(&path), &options).unwrap();
        assert!(back[0].coordinates.iter().skip(2).step_by(3).all(|&z| z == 0.0), "{name}");
        let columns = TypedColumns { columns: Some("x,y"), ..TypedColumns::default() };
        let back = read_marked(&[path], &NO_OPTIONS, &Columns::new(&columns).unwrap()).unwrap();
        assert_eq!(bits(&[back[0].points.clone()]), bits(&[flat]), "{name}");
    }
    let same = [hard(5, 2, 1), hard(5, 2, 1)];
    let path = folder.path().join("same.bin");
    write_all(&path, &same).unwrap();
    assert_eq!(bits(&read_all(&[path], &NO_OPTIONS).unwrap()), bits(&same), "equal sets that were meant");
    let empty = RawPoints { dim: 2, coordinates: vec![], source: "e".into(), lines: vec![] };
    let path = folder.path().join("empty.npz");
    write_all(&path, &[hard(2, 2, 1), empty.clone()]).unwrap();
    assert_eq!(read_all(&[path], &NO_OPTIONS).unwrap()[1].len(), 0);
}

#[test]
fn written_npy_and_npz_are_what_numpy_expects() {
    let folder = TempDir::new().unwrap();
    let sets = [hard(4, 2, 1), hard(4, 2, 2)];
    let path = folder.path().join("a.npy");
    write_all(&path, &sets).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(bytes.len(), 128 + 2 * 4 * 2 * 8);
    let file = npyz::NpyFile::new(&bytes[..]).unwrap();
    assert_eq!((file.shape(), file.order()), (&[2, 4, 2][..], npyz::Order::C));
    let numbers: Vec<f64> = file.into_vec().unwrap();
    assert_eq!(numbers, [&sets[0].coordinates[..], &sets[1].coordinates[..]].concat());

    let path = folder.path().join("a.npz");
    write_all(&path, &sets).unwrap();
    let archive = zip::ZipArchive::new(std::fs::File::open(&path).unwrap()).unwrap();
    let names: Vec<String> = archive.file_names().map(|n| n.unwrap().into_owned()).collect();
    assert_eq!(names, ["set_0.npy", "set_1.npy"]);
}

#[test]
fn written_text_is_plain() {
    let folder = TempDir::new().unwrap();
    let set =
        |coordinates: &[f64]| RawPoints { dim: 2, coordinates: coordinates.into(), source: "s".into(), lines: vec![] };
    let sets = [set(&[0.5, 0.25, 1e-7, 3.0]), set(&[0.1, 0.2])];
    for (name, text) in
        [("a.csv", "x,y\n0.5,0.25\n1e-7,3.0\n#\n0.1,0.2\n"), ("a.txt", "0.5 0.25\n1e-7 3.0\n#\n0.1 0.2\n")]
    {
        let path = folder.path().join(name);
        write_all(&path, &sets).unwrap();
        assert_eq!(std::fs::read_to_string(path).unwrap(), text);
    }
}

/// Of points with more coordinates than there are letters.
#[test]
fn many_coordinates_are_numbered() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("a.csv");
    write_all(&path, &[hard(3, 5, 1)]).unwrap();
    assert_eq!(std::fs::read_to_string(path).unwrap().lines().next(), Some("x1,x2,x3,x4,x5"));
    for name in ["a.ply", "a.xyz"] {
        let error = write_all(&folder.path().join(name), &[hard(3, 5, 1)]).unwrap_err();
        assert!(error.contains("holds points in space, these have 5 coordinates"), "{error}");
    }
}

#[test]
fn f32_formats_round_but_stay_below_one() {
    let folder = TempDir::new().unwrap();
    let set = RawPoints { dim: 2, coordinates: vec![0.1, 1.0 - 1e-12], source: "s".into(), lines: vec![] };
    let expected = [f64::from(0.1f32), 1.0 - 2f64.powi(-24)];
    for (name, options) in [("a.rps", NO_OPTIONS), ("a.f32", ReadOptions { dim: Some(2), raw: None })] {
        let path = folder.path().join(name);
        write_all(&path, std::slice::from_ref(&set)).unwrap();
        assert_eq!(read_all(&[path], &options).unwrap()[0].coordinates, expected);
    }
}

#[test]
fn what_cannot_be_written_leaves_nothing_behind() {
    let folder = TempDir::new().unwrap();
    let (flat, short, solid) = (hard(9, 2, 1), hard(3, 2, 2), hard(9, 3, 3));
    let empty = RawPoints { dim: 2, coordinates: vec![], source: "empty".into(), lines: vec![] };
    let nan = RawPoints { dim: 2, coordinates: vec![0.0, 0.0, f64::NAN, 0.0], source: "nan".into(), lines: vec![] };
    let pair = [flat.clone(), short];
    let unequal = "realization 1 has 3 points, those before it 9; .npz, .csv and .txt hold unequal realizations";
    let single = "this format holds one realization; .npy, .npz, .bin, .csv and .txt hold several";
    let none = "realization 0 has no points, which text cannot show; .npz holds empty realizations";
    let table: &[(&str, &[RawPoints], String)] = &[
        ("a.npy", &pair, format!("out a.npy: {unequal}")),
        ("a.bin", &pair, format!("out a.bin: {unequal}")),
        ("a.rps", &pair, format!("out a.rps: {single}")),
        ("a.ply", &pair, format!("out a.ply: {single}")),
        ("a.f64", &pair, format!("out a.f64: {single}")),
        (
            "a.rps",
            std::slice::from_ref(&solid),
            "out a.rps: .rps holds points in the plane, these have 3 coordinates".into(),
        ),
        ("a.csv", std::slice::from_ref(&empty), format!("out a.csv: {none}")),
        (
            "a.f32",
            std::slice::from_ref(&empty),
            "out a.f32: a realization without points would be an empty file".into(),
        ),
        ("a.npy", std::slice::from_ref(&nan), "nan, point 1: NaN is not finite".into()),
        (
            "a.txt",
            &[flat.clone(), solid.clone()],
            "hard: points of 3 coordinates in a file of 2-dimensional points".into(),
        ),
        ("a.npz", &[], "out a.npz: there are no realizations to write".into()),
        (
            "a.doc",
            &pair,
            "out a.doc: expected a file name that ends in .csv, .txt, .npy, .npz, .ply, .xyz, .rps, .bin, .f32 or .f64"
                .into(),
        ),
        (
            "a",
            &pair,
            "out a: expected a file name that ends in .csv, .txt, .npy, .npz, .ply, .xyz, .rps, .bin, .f32 or .f64"
                .into(),
        ),
    ];
    for (name, sets, message) in table {
        assert_eq!(write_all(&folder.path().join(name), sets).unwrap_err(), *message);
    }
    if cfg!(not(feature = "tables")) {
        let reason =
            "out a.parquet: this pairwave was built without Parquet and Arrow; build it with `--features tables`";
        assert_eq!(write_all(&folder.path().join("a.parquet"), &pair).unwrap_err(), reason);
    }
    let mut failing = [Ok(flat.clone()), Err(pairwave::Error::Cancelled)].into_iter();
    assert!(write(&folder.path().join("a.csv"), &mut failing, false).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing half-written");

    let message = write_all(&folder.path().join("no/such/a.csv"), &pair).unwrap_err();
    assert!(message.starts_with("a.csv: No such file"), "{message}");

    let path = folder.path().join("a.csv");
    std::fs::write(&path, "mine").unwrap();
    assert_eq!(write_all(&path, &pair).unwrap_err(), "out a.csv: exists already; `force` replaces it");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    let mut failing = [Ok(flat.clone()), Err(pairwave::Error::Cancelled)].into_iter();
    assert!(write(&path, &mut failing, true).is_err());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine", "kept when the new one fails");
    write(&path, &mut [Ok(flat.clone())].into_iter(), true).unwrap();
    assert_eq!(bits(&read_all(&[path], &NO_OPTIONS).unwrap()), bits(&[flat]));
}
