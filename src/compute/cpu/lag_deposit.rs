//! Pairs shared among the nodes around their lags: where a lag lies in its cell is worked out for many pairs at a time, then every pair
//! adds to the corners of one cell, which lie side by side in memory.

use std::ops::Range;

use super::{Cpu, simd};
use crate::control::Control;
use crate::error::Result;
use crate::plan::half_of_lags as half;

/// Pairs whose lags are worked out at a time.
const ROW: usize = 128;

/// Pairs that cells in f32 take before they are emptied, per cell on average: what rounding leaves of them is far below what is lost between
/// nodes.
const PAIRS_PER_CELL: usize = 64;

/// Points in 32-bit fractions of the box, per axis.
pub(super) struct Lags {
    axes: Vec<Vec<u32>>,
    weights: Option<Vec<f32>>,
    /// log2 of cells per side.
    bits: u32,
}

/// What a thread keeps from realization to realization.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// Per cell of lags, what its corners have; 0 between realizations.
    corners: Vec<f32>,
    nodes: Vec<f64>,
}

/// Per node of the half of a grid of lags whose last component is 0 to half a side (of a lag and its opposite one is there), x fastest, the
/// share of all pairs, each once, times the product of its weights.
pub(super) fn deposit<'a>(
    cpu: &Cpu,
    axes: &[&[u64]],
    weights: Option<&[f64]>,
    cells: usize,
    scratch: &'a mut Scratch,
    control: &Control,
) -> Result<&'a [f64]> {
    let (dim, n) = (axes.len(), axes[0].len());
    let lags = Lags {
        axes: axes.iter().map(|axis| axis.iter().map(|x| (x >> 32) as u32).collect()).collect(),
        weights: weights.map(|weights| weights.iter().map(|w| *w as f32).collect()),
        bits: cells.trailing_zeros(),
    };
    let len = half(cells, dim);
    let Scratch { corners, nodes } = scratch;
    corners.resize(len << dim, 0.0);
    nodes.clear();
    nodes.resize(len, 0.0);
    let (mut from, mut held) = (0, 0);
    for i in 0..n {
        held += n - 1 - i;
        if held > PAIRS_PER_CELL * len || i + 1 == n {
            control.check()?;
            simd::deposit_lags(cpu.level, &lags, from..i + 1, corners);
            empty(corners, nodes, dim, cells);
            (from, held) = (i + 1, 0);
        }
    }
    Ok(nodes)
}

/// Adds corners of cells to the nodes they are, and leaves them at 0. Of the last cells along the last axis only one side is ever added to.
fn empty(corners: &mut [f32], nodes: &mut [f64], dim: usize, cells: usize) {
    let line = if dim == 1 { nodes.len() } else { cells };
    for (at, cells_of_line) in corners.chunks_exact(line << dim).enumerate() {
        for upper in 0..1usize << (dim - 1) {
            let (mut to, mut stride) = (0, 1);
            for a in 1..dim {
                let place = at / stride % cells + (upper >> (a - 1) & 1);
                to += if a + 1 < dim { place % cells } else { place } * stride;
                stride *= cells;
            }
            let Some(nodes) = nodes.get_mut(to * line..(to + 1) * line) else { continue };
            let sides = |side: usize| cells_of_line.iter().skip(2 * upper + side).step_by(1 << dim);
            nodes.iter_mut().zip(sides(0)).for_each(|(node, share)| *node += f64::from(*share));
            nodes.iter_mut().skip(1).zip(sides(1)).for_each(|(node, share)| *node += f64::from(*share));
            if dim > 1
                && let (Some(node), Some(share)) = (nodes.first_mut(), sides(1).next_back())
            {
                *node += f64::from(*share);
            }
        }
    }
    corners.fill(0.0);
}

/// Pairs (i, j), i in `rows` and j after it, onto the corners of their cells.
#[inline(always)]
pub(super) fn add<const FUSED: bool>(lags: &Lags, rows: Range<usize>, corners: &mut [f32]) {
    match lags.axes.as_slice() {
        [x] => add_to([x], lags, rows, corners.as_chunks_mut::<2>().0),
        [x, y] => add_to([x, y], lags, rows, corners.as_chunks_mut::<4>().0),
        [x, y, z] => add_to([x, y, z], lags, rows, corners.as_chunks_mut::<8>().0),
        _ => (),
    }
}

#[inline(always)]
fn add_to<const D: usize, const C: usize>(
    axes: [&Vec<u32>; D],
    lags: &Lags,
    rows: Range<usize>,
    cells: &mut [[f32; C]],
) {
    let (bits, n) = (lags.bits, axes[0].len());
    let (mut at, mut parts, mut products) = ([0u32; ROW], [[0.0f32; ROW]; D], [1.0f32; ROW]);
    // All ones where the opposite lag is taken, whose last component is at most half a side.
    let mut opposite = [0u32; ROW];
    for i in rows {
        for from in (i + 1..n).step_by(ROW) {
            let to = n.min(from + ROW);
            let last = axes[D - 1];
            for (x, opposite) in last[from..to].iter().zip(&mut opposite) {
                *opposite = (x.wrapping_sub(last[i]).cast_signed() >> 31).cast_unsigned();
            }
            at.fill(0);
            for ((a, axis), parts) in axes.iter().enumerate().zip(&mut parts) {
                let origin = axis[i];
                for (((x, at), part), opposite) in axis[from..to].iter().zip(&mut at).zip(parts).zip(&opposite) {
                    let lag = (x.wrapping_sub(origin) ^ opposite).wrapping_sub(*opposite);
                    *at |= (lag >> (32 - bits)) << (bits as usize * a);
                    // 24 bits, all that f32 has.
                    *part = ((lag << bits) >> 8) as i32 as f32 * 2f32.powi(-24);
                }
            }
            if let Some(weights) = &lags.weights {
                products.iter_mut().zip(&weights[from..to]).for_each(|(p, w)| *p = weights[i] * w);
            }
            for j in 0..to - from {
                let mut shares = [products[j]; C];
                for (a, parts) in parts.iter().enumerate() {
                    let sides = [1.0 - parts[j], parts[j]];
                    shares.iter_mut().enumerate().for_each(|(c, share)| *share *= sides[c >> a & 1]);
                }
                // Every lag has its cell: the check is never what fails.
                if let Some(cell) = cells.get_mut(at[j] as usize) {
                    cell.iter_mut().zip(shares).for_each(|(cell, share)| *cell += share);
                }
            }
        }
    }
}
