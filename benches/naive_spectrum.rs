//! The naive kernel on the device that was measured, for the ratio.

use std::error::Error;

/// A device with the naive kernel and points.
pub struct Naive {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    power: wgpu::Buffer,
    groups: u32,
}

impl Naive {
    /// On adapter `index` of `pairwave::compute::gpu::adapters()`; `points` lie in the unit square.
    pub fn new(index: usize, points: &[[f32; 2]], frequency: u32) -> Result<Self, Box<dyn Error>> {
        let backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = backends;
        let instance = wgpu::Instance::new(descriptor);
        let adapters = pollster::block_on(instance.enumerate_adapters(backends));
        let adapter = adapters.get(index).ok_or("no such adapter")?;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;
        let source = wgpu::ShaderSource::Wgsl(include_str!("naive_spectrum.wgsl").into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let modes = (frequency + 1) * (2 * frequency + 1);
        let buffer = |size: usize, usage| {
            let size = size as u64;
            let usage = usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
            device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
        };
        let params = buffer(8, wgpu::BufferUsages::UNIFORM);
        queue.write_buffer(&params, 0, bytemuck::cast_slice(&[points.len() as u32, frequency]));
        let places = buffer(size_of_val(points), wgpu::BufferUsages::STORAGE);
        queue.write_buffer(&places, 0, bytemuck::cast_slice(points));
        let power = buffer(4 * modes as usize, wgpu::BufferUsages::STORAGE);
        let entries = [&params, &places, &power].into_iter().zip(0..).map(|(buffer, binding)| {
            let resource = buffer.as_entire_binding();
            wgpu::BindGroupEntry { binding, resource }
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries.collect::<Vec<_>>(),
        });
        Ok(Self { device, queue, pipeline, group, power, groups: modes.div_ceil(64) })
    }

    /// `|s_m|^2` of every m, and the time is that of the kernel and the copy.
    pub fn run(&self) -> Result<Vec<f32>, Box<dyn Error>> {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.group, &[]);
            pass.dispatch_workgroups(self.groups, 1, 1);
        }
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: self.power.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        encoder.copy_buffer_to_buffer(&self.power, 0, &staging, 0, staging.size());
        self.queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, .., |_| ());
        self.device.poll(wgpu::PollType::wait_indefinitely())?;
        Ok(bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..)?))
    }
}
