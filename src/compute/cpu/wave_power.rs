//! The power spectrum, shared between threads. Formula: see `reference`; the ways to sum it are `wave_product` (grids)
//! and `wave_terms` (lists).

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::Cpu;
use super::wave_product::Product;
use super::wave_terms::Terms;
use crate::accumulate::{LEAF, WavePower};
use crate::compute::reference::wave_power::total;
use crate::compute::{Compute, Control};
use crate::error::Result;
use crate::plan::{MEMORY_BUDGET, WavePlan, WaveRoad, WaveVectors};
use crate::points::Ensemble;

/// The points of a realization: per axis, fractions of the side in steps of 2^-64.
pub(super) struct Points<'a> {
    pub(super) axes: Vec<&'a [u64]>,
    pub(super) weights: Option<&'a [f64]>,
}

impl<'a> Points<'a> {
    fn of(ensemble: &'a Ensemble, k: usize) -> Self {
        Self { axes: ensemble.fractions(k), weights: ensemble.weights(k) }
    }

    pub(super) fn len(&self) -> usize {
        self.axes[0].len()
    }

    /// `s_0`, rounded once.
    pub(super) fn total_weight(&self) -> f64 {
        self.weights.map_or(self.len() as f64, |w| total(w.iter().copied()))
    }

    /// The same points, `size` at a time.
    pub(super) fn chunks(&self, size: usize) -> impl Iterator<Item = Self> {
        (0..self.len()).step_by(size).map(move |start| {
            let range = start..(start + size).min(self.len());
            Self {
                axes: self.axes.iter().map(|axis| &axis[range.clone()]).collect(),
                weights: self.weights.map(|w| &w[range]),
            }
        })
    }
}

/// A way to sum the modes of a spectrum, cut into parts that threads take. A sum does not depend on the cut.
pub(super) trait Road: Sync {
    /// What a thread keeps from part to part.
    type Scratch: Default + Send;

    /// Number of parts.
    fn parts(&self) -> usize;

    /// Hands `s_m` (real part, imaginary part) of every mode of a part to `put`, with the index it is stored at.
    fn sum(
        &self,
        part: usize,
        points: &Points<'_>,
        scratch: &mut Self::Scratch,
        control: &Control,
        put: impl FnMut(usize, [f64; 2]),
    ) -> Result<()>;
}

pub(super) fn wave_power(cpu: &Cpu, plan: &WavePlan, ensemble: &Ensemble, control: &Control) -> Result<WavePower> {
    let job = Job { cpu, plan, ensemble, control };
    match (&plan.waves, plan.road) {
        (WaveVectors::List(list), _) => job.run(|_| Terms::new(cpu, list)),
        (WaveVectors::Grid(grid), WaveRoad::DirectF32) => job.run(|n| Product::<f32>::new(cpu, grid, plan.needed(), n)),
        (WaveVectors::Grid(grid), _) => job.run(|n| Product::<f64>::new(cpu, grid, plan.needed(), n)),
    }
}

/// `s_m` of one realization at every stored mode, real and imaginary part, in f64. `axes[a][j]` is the fraction of point
/// `j` along axis `a`. All threads take part, unless called on one of them: then it works alone.
pub(super) fn amplitudes(
    cpu: &Cpu,
    waves: &WaveVectors,
    axes: &[&[u64]],
    weights: Option<&[f64]>,
    out: &mut [[f64; 2]],
    control: &Control,
) -> Result<()> {
    let points = Points { axes: axes.to_vec(), weights };
    let wanted = parts_wanted(cpu, 1);
    match waves {
        WaveVectors::List(list) => fill(cpu, &Terms::new(cpu, list), &points, out, control),
        WaveVectors::Grid(grid) => fill(cpu, &Product::<f64>::new(cpu, grid, None, wanted), &points, out, control),
    }
}

fn fill<R: Road>(cpu: &Cpu, road: &R, points: &Points<'_>, out: &mut [[f64; 2]], control: &Control) -> Result<()> {
    if cpu.pool.current_thread_index().is_some() || road.parts() == 1 {
        let mut scratch = R::Scratch::default();
        return (0..road.parts()).try_for_each(|p| road.sum(p, points, &mut scratch, control, |at, s| out[at] = s));
    }
    let (next, out) = (AtomicUsize::new(0), Mutex::new(out));
    let results = cpu.pool.broadcast(|_| {
        let mut scratch = R::Scratch::default();
        loop {
            control.check()?;
            let part = next.fetch_add(1, Ordering::Relaxed);
            if part >= road.parts() {
                return Ok(());
            }
            let mut sums = Vec::new();
            road.sum(part, points, &mut scratch, control, |at, s| sums.push((at, s)))?;
            let mut out = out.lock().unwrap_or_else(PoisonError::into_inner);
            sums.into_iter().for_each(|(at, s)| out[at] = s);
        }
    });
    results.into_iter().collect()
}

/// Parts of a realization, for `realizations` of them at a time.
fn parts_wanted(cpu: &Cpu, realizations: usize) -> usize {
    if realizations >= cpu.threads() { 1 } else { (2 * cpu.threads()).div_ceil(realizations) }
}

struct Job<'a> {
    cpu: &'a Cpu,
    plan: &'a WavePlan,
    ensemble: &'a Ensemble,
    control: &'a Control,
}

impl Job<'_> {
    fn new_sums(&self) -> WavePower {
        WavePower::new(self.cpu.computed_by(), self.plan.waves.len(), &self.plan.rings)
    }

    /// The realizations, by leaf of the ordered sum.
    fn leaves(&self) -> Vec<Range<usize>> {
        let (first, realizations) = (self.ensemble.first_index(), self.ensemble.realizations());
        let leaf_of = |k: usize| (first + k as u64) / LEAF;
        (0..realizations)
            .filter(|&k| k == 0 || leaf_of(k) != leaf_of(k - 1))
            .map(|start| start..(((leaf_of(start) + 1) * LEAF - first) as usize).min(realizations))
            .collect()
    }

    /// Takes the road that `road` makes for a number of parts wanted.
    fn run<R: Road>(&self, road: impl Fn(usize) -> R) -> Result<WavePower> {
        let threads = self.cpu.threads() as u64;
        let leaves = self.leaves();
        let enough = threads == 1 || leaves.len() as u64 >= 2 * threads;
        // A leaf in the making is three sums per mode beside the spectrum.
        if enough && 4 * self.spectrum_bytes() * threads <= MEMORY_BUDGET {
            return self.by_leaf(&leaves, &road(1));
        }
        self.by_part(road)
    }

    fn spectrum_bytes(&self) -> u64 {
        self.plan.waves.len() as u64 * 8
    }

    /// Many realizations: one thread per leaf of the ordered sum, so that nothing is left to one thread alone.
    fn by_leaf<R: Road>(&self, leaves: &[Range<usize>], road: &R) -> Result<WavePower> {
        let sums = Mutex::new(self.new_sums());
        let next = AtomicUsize::new(0);
        let results = self.cpu.pool.broadcast(|_| {
            let mut scratch = R::Scratch::default();
            let mut power = vec![0.0; self.plan.waves.len()];
            loop {
                self.control.check()?;
                let Some(leaf) = leaves.get(next.fetch_add(1, Ordering::Relaxed)) else { return Ok(()) };
                let mut sum = self.new_sums();
                for k in leaf.clone() {
                    let points = Points::of(self.ensemble, k);
                    for part in 0..road.parts() {
                        road.sum(part, &points, &mut scratch, self.control, |at, s| power[at] = squared(s))?;
                    }
                    let index = self.ensemble.first_index() + k as u64;
                    sum.add(index, self.ensemble.norm(k), &power, &self.plan.rings);
                }
                sum.close_leaf();
                sums.lock().unwrap_or_else(PoisonError::into_inner).merge(sum)?;
            }
        });
        results.into_iter().collect::<Result<()>>()?;
        Ok(sums.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    /// Few: as many realizations at a time as there are threads and memory for, in parts.
    fn by_part<R: Road>(&self, road: impl Fn(usize) -> R) -> Result<WavePower> {
        let (threads, modes, realizations) = (self.cpu.threads(), self.plan.waves.len(), self.ensemble.realizations());
        let mut sums = self.new_sums();
        let at_once = (MEMORY_BUDGET / self.spectrum_bytes().max(1)).clamp(1, threads as u64) as usize;
        for start in (0..realizations).step_by(at_once) {
            let wave = start..(start + at_once).min(realizations);
            let road = road(parts_wanted(self.cpu, wave.len()));
            let powers: Vec<_> = wave.clone().map(|_| Mutex::new(vec![0.0; modes])).collect();
            let next = AtomicUsize::new(0);
            let results = self.cpu.pool.broadcast(|_| {
                let mut scratch = R::Scratch::default();
                let mut part_sums = Vec::new();
                loop {
                    self.control.check()?;
                    let task = next.fetch_add(1, Ordering::Relaxed);
                    let (k, part) = (task / road.parts(), task % road.parts());
                    let Some(power) = powers.get(k) else { return Ok(()) };
                    let points = Points::of(self.ensemble, start + k);
                    road.sum(part, &points, &mut scratch, self.control, |at, s| part_sums.push((at, squared(s))))?;
                    let mut power = power.lock().unwrap_or_else(PoisonError::into_inner);
                    part_sums.drain(..).for_each(|(at, q)| power[at] = q);
                }
            });
            results.into_iter().collect::<Result<()>>()?;
            for (k, power) in wave.zip(powers) {
                let power = power.into_inner().unwrap_or_else(PoisonError::into_inner);
                let index = self.ensemble.first_index() + k as u64;
                sums.add(index, self.ensemble.norm(k), &power, &self.plan.rings);
            }
        }
        sums.close_leaf();
        Ok(sums)
    }
}

fn squared([re, im]: [f64; 2]) -> f64 {
    re * re + im * im
}
