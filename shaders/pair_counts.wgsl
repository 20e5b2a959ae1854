// Unordered pairs per bin (definition: src/compute/reference/pair_counts.rs).
//
// The points of a realization are cut into tiles of TILE. A workgroup holds one tile in registers, four points per
// invocation, and walks over the tiles that follow it cyclically, up to half way round: every pair of tiles once, every
// tile with equal work. f32 decides each pair that is clear of a bin edge; 128-bit integers decide the rest, so the
// counts are exact.
//
// Joined with: shared/wide_integers, one of shared/torus_*, one of shared/bins_*, one of shared/histogram_*.

override WORKGROUP: u32 = 64u;
override DIM: u32 = 2u;
override BINS: u32 = 256u;
// 4 * WORKGROUP
override TILE: u32 = 256u;
// DIM * TILE
override TILE_WORDS: u32 = 512u;

// Answers of bins_find that are not bins.
const OUTSIDE: u32 = 0x7fffffffu;
const UNDECIDED: u32 = 0x80000000u;
const SEARCH: u32 = 0xffffffffu;

struct PairParams {
    // Periods of the axes in steps of length_unit / 2^32, rounded; 0 stands for 2^32.
    period_rounded: vec4<u32>,
    // Periods in steps of length_unit / 2^64; 0 stands for 2^64.
    period_low: vec4<u32>,
    period_high: vec4<u32>,
    // BinFilter::Linear
    bins_per_step: f32,
    relative_guard: f32,
    absolute_guard: f32,
    // BinFilter::Table
    first_cell: u32,
    last_cell: u32,
    // Points in the buffers: coordinate a of point j is at a * total_points + j.
    total_points: u32,
    reserved: vec2<u32>,
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

@group(0) @binding(0) var<uniform> params: PairParams;
@group(0) @binding(1) var<storage, read> jobs: array<PairJob>;
// Positions in steps of length_unit / 2^32, rounded, modulo the period.
@group(0) @binding(2) var<storage, read> rounded: array<u32>;
// Positions in steps of length_unit / 2^64 (low, high).
@group(0) @binding(3) var<storage, read> exact: array<vec2<u32>>;
// Per edge, the least squared distance at or beyond it, in steps squared, four limbs.
@group(0) @binding(4) var<storage, read> thresholds: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read_write> histograms: array<atomic<u32>>;

// Coordinate a of point j of the tile at a * TILE + j.
var<workgroup> tile: array<u32, TILE_WORDS>;

fn load_rounded(point: u32) -> vec3<u32> {
    var p = vec3<u32>(rounded[point], 0u, 0u);
    if (DIM > 1u) { p.y = rounded[params.total_points + point]; }
    if (DIM > 2u) { p.z = rounded[2u * params.total_points + point]; }
    return p;
}

fn load_tile(j: u32) -> vec3<u32> {
    var p = vec3<u32>(tile[j], 0u, 0u);
    if (DIM > 1u) { p.y = tile[TILE + j]; }
    if (DIM > 2u) { p.z = tile[2u * TILE + j]; }
    return p;
}

// The bin of a pair in integers. `answer` is what the filter said: UNDECIDED | edge, or SEARCH.
fn settle(answer: u32, i: u32, j: u32) -> u32 {
    var r2 = vec4<u32>(0u);
    for (var axis = 0u; axis < DIM; axis++) {
        let offset = axis * params.total_points;
        r2 = wide_add_128(r2, wide_square(torus_exact_distance(exact[offset + i], exact[offset + j], axis)));
    }
    if (answer != SEARCH) {
        let edge = answer & OUTSIDE;
        return select(edge, edge - 1u, wide_less_128(r2, thresholds[edge]));
    }
    // The number of edges at or below r2, less one.
    var low = 0u;
    var high = BINS + 1u;
    while (low < high) {
        let middle = (low + high) / 2u;
        if (wide_less_128(r2, thresholds[middle])) { high = middle; } else { low = middle + 1u; }
    }
    return low - 1u;
}

// The bins of four pairs (i.x, j) .. (i.w, j), as the filter found them. Few need settling: one loop for all four keeps the
// code short and out of the way.
fn count_pairs(bins: vec4<u32>, i: vec4<u32>, j: u32, lane: u32, first_word: u32) {
    if (bins.x < BINS) { histogram_add(bins.x, lane, first_word); }
    if (bins.y < BINS) { histogram_add(bins.y, lane, first_word); }
    if (bins.z < BINS) { histogram_add(bins.z, lane, first_word); }
    if (bins.w < BINS) { histogram_add(bins.w, lane, first_word); }
    if (any(bins >= vec4<u32>(UNDECIDED))) {
        for (var k = 0u; k < 4u; k++) {
            if (bins[k] >= UNDECIDED) {
                let bin = settle(bins[k], i[k], j);
                if (bin < BINS) { histogram_add(bin, lane, first_word); }
            }
        }
    }
}

fn find_bins(p0: vec3<u32>, p1: vec3<u32>, p2: vec3<u32>, p3: vec3<u32>, q: vec3<u32>) -> vec4<u32> {
    return vec4<u32>(
        bins_find(torus_squared_distance(p0, q)),
        bins_find(torus_squared_distance(p1, q)),
        bins_find(torus_squared_distance(p2, q)),
        bins_find(torus_squared_distance(p3, q)),
    );
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let job = jobs[group.x];
    let first_word = job.histogram * BINS;
    histogram_clear(lane);

    let tiles = (job.points + TILE - 1u) / TILE;
    let base = job.tile * TILE;
    let last = job.first_point + job.points - 1u;
    let local = vec4<u32>(lane) + WORKGROUP * vec4<u32>(0u, 1u, 2u, 3u);
    // Lanes past the last point hold it again, and count nothing.
    let i = min(vec4<u32>(job.first_point + base) + local, vec4<u32>(last));
    let p0 = load_rounded(i.x);
    let p1 = load_rounded(i.y);
    let p2 = load_rounded(i.z);
    let p3 = load_rounded(i.w);
    let held = min(TILE, job.points - base);

    for (var step = 0u; step < job.steps; step++) {
        var other = job.tile + job.first_step + step;
        if (other >= tiles) { other -= tiles; }
        let other_first = job.first_point + other * TILE;
        let length = min(TILE, job.points - other * TILE);
        workgroupBarrier();
        for (var j = lane; j < TILE; j += WORKGROUP) {
            let q = load_rounded(min(other_first + j, last));
            tile[j] = q.x;
            if (DIM > 1u) { tile[TILE + j] = q.y; }
            if (DIM > 2u) { tile[2u * TILE + j] = q.z; }
        }
        workgroupBarrier();
        if (other == job.tile || held < TILE) {
            // Within a tile each pair is met twice: only j < i counts.
            let diagonal = other == job.tile;
            let end = select(vec4<u32>(0u), select(vec4<u32>(length), local, diagonal), local < vec4<u32>(held));
            for (var j = 0u; j < length; j++) {
                let bins = select(vec4<u32>(OUTSIDE), find_bins(p0, p1, p2, p3, load_tile(j)), vec4<u32>(j) < end);
                count_pairs(bins, i, other_first + j, lane, first_word);
            }
        } else {
            for (var j = 0u; j < length; j++) {
                count_pairs(find_bins(p0, p1, p2, p3, load_tile(j)), i, other_first + j, lane, first_word);
            }
        }
    }
    histogram_flush(lane, first_word);
}
