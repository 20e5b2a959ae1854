//! A picture: constant on pixels.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use super::cells::Cells;
use super::entry::{Entry, Given};
use super::shape::Shape;
use super::spec::{Parameter, Takes};
use crate::error::{Error, Result};
use crate::samplers::Accepts;

pub(super) static ENTRY: Entry = Entry {
    formulas: "f_m = sinc sinc exp(-pi i (m_x/N + m_y/M)) DFT(v)/(N M), indices mod N and M; a(r) bilinear between lags of the cyclic autocorrelation",
    source: "as of steps",
    dims: 2..=2,
    parameters: &[
        Parameter::new(
            "file",
            "",
            Takes::Path,
            "PNG, PFM or EXR; colours by their luminance (Rec. 709), no gamma, no alpha",
        ),
        Parameter::number("top", "1", Accepts::Whole(0, 1), "1: the top row is at y = 1; 0: at y = 0"),
    ],
    example: "image:file=photo.png",
    ..Entry::new("image", "a picture, its pixels byte/255 (16 bits: /65535; PFM and EXR as they are)", make)
};

/// More pixels are refused: their transforms would take more than 4 GiB.
pub(super) const MOST_CELLS: usize = 1 << 26;

/// Rows from the top.
struct Picture {
    width: usize,
    height: usize,
    values: Vec<f64>,
}

fn make(given: &Given<'_>) -> Result<Arc<dyn Shape>> {
    let path = Path::new(given.text("file")?);
    let bytes = crate::input::read(path)?;
    let wrong = |reason: String| Error::input(path.display().to_string(), reason);
    let picture = decode(bytes).map_err(wrong)?;
    let Picture { width, height, values } = &picture;
    if width * height == 1 {
        return Err(wrong(
            "a picture of one pixel is a constant, which any points integrate exactly; expected more".into(),
        ));
    }
    if let Some(at) = values.iter().position(|v| !v.is_finite()) {
        let (row, column) = (at / width + 1, at % width + 1);
        return Err(wrong(format!("row {row}, column {column} is {}; expected finite values", values[at])));
    }
    // From rows from the top to cells, x slowest.
    let from_top = given.number("top")? == 1.0;
    let at = |i: usize, j: usize| values[if from_top { height - 1 - j } else { j } * width + i];
    let cells = (0..width * height).map(|c| at(c / height, c % height)).collect();
    Ok(Arc::new(Cells::new([*width, *height, 1], cells)))
}

fn decode(bytes: Vec<u8>) -> Result<Picture, String> {
    match bytes.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => png(bytes),
        [b'P', b'f' | b'F', ..] => pfm(&bytes),
        [0x76, 0x2f, 0x31, 0x01, ..] => exr(bytes),
        _ => Err("this is no PNG, PFM or EXR; expected one of these".into()),
    }
}

fn sized(width: usize, height: usize) -> Result<usize, String> {
    let count = width.checked_mul(height).filter(|&n| n > 0 && n <= MOST_CELLS);
    count.ok_or_else(|| format!("{width} x {height} pixels; expected 1 to {MOST_CELLS} in all"))
}

/// Rec. 709.
fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

fn png(bytes: Vec<u8>) -> Result<Picture, String> {
    let length = bytes.len();
    let damaged = |error: png::DecodingError| format!("damaged PNG: {error}");
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    // Palettes to colours, fewer bits to 8.
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let count = sized(width, height)?;
    // The library takes its length at its word.
    let palette = reader.info().palette.as_ref().map_or(0, |palette| palette.len());
    if !palette.is_multiple_of(3) || palette > 3 * 256 {
        return Err(format!("damaged PNG: a palette of {palette} bytes; expected up to 256 colours of 3 bytes"));
    }
    let size = reader.output_buffer_size().ok_or("too large a PNG")?;
    // What is compressed by Deflate is that much larger at most.
    if size / 1032 > length {
        return Err(format!("truncated PNG: {width} x {height} pixels by its header, in {length} bytes"));
    }
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).map_err(damaged)?;
    let wide = frame.bit_depth == png::BitDepth::Sixteen;
    let sample = |i: usize| match wide {
        true => f64::from(u16::from_be_bytes([buffer[2 * i], buffer[2 * i + 1]])) / 65535.0,
        false => f64::from(buffer[i]) / 255.0,
    };
    let channels = frame.color_type.samples();
    let value = |p: usize| match channels {
        1 | 2 => sample(p * channels),
        _ => luminance(std::array::from_fn(|c| sample(p * channels + c))),
    };
    Ok(Picture { width, height, values: (0..count).map(value).collect() })
}

/// PFM (Debevec): `Pf` or `PF`, width and height, a scale whose sign is the byte order, then floats, the bottom row first.
fn pfm(bytes: &[u8]) -> Result<Picture, String> {
    let mut words = Vec::new();
    let mut at = 0;
    while words.len() < 4 {
        let rest = bytes.get(at..).unwrap_or_default();
        let skip = rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
        let word: Vec<u8> = rest.iter().skip(skip).take(32).take_while(|b| !b.is_ascii_whitespace()).copied().collect();
        if word.is_empty() {
            return Err("damaged PFM: expected Pf or PF, width, height and scale".into());
        }
        at += skip + word.len();
        words.push(String::from_utf8_lossy(&word).into_owned());
    }
    let whole = |text: &str| text.parse::<usize>().map_err(|_| format!("damaged PFM: size {text}; expected a number"));
    let (width, height) = (whole(&words[1])?, whole(&words[2])?);
    let scale: f64 = words[3].parse().map_err(|_| format!("damaged PFM: scale {}; expected a number", words[3]))?;
    let channels = if words[0] == "PF" { 3 } else { 1 };
    let count = sized(width, height)?;
    // One blank after the header.
    let data = bytes.get(at + 1..).unwrap_or_default();
    if data.len() < 4 * channels * count {
        let reason = format!("truncated PFM: {} of {} bytes of data", data.len(), 4 * channels * count);
        return Err(reason);
    }
    let sample = |i: usize| {
        let four = [data[4 * i], data[4 * i + 1], data[4 * i + 2], data[4 * i + 3]];
        f64::from(if scale < 0.0 { f32::from_le_bytes(four) } else { f32::from_be_bytes(four) })
    };
    let value = |p: usize| {
        let p = (height - 1 - p / width) * width + p % width;
        if channels == 1 { sample(p) } else { luminance(std::array::from_fn(|c| sample(3 * p + c))) }
    };
    Ok(Picture { width, height, values: (0..count).map(value).collect() })
}

fn exr(bytes: Vec<u8>) -> Result<Picture, String> {
    use exr::prelude::{MetaData, ReadChannels, ReadLayers, read};
    let damaged = |error: exr::error::Error| format!("damaged EXR: {error}");
    for header in MetaData::read_from_buffered(Cursor::new(&bytes), false).map_err(damaged)?.headers {
        let (width, height) = (header.layer_size.0, header.layer_size.1);
        let size = sized(width, height)?.saturating_mul(header.channels.bytes_per_pixel);
        // More than any of its compressions makes of a picture that is none of one colour.
        if size >> 14 > bytes.len() {
            return Err(format!("truncated EXR: {width} x {height} pixels by its header, in {} bytes", bytes.len()));
        }
    }
    let read = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let image = read.non_parallel().from_buffered(Cursor::new(bytes)).map_err(damaged)?;
    let layer = image.layer_data;
    let (width, height) = (layer.size.0, layer.size.1);
    let count = sized(width, height)?;
    let channel = |name: &str| layer.channel_data.list.iter().find(|c| c.name.to_string() == name);
    let values = |channel: &exr::prelude::AnyChannel<exr::prelude::FlatSamples>| -> Vec<f64> {
        channel.sample_data.values_as_f32().map(f64::from).collect()
    };
    let values = match (channel("R"), channel("G"), channel("B"), layer.channel_data.list.as_slice()) {
        (Some(r), Some(g), Some(b), _) => {
            let (r, g, b) = (values(r), values(g), values(b));
            r.iter().zip(&g).zip(&b).map(|((r, g), b)| luminance([*r, *g, *b])).collect()
        }
        (.., [only]) => values(only),
        _ => match channel("Y") {
            Some(y) => values(y),
            None => {
                let names: Vec<String> = layer.channel_data.list.iter().map(|c| c.name.to_string()).collect();
                return Err(format!("channels {}; expected R, G and B, or Y, or one", names.join(", ")));
            }
        },
    };
    if values.len() != count {
        return Err("channels of fewer samples than pixels; expected one each".into());
    }
    Ok(Picture { width, height, values })
}
