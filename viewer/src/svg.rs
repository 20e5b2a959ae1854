//! What was laid out as SVG: the same shapes, texts and pictures as on the screen, of any size.

use std::collections::HashMap;
use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use eframe::egui::epaint::{ClippedShape, ColorMode, Mesh, PathShape, RectShape, StrokeKind, TextShape};
use eframe::egui::{Color32, ColorImage, Pos2, Rect, Shape, Stroke, TextureId, Vec2};

use crate::export;

/// Pictures in what is drawn, by their names.
pub(crate) type Pictures = HashMap<TextureId, ColorImage>;

/// The shapes as an SVG document of so many points. No ids: a page may hold several.
pub(crate) fn document(size: Vec2, shapes: &[ClippedShape], pictures: &Pictures) -> Result<String, String> {
    let whole = Rect::from_min_size(Pos2::ZERO, size);
    let mut text = String::new();
    let root = format!(r#"width="{0}" height="{1}" viewBox="0 0 {0} {1}""#, size.x, size.y);
    let fonts = "Ubuntu, Helvetica, Arial, 'DejaVu Sans', sans-serif";
    let _ = writeln!(text, r#"<svg xmlns="http://www.w3.org/2000/svg" {root} font-family="{fonts}" fill="none">"#);
    for of_one_clip in shapes.chunk_by(|a, b| a.clip_rect == b.clip_rect) {
        let clip = of_one_clip.first().map_or(whole, |shape| shape.clip_rect.intersect(whole));
        if !clip.is_positive() {
            continue;
        }
        // What is outside of an inner document is not drawn.
        let place = format!("{} {} {} {}", clip.min.x, clip.min.y, clip.width(), clip.height());
        let corner = format!(r#"x="{}" y="{}""#, clip.min.x, clip.min.y);
        let size = format!(r#"width="{}" height="{}""#, clip.width(), clip.height());
        let _ = writeln!(text, r#"<svg {corner} {size} viewBox="{place}">"#);
        for shape in of_one_clip {
            write(&mut text, &shape.shape, pictures)?;
        }
        text.push_str("</svg>\n");
    }
    text.push_str("</svg>\n");
    Ok(text)
}

fn write(text: &mut String, shape: &Shape, pictures: &Pictures) -> Result<(), String> {
    match shape {
        Shape::Vec(shapes) => shapes.iter().try_for_each(|shape| write(text, shape, pictures))?,
        Shape::Circle(circle) => {
            let place = format!(r#"cx="{:.2}" cy="{:.2}" r="{:.2}""#, circle.center.x, circle.center.y, circle.radius);
            let _ = writeln!(text, "<circle {place}{}{}/>", fill(circle.fill), stroked(circle.stroke));
        }
        Shape::LineSegment { points: [a, b], stroke } => {
            let line = format!("M{:.2} {:.2}L{:.2} {:.2}", a.x, a.y, b.x, b.y);
            let _ = writeln!(text, r#"<path d="{line}"{}/>"#, stroked(*stroke));
        }
        Shape::Path(path) => write_path(text, path),
        Shape::Rect(rect) => write_rect(text, rect, pictures)?,
        Shape::Text(written) => write_text(text, written),
        Shape::Mesh(mesh) => match pictures.get(&mesh.texture_id) {
            Some(picture) => write_picture(text, mesh.calc_bounds(), picture)?,
            None => write_mesh(text, mesh),
        },
        // Nothing of this is in a panel.
        Shape::Noop
        | Shape::Ellipse(_)
        | Shape::Band(_)
        | Shape::QuadraticBezier(_)
        | Shape::CubicBezier(_)
        | Shape::Callback(_) => {}
    }
    Ok(())
}

fn color(name: &str, color: Color32) -> String {
    let [r, g, b, a] = color.to_srgba_unmultiplied();
    let opaque = format!(r##" {name}="#{r:02x}{g:02x}{b:02x}""##);
    if a == 255 { opaque } else { format!(r#"{opaque} {name}-opacity="{:.3}""#, f32::from(a) / 255.0) }
}

fn fill(of: Color32) -> String {
    if of == Color32::TRANSPARENT { String::new() } else { color("fill", of) }
}

fn stroked(stroke: Stroke) -> String {
    if stroke.is_empty() {
        return String::new();
    }
    format!(r#"{} stroke-width="{:.2}""#, color("stroke", stroke.color), stroke.width)
}

fn write_path(text: &mut String, path: &PathShape) {
    let mut line = String::new();
    for (index, at) in path.points.iter().enumerate() {
        let _ = write!(line, "{}{:.2} {:.2}", if index == 0 { 'M' } else { 'L' }, at.x, at.y);
    }
    let end = if path.closed { "Z" } else { "" };
    let stroke = match path.stroke.color {
        ColorMode::Solid(color) => Stroke::new(path.stroke.width, color),
        ColorMode::UV(_) => Stroke::NONE,
    };
    let looks = format!(r#"{}{} stroke-linejoin="round""#, fill(path.fill), stroked(stroke));
    let _ = writeln!(text, r#"<path d="{line}{end}"{looks}/>"#);
}

fn place(of: Rect) -> String {
    let corner = format!(r#"x="{:.2}" y="{:.2}""#, of.min.x, of.min.y);
    format!(r#"{corner} width="{:.2}" height="{:.2}""#, of.width(), of.height())
}

fn write_picture(text: &mut String, rect: Rect, picture: &ColorImage) -> Result<(), String> {
    let data = STANDARD.encode(export::encode(picture).map_err(|e| e.to_string())?);
    let looks = r#"preserveAspectRatio="none" style="image-rendering:pixelated""#;
    let _ = writeln!(text, r#"<image {} {looks} href="data:image/png;base64,{data}"/>"#, place(rect));
    Ok(())
}

fn write_rect(text: &mut String, rect: &RectShape, pictures: &Pictures) -> Result<(), String> {
    let picture = rect.brush.as_ref().and_then(|brush| pictures.get(&brush.fill_texture_id));
    let outward = match rect.stroke_kind {
        StrokeKind::Inside => -0.5,
        StrokeKind::Middle => 0.0,
        StrokeKind::Outside => 0.5,
    };
    if let Some(picture) = picture {
        return write_picture(text, rect.rect, picture);
    }
    let round = format!(r#" rx="{}""#, rect.corner_radius.nw);
    let of = rect.rect.expand(if rect.stroke.is_empty() { 0.0 } else { outward * rect.stroke.width });
    if rect.fill != Color32::TRANSPARENT || !rect.stroke.is_empty() {
        let _ = writeln!(text, "<rect {}{round}{}{}/>", place(of), fill(rect.fill), stroked(rect.stroke));
    }
    Ok(())
}

/// Each row is as long as it was laid out, whatever font there is.
fn write_text(text: &mut String, written: &TextShape) {
    let galley = &written.galley;
    let Some(format) = galley.job.sections.first().map(|section| &section.format) else { return };
    let own = if format.color == Color32::PLACEHOLDER { written.fallback_color } else { format.color };
    let ink = written.override_text_color.unwrap_or(own).gamma_multiply(written.opacity_factor);
    let turn = match written.angle {
        0.0 => String::new(),
        angle => format!(r#" transform="rotate({:.2} {:.2} {:.2})""#, angle.to_degrees(), written.pos.x, written.pos.y),
    };
    for row in &galley.rows {
        let (Some(first), Some(last)) = (row.glyphs.first(), row.glyphs.last()) else { continue };
        let letters: String = row.glyphs.iter().map(|glyph| glyph.chr).collect();
        let escaped = letters.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let at = written.pos + row.pos.to_vec2() + first.pos.to_vec2();
        let length = last.pos.x + last.advance_width - first.pos.x;
        let place = format!(r#"x="{:.2}" y="{:.2}" xml:space="preserve""#, at.x, at.y);
        let look = format!(r#"font-size="{}"{}{turn}"#, format.font_id.size, color("fill", ink));
        let _ = writeln!(
            text,
            r#"<text {place} textLength="{length:.2}" lengthAdjust="spacingAndGlyphs" {look}>{escaped}</text>"#
        );
    }
}

/// Triangles of one colour as one path, all turning one way: the edges that two share cancel, and leave no seam.
fn write_mesh(text: &mut String, mesh: &Mesh) {
    let mut line = String::new();
    let mut ink = Color32::TRANSPARENT;
    for corners in mesh.indices.chunks_exact(3) {
        let corner = |k: usize| mesh.vertices.get(corners[k] as usize);
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
        let (to_b, to_c) = (b.pos - a.pos, c.pos - a.pos);
        let area = to_b.x * to_c.y - to_b.y * to_c.x;
        let (b, c) = if area < 0.0 { (c, b) } else { (b, c) };
        if area != 0.0 {
            let [a, b, c] = [a, b, c].map(|vertex| vertex.pos);
            let _ = write!(line, "M{:.2} {:.2}L{:.2} {:.2}L{:.2} {:.2}Z", a.x, a.y, b.x, b.y, c.x, c.y);
        }
        ink = a.color;
    }
    if !line.is_empty() {
        let _ = writeln!(text, r#"<path d="{line}"{}/>"#, fill(ink));
    }
}
