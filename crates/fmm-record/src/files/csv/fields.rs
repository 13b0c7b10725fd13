//! Fields of a line, and the numbers in them.
//!
//! Taken apart here and not by the crate `csv`: that one takes all that follows an open quote for one field, whatever
//! its size (520 MB of memory for such a file), and knows no columns that are aligned by blanks.

use std::ops::Range;

use super::stamp::Stamp;
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

    pub(super) fn is_blank(&self) -> bool {
        self.fields.iter().all(Range::is_empty)
    }

    pub(super) fn field(&self, column: usize) -> &'a [u8] {
        self.fields.get(column).map_or(&[], |range| &self.line[range.clone()])
    }
}

/// The number in `field`, if it is one, and its decimal mark, if it shows one. Marks between groups of three digits do
/// not count: `-6.174,5`, `1,234.5`, `1 234,5`, `1'234`. One mark alone is a decimal mark: only quotes keep a comma
/// inside of a field where commas separate columns.
pub(super) fn number(field: &[u8]) -> Option<(f64, Option<char>)> {
    let text = std::str::from_utf8(field).ok()?;
    if let Ok(value) = text.parse::<f64>() {
        return Some((value, text.contains('.').then_some('.')));
    }
    if let Some((mantissa, exponent)) = text.split_once(['d', 'D']).filter(|(mantissa, _)| !mantissa.is_empty()) {
        // Fortran writes numbers of double precision so.
        exponent.parse::<i32>().ok()?;
        return number(format!("{mantissa}e{exponent}").as_bytes());
    }
    // The last mark that stands only once is the decimal mark.
    let decimal = text.rfind([',', '.']).filter(|at| text.matches(&text[*at..=*at]).count() == 1);
    let (whole, rest) = text.split_at(decimal.unwrap_or(text.len()));
    let fraction = rest.get(1..).unwrap_or_default();
    let (whole, grouping) = without_groups(whole)?;
    if rest.len() == 1 || (grouping.is_some() && grouping == rest.chars().next()) {
        return None;
    }
    let value = format!("{whole}.{fraction}").parse().ok()?;
    let other = grouping.and_then(|mark| [(',', '.'), ('.', ',')].into_iter().find(|pair| pair.0 == mark));
    Some((value, rest.chars().next().or(other.map(|pair| pair.1))))
}

/// A whole number with commas or points between groups of digits that is no number of the other decimal mark.
pub(super) fn grouped(field: &[u8], decimal: char) -> Option<f64> {
    let (digits, grouping) = without_groups(std::str::from_utf8(field).ok()?)?;
    grouping.filter(|mark| *mark != decimal)?;
    digits.parse().ok()
}

/// A whole number without the mark between its groups of three digits, and that mark.
fn without_groups(whole: &str) -> Option<(String, Option<char>)> {
    const MARKS: [char; 7] = [',', '.', ' ', '\'', '\u{2019}', '\u{a0}', '\u{202f}'];
    let Some(mark) = whole.chars().find(|sign| MARKS.contains(sign)) else { return Some((whole.to_owned(), None)) };
    let mut groups = whole.trim_start_matches(['-', '+']).split(mark);
    let are_digits = |group: &str| group.bytes().all(|byte| byte.is_ascii_digit());
    let begins = groups.next().is_some_and(|first| (1..=3).contains(&first.len()) && are_digits(first));
    let goes_on = groups.all(|group| group.len() == 3 && are_digits(group));
    (begins && goes_on).then(|| (whole.replace(mark, ""), Some(mark)))
}

/// True for a number, but for what stands for none (`NaN`), and for a time of day.
pub(super) fn is_value(field: &[u8]) -> bool {
    number(field).is_some_and(|(value, _)| !value.is_nan()) || Stamp::of(field).is_some()
}

/// Length of a written number: digits behind the decimal mark, and characters of its exponent and of the rest.
pub(super) fn digits(field: &[u8]) -> [usize; 3] {
    let exponent = field.iter().position(|byte| matches!(byte, b'e' | b'E' | b'd' | b'D'));
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
        "; if the numbers have decimal commas, save the file with semicolons or tabs between the columns; if lines \
         stand above the table, skip them"
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
        assert_eq!(number(b"1.5"), Some((1.5, Some('.'))));
        assert_eq!(number(b"-1,5e-3"), Some((-1.5e-3, Some(','))));
        assert_eq!(number(b"+15"), Some((15.0, None)));
        assert_eq!(number(b"-1.25D-02"), Some((-0.0125, Some('.'))));
        for text in [
            "",
            "1,234,5",
            "abc",
            ",",
            "0x10",
            "1 5",
            "1,",
            "1.23,5",
            "12.3456,7",
            "1D",
            "D1",
            "1d2.5",
            "1,2,3",
            "1234.567,5",
        ] {
            assert_eq!(number(text.as_bytes()), None, "{text:?}");
        }
    }

    #[test]
    fn thousands_are_separated_by_any_mark() {
        for (text, value, mark) in [
            ("-6.174,0", -6174.0, Some(',')),
            ("1,234.5e3", 1_234_500.0, Some('.')),
            ("12 345,5", 12_345.5, Some(',')),
            ("12\u{202f}345", 12_345.0, None),
            ("1'234.5", 1234.5, Some('.')),
            ("1.234.567", 1_234_567.0, Some(',')),
            ("1,234,567", 1_234_567.0, Some('.')),
        ] {
            assert_eq!(number(text.as_bytes()), Some((value, mark)), "{text:?}");
        }
        assert_eq!(
            (grouped(b"-6,174", '.'), grouped(b"6,17", '.'), grouped(b"6,174", ',')),
            (Some(-6174.0), None, None)
        );
    }

    #[test]
    fn digits_that_are_written() {
        let digits = |text: &str| (digits(text.as_bytes())[0], digits(text.as_bytes())[1]);
        assert_eq!([digits("1"), digits("-1.25"), digits("1,5e-05"), digits("2.e")], [(0, 0), (2, 0), (1, 4), (0, 1)]);
    }
}
