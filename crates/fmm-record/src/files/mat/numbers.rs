//! The parts of an array: flags, dimensions, name, numbers.

use matfile::NumericData;

use super::Kind;
use super::element::{Endian, MATRIX, place};
use crate::RecordError;
use crate::files::arrays::ArrayFile;

const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE_CLASS: u32 = 6;
const COMPLEX: u32 = 0x0800;

/// Structures within structures that are followed.
const DEEPEST: usize = 32;

/// Adds what a variable holds, with the fields of structures as variables of their own: `s.v`, or `s(2).v` where there
/// are several. Nothing is found in one without a name, as the data that MATLAB keeps for its own objects are.
pub(super) fn add(found: &mut ArrayFile, offset: usize, body: &[u8], endian: Endian) {
    if let Err(what) = take_apart(body, endian, None, 0, found) {
        found.damaged.push((place(offset), RecordError::damaged(what)));
    }
}

/// Takes an array apart; `field` is what it is called in its structure. An error is what is wrong before its name is
/// known.
fn take_apart(
    body: &[u8],
    endian: Endian,
    field: Option<String>,
    depth: usize,
    found: &mut ArrayFile,
) -> Result<(), &'static str> {
    let mut parts = Parts { body, endian, at: 0 };
    let flags = parts.next().ok_or("it has no flags")?;
    let (UINT32, Some(word)) = (flags.code, flags.data.first_chunk::<4>()) else {
        return Err("its flags are not what flags must be");
    };
    let word = endian.u32(*word);
    let kind = Kind::of_class(word & 0xFF);
    // MATLAB's own objects have a name right behind the flags, and no dimensions.
    let dimensions: Vec<usize> = if kind == Some(Kind::Object) && parts.peek_code() == Some(INT8) {
        Vec::new()
    } else {
        let part = parts.next().ok_or("it has no dimensions")?;
        if part.code != INT32 || part.data.len() < 8 || part.data.len() % 4 != 0 {
            return Err("its dimensions are not what dimensions must be");
        }
        part.data.as_chunks().0.iter().map(|bytes| endian.u32(*bytes) as usize).collect()
    };
    let name = parts.next().ok_or("it has no name")?;
    let (INT8, Ok(name)) = (name.code, std::str::from_utf8(name.data)) else {
        return Err("its name is not text");
    };
    let name = field.unwrap_or_else(|| name.to_owned());
    if name.is_empty() {
        return Ok(());
    }
    let kind = kind.or((word & COMPLEX != 0).then_some(Kind::Complex));
    let Some(kind) = kind else {
        match numbers(&mut parts, &dimensions, endian) {
            Ok(values) => found.add(name, dimensions, values),
            Err(what) => found.damaged.push((name, RecordError::damaged(what))),
        }
        return Ok(());
    };
    if kind == Kind::Structure
        && let Err(what) = fields(&mut parts, &dimensions, &name, depth, found)
    {
        found.damaged.push((name, RecordError::damaged(what)));
        return Ok(());
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
    let length = parts.next().filter(|part| part.code == INT32).ok_or("its names have no length")?;
    let length = length.data.first_chunk().map_or(0, |bytes| parts.endian.u32(*bytes) as usize);
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
            if let Err(what) = take_apart(part.data, parts.endian, Some(path.clone()), depth + 1, found) {
                found.damaged.push((path, RecordError::damaged(what)));
            }
        }
    }
    Ok(())
}

/// The numbers of a real array.
fn numbers(parts: &mut Parts, dimensions: &[usize], endian: Endian) -> Result<Vec<f64>, &'static str> {
    let part = parts.next().ok_or("its numbers are missing or cut off")?;
    let stored = Stored::of(part.code).ok_or("its numbers are of an unknown type")?;
    let count = dimensions.iter().try_fold(1usize, |product, size| product.checked_mul(*size));
    if count.and_then(|count| count.checked_mul(stored.width)) != Some(part.data.len()) {
        return Err("its dimensions do not match its amount of data");
    }
    if part.data.is_empty() {
        return Ok(Vec::new());
    }
    decode(part.data, &stored, part.code, endian).ok_or("its numbers cannot be decoded")
}

/// A tagged piece of an array.
struct Part<'a> {
    code: u32,
    data: &'a [u8],
}

/// Goes through the pieces of an array.
struct Parts<'a> {
    body: &'a [u8],
    endian: Endian,
    at: usize,
}

impl<'a> Parts<'a> {
    /// The next piece; `None` if the body ends before the piece does.
    fn next(&mut self) -> Option<Part<'a>> {
        let rest = self.body.get(self.at..)?;
        let word = self.endian.u32(*rest.first_chunk()?);
        let (code, length, begin) = match (word & 0xFFFF, word >> 16) {
            // Up to four bytes of data stand in the tag itself, their number in its upper half.
            (code, length @ 1..=4) => (code, length as usize, 4),
            (_, 1..) => return None,
            (code, 0) => (code, self.endian.u32(*rest.get(4..)?.first_chunk()?) as usize, 8),
        };
        let data = rest.get(begin..)?.get(..length)?;
        self.at += (begin + length).next_multiple_of(8);
        Some(Part { code, data })
    }

    fn peek_code(&self) -> Option<u32> {
        let word = self.endian.u32(*self.body.get(self.at..)?.first_chunk()?);
        Some(word & 0xFFFF)
    }
}

/// Storage of a number.
struct Stored {
    /// Bytes per number.
    width: usize,
    /// Class of an array under which matfile accepts numbers so stored. MATLAB stores an array of any class in the
    /// smallest type that holds its numbers; matfile knows few of these pairs, and not even 32-bit integers as
    /// such.
    class: u32,
}

impl Stored {
    fn of(code: u32) -> Option<Self> {
        let (width, class) = match code {
            1 => (1, 8),
            2 => (1, 9),
            3 => (2, 10),
            4 => (2, 11),
            5 => (4, DOUBLE_CLASS),
            6 => (4, 13),
            7 => (4, 7),
            9 => (8, DOUBLE_CLASS),
            12 => (8, 14),
            13 => (8, 15),
            _ => return None,
        };
        Some(Self { width, class })
    }
}

/// Lets matfile decode the numbers, as a file of a single column vector under a class that it accepts.
fn decode(data: &[u8], stored: &Stored, code: u32, endian: Endian) -> Option<Vec<f64>> {
    let count = u32::try_from(data.len() / stored.width).ok().filter(|count| i32::try_from(*count).is_ok())?;
    let length = u32::try_from(data.len()).ok()?;
    let padded = data.len().next_multiple_of(8);
    // Flags, dimensions, a name of one letter and the tag of the numbers.
    let words = [
        [UINT32, 8, stored.class, 0],
        [INT32, 8, count, 1],
        [INT8, 1, endian.u32(*b"x\0\0\0"), 0],
        [14, u32::try_from(56 + padded).ok()?, 0, 0],
    ];
    let word = |number: &u32| endian.bytes_of(*number);
    let mut file = Vec::with_capacity(128 + 64 + padded);
    file.extend_from_slice(&[b' '; 124]);
    file.extend_from_slice(if endian == Endian::Little { b"\x00\x01IM" } else { b"\x01\x00MI" });
    file.extend(words[3][..2].iter().flat_map(word));
    file.extend(words[..3].iter().flatten().flat_map(word));
    file.extend([code, length].iter().flat_map(word));
    file.extend_from_slice(data);
    file.resize(128 + 64 + padded, 0);

    let parsed = matfile::MatFile::parse(&file[..]).ok()?;
    drop(file);
    let [array] = &parsed.arrays()[..] else { return None };
    Some(match array.data() {
        NumericData::Int8 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt8 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int16 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt16 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int32 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt32 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int64 { real, .. } => real.iter().map(|x| *x as f64).collect(),
        NumericData::UInt64 { real, .. } => real.iter().map(|x| *x as f64).collect(),
        NumericData::Single { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Double { real, .. } => real.clone(),
    })
}
