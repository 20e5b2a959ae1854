//! The test over all values of two results: how often it finds a difference where there is none, and where there is one. The tables are
//! written here, as a result has them.

use std::path::{Path, PathBuf};

use crate::common::Rng;
use pairwave::comparison::compare;

const ROWS: usize = 200;
const K: usize = 20;

/// A result of K realizations whose g in each bin is 1 and a normal error; that of bin `at` is larger by `shift` standard errors.
fn result(dir: &Path, bits: &mut Rng, at: usize, shift: f64) -> PathBuf {
    let mut normal = || (-2.0 * (1.0 - bits.unit()).ln()).sqrt() * (std::f64::consts::TAU * bits.unit()).cos();
    let mut text = "r_lo,r,r_hi,count,g,g_se\n".to_string();
    for row in 0..ROWS {
        let all: Vec<f64> = (0..K).map(|_| normal()).collect();
        let mean = all.iter().sum::<f64>() / K as f64;
        let se = (all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (K * (K - 1)) as f64).sqrt();
        let shifted = 1.0 + mean + if row == at { shift / (K as f64).sqrt() } else { 0.0 };
        let r = row as f64 / 100.0;
        text += &format!("{r},{},{},9,{shifted},{se}\n", r + 0.005, r + 0.01);
    }
    std::fs::create_dir_all(dir).unwrap();
    std::fs::write(dir.join("pcf.csv"), text).unwrap();
    std::fs::write(dir.join("summary.json"), format!("{{\"program\": \"pairwave\", \"k\": {K}}}")).unwrap();
    dir.into()
}

#[test]
fn the_level_holds_over_many_rows_and_a_shift_of_one_is_found() {
    const PAIRS: usize = 300;
    let folder = tempfile::tempdir().unwrap();
    let mut bits = Rng(7);
    let mut found = |shift: f64| {
        let mut differ = 0;
        for _ in 0..PAIRS {
            let a = result(&folder.path().join("a"), &mut bits, 0, 0.0);
            let b = result(&folder.path().join("b"), &mut bits, 123, shift);
            let found = compare(&[a, b], 0.05).unwrap();
            assert_eq!((found.columns.len(), found.columns[0].rows, found.values.len()), (1, ROWS, ROWS));
            differ += usize::from(found.differ && (shift == 0.0 || found.columns[0].place == "r 1.23 to 1.24"));
        }
        differ as f64 / PAIRS as f64
    };
    // Of 300, a share of 0.05 has a standard deviation of 0.0126. Without correction all would differ.
    let level = found(0.0);
    assert!((0.01..=0.09).contains(&level), "{level}");
    let power = found(10.0);
    assert!(power > 0.95, "{power}");
}
