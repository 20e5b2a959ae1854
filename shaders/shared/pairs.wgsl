// What every kernel over pairs of points has in common: points, thresholds, and the way of a pair into its bin. f32 decides
// each pair that is clear of a bin edge; 128-bit integers decide the rest, so the counts are exact.
//
// Joined with: shared/wide_integers, one of shared/torus_*, one of shared/bins_*, one of shared/histogram_*, one of
// shared/weights_*.

override WORKGROUP: u32 = 64u;
override DIM: u32 = 2u;
override BINS: u32 = 256u;

// Answers of bins_find that are not bins.
const OUTSIDE: u32 = 0x7fffffffu;
const UNDECIDED: u32 = 0x80000000u;
const SEARCH: u32 = 0xffffffffu;

struct PairParams {
    // Sides of the box in steps of length_unit / 2^32, rounded; 0 stands for 2^32.
    side_rounded: vec4<u32>,
    // Sides in steps of length_unit / 2^64; 0 stands for 2^64.
    side_low: vec4<u32>,
    side_high: vec4<u32>,
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

@group(0) @binding(0) var<uniform> params: PairParams;
// Positions in steps of length_unit / 2^32, rounded, modulo the period.
@group(0) @binding(2) var<storage, read> rounded: array<u32>;
// Positions in steps of length_unit / 2^64 (low, high).
@group(0) @binding(3) var<storage, read> exact: array<vec2<u32>>;
// Per edge, the least squared distance at or beyond it, in steps squared, four limbs.
@group(0) @binding(4) var<storage, read> thresholds: array<vec4<u32>>;
// WORDS per realization: pairs per bin, then what weights_* adds.
@group(0) @binding(5) var<storage, read_write> histograms: array<atomic<u32>>;

fn load_rounded(point: u32) -> vec3<u32> {
    var p = vec3<u32>(rounded[point], 0u, 0u);
    if (DIM > 1u) { p.y = rounded[params.total_points + point]; }
    if (DIM > 2u) { p.z = rounded[2u * params.total_points + point]; }
    return p;
}

// The squared distance in integers.
fn exact_squared_distance(i: u32, j: u32) -> vec4<u32> {
    var r2 = vec4<u32>(0u);
    for (var axis = 0u; axis < DIM; axis++) {
        let offset = axis * params.total_points;
        r2 = wide_add_128(r2, wide_square(torus_exact_distance(exact[offset + i], exact[offset + j], axis)));
    }
    return r2;
}

// The bin of a pair in integers. `answer` is what the filter said: UNDECIDED | edge, or SEARCH.
fn settle(answer: u32, i: u32, j: u32) -> u32 {
    let r2 = exact_squared_distance(i, j);
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

// Four points in the registers of an invocation: their numbers and their rounded positions.
struct Held {
    index: vec4<u32>,
    p0: vec3<u32>,
    p1: vec3<u32>,
    p2: vec3<u32>,
    p3: vec3<u32>,
}

fn hold(index: vec4<u32>) -> Held {
    return Held(
        index,
        load_rounded(index.x),
        load_rounded(index.y),
        load_rounded(index.z),
        load_rounded(index.w),
    );
}

// What the filter says about each of them and a point at q.
fn find_bins(held: Held, q: vec3<u32>) -> vec4<u32> {
    return vec4<u32>(
        bins_find(torus_squared_distance(held.p0, q)),
        bins_find(torus_squared_distance(held.p1, q)),
        bins_find(torus_squared_distance(held.p2, q)),
        bins_find(torus_squared_distance(held.p3, q)),
    );
}

// Counts the pairs of each of them and point j at q. Few need settling: one loop for all four keeps the code short and out of
// the way.
fn count_pairs(bins: vec4<u32>, held: Held, j: u32, q: vec3<u32>, lane: u32, first_word: u32) {
    if (bins.x < BINS) { weights_add(bins.x, held.index.x, held.p0, j, q, lane, first_word); }
    if (bins.y < BINS) { weights_add(bins.y, held.index.y, held.p1, j, q, lane, first_word); }
    if (bins.z < BINS) { weights_add(bins.z, held.index.z, held.p2, j, q, lane, first_word); }
    if (bins.w < BINS) { weights_add(bins.w, held.index.w, held.p3, j, q, lane, first_word); }
    if (any(bins >= vec4<u32>(UNDECIDED))) {
        for (var k = 0u; k < 4u; k++) {
            if (bins[k] >= UNDECIDED) {
                let bin = settle(bins[k], held.index[k], j);
                if (bin < BINS) {
                    let p = select(select(held.p0, held.p1, k == 1u), select(held.p2, held.p3, k == 3u), k >= 2u);
                    weights_add(bin, held.index[k], p, j, q, lane, first_word);
                }
            }
        }
    }
}
