//! What all else trusts: the definitions, worked by hand and against closed forms; comparators that can fail; laws without a
//! reference; samplers.

#[path = "../common/mod.rs"]
mod common;

mod by_hand;
mod comparison_can_fail;
mod coordinates;
mod counts;
mod discrepancy;
mod importance;
mod integrals;
mod integrands;
mod integration;
mod integration_warp;
mod intensity;
mod laws;
mod polygon;
mod samplers;
