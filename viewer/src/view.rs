//! How things are shown: nothing here is ever measured anew.

use pairwave::display::ColorMap;
use pairwave::display::Panel;
use pairwave::display::ToneMap;
use pairwave::display::{AxisScale, FrequencyUnit, LengthUnit};
use serde::{Deserialize, Serialize};

/// Everything about the looks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct View {
    /// Panels that are shown, and so computed.
    pub panels: Vec<Panel>,
    /// The panel that fills the window.
    pub maximized: Option<Panel>,
    /// Pictures of several sets, side by side; else of the selected one.
    pub side_by_side: bool,
    /// Unit of distances.
    pub length_unit: LengthUnit,
    /// Unit of frequencies.
    pub frequency_unit: FrequencyUnit,
    /// Along r.
    pub r_scale: AxisScale,
    /// Along nu.
    pub nu_scale: AxisScale,
    /// Of g.
    pub g_scale: AxisScale,
    /// Of P.
    pub p_scale: AxisScale,
    /// Whether curves have their error bands.
    pub bands: bool,
    /// Whether curves have their closed forms.
    pub closed_forms: bool,
    /// Spectra as papers print them: tones, colours, unit and range of frequencies and anisotropy are theirs.
    pub paper: bool,
    /// Of the 2D spectrum.
    pub tone_map: ToneMap,
    /// Of the 2D spectrum.
    pub spectrum_colors: ColorMap,
    /// Of the vector g.
    pub vector_colors: ColorMap,
    /// Whether the controls are there.
    pub controls: bool,
    /// Whether the scalars of all sets are there.
    pub numbers: bool,
    /// Which pair of axes of a 3D set.
    pub plane: usize,
    /// Points: copies around the torus.
    pub tiling: bool,
    /// Points: their indices.
    pub indices: bool,
    /// Points: the strata of a square number of them.
    pub strata: bool,
    /// Points: each linked to its nearest neighbour.
    pub links: bool,
    /// Points: the integrand below them.
    pub integrand_below: bool,
    /// Integration: what is drawn.
    pub integrals: Integrals,
    /// P(m): in its place what every frequency adds to the variance of an integral.
    pub attribution: bool,
    /// Which of the integrands of a set is drawn where there is room for one.
    pub integrand: usize,
    /// Light or dark.
    pub theme: Theme,
}

/// What is drawn of integrals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrals {
    /// Predicted and observed variances.
    #[default]
    Errors,
    /// Which frequencies the variance comes from.
    Frequencies,
    /// At which distances correlation acts.
    Distances,
    /// Variances against the number of points.
    Numbers,
}

impl Integrals {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Errors, Self::Frequencies, Self::Distances, Self::Numbers];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Errors => "variance",
            Self::Frequencies => "by frequency",
            Self::Distances => "by distance",
            Self::Numbers => "against n",
        }
    }
}

/// Light or dark.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Theme {
    /// As the desktop has it.
    #[default]
    System,
    /// Light.
    Light,
    /// Dark.
    Dark,
}

impl Theme {
    /// The one that follows it, round and round.
    pub(crate) fn next(self) -> Self {
        let at = Self::ALL.iter().position(|theme| *theme == self).unwrap_or_default();
        Self::ALL[(at + 1) % Self::ALL.len()]
    }

    /// All of them.
    pub const ALL: [Self; 3] = [Self::System, Self::Light, Self::Dark];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::System => "as the desktop",
            Self::Light => "light",
            Self::Dark => "dark",
        }
    }
}

impl View {
    /// Has a panel among those that are shown.
    pub(crate) fn show(&mut self, panel: Panel) {
        if !self.panels.contains(&panel) {
            self.panels.push(panel);
        }
    }

    /// Whether a panel is on the screen.
    pub(crate) fn is_shown(&self, panel: Panel) -> bool {
        match self.maximized {
            Some(one) => one == panel,
            None => self.panels.contains(&panel),
        }
    }
}

impl Default for View {
    fn default() -> Self {
        Self {
            panels: Panel::ALL.to_vec(),
            maximized: None,
            side_by_side: false,
            length_unit: LengthUnit::Box,
            frequency_unit: FrequencyUnit::Cycles,
            r_scale: AxisScale::Linear,
            nu_scale: AxisScale::Linear,
            g_scale: AxisScale::Linear,
            p_scale: AxisScale::Linear,
            bands: true,
            closed_forms: true,
            paper: false,
            tone_map: ToneMap::default(),
            spectrum_colors: ColorMap::SEQUENTIAL[0],
            vector_colors: ColorMap::DIVERGING[0],
            controls: true,
            numbers: false,
            plane: 0,
            tiling: false,
            indices: false,
            strata: false,
            links: false,
            integrand_below: false,
            integrals: Integrals::default(),
            attribution: false,
            integrand: 0,
            theme: Theme::System,
        }
    }
}
