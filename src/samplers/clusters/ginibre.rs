//! The Ginibre process on the torus: the determinantal process of the lowest Landau level (Haldane, Rezayi 1985).
//!
//! Orthonormal `phi_j(x, y) = (2 n)^(1/4) sum_t exp(2 pi i (j + n t) x) exp(-pi n (y - t - j/n)^2)`, j < n, whose squares sum to n within
//! 0.75 % at n = 4, 1e-9 at 16:
//!
//! ```text
//! P(m) = 1 - exp(-pi |m|^2 / n)      g(r) = n / (n - 1) (1 - exp(-pi n r^2))
//! ```

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::determinantal::{Basis, draw};
use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Entry, Family, Realization, Sampler, Size};

/// From here on the closed forms hold to rounding: images are below 1e-6.
const MANY: usize = 16;

/// More would take minutes each.
const MOST: u64 = 2048;

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Ginibre 1965; Haldane & Rezayi 1985",
    formulas: "P = 1 - exp(-pi nu^2/n), g = n/(n-1) (1 - exp(-pi n r^2))",
    size: Size::new("4 to 2048", |n, _| (n >= 4).then_some(n.min(MOST)), |n, _| (n <= MOST).then_some(n.max(4))),
    dims: 2..=2,
    ..Entry::new("ginibre", Family::Clusters, "Ginibre's determinantal process on the torus", |given| {
        Ok(Arc::new(Ginibre { n: given.n as usize }))
    })
};

struct Ginibre {
    n: usize,
}

impl Basis for Ginibre {
    fn len(&self) -> usize {
        self.n
    }

    fn dim(&self) -> usize {
        2
    }

    fn bound(&self) -> f64 {
        self.n as f64 * if self.n < MANY { 1.01 } else { 1.0 + 1e-8 }
    }

    fn values(&self, place: &[f64], re: &mut [f64], im: &mut [f64]) {
        let (n, x, y) = (self.n as f64, place[0], place[1]);
        let reach = (80.0 / (PI * n)).sqrt();
        let scale = (2.0 * n).powf(0.25);
        for (j, (re, im)) in re.iter_mut().zip(im).enumerate() {
            (*re, *im) = (0.0, 0.0);
            let from = y - j as f64 / n;
            for t in (from - reach).ceil() as i64..=(from + reach).floor() as i64 {
                let height = scale * (-PI * n * (from - t as f64).powi(2)).exp();
                let mode = j as i64 + self.n as i64 * t;
                let (sin, cos) = (TAU * (mode as f64 * x).fract()).sin_cos();
                *re += height * cos;
                *im += height * sin;
            }
        }
    }
}

impl Sampler for Ginibre {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        draw(self, &mut which.stream(), control)
    }

    fn pair_correlation(&self, r: f64) -> Option<f64> {
        let n = self.n as f64;
        (self.n >= MANY).then(|| n / (n - 1.0) * (1.0 - (-PI * n * r * r).exp()))
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        let nu2: f64 = m.iter().map(|&m| f64::from(m).powi(2)).sum();
        Some(1.0 - (-PI * nu2 / self.n as f64).exp())
    }
}
