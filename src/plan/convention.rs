//! Whose grid, rings, labels and normalization the radial spectrum has.

/// A program whose published numbers are to be reproduced from the same points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Convention {
    /// Rings `[k - 1/2, k + 1/2)`, DC in none, independent modes counted once.
    #[default]
    Ours,
    /// PSA (Schloemer & Heck 2011), version 1.1.
    Psa,
    /// UTK, version 2.
    Utk,
    /// `pspec` of pbrt, version 4.
    Pspec,
}

impl std::fmt::Display for Convention {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Ours => "ours",
            Self::Psa => "psa",
            Self::Utk => "utk",
            Self::Pspec => "pspec",
        })
    }
}
