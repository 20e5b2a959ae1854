//! Errors of integrals: predicted and observed variances as dots with their errors, what the variance comes from, and how it falls with the
//! number of points.

use eframe::egui;
use egui_plot::{HLine, Line, LineStyle, MarkerShape, PlotPoint, PlotPoints, Points, Text, VLine};
use pairwave::display::{
    Decades, ErrorBar, ErrorBars, Form, Frame, Ladder, LadderFrame, Origin, Panel, Rung, Shares, error_bars,
};

use super::chart::{Chart, Zoomed};
use super::{Scene, line, said_instead};
use crate::actions::Action;
use crate::colors;
use crate::hover::Place;
use crate::set::Set;
use crate::view::{Integrals, View};

/// Draws the panel.
pub(super) fn show(ui: &mut egui::Ui, scene: &mut Scene<'_>, zoomed: &mut Zoomed) {
    let visible = |scene: &Scene<'_>, s: usize| {
        scene.sets[s].visible && scene.sets[s].analysis().is_some_and(|analysis| Panel::Integration.has(analysis))
    };
    let drawn: Vec<usize> = (0..scene.sets.len()).filter(|&s| visible(scene, s)).collect();
    if drawn.is_empty() {
        let any = scene.sets.iter().any(|set| set.visible && !set.request.integrand.is_empty());
        let text = if any { "measuring…" } else { "no integrand is chosen: choose one at the left, under Integrals" };
        return said_instead(ui, scene, text);
    }
    kinds(ui, scene, zoomed);
    match scene.view.integrals {
        Integrals::Errors => errors(ui, scene, &drawn),
        Integrals::Frequencies => shares(ui, scene, zoomed, &drawn, Origin::Frequencies),
        Integrals::Distances => shares(ui, scene, zoomed, &drawn, Origin::Distances),
        Integrals::Numbers => ladders(ui, scene, zoomed, &drawn),
    }
}

/// A choice of what is drawn.
fn kinds(ui: &mut egui::Ui, scene: &mut Scene<'_>, zoomed: &mut Zoomed) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for kind in Integrals::ALL {
            let about = match kind {
                Integrals::Errors => Panel::Integration.definition(),
                Integrals::Frequencies => Origin::Frequencies.definition(),
                Integrals::Distances => Origin::Distances.definition(),
                Integrals::Numbers => LadderFrame::DEFINITION,
            };
            let text = egui::RichText::new(kind.name()).small();
            let chosen = scene.view.integrals == kind;
            if ui.selectable_label(chosen, text).on_hover_text(about).clicked() && !chosen {
                zoomed.reset(Panel::Integration);
                let view = View { integrals: kind, ..scene.view.clone() };
                scene.actions.push(Action::Look(Box::new(view)));
            }
        }
    });
}

/// What the sets say of the variance under the pointer, or their names.
fn readout(ui: &mut egui::Ui, scene: &Scene<'_>, drawn: &[usize], said: impl Fn(&Set) -> Option<String>) {
    let alone = drawn.len() == 1;
    let texts = drawn.iter().map(|&s| &scene.sets[s]).map(|set| {
        let name = set.name();
        match said(set) {
            Some(text) if alone => (set.color, text.clone(), text),
            Some(text) => (set.color, text.clone(), format!("{name}: {text}")),
            None => (set.color, name.clone(), format!("{name} ({})", set.request.command())),
        }
    });
    let texts = texts.collect();
    _ = line(ui, texts, drawn.iter().map(|&s| scene.sets[s].name()).collect());
}

/// Where the parts of a drawing of errors are.
struct Layout {
    plot: egui::Rect,
    /// Height of an integrand, of its title, and of each of its lines.
    block: f32,
    title: f32,
    line: f32,
}

impl Layout {
    /// In an area; `named` is the width of the names of lines.
    fn new(area: egui::Rect, integrands: usize, named: f32) -> Self {
        let axis = if area.height() > 150.0 { 34.0 } else { 18.0 };
        let lines = Form::ALL.len() as f32;
        let most = (area.height() - axis) / integrands as f32;
        let title = if most >= 4.0 * lines + 17.0 { 17.0 } else { 0.0 };
        let line = ((most - title) / (lines + 0.5)).min(22.0);
        let block = title + (lines + 0.5) * line;
        let left = if line >= 10.5 && area.width() > 3.0 * named { named } else { 8.0 };
        let plot = egui::Rect::from_min_size(
            area.min + egui::vec2(left, 0.0),
            egui::vec2(area.width() - left - 14.0, block * integrands as f32),
        );
        Self { plot, block, title, line }
    }

    fn has_names(&self, area: egui::Rect) -> bool {
        self.plot.min.x > area.min.x + 8.0
    }

    fn x(&self, place: f64) -> f32 {
        egui::lerp(self.plot.x_range(), place as f32)
    }

    /// The middle of a line of an integrand, of so many slots the one.
    fn y(&self, integrand: usize, form: usize, (slot, slots): (usize, usize)) -> f32 {
        let part = (slot as f32 + 0.5) / slots as f32;
        self.plot.min.y + integrand as f32 * self.block + self.title + (form as f32 + part) * self.line
    }

    /// The integrand and the line at a height.
    fn at(&self, y: f32) -> Option<(usize, Form)> {
        let below = y - self.plot.min.y;
        let integrand = (below / self.block).floor();
        let form = ((below - integrand * self.block - self.title) / self.line).floor().max(0.0) as usize;
        (below >= 0.0 && y < self.plot.max.y).then(|| (integrand as usize, Form::ALL[form.min(Form::ALL.len() - 1)]))
    }
}

fn errors(ui: &mut egui::Ui, scene: &mut Scene<'_>, drawn: &[usize]) {
    let found: Vec<(usize, Vec<ErrorBars>)> =
        drawn.iter().filter_map(|&s| Some((s, error_bars(scene.sets[s].analysis()?)))).collect();
    let mut specs: Vec<&str> = Vec::new();
    for bars in found.iter().flat_map(|(_, all)| all) {
        if !specs.contains(&bars.spec.as_str()) {
            specs.push(&bars.spec);
        }
    }
    let of = |all: &'_ [ErrorBars], spec: &str| all.iter().position(|bars| bars.spec == spec);
    let pointed = match scene.hover.place() {
        Some(Place::Variance(k, form)) => specs.get(k).map(|spec| (*spec, form)),
        _ => None,
    };
    readout(ui, scene, drawn, |set| {
        let (spec, form) = pointed?;
        let (_, all) = found.iter().find(|(s, _)| scene.sets[*s].id == set.id)?;
        let bar = all[of(all, spec)?].each.iter().find(|bar| bar.form == form)?;
        Some(format!("{form} {}", bar.brief))
    });
    let area = ui.available_rect_before_wrap();
    let font = egui::TextStyle::Small.resolve(ui.style());
    let (ink, weak) = (ui.visuals().text_color(), ui.visuals().weak_text_color());
    let written = |text: &str, color| ui.painter().layout_no_wrap(text.to_string(), font.clone(), color);
    let named = Form::ALL.iter().map(|form| written(form.name(), weak).size().x).fold(0.0, f32::max) + 12.0;
    let layout = Layout::new(area, specs.len().max(1), named);
    let decades = Decades::of(found.iter().flat_map(|(_, all)| all));
    let response = ui.interact(area, ui.scope_id().with("errors"), egui::Sense::click());
    let names: Vec<String> = drawn.iter().map(|&s| scene.sets[s].described()).collect();
    let described = format!("predicted and observed variance of {}: {}, over v₀/n", names.join(", "), specs.join(", "));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &described));

    let painter = ui.painter_at(area.expand(2.0));
    axis(&painter, area, &layout, decades, [ink, weak], &font);
    for (k, spec) in specs.iter().enumerate() {
        let top = layout.plot.min.y + k as f32 * layout.block;
        let width = area.width() - 8.0;
        if layout.title > 0.0 {
            let mut job = egui::text::LayoutJob::simple_singleline(spec.to_string(), font.clone(), ink);
            job.wrap = egui::text::TextWrapping::truncate_at_width(width);
            let galley = ui.fonts_mut(|fonts| fonts.layout_job(job));
            painter.galley(egui::pos2(area.min.x + 2.0, top), galley, ink);
        }
        if layout.has_names(area) {
            for (row, form) in Form::ALL.iter().enumerate() {
                let at = egui::pos2(layout.plot.min.x - 6.0, layout.y(k, row, (0, 1)));
                painter.text(at, egui::Align2::RIGHT_CENTER, form.name(), font.clone(), weak);
            }
        }
        if k > 0 {
            let stroke = egui::Stroke::new(1.0, weak.gamma_multiply(0.3));
            painter.hline(area.x_range(), top - 1.0, stroke);
        }
    }
    let dark = ui.visuals().dark_mode;
    for (slot, (s, all)) in found.iter().enumerate() {
        let color = colors::set(scene.sets[*s].color, dark);
        for (k, spec) in specs.iter().enumerate() {
            let Some(bars) = of(all, spec).map(|index| &all[index]) else { continue };
            for bar in &bars.each {
                let row = Form::ALL.iter().position(|form| *form == bar.form).unwrap_or_default();
                let y = layout.y(k, row, (slot, found.len()));
                let radius = (0.36 * layout.line / found.len() as f32).clamp(1.5, 4.0);
                dot(&painter, &layout, decades, bar, (y, radius), color);
            }
        }
    }
    let pointer = response.hover_pos().and_then(|at| layout.at(at.y));
    let Some((k, form)) = pointer else {
        ui.allocate_rect(area, egui::Sense::hover());
        return;
    };
    scene.hover.at(Panel::Integration, Place::Variance(k, form));
    if response.clicked() && k != scene.view.integrand {
        let view = View { integrand: k, ..scene.view.clone() };
        scene.actions.push(Action::Look(Box::new(view)));
    }
    response.on_hover_ui_at_pointer(|ui| {
        ui.set_max_width(420.0);
        let Some(spec) = specs.get(k) else { return };
        ui.strong(*spec);
        for (s, all) in &found {
            let Some(bars) = of(all, spec).map(|index| &all[index]) else { continue };
            let set = &scene.sets[*s];
            if found.len() > 1 {
                ui.colored_label(colors::set(set.color, dark), set.name());
            }
            bars.each.iter().map(|bar| &bar.text).chain(&bars.text).for_each(|text| _ = ui.label(text));
        }
    });
    ui.allocate_rect(area, egui::Sense::hover());
}

/// A dot with its errors: round where the form is spectral or shifted, a square where it is not; full where it is predicted.
fn dot(
    painter: &egui::Painter,
    layout: &Layout,
    decades: Decades,
    bar: &ErrorBar,
    (y, radius): (f32, f32),
    color: egui::Color32,
) {
    let [low, high] = bar.ends.map(|end| layout.x(decades.place(end)));
    if bar.value > 0.0 {
        painter.hline(low..=high, y, egui::Stroke::new(1.5, color));
    }
    let center = egui::pos2(layout.x(decades.place(bar.value)), y);
    let stroke = egui::Stroke::new(1.4, color);
    let ground = painter.ctx().global_style().visuals.panel_fill;
    let fill = if bar.form.is_predicted() { color } else { ground };
    if bar.value <= 0.0 {
        // What is 0 has no place on this scale.
        let font = egui::FontId::proportional((2.6 * radius).clamp(8.0, 11.0));
        painter.text(center + egui::vec2(2.0, 0.0), egui::Align2::LEFT_CENTER, "0", font, color);
    } else if matches!(bar.form, Form::Spectral | Form::Shifted) {
        painter.circle(center, radius, fill, stroke);
    } else {
        let square = egui::Rect::from_center_size(center, egui::Vec2::splat(1.8 * radius));
        painter.rect(square, 0.0, fill, stroke, egui::StrokeKind::Middle);
    }
}

/// Decades, random points, and what is along the axis.
fn axis(
    painter: &egui::Painter,
    area: egui::Rect,
    layout: &Layout,
    decades: Decades,
    [ink, weak]: [egui::Color32; 2],
    font: &egui::FontId,
) {
    let bottom = layout.plot.max.y;
    let mut taken: Vec<egui::Rect> = Vec::new();
    for (place, text) in decades.ticks() {
        let x = layout.x(place);
        let written = painter.layout_no_wrap(text, font.clone(), ink);
        let at = egui::Align2::CENTER_TOP.anchor_size(egui::pos2(x, bottom + 3.0), written.size());
        let inside = at.min.x >= area.min.x && at.max.x <= area.max.x;
        if !inside || taken.iter().any(|other| other.expand2(egui::vec2(6.0, 0.0)).intersects(at)) {
            continue;
        }
        painter.vline(x, layout.plot.y_range(), egui::Stroke::new(1.0, weak.gamma_multiply(0.3)));
        painter.galley(at.min, written, ink);
        taken.push(at);
    }
    painter.vline(layout.x(decades.place(1.0)), layout.plot.y_range(), egui::Stroke::new(1.0, weak));
    painter.hline(layout.plot.x_range(), bottom, egui::Stroke::new(1.0, weak));
    if area.max.y - bottom > 30.0 {
        let long = painter.layout_no_wrap("n × variance / v₀; random points = 1".into(), font.clone(), ink);
        let short = painter.layout_no_wrap("n V / v₀".into(), font.clone(), ink);
        let label = if long.size().x < area.width() { long } else { short };
        let middle = egui::Align2::CENTER_TOP.anchor_size(egui::pos2(area.center().x, bottom + 18.0), label.size());
        painter.galley(middle.min, label, ink);
    }
}

/// Curves of what the variance comes from: of the chosen integrand, the others paler.
fn shares(ui: &mut egui::Ui, scene: &mut Scene<'_>, zoomed: &mut Zoomed, drawn: &[usize], origin: Origin) {
    let found: Vec<(usize, Shares)> =
        drawn.iter().filter_map(|&s| Some((s, origin.shares(scene.sets[s].analysis()?)?))).collect();
    let Some((_, first)) = found.iter().find(|(s, _)| *s == scene.selected).or(found.first()) else {
        return said_instead(ui, scene, "pairs are not summed, or nothing varies: there is no such curve");
    };
    let [x, y] = first.axes;
    let chosen = |shares: &Shares| scene.view.integrand.min(shares.each.len() - 1);
    let at = match scene.hover.place() {
        Some(Place::Share(at)) => Some(at),
        _ => None,
    };
    readout(ui, scene, drawn, |set| {
        let (_, shares) = found.iter().find(|(s, _)| scene.sets[*s].id == set.id)?;
        let spec = &shares.each[chosen(shares)].spec;
        match at.and_then(|at| shares.at(chosen(shares), at)) {
            Some((_, text)) => Some(text),
            None if found.len() == 1 => Some(format!("{}, {spec}", set.name())),
            None => None,
        }
    });
    let Some(frame) = found.iter().map(|(_, shares)| shares.frame).reduce(Frame::union) else { return };
    let names: Vec<String> = found.iter().map(|(s, _)| scene.sets[*s].described()).collect();
    let described = format!("{} of {}, along {}", y.label(), names.join(", "), x.label());
    let chart = Chart {
        panel: Panel::Integration,
        index: usize::from(origin == Origin::Distances),
        x,
        y,
        frame,
        square: false,
        picture: false,
        described: &described,
        fit: None,
    };
    let (dark, weak, ink) = (ui.visuals().dark_mode, ui.visuals().weak_text_color(), ui.visuals().strong_text_color());
    let sets = scene.sets;
    let shown = chart.show(ui, zoomed, |plot| {
        let level = HLine::new("all", 1.0).color(weak.gamma_multiply(0.8)).width(1.0);
        plot.hline(level.style(LineStyle::dotted_dense()).allow_hover(false));
        for (s, shares) in &found {
            let color = colors::set(sets[*s].color, dark);
            for (k, share) in shares.each.iter().enumerate() {
                let points: PlotPoints<'_> = share.line.iter().copied().collect();
                let line = Line::new("share", points).allow_band(false).allow_hover(false);
                plot.line(match k == chosen(shares) {
                    true => line.color(color).width(2.0),
                    false => line.color(color.gamma_multiply(0.5)).width(1.0).style(LineStyle::dashed_dense()),
                });
            }
        }
        let Some(at) = at else { return };
        plot.vline(VLine::new("pointer", at).color(ink.gamma_multiply(0.5)).width(1.0).allow_hover(false));
        for (s, shares) in &found {
            if let Some((place, _)) = shares.at(chosen(shares), at) {
                let dot = Points::new("value", vec![place]).radius(3.5).color(colors::set(sets[*s].color, dark));
                plot.points(dot.allow_hover(false));
            }
        }
    });
    if let Some(pointer) = shown.pointer() {
        scene.hover.at(Panel::Integration, Place::Share(pointer.x));
    }
}

/// Variances against the number of points, of the chosen integrand.
fn ladders(ui: &mut egui::Ui, scene: &mut Scene<'_>, zoomed: &mut Zoomed, drawn: &[usize]) {
    let of = |set: &Set| -> Option<Ladder> {
        let each = &set.analysis()?.integration()?.each;
        let found = set.snapshot.as_ref()?.climb.as_ref()?.found.clone()?;
        found.ladders(scene.view.integrand.min(each.len().saturating_sub(1))).into_iter().next()
    };
    let found: Vec<(usize, Ladder)> = drawn.iter().filter_map(|&s| Some((s, of(&scene.sets[s])?))).collect();
    let at = match scene.hover.place() {
        Some(Place::Share(at)) => Some(at),
        _ => None,
    };
    readout(ui, scene, drawn, |set| {
        let climb = set.snapshot.as_ref()?.climb.as_ref()?;
        let ladder = found.iter().find(|(s, _)| scene.sets[*s].id == set.id).map(|(_, ladder)| ladder);
        let (done, all) = climb.progress;
        match (ladder, &climb.error) {
            (_, Some(error)) => Some(error.clone()),
            (Some(ladder), _) if at.is_some() => at.and_then(|at| ladder.at(at)).map(|(_, text)| text),
            (Some(ladder), _) if done < all => Some(format!("{}, {done} of {all} numbers of points", ladder.spec)),
            (Some(ladder), _) => Some(format!("{}, {}", ladder.spec, ladder.text())),
            _ => None,
        }
    });
    let Some(frame) = LadderFrame::of(found.iter().map(|(_, ladder)| ladder)) else {
        let failed = drawn.iter().find_map(|&s| scene.sets[s].snapshot.as_ref()?.climb.as_ref()?.error.clone());
        let text = match (failed, found.is_empty()) {
            (Some(failed), _) => failed,
            (None, true) => "measuring at fewer points…".into(),
            (None, false) => "no variance above 0".into(),
        };
        return said_instead(ui, scene, &text);
    };
    let names: Vec<String> = found.iter().map(|(s, _)| scene.sets[*s].described()).collect();
    let [x, y] = LadderFrame::axes();
    let described = format!("{} of {}, along {}", y.label(), names.join(", "), x.label());
    let chart = Chart {
        panel: Panel::Integration,
        index: 2,
        x,
        y,
        frame: frame.frame(),
        square: false,
        picture: false,
        described: &described,
        fit: None,
    };
    let (dark, weak, ink) = (ui.visuals().dark_mode, ui.visuals().weak_text_color(), ui.visuals().strong_text_color());
    let sets = scene.sets;
    let log = |[n, v]: [f64; 2]| [n.log10(), v.log10()];
    let beside = 0.008 * (frame.frame().x[1] - frame.frame().x[0]);
    let shown = chart.show(ui, zoomed, |plot| {
        for (line, name) in frame.references() {
            let ends = line.map(log);
            let drawn = Line::new("slope", ends.to_vec()).color(weak.gamma_multiply(0.8)).width(1.0);
            plot.line(drawn.style(LineStyle::dashed_dense()).allow_hover(false));
            let place = PlotPoint::new(ends[1][0] + beside, ends[1][1]);
            let text = egui::RichText::new(name).small();
            plot.text(Text::new("slope", place, text).color(weak).anchor(egui::Align2::LEFT_CENTER).allow_hover(false));
        }
        for (s, ladder) in &found {
            let color = colors::set(sets[*s].color, dark);
            if let Some(fit) = frame.fit(ladder) {
                plot.line(Line::new("fit", fit.map(log).to_vec()).color(color).width(1.8).allow_hover(false));
            }
            for mark in frame.marks(ladder) {
                let place = |v: f64| [mark.n.log10() + beside * mark.beside, v.log10()];
                let bar = Line::new("error", mark.ends.map(place).to_vec()).color(color).width(1.0);
                plot.line(bar.allow_hover(false));
                let (shape, filled) = match mark.rung {
                    Rung::Predicted => (MarkerShape::Circle, true),
                    Rung::Observed => (MarkerShape::Circle, false),
                    Rung::Shifted => (MarkerShape::Cross, false),
                };
                let dot = Points::new("variance", vec![place(mark.value)]).shape(shape).filled(filled).radius(3.5);
                plot.points(dot.color(color).allow_hover(false));
            }
        }
        let nearest = at.and_then(|at| found.iter().find_map(|(_, ladder)| ladder.at(at)));
        if let Some((place, _)) = nearest {
            plot.vline(VLine::new("pointer", place).color(ink.gamma_multiply(0.5)).width(1.0).allow_hover(false));
        }
    });
    if let Some(pointer) = shown.pointer() {
        scene.hover.at(Panel::Integration, Place::Share(pointer.x));
    }
}
