//! Formats of other trades that are not read: each is named, with what to convert it to. By content; by name only where the
//! content says nothing.

use super::text::Lines;

/// A format: its name, and what writes what can be read.
type Named = (&'static str, &'static str);

const CSV: &str = "export the coordinates as CSV with a header x,y[,z]";
const NUMPY: &str = "save the coordinates with numpy as .npy, shape (n, d)";
const TABLE: &str = "save the sheet as CSV";
const PANDAS: &str = "write the columns as CSV with pandas";
/// Of what some builds read.
const TABLES: &str = "build pairwave with `--features tables`, or write the columns as CSV with pandas";
const GIS: &str = "export the points as CSV with a GIS, in metres (ogr2ogr -f CSV -lco GEOMETRY=AS_XY)";
const CLOUD: &str = "export the points as text x y z with CloudCompare or a converter of point clouds";
const ATOMS: &str = "save the positions with MDAnalysis or ASE and numpy as .npy, shape (K, n, d)";
const OVITO: &str = "write the positions as CSV with a header x,y,z, or with OVITO and numpy as .npy, shape (K, n, d)";
const PICTURE: &str = "find the points in it first, and write their coordinates as CSV with a header x,y";
const UNPACK: &str = "unpack it first";
const SCAN: &str = "give it alone, as the files it stands for, to analyze or integrate";

/// What files begin with.
const MAGICS: [(&[u8], Named); 55] = [
    (b"\x89HDF\r\n\x1a\n", ("HDF5", "save the dataset with h5py and numpy as .npy, shape (n, d)")),
    (b"\x0e\x03\x13\x01", ("HDF4", NUMPY)),
    (b"MATLAB 7.3 MAT-file", ("a MATLAB .mat file", "save the matrix as CSV (writematrix)")),
    (b"MATLAB 5.0 MAT-file", ("a MATLAB .mat file", "save the matrix as CSV (writematrix)")),
    (b"CDF\x01", ("NetCDF", NUMPY)),
    (b"CDF\x02", ("NetCDF", NUMPY)),
    (b"CDF\x05", ("NetCDF", NUMPY)),
    (b"SIMPLE  =", ("FITS", "write the columns as CSV with astropy")),
    (b"XTENSION=", ("FITS", "write the columns as CSV with astropy")),
    (b"PAR1", ("Parquet", TABLES)),
    (b"PARE", ("encrypted Parquet", PANDAS)),
    (b"ARROW1", ("Arrow (Feather)", TABLES)),
    (b"FEA1", ("Feather", PANDAS)),
    (b"ORC", ("ORC", PANDAS)),
    (b"Obj\x01", ("Avro", PANDAS)),
    (b"LASF", ("LAS or LAZ", "write text x y z with PDAL or las2txt")),
    (b"# .PCD", ("PCD", CLOUD)),
    (b"ASTM-E57", ("E57", CLOUD)),
    (b"glTF", ("glTF", CLOUD)),
    (
        b"\xdf\x65\xdf\x65\xdf\x65\xdf\x65",
        ("GSD", "save the positions with the Python package gsd and numpy as .npy, shape (K, n, d)"),
    ),
    (b"\x00\x00\x07\xcb", ("XTC", ATOMS)),
    (b"\x00\x00\x07\xc9", ("TRR", ATOMS)),
    (b"\x54\x00\x00\x00CORD", ("DCD", ATOMS)),
    (b"\x00\x00\x00\x54CORD", ("DCD", ATOMS)),
    (b"\x54\x00\x00\x00VELD", ("DCD", ATOMS)),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", ("Excel .xls", TABLE)),
    (b"\x00\x00\x27\x0a", ("a shapefile", GIS)),
    (b"SQLite format 3\0", ("SQLite (GeoPackage)", GIS)),
    (b"fgb\x03", ("FlatGeobuf", GIS)),
    (b"RDX2\n", ("R's .RData", "write.csv the coordinates in R")),
    (b"RDX3\n", ("R's .RData", "write.csv the coordinates in R")),
    (b"RDA2\n", ("R's .RData", "write.csv the coordinates in R")),
    (b"RDA3\n", ("R's .RData", "write.csv the coordinates in R")),
    (b"X\n\0\0\0", ("R's .rds", "write.csv the coordinates in R")),
    (b"root", ("ROOT", "save the columns with uproot and numpy as .npy, shape (n, d)")),
    (b"\x80\x02}", ("a Python pickle", NUMPY)),
    (b"\x80\x03", ("a Python pickle", NUMPY)),
    (b"\x80\x04\x95", ("a Python pickle", NUMPY)),
    (b"\x80\x05\x95", ("a Python pickle", NUMPY)),
    (b"\x89PNG", ("a PNG picture", PICTURE)),
    (b"\xff\xd8\xff", ("a JPEG picture", PICTURE)),
    (b"GIF8", ("a GIF picture", PICTURE)),
    (b"II*\0", ("a TIFF picture", PICTURE)),
    (b"MM\0*", ("a TIFF picture", PICTURE)),
    (b"II+\0", ("a TIFF picture", PICTURE)),
    (b"%PDF", ("PDF", CSV)),
    (b"{\\rtf", ("RTF", "save it as plain text")),
    (b"\x1f\x8b", ("compressed with gzip", UNPACK)),
    (b"BZh", ("compressed with bzip2", UNPACK)),
    (b"\xfd7zXZ\0", ("compressed with xz", UNPACK)),
    (b"\x28\xb5\x2f\xfd", ("compressed with zstd", UNPACK)),
    (b"7z\xbc\xaf", ("a 7z archive", UNPACK)),
    (b"Rar!", ("a RAR archive", UNPACK)),
    (b"%%MatrixMarket", ("Matrix Market", CSV)),
    (b"NRRD000", ("NRRD", PICTURE)),
];

/// What names end in, where the content is no text and says nothing.
const ENDS: [(&[&str], Named); 9] = [
    (&["dbf", "shx", "prj", "cpg"], ("a part of a shapefile", GIS)),
    (&["mat"], ("a MATLAB .mat file", "save the matrix as CSV (writematrix)")),
    (&["h5", "hdf5", "hdf"], ("HDF5", NUMPY)),
    (&["dcd", "xtc", "trr", "tng", "nc"], ("a trajectory", ATOMS)),
    (&["pkl", "pickle", "pt", "pth"], ("a Python pickle", NUMPY)),
    (&["rds", "rdata", "rda"], ("a file of R", "write.csv the coordinates in R")),
    (&["xlsb", "numbers"], ("a spreadsheet", TABLE)),
    (&["sav", "dta", "sas7bdat"], ("a table of a statistics program", TABLE)),
    (&["stl"], ("STL", CLOUD)),
];

/// `a PLY file is not read here: export ...`, in one sentence.
fn sentence((format, convert): Named) -> String {
    format!("{format}, which is not read here; {convert}")
}

/// What a file is, if it is of another trade.
pub(super) fn named(bytes: &[u8], extension: &str) -> Option<String> {
    let compressed_r = bytes.starts_with(b"\x1f\x8b") && ["rds", "rdata", "rda"].contains(&extension);
    let by_start = || MAGICS.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, named)| *named);
    let far = || {
        // A tar archive, DICOM and a MAT file of version 7.3 say it later on.
        (bytes.get(257..262) == Some(b"ustar")).then_some(("a tar archive", UNPACK))
    };
    let binary = || ENDS.iter().find(|(ends, _)| ends.contains(&extension)).map(|(_, named)| *named);
    if compressed_r {
        return binary().map(sentence);
    }
    if let Some(found) = by_start().or_else(far) {
        return Some(sentence(found));
    }
    if !super::text::is_text(bytes) {
        return binary().map(sentence);
    }
    text(bytes).map(sentence)
}

/// What a zip archive with these entries is, if it is none of arrays.
pub(super) fn named_archive(entries: &[String]) -> Option<String> {
    let any = |what: &str| entries.iter().any(|entry| entry.contains(what));
    let ends = |end: &str| entries.iter().any(|entry| entry.to_ascii_lowercase().ends_with(end));
    let found = if any("xl/workbook") || (any("[Content_Types].xml") && any("xl/")) {
        ("an Excel workbook (.xlsx)", TABLE)
    } else if any("word/document.xml") {
        ("a Word document", CSV)
    } else if any("mimetype") && any("content.xml") {
        ("an OpenDocument sheet (.ods)", TABLE)
    } else if ends(".shp") {
        ("a shapefile in a zip archive", GIS)
    } else if ends(".kml") {
        ("KMZ", GIS)
    } else if ends("/data.pkl") || ends("data.pkl") {
        ("a file of PyTorch", NUMPY)
    } else if ends(".zarray") || ends(".zgroup") || ends("zarr.json") {
        ("Zarr in a zip archive", NUMPY)
    } else if ends(".csv") || ends(".txt") || ends(".dat") {
        ("a zip archive of text files", UNPACK)
    } else {
        return None;
    };
    Some(sentence(found))
}

/// So many bytes of a text are looked at.
const HEAD: usize = 1 << 13;

/// Formats that are text.
fn text(bytes: &[u8]) -> Option<Named> {
    let head = &bytes[..bytes.len().min(HEAD)];
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let head = String::from_utf8_lossy(head);
    // Lines that may be blank, and those that are not.
    let all: Vec<String> = Lines(head.as_bytes()).map(|line| String::from_utf8_lossy(line).into_owned()).collect();
    let lines: Vec<&str> = all.iter().map(|line| line.trim()).filter(|line| !line.is_empty()).collect();
    let first = *lines.first()?;
    let starts = |word: &str| first.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word));
    let any = |word: &str| lines.iter().any(|line| line.starts_with(word));
    if starts("<") {
        return Some(markup(&head));
    }
    if first.starts_with('{') || first.starts_with('[') {
        if first.starts_with("{\"pairwave_scan\":") {
            return Some(("a scan of pairwave", SCAN));
        }
        // A header may begin with a bracket; an array of numbers closes none before the next opens.
        let json = first.starts_with('{')
            || first[1..].trim_start().starts_with(['[', '{', '"', '-'])
            || lines.len() == 1
            || first == "["
            || first[1..].trim_start().starts_with(|c: char| c.is_ascii_digit());
        return json.then_some(if head.contains("\"Topology\"") { ("TopoJSON", GIS) } else { ("JSON", PANDAS) });
    }
    if let Some(found) = molecules(&lines, &all) {
        return Some(found);
    }
    let pcd = lines.iter().any(|l| l.starts_with("FIELDS ")) && lines.iter().any(|l| l.starts_with("VIEWPOINT "));
    if pcd {
        return Some(("PCD", CLOUD));
    }
    let words = |text: &str| text.split_whitespace().map(str::to_string).collect::<Vec<_>>();
    let vertex = |line: &&&str| {
        let words = words(line);
        words[0] == "v" && words.len() > 3 && words[1].parse::<f64>().is_ok()
    };
    if ["mtllib ", "o ", "g ", "vn ", "v "].iter().any(|word| any(word)) && lines.iter().any(|line| vertex(&line)) {
        return Some(("OBJ", CLOUD));
    }
    if starts("solid") && any("facet ") {
        return Some(("STL", CLOUD));
    }
    if ["OFF", "COFF", "NOFF"].contains(&first) {
        return Some(("OFF", CLOUD));
    }
    let wkt = ["POINT", "MULTIPOINT", "SRID=", "LINESTRING", "POLYGON", "GEOMETRYCOLLECTION"];
    if wkt.iter().any(|word| starts(word)) && (first.contains('(') || any("POINT (") || any("POINT(")) {
        return Some(("WKT", GIS));
    }
    if lines
        .iter()
        .skip(1)
        .take(3)
        .any(|line| ["POINT (", "POINT(", "\"POINT (", "\"POINT("].iter().any(|p| line.contains(p)))
    {
        return Some(("a table with WKT geometry", GIS));
    }
    if starts("@relation") {
        return Some(("ARFF", CSV));
    }
    if starts("TITLE") && first.contains('=') || starts("VARIABLES") && first.contains('=') {
        return Some(("Tecplot", CSV));
    }
    if first == "---" || starts("%YAML") {
        return Some(("YAML", CSV));
    }
    if starts("structure(") || starts("list(") || starts("c(") {
        return Some(("code of R", "write.csv the coordinates in R"));
    }
    if starts("HDR ") || starts("ncols ") && any("nrows ") {
        return Some(("an ASCII grid", PICTURE));
    }
    None
}

fn markup(head: &str) -> Named {
    let tags: [(&str, Named); 12] = [
        ("<VTKFile", ("VTK (XML)", "save the points as CSV with ParaView")),
        ("<Xdmf", ("XDMF", "save the points as CSV with ParaView")),
        ("<kml", ("KML", GIS)),
        ("<gpx", ("GPX", GIS)),
        ("<gml", ("GML", GIS)),
        ("<VOTABLE", ("VOTable", "write the columns as CSV with astropy")),
        ("<TrackMate", ("TrackMate (XML)", "export the spots as CSV")),
        ("<CellCounter_Marker_File", ("Cell Counter (XML)", "export the markers as CSV")),
        ("<svg", ("SVG", CSV)),
        ("<html", ("HTML", CSV)),
        ("<!DOCTYPE html", ("HTML", CSV)),
        ("<hoomd_xml", ("HOOMD XML", OVITO)),
    ];
    let lower = head.to_ascii_lowercase();
    let found = tags.iter().find(|(tag, _)| lower.contains(&tag.to_ascii_lowercase()));
    found.map_or(("XML", CSV), |(_, named)| *named)
}

/// Formats of molecules and atoms.
fn molecules(lines: &[&str], all: &[String]) -> Option<Named> {
    let first = *lines.first()?;
    let fields = |line: &str| line.split_whitespace().map(str::to_string).collect::<Vec<_>>();
    let number = |text: &String| text.parse::<f64>().is_ok();
    let whole = |text: &str| text.trim().parse::<u64>().is_ok();
    let numbers = |line: &str, n: usize| {
        let fields = fields(line);
        fields.len() == n && fields.iter().all(number)
    };
    let records = ["ATOM  ", "HETATM", "HEADER", "CRYST1", "REMARK", "MODEL ", "TITLE ", "COMPND"];
    let atoms = |line: &&&str| line.starts_with("ATOM  ") || line.starts_with("HETATM");
    if records.iter().any(|r| all.first().is_some_and(|l| l.starts_with(r))) && lines.iter().any(|l| atoms(&l)) {
        return Some(("PDB", ATOMS));
    }
    if first.starts_with("data_") && (lines.iter().any(|l| l.starts_with('_')) || lines.contains(&"loop_")) {
        return Some(("CIF", ATOMS));
    }
    let second = all.get(1).map_or("", String::as_str);
    let third = all.get(2).map(|line| fields(line)).unwrap_or_default();
    let numbered = third.len() >= 4 && third[..4].iter().all(number);
    let residue = all.get(2).and_then(|line| line.trim_start().split_once(|c: char| !c.is_ascii_digit()));
    if whole(second) && third.len() >= 5 && !numbered && residue.is_some_and(|(count, _)| !count.is_empty()) {
        return Some(("GRO", ATOMS));
    }
    let counts =
        |what: &str| lines.iter().any(|line| fields(line).get(1).is_some_and(|w| w == what) && whole(&fields(line)[0]));
    if counts("atoms") && lines.iter().any(|line| line.contains("xlo xhi")) {
        return Some(("a LAMMPS data file", OVITO));
    }
    let scale = all.get(1).is_some_and(|line| numbers(line, 1));
    let cell = all.len() > 7 && all[2..5].iter().all(|line| numbers(line, 3));
    let kind = |line: &String| {
        ["direct", "cartesian", "selective"].iter().any(|k| line.trim().to_ascii_lowercase().starts_with(k))
    };
    if scale && cell && all[5..all.len().min(9)].iter().any(kind) {
        return Some(("POSCAR (VASP)", ATOMS));
    }
    let trajectory = ["timestep ", "timestep"];
    (trajectory.contains(&first) && lines.len() > 2).then_some(("a DL_POLY trajectory", ATOMS))
}
