//! `pairwave integrate`

use pairwave::{Error, Result, Setting};

use super::analyze::Analyze;

/// Integration errors alone: `analyze` without its own statistics.
#[derive(clap::Args)]
pub(crate) struct Integrate {
    #[command(flatten)]
    analyze: Analyze,
}

impl Integrate {
    pub(crate) fn run(self) -> Result<()> {
        if self.analyze.request().integrand.is_empty() {
            let reason = "expected an integrand such as disk or box:x0=0.2,x1=0.7; `pairwave integrands` lists them";
            return Err(Error::setting(Setting::Integrand, "(none)", reason));
        }
        self.analyze.integrating().run()
    }
}
