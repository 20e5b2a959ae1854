//! Integration errors whose power a GPU computes, against those of the reference. Cannot see: how fast.

use crate::common::*;
use crate::shared::open;
use pairwave::accumulate::Backend;
use pairwave::analysis::Measurement;
use pairwave::compute::Device;
use pairwave::compute::reference::Reference;
use pairwave::control::Control;
use pairwave::estimate::Analysis;

fn found(device: &Device, line: &str) -> Analysis {
    let request = request(line);
    let whole = 0..request.input.realizations.unwrap();
    let mut measurement = Measurement::of(&request).unwrap().within(whole, device).unwrap();
    while measurement.step(device, &Control::default()).unwrap() {}
    measurement.analysis().unwrap()
}

#[test]
fn both_forms_are_one_number_on_a_gpu() {
    let Some(gpu) = open("integration errors") else { return };
    let f64 = gpu.verdict().f64().is_ok();
    let gpu = Device::new(Box::new(gpu), Some(2)).unwrap();
    let reference = Device::new(Box::new(Reference), Some(2)).unwrap();
    for (accuracy, tolerance) in [("fast", 2e-5), ("high", 1e-11)] {
        if accuracy == "high" && !f64 {
            continue;
        }
        for sampler in
            ["jittered -n 64", "grid -n 49 --param shift=none", "jittered -n 32 --dim 1", "random -n 20 --dim 3"]
        {
            let line = format!(
                "--sampler {sampler} -k 3 --integrand gaussian:sigma=0.12 --integrand cosine:x=2,phase=0.3 --spatial pairs \
                 --max-frequency 12 --stats spectrum --accuracy {accuracy}"
            );
            let (here, truth) = (found(&gpu, &line), found(&reference, &line));
            assert_eq!(here.computed_by.backends, [Backend::Gpu], "{sampler}: {:?}", here.computed_by);
            for (a, b) in here.integration().unwrap().each.iter().zip(&truth.integration().unwrap().each) {
                let unit = b.v0 / here.shape.mean_points;
                let (spectral, spatial) = (a.spectral.value, a.spatial.unwrap().value);
                let off = [spectral - b.spectral.value, spectral - spatial, spatial - b.spatial.unwrap().value];
                assert!(
                    off.iter().all(|off| off.abs() <= tolerance * unit),
                    "{sampler}, {accuracy}, {:?}: {off:?} in units of {unit}",
                    a.integrand
                );
            }
            // P is what was computed on the way.
            let power = |a: &Analysis| a.spectrum().unwrap().p.clone();
            for (here, truth) in power(&here).iter().zip(power(&truth)) {
                assert!((here - truth).abs() <= 1e-5 * (1.0 + truth), "{sampler}, {accuracy}: {here} {truth}");
            }
        }
    }
}
