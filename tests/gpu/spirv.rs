//! The kernels that docs/gpu.md counts. Its table of workgroups is theirs; `python benches/spirv.py` has their SPIR-V written, as wgpu
//! hands it to a Vulkan driver, and counts. Needs no device.

use naga::back::spv;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{ValidationFlags, Validator};
use pairwave::compute::gpu::{KernelSpec, cell_kernels, lag_kernel, pair_kernel, probe_kernel, wave_kernels};
use pairwave::plan::{Accuracy, Correction, EnsembleShape, LagGrid, LagPlan, PairPlan, RadialBins, WaveGrid};
use pairwave::points::Domain;

/// The workgroup memory of an NVIDIA card.
const WORKGROUP_BYTES: u32 = 48 << 10;
const POINTS: u64 = 1_000_000;

/// Each by the name that it has in the page.
fn counted() -> Vec<(&'static str, KernelSpec)> {
    let shape = |points: u64| EnsembleShape { realizations: 1, mean_points: points as f64, max_points: points };
    let torus = Domain::unit_torus;
    let box_torus = Domain::torus(&[1.0, 0.5]).unwrap();
    let window = Domain::window(&[(0.0, 1.0), (0.0, 1.0)]).unwrap();
    let linear = |r: f64, bins: usize| RadialBins::linear(r, bins).unwrap();
    let log = RadialBins::logarithmic(1e-3, 0.5, 256).unwrap();
    let plan = |domain: &Domain, bins: RadialBins, correction: Correction, points: u64| {
        PairPlan::new(domain, bins, correction, shape(points)).unwrap()
    };
    let none = Correction::None;
    let mut all = Vec::new();
    for (name, plan) in [
        ("pairs 2D", plan(&torus(2), linear(0.5, 256), none, POINTS)),
        ("pairs 2D, few points", plan(&torus(2), linear(0.5, 256), none, 10_000)),
        ("pairs 2D, 1024 bins", plan(&torus(2), linear(0.5, 1024), none, POINTS)),
        ("pairs 2D, 16384 bins", plan(&torus(2), linear(0.5, 16_384), none, POINTS)),
        ("pairs 2D, logarithmic", plan(&torus(2), log, none, POINTS)),
        ("pairs 2D, unequal sides", plan(&box_torus, linear(0.25, 256), none, POINTS)),
        ("pairs 3D", plan(&torus(3), linear(0.5, 256), none, POINTS)),
        ("pairs 2D, translation", plan(&window, linear(0.25, 256), Correction::Translation, POINTS)),
        ("pairs 2D, isotropic", plan(&window, linear(0.25, 256), Correction::Isotropic, POINTS)),
        ("pairs 2D, border", plan(&window, linear(0.25, 256), Correction::Border, POINTS)),
    ] {
        all.push((name, pair_kernel(&plan, WORKGROUP_BYTES)));
    }
    let near = |dim| plan(&torus(dim), linear(0.02, 256), none, POINTS);
    let [count, scatter, cells] = cell_kernels(&near(2), WORKGROUP_BYTES);
    all.extend([("cells 2D", cells), ("sort 2D, count", count), ("sort 2D, scatter", scatter)]);
    let [count, scatter, cells] = cell_kernels(&near(3), WORKGROUP_BYTES);
    all.extend([("cells 3D", cells), ("sort 3D, count", count), ("sort 3D, scatter", scatter)]);
    for (name, dim, bins) in
        [("lags 2D, 64 x 64", 2, 64), ("lags 2D, 256 x 256", 2, 256), ("lags 3D, 16 x 16 x 16", 3, 16)]
    {
        let grid = LagGrid::new(&torus(dim), bins, Some(0.5)).unwrap();
        let plan = LagPlan::new(&torus(dim), grid, none, None, shape(POINTS)).unwrap();
        all.push((name, lag_kernel(&plan, WORKGROUP_BYTES)));
    }
    for (power, fold, f, accuracy) in [
        ("power 2D, f32", "fold 2D, f32", &[256, 256][..], Accuracy::Fast),
        ("power 3D, f32", "fold 3D, f32", &[64, 64, 64], Accuracy::Fast),
        ("power 2D, f64", "fold 2D, f64", &[256, 256], Accuracy::High),
        ("power 1D, f32", "fold 1D, f32", &[1024], Accuracy::Fast),
    ] {
        let [product, folded] = wave_kernels(&WaveGrid::new(f).unwrap(), accuracy, false);
        all.extend([(power, product), (fold, folded)]);
    }
    all.push(("probe", probe_kernel()));
    all
}

fn number(spec: &KernelSpec, name: &str) -> Option<u32> {
    spec.overrides.iter().find(|o| o.0 == name).map(|o| o.1)
}

#[test]
fn the_page_has_their_workgroups() {
    let page = include_str!("../../docs/gpu.md");
    for (name, spec) in counted() {
        let (lanes, bytes) = (number(&spec, "WORKGROUP").unwrap(), spec.workgroup_bytes().unwrap());
        let row = format!("| {name} | {lanes} | {bytes} |");
        assert!(page.contains(&row), "docs/gpu.md has no row `{row}`");
    }
}

/// What `vulkan/adapter.rs` of wgpu-hal asks of naga where a driver has Vulkan 1.3 and robustBufferAccess2; or without the checks that it adds
/// to loops and to indices.
fn spirv(spec: &KernelSpec, checked: bool) -> Vec<u32> {
    let module = naga::front::wgsl::parse_str(&spec.source()).unwrap();
    let info = Validator::new(ValidationFlags::all(), spec.capabilities()).validate(&module).unwrap();
    let constants = spec.overrides.iter().map(|&(k, v)| (k.to_string(), f64::from(v))).collect();
    let main = Some((naga::ShaderStage::Compute, "main"));
    let (module, info) = naga::back::pipeline_constants::process_overrides(&module, &info, main, &constants).unwrap();
    let options = spv::Options {
        lang_version: (1, 6),
        flags: spv::WriterFlags::LABEL_VARYINGS,
        bounds_check_policies: BoundsCheckPolicies {
            index: if checked { BoundsCheckPolicy::Restrict } else { BoundsCheckPolicy::Unchecked },
            buffer: BoundsCheckPolicy::Unchecked,
            ..BoundsCheckPolicies::default()
        },
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::Native,
        force_loop_bounding: checked,
        ..spv::Options::default()
    };
    let entry = spv::PipelineOptions { shader_stage: naga::ShaderStage::Compute, entry_point: "main".into() };
    spv::write_vec(&module, &info, &options, Some(&entry)).unwrap()
}

#[test]
#[ignore = "writes files, for benches/spirv.py"]
fn they_are_written() {
    let folder = std::env::var("PAIRWAVE_SPIRV").expect("PAIRWAVE_SPIRV names a folder");
    for (name, spec) in counted() {
        for (kind, checked) in [("", true), (" unchecked", false)] {
            let words = spirv(&spec, checked);
            std::fs::write(format!("{folder}/{name}{kind}.spv"), bytemuck::cast_slice::<u32, u8>(&words)).unwrap();
        }
    }
}
