//! Draws of projection determinantal processes by the chain rule of Hough, Krishnapur, Peres and Virag ("Determinantal processes
//! and independence", 2006).
//!
//! Of N orthonormal functions, with v(x) the vector of their values: the density of the next point is `(|v(x)|^2 - |projection of v(x) on
//! those of the points so far|^2) / N left`. It is drawn by rejection from the uniform density, for |v|^2 is constant or nearly
//! so; the vectors of the points are made orthonormal one after the other (modified Gram-Schmidt, twice).

use crate::control::Control;
use crate::error::{Error, Result};
use crate::samplers::Stream;
use crate::samplers::waves::Waves;

/// N orthonormal functions on the unit torus.
pub(super) trait Basis {
    /// N.
    fn len(&self) -> usize;

    /// Number of coordinates.
    fn dim(&self) -> usize;

    /// The largest sum of their squares anywhere.
    fn bound(&self) -> f64;

    /// Their values at a place, real and imaginary parts.
    fn values(&self, x: &[f64], re: &mut [f64], im: &mut [f64]);
}

/// Complex vectors one after the other, real and imaginary parts apart.
struct Vectors {
    length: usize,
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Vectors {
    fn get(&self, k: usize) -> (&[f64], &[f64]) {
        let range = k * self.length..(k + 1) * self.length;
        (&self.re[range.clone()], &self.im[range])
    }

    fn count(&self) -> usize {
        self.re.len() / self.length
    }
}

/// `conj(a) . b`.
fn dot((ar, ai): (&[f64], &[f64]), (br, bi): (&[f64], &[f64])) -> (f64, f64) {
    // Sums of eight at a time, so that the compiler can use vectors.
    let mut sums = [[0.0; 8]; 2];
    let (ar, ar_rest) = ar.as_chunks::<8>();
    let (ai, ai_rest) = ai.as_chunks::<8>();
    let (br, br_rest) = br.as_chunks::<8>();
    let (bi, bi_rest) = bi.as_chunks::<8>();
    for ((ar, ai), (br, bi)) in ar.iter().zip(ai).zip(br.iter().zip(bi)) {
        for l in 0..8 {
            sums[0][l] += ar[l] * br[l] + ai[l] * bi[l];
            sums[1][l] += ar[l] * bi[l] - ai[l] * br[l];
        }
    }
    for ((ar, ai), (br, bi)) in ar_rest.iter().zip(ai_rest).zip(br_rest.iter().zip(bi_rest)) {
        sums[0][0] += ar * br + ai * bi;
        sums[1][0] += ar * bi - ai * br;
    }
    (sums[0].iter().sum(), sums[1].iter().sum())
}

/// N points, coordinates point by point.
pub(super) fn draw(basis: &dyn Basis, stream: &mut Stream, control: &Control) -> Result<Vec<f64>> {
    let (length, dim, bound) = (basis.len(), basis.dim(), basis.bound());
    let mut points = Vec::with_capacity(length * dim);
    let mut done = Vectors { length, re: Vec::new(), im: Vec::new() };
    let (mut re, mut im) = (vec![0.0; length], vec![0.0; length]);
    let mut x = vec![0.0; dim];
    for _ in 0..length {
        // The chance of a dart is at least 1 / (4 N); so many in vain mean that rounding has used up the space.
        let mut darts = 0u64;
        loop {
            control.check()?;
            darts += 1;
            if darts > 1000 * (length as u64 + 1) {
                return Err(Error::input("determinantal process", "rounding has left no place for another point"));
            }
            x.fill_with(|| stream.uniform());
            let threshold = bound * stream.uniform();
            basis.values(&x, &mut re, &mut im);
            let mut rest: f64 = re.iter().zip(&im).map(|(a, b)| a * a + b * b).sum();
            // The density falls with every vector that is taken off: most darts are refused early.
            let mut k = 0;
            while rest > threshold && k < done.count() {
                let (a, b) = dot(done.get(k), (&re, &im));
                rest -= a * a + b * b;
                k += 1;
            }
            if rest > threshold {
                break;
            }
        }
        points.extend_from_slice(&x);
        // The second turn takes off what rounding left in the first.
        for _ in 0..2 {
            for k in 0..done.count() {
                let (vr, vi) = done.get(k);
                let (a, b) = dot((vr, vi), (&re, &im));
                for ((re, im), (vr, vi)) in re.iter_mut().zip(&mut im).zip(vr.iter().zip(vi)) {
                    *re -= a * vr - b * vi;
                    *im -= a * vi + b * vr;
                }
            }
        }
        let norm = re.iter().zip(&im).map(|(a, b)| a * a + b * b).sum::<f64>().sqrt();
        done.re.extend(re.iter().map(|a| a / norm));
        done.im.extend(im.iter().map(|b| b / norm));
    }
    Ok(points)
}

impl Basis for Waves {
    fn len(&self) -> usize {
        self.len()
    }

    fn dim(&self) -> usize {
        self.dim
    }

    fn bound(&self) -> f64 {
        self.len() as f64
    }

    fn values(&self, x: &[f64], re: &mut [f64], im: &mut [f64]) {
        self.values(x, re, im);
    }
}
