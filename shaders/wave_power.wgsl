// The sums over points from which s_m follows (definition: src/compute/reference/wave_power.rs).
//
// exp(-2 pi i m.x) = exp(-2 pi i m_0 x) exp(-2 pi i (m_1 y + m_2 z)), so the sums over points are a product of two
// tables: rows m_0 >= 0, and columns, of which one of each pair +-(m_1, m_2) is enough. Each invocation holds a block of 4
// rows by 4 columns, PANEL points are summed in it, then the sums are carried to memory, and what is left goes on.
//
// Registers of the f32 kernel: 64 sums, 8 of the table entry, 16 table values, and about 20 for phases and places: below 128,
// so that 2 workgroups of 256 share a processor of 65536 registers, and one multiplies while the other makes tables.
// Per point that is 64 multiply-adds to 4 loads of 16 bytes, the ratio of an 8 by 8 block of a real matrix product.
//
// Joined with: shared/wave_types; shared/phase and shared/wave_carry, or shared/phase_f64 and shared/wave_carry_f64;
// shared/wave_unweighted or shared/wave_weighted.

override DIM: u32 = 2u;
// The workgroup has WORKGROUP >= ROW_LANES * COLUMN_LANES invocations, a multiple of ENTRIES = ROW_LANES + COLUMN_LANES.
override ROW_LANES: u32 = 16u;
override COLUMN_LANES: u32 = 16u;
override ENTRIES: u32 = 32u;
override WORKGROUP: u32 = 256u;
// 18, or 2 where there are no rows or no columns to multiply.
override SLOTS: u32 = 18u;
// Points whose tables are held at a time, a multiple of WORKGROUP / ENTRIES, and TILE * ENTRIES.
override TILE: u32 = 16u;
override TABLE_WORDS: u32 = 512u;
// Points between carries, a multiple of TILE.
override PANEL: u32 = 64u;

@group(0) @binding(0) var<uniform> params: WaveParams;
@group(0) @binding(1) var<storage, read> chunks: array<WaveRange>;
// 64-bit fractions of the side, low word first.
@group(0) @binding(2) var<storage, read> fractions: array<vec2<u32>>;

// Entry e of point p of the tile at p * ENTRIES + e: rows, times the point's weight, then columns.
var<workgroup> table_cos: array<Real4, TABLE_WORDS>;
var<workgroup> table_sin: array<Real4, TABLE_WORDS>;

// The sums of 4 rows by 4 columns: cos cos, sin sin, cos sin and sin cos of each row and all columns.
struct Product {
    cc0: Real4, ss0: Real4, cs0: Real4, sc0: Real4,
    cc1: Real4, ss1: Real4, cs1: Real4, sc1: Real4,
    cc2: Real4, ss2: Real4, cs2: Real4, sc2: Real4,
    cc3: Real4, ss3: Real4, cs3: Real4, sc3: Real4,
}

fn multiply(sums: ptr<function, Product>, p: u32, row: u32, column: u32) {
    let rc = table_cos[p * ENTRIES + row];
    let rs = table_sin[p * ENTRIES + row];
    let c = table_cos[p * ENTRIES + column];
    let s = table_sin[p * ENTRIES + column];
    (*sums).cc0 = fma(rc.xxxx, c, (*sums).cc0);
    (*sums).ss0 = fma(rs.xxxx, s, (*sums).ss0);
    (*sums).cs0 = fma(rc.xxxx, s, (*sums).cs0);
    (*sums).sc0 = fma(rs.xxxx, c, (*sums).sc0);
    (*sums).cc1 = fma(rc.yyyy, c, (*sums).cc1);
    (*sums).ss1 = fma(rs.yyyy, s, (*sums).ss1);
    (*sums).cs1 = fma(rc.yyyy, s, (*sums).cs1);
    (*sums).sc1 = fma(rs.yyyy, c, (*sums).sc1);
    (*sums).cc2 = fma(rc.zzzz, c, (*sums).cc2);
    (*sums).ss2 = fma(rs.zzzz, s, (*sums).ss2);
    (*sums).cs2 = fma(rc.zzzz, s, (*sums).cs2);
    (*sums).sc2 = fma(rs.zzzz, c, (*sums).sc2);
    (*sums).cc3 = fma(rc.wwww, c, (*sums).cc3);
    (*sums).ss3 = fma(rs.wwww, s, (*sums).ss3);
    (*sums).cs3 = fma(rc.wwww, s, (*sums).cs3);
    (*sums).sc3 = fma(rs.wwww, c, (*sums).sc3);
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let blocks = params.row_blocks * params.column_blocks;
    let job = params.first_job + id.x;
    let block = job % blocks;
    let chunk_index = job / blocks;
    let chunk = chunks[chunk_index];
    let group = wave_group(chunk_index, block);

    // The table entry this invocation makes.
    let entry = lane % ENTRIES;
    let is_row = entry < ROW_LANES;
    let first_of_four = select(
        params.first_column + (block % params.column_blocks * COLUMN_LANES + entry - ROW_LANES) * 4u,
        params.first_row + (block / params.column_blocks * ROW_LANES + entry) * 4u,
        is_row,
    );
    let four = vec4<u32>(first_of_four) + vec4<u32>(0u, 1u, 2u, 3u);
    let axis = select(min(1u, DIM - 1u), 0u, is_row) * params.total_points;
    var m = bitcast<vec4<i32>>(four);
    var m_2 = vec4<i32>();
    if (DIM > 2u && !is_row) {
        // Columns are numbered along (m_1, m_2) from (0, 0) onward.
        let width = vec4<u32>(2u * params.frequency_2 + 1u);
        let shifted = four + vec4<u32>(params.frequency_2);
        m = bitcast<vec4<i32>>(shifted / width);
        m_2 = bitcast<vec4<i32>>(shifted % width - vec4<u32>(params.frequency_2));
    }

    // The table entries it multiplies.
    let row = lane % ROW_LANES;
    let column = ROW_LANES + min(lane / ROW_LANES, COLUMN_LANES - 1u);

    var line_cos = Real4(); var line_sin = Real4();
    var product = Product();

    for (var panel = 0u; panel < chunk.count; panel += PANEL) {
        let panel_end = min(panel + PANEL, chunk.count);
        for (var first = panel; first < panel_end; first += TILE) {
            workgroupBarrier();
            for (var p = lane / ENTRIES; p < TILE; p += WORKGROUP / ENTRIES) {
                // Past the last point a row of zeros adds nothing.
                let point = chunk.first + min(first + p, chunk.count - 1u);
                let weight = select(Real(0), point_weight(point), first + p < panel_end);
                var phase = phase_turns(m, fractions[axis + point]);
                if (DIM > 2u && !is_row) {
                    phase = phase_sum(phase, phase_turns(m_2, fractions[2u * params.total_points + point]));
                }
                let plain = phase_cos_sin(phase);
                let weighted = CosSin(plain.cos * weight, plain.sin * weight);
                line_cos += weighted.cos;
                line_sin += weighted.sin;
                table_cos[p * ENTRIES + entry] = select(plain.cos, weighted.cos, is_row);
                table_sin[p * ENTRIES + entry] = select(plain.sin, weighted.sin, is_row);
            }
            workgroupBarrier();
            if (SLOTS > 2u) {
                // Loops are counted by the checks of wgpu, too.
                for (var p = 0u; p < TILE; p += 4u) {
                    multiply(&product, p, row, column);
                    multiply(&product, p + 1u, row, column);
                    multiply(&product, p + 2u, row, column);
                    multiply(&product, p + 3u, row, column);
                }
            }
        }
        let at = Carry(group, lane, panel == 0u, panel_end == chunk.count);
        line_cos = carry(at, 0u, line_cos);
        line_sin = carry(at, 1u, line_sin);
        if (SLOTS > 2u) {
            product.cc0 = carry(at, 2u, product.cc0);
            product.ss0 = carry(at, 3u, product.ss0);
            product.cs0 = carry(at, 4u, product.cs0);
            product.sc0 = carry(at, 5u, product.sc0);
            product.cc1 = carry(at, 6u, product.cc1);
            product.ss1 = carry(at, 7u, product.ss1);
            product.cs1 = carry(at, 8u, product.cs1);
            product.sc1 = carry(at, 9u, product.sc1);
            product.cc2 = carry(at, 10u, product.cc2);
            product.ss2 = carry(at, 11u, product.ss2);
            product.cs2 = carry(at, 12u, product.cs2);
            product.sc2 = carry(at, 13u, product.sc2);
            product.cc3 = carry(at, 14u, product.cc3);
            product.ss3 = carry(at, 15u, product.ss3);
            product.cs3 = carry(at, 16u, product.cs3);
            product.sc3 = carry(at, 17u, product.sc3);
        }
    }
}
