//! Points in and points out. Trusts `npyz` and `zip` to write what numpy would; proves that every variety of input
//! gives the very numbers it shows, that every bad one gives its message, and that what is written reads back bit for
//! bit. Cannot see whether a point lies in its domain: that is checked later.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use npyz::WriterBuilder as _;
use pairwave::points::RawPoints;
use pairwave::points::read::{Columns, MarkedPoints, RawLayout, ReadOptions, read_all, read_marked};
use pairwave::points::write::write;
use tempfile::TempDir;

const NO_OPTIONS: ReadOptions = ReadOptions { dim: None, raw: None };

/// One file in a folder of its own.
struct Input {
    folder: TempDir,
    path: PathBuf,
}

fn input(name: &str, bytes: impl AsRef<[u8]>) -> Input {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    Input { folder, path }
}

fn read_with(input: &Input, options: &ReadOptions) -> Result<Vec<RawPoints>, String> {
    let folder = format!("{}/", input.folder.path().display());
    read_all(std::slice::from_ref(&input.path), options).map_err(|e| e.to_string().replace(&folder, ""))
}

fn read(name: &str, bytes: impl AsRef<[u8]>) -> Result<Vec<RawPoints>, String> {
    read_with(&input(name, bytes), &NO_OPTIONS)
}

fn raw_options(layout: &str) -> ReadOptions {
    ReadOptions { raw: Some(layout.parse().unwrap()), dim: None }
}

fn points(set: &RawPoints) -> Vec<&[f64]> {
    set.coordinates.chunks_exact(set.dim).collect()
}

/// Sets as (dim, coordinates).
fn content(sets: &[RawPoints]) -> Vec<(usize, Vec<f64>)> {
    sets.iter().map(|s| (s.dim, s.coordinates.clone())).collect()
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

// Text

#[test]
fn text_varieties_give_the_same_points() {
    let varieties: &[(&str, &[u8])] = &[
        ("blanks", b"0.5 0.25\n-1 1e-3\n"),
        ("no end of line", b"0.5 0.25\n-1 1e-3"),
        ("tabs", b"0.5\t0.25\n-1\t\t1e-3\n"),
        ("commas", b"0.5,0.25\n-1,1e-3\n"),
        ("semicolons", b"0.5;0.25\n-1;1e-3\n"),
        ("comma and blank", b"0.5, 0.25\n  -1  ,\t1e-3  \n"),
        ("mixed lines", b"0.5, 0.25\n-1;1e-3\n"),
        ("padded columns", b"   0.5,              0.25\n    -1,      1e-3\n"),
        ("CRLF", b"0.5 0.25\r\n-1 1e-3\r\n"),
        ("lone CR", b"0.5 0.25\r-1 1e-3\r"),
        ("blank lines", b"\n\n0.5 0.25\n   \n\n-1 1e-3\n\n\n"),
        ("rows of separators, as spreadsheets leave them", b"0.5,0.25\n-1,1e-3\n,,\n,,\n"),
        ("byte order mark", b"\xef\xbb\xbf0.5 0.25\n-1 1e-3\n"),
        ("byte order mark before a header", b"\xef\xbb\xbfx,y\n0.5,0.25\n-1,1e-3\n"),
        ("signs and exponents", b"+0.5 25E-02\n-1.0e+00 +.001\n"),
        ("Fortran", b"0.5d0 2.5D-1\n-1.d0 1d-3\n"),
        ("trailing points and zeros", b"00.500 .25\n-1. 0.00100\n"),
        ("parentheses", b"(0.5 0.25)\n(-1, 1e-3)\n"),
        ("quoted", b"\"0.5\",\"0.25\"\n\"-1\",\"1e-3\"\n"),
        ("trailing separators", b"0.5,0.25,\n-1,1e-3,,\n"),
        ("leading comments", b"# by hand\n#\n\n# two\n0.5 0.25\n-1 1e-3\n"),
        ("comment in Latin-1", b"# Gr\xf6\xdfe\n0.5 0.25\n-1 1e-3\n"),
        ("comment after data", b"0.5 0.25 # first\n-1 1e-3# second, \"1 2\n"),
        ("trailing separator lines", b"0.5 0.25\n-1 1e-3\n#\n#\n\n#\n"),
        ("header", b"x y\n0.5 0.25\n-1 1e-3\n"),
        ("header with other names", b"\"lon\";\"lat\"\n0.5;0.25\n-1;1e-3\n"),
        ("header, commas over blanks", b"x,y\n0.5 0.25\n-1 1e-3\n"),
        ("numpy's header", b"# x y\n0.5 0.25\n-1 1e-3\n"),
        ("swapped header", b"Y,X\n0.25,0.5\n1e-3,-1\n"),
        ("columns by name", b"id,X,Y,species\n1,0.5,0.25,Pinus sylvestris\n2,-1,1e-3,\n"),
        ("columns by name, tabs", b"id\tx\tname\ty\n1\t0.5\ta b\t0.25\n2\t-1\t\t1e-3\n"),
        ("columns by name, R's csv", b"\"\",\"x\",\"y\"\n\"1\",0.5,0.25\n\"2\",-1,1e-3\n"),
        ("columns by name, quoted commas", b"name,x,y\n\"a, \"\"b\"\" # c\",0.5,0.25\nd,-1,1e-3\n"),
        ("columns by name in a comment", b"# id x y mark\n1 0.5 0.25 oak\n2 -1 1e-3 ash\n"),
        ("columns by name with blanks", b"x y mark\n0.5 0.25 7\n-1 1e-3 8\n"),
        ("a comment of as many words", b"# hello world\n0.5 0.25\n-1 1e-3\n"),
        ("PSA", b"2\n0.5 0.25\n-1 1e-3\n"),
        ("PSA, comment below the count", b"2\n# set\n0.5 0.25\n-1 1e-3\n"),
        ("header, comment below it", b"x,y\n# set\n0.5,0.25\n-1,1e-3\n"),
        ("PSA, commented", b"# set\n2 # points\n\n(0.5 0.25)\n(-1 1e-3)\n"),
    ];
    for (what, bytes) in varieties {
        let sets = read("a.txt", bytes).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert_eq!(content(&sets), [(2, vec![0.5, 0.25, -1.0, 1e-3])], "{what}");
        assert!(sets[0].source.ends_with("a.txt"), "{what}: {}", sets[0].source);
    }
}

#[test]
fn text_in_one_and_three_dimensions() {
    let one = |text: &str| content(&read("a.txt", text).unwrap());
    assert_eq!(one("0.5\n0.25\n"), [(1, vec![0.5, 0.25])]);
    assert_eq!(one("x\n7\n8\n"), [(1, vec![7.0, 8.0])]);
    // A leading integer is a count only if what follows has more columns.
    assert_eq!(one("0\n0.5\n1\n"), [(1, vec![0.0, 0.5, 1.0])]);
    assert_eq!(one("0.5\n#\n3\n4\n"), [(1, vec![0.5]), (1, vec![3.0, 4.0])]);
    assert_eq!(one("1 2 3\n4 5 6\n"), [(3, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0])]);
    assert_eq!(one("z,x,w,y\n1,2,3,4\n"), [(3, vec![2.0, 4.0, 1.0])]);
    let lone = read_with(&input("a.txt", "7\n"), &ReadOptions { dim: Some(1), raw: None });
    assert_eq!(content(&lone.unwrap()), [(1, vec![7.0])]);
}

#[test]
fn numbers_are_the_nearest_f64() {
    let text =
        "0.1 0.30000000000000004\n9007199254740993 2.2250738585072011e-308\n1e-400 0.99999999999999994448884876874\n";
    let sets = read("a.txt", text).unwrap();
    assert_eq!(
        sets[0].coordinates,
        [0.1, 0.1 + 0.2, 9007199254740992.0, 2.225_073_858_507_201e-308, 0.0, 1.0 - 2f64.powi(-53)]
    );
}

#[test]
fn comment_lines_between_data_separate_realizations() {
    let sets = read("b.txt", "# a\n1 2\n3 4\n#\n\n# again\n#\n\n5 6\n# end\n").unwrap();
    assert_eq!(content(&sets), [(2, vec![1.0, 2.0, 3.0, 4.0]), (2, vec![5.0, 6.0])]);
    assert!(sets[1].source.ends_with("b.txt, realization 1"), "{}", sets[1].source);
    assert_eq!((&sets[0].lines[..], &sets[1].lines[..]), (&[2, 3][..], &[9][..]));

    // Each set may repeat the header or announce its count.
    let sets = read("b.csv", "id,x,y\na b,1,2\n#\nid,x,y\nc,3,4\n#\nd,5,6\n").unwrap();
    assert_eq!(content(&sets), [(2, vec![1.0, 2.0]), (2, vec![3.0, 4.0]), (2, vec![5.0, 6.0])]);
    let sets = read("b.txt", "1\n1 2\n#\n2\n3 4\n5 6\n").unwrap();
    assert_eq!(content(&sets), [(2, vec![1.0, 2.0]), (2, vec![3.0, 4.0, 5.0, 6.0])]);
    assert_eq!(sets[1].lines, [5, 6]);
}

#[test]
fn lines_count_every_kind_of_ending_once() {
    let sets = read("a.txt", "# c\r\n\r1 2\n\n3 4\r\n5 6\r").unwrap();
    assert_eq!(sets[0].lines, [3, 5, 6]);
}

#[test]
fn committed_files_read_as_written() {
    let inputs = ["psa.txt", "trees.csv", "utk.dat"].map(data);
    let sets = read_all(&inputs, &NO_OPTIONS).unwrap();
    let expected: [&[f64]; 4] =
        [&[0.5, 0.25, 0.125, 0.75, 0.0625, 0.375], &[0.5, 0.25, 0.125, 0.75], &[0.5, 0.25, 0.125, 0.75], &[0.1, 0.2]];
    assert_eq!(sets.iter().map(|s| &s.coordinates[..]).collect::<Vec<_>>(), expected);
    assert_eq!(sets[1].lines, [2, 3]);
}

#[test]
fn bad_text_names_line_text_and_expectation() {
    let table: &[(&str, &str)] = &[
        ("0.5 0.25\n0.5 abc\n", r#"a.txt:2: "abc" is not a number; expected 2 numbers per line as in line 1"#),
        ("0.5 oak\n", r#"a.txt:1: "oak" is not a number; expected 2 numbers per line as in line 1"#),
        ("0.5 0.25\n\n1 nan\n", r#"a.txt:3: "nan" is not finite; expected 2 numbers per line as in line 1"#),
        ("nan nan\n", r#"a.txt:1: "nan" is not finite; expected 2 numbers per line as in line 1"#),
        ("NA NA\n1 2\n", r#"a.txt:1: "NA" is not a number; expected 2 numbers per line as in line 1"#),
        ("x,y\n1,-inf\n", r#"a.txt:2: "-inf" is not finite; expected 2 numbers per line as in line 1"#),
        ("1 1e999\n", r#"a.txt:1: "1e999" is not finite; expected 2 numbers per line as in line 1"#),
        ("1 0x10\n", r#"a.txt:1: "0x10" is not a number; expected 2 numbers per line as in line 1"#),
        ("1 2\n3 4 5\n", r#"a.txt:2: 3 fields, expected 2 as in line 1: "3 4 5""#),
        ("1 2\n#\n3\n4\n", r#"a.txt:4: 1 field, expected 2 as in line 1: "4""#),
        ("1 2\n3.5\n", r#"a.txt:2: 1 field, expected 2 as in line 1: "3.5""#),
        (
            "1 2 3 4\n",
            r#"a.txt:1: 4 numbers in a line, expected 1, 2 or 3, or a header that names columns x, y[, z]: "1 2 3 4""#,
        ),
        ("1 2 3 oak\n", r#"a.txt:1: "oak" is not a number; expected 1, 2 or 3 numbers per line"#),
        ("1,,2\n", r#"a.txt:1: an empty field in "1,,2""#),
        (",1,2\n", r#"a.txt:1: an empty field in ",1,2""#),
        ("0,5;0,25\n", r#"a.txt:1: decimal comma in "0,5;0,25"; write numbers with a point, as 0.5"#),
        ("0,5 0,25\n", r#"a.txt:1: decimal comma in "0,5 0,25"; write numbers with a point, as 0.5"#),
        ("0,5\t1\n", r#"a.txt:1: decimal comma in "0,5 1"; write numbers with a point, as 0.5"#),
        ("x;y\n1;2\n0,5;3\n", r#"a.txt:3: decimal comma in "0,5;3"; write numbers with a point, as 0.5"#),
        ("id;x;y\n1;0,5;3\n", r#"a.txt:2: decimal comma in "0,5"; write numbers with a point, as 0.5"#),
        ("\"0,5\",\"0,25\"\n", r#"a.txt:1: decimal comma in "0,5"; write numbers with a point, as 0.5"#),
        ("id,x,y\n1,2\n", r#"a.txt:2: 2 fields, expected 3 as in line 1: "1,2""#),
        ("id,x,y\n1,2,\n", r#"a.txt:2: "" is not a number; expected a number in column 3, named in line 1"#),
        ("x y\n1 0.5 0.25\n", r#"a.txt:2: 3 fields, expected 2 as in line 1: "1 0.5 0.25""#),
        (
            "a,b,c,d\n1,2,3,4\n",
            r#"a.txt:1: 4 columns, none named x; expected columns named x, y[, z], or 1 to 3 columns, in "a,b,c,d""#,
        ),
        ("id,lon,lat\n1,2,3\n", r#"a.txt:1: a column named "id" and none named x; expected columns named x, y[, z]"#),
        (",lon,lat\n1,2,3\n", r#"a.txt:1: a column named "" and none named x; expected columns named x, y[, z]"#),
        ("5\n#\n7\n", "a.txt:1: announces 5 points, found 1"),
        ("x,y,X\n1,2,3\n", "a.txt:1: two columns are named x"),
        ("x,y\n1,2\n#\ny,x\n3,4\n", "a.txt:4: this header differs from the columns of line 1"),
        ("x,y\nx,y\n1,2\n", r#"a.txt:2: "x" is not a number; expected 2 numbers per line as in line 1"#),
        ("3\n1 2\n3 4\n", "a.txt:1: announces 3 points, found 2"),
        ("1\n1 2\n3 4\n", "a.txt:1: announces 1 point, found 2"),
        ("1\n1 2\n#\n2\n3 4\n", "a.txt:4: announces 2 points, found 1"),
        ("1024\n", "a.txt:1: announces 1024 points, found 0"),
        ("18446744073709551615\n1 2\n", "a.txt:1: announces 18446744073709551615 points, found 1"),
        ("", "a.txt: the file is empty"),
        ("\n \n# nothing\n", "a.txt: no points: only blank lines and comments"),
        ("x,y\n", "a.txt: a header but no points"),
        (
            "0.5 0123456789012345678901234567890123456789012345\u{1F600}\n0.5 abcdefghijabcdefghijabcdefghijabcdefghijk\n",
            r#"a.txt:1: "0123456789012345678901234567890123456789..." is not a number; expected 2 numbers per line as in line 1"#,
        ),
    ];
    for (text, message) in table {
        assert_eq!(read("a.txt", text).unwrap_err(), *message, "{text:?}");
    }
}

#[test]
fn utf16_is_named() {
    let text = "x,y\n0.5,0.25\n";
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let marked = |mark: [u8; 2], bytes: &[u8]| [&mark[..], bytes].concat();
    for bytes in [marked([0xff, 0xfe], &little), marked([0xfe, 0xff], &big), little, big] {
        assert_eq!(read("a.csv", bytes).unwrap_err(), "a.csv: text in UTF-16; save it as UTF-8");
    }
}

// Binary

/// A `.npy` file as npyz writes it.
fn npy<T: npyz::Serialize + Copy>(dtype: &str, order: npyz::Order, shape: &[u64], values: &[T]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let dtype = npyz::DType::Plain(dtype.parse().unwrap());
    let options = npyz::WriteOptions::new().dtype(dtype).shape(shape).order(order).writer(&mut bytes);
    let mut writer = options.begin_nd().unwrap();
    writer.extend(values.iter().copied()).unwrap();
    writer.finish().unwrap();
    bytes
}

/// A version 1 header as any program might write it.
fn npy_header(dictionary: &str, data: usize) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((dictionary.len() as u16).to_le_bytes());
    bytes.extend(dictionary.bytes());
    bytes.extend(vec![0; data]);
    bytes
}

fn npy_f64(shape: &str, data: usize) -> Vec<u8> {
    npy_header(&format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"), data)
}

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
        (shape("(5, 4)", 160), format!("shape (5, 4) has 4 coordinates per point; {form}")),
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

fn zipped(entries: &[(&str, &[u8])], method: zip::CompressionMethod) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    for (name, bytes) in entries {
        archive.start_file(*name, options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

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
        stored(&[("a.npy", &first), ("b.npy", &npy("<f8", npyz::Order::C, &[1, 3], &[1.0; 3])), ("c.npy", &three)]);
    let message = read("a.npz", bytes).unwrap_err();
    assert!(
        message.starts_with("a.npz, array b: 3 coordinates per point, but ")
            && message.ends_with("a.npz, array a has 2"),
        "{message}"
    );
}

fn utk(code: u8, spare: u8, [m, n, d]: [u32; 3], data: &[u8]) -> Vec<u8> {
    let mut bytes = b"UTK!".to_vec();
    bytes.extend([code, spare, 0, 0]);
    bytes.extend([m, n, d].iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend(data);
    bytes
}

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
        (utk(5, 0, [1, 1, 4], &[0; 32]), "4 coordinates per point; 1, 2 or 3 are supported"),
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
    assert_eq!(read("a.gz", b"\x1f\x8b\x08\0\0\0").unwrap_err(), "a.gz: compressed with gzip; unpack it first");
    let message = "a.f32: raw numbers do not say how many make a point; give `raw` f32x2 (or x1, x3)";
    assert_eq!(read("a.f32", &f32s).unwrap_err(), message);
    let message = "a.rps: 15 bytes are not a whole number of f32x2 points of 8 bytes: 7 left over";
    assert_eq!(read("a.rps", &f32s[..15]).unwrap_err(), message);
    let form = "expected f32x1, f32x2, f32x3, f64x1, f64x2 or f64x3 (type x coordinates per point)";
    for wrong in ["f32", "f16x2", "f32x6", "f32x0", "f32x22", "F32x2", "f32 x2", ""] {
        let message = wrong.parse::<RawLayout>().unwrap_err().to_string();
        assert_eq!(message, format!("raw {wrong}: {form}"));
    }
    assert_eq!(with("a", &f32s, "f32x4").unwrap_err(), format!("raw f32x4: {form}"), "no setting takes the fourth");
    assert_eq!("f64x3".parse::<RawLayout>().unwrap().to_string(), "f64x3");
}

// Columns beside the coordinates

/// Points, weights and classes of an input with `--weight-column` and `--class-column` as given.
fn read_columns(input: &Input, layout: Option<&str>, weight: &str, class: &str) -> Result<Vec<MarkedPoints>, String> {
    let given = |text: &'static str| (!text.is_empty()).then_some(text);
    let leak = |text: &str| given(String::from(text).leak());
    let folder = format!("{}/", input.folder.path().display());
    let options = ReadOptions { raw: layout.map(|l| l.parse().unwrap()), dim: None };
    Columns::new(leak(weight), leak(class))
        .and_then(|columns| read_marked(std::slice::from_ref(&input.path), &options, &columns))
        .map_err(|e| e.to_string().replace(&folder, ""))
}

#[test]
fn columns_of_weights_and_classes_are_no_coordinates() {
    let expected = |sets: &[MarkedPoints], what: &str| {
        let [set] = sets else { panic!("{what}: {} sets", sets.len()) };
        assert_eq!((set.points.dim, &set.points.coordinates[..]), (2, &[0.5, 0.25, 0.125, 1.0][..]), "{what}");
        assert_eq!(set.weights, [3.5, 0.0], "{what}");
        assert_eq!(set.labels, ["1", "7"], "{what}");
    };
    for (what, text, weight, class) in [
        ("header, by name", "x,y,mass,Kind\n0.5,0.25,3.5,1\n0.125,1,0,7\n", "MASS", "kind"),
        ("header, by number", "mass;x;kind;y\n3.5;0.5;1;0.25\n0;0.125;7;1\n", "1", "3"),
        ("header without x", "a b w c\n0.5 0.25 3.5 1\n0.125 1 0 7\n", "w", "c"),
        ("other columns", "id,x,y,w,c,note\n1,0.5,0.25,3.5,1,\n2,0.125,1,0,7,tall tree\n", "w", "c"),
        ("comment as header", "# x y w c\n0.5 0.25 3.5 1\n0.125 1 0 7\n", "w", "c"),
        ("no header", "0.5 0.25 3.5 1\n0.125 1 0 7\n", "3", "4"),
        ("no header, marks first", "3.5,1,0.5,0.25\n0,7,0.125,1\n", "1", "2"),
    ] {
        expected(&read_columns(&input("a.csv", text), None, weight, class).unwrap(), what);
    }
    let rows = [0.5, 0.25, 3.5, 1.0, 0.125, 1.0, 0.0, 7.0];
    let bytes: Vec<u8> = rows.iter().flat_map(|x: &f64| x.to_le_bytes()).collect();
    expected(&read_columns(&input("a", &bytes), Some("f64x4"), "3", "4").unwrap(), "raw");
    let array = npy("<f8", npyz::Order::C, &[2, 4], &rows);
    expected(&read_columns(&input("a.npy", &array), None, "3", "4").unwrap(), "npy");
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    archive.start_file("a.npy", zip::write::SimpleFileOptions::default()).unwrap();
    archive.write_all(&array).unwrap();
    expected(&read_columns(&input("a.npz", archive.finish().unwrap().into_inner()), None, "3", "4").unwrap(), "npz");
    // Classes are text; only one of the two columns; several realizations, each with its own.
    let sets = read_columns(&input("a.txt", "0 0 oak\n1 0 \"red oak\"\n# next\n2 2 elm\n"), None, "", "3").unwrap();
    assert_eq!(sets.iter().map(|s| s.labels.join(",")).collect::<Vec<_>>(), ["oak,red oak", "elm"]);
    assert!(sets.iter().all(|s| s.weights.is_empty() && s.points.dim == 2));
    let sets = read_columns(&input("a.csv", "x,species\n0.5,white fir\n"), None, "", "species").unwrap();
    assert_eq!((sets[0].points.dim, sets[0].labels[0].as_str()), (1, "white fir"));
    let sets = read_columns(&input("a.npy", npy("<f8", npyz::Order::C, &[2, 2, 2], &rows)), None, "2", "").unwrap();
    assert_eq!((sets[0].points.dim, &sets[1].weights[..]), (1, &[1.0, 7.0][..]));
}

#[test]
fn wrong_columns_are_named() {
    for (text, weight, class, message) in [
        ("x,y,w\n1,2,3\n", "mass", "", "a.csv:1: `weight_column` mass: no column of that name; there are x, y, w"),
        ("x,y,w\n1,2,3\n", "", "4", "a.csv:1: `class_column` 4: there is no such column, only 3 columns"),
        ("x,y,w\n1,2,3\n", "2", "", "a.csv:1: column 2 is a coordinate, not a weight or a class"),
        ("x,y,w\n1,2,3\n", "3", "w", "a.csv:1: `weight_column` and `class_column` are the same column"),
        ("1 2 3\n", "w", "", "a.csv:1: `weight_column` w: no header names the columns; expected a number from 1"),
        ("x,w,w\n1,2,3\n", "w", "", "a.csv:1: `weight_column` w: two columns have that name"),
        ("1 2 1\n1 2 nan\n", "3", "", "a.csv:2: weight NaN; weights must be finite"),
        ("x,y,w\n1,2,\n", "w", "", "a.csv:2: \"\" is not a number; expected a number in column 3, named in line 1"),
        ("x,y,c\n1,2,\n", "", "c", "a.csv:2: no class in column 3"),
        ("7\n8\n", "1", "", "a.csv:2: no column is left for coordinates"),
        ("1 2\n", "0", "", "weight_column 0: columns are counted from 1"),
    ] {
        assert_eq!(read_columns(&input("a.csv", text), None, weight, class).unwrap_err(), message, "{text}");
    }
    let rows = [0.0; 8];
    let error = |shape: &[u64], weight: &str| {
        read_columns(&input("a.npy", npy("<f8", npyz::Order::C, shape, &rows)), None, weight, "").unwrap_err()
    };
    assert_eq!(error(&[2, 4], "5"), "a.npy: `weight_column` 5: there is no such column, only 4 columns");
    assert_eq!(error(&[2, 4], "w"), "a.npy: `weight_column` w: no header names the columns; expected a number from 1");
    assert_eq!(
        error(&[1, 8], "1"),
        "a.npy: shape (1, 8) has 8 columns; expected 2 to 4 columns: coordinates, and those the flags name"
    );
    assert_eq!(
        error(&[8], "1"),
        "a.npy: shape (8,) has 1 column; expected 2 to 4 columns: coordinates, and those the flags name"
    );
    // Without a flag a fourth column stays what it was.
    assert_eq!(
        read("a.txt", "1 2 3 4\n").unwrap_err(),
        "a.txt:1: 4 numbers in a line, expected 1, 2 or 3, or a header that names columns x, y[, z]: \"1 2 3 4\""
    );
}

// Batches

#[test]
fn directories_patterns_and_lists() {
    let folder = TempDir::new().unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    for k in [10, 9, 1] {
        put(&format!("set_{k}.txt"), &format!("{k} 0\n"));
    }
    put(".hidden", "junk");
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    let firsts = |inputs: &[PathBuf]| -> Vec<f64> {
        read_all(inputs, &NO_OPTIONS).unwrap().iter().map(|s| s.coordinates[0]).collect()
    };
    let at = |name: &str| folder.path().join(name);
    assert_eq!(firsts(&[folder.path().to_owned()]), [1.0, 9.0, 10.0]);
    assert_eq!(firsts(&[at("set_*.txt")]), [1.0, 9.0, 10.0]);
    assert_eq!(firsts(&[at("set_?.txt"), at("set_10.txt")]), [1.0, 9.0, 10.0]);
    assert_eq!(firsts(&[at("set_9.txt"), at("set_1.txt"), at("set_9.txt")]), [9.0, 1.0, 9.0]);

    // A file whose name has a pattern's characters is a file.
    put("odd[1]*.txt", "7 0\n");
    assert_eq!(firsts(&[at("odd[1]*.txt")]), [7.0]);

    let fails = |inputs: &[PathBuf]| {
        let message = read_all(inputs, &NO_OPTIONS).unwrap_err().to_string();
        message.replace(&format!("{}/", folder.path().display()), "").replace(&*folder.path().to_string_lossy(), "DIR")
    };
    assert_eq!(fails(&[at("none_*.txt")]), "none_*.txt: no file matches this pattern");
    assert_eq!(fails(&[at("none.txt")]), "none.txt: No such file or directory (os error 2)");
    assert_eq!(fails(&[at("sub")]), "sub: no files in this directory");
    let form = "expected files, a directory, a pattern such as 'set_*.npy', or - for standard input";
    assert_eq!(fails(&[]), format!("files (none): {form}"));
    assert_eq!(fails(&["-".into(), "-".into()]), "files - -: standard input can be read only once");

    put("third.txt", "1 2 3\n");
    assert_eq!(fails(&[at("set_1.txt"), at("third.txt")]), "third.txt: 3 coordinates per point, but set_1.txt has 2");
    let options = ReadOptions { dim: Some(2), raw: None };
    let message = read_all(&[at("third.txt")], &options).unwrap_err().to_string();
    assert!(message.ends_with("third.txt: 3 coordinates per point, but `sides` or `window` has 2 axes"), "{message}");

    std::fs::remove_file(at("third.txt")).unwrap();
    put("broken.csv", "x,y\n1,oops\n");
    let message = fails(&[folder.path().to_owned()]);
    assert_eq!(message, r#"broken.csv:2: "oops" is not a number; expected 2 numbers per line as in line 1"#);
    std::fs::rename(at("broken.csv"), at("notes.md")).unwrap();
    let message = fails(&[folder.path().to_owned()]);
    assert!(message.starts_with("notes.md: not a kind of file that holds points; expected .csv, .tsv,"), "{message}");
}

#[test]
fn ten_thousand_realizations() {
    let text: String = (0..10_000).map(|k| format!("{k} 0\n0 {k}\n#\n")).collect();
    let sets = read("a.txt", text).unwrap();
    assert_eq!(sets.len(), 10_000);
    assert_eq!(points(&sets[9_999]), [[9_999.0, 0.0], [0.0, 9_999.0]]);
    assert_eq!(sets[9_999].lines, [29_998, 29_999]);
}

// Points out

/// Numbers that are hard to write: shortest texts, extremes of the exponent, signed zero, neighbours of 1.
fn hard(n: usize, dim: usize, seed: u64) -> RawPoints {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state >> 11
    };
    let special = [0.0, -0.0, 0.1, 1.0 - 2f64.powi(-53), 5e-324, f64::MIN_POSITIVE, 1e300, -1e-5, 123_456_789.125];
    let number = |i: usize| special.get(i).copied().unwrap_or_else(|| next() as f64 / 2f64.powi(53));
    let coordinates = (0..n * dim).map(number).collect();
    RawPoints { dim, coordinates, source: "hard".into(), lines: Vec::new() }
}

fn write_all(path: &Path, sets: &[RawPoints]) -> Result<(), String> {
    let folder = format!("{}/", path.parent().unwrap().display());
    write(path, &mut sets.iter().cloned().map(Ok), false).map_err(|e| e.to_string().replace(&folder, ""))
}

fn bits(sets: &[RawPoints]) -> Vec<(usize, Vec<u64>)> {
    sets.iter().map(|s| (s.dim, s.coordinates.iter().map(|x| x.to_bits()).collect())).collect()
}

#[test]
fn written_points_read_back_bit_for_bit() {
    let folder = TempDir::new().unwrap();
    for dim in 1..=3 {
        let batch: Vec<RawPoints> = (0..3).map(|k| hard(20, dim, k)).collect();
        let uneven = [hard(20, dim, 1), hard(3, dim, 2), hard(7, dim, 3)];
        let options = ReadOptions { dim: Some(dim), raw: None };
        for extension in ["csv", "txt", "npy", "npz", "bin", "f64"] {
            let mut cases = vec![&batch[..1], &batch[..2], &batch[..]];
            match extension {
                "csv" | "txt" | "npz" => cases.push(&uneven),
                "f64" => cases.truncate(1),
                _ => {}
            }
            for (case, sets) in cases.into_iter().enumerate() {
                let path = folder.path().join(format!("{dim}_{case}.{extension}"));
                write_all(&path, sets).unwrap();
                let back = read_all(std::slice::from_ref(&path), &options).unwrap();
                assert_eq!(bits(&back), bits(sets), "{}", path.display());
            }
        }
    }
    let same = [hard(5, 2, 1), hard(5, 2, 1)];
    let path = folder.path().join("same.bin");
    write_all(&path, &same).unwrap();
    assert_eq!(bits(&read_all(&[path], &NO_OPTIONS).unwrap()), bits(&same), "equal sets that were meant");
    let empty = RawPoints { dim: 2, coordinates: vec![], source: "e".into(), lines: vec![] };
    let path = folder.path().join("empty.npz");
    write_all(&path, &[hard(2, 2, 1), empty.clone()]).unwrap();
    assert_eq!(read_all(&[path], &NO_OPTIONS).unwrap()[1].len(), 0);
}

#[test]
fn written_npy_and_npz_are_what_numpy_expects() {
    let folder = TempDir::new().unwrap();
    let sets = [hard(4, 2, 1), hard(4, 2, 2)];
    let path = folder.path().join("a.npy");
    write_all(&path, &sets).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(bytes.len(), 128 + 2 * 4 * 2 * 8);
    let file = npyz::NpyFile::new(&bytes[..]).unwrap();
    assert_eq!((file.shape(), file.order()), (&[2, 4, 2][..], npyz::Order::C));
    let numbers: Vec<f64> = file.into_vec().unwrap();
    assert_eq!(numbers, [&sets[0].coordinates[..], &sets[1].coordinates[..]].concat());

    let path = folder.path().join("a.npz");
    write_all(&path, &sets).unwrap();
    let archive = zip::ZipArchive::new(std::fs::File::open(&path).unwrap()).unwrap();
    let names: Vec<String> = archive.file_names().map(|n| n.unwrap().into_owned()).collect();
    assert_eq!(names, ["set_0.npy", "set_1.npy"]);
}

#[test]
fn written_text_is_plain() {
    let folder = TempDir::new().unwrap();
    let set =
        |coordinates: &[f64]| RawPoints { dim: 2, coordinates: coordinates.into(), source: "s".into(), lines: vec![] };
    let sets = [set(&[0.5, 0.25, 1e-7, 3.0]), set(&[0.1, 0.2])];
    for (name, text) in
        [("a.csv", "x,y\n0.5,0.25\n1e-7,3.0\n#\n0.1,0.2\n"), ("a.txt", "0.5 0.25\n1e-7 3.0\n#\n0.1 0.2\n")]
    {
        let path = folder.path().join(name);
        write_all(&path, &sets).unwrap();
        assert_eq!(std::fs::read_to_string(path).unwrap(), text);
    }
}

#[test]
fn f32_formats_round_but_stay_below_one() {
    let folder = TempDir::new().unwrap();
    let set = RawPoints { dim: 2, coordinates: vec![0.1, 1.0 - 1e-12], source: "s".into(), lines: vec![] };
    let expected = [f64::from(0.1f32), 1.0 - 2f64.powi(-24)];
    for (name, options) in [("a.rps", NO_OPTIONS), ("a.f32", ReadOptions { dim: Some(2), raw: None })] {
        let path = folder.path().join(name);
        write_all(&path, std::slice::from_ref(&set)).unwrap();
        assert_eq!(read_all(&[path], &options).unwrap()[0].coordinates, expected);
    }
}

#[test]
fn what_cannot_be_written_leaves_nothing_behind() {
    let folder = TempDir::new().unwrap();
    let (flat, short, solid) = (hard(9, 2, 1), hard(3, 2, 2), hard(9, 3, 3));
    let empty = RawPoints { dim: 2, coordinates: vec![], source: "empty".into(), lines: vec![] };
    let nan = RawPoints { dim: 2, coordinates: vec![0.0, 0.0, f64::NAN, 0.0], source: "nan".into(), lines: vec![] };
    let pair = [flat.clone(), short];
    let unequal = "realization 1 has 3 points, those before it 9; .npz, .csv and .txt hold unequal realizations";
    let single = "this format holds one realization; .npy, .npz, .bin, .csv and .txt hold several";
    let none = "realization 0 has no points, which text cannot show; .npz holds empty realizations";
    let table: &[(&str, &[RawPoints], String)] = &[
        ("a.npy", &pair, format!("out a.npy: {unequal}")),
        ("a.bin", &pair, format!("out a.bin: {unequal}")),
        ("a.rps", &pair, format!("out a.rps: {single}")),
        ("a.f64", &pair, format!("out a.f64: {single}")),
        (
            "a.rps",
            std::slice::from_ref(&solid),
            "out a.rps: .rps holds points in the plane, these have 3 coordinates".into(),
        ),
        ("a.csv", std::slice::from_ref(&empty), format!("out a.csv: {none}")),
        (
            "a.f32",
            std::slice::from_ref(&empty),
            "out a.f32: a realization without points would be an empty file".into(),
        ),
        ("a.npy", std::slice::from_ref(&nan), "nan, point 1: NaN is not finite".into()),
        (
            "a.txt",
            &[flat.clone(), solid.clone()],
            "hard: points of 3 coordinates in a file of 2-dimensional points".into(),
        ),
        ("a.npz", &[], "out a.npz: there are no realizations to write".into()),
        (
            "a.doc",
            &pair,
            "out a.doc: expected a file name that ends in .csv, .txt, .npy, .npz, .rps, .bin, .f32 or .f64".into(),
        ),
        (
            "a",
            &pair,
            "out a: expected a file name that ends in .csv, .txt, .npy, .npz, .rps, .bin, .f32 or .f64".into(),
        ),
    ];
    for (name, sets, message) in table {
        assert_eq!(write_all(&folder.path().join(name), sets).unwrap_err(), *message);
    }
    let mut failing = [Ok(flat.clone()), Err(pairwave::Error::Cancelled)].into_iter();
    assert!(write(&folder.path().join("a.csv"), &mut failing, false).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing half-written");

    let message = write_all(&folder.path().join("no/such/a.csv"), &pair).unwrap_err();
    assert!(message.starts_with("a.csv: No such file"), "{message}");

    let path = folder.path().join("a.csv");
    std::fs::write(&path, "mine").unwrap();
    assert_eq!(write_all(&path, &pair).unwrap_err(), "out a.csv: exists already; `force` replaces it");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    let mut failing = [Ok(flat.clone()), Err(pairwave::Error::Cancelled)].into_iter();
    assert!(write(&path, &mut failing, true).is_err());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine", "kept when the new one fails");
    write(&path, &mut [Ok(flat.clone())].into_iter(), true).unwrap();
    assert_eq!(bits(&read_all(&[path], &NO_OPTIONS).unwrap()), bits(&[flat]));
}

// Damage

#[test]
fn damaged_files_never_panic() {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below.max(1) as u64) as usize
    };
    let set = npy("<f8", npyz::Order::Fortran, &[2, 3, 2], &[0.5; 12]);
    let seeds: Vec<(&str, Vec<u8>)> = vec![
        ("a.txt", b"# a\n0.5 0.25\n0.125,1e-3\n#\n2\n(0.5 0.25)\n0.1 0.2\n".to_vec()),
        ("a.csv", std::fs::read(data("trees.csv")).unwrap()),
        ("a.txt", std::fs::read(data("psa.txt")).unwrap()),
        ("a.npz", zipped(&[("a.npy", &set), ("b.npy", &set)], zip::CompressionMethod::Deflated)),
        ("a.npz", zipped(&[("a.npy", &set)], zip::CompressionMethod::Stored)),
        ("a.npy", set),
        ("a.npy", npy_f64("(3, 2)", 48)),
        ("a.bin", utk(5, 0, [2, 1, 2], &(0..32).collect::<Vec<u8>>())),
        ("a.rps", [0.5f32, 0.25].iter().flat_map(|x| x.to_le_bytes()).collect()),
        ("points", [0.5f32, 0.25].iter().flat_map(|x| x.to_le_bytes()).collect()),
    ];
    let folder = TempDir::new().unwrap();
    let alphabet = b"0123456789.,;#\"()[]{}'-+eExyzn \t\r\n\0\xff\x80PK";
    let (mut good, mut bad) = (0, 0);
    for (name, seed) in &seeds {
        let path = folder.path().join(name);
        for _ in 0..200 {
            let mut bytes = seed.clone();
            for _ in 0..=random(4) {
                let at = random(bytes.len());
                match random(6) {
                    0 => bytes.truncate(at),
                    1 if !bytes.is_empty() => bytes[at] = random(256) as u8,
                    2 if !bytes.is_empty() => bytes[at] ^= 1 << random(8),
                    3 => bytes.insert(at, alphabet[random(alphabet.len())]),
                    4 if !bytes.is_empty() => _ = bytes.remove(at),
                    _ if !bytes.is_empty() => bytes[at] = alphabet[random(alphabet.len())],
                    _ => {}
                }
            }
            std::fs::write(&path, &bytes).unwrap();
            match read_all(std::slice::from_ref(&path), &NO_OPTIONS) {
                Ok(sets) => {
                    good += 1;
                    for set in &sets {
                        assert!((1..=3).contains(&set.dim));
                        assert_eq!(set.coordinates.len() % set.dim, 0);
                        assert!(set.lines.is_empty() || set.lines.len() == set.len());
                    }
                    assert!(!sets.is_empty());
                }
                Err(error) => {
                    bad += 1;
                    assert!(error.to_string().contains(name), "{error}");
                }
            }
        }
    }
    assert!(good > 100 && bad > 100, "both happen: {good} read, {bad} refused");
}
