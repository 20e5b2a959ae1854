//! `spectrum.npy`, `spectrum_se.npy`: f64, the whole grid, index `m + F`, x axis first. `pcf_vector.npy`,
//! `pcf_vector_se.npy`: f64, a value per cell of lags, x axis first; `pcf_vector_counts.npy`: u64, the same. `covariance.npy`: complex
//! f64, m first; `covariance_se.npy`: f64.

use npyz::WriterBuilder;

use crate::plan::{LagGrid, WaveGrid};

/// One grid as a .npy file, from stored values (`p` or `p_se`).
pub(super) fn grid(grid: &WaveGrid, half: &[f64], file: impl std::io::Write) -> std::io::Result<()> {
    let shape: Vec<u64> = grid.full_shape().iter().map(|&n| n as u64).collect();
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(file).begin_nd()?;
    writer.extend(grid.full(half))?;
    writer.finish()
}

/// A square matrix, row by row.
pub(super) fn matrix<T: npyz::AutoSerialize>(
    side: usize,
    values: impl Iterator<Item = T>,
    file: impl std::io::Write,
) -> std::io::Result<()> {
    let shape = [side as u64; 2];
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(file).begin_nd()?;
    writer.extend(values)?;
    writer.finish()
}

/// One value per cell of a grid of lags.
pub(super) fn lags<T: npyz::AutoSerialize + Copy>(
    grid: &LagGrid,
    values: &[T],
    file: impl std::io::Write,
) -> std::io::Result<()> {
    let shape = vec![grid.bins as u64; grid.dim()];
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(file).begin_nd()?;
    writer.extend(values.iter().copied())?;
    writer.finish()
}
