//! A file of a report: its name, how its content is made, when it is written, and where its picture stands in the page.

use std::borrow::Cow;

use rustfft::num_complex::Complex;

use super::Table;
use crate::display::Pixels;
use crate::display::figure::Figure;
use crate::estimate::Analysis;

/// A drawn picture.
pub(crate) type Svg = Result<String, Box<dyn std::error::Error + Send + Sync>>;

/// A file that may be written.
pub(crate) struct Output {
    pub(crate) name: &'static str,
    pub(crate) turn: Turn,
    pub(crate) make: Make,
    pub(crate) place: Option<Place>,
    pub(crate) shown: Option<Shown>,
}

/// What of a table is shown on a terminal.
#[derive(Clone, Copy)]
pub(crate) struct Shown {
    /// What it holds.
    pub(crate) heading: &'static str,
    /// The first is the abscissa; those that are not there are left out. `g_` is all that begin like it.
    pub(crate) columns: &'static [&'static str],
}

impl Shown {
    /// Whether a column is.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|c| *c == name || c.ends_with('_') && name.starts_with(c))
    }
}

/// When a file is written, and so listed: first of all numbers, last what is quickest to make again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Turn {
    Table,
    Array,
    ArrayOfLags,
    Figure,
    Image,
    ImageOfLags,
    Points,
}

/// How the content is made; `None` where there is nothing to show.
#[derive(Clone, Copy)]
pub(crate) enum Make {
    Table(fn(&Analysis) -> Option<Table>),
    Array(fn(&Analysis) -> Option<Array<'_>>),
    Figure(fn(&Analysis) -> Option<Figure>),
    Image(fn(&Analysis) -> Option<Image>),
    /// Drawn by hand.
    Svg(fn(&Analysis) -> Option<Svg>),
    /// One below the other.
    Maps(fn(&Analysis) -> Vec<Map<'_>>),
}

/// Where a picture stands in the page.
pub(crate) struct Place {
    /// In HTML; pictures of one heading follow each other.
    pub(crate) heading: &'static str,
    /// In HTML, of what is seen.
    pub(crate) caption: Caption,
}

/// From what an image says is seen in it, or nothing.
pub(crate) type Caption = fn(&Analysis, &str) -> Option<String>;

/// An array in C order; it may be GiB, so its values come one by one.
pub struct Array<'a> {
    /// Its sides, the slowest first.
    pub shape: Vec<u64>,
    /// What it holds.
    pub values: Values<'a>,
}

/// What an array holds.
pub enum Values<'a> {
    /// Numbers, NaN where one is undefined.
    Real(Box<dyn Iterator<Item = f64> + Send + 'a>),
    /// Counts.
    Integer(Box<dyn Iterator<Item = u64> + Send + 'a>),
    /// Amplitudes.
    Complex(Box<dyn Iterator<Item = Complex<f64>> + Send + 'a>),
}

/// A picture in pixels and what it shows.
pub(crate) struct Image {
    /// 8-bit sRGB, row by row from the top.
    pub(crate) rgb: Vec<u8>,
    /// Width and height.
    pub(crate) size: [u32; 2],
    /// In ASCII, for the file.
    pub(crate) title: &'static str,
    /// In ASCII, for the file.
    pub(crate) description: String,
    /// What is seen, besides the colours.
    pub(crate) seen: String,
    /// For those who cannot see it.
    pub(crate) alt: &'static str,
    pub(crate) bar: Bar,
    /// What its colours stand for, place by place.
    pub(crate) cells: Vec<Cells>,
}

/// The values behind a picture, or a part of it: columns of cells to the right, rows of them from the top.
pub(crate) struct Cells {
    /// Left, top, right and bottom, as parts of the picture.
    pub(crate) place: [f64; 4],
    /// To the right, and downward.
    pub(crate) axes: [Steps; 2],
    /// What the values are of, plain text.
    pub(crate) quantity: &'static str,
    /// Row by row; NaN where there is none.
    pub(crate) values: Vec<f64>,
}

/// What the places along an axis are.
pub(crate) struct Steps {
    /// Plain text.
    pub(crate) name: String,
    pub(crate) at: At,
}

/// The places along an axis.
pub(crate) enum At {
    /// Each so much after the other; where a cell is of several, so many.
    Even { first: f64, step: f64, count: usize, each: usize },
    /// By their names.
    Named(Vec<String>),
}

impl Cells {
    /// Of a whole picture of frequencies `m` up to these, the y axis up.
    pub(crate) fn of_modes(half: [i32; 2], quantity: &'static str, value: impl Fn([i32; 2]) -> f64) -> Self {
        let [x, y] = half;
        let rows = (-y..=y).rev();
        Self {
            place: [0.0, 0.0, 1.0, 1.0],
            axes: [Steps::even("m_x", -x, 1, 2 * x + 1), Steps::even("m_y", y, -1, 2 * y + 1)],
            quantity,
            values: rows.flat_map(|m1| (-x..=x).map(move |m0| [m0, m1])).map(value).collect(),
        }
    }
}

impl Steps {
    fn even(name: &str, first: i32, step: i32, count: i32) -> Self {
        let at = At::Even { first: first.into(), step: step.into(), count: count.max(0) as usize, each: 1 };
        Self { name: name.into(), at }
    }
}

/// A picture in pixels in a frame with axes and a colour bar of the sequential map.
pub(crate) struct Map<'a> {
    /// Title, subject and note, plain text.
    pub(crate) heading: [Cow<'a, str>; 3],
    pub(crate) pixels: Pixels,
    /// Of its axes.
    pub(crate) labels: [String; 2],
    /// What the colours are values of, and places from 0 to 1 with those.
    pub(crate) quantity: &'static str,
    pub(crate) bar: Vec<(f64, String)>,
    pub(crate) caption: String,
    pub(crate) cells: Cells,
}

/// What the colours stand for.
pub(crate) enum Bar {
    /// Places from 0 to 1 on the sequential map, and their values.
    Sequential(Vec<(f64, String)>),
    /// g at the two ends of the diverging map, whose middle is 1.
    AboutOne([f64; 2]),
}

impl Output {
    /// A table as CSV.
    pub(crate) const fn table(name: &'static str, make: fn(&Analysis) -> Option<Table>) -> Self {
        Self { name, turn: Turn::Table, make: Make::Table(make), place: None, shown: None }
    }

    /// An array as NPY.
    pub(crate) const fn array(name: &'static str, make: fn(&Analysis) -> Option<Array<'_>>) -> Self {
        Self { name, turn: Turn::Array, make: Make::Array(make), place: None, shown: None }
    }

    /// Curves as SVG.
    pub(crate) const fn figure(
        name: &'static str,
        make: fn(&Analysis) -> Option<Figure>,
        heading: &'static str,
        caption: Caption,
    ) -> Self {
        Self {
            name,
            turn: Turn::Figure,
            make: Make::Figure(make),
            place: Some(Place { heading, caption }),
            shown: None,
        }
    }

    /// A picture as PNG.
    pub(crate) const fn image(
        name: &'static str,
        make: fn(&Analysis) -> Option<Image>,
        heading: &'static str,
        caption: Caption,
    ) -> Self {
        Self { name, turn: Turn::Image, make: Make::Image(make), place: Some(Place { heading, caption }), shown: None }
    }

    /// A file that has no place in the page.
    pub(crate) const fn aside(self) -> Self {
        Self { place: None, ..self }
    }

    /// A table of which these columns are shown on a terminal.
    pub(crate) const fn shown(self, heading: &'static str, columns: &'static [&'static str]) -> Self {
        Self { shown: Some(Shown { heading, columns }), ..self }
    }

    /// Written at another turn.
    pub(crate) const fn turn(self, turn: Turn) -> Self {
        Self { turn, ..self }
    }
}
