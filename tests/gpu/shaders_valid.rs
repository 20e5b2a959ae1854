//! Proves that every WGSL file is used, and that every kernel the plans can ask for (each choice of files, with the numbers
//! of a plan) is valid and can be written as SPIR-V, MSL, HLSL and WGSL: it stays portable to Vulkan, Metal, Direct3D
//! and the browser, those in f64 as far as these have it. Needs no device. Cannot see what those compilers make of it.

use std::collections::BTreeSet;
use std::path::Path;

use crate::common::*;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use pairwave::compute::gpu::{
    KernelSpec, SHADER_FILES, cell_kernels, lag_kernel, pair_kernel, probe_kernel, wave_kernels,
};
use pairwave::plan::{Accuracy, Correction, EnsembleShape, PairPlan, RadialBins, WaveGrid};
use pairwave::points::Domain;

/// The workgroup memory every WebGPU device has, and that of most.
const WORKGROUP_BYTES: [u32; 2] = [16 << 10, 32 << 10];

/// Every kernel for every choice that plans make.
fn specs() -> Vec<KernelSpec> {
    let mut specs = vec![probe_kernel()];
    for case in pair_cases(60).into_iter().chain(corrected_cases(60)) {
        specs.extend(WORKGROUP_BYTES.map(|bytes| pair_kernel(&case.plan, bytes)));
        specs.extend(WORKGROUP_BYTES.map(|bytes| cell_kernels(&case.plan, bytes)).into_iter().flatten());
    }
    for case in lag_cases(20) {
        specs.extend(WORKGROUP_BYTES.map(|bytes| lag_kernel(&case.plan, bytes)));
    }
    for dim in 1..=3 {
        let cubic = Domain::unit_torus(dim);
        let unequal = Domain::torus(&[1.0, 0.5, 0.7][..dim]).unwrap();
        for (domain, points) in [(&cubic, 100), (&cubic, 1 << 20), (&unequal, 100), (&unequal, 1 << 20)] {
            for bins in [1, 7, 256, 1024, 4000, 8000, 100_000] {
                let shape = EnsembleShape { realizations: 1, mean_points: points as f64, max_points: points };
                let r = domain.shortest_side() / 2.0;
                let linear = RadialBins::linear(r, bins).unwrap();
                let log = RadialBins::logarithmic(r * 1e-3, r, bins).unwrap();
                for bins in [linear, log] {
                    let plan = PairPlan::new(domain, bins, Correction::None, shape).unwrap();
                    specs.extend(WORKGROUP_BYTES.map(|bytes| pair_kernel(&plan, bytes)));
                    specs.extend(WORKGROUP_BYTES.map(|bytes| cell_kernels(&plan, bytes)).into_iter().flatten());
                }
            }
        }
    }
    for f in [&[100][..], &[65_536, 2], &[10, 10], &[64, 64], &[3, 300], &[9, 8, 7], &[0, 0, 5], &[40, 40, 40]] {
        for accuracy in [Accuracy::Fast, Accuracy::High] {
            for weighted in [false, true] {
                specs.extend(wave_kernels(&WaveGrid::new(f).unwrap(), accuracy, weighted));
            }
        }
    }
    let mut unique: Vec<KernelSpec> = Vec::new();
    for spec in specs {
        if !unique.contains(&spec) {
            unique.push(spec);
        }
    }
    unique
}

/// The stems and files on disk, relative to `shaders/`.
fn files_on_disk() -> BTreeSet<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut found = BTreeSet::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.insert(path.strip_prefix(&root).unwrap().to_str().unwrap().replace('\\', "/"));
            }
        }
    }
    found
}

/// Validates one kernel and writes it in every language, or says what is wrong.
fn check(spec: &KernelSpec) -> Result<(), String> {
    let source = spec.source();
    let module = naga::front::wgsl::parse_str(&source).map_err(|e| e.emit_to_string(&source))?;
    let info = Validator::new(ValidationFlags::all(), spec.capabilities())
        .validate(&module)
        .map_err(|e| e.emit_to_string(&source))?;
    // A number nobody set keeps the default written in the file, which is for readers, not for plans.
    for (_, number) in module.overrides.iter() {
        let name = number.name.as_deref().unwrap_or("?");
        if !spec.overrides.iter().any(|o| o.0 == name) {
            return Err(format!("override {name} is not set"));
        }
    }
    for (name, _) in &spec.overrides {
        if !module.overrides.iter().any(|(_, o)| o.name.as_deref() == Some(name)) {
            return Err(format!("there is no override {name}"));
        }
    }
    let constants = spec.overrides.iter().map(|&(k, v)| (k.to_string(), f64::from(v))).collect();
    let main = Some((naga::ShaderStage::Compute, "main"));
    let (module, info) = naga::back::pipeline_constants::process_overrides(&module, &info, main, &constants)
        .map_err(|e| e.to_string())?;

    let spirv = naga::back::spv::write_vec(&module, &info, &naga::back::spv::Options::default(), None)
        .map_err(|e| format!("SPIR-V: {e}"))?;
    let options = naga::back::hlsl::Options { fake_missing_bindings: true, ..Default::default() };
    let pipeline = naga::back::hlsl::PipelineOptions::default();
    let mut hlsl = String::new();
    naga::back::hlsl::Writer::new(&mut hlsl, &options, &pipeline)
        .write(&module, &info, None)
        .map_err(|e| format!("HLSL: {e}"))?;
    let wgsl = naga::back::wgsl::write_string(&module, &info, naga::back::wgsl::WriterFlags::empty())
        .map_err(|e| format!("WGSL: {e}"))?;
    let options = naga::back::msl::Options { fake_missing_bindings: true, ..Default::default() };
    let metal = if spec.uses_f64() {
        "Metal has no f64".to_string()
    } else {
        let written = naga::back::msl::write_string(&module, &info, &options, &Default::default());
        written.map_err(|e| format!("MSL: {e}"))?.0
    };
    // Not read again: naga 30 leaves the element type out of arrays whose length is an override. A browser gets our text.
    if spirv.is_empty() || metal.is_empty() || hlsl.is_empty() || wgsl.is_empty() {
        return Err("an empty translation".into());
    }
    Ok(())
}

#[test]
fn every_kernel_is_valid_and_portable() {
    let specs = specs();
    println!("{} kernels", specs.len());
    assert!(specs.len() > 50, "plans ask for more kernels than {}", specs.len());
    for spec in &specs {
        let files: Vec<_> = spec.files.iter().map(|f| f.path).collect();
        if let Err(why) = check(spec) {
            panic!("{} from {files:?} with {:?}: {why}", spec.name, spec.overrides);
        }
        let bytes = spec.workgroup_bytes().unwrap();
        assert!(bytes <= 32 << 10, "{files:?} with {:?} needs {bytes} bytes", spec.overrides);
        let threads = spec.overrides.iter().find(|o| o.0 == "WORKGROUP").unwrap().1;
        assert!((1..=256).contains(&threads), "every WebGPU device takes 256 invocations, not {threads}");
    }
}

#[test]
fn workgroup_memory_follows_the_smaller_limit() {
    for case in pair_cases(60).into_iter().chain(corrected_cases(60)) {
        for bytes in WORKGROUP_BYTES {
            for kernel in [pair_kernel(&case.plan, bytes)].into_iter().chain(cell_kernels(&case.plan, bytes)) {
                let used = kernel.workgroup_bytes().unwrap();
                assert!(used <= bytes, "{}: {used} of {bytes} bytes", case.name);
            }
        }
    }
    for case in lag_cases(20) {
        for bytes in WORKGROUP_BYTES {
            let used = lag_kernel(&case.plan, bytes).workgroup_bytes().unwrap();
            assert!(used <= bytes, "{}: {used} of {bytes} bytes", case.name);
        }
    }
}

#[test]
fn files_on_disk_are_the_files_of_kernels() {
    let disk = files_on_disk();
    assert!(disk.len() >= 10, "found only {disk:?}");
    let listed: BTreeSet<_> = SHADER_FILES.iter().map(|f| f.path.to_string()).collect();
    assert_eq!(disk, listed, "shaders/ and SHADER_FILES");
    let used: BTreeSet<_> = specs().iter().flat_map(|s| s.files.clone()).map(|f| f.path.to_string()).collect();
    assert_eq!(used, disk, "a file no plan uses is not tested by anything");
    for file in SHADER_FILES {
        let has_main = file.text.contains("fn main(");
        assert_eq!(has_main, !file.path.starts_with("shared/"), "{}: one entry point per file, none shared", file.path);
    }
    for spec in specs() {
        assert_eq!(spec.files.last().unwrap().path, format!("{}.wgsl", spec.name), "the stem names the kernel");
    }
}

#[test]
fn a_broken_shader_is_caught() {
    let mut spec = probe_kernel();
    spec.overrides.push(("NO_SUCH_NUMBER", 1));
    assert!(check(&spec).is_err(), "an override that is not there");
    let mut spec = probe_kernel();
    spec.overrides.clear();
    assert!(check(&spec).is_err(), "an override that is not set");
    let mut spec = probe_kernel();
    spec.files.remove(0);
    assert!(check(&spec).is_err(), "a file left out");
    let [precise, _] = wave_kernels(&WaveGrid::new(&[4, 4]).unwrap(), Accuracy::High, false);
    assert!(precise.uses_f64() && !probe_kernel().uses_f64());
    let plain = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&naga::front::wgsl::parse_str(&precise.source()).unwrap());
    assert!(plain.is_err(), "f64 in plain WGSL");
}
