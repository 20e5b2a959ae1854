//! `pairwave samplers`

use pairwave::Result;
use pairwave::samplers::registry;

pub(crate) fn run() -> Result<()> {
    let mut text = String::new();
    for sampler in registry() {
        text += &format!("{:<14} {}\n", sampler.name(), sampler.summary());
        for p in sampler.parameters() {
            text += &format!("{:14} --param {}={}  {} ({})\n", "", p.name, p.default, p.help, p.accepts);
        }
    }
    super::print(&text)
}
