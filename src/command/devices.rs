//! `pairwave devices`

use pairwave::Result;
use pairwave::compute::gpu::{AdapterChoice, GpuCompute, adapters};
use pairwave::compute::{Compute, cpu::Cpu};

pub(crate) fn run() -> Result<()> {
    let mut text = format!("cpu        {}\n", Cpu::new(None)?.computed_by().device());
    let adapters = pairwave::control::wait(adapters());
    if adapters.is_empty() {
        text += "gpu        none: no Vulkan, Metal or D3D12 driver found; the native CPU path does everything\n";
    }
    for adapter in adapters {
        text += &format!("{:<10} {adapter}\n", adapter.index);
        let verdict = match pairwave::control::wait(GpuCompute::open(AdapterChoice::Index(adapter.index))) {
            Ok(gpu) => gpu.verdict().to_string(),
            Err(error) => format!("not usable: {error}"),
        };
        for line in verdict.lines() {
            text += &format!("{:10} {line}\n", "");
        }
    }
    super::print(&text)
}
