// Minimum image where the axes have different periods; 0 stands for 2^32 (rounded) or 2^64 (exact), the natural wrap.
// The other choice is torus_cubic.wgsl.

// Squared distance in f32, from coordinates and periods rounded to 32 bits, in steps of length_unit / 2^32.
fn torus_squared_distance(p: vec3<u32>, q: vec3<u32>) -> f32 {
    let period = params.side_rounded.xyz;
    let forward = p - q + select(vec3<u32>(0u), period, p < q);
    let d = vec3<f32>(min(forward, period - forward));
    var r2 = d.x * d.x;
    if (DIM > 1u) { r2 += d.y * d.y; }
    if (DIM > 2u) { r2 += d.z * d.z; }
    return r2;
}

// Distance along one axis, exact, in steps of length_unit / 2^64.
fn torus_exact_distance(a: vec2<u32>, b: vec2<u32>, axis: u32) -> vec2<u32> {
    let period = vec2<u32>(params.side_low[axis], params.side_high[axis]);
    var forward = wide_sub(a, b);
    if (wide_less(a, b)) { forward = wide_add(forward, period); }
    let backward = wide_sub(period, forward);
    if (wide_less(backward, forward)) { return backward; }
    return forward;
}

// The lag p - q in steps of length_unit / 2^32, from rounded coordinates and periods.
fn torus_lag(p: vec3<u32>, q: vec3<u32>) -> vec3<i32> {
    let period = params.side_rounded.xyz;
    let forward = p - q + select(vec3<u32>(0u), period, p < q);
    return bitcast<vec3<i32>>(forward - select(vec3<u32>(0u), period, forward >= period - forward));
}

// The lag a - b along one axis, exact, in [-period / 2, period / 2), modulo 2^64.
fn torus_exact_lag(a: vec2<u32>, b: vec2<u32>, axis: u32) -> vec2<u32> {
    let period = vec2<u32>(params.side_low[axis], params.side_high[axis]);
    var forward = wide_sub(a, b);
    if (wide_less(a, b)) { forward = wide_add(forward, period); }
    if (wide_less(forward, wide_sub(period, forward))) { return forward; }
    return wide_sub(forward, period);
}
