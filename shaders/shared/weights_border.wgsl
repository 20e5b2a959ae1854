// Minus sampling: beside all pairs, those seen from points deeper inside the window than the bin's upper edge. Words: pairs per
// bin; ordered pairs (i, j) in bin b with depths[i] > b, per bin; the same pairs of all bins per depths[i].

// Per point, the number of bins whose upper edge is at most its distance from the border.
@group(0) @binding(8) var<storage, read> depths: array<u32>;

fn weights_add(bin: u32, i: u32, p: vec3<u32>, j: u32, q: vec3<u32>, lane: u32, first_word: u32) {
    histogram_add(bin, lane, first_word);
    weights_see(bin, depths[i], lane, first_word);
    weights_see(bin, depths[j], lane, first_word);
}

fn weights_see(bin: u32, depth: u32, lane: u32, first_word: u32) {
    if (depth > bin) {
        histogram_add(BINS + bin, lane, first_word);
        histogram_add(2u * BINS + depth, lane, first_word);
    }
}
