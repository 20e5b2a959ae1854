//! Pictures as .png files, with what they show in words.

use crate::statistics::Image;

/// A picture with its title and description.
pub(super) fn image(image: &Image) -> Result<Vec<u8>, png::EncodingError> {
    encode(&image.rgb, image.size, image.title, &image.description)
}

/// An RGB picture with its title and description, which are in ASCII.
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
    encoder.add_text_chunk("Title".into(), title.into())?;
    encoder.add_text_chunk("Description".into(), description.into())?;
    encoder.add_text_chunk("Software".into(), concat!("pairwave ", env!("CARGO_PKG_VERSION")).into())?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()?;
    Ok(png)
}
