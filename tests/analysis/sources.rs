//! Points are the same whether they are held in memory, read again when they are needed, or come as bytes.

use std::path::Path;
use std::sync::Arc;

use crate::common::Rng;
use pairwave::analysis::{Analysis, Measurement, Plan};
use pairwave::compute::{Device, cpu::Cpu};
use pairwave::control::Control;
use pairwave::points::read::MarkedPoints;
use pairwave::points::{Domain, RawPoints, write};
use pairwave::report;
use pairwave::request::{PointsRequest, Request};
use pairwave::source::Points;

fn points(line: &str) -> PointsRequest {
    Request::parse(line.split_whitespace().map(String::from)).unwrap().input
}

/// Sets of `n(k)` points.
fn sets(count: usize, n: impl Fn(usize) -> usize, seed: u64) -> Vec<RawPoints> {
    let mut rng = Rng(seed);
    let set = |k: usize| RawPoints {
        dim: 2,
        coordinates: (0..2 * n(k)).map(|_| rng.unit()).collect(),
        source: String::new(),
        lines: Vec::new(),
    };
    (0..count).map(set).collect()
}

fn save(path: &Path, sets: Vec<RawPoints>) {
    write::write(path, &mut sets.into_iter().map(Ok), false).unwrap();
}

/// Inputs of every kind that may be too large to be held.
fn inputs(folder: &Path) -> Vec<String> {
    let at = |name: &str| folder.join(name).display().to_string();
    for k in 0..11 {
        save(&folder.join(format!("set_{k}.csv")), sets(1, |_| 20 + k, k as u64));
    }
    save(&folder.join("batch.npy"), sets(37, |_| 25, 7));
    save(&folder.join("batch.txt"), sets(9, |k| 10 + k, 8));
    save(&folder.join("batch.npz"), sets(5, |k| 12 + k, 9));
    let mut rng = Rng(3);
    for k in 0..4 {
        let rows: String = (0..15)
            .map(|i| {
                let weight = if i == 3 && k == 2 { 9.0 } else { rng.unit() };
                format!("{},{},{weight},{}\n", rng.unit(), rng.unit(), ["elm", "oak", "ash"][(i + k) % 3])
            })
            .collect();
        std::fs::write(folder.join(format!("marked_{k}.csv")), format!("x,y,w,kind\n{rows}")).unwrap();
    }
    let marked = (0..4).map(|k| at(&format!("marked_{k}.csv"))).collect::<Vec<_>>().join(" ");
    vec![
        at("set_*.csv"),
        at("batch.npy"),
        at("batch.txt"),
        at("batch.npz"),
        format!("{} {} {}", at("batch.npy"), at("set_3.csv"), at("batch.txt")),
        format!("{marked} --weight-column w"),
        format!("{marked} --class-column kind --window 0,1,0,1"),
        format!("{} --box 0.5,2 --wrap", at("batch.npy")),
    ]
}

#[test]
fn what_is_read_again_is_what_was_held() {
    let folder = tempfile::tempdir().unwrap();
    for line in inputs(folder.path()) {
        let request = points(&line);
        let held = Points::open(&request).unwrap();
        let control = Control::default();
        for budget in [0, 1000] {
            let lazy = Points::files_within(&request, budget).unwrap();
            assert_eq!(lazy.shape(), held.shape(), "{line}");
            assert_eq!(lazy.classes(), held.classes(), "{line}");
            assert_eq!((lazy.subject(), lazy.domain()), (held.subject(), held.domain()), "{line}");
            let all = held.shape().realizations;
            for (start, end) in [(0, all), (0, 1), (all - 1, all), (1, all), (all / 3, all / 2 + 1)] {
                let [a, b] = [&held, &lazy].map(|s| s.batch(start..end, &control).unwrap());
                assert_eq!(a, b, "{line}, {start}..{end}");
            }
        }
    }
}

#[test]
fn what_cannot_be_used_is_found_when_files_are_opened() {
    let folder = tempfile::tempdir().unwrap();
    let line = inputs(folder.path()).remove(0);
    std::fs::write(folder.path().join("set_9.csv"), "0.5,0.5\n0.5,1.5\n").unwrap();
    for budget in [0, u64::MAX] {
        let error = Points::files_within(&points(&line), budget).err().unwrap().to_string();
        assert!(error.contains("set_9.csv:2") && error.contains("y = 1.5"), "{error}");
    }
}

#[test]
fn files_that_change_meanwhile_are_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let line = inputs(folder.path()).remove(2);
    let lazy = Points::files_within(&points(&line), 0).unwrap();
    std::fs::write(folder.path().join("batch.txt"), "0.1 0.1\n0.2 0.2\n").unwrap();
    let error = lazy.batch(3..5, &Control::default()).unwrap_err().to_string();
    assert!(error.contains("batch.txt") && error.contains("fewer realizations"), "{error}");
    let folder = tempfile::tempdir().unwrap();
    let line = inputs(folder.path()).remove(1);
    let lazy = Points::files_within(&points(&line), 0).unwrap();
    let path = folder.path().join("batch.npy");
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let error = lazy.batch(0..37, &Control::default()).unwrap_err().to_string();
    assert!(error.contains("batch.npy") && error.contains("realization 18 is not there any more"), "{error}");
}

#[test]
fn bytes_with_a_name_are_read_as_that_file() {
    let folder = tempfile::tempdir().unwrap();
    inputs(folder.path());
    let control = Control::default();
    for name in ["batch.npy", "batch.npz", "batch.txt", "set_3.csv"] {
        let path = folder.path().join(name);
        let (bytes, request) = (std::fs::read(&path).unwrap(), points(&path.display().to_string()));
        let file = Points::open(&request).unwrap();
        let read = Points::from_bytes(name, &bytes, &request).unwrap();
        let all = file.shape().realizations;
        assert_eq!(read.batch(0..all, &control).unwrap(), file.batch(0..all, &control).unwrap(), "{name}");
        assert_eq!(read.subject(), name);
    }
    let error = Points::from_bytes("dropped.csv", b"0.1,0.2\n0.3,x\n", &points("f")).err().unwrap().to_string();
    assert!(error.starts_with("dropped.csv:2"), "{error}");
}

#[test]
fn points_in_memory_say_what_is_wrong_with_them() {
    let unit = || Domain::unit_torus(2);
    let error = |sets: &[Vec<f64>]| Points::new(unit(), sets).err().unwrap().to_string();
    assert!(error(&[vec![0.1, 0.2, 0.3]]).contains("realization 0: 3 numbers"));
    assert!(error(&[vec![0.1, 0.2], vec![0.3, 1.5]]).contains("realization 1, point 0: y = 1.5"));
    assert!(error(&[]).contains("no realizations"));
    assert!(error(&[vec![f64::NAN, 0.2]]).contains("not a finite number"));
}

/// Sets in memory with their marks.
fn in_memory(sets: Vec<RawPoints>, weights: bool) -> Vec<MarkedPoints> {
    let mut rng = Rng(5);
    let mut marked = |points: RawPoints| {
        let weights = if weights { (0..points.len()).map(|_| rng.unit()).collect() } else { Vec::new() };
        MarkedPoints { points, weights, labels: Vec::new(), reading: Arc::default() }
    };
    sets.into_iter().map(&mut marked).collect()
}

#[test]
fn points_in_memory_are_those_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("marked.csv");
    let held = in_memory(sets(6, |k| 20 + k, 4), true);
    let mut text = String::from("x,y,w,set\n");
    for (k, set) in held.iter().enumerate() {
        for (point, weight) in set.points.coordinates.chunks(2).zip(&set.weights) {
            text += &format!("{:?},{:?},{weight:?},{k}\n", point[0], point[1]);
        }
    }
    std::fs::write(&path, text).unwrap();
    let read =
        Points::open(&points(&format!("{} --weight-column w --realization-column set", path.display()))).unwrap();
    let request = points("--weight-column w");
    let held = Points::marked(held, &request, &Control::default()).unwrap();
    assert_eq!(held.shape(), read.shape());
    let both = [&held, &read].map(|points| points.batch(0..6, &Control::default()).unwrap());
    assert_eq!(both[0], both[1]);
    // Simulations that are named are read.
    let nowhere = Points::marked(
        in_memory(sets(2, |_| 9, 1), false),
        &points("--envelope-from nowhere.csv"),
        &Control::default(),
    );
    assert!(nowhere.err().unwrap().to_string().contains("nowhere.csv"));
    // What says how files are read says nothing here, and is not passed over.
    for (line, name) in
        [("--columns x,y", "columns"), ("-n 5", "points"), ("--sampler random", "sampler"), ("a.csv", "files")]
    {
        let error = Points::marked(in_memory(sets(1, |_| 5, 1), false), &points(line), &Control::default());
        let error = error.err().unwrap().to_string();
        assert!(error.starts_with(&format!("{name} ")) && error.contains("they are here"), "{error}");
    }
    let none = Points::marked(Vec::new(), &request, &Control::default()).err().unwrap().to_string();
    assert!(none.contains("there are no realizations"), "{none}");
    let mut mixed = in_memory(sets(2, |_| 6, 1), false);
    mixed[1].points.dim = 3;
    let mixed = Points::marked(mixed, &points(""), &Control::default()).err().unwrap().to_string();
    assert!(mixed.contains("3 coordinates per point, the first realization 2"), "{mixed}");
}

/// Parts of a stream, of which none knows the others, come to the bytes of the whole.
#[test]
fn parts_of_a_stream_are_merged() {
    let device = Device::new(Box::new(Cpu::new(Some(2)).unwrap()), None).unwrap();
    let request = Request::parse("--stats pcf,spectrum,neighbors --bins 12".split(' ').map(String::from)).unwrap();
    let all = in_memory(sets(40, |k| 30 + k % 3, 6), false);
    let whole = Points::marked(all.clone(), &request.input, &Control::default()).unwrap();
    let shape = whole.shape();
    let measured = |points: Points, span: std::ops::Range<u64>| {
        let points = Arc::new(points);
        let plan = Plan::of(&request, &points).unwrap().for_device(device.compute());
        let mut sums = Measurement::new(request.clone(), points, plan).within(span, &device).unwrap();
        while sums.step(&device, &Control::default()).unwrap() {}
        sums
    };
    let part = |from: usize, to: usize| {
        let sets = all[from..to].to_vec();
        let points = Points::of_stream("s", sets, from as u64, shape, &request.input).unwrap();
        measured(points, from as u64..to as u64)
    };
    let mut merged = part(16, 32);
    merged.merge(Measurement::read("part", &part(32, 40).write()).unwrap()).unwrap();
    merged.merge(part(0, 16)).unwrap();
    let (one, other) = (measured(whole, 0..40).analysis().unwrap(), merged.analysis().unwrap());
    let table = |found: &Analysis, name: &str| report::table(name, found).unwrap();
    for name in ["pcf", "spectrum_radial", "neighbor_functions"] {
        assert_eq!(table(&one, name), table(&other, name));
    }
    assert_eq!(merged.reach(), 0..40);
    // Each of these would count something twice, or what is not there.
    let of = |sets: &[MarkedPoints], first, request: &PointsRequest| {
        Points::of_stream("s", sets.to_vec(), first, shape, request).err().map(|error| error.to_string())
    };
    for (error, why) in [
        (of(&all[..16], 8, &request.input), "begins at a multiple of 16"),
        (of(&all[..16], 32, &request.input), "a part of 0..40"),
        (of(&all[..16], 0, &points("--weight-column w")), "relative to all realizations"),
        (of(&all[..16], 0, &points("--envelope-from a.csv")), "relative to all realizations"),
        (of(&in_memory(sets(16, |_| 33, 1), false), 0, &request.input), "up to 33 points"),
    ] {
        assert!(error.as_ref().is_some_and(|error| error.contains(why)), "{error:?}: {why}");
    }
    let other = Points::of_stream("another", all[..16].to_vec(), 0, shape, &request.input).unwrap();
    assert!(part(16, 32).merge(measured(other, 0..16)).unwrap_err().to_string().contains("stream"));
    let beyond = Points::of_stream("s", all[..16].to_vec(), 0, shape, &request.input).unwrap();
    assert!(
        beyond
            .batch(8..24, &Control::default())
            .unwrap_err()
            .to_string()
            .contains("0..16 of a stream, and is asked for 8..24")
    );
}
