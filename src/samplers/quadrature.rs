//! Integrals whose integrands have square roots at the ends.

/// Places and weights of Simpson's rule in s with `t = from + (to - from) (3 s^2 - 2 s^3)`, which turns square roots at both ends
/// into polynomials.
pub(super) fn simpson<const STEPS: usize>(from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    let h = 1.0 / STEPS as f64;
    (0..=STEPS).map(move |i| {
        let s = i as f64 * h;
        let weight = if i == 0 || i == STEPS { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
        (from + (to - from) * s * s * (3.0 - 2.0 * s), weight * h / 3.0 * (to - from) * 6.0 * s * (1.0 - s))
    })
}
