// Sums in f64, which need no panels: they are written when the chunk ends.

// Of each workgroup, SLOTS * WORKGROUP.
@group(0) @binding(3) var<storage, read_write> sums: array<vec4<f64>>;

struct Carry {
    group: u32,
    lane: u32,
    // The chunk's first panel, and its last.
    first: bool,
    last: bool,
}

fn carry(at: Carry, slot: u32, sum: vec4<f64>) -> vec4<f64> {
    if (at.last) {
        sums[(at.group * SLOTS + slot) * WORKGROUP + at.lane] = sum;
    }
    return sum;
}
