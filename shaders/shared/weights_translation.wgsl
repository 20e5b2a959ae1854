// Translation weights, prod a / (a - |h|) over the axes, with sides a and differences h.

// Rounding to 32 bits moves a - |h| by up to 1.5 steps: where it has fewer steps than this, 64 bits are used.
const WEIGHTS_ROUNDED: u32 = 0x1000000u;

// a / (a - |h|) - 1 along one axis.
fn weights_excess(p: u32, q: u32, i: u32, j: u32, axis: u32) -> f32 {
    let h = max(p, q) - min(p, q);
    let overlap = params.side_rounded[axis] - h;
    // Rounding may also take it below 0, which is beyond 2^31.
    if (overlap >= WEIGHTS_ROUNDED && overlap <= 0x80000000u) { return f32(h) / f32(overlap); }
    let offset = axis * params.total_points;
    let exact_h = torus_exact_distance(exact[offset + i], exact[offset + j], axis);
    let side = vec2<u32>(params.side_low[axis], params.side_high[axis]);
    return wide_f32(exact_h) / wide_f32(wide_sub(side, exact_h));
}

fn weights_add(bin: u32, i: u32, p: vec3<u32>, j: u32, q: vec3<u32>, lane: u32, first_word: u32) {
    histogram_add(bin, lane, first_word);
    var excess = weights_excess(p.x, q.x, i, j, 0u);
    if (DIM > 1u) {
        let e = weights_excess(p.y, q.y, i, j, 1u);
        excess += e + excess * e;
    }
    if (DIM > 2u) {
        let e = weights_excess(p.z, q.z, i, j, 2u);
        excess += e + excess * e;
    }
    histogram_add_wide(bin, weights_fixed_point(excess), lane, first_word);
}
