// Totals over chunks of what wave_carry left, as two-float sums. Joined with: shared/two_float.

alias Real4 = vec4<f32>;

@group(0) @binding(2) var<storage, read> sums: array<vec4<i32>>;

alias Total = TwoFloat;

fn total_add(total: Total, group: u32, slot: u32, lane: u32) -> Total {
    let place = (group * 2u * SLOTS + slot) * LANES + lane;
    let steps = sums[place];
    let rest = bitcast<vec4<f32>>(sums[place + SLOTS * LANES]);
    // Two parts that are exact in f32.
    let fine = steps & vec4<i32>(0xff);
    var added = two_float_add(total, vec4<f32>(steps - fine) * 3.0517578125e-5, params.zero);
    added.low += vec4<f32>(fine) * 3.0517578125e-5 + rest;
    return added;
}

fn total_sum(a: Total, b: Total) -> Real4 {
    return (a.high + b.high) + (a.low + b.low);
}

fn total_difference(a: Total, b: Total) -> Real4 {
    return (a.high - b.high) + (a.low - b.low);
}
