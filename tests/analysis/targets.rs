//! Runs that end when a number is known well enough.

use crate::common::request;
use pairwave::analysis::{Ended, Job, Measurement, Standing};
use pairwave::compute::{Device, cpu::Cpu};
use pairwave::control::Control;
use pairwave::request::Request;

fn device() -> Device {
    Device::new(Box::new(Cpu::new(Some(1)).unwrap()), None).unwrap()
}

fn job(target: &str) -> Job {
    Job { until: vec![target.parse().unwrap()], ..Job::default() }
}

fn stopped(request: &Request, job: &Job, device: &Device) -> Measurement {
    let mut measurement = Measurement::of(request).unwrap();
    let ended = job.measure(&mut measurement, device, &Control::default(), &mut |_| ());
    assert!(matches!(ended, Ended::Whole), "{ended:?}");
    measurement
}

/// The part of 1,000 runs whose interval of 1.96 errors about the value holds the truth, by the stated error and by the plain one.
fn coverage(line: &str, target: &str, truth: f64) -> (f64, f64) {
    let (device, job) = (device(), job(target));
    let mut request = request(line);
    let mut held = [0u32; 2];
    for seed in 0..1000 {
        request.input.seed = Some(seed);
        let measurement = stopped(&request, &job, &device);
        let standing: &Standing = &measurement.standings()[0];
        assert!(standing.reached, "{standing:?}");
        let away = (standing.value - truth).abs();
        let errors = [standing.stated_error, standing.standard_error].map(|error| error.unwrap());
        assert!(errors[0] <= standing.target);
        (0..2).for_each(|which| held[which] += u32::from(away <= 1.96 * errors[which]));
    }
    (f64::from(held[0]) / 1000.0, f64::from(held[1]) / 1000.0)
}

/// g and P of random points are 1. A standard deviation of the share of 1,000 runs is 0.7 %.
#[test]
fn the_stated_error_holds_though_it_is_looked_at_often() {
    let g =
        coverage("--sampler random -n 16 -k 4000 --stats pcf --r-max 0.2 --bins 8 --device cpu", "pcf@0.11:0.06", 1.0);
    let line = "--sampler random -n 16 -k 4000 --stats spectrum --max-frequency 2 --device cpu";
    let p = coverage(line, "spectrum@1,-2:0.1", 1.0);
    for (name, (stated, plain)) in [("g", g), ("P", p)] {
        assert!(stated >= 0.935, "{name}: {stated}");
        // The plain error does not: what is compared can fail.
        assert!(plain < stated, "{name}: {plain}, {stated}");
    }
    assert!(p.1 < 0.935, "the plain error of exponential values, looked at often: {}", p.1);
}

#[test]
fn a_run_ends_at_the_same_realization_however_it_was_carried_out() {
    let device = device();
    let line = "--sampler jittered -n 64 -k 5000 --stats pcf,spectrum --max-frequency 4 --device cpu";
    let job = job("pcf@0.11:0.01");
    let whole = stopped(&request(line), &job, &device);
    let ends = whole.realizations();
    assert!((64..5000).contains(&ends) && ends.is_multiple_of(16), "{ends}");
    // Stopped between two looks and gone on with.
    let few = ends / 2 / 16 * 16;
    let first = stopped(&request(&line.replace("5000", &few.to_string())), &Job::default(), &device);
    assert_eq!(first.realizations(), few);
    let read = Measurement::read("first", &first.write()).unwrap();
    let mut rest = Measurement::of(&request(line)).unwrap().resume(read).unwrap();
    let ended = job.measure(&mut rest, &device, &Control::default(), &mut |_| ());
    assert!(matches!(ended, Ended::Whole));
    assert_eq!((whole.realizations(), whole.standings()), (rest.realizations(), rest.standings()));
    // In words, for what is undefined is not equal to itself.
    let said = |measured: &Measurement| {
        let found = measured.analysis().unwrap();
        [format!("{:?}", found.pair_correlation()), format!("{:?}", found.spectrum())]
    };
    let (a, b) = (said(&whole), said(&rest));
    assert!(a[0] == b[0], "other g");
    assert!(a[1] == b[1], "other P");
}

#[test]
fn what_is_not_reached_is_said_with_what_would_do() {
    let request = request("--sampler random -n 16 -k 100 --stats pcf --r-max 0.2 --bins 8 --device cpu");
    let measurement = stopped(&request, &job("pcf@0.11:0.001"), &device());
    let warnings = measurement.analysis().unwrap().warnings;
    assert_eq!(measurement.realizations(), 100);
    let said = warnings.iter().find(|warning| warning.contains("is not reached")).unwrap();
    assert!(said.contains("realizations would do"), "{said}");
}

#[test]
fn numbers_that_there_are_not_are_named() {
    for (target, why) in [
        ("pcf@0.9:0.1", "pcf.csv has no row there; expected R: r from 0 to 0.2"),
        ("pcf.h@0.1:0.1", "pcf.csv has no such column of values; expected g"),
        ("spectrum@1,1:0.1", "the run has no P on a grid"),
        ("variance@disk:0.1", "the run has no variance.csv"),
    ] {
        let request = request("--sampler random -n 16 -k 64 --stats pcf --r-max 0.2 --bins 8 --device cpu");
        let mut measurement = Measurement::of(&request).unwrap();
        let Ended::Failed(error) = job(target).measure(&mut measurement, &device(), &Control::default(), &mut |_| ())
        else {
            panic!("{target} was measured")
        };
        assert!(error.to_string().contains(why), "{target}: {error}");
    }
}
