//! Numbers without a header.

use crate::shared::{content, input, read, read_with};
use pairwave::points::read::{RawLayout, ReadOptions};

fn raw_options(layout: &str) -> ReadOptions {
    ReadOptions { raw: Some(layout.parse().unwrap()), dim: None }
}

#[test]
fn raw_numbers() {
    let f32s: Vec<u8> = [0.5f32, 0.25, 0.125, 0.1].iter().flat_map(|x| x.to_le_bytes()).collect();
    let f64s: Vec<u8> = [0.5f64, 0.25, 0.125, 0.1].iter().flat_map(|x| x.to_le_bytes()).collect();
    let narrow = vec![0.5, 0.25, 0.125, f64::from(0.1f32)];
    assert_eq!(content(&read("a.rps", &f32s).unwrap()), [(2, narrow.clone())]);
    assert_eq!(content(&read("points", &f32s).unwrap()), [(2, narrow.clone())], "fractions cannot be anything else");
    assert_eq!(content(&read("a.rps", "0.5 0.25\n").unwrap()), [(2, vec![0.5, 0.25])], "text whatever its name");

    let with = |name, bytes: &[u8], layout| read_with(&input(name, bytes), &raw_options(layout));
    assert_eq!(content(&with("a", &f32s, "f32x1").unwrap()), [(1, narrow)]);
    let wide = vec![0.5, 0.25, 0.125, 0.1];
    assert_eq!(content(&with("a.rps", &f64s, "f64x2").unwrap()), [(2, wide.clone())]);
    assert_eq!(content(&with("a.npy", &f64s[..24], "f64x3").unwrap()), [(3, wide[..3].to_vec())]);
    assert_eq!(with("a.txt", b"0.5 0.25", "f64x1").unwrap()[0].len(), 1, "raw overrides everything");
    let dim = ReadOptions { dim: Some(2), raw: None };
    assert_eq!(content(&read_with(&input("a.f64", &f64s), &dim).unwrap()), [(2, wide)]);

    let unknown = "neither text nor .npy, .npz or UTK .bin (no such header); raw numbers need `raw` f32x2 or the like";
    assert_eq!(read("points", &f64s).unwrap_err(), format!("points: {unknown}"));
    assert_eq!(read("a.bin", &f32s).unwrap_err(), format!("a.bin: {unknown}"));
    assert_eq!(
        read("a.gz", b"\x1f\x8b\x08\0\0\0").unwrap_err(),
        "a.gz: compressed with gzip, which is not read here; unpack it first"
    );
    let message = "a.f32: raw numbers do not say how many make a point; give `raw` f32x2 (or x1, x3)";
    assert_eq!(read("a.f32", &f32s).unwrap_err(), message);
    let message = "a.rps: 15 bytes are not a whole number of f32x2 points of 8 bytes: 7 left over";
    assert_eq!(read("a.rps", &f32s[..15]).unwrap_err(), message);
    let form = "expected f32x1, f32x2, f32x3, f64x1, f64x2 or f64x3 (type x coordinates per point), or up to x9 where `columns` and the like say what the numbers are";
    for wrong in ["f32", "f16x2", "f32x10", "f32x0", "f32x22", "F32x2", "f32 x2", ""] {
        let message = wrong.parse::<RawLayout>().unwrap_err().to_string();
        assert_eq!(message, format!("raw {wrong}: {form}"));
    }
    assert_eq!(with("a", &f32s, "f32x4").unwrap_err(), format!("raw f32x4: {form}"), "no setting takes the fourth");
    assert_eq!("f64x3".parse::<RawLayout>().unwrap().to_string(), "f64x3");
}
