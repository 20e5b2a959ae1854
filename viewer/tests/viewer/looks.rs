//! How it looks: every panel; both themes, two sizes, what the pointer marks, sets overlaid and side by side. What can be told by its
//! label is tested in `controls.rs` and `taking.rs`. Pictures of software Vulkan; `UPDATE_SNAPSHOTS=1 cargo test -p pairwave-viewer
//! looks` accepts what it looks like now.

use crate::common::{Window, settle, viewer};
use eframe::egui;
use egui_kittest::{Harness, SnapshotOptions, SnapshotResults};
use pairwave::display::{AxisScale, Panel};
use pairwave_viewer::app::Viewer;
use pairwave_viewer::view::{Integrals, Theme, View};

const SMALL: [f32; 2] = [900.0, 600.0];
const LARGE: [f32; 2] = [1600.0, 1000.0];
const PANEL: [f32; 2] = [640.0, 440.0];
const JITTERED: &str = "--sampler jittered -n 64 -k 8 --max-frequency 24 --lag-bins 24";
const RANDOM: &str = "--sampler random -n 144 -k 8 --max-frequency 24 --lag-bins 24";

const INTEGRANDS: &str = " --integrand disk --integrand gaussian";

/// A window on these sets, measured to the end; `None` where there is no driver at all and that is allowed.
fn window(lines: &[&str], size: [f32; 2], view: View) -> Option<Window> {
    let accepted = std::env::var("PAIRWAVE_ALLOW_NO_GPU").is_ok_and(|v| v == "1");
    if accepted && pollster::block_on(pairwave::compute::gpu::adapters()).is_empty() {
        eprintln!("not looked at: there is no GPU driver and PAIRWAVE_ALLOW_NO_GPU=1");
        return None;
    }
    let mut viewer = viewer(lines);
    viewer.timings = false;
    viewer.set_view(view);
    let still = |ctx: &egui::Context| {
        ctx.all_styles_mut(|style| {
            style.animation_time = 0.0;
            style.visuals.text_cursor.blink = false;
        });
    };
    let mut window = Harness::builder()
        .with_size(size)
        .with_context_setup(still)
        .wgpu()
        .build_ui_state(|ui, viewer: &mut Viewer| viewer.ui(ui), viewer);
    settle(&mut window);
    Some(window)
}

/// A few pixels may differ, as they do between versions of the rasterizer: fewer than a curve has.
fn alike() -> SnapshotOptions {
    SnapshotOptions::new().threshold(1.0).max_failed_pixels(10_usize)
}

/// Compares with the picture of this name; `seen` fails in the end if one differs.
fn look(seen: &mut SnapshotResults, window: &mut Window, name: &str) {
    window.snapshot_options(name, &alike());
    seen.extend(window.take_snapshot_results());
}

fn light() -> View {
    View { theme: Theme::Light, ..View::default() }
}

fn only(panel: Panel) -> View {
    View { maximized: Some(panel), ..light() }
}

#[test]
fn panels() {
    let mut seen = SnapshotResults::new();
    for panel in Panel::ALL {
        // All that can be drawn over points.
        let view = View { tiling: true, indices: true, strata: true, links: true, ..only(panel) };
        let integrands = if panel == Panel::Integration { INTEGRANDS } else { "" };
        let Some(mut window) = window(&[&format!("{JITTERED}{integrands}")], PANEL, view) else { return };
        look(&mut seen, &mut window, &format!("panel_{}", panel.slug()));
    }
}

#[test]
fn windows() {
    let mut seen = SnapshotResults::new();
    let dark = View { theme: Theme::Dark, ..light() };
    let Some(mut window) = window(&[JITTERED], LARGE, dark.clone()) else { return };
    look(&mut seen, &mut window, "window_dark_large");

    let Some(mut window) = self::window(&[JITTERED], SMALL, light()) else { return };
    // In g(r): the other panels mark the place.
    window.hover_at(egui::pos2(560.0, 180.0));
    window.run_steps(4);
    look(&mut seen, &mut window, "window_pointer");

    let Some(mut window) = self::window(&[JITTERED], SMALL, View { paper: true, controls: false, ..light() }) else {
        return;
    };
    look(&mut seen, &mut window, "window_paper");

    // Nothing that needs a plane, and the rest in its place.
    let Some(mut window) = self::window(&["--sampler jittered --dim 1 -n 16 -k 2"], SMALL, light()) else { return };
    look(&mut seen, &mut window, "window_line");

    // The wheel zooms P along nu; Shift and wheel zoom upward.
    let logarithmic = View { nu_scale: AxisScale::Log, p_scale: AxisScale::Log, ..only(Panel::Radial) };
    let Some(mut window) = self::window(&[JITTERED], PANEL, logarithmic) else { return };
    for (modifiers, name) in [(egui::Modifiers::NONE, "panel_wheel"), (egui::Modifiers::SHIFT, "panel_wheel_shift")] {
        window.hover_at(egui::pos2(520.0, 220.0));
        window.run_steps(2);
        window.event(egui::Event::ModifiersChanged(modifiers));
        window.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: egui::vec2(0.0, 5.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers,
        });
        window.run_steps(60);
        look(&mut seen, &mut window, name);
    }

    let Some(mut window) = self::window(&[JITTERED, RANDOM], SMALL, light()) else { return };
    look(&mut seen, &mut window, "window_two_sets_overlaid");
    window.state_mut().set_view(View { side_by_side: true, ..dark });
    settle(&mut window);
    look(&mut seen, &mut window, "window_two_sets_side_by_side");
}

#[test]
fn integrals() {
    let mut seen = SnapshotResults::new();
    let sets = [JITTERED, RANDOM].map(|line| format!("{line}{INTEGRANDS}"));
    let both = sets.each_ref().map(String::as_str);
    let of = |integrals: Integrals| View { integrals, ..only(Panel::Integration) };
    let Some(mut window) = window(&both, PANEL, of(Integrals::Errors)) else { return };
    look(&mut seen, &mut window, "integrals_variance");
    for (kind, name) in
        [(Integrals::Frequencies, "frequencies"), (Integrals::Distances, "distances"), (Integrals::Numbers, "numbers")]
    {
        window.state_mut().set_view(of(kind));
        settle(&mut window);
        look(&mut seen, &mut window, &format!("integrals_{name}"));
    }
    let map = View { attribution: true, ..only(Panel::Spectrum) };
    window.state_mut().set_view(map);
    settle(&mut window);
    look(&mut seen, &mut window, "integrals_map");
    let below = View { integrand_below: true, integrand: 1, ..only(Panel::Points) };
    window.state_mut().set_view(below);
    settle(&mut window);
    look(&mut seen, &mut window, "integrals_below");

    let removal = format!("{RANDOM}{INTEGRANDS} --intensity formula:0.1+0.9*x --by removal");
    let below = View { integrand_below: true, ..only(Panel::Points) };
    let Some(mut window) = self::window(&[&removal], PANEL, below) else { return };
    look(&mut seen, &mut window, "integrals_removal");

    let Some(mut window) = self::window(&both, SMALL, View { theme: Theme::Dark, ..light() }) else { return };
    look(&mut seen, &mut window, "integrals_window");
}

#[test]
fn a_difference_is_seen() {
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let view = only(Panel::Pcf);
    let Some(mut window) = window(&[JITTERED], PANEL, view.clone()) else { return };
    window.render().unwrap().save(dir.path().join("pcf.png")).unwrap();
    let options = alike().output_path(dir.path());
    let compare =
        |window: &mut Window| egui_kittest::try_image_snapshot_options(&window.render().unwrap(), "pcf", &options);
    compare(&mut window).unwrap();
    window.state_mut().set_view(View { bands: false, ..view });
    window.run_steps(3);
    assert!(compare(&mut window).is_err(), "without its error band g(r) looks the same");
}
