//! The GPU against the definitions, and its shaders. A room of its own, because it needs a driver.

#[path = "../common/mod.rs"]
mod common;

mod device;
mod integration;
mod lag_counts;
mod pair_counts;
mod shader_layouts;
mod shaders_valid;
mod shared;
mod spirv;
mod wave_power;
