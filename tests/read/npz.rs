//! NPZ archives.

use crate::shared::{npy, npy_f64, read, zipped};

#[test]
fn npz_archives() {
    let set = |values: &[f64]| npy("<f8", npyz::Order::C, &[values.len() as u64 / 2, 2], values);
    let batch = npy("<f4", npyz::Order::C, &[2, 1, 2], &[7f32, 8.0, 9.0, 10.0]);
    let (first, second) = (set(&[1.0, 2.0]), set(&[3.0, 4.0, 5.0, 6.0]));
    for method in [zip::CompressionMethod::Stored, zip::CompressionMethod::Deflated] {
        let bytes = zipped(&[("set_10.npy", &batch), ("set_2.npy", &second), ("set_1.npy", &first)], method);
        let sets = read("a.npz", &bytes).unwrap();
        let expected: [&[f64]; 4] = [&[1.0, 2.0], &[3.0, 4.0, 5.0, 6.0], &[7.0, 8.0], &[9.0, 10.0]];
        assert_eq!(sets.iter().map(|s| &s.coordinates[..]).collect::<Vec<_>>(), expected);
        assert!(sets[1].source.ends_with("a.npz, array set_2"), "{}", sets[1].source);
        assert!(sets[3].source.ends_with("a.npz, array set_10, realization 1"), "{}", sets[3].source);

        let mut flipped = bytes.clone();
        // Within the first entry: its header has 30 bytes and its name.
        flipped[30 + "set_10.npy".len() + 20] ^= 1;
        let message = read("a.npz", flipped).unwrap_err();
        assert!(message.starts_with("a.npz, array set_") && message.contains("damaged"), "{message}");
    }
    let stored = |entries: &[(&str, &[u8])]| zipped(entries, zip::CompressionMethod::Stored);
    let message = read("a.xlsx", stored(&[("a/b.xml", b"<a/>")])).unwrap_err();
    assert_eq!(message, r#"a.xlsx: a zip archive, but its entry "a/b.xml" is not a .npy array; expected .npz"#);
    assert_eq!(read("a.npz", stored(&[])).unwrap_err(), "a.npz: no arrays in this archive");
    let message = read("a.npz", stored(&[("a.npy", &npy_f64("()", 8))])).unwrap_err();
    assert!(message.starts_with("a.npz, array a: shape ();"), "{message}");
    let message = read("a.npz", stored(&[("a.npy", b"hello")])).unwrap_err();
    assert_eq!(message, "a.npz, array a: not a .npy array");
    let message = read("a.npz", &stored(&[("a.npy", &first)])[..60]).unwrap_err();
    assert!(message.starts_with("a.npz: damaged zip archive: "), "{message}");
    let three = set(&[1.0; 6]);
    let bytes =
        stored(&[("a1.npy", &first), ("a2.npy", &npy("<f8", npyz::Order::C, &[1, 3], &[1.0; 3])), ("a3.npy", &three)]);
    let message = read("a.npz", bytes).unwrap_err();
    assert!(
        message.starts_with("a.npz, array a2: 3 coordinates per point, but ")
            && message.ends_with("a.npz, array a1 has 2"),
        "{message}"
    );
}
