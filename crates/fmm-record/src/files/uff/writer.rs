//! Data sets into a file.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use super::{Abscissa, Axis, DataSet, Freedom, Ordinate, Precision};
use crate::error::RecordError;
use crate::files::number::ByteOrder;

/// Form of the points in a file that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Text: 6 digits of single, 13 of double numbers.
    Ascii,
    /// Bytes, which keep all digits.
    Binary(ByteOrder),
}

/// Writes data sets into the file at `path`, which is replaced if it exists; see [`write_to`].
///
/// # Errors
/// [`RecordError::Io`], otherwise as [`write_to`].
pub fn write(path: impl AsRef<Path>, sets: &[DataSet], form: Form) -> Result<(), RecordError> {
    let path = path.as_ref();
    let file = File::create(path).map_err(|source| RecordError::io("create", path, source))?;
    let mut out = BufWriter::new(file);
    write_to(&mut out, sets, form)?;
    out.flush().map_err(interrupted)
}

/// Writes data sets to `out`, one behind the other.
///
/// Whatever the form, the format has six digits for start and step of an even abscissa: a step that is the inverse
/// of a whole number of hertz comes back as it was in [`DataSet::record`], any other within 5·10⁻⁶ of itself. An uneven
/// abscissa has six digits in text, and is single in bytes.
///
/// # Errors
/// [`RecordError::Unsupported`] or [`RecordError::Values`] for content that the format cannot hold, and
/// [`RecordError::Io`] if writing fails.
pub fn write_to(mut out: impl Write, sets: &[DataSet], form: Form) -> Result<(), RecordError> {
    for set in sets {
        out.write_all(&block(set, form)?).map_err(interrupted)?;
    }
    Ok(())
}

/// Writing that stopped half way.
fn interrupted(source: std::io::Error) -> RecordError {
    RecordError::Io { what: "write on".into(), source: std::sync::Arc::new(source) }
}

/// A data set with its delimiters.
fn block(set: &DataSet, form: Form) -> Result<Vec<u8>, RecordError> {
    let points = match form {
        Form::Ascii => text_points(set)?,
        Form::Binary(order) => binary_points(set, order)?,
    };
    let identifier = match form {
        Form::Ascii => format!("{:>6}", 58),
        Form::Binary(order) => {
            let order = if order == ByteOrder::Little { 1 } else { 2 };
            let (bytes, zero) = (points.len(), 0);
            format!("{:>6}b{order:>6}{:>6}{:>12}{bytes:>12}{zero:>6}{zero:>6}{zero:>12}{zero:>12}", 58, 2, 11)
        }
    };
    let mut block = format!("    -1\n{identifier}\n").into_bytes();
    header(set, &mut block)?;
    block.extend_from_slice(&points);
    block.extend_from_slice(b"    -1\n");
    Ok(block)
}

/// The eleven lines before the points.
fn header(set: &DataSet, block: &mut Vec<u8>) -> Result<(), RecordError> {
    let header = &set.header;
    for line in &header.lines {
        block.extend(text("line", line, 80)?);
        block.push(b'\n');
    }
    block.extend(integer("function type", header.function.0.into(), 5)?);
    block.extend(integer("function number", header.identification.into(), 10)?);
    block.extend(integer("version", header.version.into(), 5)?);
    block.extend(integer("load case", header.load_case.into(), 10)?);
    for Freedom { entity, node, direction } in [&header.response, &header.reference] {
        block.push(b' ');
        block.extend(padded("entity", entity, 10)?);
        block.extend(integer("node", (*node).into(), 10)?);
        block.extend(integer("direction", (*direction).into(), 4)?);
    }
    let ordinate = match (set.ordinate(), set.precision()) {
        (Ordinate::Real(_), Precision::Single) => 2,
        (Ordinate::Real(_), Precision::Double) => 4,
        (Ordinate::Complex(_), Precision::Single) => 5,
        (Ordinate::Complex(_), Precision::Double) => 6,
    };
    let (spacing, start, step) = match set.abscissa() {
        Abscissa::Even { start, step } => (1, *start, *step),
        Abscissa::Uneven(_) => (0, 0.0, 0.0),
    };
    block.push(b'\n');
    block.extend(integer("ordinate type", ordinate, 10)?);
    block.extend(integer("number of points", i64::try_from(set.len()).unwrap_or(i64::MAX), 10)?);
    block.extend(integer("spacing", spacing, 10)?);
    for value in [start, step, header.z] {
        block.extend(format!("{:>13}", scientific(value, 5)).into_bytes());
    }
    for Axis { data_type, exponents, label, unit } in
        [&header.abscissa, &header.ordinate, &header.denominator, &header.z_axis]
    {
        block.push(b'\n');
        block.extend(integer("data type", data_type.0.into(), 10)?);
        for exponent in exponents {
            block.extend(integer("exponent", (*exponent).into(), 5)?);
        }
        for (what, word) in [("label", label), ("unit", unit)] {
            block.push(b' ');
            block.extend(padded(what, word, 20)?);
        }
    }
    block.push(b'\n');
    Ok(())
}

/// A text in Latin-1, NONE if it is empty.
fn text(what: &'static str, text: &str, limit: usize) -> Result<Vec<u8>, RecordError> {
    let letters: Option<Vec<u8>> =
        text.chars().map(|letter| u8::try_from(letter).ok().filter(|_| !letter.is_control())).collect();
    match letters.filter(|letters| letters.len() <= limit) {
        Some(letters) if letters.is_empty() => Ok(b"NONE".to_vec()),
        Some(letters) => Ok(letters),
        None => Err(RecordError::unsupported(format!(
            "{what} \"{text}\" cannot be written: it must have at most {limit} characters of Latin-1 on one line"
        ))),
    }
}

fn padded(what: &'static str, word: &str, columns: usize) -> Result<Vec<u8>, RecordError> {
    let mut letters = text(what, word, columns)?;
    letters.resize(columns, b' ');
    Ok(letters)
}

fn integer(what: &'static str, value: i64, columns: usize) -> Result<Vec<u8>, RecordError> {
    let field = format!("{value:>columns$}");
    if field.len() <= columns {
        return Ok(field.into_bytes());
    }
    Err(RecordError::unsupported(format!("{what} {value} cannot be written: it has only {columns} columns")))
}

/// A number with `decimals` behind the point and an exponent of at least two digits, as Fortran writes it.
fn scientific(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$E}");
    match text.split_once('E') {
        Some((mantissa, exponent)) => {
            let (sign, digits) = exponent.strip_prefix('-').map_or(('+', exponent), |digits| ('-', digits));
            format!("{mantissa}E{sign}{digits:0>2}")
        }
        None => text,
    }
}

/// The value in single precision, unless it is lost there.
fn single(index: usize, value: f64) -> Result<f32, RecordError> {
    let single = value as f32;
    if single.is_finite() || !value.is_finite() {
        return Ok(single);
    }
    let what = format!(
        "value {index}, {value}, is beyond the range of single precision; write the data set in double precision"
    );
    Err(RecordError::Values { index, what })
}

/// The numbers of all points, each with its index and whether it is an abscissa or a value.
fn numbers(set: &DataSet) -> impl Iterator<Item = (usize, bool, f64)> {
    let abscissae = match set.abscissa() {
        Abscissa::Even { .. } => &[][..],
        Abscissa::Uneven(values) => values,
    };
    (0..set.len()).flat_map(move |index| {
        let abscissa = abscissae.get(index).map(|value| (index, true, *value));
        let [first, second] = match set.ordinate() {
            Ordinate::Real(values) => [Some(values[index]), None],
            Ordinate::Complex(values) => values[index].map(Some),
        };
        let value = move |value: Option<f64>| value.map(|value| (index, false, value));
        abscissa.into_iter().chain(value(first)).chain(value(second))
    })
}

/// Refuses uneven abscissae that differ, but not after rounding by `rounded`.
fn told_apart(set: &DataSet, rounded: impl Fn(f64) -> f64) -> Result<(), RecordError> {
    let Abscissa::Uneven(values) = set.abscissa() else { return Ok(()) };
    let merged = |pair: &[f64]| pair[0] != pair[1] && rounded(pair[0]) == rounded(pair[1]);
    match values.windows(2).position(merged) {
        Some(index) => {
            let value = values[index];
            let what = format!(
                "abscissa {index}, {value}, cannot be told from its neighbour in the digits that the format has for it"
            );
            Err(RecordError::Values { index, what })
        }
        None => Ok(()),
    }
}

fn text_points(set: &DataSet) -> Result<Vec<u8>, RecordError> {
    told_apart(set, |value| scientific(value, 5).parse().unwrap_or(f64::NAN))?;
    let double = set.precision() == Precision::Double;
    let uneven = matches!(set.abscissa(), Abscissa::Uneven(_));
    let complex = matches!(set.ordinate(), Ordinate::Complex(_));
    let in_line = match (double, uneven, complex) {
        (false, ..) => 6,
        (true, true, true) => 3,
        (true, ..) => 4,
    };
    let mut block = Vec::new();
    let mut column = 0;
    for (index, is_abscissa, value) in numbers(set) {
        if !double {
            single(index, value)?;
        }
        let field = if double && !is_abscissa {
            format!("{:>20}", scientific(value, 12))
        } else {
            format!("{:>13}", scientific(value, 5))
        };
        block.extend_from_slice(field.as_bytes());
        column += 1;
        if column == in_line {
            block.push(b'\n');
            column = 0;
        }
    }
    if column > 0 {
        block.push(b'\n');
    }
    Ok(block)
}

fn binary_points(set: &DataSet, order: ByteOrder) -> Result<Vec<u8>, RecordError> {
    told_apart(set, |value| f64::from(value as f32))?;
    let mut block = Vec::new();
    for (index, is_abscissa, value) in numbers(set) {
        let is_double = set.precision() == Precision::Double && !is_abscissa;
        match (is_double, order) {
            (true, ByteOrder::Little) => block.extend(value.to_le_bytes()),
            (true, ByteOrder::Big) => block.extend(value.to_be_bytes()),
            (false, ByteOrder::Little) => block.extend(single(index, value)?.to_le_bytes()),
            (false, ByteOrder::Big) => block.extend(single(index, value)?.to_be_bytes()),
        }
    }
    Ok(block)
}
