//! How things are shown: nothing here is measured anew, but for panels that were hidden.

use eframe::egui;
use pairwave::display::{AxisScale, ColorMap, FrequencyUnit, LengthUnit, Panel, ToneMap};

use super::{choice, row};
use crate::set::Set;
use crate::view::{Theme, View};

/// Draws the controls of the looks; units are named for the selected set.
pub(super) fn show(ui: &mut egui::Ui, selected: Option<&Set>, view: &mut View) {
    let analysis = selected.and_then(Set::analysis);
    ui.separator();
    ui.heading("Show");
    egui::CollapsingHeader::new("Panels").show(ui, |ui| panels(ui, view));
    let (dim, domain) = analysis.map_or((2, None), |a| (a.domain.dim(), Some(a.domain.clone())));
    let name = analysis.and_then(|analysis| analysis.unit);
    let domain = domain.unwrap_or_else(|| pairwave::points::Domain::unit_torus(dim));
    egui::CollapsingHeader::new("Curves").show(ui, |ui| {
        let of_length = |unit: LengthUnit| unit.symbol(dim, name);
        choice(ui, ("unit of r", "Unit of distances"), &mut view.length_unit, &LengthUnit::ALL, of_length);
        let of_frequency = |unit: FrequencyUnit| unit.symbol(&domain, name);
        choice(ui, ("unit of ν", "Unit of frequencies"), &mut view.frequency_unit, &FrequencyUnit::ALL, of_frequency);
        let along = [AxisScale::Linear, AxisScale::Log];
        for (name, scale, scales) in [
            ("scale of r", &mut view.r_scale, &along[..]),
            ("scale of g", &mut view.g_scale, &along[..]),
            ("scale of ν", &mut view.nu_scale, &along[..]),
            ("scale of P", &mut view.p_scale, &AxisScale::ALL[..]),
        ] {
            choice(ui, (name, "Of this axis in all panels"), scale, scales, |s| s.name().to_string());
        }
        ui.checkbox(&mut view.bands, "error bands").on_hover_text("One standard error on either side");
        ui.checkbox(&mut view.closed_forms, "closed forms").on_hover_text("What theory says, where it is known");
    });
    egui::CollapsingHeader::new("Pictures").show(ui, |ui| pictures(ui, view));
    egui::CollapsingHeader::new("Drawn with points").show(ui, |ui| {
        ui.checkbox(&mut view.tiling, "copies around the torus");
        ui.checkbox(&mut view.indices, "indices").on_hover_text("The number of each point, from 0");
        ui.checkbox(&mut view.strata, "strata").on_hover_text("The m^d equal boxes of n = m^d points");
        ui.checkbox(&mut view.links, "nearest neighbours")
            .on_hover_text("Each point is linked to the one nearest to it");
        ui.checkbox(&mut view.integrand_below, "integrand below").on_hover_text(
            "The function that is integrated, in greys from its least to its largest value; in 3D a plane through the middle of the box",
        );
    });
    let specs = selected.map_or(&[][..], |set| &set.request.integrand);
    if specs.len() > 1 {
        let mut chosen = view.integrand.min(specs.len() - 1);
        let all: Vec<usize> = (0..specs.len()).collect();
        let help = "Of several integrands the one that is drawn below points and whose variance is mapped";
        if choice(ui, ("integrand", help), &mut chosen, &all, |k| specs[k].clone()) {
            view.integrand = chosen;
        }
    }
    choice(ui, ("theme", "Light or dark"), &mut view.theme, &Theme::ALL, |t| t.name().to_string());
}

fn panels(ui: &mut egui::Ui, view: &mut View) {
    ui.checkbox(&mut view.numbers, "numbers").on_hover_text(
        "The scalars of all sets: distances of neighbours, hyperuniformity, figures of merit of spectra",
    );
    for panel in Panel::ALL {
        let mut shown = view.panels.contains(&panel);
        if ui.checkbox(&mut shown, panel.name()).on_hover_text(panel.definition()).changed() {
            view.panels.retain(|p| *p != panel);
            if shown {
                view.panels.push(panel);
            }
            view.maximized = None;
        }
    }
}

fn pictures(ui: &mut egui::Ui, view: &mut View) {
    ui.checkbox(&mut view.side_by_side, "side by side")
        .on_hover_text("Pictures and points of all sets, each on its own");
    ui.checkbox(&mut view.paper, "as in papers").on_hover_text(
        "P(m) grey and linear from 0 to 2, frequencies up to 4 per mean spacing, anisotropy above that of an isotropic spectrum",
    );
    if !view.paper {
        ui.checkbox(&mut view.attribution, "variance of an integral").on_hover_text(
            "In P(m) what every frequency adds to the variance of an integral, |f_m|² P(m), on a logarithmic scale",
        );
        tones(ui, view);
    }
    let map = |map: ColorMap| map.name().to_string();
    choice(ui, ("colours of g", "They part at g = 1"), &mut view.vector_colors, &ColorMap::DIVERGING, map);
}

/// What shades and colours P has.
fn tones(ui: &mut egui::Ui, view: &mut View) {
    let kind = |tone: ToneMap| std::mem::discriminant(&tone);
    let all = ToneMap::ALL.map(|t| if kind(t) == kind(view.tone_map) { view.tone_map } else { t });
    let definition = view.tone_map.definition();
    choice(ui, ("tones of P", &definition), &mut view.tone_map, &all, |t| t.name().to_string());
    let dial = match &mut view.tone_map {
        ToneMap::Reinhard => None,
        ToneMap::Linear { max } => Some(("largest P", max, 0.01..=1e6)),
        ToneMap::Log { decades } => Some(("decades", decades, 0.1..=30.0)),
        ToneMap::Decibel { range } => Some(("range in dB", range, 1.0..=300.0)),
    };
    if let Some((name, value, range)) = dial {
        row(ui, name, &definition, |ui, label| {
            let speed = (*value * 0.01).max(1e-3);
            let drag =
                egui::DragValue::new(value).range(range).clamp_existing_to_range(false).speed(speed).max_decimals(3);
            let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
            ui.add_sized(size, drag).labelled_by(label).on_hover_text(&definition);
        });
    }
    let map = |map: ColorMap| map.name().to_string();
    choice(ui, ("colours of P", "Even in lightness"), &mut view.spectrum_colors, &ColorMap::SEQUENTIAL, map);
}
