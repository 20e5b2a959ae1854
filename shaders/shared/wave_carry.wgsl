// Sums of panels in f32, added up without any rounding: the part of a sum that is a multiple of 2^-15 moves into an integer
// in memory, the rest stays where it is. So the error of a chunk is that of its panels alone. A panel has at most 127 points
// and a chunk at most 2^15, of weights up to 1.

// Of each workgroup, SLOTS * WORKGROUP integers in steps of 2^-15, then as many rests: the bits of f32.
@group(0) @binding(3) var<storage, read_write> sums: array<vec4<i32>>;

struct Carry {
    group: u32,
    lane: u32,
    // The chunk's first panel, and its last.
    first: bool,
    last: bool,
}

fn carry(at: Carry, slot: u32, sum: vec4<f32>) -> vec4<f32> {
    let place = (at.group * 2u * SLOTS + slot) * WORKGROUP + at.lane;
    // Numbers next to 384 are multiples of 2^-15. A compiler that knew them would take (sum + 384) - 384 for sum.
    let near = bitcast<vec4<u32>>(sum + vec4<f32>(384.0)) ^ vec4<u32>(params.zero);
    let steps = bitcast<vec4<i32>>(near - vec4<u32>(0x43c00000u));
    let rest = sum - (bitcast<vec4<f32>>(near) - vec4<f32>(384.0));
    if (at.first) {
        sums[place] = steps;
    } else {
        sums[place] += steps;
    }
    if (at.last) {
        sums[place + SLOTS * WORKGROUP] = bitcast<vec4<i32>>(rest);
    }
    return rest;
}
