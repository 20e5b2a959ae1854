//! Windows that are polygons, from files.

use crate::shared::{Scratch, column, csv, summary};

const POINTS: &str = "x,y\n0.1,0.2\n0.3,1.9\n0.5,0.5\n1.7,0.25\n1,1\n0.9,1.4\n2,0\n1.2,0.7\n0.4,1.1\n1.5,1\n";

/// The same outline in every format, closed or not, in either direction.
#[test]
fn every_format_is_the_same_window() {
    let scratch = Scratch::new();
    scratch.file("points.csv", POINTS);
    let json = r#"{"type":"Polygon","coordinates":[[[0,0],[2,0],[2,1],[1,1],[1,2],[0,2],[0,0]]]}"#;
    let feature = format!(r#"{{"type":"Feature","properties":{{}},"geometry":{json}}}"#);
    let files = [
        ("a.wkt", "POLYGON ((0 0, 2 0, 2 1, 1 1, 1 2, 0 2, 0 0))".to_string()),
        ("b.wkt", "MULTIPOLYGON Z (((0 0 5, 0 2 5, 1 2 5, 1 1 5, 2 1 5, 2 0 5)))".into()),
        ("c.json", json.into()),
        ("d.geojson", feature.clone()),
        ("e.geojson", format!(r#"{{"type":"FeatureCollection","crs":{{}},"features":[{feature}]}}"#)),
        ("f.txt", "0 0\n2 0\n2 1\n1 1\n1 2\n0 2\n".into()),
        ("g.csv", "Easting;Northing\n0;0\n0;2\n1;2\n1;1\n2;1\n2,0;0\n0;0\n".into()),
    ];
    let mut first: Option<String> = None;
    for (name, text) in files {
        scratch.file(name, &text);
        let line = format!(
            "analyze points.csv --window-polygon {name} --stats pcf,k-function,neighbors --device cpu --out {name}.out"
        );
        let said = scratch.ok(&line);
        assert!(said.contains("polygon of 6 vertices in [0, 2] x [0, 2]"), "{name}: {said}");
        let dir = scratch.path(&format!("{name}.out"));
        let json = summary(&dir);
        assert_eq!(
            (&json["domain"]["measure"], json["domain"]["polygon"][0][0].as_array().unwrap().len()),
            (&3.0.into(), 6)
        );
        let degrees = json["warnings"].to_string().contains("degrees of longitude and latitude");
        assert_eq!(degrees, ["c.json", "d.geojson"].contains(&name), "{name}");
        let k = std::fs::read_to_string(dir.join("k_function.csv")).unwrap();
        assert_eq!(&k, first.get_or_insert_with(|| k.clone()), "{name}");
        assert!(column::<f64>(&csv(&dir.join("k_function.csv")), "k").iter().all(|k| k.is_finite()));
        // The outline is drawn.
        let picture = std::fs::read_to_string(dir.join("points.svg")).unwrap();
        assert!(picture.matches('L').count() >= 5 && picture.contains("; polygon"), "{name}");
    }
}

/// What is not there in a polygon is left out of the default with a word, and simulations for envelopes stay inside.
#[test]
fn the_default_and_envelopes_know_of_polygons() {
    let scratch = Scratch::new();
    scratch.file("points.csv", POINTS);
    scratch.file("l.wkt", "POLYGON ((0 0, 2 0, 2 1, 1 1, 1 2, 0 2, 0 0))");
    scratch.ok("analyze points.csv --window-polygon l.wkt --device cpu --envelope 19 --out out");
    let json = summary(&scratch.path("out"));
    assert!(json["warnings"].to_string().contains("the spectrum is not measured"));
    assert!(json["spectrum"].is_null() && !scratch.path("out/spectrum_radial.csv").exists());
    assert!(scratch.path("out/envelope.csv").exists() && scratch.path("out/pcf.csv").exists());
    let plan = scratch.ok("analyze points.csv --window-polygon l.wkt --device cpu --explain");
    for fact in
        ["skipped: spectrum (not available in a polygon)", "by the 6 sides of the polygon", "are in the polygon"]
    {
        assert!(plan.contains(fact), "{fact} is missing from\n{plan}");
    }
    // A box in a file is a box.
    scratch.file("box.wkt", "POLYGON ((0 0, 0 2, 2 2, 2 0))");
    let plan = scratch.ok("analyze points.csv --window-polygon box.wkt --device cpu --explain");
    assert!(plan.contains("window [0, 2] x [0, 2]") && plan.contains("wave_power"), "{plan}");
}
