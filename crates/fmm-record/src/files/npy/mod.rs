//! Arrays in files of NumPy: npy, a single array, and npz, an archive of several.
//!
//! Arrays of other types than real numbers (complex numbers, text, structures, Python objects) are not read, but those
//! of an archive are listed.
//!
//! Read here and not by the crate npyz (0.9.1): that one allocates the length that a header states (4 GB for twelve
//! bytes), panics where the product of a shape overflows, and takes 36 s for a header of 18 nested brackets.

mod header;
#[cfg(test)]
mod tests;

use std::io::{Cursor, Read};

use zip::ZipArchive;

use crate::error::RecordError;
use crate::files::arrays::{ArrayFile, Notation};
use crate::files::npy::header::{Header, MAGIC};
use crate::files::reading::{MOST_INFLATED, too_large};

/// The arrays in the bytes of an npy or npz file. One of an archive that cannot be read is an error only where it is
/// asked for.
pub(crate) fn parse(bytes: &[u8]) -> Result<ArrayFile, RecordError> {
    let mut file = ArrayFile::new(Notation::Numpy);
    if bytes.starts_with(MAGIC) {
        // What is there cannot be too much.
        let named = |error| match error {
            RecordError::Unsupported { what } => RecordError::unsupported(format!("the array is {what}")),
            error => error,
        };
        let (shape, values) = array(bytes, "", &mut { usize::MAX }).map_err(named)?;
        file.add(String::new(), shape, values);
        return Ok(file);
    }
    if !bytes.starts_with(b"PK") {
        let length = bytes.len();
        let what = format!("not a file of NumPy: {length} bytes that begin neither as npy nor as npz");
        return Err(RecordError::UnknownFormat { what });
    }
    let damaged = |error| RecordError::undecoded("the archive cannot be read", error);
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let mut budget = MOST_INFLATED / size_of::<f64>();
    for index in 0..archive.len() {
        let name = match archive.name_for_index(index) {
            Some(name) => name.map_err(damaged)?.into_owned(),
            None => continue,
        };
        let Some(name) = name.strip_suffix(".npy") else {
            file.others.push((name, "no array".into()));
            continue;
        };
        let entry = archive.by_index(index).map_err(damaged);
        match entry.and_then(|entry| array(entry, name, &mut budget)) {
            Ok((shape, values)) => file.add(name.into(), shape, values),
            Err(RecordError::Unsupported { what }) => file.others.push((name.into(), what)),
            Err(error) => file.damaged.push((name.into(), error)),
        }
    }
    Ok(file)
}

/// Reads an array, and takes its numbers off the budget before any of them is read.
fn array(mut input: impl Read, name: &str, budget: &mut usize) -> Result<(Vec<usize>, Vec<f64>), RecordError> {
    let damaged = |error| RecordError::undecoded("the decoder says", error);
    let header = header::read(&mut input, name)?;
    let Header { number, count, .. } = header;
    if count > *budget {
        return Err(too_large());
    }
    *budget -= count;
    let promised = (count * number.width) as u64;
    let mut bytes = Vec::new();
    input.by_ref().take(promised).read_to_end(&mut bytes).map_err(damaged)?;
    if (bytes.len() as u64) < promised {
        return Err(header::truncated(name, promised, bytes.len()));
    }
    // An archive compares its checksum when the end is reached.
    if input.read(&mut [0]).map_err(damaged)? > 0 {
        let what = "arrays saved one behind the other are to be saved as npz";
        return Err(RecordError::damaged(format!("data follow the array \"{name}\"; {what}")));
    }
    let values = number.values(&bytes);
    let values = if header.fortran { row_after_row(&values, &header.shape) } else { values };
    Ok((header.shape, values))
}

/// Numbers of which the first axis varies first, in the order in which the last one does.
fn row_after_row(values: &[f64], shape: &[usize]) -> Vec<f64> {
    let place = |index: usize| {
        let (mut rest, mut place, mut stride) = (index, 0, values.len());
        for length in shape.iter().rev() {
            stride /= length;
            place += rest % length * stride;
            rest /= length;
        }
        place
    };
    (0..values.len()).map(|index| values[place(index)]).collect()
}
