// Unordered pairs per bin (definition: src/compute/reference/pair_counts.rs): of points sorted by cell, those in cells near each
// other (src/compute/cells.rs says which). The other way to find pairs is pair_counts.wgsl.
//
// Joined with: shared/pairs and what it names.

// Tasks of one realization.
struct CellPairJob {
    first_task: u32,
    tasks: u32,
    histogram: u32,
}

// Points of one cell against a range of points.
struct CellPairTask {
    first_row: u32,
    rows: u32,
    first: u32,
    end: u32,
    // 4 * 2^lane_bits invocations' registers hold the rows.
    lane_bits: u32,
}

@group(0) @binding(1) var<storage, read> jobs: array<CellPairJob>;
@group(0) @binding(9) var<storage, read> tasks: array<CellPairTask>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let job = jobs[group.x];
    let first_word = job.histogram * WORDS;
    histogram_clear(lane);
    for (var t = 0u; t < job.tasks; t++) {
        let task = tasks[job.first_task + t];
        // As few lanes as hold the rows take one partner; the workgroup takes as many partners at a time as it can.
        let lanes = 1u << task.lane_bits;
        let local = vec4<u32>(lane & (lanes - 1u)) + lanes * vec4<u32>(0u, 1u, 2u, 3u);
        let rows_end = task.first_row + task.rows;
        let held = hold(min(vec4<u32>(task.first_row) + local, vec4<u32>(rows_end - 1u)));
        // Among the rows themselves each pair is met twice: only partners after the row count. Lanes past the last row hold it
        // again, and count nothing.
        let own = task.first < rows_end && task.end > task.first_row;
        let least = select(
            vec4<u32>(0xffffffffu),
            select(vec4<u32>(0u), held.index + vec4<u32>(1u), own),
            local < vec4<u32>(task.rows),
        );
        for (var j = task.first + (lane >> task.lane_bits); j < task.end; j += WORKGROUP >> task.lane_bits) {
            let q = load_rounded(j);
            let bins = select(vec4<u32>(OUTSIDE), find_bins(held, q), vec4<u32>(j) >= least);
            count_pairs(bins, held, j, q, lane, first_word);
        }
    }
    histogram_flush(lane, first_word);
}
