//! Points from files of every format, and back.

mod columns;
mod files;
mod foreign;
mod npy;
mod npz;
mod raw;
mod readings;
mod shared;
mod tables;
mod text;
mod utk;
mod write;
