//! Kernels as one would write them first, on the device that was measured, for the ratio.

use std::error::Error;

pub const SPECTRUM: &str = include_str!("naive_spectrum.wgsl");
pub const PAIRS: &str = include_str!("naive_pairs.wgsl");

/// A device with a naive kernel and points.
pub struct Naive {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    answers: wgpu::Buffer,
    groups: u32,
}

impl Naive {
    /// On adapter `index` of `pairwave::compute::gpu::adapters()`; `points` lie in the unit square. Next to their number the kernel is
    /// given `size`, and runs `invocations` to write `answers` words.
    pub fn new(
        index: usize,
        kernel: &str,
        points: &[[f32; 2]],
        size: u32,
        [invocations, answers]: [u32; 2],
    ) -> Result<Self, Box<dyn Error>> {
        let backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = backends;
        let instance = wgpu::Instance::new(descriptor);
        let adapters = pollster::block_on(instance.enumerate_adapters(backends));
        let adapter = adapters.get(index).ok_or("no such adapter")?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
        let source = wgpu::ShaderSource::Wgsl(kernel.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let buffer = |size: usize, usage| {
            let size = size as u64;
            let usage = usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
            device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
        };
        let params = buffer(8, wgpu::BufferUsages::UNIFORM);
        queue.write_buffer(&params, 0, bytemuck::cast_slice(&[points.len() as u32, size]));
        let places = buffer(size_of_val(points), wgpu::BufferUsages::STORAGE);
        queue.write_buffer(&places, 0, bytemuck::cast_slice(points));
        let answers = buffer(4 * answers as usize, wgpu::BufferUsages::STORAGE);
        let entries = [&params, &places, &answers].into_iter().zip(0..).map(|(buffer, binding)| {
            let resource = buffer.as_entire_binding();
            wgpu::BindGroupEntry { binding, resource }
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries.collect::<Vec<_>>(),
        });
        Ok(Self { device, queue, pipeline, group, answers, groups: invocations.div_ceil(64) })
    }

    /// The words that the kernel writes, from 0 on; the time is that of the kernel and the copy.
    pub fn run<T: bytemuck::Pod>(&self) -> Result<Vec<T>, Box<dyn Error>> {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.clear_buffer(&self.answers, 0, None);
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.group, &[]);
            pass.dispatch_workgroups(self.groups, 1, 1);
        }
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: self.answers.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        encoder.copy_buffer_to_buffer(&self.answers, 0, &staging, 0, staging.size());
        self.queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, .., |_| ());
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..)?))
    }
}
