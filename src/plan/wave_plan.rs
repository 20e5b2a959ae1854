//! The plan for the power spectrum.

use std::fmt;
use std::sync::Arc;

use super::{
    Accuracy, Batch, Conventions, EnsembleShape, MEMORY_BUDGET, MethodEstimate, NufftSizes, PANEL,
    RING_DIRECTIONS_RULE, Rings, Sectors, TaperPlan, WaveCosts, WaveMethod, WaveVectors, refuse_polygon,
};
use crate::error::{Error, Result, numbers};
use crate::memory::Memory;
use crate::points::Domain;
use crate::setting::Setting;

/// Everything decided about the power spectrum before any phase is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct WavePlan {
    /// The domain.
    pub domain: Domain,
    /// The wave vectors.
    pub waves: WaveVectors,
    /// Their rings.
    pub rings: Rings,
    /// Tapers, in a window.
    pub taper: Option<TaperPlan>,
    /// Whose rings they are.
    pub conventions: Conventions,
    /// Whether only the rings are wanted: modes in none may be left out, and their sums are 0.
    pub rings_only: bool,
    /// Of the stored modes those that are wanted, as 1; others may be left out, and their sums are 0. All of them, where it is none.
    pub wanted: Option<Arc<[u32]>>,
    /// The promise to keep.
    pub accuracy: Accuracy,
    /// What the methods to it cost, by which each realization gets the fastest for its number of points.
    pub costs: WaveCosts,
    /// The method of all realizations instead.
    pub method: Option<WaveMethod>,
    /// The tolerance of transforms: that of the promise.
    pub tolerance: f64,
    /// Points of a panel, whose sums in f32 are short enough for the promise; 1 to `PANEL`.
    pub panel: usize,
    /// What transforms and sums may take.
    pub memory: Memory,
    /// Number and size of realizations.
    pub shape: EnsembleShape,
    /// Realizations worked on at a time.
    pub batch: Batch,
}

impl WavePlan {
    /// Decides.
    ///
    /// # Errors
    /// Wave vectors of another dimension than the domain.
    pub fn new(
        domain: &Domain,
        waves: impl Into<WaveVectors>,
        accuracy: Accuracy,
        shape: EnsembleShape,
    ) -> Result<Self> {
        refuse_polygon(domain, "spectrum, radial")?;
        let waves = waves.into();
        if let Some(grid) = waves.grid().filter(|grid| grid.dim() != domain.dim()) {
            let given = &grid.max_frequency()[..grid.dim()];
            let reason = match domain.dim() {
                1 => "expected 1 number for points with 1 coordinate".into(),
                dim => format!("expected 1 or {dim} numbers for points with {dim} coordinates"),
            };
            return Err(Error::setting(Setting::MaxFrequency, numbers(given.iter().map(|&f| f64::from(f))), reason));
        }
        let rings = Rings::new(&waves, domain);
        let bytes = shape.max_points * 24 + waves.len() as u64 * 8;
        let batch = Batch::new(shape, bytes);
        Ok(Self {
            domain: domain.clone(),
            waves,
            rings,
            taper: (!domain.is_torus()).then(TaperPlan::default),
            conventions: Conventions::default(),
            rings_only: false,
            wanted: None,
            accuracy,
            costs: WaveCosts::CPU,
            method: None,
            tolerance: accuracy.nufft_tolerance(),
            panel: PANEL,
            memory: Memory(MEMORY_BUDGET),
            shape,
            batch,
        })
    }

    /// The methods there are for a realization of `n` points, with estimates.
    pub fn methods(&self, n: f64) -> Vec<MethodEstimate> {
        WaveMethod::ALL.into_iter().filter_map(|method| self.estimate(method, n, self.share()).ok()).collect()
    }

    /// The estimate of one of them, or why it is none.
    fn estimate(&self, method: WaveMethod, n: f64, share: f64) -> std::result::Result<MethodEstimate, &'static str> {
        if method == WaveMethod::DirectF32 && self.tapered().is_some() {
            return Err("is not for tapers");
        }
        method.estimate(&self.waves, self.accuracy, self.tolerance, share, n, &self.costs)
    }

    /// The part of the stored modes that is needed.
    fn share(&self) -> f64 {
        let share = |wanted: &[u32]| wanted.iter().filter(|&&w| w > 0).count() as f64 / self.waves.len() as f64;
        self.needed().map_or(1.0, share)
    }

    /// The method of a realization of `n` points. It depends on nothing else of the ensemble, so that the parts of a batch,
    /// each computed by itself, are summed as in the whole.
    pub fn method(&self, n: usize) -> WaveMethod {
        self.method.unwrap_or_else(|| {
            let all = self.methods(n as f64);
            let best = all.into_iter().min_by(|a, b| a.seconds.total_cmp(&b.seconds));
            best.map_or(WaveMethod::DirectF64, |best| best.method)
        })
    }

    /// What a realization of `n` points takes by the fastest method, tapers and blocks of a transform included.
    pub fn seconds(&self, n: f64) -> f64 {
        let method = self.method(n.round() as usize);
        let all = self.methods(n);
        let one = all.iter().find(|m| m.method == method).map_or(0.0, |m| m.seconds);
        one * self.tapers() * if method == WaveMethod::Nufft { self.blocks(n) as f64 } else { 1.0 }
    }

    /// A number for every stored mode, where those of 0 may be left out: in no ring, or not wanted.
    pub fn needed(&self) -> Option<&[u32]> {
        self.wanted.as_deref().or_else(|| self.rings_only.then_some(&self.rings.ring_of))
    }

    /// Whether P at the stored mode is computed.
    pub fn computes(&self, index: usize) -> bool {
        self.needed().is_none_or(|needed| needed[index] > 0)
    }

    /// The same with power summed by direction (2D).
    ///
    /// # Errors
    /// As `Sectors::new`.
    pub fn with_sectors(mut self, count: usize) -> Result<Self> {
        self.rings.sectors = Sectors::new(count, &self.waves, &self.rings, &self.domain)?;
        Ok(self)
    }

    /// The same within that memory.
    #[must_use]
    pub fn within(self, memory: Memory) -> Self {
        Self { memory, ..self }
    }

    /// Blocks of frequencies that a transform of `n` points is cut to, to fit.
    fn blocks(&self, n: f64) -> usize {
        let sizes = self.waves.grid().and_then(|grid| NufftSizes::new(grid, self.tolerance, WaveMethod::about(n)).ok());
        sizes.map_or(1, |sizes| sizes.blocks(self.memory))
    }

    /// The same in words.
    fn in_blocks(&self, method: WaveMethod, n: f64) -> String {
        let blocks = if method == WaveMethod::Nufft { self.blocks(n) } else { 1 };
        if blocks == 1 {
            String::new()
        } else {
            format!(", {blocks} times: so many blocks of frequencies, to fit into {}", self.memory)
        }
    }

    /// Floating-point operations of the matrix products: 8 per point, row and column.
    pub fn flop(&self) -> f64 {
        let per_point = match &self.waves {
            WaveVectors::Grid(grid) => {
                let [rows, n1, n2] = grid.half_shape();
                8.0 * (rows * (n1 * n2).div_ceil(2)) as f64
            }
            WaveVectors::List(list) => 4.0 * list.vectors.len() as f64,
        };
        self.tapers() * per_point * self.shape.realizations as f64 * self.shape.mean_points
    }
}

impl fmt::Display for WavePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bound = self.accuracy.power_bound().max_any(self.shape.mean_points);
        let waves = match &self.waves {
            WaveVectors::Grid(grid) => {
                let axes: Vec<_> = grid.max_frequency()[..grid.dim()].iter().map(u32::to_string).collect();
                format!("|m| <= {}", axes.join(", "))
            }
            WaveVectors::List(list) if list.mirrored => format!("{} pairs of wave vectors", list.vectors.len()),
            WaveVectors::List(list) => format!("{} wave vectors", list.vectors.len()),
        };
        writeln!(f, "wave_power: {waves}, {} rings, {:.3e} flop", self.rings.count, self.flop())?;
        let accuracy = self.accuracy.name();
        writeln!(f, "  accuracy {accuracy}: |P - P_ref| <= {bound:.0e} (1 + P) whatever the points")?;
        if self.accuracy == Accuracy::Fast {
            let (rms, root) = (self.accuracy.power_bound().rms_uniform, (self.shape.realizations as f64).sqrt());
            let (k, least) = (self.shape.realizations, rms * root);
            writeln!(
                f,
                "  chance makes P / sqrt(K) of it, K = {k}: more than its rms error {rms:.0e} wherever P > {least:.0e}; `accuracy` high is for less"
            )?;
        }
        let (n, share) = (self.shape.mean_points, self.share());
        let method = self.method(n.round() as usize).name();
        writeln!(f, "  road: {method} for {n} points; on {}, one realization:", self.costs.device)?;
        for method in WaveMethod::ALL {
            match self.estimate(method, n, share) {
                Ok(estimate) => writeln!(f, "    {estimate}{}", self.in_blocks(method, n))?,
                Err(why) => writeln!(f, "    {} {why}", method.name())?,
            }
        }
        if let Some(taper) = &self.taper {
            writeln!(f, "  {taper}")?;
        }
        writeln!(f, "  {}", self.batch)?;
        if matches!(&self.waves, WaveVectors::List(list) if list.mirrored) {
            writeln!(f, "  {RING_DIRECTIONS_RULE}")?;
        }
        if let Some(needed) = self.needed() {
            let outside = needed.iter().filter(|&&needed| needed == 0).count();
            writeln!(
                f,
                "  skipped: {outside} modes {}",
                if self.wanted.is_some() { "that nobody wants" } else { "in no ring" }
            )?;
        }
        if let Some(grid) = self.waves.grid() {
            writeln!(f, "  skipped: {} modes that are mirror images", grid.full_len() - grid.half_len())?;
        }
        Ok(())
    }
}
