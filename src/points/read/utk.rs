//! UTK's `.bin`: magic `UTK!`, a type byte and three spare ones, then u32 m, n, d (sets, points per set, coordinates
//! per point), then the numbers, all little endian (utk `io/` and its README, "File formats").
//!
//! Integers are coordinates as they stand: UTK's own reader casts them without scaling.

use super::{Apart, Columns, Element, Sets, check_length};
use crate::error::{Error, Result};
use crate::points::write::UTK_SETS_DIFFER;

pub(super) const MAGIC: [u8; 4] = 0x214B_5455_u32.to_le_bytes();
const HEADER: usize = 20;

pub(super) fn read(name: &str, bytes: &[u8], columns: &Columns) -> Result<Sets> {
    let rows = columns.rows;
    let Some((header, data)) = bytes.split_at_checked(HEADER) else {
        let reason = format!("truncated: the header of a UTK .bin has {HEADER} bytes, found {}", bytes.len());
        return Err(Error::input(name, reason));
    };
    let (words, _) = header.as_chunks::<4>();
    let word = |i: usize| u32::from_le_bytes(words[i]);
    let (m, n, d) = (word(2), word(3), word(4));
    let element = match header[4] {
        0 => Element::I32,
        1 => Element::I64,
        2 => Element::U32,
        3 => Element::U64,
        4 => Element::F32,
        5 => Element::F64,
        code => {
            let reason = format!(
                "unknown UTK type code {code}; expected 0 (i32), 1 (i64), 2 (u32), 3 (u64), 4 (f32) or 5 (f64)"
            );
            return Err(Error::input(name, reason));
        }
    };
    let (one, number) = (rows.one(), rows.number());
    if !(1..=columns.most_axes()).contains(&(d as usize)) && columns.coordinates.is_empty() {
        return Err(Error::input(
            name,
            format!("{d} {number}s per {one}; 1, 2 or 3 are supported, and `columns` chooses them, as in 1,2"),
        ));
    }
    if m == 0 || (n == 0 && m > 1) {
        return Err(Error::input(name, format!("no {one}s: {m} sets of {n} {one}s")));
    }
    let what = format!("a header of {m} sets of {n} {one}s with {d} {number}s");
    let per_set = u64::from(n) * u64::from(d);
    check_length(name, &what, per_set.checked_mul(u64::from(m)), element, data)?;
    let set_bytes = (data.len() / m as usize).max(1);
    let sets: Vec<&[u8]> = if n == 0 { vec![&[]] } else { data.chunks_exact(set_bytes).collect() };
    if m > 1 && header[5] != UTK_SETS_DIFFER && sets.iter().all(|set| *set == sets[0]) {
        // Error bars over copies would be zero.
        let reason = format!(
            "its {m} sets are byte for byte the same: UTK writes the first set m times into a .bin; export text (.dat) instead"
        );
        return Err(Error::input(name, reason));
    }
    Ok(Sets {
        width: d as usize,
        sets: sets.iter().map(|set| element.decode(set, false)).collect(),
        first: None,
        names: Vec::new(),
        format: format!("UTK .bin of {}", element.name()),
        apart: if m > 1 { Apart::Sets } else { Apart::Files },
        digits: element.digits(),
    })
}
