//! The Halton sequence (Halton 1960): coordinate j of point i is the radical inverse of i in the j-th prime base,
//! i = 0 .. n - 1, starting at the origin.
//!
//! By default every realization is moved by one uniform shift of its own (Cranley, Patterson 1976), which leaves g and P as
//! they are and makes the estimate of an integral unbiased.

use super::stream::{stream, uniform};
use super::{Accepts, Parameter, ParameterValues, Realization, Sampler, wrap};
use crate::error::Result;

pub(super) struct Halton;

const BASES: [u64; 3] = [2, 3, 5];

impl Sampler for Halton {
    fn name(&self) -> &'static str {
        "halton"
    }

    fn summary(&self) -> &'static str {
        "first n points of the Halton sequence in bases 2, 3, 5"
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter {
            name: "scramble",
            default: "shift",
            accepts: Accepts::OneOf(&["none", "shift"]),
            help: "shift: one uniform shift per realization (Cranley-Patterson); none: all realizations equal",
        }]
    }

    fn generate(&self, realization: &Realization, values: &ParameterValues) -> Result<Vec<f64>> {
        let Realization { n, dim, .. } = *realization;
        self.check(n, dim, values)?;
        let mut shift = [0.0; 3];
        if values.word("scramble")? == "shift" {
            let mut rng = stream(self, values, realization);
            shift = std::array::from_fn(|_| uniform(&mut rng));
        }
        let point = |i| (0..dim).map(move |j| wrap(radical_inverse(i, BASES[j]) + shift[j]));
        Ok((0..n).flat_map(point).collect())
    }
}

/// The digits of `i` mirrored at the radix point. Both integers are exact in f64, so the quotient is correctly rounded.
fn radical_inverse(mut i: u64, base: u64) -> f64 {
    let (mut mirrored, mut scale) = (0, 1);
    while i > 0 {
        mirrored = mirrored * base + i % base;
        scale *= base;
        i /= base;
    }
    mirrored as f64 / scale as f64
}
