//! How a request is carried out: devices that fail, results that are looked at meanwhile.

#[path = "../common/mod.rs"]
mod common;

mod ahead;
mod envelope;
mod fallback;
mod measurement;
mod metamorphic;
mod mortal;
mod sources;
mod streaming;
mod survives;
mod targets;
