//! The inverse of distribution functions that are known in closed form: of a product of functions of one coordinate, with an offset.

use super::factors::Factor;
use super::separable::Separable;

/// `x` in [lo, hi] where a rising function crosses `target`; `at` has its value and slope. Newton's method, halving wherever that leaves
/// the bracket (Press et al., Numerical Recipes, 9.4).
pub(super) fn crossing(lo: f64, hi: f64, target: f64, guess: f64, at: impl Fn(f64) -> (f64, f64)) -> f64 {
    let (mut lo, mut hi, mut x) = (lo, hi, guess.clamp(lo, hi));
    for _ in 0..80 {
        let (value, slope) = at(x);
        let over = value - target;
        if over > 0.0 {
            hi = x;
        } else {
            lo = x;
        }
        let newton = x - over / slope;
        // At an end of the bracket it would stay there.
        let next = if newton > lo && newton < hi { newton } else { 0.5 * (lo + hi) };
        if over == 0.0 || (next - x).abs() <= 2.0 * f64::EPSILON * x.abs() || next <= lo || next >= hi {
            return if over == 0.0 { x } else { next };
        }
        x = next;
    }
    x
}

/// Quantiles of a factor between which its inverse is looked for.
const QUANTILES: usize = 256;

/// One axis of a product.
struct Line {
    factor: Factor,
    integral: f64,
    /// Where its integral is k / `QUANTILES` of the whole.
    quantiles: Vec<f64>,
}

impl Line {
    fn new(factor: &Factor) -> Self {
        let mut line = Self { factor: factor.clone(), integral: factor.integral(), quantiles: Vec::new() };
        let quantile = |k: usize| line.solve(0.0, 1.0, k as f64 / QUANTILES as f64, [0.0, 1.0]);
        line.quantiles = (0..=QUANTILES).map(quantile).collect();
        line
    }

    /// t where the integral of `a + b f` over [0, t] is the part `v` of the whole.
    fn solve(&self, a: f64, b: f64, v: f64, within: [f64; 2]) -> f64 {
        let [lo, hi] = within;
        let guess = lo + (hi - lo) * v;
        let at = |t: f64| (a * t + b * self.factor.cumulative(t), a + b * self.factor.value(t));
        crossing(lo, hi, v * (a + b * self.integral), guess, at)
    }

    /// The same of f alone.
    fn quantile(&self, v: f64) -> f64 {
        match &self.factor {
            Factor::One => v,
            Factor::Interval { lo, hi } => (lo + v * (hi - lo)).min(hi.next_down()),
            Factor::Power(1) => v.sqrt(),
            Factor::Power(p) => v.powf(1.0 / (f64::from(*p) + 1.0)),
            _ => {
                let place = v * QUANTILES as f64;
                let k = (place as usize).min(QUANTILES - 1);
                let (lo, hi) = (self.quantiles[k], self.quantiles[k + 1]);
                let at = |t: f64| (self.factor.cumulative(t), self.factor.value(t));
                crossing(lo, hi, v * self.integral, lo + (place - k as f64) * (hi - lo), at)
            }
        }
    }
}

/// The map whose density is proportional to a separable function.
pub(super) struct Lines {
    offset: f64,
    scale: f64,
    lines: Vec<Line>,
}

impl Lines {
    pub(super) fn new(p: &Separable) -> Self {
        Self { offset: p.offset(), scale: p.scale(), lines: p.factors().iter().map(Line::new).collect() }
    }

    /// One axis of a product without offset: places of the others do not matter.
    pub(super) fn quantile(&self, axis: usize, v: f64) -> f64 {
        self.lines[axis].quantile(v)
    }

    /// Axis by axis: the density of x_k, given those before, is `offset + c f_k`, where c has the values of factors before and the integrals of
    /// those behind.
    pub(super) fn place(&self, u: [f64; 3]) -> [f64; 3] {
        let mut x = [0.0; 3];
        for (k, line) in self.lines.iter().enumerate() {
            if self.offset == 0.0 {
                x[k] = line.quantile(u[k]);
                continue;
            }
            let behind = self.lines[k + 1..].iter().map(|line| line.integral).product::<f64>();
            let before = self.lines[..k].iter().zip(x).map(|(line, x)| line.factor.value(x)).product::<f64>();
            x[k] = line.solve(self.offset, self.scale * before * behind, u[k], [0.0, 1.0]);
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crossing_is_found_where_newton_would_leave() {
        for target in [-0.9, 0.0, 1e-9, 0.3, 0.99] {
            // Flat in the middle, and nearly a jump.
            for of in
                [|x: f64| (x.powi(9), 9.0 * x.powi(8)), |x: f64| ((40.0 * x).tanh(), 40.0 / (40.0 * x).cosh().powi(2))]
            {
                let x = crossing(-1.0, 1.0, target, 0.9, of);
                assert!((of(x).0 - target).abs() < 1e-14, "{target}: {x}");
            }
        }
    }
}
