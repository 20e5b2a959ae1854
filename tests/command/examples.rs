//! The examples run, and say what they should.

use std::process::Command;

/// What an example prints. The tests of a package build its examples.
fn run(name: &str) -> String {
    let folder = std::path::Path::new(env!("CARGO_BIN_EXE_pairwave")).parent().unwrap().join("examples");
    let out = Command::new(folder.join(name)).output().unwrap_or_else(|e| {
        panic!("{name}: {e}; `cargo test` builds it, and so does `cargo build --profile test --examples`")
    });
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(out.status.success(), "{name}: {text}{}", String::from_utf8_lossy(&out.stderr));
    text
}

#[test]
fn own_points_are_a_lattice() {
    assert!(run("own_points").contains("nearest neighbours are 0.06250 apart"));
}

#[test]
fn an_own_sampler_is_measured() {
    let text = run("own_sampler");
    assert!(text.contains("sampler antithetic, n 256, K 200") && text.contains("mean of P over rings"), "{text}");
}

#[test]
fn a_gpu_is_chosen_by_its_index_or_the_cpu_takes_its_place() {
    let text = run("gpu_by_index");
    assert!(text.contains("by ") && text.contains("ordered pairs closer than"), "{text}");
}

#[test]
fn shards_are_merged() {
    assert!(run("shards").contains("merged as in one run"));
}

#[test]
fn wave_vectors_are_listed() {
    let text = run("wave_vectors");
    assert_eq!(text.lines().count(), 4);
    assert!(text.contains("P(1000000, 1) = "), "{text}");
}
