//! What is taken away from the window: files, pictures, the command, sessions; and the keys that do it.
//!
//! Trusts the library's panels and its round trip of requests. Proves that a click in the window hands out the bytes of the
//! command line, that the command in the clipboard is that of those bytes, that a session comes back as it was and that one that
//! cannot is refused with a reason, and that every key does what the help says of it.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::process::Command;
use std::rc::Rc;
use std::time::Duration;

use crate::common::{Window, by_command, request, settle};
use eframe::egui;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use pairwave::display::{AxisScale, Panel};
use pairwave::request::{Request, Statistic};
use pairwave_viewer::actions::Keyed;
use pairwave_viewer::app::Viewer;
use pairwave_viewer::files::{Answer, Choice, Files};
use pairwave_viewer::help::SHORTCUTS;
use pairwave_viewer::session::{self, Session};
use pairwave_viewer::view::{Theme, View};
use serde_json::{Value, json};

/// What came to the files of a test, and what they answer.
#[derive(Default)]
struct Log {
    saved: BTreeMap<String, Vec<u8>>,
    chosen: Vec<Choice>,
    answers: Vec<Answer>,
}

struct Memory(Rc<RefCell<Log>>);

impl Files for Memory {
    fn choose(&mut self, what: Choice) {
        self.0.borrow_mut().chosen.push(what);
    }

    fn save(&mut self, name: &str, bytes: Vec<u8>) {
        let before = self.0.borrow_mut().saved.insert(name.into(), bytes);
        assert!(before.is_none(), "{name} is written twice");
    }

    fn answers(&mut self) -> Vec<Answer> {
        std::mem::take(&mut self.0.borrow_mut().answers)
    }
}

fn viewer(request: Request) -> (Viewer, Rc<RefCell<Log>>) {
    let log = Rc::<RefCell<Log>>::default();
    (Viewer::new(request, Box::new(Memory(log.clone())), || ()).unwrap(), log)
}

fn open(viewer: Viewer, pixels_per_point: f32) -> Window {
    let builder = Harness::builder().with_size(egui::vec2(1000.0, 700.0)).with_pixels_per_point(pixels_per_point);
    let mut window = builder.wgpu().build_ui_state(|ui, viewer: &mut Viewer| viewer.ui(ui), viewer);
    window.run_steps(2);
    window
}

/// What a frame left on the clipboard.
fn copied(window: &Window) -> Option<String> {
    window.output().platform_output.commands.iter().find_map(|c| match c {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    })
}

/// Presses a key; what is on the clipboard then.
fn press(window: &mut Window, modifiers: Modifiers, key: Key) -> Option<String> {
    let event = |pressed| egui::Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
    window.event(egui::Event::ModifiersChanged(modifiers));
    window.event(event(true));
    window.step();
    let copied = copied(window);
    window.event(event(false));
    window.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    window.step();
    window.run_steps(2);
    copied
}

/// Takes an entry of the menu of a panel; what is on the clipboard then.
fn take(window: &mut Window, panel: Panel, entry: &str) -> Option<String> {
    window.get_by_label(&format!("Take away {}", panel.name())).click();
    window.step();
    window.run_steps(2);
    window.get_by_label_contains(entry).click();
    window.step();
    let copied = copied(window);
    // Nothing is under the pointer while the screen is read.
    window.remove_cursor();
    window.step();
    window.run_steps(4);
    copied
}

/// Which entries of its menu a panel does not have.
fn disabled(window: &mut Window, panel: Panel) -> Vec<&'static str> {
    window.get_by_label(&format!("Take away {}", panel.name())).click();
    window.step();
    window.run_steps(2);
    let entries = ["Figure of the report (SVG)", "Picture (PNG)", "Numbers (CSV)", "Numbers (NPY)"];
    let off = |entry: &&str| window.get_by_label(entry).accesskit_node().is_disabled();
    let found = entries.into_iter().filter(off).collect();
    press(window, Modifiers::NONE, Key::Escape);
    found
}

/// The request that a shell makes of a command.
fn pasted(command: &str) -> Request {
    let script = format!("pairwave() {{ printf '%s\\0' \"$@\"; }}; {command}");
    let words = Command::new("sh").args(["-c", &script]).output().unwrap().stdout;
    let words = String::from_utf8(words).unwrap();
    let words: Vec<String> = words.split_terminator('\0').map(String::from).collect();
    assert_eq!(words[0], "analyze", "{command}");
    Request::parse(words[1..].to_vec()).unwrap()
}

fn state(window: &Window) -> Value {
    serde_json::from_str(&window.state().session()).unwrap()
}

const SMALL: &str = "--sampler jittered -n 64 -k 5 --bins 32 --max-frequency 8 --lag-bins 16";

#[test]
fn files_are_those_of_the_copied_command() {
    let line = format!("{SMALL} --integrand disk");
    let (viewer, log) = viewer(request(&line));
    let mut window = open(viewer, 1.0);
    settle(&mut window);
    for panel in Panel::ALL {
        let off = disabled(&mut window, panel);
        for entry in ["Figure of the report (SVG)", "Picture (PNG)", "Numbers (CSV)", "Numbers (NPY)"] {
            if !off.contains(&entry) && (panel, entry) != (Panel::Anisotropy, "Numbers (CSV)") {
                take(&mut window, panel, entry);
            }
        }
    }
    let command = take(&mut window, Panel::Vector, "Copy the command").unwrap();
    assert_eq!(
        Some(&command),
        press(&mut window, Modifiers::CTRL | Modifiers::COMMAND | Modifiers::SHIFT, Key::C).as_ref()
    );
    let copied = pasted(&command);
    let stats = [Statistic::Pcf, Statistic::Radial, Statistic::Spectrum, Statistic::PcfVector];
    assert_eq!(copied, Request { stats: stats.to_vec(), ..request(&line) });

    let saved = std::mem::take(&mut log.borrow_mut().saved);
    let report = by_command(&copied);
    let (of_report, others): (Vec<_>, Vec<_>) = saved.iter().partition(|(name, _)| report.contains_key(*name));
    for (name, bytes) in &of_report {
        assert!(report[*name] == **bytes, "{name} differs");
    }
    let names = |of: &[(&String, &Vec<u8>)]| of.iter().map(|(name, _)| name.to_string()).collect::<Vec<_>>();
    let expected = [
        "anisotropy.svg",
        "pcf.csv",
        "pcf.svg",
        "pcf_vector.npy",
        "pcf_vector.png",
        "points.svg",
        "spectrum.npy",
        "spectrum.png",
        "spectrum_radial.csv",
        "spectrum_radial.svg",
        "variance.csv",
        "variance.svg",
    ];
    assert_eq!(names(&of_report), expected);
    // Pictures with axes are made for the viewer, and points go out as they came in.
    assert_eq!(names(&others), ["pcf_vector.svg", "points.csv", "spectrum.svg"]);
    assert_eq!(saved["points.csv"].iter().filter(|&&byte| byte == b'\n').count(), 65);
    for (name, bytes) in saved.iter().filter(|(name, _)| name.ends_with("svg")) {
        let document = roxmltree::Document::parse(std::str::from_utf8(bytes).unwrap()).unwrap();
        assert_eq!(document.root_element().tag_name().name(), "svg", "{name}");
    }

    // The comparison can fail.
    let other = by_command(&Request { input: request(&format!("{line} --seed 2")).input, ..copied });
    assert!(of_report.iter().all(|(name, bytes)| other[*name] != **bytes));
}

#[test]
fn the_anisotropy_takes_the_table_of_the_rings() {
    let (viewer, log) = viewer(request("--sampler random -n 64 -k 5 --max-frequency 8"));
    let mut window = open(viewer, 1.0);
    settle(&mut window);
    take(&mut window, Panel::Anisotropy, "Numbers (CSV)");
    take(&mut window, Panel::Points, "Copy the command");
    let saved = &log.borrow().saved;
    assert_eq!(saved.keys().collect::<Vec<_>>(), ["spectrum_radial.csv"]);
}

#[test]
fn what_there_is_none_of_is_disabled_and_says_why() {
    let (viewer, _) = viewer(request("--sampler random -n 64 -k 5 --dim 1 --max-frequency 8"));
    let mut window = open(viewer, 1.0);
    settle(&mut window);
    let none: [(Panel, &[&str]); 7] = [
        (Panel::Points, &["Picture (PNG)", "Numbers (NPY)"]),
        (Panel::Pcf, &["Picture (PNG)", "Numbers (NPY)"]),
        (Panel::Radial, &["Picture (PNG)", "Numbers (NPY)"]),
        (Panel::Anisotropy, &["Figure of the report (SVG)", "Picture (PNG)", "Numbers (NPY)"]),
        (Panel::Spectrum, &["Figure of the report (SVG)", "Picture (PNG)", "Numbers (CSV)"]),
        (Panel::Vector, &["Figure of the report (SVG)", "Picture (PNG)", "Numbers (CSV)"]),
        (Panel::Integration, &["Figure of the report (SVG)", "Picture (PNG)", "Numbers (CSV)", "Numbers (NPY)"]),
    ];
    // Those that nothing can be drawn in are left out, unless one is asked for.
    assert!(window.query_by_label("Take away P(m)").is_none());
    for (panel, entries) in none {
        let one = View { maximized: Some(panel), ..window.state().view().clone() };
        window.state_mut().set_view(one);
        settle(&mut window);
        assert_eq!(disabled(&mut window, panel), entries, "{panel:?}");
    }
    let spectrum = View { maximized: Some(Panel::Spectrum), ..window.state().view().clone() };
    window.state_mut().set_view(spectrum);
    settle(&mut window);
    window.get_by_label("Take away P(m)").click();
    window.step();
    window.run_steps(2);
    window.get_by_label("Numbers (CSV)").hover();
    window.run_steps(8);
    window.get_by_label_contains("take the NPY");
}

#[test]
fn of_several_sets_the_selected_one_is_taken() {
    let (viewer, log) = viewer(request("--sampler jittered -n 36 -k 2 --max-frequency 8"));
    let mut window = open(viewer, 1.0);
    let mut sets = state(&window);
    let mut other = sets["sets"][0].clone();
    other["arguments"] = json!(request("--sampler random -n 30 -k 3 --max-frequency 8").arguments());
    other["color"] = json!(1);
    sets["sets"].as_array_mut().unwrap().push(other);
    window.state_mut().open_session(&sets.to_string()).unwrap();
    settle(&mut window);
    take(&mut window, Panel::Pcf, "Numbers (CSV)");
    press(&mut window, Modifiers::NONE, Key::CloseBracket);
    take(&mut window, Panel::Pcf, "Numbers (CSV)");
    let saved = std::mem::take(&mut log.borrow_mut().saved);
    assert_eq!(saved.keys().collect::<Vec<_>>(), ["jittered_pcf.csv", "random_pcf.csv"]);
    for (name, line) in [("jittered", "-n 36 -k 2"), ("random", "-n 30 -k 3")] {
        let report = by_command(&request(&format!("--sampler {name} {line} --stats pcf")));
        assert!(saved[&format!("{name}_pcf.csv")] == report["pcf.csv"], "{name}");
    }
    window.get_by_label("Take away g(r)").click();
    window.step();
    window.run_steps(2);
    window.get_by_label("g(r) of random");
}

#[test]
fn a_command_is_of_what_is_shown_and_survives_a_shell() {
    let dir = tempfile::Builder::new().prefix("it's a $HOME").tempdir_in(".").unwrap();
    let file = std::path::Path::new(dir.path().file_name().unwrap()).join("points & more.csv");
    std::fs::write(&file, "0.1,0.2\n0.7,0.4\n0.3,0.9\n").unwrap();
    let mut asked = request("--bins 8");
    asked.input.files = vec![file];
    let (viewer, _) = viewer(asked.clone());
    let mut window = open(viewer, 1.0);
    press(&mut window, Modifiers::NONE, Key::Num2);
    settle(&mut window);
    let command = take(&mut window, Panel::Pcf, "Copy the command").unwrap();
    assert_eq!(pasted(&command), Request { stats: vec![Statistic::Pcf], ..asked.clone() });
    let here = std::env::current_dir().unwrap();
    window.get_by_label_contains(&format!("its paths start in {}", here.display()));
    // With no statistic shown, those of the request: a command measures something.
    press(&mut window, Modifiers::NONE, Key::Num1);
    let command = take(&mut window, Panel::Points, "Copy the command").unwrap();
    assert_eq!(pasted(&command), asked);
}

/// Rows of an RGB picture.
struct Picture {
    size: [usize; 2],
    rgb: Vec<u8>,
}

fn decode(bytes: &[u8]) -> Picture {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgb).unwrap();
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    Picture { size: [info.width as usize, info.height as usize], rgb }
}

/// Where a picture is in another.
fn place(part: &Picture, whole: &Picture) -> Option<[usize; 2]> {
    let row = |of: &Picture, x: usize, y: usize, width: usize| {
        let start = 3 * (y * of.size[0] + x);
        of.rgb[start..start + 3 * width].to_vec()
    };
    let [w, h] = part.size;
    let rows: Vec<Vec<u8>> = (0..h).map(|y| row(part, 0, y, w)).collect();
    let all = (0..=whole.size[1] - h).flat_map(|y| (0..=whole.size[0] - w).map(move |x| [x, y]));
    all.into_iter().find(|&[x, y]| (0..h).all(|dy| row(whole, x, y + dy, w) == rows[dy]))
}

#[test]
fn a_picture_as_shown_is_the_part_of_the_screen() {
    for scale in [1.0, 1.5] {
        let (viewer, log) = viewer(request("--sampler jittered -n 16 -k 2 --max-frequency 4"));
        let mut window = open(viewer, scale);
        let mut session = state(&window);
        session["view"]["panels"] = json!(["points", "pcf"]);
        window.state_mut().open_session(&session.to_string()).unwrap();
        settle(&mut window);
        let mut places = Vec::new();
        for panel in [Panel::Points, Panel::Pcf] {
            take(&mut window, panel, "Picture as shown (PNG)");
            let part = decode(&log.borrow().saved[&format!("{}_shown.png", panel.slug())]);
            let screen = window.render().unwrap();
            let whole = Picture {
                size: [screen.width() as usize, screen.height() as usize],
                rgb: screen.pixels().flat_map(|p| [p[0], p[1], p[2]]).collect(),
            };
            let [x, y] = place(&part, &whole).unwrap_or_else(|| panic!("{panel:?} is not on the screen"));
            let button = window.get_by_label(&format!("Take away {}", panel.name())).rect();
            let inside =
                |at: f32, from: usize, size: usize| at * scale > from as f32 && at * scale < (from + size) as f32;
            assert!(inside(button.center().x, x, part.size[0]) && inside(button.center().y, y, part.size[1]));
            if scale == 1.0 {
                // From one line of the frame to the other.
                let pixel = |x: usize| &part.rgb[3 * (part.size[1] / 2 * part.size[0] + x)..][..3];
                let last = part.size[0] - 1;
                assert!(pixel(0) == pixel(last) && pixel(1) == pixel(last - 1) && pixel(0) != pixel(1), "{panel:?}");
            }
            places.push(([x, y], part.size));
        }
        // Beside or above each other, they fill the window beside the controls but for the gap between them.
        let [(first, a), (second, b)] = places[..] else { panic!() };
        let along = usize::from(first[0] == second[0]);
        let across = 1 - along;
        assert!(first[across] == second[across] && a[across] == b[across], "{places:?}");
        assert!(((second[along] - first[along] - a[along]) as f32 - 6.0 * scale).abs() <= 1.0, "{places:?}");
        let size = [second[0] + b[0] - first[0], second[1] + b[1] - first[1]].map(|side| side as f32 / scale);
        assert!(size[0] > 700.0 && size[1] > 600.0, "{places:?}");

        window.get_by_label("Take away g(r)").click();
        window.step();
        window.run_steps(2);
        window.get_by_label("Copy picture").click();
        let mut found = None;
        for _ in 0..6 {
            window.step();
            let commands = &window.output().platform_output.commands;
            found = found.or_else(|| {
                commands.iter().find_map(|c| match c {
                    egui::OutputCommand::CopyImage(image) => Some(image.size),
                    _ => None,
                })
            });
        }
        assert_eq!(found, Some(places[1].1));
    }
}

/// With more pixels the same is seen: all sets, scales and zoom, but for the buttons.
#[test]
fn a_picture_is_enlarged() {
    let (mut viewer, log) = viewer(request("--sampler jittered -n 64 -k 40 --bins 24 --max-frequency 4"));
    let setup = egui_kittest::wgpu::default_wgpu_setup();
    viewer.drawn_by = Some(egui_kittest::wgpu::create_render_state(setup, Default::default()));
    viewer.add(request("--sampler random -n 100 -k 40 --bins 24 --max-frequency 4"));
    let log_axes = View { g_scale: AxisScale::Log, side_by_side: true, theme: Theme::Light, ..View::default() };
    viewer.set_view(log_axes);
    let mut window = open(viewer, 1.0);
    settle(&mut window);
    // A zoom is taken along.
    window.hover_at(window.get_by_label_contains("g(r) of").rect().center());
    window.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: egui::vec2(0.0, 5.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    window.run_steps(60);
    window.remove_cursor();
    window.run_steps(2);
    for panel in [Panel::Pcf, Panel::Points, Panel::Spectrum] {
        take(&mut window, panel, "Picture as shown (PNG)");
        take(&mut window, panel, "The same at 2 times");
        let saved = std::mem::take(&mut log.borrow_mut().saved);
        let [shown, large] = ["", "_2x"].map(|end| decode(&saved[&format!("random_{}_shown{end}.png", panel.slug())]));
        assert_eq!(large.size, shown.size.map(|side| 2 * side), "{panel:?}");
        // The means of squares below the title with its buttons: lines are a pixel off here and there, as letters have other widths.
        let mean = |of: &Picture, [x, y]: [usize; 2], side: usize, c: usize| {
            let all = (y..y + side).flat_map(|y| (x..x + side).map(move |x| 3 * (y * of.size[0] + x) + c));
            all.map(|at| f64::from(of.rgb[at])).sum::<f64>() / (side * side) as f64
        };
        let [columns, rows] = shown.size.map(|side| side / 8);
        let squares = (5..rows).flat_map(|y| (0..columns).map(move |x| [8 * x, 8 * y]));
        let each = squares.flat_map(|at| [0, 1, 2].map(|c| (at, c)));
        let off: Vec<f64> =
            each.map(|(at, c)| (mean(&shown, at, 8, c) - mean(&large, at.map(|k| 2 * k), 16, c)).abs()).collect();
        let off = off.iter().sum::<f64>() / off.len() as f64;
        assert!(off < 4.0, "{panel:?}: {off} off in the mean");
    }
}

/// A session in which nothing is as it is at first.
fn special() -> Value {
    json!({
        "format": "pairwave-viewer session",
        "version": 1,
        "folder": std::env::current_dir().unwrap(),
        "sets": [
            {"arguments": ["--sampler", "thomas", "-n", "40", "-k", "8", "--seed", "7", "--param", "sigma=0.1"], "color": 2, "visible": false},
            {"arguments": ["--sampler", "random", "-n", "16", "-k", "8", "--seed", "5", "--bins", "12", "--threads", "1"], "color": 0, "visible": true},
            {"arguments": ["--r-max", "0.30000000000000004", "a b.csv", "é.npy"], "color": 3, "visible": true},
        ],
        "selected": 1,
        "view": {
            "panels": ["pcf", "vector"],
            "maximized": "vector",
            "side-by-side": true,
            "length-unit": "packing-distance",
            "frequency-unit": "sqrt-n",
            "r-scale": "log",
            "nu-scale": "log",
            "g-scale": "decibel",
            "p-scale": "log",
            "bands": false,
            "closed-forms": false,
            "paper": true,
            "tone-map": {"linear": {"max": 1.1000000000000003}},
            "spectrum-colors": "magma",
            "vector-colors": "purple-orange",
            "controls": false,
            "numbers": true,
            "plane": 2,
            "tiling": true,
            "indices": true,
            "strata": true,
            "links": true,
            "integrand-below": true,
            "attribution": true,
            "integrals": "distances",
            "integrand": 1,
            "theme": "dark"
        }
    })
}

/// Other points are opened in the light that the last ones were seen in, and in nothing else of theirs.
#[test]
fn the_theme_of_the_last_window_is_kept() {
    let (mut viewer, _) = viewer(request("--sampler random -n 9"));
    viewer.keep_theme(&special().to_string());
    assert_eq!(*viewer.view(), View { theme: Theme::Dark, ..View::default() });
    viewer.keep_theme("no session");
    assert_eq!(viewer.view().theme, Theme::Dark);
}

#[test]
fn a_session_comes_back_as_it_was() {
    let (mut first, _) = viewer(request("--sampler jittered -n 16"));
    let fresh: Value = serde_json::from_str(&first.session()).unwrap();
    let special = special();
    for (name, value) in special["view"].as_object().unwrap() {
        assert_ne!(*value, fresh["view"][name], "{name} shows nothing");
    }
    assert_eq!(special["view"].as_object().unwrap().len(), fresh["view"].as_object().unwrap().len());
    first.open_session(&special.to_string()).unwrap();
    let text = first.session();
    assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), special);
    let (mut second, _) = viewer(request("--sampler random -n 9"));
    second.open_session(&text).unwrap();
    assert_eq!(second.session(), text);
}

#[test]
fn relative_paths_of_a_session_start_where_it_was_saved() {
    let mut text = special();
    text["folder"] = json!("/elsewhere");
    let integrands = ["--integrand", "image:file=a b.png", "--integrand", "disk", "--integrand", "table:file=/own.csv"];
    text["sets"][0]["arguments"].as_array_mut().unwrap().extend(integrands.map(|word| json!(word)));
    let (mut viewer, _) = viewer(request("--sampler jittered -n 16"));
    viewer.open_session(&text.to_string()).unwrap();
    let found: Value = serde_json::from_str(&viewer.session()).unwrap();
    let arguments = found["sets"][2]["arguments"].as_array().unwrap();
    assert_eq!(arguments[2..], [json!("/elsewhere/a b.csv"), json!("/elsewhere/é.npy")]);
    assert_eq!(found["sets"][1], text["sets"][1]);
    let specs = &viewer.requests().next().unwrap().integrand;
    assert_eq!(*specs, ["image:file=/elsewhere/a b.png", "disk", "table:file=/own.csv"]);
}

#[test]
fn sessions_that_cannot_be_read_say_why_and_change_nothing() {
    let edit = |change: &dyn Fn(&mut Value)| {
        let mut session = special();
        change(&mut session);
        session.to_string()
    };
    let set = |path: &str, value: Value| edit(&|session| *session.pointer_mut(path).unwrap() = value.clone());
    let one = special()["sets"][0].clone();
    let five: Vec<Value> = (0..5).map(|_| one.clone()).collect();
    let cases = [
        (String::new(), "this is no session"),
        ("x,y\n0.1,0.2\n".into(), "this is no session"),
        ("[1, 2]".into(), "this is no session"),
        ("{}".into(), "pairwave-viewer session"),
        ("\u{0}\u{ffff}".into(), "this is no session"),
        (special().to_string()[..200].into(), "EOF"),
        (set("/format", json!("paint")), "paint"),
        (set("/version", json!(2)), "version 2"),
        (set("/version", json!("1")), "expected u64"),
        (edit(&|s| _ = s.as_object_mut().unwrap().remove("version")), "no \"version\": 1"),
        (edit(&|s| _ = s.as_object_mut().unwrap().remove("sets")), "sets"),
        (edit(&|s| s["zoom"] = json!(3)), "zoom"),
        (edit(&|s| s["view"]["glow"] = json!(3)), "glow"),
        (edit(&|s| s["sets"][0]["weight"] = json!(3)), "weight"),
        (set("/sets", json!([])), "0 sets"),
        (set("/sets", json!(five)), "5 sets"),
        (set("/selected", json!(3)), "\"selected\" is 3"),
        (set("/selected", json!(-1)), "-1"),
        (set("/sets/1/color", json!(4)), "set 2: the colour is 4"),
        (set("/sets/1/color", json!(2)), "set 2: the colour is 2"),
        (set("/sets/0/arguments/1", json!("thomsa")), "set 1: --sampler thomsa"),
        (set("/sets/0/arguments/0", json!("--sample")), "set 1: "),
        (set("/sets/0/arguments/3", json!("many")), "many"),
        (set("/sets/0/arguments/9", json!("sigma=-1")), "sigma"),
        (set("/sets/0/arguments", json!([])), "set 1: neither files nor --sampler"),
        (set("/sets/2/arguments", json!(["-"])), "set 3: points from standard input"),
        (set("/sets/0/visible", json!("yes")), "boolean"),
        (set("/view/theme", json!("sepia")), "sepia"),
        (set("/view/panels/0", json!("sound")), "sound"),
        (set("/view/tone-map/linear/max", json!(0)), "\"max\": 0"),
        (set("/view/tone-map", json!({"log": {"decades": -1}})), "\"decades\": -1"),
        (set("/view/plane", json!(3)), "\"plane\" is 3"),
    ];
    let (mut viewer, _) = viewer(request("--sampler jittered -n 16"));
    let before = viewer.session();
    for (text, says) in &cases {
        let error = viewer.open_session(text).expect_err(says);
        assert!(error.contains(says) && !error.contains('\n'), "{says}: {error}");
        assert_eq!(viewer.session(), before, "{says}");
    }
    // What was there before is not in the way of a good one.
    viewer.open_session(&special().to_string()).unwrap();
}

#[derive(Default)]
struct Storage(BTreeMap<String, String>);

impl eframe::Storage for Storage {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.into(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

#[test]
fn the_last_session_is_reopened_or_says_why_not() {
    let (mut first, _) = viewer(request("--sampler jittered -n 16"));
    first.open_session(&special().to_string()).unwrap();
    let mut storage = Storage::default();
    eframe::App::save(&mut first, &mut storage);
    let (mut next, _) = viewer(request("--sampler random -n 9"));
    next.reopen(&storage.0[session::LAST]);
    assert_eq!(next.session(), first.session());

    let (mut other, _) = viewer(request("--sampler random -n 9"));
    let before = other.session();
    other.reopen("{\"format\": \"pairwave-viewer session\", \"version\": 77}");
    assert_eq!(other.session(), before);
    open(other, 1.0).get_by_label_contains("version 77");
}

#[test]
fn settings_without_points_are_those_of_the_first_sampler() {
    let completed = Viewer::with_points(Request::parse(["--bins", "9", "-n", "50"].map(String::from)).unwrap());
    assert_eq!(completed.arguments(), ["--sampler", "jittered", "-n", "50", "-k", "200", "--bins", "9"]);
    let own = request("--sampler random -n 7");
    assert_eq!(Viewer::with_points(own.clone()), own);
}

#[test]
fn the_program_names_what_is_wrong_with_its_session() {
    let bad = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(bad.path(), "{\"format\": \"paint\"}").unwrap();
    let bad = bad.path().to_str().unwrap();
    for (arguments, says) in [
        (vec!["--session", "/nowhere/a.json"], "/nowhere/a.json"),
        (vec!["--session", bad], "paint"),
        (vec!["--session", bad, "--bins", "3"], "--session FILE cannot be used with settings"),
        (vec!["--session", bad, "points.csv"], "--session"),
        (vec!["--session", bad, "--fresh"], "--fresh"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_pairwave-viewer")).args(&arguments).output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && text.contains(says), "{arguments:?}: {text}");
    }
}

/// Presses a key of the table in a window of three sets, and says what came of it.
fn check(action: Keyed, index: usize, modifiers: Modifiers, key: Key) {
    let (viewer, log) = viewer(request("--sampler jittered -n 16"));
    let mut window = open(viewer, 1.0);
    let mut start = special();
    start["view"]["maximized"] = Value::Null;
    start["sets"][2]["arguments"] = json!(["--sampler", "random", "-n", "16", "-k", "8", "--threads", "1"]);
    if matches!(action, Keyed::Leave | Keyed::AllPanels) {
        start["view"]["maximized"] = json!("pcf");
    }
    window.state_mut().open_session(&start.to_string()).unwrap();
    window.run_steps(2);
    let help = |window: &Window| window.query_by_label("Help: keys, mouse and marks").is_some();
    let before = state(&window);
    let argument = |state: &Value, flag: &str| {
        let request = state["sets"][1]["arguments"].as_array().unwrap().clone();
        let at = request.iter().position(|a| a == flag).unwrap();
        request[at + 1].as_str().unwrap().to_string()
    };
    let copied = press(&mut window, modifiers, key);
    let mut after = state(&window);
    assert!(!window.ctx.input(|i| i.key_pressed(key)), "{action:?} leaves its key to others");
    let mut expected = before.clone();
    match action {
        Keyed::Help => {
            assert!(help(&window));
            press(&mut window, modifiers, key);
            assert!(!help(&window));
        }
        Keyed::Leave => {
            expected["view"]["maximized"] = Value::Null;
            assert_eq!(after, expected);
            // With the help open, that goes first.
            window.state_mut().open_session(&start.to_string()).unwrap();
            press(&mut window, Modifiers::NONE, Key::F1);
            press(&mut window, modifiers, key);
            assert!(!help(&window));
            (after, expected) = (state(&window), before);
        }
        Keyed::Pause => {
            assert!(window.state().is_paused());
            press(&mut window, modifiers, key);
            assert!(!window.state().is_paused());
        }
        Keyed::Panel => expected["view"]["maximized"] = json!(Panel::ALL[index]),
        Keyed::AllPanels => expected["view"]["maximized"] = Value::Null,
        Keyed::Controls => expected["view"]["controls"] = json!(true),
        // What it does to plots and pictures is shown where they are.
        Keyed::ResetZoom => {}
        Keyed::Theme => {
            for theme in ["system", "light", "dark"] {
                expected["view"]["theme"] = json!(theme);
                assert_eq!(state(&window), expected);
                press(&mut window, modifiers, key);
            }
            after = expected.clone();
        }
        Keyed::More => expected["sets"][1]["arguments"][5] = json!("16"),
        Keyed::Fewer => expected["sets"][1]["arguments"][5] = json!("4"),
        Keyed::Seed => {
            assert_ne!(argument(&after, "--seed"), argument(&before, "--seed"));
            expected["sets"][1]["arguments"] = after["sets"][1]["arguments"].clone();
        }
        Keyed::Add | Keyed::Duplicate => {
            assert_eq!(after["selected"], 3);
            let arguments = &after["sets"][3]["arguments"];
            match action {
                Keyed::Duplicate => assert_eq!(*arguments, before["sets"][1]["arguments"]),
                _ => assert!(arguments[1] != "thomas" && arguments[1] != "random", "{arguments}"),
            }
            assert_eq!(after["sets"][3]["color"], 1, "the free one");
            press(&mut window, modifiers, key);
            assert_eq!(state(&window), after, "there is no room for a fifth");
            window.get_by_label_contains("There is room for 4 sets");
            after["sets"].as_array_mut().unwrap().pop();
            expected["selected"] = json!(3);
        }
        Keyed::Remove => {
            expected["sets"].as_array_mut().unwrap().remove(1);
            assert_eq!(after, expected);
            press(&mut window, modifiers, key);
            press(&mut window, modifiers, key);
            after = state(&window);
            window.get_by_label("The last set stays");
            let sets = expected["sets"].as_array_mut().unwrap();
            sets.truncate(1);
            expected["selected"] = json!(0);
        }
        Keyed::Previous => expected["selected"] = json!(0),
        Keyed::Next => expected["selected"] = json!(2),
        Keyed::SaveSession => {
            let saved = &log.borrow().saved;
            assert_eq!(saved.keys().collect::<Vec<_>>(), ["session.json"]);
            assert_eq!(saved["session.json"], window.state().session().into_bytes());
        }
        Keyed::OpenSession => {
            assert_eq!(log.borrow().chosen, [Choice::Session]);
            let path = "/home/ada/session.json".into();
            log.borrow_mut().answers.push(Answer::Session { path, text: special().to_string() });
            window.run_steps(2);
            window.get_by_label("Opened /home/ada/session.json");
            (after, expected) = (state(&window), special());
        }
        Keyed::CopyCommand => {
            let arguments = before["sets"][1]["arguments"].as_array().unwrap();
            let own = Request::parse(arguments.iter().map(|a| a.as_str().unwrap().to_string())).unwrap();
            let stats = vec![Statistic::Pcf, Statistic::PcfVector, Statistic::Neighbors];
            assert_eq!(copied.as_deref(), Some(Request { stats, ..own }.command().as_str()));
        }
    }
    assert_eq!(after, expected, "{action:?}");
    assert_eq!(copied.is_some(), action == Keyed::CopyCommand);
    assert_eq!(log.borrow().saved.is_empty(), action != Keyed::SaveSession);
    assert_eq!(log.borrow().chosen.is_empty(), action != Keyed::OpenSession);
}

#[test]
fn every_key_does_what_its_line_says() {
    for shortcut in &SHORTCUTS {
        for (index, key) in shortcut.keys.iter().enumerate() {
            check(shortcut.action, index, key.modifiers, key.logical_key);
        }
    }
}

#[test]
fn no_two_lines_share_a_key() {
    let mut keys: Vec<_> = SHORTCUTS.iter().flat_map(|s| s.keys).map(|k| (k.logical_key, k.modifiers)).collect();
    let count = keys.len();
    keys.sort_by_key(|(key, m)| (*key, m.command, m.shift));
    keys.dedup();
    assert_eq!(keys.len(), count);
    let actions: Vec<_> = SHORTCUTS.iter().map(|s| s.action).collect();
    assert!((1..actions.len()).all(|i| !actions[..i].contains(&actions[i])));
}

#[test]
fn files_have_the_realizations_that_they_have() {
    let (mut viewer, _) = viewer(request("--sampler jittered -n 16"));
    let mut start = special();
    start["selected"] = json!(2);
    viewer.open_session(&start.to_string()).unwrap();
    let mut window = open(viewer, 1.0);
    press(&mut window, Modifiers::NONE, Key::Plus);
    press(&mut window, Modifiers::NONE, Key::S);
    assert_eq!(state(&window), start);
    window.get_by_label_contains("only samplers make others");
}

#[test]
fn the_help_lists_every_key_and_closes() {
    let (viewer, _) = viewer(request("--sampler jittered -n 16 -k 2"));
    let mut window = open(viewer, 1.0);
    window.set_size(egui::vec2(900.0, 600.0));
    window.run_steps(2);
    let title = "Help: keys, mouse and marks";
    assert!(window.query_by_label(title).is_none());
    for way in 0..3 {
        press(&mut window, Modifiers::NONE, Key::F1);
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(900.0, 600.0));
        for shortcut in &SHORTCUTS {
            let keys = shortcut.text(&window.ctx);
            assert!(!keys.is_empty());
            let line = window.get_by_label(shortcut.words);
            assert!(screen.contains_rect(line.rect()), "{keys} is not seen");
            window.get_all_by_label(&keys).next().unwrap();
        }
        // Under the help nothing else is pressed.
        let before = state(&window);
        press(&mut window, Modifiers::NONE, Key::Num2);
        assert_eq!(state(&window), before);
        match way {
            0 => _ = press(&mut window, Modifiers::NONE, Key::Escape),
            1 => {
                window.get_by_label("Close the help (Escape)").click();
                window.step();
                window.run_steps(2);
            }
            _ => {
                let beside = egui::pos2(8.0, 300.0);
                window.hover_at(beside);
                window.drag_at(beside);
                window.drop_at(beside);
                window.step();
                window.run_steps(2);
            }
        }
        assert!(window.query_by_label(title).is_none(), "way {way}");
    }
}

#[test]
fn keys_belong_to_a_text_that_is_typed() {
    let (viewer, _) = viewer(request("--sampler jittered -n 16 -k 2"));
    let mut window = Harness::builder().with_size(egui::vec2(900.0, 600.0)).build_ui_state(
        |ui, (text, viewer): &mut (String, Viewer)| {
            egui::Panel::top("text").show(ui, |ui| {
                let label = ui.label("a text");
                ui.text_edit_singleline(text).labelled_by(label.id);
            });
            viewer.ui(ui);
        },
        (String::new(), viewer),
    );
    window.run_steps(2);
    let maximized = |window: &Harness<'_, (String, Viewer)>| {
        serde_json::from_str::<Value>(&window.state().1.session()).unwrap()["view"]["maximized"].clone()
    };
    window.key_press(Key::Num2);
    window.step();
    assert_eq!(maximized(&window), "pcf");
    window.get_by_role_and_label(egui::accesskit::Role::TextInput, "a text").focus();
    window.step();
    window.run_steps(2);
    for key in [Key::Num3, Key::S, Key::Space, Key::Delete] {
        window.key_press(key);
        window.step();
    }
    // Leaves the text, not the panel.
    window.key_press(Key::Escape);
    window.step();
    assert_eq!(maximized(&window), "pcf");
    assert!(!window.state().1.is_paused());
    window.run_steps(2);
    window.key_press(Key::Escape);
    window.step();
    assert_eq!(maximized(&window), Value::Null);
}

#[test]
fn space_presses_what_has_the_focus() {
    let (viewer, _) = viewer(request("--sampler jittered -n 16 -k 2"));
    let mut window = open(viewer, 1.0);
    window.get_by_label("Take away g(r)").focus();
    window.step();
    window.run_steps(2);
    press(&mut window, Modifiers::NONE, Key::Space);
    assert!(!window.state().is_paused());
    window.get_by_label("Figure of the report (SVG)");
}

#[test]
fn notes_go_and_errors_stay_until_they_are_closed() {
    let (viewer, log) = viewer(request("--sampler jittered -n 16 -k 2"));
    let mut window = open(viewer, 1.0);
    let saved = Answer::Saved("/home/ada/pcf.csv".into());
    log.borrow_mut().answers = vec![Answer::Failed("/home/ada/x.csv: line 3".into()), saved];
    window.run_steps(2);
    let shown = |window: &Window| {
        ["/home/ada/x.csv: line 3", "Saved /home/ada/pcf.csv"].map(|text| window.query_by_label(text).is_some())
    };
    assert_eq!(shown(&window), [true, true]);
    let wait = window.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    assert!(wait < Duration::from_secs(60), "nothing would take the note away");
    // A minute of frames.
    window.run_steps(240);
    assert_eq!(shown(&window), [true, false]);
    window.get_by_label("Close this message").click();
    window.step();
    window.run_steps(2);
    assert_eq!(shown(&window), [false, false]);
    // What is said twice is shown once.
    log.borrow_mut().answers = vec![Answer::Failed("twice".into()), Answer::Failed("twice".into())];
    window.run_steps(3);
    window.get_by_label("twice");
}

#[test]
fn the_menu_of_sessions_saves_and_opens() {
    let (viewer, log) = viewer(request("--sampler jittered -n 16 -k 2"));
    let mut window = open(viewer, 1.0);
    for entry in ["Save session…", "Open session…"] {
        window.get_by_label("Session").click();
        window.step();
        window.run_steps(2);
        window.get_by_label_contains(entry).click();
        window.step();
        window.run_steps(2);
    }
    let saved = String::from_utf8(log.borrow().saved["session.json"].clone()).unwrap();
    assert_eq!(saved, window.state().session());
    Session::parse(&saved).unwrap();
    assert_eq!(log.borrow().chosen, [Choice::Session]);
}

/// The texts of a figure, those of each line of text together.
fn texts(bytes: &[u8]) -> Vec<String> {
    let document = roxmltree::Document::parse(std::str::from_utf8(bytes).unwrap()).unwrap();
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    texts.filter_map(|node| node.text().map(str::to_string)).collect()
}

#[test]
fn a_figure_is_what_is_shown() {
    let (mut viewer, log) = viewer(request(&format!("{SMALL} --unit mm --integrand disk")));
    viewer.add(request(
        "--sampler random -n 30 -k 3 --bins 32 --max-frequency 8 --lag-bins 16 --unit mm --integrand disk",
    ));
    viewer.set_view(View { theme: Theme::Light, r_scale: AxisScale::Log, ..View::default() });
    let mut window = open(viewer, 1.0);
    settle(&mut window);
    for panel in Panel::ALL {
        take(&mut window, panel, "Figure (SVG)");
    }
    let saved = std::mem::take(&mut log.borrow_mut().saved);
    assert!(saved.keys().all(|name| name.starts_with("random_") && name.ends_with("_shown.svg")), "{:?}", saved.keys());
    if let Some(dir) = std::env::var_os("PAIRWAVE_KEEP_FIGURES") {
        saved.iter().for_each(|(name, bytes)| std::fs::write(std::path::Path::new(&dir).join(name), bytes).unwrap());
    }
    let curves = texts(&saved["random_pcf_shown.svg"]);
    // Both sets, the axis in its unit, and its decades.
    for expected in ["jittered", "random", "g(r)"] {
        assert!(curves.iter().any(|text| text == expected), "{expected}: {curves:?}");
    }
    assert!(curves.iter().any(|text| text.contains("(mm)")) && curves.iter().any(|text| text == "0.1"), "{curves:?}");
    let bytes = &saved["random_pcf_shown.svg"];
    for color in ["#0072b2", "#d55e00"] {
        assert!(String::from_utf8_lossy(bytes).contains(&format!("stroke=\"{color}\"")), "{color}");
    }
    // Curves are lines, a spectrum is a picture.
    assert!(!String::from_utf8_lossy(bytes).contains("<image "));
    let picture = String::from_utf8_lossy(&saved["random_spectrum_shown.svg"]);
    assert_eq!(picture.matches("<image ").count(), 1);
    let dots = String::from_utf8_lossy(&saved["random_points_shown.svg"]).matches("<circle ").count();
    assert_eq!(dots, 64 + 30);
    // Of both sets the spectral prediction and what is observed at shifts.
    let variances = &saved["random_variance_shown.svg"];
    assert_eq!(String::from_utf8_lossy(variances).matches("<circle ").count(), 4);
    for expected in ["spectral", "spatial", "shifted", "as it is"] {
        assert!(texts(variances).iter().any(|text| text == expected), "{expected}: {:?}", texts(variances));
    }

    // Other scales and a zoom are another figure.
    let linear = View { r_scale: AxisScale::Linear, ..window.state().view().clone() };
    window.state_mut().set_view(linear);
    window.run_steps(3);
    take(&mut window, Panel::Pcf, "Figure (SVG)");
    let whole = log.borrow_mut().saved.remove("random_pcf_shown.svg").unwrap();
    assert!(texts(&whole).iter().any(|text| text == "0") && whole != *bytes);
    let place = window.get_by_label_contains("g(r) of jittered").rect().center();
    window.hover_at(place);
    window.run_steps(2);
    let (unit, source) = (egui::MouseWheelUnit::Line, egui::MouseWheelSource::Wheel);
    let (delta, phase, modifiers) = (egui::vec2(0.0, 5.0), egui::TouchPhase::Move, Modifiers::NONE);
    window.event(egui::Event::MouseWheel { unit, delta, phase, source, modifiers });
    window.run_steps(60);
    take(&mut window, Panel::Pcf, "Figure (SVG)");
    let zoomed = log.borrow_mut().saved.remove("random_pcf_shown.svg").unwrap();
    assert!(!texts(&zoomed).iter().any(|text| text == "0"), "{:?}", texts(&zoomed));
}
