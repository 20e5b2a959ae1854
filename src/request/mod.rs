//! What is asked for: one struct that the command line parses and the viewer edits, and the way back to a command line.
//! `analysis` turns it into plans.

mod device;
mod idle;
pub mod lists;
mod settings;
#[cfg(feature = "cli")]
mod typed;
mod values;

use std::path::PathBuf;

use crate::estimate::Normalization;
use crate::memory::Memory;
use crate::named::named;
use crate::plan::{
    Accuracy, Bandwidth, BinScale, By, Convention, Conventions, Correction, Debias, Divisor, Estimator,
    IntensityBandwidth, LagReach, SmoothingKernel, Spatial, Taper,
};
use crate::points::read::RawLayout;
use crate::points::{Boundary, UnitName};

pub use device::DeviceChoice;
pub(crate) use idle::{refuse_idle_settings, refuse_settings_of_samplers, refuse_unknown_to_convention};
pub(crate) use lists::Lists;
pub use settings::{Group, Row, SETTINGS};
#[cfg(feature = "cli")]
pub use typed::{dress, help};
pub use values::shell_words;

/// A statistic of `--stats`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[non_exhaustive]
pub enum Statistic {
    /// Pair correlation function g(r).
    Pcf,
    /// g of the vector between two points, on a grid of lags.
    PcfVector,
    /// Ripley's K(r), L(r) and the mean number of neighbours within r.
    KFunction,
    /// Power spectrum P(m) on the grid, with its radial mean and anisotropy.
    Spectrum,
    /// Radial mean and anisotropy only.
    Radial,
    /// Covariance of the amplitudes of low frequencies, E[s_m conj(s_l)].
    Covariance,
    /// Nearest-neighbour distances.
    Neighbors,
    /// Discrepancies, diaphony, t of nets in base 2, covering radius.
    Discrepancy,
    /// Numbers of points in boxes and balls.
    Counts,
    /// Intensity on a grid.
    Intensity,
}

named!(
    Statistic: Pcf = "pcf", PcfVector = "pcf-vector", KFunction = "k-function", Spectrum = "spectrum", Radial = "radial",
    Covariance = "covariance", Neighbors = "neighbors", Discrepancy = "discrepancy",
    Counts = "counts", Intensity = "intensity"
);

/// What is measured where nothing else is asked for.
pub(crate) const DEFAULT_STATISTICS: [Statistic; 3] = [Statistic::Pcf, Statistic::Spectrum, Statistic::Neighbors];

/// The points: files, or a sampler.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct PointsRequest {
    /// Point files or directories, one batch; - is stdin
    ///
    /// Point files, directories or quoted patterns, all of them one batch of realizations; `-` is standard input.
    #[cfg_attr(feature = "cli", arg(value_name = "FILES"))]
    pub files: Vec<PathBuf>,

    /// Generate the points instead
    ///
    /// Generate the points instead of reading them; `pairwave samplers` lists the names and their parameters.
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME"))]
    pub sampler: Option<String>,

    /// Points per realization (with --sampler)
    #[cfg_attr(feature = "cli", arg(short = 'n', long = "points", value_name = "N"))]
    pub points: Option<u64>,

    /// Number of realizations (with --sampler)
    #[cfg_attr(feature = "cli", arg(short = 'k', long = "realizations", value_name = "K"))]
    pub realizations: Option<u64>,

    /// Dimension, 1 to 3 (with --sampler)
    #[cfg_attr(feature = "cli", arg(long, value_name = "D"))]
    pub dim: Option<usize>,

    /// Seed (with --sampler)
    ///
    /// Seed (with --sampler or --envelope): the same seed draws the same points and simulations, on every machine.
    #[cfg_attr(feature = "cli", arg(long))]
    pub seed: Option<u64>,

    /// A sampler's parameter; may be repeated
    #[cfg_attr(feature = "cli", arg(long = "param", value_name = "KEY=VALUE"))]
    pub params: Vec<String>,

    /// Read files as raw little-endian numbers, e.g. f32x2
    #[cfg_attr(feature = "cli", arg(long, value_name = "TYPExD", value_parser = typed::raw_layout))]
    pub raw: Option<RawLayout>,

    /// Arrays of an .npz that hold the points
    ///
    /// The arrays of an .npz archive that hold the points: one, or one per coordinate, as in x,y.
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME[,NAME]"))]
    pub array: Option<String>,

    /// Columns of the coordinates, as in x,y
    ///
    /// The columns that hold the coordinates, by their names or their numbers from 1, as in x,y or 2,3.
    #[cfg_attr(feature = "cli", arg(long, value_name = "C1,C2[,C3]"))]
    pub columns: Option<String>,

    /// The column whose values are realizations
    ///
    /// The column, by its name or its number from 1, each of whose values is a realization: a frame, a run. The word
    /// blank-lines tells them apart by blank lines.
    #[cfg_attr(feature = "cli", arg(long, value_name = "COLUMN"))]
    pub realization_column: Option<String>,

    /// The column that holds the weight of each point
    ///
    /// The column that holds the weight of each point, by its name or its number from 1.
    #[cfg_attr(feature = "cli", arg(long, value_name = "COLUMN"))]
    pub weight_column: Option<String>,

    /// The column that holds the intensity at each point
    ///
    /// The column that holds the intensity at each point, by its name or its number from 1: g, K, L and P are then those of an
    /// inhomogeneous process, each point counting 1/intensity.
    #[cfg_attr(feature = "cli", arg(long, value_name = "COLUMN"))]
    pub intensity_column: Option<String>,

    /// The column that holds the class of each point
    ///
    /// The column that holds the class of each point, by its name or its number from 1.
    #[cfg_attr(feature = "cli", arg(long, value_name = "COLUMN"))]
    pub class_column: Option<String>,

    /// Leave out files that cannot be used
    ///
    /// Leave out files that cannot be read or used, and say which and why, in place of ending with the first; the realizations
    /// are numbered without them.
    #[cfg_attr(feature = "cli", arg(long))]
    pub keep_going: bool,

    /// Files of simulated points, for envelopes; may be repeated
    ///
    /// Files, directories or quoted patterns of simulated points, for pointwise and global envelopes, read as the points are;
    /// may be repeated. Each realization in them is a simulation, or as many in a row as the points have.
    #[cfg_attr(feature = "cli", arg(long, value_name = "FILES"))]
    pub envelope_from: Vec<PathBuf>,

    /// g, K, L and P of an inhomogeneous process
    ///
    /// g, K, L and P of an inhomogeneous process, each point counting 1/intensity: that of a kernel estimate (estimate), or of a
    /// function as `pairwave integrands` lists them, in fractions of the box and up to a factor.
    #[cfg_attr(feature = "cli", arg(long, value_name = "estimate|SPEC"))]
    pub inhomogeneous: Option<String>,

    /// Standard deviation of the intensity's kernel, or a rule
    ///
    /// Standard deviation of the Gaussian kernel of the intensity, or a rule: scott, or likelihood (likelihood cross-validation).
    #[cfg_attr(feature = "cli", arg(long, value_name = "SD|RULE", allow_negative_numbers = true))]
    pub intensity_bandwidth: Option<IntensityBandwidth>,

    /// What happens at the sides
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub domain: Option<Boundary>,

    /// Sides of the torus
    #[cfg_attr(
        feature = "cli",
        arg(long = "box", value_name = "L1,L2[,L3]", value_delimiter = ',', allow_hyphen_values = true)
    )]
    pub sides: Option<Vec<f64>>,

    /// The window the points were observed in
    ///
    /// The window the points were observed in: its ends along each axis. Distances are then plain, and edges corrected for.
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "x0,x1,y0,y1[,z0,z1]", value_delimiter = ',', allow_hyphen_values = true)
    )]
    pub window: Option<Vec<f64>>,

    /// The window as a polygon: WKT, GeoJSON or vertices
    ///
    /// A file with the outline of the window the points were observed in: a WKT POLYGON or MULTIPOLYGON, a GeoJSON Polygon or
    /// MultiPolygon, holes allowed, or x and y of one vertex per line (2D).
    #[cfg_attr(feature = "cli", arg(long, value_name = "FILE"))]
    pub window_polygon: Option<PathBuf>,

    /// Fold points outside the torus back in
    ///
    /// Fold points outside the torus back in; without it they are an error.
    #[cfg_attr(feature = "cli", arg(long))]
    pub wrap: bool,

    /// Name of the length unit, such as m or µm
    ///
    /// The name of the length unit of the domain, such as m or µm, for axes, tables and pages. No number depends on it.
    #[cfg_attr(feature = "cli", arg(long, value_name = "NAME"))]
    pub unit: Option<UnitName>,
}

/// What to measure, and how.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Request {
    /// The points.
    #[cfg_attr(feature = "cli", command(flatten))]
    pub input: PointsRequest,

    /// What to measure
    ///
    /// Statistics to compute, separated by commas.
    #[cfg_attr(
        feature = "cli",
        arg(long, value_enum, value_delimiter = ',', default_value = "pcf,spectrum,neighbors", value_name = "LIST")
    )]
    pub stats: Vec<Statistic>,

    /// Largest distance
    #[cfg_attr(feature = "cli", arg(long, value_name = "R", allow_negative_numbers = true))]
    pub r_max: Option<f64>,

    /// Number of distance bins
    #[cfg_attr(feature = "cli", arg(long, value_name = "B", allow_negative_numbers = true))]
    pub bins: Option<usize>,

    /// Spacing of the bins
    ///
    /// Spacing of the bins; log covers three decades below the largest distance.
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub bin_scale: Option<BinScale>,

    /// Bin edges
    ///
    /// Bin edges, one number per line or separated by blanks or commas.
    #[cfg_attr(feature = "cli", arg(long, value_name = "FILE"))]
    pub edges: Option<PathBuf>,

    /// Also smooth g: epanechnikov, gaussian or box
    ///
    /// Also smooth g with this kernel: a second column beside the counts in bins.
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub kernel: Option<SmoothingKernel>,

    /// Standard deviation of the kernel, or a rule
    ///
    /// Standard deviation of the kernel, or a rule: stoyan, fiksel, or lscv (least-squares cross-validation).
    #[cfg_attr(feature = "cli", arg(long, value_name = "SD|RULE", allow_negative_numbers = true))]
    pub bandwidth: Option<Bandwidth>,

    /// Radius whose sphere a pair is divided by
    ///
    /// What a pair at distance d adds to the estimate at r is divided by the surface of the sphere of radius r or d.
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub divisor: Option<Divisor>,

    /// Sum the kernel over every pair
    ///
    /// Sum the kernel over every pair, however many there are.
    #[cfg_attr(feature = "cli", arg(long))]
    pub exact_kernel: bool,

    /// Edges: translation, isotropic, border or none
    ///
    /// Edge correction of distances in a window.
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub correction: Option<Correction>,

    /// Also take distances beyond half the torus
    ///
    /// On a torus, also take distances beyond half the shortest side, up to half the diagonal.
    #[cfg_attr(feature = "cli", arg(long))]
    pub beyond_half: bool,

    /// The two classes whose g, K and neighbours are wanted
    ///
    /// The two classes whose g, K and neighbours are wanted, as a line of CSV.
    #[cfg_attr(feature = "cli", arg(long, value_name = "A,B"))]
    pub classes: Option<String>,

    /// Bins per axis of the vector g
    #[cfg_attr(feature = "cli", arg(long, value_name = "B", allow_negative_numbers = true))]
    pub lag_bins: Option<usize>,

    /// Largest lag per axis of the vector g, or whole
    ///
    /// Largest lag per axis of the vector g, in length units; whole: half the sides of a torus, the sides of a window.
    #[cfg_attr(feature = "cli", arg(long, value_name = "H", allow_negative_numbers = true))]
    pub lag_max: Option<LagReach>,

    /// Radii of rings along which g(r, theta) is shown
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "R1,R2,...", value_delimiter = ',', allow_negative_numbers = true)
    )]
    pub lag_rings: Option<Vec<f64>>,

    /// Simulate complete spatial randomness N times
    ///
    /// Simulate complete spatial randomness N times, for pointwise and global envelopes.
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", allow_negative_numbers = true))]
    pub envelope: Option<u64>,

    /// pairs: n(n-1); intensity: n^2
    ///
    /// What pairs are divided by: n(n-1) or n^2 (with border correction n times the points deep enough inside, either way; where points
    /// have weights, without or with the square of their own).
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value = "pairs"))]
    pub normalization: Normalization,

    /// Largest frequency
    ///
    /// Largest frequency, for all axes or per axis.
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "F[,F2[,F3]]", value_delimiter = ',', allow_negative_numbers = true)
    )]
    pub max_frequency: Option<Vec<u32>>,

    /// Wave vectors, one per line
    ///
    /// Wave vectors, one per line: integers m on a torus; cycles per unit length in a window.
    #[cfg_attr(feature = "cli", arg(long, value_name = "FILE"))]
    pub frequencies: Option<PathBuf>,

    /// At most N wave vectors per ring
    ///
    /// For --stats radial: at most N wave vectors per ring, evenly spread over directions.
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", allow_negative_numbers = true))]
    pub ring_directions: Option<u64>,

    /// Sectors of half a turn (2D)
    ///
    /// Sectors of half a turn in which angular power is summed (2D).
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", allow_negative_numbers = true))]
    pub sectors: Option<usize>,

    /// Largest frequency of the covariance of amplitudes
    #[cfg_attr(feature = "cli", arg(long, value_name = "B", allow_negative_numbers = true))]
    pub covariance_frequency: Option<u32>,

    /// Predict the error of integrating this
    ///
    /// Predict and observe the error of integrating NAME or NAME:key=value,...; several times for several (`pairwave integrands` lists
    /// them). Coordinates are fractions of the box.
    #[cfg_attr(feature = "cli", arg(long, value_name = "SPEC"))]
    pub integrand: Vec<String>,

    /// mean, ratio, lambda or count-ratio
    ///
    /// What estimates the integral: the mean of f over the points (mean; ratio where their number is random), or their sum over the
    /// expected number (lambda). Of points with weights the sum of w f (lambda), over that of w (ratio), or times the expected number over theirs (count-ratio).
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub estimator: Option<Estimator>,

    /// Shifts of each realization
    ///
    /// Shifts of each realization, of a lattice with a random offset, at which the error is observed.
    #[cfg_attr(feature = "cli", arg(long, value_name = "S", allow_negative_numbers = true))]
    pub shifts: Option<u32>,

    /// pairs, deposit, radial or none
    ///
    /// How the predicted variance is summed in space: over every pair, over pairs deposited on a grid of lags, over g(r) up to half a side
    /// (for isotropic points or integrands), or not at all.
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub spatial: Option<Spatial>,

    /// Names the frequencies that add most to the variance
    ///
    /// Names the T frequencies that add most to the variance of each integral; without it a table has 100.
    #[cfg_attr(feature = "cli", arg(long, value_name = "T", allow_negative_numbers = true))]
    pub top: Option<u32>,

    /// Importance sampling: points as dense as this
    ///
    /// Importance sampling: points as dense as NAME or NAME:key=value,... (an integrand), placed so by --by; without it the points at hand are
    /// that dense, per box. f over that density is averaged.
    #[cfg_attr(feature = "cli", arg(long, value_name = "SPEC"))]
    pub intensity: Option<String>,

    /// removal or warp
    ///
    /// How points are placed by --intensity: the sampler's are parents, of which as many are kept (removal), or coordinates of the map to that
    /// density (warp).
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub by: Option<By>,

    /// Cells per axis of the intensity
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", allow_negative_numbers = true))]
    pub intensity_grid: Option<usize>,

    /// Taper of P in a window: bartlett or sine
    ///
    /// Taper of a window's spectrum.
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub taper: Option<Taper>,

    /// Sine tapers per axis
    ///
    /// With --taper sine: the first N sine tapers per axis, averaged.
    #[cfg_attr(feature = "cli", arg(long, value_name = "N", allow_negative_numbers = true))]
    pub tapers: Option<usize>,

    /// How the transform of the window is removed
    ///
    /// How the transform of the window itself is removed from its spectrum.
    #[cfg_attr(feature = "cli", arg(long, value_enum))]
    pub debias: Option<Debias>,

    /// Follow psa, utk or pspec
    ///
    /// Grid, rings, labels and normalization of another program.
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value = "ours"))]
    pub convention: Convention,

    /// Also that program's known defects
    ///
    /// With --convention: also that program's known defects.
    #[cfg_attr(feature = "cli", arg(long))]
    pub bug_compatible: bool,

    /// What computes
    ///
    /// What computes: auto, cpu, gpu, reference, or an index of `pairwave devices`.
    #[cfg_attr(feature = "cli", arg(long, default_value = "auto", value_name = "auto|cpu|gpu|reference|INDEX"))]
    pub device: DeviceChoice,

    /// fast or high: the promise about P
    ///
    /// The promise about P (pair counts are exact either way).
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value = "fast"))]
    pub accuracy: Accuracy,

    /// Threads of the CPU path
    #[cfg_attr(feature = "cli", arg(long, value_name = "T", allow_negative_numbers = true))]
    pub threads: Option<usize>,

    /// Memory of transforms and sums, such as 4GiB
    ///
    /// Memory of transforms and sums, beside points and results, such as 500MB or 4GiB. Less makes more steps of the same
    /// sums: no number depends on it, but for the default of --max-frequency below 2GiB.
    #[cfg_attr(feature = "cli", arg(long, value_name = "SIZE"))]
    pub memory: Option<Memory>,

    /// Costs of methods, from `bench --calibrate`
    ///
    /// A file of what methods cost on this machine, as `pairwave bench --calibrate FILE` measures it: which method is taken follows from
    /// that, and with it the last digits of P, within what --accuracy promises. Without it: the costs that are built in.
    #[cfg_attr(feature = "cli", arg(long, value_name = "FILE"))]
    pub costs: Option<PathBuf>,
}

/// The word that asks for an estimate of the intensity.
pub(crate) const ESTIMATE: &str = "estimate";

impl PointsRequest {
    /// Whether points are weighted by the inverse of their intensity.
    pub fn is_inhomogeneous(&self) -> bool {
        self.inhomogeneous.is_some() || self.intensity_column.is_some()
    }

    /// Whether points have weights.
    pub fn is_weighted(&self) -> bool {
        self.weight_column.is_some() || self.is_inhomogeneous()
    }
}

impl Request {
    /// Everything that its convention decides.
    pub fn conventions(&self) -> Conventions {
        self.convention.resolve(self.bug_compatible)
    }

    /// The memory it may take.
    pub fn memory(&self) -> Memory {
        self.memory.unwrap_or_else(Memory::of_machine)
    }
}

impl Default for Request {
    /// What `pairwave analyze` measures when no flag is given.
    fn default() -> Self {
        Self {
            input: PointsRequest::default(),
            stats: DEFAULT_STATISTICS.to_vec(),
            r_max: None,
            bins: None,
            bin_scale: None,
            edges: None,
            kernel: None,
            bandwidth: None,
            divisor: None,
            exact_kernel: false,
            correction: None,
            beyond_half: false,
            classes: None,
            lag_bins: None,
            lag_max: None,
            lag_rings: None,
            envelope: None,
            normalization: Normalization::default(),
            max_frequency: None,
            frequencies: None,
            ring_directions: None,
            sectors: None,
            covariance_frequency: None,
            integrand: Vec::new(),
            estimator: None,
            shifts: None,
            spatial: None,
            top: None,
            intensity: None,
            by: None,
            intensity_grid: None,
            taper: None,
            tapers: None,
            debias: None,
            convention: Convention::default(),
            bug_compatible: false,
            device: DeviceChoice::default(),
            accuracy: Accuracy::default(),
            threads: None,
            memory: None,
            costs: None,
        }
    }
}
