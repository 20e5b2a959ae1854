//! Units and scales of axes: from a value of the analysis to where it is drawn, and back.

use super::words::packing_symbol;
use super::{escape, human, ticks};
use crate::estimate::Analysis;
use crate::plan::Conventions;
use crate::points::{Domain, UnitName};

/// Units under the name that the length unit has, if it has one.
#[derive(Debug, Clone)]
pub(crate) struct Units {
    /// `µm`, else `length units`.
    pub(crate) length: String,
    /// `µm`, else `length units of the domain`.
    pub(crate) own_length: String,
    /// `cycles per µm`, else `cycles per unit length`.
    pub(crate) cycles: String,
    /// Of rings, by whose convention.
    pub(crate) rings: String,
}

impl Units {
    /// Those of an analysis, as plain text.
    pub(crate) fn of(analysis: &Analysis) -> Self {
        Self::new(analysis.unit, &analysis.conventions)
    }

    /// Under this name, with our own rings.
    pub(crate) fn named(unit: Option<UnitName>) -> Self {
        Self::new(unit, &Conventions::default())
    }

    /// As plain text.
    pub(crate) fn new(unit: Option<UnitName>, conventions: &Conventions) -> Self {
        let rings = per_own(conventions.unit(), unit);
        Self {
            length: unit.map_or(LENGTH_UNITS.into(), |unit| unit.to_string()),
            own_length: unit.map_or(format!("{LENGTH_UNITS} of the domain"), |unit| unit.to_string()),
            cycles: per_own(CYCLES, unit),
            rings: if conventions.foreign { format!("{rings}; rings of {}", conventions.of) } else { rings },
        }
    }

    /// The same as SVG text or HTML.
    pub(crate) fn escaped(self) -> Self {
        let Self { length, own_length, cycles, rings } = self;
        Self {
            length: escape(&length),
            own_length: escape(&own_length),
            cycles: escape(&cycles),
            rings: escape(&rings),
        }
    }
}

/// What a length unit without a name is called.
const LENGTH_UNITS: &str = "length units";
const UNIT_LENGTH: &str = "unit length";
const CYCLES: &str = "cycles per unit length";

/// A text with the unit length under its name.
fn per_own(text: &str, name: Option<UnitName>) -> String {
    name.map_or(text.into(), |name| text.replace(UNIT_LENGTH, name.as_str()))
}

/// The unit of distances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LengthUnit {
    /// The domain's own length unit.
    #[default]
    Box,
    /// The distance between neighbours in the closest packing of as many points (`Domain::closest_packing_distance`): hexagonal
    /// in 2D, face-centred cubic in 3D, even spacing in 1D.
    PackingDistance,
}

impl LengthUnit {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Box, Self::PackingDistance];

    /// Its length in the domain's own unit, for `n` points.
    pub fn size(self, domain: &Domain, n: f64) -> f64 {
        match self {
            Self::Box => 1.0,
            Self::PackingDistance => domain.closest_packing_distance(n),
        }
    }

    /// Its symbol: the name of the domain's own unit, if it has one; `d_hex` in 2D, `d_fcc` in 3D, `d_even` in 1D.
    pub fn symbol(self, dim: usize, name: Option<UnitName>) -> String {
        match self {
            Self::Box => name.map_or(LENGTH_UNITS.into(), |name| name.to_string()),
            Self::PackingDistance => {
                let (base, index) = packing_symbol(dim);
                format!("{base}_{index}")
            }
        }
    }
}

/// The unit of frequencies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FrequencyUnit {
    /// Cycles per length unit of the domain; on a unit torus, cycles per side.
    #[default]
    Cycles,
    /// One cycle per mean spacing of the points, `lambda^(1/d)` with intensity `lambda = n / |D|`: on a unit torus in 2D the root
    /// of n.
    SqrtN,
}

impl FrequencyUnit {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Cycles, Self::SqrtN];

    /// Its frequency in cycles per length unit of the domain, for `n` points.
    pub fn size(self, domain: &Domain, n: f64) -> f64 {
        match self {
            Self::Cycles => 1.0,
            Self::SqrtN => (n / domain.measure()).powf(1.0 / domain.dim() as f64),
        }
    }

    /// Its symbol: cycles per length unit, by its name if it has one; `√n`, where the domain's measure is 1; else `√λ`.
    pub fn symbol(self, domain: &Domain, name: Option<UnitName>) -> String {
        let base = if domain.measure() == 1.0 { "n" } else { "λ" };
        match (self, domain.dim()) {
            (Self::Cycles, _) => per_own(CYCLES, name),
            (Self::SqrtN, 1) => base.into(),
            (Self::SqrtN, 2) => format!("√{base}"),
            (Self::SqrtN, _) => format!("∛{base}"),
        }
    }
}

/// How values are laid out along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AxisScale {
    /// Evenly.
    #[default]
    Linear,
    /// By their decimal logarithm.
    Log,
    /// By `10 log10` of them, in dB.
    Decibel,
}

impl AxisScale {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Linear, Self::Log, Self::Decibel];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Log => "log",
            Self::Decibel => "dB",
        }
    }
}

/// What is along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Quantity {
    Distance {
        unit: LengthUnit,
        dim: usize,
        name: Option<UnitName>,
    },
    Frequency {
        unit: FrequencyUnit,
        dim: usize,
        of_unit_measure: bool,
        name: Option<UnitName>,
    },
    /// Of another program's rings, with its unit.
    ForeignFrequency(&'static str, Option<UnitName>),
    Dimensionless(&'static str),
    /// A symbol, and what it is.
    Named(&'static str, &'static str),
    Decibels(&'static str),
}

/// An axis: what is drawn along it, in which unit and on which scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    quantity: Quantity,
    /// Of a component, its name in place of that of the length: `x`, `h_x`, `ν_x`.
    component: Option<&'static str>,
    /// One unit of the axis, in units of the analysis.
    unit: f64,
    /// What is 0 on the axis, in units of the analysis.
    zero: f64,
    scale: AxisScale,
}

impl Axis {
    /// Distances r of an analysis.
    pub fn distance(analysis: &Analysis, unit: LengthUnit, scale: AxisScale) -> Self {
        let domain = &analysis.domain;
        let quantity = Quantity::Distance { unit, dim: domain.dim(), name: analysis.unit };
        Self { quantity, component: None, unit: unit.size(domain, analysis.shape.mean_points), zero: 0.0, scale }
    }

    /// Frequencies nu of an analysis; those of another program's rings stay in its own unit.
    pub fn frequency(analysis: &Analysis, unit: FrequencyUnit, scale: AxisScale) -> Self {
        let domain = &analysis.domain;
        if analysis.conventions.foreign {
            let quantity = Quantity::ForeignFrequency(analysis.conventions.unit(), analysis.unit);
            return Self { quantity, component: None, unit: 1.0, zero: 0.0, scale };
        }
        let quantity = Quantity::Frequency {
            unit,
            dim: domain.dim(),
            of_unit_measure: domain.measure() == 1.0,
            name: analysis.unit,
        };
        Self { quantity, component: None, unit: unit.size(domain, analysis.shape.mean_points), zero: 0.0, scale }
    }

    /// Coordinates of points along an axis of the domain.
    pub fn coordinate(analysis: &Analysis, unit: LengthUnit, axis: usize) -> Self {
        let name = ["x", "y", "z"].get(axis).copied();
        Self { component: name, ..Self::distance(analysis, unit, AxisScale::Linear) }
    }

    /// Lags along an axis of the domain.
    pub fn lag(analysis: &Analysis, unit: LengthUnit, axis: usize) -> Self {
        let name = ["h_x", "h_y", "h_z"].get(axis).copied();
        Self { component: name, ..Self::distance(analysis, unit, AxisScale::Linear) }
    }

    /// Components of frequencies along an axis of the domain.
    pub fn wave(analysis: &Analysis, unit: FrequencyUnit, axis: usize) -> Self {
        let name = ["ν_x", "ν_y", "ν_z"].get(axis).copied();
        Self { component: name, ..Self::frequency(analysis, unit, AxisScale::Linear) }
    }

    /// Under a name of its own.
    pub(crate) fn named(symbol: &'static str, label: &'static str, scale: AxisScale) -> Self {
        Self { quantity: Quantity::Named(symbol, label), component: None, unit: 1.0, zero: 0.0, scale }
    }

    /// Values of g.
    pub fn g(scale: AxisScale) -> Self {
        Self { quantity: Quantity::Dimensionless("g"), component: None, unit: 1.0, zero: 0.0, scale }
    }

    /// Values of P.
    pub fn p(scale: AxisScale) -> Self {
        Self { quantity: Quantity::Dimensionless("P"), component: None, unit: 1.0, zero: 0.0, scale }
    }

    /// Anisotropy, which is in dB already.
    pub fn anisotropy() -> Self {
        Self {
            quantity: Quantity::Decibels("anisotropy"),
            component: None,
            unit: 1.0,
            zero: 0.0,
            scale: AxisScale::Linear,
        }
    }

    /// Anisotropy above that of an isotropic spectrum, `-10 log10 K` dB.
    pub fn anisotropy_above(analysis: &Analysis) -> Self {
        let zero = analysis.radial().map_or(0.0, |radial| radial.anisotropy_reference_db);
        Self { quantity: Quantity::Decibels("anisotropy above isotropic"), zero, ..Self::anisotropy() }
    }

    /// The scale.
    pub fn scale(self) -> AxisScale {
        self.scale
    }

    /// A value of the analysis in the unit of the axis.
    pub fn in_unit(self, value: f64) -> f64 {
        (value - self.zero) / self.unit
    }

    /// Where a value of the analysis is drawn; `None` where that is undefined, as the logarithm of 0 is.
    pub fn forward(self, value: f64) -> Option<f64> {
        let value = self.in_unit(value);
        let drawn = match self.scale {
            AxisScale::Linear => value,
            AxisScale::Log => value.log10(),
            AxisScale::Decibel => 10.0 * value.log10(),
        };
        drawn.is_finite().then_some(drawn)
    }

    /// The value that is drawn there.
    pub fn backward(self, drawn: f64) -> Option<f64> {
        let value = match self.scale {
            AxisScale::Linear => drawn,
            AxisScale::Log => 10f64.powf(drawn),
            AxisScale::Decibel => 10f64.powf(drawn / 10.0),
        };
        Some(value * self.unit + self.zero).filter(|v| v.is_finite())
    }

    /// Round numbers between two drawn places, about `target` of them: where they are drawn, and their text.
    pub fn ticks(self, low: f64, high: f64, target: u32) -> Vec<(f64, String)> {
        match self.scale {
            AxisScale::Log if high - low < 300.0 && low.abs().max(high.abs()) < 300.0 => {
                let decades = ticks::log_ticks(&(10f64.powf(low)..10f64.powf(high)));
                decades.into_iter().map(|(t, text)| (t.log10(), text)).collect()
            }
            AxisScale::Log => Vec::new(),
            AxisScale::Linear | AxisScale::Decibel => ticks::ticks(&(low..high), target),
        }
    }

    /// What is along the axis: `r`, `r / d_hex`, `ν / √n`, `g`; of a component `x`, `h_x / d_hex`.
    pub fn symbol(self) -> String {
        let named = |whole: &'static str| self.component.unwrap_or(whole);
        match self.quantity {
            Quantity::Distance { unit: LengthUnit::Box, .. } => named("r").into(),
            Quantity::Distance { unit, dim, .. } => format!("{} / {}", named("r"), unit.symbol(dim, None)),
            Quantity::Frequency { unit: FrequencyUnit::Cycles, .. } | Quantity::ForeignFrequency(..) => {
                named("ν").into()
            }
            Quantity::Frequency { dim, of_unit_measure, .. } => {
                let root = ["", "√", "∛"][(dim - 1).min(2)];
                format!("{} / {root}{}", named("ν"), if of_unit_measure { "n" } else { "λ" })
            }
            Quantity::Dimensionless(name) | Quantity::Named(name, _) | Quantity::Decibels(name) => name.into(),
        }
    }

    /// The text along the axis: what it is, and its unit.
    pub fn label(self) -> String {
        let symbol = self.symbol();
        let (distance, frequency) = if self.component.is_some() { ("", "") } else { ("distance ", "frequency ") };
        match (self.scale, self.quantity) {
            (AxisScale::Decibel, _) => format!("10 log10({symbol}) (dB)"),
            (_, Quantity::Decibels(_)) => format!("{symbol} (dB)"),
            (_, Quantity::Distance { unit: LengthUnit::Box, .. }) => {
                format!("{distance}{symbol} ({})", self.unit_text())
            }
            (_, Quantity::Distance { .. }) => format!("{distance}{symbol} (closest packing = 1)"),
            (_, Quantity::Frequency { unit: FrequencyUnit::Cycles, .. } | Quantity::ForeignFrequency(..)) => {
                format!("{frequency}{symbol} ({})", self.unit_text())
            }
            (_, Quantity::Frequency { .. }) => format!("{frequency}{symbol} (cycles per mean spacing)"),
            (_, Quantity::Dimensionless(_)) => format!("{symbol} (dimensionless)"),
            (_, Quantity::Named(_, label)) => label.into(),
        }
    }

    /// The same where there is little room: `r (length units)`, `ν / √n`, `P (dB)`.
    pub fn short_label(self) -> String {
        let symbol = self.symbol();
        match (self.scale, self.quantity) {
            (
                AxisScale::Decibel,
                Quantity::Distance { .. } | Quantity::Frequency { .. } | Quantity::ForeignFrequency(..),
            ) => {
                format!("10 log10({symbol}) (dB)")
            }
            (AxisScale::Decibel, _) | (_, Quantity::Decibels(_)) => format!("{symbol} (dB)"),
            _ if self.unit_text().is_empty() => symbol,
            _ => format!("{symbol} ({})", self.unit_text()),
        }
    }

    /// Its unit, if that has a name of its own.
    fn unit_text(self) -> String {
        match self.quantity {
            Quantity::Distance { unit: LengthUnit::Box, name, .. } => {
                name.map_or(LENGTH_UNITS.into(), |n| n.to_string())
            }
            Quantity::Frequency { unit: FrequencyUnit::Cycles, name, .. } => per_own(CYCLES, name),
            Quantity::ForeignFrequency(unit, name) => per_own(unit, name),
            Quantity::Decibels(_) => "dB".into(),
            _ => String::new(),
        }
    }

    /// A value of the analysis with what it is and its unit: `r / d_hex = 0.9804`, `r = 0.03 length units`.
    pub fn text(self, value: f64) -> String {
        format!("{} = {} {}", self.symbol(), human(self.in_unit(value)), self.unit_text()).trim_end().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(unit: f64, scale: AxisScale) -> Axis {
        Axis { quantity: Quantity::Dimensionless("P"), component: None, unit, zero: 0.0, scale }
    }

    #[test]
    fn scales_have_their_landmarks() {
        assert_eq!(axis(1.0, AxisScale::Decibel).forward(10.0), Some(10.0));
        assert_eq!(axis(2.0, AxisScale::Decibel).forward(2.0), Some(0.0));
        assert_eq!(axis(1.0, AxisScale::Log).forward(1000.0).map(f64::round), Some(3.0));
        for scale in [AxisScale::Log, AxisScale::Decibel] {
            assert_eq!([0.0, -1.0, f64::NAN].map(|v| axis(1.0, scale).forward(v)), [None; 3]);
        }
        assert_eq!(axis(1.0, AxisScale::Log).backward(400.0), None);
    }

    #[test]
    fn what_is_drawn_reads_back() {
        for scale in AxisScale::ALL {
            for value in [1e-9, 0.3, 1.0, 77.0, 1e12] {
                let axis = axis(0.033, scale);
                let back = axis.forward(value).and_then(|drawn| axis.backward(drawn)).unwrap();
                assert!((back / value - 1.0).abs() < 1e-13, "{scale:?}: {value} reads back as {back}");
            }
        }
    }

    #[test]
    fn units_are_those_of_the_closest_packing_and_the_mean_spacing() {
        let square = Domain::torus(&[2.0, 2.0]).unwrap();
        assert_eq!(LengthUnit::PackingDistance.size(&square, 100.0), square.closest_packing_distance(100.0));
        assert_eq!(FrequencyUnit::SqrtN.size(&square, 100.0), 5.0);
        assert_eq!(FrequencyUnit::SqrtN.symbol(&square, None), "√λ");
        assert_eq!(FrequencyUnit::SqrtN.symbol(&Domain::unit_torus(3), None), "∛n");
        assert_eq!(LengthUnit::PackingDistance.symbol(3, None), "d_fcc");
    }

    #[test]
    fn ticks_are_where_their_text_says() {
        let decibels = axis(1.0, AxisScale::Decibel).ticks(-20.0, 20.0, 5);
        assert!(decibels.contains(&(-10.0, "−10".into())), "{decibels:?}");
        let decades = axis(1.0, AxisScale::Log).ticks(-2.0, 2.0, 5);
        assert_eq!(decades.iter().map(|t| t.1.as_str()).collect::<Vec<_>>(), ["0.01", "0.1", "1", "10", "100"]);
        assert!(decades.iter().zip([-2.0, -1.0, 0.0, 1.0, 2.0]).all(|(t, at)| (t.0 - at).abs() < 1e-12));
    }
}
