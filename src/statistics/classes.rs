//! Which two classes of points are asked for.

use crate::error::{Error, Result};
use crate::request::Request;
use crate::setting::Setting;

/// Two of the classes there are.
pub(super) struct TwoClasses {
    pub(super) names: [String; 2],
    pub(super) numbers: [u32; 2],
}

impl TwoClasses {
    /// Finds the classes asked for among `names`.
    pub(super) fn among(names: &[String], request: &Request) -> Result<Self> {
        const SHOWN: usize = 20;
        let listed = || {
            let more = if names.len() > SHOWN { format!(" and {} more", names.len() - SHOWN) } else { String::new() };
            format!("{}{more}", names[..names.len().min(SHOWN)].join(", "))
        };
        let number = |name: &str| names.iter().position(|n| n == name).map(|k| k as u32);
        let typed = request.classes.clone().unwrap_or("(none)".into());
        let wanted = request.classes.as_deref().map(fields);
        let fail = |reason: String| Err(Error::setting(Setting::Classes, &typed, reason));
        let numbers = match (wanted.as_deref(), names) {
            (None, [_, _]) => [0, 1],
            (None, _) => return fail(format!("expected two of the {} classes: {}", names.len(), listed())),
            (Some([a, b]), _) if a == b => return fail("expected two different classes".into()),
            (Some([a, b]), _) => match (number(a), number(b)) {
                (Some(a), Some(b)) => [a, b],
                (None, _) => return fail(format!("no point is of class {a}; there are {}", listed())),
                (_, None) => return fail(format!("no point is of class {b}; there are {}", listed())),
            },
            (Some(_), _) => return fail("expected two classes, as in oak,elm".into()),
        };
        let names = numbers.map(|k| names[k as usize].clone());
        Ok(Self { names, numbers })
    }
}

/// The fields of a line of CSV.
fn fields(line: &str) -> Vec<String> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).trim(csv::Trim::All).from_reader(line.as_bytes());
    let first = reader.records().next().and_then(|record| record.ok());
    first.map_or(Vec::new(), |record| record.iter().map(str::to_string).collect())
}
