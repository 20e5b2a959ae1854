//! Whose grid, rings, labels and normalization the radial spectrum has. What each program does, and what is wrong with it:
//! `docs/conventions.md`.

use std::fmt;

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

/// Everything in which programs differ, resolved once from a convention: no other module asks whose it is.
#[derive(Clone, Copy)]
pub struct Conventions {
    /// Whose they are.
    pub of: Convention,
    /// Whether the defects of that program are copied too.
    pub bug_compatible: bool,
    /// Whether rings and labels are not ours: closed forms, sectors and what else is read off our own do not apply.
    pub foreign: bool,
    /// What the columns `nu_lo`, `nu` and `nu_hi` are.
    pub labels: &'static str,
    /// What the column `r` of g is.
    pub pair_labels: &'static str,
    /// Whether g has bins of its own, its labels, and statistics that are read off distances.
    pub pairs: bool,
    /// How the spread within a ring is taken.
    pub anisotropy: AnisotropyRule,
    /// Whether the last plane along each axis of a symmetric grid is not part of its own, which is `-F ..= F - 1`.
    pub lacks_last_plane: bool,
    /// Whether P(0) is set to 0.
    pub dc_cleared: bool,
    /// Whether the program knows two dimensions only.
    planar: bool,
    /// Why there are no defects to copy, where there are none.
    flawless: Option<&'static str>,
    max_frequency: fn(u64) -> Option<u32>,
    rings: Option<fn(&WaveGrid, u64) -> RingRule>,
}

/// How the anisotropy of a ring is taken from its modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnisotropyRule {
    /// Over its independent modes, beside -10 log10 K.
    Independent,
    /// Over all of them, opposite ones twice; by PSA, whose defects make it 0 where a ring is not resolved, and the reference
    /// of K > 1 realizations -K.
    AllModes,
    /// It is not printed.
    Absent,
}

const OURS: Conventions = Conventions {
    of: Convention::Ours,
    bug_compatible: false,
    foreign: false,
    labels: "cycles per unit length; nu is the centre of its ring",
    pair_labels: "r is the centre of its bin",
    pairs: false,
    anisotropy: AnisotropyRule::Independent,
    lacks_last_plane: false,
    dc_cleared: false,
    planar: false,
    flawless: Some("needs `convention` psa or utk: it copies the defects of that program"),
    max_frequency: |_| None,
    rings: None,
};

const PSA: Conventions = Conventions {
    of: Convention::Psa,
    foreign: true,
    labels: "cycles per side; nu is the left edge of its ring",
    pair_labels: "r is the left edge of its bin",
    pairs: true,
    anisotropy: AnisotropyRule::AllModes,
    lacks_last_plane: true,
    planar: true,
    flawless: None,
    // In single precision, as it computes it.
    max_frequency: |n| Some((10f32 / (2f32 / (n as f32).sqrt())) as u32),
    rings: Some(|grid, _| {
        let f = grid.max_frequency()[0];
        let count = f / 2;
        let width = f as f32 / count as f32;
        let ring = move |squared: f64| ((squared as f32).sqrt() / width) as usize;
        RingRule {
            ring: Box::new(ring),
            width: f64::from(f) / f64::from(count),
            count: count as usize,
            unit: 1.0,
            dc: true,
        }
    }),
    ..OURS
};

const UTK: Conventions = Conventions {
    of: Convention::Utk,
    foreign: true,
    labels: "cycles per side divided by n^(1/d); nu is the left edge of its ring",
    anisotropy: AnisotropyRule::Absent,
    flawless: None,
    max_frequency: |n| Some(((10.0 * (n as f64).sqrt()) as u32).saturating_sub(1) / 2),
    rings: Some(|grid, n| {
        let width = 2.0 * f64::from(grid.max_frequency()[0]) + 1.0;
        RingRule {
            ring: Box::new(|squared| (0.5 * squared.sqrt()) as usize),
            width: 2.0,
            count: (width * (width - 1.0)).sqrt() as usize / 2,
            unit: (n as f64).powf(1.0 / grid.dim() as f64),
            dc: true,
        }
    }),
    ..OURS
};

const PSPEC: Conventions = Conventions {
    of: Convention::Pspec,
    foreign: true,
    labels: "cycles per side; nu is the left edge of its ring",
    anisotropy: AnisotropyRule::Absent,
    planar: true,
    flawless: Some(
        "no defect of pspec shows in numbers that the same points determine; expected `convention` psa or utk",
    ),
    max_frequency: |_| Some(750),
    rings: Some(|grid, _| RingRule {
        ring: Box::new(|squared| squared.sqrt() as usize),
        width: 1.0,
        count: grid.max_frequency()[0] as usize,
        unit: 1.0,
        dc: false,
    }),
    ..OURS
};

impl Convention {
    /// What it decides; with `bug_compatible`, the defects of its program too.
    pub const fn resolve(self, bug_compatible: bool) -> Conventions {
        let mut all = match self {
            Self::Ours => OURS,
            Self::Psa => PSA,
            Self::Utk => UTK,
            Self::Pspec => PSPEC,
        };
        all.bug_compatible = bug_compatible;
        all.dc_cleared = bug_compatible && matches!(self, Self::Utk);
        all
    }
}

impl Default for Conventions {
    fn default() -> Self {
        OURS
    }
}

impl fmt::Debug for Conventions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.of, if self.bug_compatible { ", with its defects" } else { "" })
    }
}

impl PartialEq for Conventions {
    fn eq(&self, other: &Self) -> bool {
        (self.of, self.bug_compatible) == (other.of, other.bug_compatible)
    }
}

impl Conventions {
    /// Refuses what its program could not do.
    ///
    /// # Errors
    /// A domain that the program does not know, or defects of none.
    pub fn check(&self, domain: &Domain) -> Result<()> {
        let fail = |reason: &str| Err(Error::setting(Setting::Convention, self.of, reason));
        match self {
            Self { foreign: true, .. } if !domain.is_torus() => {
                fail("is for a torus; a window has `taper` and `debias`")
            }
            Self { foreign: true, .. } if !domain.is_cubic() => fail("is for a torus with equal sides"),
            Self { planar: true, .. } if domain.dim() != 2 => fail("that program knows two dimensions only"),
            Self { bug_compatible: true, flawless: Some(reason), .. } => {
                Err(Error::setting(Setting::BugCompatible, "(given)", *reason))
            }
            _ => Ok(()),
        }
    }

    /// The unit of its frequencies.
    pub fn unit(&self) -> &'static str {
        self.labels.split(';').next().unwrap_or_default()
    }

    /// Half the width of its grid for n points, as it computes it; `None` for ours.
    pub fn max_frequency(&self, n: u64) -> Option<u32> {
        (self.max_frequency)(n)
    }

    /// Bins of its g for n points on the unit torus: how many, and their width, an eighth of n up to 8 closest-packing
    /// distances, as PSA computes them in single precision; `None` where g is ours.
    pub fn pair_bins(&self, n: u64) -> Option<(usize, f64)> {
        let bins = (0.125f32 * n as f32) as usize;
        let packed = (2.0 / (3f64.sqrt() * n as f64)) as f32;
        let r_max = 8f32 / (1f32 / packed.sqrt());
        self.pairs.then(|| (bins, f64::from(r_max / bins.max(1) as f32)))
    }
}

impl WavePlan {
    /// The same with the rings of another program, and of its defects those in the rings.
    ///
    /// # Errors
    /// As [`Conventions::check`]; a grid with another half width per axis, or less than 2.
    pub fn with_conventions(self, conventions: Conventions) -> Result<Self> {
        conventions.check(&self.domain)?;
        let Some((rings, grid)) = conventions.rings.zip(self.waves.grid()) else { return Ok(self) };
        let f = &grid.max_frequency()[..grid.dim()];
        if f.iter().any(|&k| k != f[0]) || f[0] < 2 {
            let given = f.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
            let reason = "`convention` needs one number for all axes, and at least 2";
            return Err(Error::setting(Setting::MaxFrequency, given, reason));
        }
        let rings = super::Rings::by(&rings(grid, self.shape.max_points), grid, conventions.dc_cleared);
        Ok(Self { rings, conventions, ..self })
    }

    /// Whether P(0) is set to 0: by UTK, and by the debiasing of a window whose P is otherwise the plain periodogram.
    pub fn dc_cleared(&self) -> bool {
        let debiased = self.tapered().is_none() && self.taper.is_some_and(|t| t.debias != Debias::None);
        debiased || self.conventions.dc_cleared
    }
}
