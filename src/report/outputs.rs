//! The files of an analysis: every row of every room, and the points.

use std::io::{self, Write};

use base64::Engine as _;

use super::html::color_bar;
use super::{npy, picture_figure, png, points_picture, svg};
use crate::display::figure::Figure;
use crate::error::{Error, Result};
use crate::estimate::Analysis;
use crate::statistics::{Array, Cells, Image, Make, Output, ROOMS, Room};

/// Every room, and the points last.
pub(super) fn sections() -> impl DoubleEndedIterator<Item = &'static dyn Room> {
    ROOMS.iter().copied().chain([&points_picture::Here as &dyn Room])
}

/// Every file there may be, in the order in which they are written.
pub(super) fn all() -> Vec<&'static Output> {
    let mut outputs: Vec<&Output> = sections().flat_map(|section| section.outputs()).collect();
    outputs.sort_by_key(|output| output.turn);
    outputs
}

/// What a file holds.
pub(super) enum Content<'a> {
    Bytes(Vec<u8>),
    Array(Array<'a>),
}

/// A picture as it stands in the page, in HTML, and what is seen in it.
pub(super) struct Picture {
    pub(super) html: String,
    /// What stands below it.
    pub(super) below: String,
    pub(super) seen: String,
    /// Of curves, what is drawn.
    pub(super) figure: Option<Figure>,
    /// The values behind it, each with the turn of its element among those of pictures.
    pub(super) cells: Vec<(usize, Cells)>,
}

/// The content of a file and, of a picture, what the page shows.
pub(super) type Made<'a> = (Content<'a>, Option<Picture>);

/// What an output is of an analysis; `None` where there is nothing.
pub(super) fn made<'a>(output: &Output, a: &'a Analysis) -> io::Result<Option<Made<'a>>> {
    let bytes = |bytes| (Content::Bytes(bytes), None);
    let drawn = |svg: String, figure, cells| {
        let picture = Picture { html: svg.clone(), below: String::new(), seen: String::new(), figure, cells };
        (Content::Bytes(svg.into_bytes()), Some(picture))
    };
    Ok(match output.make {
        Make::Table(make) => make(a).map(|table| table.csv()).transpose()?.map(bytes),
        Make::Array(make) => make(a).map(|array| (Content::Array(array), None)),
        Make::Figure(make) => {
            let figure = make(a).map(|figure| svg::svg(&figure).map(|svg| drawn(svg, Some(figure), Vec::new())));
            figure.transpose().map_err(io::Error::other)?
        }
        Make::Svg(make) => make(a).transpose().map_err(io::Error::other)?.map(|svg| drawn(svg, None, Vec::new())),
        Make::Image(make) => make(a).map(encoded).transpose()?,
        Make::Maps(make) => {
            let maps = make(a);
            let svg = picture_figure::maps(&maps).transpose().map_err(io::Error::other)?;
            // Behind each map comes its bar of colours.
            let cells = maps.into_iter().enumerate().map(|(k, map)| (2 * k, map.cells)).collect();
            svg.map(|svg| drawn(svg, None, cells))
        }
    })
}

/// An image as a file, and in the page with its bar of colours.
fn encoded(image: Image) -> io::Result<(Content<'static>, Option<Picture>)> {
    let bytes = png::image(&image).map_err(io::Error::other)?;
    let data = base64::engine::general_purpose::STANDARD.encode(&bytes);
    let ([width, height], alt, bar) = (image.size, image.alt, color_bar(&image.bar));
    let html =
        format!("<img alt=\"{alt}\" width=\"{width}\" height=\"{height}\" src=\"data:image/png;base64,{data}\">");
    let cells = image.cells.into_iter().map(|cells| (0, cells)).collect();
    Ok((Content::Bytes(bytes), Some(Picture { html, below: bar, seen: image.seen, figure: None, cells })))
}

impl Content<'_> {
    /// Writes it.
    pub(super) fn write(self, file: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Bytes(bytes) => file.write_all(&bytes),
            Self::Array(array) => npy::write(array, file),
        }
    }
}

/// The bytes of one file; `None` where there is nothing, or no such file.
pub(super) fn bytes(name: &str, a: &Analysis) -> Result<Option<Vec<u8>>> {
    let Some(output) = all().into_iter().find(|output| output.name == name) else { return Ok(None) };
    let mut bytes = Vec::new();
    match made(output, a).and_then(|made| made.map(|(content, _)| content.write(&mut bytes)).transpose()) {
        Ok(written) => Ok(written.map(|()| bytes)),
        Err(e) => Err(Error::file(name, e)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_named_once_and_every_picture_has_its_place() {
        let mut names: Vec<&str> = all().iter().map(|output| output.name).collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count);
        let pictured = |output: &Output| !matches!(output.make, Make::Table(_) | Make::Array(_));
        let (pictures, others): (Vec<_>, Vec<_>) = all().into_iter().partition(|output| pictured(output));
        assert!(others.iter().all(|output| output.place.is_none()));
        let aside: Vec<_> = pictures.iter().filter(|output| output.place.is_none()).map(|output| output.name).collect();
        assert_eq!(aside, ["spectrum_grey.png"], "the same as another, as papers print it");
    }
}
