//! Processor time per frame of the window, without what the device that draws takes: laid out, and made into triangles.
//! `cargo bench -p pairwave-viewer --bench frame`

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use pairwave::display::Panel;
use pairwave_viewer::app::Viewer;
use pairwave_viewer::view::View;

const FRAMES: usize = 60;

fn frame(window: &mut Harness<'_, Viewer>) -> Duration {
    let start = Instant::now();
    window.step();
    let shapes = window.output().shapes.clone();
    black_box(window.ctx.tessellate(shapes, window.ctx.pixels_per_point()));
    start.elapsed()
}

fn main() {
    let points = View { maximized: Some(Panel::Points), ..View::default() };
    let all_over = View { tiling: true, links: true, strata: true, indices: true, ..points.clone() };
    let four = ["--sampler random -n 1024 -k 20", "--sampler jittered -n 1024 -k 20"].repeat(2);
    let scenes: [(&str, Vec<&str>, View, bool); 7] = [
        ("six panels of one set, settled", vec!["--sampler jittered -n 1024 -k 20"], View::default(), true),
        ("six panels of four sets, settled", four.clone(), View::default(), true),
        (
            "six panels of one set, while realizations come in",
            vec!["--sampler jittered -n 1024 -k 1000000"],
            View::default(),
            false,
        ),
        (
            "the same, 1023 frequencies per axis",
            vec!["--sampler jittered -n 1024 -k 1000000 --max-frequency 1023"],
            View::default(),
            false,
        ),
        ("20,000 points", vec!["--sampler random -n 20000 -k 1"], points, true),
        (
            "5,000 points, with all that is drawn over them",
            vec!["--sampler jittered -n 4900 -k 1"],
            all_over.clone(),
            true,
        ),
        ("20,000 points, with all that is drawn over them", vec!["--sampler jittered -n 19881 -k 1"], all_over, true),
    ];
    println!("milliseconds per frame of 1600 x 1000: median, ninth decile, longest of {FRAMES}");
    for (name, lines, view, settled) in scenes {
        let mut viewer = common::viewer(&lines);
        viewer.set_view(view);
        let mut window = Harness::builder()
            .with_size([1600.0, 1000.0])
            .build_ui_state(|ui, viewer: &mut Viewer| viewer.ui(ui), viewer);
        let there = |viewer: &Viewer| viewer.snapshots().all(|s| s.is_some_and(|s| s.analysis.is_some()));
        while !(if settled { window.state().is_settled() } else { there(window.state()) }) {
            window.step();
            std::thread::sleep(Duration::from_millis(5));
        }
        let first = frame(&mut window);
        window.run_steps(4);
        let mut times: Vec<Duration> = (0..FRAMES)
            .map(|_| {
                if !settled {
                    // New results arrive between frames.
                    std::thread::sleep(Duration::from_millis(30));
                }
                frame(&mut window)
            })
            .collect();
        times.sort();
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        let longest = times[FRAMES - 1].max(first);
        println!("{:6.2} {:6.2} {:6.2}  {name}", ms(times[FRAMES / 2]), ms(times[FRAMES * 9 / 10]), ms(longest));
    }
}
