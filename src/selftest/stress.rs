//! Whether promises hold where numbers are at their worst: hostile points, far frequencies, many decades in one sum, and inputs that a search finds.
//! Everything is held against the reference, or against what is known exactly.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::accumulate::{Backend, ComputedBy, PairCounts, PairHistogram, WavePower};
use crate::compute::reference::Reference;
use crate::compute::{Compute, Device, Session, Work};
use crate::control::Control;
use crate::error::Result;
use crate::estimate::{IntegrationErrors, KernelEstimate, Normalization, PairCorrelation};
use crate::memory::Memory;
use crate::plan::{
    Accuracy, Correction, Divisor, EnsembleShape, IntegrationPlan, IntegrationSettings, KernelPlan, LEAF,
    MEMORY_BUDGET, PairPlan, RadialBins, Smoothing, SmoothingKernel, Spatial, WaveGrid, WaveList, WaveMethod, WavePlan,
};
use crate::points::{Domain, Ensemble, RawPoints};
use crate::samplers::Process;

/// A promise that was pushed at.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Stress {
    /// What was done, and what is looked at.
    pub what: String,
    /// What is promised of it: at most.
    pub bound: f64,
    /// The worst that was found.
    pub measured: f64,
    /// Inputs that were tried.
    pub tried: u64,
    /// Whether the promise holds.
    pub holds: bool,
}

impl Stress {
    fn new(what: impl Into<String>, bound: f64, measured: f64, tried: u64) -> Self {
        // Written so that NaN fails.
        Self { what: what.into(), bound, measured, tried, holds: measured <= bound }
    }

    /// How far the worst is from what is promised, as a factor.
    pub fn clearance(&self) -> f64 {
        if self.measured == 0.0 { f64::INFINITY } else { self.bound / self.measured }
    }
}

/// What is pushed at, and how hard.
struct Push<'a> {
    device: &'a Device,
    control: &'a Control,
    full: bool,
}

/// Pushes; each result is told of as soon as it is known.
///
/// # Errors
/// What the device says; `Error::Cancelled`.
pub async fn stress(
    device: &Device,
    full: bool,
    control: &Control,
    tell: &mut dyn FnMut(&Stress),
) -> Result<Vec<Stress>> {
    let push = Push { device, control, full };
    let mut all = Vec::new();
    let mut add = |found: Vec<Stress>| {
        found.iter().for_each(&mut *tell);
        all.extend(found);
    };
    add(push.counts().await?);
    add(vec![push.large_counts()?]);
    add(vec![push.many_realizations()]);
    add(push.far_frequencies().await?);
    add(push.lattice_zeros().await?);
    add(push.heavy_weights().await?);
    add(push.orders().await?);
    add(push.searched_power().await?);
    add(push.kernels().await?);
    add(push.cancelling_variance().await?);
    Ok(all)
}

/// Coordinates at the ends and in the middle of what f64 can say in [0, 1).
const HOSTILE: [f64; 14] = [
    0.0,
    -0.0,
    5e-324,
    2.225_073_858_507_201_4e-308,
    1.084_202_172_485_504_4e-19,
    1.110_223_024_625_156_5e-16,
    2.328_306_436_538_696_3e-10,
    1.0 / 3.0,
    0.499_999_999_999_999_94,
    0.5,
    0.500_000_000_000_000_1,
    0.999_999_999_767_169_4,
    0.999_999_999_999_999_8,
    0.999_999_999_999_999_9,
];

fn points(dim: usize, coordinates: Vec<f64>) -> RawPoints {
    RawPoints { dim, coordinates, source: "stress".into(), lines: Vec::new() }
}

fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// Uniform in [0, 1).
fn unit(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 * 2f64.powi(-53)
}

fn uniform(dim: usize, n: usize, seed: u64) -> Vec<f64> {
    let mut random = random(seed);
    (0..n * dim).map(|_| unit(&mut random)).collect()
}

impl Push<'_> {
    fn session(&self) -> Session<'_> {
        Session::new(self.device, self.control, None)
    }

    /// Pairs in another bin than the reference says; none are.
    async fn counts(&self) -> Result<Vec<Stress>> {
        let torus = Domain::unit_torus;
        let mut cases: Vec<(&str, Domain, Vec<f64>, RadialBins)> = Vec::new();
        for dim in 1..=3 {
            let n = HOSTILE.len().pow(2);
            let at = |j: usize, a: usize| HOSTILE[(j / [1, HOSTILE.len(), 5][a] + a) % HOSTILE.len()];
            let hostile: Vec<f64> = (0..n).flat_map(|j| (0..dim).map(move |a| at(j, a))).collect();
            cases.push((
                "coordinates of 0, 1 - 2^-53, subnormals, logarithmic bins",
                torus(dim),
                hostile.clone(),
                RadialBins::logarithmic(1e-18, 0.5, 300)?,
            ));
            cases.push((
                "coordinates of 0, 1 - 2^-53, subnormals, equal bins",
                torus(dim),
                hostile,
                RadialBins::linear(0.5, 256)?,
            ));
        }
        let n = if self.full { 4000 } else { 1000 };
        let moved = uniform(2, n, 1);
        let clusters = (0..n).zip(moved.chunks(2)).flat_map(|(j, by)| {
            let centre = [f64::from(j as u32 % 7) / 7.0, f64::from(j as u32 % 5) / 5.0];
            [centre[0] + 1e-9 * by[0], centre[1] + 1e-9 * by[1]]
        });
        cases.push(("clusters of 1e-9", torus(2), clusters.collect(), RadialBins::logarithmic(1e-12, 0.5, 400)?));
        let side = if self.full { 64 } else { 40 };
        let lattice = (0..side * side).flat_map(|k| [k % side, k / side].map(|x| x as f64 / side as f64));
        cases.push((
            "a lattice with its distances on edges",
            torus(2),
            lattice.collect(),
            RadialBins::linear(0.5, side / 2)?,
        ));
        let (corner, step) = (1e6, 1e-3);
        let window = Domain::window(&[(corner, corner + 0.1), (corner, corner + 0.1)])?;
        let projected = (0..10_000).step_by(if self.full { 3 } else { 11 });
        let projected = projected.flat_map(|k| [k % 100, k / 100].map(|x| corner + f64::from(x) * step));
        cases.push((
            "a map 1e6 from the origin, spacings of 1e-3",
            window,
            projected.collect(),
            RadialBins::linear(0.04, 40)?,
        ));
        let mut all = Vec::new();
        for (what, domain, coordinates, bins) in cases {
            let dim = domain.dim();
            let ensemble = Ensemble::from_raw(&[points(dim, coordinates)], &domain, false, 0)?;
            let plan = PairPlan::new(&domain, bins, Correction::None, ensemble.shape())?;
            let truth = Reference.pair_counts(&plan, &ensemble, self.control).await?;
            let suited = plan.clone().for_device(self.device.compute().costs().pairs);
            let found = self.session().pair_counts(&suited, &ensemble).await?;
            let wrong: u64 = found.counts.iter().zip(&truth.counts).map(|(a, b)| a.abs_diff(*b)).sum();
            let pairs = ensemble.points_in(0) as u64;
            all.push(Stress::new(
                format!("{what}, {dim}D: pairs in a wrong bin"),
                0.0,
                wrong as f64,
                pairs * (pairs - 1),
            ));
        }
        Ok(all)
    }

    /// Counts beyond 2^32 and 2^53 in a bin, of many realizations: their sum is exact, and g is it, rounded once.
    fn large_counts(&self) -> Result<Stress> {
        let shape = EnsembleShape { realizations: 1000, mean_points: 3e6, max_points: 3_000_000 };
        let plan = PairPlan::new(&Domain::unit_torus(2), RadialBins::linear(0.1, 2)?, Correction::None, shape)?;
        let mut counts = PairCounts::new(ComputedBy::new(Backend::Reference, "given"), &plan);
        let odd = (1u64 << 43) + 1;
        for k in 0..1000 {
            counts.add(&PairHistogram::new(3_000_000, vec![odd, odd + 2 * k], None));
        }
        let expected = [1000 * odd, 1000 * odd + 999_000];
        let g = PairCorrelation::new(&plan, &counts, Normalization::Pairs);
        let pairs = 1000.0 * 3e6 * (3e6 - 1.0);
        let off = (0..2).map(|bin| {
            let exact = expected[bin] as f64 / pairs / plan.shell_measure(bin);
            let missing = (counts.counts[bin] != expected[bin]) as u32;
            f64::from(missing) + (g.g[bin] / exact - 1.0).abs()
        });
        Ok(Stress::new("counts of 9e15 in a bin, K = 1000: g, relative", 4.0 * f64::EPSILON, off.fold(0.0, worse), 2))
    }

    /// Many realizations of powers of 16 decades: the mean of what is known exactly.
    fn many_realizations(&self) -> Stress {
        let leaves: u64 = if self.full { 1 << 16 } else { 1 << 12 };
        let grid = WaveGrid::new(&[1]);
        let shape = EnsembleShape { realizations: leaves * LEAF, mean_points: 1.0, max_points: 1 };
        let plan = grid.and_then(|grid| WavePlan::new(&Domain::unit_torus(1), grid, Accuracy::High, shape));
        let Ok(plan) = plan else { return Stress::new("sums over realizations", 0.0, f64::NAN, 0) };
        let modes = plan.waves.len();
        let mut sums = WavePower::new(ComputedBy::new(Backend::Reference, "given"), modes, &plan.rings);
        // 1 and 2^-52 in turn: a sum in one variable loses every other one.
        let of = |k: u64| if k.is_multiple_of(2) { 1.0 } else { f64::EPSILON };
        for k in 0..leaves * LEAF {
            sums.add(k, 1.0, &vec![of(k); modes], &plan.rings);
        }
        let half = (leaves * LEAF / 2) as f64;
        let exact = half + half * f64::EPSILON;
        let off = sums.mode_totals().q.iter().map(|q| (q / exact - 1.0).abs()).fold(0.0, worse);
        // Half an ulp for each level of the tree, and for each realization of a leaf.
        let levels = (leaves as f64).log2() + LEAF as f64;
        let what = format!("sums over K = {} realizations, 1 and 2^-52 in turn: relative", leaves * LEAF);
        Stress::new(what, 0.5 * levels * f64::EPSILON, off, leaves * LEAF)
    }

    /// The plans of a spectrum that a device has, by method and accuracy.
    fn plans(&self, plan: &WavePlan) -> Vec<WavePlan> {
        let compute = self.device.compute();
        let mut all = Vec::new();
        for accuracy in [Accuracy::Fast, Accuracy::High] {
            let plan = WavePlan {
                accuracy,
                tolerance: accuracy.nufft_tolerance(),
                costs: compute.costs().waves,
                ..plan.clone()
            };
            for method in plan.methods(plan.shape.mean_points).into_iter().map(|estimate| estimate.method) {
                let plan = WavePlan { method: Some(method), ..plan.clone() };
                // What keeps more than it promises is looked at where it promises it.
                let more = (accuracy, method) == (Accuracy::Fast, WaveMethod::DirectF64);
                if !more && compute.supports(Work::Waves(&plan)).is_ok() {
                    all.push(plan);
                }
            }
        }
        all
    }

    /// The largest |P - P_ref| / (1 + P_ref) of some modes of one realization.
    async fn error(&self, plan: &WavePlan, ensemble: &Ensemble, some: &[usize], truth: &[f64]) -> Result<f64> {
        let found = self.session().wave_power(plan, ensemble).await?.mode_totals().q;
        let norm = ensemble.norm(0);
        let off = some.iter().zip(truth).map(|(&index, t)| (found[index] - t).abs() / (norm + t));
        Ok(off.fold(0.0, worse))
    }

    /// |s|^2 of some modes by the reference.
    async fn truth(&self, plan: &WavePlan, ensemble: &Ensemble, some: &[usize]) -> Result<Vec<f64>> {
        let vectors = some.iter().map(|&index| plan.waves.vector(index)).collect();
        let list = WaveList { dim: plan.waves.dim(), vectors, mirrored: true };
        let list = WavePlan::new(&plan.domain, list, Accuracy::High, plan.shape)?;
        Ok(Reference.wave_power(&list, ensemble, self.control).await?.mode_totals().q)
    }

    /// P at |m| up to 2^20, and of many points.
    async fn far_frequencies(&self) -> Result<Vec<Stress>> {
        let mut all = Vec::new();
        let n = if self.full { 1_000_000 } else { 100_000 };
        let f = if self.full { 1 << 20 } else { 1 << 18 };
        for (n, f) in [(500, f), (n, 4096)] {
            let ensemble = Ensemble::from_raw(&[points(1, uniform(1, n, 2))], &Domain::unit_torus(1), false, 0)?;
            let plan = WavePlan::new(ensemble.domain(), WaveGrid::new(&[f])?, Accuracy::Fast, ensemble.shape())?;
            let some: Vec<usize> = (1..=24).map(|k| (plan.waves.len() - 1) * k / 24).collect();
            let truth = self.truth(&plan, &ensemble, &some).await?;
            for plan in self.plans(&plan) {
                let bound = plan.accuracy.power_bound().max_uniform;
                let measured = self.error(&plan, &ensemble, &some, &truth).await?;
                all.push(Stress::new(format!("P, |m| to {f}, n = {n}, 1D: {}", named(&plan)), bound, measured, 24));
            }
        }
        Ok(all)
    }

    /// A P of 0 in a spectrum that goes up to n.
    async fn lattice_zeros(&self) -> Result<Vec<Stress>> {
        let n = if self.full { 65_536u64 } else { 4096 };
        let (a, mut all) = (n / 2 - 19, Vec::new());
        let lattice = (0..n).flat_map(|k| [k as f64 / n as f64, (k * a % n) as f64 / n as f64]).collect();
        let ensemble = Ensemble::from_raw(&[points(2, lattice)], &Domain::unit_torus(2), false, 0)?;
        let f = 48;
        let plan = WavePlan::new(ensemble.domain(), WaveGrid::new(&[f, f])?, Accuracy::Fast, ensemble.shape())?;
        let is_zero = |index: &usize| {
            let m = plan.waves.vector(*index).map(|m| m as i64);
            (m[0] + m[1] * a as i64).rem_euclid(n as i64) != 0
        };
        let zeros: Vec<usize> = (0..plan.waves.len()).filter(is_zero).collect();
        for plan in self.plans(&plan) {
            let found = self.session().wave_power(&plan, &ensemble).await?.mode_totals().q;
            let largest = zeros.iter().map(|&index| found[index] / n as f64).fold(0.0, worse);
            let bound = plan.accuracy.power_bound().zero(n as f64);
            all.push(Stress::new(
                format!("zeros of P of a lattice of n = {n}, where others are n: {}", named(&plan)),
                bound,
                largest,
                zeros.len() as u64,
            ));
        }
        Ok(all)
    }

    /// Weights of 60 decades in one sum.
    async fn heavy_weights(&self) -> Result<Vec<Stress>> {
        let (n, mut all) = (400, Vec::new());
        let weights: Vec<f64> = uniform(1, n, 3).into_iter().map(|u| 10f64.powf(60.0 * u - 30.0)).collect();
        let ensemble = Ensemble::from_raw(&[points(2, uniform(2, n, 4))], &Domain::unit_torus(2), false, 0)?;
        let ensemble = ensemble.with_weights(&weights);
        let plan = WavePlan::new(ensemble.domain(), WaveGrid::new(&[12, 12])?, Accuracy::Fast, ensemble.shape())?;
        let some: Vec<usize> = (0..plan.waves.len()).collect();
        let truth = self.truth(&plan, &ensemble, &some).await?;
        for plan in self.plans(&plan) {
            let bound = plan.accuracy.power_bound().max_any(n as f64);
            let measured = self.error(&plan, &ensemble, &some, &truth).await?;
            all.push(Stress::new(
                format!("P of weights from 1e-30 to 1e30: {}", named(&plan)),
                bound,
                measured,
                some.len() as u64,
            ));
        }
        Ok(all)
    }

    /// Points in orders that make partial sums large.
    async fn orders(&self) -> Result<Vec<Stress>> {
        let n = if self.full { 20_000 } else { 3000 };
        let mut sorted: Vec<[f64; 2]> = uniform(2, n, 5).as_chunks().0.to_vec();
        sorted.sort_by(|p, q| p[0].total_cmp(&q[0]));
        let strided: Vec<[f64; 2]> = (0..160).flat_map(|r| sorted.iter().skip(r).step_by(160)).copied().collect();
        let mut all: Vec<Stress> = Vec::new();
        for order in [sorted.clone(), sorted.into_iter().rev().collect(), strided] {
            let flat = order.into_iter().flatten().collect();
            let ensemble = Ensemble::from_raw(&[points(2, flat)], &Domain::unit_torus(2), false, 0)?;
            let plan = WavePlan::new(ensemble.domain(), WaveGrid::new(&[20, 20])?, Accuracy::Fast, ensemble.shape())?;
            let some: Vec<usize> = (0..plan.waves.len()).step_by(7).collect();
            let truth = self.truth(&plan, &ensemble, &some).await?;
            for plan in self.plans(&plan) {
                let bound = plan.accuracy.power_bound().max_any(n as f64);
                let measured = self.error(&plan, &ensemble, &some, &truth).await?;
                merge(
                    &mut all,
                    Stress::new(
                        format!("P of points sorted, reversed and strided: {}", named(&plan)),
                        bound,
                        measured,
                        1,
                    ),
                );
            }
        }
        Ok(all)
    }

    /// The worst points that a search finds: hill climbing on the error over its bound, from several kinds of points.
    async fn searched_power(&self) -> Result<Vec<Stress>> {
        let (starts, steps) = if self.full { (12, 400) } else { (6, 40) };
        // More than a panel of points.
        let n = 200;
        let domain = Domain::unit_torus(2);
        let shape = EnsembleShape { realizations: 1, mean_points: n as f64, max_points: n as u64 };
        let plan = WavePlan::new(&domain, WaveGrid::new(&[7, 7])?, Accuracy::Fast, shape)?;
        let some: Vec<usize> = (0..plan.waves.len()).collect();
        let mut all = Vec::new();
        for plan in self.plans(&plan) {
            let bound = plan.accuracy.power_bound().max_any(n as f64);
            let (mut worst, mut tried) = (0.0f64, 0);
            for start in 0..starts {
                let mut random = random(100 + start);
                let mut coordinates = first_guess(start, n, &mut random);
                let mut height = 0.0f64;
                for step in 0..steps {
                    self.control.check()?;
                    let mut next = coordinates.clone();
                    if step > 0 {
                        change(&mut next, &mut random);
                    }
                    let ensemble = Ensemble::from_raw(&[points(2, next.clone())], &domain, false, 0)?;
                    let truth = self.truth(&plan, &ensemble, &some).await?;
                    let error = self.error(&plan, &ensemble, &some, &truth).await?;
                    tried += 1;
                    if !error.partial_cmp(&height).is_some_and(std::cmp::Ordering::is_lt) {
                        (height, coordinates) = (error, next);
                    }
                    worst = worse(worst, error);
                }
            }
            all.push(Stress::new(
                format!("P of the worst points that a search finds, n = {n}: {}", named(&plan)),
                bound,
                worst,
                tried,
            ));
        }
        Ok(all)
    }

    /// Kernels far narrower than the spacing, and nearly as wide as the box.
    async fn kernels(&self) -> Result<Vec<Stress>> {
        let mut all: Vec<Stress> = Vec::new();
        let n = 300;
        let ensemble = Ensemble::from_raw(&[points(2, uniform(2, n, 6))], &Domain::unit_torus(2), false, 0)?;
        for shape in [SmoothingKernel::Epanechnikov, SmoothingKernel::Gaussian, SmoothingKernel::Box] {
            for bandwidth in [1e-9, 1e-5, 0.05, 0.2] {
                let r = (1..40).map(|k| f64::from(k) / 100.0).collect();
                let kernel = Smoothing { shape, bandwidth };
                let plan = KernelPlan::new(
                    kernel,
                    Divisor::R,
                    r,
                    true,
                    ensemble.domain(),
                    Correction::None,
                    ensemble.shape(),
                )?;
                let truth = Reference.kernel_sums(&plan, &ensemble, self.control).await?;
                let found = self.session().kernel_sums(&plan, &ensemble).await?;
                let [truth, found] =
                    [truth, found].map(|sums| KernelEstimate::new(&plan, &sums, Normalization::Pairs).g);
                let off = truth.iter().zip(&found).map(|(t, g)| match (t, g) {
                    (Some(t), Some(g)) => (g - t).abs() / t.abs().max(1.0),
                    (None, None) => 0.0,
                    _ => f64::INFINITY,
                });
                let measured = off.fold(0.0, worse);
                merge(
                    &mut all,
                    Stress::new("kernel estimates, bandwidths of 1e-9 to 0.2: of max(1, g)", 1e-9, measured, 39),
                );
            }
        }
        Ok(all)
    }

    /// Predictions that all but cancel: a grid integrates a smooth function to rounding, and both forms say so.
    async fn cancelling_variance(&self) -> Result<Vec<Stress>> {
        let mut all = Vec::new();
        for (sampler, integrand) in [
            ("grid", "gaussian:sigma=0.1"),
            ("grid", "cosine:x=2,y=1"),
            ("jittered", "gaussian:sigma=0.15"),
            ("sobol", "cosine:x=3,y=2"),
        ] {
            let n = 256;
            let ensemble = Process::new(sampler, n, 4, 2, 1, &[])?.ensemble(0..4, self.control)?;
            let settings = IntegrationSettings {
                integrands: &[integrand.into()],
                estimator: None,
                shifts: 1,
                spatial: Some(Spatial::Pairs),
                top: None,
                intensity: None,
                by: None,
                weighted: false,
                max_frequency: Some(&[64]),
                low_frequency: Some(1),
                accuracy: Accuracy::High,
                memory: Memory(MEMORY_BUDGET),
                equal: true,
            };
            let plan = IntegrationPlan::new(ensemble.domain(), settings, ensemble.shape())?;
            let sums = self.session().integration(&plan, false, &ensemble).await?;
            let found = IntegrationErrors::new(&plan, &sums);
            let error = found.as_ref().and_then(|found| found.each.first());
            // In units of what random points have.
            let off = error.and_then(|e| Some((e.spatial?.value - e.closed.value).abs() / (e.v0 / n as f64)));
            let what =
                format!("variance of {integrand} by {sampler}, over that of random points: pairs against frequencies");
            all.push(Stress::new(what, 1e-11, off.unwrap_or(f64::NAN), 4));
        }
        Ok(all)
    }
}

/// The larger of two errors; NaN is the worst there is.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// A method and what it promises.
fn named(plan: &WavePlan) -> String {
    format!("{}, {}", plan.method.map_or("any", WaveMethod::name), plan.accuracy.name())
}

/// Adds a result to those of the same name, of which the worst counts.
fn merge(all: &mut Vec<Stress>, next: Stress) {
    match all.iter_mut().find(|one| one.what == next.what) {
        Some(one) => {
            let measured = worse(one.measured, next.measured);
            *one = Stress::new(next.what, next.bound, measured, one.tried + next.tried);
        }
        None => all.push(next),
    }
}

/// Points that a search begins with.
fn first_guess(kind: u64, n: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut any = || unit(random);
    match kind % 6 {
        0 => (0..2 * n).map(|_| any()).collect(),
        // All in one place.
        1 => {
            let [x, y] = [any(), any()];
            [x, y].into_iter().cycle().take(2 * n).collect()
        }
        // On a line.
        2 => {
            let y = any();
            (0..n).flat_map(|_| [any(), y]).collect()
        }
        // A few places.
        3 => {
            let places: Vec<[f64; 2]> = (0..5).map(|_| [any(), any()]).collect();
            (0..n).flat_map(|k| places[k % 5]).collect()
        }
        // Sorted.
        4 => {
            let mut xs: Vec<f64> = (0..n).map(|_| any()).collect();
            xs.sort_by(f64::total_cmp);
            xs.into_iter().flat_map(|x| [x, any()]).collect()
        }
        // A lattice.
        _ => (0..n).flat_map(|k| [k as f64 / n as f64, (k * 29 % n) as f64 / n as f64]).collect(),
    }
}

/// Changes a few coordinates: anew, to those of another point, by little, or to few digits.
fn change(coordinates: &mut [f64], random: &mut ChaCha8Rng) {
    let n = coordinates.len() / 2;
    let mut below = |most: usize| (random.next_u64() % most as u64) as usize;
    let (times, kind, from) = (1 + below(n / 4), below(5), below(n));
    for _ in 0..times {
        let at = 2 * below(n);
        let digits = 2f64.powi(below(30) as i32);
        let fresh = below(1 << 30) as f64 / f64::from(1 << 30);
        let source = [coordinates[2 * from], coordinates[2 * from + 1]];
        let [x, y] = [coordinates[at], coordinates[at + 1]];
        let changed = match kind {
            0 => [fresh, y],
            1 => source,
            2 => [x + 1e-7 * fresh, y],
            3 => [(x * digits).floor() / digits, y],
            _ => [y, x],
        };
        for (to, value) in coordinates[at..at + 2].iter_mut().zip(changed) {
            *to = if (0.0..1.0).contains(&value) { value } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::Forgetful;
    use super::*;
    use crate::compute::cpu::Cpu;

    #[test]
    fn a_device_that_loses_pairs_is_found() {
        let wrong = |compute: Box<dyn Compute>| {
            let device = Device::new(compute, Some(1)).unwrap();
            let push = Push { device: &device, control: &Control::default(), full: false };
            let found = crate::control::wait(push.counts()).unwrap();
            found.iter().filter(|one| !one.holds).count()
        };
        let cpu = || Cpu::new(Some(1)).unwrap();
        assert_eq!(wrong(Box::new(cpu())), 0);
        assert!(wrong(Box::new(Forgetful(cpu()))) > 0);
    }

    #[test]
    fn the_worst_of_a_name_counts_and_nan_fails() {
        let mut all = Vec::new();
        for measured in [1e-3, 1e-5] {
            merge(&mut all, Stress::new("one", 1e-2, measured, 10));
        }
        assert_eq!(all, [Stress { what: "one".into(), bound: 1e-2, measured: 1e-3, tried: 20, holds: true }]);
        assert_eq!(all[0].clearance(), 10.0);
        merge(&mut all, Stress::new("one", 1e-2, f64::NAN, 1));
        assert!(!all[0].holds);
    }

    #[test]
    fn changed_points_stay_in_the_box() {
        let mut random = random(7);
        for kind in 0..6 {
            let mut coordinates = first_guess(kind, 40, &mut random);
            assert_eq!(coordinates.len(), 80);
            (0..200).for_each(|_| change(&mut coordinates, &mut random));
            assert!(coordinates.iter().all(|x| (0.0..1.0).contains(x)));
        }
    }
}
