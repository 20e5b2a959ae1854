// Every pair weighs 1. The other choices are weights_translation.wgsl, weights_isotropic.wgsl and weights_border.wgsl.

fn weights_add(bin: u32, i: u32, p: vec3<u32>, j: u32, q: vec3<u32>, lane: u32, first_word: u32) {
    histogram_add(bin, lane, first_word);
}
