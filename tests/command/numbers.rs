//! All numbers of a result in one file.

use std::collections::BTreeSet;
use std::io::Read as _;

use crate::shared::{Scratch, npy, summary};

#[test]
fn the_archive_holds_every_number_of_the_tables_and_arrays() {
    let scratch = Scratch::new();
    scratch.fails("analyze --sampler random -n 9 --npz", 2, "--out");
    scratch.ok(
        "analyze --sampler jittered -n 64 -k 40 --stats pcf,pcf-vector,k-function,spectrum,covariance,neighbors,counts,discrepancy,intensity --lag-bins 8 \
         --integrand disk --device cpu --npz --keep-sums --out o",
    );
    let listed: Vec<String> = serde_json::from_value(summary(&scratch.path("o"))["files"].clone()).unwrap();
    assert!(listed.contains(&"results.npz".to_string()));
    let mut archive = zip::ZipArchive::new(std::fs::File::open(scratch.path("o/results.npz")).unwrap()).unwrap();
    let mut names: BTreeSet<String> = archive.file_names().map(|name| name.unwrap().into_owned()).collect();
    let mut array = |name: &str| {
        let mut bytes = Vec::new();
        archive.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
        bytes
    };
    let (mut arrays, mut columns) = (0, 0);
    for file in &listed {
        let path = scratch.path("o").join(file);
        if let Some(stem) = file.strip_suffix(".npy") {
            assert_eq!(array(&format!("{stem}.npy")), std::fs::read(&path).unwrap(), "{file}");
            assert!(names.remove(&format!("{stem}.npy")));
            arrays += 1;
        }
        let Some(stem) = file.strip_suffix(".csv") else { continue };
        // Specifications of integrands have commas.
        let mut reader = csv::Reader::from_path(&path).unwrap();
        let header: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        for (k, column) in header.iter().enumerate() {
            let cells: Vec<&str> = rows.iter().map(|row| &row[k]).collect();
            let name = format!("{stem}/{column}.npy");
            let numeric = cells.iter().all(|cell| cell.is_empty() || cell.parse::<f64>().is_ok());
            if !names.remove(&name) {
                let words = cells.iter().any(|cell| cell.parse::<f64>().is_err());
                assert!(words, "{file} {column} is left out: {cells:?}");
                continue;
            }
            assert!(numeric, "{name}");
            let bytes = array(&name);
            let file = npyz::NpyFile::new(bytes.as_slice()).unwrap();
            assert_eq!(file.shape(), [cells.len() as u64], "{name}");
            let values: Vec<f64> = match file.dtype().descr().contains("u8") {
                true => file.into_vec::<u64>().unwrap().into_iter().map(|x| x as f64).collect(),
                false => file.into_vec().unwrap(),
            };
            for (cell, value) in cells.iter().zip(values) {
                assert!(cell.parse().map_or(value.is_nan(), |cell: f64| cell == value), "{name}: {cell}, {value}");
            }
            columns += 1;
        }
    }
    assert_eq!(names, BTreeSet::new(), "nothing else");
    assert!(arrays >= 6 && columns > 60, "{arrays} arrays, {columns} columns");
    assert_eq!(npy(&scratch.path("o/spectrum.npy")).0.len(), 2);
    // Of parts too; not of many measurements.
    scratch.ok("merge o --npz --out m");
    assert_eq!(
        std::fs::read(scratch.path("m/results.npz")).unwrap().len(),
        std::fs::read(scratch.path("o/results.npz")).unwrap().len()
    );
    scratch.fails(
        "analyze --sampler random -n 9 --npz --projections --out p",
        2,
        "--npz (given): is of one measurement",
    );
}
