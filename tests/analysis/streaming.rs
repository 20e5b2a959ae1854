//! A measurement that is looked at while it goes on ends with the bytes of one that is not, whatever was changed meanwhile.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::common::{files, request};
use pairwave::analysis::{self, Measurement, Plan};
use pairwave::compute::{Device, cpu::Cpu};
use pairwave::control::Control;
use pairwave::source::Points;

fn device() -> Device {
    Device::new(Box::new(Cpu::new(Some(2)).unwrap()), Some(2)).unwrap()
}

fn at_once(line: &str) -> BTreeMap<String, Vec<u8>> {
    let (request, cpu) = (request(line), device());
    let source = Arc::new(Points::open(&request.input).unwrap());
    let plan = Plan::of(&request, &source).unwrap().for_device(cpu.compute());
    files(&analysis::run(&request, source, plan, &cpu, &Control::default(), &mut |_| ()).unwrap())
}

fn finish(measurement: &mut Measurement, cpu: &Device) -> BTreeMap<String, Vec<u8>> {
    while measurement.step(cpu, &Control::default()).unwrap() {}
    files(&measurement.analysis().unwrap())
}

fn assert_same(found: &BTreeMap<String, Vec<u8>>, expected: &BTreeMap<String, Vec<u8>>) {
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (name, bytes) in expected {
        assert!(found[name] == *bytes, "{name} differs");
    }
}

const ALL: &str = "--sampler thomas -n 100 --seed 3 --stats pcf,pcf-vector,spectrum,covariance,neighbors,k-function --max-frequency 12 --lag-bins 16";

#[test]
fn steps_end_with_the_bytes_of_the_whole() {
    let cpu = device();
    for k in [1, 5, 16, 37] {
        let line = format!("{ALL} -k {k}");
        let mut measurement = Measurement::live(&request(&line), &cpu).unwrap();
        let mut seen = 0;
        while measurement.step(&cpu, &Control::default()).unwrap() {
            let status = measurement.status();
            let done = status.tracks.iter().map(|t| t.done).sum::<u64>();
            assert!(done > seen, "every step adds");
            seen = done;
            assert!(measurement.analysis().unwrap().spectrum().is_some() || status.tracks[2].done == 0);
        }
        assert_same(&files(&measurement.analysis().unwrap()), &at_once(&line));
    }
}

#[test]
fn more_realizations_are_added_to_those_there() {
    let cpu = device();
    let line = |k| format!("--sampler jittered -n 100 --stats pcf,spectrum,covariance --max-frequency 12 -k {k}");
    let mut measurement = Measurement::live(&request(&line(5)), &cpu).unwrap();
    finish(&mut measurement, &cpu);
    for k in [21, 40] {
        let before = measurement.status().tracks[0].done;
        measurement.change(&request(&line(k)), &cpu).unwrap();
        assert!(measurement.status().tracks.iter().all(|t| t.kept == before), "{:?}", measurement.status());
        assert_same(&finish(&mut measurement, &cpu), &at_once(&line(k)));
    }
    measurement.change(&request(&line(7)), &cpu).unwrap();
    assert!(measurement.status().tracks.iter().all(|t| t.kept == 0), "sums cannot be taken apart");
    assert_same(&finish(&mut measurement, &cpu), &at_once(&line(7)));
}

#[test]
fn a_change_touches_only_its_own_sums() {
    let cpu = device();
    let line = |rest: &str| format!("--sampler jittered -n 100 -k 20 {rest}");
    let first = line("--stats pcf,spectrum,neighbors --max-frequency 12");
    let mut measurement = Measurement::live(&request(&first), &cpu).unwrap();
    finish(&mut measurement, &cpu);
    let mut expect = |rest: &str, kept: &[u64], rebinned: bool| {
        let line = line(rest);
        measurement.change(&request(&line), &cpu).unwrap();
        let status = measurement.status();
        assert_eq!(status.tracks.iter().map(|t| t.kept).collect::<Vec<_>>(), kept, "{line}");
        assert_eq!(status.tracks.iter().any(|t| t.rebinned), rebinned, "{line}");
        assert_same(&finish(&mut measurement, &cpu), &at_once(&line));
    };
    expect("--stats pcf,spectrum --max-frequency 14", &[20, 0], false);
    expect("--stats pcf,spectrum --max-frequency 14 --normalization intensity", &[20, 20], false);
    expect("--stats pcf,spectrum --max-frequency 14 --bins 128", &[20, 20], true);
    // Edges that are not among the finest: counted anew; those are the finest from here on.
    expect("--stats pcf,spectrum --max-frequency 14 --bins 100", &[0, 20], false);
    expect("--stats pcf,spectrum --max-frequency 14 --bins 50", &[20, 20], true);
    expect("--stats pcf,spectrum --max-frequency 14 --bins 100", &[20, 20], true);
    expect("--stats radial --max-frequency 14", &[20], false);
    expect("--stats spectrum --max-frequency 14", &[20], false);
    expect("--stats pcf --bins 100", &[20], false);
}

#[test]
fn envelopes_are_refused_while_realizations_come_in() {
    let line = "--sampler random -n 50 -k 3 --stats pcf --envelope 19";
    let error = Measurement::live(&request(line), &device()).err().unwrap().to_string();
    assert!(error.starts_with("envelope "), "{error}");
}

/// A bandwidth by cross-validation is found once all realizations are in; until then there is no smoothed g.
#[test]
fn a_bandwidth_is_found_at_the_end() {
    let line = "--sampler thomas -n 80 -k 20 --stats pcf --kernel epanechnikov --bandwidth lscv";
    let cpu = device();
    let mut measurement = Measurement::live(&request(line), &cpu).unwrap();
    measurement.step(&cpu, &Control::default()).unwrap();
    measurement.step(&cpu, &Control::default()).unwrap();
    assert!(measurement.analysis().unwrap().kernel().is_none());
    assert_same(&finish(&mut measurement, &cpu), &at_once(line));
}
