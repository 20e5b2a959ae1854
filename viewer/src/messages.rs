//! What a person must know of files, sessions and exports: at the bottom right, until it is closed or old.

use eframe::egui;

use crate::style;

/// Seconds that a note stays; errors stay until they are closed.
const STAYS: f64 = 8.0;

/// Room for the button that closes one.
const CLOSE: f32 = 40.0;

/// No more than this many: the oldest goes first.
const MOST: usize = 20;

/// A line or two.
#[derive(Debug, Clone, PartialEq)]
struct Message {
    text: String,
    is_error: bool,
    /// When it was first drawn, in seconds of the window's clock.
    since: Option<f64>,
}

/// What there is to say, the latest last.
#[derive(Debug, Default)]
pub(crate) struct Messages(Vec<Message>);

impl Messages {
    /// Says what went wrong; it stays until it is closed.
    pub(crate) fn fail(&mut self, text: impl Into<String>) {
        self.say(text.into(), true);
    }

    /// Says what was done; it goes by itself.
    pub(crate) fn note(&mut self, text: impl Into<String>) {
        self.say(text.into(), false);
    }

    fn say(&mut self, text: String, is_error: bool) {
        // What is said again is said once, as the latest.
        self.0.retain(|m| m.text != text);
        self.0.push(Message { text, is_error, since: None });
        let excess = self.0.len().saturating_sub(MOST);
        self.0.drain(..excess);
    }

    /// Draws them into the lower right corner of the panels.
    pub(crate) fn show(&mut self, ctx: &egui::Context, panels: egui::Rect) {
        let now = ctx.input(|i| i.time);
        self.0.retain(|m| m.is_error || m.since.is_none_or(|since| now < since + STAYS));
        if self.0.is_empty() {
            return;
        }
        let mut closed = None;
        let width = (0.5 * panels.width()).clamp(240.0, 460.0);
        egui::Area::new(egui::Id::unique("messages"))
            .order(egui::Order::Foreground)
            .pivot(egui::Align2::RIGHT_BOTTOM)
            .fixed_pos(panels.max - egui::vec2(8.0, 8.0))
            .constrain(true)
            .show(ctx, |ui| {
                let most = 0.5 * panels.height();
                let area =
                    egui::ScrollArea::vertical().max_height(most).min_scrolled_height(most).stick_to_bottom(true);
                area.show(ui, |ui| {
                    ui.set_width(width);
                    for (index, message) in self.0.iter_mut().enumerate() {
                        let since = *message.since.get_or_insert(now);
                        if !message.is_error {
                            let left = std::time::Duration::try_from_secs_f64(since + STAYS - now).unwrap_or_default();
                            ctx.request_repaint_after(left);
                        }
                        if draw(ui, message) {
                            closed = Some(index);
                        }
                    }
                });
            });
        if let Some(index) = closed {
            self.0.remove(index);
            ctx.request_repaint();
        }
    }
}

/// Draws one; whether it is to be closed.
fn draw(ui: &mut egui::Ui, message: &Message) -> bool {
    let visuals = ui.visuals();
    let (sign, color) = match message.is_error {
        true => ("⚠", visuals.error_fg_color),
        false => ("✔", visuals.weak_text_color()),
    };
    let frame = egui::Frame::popup(ui.style()).inner_margin(6).stroke(egui::Stroke::new(1.0, color));
    let shown = frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_top(|ui| {
            ui.colored_label(color, sign);
            let room = ui.available_width() - CLOSE;
            let text = ui.vertical(|ui| {
                ui.set_width(room);
                ui.add(egui::Label::new(&message.text).wrap().selectable(true))
            });
            let live = if message.is_error { egui::accesskit::Live::Assertive } else { egui::accesskit::Live::Polite };
            ui.ctx().accesskit_node_builder(text.inner.id, |node| node.set_live(live));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::TOP), |ui| {
                style::icon(ui, "✖", "Close this message").clicked()
            })
            .inner
        })
        .inner
    });
    shown.inner
}
