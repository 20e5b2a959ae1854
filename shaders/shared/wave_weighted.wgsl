// Points with weights of at most 1. The other choice is wave_unweighted.

@group(0) @binding(4) var<storage, read> weights: array<Real>;

fn point_weight(point: u32) -> Real {
    return weights[point];
}
