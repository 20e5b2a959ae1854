//! What is taken away: a panel as a picture, a figure or numbers, and the equivalent command to the clipboard.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui;
use pairwave::analysis::Analysis;
use pairwave::display::Panel;
use pairwave::points::Ensemble;
use pairwave::report::panel::{self, Offers};
use pairwave::request::Request;

use crate::actions::{Keyed, Take};
use crate::set::Set;
use crate::state::State;
use crate::{colors, help, style};

/// Where panels are, and the picture that is asked for of one.
#[derive(Default)]
pub(crate) struct Exports {
    rects: Vec<(Panel, egui::Rect)>,
    shot: Option<Shot>,
    /// The window, once it has been read back.
    arrived: Arc<Mutex<Option<Arc<egui::ColorImage>>>>,
    /// Whether pictures may have more pixels than the screen has.
    pub(crate) can_enlarge: bool,
}

/// A picture of the window that is to be taken, or is under way.
#[derive(Clone, Copy)]
struct Shot {
    panel: Panel,
    take: Take,
    /// Frames until it is taken: the menu is to be gone, and what it covered is not yet under the pointer.
    wait: Option<u32>,
}

impl Exports {
    /// Where a panel is.
    pub(crate) fn place(&self, panel: Panel) -> Option<egui::Rect> {
        self.rects.iter().find(|(of, _)| *of == panel).map(|(_, rect)| *rect)
    }

    /// Remembers where a panel is.
    pub(crate) fn at(&mut self, panel: Panel, rect: egui::Rect) {
        self.rects.retain(|(other, _)| *other != panel);
        self.rects.push((panel, rect));
    }

    /// Asks for the picture of a panel.
    pub(crate) fn ask(&mut self, panel: Panel, take: Take) {
        self.shot = Some(Shot { panel, take, wait: Some(1) });
    }

    /// Takes the picture of the window when it is time to.
    pub(crate) fn shoot(&mut self, ctx: &egui::Context) {
        let Some(wait) = self.shot.as_mut().and_then(|shot| shot.wait.as_mut()) else { return };
        if *wait > 0 {
            *wait -= 1;
            ctx.request_repaint();
            return;
        }
        if let Some(shot) = &mut self.shot {
            shot.wait = None;
        }
        let (arrived, of) = (self.arrived.clone(), ctx.clone());
        ctx.request_screenshot(move |image| {
            *arrived.lock().unwrap_or_else(PoisonError::into_inner) = Some(image);
            of.request_repaint();
        });
    }

    /// The picture of a panel, once it is there.
    pub(crate) fn picture(&mut self, ctx: &egui::Context) -> Option<(Panel, Take, Option<egui::ColorImage>)> {
        let window = self.arrived.lock().unwrap_or_else(PoisonError::into_inner).take()?;
        let Shot { panel, take, .. } = self.shot.take()?;
        let rect = self.place(panel);
        Some((panel, take, rect.and_then(|rect| crop(&window, rect, ctx.pixels_per_point()))))
    }
}

/// The menu of a panel: what there is of the selected set, one of `count`; `can_enlarge`: whether a device draws it. What was chosen.
pub(crate) fn menu(ui: &mut egui::Ui, panel: Panel, set: &Set, count: usize, can_enlarge: bool) -> Option<Take> {
    let button = style::icon(ui, "📤", &format!("Take away {}", panel.name()));
    egui::Popup::menu(&button).width(232.0).show(|ui| entries(ui, panel, set, count, can_enlarge))?.inner
}

fn entries(ui: &mut egui::Ui, panel: Panel, set: &Set, count: usize, can_enlarge: bool) -> Option<Take> {
    let analysis = set.analysis();
    let offers = analysis.map(|analysis| panel::offers(panel, analysis));
    heading(ui, panel, set, count);
    let mut chosen = None;
    for takes in [
        &[Take::CopyPicture, Take::Shown, Take::Enlarged(2), Take::Enlarged(4), Take::Figure][..],
        &[Take::Svg, Take::Png, Take::Csv, Take::Npy],
        &[Take::Command],
    ] {
        ui.separator();
        for &take in takes {
            let (text, about) = words(panel, take);
            let there = match (take, &offers) {
                (Take::CopyPicture | Take::Shown | Take::Figure | Take::Command, _) => true,
                (Take::Enlarged(_), _) => can_enlarge,
                (_, None) => false,
                (take, Some(offers)) => offered(take, offers),
            };
            let mut button = egui::Button::new(text);
            if take == Take::Command {
                button = button.shortcut_text(help::keys(ui.ctx(), Keyed::CopyCommand));
            }
            let response = ui.add_enabled(there, button);
            let response = response.on_hover_text(about).on_disabled_hover_text(why_not(panel, take, set));
            if response.clicked() {
                chosen = Some(take);
                ui.close();
            }
        }
    }
    chosen
}

/// Which set it is, and how far.
fn heading(ui: &mut egui::Ui, panel: Panel, set: &Set, count: usize) {
    ui.horizontal(|ui| {
        if count > 1 {
            ui.colored_label(colors::set(set.color, ui.visuals().dark_mode), "⏺");
        }
        ui.label(format!("{} of {}", panel.name(), set.name()));
    });
    let Some(snapshot) = set.snapshot.as_deref().filter(|s| !s.done) else { return };
    if let (Some(analysis), Some(status)) = (&snapshot.analysis, &snapshot.status) {
        ui.weak(format!("{} of {} realizations so far", analysis.shape.realizations, status.total));
    }
}

/// An entry and what it gives.
fn words(panel: Panel, take: Take) -> (&'static str, &'static str) {
    let points = panel == Panel::Points;
    match take {
        Take::CopyPicture => ("Copy picture", "This panel as it is on the screen, to the clipboard"),
        Take::Shown => ("Picture as shown (PNG)", "This panel as it is on the screen, in its pixels"),
        Take::Enlarged(2) => {
            ("The same at 2 times", "This panel as it is shown, 4 pixels for each: scales, units, zoom and all sets")
        }
        Take::Enlarged(_) => {
            ("The same at 4 times", "This panel as it is shown, 16 pixels for each: scales, units, zoom and all sets")
        }
        Take::Figure => (
            "Figure (SVG)",
            "This panel as it is shown, in lines and texts for print: scales, units, zoom and all sets",
        ),
        Take::Svg => {
            ("Figure of the report (SVG)", "As in the report of pairwave analyze: with axes, units and caption")
        }
        Take::Png => {
            ("Picture (PNG)", "As in the report of pairwave analyze: a pixel or more per cell, in its colours")
        }
        Take::Csv if points => ("Numbers (CSV)", "Coordinates of the realization that is shown"),
        Take::Csv => ("Numbers (CSV)", "The file that pairwave analyze writes, with every error"),
        Take::Npy => ("Numbers (NPY)", "The array that pairwave analyze writes, for NumPy"),
        Take::Command => ("Copy the command", "The pairwave analyze that gives these numbers, to the clipboard"),
    }
}

fn offered(take: Take, offers: &Offers) -> bool {
    match take {
        Take::Svg => offers.svg,
        Take::Png => offers.png,
        Take::Csv => offers.csv,
        Take::Npy => offers.npy,
        Take::CopyPicture | Take::Shown | Take::Enlarged(_) | Take::Figure | Take::Command => true,
    }
}

/// Why an entry gives nothing.
fn why_not(panel: Panel, take: Take, set: &Set) -> String {
    if matches!(take, Take::Enlarged(_)) {
        return "No device draws this window".into();
    }
    if set.analysis().is_none() {
        let error = set.snapshot.as_ref().and_then(|s| s.error.as_ref());
        return error.map_or_else(|| "Nothing is measured yet".into(), |e| format!("Nothing could be measured: {e}"));
    }
    let text = match (panel, take) {
        (Panel::Points, Take::Csv) => "The first realization has no points",
        (Panel::Spectrum, Take::Csv) => "P on a grid is an array: take the NPY",
        (Panel::Vector, Take::Csv) => "g on a grid of lags is an array: take the NPY",
        (Panel::Spectrum | Panel::Vector, Take::Svg | Take::Png) => {
            "There is no picture in one dimension or of a list of frequencies"
        }
        (Panel::Spectrum, Take::Npy) => "A list of frequencies is a table: take the CSV",
        (Panel::Points, Take::Npy) => "Points are a table: take the CSV",
        (Panel::Integration, _) if set.request.integrand.is_empty() => {
            "No integrand is chosen: choose one at the left, under Integrals"
        }
        (Panel::Integration, Take::Npy) => "Variances are a table: take the CSV",
        (Panel::Points | Panel::Pcf | Panel::Radial | Panel::Anisotropy | Panel::Integration, Take::Png) => {
            "Made of lines and dots: take the SVG, or the picture as shown"
        }
        (Panel::Pcf | Panel::Radial | Panel::Anisotropy, Take::Npy) => "Curves are a table: take the CSV",
        _ => "It is not measured: this panel was not shown until now",
    };
    text.into()
}

/// A part of the window in pixels.
pub(crate) fn pixels(rect: egui::Rect, pixels_per_point: f32) -> egui::Rect {
    let place = |at: egui::Pos2| (at.to_vec2() * pixels_per_point).round().max(egui::Vec2::ZERO).to_pos2();
    egui::Rect::from_min_max(place(rect.min), place(rect.max))
}

/// A part of the window; `None` where nothing of it is in the window.
fn crop(window: &egui::ColorImage, rect: egui::Rect, pixels_per_point: f32) -> Option<egui::ColorImage> {
    let whole = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(window.width() as f32, window.height() as f32));
    let part = pixels(rect, pixels_per_point).intersect(whole);
    let [x, y, w, h] = [part.min.x, part.min.y, part.width(), part.height()].map(|at| at as usize);
    part.is_positive().then(|| window.region_by_pixels([x, y], [w, h]))
}

/// A picture as PNG; a window has no holes, so without an alpha channel.
pub(crate) fn encode(image: &egui::ColorImage) -> Result<Vec<u8>, png::EncodingError> {
    let rgb: Vec<u8> = image.pixels.iter().flat_map(|p| [p.r(), p.g(), p.b()]).collect();
    let mut bytes = Vec::new();
    let [width, height] = image.size.map(|side| side as u32);
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    writer.finish()?;
    Ok(bytes)
}

/// The bytes of a file of the report; of points, those that are shown.
fn file(panel: Panel, take: Take, analysis: &Analysis, points: &Ensemble) -> pairwave::Result<Option<Vec<u8>>> {
    match take {
        Take::Csv if panel == Panel::Points => panel::points_csv(points),
        Take::Svg => Ok(panel::svg(panel, analysis)?.map(String::into_bytes)),
        Take::Png => panel::png(panel, analysis),
        Take::Csv => panel::csv(panel, analysis),
        Take::Npy => panel::npy(panel, analysis),
        Take::CopyPicture | Take::Shown | Take::Enlarged(_) | Take::Figure | Take::Command => Ok(None),
    }
}

/// The name of a file: that of the report, after the set where there are several.
pub(crate) fn name(panel: Panel, take: Take, set: &Set, count: usize) -> String {
    let file = match take {
        // The report has one table for both.
        Take::Csv if panel == Panel::Anisotropy => format!("{}.csv", Panel::Radial.slug()),
        Take::Svg => format!("{}.svg", panel.slug()),
        Take::Figure => format!("{}_shown.svg", panel.slug()),
        Take::Csv => format!("{}.csv", panel.slug()),
        Take::Npy => format!("{}.npy", panel.slug()),
        Take::Png => format!("{}.png", panel.slug()),
        Take::Enlarged(times) => format!("{}_shown_{times}x.png", panel.slug()),
        Take::CopyPicture | Take::Shown | Take::Command => format!("{}_shown.png", panel.slug()),
    };
    if count == 1 {
        return file;
    }
    let name = set.name();
    let stem = Path::new(&name).file_stem().map_or(name.clone(), |s| s.to_string_lossy().into_owned());
    let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    format!("{}_{file}", stem.chars().map(plain).collect::<String>())
}

/// What is saved of a panel of the selected set, one of `count`: the name of the file and its bytes, or why there is none.
pub(crate) fn saved(panel: Panel, take: Take, set: &Set, count: usize) -> Result<(String, Vec<u8>), String> {
    let name = name(panel, take, set, count);
    match set.analysis().zip(set.points()).map(|(analysis, points)| file(panel, take, analysis, points)) {
        Some(Ok(Some(bytes))) => Ok((name, bytes)),
        Some(Err(error)) => Err(error.told(pairwave::Setting::flag)),
        Some(Ok(None)) | None => Err(format!("{name}: there are no data for it any more")),
    }
}

/// The same of its picture as shown.
pub(crate) fn saved_picture(
    panel: Panel,
    take: Take,
    image: &egui::ColorImage,
    set: &Set,
    count: usize,
) -> Result<(String, Vec<u8>), String> {
    let name = name(panel, take, set, count);
    match encode(image) {
        Ok(bytes) => Ok((name, bytes)),
        Err(error) => Err(format!("{name}: {error}")),
    }
}

/// What `pairwave analyze` must be asked for to find the numbers that the panels show of the selected set. With no statistic
/// shown, those that are measured where none are named.
pub(crate) fn command_of(state: &State) -> Option<Request> {
    let set = state.selected_set()?;
    let wanted = state.wanted(set);
    Some(if wanted.stats.is_empty() { set.request.only(&Request::default().stats) } else { wanted })
}

/// What is said when the command of a request was copied.
pub(crate) fn copied(request: &Request) -> String {
    let mut paths = request.input.files.iter().chain(&request.edges).chain(&request.frequencies);
    let mut specs = request.integrand.iter().chain(&request.intensity);
    let of_spec = |spec: &String| spec.split_once("file=").is_some_and(|(_, path)| Path::new(path).is_relative());
    let relative = paths.any(|path| path.is_relative() && path.as_os_str() != "-") || specs.any(of_spec);
    match std::env::current_dir().ok().filter(|_| relative) {
        Some(folder) => format!("Copied the command; its paths start in {}", folder.display()),
        None => "Copied the command".into(),
    }
}
