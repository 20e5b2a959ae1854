//! Text and CSV, and what is said of what is neither.

use crate::shared::{content, input, read, read_with};
use pairwave::points::read::ReadOptions;

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
        ("decimal commas", b"0,5;0,25\n-1;1e-3\n"),
        ("decimal commas below a header", b"x;y\n0,5;0,25\n-1;0,001\n"),
        ("decimal commas beside text", b"id;x;y\n1;0,5;0,25\n2;-1;0,001\n"),
        ("decimal commas and tabs", b"0,5\t0,25\n-1\t1e-3\n"),
        ("units in brackets", b"x [m],y [m]\n0.5,0.25\n-1,1e-3\n"),
        ("units in brackets, quoted, other columns", b"\"id\",\"x [m]\",\"y [m]\"\n1,0.5,0.25\n2,-1,1e-3\n"),
        ("units in brackets, blanks", b"x [m] y [m]\n0.5 0.25\n-1 1e-3\n"),
        ("units in parentheses, other columns", b"y (um);mass (g);x (um)\n0.25;7;0.5\n1e-3;8;-1\n"),
        ("units in a comment", b"# x [m] y [m] m [g]\n0.5 0.25 1\n-1 1e-3 2\n"),
        ("R's write.table", b"\"x\" \"y\"\n\"1\" 0.5 0.25\n\"2\" -1 1e-3\n"),
        ("R's write.table without quotes", b"x y\n1 0.5 0.25\n2 -1 1e-3\n"),
        ("R's write.table, tabs and a factor", b"x\ty\tkind\na b\t0.5\t0.25\toak\nc\t-1\t1e-3\telm\n"),
        ("R's write.table, commas", b"x,y\n1,0.5,0.25\n2,-1,1e-3\n"),
        ("R's write.table of some rows", b"x y\n7 0.5 0.25\n3 -1 1e-3\n"),
        ("sep=", b"sep=;\nx;y\n0,5;0,25\n-1;0,001\n"),
        ("sep=|", b"sep=|\nx|y\n0.5|0.25\n-1|1e-3\n"),
        ("pandas with an index", b",0,1\n0,0.5,0.25\n1,-1,1e-3\n"),
        ("a row behind a #", b"0.5 0.25\n# 0.1 0.2 outlier\n-1 1e-3\n"),
        ("a row of other columns behind a #", b"id,x,y\na,0.5,0.25\n#b,0.1,0.2\nc,-1,1e-3\n"),
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
fn rows_have_names_in_every_realization() {
    // Each counts its own.
    let sets = read("b.txt", "x y\n1 1 2\n2 3 4\n#\n1 5 6\n").unwrap();
    assert_eq!(content(&sets), [(2, vec![1.0, 2.0, 3.0, 4.0]), (2, vec![5.0, 6.0])]);
    // One that counted is known when counting ends.
    let error = read("b.txt", "x y\n1 1 2\n2 3 4\nb 5 6\n2 7 8\n").unwrap_err();
    assert!(error.starts_with("b.txt:5: 3 fields, the header names 2, and \"2\" stands first in two rows"), "{error}");
}

#[test]
fn lines_count_every_kind_of_ending_once() {
    let sets = read("a.txt", "# c\r\n\r1 2\n\n3 4\r\n5 6\r").unwrap();
    assert_eq!(sets[0].lines, [3, 5, 6]);
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
            r#"a.txt:1: 4 numbers in a line, expected 1, 2 or 3, or a header that names columns x, y[, z], or `columns` 1,2: "1 2 3 4""#,
        ),
        ("1 2 3 oak\n", r#"a.txt:1: "oak" is not a number; expected 1, 2 or 3 numbers per line, or `columns` 1,2"#),
        ("1,,2\n", r#"a.txt:1: an empty field in "1,,2""#),
        (",1,2\n", r#"a.txt:1: an empty field in ",1,2""#),
        (
            "0,5 0,25\n",
            r#"a.txt:1: decimal comma in "0,5 0,25"; write numbers with a point, as 0.5, or separate them by semicolons or tabs"#,
        ),
        ("0,5;1\n1;0.5\n", "a.txt:2: decimal commas (line 1) and decimal points (line 2) in one file; write points"),
        ("x,y\n1,2\n,\n3,4\n", "a.txt:3: a row of empty fields with points after it; fill it in, or delete it"),
        ("x,y\n\"\",\"\"\n3,4\n", "a.txt:2: a row of empty fields with points after it; fill it in, or delete it"),
        (
            "\"0,5\",\"0,25\"\n",
            r#"a.txt:1: decimal comma in "0,5"; write numbers with a point, as 0.5, or separate them by semicolons or tabs"#,
        ),
        ("id,x,y\n1,2\n", r#"a.txt:2: 2 fields, expected 3 as in line 1: "1,2""#),
        ("id,x,y\n1,2,\n", r#"a.txt:2: "" is not a number; expected a number in column 3, named in line 1"#),
        (
            "x y\n1.5 0.5 0.25\n",
            r#"a.txt:2: 3 fields, the header names 2, and "1.5" is not the name of a row; decimal commas? write points, or semicolons between numbers; a class or a frame needs a name in the header"#,
        ),
        (
            "a,b,c,d\n1,2,3,4\n",
            r#"a.txt:1: 4 columns, none named x; expected columns named x, y[, z], or 1 to 3 columns, or `columns` with the names of those meant, in "a,b,c,d""#,
        ),
        (
            "id,lon,lat\n1,2,3\n",
            r#"a.txt:1: a column named "id" and none named x; expected columns named x, y[, z], or `columns` with the names of those meant"#,
        ),
        (
            ",lon,lat\n1,2,3\n",
            r#"a.txt:1: a column named "" and none named x; expected columns named x, y[, z], or `columns` with the names of those meant"#,
        ),
        ("5\n#\n7\n", "a.txt:1: announces 5 points, found 1"),
        ("x,y,X\n1,2,3\n", "a.txt:1: two columns are named x; `columns` names others"),
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
fn utf16_is_read() {
    let text = "x,y\n0.5,0.25\n";
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let marked = |mark: [u8; 2], bytes: &[u8]| [&mark[..], bytes].concat();
    for bytes in [marked([0xff, 0xfe], &little), marked([0xfe, 0xff], &big), little, big] {
        assert_eq!(content(&read("a.csv", bytes).unwrap()), [(2, vec![0.5, 0.25])]);
    }
    let lone: Vec<u8> = [0x31u16, 0x20, 0x32, 0x0a, 0xd800, 0x31].into_iter().flat_map(u16::to_le_bytes).collect();
    let damaged = marked([0xff, 0xfe], &lone);
    assert_eq!(read("a.csv", damaged).unwrap_err(), "a.csv: text in UTF-16LE, but damaged: some of it is no character");
}
