use pairwave::compute::{
    Control,
    cpu::{
        SimdLevel,
        nufft::{Nufft, Points, Scratch},
    },
};
use pairwave::plan::WaveGrid;
use std::time::Instant;
fn main() {
    for tol in [1e-6, 1e-12] {
        for (n, f) in [(4096usize, 256u32), (65536, 256), (1000000, 512)] {
            let mut s = 1u64;
            let mut r = || {
                s = s.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (s ^ (s >> 33)).wrapping_mul(0xff51afd7ed558ccd)
            };
            let x: Vec<u64> = (0..n).map(|_| r()).collect();
            let y: Vec<u64> = (0..n).map(|_| r()).collect();
            let grid = WaveGrid::new(&[f, f]).unwrap();
            let t = Instant::now();
            let nufft = Nufft::new(&grid, tol, n as f64, SimdLevel::detect()).unwrap();
            let plan = t.elapsed().as_secs_f64() * 1e3;
            let mut out = vec![0.0; grid.half_len()];
            let mut scratch = Scratch::default();
            let mut best = 1e9f64;
            for _ in 0..(if n > 100000 { 10 } else { 40 }) {
                let t = Instant::now();
                nufft
                    .power(
                        &Points { axes: &[&x, &y], weights: None },
                        &mut scratch,
                        None,
                        &Control::default(),
                        &mut out,
                    )
                    .unwrap();
                best = best.min(t.elapsed().as_secs_f64() * 1e3);
            }
            println!("tol {tol:e} n {n} F {f}: {best:.3} ms  (plan {plan:.2}) {}", out[5]);
        }
    }
}
