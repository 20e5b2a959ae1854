//! How the amplitudes of a realization are summed: whichever way is estimated to be fastest and keeps the promise.

use std::fmt;

use super::{Accuracy, NufftCosts, NufftSizes, WaveGrid, WaveVectors};

/// How `s_m` is summed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WaveMethod {
    /// By the definition, separably, tables and panels in f32.
    DirectF32,
    /// The same in f64; term by term for a list.
    DirectF64,
    /// Spreading onto a fine grid and a Fourier transform of that, in f64.
    Nufft,
}

/// A method, and what it would take for one realization.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MethodEstimate {
    /// The method.
    pub method: WaveMethod,
    /// Seconds on the machine that the costs are of.
    pub seconds: f64,
}

/// What the parts of a method take on a device, in nanoseconds of one thread (a GPU as a whole counts as one).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaveCosts {
    /// The device, in words.
    pub device: &'static str,
    /// The product in f32.
    pub f32: ProductCosts,
    /// The product in f64.
    pub f64: ProductCosts,
    /// A point at a wave vector of a list.
    pub term: f64,
    /// The transform, where there is one.
    pub nufft: Option<NufftCosts>,
}

/// What a product takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProductCosts {
    /// A point's cosine and sine in a table.
    pub entry: f64,
    /// A point's four products of cosines and sines at a row and a column.
    pub mode: f64,
    /// Adding their sums over a panel to those of all points.
    pub panel: f64,
    /// Making amplitudes of them.
    pub finish: f64,
    /// Beginning.
    pub start: f64,
}

/// Points per panel of the CPU's products, at most: with more of them the error in f32 grows (see `Accuracy` for the bound it must keep), with
/// fewer the time to add up panels.
pub const PANEL: usize = 160;

impl WaveCosts {
    /// Fitted to the times that `benches/wave_sweep.rs` takes on one core of an AMD EPYC of 2022 (Zen 4, AVX-512).
    /// What a transform is planned in is left out: it is planned once for all realizations alike.
    pub const CPU: Self = Self {
        device: "the CPU, one thread",
        f32: ProductCosts { entry: 1.1, mode: 0.065, panel: 1.6, finish: 9.5, start: 230.0 },
        f64: ProductCosts { entry: 1.25, mode: 0.112, panel: 7.5, finish: 5.6, start: 250.0 },
        term: 2.5,
        nufft: Some(NufftCosts::CPU),
    };

    /// Reasoned, not measured, for a GPU of the size of an NVIDIA H200: 30 TFLOP/s in f32, half of that in f64.
    pub const GPU: Self = Self {
        device: "a GPU, by reasoned costs",
        f32: ProductCosts { entry: 0.001, mode: 0.000_27, panel: 0.001, finish: 0.001, start: 1e5 },
        f64: ProductCosts { entry: 0.002, mode: 0.000_54, panel: 0.002, finish: 0.002, start: 1e5 },
        term: 2.5,
        nufft: None,
    };
}

impl WaveMethod {
    /// All there are.
    pub const ALL: [Self; 3] = [Self::DirectF32, Self::DirectF64, Self::Nufft];

    /// The estimate for a realization of `n` points, or why there is none: a method that does not keep the promise. `share` is
    /// the part of a grid's modes that is needed.
    pub(super) fn estimate(
        self,
        waves: &WaveVectors,
        accuracy: Accuracy,
        tolerance: f64,
        share: f64,
        n: f64,
        costs: &WaveCosts,
    ) -> Result<MethodEstimate, &'static str> {
        let nanoseconds = match (self, waves) {
            (Self::DirectF64, WaveVectors::List(list)) => n * list.vectors.len() as f64 * costs.term,
            (_, WaveVectors::List(_)) => return Err("is for grids, not for lists of wave vectors"),
            (Self::DirectF32, _) if accuracy != Accuracy::Fast => return Err("does not keep the promise"),
            (Self::DirectF32, WaveVectors::Grid(grid)) => costs.f32.nanoseconds(grid, share, n),
            (Self::DirectF64, WaveVectors::Grid(grid)) => costs.f64.nanoseconds(grid, share, n),
            (Self::Nufft, WaveVectors::Grid(grid)) => {
                let costs = costs.nufft.ok_or("is for the CPU alone")?;
                let sizes =
                    NufftSizes::new(grid, tolerance, Self::about(n)).map_err(|_| "has no kernel wide enough")?;
                costs.nanoseconds(&sizes, n)
            }
        };
        Ok(MethodEstimate { method: self, seconds: 1e-9 * nanoseconds })
    }

    /// The number of points that a transform of `n` is made for: a power of two, so that few are made.
    pub fn about(n: f64) -> f64 {
        n.max(1.0).log2().ceil().exp2()
    }

    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::DirectF32 => "direct f32",
            Self::DirectF64 => "direct f64",
            Self::Nufft => "NUFFT",
        }
    }
}

impl ProductCosts {
    fn nanoseconds(&self, grid: &WaveGrid, share: f64, n: f64) -> f64 {
        // Rows and columns without the first, in whole groups.
        let groups = |count: f64| (count / 8.0).ceil() * 8.0;
        let [f0, n1, n2] = grid.half_shape().map(|n| n as f64);
        let (rows, columns) = if grid.dim() == 1 {
            let half = ((f0 - 1.0) / 2.0).sqrt().round();
            (groups(half), groups(f0 / (2.0 * half + 1.0)))
        } else {
            (groups(f0 - 1.0), groups((n1 * n2 - 1.0) / 2.0))
        };
        let panels = (n / PANEL as f64).ceil();
        self.start
            + n * (rows + columns) * self.entry
            + rows * columns * share * (n * self.mode + panels * self.panel + self.finish)
    }
}

impl fmt::Display for MethodEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} about {:.2e} s", self.method.name(), self.seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::WaveList;

    #[test]
    fn what_is_no_method_says_why() {
        let grid = |f: u32| WaveVectors::from(WaveGrid::new(&[f, f]).unwrap());
        let why = |method: WaveMethod, waves: &WaveVectors, accuracy, costs: &WaveCosts| {
            method.estimate(waves, accuracy, accuracy.nufft_tolerance(), 1.0, 1000.0, costs).err()
        };
        let (fast, high, cpu) = (Accuracy::Fast, Accuracy::High, WaveCosts::CPU);
        assert!(WaveMethod::ALL.iter().all(|&method| why(method, &grid(64), fast, &cpu).is_none()));
        assert_eq!(why(WaveMethod::DirectF32, &grid(64), high, &cpu), Some("does not keep the promise"));
        assert_eq!(why(WaveMethod::Nufft, &grid(64), fast, &WaveCosts::GPU), Some("is for the CPU alone"));
        let list = WaveList { dim: 2, vectors: vec![[1.0, 2.0, 0.0]], mirrored: false }.into();
        for method in [WaveMethod::DirectF32, WaveMethod::Nufft] {
            assert_eq!(why(method, &list, fast, &cpu), Some("is for grids, not for lists of wave vectors"));
        }
        assert_eq!(why(WaveMethod::DirectF64, &list, fast, &cpu), None);
    }
}
