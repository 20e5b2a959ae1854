//! A measurement that is looked at while it goes on ends with the bytes of one that is not, whatever was changed meanwhile.

use std::collections::BTreeMap;

use crate::common::{files, request};
use pairwave::analysis::{self, Plan, Running};
use pairwave::compute::cpu::Cpu;
use pairwave::control::Control;
use pairwave::source::Source;

fn at_once(line: &str) -> BTreeMap<String, Vec<u8>> {
    let (request, cpu) = (request(line), Cpu::new(Some(2)).unwrap());
    let source = Source::open(&request.input).unwrap();
    let plan = Plan::of(&request, &source).unwrap().for_device(&cpu);
    files(&analysis::run(&request, &source, &plan, &cpu, &Control::default(), &mut |_| ()).unwrap())
}

fn finish(running: &mut Running, cpu: &Cpu) -> BTreeMap<String, Vec<u8>> {
    while running.step(cpu, &Control::default()).unwrap() {}
    files(&running.analysis().unwrap())
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
    let cpu = Cpu::new(Some(2)).unwrap();
    for k in [1, 5, 16, 37] {
        let line = format!("{ALL} -k {k}");
        let mut running = Running::new(request(&line), &cpu).unwrap();
        let mut seen = 0;
        while running.step(&cpu, &Control::default()).unwrap() {
            let status = running.status();
            let done = status.tracks.iter().map(|t| t.done).sum::<u64>();
            assert!(done > seen, "every step adds");
            seen = done;
            assert!(running.analysis().unwrap().spectrum().is_some() || status.tracks[2].done == 0);
        }
        assert_same(&files(&running.analysis().unwrap()), &at_once(&line));
    }
}

#[test]
fn more_realizations_are_added_to_those_there() {
    let cpu = Cpu::new(Some(2)).unwrap();
    let line = |k| format!("--sampler jittered -n 100 --stats pcf,spectrum,covariance --max-frequency 12 -k {k}");
    let mut running = Running::new(request(&line(5)), &cpu).unwrap();
    finish(&mut running, &cpu);
    for k in [21, 40] {
        let before = running.status().tracks[0].done;
        running.change(request(&line(k)), &cpu).unwrap();
        assert!(running.status().tracks.iter().all(|t| t.kept == before), "{:?}", running.status());
        assert_same(&finish(&mut running, &cpu), &at_once(&line(k)));
    }
    running.change(request(&line(7)), &cpu).unwrap();
    assert!(running.status().tracks.iter().all(|t| t.kept == 0), "sums cannot be taken apart");
    assert_same(&finish(&mut running, &cpu), &at_once(&line(7)));
}

#[test]
fn a_change_touches_only_its_own_sums() {
    let cpu = Cpu::new(Some(2)).unwrap();
    let line = |rest: &str| format!("--sampler jittered -n 100 -k 20 {rest}");
    let first = line("--stats pcf,spectrum,neighbors --max-frequency 12");
    let mut running = Running::new(request(&first), &cpu).unwrap();
    finish(&mut running, &cpu);
    let mut expect = |rest: &str, kept: &[u64], rebinned: bool| {
        let line = line(rest);
        running.change(request(&line), &cpu).unwrap();
        let status = running.status();
        assert_eq!(status.tracks.iter().map(|t| t.kept).collect::<Vec<_>>(), kept, "{line}");
        assert_eq!(status.tracks.iter().any(|t| t.rebinned), rebinned, "{line}");
        assert_same(&finish(&mut running, &cpu), &at_once(&line));
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
fn what_needs_all_realizations_is_refused() {
    let cpu = Cpu::new(Some(2)).unwrap();
    for (line, setting) in [
        ("--sampler random -n 50 -k 3 --stats pcf --kernel gaussian --bandwidth lscv", "bandwidth "),
        ("--sampler random -n 50 -k 3 --stats pcf --envelope 19", "envelope "),
    ] {
        let error = Running::new(request(line), &cpu).err().unwrap().to_string();
        assert!(error.starts_with(setting), "{error}");
    }
}
