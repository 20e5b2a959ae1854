//! Lines, and how they are cut into fields and numbers.

use std::ops::Range;

/// Lines ended by `\n`, `\r\n` or a lone `\r`.
pub(in crate::points::read) struct Lines<'a>(pub(in crate::points::read) &'a [u8]);

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.0.is_empty() {
            return None;
        }
        let end = self.0.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.0.len());
        let (line, rest) = self.0.split_at(end);
        let ending = if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) };
        self.0 = &rest[ending..];
        Some(line)
    }
}

pub(super) fn is_blank(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | 0x0b | 0x0c | 0x1a | b'(' | b')')
}

/// The line before its first `#` outside quotes, and what follows that `#`.
pub(super) fn split_comment(line: &[u8]) -> (&[u8], Option<&[u8]>) {
    let mut quoted = false;
    let start = line.iter().position(|&b| {
        quoted ^= b == b'"';
        b == b'#' && !quoted
    });
    match start {
        Some(start) => (&line[..start], Some(&line[start + 1..])),
        None => (line, None),
    }
}

/// The separator that the first line of a file for Excel sets: `sep=;`.
pub(super) fn separator_line(line: &[u8]) -> Option<u8> {
    let line = unquoted(line.trim_ascii());
    match line.get(..4)?.eq_ignore_ascii_case(b"sep=") {
        true => match &line[4..] {
            [one @ (b',' | b';' | b'|' | b':')] => Some(*one),
            // White space at the end of the line was trimmed.
            [] | b"\\t" => Some(b'\t'),
            _ => None,
        },
        false => None,
    }
}

/// What separates the fields of a header, where something other than blanks does.
pub(super) fn delimiter(content: &[u8]) -> Option<u8> {
    let mut quoted = false;
    let outside: Vec<u8> = content
        .iter()
        .copied()
        .filter(|&b| {
            quoted ^= b == b'"';
            !quoted
        })
        .collect();
    [b';', b',', b'\t'].into_iter().find(|d| outside.contains(d))
}

/// Fields between blanks, tabs, parentheses, commas and semicolons. Returns whether a field is missing: a comma or
/// semicolon before the first field, or two of them between fields.
pub(super) fn split_loosely(content: &[u8], fields: &mut Vec<Range<usize>>) -> bool {
    fields.clear();
    let (mut marks, mut hole, mut at) = (1, false, 0);
    while at < content.len() {
        let b = content[at];
        if is_blank(b) {
            at += 1;
        } else if b == b',' || b == b';' {
            marks += 1;
            at += 1;
        } else {
            let start = at;
            if b == b'"' {
                at += 1;
                while at < content.len() && content[at] != b'"' {
                    at += 1;
                }
            }
            while at < content.len() && !is_blank(content[at]) && content[at] != b',' && content[at] != b';' {
                at += 1;
            }
            hole |= marks > 1;
            marks = 0;
            fields.push(start..at);
        }
    }
    hole
}

/// Fields between `delimiter`s outside quotes, trimmed; empty ones included.
pub(super) fn split_strictly(content: &[u8], delimiter: u8, fields: &mut Vec<Range<usize>>) {
    fields.clear();
    let (mut quoted, mut start) = (false, 0);
    for at in 0..=content.len() {
        let b = content.get(at).copied();
        quoted ^= b == Some(b'"');
        if b.is_none() || (b == Some(delimiter) && !quoted) {
            let blanks = |part: &[u8]| part.iter().take_while(|b| b.is_ascii_whitespace()).count();
            let first = start + blanks(&content[start..at]);
            let trailing = content[first..at].iter().rev().take_while(|b| b.is_ascii_whitespace()).count();
            fields.push(first..at - trailing);
            start = at + 1;
        }
    }
}

pub(super) fn unquoted(field: &[u8]) -> &[u8] {
    field.strip_prefix(b"\"").and_then(|f| f.strip_suffix(b"\"")).unwrap_or(field).trim_ascii()
}

/// A number as Rust, C, Python or Fortran (`1.5d-3`) write it, rounded to nearest. Also `nan` and `inf`, so that the
/// message can tell them from text.
pub(in crate::points::read) fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    let fortran = || text.contains(['d', 'D']).then(|| text.replace(['d', 'D'], "e").parse().ok()).flatten();
    text.parse().ok().or_else(fortran)
}

/// `-0,25`: digits, a comma, digits and perhaps an exponent.
pub(crate) fn is_decimal_comma(field: &[u8]) -> bool {
    let field = field.strip_prefix(b"-").or(field.strip_prefix(b"+")).unwrap_or(field);
    let mut halves = field.splitn(2, |&b| b == b',');
    let (Some(whole), Some(rest)) = (halves.next(), halves.next()) else { return false };
    let digits = rest.iter().take_while(|b| b.is_ascii_digit()).count();
    let exponent = &rest[digits..];
    let has_exponent = matches!(exponent.first(), Some(b'e' | b'E' | b'd' | b'D')) && !exponent.contains(&b',');
    !whole.is_empty() && whole.iter().all(u8::is_ascii_digit) && digits > 0 && (exponent.is_empty() || has_exponent)
}

/// Whether commas stand inside numbers that something else separates, as in `0,5;0,25` and `0,5 0,25`.
pub(crate) fn has_decimal_comma(content: &[u8]) -> bool {
    if !content.contains(&b',') {
        return false;
    }
    let semicolon = content.contains(&b';');
    let separator = |&b: &u8| if semicolon { b == b';' } else { is_blank(b) };
    let fields = content.split(separator).map(|f| f.trim_ascii_start().trim_ascii_end()).filter(|f| !f.is_empty());
    let (mut count, mut decimal) = (0, false);
    for field in fields {
        count += 1;
        decimal |= is_decimal_comma(field);
    }
    count > 1 && decimal
}

pub(super) fn decimal_comma(content: &[u8]) -> String {
    format!(
        "decimal comma in {}; write numbers with a point, as 0.5, or separate them by semicolons or tabs",
        shown(content)
    )
}

/// A number with a decimal comma.
pub(super) fn decimal_comma_number(field: &[u8]) -> Option<f64> {
    if !is_decimal_comma(field) {
        return None;
    }
    let point: Vec<u8> = field.iter().map(|&b| if b == b',' { b'.' } else { b }).collect();
    number(&point)
}

/// Fields between semicolons, or tabs where there are none, if they are numbers and one of them has a decimal comma. Where not,
/// `fields` stays as it was.
pub(super) fn split_decimals(content: &[u8], fields: &mut Vec<Range<usize>>) -> bool {
    let Some(separator) = [b';', b'\t'].into_iter().find(|b| content.contains(b)).filter(|_| content.contains(&b','))
    else {
        return false;
    };
    let mut found = Vec::new();
    split_strictly(content, separator, &mut found);
    while found.last().is_some_and(Range::is_empty) {
        found.pop();
    }
    let field = |f: &Range<usize>| unquoted(&content[f.clone()]);
    let decimal = found.iter().any(|f| is_decimal_comma(field(f)));
    let all = found.iter().all(|f| is_decimal_comma(field(f)) || number(field(f)).is_some());
    if decimal && all {
        *fields = found;
    }
    decimal && all
}

/// `content` for a message: quoted, shortened, without control characters.
pub(in crate::points::read) fn shown(content: &[u8]) -> String {
    const LONGEST: usize = 40;
    let content = content.trim_ascii();
    let text = String::from_utf8_lossy(&content[..content.len().min(4 * LONGEST)]);
    let mut short: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() > LONGEST {
        short.push_str("...");
    }
    format!("\"{short}\"")
}
