//! Buffers that live as long as one call: upload, scratch, read back.

use bytemuck::Pod;

use super::device::{Gpu, Waiting};
use crate::error::Result;

/// What scratch memory holds before a kernel writes to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fill {
    /// Zeros.
    #[default]
    Zero,
    /// Garbage, so that a kernel that reads what nobody wrote is found out. Uploads get a tail of it, too.
    Poison,
}

/// A NaN as f32 and a large number as u32.
const POISON: u32 = 0xffc5_a5a5;
/// Poisoned words after the data of an upload.
const TAIL_WORDS: usize = 1024;

impl Gpu {
    fn buffer(&self, label: &'static str, bytes: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let descriptor = wgpu::BufferDescriptor {
            label: Some(label),
            // A binding holds at least one element, the largest of which has 32 bytes; a write is a multiple of 4.
            size: bytes.next_multiple_of(16).max(32),
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        };
        self.device.create_buffer(&descriptor)
    }

    /// A uniform buffer holding `value`.
    pub(super) fn uniform<T: Pod>(&self, label: &'static str, value: &T) -> wgpu::Buffer {
        let buffer = self.buffer(label, size_of::<T>() as u64, wgpu::BufferUsages::UNIFORM);
        self.queue.write_buffer(&buffer, 0, bytemuck::bytes_of(value));
        buffer
    }

    /// A storage buffer holding `data`.
    pub(super) fn upload<T: Pod>(&self, label: &'static str, data: &[T], fill: Fill) -> wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let tail = if fill == Fill::Poison { TAIL_WORDS } else { 0 };
        let buffer = self.buffer(label, (bytes.len() + 4 * tail) as u64, wgpu::BufferUsages::STORAGE);
        if !bytes.is_empty() {
            self.queue.write_buffer(&buffer, 0, bytes);
        }
        if tail > 0 {
            self.queue.write_buffer(&buffer, bytes.len() as u64, bytemuck::cast_slice(&[POISON; TAIL_WORDS]));
        }
        buffer
    }

    /// A storage buffer of `bytes` that kernels write to and that may be read back.
    pub(super) fn scratch(&self, label: &'static str, bytes: u64, fill: Fill) -> wgpu::Buffer {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let buffer = self.buffer(label, bytes, usage);
        if fill == Fill::Poison {
            let words = vec![POISON; (buffer.size() / 4) as usize];
            self.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&words));
        }
        buffer
    }

    /// Submits what `encoder` holds, to be followed by a copy of the first `len` values of `source` to the host.
    pub(super) fn submit_and_read<T: Pod>(
        &self,
        what: &'static str,
        mut encoder: wgpu::CommandEncoder,
        source: &wgpu::Buffer,
        len: usize,
    ) -> ReadBack {
        let bytes = (len * size_of::<T>()) as u64;
        let staging = self.buffer("read_back", bytes, wgpu::BufferUsages::MAP_READ);
        encoder.copy_buffer_to_buffer(source, 0, &staging, 0, bytes);
        let submission = self.queue.submit([encoder.finish()]);
        let (mapped, answer) = Waiting::of(submission);
        staging.map_async(wgpu::MapMode::Read, 0..bytes, answer);
        ReadBack { what, staging, bytes, mapped }
    }

    /// Waits for a submission and returns what it read.
    pub(super) async fn finish<T: Pod>(&self, read: ReadBack) -> Result<Vec<T>> {
        let what = read.what;
        self.wait(what, read.mapped).await?.map_err(|e| self.error(what, e))?;
        let view = read.staging.get_mapped_range(0..read.bytes).map_err(|e| self.error(what, e))?;
        Ok(bytemuck::pod_collect_to_vec(&view))
    }

    /// Submits, waits and reads in one go.
    pub(super) async fn read_back<T: Pod>(
        &self,
        what: &'static str,
        encoder: wgpu::CommandEncoder,
        source: &wgpu::Buffer,
        len: usize,
    ) -> Result<Vec<T>> {
        self.finish(self.submit_and_read::<T>(what, encoder, source, len)).await
    }
}

/// A copy to the host under way.
pub(super) struct ReadBack {
    what: &'static str,
    staging: wgpu::Buffer,
    bytes: u64,
    mapped: Waiting<Result<(), wgpu::BufferAsyncError>>,
}
