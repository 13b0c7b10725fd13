//! Header of a data set as text: eleven lines before the points, and numbers as Fortran writes them.

use std::str::FromStr;

use super::lines::{Line, Lines};
use super::{Axis, DataType, Freedom, FunctionType, Header};
use crate::error::RecordError;

/// Number of lines in a header.
pub(super) const LINES: usize = 11;

/// Form of the points in the file.
pub(super) struct Form {
    /// True for ordinates of 64 bits.
    pub(super) is_double: bool,
    pub(super) complex: bool,
    /// Number of points that the header promises.
    pub(super) count: u64,
    /// Start and step of an even abscissa.
    pub(super) even: Option<(f64, f64)>,
}

impl Form {
    /// Number of numbers of a point: its abscissa if that is uneven, then its ordinate or the two parts.
    pub(super) fn numbers(&self) -> usize {
        1 + usize::from(self.complex) + usize::from(self.even.is_none())
    }
}

/// Reads a header; `None` if the file ends before it does.
pub(super) fn read(lines: &mut Lines) -> Result<Option<(Header, Form)>, RecordError> {
    let mut records = Vec::with_capacity(LINES);
    while records.len() < LINES {
        let Some(line) = lines.next().filter(|line| line.ended) else { return Ok(None) };
        records.push(Record::of(&line));
    }
    let mut header = Header::default();
    for (text, record) in header.lines.iter_mut().zip(&records) {
        *text = record.text(0, 80);
    }
    records[5].freedoms(&mut header)?;
    let (form, z) = records[6].form()?;
    header.z = z;
    header.abscissa = records[7].axis()?;
    header.ordinate = records[8].axis()?;
    header.denominator = records[9].axis()?;
    header.z_axis = records[10].axis()?;
    Ok(Some((header, form)))
}

/// Letters of a line, of UTF-8 if it is valid, else of Latin-1; control characters are blanks.
pub(super) fn letters(line: &[u8]) -> Vec<char> {
    /// No record of the format is longer, even if each of its letters takes four bytes.
    const LONGEST: usize = 320;
    let head = &line[..line.len().min(LONGEST)];
    let letters: Vec<char> = match std::str::from_utf8(head) {
        Ok(text) => text.chars().collect(),
        Err(_) => head.iter().copied().map(char::from).collect(),
    };
    letters.into_iter().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}

/// Part of a line that an error shows.
pub(super) fn shown(line: &[u8]) -> String {
    const SHOWN: usize = 80;
    letters(line).into_iter().take(SHOWN).collect::<String>().trim().to_owned()
}

/// A line of the header, in which fields have fixed columns.
struct Record {
    letters: Vec<char>,
    number: u64,
}

/// A line of a header that contradicts the format.
pub(super) fn wrong_header(line: u64, what: &str, text: &str) -> RecordError {
    RecordError::on_line(line, format!("line {line}: {what}, but the line is \"{text}\""))
}

impl Record {
    fn of(line: &Line) -> Self {
        Self { letters: letters(line.text), number: line.number }
    }

    fn error(&self, what: &'static str) -> RecordError {
        let text = self.letters.iter().collect::<String>();
        wrong_header(self.number, what, &shown(text.as_bytes()))
    }

    /// The text in `width` columns from `from` on; empty where it says NONE.
    fn text(&self, from: usize, width: usize) -> String {
        let text: String = self.letters.iter().skip(from).take(width).collect();
        unless_none(&text)
    }

    /// The whole number in `width` columns from `from` on; blanks are 0, as in Fortran.
    fn integer<T: FromStr + Default>(&self, (from, width): (usize, usize)) -> Option<T> {
        let text: String = self.letters.iter().skip(from).take(width).collect();
        let text = text.trim();
        if text.is_empty() { Some(T::default()) } else { text.parse().ok() }
    }

    fn integers<const N: usize>(&self, fields: [(usize, usize); N]) -> Option<[i32; N]> {
        let mut values = [0; N];
        for (value, field) in values.iter_mut().zip(fields) {
            *value = self.integer(field)?;
        }
        Some(values)
    }

    fn words(&self) -> Vec<String> {
        self.letters.iter().collect::<String>().split_whitespace().map(str::to_owned).collect()
    }

    /// Record 6: what the function is and where it was measured. Some programs keep to no columns; their words are
    /// read if there are as many as fields.
    fn freedoms(&self, header: &mut Header) -> Result<(), RecordError> {
        let columns = [(0, 5), (5, 10), (15, 5), (20, 10), (41, 10), (51, 4), (66, 10), (76, 4)];
        let by_columns = || Some((self.integers(columns)?, [self.text(31, 10), self.text(56, 10)]));
        let by_words = || {
            let words = self.words();
            let [a, b, c, d, response, e, f, reference, g, h] = &words[..] else { return None };
            let mut values = [0; 8];
            for (value, word) in values.iter_mut().zip([a, b, c, d, e, f, g, h]) {
                *value = word.parse().ok()?;
            }
            Some((values, [unless_none(response), unless_none(reference)]))
        };
        let (values, [response, reference]) = by_columns().or_else(by_words).ok_or_else(|| {
            self.error("here the format has type, number, version, load case, and name, node, direction twice")
        })?;
        header.function = FunctionType(values[0]);
        [header.identification, header.version, header.load_case] = [values[1], values[2], values[3]];
        header.response = Freedom { entity: response, node: values[4], direction: values[5] };
        header.reference = Freedom { entity: reference, node: values[6], direction: values[7] };
        Ok(())
    }

    /// Record 7: the form of the points, and the value on the z axis.
    fn form(&self) -> Result<(Form, f64), RecordError> {
        let numbers = |from: usize| -> Option<Vec<f64>> {
            let text: String = self.letters.iter().skip(from).collect();
            Numbers::new(text.as_bytes()).take(6).collect::<Result<_, _>>().ok()
        };
        let by_columns = || {
            let [kind, spacing] = self.integers([(0, 10), (20, 10)])?;
            Some((f64::from(kind), self.integer::<u64>((10, 10))?, f64::from(spacing), numbers(30)?))
        };
        let by_words = || match &numbers(0)?[..] {
            // A count has ten columns.
            [kind, count, spacing, rest @ ..] if (0.0..1e10).contains(count) && count.fract() == 0.0 => {
                Some((*kind, *count as u64, *spacing, rest.to_vec()))
            }
            _ => None,
        };
        let (kind, count, spacing, reals) = by_columns().or_else(by_words).ok_or_else(|| {
            self.error("here the format has ordinate type, number of points, spacing, start, step, z")
        })?;
        let (is_double, complex) = match kind {
            2.0 => (false, false),
            4.0 => (true, false),
            5.0 => (false, true),
            6.0 => (true, true),
            _ => return Err(self.error("the type of the ordinate must be 2, 4, 5 or 6")),
        };
        let even = match (spacing, reals.first(), reals.get(1)) {
            (0.0, ..) => None,
            (1.0, Some(&start), Some(&step)) if start.is_finite() && step.is_finite() => Some((start, step)),
            (1.0, ..) => return Err(self.error("an even abscissa needs a start and a step")),
            _ => return Err(self.error("the spacing of the abscissa must be 0 (uneven) or 1 (even)")),
        };
        let z = reals.get(2).copied().unwrap_or_default();
        Ok((Form { is_double, complex, count, even }, z))
    }

    /// Records 8 to 11: an axis.
    fn axis(&self) -> Result<Axis, RecordError> {
        let columns = [(0, 10), (10, 5), (15, 5), (20, 5)];
        let by_columns = || Some((self.integers(columns)?, self.text(26, 20), self.text(47, 20)));
        let by_words = || {
            let words = self.words();
            let mut values = [0; 4];
            for (index, value) in values.iter_mut().enumerate() {
                *value = words.get(index)?.parse().ok()?;
            }
            let word = |index: usize| words.get(index).map(|word| unless_none(word)).unwrap_or_default();
            Some((values, word(4), word(5)))
        };
        let ([data_type, exponents @ ..], label, unit) = by_columns()
            .or_else(by_words)
            .ok_or_else(|| self.error("here the format has type, three exponents, label and unit of an axis"))?;
        Ok(Axis { data_type: DataType(data_type), exponents, label, unit })
    }
}

fn unless_none(text: &str) -> String {
    let text = text.trim();
    if text == "NONE" { String::new() } else { text.to_owned() }
}

/// The numbers of a line. They may touch where the sign of one follows the exponent of another.
pub(super) struct Numbers<'a> {
    line: &'a [u8],
    at: usize,
}

impl<'a> Numbers<'a> {
    pub(super) fn new(line: &'a [u8]) -> Self {
        Self { line, at: 0 }
    }

    /// True if the last number ends with the line.
    pub(super) fn at_end(&self) -> bool {
        self.at == self.line.len()
    }

    /// The text up to the next blank.
    fn word(&self) -> &'a [u8] {
        let rest = &self.line[self.at..];
        &rest[..rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len())]
    }
}

impl<'a> Iterator for Numbers<'a> {
    /// A number, or the text that is not one.
    type Item = Result<f64, &'a [u8]>;

    fn next(&mut self) -> Option<Self::Item> {
        self.at += self.line[self.at..].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let word = self.word();
        if word.is_empty() {
            return None;
        }
        let plain = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        let (value, length) = match plain {
            Some(value) => (Ok(value), word.len()),
            None => leading(word).map_or((Err(word), word.len()), |(value, length)| (Ok(value), length)),
        };
        self.at += length;
        Some(value)
    }
}

/// The number at the start of `word`, and its length: with an exponent after E or D, or of three digits after a mere
/// sign, as Fortran writes it where the letter would not fit.
fn leading(word: &[u8]) -> Option<(f64, usize)> {
    let digits = |from: usize| word[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let sign = |at: usize| usize::from(matches!(word.get(at), Some(b'+' | b'-')));
    let mut end = sign(0);
    // NaN and inf are short; the next number may follow without a space.
    for (name, value) in [(b"NaN", f64::NAN), (b"inf", f64::INFINITY)] {
        let after = end + name.len();
        if word.get(end..after).is_some_and(|text| text.eq_ignore_ascii_case(name)) && sign(after) == 1 {
            return Some((if word[0] == b'-' { -value } else { value }, after));
        }
    }
    let whole = digits(end);
    end += whole;
    let mut fraction = 0;
    if word.get(end) == Some(&b'.') {
        fraction = digits(end + 1);
        end += 1 + fraction;
    }
    if whole + fraction == 0 {
        return None;
    }
    let mantissa = end;
    let letter = usize::from(matches!(word.get(end), Some(b'E' | b'e' | b'D' | b'd')));
    let exponent = end + letter;
    let count = digits(exponent + sign(exponent));
    let after = exponent + sign(exponent) + count;
    let is_exponent =
        if letter == 1 { count > 0 } else { sign(exponent) == 1 && count == 3 && word.get(after) != Some(&b'.') };
    if is_exponent {
        end = after;
    }
    // What follows must be another number, which begins with its sign.
    if end < word.len() && sign(end) == 0 {
        return None;
    }
    let text = |bytes| std::str::from_utf8(bytes).ok();
    let exponent = if is_exponent { text(&word[exponent..end])? } else { "0" };
    format!("{}e{exponent}", text(&word[..mantissa])?).parse().ok().map(|value| (value, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(line: &str) -> Result<Vec<f64>, String> {
        Numbers::new(line.as_bytes())
            .map(|number| number.map_err(|text| String::from_utf8_lossy(text).into()))
            .collect()
    }

    #[test]
    fn numbers_of_fortran_in_all_their_forms() {
        assert_eq!(all(" -1.47553E-02 1.0e3\t5 ").unwrap(), [-1.475_53e-2, 1000.0, 5.0]);
        assert_eq!(all("1.5D+02 -2.5d-1 .5 5.").unwrap(), [150.0, -0.25, 0.5, 5.0]);
        assert_eq!(all("1.23456-105 1.23456+105").unwrap(), [1.23456e-105, 1.23456e105]);
        assert_eq!(all("2.99110e-02-10.00000e-05-1.0E-003-2.0").unwrap(), [0.029_911, -1e-4, -1e-3, -2.0]);
        assert_eq!(all("-1.5-2.5").unwrap(), [-1.5, -2.5]);
        assert!(all("NaN").unwrap()[0].is_nan());
        let touching = all("NaN-1.757388200993E+159").unwrap();
        assert!(touching[0].is_nan() && touching[1..] == [-1.757_388_200_993e159], "{touching:?}");
        assert_eq!(all("-inf-1.0E+100 inf+1.0").unwrap(), [f64::NEG_INFINITY, -1e100, f64::INFINITY, 1.0]);
        assert_eq!(all("").unwrap(), [0.0; 0]);
        for line in ["abc", "1.5x", "*************", "1.5E", "1,5", "-", ".", "--1", "1.5E+-2", "NaN1.5", "in-1.5"] {
            assert_eq!(all(line), Err(line.to_owned()), "{line}");
        }
    }

    #[test]
    fn the_end_of_a_line_is_known() {
        let mut numbers = Numbers::new(b"1 2");
        assert_eq!((numbers.next(), numbers.at_end()), (Some(Ok(1.0)), false));
        assert_eq!((numbers.next(), numbers.at_end()), (Some(Ok(2.0)), true));
    }
}
