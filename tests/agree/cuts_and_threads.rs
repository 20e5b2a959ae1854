//! The bytes of sums are the same on any number of threads and however a batch is cut; cancelling gives none.

use crate::common::*;
use crate::shared::{bits, cpu, many};
use pairwave::Error;
use pairwave::compute::Compute;
use pairwave::compute::cpu::Cpu;
use pairwave::control::Control;
use pairwave::plan::{Accuracy, Correction, LEAF, RadialBins};

#[test]
fn threads_do_not_change_a_bit() {
    for (realizations, n) in [(1, 1500), (3, 1100), (70, 60)] {
        let ensemble = many(2, realizations, n);
        let pairs = pair_plan(&ensemble, RadialBins::linear(0.3, 50).unwrap(), Correction::None);
        let waves: Vec<_> =
            [Accuracy::Fast, Accuracy::High].map(|a| wave_plan(&ensemble, &[70, 40], a)).into_iter().collect();
        let run = |threads: usize| {
            let cpu = cpu(threads);
            let control = Control::default();
            let counts = wait(cpu.pair_counts(&pairs, &ensemble, &control)).unwrap();
            let powers: Vec<_> =
                waves.iter().map(|w| bits(&wait(cpu.wave_power(w, &ensemble, &control)).unwrap())).collect();
            ((counts.counts, counts.bins, counts.realizations), powers)
        };
        let one = run(1);
        for threads in [2, 5] {
            assert!(run(threads) == one, "{realizations} x {n} with {threads} threads");
        }
    }
}

#[test]
fn cuts_of_a_batch_do_not_change_a_bit() {
    let leaf = LEAF as usize;
    let ensemble = many(3, 5 * leaf + 3, 50);
    let pairs = pair_plan(&ensemble, RadialBins::linear(0.3, 50).unwrap(), Correction::None);
    let waves = wave_plan(&ensemble, &[5, 4, 3], Accuracy::Fast);
    let (cpu, control) = (cpu(2), Control::default());
    let whole = (
        wait(cpu.pair_counts(&pairs, &ensemble, &control)).unwrap(),
        bits(&wait(cpu.wave_power(&waves, &ensemble, &control)).unwrap()),
    );
    for cut in [leaf, 3 * leaf, 5 * leaf] {
        let parts = [ensemble.slice(0..cut), ensemble.slice(cut..ensemble.realizations())];
        let [mut counts, other] = parts.each_ref().map(|e| wait(cpu.pair_counts(&pairs, e, &control)).unwrap());
        counts.merge(&other).unwrap();
        assert!(counts == whole.0, "counts cut at {cut}");
        let [mut power, other] = parts.each_ref().map(|e| wait(cpu.wave_power(&waves, e, &control)).unwrap());
        power.merge(other).unwrap();
        assert!(bits(&power) == whole.1, "powers cut at {cut}");
    }
}

#[test]
fn cancelling_is_an_error_and_bad_threads_are_refused() {
    let ensemble = ensemble(&[uniform(2, 100, 1)]);
    let control = Control::default();
    control.cancel();
    let pairs = pair_plan(&ensemble, RadialBins::linear(0.5, 4).unwrap(), Correction::None);
    assert!(matches!(wait(cpu(2).pair_counts(&pairs, &ensemble, &control)), Err(Error::Cancelled)));
    let waves = wave_plan(&ensemble, &[4, 4], Accuracy::Fast);
    assert!(matches!(wait(cpu(2).wave_power(&waves, &ensemble, &control)), Err(Error::Cancelled)));
    for threads in [0, 1_000_000] {
        let error = Cpu::new(Some(threads)).unwrap_err();
        assert!(error.to_string().starts_with(&format!("threads {threads}: ")), "{error}");
    }
    assert!(cpu(2).computed_by().device().contains("2 threads"));
}
