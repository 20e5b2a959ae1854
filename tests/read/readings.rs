//! What is said about a file that was read, and what flags choose in it.

use crate::shared::{notes, npy, read, read_typed, zipped};
use pairwave::points::read::{Apart, TypedColumns};

const ROWS: &str = "0.62,0.89\n0.77,0.22\n0.31,0.87\n0.25,0.82\n0.79,0.46\n0.31,0.27\n";

/// Rows with a number before each.
fn numbered(number: impl Fn(usize) -> usize) -> String {
    ROWS.lines().enumerate().map(|(j, row)| format!("{},{row}\n", number(j))).collect()
}

#[test]
fn what_may_be_meant_otherwise_is_said() {
    let blocks = ROWS.replacen("0.25", "\n0.25", 1);
    let table: &[(String, &[&str])] = &[
        (ROWS.into(), &[]),
        (format!("x,y\n{ROWS}"), &[]),
        (
            format!("0,1\n{ROWS}"),
            &["was taken for the numbers of the columns, not for a point; written as 0.0,1.0 it is a point"],
        ),
        (format!("1,2\n{ROWS}"), &["was taken for the numbers of the columns"]),
        (format!("\"0\",\"1\"\n{ROWS}"), &["was taken for the numbers of the columns"]),
        ("0,1\n3,5\n7,2\n".into(), &["was taken for a point; if it numbers the columns, delete it"]),
        (format!("{ROWS},\n,\n"), &[":7: 2 rows of empty fields left out"]),
        (format!("{ROWS}#0.1,0.2\n{ROWS}"), &[":7: 1 row behind a # left out"]),
        (
            blocks,
            &[":4: blank lines leave 2 blocks of points, read as one realization; `realization_column` blank-lines"],
        ),
        (format!("frame,x,y\n{}", numbered(|j| j / 3)), &["column frame has 2 values and was not used"]),
        (format!("frame,x,y\n{}", numbered(|_| 7)), &[]),
        (format!("lon,lat\n{ROWS}"), &["column lon holds degrees by its name"]),
        (format!("Longitude (deg),Latitude (deg)\n{ROWS}"), &["holds degrees by its name"]),
        (
            "0 0\n1 3\n2 6\n3 1\n".into(),
            &["column 1 counts the rows (0, 1, 2, ...) and was read as a coordinate; `columns` 2"],
        ),
    ];
    for (text, expected) in table {
        let said = notes("a.csv", text);
        assert_eq!(said.len(), expected.len(), "{text}: {said:?}");
        assert!(said.iter().zip(*expected).all(|(said, part)| said.contains(part)), "{text}: {said:?}");
    }
    assert_eq!(read("a.csv", format!("0,1\n{ROWS}")).unwrap()[0].len(), 6);
}

#[test]
fn what_cannot_be_decided_names_the_flag() {
    let frames: String = (0..8).map(|j| format!("{} 0.{j}5 0.{}1\n", j / 4, 9 - j)).collect();
    for (text, reason) in [
        (
            numbered(|j| j),
            "a.csv:1: column 1 counts the rows (0, 1, 2, ...); `columns` 2,3 leaves it out, 1,2,3 takes it for a coordinate",
        ),
        (
            format!("tree,East,North\n{}", numbered(|j| j + 1)),
            "a.csv:1: column tree counts the rows (1, 2, 3, ...); `columns` East,North leaves it out, tree,East,North takes it for a coordinate",
        ),
        (
            frames,
            "a.csv:1: column 1 has 2 whole numbers, each in a block, as frames have; `realization_column` 1 makes each a realization, `columns` 2,3 leaves it out, 1,2,3 takes it for a coordinate",
        ),
        (
            format!("frame,East,North\n{}", numbered(|j| j)),
            "a.csv:1: a column named \"frame\" and none named x; expected columns named x, y[, z], or `columns` with the names of those meant",
        ),
    ] {
        assert_eq!(read("a.csv", text).unwrap_err(), reason);
    }
}

#[test]
fn columns_and_realizations_are_chosen() {
    let text = "tree,Easting [m],Northing [m],plot\n1,0.5,0.25,b\n2,0.125,1,a\n3,0.75,0.5,b\n";
    let typed = |columns, realization| TypedColumns { columns, realization, ..TypedColumns::default() };
    for columns in ["Easting,northing", "2,3", "Easting [m],3", "\"Easting [m]\",\"Northing [m]\""] {
        let sets = read_typed("a.csv", text, typed(Some(columns), None)).unwrap();
        assert_eq!(sets[0].points.coordinates, [0.5, 0.25, 0.125, 1.0, 0.75, 0.5], "{columns}");
        assert_eq!(
            (&sets[0].reading.columns[0][..], &sets[0].reading.unused[..]),
            ("Easting [m]", &["tree".into(), "plot".into()][..])
        );
    }
    let sets = read_typed("a.csv", text, typed(Some("Northing,Easting"), Some("plot"))).unwrap();
    let content: Vec<_> = sets.iter().map(|s| (&s.points.coordinates[..], &s.points.lines[..])).collect();
    assert_eq!(content, [(&[0.25, 0.5, 0.5, 0.75][..], &[2, 4][..]), (&[1.0, 0.125][..], &[3][..])]);
    assert!(sets[1].points.source.ends_with("a.csv, realization plot a"), "{}", sets[1].points.source);
    assert_eq!(sets[0].reading.apart, Apart::Column("plot".into()));
    assert!(sets[1].points.place(0).ends_with("a.csv:3"));
    // Without a header; columns beside that are text.
    let sets = read_typed("a.csv", "a b,0.5,0.25,\nc,0.125,1,d\n", typed(Some("2,3"), None)).unwrap();
    assert_eq!(sets[0].points.coordinates, [0.5, 0.25, 0.125, 1.0]);
    // Blank lines, where they are asked for, and only then.
    let blocks = "1 2\n3 4\n\n\n5 6\n";
    let sets = read_typed("a.txt", blocks, typed(None, Some("blank-lines"))).unwrap();
    assert_eq!(sets.iter().map(|s| s.points.len()).collect::<Vec<_>>(), [2, 1]);
    assert_eq!(read("a.txt", blocks).unwrap().len(), 1);
    // Arrays of numbers.
    let rows = [7.0, 0.5, 0.25, 7.0, 0.125, 1.0, 2.0, 0.75, 0.5];
    let array = npy("<f8", npyz::Order::C, &[3, 3], &rows);
    let sets = read_typed("a.npy", &array, typed(Some("3,2"), Some("1"))).unwrap();
    assert_eq!(
        sets.iter().map(|s| &s.points.coordinates[..]).collect::<Vec<_>>(),
        [&[0.25, 0.5, 1.0, 0.125][..], &[0.5, 0.75]]
    );

    let fails = |columns, realization| read_typed("a.csv", text, typed(columns, realization)).unwrap_err();
    assert_eq!(
        fails(Some("1,2,3,4"), None),
        "columns 1,2,3,4: expected 1, 2 or 3 columns, found 4; `projections` takes more"
    );
    assert_eq!(fails(Some("1,1"), None), "columns 1,1: names column 1 twice");
    assert_eq!(fails(Some("1,tree"), None), "a.csv:1: `columns` names column 1 twice");
    assert_eq!(fails(Some("1,,2"), None), "columns 1,,2: expected names or numbers, separated by commas");
    assert_eq!(fails(Some("0,1"), None), "columns 0,1: columns are counted from 1");
    assert_eq!(fails(Some("2,5"), None), "a.csv:1: `columns` 5: there is no such column, only 4 columns");
    assert_eq!(fails(Some("2,3"), Some("3")), "a.csv:1: `columns` and `realization_column` are the same column");
    assert_eq!(
        fails(Some("lat,lon"), None),
        "a.csv:1: `columns` lat: no column of that name; there are tree, Easting [m], Northing [m], plot"
    );
}

#[test]
fn arrays_are_chosen_by_name() {
    let flat = |values: &[f64]| npy("<f8", npyz::Order::C, &[values.len() as u64], values);
    let pairs = |values: &[f64]| {
        npy("<f4", npyz::Order::C, &[values.len() as u64 / 2, 2], &values.iter().map(|&v| v as f32).collect::<Vec<_>>())
    };
    let archive = |entries: &[(&str, &[u8])]| zipped(entries, zip::CompressionMethod::Stored);
    let (x, y, w) = (flat(&[0.5, 0.25]), flat(&[0.125, 1.0]), flat(&[3.0, 4.0]));
    let (pos, vel) = (pairs(&[0.5, 0.125, 0.25, 1.0]), pairs(&[9.0, 9.0, 8.0, 8.0]));
    let array = |array| TypedColumns { array, ..TypedColumns::default() };
    let expected = [0.5, 0.125, 0.25, 1.0];
    let one = |bytes: &[u8], typed| {
        let sets = read_typed("a.npz", bytes, typed).unwrap();
        assert_eq!((sets.len(), &sets[0].points.coordinates[..]), (1, &expected[..]));
        sets.into_iter().next().unwrap()
    };
    one(&archive(&[("x.npy", &x), ("y.npy", &y)]), array(None));
    one(&archive(&[("Y.npy", &y), ("X.npy", &x)]), array(None));
    one(&archive(&[("arr_0.npy", &x), ("arr_1.npy", &y)]), array(Some("arr_0,arr_1")));
    let both = archive(&[("pos.npy", &pos), ("vel.npy", &vel)]);
    let chosen = one(&both, array(Some("pos")));
    assert_eq!((&chosen.reading.unused[..], chosen.reading.digits), (&["array vel".to_string()][..], Some(24)));
    let weighted = archive(&[("points.npy", &pos), ("weights.npy", &w)]);
    let set = one(&weighted, TypedColumns { weight: Some("weights"), ..TypedColumns::default() });
    assert_eq!(set.weights, [3.0, 4.0]);

    let fails = |bytes: Vec<u8>, typed| read_typed("a.npz", bytes, typed).unwrap_err();
    let choose = "`array` NAME chooses the points, or one array per coordinate, as in x,y";
    assert_eq!(fails(both.clone(), array(None)), format!("a.npz: holds 2 arrays: pos (2, 2), vel (2, 2); {choose}"));
    assert_eq!(fails(weighted, array(None)), format!("a.npz: holds 2 arrays: points (2, 2), weights (2,); {choose}"));
    assert_eq!(
        fails(archive(&[("arr_0.npy", &x), ("arr_1.npy", &y)]), array(None)),
        "a.npz: holds 2 arrays: arr_0 (2,), arr_1 (2,); `array` with one name per coordinate makes them one set; a domain of one axis, realizations in 1D"
    );
    assert_eq!(
        fails(both, array(Some("position"))),
        "a.npz: `array` position: no array of that name; there are pos (2, 2), vel (2, 2)"
    );
    assert_eq!(
        read_typed("a.csv", "1 2\n", array(Some("x"))).unwrap_err(),
        "a.csv: `array` chooses arrays of an .npz archive, which this file is not"
    );
}
