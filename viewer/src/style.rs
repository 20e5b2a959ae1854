//! The style of egui, with what it lacks: a font to fall back on for signs such as ⁻ and ∛, errors that are read with ease,
//! buttons of a sign.

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
        // Those of egui have a contrast of 3 to 4; these have more than 6, on either ground.
        let of = egui::Color32::from_rgb;
        let (error, warning) = if style.visuals.dark_mode {
            (of(255, 123, 114), of(240, 170, 60))
        } else {
            (of(176, 16, 16), of(138, 72, 0))
        };
        (style.visuals.error_fg_color, style.visuals.warn_fg_color) = (error, warning);
        // Legends and colour bars: small, and still read with ease.
        if let Some(small) = style.text_styles.get_mut(&egui::TextStyle::Small) {
            small.size = 11.0;
        }
    });
}

/// A small button that shows a sign and says in words what it does.
pub(crate) fn icon(ui: &mut egui::Ui, sign: &str, text: &str) -> egui::Response {
    let response = ui.small_button(sign).on_hover_text(text);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, text));
    response
}
