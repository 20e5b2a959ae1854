//! The window: controls at the left, panels in the middle, what is going on at the bottom.

use std::collections::BTreeMap;
use std::time::Duration;

use eframe::egui;
use eframe::egui_wgpu::RenderState;
use pairwave::display::Panel;
use pairwave::request::Request;

use crate::actions::{Action, Keyed, Take};
use crate::controls::Controls;
use crate::engine::{PACE, SetId, Snapshot};
use crate::export::{self, Exports};
use crate::files::{self, Answer, Choice, Files};
use crate::hover::Hover;
use crate::numbers;
use crate::offscreen;
use crate::panels::{Panels, Scene};
use crate::session::{self, Session};
use crate::set::{MOST_SETS, Set};
use crate::state::State;
use crate::view::{Theme, View};
use crate::worker::Worker;
use crate::{help, status, style};

/// The window.
pub struct Viewer {
    state: State,
    /// Whether the status line has the time it took.
    pub timings: bool,
    /// What draws the window, if it may draw pictures too.
    pub drawn_by: Option<RenderState>,
    /// Whether the processor draws, which measures too: results are then shown less often.
    pub drawn_by_processor: bool,
    /// Time between two results of a set, as the worker was last told.
    pace: Duration,
    hover: Hover,
    controls: Controls,
    panels: Panels,
    exports: Exports,
    files: Box<dyn Files>,
    worker: Worker,
    /// What the worker was last asked for, by set.
    asked: BTreeMap<SetId, Request>,
    /// Whether it was last told to leave a set as it is: every set that it knows is here.
    held: BTreeMap<SetId, bool>,
    /// Whether it was last told to measure at fewer points too.
    climbs: BTreeMap<SetId, bool>,
    /// Which realization it was last told to draw.
    looked: BTreeMap<SetId, u64>,
    has_style: bool,
    /// What the window is called.
    title: String,
}

impl Viewer {
    /// A window with one set. `notify` is called from another thread when there is something new to draw.
    pub fn new(
        request: Request,
        files: Box<dyn Files>,
        notify: impl Fn() + Send + Sync + 'static,
    ) -> std::io::Result<Self> {
        let mut viewer = Self {
            state: State::default(),
            timings: true,
            drawn_by: None,
            drawn_by_processor: false,
            pace: PACE,
            hover: Hover::default(),
            controls: Controls::default(),
            panels: Panels::default(),
            exports: Exports::default(),
            files,
            worker: Worker::new(notify)?,
            asked: BTreeMap::new(),
            held: BTreeMap::new(),
            climbs: BTreeMap::new(),
            looked: BTreeMap::new(),
            has_style: false,
            title: String::new(),
        };
        viewer.add(request);
        Ok(viewer)
    }

    /// What it opens with where nothing is asked for: a sampler whose g and P are known in closed form.
    pub fn first_request() -> Request {
        let mut request = Request::default();
        request.input.sampler = Some("jittered".into());
        request.input.points = Some(1024);
        request.input.realizations = Some(200);
        request
    }

    /// A request that says what is to be done but not to which points, with points.
    pub fn with_points(mut request: Request) -> Request {
        let input = &mut request.input;
        if input.files.is_empty() && input.sampler.is_none() {
            let first = Self::first_request().input;
            input.sampler = first.sampler;
            input.points = input.points.or(first.points);
            input.realizations = input.realizations.or(first.realizations);
        }
        request
    }

    /// Adds a set and selects it; says so if there is no room.
    pub fn add(&mut self, request: Request) {
        self.state.add(request);
    }

    /// Tells the worker what changed, and takes what it found.
    fn exchange(&mut self) {
        self.worker.poll();
        for index in 0..self.state.sets.len() {
            let set = &self.state.sets[index];
            let (id, wanted, held) = (set.id, self.state.wanted(set), set.cancelled || !set.visible);
            if self.held.get(&id) != Some(&held) {
                self.held.insert(id, held);
                self.worker.hold(id, held);
            }
            let climbs = self.state.climbs(set);
            let set = &mut self.state.sets[index];
            if set.visible && self.asked.get(&id) != Some(&wanted) {
                // Other settings start what was cancelled.
                set.cancelled = false;
                self.asked.insert(id, wanted.clone());
                self.worker.set(id, wanted);
            }
            if self.asked.contains_key(&id) && self.climbs.insert(id, climbs).unwrap_or(false) != climbs {
                self.worker.climb(id, climbs);
            }
            if let Some(latest) = self.worker.latest(id) {
                set.snapshot = Some(latest);
            }
            // Fewer realizations than there were, and the one that was chosen is not among them.
            if set.snapshot.as_ref().is_some_and(|snapshot| snapshot.status.is_some()) {
                set.realization = set.realization.min(set.last_realization());
            }
            if self.asked.contains_key(&id) && self.looked.insert(id, set.realization) != Some(set.realization) {
                self.worker.look(id, set.realization);
            }
        }
        let is_there = |id: &SetId| self.state.sets.iter().any(|s| s.id == *id);
        self.held.keys().filter(|id| !is_there(id)).for_each(|id| self.worker.remove(*id));
        self.asked.retain(|id, _| is_there(id));
        self.held.retain(|id, _| is_there(id));
        self.climbs.retain(|id, _| is_there(id));
        self.looked.retain(|id, _| is_there(id));
    }

    /// Has results come as often as drawing them leaves the processor to measuring.
    fn keep_pace(&mut self, ctx: &egui::Context) {
        let pixels = ctx.content_rect().area() * ctx.pixels_per_point().powi(2);
        let pace = if self.drawn_by_processor { pace_of(pixels) } else { PACE };
        if std::mem::replace(&mut self.pace, pace) != pace {
            self.worker.pace(pace);
        }
    }

    /// Names the window after what is in it.
    fn name_window(&mut self, ctx: &egui::Context) {
        let names: Vec<String> = self.state.sets.iter().map(Set::name).collect();
        let title = format!("{} - pairwave", names.join(", "));
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Whether measuring is stopped.
    pub fn is_paused(&self) -> bool {
        self.state.paused
    }

    /// Whether everything asked for is there.
    pub fn is_settled(&self) -> bool {
        self.state.is_settled()
    }

    /// How things are shown.
    pub fn view(&self) -> &View {
        &self.state.view
    }

    /// Shows things otherwise.
    pub fn set_view(&mut self, view: View) {
        self.state.view = view;
    }

    /// What is asked for of each set.
    pub fn requests(&self) -> impl Iterator<Item = &Request> {
        self.state.sets.iter().map(|set| &set.request)
    }

    /// The latest of each set.
    pub fn snapshots(&self) -> impl Iterator<Item = Option<&Snapshot>> {
        self.state.sets.iter().map(|set| set.snapshot.as_deref())
    }

    /// Light or dark, as the last window had it.
    pub fn keep_theme(&mut self, last: &str) {
        if let Ok(session) = Session::parse(last) {
            self.state.view.theme = session.theme();
        }
    }

    /// The session as text.
    pub fn session(&self) -> String {
        Session::of(&self.state).text()
    }

    /// Takes a session; after an error nothing has changed.
    pub fn open_session(&mut self, text: &str) -> Result<(), String> {
        self.take_session(&Session::parse(text)?)
    }

    /// Shows what a session says; after an error nothing has changed.
    pub fn take_session(&mut self, session: &Session) -> Result<(), String> {
        session.show(&mut self.state)
    }

    /// Takes up where the last window ended. If that cannot be, says why and leaves things as they are.
    pub fn reopen(&mut self, text: &str) {
        if let Err(error) = self.open_session(text) {
            let failed = format!("The last session could not be reopened, so this is a new one: {error}");
            self.state.messages.fail(failed);
        }
    }

    /// Draws a frame. What is asked for in a part of it is done before the next part is drawn.
    pub fn ui(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        if !std::mem::replace(&mut self.has_style, true) {
            style::install(&ctx);
            ctx.request_repaint();
            return;
        }
        ctx.set_theme(match self.state.view.theme {
            Theme::System => egui::ThemePreference::System,
            Theme::Light => egui::ThemePreference::Light,
            Theme::Dark => egui::ThemePreference::Dark,
        });
        self.keep_pace(&ctx);
        self.exchange();
        let actions = help::shortcuts(&ctx, self.state.help);
        self.carry_out(&ctx, actions);
        for answer in files::arrived(&ctx, &mut *self.files) {
            self.answer(answer);
        }
        self.name_window(&ctx);
        let bottom = egui::Panel::bottom("status").show(ui, |ui| status::show(ui, &self.state, self.timings));
        self.carry_out(&ctx, bottom.inner);
        if self.state.view.controls {
            let left = egui::Panel::left("controls").resizable(true).default_size(248.0).size_range(220.0..=420.0);
            let left = left.show(ui, |ui| {
                // Beside the controls, never over them.
                ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
                egui::ScrollArea::vertical().show(ui, |ui| self.controls.show(ui, &self.state)).inner
            });
            self.carry_out(&ctx, left.inner);
        }
        if self.state.view.numbers {
            let right = egui::Panel::right("numbers").resizable(true).default_size(300.0).size_range(200.0..=700.0);
            right.show(ui, |ui| numbers::show(ui, &self.state.sets));
        }
        self.exports.can_enlarge = self.drawn_by.is_some();
        let mut actions = Vec::new();
        let middle = egui::CentralPanel::default().show(ui, |ui| {
            let mut scene = Scene {
                sets: &self.state.sets,
                selected: self.state.selected,
                view: &self.state.view,
                hover: &mut self.hover,
                exports: &mut self.exports,
                paused: self.state.paused,
                plain: false,
                actions: &mut actions,
            };
            self.panels.show(ui, &mut scene);
        });
        if self.state.help {
            actions.extend(help::show(&ctx));
        }
        self.state.messages.show(&ctx, middle.response.rect);
        files::announce_drop(&ctx, self.state.sets.len() < MOST_SETS);
        self.carry_out(&ctx, actions);
        self.exports.shoot(&ctx);
        if let Some((panel, take, image)) = self.exports.picture(&ctx) {
            self.take_picture(&ctx, panel, take, image);
        }
        if self.hover.end_frame() {
            ctx.request_repaint();
        }
    }

    /// Does what was asked for, in its order; what was drawn before shows it in the next frame.
    fn carry_out(&mut self, ctx: &egui::Context, actions: Vec<Action>) {
        if !actions.is_empty() {
            ctx.request_repaint();
        }
        for action in actions {
            self.act(ctx, action);
        }
    }

    fn act(&mut self, ctx: &egui::Context, action: Action) {
        let state = &mut self.state;
        match action {
            Action::Keyed(keyed) => self.act_keyed(ctx, keyed),
            Action::Maximize(panel) => state.view.maximized = panel,
            Action::Ask(id, request) => state.change(id, |set| set.request = *request),
            Action::Look(view) => state.view = *view,
            Action::Plane(plane) => state.view.plane = plane,
            Action::Select(id) => state.select(id),
            Action::Show(id, visible) => state.change(id, |set| set.visible = visible),
            Action::Realization(id, index) => state.change(id, |set| set.realization = index),
            Action::Cancel(id, cancelled) => state.change(id, |set| set.cancelled = cancelled),
            Action::Remove(id) => state.remove(id),
            Action::AddSampler(name) => state.add_sampler(name),
            Action::Choose(choice) => self.files.choose(choice),
            Action::Take(_, Take::Command) => self.copy_command(ctx),
            Action::Take(panel, take @ (Take::CopyPicture | Take::Shown)) => self.exports.ask(panel, take),
            Action::Take(panel, Take::Enlarged(times)) => self.enlarge(ctx, panel, times),
            Action::Take(panel, Take::Figure) => self.write_figure(ctx, panel),
            Action::Take(panel, take) => {
                let Some(set) = state.selected_set() else { return };
                let file = export::saved(panel, take, set, state.sets.len());
                self.save(file);
            }
        }
    }

    fn act_keyed(&mut self, ctx: &egui::Context, keyed: Keyed) {
        let state = &mut self.state;
        match keyed {
            Keyed::Help => state.help = !state.help,
            Keyed::Leave if state.help => state.help = false,
            Keyed::Leave | Keyed::AllPanels => state.view.maximized = None,
            Keyed::Pause => {
                state.paused = !state.paused;
                self.worker.pause(state.paused);
            }
            // Which one, its key says: an `Action::Maximize`.
            Keyed::Panel => {}
            Keyed::ResetZoom => self.panels.reset(),
            Keyed::Controls => state.view.controls = !state.view.controls,
            Keyed::Theme => state.view.theme = state.view.theme.next(),
            Keyed::More => state.double(),
            Keyed::Fewer => state.halve(),
            Keyed::Seed => state.reseed(),
            Keyed::Add => state.add_other(),
            Keyed::Duplicate => state.duplicate(),
            Keyed::Remove => state.remove_selected(),
            Keyed::Previous => state.selected = state.selected.saturating_sub(1),
            Keyed::Next => state.selected = (state.selected + 1).min(state.sets.len().saturating_sub(1)),
            Keyed::SaveSession => {
                let text = self.session();
                self.files.save("session.json", text.into_bytes());
            }
            Keyed::OpenSession => self.files.choose(Choice::Session),
            Keyed::CopyCommand => self.copy_command(ctx),
        }
    }

    /// Takes what came of files.
    fn answer(&mut self, answer: Answer) {
        match answer {
            Answer::Points(files) => self.state.add_files(files),
            Answer::Integrand(spec) => self.state.add_integrand(spec),
            Answer::Session { path, text } => match self.open_session(&text) {
                Ok(()) => self.state.messages.note(format!("Opened {}", path.display())),
                Err(error) => self.state.messages.fail(format!("{}: {error}", path.display())),
            },
            Answer::Saved(path) => self.state.messages.note(format!("Saved {}", path.display())),
            Answer::Failed(text) => self.state.messages.fail(text),
        }
    }

    /// Asks where to, and writes a file; or says why there is none.
    fn save(&mut self, file: Result<(String, Vec<u8>), String>) {
        match file {
            Ok((name, bytes)) => self.files.save(&name, bytes),
            Err(error) => self.state.messages.fail(error),
        }
    }

    /// Writes a panel as it is shown, with `times` the pixels along both sides.
    fn enlarge(&mut self, ctx: &egui::Context, panel: Panel, times: u32) {
        let (Some(device), Some(rect)) = (&self.drawn_by, self.exports.place(panel)) else { return };
        let scale = ctx.pixels_per_point();
        let shown = export::pixels(rect, scale).size();
        let size = [shown.x, shown.y].map(|side| side as u32 * times);
        let (own, draw) = self.beside(ctx, panel);
        let image = offscreen::draw(device, &own, size, scale * times as f32, draw);
        let Some(set) = self.state.selected_set() else { return };
        let take = Take::Enlarged(times);
        let file = image.and_then(|image| export::saved_picture(panel, take, &image, set, self.state.sets.len()));
        self.save(file);
    }

    /// Writes a panel as it is shown, as SVG.
    fn write_figure(&mut self, ctx: &egui::Context, panel: Panel) {
        let (Some(rect), Some(set)) = (self.exports.place(panel), self.state.selected_set()) else { return };
        let name = export::name(panel, Take::Figure, set, self.state.sets.len());
        let (own, draw) = self.beside(ctx, panel);
        let text = offscreen::svg(&own, rect.size().round(), ctx.input(|i| i.max_texture_side), draw);
        self.save(text.map(|text| (name, text.into_bytes())));
    }

    /// A context beside that of the window, and what draws a panel there as it is shown here.
    fn beside(&self, ctx: &egui::Context, panel: Panel) -> (egui::Context, impl FnMut(&mut egui::Ui)) {
        let own = egui::Context::default();
        style::install(&own);
        own.set_theme(ctx.theme());
        let (mut panels, mut hover, mut exports) = (self.panels.picture(), Hover::default(), Exports::default());
        let state = &self.state;
        let draw = move |ui: &mut egui::Ui| {
            ui.painter().rect_filled(ui.max_rect(), 0.0, ui.visuals().panel_fill);
            let mut scene = Scene {
                sets: &state.sets,
                selected: state.selected,
                view: &state.view,
                hover: &mut hover,
                exports: &mut exports,
                paused: state.paused,
                plain: true,
                actions: &mut Vec::new(),
            };
            panels.frame(ui, panel, &mut scene);
        };
        (own, draw)
    }

    fn take_picture(&mut self, ctx: &egui::Context, panel: Panel, take: Take, image: Option<egui::ColorImage>) {
        let Some(set) = self.state.selected_set() else { return };
        match image {
            None => {
                self.save(Err(format!("{} is not on the screen any more, so there is no picture of it", panel.name())))
            }
            Some(image) if take == Take::CopyPicture => {
                ctx.copy_image(image);
                self.state.messages.note(format!("Copied the picture of {}", panel.name()));
            }
            Some(image) => {
                let file = export::saved_picture(panel, take, &image, set, self.state.sets.len());
                self.save(file);
            }
        }
    }

    /// The equivalent command, to the clipboard.
    fn copy_command(&mut self, ctx: &egui::Context) {
        let Some(request) = export::command_of(&self.state) else { return };
        ctx.copy_text(request.command());
        self.state.messages.note(export::copied(&request));
    }
}

/// Software Vulkan takes all cores for about 0.1 microseconds per pixel: a tenth of the time for drawing.
fn pace_of(pixels: f32) -> Duration {
    Duration::from_micros(pixels as u64).clamp(PACE, Duration::from_secs(4))
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        Self::ui(self, ui);
    }

    /// Called when the window closes, and twice a minute.
    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        storage.set_string(session::LAST, self.session());
    }
}
