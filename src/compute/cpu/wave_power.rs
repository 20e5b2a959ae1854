//! The power spectrum, shared between threads. Formula: see `reference`; the ways to sum it are `wave_product` and `nufft`
//! (grids) and `wave_terms` (lists).

use std::borrow::Cow;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::Cpu;
use super::nufft::{self, Nufft};
use super::wave_product::{self, Product};
use super::wave_terms::Terms;
use crate::accumulate::WavePower;
use crate::compute::compensated::total;
use crate::compute::{Compute, See};
use crate::control::Control;
use crate::error::Result;
use crate::plan::LEAF;
use crate::plan::{PANEL, WaveMethod, WavePlan, WaveVectors};
use crate::points::Ensemble;
use crate::pool::Pool;

/// The points of a realization: per axis, fractions of the side in steps of 2^-64.
pub(super) struct WavePoints<'a> {
    pub(super) axes: Vec<&'a [u64]>,
    /// The same as numbers, 1 on the upper side of a window; for wave vectors that are no integers.
    pub(super) turns: Vec<Cow<'a, [f64]>>,
    pub(super) weights: Option<&'a [f64]>,
}

impl<'a> WavePoints<'a> {
    /// Those of realization `k`, for these wave vectors.
    pub(super) fn of(ensemble: &'a Ensemble, k: usize, waves: &WaveVectors) -> Self {
        let axes = ensemble.fractions(k);
        let whole = match waves {
            WaveVectors::Grid(_) => true,
            WaveVectors::List(list) => list.vectors.as_flattened().iter().all(|m| m.fract() == 0.0),
        };
        let turns = |axis: usize| Cow::Owned(ensemble.turns(k, axis).collect());
        let turns = if whole { Vec::new() } else { (0..axes.len()).map(turns).collect() };
        Self { axes, turns, weights: ensemble.weights(k) }
    }

    /// The same points with these weights.
    pub(super) fn weighted<'b>(&'b self, weights: &'b [f64]) -> WavePoints<'b> {
        let turns = self.turns.iter().map(|axis| Cow::Borrowed(&**axis)).collect();
        WavePoints { axes: self.axes.clone(), turns, weights: Some(weights) }
    }

    pub(super) fn len(&self) -> usize {
        self.axes[0].len()
    }

    /// `s_0`, rounded once.
    pub(super) fn total_weight(&self) -> f64 {
        self.weights.map_or(self.len() as f64, |w| total(w.iter().copied()))
    }

    /// The same points, `size` at a time.
    pub(super) fn chunks(&self, size: usize) -> impl Iterator<Item = WavePoints<'_>> {
        (0..self.len()).step_by(size).map(move |start| {
            let range = start..(start + size).min(self.len());
            WavePoints {
                axes: self.axes.iter().map(|axis| &axis[range.clone()]).collect(),
                turns: self.turns.iter().map(|axis| Cow::Borrowed(&axis[range.clone()])).collect(),
                weights: self.weights.map(|w| &w[range]),
            }
        })
    }
}

/// A way to sum the modes of a spectrum, cut into parts that threads take. A sum does not depend on the cut.
pub(super) trait Method: Sync {
    /// What a thread keeps from part to part.
    type Scratch: Default + Send;

    /// Number of parts.
    fn parts(&self) -> usize;

    /// Hands `s_m` (real part, imaginary part) of every mode of a part to `put`, with the index it is stored at.
    fn sum(
        &self,
        part: usize,
        points: &WavePoints<'_>,
        scratch: &mut Self::Scratch,
        control: &Control,
        put: impl FnMut(usize, [f64; 2]),
    ) -> Result<()>;
}

/// A spectrum's sums by any of them.
enum AnyMethod<'a> {
    F32(Product<'a, f32>),
    F64(Product<'a, f64>),
    Terms(Terms<'a>),
    /// And where DC is stored.
    Nufft(Arc<Nufft>, usize),
}

/// What a thread keeps from realization to realization.
#[derive(Default)]
struct Scratch {
    f32: wave_product::Scratch<f32>,
    f64: wave_product::Scratch<f64>,
    nufft: nufft::Scratch,
}

impl<'a> AnyMethod<'a> {
    fn new(cpu: &Cpu, plan: &'a WavePlan, (method, points): MethodKey, parts: usize) -> Result<Self> {
        Ok(match (&plan.waves, method) {
            (WaveVectors::List(list), _) => Self::Terms(Terms::new(cpu, list)),
            (WaveVectors::Grid(grid), WaveMethod::DirectF32) => {
                Self::F32(Product::new(cpu, grid, plan.needed(), plan.panel, parts))
            }
            (WaveVectors::Grid(grid), WaveMethod::DirectF64) => {
                Self::F64(Product::new(cpu, grid, plan.needed(), plan.panel, parts))
            }
            (WaveVectors::Grid(grid), WaveMethod::Nufft) => {
                Self::Nufft(cpu.nuffts.get(grid, plan.tolerance, points, cpu.level(), plan.memory)?, grid.dc())
            }
        })
    }

    /// Number of parts that threads can share; none, if they share the whole otherwise.
    fn parts(&self) -> usize {
        match self {
            Self::F32(method) => method.parts(),
            Self::F64(method) => method.parts(),
            Self::Terms(method) => method.parts(),
            Self::Nufft(..) => 0,
        }
    }

    /// `|s_m|^2` of the modes of a part.
    fn part(
        &self,
        part: usize,
        points: &WavePoints<'_>,
        scratch: &mut Scratch,
        control: &Control,
        mut put: impl FnMut(usize, f64),
    ) -> Result<()> {
        let put = |at, [re, im]: [f64; 2]| put(at, re * re + im * im);
        match self {
            Self::F32(method) => method.sum(part, points, &mut scratch.f32, control, put),
            Self::F64(method) => method.sum(part, points, &mut scratch.f64, control, put),
            Self::Terms(method) => method.sum(part, points, &mut (), control, put),
            Self::Nufft(..) => Ok(()),
        }
    }

    /// `|s_m|^2` of all modes. A pool takes part in what has no parts.
    fn whole(
        &self,
        points: &WavePoints<'_>,
        scratch: &mut Scratch,
        pool: Option<&Pool>,
        control: &Control,
        power: &mut [f64],
    ) -> Result<()> {
        if let Self::Nufft(nufft, dc) = self {
            let spread = nufft::Nonuniform { axes: &points.axes, weights: points.weights };
            nufft.power(&spread, &mut scratch.nufft, pool, control, power)?;
            power[*dc] = points.total_weight().powi(2);
            return Ok(());
        }
        (0..self.parts()).try_for_each(|part| self.part(part, points, scratch, control, |at, q| power[at] = q))
    }

    /// Bytes of a thread's scratch, where they count.
    fn bytes(&self, points: usize, weighted: bool) -> u64 {
        if let Self::Nufft(nufft, _) = self { nufft.bytes(points, weighted, 1) } else { 0 }
    }
}

/// A method, and about how many points it is made for, where that matters.
type MethodKey = (WaveMethod, usize);

pub(super) fn wave_power(cpu: &Cpu, plan: &WavePlan, ensemble: &Ensemble, control: &Control) -> Result<WavePower> {
    wave_power_seen(cpu, plan, ensemble, control, &|_, _| ())
}

/// The same, where each realization is looked at on the way.
pub(super) fn wave_power_seen(
    cpu: &Cpu,
    plan: &WavePlan,
    ensemble: &Ensemble,
    control: &Control,
    see: &See<'_>,
) -> Result<WavePower> {
    // To choose a method is to look at every mode: once per number of points.
    let mut known = HashMap::new();
    let keys = (0..ensemble.realizations()).map(|k| {
        let n = ensemble.points_in(k);
        *known.entry(n).or_insert_with(|| match plan.method(n) {
            WaveMethod::Nufft => (WaveMethod::Nufft, WaveMethod::about(n as f64) as usize),
            direct => (direct, 0),
        })
    });
    let keys = keys.collect();
    LeafJob { cpu, plan, ensemble, control, keys, see }.run()
}

/// `s_m` of one realization at every stored mode, real and imaginary part, in f64. All threads take part, unless called on one of them: then it works alone.
pub(super) fn amplitudes(
    cpu: &Cpu,
    waves: &WaveVectors,
    points: &WavePoints<'_>,
    out: &mut [[f64; 2]],
    control: &Control,
) -> Result<()> {
    let wanted = parts_wanted(cpu, 1);
    match waves {
        WaveVectors::List(list) => fill(cpu, &Terms::new(cpu, list), points, out, control),
        WaveVectors::Grid(grid) => {
            fill(cpu, &Product::<f64>::new(cpu, grid, None, PANEL, wanted), points, out, control)
        }
    }
}

fn fill<R: Method>(
    cpu: &Cpu,
    method: &R,
    points: &WavePoints<'_>,
    out: &mut [[f64; 2]],
    control: &Control,
) -> Result<()> {
    if cpu.pool.is_within() || method.parts() == 1 {
        let mut scratch = R::Scratch::default();
        return (0..method.parts()).try_for_each(|p| method.sum(p, points, &mut scratch, control, |at, s| out[at] = s));
    }
    let (next, out) = (AtomicUsize::new(0), Mutex::new(out));
    let results = cpu.pool.broadcast(|_| {
        let mut scratch = R::Scratch::default();
        loop {
            control.check()?;
            let part = next.fetch_add(1, Ordering::Relaxed);
            if part >= method.parts() {
                return Ok(());
            }
            let mut sums = Vec::new();
            method.sum(part, points, &mut scratch, control, |at, s| sums.push((at, s)))?;
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

struct LeafJob<'a> {
    cpu: &'a Cpu,
    plan: &'a WavePlan,
    ensemble: &'a Ensemble,
    control: &'a Control,
    /// The method of each realization.
    keys: Vec<MethodKey>,
    see: &'a See<'a>,
}

impl LeafJob<'_> {
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

    fn run(&self) -> Result<WavePower> {
        let threads = self.cpu.threads() as u64;
        let leaves = self.leaves();
        let methods = self.methods(1)?;
        // A leaf in the making is three sums per mode beside the spectrum.
        let weighted = self.ensemble.weights(0).is_some();
        let scratch = methods.iter().map(|((_, n), method)| method.bytes(*n, weighted)).max().unwrap_or(0);
        let fits = threads * (4 * self.spectrum_bytes() + scratch) <= self.plan.memory.0;
        if fits && (threads == 1 || leaves.len() as u64 >= 2 * threads) {
            return self.by_leaf(&leaves, &methods);
        }
        self.by_part()
    }

    fn spectrum_bytes(&self) -> u64 {
        self.plan.waves.len() as u64 * 8
    }

    /// The methods that realizations take, made for a number of parts.
    fn methods(&self, parts: usize) -> Result<HashMap<MethodKey, AnyMethod<'_>>> {
        let mut methods = HashMap::new();
        for k in 0..self.ensemble.realizations() {
            if let Entry::Vacant(method) = methods.entry(self.keys[k]) {
                method.insert(AnyMethod::new(self.cpu, self.plan, self.keys[k], parts)?);
            }
        }
        Ok(methods)
    }

    /// Many realizations: one thread per leaf of the ordered sum, so that nothing is left to one thread alone.
    fn by_leaf(&self, leaves: &[Range<usize>], methods: &HashMap<MethodKey, AnyMethod<'_>>) -> Result<WavePower> {
        let sums = Mutex::new(self.new_sums());
        let next = AtomicUsize::new(0);
        let results = self.cpu.pool.broadcast(|_| {
            let mut scratch = Scratch::default();
            let mut power = vec![0.0; self.plan.waves.len()];
            loop {
                self.control.check()?;
                let Some(leaf) = leaves.get(next.fetch_add(1, Ordering::Relaxed)) else { return Ok(()) };
                let mut sum = self.new_sums();
                for k in leaf.clone() {
                    let points = WavePoints::of(self.ensemble, k, &self.plan.waves);
                    methods[&self.keys[k]].whole(&points, &mut scratch, None, self.control, &mut power)?;
                    self.add(&mut sum, k, &mut power);
                    self.control.advance(1.0 / self.ensemble.realizations() as f64);
                }
                sum.close_leaf();
                sums.lock().unwrap_or_else(PoisonError::into_inner).merge(sum)?;
            }
        });
        results.into_iter().collect::<Result<()>>()?;
        Ok(sums.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    /// Few: as many realizations at a time as there are threads and memory for, in parts.
    fn by_part(&self) -> Result<WavePower> {
        let (threads, modes, realizations) = (self.cpu.threads(), self.plan.waves.len(), self.ensemble.realizations());
        let mut sums = self.new_sums();
        let mut scratch = Scratch::default();
        let at_once = (self.plan.memory.0 / self.spectrum_bytes().max(1)).clamp(1, threads as u64) as usize;
        for start in (0..realizations).step_by(at_once) {
            let wave = start..(start + at_once).min(realizations);
            let methods = self.methods(parts_wanted(self.cpu, wave.len()))?;
            let mut powers: Vec<_> = wave.clone().map(|_| Mutex::new(vec![0.0; modes])).collect();
            let of = |k: usize| &methods[&self.keys[k]];
            let tasks: Vec<_> = wave.clone().flat_map(|k| (0..of(k).parts()).map(move |part| (k, part))).collect();
            let next = AtomicUsize::new(0);
            let results = self.cpu.pool.broadcast(|_| {
                let mut scratch = Scratch::default();
                let mut part_sums = Vec::new();
                loop {
                    self.control.check()?;
                    let Some(&(k, part)) = tasks.get(next.fetch_add(1, Ordering::Relaxed)) else { return Ok(()) };
                    let points = WavePoints::of(self.ensemble, k, &self.plan.waves);
                    of(k).part(part, &points, &mut scratch, self.control, |at, q| part_sums.push((at, q)))?;
                    let mut power = powers[k - start].lock().unwrap_or_else(PoisonError::into_inner);
                    part_sums.drain(..).for_each(|(at, q)| power[at] = q);
                    self.control.advance(1.0 / (realizations * of(k).parts()) as f64);
                }
            });
            results.into_iter().collect::<Result<()>>()?;
            for (k, power) in wave.zip(&mut powers) {
                let power = power.get_mut().unwrap_or_else(PoisonError::into_inner);
                if of(k).parts() == 0 {
                    let points = WavePoints::of(self.ensemble, k, &self.plan.waves);
                    of(k).whole(&points, &mut scratch, Some(&self.cpu.pool), self.control, power)?;
                    self.control.advance(1.0 / realizations as f64);
                }
                self.add(&mut sums, k, power);
            }
        }
        sums.close_leaf();
        Ok(sums)
    }

    /// Adds realization `k`.
    fn add(&self, sums: &mut WavePower, k: usize, power: &mut [f64]) {
        if let Some(needed) = self.plan.needed() {
            // What a method may or may not compute, nobody sees.
            let dc = self.plan.waves.dc();
            let outside = needed.iter().enumerate().filter(|&(at, &needed)| needed == 0 && Some(at) != dc);
            outside.for_each(|(at, _)| power[at] = 0.0);
        }
        (self.see)(k, power);
        sums.add(self.ensemble.first_index() + k as u64, self.ensemble.norm(k), power, &self.plan.rings);
    }
}
