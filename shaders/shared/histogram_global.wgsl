// More bins than workgroup memory holds: every pair is counted in global memory. The other choice is
// histogram_workgroup.wgsl.

fn histogram_clear(lane: u32) {}

fn histogram_add(bin: u32, lane: u32, first_word: u32) {
    atomicAdd(&histograms[first_word + bin], 1u);
}

fn histogram_flush(lane: u32, first_word: u32) {}
