//! Pictures and tables.

use std::path::PathBuf;

use super::*;

/// Files of a picture of 3 x 2 pixels and of tables.
pub(super) struct Files {
    dir: tempfile::TempDir,
}

/// Rows from the top, in 255ths.
const PIXELS: [[u8; 3]; 2] = [[0, 51, 255], [102, 204, 153]];

impl Files {
    pub(super) fn new() -> Self {
        let files = Self { dir: tempfile::tempdir().unwrap() };
        files.write("grey.png", &png(png::ColorType::Grayscale, png::BitDepth::Eight, |v| vec![v]));
        files.write("deep.png", &png(png::ColorType::Grayscale, png::BitDepth::Sixteen, |v| vec![v, v]));
        files.write("rgba.png", &png(png::ColorType::Rgba, png::BitDepth::Eight, |v| vec![v, v, v, 7]));
        let values = |rows: [usize; 2]| rows.into_iter().flat_map(|j| PIXELS[j]).map(|v| f32::from(v) / 255.0);
        let pfm = |head: &str, bytes: fn(f32) -> [u8; 4]| {
            let data: Vec<u8> = values([1, 0]).flat_map(bytes).collect();
            [head.as_bytes(), &data].concat()
        };
        files.write("little.pfm", &pfm("Pf\n3 2\n-1.0\n", f32::to_le_bytes));
        files.write("big.pfm", &pfm("Pf\n3 2\n1.0\n", f32::to_be_bytes));
        let colour: Vec<u8> = values([1, 0]).flat_map(|v| [v; 3]).flat_map(f32::to_le_bytes).collect();
        files.write("colour.pfm", &[b"PF\n3 2\n-1.0\n".as_slice(), &colour].concat());
        let pixel = |x: usize, y: usize| f32::from(PIXELS[y][x]) / 255.0;
        exr::prelude::write_rgb_file(files.path("colour.exr"), 3, 2, |x, y| (pixel(x, y), pixel(x, y), pixel(x, y)))
            .unwrap();
        let table: Vec<f64> = (0..24).map(|i| f64::from(i * i % 7) - 1.5).collect();
        files.write(
            "table3.npy",
            &npy("<f8", false, &[2, 3, 4], &table.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>()),
        );
        files.write(
            "table2.npy",
            &npy("<f8", false, &[4, 6], &table.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>()),
        );
        let turned = (0..24).map(|i| table[i % 4 * 6 + i / 4] as f32);
        files.write("fortran.npy", &npy("<f4", true, &[4, 6], &turned.flat_map(f32::to_le_bytes).collect::<Vec<_>>()));
        files.write("steps.txt", b"# five cells\nx,value\n0,1\n0.2,3 # here\n0.4,-2\n\n0.6,5\n0.8,0.5\n");
        files
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    fn spec(&self, kind: &str, name: &str, more: &str) -> String {
        format!("{kind}:file={}{more}", self.path(name).display())
    }

    fn refused(&self, kind: &str, name: &str, dim: usize) -> String {
        let error = Integrand::new(&self.spec(kind, name, ""), dim).expect_err(name).to_string();
        assert!(error.contains(name), "{error} does not name the file");
        error
    }

    /// One of each kind and dimension.
    pub(super) fn all(&self) -> Vec<Integrand> {
        vec![
            made(&self.spec("image", "grey.png", ""), 2),
            made(&self.spec("table", "steps.txt", ""), 1),
            made(&self.spec("table", "table2.npy", ""), 2),
            made(&self.spec("table", "table3.npy", ""), 3),
            made("formula:x^3 - x", 1),
            made("formula:x^2*y", 2),
            made("formula:x*y*z", 3),
        ]
    }
}

fn png(color: png::ColorType, depth: png::BitDepth, sample: impl Fn(u8) -> Vec<u8>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 3, 2);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let data: Vec<u8> = PIXELS.into_iter().flatten().flat_map(sample).collect();
    encoder.write_header().unwrap().write_image_data(&data).unwrap();
    bytes
}

fn npy(descr: &str, fortran: bool, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let sides: String = shape.iter().map(|side| format!("{side},")).collect();
    let order = if fortran { "True" } else { "False" };
    let head = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({sides}), }}\n");
    [b"\x93NUMPY\x01\x00", (head.len() as u16).to_le_bytes().as_slice(), head.as_bytes(), data].concat()
}

#[test]
fn pictures_of_all_formats_are_the_same_function() {
    let files = Files::new();
    for name in ["grey.png", "deep.png", "rgba.png", "little.pfm", "big.pfm", "colour.pfm", "colour.exr"] {
        for top in [0, 1] {
            let f = made(&files.spec("image", name, &format!(",top={top}")), 2);
            for (row, pixels) in PIXELS.into_iter().enumerate() {
                let y = if (top == 1) == (row == 0) { 0.75 } else { 0.25 };
                for (column, value) in pixels.into_iter().enumerate() {
                    let found = f.value(&[(column as f64 + 0.5) / 3.0, y]);
                    assert!(
                        (found - f64::from(value) / 255.0).abs() < 1e-6,
                        "{name}, top={top}: {row} {column}: {found}"
                    );
                }
            }
            assert!((f.integral() - 765.0 / 255.0 / 6.0).abs() < 1e-6, "{name}");
            // The edges of pixels are half-open.
            assert_eq!(f.value(&[0.0, 0.5]), f.value(&[0.1, 0.9]));
        }
    }
    // Which way up is seen in f_m, not in the integrals.
    let [up, down] = [1, 0].map(|top| made(&files.spec("image", "grey.png", &format!(",top={top}")), 2));
    assert!((up.coefficient(&[1, 1]) - down.coefficient(&[1, 1])).norm() > 0.01);
    assert_eq!(up.spec(), files.spec("image", "grey.png", ",top=1"));
}

/// f_m of cells by summing them, to rounding, at frequencies far beyond their number; and as the sum of boxes and steps they are.
#[test]
fn cells_are_sums_of_boxes() {
    let files = Files::new();
    let steps = made("steps:values=1;3;-2;5;0.5", 1);
    let text = made(&files.spec("table", "steps.txt", ""), 1);
    for m in [0, 1, -2, 7, 31, 5, 10] {
        assert!((steps.coefficient(&[m]) - text.coefficient(&[m])).norm() < 1e-15);
    }
    for r in lags(1, 40) {
        assert!((steps.autocorrelation(&r) - text.autocorrelation(&r)).abs() < 1e-14);
    }
    let tables = [
        (made(&files.spec("table", "table2.npy", ""), 2), vec![4usize, 6]),
        (made(&files.spec("table", "fortran.npy", ""), 2), vec![4, 6]),
        (made(&files.spec("table", "table3.npy", ""), 3), vec![2, 3, 4]),
    ];
    for (f, shape) in tables {
        let dim = shape.len();
        for m in modes(dim, 30, 20) {
            let mut sum = Complex::default();
            for i in 0..24 {
                let mut rest = i;
                let mut cell = vec![0; dim];
                for k in (0..dim).rev() {
                    cell[k] = rest % shape[k];
                    rest /= shape[k];
                }
                let ends: Vec<String> = (0..dim)
                    .map(|k| {
                        let end = |j: usize| j as f64 / shape[k] as f64;
                        format!("{0}0={1},{0}1={2}", ["x", "y", "z"][k], end(cell[k]), end(cell[k] + 1))
                    })
                    .collect();
                let value = f64::from((i * i % 7) as u32) - 1.5;
                sum += made(&format!("box:{}", ends.join(",")), dim).coefficient(&m) * value;
            }
            assert!((f.coefficient(&m) - sum).norm() < 1e-14, "{f:?} {m:?}");
        }
    }
}

#[test]
fn files_that_are_wrong_say_how() {
    let files = Files::new();
    let small = |name: &str, bytes: &[u8]| files.write(name, bytes);
    small("one.pfm", &[b"Pf\n1 1\n-1.0\n".as_slice(), &1f32.to_le_bytes()].concat());
    small("nan.pfm", &[b"Pf\n2 1\n-1.0\n".as_slice(), &1f32.to_le_bytes(), &f32::NAN.to_le_bytes()].concat());
    small("short.pfm", b"Pf\n2 1\n-1.0\n1234");
    small("head.pfm", b"Pf\n2");
    small("text.png", b"not a picture");
    small("cut.png", &std::fs::read(files.path("grey.png")).unwrap()[..50]);
    small("nan.npy", &npy("<f8", false, &[2], &[1f64.to_le_bytes(), f64::NAN.to_le_bytes()].concat()));
    small("complex.npy", &npy("<c16", false, &[2], &[0; 32]));
    small("words.txt", b"1\n2\nthree\n");
    small("empty.txt", b"# nothing\n");
    for (kind, name, dim, said) in [
        ("image", "nowhere.png", 2, "No such file"),
        ("image", "one.pfm", 2, "a picture of one pixel is a constant"),
        ("image", "nan.pfm", 2, "row 1, column 2 is NaN; expected finite values"),
        ("image", "short.pfm", 2, "truncated PFM: 4 of 8 bytes of data"),
        ("image", "head.pfm", 2, "damaged PFM: expected Pf or PF, width, height and scale"),
        ("image", "text.png", 2, "this is no PNG, PFM or EXR"),
        ("image", "cut.png", 2, "damaged PNG"),
        ("image", "grey.png", 3, "image is there in 2D, this is 3D"),
        ("table", "nowhere.npy", 2, "No such file"),
        ("table", "nan.npy", 1, "value [1] is NaN; expected finite values"),
        ("table", "table2.npy", 3, "shape (4, 6); expected 3 axes, x first"),
        ("table", "complex.npy", 1, "dtype"),
        ("table", "words.txt", 1, "line 3: \"three\"; expected a number"),
        ("table", "empty.txt", 1, "0 values; expected two or more"),
        ("table", "steps.txt", 2, "this is no NPY; expected one with 2 axes (text is for 1D)"),
    ] {
        let error = files.refused(kind, name, dim);
        assert!(error.contains(said), "{name}: {error}");
    }
}
