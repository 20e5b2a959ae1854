// Unsigned integers wider than 32 bits, as limbs, least significant first: 64 bits in vec2<u32>, 128 in vec4<u32>.

fn wide_add(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2<u32>(low, a.y + b.y + select(0u, 1u, low < a.x));
}

fn wide_sub(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(a.x - b.x, a.y - b.y - select(0u, 1u, a.x < b.x));
}

fn wide_less(a: vec2<u32>, b: vec2<u32>) -> bool {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
}

// The full product of two 32-bit integers.
fn wide_product(a: u32, b: u32) -> vec2<u32> {
    let a0 = a & 0xffffu;
    let a1 = a >> 16u;
    let b0 = b & 0xffffu;
    let b1 = b >> 16u;
    let p00 = a0 * b0;
    let p01 = a0 * b1;
    let p10 = a1 * b0;
    let middle = (p00 >> 16u) + (p01 & 0xffffu) + (p10 & 0xffffu);
    let low = (p00 & 0xffffu) | (middle << 16u);
    return vec2<u32>(low, a1 * b1 + (p01 >> 16u) + (p10 >> 16u) + (middle >> 16u));
}

// The square of a 64-bit integer: low^2 + 2^33 low high + 2^64 high^2.
fn wide_square(a: vec2<u32>) -> vec4<u32> {
    let low = wide_product(a.x, a.x);
    let cross = wide_product(a.x, a.y);
    let high = wide_product(a.y, a.y);
    let doubled = vec4<u32>(0u, cross.x << 1u, (cross.y << 1u) | (cross.x >> 31u), cross.y >> 31u);
    return wide_add_128(vec4<u32>(low, high), doubled);
}

fn wide_add_128(a: vec4<u32>, b: vec4<u32>) -> vec4<u32> {
    let low = wide_add(a.xy, b.xy);
    let carry = select(0u, 1u, wide_less(low, a.xy));
    return vec4<u32>(low, wide_add(wide_add(a.zw, b.zw), vec2<u32>(carry, 0u)));
}

fn wide_less_128(a: vec4<u32>, b: vec4<u32>) -> bool {
    return wide_less(a.zw, b.zw) || (all(a.zw == b.zw) && wide_less(a.xy, b.xy));
}

fn wide_sub_128(a: vec4<u32>, b: vec4<u32>) -> vec4<u32> {
    let borrow = select(0u, 1u, wide_less(a.xy, b.xy));
    return vec4<u32>(wide_sub(a.xy, b.xy), wide_sub(wide_sub(a.zw, b.zw), vec2<u32>(borrow, 0u)));
}

// The nearest f32, or a neighbour of it.
fn wide_f32(a: vec2<u32>) -> f32 {
    return f32(a.y) * 4294967296.0 + f32(a.x);
}

fn wide_f32_128(a: vec4<u32>) -> f32 {
    return wide_f32(a.zw) * 18446744073709551616.0 + wide_f32(a.xy);
}

// The full product of two 64-bit integers.
fn wide_product_128(a: vec2<u32>, b: vec2<u32>) -> vec4<u32> {
    let outer = vec4<u32>(wide_product(a.x, b.x), wide_product(a.y, b.y));
    let first = wide_add_128(outer, vec4<u32>(0u, wide_product(a.x, b.y), 0u));
    return wide_add_128(first, vec4<u32>(0u, wide_product(a.y, b.x), 0u));
}

// The lower half of a 64-bit integer shifted right by 1 to 63 bits.
fn wide_shift_right(a: vec2<u32>, bits: u32) -> u32 {
    if (bits >= 32u) { return a.y >> (bits - 32u); }
    return (a.x >> bits) | (a.y << (32u - bits));
}
