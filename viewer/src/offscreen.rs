//! Pictures beside the screen, laid out in a context of their own: of more pixels than it has, drawn by the device that draws the
//! window, or as SVG.

use std::sync::Arc;

use eframe::egui;
use eframe::egui::epaint::{ClippedShape, ImageDelta};
use eframe::egui_wgpu::{RenderState, Renderer, RendererOptions, ScreenDescriptor, wgpu};

use crate::svg::{self, Pictures};

/// Frames until a layout has settled: fonts are there in the second, axes have their room in the third.
const FRAMES: usize = 4;

/// Lays a picture of so many points out, in a context of its own. Its shapes; `texture` hears of the pictures in it.
fn laid_out(
    ctx: &egui::Context,
    size: egui::Vec2,
    pixels_per_point: f32,
    most: usize,
    mut ui: impl FnMut(&mut egui::Ui),
    mut texture: impl FnMut(egui::TextureId, &ImageDelta),
) -> Vec<ClippedShape> {
    let mut shapes = Vec::new();
    for _ in 0..FRAMES {
        let mut input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
            max_texture_side: Some(most),
            ..Default::default()
        };
        if let Some(viewport) = input.viewports.get_mut(&egui::ViewportId::ROOT) {
            viewport.native_pixels_per_point = Some(pixels_per_point);
        }
        let mut output = ctx.run_ui(input, &mut ui);
        for (id, images) in output.textures_delta.set.drain() {
            images.iter().for_each(|image| texture(id, image));
        }
        // What is to be freed goes with the context.
        output.textures_delta.free.clear();
        shapes = output.shapes;
    }
    shapes
}

/// A picture of so many points as SVG; pictures in it have at most so many pixels per side.
///
/// # Errors
/// A picture in it that cannot be encoded, in words.
pub(crate) fn svg(
    ctx: &egui::Context,
    size: egui::Vec2,
    most: usize,
    ui: impl FnMut(&mut egui::Ui),
) -> Result<String, String> {
    let mut pictures = Pictures::new();
    let shapes = laid_out(ctx, size, 1.0, most, ui, |id, image| {
        // The default one holds letters, which are written as text.
        let egui::ImageData::Color(whole) = &image.image;
        if id != egui::TextureId::default() && image.pos.is_none() {
            pictures.insert(id, Arc::unwrap_or_clone(whole.clone()));
        }
    });
    svg::document(size, &shapes, &pictures)
}

/// Draws a picture of so many pixels, and so many of them per point.
///
/// # Errors
/// What the device cannot hold, or did not do, in words.
pub(crate) fn draw(
    state: &RenderState,
    ctx: &egui::Context,
    [width, height]: [u32; 2],
    pixels_per_point: f32,
    ui: impl FnMut(&mut egui::Ui),
) -> Result<egui::ColorImage, String> {
    let (device, queue) = (&state.device, &state.queue);
    let size = egui::vec2(width as f32, height as f32) / pixels_per_point;
    let most = device.limits().max_texture_dimension_2d;
    if width.max(height) > most {
        return Err(format!(
            "the picture would have {width} x {height} pixels; this device draws at most {most} per side"
        ));
    }
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let mut renderer = Renderer::new(device, format, RendererOptions::default());
    let texture = |id, image: &ImageDelta| renderer.update_texture(device, queue, id, image);
    let shapes = laid_out(ctx, size, pixels_per_point, most as usize, ui, texture);
    let jobs = ctx.tessellate(shapes, pixels_per_point);
    let screen = ScreenDescriptor { size_in_pixels: [width, height], pixels_per_point };
    let extent = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture"),
        size: extent,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let before = renderer.update_buffers(device, queue, &mut encoder, &jobs, &screen);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let attachment = wgpu::RenderPassColorAttachment {
        view: &view,
        resolve_target: None,
        ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        depth_slice: None,
    };
    let pass = wgpu::RenderPassDescriptor { color_attachments: &[Some(attachment)], ..Default::default() };
    renderer.render(&mut encoder.begin_render_pass(&pass).forget_lifetime(), &jobs, &screen);
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
        },
        extent,
    );
    queue.submit(before.into_iter().chain([encoder.finish()]));
    let (tell, told) = std::sync::mpsc::channel();
    buffer.slice(..).map_async(wgpu::MapMode::Read, move |mapped| _ = tell.send(mapped));
    let failed = |error: &dyn std::fmt::Display| format!("the device did not give the picture back: {error}");
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| failed(&e))?;
    told.recv().map_err(|e| failed(&e))?.map_err(|e| failed(&e))?;
    let bytes = buffer.slice(..).get_mapped_range().map_err(|e| failed(&e))?;
    let pixels: Vec<u8> = bytes.chunks(row as usize).flat_map(|line| &line[..4 * width as usize]).copied().collect();
    Ok(egui::ColorImage::from_rgba_premultiplied([width as usize, height as usize], &pixels))
}
