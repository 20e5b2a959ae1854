//! Runs that something ends in the middle: what was done is whole leaves of every group, can be kept, and is gone on with to the same numbers.

use crate::common::*;
use crate::mortal::Mortal;
use pairwave::analysis::{Ended, Job, Measurement, Plan};
use pairwave::compute::{Device, cpu::Cpu};
use pairwave::control::Control;
use pairwave::source::Points;

fn cpu() -> Device {
    Device::new(Box::new(Cpu::new(Some(1)).unwrap()), None).unwrap()
}

/// g and P in words: what is undefined is not equal to itself.
fn said(measurement: &Measurement) -> String {
    let found = measurement.analysis().unwrap();
    format!("{:?} {:?} {:?}", found.shape, found.pair_correlation(), found.spectrum())
}

/// What was done before `failed`, kept in a folder and gone on with there.
fn goes_on(failed: &Measurement, fresh: Measurement, device: &Device) -> Measurement {
    assert!(failed.is_even() && failed.realizations() > 0 && failed.realizations() < failed.total());
    assert!(failed.realizations().is_multiple_of(16), "{}", failed.realizations());
    let kept = tempfile::tempdir().unwrap();
    failed.save(kept.path()).unwrap();
    let mut rest = fresh.resume(Measurement::load(kept.path()).unwrap()).unwrap();
    let ended = Job::default().measure(&mut rest, device, &Control::default(), &mut |_| ());
    assert!(matches!(ended, Ended::Whole), "{ended:?}");
    rest
}

#[test]
fn a_device_that_is_lost_leaves_what_it_had_done() {
    let request = request("--sampler jittered -n 64 -k 400 --stats pcf,spectrum --max-frequency 4 --device cpu");
    let cpu = cpu();
    let mut whole = Measurement::of(&request).unwrap();
    assert!(matches!(Job::default().measure(&mut whole, &cpu, &Control::default(), &mut |_| ()), Ended::Whole));
    // Three calls: within the second round, when g has its realizations and P does not.
    for calls in [2, 3] {
        let lost = Device::new(Box::new(Mortal::processor(calls)), None).unwrap();
        let mut measurement = Measurement::of(&request).unwrap();
        let Ended::Failed(error) = Job::default().measure(&mut measurement, &lost, &Control::default(), &mut |_| ())
        else {
            panic!("the device was not lost")
        };
        assert!(error.to_string().contains("the device was lost"), "{error}");
        let rest = goes_on(&measurement, Measurement::of(&request).unwrap(), &cpu);
        assert!(said(&whole) == said(&rest), "other numbers after {calls} calls");
    }
}

#[test]
fn points_that_vanish_leave_what_was_read_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = |k: u64| folder.path().join(format!("{k:03}.csv"));
    for k in 0..64 {
        let set = uniform(2, 40, 100 + k).coordinates;
        let text: String = set.chunks(2).map(|p| format!("{},{}\n", p[0], p[1])).collect();
        std::fs::write(path(k), text).unwrap();
    }
    let request = request(&format!("{} --stats pcf,spectrum --max-frequency 4 --device cpu", folder.path().display()));
    let open = || {
        // Nothing is held: files are read again when they are needed.
        let points = std::sync::Arc::new(Points::files_within(&request.input, 0).unwrap());
        let plan = Plan::of(&request, &points).unwrap();
        Measurement::new(request.clone(), points, plan)
    };
    let cpu = cpu();
    let mut whole = open();
    assert!(matches!(Job::default().measure(&mut whole, &cpu, &Control::default(), &mut |_| ()), Ended::Whole));
    let mut measurement = open();
    let gone = std::fs::read(path(40)).unwrap();
    std::fs::remove_file(path(40)).unwrap();
    let Ended::Failed(error) = Job::default().measure(&mut measurement, &cpu, &Control::default(), &mut |_| ()) else {
        panic!("nobody missed the file")
    };
    assert!(error.to_string().contains("040.csv"), "{error}");
    std::fs::write(path(40), gone).unwrap();
    let rest = goes_on(&measurement, open(), &cpu);
    assert!(said(&whole) == said(&rest), "other numbers");
}
