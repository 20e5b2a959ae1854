#![no_main]

#[path = "../targets.rs"]
mod targets;

// Panics of the libraries that the reader catches are no faults, so that the hook must not end the program; those that it does not catch do.
libfuzzer_sys::fuzz_target!(
    init: std::panic::set_hook(Box::new(|_| {})),
    |bytes: &[u8]| targets::run("points_parquet", bytes)
);
