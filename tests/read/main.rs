//! Points from files of every format, and back.

#[cfg(feature = "tables")]
mod columnar;
mod columns;
mod files;
mod foreign;
mod npy;
mod npz;
mod raw;
mod readings;
mod replay;
mod shared;
mod tables;
mod text;
mod utk;
mod write;

/// More than any test here needs: what a header claims must not be allocated before it is there.
#[global_allocator]
static ALLOCATOR: cap::Cap<std::alloc::System> = cap::Cap::new(std::alloc::System, 1 << 30);
