//! Columns that are no coordinates: weights and classes.

use std::io::Write as _;

use crate::shared::{Input, input, npy, read};
use pairwave::points::read::{Columns, MarkedPoints, ReadOptions, TypedColumns, read_marked};

/// Points, weights and classes of an input with `--weight-column` and `--class-column` as given.
fn read_columns(input: &Input, layout: Option<&str>, weight: &str, class: &str) -> Result<Vec<MarkedPoints>, String> {
    let given = |text: &'static str| (!text.is_empty()).then_some(text);
    let leak = |text: &str| given(String::from(text).leak());
    let folder = format!("{}/", input.folder.path().display());
    let options = ReadOptions { raw: layout.map(|l| l.parse().unwrap()), dim: None };
    Columns::new(&TypedColumns { weight: leak(weight), class: leak(class), ..TypedColumns::default() })
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
        (
            "x,y,w\n1,2,3\n",
            "2",
            "",
            "a.csv:1: column 2 is a coordinate, not a weight or a class; `columns` names others",
        ),
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
        "a.txt:1: 4 numbers in a line, expected 1, 2 or 3, or a header that names columns x, y[, z], or `columns` 1,2: \"1 2 3 4\""
    );
}
