//! Sums behind integration errors: of each realization a few numbers per integrand, kept in the order of its index, and power at every
//! frequency over all.

use super::{ComputedBy, Decoder, Encoder, Sums, WavePower};
use crate::error::{Error, Result};

/// Integration errors of a batch.
#[derive(Debug, Clone, PartialEq)]
pub struct IntegrationSums {
    /// `|s_m|^2` over realizations on the grid.
    pub grid: WavePower,
    /// The same along each axis alone.
    pub axes: Vec<WavePower>,
    /// Number of integrands.
    pub integrands: usize,
    /// Ordered by index.
    pub realizations: Vec<RealizationSums>,
}

/// What is kept of one realization.
#[derive(Debug, Clone, PartialEq)]
pub struct RealizationSums {
    /// Index in the whole batch.
    pub index: u64,
    /// Number of points.
    pub n: u64,
    /// Per integrand.
    pub each: Vec<IntegrandSums>,
}

/// Sums of one integrand over the points `x_j` of one realization, all without weights.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IntegrandSums {
    /// `sum_j f(x_j)`.
    pub values: f64,
    /// `sum_(m != 0) |f_m|^2 |s_m|^2` over the grid.
    pub grid: f64,
    /// The same over frequencies along axes, beyond the grid.
    pub axes: f64,
    /// `sum_(i < j) (a(x_i - x_j) - I^2)`; 0 where the plan does not sum pairs.
    pub pairs: f64,
    /// Means over shifts t of `S(t)` and `S(t)^2`, `S = sum_j f(x_j + t) - n I`.
    pub shifted: [f64; 2],
    /// `Re sum conj(f_m) s_m` over low frequencies, and `sum |f_m|^2 |s_m|^2`.
    pub low: [f64; 2],
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
        self.grid.merge(other.grid)?;
        self.axes.iter_mut().zip(other.axes).try_for_each(|(a, b)| a.merge(b))?;
        self.realizations.extend(other.realizations);
        self.realizations.sort_by_key(|r| r.index);
        Ok(())
    }

    fn append(&mut self, next: Self) -> Result<()> {
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
        out.within("grid", |out| self.grid.encode(out));
        for (a, axis) in self.axes.iter().enumerate() {
            out.within(&format!("axis {a}"), |out| axis.encode(out));
        }
        out.u64s("sizes", self.realizations.iter().flat_map(|r| [r.index, r.n]));
        out.f64s("numbers", self.realizations.iter().flat_map(|r| &r.each).flat_map(IntegrandSums::numbers));
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let (integrands, axes): (usize, usize) = (from.read("integrands")?, from.read("axes")?);
        if integrands == 0 || axes > 3 {
            return Err(from.error("integration of nothing, or of too many axes"));
        }
        let grid = from.within("grid", WavePower::decode)?;
        let axes =
            (0..axes).map(|a| from.within(&format!("axis {a}"), WavePower::decode)).collect::<Result<Vec<_>>>()?;
        let sizes = from.u64s("sizes")?;
        let (sizes, _) = sizes.as_chunks::<2>();
        let numbers = from.f64s_of("numbers", sizes.len().saturating_mul(integrands).saturating_mul(8))?;
        let each: Vec<IntegrandSums> = numbers.as_chunks::<8>().0.iter().map(IntegrandSums::of).collect();
        let of = |(&[index, n], each): (&[u64; 2], &[IntegrandSums])| RealizationSums { index, n, each: each.to_vec() };
        Ok(Self {
            grid,
            axes,
            integrands,
            realizations: sizes.iter().zip(each.chunks_exact(integrands)).map(of).collect(),
        })
    }
}
