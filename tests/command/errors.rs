//! What is said when it is wrong.

use crate::shared::Scratch;

/// Every kind of wrong request or input, with its exact message and exit code. Nothing is written.
#[test]
fn errors_name_the_flag_the_value_and_what_would_be_right() {
    let scratch = Scratch::new();
    scratch.file("ok.csv", "x,y\n0.1,0.2\n0.3,0.9\n0.5,0.5\n");
    scratch.file("one-more.csv", "x,y\n0.1,0.3\n0.3,0.7\n");
    scratch.file("one.csv", "0.1 0.2\n");
    scratch.file("outside.txt", "0.1 0.2\n1.5 0.2\n");
    scratch.file("edge.txt", "0.1 0.2\n1 0.2\n");
    scratch.file("index.txt", "0 0.1 0.2\n1 0.3 0.9\n2 0.5 0.5\n3 0.7 0.1\n");
    scratch.file("hole.csv", "x,y\n0.1,0.2\n,\n0.3,0.9\n");
    scratch.file("atoms.cif", "data_x\n_cell_length_a 5\nloop_\n");
    scratch.file("kx.csv", "kx,ky\n6.28,0\n");
    scratch.file("nu.csv", "nu_x,nu_y\n1,0\n");
    scratch.file("yz.csv", "m_y,m_z\n1,0\n");
    scratch.file("kx.txt", "# by hand\n# kx ky\n# done\n6.28 0\n");
    scratch.file("nu.txt", "# nu_x nu_y\n1 0\n");
    scratch.file("m.txt", "# m_x m_y\n1 0\n");
    scratch.file("id-kx.csv", "id,kx,ky\n1,6.28,0\n");
    scratch.file("id-ab.csv", "id,a,b\n1,6.28,0\n");
    scratch.file("far.csv", "nu_x,nu_y\n0.5,0\n0,3000000000\n");
    scratch.file("commas.csv", "x\n0,5\n0,7\n");
    scratch.file("commas2.csv", "x,y\n1,5,3\n2,5,4\n\n");
    scratch.file("commas3.csv", "x,y\n0.5,3,4\n");
    scratch.file("class.txt", "x y\noak 0.1 0.2\nelm 0.3 0.9\noak 0.5 0.5\n");
    scratch.file("frame.txt", "x y\n1 0.1 0.2\n1 0.3 0.9\n2 0.5 0.5\n");
    scratch.file("late-name.txt", "x y\n1 0.1 0.2\n0.5 0.3 0.9\n");
    scratch.file("obs.csv", "a,b,obs\n0.1,0.2,1\n0.3,0.9,1\n");
    scratch.file("hole.txt", "0, 0.1,\n0.2,,0.3\n");
    scratch.file("edge-commas.txt", "0\n0,05;0,1\n");
    scratch.file("edge-commas2.txt", "# r\n0,05\n0,1\n");
    scratch.file("heavy.csv", "x,y,w\n0.1,0.2,1\n0.3,0.9,1e-30\n");
    scratch.file("endless.csv", "x,y,w\n0.1,0.2,inf\n0.3,0.9,1\n");
    scratch.file("box.wkt", "POLYGON ((0 0, 1 0, 1 1, 0 1, 0 0.5, 0 0))\n");
    scratch.file("half.wkt", "SRID=25832;POLYGON ((0 0, 0.4 0, 0.4 1, 0 1, 0 0.5))\n");
    scratch.file("bow.wkt", "POLYGON ((0 0, 1 1, 1 0, 0 1, 0 0))\n");
    scratch.file("two.wkt", "POLYGON ((0 0, 1 1, 1 1, 0 0))\n");
    scratch.file("flat.wkt", "POLYGON ((0 0, 1 1, 2 2, 0 0))\n");
    scratch.file("out.wkt", "POLYGON ((0 0, 1 0, 1 1, 0 1), (2 2, 3 2, 3 3, 2 3))\n");
    scratch.file("in.wkt", "POLYGON ((0 0, 9 0, 9 9, 0 9), (1 1, 5 1, 5 5, 1 5), (2 2, 3 2, 3 3))\n");
    scratch.file("cross.wkt", "POLYGON ((0 0, 1 0, 1 1, 0 1), (0.5 0.5, 2 0.5, 2 0.6, 0.5 0.6))\n");
    scratch.file("over.wkt", "MULTIPOLYGON (((0 0, 1 0, 1 1, 0 1)), ((0.2 0.2, 0.4 0.2, 0.4 0.4)))\n");
    scratch.file("touch.wkt", "MULTIPOLYGON (((0 0, 1 0, 1 1, 0 1)), ((1 0, 2 0, 2 1, 1 1)))\n");
    scratch.file("spike.wkt", "POLYGON ((0 0, 1 0, 2 0, 1 0, 1 1, 0 1))\n");
    scratch.file("point.wkt", "POINT (1 2)\n");
    scratch.file("empty.wkt", "POLYGON EMPTY\n");
    scratch.file("word.wkt", "POLYGON ((0 0, 1 0, 1 x))\n");
    scratch.file("large.wkt", "POLYGON ((0 0, 1e200 0, 1 1))\n");
    scratch.file("none.json", r#"{"type":"FeatureCollection","features":[]}"#);
    scratch.file("short.json", r#"{"type":"Polygon","coordinates":[[[0,0],[1],[1,1]]]}"#);
    scratch.file("line.json", r#"{"type":"LineString","coordinates":[[0,0],[1,1]]}"#);
    scratch.file("broken.json", "{broken");
    scratch.file("xyz.txt", "0 0 1\n1 0 1\n1 1 1\n");
    std::fs::create_dir_all(scratch.path("nest/in")).unwrap();
    scratch.file("word.txt", "0.1 0.2\n0.3 abc\n");
    scratch.file("three.txt", "0.1 0.2 0.3\n0.4 0.5 0.6\n");
    scratch.file("edges.txt", "0 0.1 0.05\n");
    scratch.file("late.txt", "0.1 0.2\n");
    scratch.file("trees.csv", "x,y,kind,size\n0.1,0.2,oak,1\n0.3,0.9,elm,2\n0.5,0.5,fir,3\n");
    scratch.file("zero.csv", "x,y,size\n0.1,0.2,0\n0.3,0.9,0\n");
    scratch.file("words.txt", "0 0.1\nx\n");
    scratch.file("half.txt", "# m\n1 2\n0 1.5\n");
    scratch.file("huge.csv", "m_x,m_y\n3000000000,1\n");
    scratch.file("nothing.txt", "# m\n\n");
    scratch.file("five.txt", "5\n1 2\n");
    scratch.file("below.csv", "x,y,w\n0.1,0.2,1\n0.3,0.9,-0.5\n");
    let raw = |numbers: &[f64]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    std::fs::write(scratch.path("half.f64"), raw(&[1.0, 2.0, 1.5, 0.0])).unwrap();
    std::fs::write(scratch.path("odd.f64"), raw(&[1.0, 2.0, 3.0])).unwrap();
    std::fs::write(scratch.path("bytes"), [0, 1, 2, 255]).unwrap();
    std::fs::create_dir(scratch.path("taken")).unwrap();
    scratch.file("taken/summary.json", "{}");
    let table: &[(&str, i32, &str)] = &[
        (
            "convergence --sampler jittered -n 15,16 --integrand disk --device cpu",
            2,
            "-n 16: a slope needs two numbers of points; expected more, as in 2^4..2^12",
        ),
        (
            "convergence --sampler sobol --sampler sobol -n 4..16 --integrand disk --device cpu",
            2,
            "--sampler sobol: is given twice",
        ),
        (
            "convergence --sampler jittered --sampler sobol -n 4..16 --param r=3 --integrand disk --device cpu",
            2,
            "--param r=3: none of jittered, sobol has this parameter; expected key=value of one of them",
        ),
        (
            "convergence --sampler sobol -n 4..16 --device cpu",
            2,
            "--integrand (none): expected an integrand such as disk or box:x0=0.2,x1=0.7; `pairwave integrands` lists them",
        ),
        (
            "convergence ok.csv --integrand disk --device cpu",
            2,
            "FILES ok.csv: a slope needs two numbers of points; expected a file or folder of realizations for each, or --prefixes of one",
        ),
        (
            "convergence ok.csv ./ok.csv --integrand disk --device cpu",
            1,
            "./ok.csv: has 3 points per realization like ok.csv; expected one group of files for each number",
        ),
        (
            "convergence ok.csv --prefixes 2,4 --integrand disk --device cpu",
            2,
            "--prefixes 4: a realization has only 3 points",
        ),
        (
            "integrate --p nest --integrand disk",
            1,
            "nest: has no summary.json; expected a directory written by pairwave analyze --out, with its summary.json",
        ),
        (
            "integrate --p jittered --integrand disk",
            2,
            "-n (none): a sampler needs a number of points; --p is jittered",
        ),
        (
            "integrate --p poisson-disk -n 64 --integrand disk",
            2,
            "--p poisson-disk: P of poisson-disk is not known in closed form at n = 64; expected another sampler, or the directory of a result (`pairwave analyze` --sampler poisson-disk --out DIR)",
        ),
        (
            "integrate --p jittered -n 64 -k 3 --integrand disk",
            2,
            "--p jittered: takes no points; expected -n, --dim, --param, --estimator, --max-frequency, --intensity and --by beside it, not -k 3",
        ),
        ("analyze ok.csv --window-polygon missing.wkt", 1, "missing.wkt: No such file or directory (os error 2)"),
        (
            "analyze ok.csv --window-polygon half.wkt",
            1,
            "ok.csv:4: of 3 points, 1 point is outside the polygon, at (0.5, 0.5); expected points inside or on its sides, or the outline in which they were observed (--window-polygon)",
        ),
        (
            "analyze outside.txt --window-polygon half.wkt",
            1,
            "outside.txt:2: of 2 points, 1 point is outside the polygon, at (1.5, 0.2); expected points inside or on its sides, or the outline in which they were observed (--window-polygon)",
        ),
        (
            "analyze ok.csv --window-polygon bow.wkt",
            1,
            "bow.wkt, outer ring: sides 1 and 3 meet at (0.5, 0.5); expected a ring that meets itself nowhere (side k begins at vertex k)",
        ),
        (
            "analyze ok.csv --window-polygon spike.wkt",
            1,
            "spike.wkt, outer ring: sides 1 and 3 meet at (1, 0); expected a ring that meets itself nowhere (side k begins at vertex k)",
        ),
        (
            "analyze ok.csv --window-polygon two.wkt",
            1,
            "two.wkt, outer ring: 2 vertices; expected at least 3 that differ",
        ),
        (
            "analyze ok.csv --window-polygon flat.wkt",
            1,
            "flat.wkt, outer ring: has no area: its vertices lie on a line",
        ),
        (
            "analyze ok.csv --window-polygon out.wkt",
            1,
            "out.wkt, hole 1: is not inside the outer ring that it is a hole of",
        ),
        ("analyze ok.csv --window-polygon in.wkt", 1, "in.wkt, hole 2: is inside hole 1; holes must not overlap"),
        (
            "analyze ok.csv --window-polygon cross.wkt",
            1,
            "cross.wkt, outer ring: side 2 and side 1 of hole 1 meet at (1, 0.5); rings may touch in points but not cross",
        ),
        (
            "analyze ok.csv --window-polygon over.wkt",
            1,
            "over.wkt, outer ring of part 2: overlaps part 1; parts must not overlap",
        ),
        (
            "analyze ok.csv --window-polygon touch.wkt",
            1,
            "touch.wkt, outer ring of part 1: side 2 and side 4 of outer ring of part 2 run along each other at (1, 1); rings may touch in points but not cross",
        ),
        (
            "analyze ok.csv --window-polygon point.wkt",
            1,
            "point.wkt: is a POINT; expected a WKT POLYGON or MULTIPOLYGON, a GeoJSON Polygon or MultiPolygon, or x and y of one vertex per line",
        ),
        ("analyze ok.csv --window-polygon empty.wkt", 1, "empty.wkt: has no ring; expected one of at least 3 vertices"),
        (
            "analyze ok.csv --window-polygon word.wkt",
            1,
            "word.wkt: is no WKT: Expected a number for the Y coordinate; expected a WKT POLYGON or MULTIPOLYGON, a GeoJSON Polygon or MultiPolygon, or x and y of one vertex per line",
        ),
        (
            "analyze ok.csv --window-polygon large.wkt",
            1,
            "large.wkt: its bounding box 0,1e200,0,1: every side must be finite and between 1e-100 and 1e100; expected x0,x1,y0,y1[,z0,z1] with x0 < x1",
        ),
        (
            "analyze ok.csv --window-polygon none.json",
            1,
            "none.json: is a FeatureCollection of 0 features; expected one, a Polygon or a MultiPolygon",
        ),
        ("analyze ok.csv --window-polygon short.json", 1, "short.json: has a position of 1 numbers; expected x and y"),
        (
            "analyze ok.csv --window-polygon line.json",
            1,
            "line.json: is a LineString; expected a WKT POLYGON or MULTIPOLYGON, a GeoJSON Polygon or MultiPolygon, or x and y of one vertex per line",
        ),
        (
            "analyze ok.csv --window-polygon broken.json",
            1,
            "broken.json: is no GeoJSON: Error while deserializing GeoJSON: key must be a string at line 1 column 2; expected a WKT POLYGON or MULTIPOLYGON, a GeoJSON Polygon or MultiPolygon, or x and y of one vertex per line",
        ),
        ("analyze ok.csv --window-polygon xyz.txt", 1, "xyz.txt:1: 3 numbers per vertex; expected x and y"),
        (
            "analyze ok.csv --window-polygon word.txt",
            1,
            "word.txt:2: \"abc\" is not a number; expected 2 numbers per line as in line 1 (the file of a window: expected a WKT POLYGON or MULTIPOLYGON, a GeoJSON Polygon or MultiPolygon, or x and y of one vertex per line)",
        ),
        (
            "analyze ok.csv --window-polygon box.wkt --domain torus",
            2,
            "--window-polygon box.wkt: contradicts --domain torus; --box sets its sides",
        ),
        (
            "analyze ok.csv --window-polygon box.wkt --stats spectrum",
            2,
            "--stats spectrum, radial: is not available for points in a polygon (--window-polygon); expected pcf, k-function, neighbors, counts or intensity",
        ),
        (
            "analyze ok.csv --window-polygon box.wkt --stats pcf-vector",
            2,
            "--stats pcf-vector: is not available for points in a polygon (--window-polygon); expected pcf, k-function, neighbors, counts or intensity",
        ),
        (
            "analyze ok.csv --window-polygon box.wkt --stats covariance",
            2,
            "--stats covariance: is not available for points in a polygon (--window-polygon); expected pcf, k-function, neighbors, counts or intensity",
        ),
        (
            "analyze ok.csv --window-polygon box.wkt --r-max 1",
            2,
            "--r-max 1: expected less than the diameter of the largest circle in the polygon (1): beyond, some directions may never be seen; --correction isotropic reaches to 0.7071067811865476",
        ),
        (
            "analyze ok.csv --window-polygon box.wkt --r-max 0.5 --correction border",
            2,
            "--r-max 0.5: expected less than the radius of the largest circle in the polygon (0.5): no point is further from the border",
        ),
        (
            "analyze ok.csv --window-polygon box.wkt --r-max 0.71 --correction isotropic",
            2,
            "--r-max 0.71: expected less than the radius of the smallest circle about a part of the polygon (0.7071067811865476): beyond, some points see nothing of the circle",
        ),
        ("analyze missing.csv", 1, "missing.csv: No such file or directory (os error 2)"),
        (
            "analyze outside.txt",
            1,
            "outside.txt:2: x = 1.5 is outside [0, 1), and the points reach from 0.1 to 1.5 in x, 0.2 to 0.2 in y: --window gives the window they were observed in, --box the sides of a larger torus; --wrap would fold them over each other",
        ),
        (
            "analyze edge.txt",
            1,
            "edge.txt:2: x = 1 is outside [0, 1); --wrap folds points in, --box sets the sides, --window a window",
        ),
        (
            "analyze three.txt --box 1,1",
            1,
            "three.txt: 3 coordinates per point, but --box or --window has 2 axes; --columns chooses fewer, as in 1,2",
        ),
        ("analyze ok.csv --columns x,z", 1, "ok.csv:1: --columns z: no column of that name; there are x, y"),
        ("analyze ok.csv --columns 1,2,1,2", 2, "--columns 1,2,1,2: names column 1 twice"),
        (
            "analyze ok.csv --realization-column frame",
            1,
            "ok.csv:1: --realization-column frame: no column of that name; there are x, y",
        ),
        ("analyze ok.csv --array x", 1, "ok.csv: --array chooses arrays of an .npz archive, which this file is not"),
        (
            "analyze index.txt",
            1,
            "index.txt:1: column 1 counts the rows (0, 1, 2, ...); --columns 2,3 leaves it out, 1,2,3 takes it for a coordinate",
        ),
        ("analyze hole.csv", 1, "hole.csv:3: a row of empty fields with points after it; fill it in, or delete it"),
        (
            "analyze atoms.cif",
            1,
            "atoms.cif: CIF, which is not read here; save the positions with MDAnalysis or ASE and numpy as .npy, shape (K, n, d)",
        ),
        (
            "analyze ok.csv --box 2,2 --stats spectrum --frequencies nu.csv",
            1,
            "nu.csv: column nu_x: expected integers m, cycles per side; nu is in cycles per unit length: multiply by the side",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies yz.csv",
            1,
            "yz.csv: column m_y stands in place 1; expected the axes in order, x first",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --stats spectrum --frequencies kx.csv",
            1,
            "kx.csv: column kx is by its name an angular frequency, 2 pi times cycles per unit length; expected cycles per unit length: convert, and call the columns nu_x, nu_y",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies kx.csv",
            1,
            "kx.csv: column kx is by its name an angular frequency, 2 pi times cycles per unit length; expected integers m, cycles per side of the torus: convert, and call the columns m_x, m_y",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies kx.txt",
            1,
            "kx.txt: column kx is by its name an angular frequency, 2 pi times cycles per unit length; expected integers m, cycles per side of the torus: convert, and call the columns m_x, m_y",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --stats spectrum --frequencies id-kx.csv",
            1,
            "id-kx.csv: column kx is by its name an angular frequency, 2 pi times cycles per unit length; expected cycles per unit length: convert, and call the columns nu_x, nu_y",
        ),
        (
            "analyze ok.csv --box 2,2 --stats spectrum --frequencies nu.txt",
            1,
            "nu.txt: column nu_x: expected integers m, cycles per side; nu is in cycles per unit length: multiply by the side",
        ),
        (
            "analyze ok.csv --window 0,2,0,2 --stats spectrum --frequencies m.txt",
            1,
            "m.txt: column m_x: expected nu, cycles per unit length; m is in cycles per side: divide by the side",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies id-ab.csv",
            1,
            "id-ab.csv:1: a column named \"id\" and none named m_x; expected columns named m_x, m_y[, m_z]",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --stats spectrum --frequencies id-ab.csv",
            1,
            "id-ab.csv:1: a column named \"id\" and none named nu_x; expected columns named nu_x, nu_y[, nu_z]",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --stats spectrum --frequencies far.csv",
            1,
            "far.csv:3: nu_y = 3000000000; expected cycles per unit length, less than 2^31 of them per side of the window",
        ),
        (
            "analyze commas.csv",
            1,
            "commas.csv:3: 2 fields, the header names 1, and \"0\" stands first in two rows, so it names neither; decimal commas? write points, or semicolons between numbers; a class or a frame needs a name in the header",
        ),
        (
            "analyze commas2.csv",
            1,
            "commas2.csv:2: 3 fields, the header names 2, and no number has a decimal point; decimal commas? write points, or semicolons between numbers; a class or a frame needs a name in the header",
        ),
        (
            "analyze commas3.csv",
            1,
            "commas3.csv:2: 3 fields, the header names 2, and \"0.5\" is not the name of a row; decimal commas? write points, or semicolons between numbers; a class or a frame needs a name in the header",
        ),
        (
            "analyze class.txt",
            1,
            "class.txt:4: 3 fields, the header names 2, and \"oak\" stands first in two rows, so it names neither; decimal commas? write points, or semicolons between numbers; a class or a frame needs a name in the header",
        ),
        (
            "analyze frame.txt",
            1,
            "frame.txt:3: 3 fields, the header names 2, and \"1\" stands first in two rows, so it names neither; decimal commas? write points, or semicolons between numbers; a class or a frame needs a name in the header",
        ),
        (
            "analyze late-name.txt",
            1,
            "late-name.txt:3: 3 fields, the header names 2, and \"0.5\" is not the name of a row; decimal commas? write points, or semicolons between numbers; a class or a frame needs a name in the header",
        ),
        (
            "analyze obs.csv",
            1,
            "obs.csv:1: a column named \"obs\" and none named x; expected columns named x, y[, z], or --columns with the names of those meant",
        ),
        (
            "analyze ok.csv ./ok.csv",
            1,
            "./ok.csv: is given twice (before as ok.csv): its realizations would count twice; give it once",
        ),
        ("analyze ok.csv ok.csv", 1, "ok.csv: is given twice: its realizations would count twice; give it once"),
        ("analyze ok.csv --array x,y,x", 2, "--array x,y,x: names array x twice"),
        ("analyze nest", 1, "nest: no files in this directory, only 1 folder; give those, or 'nest/*/*'"),
        ("analyze ok.csv --edges hole.txt", 1, "hole.txt:2: an empty field in `0.2,,0.3`; expected a number"),
        (
            "analyze ok.csv --edges edge-commas.txt",
            1,
            "edge-commas.txt:2: decimal comma in `0,05;0,1`; write numbers with a point, as 0.5",
        ),
        (
            "analyze ok.csv --edges edge-commas2.txt",
            1,
            "edge-commas2.txt:2: decimal commas, or two edges in every line; write numbers with a point, as 0.5, or one in a line",
        ),
        (
            "analyze heavy.csv --weight-column w",
            1,
            "heavy.csv: --weight-column w: no realization has two points whose weights are not negligible beside the largest of all (2^-60 of it)",
        ),
        (
            "analyze --sampler random -n 9 -k 18446744073709551615",
            2,
            "-k 18446744073709551615: expected at most 1073741824 realizations: what is kept of each would not fit into the memory of a machine",
        ),
        (
            "analyze outside.txt --window 0,1,0,1",
            1,
            "outside.txt:2: x = 1.5 is outside the window [0, 1]; --window x0,x1,y0,y1 sets it",
        ),
        (
            "analyze one.csv",
            1,
            "points: pcf, pcf-vector, k-function and neighbors need a realization of at least 2 points, the largest has 1; --stats spectrum works with 1",
        ),
        (
            "analyze ok.csv --window 0,1",
            1,
            "ok.csv: 2 coordinates per point, but --box or --window has 1 axis; --columns chooses fewer, as in 1",
        ),
        ("analyze ok.csv --window 0,1,2", 2, "--window 0,1,2: expected two numbers per axis, x0,x1,y0,y1[,z0,z1]"),
        (
            "analyze ok.csv --window 0,1,1,0",
            2,
            "--window 0,1,1,0: every side must be finite and between 1e-100 and 1e100; expected x0,x1,y0,y1[,z0,z1] with x0 < x1",
        ),
        (
            "analyze ok.csv --domain window",
            2,
            "--domain window: needs --window x0,x1,y0,y1[,z0,z1] or --window-polygon FILE: a window is not guessed",
        ),
        (
            "analyze ok.csv --r-max 0.6",
            2,
            "--r-max 0.6: beyond half the shortest side (0.5) a ring does not fit into the torus and g would be under-counted; expected at most 0.5, or --beyond-half, which compares with the part that fits",
        ),
        (
            "analyze ok.csv --r-max 1 --window 0,1,0,1",
            2,
            "--r-max 1: expected less than the shortest side of the window (1): beyond, some directions are never seen",
        ),
        ("analyze ok.csv --r-max 0", 2, "--r-max 0: expected a finite number above 0"),
        ("analyze ok.csv --bins 0", 2, "--bins 0: expected 1 to 1048576"),
        (
            "analyze ok.csv --edges edges.txt",
            2,
            "--edges edges.txt: edges must be finite, at least 0 and strictly increasing; edge 1 is 1e-1, edge 2 is 5e-2",
        ),
        ("analyze ok.csv --edges words.txt", 1, "words.txt:2: `x` is not a number"),
        ("analyze ok.csv --edges nowhere.txt", 1, "nowhere.txt: No such file or directory (os error 2)"),
        ("analyze ok.csv --correction translation", 2, "--correction translation: a torus has no edges; use none"),
        (
            "analyze ok.csv --window -1,1,-1,0.5",
            1,
            "ok.csv:3: y = 0.9 is outside the window [-1, 0.5]; --window x0,x1,y0,y1 sets it",
        ),
        (
            "analyze ok.csv --box 1e-300,1",
            2,
            "--box 1e-300,1: every side must be finite and between 1e-100 and 1e100; expected L1,L2[,L3]",
        ),
        ("analyze ok.csv --r-max -1", 2, "--r-max -1: expected a finite number above 0"),
        ("analyze ok.csv --lag-bins 3", 2, "--lag-bins 3: needs pcf-vector among --stats"),
        ("analyze ok.csv --lag-max 0.1", 2, "--lag-max 0.1: needs pcf-vector among --stats"),
        ("analyze ok.csv --lag-rings 0.1,0.2", 2, "--lag-rings 0.1,0.2: needs pcf-vector among --stats"),
        (
            "analyze ok.csv --stats radial --correction none",
            2,
            "--correction none: needs pcf, k-function or pcf-vector among --stats",
        ),
        ("analyze ok.csv --stats pcf-vector --lag-bins 0", 2, "--lag-bins 0: expected 1 to 1448 bins per axis in 2D"),
        (
            "analyze ok.csv --stats pcf-vector --lag-bins 1449",
            2,
            "--lag-bins 1449: expected 1 to 1448 bins per axis in 2D",
        ),
        (
            "analyze three.txt --stats pcf-vector --lag-bins 129",
            2,
            "--lag-bins 129: expected 1 to 128 bins per axis in 3D",
        ),
        (
            "analyze ok.csv --stats pcf-vector --lag-max 0.6",
            2,
            "--lag-max 0.6: expected a number above 0 and at most half the shortest side (0.5)",
        ),
        (
            "analyze ok.csv --stats pcf-vector --lag-max 1e-200",
            2,
            "--lag-max 1e-200: its cells are narrower than positions are known; expected at least 7.047314121155779e-18",
        ),
        (
            "analyze ok.csv --stats pcf-vector --lag-max nan",
            2,
            "--lag-max NaN: expected a number above 0 and at most half the shortest side (0.5)",
        ),
        (
            "analyze ok.csv --stats pcf-vector --lag-rings 0.4999",
            2,
            "--lag-rings 0.4999: rings are two cells wide (0.015625) and fit into the grid of lags: expected more than 0.0078125 and at most 0.4921875",
        ),
        (
            "analyze three.txt --stats pcf-vector --lag-rings 0.1",
            2,
            "--lag-rings 0.1: rings are followed round in 2D, the points have 3 coordinates",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --stats pcf-vector --correction border",
            2,
            "--correction border: the vector g is corrected by the set covariance of the window: use translation, or none",
        ),
        (
            "analyze ok.csv --stats pcf-vector --correction translation",
            2,
            "--correction translation: a torus has no edges; use none",
        ),
        ("analyze ok.csv --stats spectrum --bins 3", 2, "--bins 3: needs pcf or k-function among --stats"),
        ("analyze ok.csv --intensity-grid 8", 2, "--intensity-grid 8: needs intensity among --stats"),
        (
            "analyze ok.csv --intensity-bandwidth scott",
            2,
            "--intensity-bandwidth scott: needs intensity among --stats, or --inhomogeneous estimate",
        ),
        (
            "analyze ok.csv --inhomogeneous formula:1+x --intensity-bandwidth scott",
            2,
            "--intensity-bandwidth scott: needs intensity among --stats, or --inhomogeneous estimate",
        ),
        (
            "analyze ok.csv --inhomogeneous gausian",
            2,
            "--inhomogeneous gausian: no such integrand (did you mean gaussian?); expected one of disk, box, step, interval, steps, half-plane, gaussian, cut-gaussian, ramp, monomial, cosine, checker, zone-plate, bump, image, formula, table, or estimate, a kernel estimate",
        ),
        (
            "analyze ok.csv --inhomogeneous formula:0.3-x",
            1,
            "ok.csv, realization 0, point 1 at 0.3,0.9: the intensity there is 0; expected a finite number above 0",
        ),
        (
            "analyze ok.csv --inhomogeneous estimate --intensity-bandwidth 0.01",
            1,
            "ok.csv, realization 0, point 0 at 0.1,0.2: the intensity there is 0; expected a finite number above 0: a larger --intensity-bandwidth reaches more points",
        ),
        (
            "analyze ok.csv --inhomogeneous estimate --intensity-bandwidth 2",
            2,
            "--intensity-bandwidth 2: expected a standard deviation above 0 and at most the longest side, 1",
        ),
        (
            "analyze ok.csv --inhomogeneous estimate --stats neighbors",
            2,
            "--inhomogeneous estimate: needs pcf, k-function, spectrum, radial or covariance among --stats",
        ),
        (
            "analyze ok.csv --inhomogeneous estimate --envelope 9",
            2,
            "--envelope 9: simulations have no intensity that they could be weighted by (--inhomogeneous, --intensity-column)",
        ),
        (
            "analyze ok.csv --inhomogeneous estimate --projections",
            2,
            "--inhomogeneous estimate: is not there where pairs of axes or prefixes are measured (--projections, --prefixes)",
        ),
        (
            "integrate ok.csv --prefixes 2,3 --integrand disk --device cpu",
            2,
            "--integrand disk: is not there where pairs of axes or prefixes are measured (--projections, --prefixes)",
        ),
        (
            "analyze ok.csv --projections --envelope 9 --device cpu",
            2,
            "--envelope 9: is not there where pairs of axes or prefixes are measured (--projections, --prefixes)",
        ),
        (
            "analyze ok.csv --projections --sectors 8 --device cpu",
            2,
            "--sectors 8: is not there where pairs of axes or prefixes are measured (--projections, --prefixes)",
        ),
        (
            "analyze heavy.csv --intensity-column v",
            1,
            "heavy.csv:1: --intensity-column v: no column of that name; there are x, y, w",
        ),
        (
            "analyze endless.csv --intensity-column w",
            1,
            "endless.csv:2: the intensity there is inf; expected a finite number above 0",
        ),
        (
            "analyze below.csv --intensity-column w",
            1,
            "below.csv:3: the intensity there is -0.5; expected a finite number above 0",
        ),
        (
            "analyze ok.csv --stats intensity --intensity-grid 1",
            2,
            "--intensity-grid 1: expected 2 to 4096 cells per axis in 2D",
        ),
        (
            "analyze three.txt --stats intensity --intensity-grid 257",
            2,
            "--intensity-grid 257: expected 2 to 256 cells per axis in 3D",
        ),
        (
            "analyze ok.csv --stats intensity --intensity-bandwidth 0",
            2,
            "--intensity-bandwidth 0: expected a standard deviation above 0 and at most the longest side, 1",
        ),
        (
            "analyze ok.csv --stats intensity --intensity-bandwidth nan",
            2,
            "--intensity-bandwidth NaN: expected a standard deviation above 0 and at most the longest side, 1",
        ),
        (
            "analyze trees.csv --columns x,y --weight-column size --stats counts",
            2,
            "--weight-column size: needs pcf, k-function, spectrum, radial or covariance among --stats",
        ),
        (
            "analyze ok.csv --stats pcf --max-frequency 3",
            2,
            "--max-frequency 3: needs spectrum or radial among --stats",
        ),
        (
            "analyze ok.csv --kernel box --bandwidth 0",
            2,
            "--bandwidth 0: expected more than 0 and less than the shortest side (1)",
        ),
        (
            "analyze ok.csv --kernel box --bandwidth NaN",
            2,
            "--bandwidth NaN: expected more than 0 and less than the shortest side (1)",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --kernel box --correction border",
            2,
            "--correction border: a kernel estimate weighs pairs; expected translation, isotropic or none",
        ),
        ("analyze ok.csv --envelope 0", 2, "--envelope 0: expected 1 to 174307 simulations of 770 values each"),
        (
            "analyze ok.csv --stats spectrum --envelope 9",
            2,
            "--envelope 9: needs pcf, k-function or neighbors among --stats",
        ),
        (
            "analyze ok.csv --kernel box --bandwidth 2",
            2,
            "--bandwidth 2: expected more than 0 and less than the shortest side (1)",
        ),
        (
            "analyze ok.csv --max-frequency 1,2,3",
            2,
            "--max-frequency 1,2,3: expected 1 or 2 numbers for points with 2 coordinates",
        ),
        (
            "analyze ok.csv --box 1 --max-frequency 1,2",
            1,
            "ok.csv: 2 coordinates per point, but --box or --window has 1 axis; --columns chooses fewer, as in 1",
        ),
        (
            "analyze --sampler random -n 9 --dim 1 --max-frequency 1,2",
            2,
            "--max-frequency 1,2: expected 1 number for points with 1 coordinate",
        ),
        (
            "analyze --sampler random -n 9 --dim 1 --stats radial --sectors 4",
            2,
            "--sectors 4: directions are followed in 2D, the points are in 1D",
        ),
        ("analyze ok.csv --max-frequency 100000000", 2, "--max-frequency 100000000: expected at most 4194304"),
        (
            "analyze three.txt --max-frequency 2000",
            2,
            "--max-frequency 2000: 64048012001 wave vectors need about 3101 GiB; at most 536870912 are supported (rings alone: --stats radial --ring-directions N)",
        ),
        (
            "analyze ok.csv --r-max 0.8 --beyond-half",
            2,
            "--r-max 0.8: expected at most half the diagonal of the torus (0.7071067811865476): no two points are further apart",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --beyond-half",
            2,
            "--beyond-half (given): is about a torus; a window has its edge correction",
        ),
        (
            "analyze ok.csv --stats k-function --beyond-half --r-max 0.6",
            2,
            "--beyond-half (given): K and L compare with whole balls, which fit up to r = 0.5; expected --stats pcf alone",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --correction isotropic --r-max 0.8",
            2,
            "--r-max 0.8: expected less than half the diagonal of the window (0.7071067811865476): there, some points see nothing of the circle",
        ),
        (
            "analyze ok.csv --window 0,1,0,1 --correction border --r-max 0.5",
            2,
            "--r-max 0.5: expected less than half the shortest side of the window (0.5): no point is further from the border",
        ),
        (
            "analyze three.txt --window 0,1,0,1,0,1 --correction isotropic",
            2,
            "--correction isotropic: the part of a sphere inside a box is not computed; 3D has translation, border and none",
        ),
        (
            "analyze heavy.csv --window 0,1,0,1 --correction border --weight-column w",
            1,
            "heavy.csv: --weight-column w: no realization has two points whose weights are not negligible beside the largest of all (2^-60 of it)",
        ),
        (
            "analyze ok.csv --stats k-function --bin-scale log",
            2,
            "--bin-scale log: K counts all pairs closer than r: bins must start at 0, not at 0.0005",
        ),
        (
            "analyze ok.csv --stats k-function --edges late.txt",
            2,
            "--edges late.txt: K counts all pairs closer than r: bins must start at 0, not at 0.1",
        ),
        ("analyze ok.csv --stats k-function --kernel box", 2, "--kernel box: needs pcf among --stats"),
        (
            "analyze trees.csv --stats neighbors --weight-column size",
            2,
            "--weight-column size: needs pcf, k-function, spectrum, radial or covariance among --stats",
        ),
        (
            "analyze ok.csv one-more.csv --stats pcf --envelope-from ok.csv",
            2,
            "--envelope-from ok.csv: 1 realizations are no whole number of simulations of 2 realizations, as many as the points have",
        ),
        (
            "analyze trees.csv --stats spectrum --class-column kind",
            2,
            "--class-column kind: needs pcf, k-function or neighbors among --stats",
        ),
        ("analyze trees.csv --class-column kind", 2, "--classes (none): expected two of the 3 classes: oak, elm, fir"),
        (
            "analyze trees.csv --class-column kind --classes oak,ash",
            2,
            "--classes oak,ash: no point is of class ash; there are oak, elm, fir",
        ),
        (
            "analyze trees.csv --class-column kind --classes oak,oak",
            2,
            "--classes oak,oak: expected two different classes",
        ),
        (
            "analyze trees.csv --class-column kind --classes oak",
            2,
            "--classes oak: expected two classes, as in oak,elm",
        ),
        (
            "analyze trees.csv --class-column species",
            1,
            "trees.csv:1: --class-column species: no column of that name; there are x, y, kind, size",
        ),
        ("analyze zero.csv --weight-column 3", 1, "zero.csv: --weight-column 3: all weights are 0"),
        ("analyze ok.csv -n 5", 2, "-n 5: applies to --sampler NAME only, not to point files"),
        ("analyze ok.csv --param mu=3", 2, "--param mu=3: applies to --sampler NAME only, not to point files"),
        ("analyze ok.csv --device 99", 1, "--device 99:"),
        ("analyze ok.csv --threads 100000", 2, "--threads 100000:"),
        ("analyze ok.csv --threads 0", 2, "--threads 0:"),
        (
            "analyze --sampler jitterd -n 64",
            2,
            "--sampler jitterd: no such sampler (did you mean jittered?); expected one of random, poisson, grid, hexagonal, fcc, bcc, perturbed-grid, jittered, cmj, lhs, cell, halton, hammersley, sobol, pmj02, lattice, fibonacci, kronecker, poisson-disk, maximal-poisson-disk, matern-i, matern-ii, best-candidate, lloyd, fpo, stealthy, thomas, matern-cluster, cauchy-cluster, lgcp, gaussian-dpp, fourier-dpp, ginibre",
        ),
        ("analyze --sampler random", 2, "-n (none): --sampler needs -n N"),
        ("analyze --sampler jittered -n 64 --dim 5", 2, "--dim 5: jittered: expected 1, 2 or 3"),
        ("analyze --sampler jittered -n 65", 2, "-n 65: jittered in 2D needs n = k^2; the nearest are 64 and 81"),
        (
            "analyze ok.csv --stats spectrum --frequencies half.txt",
            1,
            "half.txt:3: m_y = 1.5; expected an integer with magnitude below 2^31: cycles per side of the torus",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies huge.csv",
            1,
            "huge.csv:2: m_x = 3000000000; expected an integer with magnitude below 2^31: cycles per side of the torus",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies three.txt",
            1,
            "three.txt:1: 3 numbers per wave vector, but the points have 2 coordinates",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies nothing.txt",
            1,
            "nothing.txt: no wave vectors: only blank lines and comments",
        ),
        ("analyze ok.csv --stats spectrum --frequencies five.txt", 1, "five.txt:1: announces 5 wave vectors, found 1"),
        (
            "analyze ok.csv --stats spectrum --frequencies half.f64",
            1,
            "half.f64, wave vector 1: m_x = 1.5; expected an integer with magnitude below 2^31: cycles per side of the torus",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies odd.f64",
            1,
            "odd.f64: 24 bytes are not a whole number of f64x2 wave vectors of 16 bytes: 8 left over",
        ),
        (
            "analyze ok.csv --stats spectrum --frequencies bytes",
            1,
            "bytes: neither text nor .npy, .npz or UTK .bin (no such header); raw numbers need a name that ends in .f32 or .f64",
        ),
        ("analyze ok.csv --stats spectrum --window 0,1,0,1 --tapers 0", 2, "--tapers 0: expected 1 to 64 per axis"),
        (
            "analyze ok.csv --stats spectrum --window 0,1,0,1 --tapers 2",
            2,
            "--tapers 2: needs --taper sine; Bartlett's taper is one",
        ),
        (
            "analyze below.csv --weight-column w",
            1,
            "below.csv:3: weight -0.5; g and K need weights of at least 0, P does not",
        ),
        (
            "analyze ok.csv --stats spectrum --max-frequency 1 --convention psa",
            2,
            "--max-frequency 1: --convention needs one number for all axes, and at least 2",
        ),
        ("analyze ok.csv --stats covariance --covariance-frequency 0", 2, "--covariance-frequency 0: expected 1 to 54"),
        (
            "analyze ok.csv --stats pcf --frequencies half.txt",
            2,
            "--frequencies half.txt: needs spectrum among --stats",
        ),
        (
            "analyze ok.csv --stats spectrum,radial --frequencies half.txt",
            2,
            "--frequencies half.txt: a list of wave vectors has no rings; expected --stats spectrum without radial",
        ),
        ("analyze ok.csv --stats radial --ring-directions 0", 2, "--ring-directions 0: expected at least 1"),
        (
            "analyze ok.csv --stats spectrum,radial --ring-directions 8",
            2,
            "--ring-directions 8: leaves wave vectors out, which --stats spectrum asks for; expected --stats radial without spectrum",
        ),
        ("analyze --sampler jittered -n 64 -k 0", 2, "-k 0: expected at least 1 realization"),
        (
            "analyze --sampler random -n 64 --domain window",
            2,
            "--domain window: samplers fill a torus; a window needs files",
        ),
        ("analyze --sampler random -n 64 --box 1", 2, "--box 1: expected 2 sides for points with 2 coordinates"),
        (
            "integrate --sampler random -n 9",
            2,
            "--integrand (none): expected an integrand such as disk or box:x0=0.2,x1=0.7; `pairwave integrands` lists them",
        ),
        ("integrate --sampler random -n 9 --integrand dsk", 2, "--integrand dsk:"),
        (
            "integrate --sampler random -n 9 --integrand disk --integrand disk:r=0.25",
            2,
            "--integrand disk:r=0.25,x=0.5,y=0.5: is given twice",
        ),
        ("integrate --sampler random -n 9 --integrand disk --shifts 0", 2, "--shifts 0: expected 1 to 65536"),
        (
            "integrate --sampler thomas -n 9 -k 4 --integrand disk --estimator mean",
            2,
            "--estimator mean: needs as many points in every realization; expected ratio or lambda",
        ),
        (
            "integrate ok.csv --window 0,1,0,1 --integrand disk",
            2,
            "--integrand disk: predicts for shifts of a torus; --box gives the sides of one, and a window has none",
        ),
        ("integrate --sampler random -n 9 --integrand interval", 2, "--integrand interval:"),
        ("analyze --sampler random -n 9 --shifts 3", 2, "the following required arguments were not provided:"),
        (
            "integrate --sampler random -n 9 --integrand disk --by warp",
            2,
            "the following required arguments were not provided:",
        ),
        (
            "analyze --sampler random -n 9 --intensity ramp --by warp",
            2,
            "the following required arguments were not provided:",
        ),
        (
            "integrate --sampler random -n 9 --integrand disk --intensity ramp --by add",
            2,
            "--by add: points added to others have another g than these: what is predicted from it would be wrong, even below 0; expected removal, from a parent as dense as the largest value",
        ),
        (
            "integrate --sampler random -n 9 --dim 1 --integrand ramp --intensity interval:x0=0.5,x1=1 --by removal",
            2,
            "--intensity interval:x0=0.5,x1=1:",
        ),
        (
            "integrate --sampler random -n 9 --dim 1 --integrand formula:1 --intensity monomial:x=1 --by removal",
            2,
            "--intensity monomial:x=1: the integral of f^2 over it does not converge for formula:1:",
        ),
        (
            "integrate --sampler random -n 9 --integrand disk --intensity step:at=0.5 --device cpu",
            2,
            "--intensity step:axis=x,at=0.5:",
        ),
        (
            "integrate --sampler random -n 9 --integrand disk --estimator count-ratio",
            2,
            "--estimator count-ratio: is for points with weights; expected --weight-column or --intensity beside it, or ratio",
        ),
        (
            "integrate --sampler random -n 9 --box 1,2 --integrand disk --spatial radial",
            2,
            "--spatial radial: is for a box of equal sides and points without weights; expected pairs, deposit or none",
        ),
        (
            "integrate --sampler random -n 9 --integrand disk --intensity rmp --by warp",
            2,
            "--intensity rmp: no such integrand (did you mean ramp?); expected one of disk, box, step, interval, steps, half-plane, gaussian, cut-gaussian, ramp, monomial, cosine, checker, zone-plate, bump, image, formula, table",
        ),
        (
            "integrate --sampler random -n 9 --integrand disk --intensity formula:x-0.5 --by warp",
            2,
            "--intensity formula:x-0.5:",
        ),
        (
            "integrate --sampler random -n 9 --integrand disk --intensity formula:0*x --by warp",
            2,
            "--intensity formula:0*x: has the integral 0; expected a density, whose integral is above 0",
        ),
        (
            "integrate --sampler random -n 9 --integrand ramp --intensity step:at=0.5 --by warp",
            2,
            "--intensity step:axis=x,at=0.5: is 0 where ramp:axis=x is not: 75.000 % of the integral is never sampled, a bias; expected a density above 0 wherever the integrand is not 0",
        ),
        (
            "integrate --sampler random --dim 1 -n 9 --integrand formula:1 --intensity ramp --by warp",
            2,
            "--intensity ramp:axis=x: falls to 0 where formula:1 does not:",
        ),
        ("integrate --sampler random -n 9 --integrand formula:1/(x-0.5)", 2, "--integrand formula:1/(x-0.5):"),
        ("analyze", 2, "FILES (none): expected point files, or --sampler NAME -n N"),
    ];
    for (arguments, code, message) in table {
        let output = scratch.run(&format!("{arguments} --out result --quiet"));
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(*code), "`{arguments}`: {errors}");
        let exact = if message.ends_with(':') {
            errors.starts_with(&format!("error: {message}"))
        } else {
            errors == format!("error: {message}\n")
        };
        assert!(exact, "`{arguments}` said\n{errors}instead of\nerror: {message}");
        assert!(!scratch.path("result").exists(), "`{arguments}` left something behind");
    }
    // What clap itself refuses: exit code 2, the flag named.
    for (arguments, named) in [
        ("analyze ok.csv --out o --stats pcf,color", "color"),
        ("analyze ok.csv --out o --device tpu", "--device"),
        ("analyze ok.csv --out o --r-max 0.1 --edges edges.txt", "--edges"),
        ("analyze ok.csv --out o --bins many", "--bins"),
        ("analyze --sampler random --out o", "-n"),
        ("sample random -n 5", "--out"),
        ("paint", "paint"),
    ] {
        let output = scratch.run(arguments);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "`{arguments}`: {errors}");
        assert!(errors.contains(named), "`{arguments}` does not name {named}: {errors}");
    }
    // What is read is not overwritten, whatever is asked for.
    std::fs::create_dir(scratch.path("io")).unwrap();
    scratch.file("io/pcf.csv", "x,y\n0.1,0.2\n0.3,0.9\n");
    scratch.file("io/k_function.csv", "0 0.1\n");
    for (arguments, message) in [
        ("io", "is read as points; a result among them would be read as points too; expected another directory"),
        ("io/pcf.csv", "holds pcf.csv, which is read and would be replaced; expected another directory"),
        ("io/p*.csv", "holds pcf.csv, which is read and would be replaced; expected another directory"),
        (
            "ok.csv --edges ./io/../io/k_function.csv",
            "holds k_function.csv, which is read and would be replaced; expected another directory",
        ),
    ] {
        let output = scratch.run(&format!("analyze {arguments} --out io --force --device cpu"));
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), errors), (Some(2), format!("error: --out io: {message}\n")), "{arguments}");
    }
    assert_eq!(std::fs::read_dir(scratch.path("io")).unwrap().count(), 2);
    // An existing result is not overwritten without --force.
    let output = scratch.run("analyze ok.csv --device cpu --out taken");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(scratch.path("taken/summary.json")).unwrap(), "{}");
    scratch.ok("analyze ok.csv --device cpu --out taken --force");
    assert!(scratch.path("taken/pcf.csv").exists());
}
