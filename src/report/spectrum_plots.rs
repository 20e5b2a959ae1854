//! Pictures of P along axes and by direction.

use super::figure::{BLUE, Figure, GREEN, Layer, VERMILION, band_runs, runs};
use super::plots::{Svg, cut, half_turn, mean_frequency};
use crate::display::{about_one, size, top_of};
use crate::estimate::{Analysis, AxisMode, Band, SectorPower};

/// Below this many realizations the band of a single mode fills the frame and is left to the file.
const BANDS_FROM: f64 = 10.0;

/// P against nu along every axis.
pub(super) fn axes(analysis: &Analysis) -> Option<Svg> {
    let modes = &analysis.details()?.axes.modes;
    let end = modes.iter().map(|m| m.nu).fold(0.0, f64::max);
    let banded = analysis.radial().is_some_and(|r| r.realizations >= BANDS_FROM);
    let values: Vec<(f64, f64)> = modes.iter().map(|m| (m.p, if banded { m.p_se } else { 0.0 })).collect();
    let top = top_of(&values, &[]);
    let mut layers = vec![Layer::Level { name: "P = 1".into(), y: 1.0 }];
    let slices: Vec<&[AxisMode]> = modes.chunk_by(|a, b| a.axis == b.axis).collect();
    let colors = [BLUE, VERMILION, GREEN];
    let half = |s: &[AxisMode]| 0.5 * s[0].nu / s[0].m;
    let interval = |m: &AxisMode, half: f64| (m.nu - half, m.nu, (m.nu + half).min(end));
    for slice in slices.iter().filter(|_| banded) {
        let half = half(slice);
        let band = slice.iter().map(|m| (interval(m, half), m.band.map(|b| (b.lo, b.hi))));
        layers.push(Layer::Band { name: String::new(), color: colors[slice[0].axis], runs: band_runs(band) });
    }
    for slice in slices {
        let (half, axis) = (half(slice), slice[0].axis);
        let line = runs(slice.iter().map(|m| (interval(m, half), Some(m.p))));
        let name = format!("along {}", ["x", "y", "z"][axis]);
        layers.push(Layer::Line { name, color: colors[axis], width: 1.3, dashed: false, runs: line });
    }
    layers.extend(mean_frequency(analysis, end));
    let bands = if banded { "bands: 95 % of each mode" } else { "single modes; their 95 % bands are in the file" };
    let figure = Figure {
        title: "Power spectrum along the axes",
        subject: analysis.subject.clone(),
        note: format!("{} · {bands}{}", size(analysis), cut(modes.iter().map(|m| m.p), top)),
        x_label: "frequency ν (cycles per unit length)".into(),
        y_label: "P(ν) (dimensionless)".into(),
        x: 0.0..end,
        y: 0.0..top,
        log_x: false,
        log_y: false,
        top: None,
        layers,
    };
    (end > 0.0).then(|| figure.svg())
}

/// Power by direction, relative to an isotropic spectrum with the same ring means. Opposite directions are the same, so 0 to 180
/// degrees are all.
pub(super) fn angular(analysis: &Analysis) -> Option<Svg> {
    let sectors = &analysis.details()?.angular.as_ref()?.sectors;
    let samples: Vec<_> = half_turn(sectors, |s| s.theta).collect();
    let relative = |s: &SectorPower| {
        let expected = s.p / s.ratio.filter(|r| *r > 0.0)?;
        let Band { lo, hi, .. } = s.band?;
        Some((lo / expected, hi / expected))
    };
    let ratios = sectors.iter().filter_map(|s| s.ratio);
    let ends: Vec<f64> = sectors.iter().filter_map(relative).flat_map(|(lo, hi)| [lo, hi]).chain(ratios).collect();
    let y = about_one(&ends)?;
    let layers = vec![
        Layer::Level { name: "isotropic".into(), y: 1.0 },
        Layer::Band {
            name: "95 %".into(),
            color: BLUE,
            runs: band_runs(samples.iter().map(|&(x, s)| (x, relative(s)))),
        },
        Layer::Line {
            name: "sector over ring means".into(),
            color: BLUE,
            width: 1.6,
            dashed: false,
            runs: runs(samples.iter().map(|&(x, s)| (x, s.ratio))),
        },
    ];
    let figure = Figure {
        title: "Power by direction",
        subject: analysis.subject.clone(),
        note: format!("{} · {} sectors of {} degrees", size(analysis), sectors.len(), 180.0 / sectors.len() as f64),
        x_label: "direction θ of the frequency (degrees from the x axis)".into(),
        y_label: "P(θ) / P if isotropic (dimensionless)".into(),
        x: 0.0..180.0,
        y,
        log_x: false,
        log_y: false,
        top: None,
        layers,
    };
    Some(figure.svg())
}
