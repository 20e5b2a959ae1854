//! The covariance of the amplitudes of low frequencies.

mod image;
mod products;
mod summary;

use rustfft::num_complex::Complex;

use super::group::{Ask, Parts};
use super::{Array, Keys, Output, Room, Values};
use crate::display::human;
use crate::error::Result;
use crate::estimate::Analysis;

/// The covariance in a report.
pub(crate) struct Here;

impl Room for Here {
    fn plan(&self, ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
        products::plan(ask, parts)
    }

    fn outputs(&self) -> &'static [Output] {
        const {
            &[
                Output::array("covariance.npy", c),
                Output::array("covariance_se.npy", c_se),
                Output::image("covariance.png", image::image, "Covariance of amplitudes", image::caption),
            ]
        }
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        keys.add("covariance", &summary::covariance(a))
    }

    fn headline(&self, a: &Analysis) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(covariance) = a.covariance() {
            let z = covariance
                .scalars
                .rms_z
                .map_or(String::new(), |z| format!(", root mean square {} standard errors", human(z)));
            let share = human(covariance.scalars.off_diagonal_share);
            lines.push(format!("C(m, l): {0} x {0}, off the diagonal {share} of all |C|²{z}", covariance.modes()));
        }
        lines
    }
}

/// Row by row, m first.
fn c(a: &Analysis) -> Option<Array<'_>> {
    let covariance = a.covariance()?;
    let values = Box::new(covariance.c.iter().map(|&[re, im]| Complex { re, im }));
    Some(Array { shape: vec![covariance.modes() as u64; 2], values: Values::Complex(values) })
}

fn c_se(a: &Analysis) -> Option<Array<'_>> {
    let covariance = a.covariance()?;
    let values = Box::new(covariance.c_se.as_ref()?.iter().copied());
    Some(Array { shape: vec![covariance.modes() as u64; 2], values: Values::Real(values) })
}
