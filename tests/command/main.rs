//! The commands end to end, on files: what a user types, what appears, what is said when it is wrong. Trusts the
//! library's own tests for the numbers; checks that the right ones reach the files.

#[path = "../common/mod.rs"]
mod common;

mod analyze;
mod batches;
mod bench;
mod broken_files;
mod compare;
mod config;
mod convention;
mod convergence;
mod envelope;
mod errors;
mod examples;
mod first_order;
mod listings;
mod numbers;
mod pair_correlation;
mod plot;
mod polygon;
mod power_spectrum;
mod reads;
mod request;
mod results;
mod scan;
mod shared;
mod survey;
mod taper;
mod vector_correlation;
