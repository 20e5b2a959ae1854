//! The viewer: points, g(r) and P(nu), live. A window over the library: it edits `Request`s, hands them to a worker that
//! measures step by step, and draws the `Analysis` that comes back. It holds no arithmetic of its own; what is drawn, and the
//! text of what is under the pointer, comes from `pairwave::display`.
//!
//! ```text
//! controls -> Request -> worker (Engine: Measurement per set) -> Snapshot -> panels
//! ```
//!
//! Whatever is drawn borrows the `State` and answers with `Action`s; `app` alone carries them out.

#![warn(unreachable_pub, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod actions;
pub mod app;
mod colors;
mod controls;
pub mod engine;
mod export;
pub mod files;
pub mod help;
mod hover;
pub mod icon;
mod messages;
mod numbers;
mod offscreen;
mod panels;
pub mod session;
mod set;
mod state;
mod status;
mod style;
mod svg;
pub mod view;
pub mod worker;
