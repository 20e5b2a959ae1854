//! The native path: threads and SIMD.
