//! `pairwave samplers`

use pairwave::Result;
use pairwave::samplers::{Entry, Number, find, registry};
use serde_json::Value;

#[derive(clap::Args)]
pub(crate) struct Samplers {
    /// Explain this one: parameters, sizes, source and formulas
    name: Option<String>,

    /// As JSON
    #[arg(long)]
    json: bool,
}

impl Samplers {
    pub(crate) fn run(self) -> Result<()> {
        let chosen = match &self.name {
            Some(name) => vec![find(name)?],
            None => registry().to_vec(),
        };
        if self.json {
            let all: Vec<Value> = chosen.into_iter().map(Entry::json).collect();
            return super::print(&format!("{:#}\n", Value::Array(all)));
        }
        let text = if self.name.is_some() { chosen.into_iter().map(explained).collect() } else { listed(&chosen) };
        super::print(&text)
    }
}

/// By family, a line each.
fn listed(entries: &[&Entry]) -> String {
    let mut text = String::new();
    let mut family = None;
    for entry in entries {
        if family.replace(entry.family) != Some(entry.family) {
            let gap = if text.is_empty() { "" } else { "\n" };
            text += &format!("{gap}{}\n", entry.family.name());
        }
        let known = match entry.formulas {
            "" => "",
            formulas if formulas.contains("g =") || formulas.contains("g(") || formulas.contains("g by") => " [g, P]",
            _ => " [P]",
        };
        text += &format!("  {:<21} {}; n {}, {}{known}\n", entry.name, entry.summary, number(entry), dims(entry));
    }
    text + "\n[P], [g, P]: known in closed form. `pairwave samplers NAME` has parameters, sources and formulas.\n"
}

fn explained(entry: &Entry) -> String {
    let mut text = format!("{}: {}\n", entry.name, entry.summary);
    let mut line = |name: &str, value: &str| {
        if !value.is_empty() {
            text += &format!("  {name:<9} {value}\n");
        }
    };
    line("also", &entry.aliases.join(", "));
    line("family", entry.family.name());
    line("n", &number(entry));
    line("in", &dims(entry));
    line("source", entry.source);
    line("known", entry.formulas);
    for p in entry.all_parameters() {
        line("--param", &format!("{}={}  {} ({})", p.name, p.default, p.help, p.accepts));
    }
    if !entry.notice.is_empty() {
        text += &format!("\n{}", entry.notice);
    }
    text
}

fn number(entry: &Entry) -> String {
    let words = entry.size.words;
    match entry.number {
        Number::Fixed => words.to_string(),
        Number::Sequence => format!("{words}, a sequence"),
        Number::Expected if words == "any" => "expected".into(),
        Number::Expected => format!("expected, {words}"),
    }
}

fn dims(entry: &Entry) -> String {
    match (entry.dims.start(), entry.dims.end()) {
        (least, most) if least == most => format!("{least}D"),
        (least, most) => format!("{least} to {most}D"),
    }
}
