//! What a scene does not need is not done: work as it was counted while it was done, beside that of a plain implementation.

use std::sync::Arc;

use super::{Bench, process};
use crate::analysis::{Ended, Job, Measurement, Plan};
use crate::control::{Done, Instant};
use crate::error::{Error, Result};
use crate::plan::Spatial;
use crate::points::Domain;
use crate::request::{Request, Statistic};
use crate::source::Points;

/// The work of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Skipped {
    /// What is asked for.
    pub scene: String,
    /// What was done.
    pub done: Done,
    /// What a plain implementation does for it: every pair of points, every point at every wave vector of the plane, points read once for each.
    pub plain: Done,
    /// Seconds, points included.
    pub seconds: f64,
}

/// n and K, and the largest frequency that is looked at (0: none).
struct Size {
    n: u64,
    k: u64,
    f: u32,
}

pub(super) fn measure(bench: &Bench<'_>) -> Result<Vec<Skipped>> {
    let n = bench.size(2000, 20_000);
    let few = bench.size(900, 4096);
    let f = (5.0 * (few as f64).sqrt()).ceil() as u32;
    let of = |stats: &[Statistic]| Request { stats: stats.to_vec(), ..Request::default() };
    let pcf = |r_max| Request { r_max: Some(r_max), ..of(&[Statistic::Pcf]) };
    let radial = Request { max_frequency: Some(vec![f]), ..of(&[Statistic::Radial]) };
    let integrate = |integrand: &str| Request {
        integrand: vec![integrand.into()],
        max_frequency: Some(vec![f]),
        shifts: Some(1),
        spatial: Some(Spatial::None),
        ..of(&[])
    };
    let pairs = Size { n, k: 4, f: 0 };
    let waves = || Size { n: few, k: 4, f };
    let mut all = vec![
        scene(bench, "g at distances below 0.01", pcf(0.01), &pairs, None)?,
        scene(bench, "g at distances below 0.1", pcf(0.1), &pairs, None)?,
        scene(bench, "radial mean of P", radial.clone(), &waves(), None)?,
        scene(
            bench,
            "radial mean of P by 8 directions",
            Request { ring_directions: Some(8), ..radial.clone() },
            &waves(),
            None,
        )?,
        scene(bench, "variance of an integral over a disk, all frequencies", integrate("disk"), &waves(), None)?,
        scene(bench, "variance of a smooth integrand", integrate("gaussian:sigma=0.2"), &waves(), None)?,
        scene(bench, "variance of a function of x alone", integrate("step"), &waves(), None)?,
    ];
    let many = Size { n: 400, k: bench.size(400, 4000), f: 0 };
    all.push(scene(bench, "g(0.05) to 0.02, of many realizations", pcf(0.1), &many, Some("pcf@0.05:0.02"))?);
    all.push(changed(bench, &waves())?);
    Ok(all)
}

/// What a plain implementation does.
fn plain(request: &Request, size: &Size) -> Done {
    let Size { n, k, f } = *size;
    let pairs = if request.stats.contains(&Statistic::Pcf) { n * (n - 1) / 2 } else { 0 };
    let modes = (2 * u64::from(f) + 1).pow(2);
    let products = if f > 0 { n * modes } else { 0 };
    // Two coordinates of a partner, or of a point.
    Done { pairs: k * pairs, products: k * products, bytes: k * 16 * (pairs + products) }
}

fn scene(bench: &Bench<'_>, scene: &str, request: Request, size: &Size, until: Option<&str>) -> Result<Skipped> {
    let (device, control) = (&bench.devices[0], bench.control.beside());
    let process = process("random", size.n, size.k, 2)?;
    let points = Arc::new(Points::sampled(process, Domain::unit_torus(2))?);
    let plan = Plan::of(&request, &points)?.for_device(device.compute());
    let until = until.map(str::parse).transpose().map_err(|e: String| Error::input("a target", e))?;
    let job = Job { until: until.into_iter().collect(), ..Job::default() };
    let plain = plain(&request, size);
    let mut measurement = Measurement::new(request, points, plan);
    let start = Instant::now();
    if let Ended::Failed(error) = job.measure(&mut measurement, device, &control, &mut |_| ()) {
        return Err(error);
    }
    let seconds = start.elapsed().as_secs_f64();
    let held = if measurement.realizations() < size.k {
        format!(": K = {} of {}", measurement.realizations(), size.k)
    } else {
        String::new()
    };
    Ok(Skipped {
        scene: format!("{scene}, n = {}, K = {}{held}", size.n, size.k),
        done: control.done(),
        plain,
        seconds,
    })
}

/// An analysis whose largest frequency is changed once it is there: the pairs are not looked at again.
fn changed(bench: &Bench<'_>, size: &Size) -> Result<Skipped> {
    let device = &bench.devices[0];
    let request = |f| {
        let mut request = Request {
            stats: vec![Statistic::Pcf, Statistic::Spectrum],
            max_frequency: Some(vec![f]),
            r_max: Some(0.2),
            ..Request::default()
        };
        request.input.sampler = Some("random".into());
        (request.input.points, request.input.realizations) = (Some(size.n), Some(size.k));
        request
    };
    let (first, control) = (request(size.f), bench.control.beside());
    let mut measurement = Measurement::live(&first, device)?;
    while measurement.step(device, &control)? {}
    let other = request(size.f / 2);
    let control = bench.control.beside();
    let start = Instant::now();
    measurement.change(&other, device)?;
    while measurement.step(device, &control)? {}
    let plain = plain(&other, &Size { f: size.f / 2, ..*size });
    let scene = format!("g and P again with half the frequencies, n = {}, K = {}", size.n, size.k);
    Ok(Skipped { scene, done: control.done(), plain, seconds: start.elapsed().as_secs_f64() })
}
