//! Raw sums of `wave_covariance`: over realizations, of products of amplitudes and what their errors need.

use super::ordered_sum::OrderedSum;
use super::{ComputedBy, Decoder, Encoder, Sums};
use crate::error::{Error, Result};
use crate::plan::covariance_values;

/// Sums over realizations of products of amplitudes of H wave vectors. An amplitude has two components: component `a < H`
/// is the real part of `s_a`, component `H + a` the imaginary part. The additions are ordered by realization index
/// (`OrderedSum`).
#[derive(Debug, Clone, PartialEq)]
pub struct WaveCovariance {
    /// Who computed them.
    pub computed_by: ComputedBy,
    /// Number of realizations.
    pub realizations: u64,
    stored: usize,
    sums: OrderedSum,
}

/// The sums over one leaf of realizations, or over all. `x` are components of amplitudes, `q = |s|^2`, `N = sum w^2`.
#[derive(Debug, Clone, PartialEq)]
pub struct CovarianceSums {
    /// H.
    pub stored: usize,
    /// `sum x_a x_b` at `a * 2 H + b`.
    pub products: Vec<f64>,
    /// `sum x_a x_b N`.
    pub products_n: Vec<f64>,
    /// `sum q_a q_b` at `a * H + b`.
    pub powers: Vec<f64>,
    /// `sum N` and `sum N^2`.
    pub norms: [f64; 2],
}

impl CovarianceSums {
    /// No realizations yet.
    pub fn new(stored: usize) -> Self {
        let zeros = |len| vec![0.0; len];
        let components = 4 * stored * stored;
        Self {
            stored,
            products: zeros(components),
            products_n: zeros(components),
            powers: zeros(stored * stored),
            norms: [0.0; 2],
        }
    }

    /// Adds the norm of a realization.
    pub(crate) fn add_norm(&mut self, norm: f64) {
        self.norms[0] += norm;
        self.norms[1] += norm * norm;
    }

    fn into_values(self) -> Vec<f64> {
        let mut values = self.products;
        values.extend(self.products_n);
        values.extend(self.powers);
        values.extend(self.norms);
        values
    }

    fn from_values(stored: usize, mut values: Vec<f64>) -> Self {
        let components = 4 * stored * stored;
        values.resize(covariance_values(stored as u128) as usize, 0.0);
        let norms = [values[values.len() - 2], values[values.len() - 1]];
        let mut powers = values.split_off(2 * components);
        powers.truncate(stored * stored);
        let products_n = values.split_off(components);
        Self { stored, products: values, products_n, powers, norms }
    }
}

impl WaveCovariance {
    /// No realizations yet.
    pub fn new(computed_by: ComputedBy, stored: usize) -> Self {
        Self { computed_by, realizations: 0, stored, sums: OrderedSum::default() }
    }

    /// Adds the sums over `realizations` of leaf `leaf`: all of them, or as many as the last one has.
    pub fn add_leaf(&mut self, leaf: u64, realizations: u64, sums: CovarianceSums) {
        debug_assert_eq!(sums.stored, self.stored, "as many wave vectors");
        self.realizations += realizations;
        self.sums.add_leaf(leaf, sums.into_values());
    }

    /// Adds other realizations of the same process. Both parts must consist of whole leaves of 16 realizations (the very
    /// last may be partial).
    ///
    /// # Errors
    /// Sums of another shape; realizations that both hold, or a leaf that was cut.
    pub fn merge(&mut self, other: Self) -> Result<()> {
        if self.stored != other.stored {
            let reason = format!("{} wave vectors cannot be merged with {}", self.stored, other.stored);
            return Err(Error::input("wave covariance", reason));
        }
        if self.sums.overlaps(&other.sums) {
            let reason = "the two parts hold the same realizations, or were not cut at multiples of 16";
            return Err(Error::input("wave covariance", reason));
        }
        self.computed_by = self.computed_by.merge(&other.computed_by);
        self.realizations += other.realizations;
        self.sums.merge(other.sums);
        Ok(())
    }

    /// The totals.
    pub fn totals(&self) -> CovarianceSums {
        CovarianceSums::from_values(self.stored, self.sums.total())
    }
}

impl Sums for WaveCovariance {
    fn merge(&mut self, other: Self) -> Result<()> {
        Self::merge(self, other)
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        Some(&self.computed_by)
    }

    fn encode(&self, out: &mut Encoder) {
        self.computed_by.encode(out);
        out.value("realizations", self.realizations);
        out.value("stored", self.stored);
        self.sums.encode("leaves", out);
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let stored: u32 = from.read("stored")?;
        let values = usize::try_from(covariance_values(u128::from(stored))).unwrap_or(usize::MAX);
        Ok(Self {
            computed_by: ComputedBy::decode(from)?,
            realizations: from.count("realizations")?,
            stored: stored as usize,
            sums: OrderedSum::decode("leaves", values, from)?,
        })
    }
}
