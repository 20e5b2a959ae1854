//! Points are drawn while those before them are measured: it happens, stops with the run, and rounds grow all the same.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::time::Duration;

use crate::common::request;
use pairwave::accumulate::{Backend, ComputedBy, LagCounts, PairCounts, WavePower};
use pairwave::analysis::{Ended, Job, Measurement, Plan};
use pairwave::compute::{Compute, Device, NotHere, Pending, Work, cpu::Cpu};
use pairwave::control::Control;
use pairwave::plan::{LagPlan, PairPlan, WavePlan};
use pairwave::points::Ensemble;
use pairwave::samplers::{Process, Realization, Sampler};
use pairwave::{Domain, Error, Points, Result};

/// What comes once and is waited for.
#[derive(Default)]
struct Event(Mutex<bool>, Condvar);

impl Event {
    fn tell(&self) {
        *self.0.lock().unwrap() = true;
        self.1.notify_all();
    }

    /// Whether it came; nobody waits for ever.
    fn came(&self) -> bool {
        let (happened, _) =
            self.1.wait_timeout_while(self.0.lock().unwrap(), Duration::from_secs(60), |told| !*told).unwrap();
        *happened
    }
}

/// What happens when points of a later round are drawn.
#[derive(Default)]
struct Told {
    second_round: Event,
    /// Whether they take until somebody stops them.
    for_ever: bool,
    stopped: Event,
}

/// Two random points, which tell.
struct TwoPoints(Arc<Told>);

impl Sampler for TwoPoints {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let told = &self.0;
        if which.index >= 16 {
            told.second_round.tell();
            if told.for_ever {
                while control.check().is_ok() {
                    std::thread::sleep(Duration::from_millis(1));
                }
                told.stopped.tell();
                return control.check().map(|()| Vec::new());
            }
        }
        let mut stream = which.stream();
        Ok((0..which.n as usize * which.dim).map(|_| stream.uniform()).collect())
    }
}

/// The CPU path, and what is done before it counts pairs.
struct Before<F>(Cpu, F);

impl<F: Fn() + Send + Sync> Compute for Before<F> {
    fn computed_by(&self) -> ComputedBy {
        ComputedBy::new(Backend::Cpu, "before")
    }

    fn supports(&self, work: Work<'_>) -> Result<(), NotHere> {
        self.0.supports(work)
    }

    fn pair_counts<'a>(
        &'a self,
        plan: &'a PairPlan,
        points: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, PairCounts> {
        (self.1)();
        self.0.pair_counts(plan, points, control)
    }

    fn lag_counts<'a>(
        &'a self,
        plan: &'a LagPlan,
        points: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, LagCounts> {
        self.0.lag_counts(plan, points, control)
    }

    fn wave_power<'a>(
        &'a self,
        plan: &'a WavePlan,
        points: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, WavePower> {
        self.0.wave_power(plan, points, control)
    }
}

/// Counts pairs of `k` realizations, with `before` before each round.
fn run(told: &Arc<Told>, k: u64, control: &Control, before: impl Fn() + Send + Sync + 'static) -> (Measurement, Ended) {
    let process = Process::own("told", Arc::new(TwoPoints(told.clone())), 2, k, 2, 1).unwrap();
    let points = Arc::new(Points::sampled(process, Domain::unit_torus(2)).unwrap());
    let request = request(&format!("--sampler random -n 2 -k {k} --stats pcf --device cpu"));
    let plan = Plan::of(&request, &points).unwrap();
    let mut measurement = Measurement::new(request, points, plan);
    let device = Device::new(Box::new(Before(Cpu::new(Some(2)).unwrap(), before)), None).unwrap();
    let ended = Job::default().measure(&mut measurement, &device, control, &mut |_| ());
    (measurement, ended)
}

#[test]
fn the_next_points_are_drawn_while_these_are_measured() {
    let told = Arc::new(Told::default());
    let (seen, all) = (told.clone(), Arc::new(AtomicBool::new(true)));
    let together = all.clone();
    let (measurement, ended) = run(&told, 64, &Control::default(), move || {
        together.fetch_and(seen.second_round.came(), Ordering::Relaxed);
    });
    assert!(matches!(ended, Ended::Whole), "{ended:?}");
    assert!(all.load(Ordering::Relaxed), "the second round was not drawn before the first was measured");
    assert_eq!(measurement.realizations(), 64);
}

#[test]
fn what_is_drawn_ahead_stops_with_the_run() {
    let told = Arc::new(Told { for_ever: true, ..Told::default() });
    let control = Arc::new(Control::default());
    let (seen, stop) = (told.clone(), control.clone());
    let (measurement, ended) = run(&told, 64, &control, move || {
        assert!(seen.second_round.came());
        stop.cancel();
    });
    assert!(matches!(ended, Ended::Failed(Error::Cancelled)), "{ended:?}");
    assert!(told.stopped.came(), "it draws for ever");
    assert!(measurement.is_even());
}

#[test]
fn rounds_grow() {
    let rounds = Arc::new(AtomicU64::new(0));
    let counted = rounds.clone();
    let (measurement, ended) = run(&Arc::default(), 20_000, &Control::default(), move || {
        counted.fetch_add(1, Ordering::Relaxed);
    });
    assert!(matches!(ended, Ended::Whole), "{ended:?}");
    assert_eq!(measurement.realizations(), 20_000);
    // 1,250 rounds of a leaf.
    assert!(rounds.load(Ordering::Relaxed) < 100, "{} rounds", rounds.load(Ordering::Relaxed));
}
