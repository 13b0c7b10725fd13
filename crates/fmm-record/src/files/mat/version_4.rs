//! Files of version 4: matrices one behind the other, each with a header of five numbers.

use crate::error::RecordError;
use crate::files::arrays::{ArrayFile, Notation};
use crate::files::mat::class;
use crate::files::mat::element::place;
use crate::files::number::{ByteOrder, Kind, Number};

/// The arrays in the bytes of a file of version 4.
pub(super) fn parse(file: &[u8]) -> Result<ArrayFile, RecordError> {
    // The type of the first matrix is a small number in the order of the file.
    let first = file.get(..4).unwrap_or_default();
    let order = if ByteOrder::Little.unsigned(first) < 5000 { ByteOrder::Little } else { ByteOrder::Big };
    let mut found = ArrayFile::new(Notation::Matlab);
    let mut rest = file;
    while !rest.is_empty() {
        let offset = file.len() - rest.len();
        rest = matrix(rest, order, &mut found).ok_or_else(|| {
            RecordError::damaged(format!("the file is cut off or damaged in the variable {}", place(offset)))
        })?;
    }
    Ok(found)
}

/// Adds the matrix at the beginning of `bytes`; the bytes behind it, or `None` if it is none.
fn matrix<'a>(bytes: &'a [u8], order: ByteOrder, found: &mut ArrayFile) -> Option<&'a [u8]> {
    let (header, rest) = bytes.split_at_checked(20)?;
    let mut numbers = header.chunks_exact(4).map(|bytes| order.unsigned(bytes) as usize);
    let [kind, rows, columns, imaginary, length] = std::array::from_fn(|_| numbers.next().unwrap_or(0));
    let (name, rest) = rest.split_at_checked(length)?;
    let name = String::from_utf8_lossy(name.strip_suffix(b"\0").unwrap_or(name)).into_owned();
    let (of, width) = match kind / 10 % 10 {
        0 => (Kind::Real, 8),
        1 => (Kind::Real, 4),
        2 => (Kind::Signed, 4),
        3 => (Kind::Signed, 2),
        4 => (Kind::Unsigned, 2),
        5 => (Kind::Unsigned, 1),
        _ => return None,
    };
    let size = rows.checked_mul(columns)?.checked_mul(width)?;
    let (data, rest) = rest.split_at_checked(size.checked_mul(1 + usize::from(imaginary != 0))?)?;
    let values = || Number::of(of, width, order).map(|number| number.values(&data[..size]));
    match (kind % 10, imaginary) {
        (0, 0) => found.add(name, vec![rows, columns], values()?),
        (1, _) => {
            let text = values()?.iter().filter_map(|code| char::from_u32(*code as u32)).collect();
            found.texts.push((name.clone(), text));
            found.others.push((name, class::TEXT.to_owned()));
        }
        (2, _) => found.others.push((name, class::SPARSE.to_owned())),
        _ => found.others.push((name, class::COMPLEX.to_owned())),
    }
    Some(rest)
}
