// The histogram of a workgroup in its own memory, in several copies so that lanes rarely meet in one word; one global atomic
// per word at the end. The other choice is histogram_global.wgsl.
//
// Of its WORDS, the last 2 * SUMS are sums of 64 bits: all low halves, then all high halves. Integers only: no order of
// additions is better than another.

override WORDS: u32 = 256u;
override SUMS: u32 = 0u;
override COPIES: u32 = 1u;
// WORDS * COPIES
override HISTOGRAM_WORDS: u32 = 256u;

var<workgroup> histogram: array<atomic<u32>, HISTOGRAM_WORDS>;

fn histogram_clear(lane: u32) {
    for (var word = lane; word < HISTOGRAM_WORDS; word += WORKGROUP) { atomicStore(&histogram[word], 0u); }
    workgroupBarrier();
}

fn histogram_add(word: u32, lane: u32, first_word: u32) {
    atomicAdd(&histogram[word * COPIES + lane % COPIES], 1u);
}

fn histogram_add_wide(sum: u32, value: vec2<u32>, lane: u32, first_word: u32) {
    let low = (WORDS - 2u * SUMS + sum) * COPIES + lane % COPIES;
    let before = atomicAdd(&histogram[low], value.x);
    let high = value.y + select(0u, 1u, before + value.x < before);
    if (high > 0u) { atomicAdd(&histogram[low + SUMS * COPIES], high); }
}

fn histogram_flush(lane: u32, first_word: u32) {
    workgroupBarrier();
    for (var word = lane; word < WORDS - 2u * SUMS; word += WORKGROUP) {
        var count = 0u;
        for (var copy = 0u; copy < COPIES; copy++) { count += atomicLoad(&histogram[word * COPIES + copy]); }
        if (count > 0u) { atomicAdd(&histograms[first_word + word], count); }
    }
    for (var word = WORDS - 2u * SUMS + lane; word < WORDS - SUMS; word += WORKGROUP) {
        var sum = vec2<u32>(0u);
        for (var copy = 0u; copy < COPIES; copy++) {
            let low = word * COPIES + copy;
            sum = wide_add(sum, vec2<u32>(atomicLoad(&histogram[low]), atomicLoad(&histogram[low + SUMS * COPIES])));
        }
        let before = atomicAdd(&histograms[first_word + word], sum.x);
        let high = sum.y + select(0u, 1u, before + sum.x < before);
        if (high > 0u) { atomicAdd(&histograms[first_word + word + SUMS], high); }
    }
}
