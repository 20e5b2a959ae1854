// Unordered pairs per cell of lags (definition: src/compute/reference/lag_counts.rs).
//
// As in pair_counts.wgsl the points of a realization are cut into tiles, and a workgroup holds one tile, a point per
// invocation, and walks over the tiles that follow it cyclically, up to half way round. f32 decides each lag that is clear
// of an edge, and takes the one of a pair's two lags that is at hand: the host adds up mirror images. 64-bit integers
// decide the rest.
//
// Joined with: shared/wide_integers, one of shared/torus_*, one of shared/histogram_*.

override WORKGROUP: u32 = 256u;
override DIM: u32 = 2u;
// Bins per axis
override AXIS_BINS: u32 = 64u;
// DIM * WORKGROUP
override TILE_WORDS: u32 = 512u;
// 1 in a window, 0 on a torus
override WINDOW: u32 = 0u;

// Answers of find_cell that are not cells.
const OUTSIDE: u32 = 0x7fffffffu;
const UNDECIDED: u32 = 0x80000000u;

struct LagParams {
    // Periods of the axes in steps of length_unit / 2^32, rounded; 0 stands for 2^32.
    side_rounded: vec4<u32>,
    // Periods in steps of length_unit / 2^64; 0 stands for 2^64.
    side_low: vec4<u32>,
    side_high: vec4<u32>,
    // The first threshold of each axis, modulo 2^64, and the last lag within the grid counted from it.
    first_low: vec4<u32>,
    first_high: vec4<u32>,
    last_low: vec4<u32>,
    last_high: vec4<u32>,
    // LagFilter
    scale: vec4<f32>,
    offset: vec4<f32>,
    low: vec4<f32>,
    high: vec4<f32>,
    guard: vec4<f32>,
    // Cells from one bin of an axis to the next.
    strides: vec4<u32>,
    // Points in the buffers: coordinate a of point j is at a * total_points + j.
    total_points: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

// One tile against `steps` tiles of the same realization, the first of them `first_step` tiles further on.
struct PairJob {
    first_point: u32,
    points: u32,
    tile: u32,
    first_step: u32,
    steps: u32,
    histogram: u32,
}

@group(0) @binding(0) var<uniform> params: LagParams;
@group(0) @binding(1) var<storage, read> jobs: array<PairJob>;
// Positions in steps of length_unit / 2^32, rounded, modulo the period.
@group(0) @binding(2) var<storage, read> rounded: array<u32>;
// Positions in steps of length_unit / 2^64 (low, high).
@group(0) @binding(3) var<storage, read> exact: array<vec2<u32>>;
// Per axis, the lower thresholds of its bins counted from the first, in steps (low, high).
@group(0) @binding(4) var<storage, read> thresholds: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read_write> histograms: array<atomic<u32>>;

// Coordinate a of point j of the tile at a * WORKGROUP + j.
var<workgroup> tile: array<u32, TILE_WORDS>;

fn load_rounded(point: u32) -> vec3<u32> {
    var p = vec3<u32>(rounded[point], 0u, 0u);
    if (DIM > 1u) { p.y = rounded[params.total_points + point]; }
    if (DIM > 2u) { p.z = rounded[2u * params.total_points + point]; }
    return p;
}

fn load_tile(j: u32) -> vec3<u32> {
    var p = vec3<u32>(tile[j], 0u, 0u);
    if (DIM > 1u) { p.y = tile[WORKGROUP + j]; }
    if (DIM > 2u) { p.z = tile[2u * WORKGROUP + j]; }
    return p;
}

// The cell of a lag in steps of length_unit / 2^32, or OUTSIDE, or UNDECIDED.
fn find_cell(lag: vec3<i32>) -> u32 {
    let t = vec3<f32>(lag) * params.scale.xyz + params.offset.xyz;
    if (any(t < params.low.xyz) || any(t > params.high.xyz)) { return OUTSIDE; }
    let edge = round(t);
    if (any(abs(t - edge) <= params.guard.xyz)) { return UNDECIDED; }
    let bin = vec3<u32>(edge) - select(vec3<u32>(0u), vec3<u32>(1u), t < edge);
    let cell = bin * params.strides.xyz;
    return cell.x + cell.y + cell.z;
}

// The cell of points i and j by the definition: of their two lags the one whose first component that is not its own negative
// is positive.
fn settle(i: u32, j: u32) -> u32 {
    var turned = false;
    var known = false;
    for (var axis = 0u; axis < DIM; axis++) {
        let offset = axis * params.total_points;
        let a = exact[offset + i];
        let b = exact[offset + j];
        let lag = torus_exact_lag(a, b, axis);
        // A lag that spans the longest side of a window has the bits of -2^63 either way.
        let negative = select(lag.y >= 0x80000000u, wide_less(a, b), WINDOW == 1u);
        if (!known && !own_negative(lag, axis)) {
            known = true;
            turned = negative;
        }
    }
    var cell = 0u;
    for (var axis = 0u; axis < DIM; axis++) {
        let offset = axis * params.total_points;
        let a = exact[offset + i];
        let b = exact[offset + j];
        var lag = torus_exact_lag(a, b, axis);
        if (WINDOW == 1u && all(lag == vec2<u32>(0u, 0x80000000u)) && wide_less(a, b) == turned) { return OUTSIDE; }
        if (turned && !own_negative(lag, axis)) { lag = wide_sub(vec2<u32>(0u), lag); }
        let from_first = wide_sub(lag, vec2<u32>(params.first_low[axis], params.first_high[axis]));
        if (wide_less(vec2<u32>(params.last_low[axis], params.last_high[axis]), from_first)) { return OUTSIDE; }
        // The number of thresholds at or below.
        var low = 0u;
        var high = AXIS_BINS;
        while (low < high) {
            let middle = (low + high) / 2u;
            if (wide_less(from_first, thresholds[axis * AXIS_BINS + middle])) { high = middle; } else { low = middle + 1u; }
        }
        cell = cell * AXIS_BINS + low - 1u;
    }
    return cell;
}

// 0, and on a torus half a period.
fn own_negative(lag: vec2<u32>, axis: u32) -> bool {
    if (all(lag == vec2<u32>(0u))) { return true; }
    let period = vec2<u32>(params.side_low[axis], params.side_high[axis]);
    // Modulo 2^64 the sum is 0 for 2^63 less half a period too, which is positive.
    return WINDOW == 0u && lag.y >= 0x80000000u && all(wide_add(wide_add(lag, lag), period) == vec2<u32>(0u));
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let job = jobs[group.x];
    let first_word = job.histogram * WORDS;
    histogram_clear(lane);

    let tiles = (job.points + WORKGROUP - 1u) / WORKGROUP;
    let base = job.tile * WORKGROUP;
    let last = job.first_point + job.points - 1u;
    // Lanes past the last point hold it again, and count nothing.
    let held = base + lane < job.points;
    let i = min(job.first_point + base + lane, last);
    let p = load_rounded(i);

    for (var step = 0u; step < job.steps; step++) {
        var other = job.tile + job.first_step + step;
        if (other >= tiles) { other -= tiles; }
        let other_first = job.first_point + other * WORKGROUP;
        let length = min(WORKGROUP, job.points - other * WORKGROUP);
        workgroupBarrier();
        let q = load_rounded(min(other_first + lane, last));
        tile[lane] = q.x;
        if (DIM > 1u) { tile[WORKGROUP + lane] = q.y; }
        if (DIM > 2u) { tile[2u * WORKGROUP + lane] = q.z; }
        workgroupBarrier();
        // Within a tile each pair is met twice: only j < i counts.
        let end = select(0u, select(length, lane, other == job.tile), held);
        for (var j = 0u; j < end; j++) {
            var cell = find_cell(torus_lag(p, load_tile(j)));
            if (cell == UNDECIDED) { cell = settle(i, other_first + j); }
            if (cell != OUTSIDE) { histogram_add(cell, lane, first_word); }
        }
    }
    histogram_flush(lane, first_word);
}
