//! `spectrum.png`: P on the frequency grid as a grey picture, DC at the centre, the y axis up.

use crate::estimate::PowerSpectrum;

/// What a grey level means, in words; the same text is in the file and in the page.
pub(super) const TONE_MAP: &str = "v = min(1, log2(1 + P) / 2): P = 0 black, P = 1 mid-grey, P >= 3 white; colour map: grey, 8-bit sRGB value round(255 v)";

/// A grid may be far larger than any screen; a picture shows at most `|m| <= HALF_SIDE` per axis, so that one mode stays
/// at least one pixel and the page stays a few MB.
const HALF_SIDE: u32 = 1023;

/// Pixels a small grid is magnified towards, by a whole factor.
const TARGET: u32 = 1024;

/// The picture and what it shows.
pub(super) struct SpectrumImage {
    pub(super) png: Vec<u8>,
    pub(super) width: u32,
    pub(super) height: u32,
    /// What is seen, besides the tone map.
    pub(super) caption: String,
}

/// The grey level of `p`.
fn tone(p: f64) -> u8 {
    // NaN casts to 0.
    (255.0 * ((1.0 + p).log2() / 2.0).min(1.0)).round() as u8
}

/// `None` for a list, and in one dimension, where the radial curve already shows all.
pub(super) fn render(spectrum: &PowerSpectrum) -> Result<Option<SpectrumImage>, png::EncodingError> {
    let Some(grid) = spectrum.waves.grid().filter(|grid| grid.dim() >= 2) else { return Ok(None) };
    let [f0, f1, _] = grid.max_frequency();
    let (h0, h1) = (f0.min(HALF_SIDE) as i32, f1.min(HALF_SIDE) as i32);
    let (columns, rows) = (2 * h0 as u32 + 1, 2 * h1 as u32 + 1);
    let zoom = (TARGET / columns.max(rows)).max(1);
    let (width, height) = (columns * zoom, rows * zoom);

    let mut pixels = Vec::with_capacity((width * height) as usize);
    for m1 in (-h1..=h1).rev() {
        let row: Vec<u8> = (-h0..=h0)
            // DC is n, not a fluctuation: black, so that it says nothing.
            .map(|m0| if (m0, m1) == (0, 0) { 0 } else { tone(spectrum.p[grid.half_index([m0, m1, 0])]) })
            .flat_map(|v| std::iter::repeat_n(v, zoom as usize))
            .collect();
        for _ in 0..zoom {
            pixels.extend_from_slice(&row);
        }
    }

    let mut caption = format!("modes m_x = -{h0}..{h0} to the right, m_y = -{h1}..{h1} upward, ");
    if grid.dim() == 3 {
        caption.push_str("the slice m_z = 0, ");
    }
    if h0 < f0 as i32 || h1 < f1 as i32 {
        caption.push_str("the middle of a larger grid, ");
    }
    let each = if zoom == 1 { "one pixel".into() } else { format!("{zoom} x {zoom} pixels") };
    caption.push_str(&format!("each mode {each}, DC (the centre) drawn black"));

    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.add_text_chunk("Title".into(), "Power spectrum P(m)".into())?;
    encoder.add_text_chunk("Description".into(), format!("{caption}. Tone map: {TONE_MAP}"))?;
    encoder.add_text_chunk("Software".into(), concat!("pairwave ", env!("CARGO_PKG_VERSION")).into())?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(Some(SpectrumImage { png, width, height, caption }))
}
