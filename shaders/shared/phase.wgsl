// Phases in turns, as 32-bit fractions, and their cosine and sine in f32. phase_f64 is the same in f64.

alias Real = f32;
alias Real4 = vec4<f32>;
alias Phase = vec4<u32>;

struct CosSin {
    cos: Real4,
    sin: Real4,
}

// m x mod 1 in steps of 2^-32 turns, where x = (x.x 2^-32 + x.y) 2^-32. The upper word's part is exact; the lower's is at
// most |m| and is rounded to a step (adding 1.5 * 2^23 leaves an integer in the low bits), so the error is below 1.2 steps
// for |m| < 2^22.
fn phase_turns(m: vec4<i32>, x: vec2<u32>) -> Phase {
    let carry = vec4<f32>(m) * (f32(x.x) * 2.3283064365386963e-10) + vec4<f32>(12582912.0);
    return bitcast<vec4<u32>>(m) * x.y + bitcast<vec4<u32>>(carry) - vec4<u32>(0x4b400000u);
}

fn phase_sum(a: Phase, b: Phase) -> Phase {
    return a + b;
}

// Reduced to the nearest quarter turn, |angle| <= pi/4; minimax polynomials of Cephes (sinf, cosf). Absolute error at most
// 1.2e-7, rms 2.3e-8.
fn phase_cos_sin(phase: Phase) -> CosSin {
    let quarter = (phase + vec4<u32>(0x20000000u)) >> vec4<u32>(30u);
    let angle = vec4<f32>(bitcast<vec4<i32>>(phase - (quarter << vec4<u32>(30u)))) * 1.4629180792671596e-9;
    let a2 = angle * angle;
    let s = angle + angle * a2 * (-1.6666654611e-1 + a2 * (8.3321608736e-3 + a2 * -1.9515295891e-4));
    // Small terms first: one rounding near 1, not two.
    let c = 1.0 - (0.5 * a2 - a2 * a2 * (4.166664568298827e-2 + a2 * (-1.388731625493765e-3 + a2 * 2.443315711809948e-5)));
    let swap = (quarter & vec4<u32>(1u)) != vec4<u32>(0u);
    // Quarters 1 and 2 have a negative cosine, 2 and 3 a negative sine.
    let cos_sign = ((quarter + vec4<u32>(1u)) & vec4<u32>(2u)) << vec4<u32>(30u);
    let sin_sign = (quarter & vec4<u32>(2u)) << vec4<u32>(30u);
    return CosSin(
        bitcast<vec4<f32>>(bitcast<vec4<u32>>(select(c, s, swap)) ^ cos_sign),
        bitcast<vec4<f32>>(bitcast<vec4<u32>>(select(s, c, swap)) ^ sin_sign),
    );
}
