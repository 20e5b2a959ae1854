// The histogram of a workgroup in its own memory, in several copies so that lanes rarely meet in one bin; one global
// atomic per bin at the end. The other choice is histogram_global.wgsl.

override COPIES: u32 = 1u;
// BINS * COPIES
override HISTOGRAM_WORDS: u32 = 256u;

var<workgroup> histogram: array<atomic<u32>, HISTOGRAM_WORDS>;

fn histogram_clear(lane: u32) {
    for (var word = lane; word < HISTOGRAM_WORDS; word += WORKGROUP) { atomicStore(&histogram[word], 0u); }
    workgroupBarrier();
}

fn histogram_add(bin: u32, lane: u32, first_word: u32) {
    atomicAdd(&histogram[bin * COPIES + lane % COPIES], 1u);
}

fn histogram_flush(lane: u32, first_word: u32) {
    workgroupBarrier();
    for (var bin = lane; bin < BINS; bin += WORKGROUP) {
        var count = 0u;
        for (var copy = 0u; copy < COPIES; copy++) { count += atomicLoad(&histogram[bin * COPIES + copy]); }
        if (count > 0u) { atomicAdd(&histograms[first_word + bin], count); }
    }
}
