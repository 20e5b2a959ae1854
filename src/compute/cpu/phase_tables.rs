//! Tables of `cos` and `sin` of `2 pi m . x`, for a panel of points and a list of integer vectors `m`.
//!
//! A phase `m . x mod 1` is exact in wrapping integers, so no argument reduction is needed: the two highest bits are the
//! quadrant, the others an angle in [-pi/4, pi/4), for which short polynomials do (coefficients of sinf.c and cosf.c of
//! Cephes, S. Moshier, 1989, and of k_sin.c and k_cos.c of fdlibm, Sun Microsystems, 1993).

/// Frequencies a kernel makes at a time. Their cosines come first in a table, then their sines, then the next group.
pub(super) const GROUP: usize = 8;

/// One axis of a list of integer vectors.
#[derive(Debug, Clone)]
struct Term {
    axis: usize,
    /// Component along the axis, padded to whole groups.
    m: Vec<[i32; GROUP]>,
}

/// A list of integer vectors `m`, as the kernels want it.
#[derive(Debug, Clone)]
pub(super) struct Table {
    len: usize,
    /// One or two axes; the list is zero along the others.
    terms: Vec<Term>,
}

/// Points whose phases are wanted: per axis, fractions of the side in steps of 2^-64.
pub(super) struct Panel<'a> {
    pub(super) axes: &'a [&'a [u64]],
}

impl Table {
    /// The list `m`, all zero along axes that are not in `axes`.
    pub(super) fn new(axes: &[usize], m: &[[i32; 3]]) -> Self {
        let term = |&axis: &usize| {
            let group = |group: &[[i32; 3]]| std::array::from_fn(|l| group.get(l).map_or(0, |m| m[axis]));
            Term { axis, m: m.chunks(GROUP).map(group).collect() }
        };
        Self { len: m.len(), terms: axes.iter().map(term).collect() }
    }

    /// Number of vectors.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Values per point: cosines and sines of whole groups.
    pub(super) fn width(&self) -> usize {
        2 * self.len.next_multiple_of(GROUP)
    }
}

/// Where a table holds the cosine of vector `k`; its sine is `GROUP` further.
pub(super) const fn place(k: usize) -> usize {
    k / GROUP * 2 * GROUP + k % GROUP
}

/// `a * b + c`, fused where the processor can (elsewhere `mul_add` is a slow library call).
macro_rules! fma {
    ($a:expr, $b:expr, $c:expr) => {
        if FMA { $a.mul_add($b, $c) } else { $a * $b + $c }
    };
}

#[inline(always)]
fn turn_f32<const FMA: bool>(phase: u32) -> (f32, f32) {
    let quadrant = phase.wrapping_add(1 << 29) >> 30;
    // In turns; the coefficients hold the powers of 2 pi, so that the conversion is the only rounding of the angle.
    let a = phase.wrapping_sub(quadrant << 30) as i32 as f32 * 2f32.powi(-32);
    let z = a * a;
    let s = fma!(fma!(-75.445_653f32, z, 81.593_768), z, -41.341_67);
    // 2 pi = 6.281_25 + the rest; the first product is exact within its multiply-add.
    let s = fma!(s, z, 0.001_935_307_2);
    let s = fma!(a, 6.281_25, s * a);
    let c = fma!(fma!(59.349_7f32, z, -85.447_14), z, 64.939_36);
    let c = fma!(fma!(c, z, -19.739_209), z, 1.0);
    let odd = quadrant & 1 != 0;
    let (c, s) = if odd { (s, c) } else { (c, s) };
    let flip_cos = (quadrant.wrapping_add(1) & 2) << 30;
    let flip_sin = (quadrant & 2) << 30;
    (f32::from_bits(c.to_bits() ^ flip_cos), f32::from_bits(s.to_bits() ^ flip_sin))
}

#[inline(always)]
pub(super) fn turn_f64<const FMA: bool>(phase: u64) -> (f64, f64) {
    let quadrant = phase.wrapping_add(1 << 61) >> 62;
    let angle = phase.wrapping_sub(quadrant << 62) as i64 as f64;
    // 2 pi / 2^64
    let a = angle * (std::f64::consts::TAU / 18_446_744_073_709_551_616.0);
    let z = a * a;
    let s = fma!(1.589_690_995_211_55e-10f64, z, -2.505_076_025_340_686_3e-8);
    let s = fma!(s, z, 2.755_731_370_707_006_8e-6);
    let s = fma!(s, z, -1.984_126_982_985_795e-4);
    let s = fma!(s, z, 8.333_333_333_322_49e-3);
    let s = fma!(s, z, -1.666_666_666_666_663_2e-1);
    let s = fma!(s, z * a, a);
    let c = fma!(-1.135_964_755_778_819_5e-11f64, z, 2.087_572_321_298_175e-9);
    let c = fma!(c, z, -2.755_731_435_139_066_3e-7);
    let c = fma!(c, z, 2.480_158_728_947_673e-5);
    let c = fma!(c, z, -1.388_888_888_887_411e-3);
    let c = fma!(c, z, 4.166_666_666_666_66e-2);
    let c = fma!(c, z, -0.5);
    let c = fma!(c, z, 1.0);
    let odd = quadrant & 1 != 0;
    let (c, s) = if odd { (s, c) } else { (c, s) };
    let flip_cos = (quadrant.wrapping_add(1) & 2) << 62;
    let flip_sin = (quadrant & 2) << 62;
    (f64::from_bits(c.to_bits() ^ flip_cos), f64::from_bits(s.to_bits() ^ flip_sin))
}

/// The loops over a panel, to be inlined into a function for an instruction set.
pub(super) mod fill {
    use super::{GROUP, Panel, Table, Term, turn_f32, turn_f64};

    /// Writes `out[p * stride ..]`: cosines and sines of all vectors at point `p`, group by group.
    #[inline(always)]
    pub(in super::super) fn f32<const FMA: bool>(table: &Table, panel: &Panel<'_>, out: &mut [f32], stride: usize) {
        match table.terms.as_slice() {
            [] => {}
            [a] => f32_terms::<FMA, 1>([a], panel, out, stride),
            [a, b, ..] => f32_terms::<FMA, 2>([a, b], panel, out, stride),
        }
    }

    #[inline(always)]
    fn f32_terms<const FMA: bool, const T: usize>(
        terms: [&Term; T],
        panel: &Panel<'_>,
        out: &mut [f32],
        stride: usize,
    ) {
        let groups = terms[0].m.len();
        for (p, row) in out.chunks_exact_mut(stride).take(panel.axes[0].len()).enumerate() {
            let x: [u64; T] = std::array::from_fn(|t| panel.axes[terms[t].axis][p]);
            let high = x.map(|x| (x >> 32) as u32);
            let low = x.map(|x| x as u32 as f32 * 2f32.powi(-32));
            for group in 0..groups {
                let mut phases = [0u32; GROUP];
                for t in 0..T {
                    let m = &terms[t].m[group];
                    for (phase, &m) in phases.iter_mut().zip(m) {
                        // What the low half of x carries into the upper half of m x: below 2^22, and good to half a
                        // step of 2^-32. Adding 1.5 * 2^23 rounds it to an integer in the low bits.
                        let carry = (m as f32 * low[t] + 12_582_912.0).to_bits().wrapping_sub(0x4b40_0000);
                        *phase = phase.wrapping_add((m as u32).wrapping_mul(high[t])).wrapping_add(carry);
                    }
                }
                let (mut c, mut s) = ([0.0; GROUP], [0.0; GROUP]);
                for ((c, s), &phase) in c.iter_mut().zip(&mut s).zip(&phases) {
                    (*c, *s) = turn_f32::<FMA>(phase);
                }
                let row = &mut row[2 * group * GROUP..][..2 * GROUP];
                row[..GROUP].copy_from_slice(&c);
                row[GROUP..].copy_from_slice(&s);
            }
        }
    }

    /// The same in f64, with phases exact to 2^-64.
    #[inline(always)]
    pub(in super::super) fn f64<const FMA: bool>(table: &Table, panel: &Panel<'_>, out: &mut [f64], stride: usize) {
        match table.terms.as_slice() {
            [] => {}
            [a] => f64_terms::<FMA, 1>([a], panel, out, stride),
            [a, b, ..] => f64_terms::<FMA, 2>([a, b], panel, out, stride),
        }
    }

    #[inline(always)]
    fn f64_terms<const FMA: bool, const T: usize>(
        terms: [&Term; T],
        panel: &Panel<'_>,
        out: &mut [f64],
        stride: usize,
    ) {
        let groups = terms[0].m.len();
        for (p, row) in out.chunks_exact_mut(stride).take(panel.axes[0].len()).enumerate() {
            let x: [u64; T] = std::array::from_fn(|t| panel.axes[terms[t].axis][p]);
            for group in 0..groups {
                let mut phases = [0u64; GROUP];
                for t in 0..T {
                    for (phase, &m) in phases.iter_mut().zip(&terms[t].m[group]) {
                        *phase = phase.wrapping_add((i64::from(m) as u64).wrapping_mul(x[t]));
                    }
                }
                let (mut c, mut s) = ([0.0; GROUP], [0.0; GROUP]);
                for ((c, s), &phase) in c.iter_mut().zip(&mut s).zip(&phases) {
                    (*c, *s) = turn_f64::<FMA>(phase);
                }
                let row = &mut row[2 * group * GROUP..][..2 * GROUP];
                row[..GROUP].copy_from_slice(&c);
                row[GROUP..].copy_from_slice(&s);
            }
        }
    }

    /// `sums[c]`: the sum over points `p` of `weights[p] table[p * stride + c]`, in the order of points.
    #[inline(always)]
    pub(in super::super) fn sums_f32<const FMA: bool>(table: &[f32], stride: usize, weights: &[f32], sums: &mut [f32]) {
        let mut done = 0;
        for sums in sums.chunks_exact_mut(8 * GROUP) {
            columns::<f32, { 8 * GROUP }>(&table[done..], stride, weights, sums, mul_add_f32::<FMA>);
            done += 8 * GROUP;
        }
        for (sums, first) in sums[done..].chunks_exact_mut(2 * GROUP).zip((done..).step_by(2 * GROUP)) {
            columns::<f32, { 2 * GROUP }>(&table[first..], stride, weights, sums, mul_add_f32::<FMA>);
        }
    }

    /// The same in f64.
    #[inline(always)]
    pub(in super::super) fn sums_f64<const FMA: bool>(table: &[f64], stride: usize, weights: &[f64], sums: &mut [f64]) {
        for (sums, first) in sums.chunks_exact_mut(2 * GROUP).zip((0..).step_by(2 * GROUP)) {
            columns::<f64, { 2 * GROUP }>(&table[first..], stride, weights, sums, mul_add_f64::<FMA>);
        }
    }

    #[inline(always)]
    fn columns<T: Copy + Default, const N: usize>(
        table: &[T],
        stride: usize,
        weights: &[T],
        out: &mut [T],
        mul_add: impl Fn(T, T, T) -> T,
    ) {
        let mut sums = [T::default(); N];
        for (p, &weight) in weights.iter().enumerate() {
            for (sum, &value) in sums.iter_mut().zip(&table[p * stride..][..N]) {
                *sum = mul_add(value, weight, *sum);
            }
        }
        out.copy_from_slice(&sums);
    }

    #[inline(always)]
    fn mul_add_f32<const FMA: bool>(a: f32, b: f32, c: f32) -> f32 {
        fma!(a, b, c)
    }

    #[inline(always)]
    fn mul_add_f64<const FMA: bool>(a: f64, b: f64, c: f64) -> f64 {
        fma!(a, b, c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Phases over the whole turn, and close to every multiple of an eighth.
    fn phases() -> impl Iterator<Item = u64> {
        let even = (0..400_000u64).map(|k| k.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let near = (0..8u64).flat_map(|k| {
            (0..64).flat_map(move |b| [(k << 61).wrapping_add(1 << b), (k << 61).wrapping_sub(1 << b), k << 61])
        });
        even.chain(near)
    }

    #[test]
    fn f32_is_within_1e_7_over_the_whole_turn() {
        let mut worst = 0.0f64;
        for phase in phases().map(|p| (p >> 32) as u32) {
            let (sin, cos) = (std::f64::consts::TAU * (f64::from(phase as i32) / 2f64.powi(32))).sin_cos();
            for (c, s) in [turn_f32::<false>(phase), turn_f32::<true>(phase)] {
                worst = worst.max((f64::from(c) - cos).abs()).max((f64::from(s) - sin).abs());
            }
        }
        println!("f32: {worst:e}");
        assert!(worst <= 1e-7, "{worst:e}");
    }

    #[test]
    fn f64_is_within_3e_16_over_the_whole_turn() {
        let mut worst = 0.0f64;
        for phase in phases() {
            // Of the octant's own angle, so that libm is asked for nothing but a sine below pi/4.
            let quadrant = phase.wrapping_add(1 << 61) >> 62;
            let angle = std::f64::consts::TAU * (phase.wrapping_sub(quadrant << 62) as i64 as f64 / 2f64.powi(64));
            let (s0, c0) = angle.sin_cos();
            let (cos, sin) = [(c0, s0), (-s0, c0), (-c0, -s0), (s0, -c0)][quadrant as usize];
            for (c, s) in [turn_f64::<false>(phase), turn_f64::<true>(phase)] {
                worst = worst.max((c - cos).abs()).max((s - sin).abs());
            }
        }
        println!("f64: {worst:e}");
        assert!(worst <= 3e-16, "{worst:e}");
    }
}
