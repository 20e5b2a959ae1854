//! One point, or a law, per stratum.

pub(super) mod cell;
pub(super) mod jittered;
pub(super) mod lhs;
pub(super) mod multi_jittered;
