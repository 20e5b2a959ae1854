//! Simulations of an envelope are drawn for the data and the seed: repeated with both, new with either.

use std::sync::Arc;

use crate::common::request;
use pairwave::Analysis;
use pairwave::analysis::{self, Plan};
use pairwave::compute::{Device, cpu::Cpu};
use pairwave::control::Control;
use pairwave::source::Points;

fn analyzed(line: &str, cpu: &Device) -> Analysis {
    let request = request(line);
    let source = Arc::new(Points::open(&request.input).unwrap());
    let plan = Plan::of(&request, &source).unwrap().for_device(cpu.compute());
    analysis::run(&request, source, plan, cpu, &Control::default(), &mut |_| ()).unwrap()
}

fn device() -> Device {
    Device::new(Box::new(Cpu::new(Some(2)).unwrap()), Some(2)).unwrap()
}

#[test]
fn other_data_and_other_seeds_have_other_simulations() {
    let (cpu, folder) = (device(), tempfile::tempdir().unwrap());
    for (name, last) in [("a", 0.9), ("b", 0.8)] {
        let points = (0..9).map(|k| format!("0.{}5,0.{}1\n", k, (k * 7) % 9)).collect::<String>();
        std::fs::write(folder.path().join(format!("{name}.csv")), format!("{points}{last},{last}\n")).unwrap();
    }
    let highest = |name: &str, seed: &str| {
        let file = folder.path().join(format!("{name}.csv"));
        let line = format!("--stats k-function --bins 8 --envelope 9{seed} {}", file.display());
        analyzed(&line, &cpu).envelopes().unwrap().curves[0].pointwise[1].clone()
    };
    let first = highest("a", "");
    assert_eq!(first, highest("a", ""));
    assert_eq!(first, highest("a", " --seed 1"), "the default");
    assert_ne!(first, highest("a", " --seed 2"));
    assert_ne!(first, highest("b", ""));
}

/// Of 600 sets of independent points as many are found to differ at the 5 % level as should be, within 3 standard errors. (With the
/// same simulations for all of them the share was anything from 0.03 to 0.10, the same at every repetition.)
#[test]
fn a_test_has_the_size_that_it_says() {
    let (cpu, runs) = (device(), 600);
    let differs = |seed: u64| {
        let line = format!(
            "--sampler random -n 20 --seed {seed} --stats pcf --kernel epanechnikov --bins 6 --r-max 0.3 --envelope 19"
        );
        // Counts have ties, which make a test shy; a smoothed g has none.
        analyzed(&line, &cpu).envelopes().unwrap().find("g_kernel").unwrap().p <= 0.05
    };
    let share = (0..runs).filter(|&seed| differs(seed)).count() as f64 / runs as f64;
    assert!((share - 0.05).abs() <= 3.0 * (0.05 * 0.95 / runs as f64).sqrt(), "{share}");
}
