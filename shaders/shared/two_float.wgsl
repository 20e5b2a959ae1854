// Sums carried as an unevaluated pair of f32, high + low.
//
// Compilers may take (s - a) - b for 0 when they know s = a + b, and drivers do. So the sum goes through an exclusive or
// with a zero that only the run time knows.

struct TwoFloat {
    high: vec4<f32>,
    low: vec4<f32>,
}

fn two_float_opaque(x: vec4<f32>, zero: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(bitcast<vec4<u32>>(x) ^ vec4<u32>(zero));
}

// TwoSum (Knuth): the rounding error of high + x joins low.
fn two_float_add(sum: TwoFloat, x: vec4<f32>, zero: u32) -> TwoFloat {
    let s = two_float_opaque(sum.high + x, zero);
    let b = s - sum.high;
    let error = (sum.high - (s - b)) + (x - b);
    return TwoFloat(s, sum.low + error);
}
