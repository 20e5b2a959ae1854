//! What is fuzzed: each takes bytes that may be anything. None may panic, hang, or take memory that the bytes do not account for. The
//! tests replay the corpus through the same functions (`tests/read/replay.rs`).

use std::path::Path;

use pairwave::analysis::Measurement;
use pairwave::integrand::Integrand;
use pairwave::points::Domain;
use pairwave::points::read::polygon_of_bytes;
use pairwave::report::Plot;
use pairwave::request::PointsRequest;
use pairwave::request::lists::frequencies_of_bytes;
use pairwave::source::Points;

/// A target: what it is called, which is its folder of the corpus, and what it does with bytes.
pub type Target = (&'static str, fn(&[u8]));

/// All of them.
pub const TARGETS: &[Target] = &[
    ("points_text", |bytes| points("a.csv", bytes)),
    ("points_npy", |bytes| points("a.npy", bytes)),
    ("points_npz", |bytes| points("a.npz", bytes)),
    ("points_raw", |bytes| points("a.rps", bytes)),
    ("points_ply", |bytes| points("a.ply", bytes)),
    ("points_xyz", |bytes| points("a.xyz", bytes)),
    ("points_lammps", |bytes| points("a.dump", bytes)),
    ("points_geojson", |bytes| points("a.geojson", bytes)),
    ("points_vtk", |bytes| points("a.vtk", bytes)),
    // Read with the feature `tables`, named and refused without it.
    ("points_parquet", |bytes| points("a.parquet", bytes)),
    ("polygon", polygon),
    ("frequencies", frequencies),
    ("sums", sums),
    ("results", results),
    ("integrand", integrand),
    ("pictures", pictures),
];

/// Does what the target of a name does.
#[allow(dead_code, reason = "not all that include this use it")]
pub fn run(name: &str, bytes: &[u8]) {
    if let Some((_, target)) = TARGETS.iter().find(|(known, _)| *known == name) {
        target(bytes);
    }
}

/// Points, with the columns that the last byte chooses.
fn points(name: &str, bytes: &[u8]) {
    let some = |text: &str| Some(text.to_string());
    let input = PointsRequest { wrap: true, ..PointsRequest::default() };
    _ = Points::from_bytes(name, bytes, &input);
    let input = match bytes.last().map_or(0, |b| b % 4) {
        0 => PointsRequest { weight_column: some("3"), ..input },
        1 => PointsRequest { columns: some("2,1"), class_column: some("3"), wrap: false, ..input },
        2 => PointsRequest { realization_column: some("1"), ..input },
        _ => PointsRequest { window: Some(vec![0.0, 1.0, 0.0, 2.0]), columns: some("x,y"), wrap: false, ..input },
    };
    _ = Points::from_bytes(name, bytes, &input);
}

/// Outlines of windows: WKT, GeoJSON, vertices.
fn polygon(bytes: &[u8]) {
    _ = polygon_of_bytes(Path::new("a.wkt"), bytes);
}

/// Lists of wave vectors.
fn frequencies(bytes: &[u8]) {
    _ = frequencies_of_bytes(Path::new("a.txt"), bytes, &Domain::unit_torus(2));
    if let Ok(window) = Domain::window(&[(0.0, 3.0)]) {
        _ = frequencies_of_bytes(Path::new("a.txt"), bytes, &window);
    }
}

/// Sums, with a checksum that fits: what is behind it would be seldom reached.
fn sums(bytes: &[u8]) {
    _ = Measurement::read("a.sums", bytes);
    if let Some(end) = bytes.len().checked_sub(16) {
        let mut whole = bytes[..end].to_vec();
        whole.extend(xxhash_rust::xxh3::xxh3_128(&whole).to_le_bytes());
        _ = Measurement::read("a.sums", &whole);
    }
}

/// Tables of a result, as `plot` reads them: the summary up to a 0 byte, then g and the radial mean of P.
fn results(bytes: &[u8]) {
    let Ok(dir) = tempfile::tempdir() else { return };
    let mut parts = bytes.splitn(3, |&b| b == 0);
    for name in ["summary.json", "pcf.csv", "spectrum_radial.csv"] {
        if let Some(part) = parts.next() {
            _ = std::fs::write(dir.path().join(name), part);
        }
    }
    let plot = Plot { results: vec![dir.path().into()], size: "60x40mm".into(), ..Plot::default() };
    _ = plot.draw(&dir.path().join("out"), false);
}

/// Specifications and formulas, in the dimension of the first byte.
fn integrand(bytes: &[u8]) {
    let Some((dim, spec)) = bytes.split_first() else { return };
    let Ok(spec) = std::str::from_utf8(spec) else { return };
    // A file that a specification names is none of the input.
    if !spec.contains("file") {
        _ = Integrand::new(spec, usize::from(dim % 3) + 1);
    }
}

/// Pictures and tables that are integrands.
fn pictures(bytes: &[u8]) {
    let Ok(file) = tempfile::NamedTempFile::new() else { return };
    if std::fs::write(file.path(), bytes).is_ok() {
        for kind in ["image", "table"] {
            _ = Integrand::new(&format!("{kind}:file={}", file.path().display()), 2);
        }
    }
}
