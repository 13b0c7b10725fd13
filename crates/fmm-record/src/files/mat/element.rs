//! The variables in the bytes of a file, found without trusting any of the lengths that it states.

use std::borrow::Cow;
use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::error::RecordError;
use crate::files::number::ByteOrder;
use crate::files::reading::{MOST_INFLATED, too_large};

const HEADER: usize = 128;
pub(super) const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// The order of bytes in a file of version 5 to 7, by its header.
pub(super) fn byte_order(file: &[u8]) -> Result<ByteOrder, RecordError> {
    let length = file.len();
    let order = match file.get(HEADER - 2..HEADER) {
        Some(b"IM") => ByteOrder::Little,
        Some(b"MI") => ByteOrder::Big,
        _ => {
            let what = format!("not a MATLAB file: {length} bytes without the header of one");
            return Err(RecordError::UnknownFormat { what });
        }
    };
    match order.unsigned(&file[HEADER - 4..HEADER - 2]) {
        0x0100 => Ok(order),
        version => {
            let what = format!("a MATLAB file of unknown version {version:#06x}; save it with -v7");
            Err(RecordError::unsupported(what))
        }
    }
}

/// Place of a variable, and the body of its array, as it stands in the file or expanded; or the reason why it cannot be
/// expanded.
type Variable<'a> = (usize, Result<Cow<'a, [u8]>, RecordError>);

/// Name of the variable at `offset` as long as its own name is not known.
pub(super) fn place(offset: usize) -> String {
    format!("(at byte {offset})")
}

/// Goes through the variables of a file.
pub(super) struct Variables<'a> {
    file: &'a [u8],
    order: ByteOrder,
    at: usize,
    budget: usize,
}

impl<'a> Variables<'a> {
    /// The variables of a file whose header has been checked by [`byte_order`].
    pub(super) fn new(file: &'a [u8], order: ByteOrder) -> Self {
        Self { file, order, at: HEADER, budget: MOST_INFLATED }
    }

    /// The next variable; `None` at the end of the file.
    ///
    /// # Errors
    /// Those after which it is not known where the next one begins.
    pub(super) fn next(&mut self) -> Result<Option<Variable<'a>>, RecordError> {
        let offset = self.at;
        let rest = self.file.get(offset..).unwrap_or_default();
        if rest.is_empty() {
            return Ok(None);
        }
        let Some((tag, rest)) = rest.split_first_chunk::<8>() else {
            return Err(truncated(offset, 8, rest.len()));
        };
        let (code, length) = long_tag(*tag, self.order);
        if code != MATRIX && code != COMPRESSED {
            return Err(unknown_element(offset, code));
        }
        let Some(content) = rest.get(..length as usize) else {
            return Err(truncated(offset, length as usize, rest.len()));
        };
        // Arrays are padded to eight bytes, compressed ones are not; padding may be missing at the end of the file.
        let padded = if code == MATRIX { content.len().next_multiple_of(8) } else { content.len() };
        self.at = offset + tag.len() + padded;
        if code == MATRIX {
            return Ok(Some((offset, Ok(Cow::Borrowed(content)))));
        }
        Ok(Some((offset, self.inflate(offset, content).map(Cow::Owned))))
    }

    /// Expands a compressed variable and takes it off the budget. The tag of the array inside says how long it is;
    /// no more than that is expanded.
    fn inflate(&mut self, offset: usize, content: &[u8]) -> Result<Vec<u8>, RecordError> {
        let place = format!("the compressed variable at byte {offset} is damaged");
        let damaged = |error| RecordError::undecoded(&place, error);
        let mut decoder = ZlibDecoder::new(content);
        let mut tag = [0; 8];
        decoder.read_exact(&mut tag).map_err(damaged)?;
        let (code, length) = long_tag(tag, self.order);
        if code != MATRIX {
            return Err(unknown_element(offset, code));
        }
        let length = length as usize;
        if length > self.budget {
            return Err(too_large());
        }
        self.budget -= length;
        let mut body = Vec::new();
        decoder.by_ref().take(length as u64).read_to_end(&mut body).map_err(damaged)?;
        if body.len() < length {
            return Err(truncated(offset, length, body.len()));
        }
        // The checksum stands behind the data, and is compared only when the end of the stream is reached.
        let beyond = std::io::copy(&mut decoder.take(8), &mut std::io::sink()).map_err(damaged)?;
        if beyond < 8 { Ok(body) } else { Err(RecordError::damaged(format!("{place}: data follow the array"))) }
    }
}

/// A variable that ends behind the end of what holds it (bytes).
fn truncated(offset: usize, promised: usize, present: usize) -> RecordError {
    let what = format!(
        "the file is cut off: the variable at byte {offset} promises {promised} bytes, but {present} are there"
    );
    RecordError::damaged(what)
}

/// A variable that is neither an array nor a compressed array.
fn unknown_element(offset: usize, code: u32) -> RecordError {
    RecordError::damaged(format!(
        "the variable at byte {offset} is of type {code}, which is neither an array (14) nor a compressed one (15)"
    ))
}

fn long_tag(tag: [u8; 8], order: ByteOrder) -> (u32, u32) {
    (order.unsigned(&tag[..4]) as u32, order.unsigned(&tag[4..]) as u32)
}
