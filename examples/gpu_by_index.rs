//! Exact pair counts on a GPU chosen by its index; without one on the CPU, which gives the same integers.

use pairwave::compute::gpu::adapters;
use pairwave::request::{DeviceChoice, PointsRequest};
use pairwave::{Device, Error, Points, Request, Result, Statistic, measure};

fn main() -> Result<()> {
    for adapter in pairwave::control::wait(adapters()) {
        println!("{}: {adapter}", adapter.index);
    }
    let wanted = std::env::args().nth(1).and_then(|index| index.parse().ok()).unwrap_or(0);
    let device = match pairwave::control::wait(Device::open(DeviceChoice::Index(wanted), None)) {
        Ok(_) => DeviceChoice::Index(wanted),
        Err(Error::NoDevice { reason, .. }) => {
            println!("no GPU {wanted}: {reason}");
            DeviceChoice::Cpu
        }
        Err(other) => return Err(other),
    };
    let input = PointsRequest {
        sampler: Some("jittered".into()),
        points: Some(1024),
        realizations: Some(10),
        ..PointsRequest::default()
    };
    let request = Request { input, stats: vec![Statistic::Pcf], device, ..Request::default() };
    let found = measure(Points::open(&request.input)?, &request)?;
    println!("by {}", found.computed_by.device());
    if let Some(g) = found.pair_correlation() {
        println!("{} ordered pairs closer than {:.4}", g.count.iter().sum::<u64>(), g.r_hi[g.r_hi.len() - 1]);
    }
    Ok(())
}
