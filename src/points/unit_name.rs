//! What the length unit of a domain is called. Nothing is converted by it.

use std::fmt;
use std::str::FromStr;

/// Bytes of the longest name.
const LONGEST: usize = 24;

/// The name of a length unit, `m` or `µm`: a few characters that can be printed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct UnitName {
    bytes: [u8; LONGEST],
    length: usize,
}

impl UnitName {
    /// As it was typed.
    pub fn as_str(&self) -> &str {
        std::str::from_utf8(&self.bytes[..self.length]).unwrap_or_default()
    }
}

impl fmt::Display for UnitName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl fmt::Debug for UnitName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl FromStr for UnitName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let printed = text.trim() == text && !text.is_empty() && !text.chars().any(char::is_control);
        if !printed || text.len() > LONGEST {
            return Err(format!(
                "expected the name of a length unit, such as m or µm: 1 to {LONGEST} bytes of UTF-8 without control \
                 characters or blanks at its ends"
            ));
        }
        let mut bytes = [0; LONGEST];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        Ok(Self { bytes, length: text.len() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_what_was_typed_or_an_error() {
        for name in ["m", "µm", "h⁻¹ Mpc", "a<b&\"c\"", "123456789012345678901234"] {
            assert_eq!(name.parse::<UnitName>().unwrap().as_str(), name);
        }
        for name in ["", " ", "m ", "a\nb", "a\u{1b}[0m", "1234567890123456789012345"] {
            assert!(name.parse::<UnitName>().is_err(), "{name:?}");
        }
    }
}
