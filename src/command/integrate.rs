//! `pairwave integrate`

use pairwave::{Error, Result, Setting, prediction};

use super::analyze::Analyze;

/// Integration errors alone: `analyze` without its own statistics.
#[derive(clap::Args)]
pub(crate) struct Integrate {
    #[command(flatten)]
    analyze: Analyze,

    /// Predict without points, from a result or a sampler's formula
    ///
    /// Predict without points: from the spectrum of a result, by its directory, or from P of a sampler in closed form, NAME or
    /// NAME:key=value,... with -n N. From a result -n predicts for another number of points, with P a function of m / n^(1/d)
    #[arg(long = "p", help_heading = "Integration", value_name = "DIR|SAMPLER")]
    p: Option<String>,
}

impl Integrate {
    pub(crate) fn run(self) -> Result<()> {
        if self.analyze.request().integrand.is_empty() {
            let reason = "expected an integrand such as disk or box:x0=0.2,x1=0.7; `pairwave integrands` lists them";
            return Err(Error::setting(Setting::Integrand, "(none)", reason));
        }
        match &self.p {
            Some(spec) => {
                let found = prediction::predict(spec, self.analyze.request())?;
                self.analyze.predicted(&found)
            }
            None => self.analyze.integrating().run(),
        }
    }
}
