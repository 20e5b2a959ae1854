//! The window: controls at the left, panels in the middle, what is going on at the bottom.

use std::collections::BTreeMap;

use eframe::egui;
use pairwave::display::Panel;
use pairwave::request::Request;

use crate::controls::Controls;
use crate::engine::{SetId, Snapshot};
use crate::export::Exports;
use crate::files::Files;
use crate::hover::Hover;
use crate::messages::{self, Message};
use crate::panels::{Panels, Scene};
use crate::session::Wanted;
use crate::set::{MOST_SETS, Set};
use crate::view::{Theme, View};
use crate::worker::Worker;
use crate::{controls, help, session, status, style};

/// The state of the window.
pub struct Viewer {
    pub(crate) sets: Vec<Set>,
    pub(crate) selected: usize,
    pub(crate) view: View,
    pub(crate) hover: Hover,
    pub(crate) paused: bool,
    pub(crate) help: bool,
    /// Whether the status line has the time it took.
    pub timings: bool,
    /// What came of files, sessions and exports.
    pub(crate) messages: Vec<Message>,
    pub(crate) controls: Controls,
    pub(crate) panels: Panels,
    pub(crate) exports: Exports,
    pub(crate) files: Box<dyn Files>,
    has_style: bool,
    /// What the window is called.
    title: String,
    worker: Worker,
    next_id: SetId,
    /// What the worker was last asked for, by set.
    asked: BTreeMap<SetId, Request>,
    held: BTreeMap<SetId, bool>,
}

impl Viewer {
    /// A window with one set. `notify` is called from another thread when there is something new to draw.
    pub fn new(
        request: Request,
        files: Box<dyn Files>,
        notify: impl Fn() + Send + Sync + 'static,
    ) -> std::io::Result<Self> {
        let mut viewer = Self {
            sets: Vec::new(),
            selected: 0,
            view: View::default(),
            hover: Hover::default(),
            paused: false,
            help: false,
            timings: true,
            messages: Vec::new(),
            controls: Controls::default(),
            panels: Panels::default(),
            exports: Exports::default(),
            files,
            has_style: false,
            title: String::new(),
            worker: Worker::new(notify)?,
            next_id: 1,
            asked: BTreeMap::new(),
            held: BTreeMap::new(),
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
        if self.sets.len() >= MOST_SETS {
            self.fail(format!("There is room for {MOST_SETS} sets: remove one first"));
            return;
        }
        let free = (0..MOST_SETS).find(|c| self.sets.iter().all(|s| s.color != *c));
        self.sets.push(Set {
            id: self.next_id,
            color: free.unwrap_or(0),
            visible: true,
            cancelled: false,
            request,
            snapshot: None,
        });
        self.next_id += 1;
        self.selected = self.sets.len() - 1;
    }

    /// Shows these sets and no others; there must be at least one, and room for all.
    pub(crate) fn replace_sets(&mut self, sets: Vec<Wanted>, selected: usize) {
        for set in self.sets.drain(..) {
            self.worker.remove(set.id);
        }
        for (request, color, visible) in sets {
            self.sets.push(Set { id: self.next_id, color, visible, cancelled: false, request, snapshot: None });
            self.next_id += 1;
        }
        self.selected = selected;
    }

    /// Removes a set; the last one stays.
    pub(crate) fn remove(&mut self, index: usize) {
        if self.sets.len() > 1 && index < self.sets.len() {
            self.worker.remove(self.sets.remove(index).id);
            self.selected = self.selected.min(self.sets.len() - 1);
        }
    }

    /// Whether a panel is on the screen.
    pub(crate) fn is_shown(&self, panel: Panel) -> bool {
        match self.view.maximized {
            Some(one) => one == panel,
            None => self.view.panels.contains(&panel),
        }
    }

    /// What is asked of the worker for a set: what its request says, of the statistics that the panels show.
    pub(crate) fn wanted(&self, set: &Set) -> Request {
        let mut stats = Vec::new();
        for statistic in Panel::ALL.iter().filter(|p| self.is_shown(**p)).flat_map(|p| p.statistics()) {
            if !stats.contains(statistic) {
                stats.push(*statistic);
            }
        }
        set.request.only(&stats)
    }

    /// Tells the worker what changed, and takes what it found.
    fn exchange(&mut self) {
        self.worker.poll();
        for index in 0..self.sets.len() {
            let set = &self.sets[index];
            let (id, wanted, held) = (set.id, self.wanted(set), set.cancelled || !set.visible);
            if self.held.get(&id) != Some(&held) {
                self.held.insert(id, held);
                self.worker.hold(id, held);
            }
            if set.visible && self.asked.get(&id) != Some(&wanted) {
                // Other settings start what was cancelled.
                self.sets[index].cancelled = false;
                self.asked.insert(id, wanted.clone());
                self.worker.set(id, wanted);
            }
            if let Some(latest) = self.worker.latest(id) {
                self.sets[index].snapshot = Some(latest);
            }
        }
        self.asked.retain(|id, _| self.sets.iter().any(|s| s.id == *id));
        self.held.retain(|id, _| self.sets.iter().any(|s| s.id == *id));
    }

    /// Names the window after what is in it.
    fn name_window(&mut self, ctx: &egui::Context) {
        let names: Vec<String> = self.sets.iter().map(Set::name).collect();
        let title = format!("{} - pairwave", names.join(", "));
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Whether measuring is stopped.
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// Stops or goes on.
    pub(crate) fn pause(&mut self, paused: bool) {
        self.paused = paused;
        self.worker.pause(paused);
    }

    /// Whether everything asked for is there.
    pub fn is_settled(&self) -> bool {
        let settled = |s: &Snapshot| s.done || s.error.is_some();
        self.sets
            .iter()
            .filter(|s| s.visible && !s.cancelled)
            .all(|set| set.snapshot.as_deref().is_some_and(|s| settled(s) && s.request == self.wanted(set)))
    }

    /// How things are shown.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Shows things otherwise.
    pub fn set_view(&mut self, view: View) {
        self.view = view;
    }

    /// What is asked for of each set.
    pub fn requests(&self) -> impl Iterator<Item = &Request> {
        self.sets.iter().map(|set| &set.request)
    }

    /// The latest of each set.
    pub fn snapshots(&self) -> impl Iterator<Item = Option<&Snapshot>> {
        self.sets.iter().map(|set| set.snapshot.as_deref())
    }

    /// Draws a frame.
    pub fn ui(&mut self, ui: &mut egui::Ui) {
        let ctx = ui.ctx().clone();
        if !std::mem::replace(&mut self.has_style, true) {
            style::install(&ctx);
            ctx.request_repaint();
            return;
        }
        ctx.set_theme(match self.view.theme {
            Theme::System => egui::ThemePreference::System,
            Theme::Light => egui::ThemePreference::Light,
            Theme::Dark => egui::ThemePreference::Dark,
        });
        self.exchange();
        help::shortcuts(&ctx, self);
        self.take_files(&ctx);
        self.name_window(&ctx);
        egui::Panel::bottom("status").show(ui, |ui| status::show(ui, self));
        egui::Panel::left("controls")
            .resizable(true)
            .default_size(248.0)
            .size_range(220.0..=420.0)
            .show(ui, |ui| egui::ScrollArea::vertical().show(ui, |ui| controls::show(ui, self)));
        let middle = egui::CentralPanel::default().show(ui, |ui| {
            let mut scene = Scene {
                sets: &self.sets,
                selected: self.selected,
                view: &mut self.view,
                hover: &mut self.hover,
                exports: &mut self.exports,
                paused: self.paused,
            };
            self.panels.show(ui, &mut scene);
        });
        help::show(&ctx, self);
        messages::show(&ctx, self, middle.response.rect);
        self.announce_drop(&ctx);
        self.carry_out_exports(&ctx);
        if self.hover.end_frame() {
            ctx.request_repaint();
        }
    }
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
