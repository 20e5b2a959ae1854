//! Colour maps, even in lightness and told apart by colour-blind readers. The diverging one of the reports, blue, white, red:
//! Moreland, "Diverging Color Maps for Scientific Visualization", ISVC 2009: linear in a polar form of CIELAB (M: length,
//! s: angle from the grey axis, h: hue), from his blue over his white to his red.

/// A map from [0, 1] to colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorMap {
    /// Dark blue through green to yellow (van der Walt and Smith 2015).
    Viridis,
    /// Blue through grey to yellow, made for colour-blind readers (Nunez et al. 2018).
    Cividis,
    /// Black through red to pale yellow.
    Inferno,
    /// Black through purple to cream.
    Magma,
    /// Black to white, even in L* of CIELAB.
    Grey,
    /// Blue, white, red (Moreland 2009).
    BlueRed,
    /// Purple, white, orange (ColorBrewer's PuOr).
    PurpleOrange,
}

impl ColorMap {
    /// Maps from low to high, for P; the first is that of the reports.
    pub const SEQUENTIAL: [Self; 5] = [Self::Viridis, Self::Cividis, Self::Inferno, Self::Magma, Self::Grey];
    /// Maps that part in the middle, for g about 1; the first is that of the reports.
    pub const DIVERGING: [Self; 2] = [Self::BlueRed, Self::PurpleOrange];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viridis => "viridis",
            Self::Cividis => "cividis",
            Self::Inferno => "inferno",
            Self::Magma => "magma",
            Self::Grey => "grey",
            Self::BlueRed => "blue to red",
            Self::PurpleOrange => "purple to orange",
        }
    }

    /// The colour at `x` in [0, 1], as 8-bit sRGB. NaN is the low end of a sequential map and the middle of a diverging one.
    pub fn color(self, x: f64) -> [u8; 3] {
        let of = |gradient: colorous::Gradient, x: f64| {
            let color = gradient.eval_continuous(x);
            [color.r, color.g, color.b]
        };
        let rising = if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) };
        match self {
            Self::Viridis => of(colorous::VIRIDIS, rising),
            Self::Cividis => of(colorous::CIVIDIS, rising),
            Self::Inferno => of(colorous::INFERNO, rising),
            Self::Magma => of(colorous::MAGMA, rising),
            Self::Grey => srgb([100.0 * rising, 0.0, 0.0]),
            Self::BlueRed => diverging(x),
            Self::PurpleOrange => of(colorous::PURPLE_ORANGE, if x.is_nan() { 0.5 } else { rising }),
        }
    }
}

/// Ends of the map, (M, s, h).
const BLUE: [f64; 3] = [80.0, 1.08, -1.1];
const RED: [f64; 3] = [80.0, 1.08, 0.5];
/// M of the white in the middle.
const WHITE: f64 = 88.0;

/// The colour at `x` in [0, 1], as 8-bit sRGB; 1/2 is white, NaN too.
pub(crate) fn diverging(x: f64) -> [u8; 3] {
    let x = if x.is_nan() { 0.5 } else { x.clamp(0.0, 1.0) };
    let end = if x < 0.5 { BLUE } else { RED };
    // On the way to white the hue turns, so that the path stays even.
    let spin = end[1] * (WHITE * WHITE - end[0] * end[0]).sqrt() / (end[0] * end[1].sin());
    let white = [WHITE, 0.0, end[2] + spin.copysign(end[2])];
    let t = (2.0 * x - 1.0).abs();
    let [m, s, h]: [f64; 3] = std::array::from_fn(|k| white[k] + t * (end[k] - white[k]));
    srgb([m * s.cos(), m * s.sin() * h.cos(), m * s.sin() * h.sin()])
}

/// The colour of the reports for P at `x` in [0, 1].
pub(crate) fn sequential(x: f64) -> [u8; 3] {
    ColorMap::Viridis.color(x)
}

/// CIELAB (white point D65) to 8-bit sRGB (IEC 61966-2-1).
fn srgb([l, a, b]: [f64; 3]) -> [u8; 3] {
    let y = (l + 16.0) / 116.0;
    let linear = |t: f64| if t > 6.0 / 29.0 { t.powi(3) } else { 3.0 * (6f64 / 29.0).powi(2) * (t - 4.0 / 29.0) };
    let [x, y, z] = [0.95047 * linear(y + a / 500.0), linear(y), 1.08883 * linear(y - b / 200.0)];
    let rgb = [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266_0 * x + 1.876_010_8 * y + 0.041_556_0 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ];
    rgb.map(|v| {
        let v = if v > 0.003_130_8 { 1.055 * v.powf(1.0 / 2.4) - 0.055 } else { 12.92 * v };
        (255.0 * v.clamp(0.0, 1.0)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_colours_are_those_of_the_paper() {
        // Table of the paper: ends (59, 76, 192) and (180, 4, 38), middle (221, 221, 221).
        for (x, expected) in [(0.0, [59, 76, 192]), (0.5, [221, 221, 221]), (1.0, [180, 4, 38])] {
            let found = diverging(x);
            assert!(found.iter().zip(expected).all(|(&a, b): (&u8, u8)| a.abs_diff(b) <= 2), "{x}: {found:?}");
        }
    }

    #[test]
    fn maps_are_even_in_lightness_and_part_in_the_middle() {
        // Rec. 709 luma stands for lightness: enough to see an order.
        let light = |map: ColorMap, x: f64| {
            let [r, g, b] = map.color(x).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let steps = |from: f64, to: f64| (0..=16).map(move |k| from + (to - from) * f64::from(k) / 16.0);
        for map in ColorMap::SEQUENTIAL {
            let l: Vec<f64> = steps(0.0, 1.0).map(|x| light(map, x)).collect();
            assert!(l.windows(2).all(|w| w[0] < w[1]), "{map:?}: {l:?}");
            assert_eq!(map.color(f64::NAN), map.color(0.0));
        }
        for map in ColorMap::DIVERGING {
            for end in [0.0, 1.0] {
                let l: Vec<f64> = steps(end, 0.5).map(|x| light(map, x)).collect();
                assert!(l.windows(2).all(|w| w[0] < w[1]), "{map:?}: {l:?}");
            }
            assert_eq!(map.color(f64::NAN), map.color(0.5));
            let ([r0, _, b0], [r1, _, b1]) = (map.color(0.1), map.color(0.9));
            assert!(b0 > r0 && r1 > b1, "{map:?}: below 1 is bluish, above reddish");
        }
    }
}
