// Every point weighs 1. The other choice is wave_weighted.

fn point_weight(point: u32) -> Real {
    return Real(1);
}
