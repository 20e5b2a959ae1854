//! The discrete Fourier transform in several dimensions.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Forward, in place, not normalized; `side^dim` numbers, the first axis fastest.
pub(super) fn transform(field: &mut [Complex<f64>], side: usize, dim: usize) {
    let fft = FftPlanner::new().plan_fft_forward(side);
    fft.process(field);
    let mut line = vec![Complex::default(); side];
    for axis in 1..dim {
        let step = side.pow(axis as u32);
        for block in field.chunks_exact_mut(step * side) {
            for start in 0..step {
                line.iter_mut().zip(block[start..].iter().step_by(step)).for_each(|(to, from)| *to = *from);
                fft.process(&mut line);
                block[start..].iter_mut().step_by(step).zip(&line).for_each(|(to, from)| *to = *from);
            }
        }
    }
}
