//! `spectrum.npy`, `spectrum_se.npy`: f64, the whole grid, index `m + F`, x axis first. `pcf_vector.npy`,
//! `pcf_vector_se.npy`: f64, a value per cell of lags, x axis first; `pcf_vector_counts.npy`: u64, the same. `covariance.npy`: complex
//! f64, m first; `covariance_se.npy`: f64.

use npyz::WriterBuilder;

use crate::plan::{LagGrid, WaveGrid};

/// One grid as a .npy file, from stored values (`p` or `p_se`); with `lacks_last` without the last plane along each axis.
pub(super) fn grid(grid: &WaveGrid, half: &[f64], lacks_last: bool, file: impl std::io::Write) -> std::io::Result<()> {
    let full = grid.full_shape();
    let shape: Vec<u64> = full.iter().map(|&n| n as u64 - u64::from(lacks_last)).collect();
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(file).begin_nd()?;
    let is_last = |index: usize| {
        let along = full.iter().rev().scan(index, |rest, &n| Some((std::mem::replace(rest, *rest / n) % n, n)));
        along.into_iter().any(|(i, n)| i == n - 1)
    };
    writer.extend(grid.full(half).enumerate().filter(|&(i, _)| !(lacks_last && is_last(i))).map(|(_, p)| p))?;
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
