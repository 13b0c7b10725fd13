//! Data sets into a file.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use super::{Abscissa, Axis, DataSet, Freedom, Ordinate};
use crate::error::RecordError;
use crate::files::number::ByteOrder;

/// Form of the points in a file that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Text of 13 digits.
    Ascii,
    /// Bytes, which keep all digits.
    Binary(ByteOrder),
}

/// Writes data sets into the file at `path`, which is replaced if it exists; see [`write_to`].
///
/// # Errors
/// [`RecordError::Io`], otherwise as [`write_to`].
pub fn write(path: impl AsRef<Path>, sets: &[DataSet], form: Form) -> Result<(), RecordError> {
    let mut bytes = Vec::new();
    write_to(&mut bytes, sets, form)?;
    std::fs::write(&path, bytes).map_err(|source| RecordError::io("create", path.as_ref(), source))
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
    let stopped = |source| RecordError::Io { what: "write on".into(), source: Arc::new(source) };
    sets.iter().try_for_each(|set| out.write_all(&block(set, form)?).map_err(stopped))
}

/// A data set with its delimiters.
fn block(set: &DataSet, form: Form) -> Result<Vec<u8>, RecordError> {
    let (points, identifier) = match form {
        Form::Ascii => (text_points(set)?, format!("{:>6}", 58)),
        Form::Binary(order) => {
            let points = binary_points(set, order)?;
            let order = if order == ByteOrder::Little { 1 } else { 2 };
            let (bytes, zero) = (points.len(), 0);
            let rest = format!("{bytes:>12}{zero:>6}{zero:>6}{zero:>12}{zero:>12}");
            (points, format!("{:>6}b{order:>6}{:>6}{:>12}{rest}", 58, 2, 11))
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
    let ordinate = if matches!(set.ordinate(), Ordinate::Real(_)) { 4 } else { 6 };
    let (spacing, start, step) = match set.abscissa() {
        Abscissa::Even { start, step } => (1, *start, *step),
        Abscissa::Uneven(_) => (0, 0.0, 0.0),
    };
    block.push(b'\n');
    block.extend(integer("ordinate type", ordinate, 10)?);
    block.extend(integer("number of points", i64::try_from(set.ordinate().len()).unwrap_or(i64::MAX), 10)?);
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

/// The numbers of all points, and whether each is an abscissa.
fn numbers(set: &DataSet) -> impl Iterator<Item = (bool, f64)> {
    let abscissae = match set.abscissa() {
        Abscissa::Even { .. } => &[][..],
        Abscissa::Uneven(values) => values,
    };
    (0..set.ordinate().len()).flat_map(move |index| {
        let abscissa = abscissae.get(index).map(|value| (true, *value));
        let [first, second] = match set.ordinate() {
            Ordinate::Real(values) => [Some(values[index]), None],
            Ordinate::Complex(values) => values[index].map(Some),
        };
        abscissa.into_iter().chain([first, second].into_iter().flatten().map(|value| (false, value)))
    })
}

/// Refuses uneven abscissae that differ or are finite, but not after rounding by `rounded`.
fn told_apart(set: &DataSet, rounded: impl Fn(f64) -> f64) -> Result<(), RecordError> {
    let Abscissa::Uneven(values) = set.abscissa() else { return Ok(()) };
    let is_merged = |value: f64, next: &f64| *next != value && rounded(*next) == rounded(value);
    let is_lost = |index: usize| {
        let value = values[index];
        let is_too_large = value.is_finite() && !rounded(value).is_finite();
        is_too_large || values.get(index + 1).is_some_and(|next| is_merged(value, next))
    };
    let Some(index) = (0..values.len()).find(|index| is_lost(*index)) else { return Ok(()) };
    let value = values[index];
    let what = format!(
        "abscissa {index}, {value}, is too large or cannot be told from its neighbour in the digits that the format \
         has for it"
    );
    Err(RecordError::Values { index, what })
}

fn text_points(set: &DataSet) -> Result<Vec<u8>, RecordError> {
    told_apart(set, |value| scientific(value, 5).parse().unwrap_or(f64::NAN))?;
    let are_three = matches!((set.abscissa(), set.ordinate()), (Abscissa::Uneven(_), Ordinate::Complex(_)));
    let in_line = if are_three { 3 } else { 4 };
    let mut block = Vec::new();
    let mut column = 0;
    for (is_abscissa, value) in numbers(set) {
        let (width, decimals) = if is_abscissa { (13, 5) } else { (20, 12) };
        let field = format!("{:>width$}", scientific(value, decimals));
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
    for (is_abscissa, value) in numbers(set) {
        match (is_abscissa, order) {
            (false, ByteOrder::Little) => block.extend(value.to_le_bytes()),
            (false, ByteOrder::Big) => block.extend(value.to_be_bytes()),
            (true, ByteOrder::Little) => block.extend((value as f32).to_le_bytes()),
            (true, ByteOrder::Big) => block.extend((value as f32).to_be_bytes()),
        }
    }
    Ok(block)
}
