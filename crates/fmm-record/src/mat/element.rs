//! The variables in the bytes of a file, found without trusting any of the lengths that it states.

use std::borrow::Cow;
use std::io::Read;

use libflate::zlib::Decoder;

use super::{MOST_INFLATED, MatError};

const HEADER: usize = 128;
pub(super) const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Order of the bytes in a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Endian {
    Little,
    Big,
}

impl Endian {
    pub(super) fn u16(self, bytes: [u8; 2]) -> u16 {
        match self {
            Self::Little => u16::from_le_bytes(bytes),
            Self::Big => u16::from_be_bytes(bytes),
        }
    }

    pub(super) fn u32(self, bytes: [u8; 4]) -> u32 {
        match self {
            Self::Little => u32::from_le_bytes(bytes),
            Self::Big => u32::from_be_bytes(bytes),
        }
    }

    pub(super) fn bytes_of(self, number: u32) -> [u8; 4] {
        match self {
            Self::Little => number.to_le_bytes(),
            Self::Big => number.to_be_bytes(),
        }
    }
}

/// Checks the header of the file.
pub(super) fn endian(file: &[u8]) -> Result<Endian, MatError> {
    const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
    // HDF5 allows a user block before its signature; MATLAB puts its own header there.
    let hdf5_at = |offset: usize| file.get(offset..).is_some_and(|rest| rest.starts_with(HDF5));
    if file.starts_with(b"MATLAB 7.3") || [0, 512, 1024, 2048].into_iter().any(hdf5_at) {
        return Err(MatError::Version73);
    }
    let not_mat = MatError::NotMat { length: file.len() };
    let endian = match file.get(HEADER - 2..HEADER) {
        Some(b"IM") => Endian::Little,
        Some(b"MI") => Endian::Big,
        _ if is_version_4(file) => return Err(MatError::Version4),
        _ => return Err(not_mat),
    };
    match endian.u16([file[HEADER - 4], file[HEADER - 3]]) {
        0x0100 => Ok(endian),
        0x0200 => Err(MatError::Version73),
        version => Err(MatError::UnknownVersion { version }),
    }
}

/// A version 4 file begins with five numbers: type (decimal digits M, O, P, T), rows, columns, complex or not,
/// length of the name that follows, with its terminating zero.
fn is_version_4(file: &[u8]) -> bool {
    let Some(head) = file.first_chunk::<20>() else { return false };
    [Endian::Little, Endian::Big].into_iter().any(|endian| {
        let number = |i: usize| endian.u32([head[4 * i], head[4 * i + 1], head[4 * i + 2], head[4 * i + 3]]);
        let (kind, complex, name) = (number(0), number(3), number(4) as usize);
        let digits = kind / 1000 <= 4 && kind / 100 % 10 == 0 && kind / 10 % 10 <= 5 && kind % 10 <= 2;
        digits && complex <= 1 && (2..=64).contains(&name) && file.get(19 + name) == Some(&0)
    })
}

/// The body of an array, as it stands in the file or expanded.
pub(super) struct Variable<'a> {
    pub(super) offset: usize,
    pub(super) body: Cow<'a, [u8]>,
}

/// A compressed variable that cannot be expanded, and why.
pub(super) struct Packed {
    pub(super) offset: usize,
    pub(super) reason: String,
}

impl Variable<'_> {
    /// What it is called as long as its name is not known.
    pub(super) fn place(&self) -> String {
        place(self.offset)
    }
}

/// What the variable there is called as long as its name is not known.
pub(super) fn place(offset: usize) -> String {
    format!("(at byte {offset})")
}

/// Goes through the variables of a file.
pub(super) struct Variables<'a> {
    file: &'a [u8],
    endian: Endian,
    at: usize,
    budget: usize,
}

impl<'a> Variables<'a> {
    /// The variables of a file whose header has been checked by [`endian`].
    pub(super) fn new(file: &'a [u8], endian: Endian) -> Self {
        Self { file, endian, at: HEADER, budget: MOST_INFLATED }
    }

    /// The next variable, or why it cannot be expanded; none at the end of the file.
    ///
    /// # Errors
    /// Those after which it is not known where the next one begins.
    pub(super) fn next(&mut self) -> Result<Option<Result<Variable<'a>, Packed>>, MatError> {
        let offset = self.at;
        let rest = self.file.get(offset..).unwrap_or_default();
        if rest.is_empty() {
            return Ok(None);
        }
        let Some((tag, rest)) = rest.split_first_chunk::<8>() else {
            return Err(MatError::Truncated { offset, promised: 8, present: rest.len() as u64 });
        };
        let (code, length) = long_tag(*tag, self.endian);
        if code != MATRIX && code != COMPRESSED {
            return Err(MatError::UnknownElement { offset, code });
        }
        let Some(content) = rest.get(..length as usize) else {
            let (promised, present) = (u64::from(length), rest.len() as u64);
            return Err(MatError::Truncated { offset, promised, present });
        };
        // Arrays are padded to eight bytes, compressed ones are not; padding may be missing at the end of the file.
        let padded = if code == MATRIX { content.len().next_multiple_of(8) } else { content.len() };
        self.at = offset + tag.len() + padded;
        if code == MATRIX {
            return Ok(Some(Ok(Variable { offset, body: Cow::Borrowed(content) })));
        }
        let variable = self.inflate(offset, content).map(|body| Variable { offset, body: Cow::Owned(body) });
        Ok(Some(variable.map_err(|error| Packed { offset, reason: error.to_string() })))
    }

    /// Expands a compressed variable and takes it off the budget. The tag of the array inside says how long it is;
    /// no more than that is expanded.
    fn inflate(&mut self, offset: usize, content: &[u8]) -> Result<Vec<u8>, MatError> {
        let damaged = |error: &dyn std::fmt::Display| MatError::Compression { offset, reason: error.to_string() };
        let mut decoder = Decoder::new(content).map_err(|error| damaged(&error))?;
        let mut tag = [0; 8];
        decoder.read_exact(&mut tag).map_err(|error| damaged(&error))?;
        let (code, length) = long_tag(tag, self.endian);
        if code != MATRIX {
            return Err(MatError::UnknownElement { offset, code });
        }
        let length = length as usize;
        if length > self.budget {
            return Err(MatError::TooLarge { limit: MOST_INFLATED });
        }
        self.budget -= length;
        let mut body = Vec::new();
        decoder.by_ref().take(length as u64).read_to_end(&mut body).map_err(|error| damaged(&error))?;
        if body.len() < length {
            return Err(MatError::Truncated { offset, promised: length as u64, present: body.len() as u64 });
        }
        // The checksum stands behind the data, and is compared only when the end of the stream is reached.
        let beyond = std::io::copy(&mut decoder.take(8), &mut std::io::sink()).map_err(|error| damaged(&error))?;
        if beyond < 8 { Ok(body) } else { Err(damaged(&"data follow the array")) }
    }
}

fn long_tag([a, b, c, d, e, f, g, h]: [u8; 8], endian: Endian) -> (u32, u32) {
    (endian.u32([a, b, c, d]), endian.u32([e, f, g, h]))
}
