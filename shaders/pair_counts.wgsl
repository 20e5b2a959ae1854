// Unordered pairs per bin (definition: src/compute/reference/pair_counts.rs): all pairs of a realization.
//
// The points of a realization are cut into tiles of TILE. A workgroup holds one tile in registers, four points per
// invocation, and walks over the tiles that follow it cyclically, up to half way round: every pair of tiles once, every
// tile with equal work. The other way to find pairs is pair_counts_cells.wgsl.
//
// Joined with: shared/pairs and what it names.

// 4 * WORKGROUP
override TILE: u32 = 256u;
// DIM * TILE
override TILE_WORDS: u32 = 512u;

// One tile against `steps` tiles of the same realization, the first of them `first_step` tiles further on.
struct PairJob {
    first_point: u32,
    points: u32,
    tile: u32,
    first_step: u32,
    steps: u32,
    histogram: u32,
}

@group(0) @binding(1) var<storage, read> jobs: array<PairJob>;

// Coordinate a of point j of the tile at a * TILE + j.
var<workgroup> tile: array<u32, TILE_WORDS>;

fn load_tile(j: u32) -> vec3<u32> {
    var p = vec3<u32>(tile[j], 0u, 0u);
    if (DIM > 1u) { p.y = tile[TILE + j]; }
    if (DIM > 2u) { p.z = tile[2u * TILE + j]; }
    return p;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let job = jobs[group.x];
    let first_word = job.histogram * WORDS;
    histogram_clear(lane);

    let tiles = (job.points + TILE - 1u) / TILE;
    let base = job.tile * TILE;
    let last = job.first_point + job.points - 1u;
    let local = vec4<u32>(lane) + WORKGROUP * vec4<u32>(0u, 1u, 2u, 3u);
    // Lanes past the last point hold it again, and count nothing.
    let held = hold(min(vec4<u32>(job.first_point + base) + local, vec4<u32>(last)));
    let points_held = min(TILE, job.points - base);

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
        if (other == job.tile || points_held < TILE) {
            // Within a tile each pair is met twice: only j < i counts.
            let diagonal = other == job.tile;
            let end = select(vec4<u32>(0u), select(vec4<u32>(length), local, diagonal), local < vec4<u32>(points_held));
            for (var j = 0u; j < length; j++) {
                let q = load_tile(j);
                let bins = select(vec4<u32>(OUTSIDE), find_bins(held, q), vec4<u32>(j) < end);
                count_pairs(bins, held, other_first + j, q, lane, first_word);
            }
        } else {
            for (var j = 0u; j < length; j++) {
                let q = load_tile(j);
                count_pairs(find_bins(held, q), held, other_first + j, q, lane, first_word);
            }
        }
    }
    histogram_flush(lane, first_word);
}
