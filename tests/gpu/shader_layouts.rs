//! Proves that both sides of every buffer mean the same: naga reads names, offsets and sizes of the structs and the bindings
//! of each joined shader, and they must be those of `params.rs`, in both directions. Needs no device.

use std::collections::{BTreeMap, BTreeSet};

use crate::common::*;
use pairwave::compute::gpu::params::{Access, StructLayout, struct_layouts};
use pairwave::compute::gpu::{KernelSpec, cell_kernels, lag_kernel, pair_kernel, probe_kernel, wave_kernels};
use pairwave::plan::{Accuracy, WaveGrid};

fn specs() -> Vec<KernelSpec> {
    let mut specs = vec![probe_kernel()];
    for case in pair_cases(20).into_iter().chain(corrected_cases(20)) {
        specs.push(pair_kernel(&case.plan, 32 << 10));
        specs.extend(cell_kernels(&case.plan, 32 << 10));
    }
    specs.extend(lag_cases(20).iter().map(|case| lag_kernel(&case.plan, 32 << 10)));
    for (accuracy, weighted) in [(Accuracy::Fast, false), (Accuracy::Fast, true), (Accuracy::High, true)] {
        specs.extend(wave_kernels(&WaveGrid::new(&[4, 4]).unwrap(), accuracy, weighted));
    }
    specs
}

/// The structs of a shader that a buffer can hold: name, size, fields.
type Structs = BTreeMap<String, (usize, Vec<(String, usize, usize)>)>;

fn structs(module: &naga::Module) -> Structs {
    // Only what buffers are made of: types of variables, and of what they contain.
    let mut wanted: Vec<_> =
        module.global_variables.iter().filter(|(_, v)| v.binding.is_some()).map(|(_, v)| v.ty).collect();
    let mut found = Structs::new();
    while let Some(ty) = wanted.pop() {
        match &module.types[ty].inner {
            naga::TypeInner::Array { base, .. } => wanted.push(*base),
            naga::TypeInner::Struct { members, span } => {
                let fields = members.iter().map(|m| {
                    let size = module.types[m.ty].inner.size(module.to_ctx()) as usize;
                    wanted.push(m.ty);
                    (m.name.clone().unwrap(), m.offset as usize, size)
                });
                let fields = fields.collect();
                found.insert(module.types[ty].name.clone().unwrap(), (*span as usize, fields));
            }
            _ => {}
        }
    }
    found
}

/// What differs between the twins and the shader's structs.
fn compare(twins: &[StructLayout], shader: &Structs) -> Result<(), String> {
    for (name, (size, fields)) in shader {
        let twin = twins.iter().find(|t| t.name == name).ok_or(format!("{name} has no twin"))?;
        let theirs: Vec<_> = twin.fields.iter().map(|f| (f.0.to_string(), f.1, f.2)).collect();
        if &theirs != fields || twin.size != *size {
            return Err(format!("{name}: WGSL {fields:?}, {size} bytes; Rust {theirs:?}, {} bytes", twin.size));
        }
    }
    Ok(())
}

fn compare_bindings(spec: &KernelSpec, module: &naga::Module) -> Result<(), String> {
    let shader: BTreeSet<_> = module
        .global_variables
        .iter()
        .filter_map(|(_, v)| {
            let b = v.binding?;
            let access = match v.space {
                naga::AddressSpace::Uniform => Access::Uniform,
                naga::AddressSpace::Storage { access } if access.contains(naga::StorageAccess::STORE) => {
                    Access::ReadWrite
                }
                _ => Access::Read,
            };
            Some((b.group, b.binding, v.name.clone().unwrap(), format!("{access:?}")))
        })
        .collect();
    let rust: BTreeSet<_> =
        spec.bindings.iter().map(|b| (0, b.binding, b.name.to_string(), format!("{:?}", b.access))).collect();
    if shader == rust { Ok(()) } else { Err(format!("{}: WGSL {shader:?}, Rust {rust:?}", spec.name)) }
}

#[test]
fn structs_and_bindings_match_on_both_sides() {
    let twins = struct_layouts();
    let mut seen = BTreeSet::new();
    for spec in specs() {
        let module = naga::front::wgsl::parse_str(&spec.source()).unwrap();
        let found = structs(&module);
        compare(&twins, &found).unwrap_or_else(|why| panic!("{}: {why}", spec.name));
        compare_bindings(&spec, &module).unwrap_or_else(|why| panic!("{why}"));
        seen.extend(found.into_keys());
    }
    let registered: BTreeSet<_> = twins.iter().map(|t| t.name.to_string()).collect();
    assert_eq!(seen, registered, "structs in shaders, and twins in params.rs");
}

#[test]
fn a_planted_mismatch_is_caught() {
    let spec = &specs()[1];
    let module = naga::front::wgsl::parse_str(&spec.source()).unwrap();
    let shader = structs(&module);
    assert_eq!(compare(&struct_layouts(), &shader), Ok(()));
    let planted = |change: &dyn Fn(&mut StructLayout)| {
        let mut twins = struct_layouts();
        change(twins.iter_mut().find(|t| t.name == "PairJob").unwrap());
        compare(&twins, &shader)
    };
    assert!(planted(&|t| t.fields.swap(0, 1)).is_err(), "fields in another order");
    assert!(planted(&|t| t.fields[2].1 += 4).is_err(), "a moved field");
    assert!(planted(&|t| t.size += 4).is_err(), "another size");
    assert!(planted(&|t| t.fields[0].0 = "first").is_err(), "another name");
    assert!(planted(&|t| t.name = "Job").is_err(), "a struct without a twin");

    let mut other = spec.clone();
    other.bindings = &spec.bindings[..spec.bindings.len() - 1];
    assert!(compare_bindings(&other, &module).is_err(), "a binding left out");
    let text = spec.source().replace("var<storage, read> jobs", "var<storage, read_write> jobs");
    let module = naga::front::wgsl::parse_str(&text).unwrap();
    assert!(compare_bindings(spec, &module).is_err(), "another access");
}
