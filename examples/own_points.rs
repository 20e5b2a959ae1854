//! g and P of points of one's own, with error bars.

use pairwave::{Domain, Points, Request, Result, measure};

fn main() -> Result<()> {
    // Twenty realizations of a shifted lattice of 16 x 16 points, each a list of coordinates, point by point.
    let set = |k: usize| -> Vec<f64> {
        let shift = [0.618_034 * k as f64 % 1.0, 0.754_877 * k as f64 % 1.0];
        let point = |i: usize| [(i % 16) as f64, (i / 16) as f64];
        (0..256).flat_map(|i| [0, 1].map(|a| ((point(i)[a] + shift[a]) / 16.0).fract())).collect()
    };
    let sets: Vec<_> = (0..20).map(set).collect();
    let points = Points::new(Domain::unit_torus(2), &sets)?;
    let request = Request { bins: Some(128), ..Request::default() };
    let found = measure(points, &request)?;
    if let Some(g) = found.pair_correlation() {
        let highest = (0..g.g.len()).max_by(|&a, &b| g.g[a].total_cmp(&g.g[b])).unwrap_or(0);
        println!("g is highest at r = {:.4}: {:.2} ± {:.2}", g.r[highest], g.g[highest], g.g_se[highest]);
    }
    if let Some(mean) = found.neighbors().and_then(|n| n.distances.mean) {
        println!("nearest neighbours are {mean:.5} apart");
    }
    Ok(())
}
