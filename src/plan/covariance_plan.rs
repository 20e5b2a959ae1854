//! The plan for the covariance of amplitudes.

use std::fmt;

use super::{Batch, EnsembleShape, WaveGrid, refuse_polygon};
use crate::error::{Error, Result};
use crate::points::Domain;
use crate::setting::Setting;

/// Matrices that would take more are refused: 8 GiB.
const MOST_BYTES: u128 = 1 << 33;

/// Everything decided about `E[s_m conj(s_l)]` before any phase is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct CovariancePlan {
    /// All `m` with `|m_k| <= B`.
    pub grid: WaveGrid,
    /// Number and size of realizations.
    pub shape: EnsembleShape,
    /// Realizations worked on at a time.
    pub batch: Batch,
}

/// Numbers in the sums of `stored` wave vectors: products of two components, the same times the norm, products of two powers,
/// and the norm and its square.
pub(crate) fn covariance_values(stored: u128) -> u128 {
    9 * stored * stored + 2
}

impl CovariancePlan {
    /// For all frequencies up to `largest` along each axis; by default 64 in 1D, 8 in 2D and 2 in 3D.
    ///
    /// # Errors
    /// A frequency of 0 or one whose products would not fit.
    pub fn new(domain: &Domain, largest: Option<u32>, shape: EnsembleShape) -> Result<Self> {
        refuse_polygon(domain, "covariance")?;
        let dim = domain.dim();
        let largest = largest.unwrap_or([64, 8, 2][dim - 1]);
        let modes = (2 * u128::from(largest) + 1).pow(dim as u32);
        let bytes = bytes(modes, shape.realizations);
        if largest == 0 || bytes > MOST_BYTES {
            let fits =
                |b: &u32| self::bytes((2 * u128::from(*b) + 1).pow(dim as u32), shape.realizations) <= MOST_BYTES;
            let most = (1..).take_while(fits).last().unwrap_or(1);
            let reason = match largest {
                0 => format!("expected 1 to {most}"),
                _ => format!(
                    "{modes} wave vectors, each with each, take {bytes} bytes; expected 1 to {most} ({MOST_BYTES} bytes at most)"
                ),
            };
            return Err(Error::setting(Setting::CovarianceFrequency, largest, reason));
        }
        let grid = WaveGrid::new(&vec![largest; dim])?;
        let batch = Batch::new(shape, shape.max_points * 24);
        Ok(Self { grid, shape, batch })
    }

    /// Number of wave vectors M: the matrix is M x M.
    pub fn modes(&self) -> usize {
        self.grid.full_len()
    }

    /// Number of wave vectors whose amplitudes are computed, DC first: of each pair m, -m one, because
    /// `s_{-m} = conj(s_m)`.
    pub fn stored(&self) -> usize {
        self.grid.half_len() - self.grid.dc()
    }

    /// Bytes that sums and results take, beside the points.
    pub fn bytes(&self) -> u128 {
        bytes(self.modes() as u128, self.shape.realizations)
    }
}

/// The sums of leaves that wait for each other, and the result: two f64 and an error per element.
fn bytes(modes: u128, realizations: u64) -> u128 {
    let stored = modes.div_ceil(2);
    let waiting = 2 + u128::from(u64::BITS - (realizations / 16).leading_zeros());
    8 * covariance_values(stored).saturating_mul(waiting) + 24 * modes * modes
}

impl fmt::Display for CovariancePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (modes, largest) = (self.modes(), self.grid.max_frequency()[0]);
        writeln!(
            f,
            "wave_covariance: |m_k| <= {largest}, {modes} x {modes} pairs of wave vectors, {} bytes",
            self.bytes()
        )?;
        writeln!(f, "  amplitudes in f64, products of {} of them (s_-m = conj s_m), on the CPU", self.stored())?;
        writeln!(f, "  {}", self.batch)
    }
}
