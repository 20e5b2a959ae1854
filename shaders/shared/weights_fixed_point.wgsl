// Weights in f32, summed as integers. No weight is below 1, so what is summed is the excess over 1, in steps of 2^-32; the ones
// are the count.

fn weights_fixed_point(excess: f32) -> vec2<u32> {
    let whole = floor(excess);
    // Exact from 2^-8 on: an f32 has 24 bits.
    return vec2<u32>(u32(round((excess - whole) * 4294967296.0)), u32(whole));
}
