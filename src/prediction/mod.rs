//! Errors of integrals without points: what a measured spectrum, or one in closed form, does to an integrand. See `docs/convergence.md`.

mod spectrum;

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::error::{Error, Result, number};
use crate::estimate::Prediction;
use crate::memory::Memory;
use crate::plan::{Accuracy, By, EnsembleShape, Estimator, IntegrationPlan, IntegrationSettings, Spatial, WaveGrid};
use crate::points::Domain;
use crate::report::{self, Asked};
use crate::request::Request;
use crate::setting::Setting;
use crate::statistics::Table;
use spectrum::{Power, Spectrum};

/// What a spectrum predicts.
#[derive(Debug)]
pub struct Predicted {
    spec: String,
    subject: String,
    n: f64,
    dim: usize,
    estimator: Estimator,
    /// The density that points are placed by, and how.
    placed: Option<(String, By)>,
    max_frequency: Vec<u32>,
    /// How P was taken to n points.
    rule: String,
    /// One per integrand.
    pub each: Vec<Prediction>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// What tables of integrands and of P may take.
const MEMORY: Memory = Memory(1 << 30);

/// A tail that is known worse than to this part of the variance is worth a word.
const UNSURE: f64 = 0.02;

/// Predicts for the integrands of a request. `spec` is a directory with a result, or a sampler; of the request its number of points,
/// dimension, parameters of the sampler, estimator and largest frequencies are taken.
///
/// # Errors
/// Whatever is wrong with these; settings that say something of points to be measured.
pub fn predict(spec: &str, request: &Request) -> Result<Predicted> {
    let mut rest = request.clone();
    (rest.input.points, rest.input.dim, rest.estimator, rest.max_frequency, rest.threads) =
        (None, None, None, None, None);
    (rest.intensity, rest.by) = (None, None);
    rest.input.params.clear();
    rest.integrand.clear();
    if rest.stats.is_empty() {
        rest.stats = Request::default().stats;
    }
    if rest != Request::default() {
        let reason = format!(
            "takes no points; expected `points`, `dim`, `params`, `estimator`, `max_frequency`, `intensity` and `by` beside it, not {}",
            rest.arguments().join(" ")
        );
        return Err(Error::setting(Setting::PowerFrom, spec, reason));
    }
    if request.input.points == Some(0) {
        return Err(Error::setting(Setting::Points, 0, "expected at least 1 point"));
    }
    let spectrum = Spectrum::open(spec, request.input.points, request.input.dim, &request.input.params)?;
    let n = request.input.points.map_or(spectrum.n, |n| n as f64);
    let (dim, domain) = (spectrum.dim, Domain::unit_torus(spectrum.dim));
    let scale = if n == spectrum.n { 1.0 } else { (spectrum.n / n).powf(1.0 / dim as f64) };
    let asked = match request.max_frequency.as_deref() {
        Some(&[f]) => Some(vec![f; dim]),
        other => other.map(<[u32]>::to_vec),
    };
    let known = spectrum.power.reach().map(|reach| {
        let scaled = reach.iter().map(|f| (f / scale * (1.0 + 1e-12)) as u32).collect::<Vec<u32>>();
        // A grid that is scaled to many points would have as many modes more.
        let most = WaveGrid::default_max_frequency(n, &domain, MEMORY);
        let capped = scaled.iter().zip(most).map(|(f, most)| if scale < 1.0 { (*f).min(most) } else { *f });
        capped.map(|f| f.max(1)).collect::<Vec<u32>>()
    });
    if let (Some(asked), Some(known)) = (&asked, &known)
        && let Some((asked, known)) = asked.iter().zip(known).find(|(asked, known)| asked > known)
    {
        return Err(Error::setting(Setting::MaxFrequency, asked, format!("P is known up to {known} there")));
    }
    let frequencies = asked.or(known);
    let estimator = match (request.estimator, spectrum.equal, spectrum.count_variance) {
        (Some(estimator), true, _) => estimator,
        (None, true, _) => Estimator::Mean,
        (Some(Estimator::Lambda), false, None) => {
            let reason = "needs the variance of the number of points, which is not known here; expected ratio";
            return Err(Error::setting(Setting::Estimator, "lambda", reason));
        }
        (None, false, None) => Estimator::Ratio,
        (other, false, _) => other.unwrap_or(Estimator::Lambda),
    };
    if let (Some(spec), None) = (&request.intensity, request.by) {
        let reason = "says what points weigh, and there are none here; expected `by` removal or warp beside it";
        return Err(Error::setting(Setting::Intensity, spec, reason));
    }
    let settings = IntegrationSettings {
        integrands: &request.integrand,
        estimator: Some(estimator),
        shifts: 1,
        spatial: Some(Spatial::None),
        top: None,
        intensity: request.intensity.as_deref(),
        by: request.by,
        weighted: false,
        max_frequency: frequencies.as_deref(),
        low_frequency: Some(1),
        accuracy: Accuracy::default(),
        memory: MEMORY,
        equal: spectrum.equal,
    };
    let shape = EnsembleShape { realizations: 1, mean_points: n, max_points: n.ceil() as u64 };
    let plan = IntegrationPlan::new(&domain, settings, shape)?.narrowed()?;
    let count_variance = if estimator == Estimator::Lambda { spectrum.count_variance.unwrap_or(0.0) } else { 0.0 };
    // Frequencies between those that were measured err together.
    let realizations = spectrum.realizations.filter(|_| scale == 1.0 && matches!(spectrum.power, Power::Grid { .. }));
    let each = Prediction::all(&plan, &|m| spectrum.power.at(m, scale), realizations, count_variance);
    let mut warnings = Vec::new();
    if matches!(spectrum.power, Power::Rings { .. }) {
        warnings.push(format!(
            "{}: there is no spectrum.npy, so P is the mean over directions of spectrum_radial.csv: right where the points are isotropic, or the integrand is",
            spectrum.subject
        ));
    }
    let rule = match &spectrum.power {
        Power::Closed(_) => "closed form at this n",
        _ if scale == 1.0 => "as measured, at this n",
        _ => "P as a function of m / n^(1/d)",
    };
    if scale != 1.0 {
        warnings.push(format!(
            "P was measured at n = {} and is taken as a function of m / n^(1/{dim}): right where the mean spacing is the only length, not for Latin hypercubes, nets and lattices, nor where a length of the sampler stays as it is",
            number(spectrum.n)
        ));
    }
    if estimator == Estimator::Ratio && !spectrum.equal {
        warnings.push("the number of points varies: for the estimator ratio P predicts to first order".into());
    }
    for one in &each {
        let all = one.variance();
        if one.tail_bound > UNSURE * all && one.tail > one.tail_axes {
            warnings.push(format!(
                "{}: what lies beyond the frequencies that are summed is known to {:.1} % of the variance only (P = 1 is taken there)",
                one.integrand.spec(),
                100.0 * one.tail_bound / all
            ));
        }
    }
    Ok(Predicted {
        spec: spec.into(),
        subject: spectrum.subject,
        n,
        dim,
        estimator,
        placed: plan.importance.as_ref().and_then(|i| Some((i.density().to_string(), i.by()?))),
        max_frequency: plan.max_frequency().to_vec(),
        rule: rule.into(),
        each,
        warnings,
    })
}

impl Predicted {
    /// `variance.csv`, with the columns that it has where points are measured; empty what needs points.
    pub fn table(&self) -> Table {
        let each = &self.each;
        let rows = each.len();
        let empty = || (0..rows).map(|_| None);
        let mut table = Table::new()
            .text("subject", (0..rows).map(|_| self.subject.clone()))
            .floats("n", (0..rows).map(|_| self.n))
            .optional("k", empty())
            .text("integrand", each.iter().map(|e| e.integrand.spec().to_string()))
            .text("estimator", (0..rows).map(|_| self.estimator.name().into()))
            .floats("exact", each.iter().map(|e| e.integrand.integral()));
        for name in [
            "mean",
            "mean_se",
            "bias",
            "bias_se",
            "var_observed",
            "var_observed_se",
            "mse",
            "var_shifted",
            "var_shifted_se",
            "var_spatial",
            "var_spatial_se",
            "spatial_method",
        ] {
            table = table.optional(name, empty());
        }
        table = table
            .floats("var_spectral", each.iter().map(|e| e.spectral.value))
            .optional("var_spectral_se", each.iter().map(|e| e.spectral.se))
            .floats("tail", each.iter().map(|e| e.tail))
            .floats("tail_bound", each.iter().map(|e| e.tail_bound));
        for name in ["phase", "phase_se", "z"] {
            table = table.optional(name, empty());
        }
        let table = table
            .floats("count_term", each.iter().map(|e| e.count_term))
            .optional("var_observed_lo", empty())
            .optional("var_observed_hi", empty())
            .floats("var_random", each.iter().map(|e| e.v0 / self.n))
            .optional("phase_low", empty())
            .floats("tail_axes", each.iter().map(|e| e.tail_axes))
            .floats("removal", each.iter().map(|e| e.removal));
        let more = ["mse_predicted", "mse_predicted_se", "z_as_is", "var_low"];
        more.into_iter().fold(table, |table, name| table.optional(name, empty()))
    }

    /// What is predicted, for a terminal.
    pub fn text(&self) -> String {
        let placed = self.placed.as_ref();
        let placed = placed.map_or(String::new(), |(density, by)| format!(", points as dense as {density} by {by}"));
        let heading = format!("predicted by {}, n = {}, {}{placed}", self.subject, number(self.n), self.rule);
        let names =
            ["integrand", "exact", "var_spectral", "var_spectral_se", "tail", "tail_bound", "count_term", "var_random"];
        report::some_columns(&heading, &names, &self.table())
    }

    /// Writes `variance.csv` and `summary.json` into `dir`, as `report::write` does.
    ///
    /// # Errors
    /// As `report::write`; a directory that the spectrum was read from.
    pub fn write(&self, dir: &Path, asked: &Asked, force: bool) -> Result<Vec<PathBuf>> {
        let place = |path: &Path| path.canonicalize().ok();
        if place(dir).is_some() && place(dir) == place(Path::new(&self.spec)) {
            let reason = "holds the spectrum that is read, and would be replaced; expected another directory";
            return Err(Error::setting(Setting::Out, dir.display(), reason));
        }
        let own = json!({
            "prediction": self.rule,
            "subject": self.subject,
            "n": self.n,
            "d": self.dim,
            "intensity": self.placed.as_ref().map(|(density, _)| density),
            "by": self.placed.as_ref().map(|(_, by)| by.name()),
            "estimator": self.estimator.name(),
            "max_frequency": self.max_frequency,
        });
        report::write_files(dir, force, asked, &self.warnings, own, |files| {
            files.add("variance.csv", |file| file.write_all(&self.table().csv()?));
        })
    }
}
