//! Fonts: those of egui, with one more to fall back on for signs such as ⁻ and ∛.

use eframe::egui;

/// Makes them those of a context. They are there from the next frame on.
pub(crate) fn install(ctx: &egui::Context) {
    let mut fonts = egui::FontDefinitions::default();
    for family in fonts.families.values_mut() {
        if !family.iter().any(|font| font == "Hack") {
            family.push("Hack".into());
        }
    }
    ctx.set_fonts(fonts);
    ctx.all_styles_mut(|style| {
        // Legends and colour bars: small, and still read with ease.
        if let Some(small) = style.text_styles.get_mut(&egui::TextStyle::Small) {
            small.size = 11.0;
        }
    });
}
