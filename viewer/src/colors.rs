//! Colours of the sets: told apart by colour-blind readers, on light and on dark ground.

use egui::Color32;

use eframe::egui;

/// Okabe and Ito (2008), those that stand out on both grounds: blue, vermilion, bluish green, reddish purple.
const SETS: [Color32; 4] = [
    Color32::from_rgb(0, 114, 178),
    Color32::from_rgb(213, 94, 0),
    Color32::from_rgb(0, 158, 115),
    Color32::from_rgb(204, 121, 167),
];

/// The same, lighter, for dark ground.
const SETS_ON_DARK: [Color32; 4] = [
    Color32::from_rgb(86, 180, 233),
    Color32::from_rgb(240, 138, 62),
    Color32::from_rgb(46, 196, 150),
    Color32::from_rgb(222, 155, 192),
];

/// The colour of a set.
pub(crate) fn set(index: usize, dark: bool) -> Color32 {
    if dark { SETS_ON_DARK[index % 4] } else { SETS[index % 4] }
}
