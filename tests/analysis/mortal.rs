//! A device that computes rightly until its lifetime in calls is over.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use pairwave::accumulate::{Backend, ComputedBy, LagCounts, PairCounts, WavePower};
use pairwave::compute::{Compute, NotHere, Pending, Work, cpu::Cpu, reference::Reference};
use pairwave::control::Control;
use pairwave::plan::{LagPlan, PairPlan, WavePlan};
use pairwave::points::Ensemble;
use pairwave::{Error, Result};

pub struct Mortal<C> {
    /// What it computes with, and what it says it is.
    pub with: C,
    pub backend: Backend,
    /// What its end is.
    pub end: fn() -> Error,
    pub calls_left: AtomicU64,
    /// How often it was asked for anything.
    pub asked: Arc<AtomicU64>,
    pub can_waves: bool,
    pub can_lags: bool,
    /// Adds this to every weight sum, as a GPU's f32 weights differ from those of the CPU path.
    pub off: u128,
}

impl Mortal<Reference> {
    /// A GPU, whose place the CPU path takes.
    pub fn new(calls: u64) -> Self {
        let end =
            || Error::Device { device: "mortal".into(), what: "pair_counts", reason: "the device was lost".into() };
        Self::of(Reference, Backend::Gpu, end, calls)
    }
}

impl Mortal<Cpu> {
    /// A processor: what is no error of a device is not done again.
    pub fn processor(calls: u64) -> Self {
        let end = || Error::input("mortal", "the device was lost");
        Self::of(Cpu::new(Some(1)).unwrap(), Backend::Cpu, end, calls)
    }
}

impl<C> Mortal<C> {
    fn of(with: C, backend: Backend, end: fn() -> Error, calls: u64) -> Self {
        let (calls_left, asked) = (AtomicU64::new(calls), Arc::default());
        Self { with, backend, end, calls_left, asked, can_waves: true, can_lags: true, off: 0 }
    }

    fn call(&self) -> Result<()> {
        self.asked.fetch_add(1, Ordering::Relaxed);
        let spend = |left: u64| left.checked_sub(1);
        self.calls_left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, spend).map(drop).map_err(|_| (self.end)())
    }
}

impl<C: Compute> Compute for Mortal<C> {
    fn computed_by(&self) -> ComputedBy {
        ComputedBy::new(self.backend, "mortal")
    }

    fn supports(&self, work: Work<'_>) -> Result<(), NotHere> {
        let because = |why: &str| Err(NotHere::Because(why.into()));
        match work {
            Work::Waves(_) if !self.can_waves => because("mortal knows no waves"),
            Work::Lags(_) if !self.can_lags => because("mortal knows no lags"),
            Work::Pairs(_) | Work::Lags(_) | Work::Waves(_) => Ok(()),
            _ => Err(NotHere::Never),
        }
    }

    fn pair_counts<'a>(
        &'a self,
        plan: &'a PairPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, PairCounts> {
        Box::pin(async move {
            self.call()?;
            let mut sums = self.with.pair_counts(plan, ensemble, control).await?;
            sums.bins.sums.iter_mut().for_each(|sum| *sum += self.off);
            sums.computed_by = self.computed_by();
            Ok(sums)
        })
    }

    fn lag_counts<'a>(
        &'a self,
        plan: &'a LagPlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, LagCounts> {
        Box::pin(async move {
            self.call()?;
            let mut sums = self.with.lag_counts(plan, ensemble, control).await?;
            sums.computed_by = self.computed_by();
            Ok(sums)
        })
    }

    fn wave_power<'a>(
        &'a self,
        plan: &'a WavePlan,
        ensemble: &'a Ensemble,
        control: &'a Control,
    ) -> Pending<'a, WavePower> {
        Box::pin(async move {
            self.call()?;
            let mut sums = self.with.wave_power(plan, ensemble, control).await?;
            sums.computed_by = self.computed_by();
            Ok(sums)
        })
    }
}
