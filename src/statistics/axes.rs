//! The curves of a report, one row each: title and labels as every picture of them has them, and the columns of which a
//! picture can be drawn again.

use std::borrow::Cow;

use crate::display::Units;
use crate::display::figure::Numbers;
use crate::estimate::Analysis;

/// A figure of curves, and the table that it can be drawn from.
#[derive(Clone, Copy)]
pub(crate) struct Drawn {
    /// Of its files.
    pub(crate) stem: &'static str,
    pub(crate) title: &'static str,
    /// Labels, with `{length}`, `{cycles}` and `{rings}` for units.
    x: &'static str,
    y: &'static str,
    pub(crate) table: &'static str,
    /// The abscissa; where there is no such column, halfway between its `_lo` and its `_hi`.
    pub(crate) x_column: &'static str,
    /// What of the abscissa is a unit of the axis.
    pub(crate) x_factor: f64,
    /// The ordinates with their names, if there are several. `g_` is every column that begins like it.
    pub(crate) curves: &'static [(&'static str, &'static str)],
    /// Whether they have bands of one standard error.
    pub(crate) bands: bool,
    /// The column each of whose values is a curve of its own.
    pub(crate) group: Option<&'static str>,
    /// What the curves are compared with.
    pub(crate) level: Level,
    /// What the values are, for the range that is shown.
    pub(crate) values: Values,
    /// Whether the abscissa may stand on a logarithmic axis.
    pub(crate) log_x: bool,
}

/// What curves are compared with.
#[derive(Clone, Copy)]
pub(crate) enum Level {
    At(f64, &'static str),
    /// The values of a column.
    Column(&'static str, &'static str),
}

/// Which range is shown of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Values {
    /// From 0 up.
    Positive,
    /// About 1.
    Ratio,
    /// Of either sign.
    Signed,
    /// From 0 to 1.
    Probability,
}

const DISTANCE: &str = "distance r ({length})";
const CYCLES: &str = "frequency ν ({cycles})";
const RINGS: &str = "frequency ν ({rings})";
const G: &str = "g(r) (dimensionless)";
const L: &str = "L(r) − r ({length})";

const PLAIN: Drawn = Drawn {
    stem: "",
    title: "",
    x: DISTANCE,
    y: G,
    table: "",
    x_column: "r",
    x_factor: 1.0,
    curves: &[],
    bands: true,
    group: None,
    level: Level::At(1.0, "g = 1"),
    values: Values::Positive,
    log_x: true,
};

pub(crate) static PCF: Drawn =
    Drawn { stem: "pcf", title: "Pair correlation function g(r)", table: "pcf.csv", curves: &[("g", "")], ..PLAIN };

pub(crate) static PCF_KERNEL: Drawn = Drawn {
    stem: "pcf_kernel",
    title: "Pair correlation function g(r), smoothed",
    table: "pcf.csv",
    curves: &[("g_kernel", "")],
    ..PLAIN
};

pub(crate) static PCF_CROSS: Drawn = Drawn {
    stem: "pcf_cross",
    title: "Pair correlation functions of two classes",
    table: "pcf_cross.csv",
    curves: &[("g_", "")],
    ..PLAIN
};

pub(crate) static K_FUNCTION: Drawn = Drawn {
    stem: "k_function",
    title: "L(r) − r, from Ripley's K function",
    y: L,
    table: "k_function.csv",
    curves: &[("l_minus_r", "")],
    level: Level::At(0.0, "random: L = r"),
    values: Values::Signed,
    ..PLAIN
};

pub(crate) static K_FUNCTION_CROSS: Drawn = Drawn {
    stem: "k_function_cross",
    title: "L(r) − r of two classes, from Ripley's K function",
    y: L,
    table: "k_function_cross.csv",
    curves: &[("l_minus_r_", "")],
    level: Level::At(0.0, "independent: L = r"),
    values: Values::Signed,
    ..PLAIN
};

pub(crate) static PCF_ANGULAR: Drawn = Drawn {
    stem: "pcf_angular",
    title: "Pair correlation function along rings g(r, θ)",
    x: "direction θ of the lag (degrees from the x axis)",
    y: "g(r, θ) (dimensionless)",
    table: "pcf_angular.csv",
    x_column: "theta",
    // The table has radians.
    x_factor: std::f64::consts::PI / 180.0,
    curves: &[("g", "")],
    group: Some("r"),
    values: Values::Ratio,
    log_x: false,
    ..PLAIN
};

pub(crate) static RADIAL: Drawn = Drawn {
    stem: "spectrum_radial",
    title: "Radial mean of the power spectrum P(ν)",
    x: RINGS,
    y: "P(ν) (dimensionless)",
    table: "spectrum_radial.csv",
    x_column: "nu",
    curves: &[("p", "")],
    level: Level::At(1.0, "P = 1"),
    ..PLAIN
};

pub(crate) static ANISOTROPY: Drawn = Drawn {
    stem: "anisotropy",
    title: "Anisotropy of the power spectrum",
    y: "anisotropy (dB)",
    curves: &[("anisotropy_db", "")],
    bands: false,
    level: Level::Column("anisotropy_reference_db", "isotropic"),
    values: Values::Signed,
    ..RADIAL
};

pub(crate) static AXES: Drawn = Drawn {
    stem: "spectrum_axes",
    title: "Power spectrum along the axes",
    x: CYCLES,
    table: "spectrum_axes.csv",
    bands: false,
    group: Some("axis"),
    ..RADIAL
};

pub(crate) static ANGULAR: Drawn = Drawn {
    stem: "spectrum_angular",
    title: "Power by direction",
    x: "direction θ of the frequency (degrees from the x axis)",
    y: "P(θ) / P if isotropic (dimensionless)",
    table: "spectrum_angular.csv",
    x_column: "theta",
    curves: &[("ratio", "")],
    level: Level::At(1.0, "isotropic"),
    values: Values::Ratio,
    log_x: false,
    ..RADIAL
};

pub(crate) static NEIGHBORS: Drawn = Drawn {
    stem: "neighbor_functions",
    title: "Nearest-neighbour and empty-space functions",
    y: "probability",
    table: "neighbor_functions.csv",
    curves: &[("g_function", "G: point to nearest point"), ("f_function", "F: place to nearest point")],
    level: Level::Column("poisson", "Poisson: G = F"),
    values: Values::Probability,
    ..PLAIN
};

pub(crate) static NEIGHBORS_CROSS: Drawn = Drawn {
    stem: "neighbor_functions_cross",
    title: "J functions of two classes",
    y: "J(r) (dimensionless)",
    table: "neighbor_functions_cross.csv",
    curves: &[("j_function_", "")],
    bands: false,
    level: Level::At(1.0, "independent: J = 1"),
    ..PLAIN
};

pub(crate) static COUNTS: Drawn = Drawn {
    stem: "counts",
    title: "Index of dispersion of counts",
    x: "side of boxes, radius of balls ({length})",
    y: "variance / mean of N (dimensionless)",
    table: "counts.csv",
    x_column: "size",
    curves: &[("dispersion", "")],
    group: Some("shape"),
    level: Level::At(1.0, "Poisson: 1"),
    ..PLAIN
};

/// All of them, in the order of the page.
pub(crate) static DRAWN: [&Drawn; 13] = [
    &PCF,
    &PCF_KERNEL,
    &PCF_CROSS,
    &K_FUNCTION,
    &K_FUNCTION_CROSS,
    &PCF_ANGULAR,
    &RADIAL,
    &ANISOTROPY,
    &AXES,
    &ANGULAR,
    &NEIGHBORS,
    &NEIGHBORS_CROSS,
    &COUNTS,
];

impl Drawn {
    /// The title, which says where g, K and P are those of an inhomogeneous process.
    pub(crate) fn title_of(&self, a: &Analysis) -> Cow<'static, str> {
        match a.inhomogeneity() {
            None => self.title.into(),
            Some(_) => format!("{}, inhomogeneous", self.title).into(),
        }
    }

    /// Where its numbers stand.
    pub(crate) fn numbers(&self) -> Option<Numbers> {
        Some(Numbers { table: self.table, x: self.x_column, x_factor: self.x_factor })
    }

    /// The label of the abscissa, in these units.
    pub(crate) fn x_label(&self, units: &Units) -> String {
        labelled(self.x, units)
    }

    /// The label of the ordinate, in these units.
    pub(crate) fn y_label(&self, units: &Units) -> String {
        labelled(self.y, units)
    }
}

fn labelled(text: &str, units: &Units) -> String {
    let text = text.replace("{length}", &units.own_length);
    text.replace("{cycles}", &units.cycles).replace("{rings}", &units.rings)
}
