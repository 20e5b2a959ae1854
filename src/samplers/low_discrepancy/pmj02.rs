//! Progressive multi-jittered (0,2) sequences (Christensen, Kensler, Kilpatrick, "Progressive multi-jittered sample sequences", 2018): every
//! prefix of 2^M points is a (0,2)-net, and every prefix of 4^M, 2 4^M, 3 4^M points is spread over the cells of the net before.
//!
//! Which cells of a net with 2^M points the next 2^M points take is not a choice: in each cell of 2^-M the new point is in the other
//! half along x *and* along y, for every shape of cell, and that leaves one place. Free are the digits behind, which are uniform, and in
//! every cell of a net of 4^M which of its two last points comes first. So these are the points of a scrambled Sobol' sequence,
//! whose doublings are the same ones, in another order: N + r, 2 N + r and 3 N + r are in the cell of point r of the first N = 4^M, the first of
//! them diagonally opposite, the other two in random order. O(n), as by Helmer, Christensen and Kensler (2021).
//!
//! P as of `sobol` in the plane.

use std::sync::Arc;

use super::net_power::net_power;
use super::sobol::{DIGITS, owen, to_f64};
use crate::control::Control;
use crate::error::Result;
use crate::samplers::{Entry, Family, Number, Realization, Sampler};

pub(in crate::samplers) static ENTRY: Entry = Entry {
    source: "Christensen, Kensler, Kilpatrick 2018; Helmer, Christensen, Kensler 2021",
    formulas: "n = 2^M: axes 1 - sinc^2(m/n); P = 1 - sum_(l1+l2<=M) b_l1(m_1) b_l2(m_2) + sum_(l1+l2=M+1) b_l1(m_1) b_l2(m_2), b_l(m) = sinc^2(m/2^l) - sinc^2(m/2^(l-1))",
    number: Number::Sequence,
    dims: 2..=2,
    ..Entry::new("pmj02", Family::LowDiscrepancy, "progressive multi-jittered (0,2) sequence", |given| {
        Ok(Arc::new(Pmj02 { n: given.n }))
    })
};

struct Pmj02 {
    n: u64,
}

impl Sampler for Pmj02 {
    fn generate(&self, which: &Realization, control: &Control) -> Result<Vec<f64>> {
        let n = which.n as usize;
        // Whole nets of 4^M: the first points do not depend on how many follow.
        let levels = n.next_power_of_two().ilog2().div_ceil(2);
        let all = 1usize << (2 * levels);
        let [x, y] = [0, 1].map(|axis| owen(axis, all, &mut which.stream_of_axis(axis)));
        let mut stream = which.stream();
        // The order of the points, doubled twice at a time.
        let mut order = vec![0u32];
        for level in 0..levels {
            control.check()?;
            let cells = 1usize << (2 * level);
            let cell = |i: usize| {
                let digits = |v: u64| (v >> (DIGITS - level)) as usize;
                digits(x[i]) << level | digits(y[i])
            };
            let half = |i: usize| ((x[i] >> (DIGITS - 1 - level)) & 1, (y[i] >> (DIGITS - 1 - level)) & 1);
            let mut place = vec![0u32; cells];
            for (r, &i) in order.iter().enumerate() {
                place[cell(i as usize)] = r as u32;
            }
            // The opposite point, and the two others.
            let mut later = vec![[0u32; 3]; cells];
            let mut others = vec![1u8; cells];
            for i in cells..4 * cells {
                let r = place[cell(i)] as usize;
                let (a, b) = (half(order[r] as usize), half(i));
                if a.0 != b.0 && a.1 != b.1 {
                    later[r][0] = i as u32;
                } else {
                    later[r][others[r] as usize] = i as u32;
                    others[r] += 1;
                }
            }
            for later in &mut later {
                if stream.bits() >> 63 == 1 {
                    later.swap(1, 2);
                }
            }
            for block in 0..3 {
                order.extend(later.iter().map(|later| later[block]));
            }
        }
        Ok(order[..n].iter().flat_map(|&i| [to_f64(x[i as usize]), to_f64(y[i as usize])]).collect())
    }

    fn power(&self, m: &[i32]) -> Option<f64> {
        if !self.n.is_power_of_two() {
            return None;
        }
        let levels = self.n.ilog2() as usize;
        // A cell of a net has one point, or the share of its volume.
        Some(net_power(levels, m, |zeros| 1 << levels.saturating_sub(zeros.iter().sum::<usize>())))
    }
}
