//! P as it is known without points: of a sampler in closed form, or of a result that lies in a directory.

use std::path::Path;

use crate::error::{Error, Result};
use crate::points::read::array_of_bytes;
use crate::report::Stored;
use crate::samplers::{ParameterValues, Process, find_with_parameters};
use crate::setting::Setting;

/// A spectrum.
pub(super) struct Spectrum {
    /// What it is of, in words.
    pub(super) subject: String,
    pub(super) dim: usize,
    /// The mean number of points it is of.
    pub(super) n: f64,
    /// How many realizations it is the mean of; `None` of a closed form.
    pub(super) realizations: Option<u64>,
    /// Whether every realization has as many points.
    pub(super) equal: bool,
    /// The variance of their number; `None` where it is not known.
    pub(super) count_variance: Option<f64>,
    pub(super) power: Power,
}

/// What is known of P.
pub(super) enum Power {
    /// A formula.
    Closed(Process),
    /// All frequencies up to a largest along each axis, the x axis slowest, m = 0 in the middle.
    Grid { reach: Vec<usize>, values: Vec<f64> },
    /// Means over rings: frequencies in cycles per unit length, and the sides of the torus.
    Rings { nu: Vec<f64>, p: Vec<f64>, sides: Vec<f64> },
}

/// The exponent of P below the first frequency where it is known, of its means there and at `ratio` times that frequency.
fn low_exponent(first: f64, second: f64, ratio: f64) -> f64 {
    if first > 0.0 && second > 0.0 { ((second / first).ln() / ratio.ln()).clamp(0.0, 4.0) } else { 0.0 }
}

impl Power {
    /// The largest frequencies along the axes at which all of P is known; `None` where it is everywhere.
    pub(super) fn reach(&self) -> Option<Vec<f64>> {
        match self {
            Self::Closed(_) => None,
            Self::Grid { reach, .. } => Some(reach.iter().map(|f| *f as f64).collect()),
            Self::Rings { nu, sides, .. } => {
                let last = nu.last().copied().unwrap_or(0.0);
                Some(sides.iter().map(|side| last * side).collect())
            }
        }
    }

    /// P at `scale` times the frequency m: where that is not one that was measured, between its neighbours; below the first of them like a
    /// power of the frequency.
    pub(super) fn at(&self, m: [i32; 3], scale: f64) -> Option<f64> {
        match self {
            Self::Closed(process) => process.power(m),
            Self::Grid { reach, values } => grid_at(reach, values, m.map(|m| f64::from(m) * scale)),
            Self::Rings { nu, p, sides } => {
                let square = |(m, side): (&i32, &f64)| (f64::from(*m) * scale / side).powi(2);
                let x = m.iter().zip(sides).map(square).sum::<f64>().sqrt();
                let next = nu.partition_point(|nu| *nu < x);
                match next {
                    0 => {
                        let (first, p_first) = (*nu.first()?, *p.first()?);
                        let b = nu.get(1).zip(p.get(1)).map_or(0.0, |(nu, p)| low_exponent(p_first, *p, nu / first));
                        Some(p_first * (x / first).powf(b))
                    }
                    _ if next == nu.len() => None,
                    _ => {
                        let t = (x - nu[next - 1]) / (nu[next] - nu[next - 1]);
                        Some(p[next - 1] + t * (p[next] - p[next - 1]))
                    }
                }
            }
        }
    }
}

/// P between the nodes of a grid, all of them but m = 0, which is no power.
fn grid_at(reach: &[usize], values: &[f64], x: [f64; 3]) -> Option<f64> {
    let dim = reach.len();
    let value = |m: &[i64]| -> Option<f64> {
        let place = |(m, reach): (&i64, &usize)| usize::try_from(m + *reach as i64).ok().filter(|at| *at <= 2 * reach);
        let at = m.iter().zip(reach).try_fold(0, |at, (m, reach)| Some(at * (2 * reach + 1) + place((m, reach))?))?;
        values.get(at).copied()
    };
    let largest = x[..dim].iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    if largest == 0.0 {
        return None;
    }
    // Below the first frequencies: along the ray from there.
    let (x, factor) = if largest < 1.0 {
        let shell = |k: i64| {
            let mean = |a: usize| {
                let mut m = vec![0; dim];
                m[a] = k;
                value(&m)
            };
            (0..dim).map(mean).sum::<Option<f64>>()
        };
        let b = shell(1).zip(shell(2)).map_or(0.0, |(one, two)| low_exponent(one, two, 2.0));
        (x.map(|x| x / largest), largest.powf(b))
    } else {
        (x, 1.0)
    };
    let mut sum = 0.0;
    for corner in 0..1usize << dim {
        let (mut m, mut weight) = (vec![0i64; dim], 1.0);
        for (a, m) in m.iter_mut().enumerate() {
            let low = x[a].floor();
            let part = x[a] - low;
            let up = corner >> a & 1 == 1;
            weight *= if up { part } else { 1.0 - part };
            *m = low as i64 + i64::from(up);
        }
        if weight > 0.0 {
            sum += weight * value(&m)?;
        }
    }
    Some(factor * sum)
}

impl Spectrum {
    /// Of a directory with a result, or of a sampler, `NAME` or `NAME:key=value,...`.
    ///
    /// # Errors
    /// What is neither; a result without a spectrum, or of a window; a sampler without a closed form.
    pub(super) fn open(spec: &str, n: Option<u64>, dim: Option<usize>, params: &[String]) -> Result<Self> {
        let path = Path::new(spec);
        if path.exists() {
            if let Some(other) = params.first() {
                return Err(Error::setting(Setting::Params, other, "is of samplers; `p` names a result"));
            }
            let found = Self::measured(path)?;
            return match dim {
                Some(dim) if dim != found.dim => {
                    let reason = format!("{spec} is of points in {}D; expected {0}, or nothing", found.dim);
                    Err(Error::setting(Setting::Dim, dim, reason))
                }
                _ => Ok(found),
            };
        }
        let (entry, own) = find_with_parameters(spec).map_err(|error| match error {
            Error::Setting { reason, .. } => {
                let reason = format!("no directory with a result, and {reason}");
                Error::setting(Setting::PowerFrom, spec, reason)
            }
            other => other,
        })?;
        let name = entry.name;
        let n = n.ok_or_else(|| {
            Error::setting(Setting::Points, "(none)", format!("a sampler needs a number of points; `p` is {name}"))
        })?;
        let dim = dim.unwrap_or(2);
        if dim > 3 {
            return Err(Error::setting(Setting::Dim, dim, "expected 1 to 3"));
        }
        let params: Vec<&str> = own.into_iter().chain(params.iter().map(String::as_str)).collect();
        let process = Process::of(entry, n, 1, dim, 1, &ParameterValues::parse(entry, &params)?)?;
        // One off every axis, and one on it: some know it on axes alone.
        if [[1, 0, 0], [2, 3, 5]]
            .into_iter()
            .any(|m| process.power(std::array::from_fn(|a| if a < dim { m[a] } else { 0 })).is_none())
        {
            let reason = format!(
                "P of {name} is not known in closed form at n = {n}; expected another sampler, or the directory of a result (`pairwave analyze` --sampler {name} --out DIR)"
            );
            return Err(Error::setting(Setting::PowerFrom, spec, reason));
        }
        Ok(Self {
            subject: format!("P of {name} in closed form"),
            dim,
            n: n as f64,
            realizations: None,
            equal: process.fixed_n,
            count_variance: process.sampler.count_variance(),
            power: Power::Closed(process),
        })
    }

    fn measured(dir: &Path) -> Result<Self> {
        let stored = Stored::open(dir)?;
        let wrong = |reason: String| Error::input(dir.display().to_string(), reason);
        let number = |key: &str| {
            let value = stored.value(key).and_then(serde_json::Value::as_f64).filter(|x| x.is_finite() && *x > 0.0);
            value.ok_or_else(|| {
                wrong(format!("its summary.json has no number at {key}; expected the result of `pairwave analyze`"))
            })
        };
        let text = |key: &str| stored.value(key).and_then(|value| value.as_str()).unwrap_or_default();
        let dim = number("/d")? as usize;
        let (n, least, most) = (number("/n/mean")?, number("/n/min").unwrap_or(0.0), number("/n/max")?);
        if text("/domain/boundary") != "torus" || !(1..=3).contains(&dim) {
            return Err(wrong("is of points in a window; predictions are for shifts of a torus".into()));
        }
        if text("/parameters/convention") != "ours" && !text("/parameters/convention").is_empty() {
            let name = text("/parameters/convention");
            return Err(wrong(format!("has a spectrum by the convention of {name}; expected one of ours")));
        }
        let sides: Option<Vec<f64>> = stored
            .value("/domain/sides")
            .and_then(|sides| sides.as_array())
            .map(|sides| sides.iter().filter_map(serde_json::Value::as_f64).collect());
        let sides =
            sides.filter(|sides| sides.len() == dim).ok_or_else(|| wrong("has no sides of its torus".into()))?;
        let grid = dir.join("spectrum.npy");
        let power = if grid.exists() {
            let (reach, values) = read_grid(&grid, dim)?;
            Power::Grid { reach, values }
        } else {
            let table = stored.table("spectrum_radial.csv")?;
            let mut columns = [Vec::new(), Vec::new()];
            if let Some(table) = table {
                for (name, column) in ["nu", "p"].into_iter().zip(&mut columns) {
                    *column = table.column(name)?.unwrap_or_default();
                }
            }
            let [nu, p] = columns;
            let rows: Vec<(f64, f64)> =
                nu.into_iter().zip(p).filter_map(|(nu, p)| nu.zip(p)).filter(|row| row.0 > 0.0).collect();
            if rows.is_empty() || rows.windows(2).any(|pair| pair[0].0 >= pair[1].0) {
                let reason = "has neither spectrum.npy nor rings in spectrum_radial.csv; expected a result of `pairwave analyze` with `stats` spectrum or radial";
                return Err(wrong(reason.into()));
            }
            let (nu, p) = rows.into_iter().unzip();
            Power::Rings { nu, p, sides }
        };
        Ok(Self {
            subject: format!("P of {}", dir.display()),
            dim,
            n,
            realizations: Some(number("/k")? as u64),
            equal: least == most,
            count_variance: (least == most).then_some(0.0),
            power,
        })
    }
}

/// The largest frequencies and the values of `spectrum.npy`.
fn read_grid(path: &Path, dim: usize) -> Result<(Vec<usize>, Vec<f64>)> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| Error::file(path, error))?;
    let (shape, values) = array_of_bytes(&name, &bytes)?;
    if shape.len() != dim || shape.iter().any(|side| side % 2 == 0) {
        let reason = format!("has shape {shape:?}; expected {dim} odd sides, 2 F + 1 each");
        return Err(Error::input(name, reason));
    }
    if let Some(bad) = values.iter().find(|p| !p.is_finite() || **p < 0.0) {
        return Err(Error::input(name, format!("holds {bad}; expected P of at least 0")));
    }
    Ok((shape.iter().map(|side| side / 2).collect(), values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_frequencies_p_is_interpolated_and_below_them_a_power() {
        // |m|^2 along x and y alone is linear between no nodes; m_x^2 + 2 m_y^2 at the nodes.
        let (fx, fy) = (4i64, 3i64);
        let values: Vec<f64> = (-fx..=fx).flat_map(|x| (-fy..=fy).map(move |y| (x * x + 2 * y * y) as f64)).collect();
        let power = Power::Grid { reach: vec![4, 3], values };
        assert_eq!(power.at([3, -2, 0], 1.0), Some(17.0));
        assert_eq!(power.at([3, -2, 0], 0.5), Some((1.0 + 4.0) / 2.0 + 2.0));
        assert_eq!((power.at([5, 0, 0], 1.0), power.at([0, 0, 0], 1.0)), (None, None));
        // A square below 1, whatever the direction.
        assert!((power.at([1, 0, 0], 0.25).unwrap() - 0.0625).abs() < 1e-15);
        assert!((power.at([1, 1, 0], 0.25).unwrap() - 3.0 * 0.0625).abs() < 1e-15);
        let rings = Power::Rings { nu: vec![1.0, 2.0, 3.0], p: vec![0.1, 0.4, 0.9], sides: vec![2.0, 1.0] };
        assert!((rings.at([3, 0, 0], 1.0).unwrap() - 0.25).abs() < 1e-15, "between rings, on a side of 2");
        assert!((rings.at([0, 1, 0], 0.5).unwrap() - 0.025).abs() < 1e-15, "a square below the first");
        assert_eq!((rings.at([0, 4, 0], 1.0), rings.reach().unwrap()), (None, vec![6.0, 3.0]));
    }
}
