//! The points of a realization, the first or one that was chosen, with what is drawn over them.

use std::collections::HashMap;

use eframe::egui;
use egui_plot::{PlotImage, PlotPoint};
use glam::DVec2;
use pairwave::analysis::Analysis;
use pairwave::control::Control;
use pairwave::display::{Axis, ColorMap, Frame, Panel, integrand_pixels, overlays};
use pairwave::plan::By;
use pairwave::points::{Boundary, Ensemble};
use pairwave::request::PointsRequest;

use super::chart::{Chart, Shown, Zoomed};
use super::{Scene, cells, line, planes, said_instead};
use crate::actions::Action;
use crate::colors;
use crate::engine::SetId;
use crate::hover::Place;
use crate::set::Set;
use crate::view::View;

/// More points than this are drawn in part: a screen has no room for them.
const MOST: usize = 20_000;

/// More links than this would be a tangle, and slow.
const MOST_LINKS: usize = 5_000;

/// More indices than this are not drawn: nobody could read them.
const MOST_INDICES: usize = 400;

/// Pixels along a side of the picture of an integrand.
const BELOW: usize = 256;

/// What a drawing of points depends on: what they were asked for as, the plane, and, as a file may have changed, their ends.
#[derive(PartialEq)]
struct Of {
    request: PointsRequest,
    plane: [usize; 2],
    realization: u64,
    ends: [Option<String>; 2],
    /// The density that they come by, and how.
    density: Option<(String, Option<By>)>,
}

/// What is drawn over points, kept until the points change.
#[derive(Default)]
pub(crate) struct Cloud {
    kept: HashMap<SetId, KeptDots>,
    below: HashMap<SetId, Below>,
}

/// The picture of an integrand.
struct Below {
    /// Its specification, the plane, and what is seen of it.
    of: (String, [usize; 2], [[f64; 2]; 2]),
    texture: egui::TextureHandle,
}

struct KeptDots {
    of: Of,
    /// Number of points, and which of them are drawn: every so many.
    n: usize,
    every: usize,
    places: Vec<DVec2>,
    /// What each of these weighs in integrals, over their mean.
    weights: Option<Vec<f64>>,
    /// Copies across the sides, of every so many.
    tiles: Vec<DVec2>,
    tiled: usize,
    strata: Vec<[DVec2; 2]>,
    /// Made when they are first asked for.
    links: Option<Vec<[DVec2; 2]>>,
    frame: [DVec2; 2],
}

fn vectors(places: Vec<[f64; 2]>) -> Vec<DVec2> {
    places.into_iter().map(DVec2::from).collect()
}

fn segments(ends: Vec<[[f64; 2]; 2]>) -> Vec<[DVec2; 2]> {
    ends.into_iter().map(|ends| ends.map(DVec2::from)).collect()
}

impl KeptDots {
    fn new(of: Of, analysis: &Analysis, points: &Ensemble) -> Self {
        let plane = of.plane;
        let all = overlays::projected(points, plane);
        let every = all.len().div_ceil(MOST).max(1);
        let places: Vec<_> = all.iter().copied().step_by(every).collect();
        // There are up to eight copies.
        let tiled = (8 * places.len()).div_ceil(MOST).max(1);
        let copied: Vec<_> = places.iter().copied().step_by(tiled).collect();
        let tiles = overlays::tiles(&analysis.domain, plane, &copied).unwrap_or_default();
        let strata = overlays::strata_lines(&analysis.domain, plane, all.len()).unwrap_or_default();
        let frame = overlays::frame(&analysis.domain, plane).map(DVec2::from);
        let weights = overlays::weights(analysis, points).map(|all| all.into_iter().step_by(every).collect());
        let (places, tiles) = (vectors(places), vectors(tiles));
        Self { weights, of, n: all.len(), every, places, tiles, tiled, strata: segments(strata), links: None, frame }
    }
}

impl Cloud {
    /// Draws the points.
    pub(super) fn show(&mut self, ui: &mut egui::Ui, scene: &mut Scene<'_>, zoomed: &mut Zoomed) {
        let drawn = self.prepare(scene);
        if drawn.is_empty() {
            return said_instead(ui, scene, "there are no points");
        }
        planes(ui, scene);
        if !scene.view.side_by_side {
            self.readouts(ui, scene, &drawn);
        }
        let charts: Vec<Vec<usize>> = match scene.view.side_by_side {
            true => drawn.into_iter().map(|s| vec![s]).collect(),
            false => vec![drawn],
        };
        let area = ui.available_rect_before_wrap();
        for (index, (sets, rect)) in charts.iter().zip(cells(area, charts.len(), 4.0)).enumerate() {
            let builder = egui::UiBuilder::new().max_rect(rect).id_salt(index);
            ui.scope_builder(builder, |ui| {
                if scene.view.side_by_side {
                    self.readouts(ui, scene, sets);
                }
                self.chart(ui, index, sets, scene, zoomed);
            });
        }
        ui.allocate_rect(area, egui::Sense::hover());
    }

    /// Brings up to date what is kept. The sets that have points.
    fn prepare(&mut self, scene: &Scene<'_>) -> Vec<usize> {
        self.kept.retain(|id, _| scene.sets.iter().any(|set| set.visible && set.id == *id));
        let below = scene.view.integrand_below;
        self.below.retain(|id, _| below && scene.sets.iter().any(|set| set.visible && set.id == *id));
        let mut drawn = Vec::new();
        for (index, set) in scene.sets.iter().enumerate().filter(|(_, set)| set.visible) {
            let (Some(analysis), Some(points), Some(snapshot)) = (set.analysis(), set.points(), &set.snapshot) else {
                continue;
            };
            // More realizations leave the first alone.
            let request = PointsRequest { realizations: None, ..snapshot.request.input.clone() };
            let all = overlays::planes(analysis.domain.dim());
            let last = points.points_in(0).saturating_sub(1);
            let ends = [0, last].map(|k| overlays::point_text(points, k));
            let (plane, realization) = (all[scene.view.plane.min(all.len() - 1)], points.first_index());
            let placed = analysis.integration().and_then(|found| found.placed.as_ref());
            let density = placed.map(|placed| (placed.spec.clone(), placed.by));
            let of = Of { density, request, plane, realization, ends };
            if self.kept.get(&set.id).is_none_or(|kept| kept.of != of) {
                self.kept.insert(set.id, KeptDots::new(of, analysis, points));
            }
            if let Some(kept) = self.kept.get_mut(&set.id).filter(|_| scene.view.links) {
                let (few, plane) = (kept.n <= MOST_LINKS, kept.of.plane);
                kept.links.get_or_insert_with(|| match few {
                    true => segments(overlays::neighbor_links(points, plane, &Control::default()).unwrap_or_default()),
                    false => Vec::new(),
                });
            }
            drawn.push(index);
        }
        drawn
    }

    /// The picture of the integrand that is below the points of some sets, and what it covers.
    fn below(
        &mut self,
        ctx: &egui::Context,
        sets: &[usize],
        scene: &Scene<'_>,
        plane: [usize; 2],
    ) -> Option<(egui::TextureId, [[f64; 2]; 2])> {
        let of = sets.iter().find(|&&s| s == scene.selected).or(sets.first())?;
        let set = &scene.sets[*of];
        let found = set.analysis().zip(set.integrand(scene.view.integrand)).filter(|_| scene.view.integrand_below);
        let Some((analysis, integrand)) = found else {
            self.below.remove(&set.id);
            return None;
        };
        let [low, high] = overlays::frame(&analysis.domain, plane);
        let extent = [0, 1].map(|k| [low[k], high[k]]);
        let of = (integrand.spec().to_string(), plane, extent);
        if self.below.get(&set.id).is_none_or(|kept| kept.of != of) {
            let drawn = integrand_pixels(integrand, ColorMap::Grey, plane, extent, BELOW)?;
            let image = egui::ColorImage::from_rgb([BELOW; 2], &drawn.pixels.rgb);
            let texture = ctx.load_texture("integrand", image, egui::TextureOptions::LINEAR);
            self.below.insert(set.id, Below { of, texture });
        }
        self.below.get(&set.id).map(|kept| (kept.texture.id(), extent))
    }

    fn chart(&mut self, ui: &mut egui::Ui, index: usize, sets: &[usize], scene: &mut Scene<'_>, zoomed: &mut Zoomed) {
        let Some(analysis) = sets.first().and_then(|&s| scene.sets[s].analysis()) else { return };
        let all = overlays::planes(analysis.domain.dim());
        let plane = all[scene.view.plane.min(all.len() - 1)];
        let [axis, y_axis] = plane.map(|axis| Axis::coordinate(analysis, scene.view.length_unit, axis));
        let square = analysis.domain.dim() > 1;
        let frames = sets.iter().filter_map(|&s| self.kept.get(&scene.sets[s].id)).map(|kept| {
            let [low, high] = kept.frame.map(|corner| corner.map(|v| axis.in_unit(v)));
            let tiled = scene.view.tiling && analysis.domain.boundary() == Boundary::Torus;
            let side = if tiled { high - low } else { DVec2::ZERO };
            let (low, high) = (low - side, high + side);
            Frame { x: [low.x, high.x], y: if square { [low.y, high.y] } else { [-0.5, 0.5] } }
        });
        let Some(frame) = frames.reduce(Frame::union) else { return };
        let of = |set: &Set| {
            let which = set.points().map_or(0, Ensemble::first_index);
            if which == 0 { set.described() } else { format!("{}, realization {which} from 0", set.described()) }
        };
        let names: Vec<String> = sets.iter().map(|&s| of(&scene.sets[s])).collect();
        let first = if sets.iter().all(|&s| scene.sets[s].realization == 0) { ", first realization" } else { "" };
        let described = format!("points of {}{first}, along {} and {}", names.join(", "), axis.label(), y_axis.label());
        let chart = Chart {
            panel: Panel::Points,
            index,
            x: axis,
            y: y_axis,
            frame,
            square,
            picture: false,
            described: &described,
            fit: None,
        };
        let below = self.below(ui.ctx(), sets, scene, plane);
        let tint = egui::Color32::WHITE.gamma_multiply(0.5);
        let shown = chart.show(ui, zoomed, |plot| {
            let Some((texture, [x, y])) = below else { return };
            let [x, y] = [x, y].map(|ends| ends.map(|end| axis.in_unit(end)));
            let (centre, size) = ([x[0] + x[1], y[0] + y[1]].map(|s| 0.5 * s), [x[1] - x[0], y[1] - y[0]]);
            let image = PlotImage::new("integrand", texture, PlotPoint::from(centre), size.map(|s| s as f32));
            plot.image(image.tint(tint).allow_hover(false));
        });
        let (painter, dark) = (shown.painter(ui), ui.visuals().dark_mode);
        let mut nearest: Option<(f32, Place)> = None;
        // The selected one over the others.
        let mut over = sets.to_vec();
        over.sort_by_key(|&s| s == scene.selected);
        for s in over {
            let set = &scene.sets[s];
            let Some(kept) = self.kept.get(&set.id) else { continue };
            let of_set = Drawing { kept, axis, shown: &shown, painter: &painter, color: colors::set(set.color, dark) };
            of_set.paint(ui, scene.view);
            if let (Some(at), Some(r)) = (of_set.central(), scene.hover.distance()) {
                let edge = of_set.at(at + r * DVec2::X);
                let stroke = egui::Stroke::new(1.5, ui.visuals().text_color().gamma_multiply(0.6));
                painter.circle_stroke(of_set.at(at), edge.x - of_set.at(at).x, stroke);
            }
            if let Some((distance, k)) = shown.response.hover_pos().and_then(|pointer| of_set.nearest(pointer))
                && nearest.is_none_or(|(closest, _)| distance < closest)
            {
                nearest = Some((distance, Place::Point(set.id, k)));
            }
            if let Some(Place::Point(id, k)) = scene.hover.place() {
                let here = kept.places.get(k / kept.every).filter(|_| id == set.id);
                if let Some(place) = here {
                    let stroke = egui::Stroke::new(1.5, ui.visuals().text_color());
                    painter.circle_stroke(of_set.at(*place), 6.0, stroke);
                }
            }
        }
        if let Some((_, place)) = nearest {
            scene.hover.at(Panel::Points, place);
        }
    }

    /// A line with the names of the sets, or the point under the pointer.
    fn readouts(&self, ui: &mut egui::Ui, scene: &Scene<'_>, drawn: &[usize]) {
        let texts = drawn.iter().map(|&s| &scene.sets[s]).filter_map(|set| {
            let (kept, points) = (self.kept.get(&set.id)?, set.points()?);
            let text = match scene.hover.place() {
                Some(Place::Point(id, k)) if id == set.id => {
                    let text = overlays::point_text(points, k)?;
                    match kept.weights.as_ref().and_then(|all| all.get(k / kept.every)) {
                        Some(weight) => format!("{text}, {}", overlays::weight_text(*weight)),
                        None => text,
                    }
                }
                _ if kept.every > 1 => format!("{}, one in {} of {} points", set.name(), kept.every, kept.n),
                _ => match kept.weights.as_ref().map(|all| all.iter().filter(|w| **w != 0.0).count()) {
                    Some(left) if left < kept.n => format!("{}, {left} of {} points kept", set.name(), kept.n),
                    Some(_) => format!("{}, {} weighted points", set.name(), kept.n),
                    None => format!("{}, {} points", set.name(), kept.n),
                },
            };
            let which = (kept.of.realization > 0).then(|| format!("realization {}", kept.of.realization));
            let hidden = [
                (scene.view.links && kept.n > MOST_LINKS)
                    .then(|| format!("no links for more than {MOST_LINKS} points")),
                (scene.view.tiling && kept.tiled > 1).then(|| format!("copies of one in {}", kept.tiled * kept.every)),
                (scene.view.strata && kept.strata.is_empty()).then(|| "no strata: n is no power".to_string()),
            ];
            let text =
                std::iter::once(text).chain(which).chain(hidden.into_iter().flatten()).collect::<Vec<_>>().join("; ");
            Some((set.color, text.clone(), text))
        });
        let texts: Vec<_> = texts.collect();
        let names = drawn.iter().map(|&s| scene.sets[s].name() + ", 10000 points").collect();
        line(ui, texts, names);
    }
}

/// Which realization of the selected set is drawn, where it has several.
pub(super) fn realizations(ui: &mut egui::Ui, scene: &mut Scene<'_>) {
    let selected = scene.sets.get(scene.selected).filter(|set| set.visible && set.last_realization() > 0);
    let Some(set) = selected else { return };
    let last = set.last_realization();
    let help = format!("Which realization of {} is drawn, 0 to {last}: drag, type or use the arrow keys", set.name());
    // Beside it there are up to three buttons.
    let name = if ui.available_width() > 215.0 { "realization" } else { "#" };
    let label = ui.label(egui::RichText::new(name).small().weak()).on_hover_text(&help).id;
    ui.spacing_mut().interact_size.x = 28.0;
    let mut index = set.realization.min(last);
    // An arrow key is worth as much as a drag of a point.
    let typed = ui.memory(|memory| memory.has_focus(ui.next_auto_id()));
    let speed = if typed { 1.0 } else { (last as f64 / 400.0).clamp(0.02, 1e6) };
    let drag = egui::DragValue::new(&mut index).range(0..=last).speed(speed);
    if ui.add(drag).labelled_by(label).on_hover_text(&help).changed() && index != set.realization {
        scene.actions.push(Action::Realization(set.id, index));
    }
}

/// A set being drawn.
struct Drawing<'a> {
    kept: &'a KeptDots,
    axis: Axis,
    shown: &'a Shown,
    painter: &'a egui::Painter,
    color: egui::Color32,
}

impl Drawing<'_> {
    fn at(&self, place: DVec2) -> egui::Pos2 {
        self.shown.on_screen(place.map(|v| self.axis.in_unit(v)))
    }

    fn paint(&self, ui: &egui::Ui, view: &View) {
        let visible = self.shown.response.rect.expand(4.0);
        let lines = |segments: &[[DVec2; 2]], stroke: egui::Stroke| {
            for ends in segments.iter().map(|s| s.map(|place| self.at(place))) {
                self.painter.line_segment(ends, stroke);
            }
        };
        let weak = ui.visuals().weak_text_color();
        if view.strata {
            lines(&self.kept.strata, egui::Stroke::new(1.0, weak.gamma_multiply(0.5)));
        }
        let [low, high] = self.kept.frame.map(|corner| self.at(corner));
        let outline = egui::Stroke::new(1.0, weak);
        self.painter.rect_stroke(egui::Rect::from_two_pos(low, high), 0.0, outline, egui::StrokeKind::Middle);
        if view.links {
            lines(
                self.kept.links.as_deref().unwrap_or_default(),
                egui::Stroke::new(1.0, self.color.gamma_multiply(0.6)),
            );
        }
        // About a sixth of the mean spacing, as far as that can be seen.
        let spacing = ((high.x - low.x).abs() * (high.y - low.y).abs().max(1.0) / self.kept.places.len() as f32).sqrt();
        let radius = (spacing / 6.0).clamp(0.7, 4.0);
        let dots = |places: &[DVec2], color: egui::Color32| {
            for at in places.iter().map(|place| self.at(*place)).filter(|at| visible.contains(*at)) {
                self.painter.circle_filled(at, radius, color);
            }
        };
        if view.tiling {
            dots(&self.kept.tiles, self.color.gamma_multiply(0.35));
        }
        match &self.kept.weights {
            None => dots(&self.kept.places, self.color),
            // As much ink as they weigh; those that are not kept are hollow.
            Some(weights) => {
                for (place, weight) in self.kept.places.iter().zip(weights) {
                    let at = self.at(*place);
                    if !visible.contains(at) {
                        continue;
                    }
                    let size = radius * (weight.abs().sqrt() as f32).clamp(0.3, 3.0);
                    match *weight == 0.0 {
                        true => _ = self.painter.circle_stroke(at, 0.6 * radius, egui::Stroke::new(1.0, weak)),
                        false => _ = self.painter.circle_filled(at, size, self.color),
                    }
                }
            }
        }
        if view.indices {
            let seen = self.kept.places.iter().enumerate().map(|(k, place)| (k, self.at(*place)));
            let seen: Vec<_> = seen.filter(|(_, at)| visible.contains(*at)).collect();
            let font = egui::TextStyle::Small.resolve(ui.style());
            let color = ui.visuals().text_color();
            let align = egui::Align2::LEFT_BOTTOM;
            if seen.len() <= MOST_INDICES {
                // Where several would lie over each other, the first is written.
                let mut taken: Vec<egui::Rect> = Vec::with_capacity(seen.len());
                for (k, at) in seen {
                    let text = (k * self.kept.every).to_string();
                    let written = self.painter.layout_no_wrap(text, font.clone(), color);
                    let place = align.anchor_size(at + egui::vec2(radius, -radius), written.size());
                    if taken.iter().all(|other| !other.intersects(place)) {
                        self.painter.galley(place.min, written, color);
                        taken.push(place);
                    }
                }
            } else {
                let corner = visible.left_bottom() + egui::vec2(8.0, -8.0);
                self.painter.text(corner, align, "zoom in to see indices", font, color);
            }
        }
    }

    /// The point drawn next to the pointer, if one is near, with its distance on the screen.
    fn nearest(&self, pointer: egui::Pos2) -> Option<(f32, usize)> {
        let distances = self.kept.places.iter().enumerate().map(|(k, place)| (self.at(*place).distance(pointer), k));
        let (distance, k) = distances.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (distance < 16.0).then_some((distance, k * self.kept.every))
    }

    /// A point about in the middle.
    fn central(&self) -> Option<DVec2> {
        let [low, high] = self.kept.frame;
        let middle = self.at(low.midpoint(high));
        let near = |a: &DVec2| self.at(*a).distance_sq(middle);
        self.kept.places.iter().copied().min_by(|a, b| near(a).total_cmp(&near(b)))
    }
}
