//! The controls by their names: what they do to the request, and what they say when it cannot be.

use std::path::PathBuf;

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use pairwave::request::Request;
use pairwave_viewer::app::Viewer;
use pairwave_viewer::files::{Answer, Choice, Files};

struct NoFiles;
impl Files for NoFiles {
    fn choose(&mut self, _: Choice) {}
    fn save(&mut self, _: &str, _: Vec<u8>) {}
    fn answers(&mut self) -> Vec<Answer> {
        Vec::new()
    }
}

fn harness(line: &str) -> Harness<'static, Viewer> {
    let request = Request::parse(line.split_whitespace().map(String::from)).unwrap();
    let viewer = Viewer::new(request, Box::new(NoFiles), || ()).unwrap();
    Harness::builder()
        .with_size(eframe::egui::vec2(1100., 900.))
        .wgpu()
        .build_ui_state(|ui, v: &mut Viewer| v.ui(ui), viewer)
}

#[test]
fn look() {
    let mut h = harness("--sampler jittered -n 256 -k 20 --device cpu --threads 2");
    for _ in 0..200 {
        h.step();
        std::thread::sleep(std::time::Duration::from_millis(10));
        if h.state().is_settled() {
            break;
        }
    }
    h.step();
    for name in ["Distances", "Frequencies", "Computing", "Panels", "Curves", "Pictures", "Drawn with points"] {
        h.get_by_label(name).click();
        h.step();
        h.step();
    }
    for _ in 0..20 {
        h.step();
    }
    h.render().unwrap().save(PathBuf::from("/tmp/controls.png")).unwrap();
    let all: Vec<_> = h.root().children_recursive().filter_map(|n| n.accesskit_node().label()).collect();
    println!("{all:?}");
}
