// More words than workgroup memory holds: every pair is counted in global memory. The other choice is
// histogram_workgroup.wgsl, which says what the words are.

override WORDS: u32 = 256u;
override SUMS: u32 = 0u;

fn histogram_clear(lane: u32) {}

fn histogram_add(word: u32, lane: u32, first_word: u32) {
    atomicAdd(&histograms[first_word + word], 1u);
}

fn histogram_add_wide(sum: u32, value: vec2<u32>, lane: u32, first_word: u32) {
    let low = first_word + WORDS - 2u * SUMS + sum;
    let before = atomicAdd(&histograms[low], value.x);
    let high = value.y + select(0u, 1u, before + value.x < before);
    if (high > 0u) { atomicAdd(&histograms[low + SUMS], high); }
}

fn histogram_flush(lane: u32, first_word: u32) {}
