// Phases in turns, as 64-bit fractions, and their cosine and sine in f64: phase.wgsl for devices with SHADER_F64. Of f64
// nothing but + - * is used: drivers may have no other functions, or wrong ones.

alias Real = f64;
alias Real4 = vec4<f64>;

// Fractions of a turn in steps of 2^-64.
struct Phase {
    low: vec4<u32>,
    high: vec4<u32>,
}

struct CosSin {
    cos: Real4,
    sin: Real4,
}

// m x mod 1, exactly, where x = (x.x 2^-32 + x.y) 2^-32.
fn phase_turns(m: vec4<i32>, x: vec2<u32>) -> Phase {
    let bits = bitcast<vec4<u32>>(m);
    // The product of two 32-bit integers from halves of 16 bits.
    let m0 = bits & vec4<u32>(0xffffu);
    let m1 = bits >> vec4<u32>(16u);
    let x0 = x.x & 0xffffu;
    let x1 = x.x >> 16u;
    let p00 = m0 * x0;
    let p01 = m0 * x1;
    let p10 = m1 * x0;
    let middle = (p00 >> vec4<u32>(16u)) + (p01 & vec4<u32>(0xffffu)) + (p10 & vec4<u32>(0xffffu));
    let carry = m1 * x1 + (p01 >> vec4<u32>(16u)) + (p10 >> vec4<u32>(16u)) + (middle >> vec4<u32>(16u));
    // A negative m is read as m + 2^32.
    let borrow = select(vec4<u32>(0u), vec4<u32>(x.x), m < vec4<i32>(0));
    return Phase(bits * x.x, bits * x.y + carry - borrow);
}

fn phase_sum(a: Phase, b: Phase) -> Phase {
    let low = a.low + b.low;
    return Phase(low, a.high + b.high + select(vec4<u32>(0u), vec4<u32>(1u), low < a.low));
}

// Reduced to the nearest quarter turn, |angle| <= pi/4; polynomials of fdlibm (k_sin.c, k_cos.c, Sun Microsystems, 1993).
// Absolute error at most 3e-16.
fn phase_cos_sin(phase: Phase) -> CosSin {
    let quarter = (phase.high + vec4<u32>(0x20000000u)) >> vec4<u32>(30u);
    let high = Real4(bitcast<vec4<i32>>(phase.high - (quarter << vec4<u32>(30u))));
    let turns = high * 2.3283064365386962890625e-10lf + Real4(phase.low) * 5.42101086242752217003726400434970855712890625e-20lf;
    let angle = turns * 6.283185307179586476925286766559lf;
    let a2 = angle * angle;
    let s = angle + angle * a2 * (-1.66666666666666324348e-1lf + a2 * (8.33333333332248946124e-3lf
        + a2 * (-1.98412698298579493134e-4lf + a2 * (2.75573137070700676789e-6lf
        + a2 * (-2.50507602534068634195e-8lf + a2 * 1.58969099521155010221e-10lf)))));
    // Small terms first: one rounding near 1, not two.
    let c = 1.0lf - (0.5lf * a2 - a2 * a2 * (4.16666666666666019037e-2lf + a2 * (-1.38888888888741095749e-3lf
        + a2 * (2.48015872894767294178e-5lf + a2 * (-2.75573143513906633035e-7lf
        + a2 * (2.08757232129817482790e-9lf + a2 * -1.13596475577881948265e-11lf))))));
    let swap = (quarter & vec4<u32>(1u)) != vec4<u32>(0u);
    let cos = select(c, s, swap);
    let sin = select(s, c, swap);
    // Quarters 1 and 2 have a negative cosine, 2 and 3 a negative sine.
    return CosSin(
        select(cos, -cos, ((quarter + vec4<u32>(1u)) & vec4<u32>(2u)) != vec4<u32>(0u)),
        select(sin, -sin, (quarter & vec4<u32>(2u)) != vec4<u32>(0u)),
    );
}
