//! pairwave-viewer opens the viewer. It takes the settings of `pairwave analyze`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::{CommandFactory, FromArgMatches, Parser, error::ErrorKind};
use eframe::egui;
use pairwave::request::{Request, dress};
use pairwave_viewer::app::Viewer;
use pairwave_viewer::files::LocalFiles;
use pairwave_viewer::session::{self, Session};

/// How the samples of a pattern are correlated, live: points, g(r) and P(nu) with error bars while they are measured.
///
/// Without arguments it takes up where the last window ended; the first time it shows a jittered grid. Settings without
/// points are those of a jittered grid.
#[derive(Parser)]
#[command(version, max_term_width = 120)]
struct Arguments {
    /// Open a session that the viewer saved
    #[arg(long, value_name = "FILE", help_heading = "Session", conflicts_with_all = ["files", "sampler"])]
    session: Option<PathBuf>,

    /// Do not take up where the last window ended
    #[arg(long, help_heading = "Session", conflicts_with = "session")]
    fresh: bool,

    #[command(flatten)]
    request: Request,
}

fn main() -> ExitCode {
    let mut command = dress(Arguments::command());
    let matches = command.get_matches_mut();
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.format(&mut command).exit());
    let Arguments { session, fresh, request } = arguments;
    let asked = request != Request::default();
    if asked && session.is_some() {
        // A session has settings of its own.
        let conflict = "--session FILE cannot be used with settings: they are in the session";
        command.error(ErrorKind::ArgumentConflict, conflict).exit();
    }
    if let (Some(name), None) = (&request.input.sampler, request.input.points) {
        let missing = format!("--sampler {name} needs -n N, the number of points");
        command.error(ErrorKind::MissingRequiredArgument, missing).exit();
    }
    let session = match session.map(|path| open(&path)).transpose() {
        Ok(session) => session,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(2);
        }
    };
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("pairwave")
            .with_app_id("pairwave-viewer")
            .with_icon(pairwave_viewer::icon::icon())
            .with_inner_size([1280.0, 820.0])
            .with_min_inner_size([640.0, 420.0])
            .with_drag_and_drop(true),
        ..Default::default()
    };
    let opened = eframe::run_native(
        "pairwave-viewer",
        options,
        Box::new(move |creation| {
            let ctx = creation.egui_ctx.clone();
            let again = ctx.clone();
            let notify = move || again.request_repaint();
            let request = Viewer::with_points(request);
            // A delay, if only of a moment, is one frame; none is two.
            let result = move || ctx.request_repaint_after(Duration::from_millis(1));
            let mut viewer = Viewer::new(request, Box::new(LocalFiles::new(notify)), result)?;
            let drawn_by = creation.wgpu_render_state.as_ref().map(|state| state.adapter.get_info().device_type);
            viewer.drawn_by.clone_from(&creation.wgpu_render_state);
            viewer.drawn_by_processor = drawn_by == Some(eframe::wgpu::DeviceType::Cpu);
            let last = creation.storage.and_then(|storage| storage.get_string(session::LAST));
            match (&session, last) {
                (Some(session), _) => viewer.take_session(session)?,
                (None, Some(last)) if !asked && !fresh => viewer.reopen(&last),
                // Points are others, eyes are not.
                (None, Some(last)) => viewer.keep_theme(&last),
                _ => {}
            }
            Ok(Box::new(viewer))
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

fn open(path: &std::path::Path) -> Result<Session, String> {
    Session::parse(&Session::read(path)?).map_err(|e| format!("{}: {e}", path.display()))
}
