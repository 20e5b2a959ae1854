//! Formats whose columns have names: PLY, XYZ, LAMMPS dumps, GeoJSON, VTK.

use crate::shared::{read, read_typed};
use pairwave::points::read::{Apart, MarkedPoints, TypedColumns};

const NONE: TypedColumns<'_> = TypedColumns {
    columns: None,
    realization: None,
    weight: None,
    intensity: None,
    class: None,
    array: None,
    many_axes: false,
};

fn one(name: &str, bytes: impl AsRef<[u8]>, typed: TypedColumns<'_>) -> MarkedPoints {
    let mut sets = read_typed(name, bytes, typed).unwrap();
    assert_eq!(sets.len(), 1, "{name}");
    sets.remove(0)
}

/// Coordinates, and what is said of them.
fn said(set: &MarkedPoints) -> (&[f64], String, String, &str) {
    let reading = &set.reading;
    (&set.points.coordinates, reading.columns.join(","), reading.unused.join(","), &reading.format)
}

/// A PLY of three points with a list, a colour and faces behind them, after another element.
fn ply(format: &str) -> Vec<u8> {
    let header = format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nelement camera 1\nproperty list uchar int ids\nproperty float f\n\
         element vertex 3\nproperty float x\nproperty list uchar short near\nproperty double y\nproperty uchar red\n\
         property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    );
    let rows = [(0.5f32, vec![7i16, 8], 0.1, 3u8, 0.25f32), (0.125, vec![], 0.2, 9, 1.0), (0.75, vec![1], 0.3, 3, 0.5)];
    let mut bytes = header.into_bytes();
    if format == "ascii" {
        bytes.extend(b"2 4 5 0.5\n");
        for (x, near, y, red, z) in rows {
            let near: String = near.iter().map(|n| format!(" {n}")).collect();
            let count = near.split_whitespace().count();
            bytes.extend(format!("{x} {count}{near} {y} {red} {z}\n").bytes());
        }
        bytes.extend(b"3 0 1 2\n");
        return bytes;
    }
    let big = format == "binary_big_endian";
    let mut put = |number: &[u8]| match big {
        true => bytes.extend(number.iter().rev()),
        false => bytes.extend(number),
    };
    put(&[2]);
    [4i32, 5].iter().for_each(|n| put(&n.to_le_bytes()));
    put(&0.5f32.to_le_bytes());
    for (x, near, y, red, z) in rows {
        put(&x.to_le_bytes());
        put(&[near.len() as u8]);
        near.iter().for_each(|n| put(&n.to_le_bytes()));
        put(&f64::to_le_bytes(y));
        put(&[red]);
        put(&z.to_le_bytes());
    }
    put(&[3]);
    [0i32, 1, 2].iter().for_each(|n| put(&n.to_le_bytes()));
    bytes
}

#[test]
fn ply_of_all_three_kinds() {
    let coordinates = [0.5, 0.1, 0.25, 0.125, 0.2, 1.0, 0.75, 0.3, 0.5];
    for (format, words, digits) in [
        ("ascii", "PLY, ascii", None),
        ("binary_little_endian", "PLY, binary little-endian", Some(24)),
        ("binary_big_endian", "PLY, binary big-endian", Some(24)),
    ] {
        let bytes = ply(format);
        let set = one("a.ply", &bytes, NONE);
        let rest = "red,list near,element camera,element face";
        assert_eq!(said(&set), (&coordinates[..], "x,y,z".into(), rest.into(), words));
        assert_eq!(set.reading.digits, digits);
        let typed = TypedColumns { columns: Some("y,x"), weight: Some("z"), class: Some("red"), ..NONE };
        let set = one("a.ply", &bytes, typed);
        assert_eq!(set.points.coordinates, [0.1, 0.5, 0.2, 0.125, 0.3, 0.75]);
        assert_eq!((&set.weights[..], &set.labels.join(",")[..]), (&[0.25, 1.0, 0.5][..], "3,9,3"));
        // An announced row that is not there.
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let cut = &bytes[..text.find("end_header\n").unwrap() + 11 + 30.min(bytes.len())];
        let error = read("a.ply", cut).unwrap_err();
        assert!(error.starts_with("a.ply") && (error.contains("truncated") || error.contains("fewer")), "{error}");
    }
    let realizations = TypedColumns { realization: Some("red"), ..NONE };
    let sets = read_typed("a.ply", ply("ascii"), realizations).unwrap();
    assert_eq!(sets.iter().map(|set| set.points.len()).collect::<Vec<_>>(), [2, 1]);
    assert_eq!(sets[1].reading.apart, Apart::Column("red".into()));
    assert!(sets[1].points.place(0).ends_with("a.ply:18"), "{}", sets[1].points.place(0));
}

#[test]
fn wrong_ply_is_named() {
    let header = |lines: &str| format!("ply\nformat ascii 1.0\n{lines}end_header\n");
    for (text, reason) in [
        ("ply\nformat ascii 1.0\nelement vertex 1\n".into(), "a.ply:3: PLY without end_header"),
        (header("element face 0\n"), "a.ply: PLY without an element vertex; its elements are face"),
        (header("element vertex 9999999999999\n"), "a.ply:4: the element vertex has no properties"),
        (
            header("element vertex 9999999999999999999\nproperty float x\n") + "1\n",
            "a.ply: truncated: its header says 9999999999999999999 vertex, and there are 1",
        ),
        (
            header("element vertex 1\nproperty float x\nproperty float y\n") + "1 oops\n",
            "a.ply:7: \"oops\" is not a number; expected a number in column y",
        ),
        (
            header("element vertex 1\nproperty float x\nproperty float y\n") + "1 nan\n",
            "a.ply:7: \"nan\" is not finite; expected a number in column y",
        ),
        (
            header("element vertex 1\nproperty float x\n") + "1 2\n",
            "a.ply:6: more numbers than the element vertex has properties: \"1 2\"",
        ),
        (header("element vertex 0\nproperty float x\n"), "a.ply: no points"),
        (
            header("element vertex 1\nproperty half x\n"),
            "a.ply:4: \"property half x\"; expected property TYPE NAME or property list TYPE TYPE NAME of an element, with TYPE char, uchar, short, ushort, int, uint, float or double",
        ),
        (
            "ply\nelement vertex 0\nend_header\n".into(),
            "a.ply:3: PLY without a format; expected ascii, binary_little_endian or binary_big_endian",
        ),
    ] {
        assert_eq!(read("a.ply", &text).unwrap_err(), reason);
    }
    let typed = TypedColumns { weight: Some("mass"), ..NONE };
    assert_eq!(
        read_typed("a.ply", ply("ascii"), typed).unwrap_err(),
        "a.ply: `weight_column` mass: no column of that name; there are x, y, red, z"
    );
    let typed = TypedColumns { realization: Some("blank-lines"), ..NONE };
    assert!(read_typed("a.ply", ply("ascii"), typed).unwrap_err().contains("is about text, which this file is not"));
}

#[test]
fn xyz_has_frames_and_extended_xyz_columns() {
    let plain = "2\nwater\nO 0.1 0.2 0.3\nH 0.4 0.5 0.6 9\n";
    assert_eq!(
        read("a.xyz", plain).unwrap_err(),
        "a.xyz:4: 5 fields, expected 4 as in the first frame: \"H 0.4 0.5 0.6 9\""
    );
    let plain = "2\nwater\nO 0.1 0.2 0.3\nH 0.4 0.5 0.6\n1\nwater\nO 0.7 0.8 0.9\n\n";
    let sets = read_typed("a.xyz", plain, TypedColumns { class: Some("species"), ..NONE }).unwrap();
    assert_eq!(sets.iter().map(|set| set.labels.join(",")).collect::<Vec<_>>(), ["O,H", "O"]);
    assert_eq!(said(&sets[1]), (&[0.7, 0.8, 0.9][..], "x,y,z".into(), "".into(), "XYZ"));
    assert_eq!((&sets[0].reading.apart, &sets[0].reading.stated), (&Apart::Frames, &None));
    assert!(sets[1].points.source.ends_with("a.xyz, realization 1"));
    assert!(sets[1].points.place(0).ends_with("a.xyz:7"));
    // Numbers of elements, nothing in the comment.
    assert_eq!(read("a.xyz", "1\n\n6 0.1 0.2 0.3\n").unwrap()[0].coordinates, [0.1, 0.2, 0.3]);
    // A box, in any order of keys; coordinates need not come first.
    let frame = |n: &str, lattice: &str| {
        format!(
            "{n}\nProperties=id:I:1:pos:R:2:velo:R:2:fixed:L:1 Lattice=\"{lattice}\" Time=1.0\n1 0.5 0.25 7 8 T\n2 0.125 1.5 7 8 F\n"
        )
    };
    let extended = frame("2", "3 0 0 0 2 0 0 0 1") + &frame("2", "3 0 0 0 2 0 0 0 1");
    let sets = read_typed("a.xyz", &extended, TypedColumns { weight: Some("velo[1]"), class: Some("fixed"), ..NONE });
    let sets = sets.unwrap();
    assert_eq!(said(&sets[0]), (&[0.5, 0.25, 0.125, 1.5][..], "x,y".into(), "id,velo[0]".into(), "extended XYZ"));
    assert_eq!((&sets[1].weights[..], sets[1].labels.join(",")), (&[8.0, 8.0][..], "T,F".into()));
    assert!(matches!(sets[0].reading.stated, Some(Ok(_))));
    for (text, reason) in [
        (frame("3", "3 0 0 0 2 0 0 0 1"), "a.xyz:4: truncated: frame 0 has 3 rows by its count, and there are 2"),
        (frame("1", "3 0 0 0 2 0 0 0 1"), "a.xyz:4: \"2 0.125 1.5 7 8 F\"; expected the number of rows of frame 1"),
        (
            frame("2", "3 0 0 0 2 0 0 0 1").replace("fixed:L:1", "fixed:Q:1"),
            "a.xyz:2: Properties \"id:I:1:pos:R:2:velo:R:2:fixed:Q:1\"; expected NAME:TYPE:COUNT of each, TYPE S, R, I or L",
        ),
        (
            frame("2", "3 0 0 0 2 0 0 0 1") + "1\nProperties=pos:R:2\n1 2\n",
            "a.xyz:6: the columns of this frame are not those of the first",
        ),
        (
            "99999999999999999\nLattice=\"1 0 0 0 1 0 0 0 1\"\n".into(),
            "a.xyz:2: truncated: frame 0 has 99999999999999999 rows by its count, and there are 0",
        ),
    ] {
        let error = read("a.xyz", &text).unwrap_err();
        assert!(error.starts_with(reason), "{error}");
    }
    for (change, with, reason) in [
        (
            "3 0 0 0 2 0 0 0 1",
            "3 1 0 0 2 0 0 0 1",
            "Lattice \"3 1 0 0 2 0 0 0 1\" is not orthogonal: y of vector 1 is 1; `window` gives",
        ),
        ("3 0 0 0 2 0 0 0 1", "3 0 0", "Lattice \"3 0 0\"; expected 9 numbers"),
    ] {
        let set = read_typed("a.xyz", frame("2", change).replace(change, with), NONE).unwrap().remove(0);
        let Some(Err(said)) = &set.reading.stated else { panic!("{with}") };
        assert!(said.starts_with(reason), "{said}");
    }
    let moving = frame("2", "3 0 0 0 2 0 0 0 1") + &frame("2", "3 0 0 0 2.5 0 0 0 1");
    let set = read_typed("a.xyz", moving, NONE).unwrap().remove(0);
    let Some(Err(said)) = &set.reading.stated else { panic!("another box") };
    assert_eq!(said, "the box of frame 1 (line 5) is not that of the first; `sides` or `window` sets one for all");
}

/// A step of a dump with these columns and flags.
fn step(flags: &str, columns: &str, rows: &str) -> String {
    let n = rows.lines().count();
    let tilt = if flags.starts_with("xy") { " 0.5" } else { "" };
    let bounds: String = ["-1 3", "0 2", "-0.5 0.5"].iter().map(|line| format!("{line}{tilt}\n")).collect();
    format!(
        "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n{n}\nITEM: BOX BOUNDS {flags}\n{bounds}ITEM: ATOMS {columns}\n{rows}"
    )
}

#[test]
fn dumps_of_lammps_have_steps_and_a_box() {
    let dump = step("pp pp pp", "id type x y z", "1 1 0.5 0.25 0\n2 2 -0.5 1.5 0\n")
        + &step("pp pp pp", "id type x y z", "2 2 0 1 0\n");
    let typed = TypedColumns { columns: Some("x,y"), class: Some("type"), ..NONE };
    let sets = read_typed("a.dump", &dump, typed).unwrap();
    assert_eq!(said(&sets[0]), (&[0.5, 0.25, -0.5, 1.5][..], "x,y".into(), "id,z".into(), "LAMMPS dump"));
    assert_eq!((sets.len(), sets[0].labels.join(","), &sets[1].reading.apart), (2, "1,2".into(), &Apart::Frames));
    assert!(sets[0].points.place(1).ends_with("a.dump:11"));
    // Fractions of the box, unwrapped coordinates; x itself goes before both.
    for (columns, rows, expected, named) in [
        ("id xs ys zs", "1 0.25 0.5 0.5\n", [0.0, 1.0, 0.0], "xs,ys,zs"),
        ("id xsu ysu zsu", "1 1.25 0.5 0.5\n", [4.0, 1.0, 0.0], "xsu,ysu,zsu"),
        ("id xu yu zu", "1 9 8 7\n", [9.0, 8.0, 7.0], "xu,yu,zu"),
        ("id xs ys zs x y z", "1 0.25 0.5 0.5 1 2 3\n", [1.0, 2.0, 3.0], "x,y,z"),
    ] {
        let set = one("a.lammpstrj", step("pp pp pp", columns, rows), NONE);
        assert_eq!(
            (&set.points.coordinates[..], set.reading.columns.join(",")),
            (&expected[..], named.into()),
            "{columns}"
        );
    }
    let stated = |text: String, columns| {
        let typed = TypedColumns { columns, ..NONE };
        read_typed("a.dump", text, typed).unwrap().remove(0).reading.stated.clone()
    };
    let rows = "1 0 0 0\n";
    assert!(matches!(stated(step("pp pp pp", "id x y z", rows), None), Some(Ok(_))));
    assert_eq!(stated(step("pp pp pp", "id x y vz", rows), Some("x,vz")), None, "speeds are in no box");
    let Some(Err(said)) = stated(step("xy xz yz pp pp pp", "id x y z", rows), None) else { panic!("triclinic") };
    assert_eq!(said, "its box is triclinic (xy = 0.5); `window` gives the window they are in");
    for (text, reason) in [
        (
            step("xy xz yz pp pp pp", "id xs ys zs", rows),
            "a.dump:9: column xs holds fractions of a triclinic box (xy = 0.5), which are not read",
        ),
        (
            step("abc origin pp pp pp", "id x y z", rows),
            "a.dump:5: a general triclinic box (abc origin) is not read; write an orthogonal one",
        ),
        (
            step("pp pp pp", "id x y z", rows).replace("\n1\n", "\n2\n"),
            "a.dump:10: truncated: step 0 has 2 atoms by its number, and there are 1",
        ),
        (step("pp pp pp", "id x y z", "1 0 0\n"), "a.dump:10: 3 fields, expected 4: \"1 0 0\""),
        ("ITEM: TIMESTEP\n0\n".into(), "a.dump:2: a LAMMPS dump without ITEM: ATOMS"),
        (
            "ITEM: TIMESTEP\n0\nITEM: ENTRIES a b\n".into(),
            "a.dump:3: \"ITEM: ENTRIES a b\"; expected TIMESTEP, NUMBER OF ATOMS, BOX BOUNDS or ATOMS",
        ),
    ] {
        assert_eq!(read("a.dump", text).unwrap_err(), reason);
    }
}

#[test]
fn geojson_has_points_with_properties() {
    let feature = |geometry: &str, properties: &str| {
        format!("{{\"type\":\"Feature\",\"geometry\":{geometry},\"properties\":{properties}}}")
    };
    let all = |features: &[String]| format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", features.join(","));
    let point = |x: f64, y: f64| format!("{{\"type\":\"Point\",\"coordinates\":[{x},{y}]}}");
    let text = all(&[
        feature(&point(500.5, 400.25), "{\"species\":\"oak\",\"dbh\":3.5,\"plot\":1}"),
        feature(
            "{\"type\":\"MultiPoint\",\"coordinates\":[[1,2,9],[3,4]]}",
            "{\"species\":\"elm\",\"dbh\":1,\"plot\":2}",
        ),
        feature("null", "{}"),
    ]);
    let typed = TypedColumns { weight: Some("dbh"), class: Some("species"), ..NONE };
    let set = one("a.geojson", &text, typed);
    assert_eq!(said(&set), (&[500.5, 400.25, 1.0, 2.0, 3.0, 4.0][..], "x,y".into(), "plot".into(), "GeoJSON"));
    assert_eq!((&set.weights[..], set.labels.join(",")), (&[3.5, 1.0, 1.0][..], "oak,elm,elm".into()));
    let notes: Vec<_> = set.reading.notes.iter().map(|note| note.split("a.geojson: ").nth(1).unwrap()).collect();
    assert_eq!(notes, ["1 feature without a geometry left out", "1 point of 3 have a height, which was left out"]);
    let plots = read_typed("a.geojson", &text, TypedColumns { realization: Some("plot"), ..NONE }).unwrap();
    assert_eq!(plots.iter().map(|set| set.points.len()).collect::<Vec<_>>(), [1, 2]);
    // A property of the name x is none; heights are a coordinate where all have one.
    assert_eq!(one("a.json", feature(&point(1.0, 2.0), "{\"x\":7}"), NONE).points.coordinates, [1.0, 2.0]);
    let high = "{\"type\":\"MultiPoint\",\"coordinates\":[[1,2,9],[3,4,8]]}";
    let set = one("a.json", high, NONE);
    assert_eq!(set.points.coordinates, [1.0, 2.0, 9.0, 3.0, 4.0, 8.0]);
    assert!(set.reading.notes[0].contains("degrees of longitude and latitude"), "{:?}", set.reading.notes);
    let projected = high.replace("\"type\"", "\"crs\":{\"type\":\"name\"},\"type\"");
    assert!(one("a.json", projected, NONE).reading.notes.is_empty());
    for (text, reason) in [
        (
            all(&[feature("{\"type\":\"LineString\",\"coordinates\":[[1,2],[3,4]]}", "{}")]),
            "a.json, feature 0: is a LineString; expected a Point or a MultiPoint",
        ),
        (all(&[]), "a.json: no points"),
        (point(1.0, 2.0).replace(",2", ""), "a.json: "),
        (point(1.0, 2.0).replace('}', ""), "a.json: is no GeoJSON: "),
    ] {
        let error = read("a.json", text).unwrap_err();
        assert!(error.starts_with(reason), "{error}");
    }
    let typed = TypedColumns { weight: Some("species"), ..NONE };
    assert_eq!(
        read_typed("a.geojson", &text, typed).unwrap_err(),
        "a.geojson, point 0: \"oak\" is not a number; expected a number in column species"
    );
}

/// A file of two points with cells and data; version 5 has offsets of cells.
fn vtk(binary: bool, version: u32) -> Vec<u8> {
    let mut bytes = format!("# vtk DataFile Version {version}.0\ntitle\n").into_bytes();
    bytes.extend(if binary { &b"BINARY\n"[..] } else { b"ASCII\n" });
    let mut put = |line: &str, numbers: &[f64], kind: &str| {
        bytes.extend(line.bytes());
        bytes.push(b'\n');
        for (k, &x) in numbers.iter().enumerate() {
            match (binary, kind) {
                (false, _) => bytes.extend(format!("{}{x}", if k % 2 == 0 { "\n" } else { " " }).bytes()),
                (true, "float") => bytes.extend((x as f32).to_be_bytes()),
                (true, "long") => bytes.extend((x as i64).to_be_bytes()),
                (true, _) => bytes.extend((x as i32).to_be_bytes()),
            }
        }
        bytes.push(b'\n');
    };
    put("DATASET POLYDATA", &[], "");
    put("POINTS 2 float", &[0.5, 0.25, 0.0, 0.125, 1.5, 0.0], "float");
    put("METADATA\nINFORMATION 0\n", &[], "");
    if version < 5 {
        put("VERTICES 2 4", &[1.0, 0.0, 1.0, 1.0], "int");
    } else {
        put("VERTICES 3 2", &[], "");
        put("OFFSETS vtktypeint64", &[0.0, 1.0, 2.0], "long");
        put("CONNECTIVITY vtktypeint64", &[0.0, 1.0], "long");
    }
    put("CELL_DATA 2\nSCALARS kind int\nLOOKUP_TABLE default", &[5.0, 6.0], "int");
    put("POINT_DATA 2\nSCALARS mass float 1\nLOOKUP_TABLE default", &[2.0, 3.0], "float");
    put("FIELD more 2\nlabel 1 2 int", &[7.0, 8.0], "int");
    put("speed 2 2 float", &[1.0, 2.0, 3.0, 4.0], "float");
    put("VECTORS push float", &[0.0; 6], "float");
    bytes
}

#[test]
fn legacy_vtk_has_points_and_their_data() {
    for (binary, version, words) in [
        (false, 3, "VTK POLYDATA, ascii"),
        (true, 3, "VTK POLYDATA, binary"),
        (false, 5, "VTK POLYDATA, ascii"),
        (true, 5, "VTK POLYDATA, binary"),
    ] {
        let bytes = vtk(binary, version);
        let typed = TypedColumns { columns: Some("x,y"), weight: Some("mass"), class: Some("label"), ..NONE };
        let set = one("a.vtk", &bytes, typed);
        let rest = "z,speed[0],speed[1],push[0],push[1],push[2],vertices,data of cells";
        assert_eq!(said(&set), (&[0.5, 0.25, 0.125, 1.5][..], "x,y".into(), rest.into(), words));
        assert_eq!(
            (&set.weights[..], set.labels.join(","), set.reading.digits),
            (&[2.0, 3.0][..], "7,8".into(), binary.then_some(24))
        );
        assert_eq!(set.reading.notes, Vec::<String>::new());
        assert_eq!(read("a.vtk", &bytes).unwrap()[0].coordinates, [0.5, 0.25, 0.0, 0.125, 1.5, 0.0]);
    }
    let text = String::from_utf8(vtk(false, 3)).unwrap();
    for (from, to, reason) in [
        (
            "POLYDATA",
            "STRUCTURED_POINTS",
            "a.vtk:4: \"DATASET STRUCTURED_POINTS\"; expected DATASET POLYDATA or UNSTRUCTURED_GRID",
        ),
        (
            "POINTS 2 float",
            "POINTS 99999999999999999999 float",
            "a.vtk:6: \"POINTS 99999999999999999999 float\" is not understood",
        ),
        ("POINTS 2 float", "POINTS 5 float", "a.vtk:11: \"METADATA\" is not a number"),
        ("POINTS 2 float", "POINTS 2 strings", "a.vtk:6: \"POINTS 2 strings\" is not understood"),
        ("ASCII", "TEXT", "a.vtk:3: \"TEXT\"; expected ASCII or BINARY"),
    ] {
        assert_eq!(read("a.vtk", text.replacen(from, to, 1)).unwrap_err(), reason);
    }
    let mut cut = vtk(true, 3);
    cut.truncate(90);
    assert!(read("a.vtk", cut).unwrap_err().contains("truncated: 6 numbers by the header"));
    // What is not known behind the points ends what is read, with a word.
    let set = one("a.vtk", text.replace("FIELD more 2", "STRINGS more 2"), NONE);
    assert!(set.reading.notes[0].ends_with("a.vtk: STRINGS and what follows it was not read: no data that are known"));
}

/// Each is known by its content.
#[test]
fn names_do_not_matter() {
    let xyz = "1\nhere\nAr 0.5 0.25 0\n";
    for bytes in [ply("ascii"), vtk(true, 3), xyz.into(), step("pp pp pp", "x y", "0 0\n").into_bytes()] {
        for name in ["a.csv", "points", "a.dat"] {
            read(name, &bytes).unwrap();
        }
    }
    // A mark, and UTF-16, hide nothing.
    let marked = ["\u{feff}", xyz].concat();
    assert_eq!(read("a.xyz", &marked).unwrap()[0].coordinates, [0.5, 0.25, 0.0]);
    let wide: Vec<u8> = marked.encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(read("a.xyz", wide).unwrap()[0].coordinates, [0.5, 0.25, 0.0]);
}
