//! What a viewer needs behind its window: measurements that go on while they are looked at, and while their settings change.
//!
//! ```text
//! Request -> Worker (a thread; Engine: one `Running` per set) -> Snapshot
//! ```

#![warn(unreachable_pub, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod engine;
pub mod worker;
