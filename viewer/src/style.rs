//! The style of egui, with what it lacks: a font to fall back on for signs such as ⁻ and ∛, errors that are read with ease.

use eframe::egui;

/// Makes it that of a context. Fonts are there from the next frame on.
pub(crate) fn install(ctx: &egui::Context) {
    let mut fonts = egui::FontDefinitions::default();
    for family in fonts.families.values_mut() {
        if !family.iter().any(|font| font == "Hack") {
            family.push("Hack".into());
        }
    }
    ctx.set_fonts(fonts);
    ctx.all_styles_mut(|style| {
        // Pure red has a contrast of 4 on either ground; these have more than 6.
        let dark = style.visuals.dark_mode;
        style.visuals.error_fg_color =
            if dark { egui::Color32::from_rgb(255, 123, 114) } else { egui::Color32::from_rgb(176, 16, 16) };
        // Legends and colour bars: small, and still read with ease.
        if let Some(small) = style.text_styles.get_mut(&egui::TextStyle::Small) {
            small.size = 11.0;
        }
    });
}
