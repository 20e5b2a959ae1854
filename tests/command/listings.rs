//! What is there to choose from.

use crate::shared::Scratch;

#[test]
fn samplers_and_devices_are_listed() {
    let scratch = Scratch::new();
    let samplers = scratch.ok("samplers");
    for name in ["random", "grid", "jittered", "poisson-disk", "halton", "thomas", "--param radius"] {
        assert!(samplers.contains(name), "{name} is missing from\n{samplers}");
    }
    assert!(scratch.ok("devices").starts_with("cpu "));
}
