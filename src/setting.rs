//! The names of everything that can be set. Errors speak of settings by these; each face has words of its own for them.

use std::fmt;

/// Defines [`Setting`]: each one is named as the field of `request::Request` that holds it.
macro_rules! settings {
    ($($(#[$doc:meta])* $setting:ident = $name:literal,)*) => {
        /// A setting of some command or function, by which an error says what is wrong.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum Setting {
            $($(#[$doc])* $setting,)*
        }

        impl Setting {
            /// All of them, those of a request first and in its order.
            pub const ALL: &[Self] = &[$(Self::$setting),*];

            /// Its plain name, `r_max`: that of its field.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$setting => $name,)*
                }
            }
        }
    };
}

settings! {
    /// Point files or directories.
    Files = "files",
    /// The sampler that draws the points.
    Sampler = "sampler",
    /// Points per realization.
    Points = "points",
    /// Number of realizations.
    Realizations = "realizations",
    /// Dimension.
    Dim = "dim",
    /// Seed.
    Seed = "seed",
    /// Parameters of the sampler.
    Params = "params",
    /// Layout of raw numbers.
    Raw = "raw",
    /// Arrays of an archive that hold points.
    Array = "array",
    /// Columns of coordinates.
    Columns = "columns",
    /// Column that tells realizations apart.
    RealizationColumn = "realization_column",
    /// Column of weights.
    WeightColumn = "weight_column",
    /// Column of intensities.
    IntensityColumn = "intensity_column",
    /// Column of classes.
    ClassColumn = "class_column",
    /// Whether files that cannot be used are left out.
    KeepGoing = "keep_going",
    /// Files of simulations for envelopes.
    EnvelopeFrom = "envelope_from",
    /// The intensity of an inhomogeneous process.
    Inhomogeneous = "inhomogeneous",
    /// Bandwidth of the intensity.
    IntensityBandwidth = "intensity_bandwidth",
    /// Torus or window.
    Domain = "domain",
    /// Sides of the torus.
    Sides = "sides",
    /// The window.
    Window = "window",
    /// The window as a polygon.
    WindowPolygon = "window_polygon",
    /// Whether points outside the torus are folded back in.
    Wrap = "wrap",
    /// Name of the length unit.
    Unit = "unit",
    /// Statistics to compute.
    Stats = "stats",
    /// Largest distance.
    RMax = "r_max",
    /// Number of distance bins.
    Bins = "bins",
    /// Spacing of the bins.
    BinScale = "bin_scale",
    /// Bin edges.
    Edges = "edges",
    /// Smoothing kernel of g.
    Kernel = "kernel",
    /// Its bandwidth.
    Bandwidth = "bandwidth",
    /// What a smoothed pair is divided by.
    Divisor = "divisor",
    /// Whether the kernel is summed over every pair.
    ExactKernel = "exact_kernel",
    /// Edge correction.
    Correction = "correction",
    /// Distances beyond half the torus.
    BeyondHalf = "beyond_half",
    /// The two classes whose g is wanted.
    Classes = "classes",
    /// Bins per axis of the vector g.
    LagBins = "lag_bins",
    /// Largest lag per axis.
    LagMax = "lag_max",
    /// Radii of the rings of the vector g.
    LagRings = "lag_rings",
    /// Number of simulations for envelopes.
    Envelope = "envelope",
    /// What pairs are divided by.
    Normalization = "normalization",
    /// Largest frequency.
    MaxFrequency = "max_frequency",
    /// A list of wave vectors.
    Frequencies = "frequencies",
    /// Wave vectors per ring.
    RingDirections = "ring_directions",
    /// Sectors of angular power.
    Sectors = "sectors",
    /// Largest frequency of the covariance of amplitudes.
    CovarianceFrequency = "covariance_frequency",
    /// What is integrated.
    Integrand = "integrand",
    /// What estimates the integral.
    Estimator = "estimator",
    /// Shifts of each realization.
    Shifts = "shifts",
    /// How the spatial form is summed.
    Spatial = "spatial",
    /// Frequencies that are named.
    Top = "top",
    /// The density that points are placed by.
    Intensity = "intensity",
    /// How points are placed by it.
    By = "by",
    /// Cells per axis of the intensity.
    IntensityGrid = "intensity_grid",
    /// Taper of a window's spectrum.
    Taper = "taper",
    /// Number of sine tapers per axis.
    Tapers = "tapers",
    /// How the transform of the window is removed.
    Debias = "debias",
    /// Conventions of another program.
    Convention = "convention",
    /// Whether with that program's defects.
    BugCompatible = "bug_compatible",
    /// What computes.
    Device = "device",
    /// The promise about P.
    Accuracy = "accuracy",
    /// Number of threads.
    Threads = "threads",
    /// Memory of transforms and sums.
    Memory = "memory",
    /// Costs of methods.
    Costs = "costs",
    /// A file that measured costs go to; no part of a request.
    Calibrate = "calibrate",
    /// Where results go; no part of a request.
    Out = "out",
    /// Whether results that are there are replaced; no part of a request.
    Force = "force",
    /// Whether all pairs of axes are measured; no part of a request, like all below.
    Projections = "projections",
    /// Numbers of points of the prefixes that are measured.
    Prefixes = "prefixes",
    /// The part of the realizations that is measured.
    Shard = "shard",
    /// How often sums are written on the way.
    Checkpoint = "checkpoint",
    /// Whether a run goes on where an earlier one ended.
    Resume = "resume",
    /// A result whose realizations are added to.
    Extend = "extend",
    /// How long a run goes on.
    TimeLimit = "time_limit",
    /// Numbers that are to be known to an error.
    UntilError = "until_error",
    /// Whether sums are kept beside a result.
    KeepSums = "keep_sums",
    /// Whether all numbers are written into one file too.
    Npz = "npz",
    /// Whether a merged result may lack realizations.
    Partial = "partial",
    /// The spectrum that errors of integrals are predicted from.
    PowerFrom = "p",
    /// Figures that are drawn again.
    Figures = "figures",
    /// Names of results in a legend.
    Labels = "labels",
    /// The page that results are drawn into.
    Page = "page",
    /// Range of an abscissa.
    RangeX = "range_x",
    /// Range of an ordinate.
    RangeY = "range_y",
    /// Whether an abscissa is logarithmic.
    LogX = "log_x",
    /// Whether an ordinate is logarithmic.
    LogY = "log_y",
    /// Their colours.
    Colors = "colors",
    /// Size on paper.
    Size = "size",
    /// File format of figures.
    Format = "format",
    /// Other points that are measured beside the first.
    Beside = "beside",
    /// Level of significance.
    Alpha = "alpha",
    /// Tolerance of a non-uniform transform; `accuracy` decides it in a request.
    Tolerance = "tolerance",
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl Setting {
    /// A text, such as a warning, with every setting that it mentions under the name that `name` has for it.
    pub fn renamed(text: &str, name: impl Fn(Self) -> &'static str) -> String {
        renamed(text, name)
    }

    /// How the text of a reason mentions it: `` `r_max` ``.
    pub fn mention(self) -> String {
        format!("`{self}`")
    }
}

/// `text` with every setting that it mentions (`` `r_max` ``) under another name.
pub(crate) fn renamed(text: &str, name: impl Fn(Setting) -> &'static str) -> String {
    let mut renamed = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('`') {
        renamed.push_str(before);
        let mentioned = after.split_once('`').and_then(|(word, after)| {
            let setting = Setting::ALL.iter().find(|s| s.name() == word)?;
            Some((name(*setting), after))
        });
        rest = match mentioned {
            Some((name, after)) => {
                renamed.push_str(name);
                after
            }
            None => {
                renamed.push('`');
                after
            }
        };
    }
    renamed + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_text_mentions_is_renamed_and_nothing_else() {
        let flags = |setting| if setting == Setting::RMax { "--r-max" } else { "--other" };
        for (text, expected) in [
            ("`r_max` or `bins`: less", "--r-max or --other: less"),
            ("`what` `r_max`", "`what` --r-max"),
            ("a ` and `r_max`", "a ` and --r-max"),
            ("`r_max", "`r_max"),
            ("r_max", "r_max"),
            ("", ""),
        ] {
            assert_eq!(renamed(text, flags), expected);
        }
    }
}
