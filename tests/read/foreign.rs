//! Formats of other trades: each is named in one sentence, by its content whatever its name.

use crate::shared::{read, zipped};

#[test]
fn formats_of_other_trades_are_named() {
    let pdb = "HEADER    A\nATOM      1  N   ALA A   1      11.104   6.134  -6.504  1.00  0.00           N\n";
    let gro =
        "water\n    2\n    1SOL     OW    1   0.126   1.624   1.679\n    1SOL    HW1    2   0.190   1.661   1.747\n";
    let poscar = "Si\n1.0\n5 0 0\n0 5 0\n0 0 5\nSi\n2\nDirect\n0 0 0\n0.25 0.25 0.25\n";
    let table: &[(&str, &[u8])] = &[
        ("HDF5", b"\x89HDF\r\n\x1a\n\0\0\0\0\0\x08\x08\0"),
        ("FITS", b"SIMPLE  =                    T / conforms to FITS standard"),
        ("Parquet", b"PAR1\x15\0\x15\0"),
        ("Arrow (Feather)", b"ARROW1\0\0"),
        ("LAS or LAZ", b"LASF\0\0\0\0"),
        ("GSD", b"\xdf\x65\xdf\x65\xdf\x65\xdf\x65\0\0"),
        ("XTC", b"\0\0\x07\xcb\0\0\0\x0a"),
        ("DCD", b"\x54\0\0\0CORD\0\0"),
        ("a MATLAB .mat file", b"MATLAB 5.0 MAT-file, Platform: GLNXA64\0\0"),
        ("a shapefile", b"\0\0\x27\x0a\0\0\0\0"),
        ("Excel .xls", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1\0\0"),
        ("SQLite (GeoPackage)", b"SQLite format 3\0"),
        ("NetCDF", b"CDF\x02\0\0"),
        ("R's .rds", b"X\n\0\0\0\x03"),
        ("a PNG picture", b"\x89PNG\r\n\x1a\n\0\0"),
        ("a TIFF picture", b"II*\0\x08\0"),
        ("PCD", b"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\n"),
        ("PCD", b"VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nVIEWPOINT 0 0 0 1 0 0 0\nDATA ascii\n1 2 3\n"),
        ("VTK (XML)", b"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">\n"),
        ("KML", b"<?xml version=\"1.0\"?>\n<kml xmlns=\"\">\n"),
        ("TopoJSON", b"{\"type\": \"Topology\", \"objects\": {\"type\": \"FeatureCollection\"}}"),
        ("JSON", b"[[0.1, 0.2], [0.3, 0.4]]"),
        ("JSON", b"[\n  [0.1, 0.2],\n  [0.3, 0.4]\n]\n"),
        ("JSON", b"{\"x\": [0.1], \"y\": [0.2]}"),
        ("a LAMMPS data file", b"LAMMPS data file\n\n2 atoms\n1 atom types\n\n0 1 xlo xhi\n0 1 ylo yhi\n"),
        ("PDB", pdb.as_bytes()),
        ("GRO", gro.as_bytes()),
        ("CIF", b"data_x\n_cell_length_a 5\nloop_\n"),
        ("POSCAR (VASP)", poscar.as_bytes()),
        ("OBJ", b"# cube\nv 0.1 0.2 0.3\nv 0.4 0.5 0.6\n"),
        ("WKT", b"MULTIPOINT ((0.1 0.2), (0.3 0.4))\n"),
        ("compressed with xz", b"\xfd7zXZ\0\0\0"),
    ];
    for (format, bytes) in table {
        // Some builds read them.
        if cfg!(feature = "tables") && ["Parquet", "Arrow (Feather)"].contains(format) {
            continue;
        }
        for name in ["a.xyz", "a.csv", "points"] {
            let said = read(name, bytes).unwrap_err();
            assert!(said.starts_with(&format!("{name}: {format}, which is not read here; ")), "{format}: {said}");
            assert_eq!(said.lines().count(), 1, "{said}");
        }
    }
    // A mark and UTF-16 hide nothing.
    let wide: Vec<u8> = "\u{feff}{\"type\": \"Point\"}".encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert!(read("a.json", wide).unwrap_err().starts_with("a.json: JSON, "));
    let sheet = zipped(&[("[Content_Types].xml", b"x"), ("xl/workbook.xml", b"x")], zip::CompressionMethod::Stored);
    assert!(
        read("a.xlsx", sheet).unwrap_err().starts_with("a.xlsx: an Excel workbook (.xlsx), which is not read here; ")
    );
    // What only its name tells.
    assert!(read("a.dbf", b"\x03\x7c\x01\x01\0\0").unwrap_err().starts_with("a.dbf: a part of a shapefile, "));
}

/// Plain points of a name or with a first line that others have too.
#[test]
fn points_are_not_taken_for_another_trade() {
    for text in ["0.1 0.2 0.3\n0.4 0.5 0.6\n", "2\n0.1 0.2 0.3\n0.4 0.5 0.6\n", "x y z\n0.1 0.2 0.3\n0.4 0.5 0.6\n"] {
        let sets = read("a.xyz", text).unwrap();
        assert_eq!(sets[0].coordinates, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], "{text}");
    }
}
