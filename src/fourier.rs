//! The discrete Fourier transform in several dimensions.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// Forward, in place, not normalized; `shape` is the number of places per axis, the last axis fastest.
pub(crate) fn transform(field: &mut [Complex<f64>], shape: &[usize]) {
    let mut planner = FftPlanner::new();
    let mut step = 1;
    for &side in shape.iter().rev() {
        let fft = planner.plan_fft_forward(side);
        if step == 1 {
            fft.process(field);
        } else {
            let mut line = vec![Complex::default(); side];
            for block in field.chunks_exact_mut(step * side) {
                for start in 0..step {
                    line.iter_mut().zip(block[start..].iter().step_by(step)).for_each(|(to, from)| *to = *from);
                    fft.process(&mut line);
                    block[start..].iter_mut().step_by(step).zip(&line).for_each(|(to, from)| *to = *from);
                }
            }
        }
        step *= side;
    }
}
