// Isotropic weights: the inverse of the part of the circle about one point, through the other, that lies in the window. Summed
// over both points of a pair.
//
// The circle is cut at the four directions of the axes. With distances a and b to the two sides that meet in a corner, the
// quarter that faces the corner keeps an angle of g = pi/2 - acos(min(1, a/r)) - acos(min(1, b/r)), or 0 where the corner is
// within the circle. With A^2 = r^2 - a^2 and B^2 = r^2 - b^2 that is
//     tan g = (a^2 + b^2 - r^2) r^2 / ((a b + A B) (A b + a B)),
// where nothing cancels but integers.

const WEIGHTS_TURN: f32 = 6.2831855;
// No plan that runs here has weights above 512 (pair_limit and LEAST_PAIRS in src/compute/gpu/pair_specs.rs); this only keeps the
// conversion to integers in its range.
const WEIGHTS_MOST: f32 = 1024.0;

// atan2 of two numbers that are at least 0 and not both 0; relative error below 3e-7 (polynomial: Cephes, S. L. Moshier).
fn weights_angle(y: f32, x: f32) -> f32 {
    let steep = y > x;
    var t = min(x, y) / max(x, y);
    var base = 0.0;
    if (t > 0.41421357) {
        t = (t - 1.0) / (t + 1.0);
        base = 0.78539816;
    }
    let z = t * t;
    let series = (((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1) * z;
    let angle = base + (series * t + t);
    return select(angle, 1.5707964 - angle, steep);
}

// One side of the window, cut off at the circle, in units of the radius.
struct WeightsSide {
    // Squared distance, at most r^2.
    squared: vec4<u32>,
    distance: f32,
    // Half the chord.
    chord: f32,
}

fn weights_side(distance: vec2<u32>, r2: vec4<u32>) -> WeightsSide {
    let squared = wide_square(distance);
    if (!wide_less_128(squared, r2)) { return WeightsSide(r2, 1.0, 0.0); }
    let square = wide_f32_128(r2);
    return WeightsSide(
        squared,
        sqrt(wide_f32_128(squared) / square),
        sqrt(wide_f32_128(wide_sub_128(r2, squared)) / square),
    );
}

// The angle kept by the quarter between two sides.
fn weights_corner(a: WeightsSide, b: WeightsSide, r2: vec4<u32>) -> f32 {
    let corner = wide_add_128(a.squared, b.squared);
    if (!wide_less_128(r2, corner)) { return 0.0; }
    let beyond = wide_f32_128(wide_sub_128(corner, r2)) / wide_f32_128(r2);
    return weights_angle(
        beyond / (a.distance * b.distance + a.chord * b.chord),
        a.chord * b.distance + a.distance * b.chord,
    );
}

// Whether a circle of this radius, in rounded steps, about p surely lies in the window.
fn weights_clear(p: vec3<u32>, radius: f32) -> bool {
    // Rounding may take a point beyond a side: it is at a distance of 0 then.
    let side = params.side_rounded.xyz;
    let inward = min(p, max(p, side) - p);
    return f32(inward.x) > radius && (DIM == 1u || f32(inward.y) > radius);
}

// The weight of the circle about point i with squared radius r2, less 1.
fn weights_excess(i: u32, r2: vec4<u32>) -> f32 {
    let x = exact[i];
    let beyond_x = wide_sub(vec2<u32>(params.side_low.x, params.side_high.x), x);
    if (DIM == 1u) {
        // A circle of two points.
        let inside = vec2<bool>(wide_less_128(wide_square(x), r2), wide_less_128(wide_square(beyond_x), r2));
        return select(0.0, 1.0, any(inside));
    }
    let y = exact[params.total_points + i];
    let left = weights_side(x, r2);
    let right = weights_side(beyond_x, r2);
    let down = weights_side(y, r2);
    let up = weights_side(wide_sub(vec2<u32>(params.side_low.y, params.side_high.y), y), r2);
    let angle = (weights_corner(left, down, r2) + weights_corner(right, up, r2))
        + (weights_corner(left, up, r2) + weights_corner(right, down, r2));
    return clamp(WEIGHTS_TURN / max(angle, WEIGHTS_TURN / WEIGHTS_MOST) - 1.0, 0.0, WEIGHTS_MOST);
}

fn weights_add(bin: u32, i: u32, p: vec3<u32>, j: u32, q: vec3<u32>, lane: u32, first_word: u32) {
    histogram_add(bin, lane, first_word);
    // Above the distance by more than the roundings of f32 and of positions.
    let radius = sqrt(torus_squared_distance(p, q)) * 1.000002 + 4.0;
    let clear = vec2<bool>(weights_clear(p, radius), weights_clear(q, radius));
    if (all(clear)) { return; }
    let r2 = exact_squared_distance(i, j);
    var excess = 0.0;
    if (!clear.x) { excess += weights_excess(i, r2); }
    if (!clear.y) { excess += weights_excess(j, r2); }
    histogram_add_wide(bin, weights_fixed_point(excess), lane, first_word);
}
