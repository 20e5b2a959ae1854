//! Effective Nyquist frequency and oscillations in the way of the program PSA: not from P, but from a smoothed P that is the
//! transform of the pair counts.
//! See `docs/spectrum-scalars.md`.

use super::Analysis;

/// What PSA prints.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct PsaStatistics {
    /// In units of `sqrt(n) / 2`; 0 also where E never exceeds 1/2.
    pub effective_nyquist: f64,
    /// Dimensionless.
    pub oscillation: f64,
}

impl PsaStatistics {
    /// How many bins of equal width over distances in [0, 1/2) its counts have: `100 sqrt(n)`.
    pub fn bins(n: u64) -> usize {
        (100.0 * (n as f64).sqrt()) as usize
    }

    /// The statistics of sets of n points on the unit torus, from `counts`, per set the unordered pairs in each of `bins(n)` bins.
    /// All sums are those of PSA 1.1 (src/statistics.cpp), in f64.
    ///
    /// `g_i = c_i / (n (n - 1) / 2 pi dr^2 (2 i + 1))` at the left edges `r_i = i dr`;
    /// `P(nu) = |1 + 2 pi n integral (g - 1) J_0(2 pi nu r) w(r) r dr|` per set, then its mean over sets, at the
    /// `100 sqrt(n)` frequencies `nu_j = j n / 2 / (100 sqrt(n))`. The window is
    /// `w(r) = 0.43 + 0.5 cos(pi r / R) + 0.08 cos(2 pi r / R)` for `r <= R = 1/2 max(1/5, min(1/2, 4 nu / sqrt(n)))`.
    /// `None` for sets without pairs.
    pub fn new(n: u64, counts: &[impl AsRef<[u64]>]) -> Option<Self> {
        let (bins, points) = (Self::bins(n), n as f64);
        if n < 2 || counts.is_empty() || counts.iter().any(|c| c.as_ref().len() != bins) {
            return None;
        }
        let (pi, root) = (std::f64::consts::PI, points.sqrt());
        let (dr, dnu) = (0.5 / bins as f64, 0.5 * points / bins as f64);
        let g = |counts: &[u64]| -> Vec<f64> {
            let ring = |i: usize| 0.5 * points * (points - 1.0) * pi * dr * dr * (2 * i + 1) as f64;
            counts.iter().enumerate().map(|(i, &c)| c as f64 / ring(i)).collect()
        };
        let sets: Vec<_> = counts.iter().map(|c| g(c.as_ref())).collect();
        let power = |j: usize| {
            let nu = j as f64 * dnu;
            let reach = 0.5 * (4.0 * nu / root).clamp(0.2, 0.5);
            let kernel: Vec<f64> = (0..bins)
                .map(|i| i as f64 * dr)
                .take_while(|&r| r <= reach)
                .map(|r| {
                    let turn = pi * r / reach;
                    let window = 0.43 + 0.5 * turn.cos() + 0.08 * (2.0 * turn).cos();
                    libm::j0(2.0 * pi * nu * r) * r * window
                })
                .collect();
            let of = |g: &Vec<f64>| {
                let integral = trapezoid(&kernel.iter().zip(g).map(|(k, g)| (g - 1.0) * k).collect::<Vec<_>>(), dr);
                (1.0 + 2.0 * pi * points * integral).abs()
            };
            sets.iter().map(of).sum::<f64>() / sets.len() as f64
        };
        let p: Vec<f64> = (0..bins).map(power).collect();
        Some(Self { effective_nyquist: effective_nyquist(&p, dnu, root), oscillation: oscillation(&p, dnu, root) })
    }
}

/// `E_j = sum over i <= j of 2 nu_i P_i dnu / nu_j^2`: from the first j at or above `sqrt(n) / 2` with `E > 1/2` back to the last
/// one below 0.1; half of its frequency over half of `sqrt(n)`.
fn effective_nyquist(p: &[f64], dnu: f64, root: f64) -> f64 {
    let mut sum = 0.0;
    let disks: Vec<f64> = (p.iter().enumerate())
        .map(|(j, p)| {
            let nu = j as f64 * dnu;
            sum += 2.0 * nu * p * dnu;
            if j > 0 { sum / (nu * nu) } else { 0.0 }
        })
        .collect();
    let start = (0.5 * root / dnu) as usize;
    let full = (start..disks.len()).find(|&j| disks[j] > 0.5).unwrap_or(0);
    let low = (1..=full).rev().find(|&j| disks[j] < 0.1);
    low.map_or(0.0, |j| j as f64 * dnu / root)
}

/// From the first P of at least 0.98 (or the largest) on, over ten times `sqrt(n) / 2`.
fn oscillation(p: &[f64], dnu: f64, root: f64) -> f64 {
    let risen = p.iter().position(|&p| p >= 0.98);
    let from = risen.unwrap_or_else(|| (0..p.len()).fold(0, |best, j| if p[j] > p[best] { j } else { best }));
    let nu_0 = from as f64 * dnu;
    let nu_1 = (nu_0 + 5.0 * root).min(p.len() as f64 * dnu);
    let last = ((nu_1 / dnu + 1.0) as usize).min(p.len() - 1);
    let parts: Vec<f64> = (from..=last).map(|j| (p[j] - 1.0).powi(2) * j as f64 * dnu).collect();
    10.0 * (2.0 * trapezoid(&parts, dnu) / (nu_1 * nu_1 - nu_0 * nu_0)).sqrt()
}

fn trapezoid(values: &[f64], step: f64) -> f64 {
    match values {
        [first, .., last] => step * (values.iter().sum::<f64>() - 0.5 * (first + last)),
        _ => 0.0,
    }
}

impl Analysis {
    /// What PSA says of the spectrum, by its own method.
    pub fn psa(&self) -> Option<&PsaStatistics> {
        self.get()
    }
}
