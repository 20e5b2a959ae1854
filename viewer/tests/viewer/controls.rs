//! The controls by their names: what they do to the request, and what they say when it cannot be.

use std::time::Duration;

use crate::common::{Window, request, settle, viewer};
use eframe::egui::{self, accesskit::Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use pairwave::display::{Panel, ToneMap};
use pairwave_viewer::app::Viewer;
use pairwave_viewer::view::View;

fn window(line: &str) -> Window {
    let mut window = Harness::builder()
        .with_size(egui::vec2(1100.0, 1400.0))
        .build_ui_state(|ui, viewer: &mut Viewer| viewer.ui(ui), viewer(&[line]));
    settle(&mut window);
    window
}

fn command(window: &Window) -> String {
    window.state().requests().next().unwrap().command().replace(" --device cpu --threads 2", "")
}

fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    window.run_steps(3);
}

fn type_into(window: &mut Window, label: &str, text: &str) {
    let field = window.get_by_role_and_label(Role::TextInput, label);
    field.focus();
    window.run_steps(2);
    window.key_press_modifiers(egui::Modifiers::CTRL | egui::Modifiers::COMMAND, egui::Key::A);
    window.run_steps(2);
    window.get_by_role_and_label(Role::TextInput, label).type_text(text);
    window.run_steps(2);
    window.key_press(egui::Key::Enter);
    window.run_steps(3);
}

fn choose(window: &mut Window, combo: &str, value: &str) {
    window.get_by_role_and_label(Role::ComboBox, combo).click();
    window.run_steps(3);
    window.get_all_by_label(value).last().unwrap().click();
    window.run_steps(3);
}

#[test]
fn points_are_chosen_by_name() {
    let mut window = window("--sampler jittered -n 100 -k 4");
    choose(&mut window, "sampler", "poisson");
    assert_eq!(command(&window), "pairwave analyze --sampler poisson -n 100 -k 4");
    window.get_by_role_and_label(Role::SpinButton, "n").set_value_accesskit(120.0);
    window.run_steps(2);
    window.get_by_role_and_label(Role::SpinButton, "seed").set_value_accesskit(7.0);
    window.run_steps(2);
    assert_eq!(command(&window), "pairwave analyze --sampler poisson -n 120 -k 4 --seed 7");
    // Strata need a square: the nearest one.
    choose(&mut window, "sampler", "jittered");
    assert_eq!(command(&window), "pairwave analyze --sampler jittered -n 121 -k 4 --seed 7");
    choose(&mut window, "dimension", "3D");
    assert_eq!(command(&window), "pairwave analyze --sampler jittered -n 125 -k 4 --dim 3 --seed 7");
    settle(&mut window);
    assert_eq!(window.state().snapshots().next().unwrap().unwrap().error, None);
}

#[test]
fn parameters_of_samplers_are_controls() {
    let mut window = window("--sampler thomas -n 50 -k 2");
    for parameter in pairwave::samplers::find("thomas").unwrap().parameters {
        let before = command(&window);
        let control = window.get_by_role_and_label(Role::SpinButton, parameter.name);
        let value = control.accesskit_node().numeric_value().unwrap();
        control.set_value_accesskit(value * 1.5);
        window.run_steps(2);
        assert!(command(&window).contains(&format!("--param {}=", parameter.name)), "{before}");
        window.get_by_role_and_label(Role::SpinButton, parameter.name).set_value_accesskit(value);
        window.run_steps(2);
        assert_eq!(command(&window), before);
    }
}

#[test]
fn what_is_refused_says_so_in_its_place() {
    let mut window = window("--sampler random -n 50 -k 4");
    click(&mut window, "Distances");
    type_into(&mut window, "bins", "many");
    assert_eq!(command(&window), "pairwave analyze --sampler random -n 50 -k 4");
    window.get_by_label_contains("bins many: ");
    type_into(&mut window, "bins", "0");
    settle(&mut window);
    // Once, by the name of its control.
    assert_eq!(window.get_all_by_label_contains("bins 0: ").count(), 1);
    // Where no controls are, in the line at the bottom.
    click(&mut window, "Hide the controls (B)");
    assert_eq!(window.get_all_by_label_contains("bins 0: ").count(), 1);
    click(&mut window, "Show the controls (B)");
    type_into(&mut window, "bins", "12");
    settle(&mut window);
    assert!(window.query_by_label_contains("bins 0: ").is_none());
    let shown = window.state().snapshots().next().unwrap().unwrap();
    assert_eq!(shown.analysis.as_ref().unwrap().pair_correlation().unwrap().g.len(), 12);
    type_into(&mut window, "bins", " ");
    assert_eq!(command(&window), "pairwave analyze --sampler random -n 50 -k 4");
}

#[test]
fn looks_measure_nothing_and_more_realizations_are_added() {
    let mut window = window("--sampler random -n 50 -k 20");
    let generation = |window: &Window| window.state().snapshots().next().unwrap().unwrap().generation;
    let before = generation(&window);
    click(&mut window, "Curves");
    click(&mut window, "Pictures");
    choose(&mut window, "colours of P", "magma");
    choose(&mut window, "scale of P", "dB");
    choose(&mut window, "unit of r", "d_hex");
    click(&mut window, "error bands");
    settle(&mut window);
    assert_eq!(generation(&window), before);
    window.get_by_role_and_label(Role::SpinButton, "K").set_value_accesskit(30.0);
    window.run_steps(2);
    settle(&mut window);
    let shown = window.state().snapshots().next().unwrap().unwrap();
    assert!(shown.status.as_ref().unwrap().tracks.iter().all(|t| (t.done, t.kept) == (30, 20)), "{:?}", shown.status);
    window.get_by_label_contains("g(r): 20 kept");
}

#[test]
fn hidden_panels_are_not_computed() {
    let mut window = window("--sampler random -n 50 -k 4 --lag-bins 16");
    click(&mut window, "Panels");
    for panel in ["P(m)", "P(ν)", "anisotropy", "g(h)"] {
        window.get_by_role_and_label(Role::CheckBox, panel).click();
        window.run_steps(3);
    }
    settle(&mut window);
    let shown = window.state().snapshots().next().unwrap().unwrap();
    // Lag settings are idle now, and are no error.
    assert_eq!(shown.error, None);
    let analysis = shown.analysis.as_ref().unwrap();
    assert!(analysis.pair_correlation().is_some() && analysis.radial().is_none() && analysis.vector().is_none());
    window.get_by_label_contains("not computed: P(ν), anisotropy, P(m), g(h)");
    window.get_by_role_and_label(Role::CheckBox, "g(h)").click();
    settle(&mut window);
    let shown = window.state().snapshots().next().unwrap().unwrap();
    assert_eq!(shown.analysis.as_ref().unwrap().vector().unwrap().grid.bins, 16);
}

#[test]
fn numbers_of_all_sets_stand_side_by_side() {
    let mut window = window("--sampler random -n 50 -k 4 --max-frequency 8");
    let smallest = "Smallest nearest-neighbour distance";
    assert!(window.query_by_label(smallest).is_none());
    click(&mut window, "Panels");
    window.get_by_role_and_label(Role::CheckBox, "numbers").click();
    window.run_steps(3);
    settle(&mut window);
    window.get_by_label(smallest);
    let analysis = window.state().snapshots().next().unwrap().unwrap().analysis.clone().unwrap();
    for (name, value) in pairwave::report::panel::scalars(&analysis) {
        assert!(!name.contains(['<', '&', '>']) && !value.contains(['<', '&']), "{name}: {value}");
        assert!(window.query_all_by_label(&value).next().is_some(), "{name}: {value}");
    }
}

#[test]
fn all_lags_are_a_choice() {
    let mut window = window("--sampler random -n 500 -k 1");
    let half = |window: &Window| {
        let shown = window.state().snapshots().next().unwrap().unwrap().analysis.clone().unwrap();
        shown.vector().unwrap().grid.half[0]
    };
    assert!(half(&window) < 0.25);
    click(&mut window, "Lags");
    window.get_by_role_and_label(Role::CheckBox, "all lags").click();
    window.run_steps(3);
    assert_eq!(command(&window), "pairwave analyze --sampler random -n 500 -k 1 --lag-max whole");
    settle(&mut window);
    assert_eq!(half(&window), 0.5);
}

#[test]
fn there_is_room_for_four_sets() {
    let mut window = window("--sampler random -n 50 -k 4 --bins 9");
    for name in ["grid", "halton", "thomas"] {
        click(&mut window, "Add…");
        window.get_all_by_label(name).last().unwrap().click();
        window.run_steps(3);
    }
    assert!(window.get_by_label("Add…").accesskit_node().is_disabled());
    settle(&mut window);
    let requests: Vec<_> = window.state().requests().map(|r| (r.input.sampler.clone().unwrap(), r.bins)).collect();
    let expected = ["random", "grid", "halton", "thomas"].map(|name| (name.to_string(), Some(9)));
    assert_eq!(requests, expected);
    click(&mut window, "Remove grid (Delete)");
    assert_eq!(window.state().requests().count(), 3);
    click(&mut window, "Hide halton");
    window.get_by_label("Show halton");
    assert!(!window.get_by_label("Add…").accesskit_node().is_disabled());
}

#[test]
fn a_file_that_is_missing_is_named_and_the_other_set_is_shown() {
    let file = "there_is_no_such_file.txt";
    let window = window(file);
    assert!(window.get_all_by_label_contains(file).count() >= 2);
    let mut both = Harness::builder()
        .with_size(egui::vec2(1100.0, 1400.0))
        .build_ui_state(|ui, viewer: &mut Viewer| viewer.ui(ui), viewer(&["--sampler random -n 50 -k 4", file]));
    settle(&mut both);
    both.get_all_by_label_contains(file).next().unwrap();
    let found: Vec<_> = both.state().snapshots().map(|s| s.unwrap().analysis.is_some()).collect();
    assert_eq!(found, [true, false]);
}

#[test]
fn sets_in_space_have_planes_to_choose() {
    let mut window = window("--sampler jittered --dim 3 -n 64 -k 4 --max-frequency 6 --lag-bins 12");
    for (index, plane) in ["xy", "xz", "yz"].into_iter().enumerate() {
        window.get_all_by_label(plane).next().unwrap().click();
        window.run_steps(3);
        assert_eq!(window.state().view().plane, index);
    }
    assert!(window.get_all_by_label_contains("plane m_z = 0").next().is_some());
}

#[test]
fn a_set_is_cancelled_and_gone_on_with() {
    let mut window = window("--sampler random -n 50 -k 1");
    window.get_by_role_and_label(Role::SpinButton, "n").set_value_accesskit(2000.0);
    window.get_by_role_and_label(Role::SpinButton, "K").set_value_accesskit(400.0);
    window.run_steps(3);
    let done =
        |window: &Window| window.state().snapshots().next().unwrap().unwrap().status.as_ref().map_or(0, |s| s.done());
    while window.query_by_label_contains("Cancel this set").is_none() || done(&window) == 0 {
        window.run_steps(2);
    }
    click(&mut window, "Cancel this set: what is there stays");
    std::thread::sleep(Duration::from_millis(300));
    window.run_steps(2);
    let at = done(&window);
    assert!(at < 400);
    std::thread::sleep(Duration::from_millis(300));
    window.run_steps(2);
    assert_eq!(done(&window), at);
    window.get_by_label_contains(&format!("cancelled at K = {at} of 400"));
    click(&mut window, "Go on with this set");
    click(&mut window, "Pause (Space)");
    window.get_by_label("Go on (Space)").click();
    settle(&mut window);
    assert_eq!(done(&window), 400);
}

#[test]
fn every_control_has_a_name() {
    let mut window = window("--sampler thomas -n 50 -k 2");
    for group in ["Distances", "Frequencies", "Lags", "Computing", "Panels", "Curves", "Pictures", "Drawn with points"]
    {
        click(&mut window, group);
    }
    let roles =
        [Role::Button, Role::CheckBox, Role::ComboBox, Role::SpinButton, Role::TextInput, Role::Slider, Role::Image];
    let mut named = 0;
    for node in window.root().children_recursive() {
        let node = node.accesskit_node();
        if roles.contains(&node.role()) {
            named += 1;
            assert!(node.label().is_some_and(|l| !l.trim().is_empty()), "{node:?}");
        }
    }
    assert!(named > 50, "{named}");
}

#[test]
fn pictures_are_given_back() {
    let mut window = window("--sampler jittered -n 16 -k 2 --max-frequency 8 --lag-bins 8");
    let held = |window: &Window| window.ctx.tex_manager().read().num_allocated();
    let before = held(&window);
    let all = window.state().view().clone();
    for turn in 0..60 {
        // Other looks, another plane of the same picture, panels hidden and shown, a set more and less.
        let mut view = all.clone();
        view.tone_map = ToneMap::ALL[turn % ToneMap::ALL.len()];
        view.side_by_side = turn % 3 == 0;
        view.maximized = Panel::ALL.get(turn % 11).copied();
        window.state_mut().set_view(view);
        window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::D);
        window.run_steps(3);
        settle(&mut window);
        assert_eq!(window.state().requests().count(), 2);
        window.key_press(egui::Key::Delete);
        window.run_steps(3);
    }
    window.state_mut().set_view(all);
    settle(&mut window);
    assert_eq!(window.state().requests().count(), 1);
    assert_eq!(held(&window), before);
}

#[test]
fn integrands_are_chosen_and_edited() {
    let mut window = window("--sampler jittered -n 16 -k 3 --max-frequency 4 --lag-bins 8");
    let integrands = |window: &Window| window.state().requests().next().unwrap().integrand.clone();
    click(&mut window, "Integrals");
    choose(&mut window, "add integrand", "disk");
    choose(&mut window, "add integrand", "formula");
    assert_eq!(integrands(&window), ["disk", "formula:x*sin(9*x)"]);
    type_into(&mut window, "integrand 1", "disk:r=0.25");
    assert_eq!(integrands(&window), ["disk:r=0.25", "formula:x*sin(9*x)"]);
    type_into(&mut window, "shifts", "4");
    settle(&mut window);
    let shown = window.state().snapshots().next().unwrap().unwrap();
    let found = shown.analysis.as_ref().unwrap().integration().unwrap();
    assert_eq!((found.each.len(), found.shifts, found.each[0].estimates.len()), (2, 4, 3));
    // What is refused says so at the field, and nothing changes.
    type_into(&mut window, "integrand 1", "disk:radius=0.25");
    assert_eq!(integrands(&window)[0], "disk:r=0.25");
    window.get_by_label_contains("disk has no parameter radius");
    type_into(&mut window, "integrand 1", "disc");
    window.get_by_label_contains("did you mean disk?");
    // A formula is the worker's to check.
    type_into(&mut window, "integrand 2", "formula:1/(x");
    settle(&mut window);
    assert!(window.query_all_by_label_contains("formula:1/(x").next().is_some());
    assert!(window.state().snapshots().next().unwrap().unwrap().error.is_some());
    click(&mut window, "Leave out integrand 2");
    assert_eq!(integrands(&window), ["disk:r=0.25"]);
    // With the last one goes what is said of all.
    click(&mut window, "Leave out integrand 1");
    settle(&mut window);
    assert_eq!(command(&window), "pairwave analyze --sampler jittered -n 16 -k 3 --lag-bins 8 --max-frequency 4");
    assert_eq!(window.state().snapshots().next().unwrap().unwrap().error, None);
}

#[test]
fn variances_of_integrals_are_measured_while_they_are_shown() {
    let mut window =
        window("--sampler jittered -n 16 -k 3 --max-frequency 4 --lag-bins 8 --integrand disk --integrand ramp");
    let found = |window: &Window| {
        let shown = window.state().snapshots().next().unwrap().unwrap();
        shown.analysis.as_ref().unwrap().integration().is_some()
    };
    assert!(found(&window));
    let picture = "predicted and observed variance of jittered (n = 16, K = 3): disk:";
    let place = window.get_by_label_contains(picture).rect();
    // What is pointed at is said with its error, and more of it beside the pointer.
    window.hover_at(place.center_top() + egui::vec2(0.0, 0.25 * place.height()));
    window.run_steps(30);
    assert!(window.query_all_by_label_contains(" ± ").next().is_some());
    window.get_by_label_contains("predicted, spectral with its tail: ");
    click(&mut window, "by distance");
    window.get_by_label_contains("variance, of as many random points of jittered");
    click(&mut window, "by frequency");
    window.get_by_label_contains("share of the variance of jittered");
    // Hidden, it is not measured, and its settings are no error.
    click(&mut window, "Panels");
    window.get_by_role_and_label(Role::CheckBox, "integration").click();
    window.run_steps(3);
    settle(&mut window);
    assert!(!found(&window) && window.state().requests().next().unwrap().integrand.len() == 2);
    assert_eq!(window.state().snapshots().next().unwrap().unwrap().error, None);
    window.get_by_label_contains("not computed: integration");
    // A first integrand brings its panel back.
    click(&mut window, "Integrals");
    click(&mut window, "Leave out integrand 2");
    click(&mut window, "Leave out integrand 1");
    choose(&mut window, "add integrand", "disk");
    settle(&mut window);
    assert!(found(&window));
}

#[test]
fn what_was_asked_for_is_not_replaced_by_what_would_be_right() {
    let largest = "--sampler random -n 4 --seed 18446744073709551615";
    let seed = window(largest);
    assert_eq!(command(&seed), format!("pairwave analyze {largest}"));
    assert_eq!(seed.get_by_role_and_label(Role::SpinButton, "seed").value().as_deref(), Some("18446744073709551615"));
    for (line, says) in [
        ("--sampler random -n 0 -k 2", "n 0: expected 1 to"),
        ("--sampler random -n 99999999999999 -k 2", "n 99999999999999: expected 1 to"),
        ("--sampler random -n 16 -k 0", "K 0"),
    ] {
        let window = window(line);
        assert_eq!(command(&window), request(line).command().replace(" --device cpu --threads 2", ""));
        let error = window.state().snapshots().next().flatten().and_then(|s| s.error.clone()).expect("an error");
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn a_set_that_is_added_while_paused_says_so() {
    let mut window = window("--sampler random -n 50 -k 2");
    click(&mut window, "Pause (Space)");
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::D);
    window.run_steps(3);
    assert!(window.query_all_by_label_contains("random: paused").next().is_some());
    click(&mut window, "Go on (Space)");
    settle(&mut window);
    assert!(window.query_by_label_contains("paused").is_none());
}

#[test]
fn warnings_of_the_analysis_are_there_to_read() {
    let mut window = window("--sampler grid -n 64 -k 2");
    let warnings = window.state().snapshots().next().flatten().unwrap().analysis.clone().unwrap().warnings.clone();
    assert!(warnings.iter().any(|w| w.contains("no realization has a pair in")), "{warnings:?}");
    let many =
        if warnings.len() == 1 { "⚠ 1 warning".to_string() } else { format!("⚠ {} warnings", warnings.len()) };
    click(&mut window, &many);
    for warning in &warnings {
        window.get_by_label(warning);
    }
}

#[test]
fn the_line_at_the_bottom_names_what_computed() {
    let mut window = window("--sampler random -n 16 -k 2");
    let device = |window: &Window| window.state().snapshots().next().flatten().unwrap().device.clone();
    assert!(device(&window).starts_with("cpu"), "{}", device(&window));
    let points = View { panels: vec![Panel::Points], ..window.state().view().clone() };
    window.state_mut().set_view(points);
    settle(&mut window);
    assert!(device(&window).starts_with("cpu"), "{}", device(&window));
}

/// The first coordinate of the first point that is drawn, and its realization.
fn drawn(window: &Window) -> (u64, Vec<f64>) {
    let snapshot = window.state().snapshots().next().unwrap().unwrap();
    let points = snapshot.points.as_deref().unwrap_or(&snapshot.analysis.as_ref().unwrap().first);
    (points.first_index(), points.position(0, 0))
}

fn wait_for(window: &mut Window, realization: u64) {
    for _ in 0..2000 {
        window.run_steps(2);
        if drawn(window).0 == realization {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("realization {} is drawn, not {realization}", drawn(window).0);
}

#[test]
fn the_realization_that_is_drawn_is_chosen() {
    let line = "--sampler random -n 16 -k 5";
    let mut window = window(line);
    let source = pairwave::source::Points::open(&request(line).input).unwrap();
    let all = source.batch(0..5, &pairwave::control::Control::default()).unwrap();
    assert_eq!(drawn(&window), (0, all.position(0, 0)));
    // Beyond the last there is none.
    for (asked, there) in [(3.0, 3), (99.0, 4), (2.0, 2)] {
        window.get_by_role_and_label(Role::SpinButton, "realization").set_value_accesskit(asked);
        wait_for(&mut window, there);
        assert_eq!(drawn(&window).1, all.position(there as usize, 0), "{asked}");
    }
    window.run_steps(2);
    window.get_by_label_contains(", 16 points; realization 2");
    // By the keyboard, and while nothing is measured.
    window.get_by_label("Pause (Space)").click();
    window.run_steps(3);
    window.get_by_role_and_label(Role::SpinButton, "realization").focus();
    window.run_steps(2);
    window.key_press(egui::Key::ArrowUp);
    wait_for(&mut window, 3);
    window.get_by_label("Go on (Space)").click();
    window.run_steps(3);
    // Nothing was measured anew, and estimates are of all.
    assert_eq!(window.state().snapshots().next().unwrap().unwrap().analysis.as_ref().unwrap().shape.realizations, 5);
    // Fewer realizations than that: the last of them. Other points: the same number of theirs.
    window.get_by_role_and_label(Role::SpinButton, "K").set_value_accesskit(3.0);
    window.run_steps(2);
    wait_for(&mut window, 2);
    window.get_by_role_and_label(Role::SpinButton, "seed").set_value_accesskit(7.0);
    settle(&mut window);
    wait_for(&mut window, 2);
    let other = pairwave::source::Points::open(&request("--sampler random -n 16 -k 3 --seed 7").input).unwrap();
    let other = other.batch(2..3, &pairwave::control::Control::default()).unwrap();
    assert_eq!(drawn(&window).1, other.position(0, 0));
}

#[test]
fn units_have_the_name_they_were_given() {
    let mut window = window("--sampler random -n 16 -k 2 --unit mm");
    click(&mut window, "Curves");
    for (combo, value) in [("unit of r", "mm"), ("unit of ν", "cycles per mm")] {
        let chosen = window.get_by_role_and_label(Role::ComboBox, combo).accesskit_node().value();
        assert_eq!(chosen.as_deref(), Some(value), "{combo}");
    }
}
