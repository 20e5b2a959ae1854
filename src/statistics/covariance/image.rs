//! `covariance.png`: |C_ml| as a matrix, m downward and l to the right, zero frequency left out.

use crate::display::{DC, escape, human, sequential};
use crate::estimate::Analysis;
use crate::statistics::{At, Bar, Cells, Image, Steps};

/// Decades below the largest value that colours tell apart.
const DECADES: i32 = 4;

/// Pixels a small matrix is magnified towards, by a whole factor.
const TARGET: usize = 640;

/// Larger matrices are shown by the largest of each block.
const LARGEST: usize = 2048;

/// Nothing to be seen if all is 0.
pub(super) fn image(analysis: &Analysis) -> Option<Image> {
    let covariance = analysis.covariance()?;
    let (modes, dc) = (covariance.modes(), covariance.dc());
    let others = || (0..modes).filter(|&m| m != dc);
    let top = others().map(|m| covariance.magnitude(m, m)).fold(0.0, f64::max);
    let tone = |c: f64| (1.0 + (c / top).log10() / f64::from(DECADES)).clamp(0.0, 1.0);
    let block = modes.div_ceil(LARGEST);
    let cells = modes.div_ceil(block);
    let zoom = (TARGET / cells).max(1);
    let side = cells * zoom;
    let mut rgb = Vec::with_capacity(3 * side * side);
    let mut values = Vec::with_capacity(cells * cells);
    for row in 0..cells {
        let members = |cell: usize| (cell * block..((cell + 1) * block).min(modes)).filter(|&m| m != dc);
        let largest = |column: usize| {
            let pairs = members(row).flat_map(|m| members(column).map(move |l| (m, l)));
            pairs.map(|(m, l)| covariance.magnitude(m, l)).reduce(f64::max)
        };
        let of_row: Vec<Option<f64>> = (0..cells).map(largest).collect();
        values.extend(of_row.iter().map(|c| c.unwrap_or(f64::NAN)));
        let line: Vec<u8> = of_row
            .into_iter()
            .flat_map(|c| std::iter::repeat_n(c.map_or(DC, |c| sequential(tone(c))), zoom))
            .flatten()
            .collect();
        (0..zoom).for_each(|_| rgb.extend_from_slice(&line));
    }
    let largest = covariance.grid.max_frequency()[0];
    let shown = match block {
        1 => format!("each pair {zoom} x {zoom} pixels"),
        _ => format!("each pixel the largest of {block} x {block} pairs"),
    };
    let caption = format!(
        "m downward and l to the right, both in the order of covariance.npy, all |m_k| <= {largest} with x slowest and DC in \
         the middle, left out and grey; {shown}; logarithmic from {:.3e} to {top:.3e}, the largest P but DC",
        top * 10f64.powi(-DECADES)
    );
    let ticks =
        (0..=DECADES).map(|k| (f64::from(k) / f64::from(DECADES), human(top * 10f64.powi(k - DECADES)))).collect();
    let sizes = covariance.grid.full_shape();
    let vector = |cell: usize| {
        let mut rest = cell * block;
        let mut of_axis = |size: &usize| {
            let m = (rest % size) as i64 - (size / 2) as i64;
            rest /= size;
            m.to_string()
        };
        let mut vector: Vec<String> = sizes.iter().rev().map(&mut of_axis).collect();
        vector.reverse();
        format!("({})", vector.join(", "))
    };
    let axes = ["l", "m"].map(|name| Steps { name: name.into(), at: At::Named((0..cells).map(vector).collect()) });
    Some(Image {
        rgb,
        size: [side as u32; 2],
        title: "Covariance of amplitudes |C_ml|",
        description: format!("{caption}; colour map: viridis"),
        seen: caption,
        alt: "Covariance of amplitudes",
        bar: Bar::Sequential(ticks),
        cells: vec![Cells { place: [0.0, 0.0, 1.0, 1.0], axes, quantity: "|C_ml|", values }],
    })
}

/// What the picture shows.
pub(super) fn caption(a: &Analysis, seen: &str) -> Option<String> {
    let s = &a.covariance()?.scalars;
    let value = |x: Option<f64>| x.map_or("undefined".into(), human);
    Some(format!(
        "|<i>C<sub>ml</sub></i>| with <i>C<sub>ml</sub></i> = ∑<sub><i>k</i></sub> <i>s</i><sub><b>m</b></sub> \
         <i>s</i><sub><b>l</b></sub><sup>*</sup> / ∑<sub><i>k</i></sub> <i>n<sub>k</sub></i>: {}. Its diagonal is <i>P</i>; \
         off the diagonal the expectation is 0 for a stationary process. Without zero frequency, the share of all \
         |<i>C</i>|<sup>2</sup> off the diagonal is {} (by chance alone {}), the largest |<i>C</i>| there {} standard \
         errors, their root mean square {}.",
        escape(seen),
        human(s.off_diagonal_share),
        value(s.off_diagonal_share_by_chance),
        value(s.largest_z),
        value(s.rms_z)
    ))
}
