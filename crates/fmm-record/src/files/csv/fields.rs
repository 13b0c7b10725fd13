//! The fields of a line.
//!
//! Taken apart here and not by the crate `csv`, as that one takes what follows a quote that is never closed for one
//! field, whatever its size (520 MB of memory for such a file), and knows no columns that are aligned by blanks.

use std::ops::Range;

/// Separator between the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    /// A sign, once.
    Sign(u8),
    /// Spaces and tabs, as many as there are: columns that are aligned.
    Blanks,
}

impl Separator {
    /// Whether a comma within a field may be a decimal comma.
    pub(super) fn leaves_comma(self) -> bool {
        self != Self::Sign(b',')
    }
}

/// Places of the fields of `line`, without blanks and quotes around them. A quote that is not closed on the line is an
/// ordinary character.
pub(super) fn split(line: &[u8], separator: Separator, fields: &mut Vec<Range<usize>>) {
    fields.clear();
    let is_blank = |byte: u8| (byte == b' ' || byte == b'\t') && separator != Separator::Sign(byte);
    let ends = |byte: u8| match separator {
        Separator::Sign(sign) => byte == sign,
        Separator::Blanks => byte == b' ' || byte == b'\t',
    };
    let mut at = 0;
    loop {
        while at < line.len() && is_blank(line[at]) {
            at += 1;
        }
        if separator == Separator::Blanks && at == line.len() {
            return;
        }
        let quoted = if line.get(at) == Some(&b'"') { closing_quote(line, at + 1) } else { None };
        let from = quoted.map_or(at, |close| close + 1);
        let end = line[from..].iter().position(|byte| ends(*byte)).map_or(line.len(), |length| from + length);
        let is_only_quoted = line[from..end].iter().all(|byte| is_blank(*byte));
        fields.push(match quoted.filter(|_| is_only_quoted) {
            Some(close) => trimmed(line, at + 1..close),
            None => trimmed(line, at..end),
        });
        if end == line.len() {
            return;
        }
        at = end + 1;
    }
}

/// Place of the quote that closes the one before `at`; two together are one character.
fn closing_quote(line: &[u8], mut at: usize) -> Option<usize> {
    loop {
        at += line.get(at..)?.iter().position(|byte| *byte == b'"')?;
        if line.get(at + 1) != Some(&b'"') {
            return Some(at);
        }
        at += 2;
    }
}

fn trimmed(line: &[u8], field: Range<usize>) -> Range<usize> {
    let text = &line[field.clone()];
    let start = field.start + text.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    let end = field.end - text.iter().rev().take_while(|byte| byte.is_ascii_whitespace()).count();
    start..end.max(start)
}

/// The text of a field, in Latin-1 if it is not UTF-8.
pub(super) fn text(field: &[u8]) -> String {
    let decoded =
        std::str::from_utf8(field).map_or_else(|_| field.iter().copied().map(char::from).collect(), str::to_owned);
    decoded.replace("\"\"", "\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(line: &str, separator: Separator) -> Vec<&str> {
        let mut ranges = Vec::new();
        split(line.as_bytes(), separator, &mut ranges);
        ranges.into_iter().map(|range| &line[range]).collect()
    }

    #[test]
    fn quotes_and_blanks() {
        let comma = Separator::Sign(b',');
        assert_eq!(fields(" a ,\"b, c\" , \" d\",", comma), ["a", "b, c", "d", ""]);
        assert_eq!(fields("\"a\"b,5\" pipe,\"never, closed", comma), ["\"a\"b", "5\" pipe", "\"never", "closed"]);
        assert_eq!(fields("\"say \"\"a\"\"\",1", comma), ["say \"\"a\"\"", "1"]);
        assert_eq!(fields("a\t b\t", Separator::Sign(b'\t')), ["a", "b", ""]);
        assert_eq!(fields("  1.0   2.0\t3 ", Separator::Blanks), ["1.0", "2.0", "3"]);
        assert_eq!(fields("", comma), [""]);
    }
}
