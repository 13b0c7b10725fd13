//! Numbers as text, with a decimal point or a decimal comma.

/// Which decimal mark a number had; none if it had no fraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    Point,
    Comma,
}

/// The number in `text`, if it is one. A decimal comma counts only where commas do not separate columns.
pub(super) fn parse(text: &str, separator: u8) -> Option<(f64, Option<Mark>)> {
    if let Ok(value) = text.parse::<f64>() {
        return Some((value, text.contains('.').then_some(Mark::Point)));
    }
    if separator == b',' || text.contains('.') {
        return None;
    }
    text.replacen(',', ".", 1).parse().ok().map(|value| (value, Some(Mark::Comma)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_decimal_marks() {
        assert_eq!(parse("1.5", b','), Some((1.5, Some(Mark::Point))));
        assert_eq!(parse("-1,5e-3", b';'), Some((-1.5e-3, Some(Mark::Comma))));
        assert_eq!(parse("+15", b';'), Some((15.0, None)));
        assert_eq!(parse("1,5", b','), None);
        for text in ["", "1.234,5", "1,234,5", "abc", ",", "0x10", "1 5"] {
            assert_eq!(parse(text, b';'), None, "{text:?}");
        }
    }
}
