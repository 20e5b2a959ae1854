//! What tests and benches of the window share: a viewer without files, a request from a command line, waiting for a measurement.
#![allow(dead_code, reason = "not every one of them needs all of it")]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use pairwave::analysis::{self, Analysis, Plan};
use pairwave::compute::Device;
use pairwave::control::Control;
use pairwave::report;
use pairwave::request::Request;
use pairwave::source::Points;
use pairwave_viewer::app::Viewer;
use pairwave_viewer::files::{Answer, Choice, Files};

pub type Window = Harness<'static, Viewer>;

/// A place without files: nothing is chosen, nothing is kept.
pub struct NoFiles;
impl Files for NoFiles {
    fn choose(&mut self, _: Choice) {}
    fn save(&mut self, _: &str, _: Vec<u8>) {}
    fn answers(&mut self) -> Vec<Answer> {
        Vec::new()
    }
}

/// The request of a command line, on the processor.
pub fn request(line: &str) -> Request {
    Request::parse(format!("{line} --device cpu --threads 2").split_whitespace().map(String::from)).unwrap()
}

/// All files of a result, by name.
pub fn written(analysis: &Analysis) -> BTreeMap<String, Vec<u8>> {
    let dir = tempfile::tempdir().unwrap();
    let written = report::write(&dir.path().join("out"), analysis, false).unwrap();
    let name = |p: &Path| p.file_name().unwrap().to_string_lossy().into_owned();
    written.iter().map(|p| (name(p), std::fs::read(p).unwrap())).collect()
}

/// All files that the command line writes.
pub fn by_command(request: &Request) -> BTreeMap<String, Vec<u8>> {
    let source = Arc::new(Points::open(&request.input).unwrap());
    let device = pollster::block_on(Device::open(request.device, request.threads)).unwrap();
    let plan = Plan::of(request, &source).unwrap().for_device(device.compute());
    written(&analysis::run(request, source, plan, &device, &Control::default(), &mut |_| ()).unwrap())
}

/// A viewer on these sets, without files.
pub fn viewer(lines: &[&str]) -> Viewer {
    let mut requests = lines.iter().map(|line| request(line));
    let mut viewer = Viewer::new(requests.next().unwrap(), Box::new(NoFiles), || ()).unwrap();
    requests.for_each(|request| viewer.add(request));
    viewer
}

/// Draws until everything asked for is there, and drawn.
pub fn settle(window: &mut Window) {
    let start = Instant::now();
    window.run_steps(2);
    while !window.state().is_settled() {
        assert!(start.elapsed() < Duration::from_secs(300), "still measuring: {:?}", window.state().snapshots().next());
        std::thread::sleep(Duration::from_millis(5));
        window.run_steps(2);
    }
    window.run_steps(4);
}
