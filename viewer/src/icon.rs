//! The icon of the window: a jittered pattern, a dot per stratum.

use eframe::egui;

const SIDE: u32 = 64;
const STRATA: u32 = 4;

/// 64 by 64 pixels, light dots on dark blue.
pub fn icon() -> egui::IconData {
    let stratum = SIDE as f32 / STRATA as f32;
    let dots: Vec<egui::Pos2> = (0..STRATA * STRATA)
        .map(|i| {
            let (x, y) = (i % STRATA, i / STRATA);
            // Fixed offsets that look irregular.
            let offset = |a: u32| 0.32 + 0.36 * ((a * 7 + i * i * 3) % 11) as f32 / 10.0;
            egui::pos2((x as f32 + offset(2)) * stratum, (y as f32 + offset(5)) * stratum)
        })
        .collect();
    let rgba = (0..SIDE * SIDE)
        .flat_map(|i| {
            let pixel = egui::pos2((i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5);
            let nearest = dots.iter().map(|dot| dot.distance(pixel)).fold(f32::INFINITY, f32::min);
            let dot = (4.5 - nearest).clamp(0.0, 1.0);
            let [r, g, b] = [(12.0, 240.0), (44.0, 248.0), (84.0, 255.0)]
                .map(|(ground, dot_color)| egui::lerp(ground..=dot_color, dot) as u8);
            [r, g, b, 255]
        })
        .collect();
    egui::IconData { rgba, width: SIDE, height: SIDE }
}
