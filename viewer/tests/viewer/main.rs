//! The window: what it ends with, what its controls do, how it looks, what it gives away, and that it opens.

#[path = "../common/mod.rs"]
mod common;

mod controls;
mod looks;
mod taking;
mod window;
mod worker;
