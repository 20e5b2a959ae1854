//! `spectrum.npy`, `spectrum_se.npy`: f64, the whole grid, index `m + F`, x axis first.

use npyz::WriterBuilder;

use crate::estimate::PowerSpectrum;

/// One grid as a .npy file, from stored values (`p` or `p_se`).
pub(super) fn grid(spectrum: &PowerSpectrum, half: &[f64], file: impl std::io::Write) -> std::io::Result<()> {
    let shape: Vec<u64> = spectrum.full_shape().iter().map(|&n| n as u64).collect();
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(file).begin_nd()?;
    writer.extend(spectrum.full(half))?;
    writer.finish()
}
