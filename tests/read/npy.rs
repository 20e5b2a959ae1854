//! NPY: types, orders, shapes, and files that lie.

use crate::shared::{content, npy, npy_f64, npy_header, read};

#[test]
fn npy_number_types_and_byte_orders() {
    let values = [1.0, 2.0, 3.0, 100.0];
    let c = npyz::Order::C;
    macro_rules! files {
        ($($dtype:literal as $type:ty),*) => { vec![$(($dtype, npy($dtype, c, &[2, 2], &values.map(|v| v as $type)))),*] };
    }
    let mut files = files![
        "<f4" as f32,
        ">f4" as f32,
        "<f8" as f64,
        ">f8" as f64,
        "|i1" as i8,
        "|u1" as u8,
        "<i2" as i16,
        ">i2" as i16,
        "<u2" as u16,
        ">u2" as u16,
        "<i4" as i32,
        ">i4" as i32,
        "<u4" as u32,
        ">u4" as u32,
        "<i8" as i64,
        ">i8" as i64,
        "<u8" as u64,
        ">u8" as u64
    ];
    files.push(("<f2", npy("<f2", c, &[2, 2], &values.map(half::f16::from_f64))));
    files.push((">f2", npy(">f2", c, &[2, 2], &values.map(half::f16::from_f64))));
    for (dtype, bytes) in files {
        assert_eq!(content(&read("a.npy", bytes).unwrap()), [(2, values.to_vec())], "{dtype}");
    }
    assert_eq!(read("a.npy", npy("<i4", c, &[1], &[-7])).unwrap()[0].coordinates, [-7.0]);
    // By content: the name may be anything.
    assert_eq!(read("a.csv", npy("<i4", c, &[1], &[-7])).unwrap()[0].coordinates, [-7.0]);
}

#[test]
fn npy_shapes_and_orders() {
    let values: Vec<f64> = (0..12).map(f64::from).collect();
    let one = |order, shape: &[u64]| content(&read("a.npy", npy("<f8", order, shape, &values)).unwrap());
    let (c, fortran) = (npyz::Order::C, npyz::Order::Fortran);
    assert_eq!(one(c, &[12]), [(1, values.clone())]);
    assert_eq!(one(fortran, &[12]), [(1, values.clone())]);
    assert_eq!(one(c, &[12, 1]), [(1, values.clone())]);
    assert_eq!(one(c, &[4, 3]), [(3, values.clone())]);
    assert_eq!(one(fortran, &[6, 2]), [(2, vec![0., 6., 1., 7., 2., 8., 3., 9., 4., 10., 5., 11.])]);
    assert_eq!(one(c, &[2, 3, 2]), [(2, values[..6].to_vec()), (2, values[6..].to_vec())]);
    assert_eq!(one(fortran, &[2, 3, 2]), [(2, vec![0., 6., 2., 8., 4., 10.]), (2, vec![1., 7., 3., 9., 5., 11.])]);
    assert_eq!(one(c, &[1, 6, 2]), [(2, values.clone())]);
    let sets = read("a.npy", npy("<f8", c, &[2, 3, 2], &values)).unwrap();
    assert!(sets[1].source.ends_with("a.npy, realization 1"));
    assert!(sets[1].lines.is_empty());

    let empty = read("a.npy", npy_f64("(0, 2)", 0)).unwrap();
    assert_eq!(content(&empty), [(2, vec![])]);
    assert_eq!(read("a.npy", npy_f64("(1L, 2L)", 16)).unwrap()[0].len(), 1);
    let nan = read("a.npy", npy("<f8", c, &[1, 2], &[f64::NAN, 1.0])).unwrap();
    assert!(nan[0].coordinates[0].is_nan(), "left to the check of the domain, which names the point");
}

#[test]
fn bad_npy_files() {
    let shape = |shape: &str, data| npy_f64(shape, data);
    let dtype =
        |descr: &str| npy_header(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': (1, 2), }}"), 16);
    let form = "expected (n, d) or (K, n, d) with d = 1, 2 or 3";
    let kinds = "expected f2, f4, f8, i1 to i8 or u1 to u8";
    let keys = "expected 'descr', 'fortran_order' and 'shape'";
    let mut version = shape("(1, 2)", 16);
    version[6] = 9;
    let mut long = shape("(1, 2)", 16);
    long[6] = 2;
    long[8..12].fill(0xff);
    let table: Vec<(Vec<u8>, String)> = vec![
        (shape("(2, 2)", 31), "truncated: shape (2, 2) of <f8 needs 32 bytes of data, found 31".into()),
        (shape("(2, 2)", 33), "shape (2, 2) of <f8 needs 32 bytes of data, found 1 more after them".into()),
        (
            shape("(2, 1000)", 16000),
            format!("shape (2, 1000) has 1000 coordinates per point; {form}; it seems to be transposed"),
        ),
        (
            shape("(5, 2, 9)", 720),
            format!("shape (5, 2, 9) has 9 coordinates per point; {form}; it seems to be transposed"),
        ),
        (
            shape("(5, 4)", 160),
            format!(
                "shape (5, 4) has 4 coordinates per point; {form}; `columns` chooses them, as in 1,2, and `projections` measures up to 16 by pairs"
            ),
        ),
        (shape("(5, 0)", 0), format!("shape (5, 0) has 0 coordinates per point; {form}")),
        (shape("()", 8), format!("shape (); {form}, or (n,) for d = 1")),
        (shape("(1, 1, 1, 2)", 16), format!("shape (1, 1, 1, 2); {form}, or (n,) for d = 1")),
        (shape("(0, 5, 2)", 0), "shape (0, 5, 2) holds no points".into()),
        (shape("(9000000000000000000, 0, 2)", 0), "shape (9000000000000000000, 0, 2) holds no points".into()),
        (
            shape("(1000000000000000000, 2)", 16),
            "shape (1000000000000000000, 2) of <f8 needs 16000000000000000000 bytes of data, found 16"
                .replace("shape", "truncated: shape"),
        ),
        (
            shape("(9000000000000000000, 9000000000000000000, 2)", 16),
            "shape (9000000000000000000, 9000000000000000000, 2) of <f8 is more than any file can hold".into(),
        ),
        (shape("(-1, 2)", 16), format!("damaged .npy header: 'shape' is not a tuple of sizes; {keys}")),
        (
            shape("(99999999999999999999, 2)", 16),
            format!("damaged .npy header: 'shape' is not a tuple of sizes; {keys}"),
        ),
        (dtype("'|b1'"), format!("dtype \"|b1\" is booleans; {kinds}")),
        (dtype("'<c16'"), format!("dtype \"<c16\" is complex numbers; {kinds}")),
        (dtype("'<U4'"), format!("dtype \"<U4\" is strings; {kinds}")),
        (dtype("'|O'"), format!("dtype \"|O\" is Python objects; {kinds}")),
        (dtype("'<M8[s]'"), format!("dtype \"<M8[s]\" is times; {kinds}")),
        (dtype("'<f16'"), format!("dtype \"<f16\" is an unsupported type; {kinds}")),
        (
            dtype("[('x', '<f8'), ('y', '<f8')]"),
            "a structured array, dtype [('x', '<f8'), ('y', '<f8')]; expected plain numbers, shape (n, d)".into(),
        ),
        (npy_header("{}", 0), format!("damaged .npy header: no 'descr'; {keys}")),
        (version, ".npy version 9; expected 1, 2 or 3".into()),
        (long, "truncated: the file ends within the .npy header".into()),
        (b"\x93NUMPY".to_vec(), "truncated: the file ends within the .npy header".into()),
        (
            b"\x93NUM\0".to_vec(),
            "neither text nor .npy, .npz or UTK .bin (no such header); raw numbers need `raw` f32x2 or the like".into(),
        ),
    ];
    for (bytes, message) in table {
        assert_eq!(read("a.npy", bytes).unwrap_err(), format!("a.npy: {message}"));
    }
}

#[test]
fn one_large_realization_is_read_block_by_block() {
    let numbers: Vec<f32> = (0..150_000u32).map(|k| (k * 37 % 1009) as f32 * 0.5).collect();
    let expected: Vec<f64> = numbers.iter().map(|&x| f64::from(x)).collect();
    for shape in [&[75_000, 2][..], &[1, 75_000, 2]] {
        let sets = read("a.npy", npy("<f4", npyz::Order::C, shape, &numbers)).unwrap();
        assert!(sets[0].source.ends_with("a.npy"), "{}", sets[0].source);
        assert_eq!(content(&sets), [(2, expected.clone())], "{shape:?}");
    }
    let pairs = read("a.npy", npy("<f4", npyz::Order::C, &[2, 75_000], &numbers));
    assert!(pairs.unwrap_err().contains("it seems to be transposed"));
    let sets = read("a.npy", npy("<f4", npyz::Order::C, &[2, 37_500, 2], &numbers)).unwrap();
    assert_eq!(content(&sets), [(2, expected[..75_000].to_vec()), (2, expected[75_000..].to_vec())]);
}
