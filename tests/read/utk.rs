//! UTK's `.bin`.

use crate::shared::{content, read, utk};

#[test]
fn utk_bin() {
    let values = [1.0, 2.0, 3.0, 4.0];
    let shape = [2, 1, 2];
    let halves = [(2, vec![1.0, 2.0]), (2, vec![3.0, 4.0])];
    let files = [
        utk(0, 0, shape, &values.map(|v| (v as i32).to_le_bytes()).concat()),
        utk(1, 0, shape, &values.map(|v| (v as i64).to_le_bytes()).concat()),
        utk(2, 0, shape, &values.map(|v| (v as u32).to_le_bytes()).concat()),
        utk(3, 0, shape, &values.map(|v| (v as u64).to_le_bytes()).concat()),
        utk(4, 0, shape, &values.map(|v| (v as f32).to_le_bytes()).concat()),
        utk(5, 0, shape, &values.map(f64::to_le_bytes).concat()),
    ];
    for bytes in &files {
        assert_eq!(content(&read("a.bin", bytes).unwrap()), halves);
        assert_eq!(content(&read("a.txt", bytes).unwrap()), halves, "by content");
    }
    let table = [
        (
            utk(5, 0, [1, 2, 2], &[0; 31]),
            "truncated: a header of 1 sets of 2 points with 2 coordinates needs 32 bytes of data, found 31",
        ),
        (
            utk(5, 0, [1, 2, 2], &[0; 40]),
            "a header of 1 sets of 2 points with 2 coordinates needs 32 bytes of data, found 8 more after them",
        ),
        (
            utk(6, 0, [1, 1, 2], &[0; 16]),
            "unknown UTK type code 6; expected 0 (i32), 1 (i64), 2 (u32), 3 (u64), 4 (f32) or 5 (f64)",
        ),
        (
            utk(5, 0, [1, 1, 4], &[0; 32]),
            "4 coordinates per point; 1, 2 or 3 are supported, and `columns` chooses them, as in 1,2",
        ),
        (utk(5, 0, [0, 1, 2], &[]), "no points: 0 sets of 1 points"),
        (utk(5, 0, [u32::MAX, 0, 2], &[]), "no points: 4294967295 sets of 0 points"),
        (
            utk(5, 0, [u32::MAX, u32::MAX, 3], &[]),
            "a header of 4294967295 sets of 4294967295 points with 3 coordinates is more than any file can hold",
        ),
        (
            utk(5, 0, [2, 1, 2], &[0; 32]),
            "its 2 sets are byte for byte the same: UTK writes the first set m times into a .bin; export text (.dat) instead",
        ),
        (b"UTK!\x05\0\0\0".to_vec(), "truncated: the header of a UTK .bin has 20 bytes, found 8"),
    ];
    for (bytes, message) in table {
        assert_eq!(read("a.bin", bytes).unwrap_err(), format!("a.bin: {message}"));
    }
    assert_eq!(read("a.bin", utk(5, 0, [1, 0, 2], &[])).unwrap()[0].len(), 0);
}
