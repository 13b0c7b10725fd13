//! Fields of a line, and the numbers in them.
//!
//! Taken apart here and not by the crate `csv`: that one takes all that follows an open quote for one field, whatever
//! its size (520 MB of memory for such a file), and knows no columns that are aligned by blanks.

use std::ops::Range;

use crate::error::RecordError;

/// Separator between the fields of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    /// A sign, once.
    Sign(u8),
    /// Spaces and tabs, as many as there are: columns that are aligned.
    Blanks,
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

/// Content of a column, by the last rows that are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Number,
    Text,
    Blank,
}

/// A line and its fields.
pub(super) struct Row<'a> {
    line: &'a [u8],
    fields: Vec<Range<usize>>,
}

impl<'a> Row<'a> {
    pub(super) fn of(line: &'a [u8], separator: Separator) -> Self {
        let mut fields = Vec::new();
        split(line, separator, &mut fields);
        Self { line, fields }
    }

    pub(super) fn len(&self) -> usize {
        self.fields.len()
    }

    pub(super) fn field(&self, column: usize) -> &'a [u8] {
        self.fields.get(column).map_or(&[], |range| &self.line[range.clone()])
    }
}

/// The number in `field`, if it is one, and its decimal mark, if it has one. A decimal comma counts only where commas
/// do not separate columns.
pub(super) fn number(field: &[u8], separator: Separator) -> Option<(f64, Option<char>)> {
    let text = std::str::from_utf8(field).ok()?;
    if let Ok(value) = text.parse::<f64>() {
        return Some((value, text.contains('.').then_some('.')));
    }
    if separator == Separator::Sign(b',') || text.contains('.') || text.ends_with(',') {
        return None;
    }
    text.replacen(',', ".", 1).parse().ok().map(|value| (value, Some(',')))
}

/// Length of a written number: digits behind the decimal mark, and characters of its exponent and of the rest.
pub(super) fn digits(field: &[u8]) -> [usize; 3] {
    let exponent = field.iter().position(|byte| matches!(byte, b'e' | b'E'));
    let mantissa = &field[..exponent.unwrap_or(field.len())];
    let mark = mantissa.iter().position(|byte| matches!(byte, b'.' | b','));
    let fraction = mark.map_or(0, |mark| mantissa.len() - mark - 1);
    [fraction, exponent.map_or(0, |at| field.len() - at), mark.unwrap_or(mantissa.len())]
}

/// True if fewer digits are written than in the `least` of others.
pub(super) fn are_fewer(digits: [usize; 3], least: [usize; 3]) -> bool {
    // Numbers that all have a fraction or an exponent end with it.
    let is_whole = least[..2] == [0, 0];
    digits[0] < least[0] || digits[1] < least[1] || (is_whole && digits[2] < least[2])
}

/// A header without a table.
pub(super) const NO_ROWS: &str = "the file has a header but no rows of data below it";

/// A row with more or fewer fields than the first.
pub(super) fn ragged(line: u64, expected: usize, found: usize, separator: Separator) -> RecordError {
    let remedy = if separator == Separator::Sign(b',') {
        "; if the numbers have decimal commas, save the file with semicolons or tabs between the columns; if lines stand above \
         the table, skip them"
    } else {
        ""
    };
    RecordError::on_line(line, format!("line {line} has {found} fields, but the first row has {expected}{remedy}"))
}

/// A field that is not a number.
pub(super) fn not_a_number(line: u64, column: &str, text: &str) -> RecordError {
    RecordError::on_line(line, format!("line {line}, column \"{column}\": \"{text}\" is not a number"))
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

    #[test]
    fn both_decimal_marks() {
        let (comma, semicolon) = (Separator::Sign(b','), Separator::Sign(b';'));
        assert_eq!(number(b"1.5", comma), Some((1.5, Some('.'))));
        assert_eq!(number(b"-1,5e-3", semicolon), Some((-1.5e-3, Some(','))));
        assert_eq!(number(b"+15", semicolon), Some((15.0, None)));
        assert_eq!(number(b"1,5", comma), None);
        for text in ["", "1.234,5", "1,234,5", "abc", ",", "0x10", "1 5", "1,"] {
            assert_eq!(number(text.as_bytes(), semicolon), None, "{text:?}");
        }
    }

    #[test]
    fn digits_that_are_written() {
        let digits = |text: &str| (digits(text.as_bytes())[0], digits(text.as_bytes())[1]);
        assert_eq!([digits("1"), digits("-1.25"), digits("1,5e-05"), digits("2.e")], [(0, 0), (2, 0), (1, 4), (0, 1)]);
    }
}
