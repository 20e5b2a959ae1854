//! A kernel: WGSL files joined as text, numbers filled in, checked, made ready. Immutable and reused; buffers belong to
//! the call.

use super::device::Gpu;
use super::params::{Access, Binding};
use crate::error::Result;

/// One WGSL file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShaderFile {
    /// Its path below `shaders/`.
    pub path: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! shader_files {
    ($($name:ident = $path:literal;)+) => {
        $(pub(super) const $name: ShaderFile =
            ShaderFile { path: $path, text: include_str!(concat!("../../../shaders/", $path)) };)+

        /// Every WGSL file of the program.
        pub const SHADER_FILES: &[ShaderFile] = &[$($name),+];
    };
}

shader_files! {
    WIDE_INTEGERS = "shared/wide_integers.wgsl";
    TORUS_CUBIC = "shared/torus_cubic.wgsl";
    TORUS_BOX = "shared/torus_box.wgsl";
    BINS_LINEAR = "shared/bins_linear.wgsl";
    BINS_TABLE = "shared/bins_table.wgsl";
    HISTOGRAM_WORKGROUP = "shared/histogram_workgroup.wgsl";
    HISTOGRAM_GLOBAL = "shared/histogram_global.wgsl";
    WEIGHTS_NONE = "shared/weights_none.wgsl";
    WEIGHTS_FIXED_POINT = "shared/weights_fixed_point.wgsl";
    WEIGHTS_TRANSLATION = "shared/weights_translation.wgsl";
    WEIGHTS_ISOTROPIC = "shared/weights_isotropic.wgsl";
    WEIGHTS_BORDER = "shared/weights_border.wgsl";
    PAIRS = "shared/pairs.wgsl";
    PAIR_COUNTS = "pair_counts.wgsl";
    LAG_COUNTS = "lag_counts.wgsl";
    PAIR_COUNTS_CELLS = "pair_counts_cells.wgsl";
    CELL_TYPES = "shared/cell_types.wgsl";
    CELL_COUNT = "cell_count.wgsl";
    CELL_SCATTER = "cell_scatter.wgsl";
    PHASE = "shared/phase.wgsl";
    PHASE_F64 = "shared/phase_f64.wgsl";
    TWO_FLOAT = "shared/two_float.wgsl";
    WAVE_TYPES = "shared/wave_types.wgsl";
    WAVE_UNWEIGHTED = "shared/wave_unweighted.wgsl";
    WAVE_WEIGHTED = "shared/wave_weighted.wgsl";
    WAVE_CARRY = "shared/wave_carry.wgsl";
    WAVE_CARRY_F64 = "shared/wave_carry_f64.wgsl";
    WAVE_TOTAL = "shared/wave_total.wgsl";
    WAVE_TOTAL_F64 = "shared/wave_total_f64.wgsl";
    WAVE_POWER = "wave_power.wgsl";
    WAVE_POWER_FOLD = "wave_power_fold.wgsl";
    PROBE = "probe.wgsl";
}

/// What a kernel is made of: a value that can be printed, compared and checked without a device.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelSpec {
    /// The stem of the file with the entry point `main`.
    pub name: &'static str,
    /// The files, in reading order.
    pub files: Vec<ShaderFile>,
    /// The numbers.
    pub overrides: Vec<(&'static str, u32)>,
    /// The bindings of group 0.
    pub bindings: &'static [Binding],
}

impl KernelSpec {
    /// The text a device compiles.
    pub fn source(&self) -> String {
        self.files.iter().map(|file| format!("// ---- {}\n{}\n", file.path, file.text)).collect()
    }

    /// Whether it takes `SHADER_F64`, which is not WebGPU. Files that compute in f64 say so in their names.
    pub fn uses_f64(&self) -> bool {
        self.files.iter().any(|file| file.path.ends_with("_f64.wgsl"))
    }

    /// What naga is to allow beyond WebGPU.
    pub fn capabilities(&self) -> naga::valid::Capabilities {
        if self.uses_f64() { naga::valid::Capabilities::FLOAT64 } else { naga::valid::Capabilities::empty() }
    }

    /// Bytes of workgroup memory with the numbers filled in. wgpu does not check this against the limit.
    ///
    /// # Errors
    /// A kernel that does not compile, in the words of the compiler.
    pub fn workgroup_bytes(&self) -> Result<u32, String> {
        let module = naga::front::wgsl::parse_str(&self.source()).map_err(|e| e.emit_to_string(&self.source()))?;
        let flags = naga::valid::ValidationFlags::all();
        let mut validator = naga::valid::Validator::new(flags, self.capabilities());
        let info = validator.validate(&module).map_err(|e| e.emit_to_string(&self.source()))?;
        let constants = self.overrides.iter().map(|&(name, value)| (name.to_string(), f64::from(value))).collect();
        let main = Some((naga::ShaderStage::Compute, "main"));
        let (module, _) = naga::back::pipeline_constants::process_overrides(&module, &info, main, &constants)
            .map_err(|e| e.to_string())?;
        let mut layouts = naga::proc::Layouter::default();
        layouts.update(module.to_ctx()).map_err(|e| e.to_string())?;
        let shared = module.global_variables.iter().filter(|(_, v)| v.space == naga::AddressSpace::WorkGroup);
        Ok(shared.map(|(_, v)| layouts[v.ty].size).sum())
    }
}

/// A kernel made ready on one device.
#[derive(Debug)]
pub struct Kernel {
    spec: KernelSpec,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Kernel {
    /// Checks and compiles.
    ///
    /// # Errors
    /// `Error::Device` if the device refuses it.
    pub async fn new(gpu: &Gpu, spec: KernelSpec) -> Result<Self> {
        let name = spec.name;
        let bytes = spec.workgroup_bytes().map_err(|reason| gpu.error(name, reason))?;
        let limit = gpu.limits.max_compute_workgroup_storage_size;
        if bytes > limit {
            return Err(gpu.error(name, format!("needs {bytes} bytes of workgroup memory, the device has {limit}")));
        }
        gpu.guarded(name, async || {
            let entries: Vec<_> = spec.bindings.iter().map(layout_entry).collect();
            let layout = gpu
                .device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(name), entries: &entries });
            let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(name),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            });
            let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(name),
                source: wgpu::ShaderSource::Wgsl(spec.source().into()),
            });
            let constants: Vec<_> = spec.overrides.iter().map(|&(key, value)| (key, f64::from(value))).collect();
            let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some("main"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    zero_initialize_workgroup_memory: true,
                },
                cache: None,
            });
            Ok(Self { spec, layout, pipeline })
        })
        .await
    }

    /// What it is made of.
    pub fn spec(&self) -> &KernelSpec {
        &self.spec
    }

    /// Appends `groups` workgroups to the encoder. `buffers` in the order of the bindings.
    pub(super) fn dispatch(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        buffers: &[&wgpu::Buffer],
        groups: u32,
    ) {
        let name = self.spec.name;
        debug_assert_eq!(buffers.len(), self.spec.bindings.len(), "{name}: one buffer per binding");
        let entries: Vec<_> = self
            .spec
            .bindings
            .iter()
            .zip(buffers)
            .map(|(b, buffer)| wgpu::BindGroupEntry { binding: b.binding, resource: buffer.as_entire_binding() })
            .collect();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(name),
            layout: &self.layout,
            entries: &entries,
        });
        let descriptor = wgpu::ComputePassDescriptor { label: Some(name), timestamp_writes: None };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(groups, 1, 1);
    }
}

fn layout_entry(binding: &Binding) -> wgpu::BindGroupLayoutEntry {
    let ty = match binding.access {
        Access::Uniform => wgpu::BufferBindingType::Uniform,
        Access::Read => wgpu::BufferBindingType::Storage { read_only: true },
        Access::ReadWrite => wgpu::BufferBindingType::Storage { read_only: false },
    };
    wgpu::BindGroupLayoutEntry {
        binding: binding.binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}
