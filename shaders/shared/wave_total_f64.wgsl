// Totals over chunks of what wave_carry_f64 left.

alias Real4 = vec4<f64>;

@group(0) @binding(2) var<storage, read> sums: array<vec4<f64>>;

alias Total = vec4<f64>;

fn total_add(total: Total, group: u32, slot: u32, lane: u32) -> Total {
    return total + sums[(group * SLOTS + slot) * LANES + lane];
}

fn total_sum(a: Total, b: Total) -> Real4 {
    return a + b;
}

fn total_difference(a: Total, b: Total) -> Real4 {
    return a - b;
}
