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

/// The arcs of `weights_isotropic.wgsl`, their numbers read from there, in the same f32 operations: within what the file says, and
/// beyond it where one digit is another.
#[test]
fn arcs_keep_their_bound() {
    let text = SHADER_FILES.iter().find(|file| file.path.ends_with("weights_isotropic.wgsl")).unwrap().text;
    let numbers = |text: &str, after: &str| -> Vec<f32> {
        let from = text.find(after).unwrap() + after.len();
        let line = &text[from..from + text[from..].find(';').unwrap()];
        let words = line.split(|c: char| !(c.is_ascii_alphanumeric() || c == '.' || c == '-'));
        words.filter_map(|word| word.parse().ok()).collect()
    };
    let worst = |text: &str| {
        let turn = numbers(text, "WEIGHTS_TURN: f32 =")[0];
        let eighth = numbers(text, "(t + 1.0);\n        base =")[0];
        let quarter = numbers(text, "select(angle,")[0];
        let [a, b, c, d] = numbers(text, "let series =")[..] else { panic!("four coefficients") };
        let angle = |y: f32, x: f32| {
            let (mut t, mut base) = (y.min(x) / y.max(x), 0.0);
            if t > 0.414_213_57 {
                (t, base) = ((t - 1.0) / (t + 1.0), eighth);
            }
            let z = t * t;
            let angle = base + ((((a * z - b) * z + c) * z - d) * z * t + t);
            if y > x { quarter - angle } else { angle }
        };
        let error = |k: i32| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_2 / 1e4).sin_cos();
            let (y, x) = (sin as f32, cos as f32);
            (f64::from(angle(y, x)) / f64::from(y).atan2(x.into()) - 1.0).abs()
        };
        (1..10_000).map(error).fold((f64::from(turn) / std::f64::consts::TAU - 1.0).abs(), f64::max)
    };
    assert!(worst(text) < 3e-7, "{:e}", worst(text));
    for (right, wrong) in [
        ("8.05374449538e-2", "8.15374449538e-2"),
        ("1.38776856032e-1", "1.38976856032e-1"),
        ("1.99777106478e-1", "1.99877106478e-1"),
        ("3.33329491539e-1", "3.33319491539e-1"),
        ("6.2831855", "6.2831955"),
        ("0.78539816", "0.78539916"),
        ("1.5707964", "1.5707974"),
    ] {
        assert!(worst(&text.replace(right, wrong)) > 3e-7, "{right} as {wrong} is not seen");
    }
}

/// The polynomials of `phase_f64.wgsl`, read from there: within what the file says, and beyond it where one digit is another.
#[test]
fn phases_in_f64_keep_their_bound() {
    let text = SHADER_FILES.iter().find(|file| file.path.ends_with("phase_f64.wgsl")).unwrap().text;
    let worst = |text: &str| {
        let numbers = |after: &str| -> Vec<f64> {
            let from = text.find(after).unwrap() + after.len();
            let line = &text[from..from + text[from..].find(';').unwrap()];
            let words = line.split(|c: char| !(c.is_ascii_alphanumeric() || c == '.' || c == '-'));
            words.filter(|word| word.contains("e-")).map(|word| word.trim_end_matches("lf").parse().unwrap()).collect()
        };
        let (s, c) = (numbers("let s ="), numbers("let c ="));
        assert_eq!((s.len(), c.len()), (6, 6));
        let series = |numbers: &[f64], x: f64| numbers.iter().rev().fold(0.0, |sum, c| sum * x + c);
        let error = |k: i32| {
            let angle = f64::from(k) * std::f64::consts::FRAC_PI_4 / 1e4;
            let a2 = angle * angle;
            let sin = angle + angle * a2 * series(&s, a2);
            let cos = 1.0 - (0.5 * a2 - a2 * a2 * series(&c, a2));
            (sin - angle.sin()).abs().max((cos - angle.cos()).abs())
        };
        (-10_000..=10_000).map(error).fold(0.0, f64::max)
    };
    assert!(worst(text) <= 3e-16, "{:e}", worst(text));
    for (right, wrong) in [
        ("1.58969099521155010221e-10", "1.57969099521155010221e-10"),
        ("2.50507602534068634195e-8", "2.50607602534068634195e-8"),
        ("1.66666666666666324348e-1", "1.66666666666664324348e-1"),
        ("1.13596475577881948265e-11", "1.11596475577881948265e-11"),
        ("2.08757232129817482790e-9", "2.08857232129817482790e-9"),
        ("4.16666666666666019037e-2", "4.16666666666566019037e-2"),
    ] {
        assert!(worst(&text.replace(right, wrong)) > 3e-16, "{right} as {wrong} is not seen");
    }
}
