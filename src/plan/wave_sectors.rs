//! Sectors of direction: which of the modes in rings lie in which.

use super::{Rings, WaveVectors};
use crate::error::{Error, Result};
use crate::points::Domain;
use crate::setting::Setting;

/// Sectors where none are asked for: of 10 degrees.
pub const DEFAULT_SECTORS: usize = 18;
/// Most sectors: of a twentieth of a degree.
pub const MAX_SECTORS: usize = 3600;

/// Sectors of half a turn, for the modes of whole rings. Opposite directions are the same: P(-m) = P(m). The direction of a
/// mode is that of its frequency `nu = m / L`. Sector `s` of N is centred on `s / N` of half a turn, so that the x axis is a
/// centre and not a border.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sectors {
    /// Number of sectors, N.
    pub count: usize,
    /// Sector (1-based) of each stored mode, 0 for none; empty without sectors.
    pub sector_of: Vec<u32>,
    /// Members per sector (index `s`).
    pub modes: Vec<u64>,
}

impl Sectors {
    /// The sectors of a spectrum in two dimensions.
    ///
    /// # Errors
    /// Not two dimensions, no rings, or a number of sectors that cannot be.
    pub fn new(count: usize, waves: &WaveVectors, rings: &Rings, domain: &Domain) -> Result<Self> {
        if domain.dim() != 2 {
            let reason = format!("directions are followed in 2D, the points are in {}D", domain.dim());
            return Err(Error::setting(Setting::Sectors, count, reason));
        }
        if !(1..=MAX_SECTORS).contains(&count) {
            return Err(Error::setting(Setting::Sectors, count, format!("expected 1 to {MAX_SECTORS}")));
        }
        let sector = |index: usize| {
            let [x, y, _] = waves.frequency(index, domain);
            let turn = y.atan2(x) / std::f64::consts::PI;
            ((turn.rem_euclid(1.0) * count as f64 + 0.5).floor() as usize) % count
        };
        let mut modes = vec![0; count];
        let sector_of = (0..waves.len())
            .map(|index| {
                if rings.ring_of[index] == 0 {
                    return 0;
                }
                let s = sector(index);
                modes[s] += u64::from(rings.times[index]);
                s as u32 + 1
            })
            .collect();
        Ok(Self { count, sector_of, modes })
    }

    /// First, central and last direction of a sector, in radians from the x axis.
    pub fn bounds(&self, sector: usize) -> [f64; 3] {
        let step = std::f64::consts::PI / self.count as f64;
        [-0.5, 0.0, 0.5].map(|d| (sector as f64 + d) * step)
    }
}
