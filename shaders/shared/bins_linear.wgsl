// The f32 filter for equal bins from 0 (BinFilter::Linear). The other choice is bins_table.wgsl.

// The bin of a squared distance in steps of length_unit / 2^32, or OUTSIDE, or UNDECIDED | edge.
fn bins_find(r2: f32) -> u32 {
    let t = sqrt(r2) * params.bins_per_step;
    if (t >= f32(BINS) + 0.5) { return OUTSIDE; }
    let edge = round(t);
    if (edge >= 1.0 && abs(t - edge) <= params.relative_guard * t + params.absolute_guard) {
        return UNDECIDED | u32(edge);
    }
    return u32(t);
}
