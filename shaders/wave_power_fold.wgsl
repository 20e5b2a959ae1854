// The sums of wave_power, folded into |s_m|^2: chunks of points are added in order, then
// s_m = (CC - SS) - i (SC + CS) for m = (row, +column), and s_m = (CC + SS) - i (SC - CS) for (row, -column).
//
// Joined with: shared/two_float, shared/wave_types.

override WORKGROUP: u32 = 64u;

@group(0) @binding(0) var<uniform> params: WaveParams;
// Chunks of each realization.
@group(0) @binding(1) var<storage, read> realizations: array<WaveRange>;
@group(0) @binding(2) var<storage, read> sums: array<WaveSums>;
// |s|^2 of (row, +column) and (row, -column).
@group(0) @binding(3) var<storage, read_write> power: array<vec2<f32>>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let job = params.first_job * WORKGROUP + id.x;
    if (job >= params.jobs) { return; }
    let modes = params.rows * params.columns;
    let realization = realizations[job / modes];
    var total = TwoFloat();
    for (var k = 0u; k < realization.count; k++) {
        let part = sums[(realization.first + k) * modes + job % modes];
        total = two_float_add(total, part.high, params.zero);
        total.low += part.low;
    }
    // x = CC, y = SS, z = CS, w = SC
    let re_plus = (total.high.x - total.high.y) + (total.low.x - total.low.y);
    let re_minus = (total.high.x + total.high.y) + (total.low.x + total.low.y);
    let im_plus = (total.high.w + total.high.z) + (total.low.w + total.low.z);
    let im_minus = (total.high.w - total.high.z) + (total.low.w - total.low.z);
    power[job] = vec2<f32>(re_plus * re_plus + im_plus * im_plus, re_minus * re_minus + im_minus * im_minus);
}
