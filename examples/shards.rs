//! A batch in two shards, as on two machines: written, read and merged, with the numbers of one run to the last bit.

use pairwave::control::Control;
use pairwave::request::{DeviceChoice, PointsRequest};
use pairwave::{Device, Measurement, Points, Request, Result, measure};

fn main() -> Result<()> {
    let input = PointsRequest {
        sampler: Some("poisson-disk".into()),
        points: Some(200),
        realizations: Some(40),
        ..PointsRequest::default()
    };
    let request = Request { input, ..Request::default() };
    let (device, control) = (pairwave::control::wait(Device::open(DeviceChoice::Cpu, None))?, Control::default());
    let mut files = Vec::new();
    // Shards begin and end at multiples of 16 realizations.
    for range in [0..16, 16..40] {
        let mut shard = Measurement::of(&request)?.within(range, &device)?;
        while shard.step(&device, &control)? {}
        files.push(shard.write());
    }
    let mut merged = Measurement::read("second", &files[1])?;
    merged.merge(Measurement::read("first", &files[0])?)?;
    let whole = measure(Points::open(&request.input)?, &request)?;
    let same = merged.analysis().is_some_and(|found| {
        let p = |found: &pairwave::Analysis| found.spectrum().map(|spectrum| spectrum.p.clone());
        found.pair_correlation() == whole.pair_correlation() && p(&found) == p(&whole)
    });
    println!(
        "{} and {} bytes; merged {}",
        files[0].len(),
        files[1].len(),
        if same { "as in one run" } else { "otherwise" }
    );
    assert!(same, "shards have the numbers of the whole");
    Ok(())
}
