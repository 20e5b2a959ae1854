//! Points from files of every format, and back.

mod columns;
mod files;
mod npy;
mod npz;
mod raw;
mod shared;
mod text;
mod utk;
mod write;
