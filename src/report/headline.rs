//! What the terminal says when a result is written: a few lines, no more.

use crate::display::{human, with_error};
use crate::estimate::Analysis;

/// Subject, device, and one line per statistic.
pub fn headline(a: &Analysis) -> String {
    let mut lines = vec![format!("{}, on {}", a.subject, a.computed_by.device())];
    if let Some(g) = a.pair_correlation() {
        let pairs: u64 = g.count.iter().sum();
        let range = format!("[{}, {})", human(g.r_lo[0]), human(g.r_hi[g.r_hi.len() - 1]));
        lines.push(format!("g(r): {} bins over {range}, {pairs} ordered pairs", g.g.len()));
    }
    if let Some(cross) = a.cross() {
        let pairs: u64 = cross.between.count.iter().sum();
        let [a, b] = &cross.classes;
        lines.push(format!("g of {a} and {b}: {pairs} pairs from {a} to {b}"));
    }
    if let Some(k) = a.k_function()
        && let (Some(&r), Some(&neighbors)) = (k.r.last(), k.neighbors.last())
    {
        lines.push(format!("K(r): {} further points within {} of a point, on average", human(neighbors), human(r)));
    }
    if let Some(vector) = a.vector() {
        let pairs: u64 = vector.count.iter().sum();
        let bins = vec![vector.grid.bins.to_string(); vector.grid.dim()].join(" x ");
        lines.push(format!("g(h): {bins} cells of lags, {pairs} ordered pairs"));
    }
    if let Some(spectrum) = a.spectrum().filter(|s| a.grid_wanted && s.waves.grid().is_none()) {
        lines.push(format!("P(ν): {} wave vectors of a list", spectrum.p.len()));
    }
    if let Some(radial) = a.radial() {
        let first = radial.rings.first().map_or(String::new(), |ring| {
            let error = Some(ring.p_se);
            format!(", P = {} at the lowest frequency", with_error(ring.p, error))
        });
        lines.push(format!("P(ν): {} rings{first}", radial.rings.len()));
    }
    if let Some(covariance) = a.covariance() {
        let z = covariance
            .scalars
            .rms_z
            .map_or(String::new(), |z| format!(", root mean square {} standard errors", human(z)));
        let share = human(covariance.scalars.off_diagonal_share);
        lines.push(format!("C(m, l): {0} x {0}, off the diagonal {share} of all |C|²{z}", covariance.modes()));
    }
    if let Some(neighbors) = a.neighbors() {
        let nn = &neighbors.distances;
        let value = |x: Option<f64>, se| x.map_or("undefined".into(), |x| with_error(x, se));
        let relative = nn.mean_relative.map_or(String::new(), |r| format!(" ({} of the closest packing)", human(r)));
        let (minimum, mean) = (value(nn.minimum, None), value(nn.mean, nn.mean_se));
        lines.push(format!("nearest neighbour: smallest {minimum}, mean {mean}{relative}"));
        if let Ok(bonds) = &neighbors.bonds {
            let (local, global) = (with_error(bonds.local, bonds.local_se), with_error(bonds.global, bonds.global_se));
            lines.push(format!("bond order: mean |ψ₆| {local}, |mean ψ₆| {global}"));
        }
    }
    lines.join("\n") + "\n"
}
