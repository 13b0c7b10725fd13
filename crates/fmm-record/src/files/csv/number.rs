//! Numbers as text, with a decimal point or a decimal comma.

use super::fields::Separator;

/// Decimal mark of a number; `None` if it has no fraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    Point,
    Comma,
}

/// The number in `field`, if it is one. A decimal comma counts only where commas do not separate columns.
pub(super) fn parse(field: &[u8], separator: Separator) -> Option<(f64, Option<Mark>)> {
    let text = std::str::from_utf8(field).ok()?;
    if let Ok(value) = text.parse::<f64>() {
        return Some((value, text.contains('.').then_some(Mark::Point)));
    }
    if !separator.leaves_comma() || text.contains('.') || text.ends_with(',') {
        return None;
    }
    text.replacen(',', ".", 1).parse().ok().map(|value| (value, Some(Mark::Comma)))
}

/// Length of a written number: digits behind the decimal mark, and characters of its exponent and of the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Digits {
    fraction: usize,
    exponent: usize,
    whole: usize,
}

impl Digits {
    pub(super) fn of(field: &[u8]) -> Self {
        let exponent = field.iter().position(|byte| matches!(byte, b'e' | b'E'));
        let mantissa = &field[..exponent.unwrap_or(field.len())];
        let mark = mantissa.iter().position(|byte| matches!(byte, b'.' | b','));
        Self {
            fraction: mark.map_or(0, |mark| mantissa.len() - mark - 1),
            exponent: exponent.map_or(0, |at| field.len() - at),
            whole: mark.unwrap_or(mantissa.len()),
        }
    }

    /// The least of both of two numbers.
    pub(super) fn least(self, other: Self) -> Self {
        Self {
            fraction: self.fraction.min(other.fraction),
            exponent: self.exponent.min(other.exponent),
            whole: self.whole.min(other.whole),
        }
    }

    /// Whether fewer are written than in the `least` of others.
    pub(super) fn are_fewer_than(self, least: Self) -> bool {
        // Numbers that all have a fraction or an exponent end with it.
        let is_whole = least.fraction == 0 && least.exponent == 0;
        self.fraction < least.fraction || self.exponent < least.exponent || (is_whole && self.whole < least.whole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_decimal_marks() {
        let (comma, semicolon) = (Separator::Sign(b','), Separator::Sign(b';'));
        assert_eq!(parse(b"1.5", comma), Some((1.5, Some(Mark::Point))));
        assert_eq!(parse(b"-1,5e-3", semicolon), Some((-1.5e-3, Some(Mark::Comma))));
        assert_eq!(parse(b"+15", semicolon), Some((15.0, None)));
        assert_eq!(parse(b"1,5", comma), None);
        for text in ["", "1.234,5", "1,234,5", "abc", ",", "0x10", "1 5", "1,"] {
            assert_eq!(parse(text.as_bytes(), semicolon), None, "{text:?}");
        }
    }

    #[test]
    fn digits_that_are_written() {
        let digits = |text: &str| (Digits::of(text.as_bytes()).fraction, Digits::of(text.as_bytes()).exponent);
        assert_eq!([digits("1"), digits("-1.25"), digits("1,5e-05"), digits("2.e")], [(0, 0), (2, 0), (1, 4), (0, 1)]);
    }
}
