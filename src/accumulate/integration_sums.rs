//! Sums behind integration errors: of each realization a few numbers per integrand, kept in the order of its index, and power at every
//! frequency over all.

use super::{ComputedBy, Decoder, Encoder, Sums, WavePower};
use crate::error::{Error, Result};

/// Integration errors of a batch.
#[derive(Debug, Clone, PartialEq)]
pub struct IntegrationSums {
    /// `|s_m|^2` over realizations on the grid, of weights over `unit`.
    pub grid: WavePower,
    /// The same along each axis alone.
    pub axes: Vec<WavePower>,
    /// Number of integrands.
    pub integrands: usize,
    /// What weights are measured in there, a power of two; 1 without weights.
    pub unit: f64,
    /// Pairs i < j of all realizations around each node of half a grid of lags (x fastest, the last component 0 to half a side), times their weights over `unit`, in steps of `LAG_STEP`: integers,
    /// whose sum does not depend on order. Empty where they are not deposited.
    pub lags: Vec<i64>,
    /// Ordered by index.
    pub realizations: Vec<RealizationSums>,
}

/// Steps in which pairs around a node are added up over realizations.
pub const LAG_STEP: f64 = 1.0 / (1u64 << 20) as f64;

/// What is kept of one realization.
#[derive(Debug, Clone, PartialEq)]
pub struct RealizationSums {
    /// Index in the whole batch.
    pub index: u64,
    /// Number of points.
    pub n: u64,
    /// `sum_j w_j`, n where every point weighs 1.
    pub weight: f64,
    /// `sum_j w_j^2`.
    pub square: f64,
    /// Per integrand.
    pub each: Vec<IntegrandSums>,
    /// Of the points that are kept of these, where some are removed.
    pub removal: Option<RemovalSums>,
}

/// Sums of one integrand over the points `x_j` of one realization and their weights.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IntegrandSums {
    /// `sum_j w_j f(x_j)`.
    pub values: f64,
    /// `sum_(m != 0) |f_m|^2 |s_m|^2` over the grid.
    pub grid: f64,
    /// The same over frequencies along axes, beyond the grid.
    pub axes: f64,
    /// `sum_(i < j) w_i w_j (a(x_i - x_j) - I^2)`; 0 where the plan does not sum pairs.
    pub pairs: f64,
    /// Means over shifts t of `S(t)` and `S(t)^2`, `S = sum_j w_j (f(x_j + t) - I)`.
    pub shifted: [f64; 2],
    /// `Re sum conj(f_m) s_m` over low frequencies, and `sum |f_m|^2 |s_m|^2`.
    pub low: [f64; 2],
}

/// Of the points of a realization that are kept, each with probability q.
#[derive(Debug, Clone, PartialEq)]
pub struct RemovalSums {
    /// Their number.
    pub kept: u64,
    /// Shifts after which points are left, which is what a ratio is observed at.
    pub shifts: u64,
    /// Per integrand.
    pub each: Vec<KeptSums>,
}

/// Sums of one integrand over points that are kept. The error is `sum_kept f/q - n I`, or for a ratio that of the estimate itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct KeptSums {
    /// The error.
    pub error: f64,
    /// `sum_j f(x_j)^2 (1/q(x_j) - 1)` over all points: its variance, these points given.
    pub given: f64,
    /// Means over shifts of the error and its square, other points kept at each.
    pub shifted: [f64; 2],
}

impl IntegrandSums {
    fn numbers(&self) -> [f64; 8] {
        let [s, squares] = self.shifted;
        let [linear, low] = self.low;
        [self.values, self.grid, self.axes, self.pairs, s, squares, linear, low]
    }

    fn of(&[values, grid, axes, pairs, s, squares, linear, low]: &[f64; 8]) -> Self {
        Self { values, grid, axes, pairs, shifted: [s, squares], low: [linear, low] }
    }
}

impl Sums for IntegrationSums {
    fn merge(&mut self, other: Self) -> Result<()> {
        if (self.integrands, self.axes.len()) != (other.integrands, other.axes.len()) {
            return Err(Error::input("integration", "sums of other integrands"));
        }
        self.same_unit(&other)?;
        add_lags(&mut self.lags, other.lags)?;
        self.grid.merge(other.grid)?;
        self.axes.iter_mut().zip(other.axes).try_for_each(|(a, b)| a.merge(b))?;
        self.realizations.extend(other.realizations);
        self.realizations.sort_by_key(|r| r.index);
        Ok(())
    }

    fn append(&mut self, next: Self) -> Result<()> {
        self.same_unit(&next)?;
        add_lags(&mut self.lags, next.lags)?;
        self.grid.append(next.grid)?;
        self.axes.iter_mut().zip(next.axes).try_for_each(|(a, b)| a.append(b))?;
        self.realizations.extend(next.realizations);
        Ok(())
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        Some(&self.grid.computed_by)
    }

    fn encode(&self, out: &mut Encoder) {
        out.value("integrands", self.integrands);
        out.value("axes", self.axes.len());
        let removed = self.realizations.iter().any(|r| r.removal.is_some());
        out.value("removal", u8::from(removed));
        out.f64s("unit", [self.unit]);
        out.u64s("lags", self.lags.iter().map(|count| count.cast_unsigned()));
        out.within("grid", |out| self.grid.encode(out));
        for (a, axis) in self.axes.iter().enumerate() {
            out.within(&format!("axis {a}"), |out| axis.encode(out));
        }
        out.u64s("sizes", self.realizations.iter().flat_map(|r| [r.index, r.n]));
        out.f64s("weights", self.realizations.iter().flat_map(|r| [r.weight, r.square]));
        out.f64s("numbers", self.realizations.iter().flat_map(|r| &r.each).flat_map(IntegrandSums::numbers));
        if removed {
            let kept = || self.realizations.iter().filter_map(|r| r.removal.as_ref());
            out.u64s("kept", kept().flat_map(|r| [r.kept, r.shifts]));
            let numbers = |k: &KeptSums| [k.error, k.given, k.shifted[0], k.shifted[1]];
            out.f64s("kept numbers", kept().flat_map(|r| &r.each).flat_map(numbers));
        }
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let (integrands, axes): (usize, usize) = (from.read("integrands")?, from.read("axes")?);
        let removed: u8 = from.read("removal")?;
        if integrands == 0 || axes > 3 {
            return Err(from.error("integration of nothing, or of too many axes"));
        }
        let unit = from.f64s_of("unit", 1)?[0];
        let lags = from.u64s("lags")?.into_iter().map(u64::cast_signed).collect();
        let grid = from.within("grid", WavePower::decode)?;
        let axes =
            (0..axes).map(|a| from.within(&format!("axis {a}"), WavePower::decode)).collect::<Result<Vec<_>>>()?;
        let sizes = from.u64s("sizes")?;
        let (sizes, rest) = sizes.as_chunks::<2>();
        from.check_len("sizes", 2 * sizes.len() + rest.len(), 2 * sizes.len())?;
        let per_realization = |many: usize| sizes.len().saturating_mul(many);
        let weights = from.f64s_of("weights", per_realization(2))?;
        let numbers = from.f64s_of("numbers", per_realization(integrands).saturating_mul(8))?;
        let each: Vec<IntegrandSums> = numbers.as_chunks::<8>().0.iter().map(IntegrandSums::of).collect();
        let mut removals = vec![None; sizes.len()];
        if removed != 0 {
            let kept = from.u64s("kept")?;
            from.check_len("kept", kept.len(), per_realization(2))?;
            let numbers = from.f64s_of("kept numbers", per_realization(integrands).saturating_mul(4))?;
            let of = |&[error, given, s, squares]: &[f64; 4]| KeptSums { error, given, shifted: [s, squares] };
            let each: Vec<KeptSums> = numbers.as_chunks::<4>().0.iter().map(of).collect();
            for ((to, &[kept, shifts]), each) in
                removals.iter_mut().zip(kept.as_chunks::<2>().0).zip(each.chunks_exact(integrands))
            {
                *to = Some(RemovalSums { kept, shifts, each: each.to_vec() });
            }
        }
        let realizations = (sizes.iter().zip(weights.as_chunks::<2>().0).zip(each.chunks_exact(integrands)))
            .zip(removals)
            .map(|(((&[index, n], &[weight, square]), each), removal)| RealizationSums {
                index,
                n,
                weight,
                square,
                each: each.to_vec(),
                removal,
            })
            .collect();
        Ok(Self { grid, axes, integrands, unit, lags, realizations })
    }
}

/// Adds pairs on the same lags, or none.
pub(crate) fn add_lags(to: &mut Vec<i64>, more: Vec<i64>) -> Result<()> {
    match (to.len(), more.len()) {
        (_, 0) => {}
        (0, _) => *to = more,
        (a, b) if a != b => return Err(Error::input("integration", format!("pairs on {a} lags and on {b}"))),
        _ => to.iter_mut().zip(more).for_each(|(sum, more)| *sum = sum.saturating_add(more)),
    }
    Ok(())
}

impl IntegrationSums {
    /// Sums in one unit of weights: that of whatever has been summed.
    fn same_unit(&mut self, other: &Self) -> Result<()> {
        match (self.realizations.is_empty(), other.realizations.is_empty()) {
            (true, _) => self.unit = other.unit,
            (false, false) if self.unit != other.unit => {
                let reason = format!("weights in units of {} and of {}", self.unit, other.unit);
                return Err(Error::input("integration", reason));
            }
            _ => {}
        }
        Ok(())
    }
}
