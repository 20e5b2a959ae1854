//! Raw sums of `pair_counts`: integers only, so any order of additions gives the same sums.

use super::{ComputedBy, Decoder, Encoder, Sums};
use crate::error::{Error, Result};
use crate::plan::PairPlan;

/// Steps per unit of a pair's weight: weights are summed as multiples of 2^-32.
pub const WEIGHT_STEPS: f64 = 4_294_967_296.0;

/// The histogram of one realization: what a kernel delivers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PairHistogram {
    /// Number of points.
    pub n: u64,
    /// Ordered pairs per bin.
    pub counts: Vec<u64>,
    /// Sum over the same pairs of their weight, in steps of 2^-32, where points have weights 2^-64; `None` where every pair weighs 1.
    pub weights: Option<Vec<u128>>,
    /// Pairs seen from points deep inside the window, for the border correction.
    pub border: Option<BorderHistogram>,
    /// `sum_(i != j) u_i u_j` and `(sum u)^2` over the weights `u` of the points, in steps of 2^-64; `None` where every point
    /// weighs 1.
    pub masses: Option<[u128; 2]>,
}

/// Minus sampling. With `m_i` the number of bins whose upper edge is at most the distance of point `i` from the border:
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BorderHistogram {
    /// Per bin `b`, ordered pairs `(i, j)` in it with `m_i > b`, or their `u_i u_j` in steps of 2^-64, where points have weights.
    pub counts: Vec<u128>,
    /// The same pairs of all bins, by `m_i`: entry `m`, from 0 to the number of bins.
    pub ends: Vec<u128>,
    /// Per bin `b`, what they are compared with: `geometry::border_norms`. As usual for this correction, lambda is estimated apart
    /// from the pairs, by n / |D|.
    pub norms: Vec<[u128; 2]>,
}

impl PairHistogram {
    /// Of points that weigh 1, without border correction.
    pub fn new(n: u64, counts: Vec<u64>, weights: Option<Vec<u128>>) -> Self {
        Self { n, counts, weights, border: None, masses: None }
    }

    /// Adds other pairs of the same realization.
    pub(crate) fn merge(&mut self, part: &Self) {
        let add = |a: &mut [u128], b: &[u128]| a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        self.counts.iter_mut().zip(&part.counts).for_each(|(a, b)| *a += b);
        if let (Some(a), Some(b)) = (&mut self.weights, &part.weights) {
            add(a, b);
        }
        if let (Some(a), Some(b)) = (&mut self.border, &part.border) {
            // Norms belong to the realization, not to a part of its pairs.
            add(&mut a.counts, &b.counts);
            add(&mut a.ends, &b.ends);
        }
    }

    /// What is compared with the expectation: weights where there are any, else counts.
    fn sums(&self, bin: usize) -> u128 {
        match (&self.border, &self.weights) {
            (Some(border), _) => border.counts[bin],
            (None, Some(weights)) => weights[bin],
            (None, None) => u128::from(self.counts[bin]),
        }
    }

    /// `sums` over all pairs closer than the upper edge of each bin.
    fn cumulative(&self) -> Vec<u128> {
        let mut sum = 0;
        (0..self.counts.len())
            .map(|bin| {
                sum += self.sums(bin);
                if let Some(border) = &self.border {
                    // Pairs whose first point is nearer to the border than this edge drop out again.
                    sum -= border.ends[bin];
                }
                sum
            })
            .collect()
    }

    /// `norms` without border correction, in units of 1.
    pub(crate) fn unit_norms(n: u64, masses: Option<[u128; 2]>) -> [f64; 2] {
        let unit = if masses.is_some() { 2f64.powi(-64) } else { 1.0 };
        Self { masses, ..Self::new(n, Vec::new(), None) }.norms(0).map(|norm| norm as f64 * unit)
    }

    /// Number of ordered pairs by both normalizations: `n (n - 1)` and `n^2`, or what stands for them.
    fn norms(&self, bin: usize) -> [u128; 2] {
        let n = u128::from(self.n);
        match (&self.border, self.masses) {
            (Some(border), _) => border.norms[bin],
            (None, Some(both)) => both,
            (None, None) => [n * n.saturating_sub(1), n * n],
        }
    }
}

/// Sums over realizations of what the ratio `sum c / sum N` and its error need, per bin: `c` are the ordered pairs of one
/// realization (or their weights), `N` what they are compared with, by both normalizations.
///
/// Products are formed from `c` and `N` in coarser *moment steps*, so that squares fit; only errors use them.
#[derive(Debug, Clone, PartialEq)]
pub struct Ratios {
    /// `sum c`, in steps of c.
    pub sums: Vec<u128>,
    /// `sum c^2`, in moment steps.
    pub squares: Vec<u128>,
    /// `sum c N`, in moment steps.
    pub products: Vec<[u128; 2]>,
    /// One entry for all bins, or one per bin where N differs between them.
    pub norms: Vec<[Norm; 2]>,
}

/// Sums over realizations of N.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Norm {
    /// `sum N`, in steps of N.
    pub sum: u128,
    /// `sum N`, in moment steps.
    pub moment: u128,
    /// `sum N^2`, in moment steps.
    pub square: u128,
}

/// How many steps there are to a unit, of the integers in a `PairCounts`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Steps {
    /// Bits below 1 of c.
    pub sum_bits: u32,
    /// Bits below 1 of N.
    pub norm_bits: u32,
    /// Bits below 1 of c and N in products.
    pub moment_bits: [u32; 2],
}

impl Steps {
    /// Of plain counts.
    pub(super) const ONE: Self = Self { sum_bits: 0, norm_bits: 0, moment_bits: [0, 0] };

    fn new(plan: &PairPlan) -> Self {
        match (plan.weighted(), plan.masses) {
            (_, true) => Self { sum_bits: 64, norm_bits: 64, moment_bits: [16, 16] },
            (true, false) => Self { sum_bits: 32, norm_bits: 0, moment_bits: [16, 0] },
            (false, false) => Self::ONE,
        }
    }
}

/// The nearest multiple of 2^bits, in units of it.
fn drop_bits(value: u128, bits: u32) -> u128 {
    if bits == 0 { value } else { (value + (1 << (bits - 1))) >> bits }
}

impl Ratios {
    pub(super) fn new(bins: usize, by_bin: bool) -> Self {
        Self {
            sums: vec![0; bins],
            squares: vec![0; bins],
            products: vec![[0; 2]; bins],
            norms: vec![[Norm::default(); 2]; if by_bin { bins } else { 1 }],
        }
    }

    /// The sums of N that belong to a bin.
    pub fn norm(&self, bin: usize) -> &[Norm; 2] {
        &self.norms[bin.min(self.norms.len() - 1)]
    }

    pub(super) fn add(&mut self, histogram: &PairHistogram, steps: Steps, sum: impl Fn(usize) -> u128) {
        self.add_values(steps, sum, |bin| histogram.norms(bin));
    }

    /// Adds one realization: c and N of each bin.
    fn add_values(&mut self, steps: Steps, sum: impl Fn(usize) -> u128, norm: impl Fn(usize) -> [u128; 2]) {
        let coarse = |n: u128| drop_bits(n, steps.norm_bits - steps.moment_bits[1]);
        for (bin, norms) in self.norms.iter_mut().enumerate() {
            for (total, n) in norms.iter_mut().zip(norm(bin)) {
                total.sum += n;
                total.moment += coarse(n);
                total.square = total.square.saturating_add(coarse(n).saturating_mul(coarse(n)));
            }
        }
        for bin in 0..self.sums.len() {
            let c = sum(bin);
            self.sums[bin] += c;
            let c = drop_bits(c, steps.sum_bits - steps.moment_bits[0]);
            self.squares[bin] = self.squares[bin].saturating_add(c.saturating_mul(c));
            let norms = norm(bin.min(self.norms.len() - 1));
            for (product, n) in self.products[bin].iter_mut().zip(norms) {
                *product = product.saturating_add(c.saturating_mul(coarse(n)));
            }
        }
    }

    pub(super) fn merge(&mut self, other: &Self) {
        let add = |a: &mut u128, b: &u128| *a = a.saturating_add(*b);
        self.sums.iter_mut().zip(&other.sums).for_each(|(a, b)| add(a, b));
        self.squares.iter_mut().zip(&other.squares).for_each(|(a, b)| add(a, b));
        self.products.as_flattened_mut().iter_mut().zip(other.products.as_flattened()).for_each(|(a, b)| add(a, b));
        for (a, b) in self.norms.as_flattened_mut().iter_mut().zip(other.norms.as_flattened()) {
            add(&mut a.sum, &b.sum);
            add(&mut a.moment, &b.moment);
            add(&mut a.square, &b.square);
        }
    }
}

/// Sums over realizations of what g, K and their errors need. Merging is exact and associative.
#[derive(Debug, Clone, PartialEq)]
pub struct PairCounts {
    /// Who computed them.
    pub computed_by: ComputedBy,
    /// Number of realizations.
    pub realizations: u64,
    /// Ordered pairs per bin, unweighted.
    pub counts: Vec<u64>,
    /// The units of the sums below.
    pub steps: Steps,
    /// Per bin.
    pub bins: Ratios,
    /// Per upper edge of a bin, over all pairs closer than it; where K was asked for.
    pub cumulative: Option<Ratios>,
}

impl PairCounts {
    /// No realizations yet.
    pub fn new(computed_by: ComputedBy, plan: &PairPlan) -> Self {
        let bins = plan.bins.len();
        Self {
            computed_by,
            realizations: 0,
            counts: vec![0; bins],
            steps: Steps::new(plan),
            bins: Ratios::new(bins, plan.border()),
            cumulative: plan.cumulative.then(|| Ratios::new(bins, plan.border())),
        }
    }

    /// Adds one realization.
    pub fn add(&mut self, histogram: &PairHistogram) {
        self.realizations += 1;
        for (sum, c) in self.counts.iter_mut().zip(&histogram.counts) {
            *sum += c;
        }
        self.bins.add(histogram, self.steps, |bin| histogram.sums(bin));
        if let Some(cumulative) = &mut self.cumulative {
            let sums = histogram.cumulative();
            cumulative.add(histogram, self.steps, |bin| sums[bin]);
        }
    }

    /// Adds one realization of the pairs between two classes of points, in both orders: what is counted in `both` together
    /// beyond each alone, compared with `N = n (n - 1) - n_A (n_A - 1) - n_B (n_B - 1) = 2 n_A n_B`, n = n_A + n_B, by either
    /// normalization (and so with what stands for it: weights, or points seen from deep inside). All three hold the same single
    /// realization of a plan.
    pub fn add_between(&mut self, plan: &PairPlan, both: &Self, a: &Self, b: &Self) {
        // That of pairs leaves more digits beside heavy points; with border correction it does not add up over classes.
        let which = usize::from(plan.border());
        self.computed_by = self.computed_by.merge(&both.computed_by);
        self.realizations += 1;
        for (bin, sum) in self.counts.iter_mut().enumerate() {
            *sum += both.counts[bin] - a.counts[bin] - b.counts[bin];
        }
        let pairs = |of: &Self, bin: usize| of.bins.norm(bin)[which].sum;
        self.bins.add_values(
            self.steps,
            |bin| both.bins.sums[bin] - a.bins.sums[bin] - b.bins.sums[bin],
            // Each is rounded where points have weights.
            |bin| [pairs(both, bin).saturating_sub(pairs(a, bin) + pairs(b, bin)); 2],
        );
        let each = [both, a, b].map(|counts| counts.cumulative.as_ref());
        if let (Some(cumulative), [Some(both), Some(a), Some(b)]) = (&mut self.cumulative, each) {
            let pairs = |of: &Ratios, bin: usize| of.norm(bin)[which].sum;
            cumulative.add_values(
                self.steps,
                |bin| both.sums[bin] - a.sums[bin] - b.sums[bin],
                |bin| [pairs(both, bin).saturating_sub(pairs(a, bin) + pairs(b, bin)); 2],
            );
        }
    }

    /// Adds other realizations of the same process, counted in the same bins by the same method.
    ///
    /// # Errors
    /// Sums of another shape.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        let kind = |c: &Self| (c.counts.len(), c.steps, c.bins.norms.len(), c.cumulative.is_some());
        if kind(self) != kind(other) {
            let reason = format!(
                "{} bins cannot be merged with {}, or they were counted by another method",
                self.counts.len(),
                other.counts.len()
            );
            return Err(Error::input("pair counts", reason));
        }
        self.computed_by = self.computed_by.merge(&other.computed_by);
        self.realizations += other.realizations;
        for (a, b) in self.counts.iter_mut().zip(&other.counts) {
            *a += b;
        }
        self.bins.merge(&other.bins);
        if let (Some(a), Some(b)) = (&mut self.cumulative, &other.cumulative) {
            a.merge(b);
        }
        Ok(())
    }

    /// Sum of weights in a bin (of counts, where every pair weighs 1), in units of 1.
    pub fn sum(&self, bin: usize) -> f64 {
        self.bins.sums[bin] as f64 / 2f64.powi(self.steps.sum_bits as i32)
    }
}

/// Raw sums of two classes A and B: pairs within A, within B, and between them in both orders.
#[derive(Debug, Clone, PartialEq)]
pub struct CrossCounts {
    /// Ordered pairs of points of A.
    pub a: PairCounts,
    /// Ordered pairs of points of B.
    pub b: PairCounts,
    /// Pairs of a point of each, from A to B and from B to A.
    pub between: PairCounts,
}

impl CrossCounts {
    /// Adds other realizations of the same process.
    ///
    /// # Errors
    /// Sums of another shape.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        self.a.merge(&other.a)?;
        self.b.merge(&other.b)?;
        self.between.merge(&other.between)
    }
}

impl Ratios {
    pub(super) fn encode(&self, name: &str, out: &mut Encoder) {
        out.within(name, |out| {
            out.u128s("sums", self.sums.iter().copied());
            out.u128s("squares", self.squares.iter().copied());
            out.u128s("products", self.products.as_flattened().iter().copied());
            out.u128s("norms", self.norms.as_flattened().iter().flat_map(|n| [n.sum, n.moment, n.square]));
        });
    }

    pub(super) fn decode(name: &str, from: &mut Decoder<'_>) -> Result<Self> {
        from.within(name, |from| {
            let (sums, squares) = (from.u128s("sums")?, from.u128s("squares")?);
            let (products, norms) = (from.u128s("products")?, from.u128s("norms")?);
            from.check_len("squares", squares.len(), sums.len())?;
            from.check_len("products", products.len(), 2 * sums.len())?;
            let per_bin = norms.len() == 6 * sums.len() && !sums.is_empty();
            from.check_len("norms", norms.len(), if per_bin { 6 * sums.len() } else { 6 })?;
            let norm = |n: &[u128; 3]| Norm { sum: n[0], moment: n[1], square: n[2] };
            let (norms, _) = norms.as_chunks::<3>();
            let (norms, _) = norms.as_chunks::<2>();
            Ok(Self {
                sums,
                squares,
                products: products.as_chunks::<2>().0.to_vec(),
                norms: norms.iter().map(|both| both.each_ref().map(norm)).collect(),
            })
        })
    }
}

impl Sums for PairCounts {
    fn merge(&mut self, other: Self) -> Result<()> {
        Self::merge(self, &other)
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        Some(&self.computed_by)
    }

    fn encode(&self, out: &mut Encoder) {
        self.computed_by.encode(out);
        out.value("realizations", self.realizations);
        let Steps { sum_bits, norm_bits, moment_bits } = self.steps;
        out.value("bits", vec![sum_bits, norm_bits, moment_bits[0], moment_bits[1]]);
        out.value("cumulative", self.cumulative.is_some());
        out.u64s("counts", self.counts.iter().copied());
        self.bins.encode("bins", out);
        if let Some(cumulative) = &self.cumulative {
            cumulative.encode("cumulative", out);
        }
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let [sum_bits, norm_bits, first, second] = from.read("bits")?;
        let counts = from.u64s("counts")?;
        let bins = Ratios::decode("bins", from)?;
        from.check_len("bins", bins.sums.len(), counts.len())?;
        let cumulative = from.read::<bool>("cumulative")?.then(|| Ratios::decode("cumulative", from)).transpose()?;
        if let Some(cumulative) = &cumulative {
            from.check_len("cumulative", cumulative.sums.len(), counts.len())?;
        }
        Ok(Self {
            computed_by: ComputedBy::decode(from)?,
            realizations: from.count("realizations")?,
            counts,
            steps: Steps { sum_bits, norm_bits, moment_bits: [first, second] },
            bins,
            cumulative,
        })
    }
}

impl Sums for CrossCounts {
    fn merge(&mut self, other: Self) -> Result<()> {
        Self::merge(self, &other)
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        Some(&self.between.computed_by)
    }

    fn encode(&self, out: &mut Encoder) {
        for (name, counts) in [("a", &self.a), ("b", &self.b), ("between", &self.between)] {
            out.within(name, |out| counts.encode(out));
        }
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        Ok(Self {
            a: from.within("a", PairCounts::decode)?,
            b: from.within("b", PairCounts::decode)?,
            between: from.within("between", PairCounts::decode)?,
        })
    }
}
