//! How a GPU cuts all pairs of a realization.

use std::fmt;

/// A workgroup holds a tile of points in registers, some to each invocation, and one tile after the other passes by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// Invocations of a workgroup.
    pub lanes: u32,
}

impl Tile {
    /// Points in registers per invocation.
    pub const POINTS_PER_LANE: u32 = 4;
    /// From this many points per realization on, there are enough tiles to fill a large GPU with wide workgroups.
    const WIDE_FROM_POINTS: u64 = 1 << 15;

    pub(super) const fn new(max_points: u64) -> Self {
        Self { lanes: if max_points >= Self::WIDE_FROM_POINTS { 128 } else { 64 } }
    }

    /// Points of a tile.
    pub const fn points(self) -> u32 {
        Self::POINTS_PER_LANE * self.lanes
    }
}

impl fmt::Display for Tile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tiles of {} points, {} to each invocation", self.points(), Self::POINTS_PER_LANE)
    }
}
