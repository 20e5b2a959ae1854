//! Figures as PDF and PNG, with a font that is part of the program.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use crate::report::png::encode;

/// Px of CSS per inch.
const CSS: f32 = 96.0;
/// Pixels per inch.
const FINE: f32 = 300.0;

type Bytes = Result<Vec<u8>, Box<dyn std::error::Error + Send + Sync>>;

/// The figure with its text in a font that is here on any machine; what that lacks is in another.
fn tree(svg: &str) -> Result<Tree, resvg::usvg::Error> {
    let mut options = Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let family = fonts.faces().next().and_then(|face| face.families.first()).map(|family| family.0.clone());
    if let Some(family) = family {
        fonts.set_sans_serif_family(family);
    }
    fonts.load_font_data(epaint_default_fonts::HACK_REGULAR.to_vec());
    Tree::from_str(svg, &options)
}

/// As PDF, its text as text.
pub(super) fn pdf(svg: &str) -> Bytes {
    let page = svg2pdf::PageOptions { dpi: CSS };
    svg2pdf::to_pdf(&tree(svg)?, svg2pdf::ConversionOptions::default(), page).map_err(|e| e.to_string().into())
}

/// As PNG.
pub(super) fn png(svg: &str) -> Bytes {
    let tree = tree(svg)?;
    // Whole pixels that the ground covers: none is left transparent at the sides.
    let pixels = |px: f32| (px * FINE / CSS).floor().max(1.0) as u32;
    let size = [pixels(tree.size().width()), pixels(tree.size().height())];
    let mut picture = Pixmap::new(size[0], size[1]).ok_or("the figure is too large")?;
    resvg::render(&tree, Transform::from_scale(FINE / CSS, FINE / CSS), &mut picture.as_mut());
    let rgb: Vec<u8> = picture.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
    Ok(encode(&rgb, size, "figure", "drawn by pairwave plot")?)
}
