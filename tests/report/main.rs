//! What is written and what is shown.

#[path = "../common/mod.rs"]
mod common;

mod comparison;
mod files;
mod panels;
