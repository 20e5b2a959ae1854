//! Which kernel counts the pairs of a plan: files, numbers, bindings; and what it can hold.

use super::kernel::{self, KernelSpec, ShaderFile};
use super::params;
use crate::plan::{BinFilter, BinTable, Correction, PairPlan, PairSearch};

/// Invocations per workgroup of pairs in cells, and of the sort.
pub(super) const CELL_LANES: u32 = 64;
pub(super) const SORT_LANES: u32 = 64;
/// Workgroup memory given to copies of the histogram, per invocation: 16 KiB for 128 of them. More would keep other workgroups
/// off the processor.
const COPIES_BYTES: u32 = 128;
/// Of 32 lanes that run in step, as on most hardware, at most 32 / copies meet in one word: never more than 4 with 8 copies,
/// when all pairs of a lattice fall into one bin; of uniform points 3 to 4 meet on the worst bank of memory anyway. So a
/// lattice should take no more than twice as long (reasoned, not measured). Few bins get a copy for every lane.
const MAX_COPIES: u32 = 32;
/// Dispatches of fewer pairs than this are not worth it.
const LEAST_PAIRS: u64 = 1 << 22;

/// The words of one histogram, and how many of them are pairs of words.
pub(super) struct Layout {
    /// All words.
    pub(super) words: u32,
    /// Sums of 64 bits, at the end: low halves, then high halves.
    pub(super) sums: u32,
}

impl Layout {
    pub(super) fn new(plan: &PairPlan) -> Self {
        let bins = plan.bins.len() as u32;
        match plan.correction {
            Correction::None => Self { words: bins, sums: 0 },
            Correction::Translation | Correction::Isotropic => Self { words: 3 * bins, sums: bins },
            Correction::Border => Self { words: 3 * bins + 1, sums: 0 },
        }
    }

    /// Words that are sums of their own.
    pub(super) fn plain(&self) -> usize {
        (self.words - 2 * self.sums) as usize
    }

    /// How many sums there are.
    pub(super) fn values(&self) -> usize {
        (self.words - self.sums) as usize
    }
}

/// The kernel for all pairs of a plan on a device with `limit` bytes of workgroup memory.
pub(super) fn all_pairs(plan: &PairPlan, limit: u32) -> KernelSpec {
    let tile = plan.tile.points();
    let tile_words = plan.domain.dim() as u32 * tile;
    let (mut files, mut overrides) = parts(plan, plan.tile.lanes, limit - 4 * tile_words);
    files.push(kernel::PAIR_COUNTS);
    overrides.extend([("TILE", tile), ("TILE_WORDS", tile_words)]);
    let bindings = match (&plan.filter, plan.border()) {
        (BinFilter::Linear { .. }, false) => params::PAIR_LINEAR,
        (BinFilter::Table(_), false) => params::PAIR_TABLE,
        (BinFilter::Linear { .. }, true) => params::PAIR_LINEAR_BORDER,
        (BinFilter::Table(_), true) => params::PAIR_TABLE_BORDER,
    };
    KernelSpec { name: "pair_counts", files, overrides, bindings }
}

/// The kernel for pairs in cells near each other.
pub(super) fn cell_pairs(plan: &PairPlan, limit: u32) -> KernelSpec {
    let (mut files, overrides) = parts(plan, CELL_LANES, limit);
    files.push(kernel::PAIR_COUNTS_CELLS);
    let bindings = match (&plan.filter, plan.border()) {
        (BinFilter::Linear { .. }, false) => params::CELL_PAIR_LINEAR,
        (BinFilter::Table(_), false) => params::CELL_PAIR_TABLE,
        (BinFilter::Linear { .. }, true) => params::CELL_PAIR_LINEAR_BORDER,
        (BinFilter::Table(_), true) => params::CELL_PAIR_TABLE_BORDER,
    };
    KernelSpec { name: "pair_counts_cells", files, overrides, bindings }
}

/// Files and numbers that kernels over pairs share, for workgroups with `bytes` of memory left for histograms.
fn parts(plan: &PairPlan, workgroup: u32, bytes: u32) -> (Vec<ShaderFile>, Vec<(&'static str, u32)>) {
    let (dim, bins) = (plan.domain.dim(), plan.bins.len() as u32);
    let layout = Layout::new(plan);
    let cubic = plan.domain.periods()[..dim].iter().all(|&p| p == 0);
    let mut files = vec![kernel::WIDE_INTEGERS, if cubic { kernel::TORUS_CUBIC } else { kernel::TORUS_BOX }];
    let mut overrides = vec![
        ("WORKGROUP", workgroup),
        ("DIM", dim as u32),
        ("BINS", bins),
        ("WORDS", layout.words),
        ("SUMS", layout.sums),
    ];
    match plan.filter {
        BinFilter::Linear { .. } => files.push(kernel::BINS_LINEAR),
        BinFilter::Table(_) => {
            files.push(kernel::BINS_TABLE);
            overrides.push(("CELL_SHIFT", BinTable::CELL_SHIFT));
        }
    }
    if 4 * u64::from(layout.words) <= u64::from(bytes) {
        let mut copies = 1;
        while copies < MAX_COPIES && 8 * copies * layout.words <= (COPIES_BYTES * workgroup).min(bytes) {
            copies *= 2;
        }
        files.push(kernel::HISTOGRAM_WORKGROUP);
        overrides.extend([("COPIES", copies), ("HISTOGRAM_WORDS", layout.words * copies)]);
    } else {
        files.push(kernel::HISTOGRAM_GLOBAL);
    }
    match plan.correction {
        Correction::None => files.push(kernel::WEIGHTS_NONE),
        Correction::Translation => files.extend([kernel::WEIGHTS_FIXED_POINT, kernel::WEIGHTS_TRANSLATION]),
        Correction::Isotropic => files.extend([kernel::WEIGHTS_FIXED_POINT, kernel::WEIGHTS_ISOTROPIC]),
        Correction::Border => files.push(kernel::WEIGHTS_BORDER),
    }
    files.push(kernel::PAIRS);
    (files, overrides)
}

/// The kernel that counts the points of cells, and the one that sorts them.
pub(super) fn sort(plan: &PairPlan) -> [KernelSpec; 2] {
    let mut overrides = vec![("WORKGROUP", SORT_LANES), ("DIM", plan.domain.dim() as u32)];
    let files = vec![kernel::WIDE_INTEGERS, kernel::CELL_TYPES, kernel::CELL_COUNT];
    let count = KernelSpec { name: "cell_count", files, overrides: overrides.clone(), bindings: params::CELL_COUNT };
    overrides.push(("DEPTHS", u32::from(plan.border())));
    let files = vec![kernel::CELL_TYPES, kernel::CELL_SCATTER];
    [count, KernelSpec { name: "cell_scatter", files, overrides, bindings: params::CELL_SCATTER }]
}

/// What one unordered pair adds to any word of a histogram, at most: the upper halves of sums count whole units.
fn largest_addend(plan: &PairPlan) -> f64 {
    let ratio = plan.bins.r_max() / plan.domain.shortest_side();
    match plan.correction {
        Correction::None => 1.0,
        // Both of its points.
        Correction::Border => 2.0,
        // Of the differences along the axes only one exceeds r / sqrt(2), and none of the rest r / sqrt(3).
        Correction::Translation => {
            (1..=plan.domain.dim()).map(|k| 1.0 / (1.0 - ratio / (k as f64).sqrt()).max(1e-9)).product()
        }
        // Of either point.
        Correction::Isotropic => 2.0 * plan.largest_isotropic(),
    }
}

/// How many pairs may be looked at before words of 32 bits overflow.
pub(super) fn pair_limit(plan: &PairPlan) -> u64 {
    (f64::from(u32::MAX) / (1.001 * largest_addend(plan))) as u64
}

/// Why a plan cannot run on a device with these limits.
pub(super) fn supports(plan: &PairPlan, limits: &wgpu::Limits) -> Result<(), String> {
    if plan.domain.as_polygon().is_some() && matches!(plan.correction, Correction::Translation | Correction::Isotropic)
    {
        return Err(format!("{} weights in a polygon are not computed on a GPU", plan.correction));
    }
    if plan.masses {
        return Err("weights of points are not computed on the GPU".into());
    }
    if pair_limit(plan) < LEAST_PAIRS {
        let largest = largest_addend(plan);
        return Err(format!("{} weights up to {largest:.0} are too large for sums on the GPU", plan.correction));
    }
    let (needed, buffers) = (plan.cell_buffers(), limits.max_storage_buffers_per_shader_stage);
    if plan.search != PairSearch::All && needed > buffers {
        return Err(format!("planned for another device: {needed} storage buffers, this one has {buffers}"));
    }
    fits(plan.shape.max_points, plan.domain.dim(), limits.max_storage_buffer_binding_size)
}

pub(super) fn fits(points: u64, dim: usize, binding_bytes: u64) -> Result<(), String> {
    let bytes = points.saturating_mul(8 * dim as u64);
    if bytes > binding_bytes || points > u64::from(u32::MAX) / 8 {
        return Err(format!("{points} points need {bytes} bytes in one buffer, the device has {binding_bytes}"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{EnsembleShape, PairDevice, RadialBins, SearchCosts};
    use crate::points::Domain;

    /// What a plan says that kernels need is what they need, and a device with less looks at all pairs.
    #[test]
    fn plans_know_how_many_buffers_cells_need() {
        let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
        let shape = EnsembleShape { realizations: 1, mean_points: 1e6, max_points: 1_000_000 };
        let bins = [RadialBins::linear(0.01, 8).unwrap(), RadialBins::logarithmic(0.001, 0.01, 8).unwrap()];
        for (bins, correction) in bins.iter().flat_map(|b| [(b, Correction::None), (b, Correction::Border)]) {
            let plan = PairPlan::new(&window, bins.clone(), correction, shape).unwrap();
            let kernels = sort(&plan).into_iter().chain([cell_pairs(&plan, 16 << 10)]);
            let needed = kernels.map(|kernel| kernel.bindings.len() as u32 - 1).max();
            assert_eq!(needed, Some(plan.cell_buffers()));
            // As many as every device of WebGPU has.
            assert!(all_pairs(&plan, 16 << 10).bindings.len() <= 1 + 8);
            let on = |buffers| {
                plan.clone().for_device(PairDevice { costs: SearchCosts::GPU, buffers: Some(buffers) }).search
            };
            assert_ne!(on(plan.cell_buffers()), PairSearch::All);
            assert_eq!(on(plan.cell_buffers() - 1), PairSearch::All);
        }
    }
}
