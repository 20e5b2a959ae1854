//! Pictures as .png files, with what they show in words.

use crate::statistics::Image;

/// A picture with its title and description.
pub(super) fn image(image: &Image) -> Result<Vec<u8>, png::EncodingError> {
    encode(&image.rgb, image.size, image.title, &image.description)
}

/// An RGB picture with its title and description.
pub(crate) fn encode(
    rgb: &[u8],
    [width, height]: [u32; 2],
    title: &str,
    description: &str,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let software = concat!("pairwave ", env!("CARGO_PKG_VERSION"));
    for (key, text) in [("Title", title), ("Description", description), ("Software", software)] {
        // Exponents of large numbers are no Latin letters.
        match text.is_ascii() {
            true => encoder.add_text_chunk(key.into(), text.into())?,
            false => encoder.add_itxt_chunk(key.into(), text.into())?,
        }
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()?;
    Ok(png)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_can_stand_in_a_picture() {
        let png = encode(&[0; 3], [1, 1], "P", "\u{3bb} = 4.1\u{d7}10\u{207b}\u{b3}").unwrap();
        let png = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
        assert_eq!(png.info().uncompressed_latin1_text[0].text, "P");
        assert_eq!(png.info().utf8_text[0].get_text().unwrap(), "\u{3bb} = 4.1\u{d7}10\u{207b}\u{b3}");
    }
}
