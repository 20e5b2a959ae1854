//! Whose grid, rings, labels and normalization the radial spectrum has. What each program does, and what is wrong with it:
//! `docs/conventions.md`.

use super::{Debias, WaveGrid, WavePlan};
use crate::error::{Error, Result};
use crate::named::named;
use crate::points::Domain;
use crate::setting::Setting;

/// A program whose published numbers are to be reproduced from the same points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Convention {
    /// Rings `[k - 1/2, k + 1/2)`, DC in none, independent modes counted once.
    #[default]
    Ours,
    /// PSA (Schloemer & Heck 2011), version 1.1: rings of width 2, DC in the first, left edges as labels.
    Psa,
    /// UTK, version 2: rings of width 2, DC in the first, left edges in units of n^(1/d) as labels.
    Utk,
    /// `pspec` of pbrt, version 4: rings [k, k + 1), DC in none.
    Pspec,
}

named!(Convention: Ours = "ours", Psa = "psa", Utk = "utk", Pspec = "pspec");

/// How rings are cut from a grid of half width F.
pub(super) struct RingRule {
    /// Which ring (from 0) holds a mode with this `|m|^2`.
    pub(super) ring: Box<dyn Fn(f64) -> usize>,
    /// Width of a ring in `|m|`.
    pub(super) width: f64,
    /// Rings, of which some may lie beyond the grid.
    pub(super) count: usize,
    /// What labels are divided by.
    pub(super) unit: f64,
    /// Whether DC is a member of its ring.
    pub(super) dc: bool,
}

impl Convention {
    /// The flag and everything that its program could not do.
    ///
    /// # Errors
    /// A domain that the program does not know, or defects of none.
    pub fn check(self, domain: &Domain, bug_compatible: bool) -> Result<()> {
        let fail = |reason: &str| Err(Error::setting(Setting::Convention, self, reason));
        match self {
            Self::Ours => {
                if bug_compatible {
                    let reason = "needs `convention` psa or utk: it copies the defects of that program";
                    return Err(Error::setting(Setting::BugCompatible, "(given)", reason));
                }
                return Ok(());
            }
            _ if !domain.is_torus() => return fail("is for a torus; a window has `taper` and `debias`"),
            _ if !domain.is_cubic() => return fail("is for a torus with equal sides"),
            Self::Psa | Self::Pspec if domain.dim() != 2 => return fail("that program knows two dimensions only"),
            _ => {}
        }
        if bug_compatible && self == Self::Pspec {
            let reason =
                "no defect of pspec shows in numbers that the same points determine; expected `convention` psa or utk";
            return Err(Error::setting(Setting::BugCompatible, "(given)", reason));
        }
        Ok(())
    }

    /// Half the width of its grid for n points, as it computes it: PSA in single precision.
    pub fn max_frequency(self, n: u64) -> Option<u32> {
        match self {
            Self::Ours => None,
            Self::Psa => Some((10f32 / (2f32 / (n as f32).sqrt())) as u32),
            Self::Utk => Some((10.0 * (n as f64).sqrt()) as u32).map(|width| width.saturating_sub(1) / 2),
            Self::Pspec => Some(750),
        }
    }

    /// Its rings on a grid; `None` for ours.
    pub(super) fn rings(self, grid: &WaveGrid, n: u64) -> Option<RingRule> {
        let f = grid.max_frequency()[0];
        let half = f64::from(f);
        let rule = |ring, width, count, unit, dc| Some(RingRule { ring, width, count, unit, dc });
        match self {
            Self::Ours => None,
            Self::Psa => {
                let count = f / 2;
                let width = f as f32 / count as f32;
                let ring = move |squared: f64| ((squared as f32).sqrt() / width) as usize;
                rule(Box::new(ring), half / f64::from(count), count as usize, 1.0, true)
            }
            Self::Utk => {
                let width = 2.0 * half + 1.0;
                let count = (width * (width - 1.0)).sqrt() as usize / 2;
                let unit = (n as f64).powf(1.0 / grid.dim() as f64);
                rule(Box::new(|squared| (0.5 * squared.sqrt()) as usize), 2.0, count, unit, true)
            }
            Self::Pspec => rule(Box::new(|squared| squared.sqrt() as usize), 1.0, f as usize, 1.0, false),
        }
    }

    /// Bins of its g for n points on the unit torus: how many, and their width, an eighth of n up to 8 closest-packing
    /// distances, as PSA computes them in single precision; `None` where g is ours.
    pub fn pair_bins(self, n: u64) -> Option<(usize, f64)> {
        let bins = (0.125f32 * n as f32) as usize;
        let packed = (2.0 / (3f64.sqrt() * n as f64)) as f32;
        let r_max = 8f32 / (1f32 / packed.sqrt());
        (self == Self::Psa).then(|| (bins, f64::from(r_max / bins.max(1) as f32)))
    }

    /// What the columns `nu_lo`, `nu` and `nu_hi` are.
    pub fn labels(self) -> &'static str {
        match self {
            Self::Ours => "cycles per unit length; nu is the centre of its ring",
            Self::Psa => "cycles per side; nu is the left edge of its ring",
            Self::Utk => "cycles per side divided by n^(1/d); nu is the left edge of its ring",
            Self::Pspec => "cycles per side; nu is the left edge of its ring",
        }
    }

    /// What the column `r` of g is.
    pub fn pair_labels(self) -> &'static str {
        match self {
            Self::Psa => "r is the left edge of its bin",
            _ => "r is the centre of its bin",
        }
    }

    /// Whether the last plane along each axis of a symmetric grid is not part of its own, which is `-F ..= F - 1`.
    pub fn lacks_last_plane(self) -> bool {
        self == Self::Psa
    }
}

impl WavePlan {
    /// The same with the rings of another program, and of its defects those in the rings.
    ///
    /// # Errors
    /// As `Convention::check`.
    pub fn with_convention(self, convention: Convention, bug_compatible: bool) -> Result<Self> {
        convention.check(&self.domain, bug_compatible)?;
        let Some(grid) = self.waves.grid() else { return Ok(self) };
        let f = &grid.max_frequency()[..grid.dim()];
        if convention != Convention::Ours && (f.iter().any(|&k| k != f[0]) || f[0] < 2) {
            let given = f.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
            let reason = "`convention` needs one number for all axes, and at least 2";
            return Err(Error::setting(Setting::MaxFrequency, given, reason));
        }
        let rings = match convention.rings(grid, self.shape.max_points) {
            Some(rule) => super::Rings::by(&rule, grid, bug_compatible && convention == Convention::Utk),
            None => return Ok(self),
        };
        Ok(Self { rings, convention, bug_compatible, ..self })
    }

    /// Whether P(0) is set to 0: by UTK, and by the debiasing of a window whose P is otherwise the plain periodogram.
    pub fn dc_cleared(&self) -> bool {
        let debiased = self.tapered().is_none() && self.taper.is_some_and(|t| t.debias != Debias::None);
        debiased || self.bug_compatible && self.convention == Convention::Utk
    }
}
