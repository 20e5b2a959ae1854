//! A measurement that is cut, written, read and merged in any order has the bytes of the whole; what is not of one whole is
//! refused by name.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use crate::common::Rng;
use pairwave::analysis::{Analysis, Measurement, Plan};
use pairwave::compute::{Device, cpu::Cpu};
use pairwave::control::Control;
use pairwave::report;
use pairwave::request::Request;
use pairwave::source::Points;

fn device() -> Device {
    Device::new(Box::new(Cpu::new(Some(2)).unwrap()), Some(2)).unwrap()
}

fn request(line: &str) -> Request {
    Request::parse(line.split_whitespace().map(String::from)).unwrap()
}

/// Every file, without what depends on the clock.
fn files(analysis: &Analysis) -> BTreeMap<String, Vec<u8>> {
    let dir = tempfile::tempdir().unwrap();
    let written = report::write(&dir.path().join("out"), analysis, false).unwrap();
    let name = |p: &Path| p.file_name().unwrap().to_string_lossy().into_owned();
    let of_time = |line: &&[u8]| !line.windows(6).any(|w| w == b">Time<");
    let bytes = |p: &Path| {
        let bytes = std::fs::read(p).unwrap();
        match name(p).as_str() {
            "summary.json" => {
                let mut summary: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
                summary.as_object_mut().unwrap().remove("timings_seconds");
                summary.to_string().into_bytes()
            }
            "report.html" => bytes.split(|&b| b == b'\n').filter(of_time).collect::<Vec<_>>().concat(),
            _ => bytes,
        }
    };
    written.iter().map(|p| (name(p), bytes(p))).collect()
}

fn whole(request: &Request, device: &Device) -> BTreeMap<String, Vec<u8>> {
    let source = Arc::new(Points::open(&request.input).unwrap());
    let plan = Plan::of(request, &source).unwrap().for_device(device.compute());
    files(&pairwave::analysis::run(request, source, plan, device, &Control::default(), &mut |_| ()).unwrap())
}

/// The sums of a range of realizations.
fn shard(request: &Request, range: std::ops::Range<u64>, device: &Device) -> Measurement {
    let mut shard = Measurement::of(request).unwrap().within(range, device).unwrap();
    while shard.step(device, &Control::default()).unwrap() {}
    shard
}

fn assert_same(found: &BTreeMap<String, Vec<u8>>, expected: &BTreeMap<String, Vec<u8>>, why: &str) {
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>(), "{why}");
    for (name, bytes) in expected {
        assert!(found[name] == *bytes, "{name} differs: {why}");
    }
}

/// Requests that have every group of sums between them.
fn requests(folder: &Path) -> Vec<String> {
    let mut rng = Rng(5);
    let mut rows = String::from("x,y,w,kind\n");
    let files: Vec<_> = (0..37)
        .map(|k| {
            let points = 30 + k % 3;
            let row = |i: usize, rng: &mut Rng| {
                format!("{},{},{},{}\n", rng.unit(), rng.unit(), 0.1 + rng.unit(), ["oak", "elm"][i % 2])
            };
            let rows: String = (0..points).map(|i| row(i, &mut rng)).collect();
            let path = folder.join(format!("set_{k}.csv"));
            std::fs::write(&path, format!("x,y,w,kind\n{rows}")).unwrap();
            path.display().to_string()
        })
        .collect();
    rows.clear();
    let (edges, list) = (folder.join("edges.txt"), folder.join("nu.csv"));
    std::fs::write(&edges, "0 0.01 0.05 0.2").unwrap();
    std::fs::write(&list, "1,2\n-3,0\n").unwrap();
    let files = files.join(" ");
    vec![
        "--sampler thomas -n 60 -k 53 --stats pcf,pcf-vector,spectrum,covariance,neighbors,k-function --max-frequency 8 \
         --lag-bins 12 --kernel gaussian"
            .into(),
        "--sampler jittered -n 64 -k 40 --convention psa --stats pcf,spectrum".into(),
        format!("{files} --stats pcf,k-function,spectrum --weight-column w --max-frequency 5"),
        format!("{files} --window 0,1,0,1 --stats pcf --class-column kind --edges {}", edges.display()),
        format!("{files} --stats spectrum --frequencies {}", list.display()),
        "--sampler random -n 50 -k 33 --stats pcf --kernel box --bandwidth 0.01 --exact-kernel".into(),
    ]
}

#[test]
fn shards_in_any_order_have_the_bytes_of_the_whole() {
    let (folder, device) = (tempfile::tempdir().unwrap(), device());
    for line in requests(folder.path()) {
        let request = request(&line);
        let expected = whole(&request, &device);
        let total = Measurement::of(&request).unwrap().total();
        let shards = || [0..16, 16..32, 32..total].map(|range| shard(&request, range, &device));
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0], [2, 1, 0]] {
            // Each through its bytes, as from other machines.
            let bytes = shards().map(|shard| shard.write());
            let read = |k: usize| Measurement::read("a shard", &bytes[k]).unwrap();
            let mut merged = read(order[0]);
            merged.merge(read(order[1])).unwrap();
            // Written and read again in between.
            merged = Measurement::read("merged", &merged.write()).unwrap();
            assert!(!merged.is_whole());
            merged.merge(read(order[2])).unwrap();
            assert!(merged.is_whole());
            assert_same(&files(&merged.analysis().unwrap()), &expected, &format!("{line}, in the order {order:?}"));
        }
    }
}

#[test]
fn a_measurement_that_was_read_goes_on() {
    let (folder, device) = (tempfile::tempdir().unwrap(), device());
    for line in requests(folder.path()) {
        let request = request(&line);
        let expected = whole(&request, &device);
        // Stopped at every place where a step ends.
        let mut steps = 0;
        loop {
            let mut first = Measurement::of(&request).unwrap().within(0..16, &device).unwrap();
            for _ in 0..steps {
                first.step(&device, &Control::default()).unwrap();
            }
            let done = !first.step(&device, &Control::default()).unwrap();
            let mut rest = Measurement::read("first", &first.write()).unwrap();
            rest.attach(Arc::new(Points::open(&request.input).unwrap()), &device).unwrap();
            let total = rest.total();
            let mut rest = rest.to(0..total);
            while rest.step(&device, &Control::default()).unwrap() {}
            assert_same(&files(&rest.analysis().unwrap()), &expected, &format!("{line}, after {steps} steps"));
            if done {
                break;
            }
            steps += 2;
        }
    }
}

#[test]
fn a_bandwidth_that_needs_all_realizations_is_found_after_the_merge() {
    let device = device();
    let request = request("--sampler thomas -n 60 -k 32 --stats pcf --kernel epanechnikov --bandwidth lscv");
    let mut merged = shard(&request, 16..32, &device);
    merged.merge(shard(&request, 0..16, &device)).unwrap();
    assert!(!merged.is_whole(), "the smoothed g waits for its bandwidth");
    while merged.step(&device, &Control::default()).unwrap() {}
    assert_same(&files(&merged.analysis().unwrap()), &whole(&request, &device), "lscv");
}

#[test]
fn what_is_not_of_one_whole_is_refused_by_name() {
    let (folder, device) = (tempfile::tempdir().unwrap(), device());
    let base =
        "--sampler random -n 40 -k 48 --stats pcf,spectrum,pcf-vector,neighbors --bins 8 --r-max 0.2 --max-frequency 4";
    let others = [
        // As many bins, with other edges.
        ("g(r), edges", base.replace("--r-max 0.2", "--r-max 0.3")),
        ("g(r), edges", base.replace("--bins 8", "--bins 8 --bin-scale log")),
        ("domain, sides", format!("{base} --box 2,2")),
        ("points, seed: 1, against 2", format!("{base} --seed 2")),
        ("points, n", base.replace("-n 40", "-n 41")),
        ("P, waves, max_frequency", base.replace("--max-frequency 4", "--max-frequency 5")),
        ("P, sectors", format!("{base} --sectors 4")),
        ("P, accuracy", format!("{base} --accuracy high")),
        ("g of the vector, lags, half", format!("{base} --lag-max 0.1")),
        ("sums, neighbours", base.replace(",neighbors", "")),
    ];
    let first = request(base);
    for (what, line) in others {
        let other = shard(&request(&line), 16..32, &device);
        let mut merged = shard(&first, 0..16, &device);
        let before = merged.write();
        let error = merged.merge(other).unwrap_err().to_string();
        assert!(error.contains(what), "{line}: {error}");
        assert!(merged.write() == before, "a refused merge changes nothing");
    }
    for (twice, range) in [("17 to 32", 16..32), ("17 to 48", 0..48)] {
        let mut merged = shard(&first, 16..48, &device);
        let error = merged.merge(shard(&first, range, &device)).unwrap_err().to_string();
        assert!(error.contains(&format!("both parts hold realizations {twice}")), "{error}");
    }
    for range in [3..16, 0..17, 32..49, 16..16] {
        let error = Measurement::of(&first).unwrap().within(range, &device).err().unwrap().to_string();
        assert!(error.contains("multiples of 16"), "{error}");
    }
    // Other points of the same number, in files of the same names.
    let write = |seed: u64| {
        let mut rng = Rng(seed);
        let path = folder.path().join("points.csv");
        let rows: String = (0..20).map(|_| format!("{},{}\n", rng.unit(), rng.unit())).collect();
        std::fs::write(&path, rows).unwrap();
        format!("{} --stats pcf", path.display())
    };
    let read = shard(&request(&write(1)), 0..1, &device).write();
    let line = write(2);
    let mut read = Measurement::read("old", &read).unwrap();
    let error = read.attach(Arc::new(Points::open(&request(&line).input).unwrap()), &device).unwrap_err().to_string();
    assert!(error.contains("other points were measured"), "{error}");
}

#[test]
fn damaged_files_are_never_half_read() {
    let device = device();
    let bytes = shard(&request("--sampler random -n 20 -k 16 --stats pcf,neighbors --bins 4"), 0..16, &device).write();
    assert!(Measurement::read("whole", &bytes).is_ok());
    let mut rng = Rng(9);
    for _ in 0..300 {
        let mut damaged = bytes.clone();
        let at = (rng.unit() * damaged.len() as f64) as usize;
        damaged[at] ^= 1 << (at % 8);
        assert!(Measurement::read("damaged", &damaged).is_err(), "byte {at}");
        assert!(Measurement::read("cut", &bytes[..at]).is_err(), "cut at {at}");
    }
    let error = Measurement::read("points.csv", b"x,y\n0.1,0.2\n").err().unwrap().to_string();
    assert!(error.starts_with("points.csv: holds no sums of pairwave"), "{error}");
}
