//! Tapers: functions of the window that points are weighted by, so that what the window cuts off leaks less into other
//! frequencies (Rajala, Olhede & Murrell 2020; Hawat, Gautier, Bardenet & Lachieze-Rey 2023).

/// The taper of a window's spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Taper {
    /// `1 / sqrt |W|` everywhere: Bartlett's periodogram.
    #[default]
    Bartlett,
    /// `prod_k sqrt(2 / L_k) sin(pi p_k x_k / L_k)`, x from the corner of the window.
    Sine,
}

impl std::fmt::Display for Taper {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Bartlett => "bartlett",
            Self::Sine => "sine",
        })
    }
}

/// How the transform of the taper, which the mean intensity brings in, is removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Debias {
    /// From the amplitude, before it is squared.
    #[default]
    Direct,
    /// Its square from the power: may fall below 0.
    Undirect,
    /// Not at all.
    None,
}

impl std::fmt::Display for Debias {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Direct => "direct",
            Self::Undirect => "undirect",
            Self::None => "none",
        })
    }
}
