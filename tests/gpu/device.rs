//! What a device says of itself, that results do not depend on what memory held before or on how a batch is cut, and that a lost
//! device is an error. Cannot see: other drivers than the one here.

use crate::common::*;
use crate::shared::{go, open, promises, shared};
use pairwave::Error;
use pairwave::accumulate::WavePower;
use pairwave::compute::gpu::{AdapterChoice, Fill, GpuCompute, adapters};
use pairwave::compute::{Compute, NotHere, Work};
use pairwave::control::Control;
use pairwave::plan::{
    Accuracy, Correction, EnsembleShape, PairPlan, PairSettings, RadialBins, WaveGrid, WaveList, WavePlan,
};
use pairwave::points::Domain;

/// Why a device leaves something to the CPU path.
fn refusal(gpu: &GpuCompute, work: Work<'_>) -> String {
    match gpu.supports(work) {
        Err(NotHere::Because(why)) => why,
        other => panic!("{work:?}: {other:?}"),
    }
}

#[test]
fn self_check_passes_and_says_what_it_found() {
    let Some(gpu) = shared("self-check") else { return };
    println!("{}\n{}", gpu.gpu().summary(), gpu.verdict());
    assert!(gpu.verdict().passed() && gpu.verdict().checks.len() >= 5);
    // A device may have no f64, but one that has it is to compute well.
    let f64 = gpu.verdict().f64();
    assert!(f64.as_ref().err().is_none_or(|why| why.contains("SHADER_F64")), "{f64:?}");
    assert!(wait(adapters()).iter().any(|a| a == gpu.gpu().summary()));
}

#[test]
fn an_adapter_that_is_not_there_is_an_error() {
    let none = wait(GpuCompute::open(AdapterChoice::Index(99))).map(|_| ()).unwrap_err();
    assert!(matches!(none, Error::NoDevice { .. }), "{none}");
    // A processor in disguise is never taken for hardware.
    let hardware = wait(adapters()).iter().any(|a| !a.software);
    match wait(GpuCompute::open(AdapterChoice::HardwareOnly)) {
        Ok(gpu) => assert!(!gpu.gpu().summary().software),
        Err(why) => assert!(!hardware && matches!(why, Error::NoDevice { .. }), "{why}"),
    }
}

#[test]
fn many_small_realizations() {
    let Some(gpu) = shared("many small realizations") else { return };
    let sets: Vec<_> = (0..500).map(|k| uniform(2, 20 + k % 13, k as u64)).collect();
    let ensemble = ensemble(&sets);
    let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 32).unwrap(), Correction::None);
    let here = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
    assert_counts_equal("500 sets", &here, &reference_counts(&plan, &ensemble));
    let plan = wave_plan(&ensemble, &[6, 6], Accuracy::Fast);
    let here = wait(gpu.wave_power(&plan, &ensemble, &go())).unwrap();
    assert_power_within("500 sets", Accuracy::Fast, &here, &reference_power(&plan, &ensemble));
}

#[test]
fn empty_realizations_are_zeros() {
    let Some(gpu) = shared("empty") else { return };
    for sets in [vec![uniform(2, 0, 1)], vec![uniform(2, 0, 1), uniform(2, 1, 2), uniform(2, 0, 3)]] {
        let ensemble = ensemble(&sets);
        let plan = pair_plan(&ensemble, RadialBins::linear(0.5, 8).unwrap(), Correction::None);
        let here = wait(gpu.pair_counts(&plan, &ensemble, &go())).unwrap();
        assert_counts_equal("empty", &here, &reference_counts(&plan, &ensemble));
        let plan = wave_plan(&ensemble, &[4, 4], Accuracy::Fast);
        let (here, truth) = (wait(gpu.wave_power(&plan, &ensemble, &go())).unwrap(), reference_power(&plan, &ensemble));
        assert_eq!((here.norm_totals(), here.realizations), (truth.norm_totals(), truth.realizations));
        for (a, b) in here.mode_totals().q.iter().zip(&truth.mode_totals().q) {
            assert!((a - b).abs() <= 1e-6, "{a} against {b}");
        }
    }
}

#[test]
fn batches_can_be_split_anywhere_at_a_leaf() {
    let Some(gpu) = shared("split") else { return };
    let sets: Vec<_> = (0..48).map(|k| uniform(2, 30 + k % 5, k as u64)).collect();
    let whole = ensemble(&sets);
    let pairs = pair_plan(&whole, RadialBins::linear(0.5, 20).unwrap(), Correction::None);
    let waves = wave_plan(&whole, &[9, 9], Accuracy::Fast);
    let all =
        (wait(gpu.pair_counts(&pairs, &whole, &go())).unwrap(), wait(gpu.wave_power(&waves, &whole, &go())).unwrap());
    let parts = [0..16, 16..32, 32..48].map(|r| whole.slice(r));
    let mut merged: Option<(_, _)> = None;
    for part in &parts {
        let (p, w) =
            (wait(gpu.pair_counts(&pairs, part, &go())).unwrap(), wait(gpu.wave_power(&waves, part, &go())).unwrap());
        match &mut merged {
            None => merged = Some((p, w)),
            Some((ps, ws)) => {
                ps.merge(&p).unwrap();
                ws.merge(w).unwrap();
            }
        }
    }
    assert_eq!(merged.unwrap(), all, "bytes, not only values");
}

#[test]
fn poisoned_memory_and_other_cuts_give_identical_bytes() {
    let sets = [uniform(2, 2500, 1), uniform(2, 700, 2), uniform(2, 3, 3)];
    let weights: Vec<f64> = (0..3203).map(|j| f64::from(j % 17) / 16.0 - 0.4).collect();
    let plain = ensemble(&sets);
    let weighted = plain.clone().with_weights(&weights);
    let pairs = pair_plan(&plain, RadialBins::logarithmic(1e-3, 0.5, 30).unwrap(), Correction::None);
    let Some(gpu) = shared("poison") else { return };
    let spectra = |gpu: &GpuCompute, frequency: &[u32]| -> Vec<WavePower> {
        let both = promises(gpu).flat_map(|p| [(p.accuracy, &plain), (p.accuracy, &weighted)]);
        both.map(|(accuracy, points)| {
            wait(gpu.wave_power(&wave_plan(points, frequency, accuracy), points, &go())).unwrap()
        })
        .collect()
    };
    let clean = (wait(gpu.pair_counts(&pairs, &plain, &go())).unwrap(), spectra(gpu, &[70, 71]));
    // 600 KiB hold one block of the grid at a time, 2^20 sums cut that into submissions. 1 byte is the smallest cut there is.
    for (fill, bytes, fma) in
        [(Fill::Poison, 64 << 20, 1 << 29), (Fill::Poison, 600 << 10, 1 << 20), (Fill::Zero, 1, 1)]
    {
        let Some(gpu) = open("poison") else { return };
        let gpu = gpu.with_tuning(|t| (t.fill, t.buffer_bytes, t.fma_per_dispatch) = (fill, bytes, fma));
        for _ in 0..2 {
            if bytes > 1 {
                assert_eq!(wait(gpu.pair_counts(&pairs, &plain, &go())).unwrap(), clean.0, "{fill:?}, {bytes}");
            }
            assert_eq!(spectra(&gpu, &[70, 71]), clean.1, "{fill:?}, {bytes}");
        }
    }
}

#[test]
fn a_lost_device_is_an_error_and_stays_one() {
    let Some(gpu) = open("lost device") else { return };
    let ensemble = ensemble(&[uniform(2, 300, 1)]);
    let pairs = pair_plan(&ensemble, RadialBins::linear(0.5, 20).unwrap(), Correction::None);
    let waves = wave_plan(&ensemble, &[9, 9], Accuracy::Fast);
    wait(gpu.pair_counts(&pairs, &ensemble, &go())).unwrap();
    gpu.gpu().lose();
    for _ in 0..2 {
        let why = wait(gpu.pair_counts(&pairs, &ensemble, &go())).unwrap_err();
        assert!(matches!(why, Error::Device { .. }) && why.to_string().contains("lost"), "{why}");
        let why = wait(gpu.wave_power(&waves, &ensemble, &go())).unwrap_err();
        assert!(matches!(why, Error::Device { .. }), "{why}");
    }
}

#[test]
fn a_device_lost_at_work_is_an_error() {
    let Some(gpu) = open("device lost at work") else { return };
    // One small dispatch after another, again and again, so that the loss falls among them.
    let gpu = gpu.with_tuning(|t| t.pairs_per_dispatch = 1);
    let ensemble = ensemble(&[uniform(2, 20_000, 1)]);
    let pairs = pair_plan(&ensemble, RadialBins::linear(0.5, 20).unwrap(), Correction::None);
    let why = std::thread::scope(|scope| {
        let work = scope.spawn(|| (0..10_000).find_map(|_| wait(gpu.pair_counts(&pairs, &ensemble, &go())).err()));
        std::thread::sleep(std::time::Duration::from_millis(500));
        gpu.gpu().lose();
        work.join().expect("no panic").expect("an error")
    });
    assert!(matches!(why, Error::Device { .. }), "{why}");
}

#[test]
fn cancelled_work_ends() {
    let Some(gpu) = shared("cancel") else { return };
    let ensemble = ensemble(&[uniform(2, 300, 1)]);
    let pairs = pair_plan(&ensemble, RadialBins::linear(0.5, 20).unwrap(), Correction::None);
    let control = Control::default();
    control.cancel();
    assert!(matches!(wait(gpu.pair_counts(&pairs, &ensemble, &control)), Err(Error::Cancelled)));
    let waves = wave_plan(&ensemble, &[9, 9], Accuracy::Fast);
    assert!(matches!(wait(gpu.wave_power(&waves, &ensemble, &control)), Err(Error::Cancelled)));
}

#[test]
fn what_is_not_done_here_is_said() {
    let Some(gpu) = shared("supports") else { return };
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    let ensemble = ensemble_in(&window, &[uniform(2, 50, 1)]);
    let plain = pair_plan(&ensemble, RadialBins::linear(0.4, 8).unwrap(), Correction::None);
    assert_eq!(gpu.supports(Work::Pairs(&plain)), Ok(()));
    let bins = |r: f64| RadialBins::linear(r, 8).unwrap();
    // Weights that grow without bound, and weights of points.
    let steep = pair_plan(&ensemble, bins(0.999), Correction::Translation);
    assert!(refusal(gpu, Work::Pairs(&steep)).contains("translation weights up to"));
    let near_corners = pair_plan(&ensemble, bins(0.707), Correction::Isotropic);
    assert!(refusal(gpu, Work::Pairs(&near_corners)).contains("isotropic weights up to"));
    let less_so = pair_plan(&ensemble, bins(0.7), Correction::Isotropic);
    assert_eq!(gpu.supports(Work::Pairs(&less_so)), Ok(()));
    let settings = PairSettings { masses: true, ..Correction::None.into() };
    let masses = PairPlan::new(&window, bins(0.4), settings, shape(&ensemble)).unwrap();
    assert!(refusal(gpu, Work::Pairs(&masses)).contains("weights of points"));
    for plan in [steep, near_corners, masses] {
        assert!(wait(gpu.pair_counts(&plan, &ensemble, &go())).is_err());
    }
    assert_eq!(gpu.supports(Work::Waves(&wave_plan(&ensemble, &[4, 4], Accuracy::Fast))), Ok(()));
    let high = wave_plan(&ensemble, &[4, 4], Accuracy::High);
    let why = gpu.verdict().f64().map_err(|why| NotHere::Because(format!("accuracy high needs f64: {why}")));
    assert_eq!(gpu.supports(Work::Waves(&high)), why);
    assert_eq!(wait(gpu.wave_power(&high, &ensemble, &go())).is_ok(), why.is_ok());
    let list = WaveList { dim: 2, vectors: vec![[1.0, 2.0, 0.0]], mirrored: false };
    let listed = WavePlan::new(&Domain::unit_torus(2), list, Accuracy::Fast, shape(&ensemble)).unwrap();
    assert!(refusal(gpu, Work::Waves(&listed)).contains("lists"));
    assert!(wait(gpu.wave_power(&listed, &ensemble, &go())).is_err());
    // More than any device has in one buffer: the number of bytes is said.
    let huge = EnsembleShape { max_points: 1 << 40, ..shape(&ensemble) };
    let huge = WavePlan::new(&window, WaveGrid::new(&[4, 4]).unwrap(), Accuracy::Fast, huge).unwrap();
    assert!(refusal(gpu, Work::Waves(&huge)).contains("17592186044416 bytes"));
}
