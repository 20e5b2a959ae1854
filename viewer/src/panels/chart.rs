//! The plot that all panels draw into: axes with the ticks of the library, zoom, pan and reset.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use eframe::egui;
use egui_plot::{AxisHints, GridInput, GridMark, Plot, PlotTransform, PlotUi};
use glam::DVec2;
use pairwave::display::{Axis, Frame, Panel};

/// Panels of which a person has chosen what is seen, and that.
#[derive(Clone, Default)]
pub(super) struct Zoomed(HashMap<Panel, Frame>);

impl Zoomed {
    pub(super) fn is(&self, panel: Panel) -> bool {
        self.0.contains_key(&panel)
    }

    /// Shows all of a panel again.
    pub(super) fn reset(&mut self, panel: Panel) {
        self.0.remove(&panel);
    }
}

/// The range upward that shows what is drawn between two places to the right.
pub(super) type Fit<'a> = dyn Fn([f64; 2]) -> Option<[f64; 2]> + 'a;

/// What is drawn into.
pub(super) struct Chart<'a> {
    pub(super) panel: Panel,
    /// Which of several in the panel.
    pub(super) index: usize,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) frame: Frame,
    /// Whether a unit is as long upward as it is to the right.
    pub(super) square: bool,
    /// Whether it is filled, so that a grid behind it would be in the way.
    pub(super) picture: bool,
    /// What it shows, for those who cannot see it.
    pub(super) described: &'a str,
    /// Of curves: what the wheel shows upward.
    pub(super) fit: Option<&'a Fit<'a>>,
}

/// What came of it.
pub(super) struct Shown {
    pub(super) response: egui::Response,
    pub(super) transform: PlotTransform,
}

impl Shown {
    /// Where the pointer is, as drawn.
    pub(super) fn pointer(&self) -> Option<DVec2> {
        let place = self.transform.value_from_position(self.response.hover_pos()?);
        Some(DVec2::new(place.x, place.y))
    }

    /// Where a place is on the screen.
    pub(super) fn on_screen(&self, place: DVec2) -> egui::Pos2 {
        self.transform.position_from_point(&place.to_array().into())
    }

    /// What paints over the plot, and nowhere else.
    pub(super) fn painter(&self, ui: &egui::Ui) -> egui::Painter {
        ui.painter().with_clip_rect(self.response.rect)
    }
}

/// Whether there is room for the names of both axes.
pub(super) fn is_roomy(size: egui::Vec2) -> bool {
    size.x > 300.0 && size.y > 180.0
}

impl Chart<'_> {
    /// Draws the axes, and what `draw` adds.
    pub(super) fn show<'b>(
        self,
        ui: &mut egui::Ui,
        zoomed: &mut Zoomed,
        draw: impl FnOnce(&mut PlotUi<'b>) + 'b,
    ) -> Shown
    where
        Self: 'b,
    {
        let Self { panel, index, x, y, fit, square, .. } = self;
        let mut size = ui.available_size();
        let id = ui.scope_id().with(("chart", panel.slug(), index));
        // What the axes took.
        let axes = ui.data(|d| d.get_temp::<egui::Vec2>(id)).unwrap_or(egui::vec2(30.0, 20.0));
        let mut frame = self.frame;
        if square {
            // No larger than what it shows.
            size = fitting(frame, size - axes) + axes;
            frame = whole(frame, size - axes);
        }
        let start = zoomed.0.get(&panel).copied().unwrap_or(frame);
        let roomy = is_roomy(size);
        let count = |length: f32, each: f32| ((length / each) as u32).clamp(3, 8);
        let targets = [count(size.x, 110.0), count(size.y, 60.0)];
        let spacing = egui::Rangef::new(8.0, 12.0);
        let mut hints = [AxisHints::new_x(), AxisHints::new_y()];
        hints = [(0, x), (1, y)].map(|(k, axis)| {
            let hint = std::mem::replace(&mut hints[k], AxisHints::new_x());
            let hint = hint.formatter(tick_text(axis, targets[k])).label_spacing(spacing);
            match (roomy, square) {
                (true, _) => hint.label(axis.label()),
                (false, false) => hint.label(egui::RichText::new(axis.short_label()).small()),
                (false, true) => hint,
            }
        });
        let [x_hints, y_hints] = hints;
        let faint = ui.visuals().weak_text_color().gamma_multiply(0.35);
        let mut plot = Plot::new((panel.slug(), index))
            .width(size.x)
            .height(size.y)
            .auto_bounds(false)
            .default_x_bounds(start.x[0], start.x[1])
            .default_y_bounds(start.y[0], start.y[1])
            .allow_double_click_reset(false)
            .allow_scroll(false)
            .allow_zoom(false)
            .allow_axis_zoom_drag(!square)
            // Those side by side are looked at together.
            .link_axis(egui::Id::unique(panel.slug()), true)
            .show_x(false)
            .show_y(false)
            .label_formatter(|_| None)
            .set_margin_fraction(egui::Vec2::ZERO)
            .grid_color(faint)
            .grid_spacing(egui::Rangef::new(8.0, 12.0))
            .x_grid_spacer(marks(x, targets[0]))
            .y_grid_spacer(marks(y, targets[1]))
            .custom_x_axes(vec![x_hints])
            .custom_y_axes(vec![y_hints.min_thickness(28.0)]);
        if square {
            plot = plot.data_aspect(1.0).allow_boxed_zoom(false);
        }
        if self.picture {
            plot = plot.show_grid(false);
        }
        let chosen = zoomed.is(panel);
        let shown = plot.show(ui, move |plot| {
            if !chosen {
                plot.set_plot_bounds_x(frame.x[0]..=frame.x[1]);
                plot.set_plot_bounds_y(frame.y[0]..=frame.y[1]);
            }
            let mut changed = false;
            if plot.response().hovered()
                && let Some(at) = plot.pointer_coordinate()
            {
                let input = |i: &egui::InputState| (i.smooth_scroll_delta(), i.zoom_delta(), i.modifiers.shift);
                let (scroll, pinch, shift) = plot.ctx().input(input);
                // With Shift the wheel turns sideways.
                let factor = f64::from(pinch * ((scroll.x + scroll.y) * 0.004).exp());
                let seen = plot.plot_bounds();
                let seen = Frame { x: [seen.min()[0], seen.max()[0]], y: [seen.min()[1], seen.max()[1]] };
                if factor != 1.0 {
                    let factors = match (square, shift) {
                        (true, _) => [factor; 2],
                        (false, false) => [factor, 1.0],
                        (false, true) => [1.0, factor],
                    };
                    let mut wanted = seen.zoomed([at.x, at.y], factors);
                    if !square && !shift {
                        wanted.y = fit.and_then(|fit| fit(wanted.x)).unwrap_or(wanted.y);
                    }
                    plot.set_plot_bounds_x(wanted.x[0]..=wanted.x[1]);
                    plot.set_plot_bounds_y(wanted.y[0]..=wanted.y[1]);
                    changed = true;
                }
            }
            draw(plot);
            changed
        });
        let response = shown.response;
        ui.data_mut(|d| d.insert_temp(id, size - response.rect.size()));
        // By a drag of an axis or a box.
        let ends = [0, 1].map(|k| [shown.transform.bounds().min()[k], shown.transform.bounds().max()[k]]);
        let moved = !square && !chosen && ends != [frame.x, frame.y];
        if shown.inner || moved || response.drag_stopped() || response.dragged() {
            zoomed.0.insert(panel, frame);
            // What was drawn was chosen for what was seen before.
            ui.ctx().request_repaint();
        }
        if let Some(seen) = zoomed.0.get_mut(&panel) {
            *seen = Frame { x: ends[0], y: ends[1] };
        }
        if response.double_clicked() {
            zoomed.reset(panel);
        }
        let described = self.described.to_string();
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &described));
        Shown { response, transform: shown.transform }
    }
}

/// The size that has the shape of a frame, as large as there is room.
fn fitting(frame: Frame, room: egui::Vec2) -> egui::Vec2 {
    let shape = ((frame.y[1] - frame.y[0]) / (frame.x[1] - frame.x[0])) as f32;
    let width = room.x.min(room.y / shape).max(1.0);
    egui::vec2(width, shape * width)
}

/// The frame that shows all of one where a unit is as long upward as to the right.
fn whole(frame: Frame, size: egui::Vec2) -> Frame {
    let [width, height] = [frame.x[1] - frame.x[0], frame.y[1] - frame.y[0]];
    let per_point = (width / f64::from(size.x.max(1.0))).max(height / f64::from(size.y.max(1.0)));
    let about = |ends: [f64; 2], points: f32| {
        let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * per_point * f64::from(points.max(1.0)));
        [middle - half, middle + half]
    };
    Frame { x: about(frame.x, size.x), y: about(frame.y, size.y) }
}

fn marks(axis: Axis, target: u32) -> impl Fn(GridInput) -> Vec<GridMark> {
    move |input| {
        let places: Vec<f64> = axis.ticks(input.bounds.0, input.bounds.1, target).iter().map(|t| t.0).collect();
        let step = places.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
        let step_size = if step.is_finite() { step } else { input.bounds.1 - input.bounds.0 };
        places.into_iter().map(|value| GridMark { value, step_size }).collect()
    }
}

fn tick_text(axis: Axis, target: u32) -> impl Fn(GridMark, &RangeInclusive<f64>) -> String {
    move |mark, range| {
        let near = |t: &(f64, String)| (t.0 - mark.value).abs() <= 1e-6 * mark.step_size;
        let all = axis.ticks(*range.start(), *range.end(), target);
        all.into_iter().find(near).map(|t| t.1).unwrap_or_default()
    }
}
