//! Numbers and user text, as people read them.

/// `x` with 4 significant digits, a true minus sign and powers of ten as superscripts: `0.03358`, `1.2×10⁻⁷`.
pub(crate) fn human(x: f64) -> String {
    significant(x, 4)
}

/// `x ± se`, both to the second digit of `se`; without a usable `se`, as `human`.
pub(crate) fn with_error(x: f64, se: Option<f64>) -> String {
    match se {
        Some(se) if se > 0.0 && se.is_finite() && x.is_finite() => {
            let digits = magnitude(x) - magnitude(se) + 2;
            format!("{} ± {}", significant(x, digits.clamp(1, 15)), significant(se, 2))
        }
        _ => human(x),
    }
}

/// Exponent of the leading digit.
fn magnitude(x: f64) -> i32 {
    if x == 0.0 { 0 } else { x.abs().log10().floor() as i32 }
}

fn significant(x: f64, digits: i32) -> String {
    if !x.is_finite() {
        return "undefined".into();
    }
    if x == 0.0 {
        return "0".into();
    }
    let e = magnitude(x);
    if (-4..6).contains(&e) {
        return trimmed(x, (digits - 1 - e).max(0) as usize);
    }
    let mantissa = trimmed(x / 10f64.powi(e), (digits - 1).max(0) as usize);
    // A mantissa that rounds up to 10 belongs to the next decade.
    let (mantissa, e) =
        if mantissa.trim_start_matches('−') == "10" { (mantissa.replace("10", "1"), e + 1) } else { (mantissa, e) };
    format!("{mantissa}×10{}", superscript(e))
}

/// Fixed decimals without trailing zeros.
fn trimmed(x: f64, decimals: usize) -> String {
    let s = format!("{x:.decimals$}");
    let s = if s.contains('.') { s.trim_end_matches('0').trim_end_matches('.') } else { &s };
    if s == "-0" { "0".into() } else { s.replace('-', "−") }
}

/// A tick label: as many decimals as the step between ticks needs.
pub(crate) fn tick(x: f64, step: f64) -> String {
    let largest = x.abs().max(step);
    if !(1e-4..1e6).contains(&largest) && x != 0.0 {
        return significant(x, magnitude(x) - magnitude(step) + 1);
    }
    let decimals = (-magnitude(step * 1.000_001)).max(0) as usize;
    let s = format!("{x:.decimals$}");
    if s.trim_start_matches('-').bytes().all(|b| matches!(b, b'0' | b'.')) { "0".into() } else { s.replace('-', "−") }
}

fn superscript(e: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |c: char| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize]);
    e.to_string().chars().map(digit).collect()
}

/// Text made safe for XML and HTML, in content and in quoted attributes. Control characters, which XML cannot hold at
/// all, become U+FFFD.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' | '\t' => escaped.push(c),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

/// A few words of HTML or SVG without their tags and escapes: squares as ², other powers behind a ^, an index behind `_`.
pub(crate) fn untagged(html: &str) -> String {
    let html = html.replace("<sup>2</sup>", "²").replace("<sup>", "^").replace("<sub>", "_");
    let mut plain = String::with_capacity(html.len());
    let mut inside = false;
    for c in html.chars() {
        match c {
            '<' => inside = true,
            '>' if inside => inside = false,
            c if !inside => plain.push(c),
            _ => {}
        }
    }
    let entities = [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&quot;", "\""),
        ("&#39;", "'"),
        ("&#8203;", ""),
        ("&nbsp;", " "),
        ("&amp;", "&"),
    ];
    entities.iter().fold(plain, |text, (entity, c)| text.replace(entity, c))
}

/// At most `max` characters, the middle left out: both ends of a file name tell more than its middle.
pub(crate) fn shortened(text: &str, max: usize) -> String {
    let chars: Vec<char> = text.chars().collect();
    if chars.len() <= max {
        return text.into();
    }
    let tail = (max - 1) / 2;
    let head = max - 1 - tail;
    chars[..head].iter().chain(['…'].iter()).chain(&chars[chars.len() - tail..]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        for (x, text) in [
            (0.0, "0"),
            (0.033_581_4, "0.03358"),
            (1024.0, "1024"),
            (-13.0103, "−13.01"),
            (1.25e-7, "1.25×10⁻⁷"),
            (9.999_99e-7, "1×10⁻⁶"),
            (123_456_789.0, "1.235×10⁸"),
            (f64::NAN, "undefined"),
        ] {
            assert_eq!(human(x), text);
        }
        assert_eq!(with_error(0.012_345_6, Some(0.000_56)), "0.01235 ± 0.00056");
        assert_eq!(with_error(1.0, Some(0.0)), "1");
        assert_eq!(with_error(1.0, None), "1");
        assert_eq!(tick(0.15, 0.05), "0.15");
        assert_eq!(tick(-0.0, 0.05), "0");
        assert_eq!(tick(-20.0, 10.0), "−20");
        assert_eq!(tick(2e-7, 1e-7), "2×10⁻⁷");
    }

    #[test]
    fn user_text_is_safe() {
        assert_eq!(escape("a<b & \"c\"\u{1}"), "a&lt;b &amp; &quot;c&quot;\u{fffd}");
        assert_eq!(shortened("abcdefghij", 5), "ab…ij");
        assert_eq!(shortened("abc", 5), "abc");
        assert_eq!(
            untagged("<i>P</i> ~ <i>ν<sup>b</sup></i>, <i>n</i><sup>2</sup> &lt; &amp;lt;"),
            "P ~ ν^b, n² < &lt;"
        );
    }
}
