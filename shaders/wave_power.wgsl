// The four sums over points from which s_m follows (definition: src/compute/reference/wave_power.rs).
//
// exp(-2 pi i m.x) = exp(-2 pi i m_0 x) exp(-2 pi i (m_1 y + m_2 z)), so the sums over points are a product of two
// tables: rows m_0 >= 0, and columns, of which one of each pair +-(m_1, m_2) is enough. Each invocation holds a block of 4
// rows by 4 columns in registers. Panels of PANEL points are summed in f32 and then join two-float sums, so the error
// does not grow with the number of points.
//
// Joined with: shared/phase, shared/two_float, shared/wave_types.

override DIM: u32 = 2u;
// The workgroup has ROW_LANES * COLUMN_LANES = WORKGROUP invocations.
override ROW_LANES: u32 = 8u;
override COLUMN_LANES: u32 = 8u;
override WORKGROUP: u32 = 64u;
// Points whose tables are held at a time, and table lengths: TILE * ROW_LANES, TILE * COLUMN_LANES.
override TILE: u32 = 16u;
override ROW_WORDS: u32 = 128u;
override COLUMN_WORDS: u32 = 128u;
// Points summed in plain f32, a multiple of TILE.
override PANEL: u32 = 64u;

@group(0) @binding(0) var<uniform> params: WaveParams;
@group(0) @binding(1) var<storage, read> chunks: array<WaveRange>;
// x = (high + low) 2^-32 of the side, high an integer, low the bits of an f32 in [0, 1].
@group(0) @binding(2) var<storage, read> fractions: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> sums: array<WaveSums>;

// Four rows (columns) of point p and lane l at p * ROW_LANES + l.
var<workgroup> row_cos: array<vec4<f32>, ROW_WORDS>;
var<workgroup> row_sin: array<vec4<f32>, ROW_WORDS>;
var<workgroup> column_cos: array<vec4<f32>, COLUMN_WORDS>;
var<workgroup> column_sin: array<vec4<f32>, COLUMN_WORDS>;

fn axis_phase(m: vec4<i32>, axis: u32, point: u32) -> vec4<u32> {
    let x = fractions[axis * params.total_points + point];
    return phase_turns(m, x.x, bitcast<f32>(x.y));
}

// Columns are numbered along (m_1, m_2) from (0, 0) onward.
fn column_phase(columns: vec4<u32>, point: u32) -> vec4<u32> {
    var phase = vec4<u32>(0u);
    if (DIM > 1u) {
        let width = vec4<u32>(2u * params.frequency_2 + 1u);
        let shifted = columns + vec4<u32>(params.frequency_2);
        let m_1 = shifted / width;
        phase += axis_phase(bitcast<vec4<i32>>(m_1), 1u, point);
        if (DIM > 2u) {
            let m_2 = shifted - m_1 * width - vec4<u32>(params.frequency_2);
            phase += axis_phase(bitcast<vec4<i32>>(m_2), 2u, point);
        }
    }
    return phase;
}

fn store(row: u32, column: u32, chunk: u32, high: vec4<f32>, low: vec4<f32>) {
    if (row < params.rows && column < params.columns) {
        sums[(chunk * params.rows + row) * params.columns + column] = WaveSums(high, low);
    }
}

fn store_row(row: u32, column: u32, chunk: u32, cc: TwoFloat, ss: TwoFloat, cs: TwoFloat, sc: TwoFloat) {
    store(row, column, chunk, vec4<f32>(cc.high.x, ss.high.x, cs.high.x, sc.high.x),
          vec4<f32>(cc.low.x, ss.low.x, cs.low.x, sc.low.x));
    store(row, column + 1u, chunk, vec4<f32>(cc.high.y, ss.high.y, cs.high.y, sc.high.y),
          vec4<f32>(cc.low.y, ss.low.y, cs.low.y, sc.low.y));
    store(row, column + 2u, chunk, vec4<f32>(cc.high.z, ss.high.z, cs.high.z, sc.high.z),
          vec4<f32>(cc.low.z, ss.low.z, cs.low.z, sc.low.z));
    store(row, column + 3u, chunk, vec4<f32>(cc.high.w, ss.high.w, cs.high.w, sc.high.w),
          vec4<f32>(cc.low.w, ss.low.w, cs.low.w, sc.low.w));
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let job = params.first_job + group.x;
    let column_block = job % params.column_blocks;
    let row_block = job / params.column_blocks % params.row_blocks;
    let chunk_index = job / (params.column_blocks * params.row_blocks);
    let chunk = chunks[chunk_index];
    let row_lane = lane % ROW_LANES;
    let column_lane = lane / ROW_LANES;
    let block_row = row_block * ROW_LANES * 4u;
    let block_column = column_block * COLUMN_LANES * 4u;

    var sum_cc0 = TwoFloat(); var sum_ss0 = TwoFloat(); var sum_cs0 = TwoFloat(); var sum_sc0 = TwoFloat();
    var sum_cc1 = TwoFloat(); var sum_ss1 = TwoFloat(); var sum_cs1 = TwoFloat(); var sum_sc1 = TwoFloat();
    var sum_cc2 = TwoFloat(); var sum_ss2 = TwoFloat(); var sum_cs2 = TwoFloat(); var sum_sc2 = TwoFloat();
    var sum_cc3 = TwoFloat(); var sum_ss3 = TwoFloat(); var sum_cs3 = TwoFloat(); var sum_sc3 = TwoFloat();

    for (var panel = 0u; panel < chunk.count; panel += PANEL) {
        var cc0 = vec4<f32>(); var ss0 = vec4<f32>(); var cs0 = vec4<f32>(); var sc0 = vec4<f32>();
        var cc1 = vec4<f32>(); var ss1 = vec4<f32>(); var cs1 = vec4<f32>(); var sc1 = vec4<f32>();
        var cc2 = vec4<f32>(); var ss2 = vec4<f32>(); var cs2 = vec4<f32>(); var sc2 = vec4<f32>();
        var cc3 = vec4<f32>(); var ss3 = vec4<f32>(); var cs3 = vec4<f32>(); var sc3 = vec4<f32>();
        let panel_end = min(panel + PANEL, chunk.count);
        for (var first = panel; first < panel_end; first += TILE) {
            workgroupBarrier();
            for (var item = lane; item < TILE * (ROW_LANES + COLUMN_LANES); item += WORKGROUP) {
                let p = item / (ROW_LANES + COLUMN_LANES);
                let entry = item % (ROW_LANES + COLUMN_LANES);
                let live = first + p < panel_end;
                let point = chunk.first + min(first + p, chunk.count - 1u);
                if (entry < ROW_LANES) {
                    let rows = vec4<u32>(params.first_row + block_row + entry * 4u) + vec4<u32>(0u, 1u, 2u, 3u);
                    let row = phase_cos_sin(axis_phase(bitcast<vec4<i32>>(rows), 0u, point));
                    // Past the last point a row of zeros adds nothing.
                    row_cos[p * ROW_LANES + entry] = select(vec4<f32>(), row.cos, live);
                    row_sin[p * ROW_LANES + entry] = select(vec4<f32>(), row.sin, live);
                } else {
                    let l = entry - ROW_LANES;
                    let columns = vec4<u32>(params.first_column + block_column + l * 4u) + vec4<u32>(0u, 1u, 2u, 3u);
                    let column = phase_cos_sin(column_phase(columns, point));
                    column_cos[p * COLUMN_LANES + l] = column.cos;
                    column_sin[p * COLUMN_LANES + l] = column.sin;
                }
            }
            workgroupBarrier();
            for (var p = 0u; p < TILE; p++) {
                let rc = row_cos[p * ROW_LANES + row_lane];
                let rs = row_sin[p * ROW_LANES + row_lane];
                let c = column_cos[p * COLUMN_LANES + column_lane];
                let s = column_sin[p * COLUMN_LANES + column_lane];
                cc0 = fma(rc.xxxx, c, cc0); ss0 = fma(rs.xxxx, s, ss0); cs0 = fma(rc.xxxx, s, cs0); sc0 = fma(rs.xxxx, c, sc0);
                cc1 = fma(rc.yyyy, c, cc1); ss1 = fma(rs.yyyy, s, ss1); cs1 = fma(rc.yyyy, s, cs1); sc1 = fma(rs.yyyy, c, sc1);
                cc2 = fma(rc.zzzz, c, cc2); ss2 = fma(rs.zzzz, s, ss2); cs2 = fma(rc.zzzz, s, cs2); sc2 = fma(rs.zzzz, c, sc2);
                cc3 = fma(rc.wwww, c, cc3); ss3 = fma(rs.wwww, s, ss3); cs3 = fma(rc.wwww, s, cs3); sc3 = fma(rs.wwww, c, sc3);
            }
        }
        let zero = params.zero;
        sum_cc0 = two_float_add(sum_cc0, cc0, zero); sum_ss0 = two_float_add(sum_ss0, ss0, zero);
        sum_cs0 = two_float_add(sum_cs0, cs0, zero); sum_sc0 = two_float_add(sum_sc0, sc0, zero);
        sum_cc1 = two_float_add(sum_cc1, cc1, zero); sum_ss1 = two_float_add(sum_ss1, ss1, zero);
        sum_cs1 = two_float_add(sum_cs1, cs1, zero); sum_sc1 = two_float_add(sum_sc1, sc1, zero);
        sum_cc2 = two_float_add(sum_cc2, cc2, zero); sum_ss2 = two_float_add(sum_ss2, ss2, zero);
        sum_cs2 = two_float_add(sum_cs2, cs2, zero); sum_sc2 = two_float_add(sum_sc2, sc2, zero);
        sum_cc3 = two_float_add(sum_cc3, cc3, zero); sum_ss3 = two_float_add(sum_ss3, ss3, zero);
        sum_cs3 = two_float_add(sum_cs3, cs3, zero); sum_sc3 = two_float_add(sum_sc3, sc3, zero);
    }

    let row = block_row + row_lane * 4u;
    let column = block_column + column_lane * 4u;
    store_row(row, column, chunk_index, sum_cc0, sum_ss0, sum_cs0, sum_sc0);
    store_row(row + 1u, column, chunk_index, sum_cc1, sum_ss1, sum_cs1, sum_sc1);
    store_row(row + 2u, column, chunk_index, sum_cc2, sum_ss2, sum_cs2, sum_sc2);
    store_row(row + 3u, column, chunk_index, sum_cc3, sum_ss3, sum_cs3, sum_sc3);
}
