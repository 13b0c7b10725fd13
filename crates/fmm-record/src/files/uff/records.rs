//! The eleven lines of text before the points.

use std::str::FromStr;

use super::lines::{Line, Lines};
use super::number::Numbers;
use super::{Axis, DataType, Freedom, FunctionType, Header, Precision};
use crate::RecordError;

/// Number of lines in a header.
pub(super) const LINES: usize = 11;

/// Form of the points in the file.
pub(super) struct Form {
    pub(super) precision: Precision,
    pub(super) complex: bool,
    /// Number of points that the header promises.
    pub(super) count: u64,
    /// Start and step of an even abscissa.
    pub(super) even: Option<(f64, f64)>,
}

impl Form {
    /// Number of numbers of a point.
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
        let (precision, complex) = match kind {
            2.0 => (Precision::Single, false),
            4.0 => (Precision::Double, false),
            5.0 => (Precision::Single, true),
            6.0 => (Precision::Double, true),
            _ => return Err(self.error("the type of the ordinate must be 2, 4, 5 or 6")),
        };
        let even = match (spacing, reals.first(), reals.get(1)) {
            (0.0, ..) => None,
            (1.0, Some(&start), Some(&step)) if start.is_finite() && step.is_finite() => Some((start, step)),
            (1.0, ..) => return Err(self.error("an even abscissa needs a start and a step")),
            _ => return Err(self.error("the spacing of the abscissa must be 0 (uneven) or 1 (even)")),
        };
        let z = reals.get(2).copied().unwrap_or_default();
        Ok((Form { precision, complex, count, even }, z))
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
