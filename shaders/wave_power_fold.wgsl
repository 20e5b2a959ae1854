// The sums of wave_power, folded into |s_m|^2: chunks of points are added in order, then
// s_m = (CC - SS) - i (SC + CS) for m = (row, +column), and s_m = (CC + SS) - i (SC - CS) for (row, -column). Along row 0
// and column 0, s_m = C - i S.
//
// Joined with: shared/wave_types; shared/two_float and shared/wave_total, or shared/wave_total_f64.

override WORKGROUP: u32 = 64u;
// As in wave_power.
override ENTRIES: u32 = 32u;
override LANES: u32 = 256u;
override SLOTS: u32 = 18u;
// Of a block: ENTRIES, then 4 LANES of them where there is a product, row by row of the invocations.
override ITEMS: u32 = 1056u;

@group(0) @binding(0) var<uniform> params: WaveParams;
// Chunks of each realization.
@group(0) @binding(1) var<storage, read> realizations: array<WaveRange>;
// Of each realization, block and item, |s|^2 of the (row, +column) and of the (row, -column); of an entry the first four.
@group(0) @binding(3) var<storage, read_write> power: array<Real4>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let job = params.first_job * WORKGROUP + id.x;
    if (job >= params.jobs) { return; }
    let blocks = params.row_blocks * params.column_blocks;
    let item = job % ITEMS;
    let block = job / ITEMS % blocks;
    let chunks = realizations[job / ITEMS / blocks];
    if (item < ENTRIES) {
        var c = Total(); var s = Total();
        for (var k = 0u; k < chunks.count; k++) {
            let group = wave_group(chunks.first + k, block);
            for (var lane = item; lane < LANES; lane += ENTRIES) {
                c = total_add(c, group, 0u, lane);
                s = total_add(s, group, 1u, lane);
            }
        }
        let re = total_sum(c, Total());
        let im = total_sum(s, Total());
        power[2u * job] = re * re + im * im;
    } else {
        let lane = (item - ENTRIES) % LANES;
        let slot = 2u + (item - ENTRIES) / LANES * 4u;
        var cc = Total(); var ss = Total(); var cs = Total(); var sc = Total();
        for (var k = 0u; k < chunks.count; k++) {
            let group = wave_group(chunks.first + k, block);
            cc = total_add(cc, group, slot, lane);
            ss = total_add(ss, group, slot + 1u, lane);
            cs = total_add(cs, group, slot + 2u, lane);
            sc = total_add(sc, group, slot + 3u, lane);
        }
        let re_plus = total_difference(cc, ss);
        let re_minus = total_sum(cc, ss);
        let im_plus = total_sum(sc, cs);
        let im_minus = total_difference(sc, cs);
        power[2u * job] = re_plus * re_plus + im_plus * im_plus;
        power[2u * job + 1u] = re_minus * re_minus + im_minus * im_minus;
    }
}
