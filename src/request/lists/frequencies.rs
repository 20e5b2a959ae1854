//! Wave vectors, one per line: the same files that hold points, read as frequencies.

use std::path::Path;

use crate::error::{Error, Result, number, plural};
use crate::plan::WaveList;
use crate::points::Domain;
use crate::points::read::{Columns, Input, ReadOptions, Rows, extension, read_bytes, read_whole};
use crate::setting::Setting;

/// Frequencies from here on are refused: 2^31 cycles per side.
const LIMIT: f64 = 2_147_483_648.0;

/// Reads `--frequencies`: on a torus integers m, in cycles per side; in a window cycles per unit length. The file may be any
/// that could hold points with as many coordinates as `domain` has axes; a header is optional, `#` starts a comment. Where the
/// header names m_x, m_y or nu_x, nu_y other columns may stand beside them. The order is kept, and so are repetitions. Returns
/// also what was read, in words.
///
/// # Errors
/// What the file system says; what is no wave vector, by its place.
pub fn read_frequencies(path: &Path, domain: &Domain) -> Result<(WaveList, String)> {
    let (name, bytes) = read_whole(path)?;
    frequencies_of_bytes(Path::new(&name), &bytes, domain)
}

/// The same of the bytes of a file, which `path` is the name of.
///
/// # Errors
/// What is no wave vector, by its place.
pub fn frequencies_of_bytes(path: &Path, bytes: &[u8], domain: &Domain) -> Result<(WaveList, String)> {
    let name = path.display().to_string();
    let dim = domain.dim();
    let mut vectors = Vec::new();
    let mut read = Input::default();
    let columns = Columns { rows: Rows::WaveVectors { per_side: domain.is_torus() }, ..Columns::default() };
    for set in read_bytes(&name, &extension(path), bytes, &ReadOptions { dim: Some(dim), raw: None }, &columns)? {
        if let Some(column) = set.reading.columns.iter().find(|name| is_angular(name)) {
            let (unit, names) = match domain.is_torus() {
                true => ("integers m, cycles per side of the torus", "m_x, m_y"),
                false => ("cycles per unit length", "nu_x, nu_y"),
            };
            let reason = format!(
                "column {column} is by its name an angular frequency, 2 pi times cycles per unit length; expected {unit}: \
                 convert, and call the columns {names}"
            );
            return Err(Error::input(path.display().to_string(), reason));
        }
        if let Some(reason) = misnamed(&set.reading.columns, domain) {
            return Err(Error::input(path.display().to_string(), reason));
        }
        read.see(&set.reading);
        let set = set.points;
        let place = |j: usize| match set.lines.is_empty() {
            true => format!("{}, wave vector {j}", set.source),
            false => set.place(j),
        };
        if set.dim != dim {
            let reason = format!(
                "{} per wave vector, but the points have {}",
                plural(set.dim as u64, "number"),
                plural(dim as u64, "coordinate")
            );
            return Err(Error::input(place(0), reason));
        }
        for (j, frequency) in set.coordinates.chunks_exact(dim).enumerate() {
            let mut vector = [0.0; 3];
            for (k, &value) in frequency.iter().enumerate() {
                let cycles = if domain.is_torus() { value } else { value * domain.sides()[k] };
                if let Some(reason) = refused(cycles, value, k, domain) {
                    return Err(Error::input(place(j), reason));
                }
                // Without a sign where it is 0.
                vector[k] = cycles + 0.0;
            }
            vectors.push(vector);
        }
    }
    let list = WaveList { dim, vectors, mirrored: false };
    list.check_size(Setting::Frequencies, path.display())?;
    let unit = if domain.is_torus() { "cycles per side" } else { "cycles per unit length" };
    let many = plural(list.vectors.len() as u64, "wave vector");
    let said = format!("frequencies {}: {}, {many} in {unit}", path.display(), read.taken());
    Ok((list, said))
}

/// Whether a column is called as angular frequencies are: kx, k_y, q1, omega.
fn is_angular(name: &str) -> bool {
    let plain: String = name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    let stems = ["wavenumber", "wavevector", "omega", "\u{3c9}", "k", "q"];
    let end =
        |stem: &str| plain.strip_prefix(stem).is_some_and(|end| ["", "x", "y", "z", "0", "1", "2", "3"].contains(&end));
    // With a unit: `kx (rad/m)`.
    stems.into_iter().any(end) || name.contains("rad/") || plain.starts_with("angular") || {
        let bare = name.split(['(', '[']).next().unwrap_or_default().trim();
        bare.len() < name.len() && is_angular(bare)
    }
}

/// What the names of columns say against taking them in this order and unit: `nu_x` on a torus, `m_x` in a window (the same
/// only where sides are 1), `nu_y` before `nu_x`.
fn misnamed(columns: &[String], domain: &Domain) -> Option<String> {
    let given = if domain.is_torus() { "m" } else { "nu" };
    for (axis, name) in columns.iter().enumerate() {
        let plain: String = name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
        let bare = plain.trim_end_matches(['x', 'y', 'z']);
        let stem = match bare {
            "nu" | "\u{3bd}" => "nu",
            "m" => "m",
            "f" => given,
            _ => continue,
        };
        if stem != given && domain.sides().get(axis).is_some_and(|&side| side != 1.0) {
            let (unit, other) = match given {
                "m" => ("integers m, cycles per side", "nu is in cycles per unit length: multiply by the side"),
                _ => ("nu, cycles per unit length", "m is in cycles per side: divide by the side"),
            };
            return Some(format!("column {name}: expected {unit}; {other}"));
        }
        let place = ["x", "y", "z"].iter().position(|axis| plain[bare.len()..] == **axis);
        if place.is_some_and(|place| place != axis) {
            return Some(format!("column {name} stands in place {}; expected the axes in order, x first", axis + 1));
        }
    }
    None
}

/// Why a coordinate of a wave vector cannot be used.
fn refused(cycles: f64, value: f64, axis: usize, domain: &Domain) -> Option<String> {
    let axis = ["x", "y", "z"][axis];
    let value = number(value);
    if domain.is_torus() {
        let expected = "expected an integer with magnitude below 2^31: cycles per side of the torus";
        let good = cycles.fract() == 0.0 && cycles.abs() < LIMIT;
        return (!good).then(|| format!("m_{axis} = {value}; {expected}"));
    }
    let expected = "expected cycles per unit length, less than 2^31 of them per side of the window";
    // Written so that NaN fails.
    let good = cycles.abs() < LIMIT;
    (!good).then(|| format!("nu_{axis} = {value}; {expected}"))
}
