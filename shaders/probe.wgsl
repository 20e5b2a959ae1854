// What the self-check asks of a device before anything else: does a compensated sum survive its compiler, and are
// cosine and sine of a phase as good as promised?
//
// Joined with: shared/phase, shared/two_float.

override WORKGROUP: u32 = 64u;

struct ProbeParams {
    count: u32,
    // A zero the compiler does not know.
    zero: u32,
    reserved_0: u32,
    reserved_1: u32,
}

struct ProbeInput {
    // Two numbers to add.
    a: f32,
    b: f32,
    // A phase in steps of 2^-32 turns.
    phase: u32,
    reserved: u32,
}

struct ProbeOutput {
    // a + b = sum + error, exactly.
    sum: f32,
    error: f32,
    cos: f32,
    sin: f32,
}

@group(0) @binding(0) var<uniform> params: ProbeParams;
@group(0) @binding(1) var<storage, read> inputs: array<ProbeInput>;
@group(0) @binding(2) var<storage, read_write> outputs: array<ProbeOutput>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) { return; }
    let given = inputs[id.x];
    let sum = two_float_add(TwoFloat(vec4<f32>(given.a), vec4<f32>()), vec4<f32>(given.b), params.zero);
    let wave = phase_cos_sin(vec4<u32>(given.phase));
    outputs[id.x] = ProbeOutput(sum.high.x, sum.low.x, wave.cos.x, wave.sin.x);
}
