//! The parts of an array: flags, dimensions, name, numbers.

use crate::error::RecordError;
use crate::files::arrays::ArrayFile;
use crate::files::mat::class;
use crate::files::mat::element::MATRIX;
use crate::files::number::{ByteOrder, Kind, Number};

const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const UTF8: u32 = 16;
const UTF16: u32 = 17;
const COMPLEX: u32 = 0x0800;

/// Structures within structures that are followed.
const DEEPEST: usize = 32;

/// Takes an array apart, with the fields of structures as arrays of their own: `s.v`, or `s(2).v` where there are
/// several; `field` is its name in its structure. Nothing is found in one without a name, as the data that MATLAB keeps
/// for its own objects are. An error is a fault before its name is known.
pub(super) fn take_apart(
    body: &[u8],
    order: ByteOrder,
    field: Option<String>,
    depth: usize,
    found: &mut ArrayFile,
) -> Result<(), &'static str> {
    let mut parts = Parts { body, order, at: 0 };
    let flags = parts.next().ok_or("it has no flags")?;
    let (UINT32, Some(word)) = (flags.code, flags.data.get(..4)) else {
        return Err("its flags are not what flags must be");
    };
    let word = order.unsigned(word) as u32;
    let kind = class::of(word & 0xFF);
    // MATLAB's own objects have a name right behind the flags, and no dimensions.
    let dimensions: Vec<usize> = if kind == Some(class::OBJECT) && parts.peek_code() == Some(INT8) {
        Vec::new()
    } else {
        let part = parts.next().ok_or("it has no dimensions")?;
        if part.code != INT32 || part.data.len() < 8 || part.data.len() % 4 != 0 {
            return Err("its dimensions are not two or more whole numbers of 32 bits");
        }
        part.data.as_chunks().0.iter().map(|bytes: &[u8; 4]| order.unsigned(bytes) as usize).collect()
    };
    let name = parts.next().ok_or("it has no name")?;
    let (INT8, Ok(name)) = (name.code, std::str::from_utf8(name.data)) else {
        return Err("its name is not text");
    };
    let name = field.unwrap_or_else(|| name.to_owned());
    if name.is_empty() {
        return Ok(());
    }
    let kind = kind.or((word & COMPLEX != 0).then_some(class::COMPLEX));
    let Some(kind) = kind else {
        match numbers(&mut parts, &dimensions) {
            Ok(values) => found.add(name, dimensions, values),
            Err(what) => found.damaged.push((name, RecordError::damaged(what))),
        }
        return Ok(());
    };
    if kind == class::STRUCTURE
        && let Err(what) = fields(&mut parts, &dimensions, &name, depth, found)
    {
        found.damaged.push((name, RecordError::damaged(what)));
        return Ok(());
    }
    if kind == class::TEXT
        && let Some(text) = parts.next().and_then(|part| short_text(&part, order))
    {
        found.texts.push((name.clone(), text));
    }
    found.others.push((name, kind.to_string()));
    Ok(())
}

/// The fields of a structure, element by element.
fn fields(
    parts: &mut Parts,
    dimensions: &[usize],
    name: &str,
    depth: usize,
    found: &mut ArrayFile,
) -> Result<(), &'static str> {
    if depth == DEEPEST {
        return Err("its structures are too deep");
    }
    let length =
        parts.next().filter(|part| part.code == INT32).ok_or("the length of the names of its fields is missing")?;
    let length = length.data.get(..4).map_or(0, |bytes| parts.order.unsigned(bytes) as usize);
    let names = parts.next().filter(|part| part.code == INT8).ok_or("its fields have no names")?;
    if length == 0 || names.data.len() % length != 0 {
        return Err("the names of its fields do not match their length");
    }
    let until_zero = |name: &[u8]| {
        let length = name.iter().position(|byte| *byte == 0).unwrap_or(name.len());
        String::from_utf8_lossy(&name[..length]).into_owned()
    };
    let names: Vec<String> = names.data.chunks_exact(length).map(until_zero).collect();
    let count = dimensions.iter().try_fold(1usize, |product, size| product.checked_mul(*size));
    let count = count.ok_or("its dimensions are beyond all memory")?;
    if names.is_empty() {
        return Ok(());
    }
    for element in 1..=count {
        for field in &names {
            let part = parts.next().filter(|part| part.code == MATRIX).ok_or("fields of it are missing or cut off")?;
            let path = if count == 1 { format!("{name}.{field}") } else { format!("{name}({element}).{field}") };
            // An empty field may have no content at all.
            if part.data.is_empty() {
                continue;
            }
            if let Err(what) = take_apart(part.data, parts.order, Some(path.clone()), depth + 1, found) {
                found.damaged.push((path, RecordError::damaged(what)));
            }
        }
    }
    Ok(())
}

/// The numbers of a real array.
fn numbers(parts: &mut Parts, dimensions: &[usize]) -> Result<Vec<f64>, &'static str> {
    let part = parts.next().ok_or("its numbers are missing or cut off")?;
    let number = stored(part.code, parts.order).ok_or("its numbers are of an unknown type")?;
    let count = dimensions.iter().try_fold(1usize, |product, size| product.checked_mul(*size));
    if count.and_then(|count| count.checked_mul(number.width)) != Some(part.data.len()) {
        return Err("its dimensions do not match its amount of data");
    }
    Ok(number.values(part.data))
}

/// The text in a part, in UTF-8 or UTF-16 or a byte a letter, if it is no longer than a unit may be.
fn short_text(part: &Part<'_>, order: ByteOrder) -> Option<String> {
    const LONGEST: usize = 64;
    let units: Vec<u16> = match part.code {
        _ if part.data.len() > LONGEST => return None,
        UTF8 => return std::str::from_utf8(part.data).ok().map(str::to_owned),
        UINT16 | UTF16 => part.data.chunks_exact(2).map(|pair| order.unsigned(pair) as u16).collect(),
        _ => part.data.iter().copied().map(u16::from).collect(),
    };
    String::from_utf16(&units).ok()
}

/// A tagged piece of an array.
struct Part<'a> {
    code: u32,
    data: &'a [u8],
}

/// Goes through the pieces of an array.
struct Parts<'a> {
    body: &'a [u8],
    order: ByteOrder,
    at: usize,
}

impl<'a> Parts<'a> {
    /// The next piece; `None` if the body ends before the piece does.
    fn next(&mut self) -> Option<Part<'a>> {
        let rest = self.body.get(self.at..)?;
        let word = self.order.unsigned(rest.get(..4)?) as u32;
        let (code, length, begin) = match (word & 0xFFFF, word >> 16) {
            // Up to four bytes of data stand in the tag itself, their number in its upper half.
            (code, length @ 1..=4) => (code, length as usize, 4),
            (_, 1..) => return None,
            (code, 0) => (code, self.order.unsigned(rest.get(4..8)?) as usize, 8),
        };
        let data = rest.get(begin..)?.get(..length)?;
        self.at += (begin + length).next_multiple_of(8);
        Some(Part { code, data })
    }

    fn peek_code(&self) -> Option<u32> {
        let word = self.order.unsigned(self.body.get(self.at..)?.get(..4)?) as u32;
        Some(word & 0xFFFF)
    }
}

/// Storage of the numbers of a part, by the code of its type: MATLAB stores an array of any class in the smallest type
/// that holds its numbers.
fn stored(code: u32, order: ByteOrder) -> Option<Number> {
    let (kind, width) = match code {
        1 => (Kind::Signed, 1),
        2 => (Kind::Unsigned, 1),
        3 => (Kind::Signed, 2),
        4 => (Kind::Unsigned, 2),
        5 => (Kind::Signed, 4),
        6 => (Kind::Unsigned, 4),
        7 => (Kind::Real, 4),
        9 => (Kind::Real, 8),
        12 => (Kind::Signed, 8),
        13 => (Kind::Unsigned, 8),
        _ => return None,
    };
    Number::of(kind, width, order)
}
