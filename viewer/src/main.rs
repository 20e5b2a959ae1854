//! pairwave-viewer opens the viewer. It takes the settings of `pairwave analyze`.

use std::process::ExitCode;

use clap::Parser;
use eframe::egui;
use pairwave::request::Request;
use pairwave_viewer::app::Viewer;
use pairwave_viewer::files::LocalFiles;

/// How the samples of a pattern are correlated, live: points, g(r) and P(nu) with error bars while they are measured.
#[derive(Parser)]
#[command(version, max_term_width = 120)]
struct Arguments {
    #[command(flatten)]
    request: Request,
}

fn main() -> ExitCode {
    let request = Arguments::parse().request;
    let asked = !request.input.files.is_empty() || request.input.sampler.is_some();
    let request = if asked { request } else { Viewer::first_request() };
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("pairwave")
            .with_inner_size([1280.0, 820.0])
            .with_min_inner_size([640.0, 420.0])
            .with_drag_and_drop(true),
        ..Default::default()
    };
    let opened = eframe::run_native(
        "pairwave",
        options,
        Box::new(|creation| {
            let ctx = creation.egui_ctx.clone();
            Ok(Box::new(Viewer::new(request, Box::new(LocalFiles), move || ctx.request_repaint())?))
        }),
    );
    match opened {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: no window could be opened: {error}");
            eprintln!("`pairwave analyze` measures the same without a window");
            ExitCode::FAILURE
        }
    }
}
