//! `pairwave integrands`

use std::path::PathBuf;

use pairwave::integrand::{Entry, find, registry};
use pairwave::{Error, Integrand, Result, Setting, report};
use serde_json::Value;

#[derive(clap::Args)]
pub(crate) struct Integrands {
    /// Explain this one: a name, or NAME:key=value,... with its integrals
    spec: Option<String>,

    /// Dimension of what is explained and drawn; by default 2, of those in 1D only 1
    #[arg(long, value_name = "D")]
    dim: Option<usize>,

    /// As JSON
    #[arg(long)]
    json: bool,

    /// Draw it, or all that need no file, into this directory: NAME.svg
    #[arg(long, value_name = "DIR")]
    draw: Option<PathBuf>,

    /// Replace pictures that are there
    #[arg(long)]
    force: bool,
}

impl Integrands {
    pub(crate) fn run(self) -> Result<()> {
        let chosen = match &self.spec {
            Some(spec) => vec![find(spec.split(':').next().unwrap_or_default().trim())?],
            None => registry().to_vec(),
        };
        let made: Vec<Option<Integrand>> = chosen.iter().map(|entry| self.made(entry)).collect::<Result<_>>()?;
        if let Some(dir) = &self.draw {
            let drawn: Vec<&Integrand> = made.iter().flatten().collect();
            if let (Some(spec), []) = (&self.spec, drawn.as_slice()) {
                let reason = format!("has nothing to draw; expected {spec}:file=PATH");
                return Err(Error::setting(Setting::Integrand, spec, reason));
            }
            let files = report::draw_integrands(dir, &drawn, self.force)?;
            return super::print(&files.iter().map(|file| format!("{}\n", file.display())).collect::<String>());
        }
        let both = chosen.iter().zip(&made);
        if self.json {
            let all: Vec<Value> = both.map(|(entry, made)| entry.json(made.as_ref())).collect();
            return super::print(&format!("{:#}\n", Value::Array(all)));
        }
        let text = match self.spec {
            Some(_) => both.map(|(entry, made)| explained(entry, made.as_ref())).collect(),
            None => listed(&chosen),
        };
        super::print(&text)
    }

    /// The integrand of a line, with what was typed; `None` where only a name was and it needs more.
    fn made(&self, entry: &Entry) -> Result<Option<Integrand>> {
        let typed = self.spec.as_deref().filter(|spec| spec.contains(':'));
        let spec = match typed {
            Some(spec) => spec,
            None if entry.needs_file() => return Ok(None),
            None if entry.example.is_empty() => entry.name,
            None => entry.example,
        };
        let dim = match self.dim {
            Some(dim) if self.spec.is_none() && !entry.dims.contains(&dim) => return Ok(None),
            Some(dim) => dim,
            None => 2.clamp(*entry.dims.start(), *entry.dims.end()),
        };
        Integrand::new(spec, dim).map(Some)
    }
}

fn listed(entries: &[&Entry]) -> String {
    let mut text = String::new();
    for entry in entries {
        let known = if entry.closed { " [closed]" } else { "" };
        text += &format!("  {:<13} {}; {}{known}\n", entry.name, entry.summary, entry.in_dims());
        let parameters: Vec<String> = entry.parameters.iter().map(|p| p.shown()).collect();
        if !parameters.is_empty() {
            text += &format!("  {:<13}   {}\n", "", parameters.join(","));
        }
    }
    text + "\n[closed]: integrals, Fourier coefficients and autocorrelation are exact. Coordinates are fractions of the box.\n\
            NAME:key=value,... sets parameters; `pairwave integrands NAME` has what they are, formulas and sources.\n"
}

fn explained(entry: &Entry, made: Option<&Integrand>) -> String {
    let mut text = format!("{}: {}\n", entry.name, entry.summary);
    let mut line = |name: &str, value: &str| {
        if !value.is_empty() {
            text += &format!("  {name:<9} {value}\n");
        }
    };
    line("also", &entry.aliases.join(", "));
    line("in", &entry.in_dims());
    line("source", entry.source);
    line("known", entry.formulas);
    line("closed", if entry.closed { "yes" } else { "no, errors are stated" });
    for p in entry.parameters {
        let from = if p.from_dim > 1 { format!(", from {}D on", p.from_dim) } else { String::new() };
        line("with", &format!("{}  {} ({}{from})", p.shown(), p.help, p.takes));
    }
    let Some(f) = made else { return text };
    text += &format!("\n{f:?}\n");
    let mut value = |name: &str, value: f64| text += &format!("  {name:<17} {value}\n");
    value("integral", f.integral());
    value("of its square", f.square_integral());
    value("variance", f.variance());
    if !entry.closed {
        value("error of these", f.integral_error());
        value("of coefficients", f.coefficient_error());
        value("of a(r)", f.autocorrelation_error());
    }
    text
}
