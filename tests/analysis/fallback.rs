//! What happens when a device cannot, or fails in the middle: the CPU path takes over, nothing is counted twice or lost
//! (g is the same to the last bit, P up to the rounding of the backends that computed it), and the summary says so.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use crate::common::*;
use crate::mortal::Mortal;
use pairwave::accumulate::Backend;
use pairwave::analysis::{self, Analysis, Measurement, Plan};
use pairwave::compute::{Compute, Device, cpu::Cpu};
use pairwave::control::Control;
use pairwave::request::Request;
use pairwave::source::Points;
use pairwave::{Error, Result};

fn analyze(request: &Request, compute: impl Compute + 'static) -> Result<Analysis> {
    let source = Arc::new(Points::open(&request.input)?);
    let plan = Plan::of(request, &source)?;
    let device = Device::new(Box::new(compute), Some(2)).unwrap();
    analysis::run(request, source, plan, &device, &Control::default(), &mut |_| ())
}

#[test]
fn a_device_lost_in_the_middle_is_replaced_and_named() {
    // Several batches of 4096 realizations: the device dies after 0, 1, 2 or 3 calls, between batches or within one.
    let request = request(
        "--sampler random -n 4 -k 10000 --stats pcf,pcf-vector,spectrum --bins 8 --lag-bins 4 --max-frequency 2 --accuracy high",
    );
    let truth = analyze(&request, Cpu::new(Some(2)).unwrap()).unwrap();
    assert!(truth.warnings.is_empty());
    for calls in 0..=4 {
        let found = analyze(&request, Mortal::new(calls)).unwrap();
        assert_eq!(found.pair_correlation(), truth.pair_correlation(), "after {calls} calls");
        assert_eq!(found.vector(), truth.vector(), "after {calls} calls");
        let (p, q) = (&found.spectrum().unwrap().p, &truth.spectrum().unwrap().p);
        assert!(p.iter().zip(q).all(|(p, q)| (p - q).abs() < 1e-12), "after {calls} calls");
        let named = "mortal: pair_counts: the device was lost; continued on the native CPU path";
        assert_eq!(found.warnings, [named], "after {calls} calls");
        assert!(found.computed_by.backends.contains(&Backend::Cpu), "after {calls} calls: {:?}", found.computed_by);
        assert_eq!(found.computed_by.backends.contains(&Backend::Gpu), calls > 0, "{:?}", found.computed_by);
        assert!(found.computed_by.devices.len() <= 2, "each device is named once: {:?}", found.computed_by);
    }
}

#[test]
fn what_a_device_does_not_do_is_done_on_the_cpu_and_named() {
    let request = request("--sampler random -n 30 -k 3 --stats pcf,spectrum --max-frequency 3");
    let device = Mortal { can_waves: false, ..Mortal::new(100) };
    let found = analyze(&request, device).unwrap();
    assert!(found.warnings.contains(&"mortal knows no waves; done on the native CPU path".to_string()), "{found:?}");
    assert_eq!(found.computed_by.backends, [Backend::Gpu, Backend::Cpu]);
    let device = Mortal { can_lags: false, ..Mortal::new(100) };
    let found = analyze(&self::request("--sampler random -n 30 -k 3 --stats pcf-vector"), device).unwrap();
    assert!(found.warnings.contains(&"mortal knows no lags; done on the native CPU path".to_string()), "{found:?}");
}

/// The pairs between two classes are a difference, which must be of sums by one backend.
#[test]
fn a_device_lost_between_classes_leaves_no_mixture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trees.csv");
    let mut rng = Rng(3);
    let rows: Vec<_> = (0..40).map(|i| format!("{},{},{}", rng.unit(), rng.unit(), ["oak", "elm"][i % 2])).collect();
    std::fs::write(&path, format!("x,y,kind\n{}", rows.join("\n"))).unwrap();
    let request =
        request(&format!("{} --window 0,1,0,1 --class-column kind --stats pcf --bins 5 --r-max 0.4", path.display()));
    let truth = analyze(&request, Cpu::new(Some(1)).unwrap()).unwrap();
    let truth = truth.cross().unwrap();
    for calls in 0..=4 {
        let found = analyze(&request, Mortal { off: 1 << 20, ..Mortal::new(calls) }).unwrap();
        let found = found.cross().unwrap();
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4 * (1.0 + b));
        assert!(near(&found.between.g, &truth.between.g), "after {calls} calls: {:?}", found.between.g);
        assert_eq!(found.between.count, truth.between.count);
    }
}

#[test]
fn cancelling_ends_with_nothing() {
    let request = request("--sampler random -n 30 -k 50000");
    let source = Arc::new(Points::open(&request.input).unwrap());
    let plan = Plan::new(&request, source.domain(), source.shape()).unwrap();
    let control = Control::default();
    let cpu = Device::new(Box::new(Cpu::new(Some(1)).unwrap()), None).unwrap();
    let mut stages = 0;
    // Asked to stop in the middle of the second batch.
    let result = analysis::run(&request, source, plan, &cpu, &control, &mut |progress| {
        stages += 1;
        if progress.done > 0 && progress.stage == "wave_power" {
            control.cancel();
        }
    });
    assert!(matches!(result, Err(Error::Cancelled)), "cancelled work must not look like a result");
    assert!(stages < 12, "it went on for {stages} stages");
}

#[test]
fn a_plan_is_a_value_that_prints() {
    let request = request("--sampler random -n 1000 -k 100 --stats pcf,radial");
    let source = Points::open(&request.input).unwrap();
    let plan = Plan::new(&request, source.domain(), source.shape()).unwrap();
    let text = plan.to_string();
    for line in ["pair_counts: ", "wave_power: ", "skipped: half of the pairs", "skipped: neighbors (not asked for)"] {
        assert!(text.contains(line), "{line} is missing from\n{text}");
    }
    // What the tests of a plan can assert without a device.
    let e = ensemble(&[uniform(2, 50, 1)]);
    let pairs = pair_plan(&e, pairwave::plan::RadialBins::linear(0.5, 8).unwrap(), pairwave::plan::Correction::None);
    assert_eq!(pairs, pairs.clone());
}

/// A device that fails while the measurement is looked at stays failed, and is asked no more.
#[test]
fn a_device_lost_while_realizations_come_in_is_replaced_for_good() {
    let line = "--sampler random -n 20 -k 200 --stats pcf,spectrum --bins 8 --max-frequency 2 --accuracy high";
    let request = request(line);
    let truth = analyze(&request, Cpu::new(Some(2)).unwrap()).unwrap();
    let mortal = Mortal::new(3);
    let asked = mortal.asked.clone();
    let device = Device::new(Box::new(mortal), Some(2)).unwrap();
    let mut measurement = Measurement::live(&request, &device).unwrap();
    while measurement.step(&device, &Control::default()).unwrap() {}
    let found = measurement.analysis().unwrap();
    assert_eq!(found.pair_correlation(), truth.pair_correlation());
    let (p, q) = (&found.spectrum().unwrap().p, &truth.spectrum().unwrap().p);
    assert!(p.iter().zip(q).all(|(p, q)| (p - q).abs() < 1e-12));
    assert_eq!(found.warnings.len(), 1, "{:?}", found.warnings);
    assert!(found.warnings[0].ends_with("continued on the native CPU path"), "{:?}", found.warnings);
    let before = asked.load(Ordering::Relaxed);
    // Other settings, and another measurement on the same device: it is not asked again, and both say so.
    let other = self::request(&format!("{line} --seed 2"));
    let mut again = Measurement::live(&other, &device).unwrap();
    while again.step(&device, &Control::default()).unwrap() {}
    assert_eq!(asked.load(Ordering::Relaxed), before);
    assert_eq!(again.analysis().unwrap().warnings, found.warnings);
    assert_eq!(again.analysis().unwrap().computed_by.backends, [Backend::Cpu]);
}
