//! Curves of P: over rings, along axes, by direction; and their captions.

use crate::display::figure::{BLUE, Figure, GREEN, GREY, Layer, Of, SKY, Stroke, VERMILION, band_runs, runs};
use crate::display::{
    FrequencyUnit, Panel, Units, about_one, defined_anisotropy, error_note, human, inhomogeneous_caption,
    size_and_weights, top_of,
};
use crate::estimate::{Analysis, AxisMode, Band, SectorPower};
use crate::statistics::axes;
use crate::statistics::layers::{closed_form, cut, half_turn};

/// Below this many realizations the band of a single mode fills the frame and is left to the file.
const BANDS_FROM: f64 = 10.0;

/// P against nu, with its band, P = 1, the closed form and the mean sampling frequency.
pub(super) fn radial(analysis: &Analysis) -> Option<Figure> {
    let radial = analysis.radial()?;
    let rings = &radial.rings;
    let samples = Panel::Radial.samples(analysis)?;
    let x = 0.0..rings.last()?.nu_hi;
    let confidence = rings.iter().map(|r| ((r.nu_lo, r.nu, r.nu_hi), r.band.map(|b| (b.lo, b.hi))));
    let mut layers = vec![
        Layer::Level { name: "P = 1".into(), y: 1.0 },
        Layer::Band { name: "95 %".into(), color: SKY, runs: band_runs(confidence) },
        Layer::Band { name: "±1 s.e.".into(), color: BLUE, runs: band_runs(samples.bands()) },
        Layer::Line {
            name: "radial mean".into(),
            color: BLUE,
            width: 1.6,
            stroke: Stroke::Solid,
            runs: runs(samples.values()),
            of: Of::Column("p".into()),
        },
    ];
    layers.extend(closed_form(analysis, &samples, analysis.closed_form.radial.is_some()));
    layers.extend(mean_frequency(analysis, x.end));
    let units = Units::of(analysis).escaped();
    Some(Figure {
        title: axes::RADIAL.title_of(analysis),
        subject: analysis.subject.clone(),
        note: format!(
            "{} · {}{}",
            size_and_weights(analysis),
            error_note(radial.errors, "exponential ordinates"),
            cut(rings.iter().map(|r| r.p), samples.range.end)
        ),
        x_label: axes::RADIAL.x_label(&units),
        y_label: axes::RADIAL.y_label(&units),
        x,
        y: samples.range,
        log_x: false,
        log_y: false,
        top: None,
        layers,
        numbers: axes::RADIAL.numbers(),
    })
}

/// P in a formula.
pub(super) const DEFINITION: &str = "<i>P</i>(<b>m</b>) = ∑<sub><i>k</i></sub> \
    |∑<sub><i>j</i></sub> exp(−2π<i>i</i> <b>m</b>·<b>x</b><sub><i>j</i></sub>/<i>L</i>)|<sup>2</sup> / \
    ∑<sub><i>k</i></sub> <i>n<sub>k</sub></i>";

/// What the picture of the radial mean shows.
pub(super) fn radial_caption(a: &Analysis, _: &str) -> Option<String> {
    let rings = match a.conventions.foreign {
        false => "the modes with |<b>m</b>/<i>L</i>| in rings around <i>ν</i>, zero frequency left out".into(),
        true => format!("the rings of {} (<i>ν</i> in {})", a.conventions.of, a.conventions.labels),
    };
    Some(format!(
        "{DEFINITION}, averaged over {rings}; 1 is the level of independent points. The wider band holds the \
         expectation with probability 95 %: by the chi-squared law of exponential ordinates, or from 30 realizations and \
         100 ordinates on by the standard error across realizations.{}",
        inhomogeneous_caption(a)
    ))
}

/// Of a list there is no picture.
pub(super) fn words(a: &Analysis) -> Option<String> {
    let listed = a.listed_power()?.p.len();
    let weights = inhomogeneous_caption(a);
    Some(format!("{DEFINITION} at {listed} listed wave vectors: see spectrum_list.csv.{weights}"))
}

/// Anisotropy against nu, with the level of an isotropic spectrum and the scatter expected around it. In one dimension a
/// ring is a single independent mode: there is nothing to draw.
pub(super) fn anisotropy(analysis: &Analysis) -> Option<Figure> {
    let samples = Panel::Anisotropy.samples(analysis)?;
    let radial = analysis.radial()?;
    let rings = &radial.rings;
    let reference = radial.anisotropy_reference_db;
    let x = 0.0..rings.last()?.nu_hi;
    let defined = defined_anisotropy(radial);
    let y = samples.range.clone();
    let outside = defined.iter().filter(|a| !y.contains(a)).count();

    let db = human(reference);
    let mut layers = vec![
        Layer::Band { name: "expected scatter, ±1 s.d.".into(), color: GREY, runs: band_runs(samples.bands()) },
        Layer::Level { name: format!("isotropic: {db} dB"), y: reference },
        Layer::Line {
            name: "anisotropy".into(),
            color: BLUE,
            width: 1.6,
            stroke: Stroke::Solid,
            runs: runs(samples.values()),
            of: Of::Column("anisotropy_db".into()),
        },
    ];
    layers.extend(mean_frequency(analysis, x.end));
    let mut note = format!("{} · grey band: ±1 s.d. of an isotropic spectrum, from theory", size_and_weights(analysis));
    if defined.is_empty() {
        note.push_str(" · undefined in every ring: no spread, or single modes");
    } else if outside > 0 {
        note.push_str(&format!(" · outside the frame: {outside} of {} rings", rings.len()));
    }
    let units = Units::of(analysis).escaped();
    Some(Figure {
        title: axes::ANISOTROPY.title_of(analysis),
        subject: analysis.subject.clone(),
        note,
        x_label: axes::ANISOTROPY.x_label(&units),
        y_label: axes::ANISOTROPY.y_label(&units),
        x,
        y,
        log_x: false,
        log_y: false,
        top: None,
        layers,
        numbers: axes::ANISOTROPY.numbers(),
    })
}

/// What the picture of anisotropy shows.
pub(super) fn anisotropy_caption(_: &Analysis, _: &str) -> Option<String> {
    Some(
        "10 log<sub>10</sub>(<i>s</i><sup>2</sup> / <i>P</i>(<i>ν</i>)<sup>2</sup>) in dB, with \
         <i>s</i><sup>2</sup> the variance of <i>P</i>(<b>m</b>) over the independent modes of a ring; an isotropic \
         spectrum that is the average of <i>K</i> independent ones (of realizations, and of each one's tapers) scatters \
         around −10 log<sub>10</sub> <i>K</i>."
        .into(),
    )
}

/// P against nu along every axis.
pub(super) fn along_axes(analysis: &Analysis) -> Option<Figure> {
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
        let letter = ["x", "y", "z"][axis];
        layers.push(Layer::Line {
            name: format!("along {letter}"),
            color: colors[axis],
            width: 1.3,
            stroke: Stroke::Solid,
            runs: line,
            of: Of::Rows("p", "axis", letter.into()),
        });
    }
    layers.extend(mean_frequency(analysis, end));
    let bands = if banded { "bands: 95 % of each mode" } else { "single modes; their 95 % bands are in the file" };
    let units = Units::of(analysis).escaped();
    (end > 0.0).then(|| Figure {
        title: axes::AXES.title_of(analysis),
        subject: analysis.subject.clone(),
        note: format!("{} · {bands}{}", size_and_weights(analysis), cut(modes.iter().map(|m| m.p), top)),
        x_label: axes::AXES.x_label(&units),
        y_label: axes::AXES.y_label(&units),
        x: 0.0..end,
        y: 0.0..top,
        log_x: false,
        log_y: false,
        top: None,
        layers,
        numbers: axes::AXES.numbers(),
    })
}

/// What the picture of the axes shows.
pub(super) fn axes_caption(_: &Analysis, _: &str) -> Option<String> {
    Some(
        "<i>P</i> at the wave vectors along each axis: the power of the points' projections onto it. A point set \
         that is stratified along an axis has low power there. Each is a single mode, so that it scatters more than a \
         ring."
            .into(),
    )
}

/// Power by direction, relative to an isotropic spectrum with the same ring means. Opposite directions are the same, so 0 to 180
/// degrees are all.
pub(super) fn angular(analysis: &Analysis) -> Option<Figure> {
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
            stroke: Stroke::Solid,
            runs: runs(samples.iter().map(|&(x, s)| (x, s.ratio))),
            of: Of::Column("ratio".into()),
        },
    ];
    let units = Units::of(analysis).escaped();
    Some(Figure {
        title: axes::ANGULAR.title_of(analysis),
        subject: analysis.subject.clone(),
        note: format!(
            "{} · {} sectors of {} degrees",
            size_and_weights(analysis),
            sectors.len(),
            180.0 / sectors.len() as f64
        ),
        x_label: axes::ANGULAR.x_label(&units),
        y_label: axes::ANGULAR.y_label(&units),
        x: 0.0..180.0,
        y,
        log_x: false,
        log_y: false,
        top: None,
        layers,
        numbers: axes::ANGULAR.numbers(),
    })
}

/// What the picture of directions shows.
pub(super) fn angular_caption(_: &Analysis, _: &str) -> Option<String> {
    Some(
        "Mean of <i>P</i> over the modes of whole rings whose frequency <b>m</b>/<i>L</i> lies in a sector of \
         directions, over the mean of the ring means at the same modes: 1 for an isotropic spectrum, however steep. \
         Opposite directions are the same."
            .into(),
    )
}

/// The frequency of one cycle per mean spacing, `lambda^(1/d)`, if it lies in the frame.
fn mean_frequency(analysis: &Analysis, end: f64) -> Option<Layer> {
    if analysis.conventions.foreign {
        return None;
    }
    let unit = FrequencyUnit::SqrtN;
    let nu = unit.size(&analysis.domain, analysis.shape.mean_points);
    let symbol = unit.symbol(&analysis.domain, analysis.unit);
    (nu > 0.0 && nu < end).then(|| Layer::Hint { x: nu, label: format!("{symbol} = {}", human(nu)) })
}
