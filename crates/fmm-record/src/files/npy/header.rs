//! The header of an array: what its numbers are, and how many.

use std::io::Read;

use crate::error::RecordError;
use crate::files::number::{ByteOrder, Kind, Number};

pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// Type, shape and order of an array.
pub(super) struct Header {
    pub(super) number: Number,
    pub(super) fortran: bool,
    pub(super) shape: Vec<usize>,
    /// Number of numbers in the array.
    pub(super) count: usize,
}

/// Storage of the numbers of a NumPy type, as `<f8`; `None` if the type is not real.
fn stored(descr: &str) -> Option<Number> {
    let mut letters = descr.chars();
    let order = letters.next()?;
    let kind = match letters.next()? {
        'f' => Kind::Real,
        'i' => Kind::Signed,
        'u' | 'b' => Kind::Unsigned,
        _ => return None,
    };
    let width = letters.as_str().parse().ok()?;
    let order = match order {
        '<' => ByteOrder::Little,
        '>' => ByteOrder::Big,
        '|' if width == 1 => ByteOrder::Little,
        _ => return None,
    };
    Number::of(kind, width, order)
}

/// Reads a header; `name` is that of the array, for errors.
pub(super) fn read(input: &mut impl Read, name: &str) -> Result<Header, RecordError> {
    let mut take = |length: u64| -> Result<Vec<u8>, RecordError> {
        let mut bytes = Vec::new();
        input
            .by_ref()
            .take(length)
            .read_to_end(&mut bytes)
            .map_err(|error| RecordError::undecoded("the decoder says", error))?;
        if (bytes.len() as u64) < length { Err(truncated(name, length, bytes.len())) } else { Ok(bytes) }
    };
    let start = take(8)?;
    if !start.starts_with(MAGIC) {
        return Err(damaged(name, "it does not begin as an array does"));
    }
    let length = match start[6] {
        1 => ByteOrder::Little.unsigned(&take(2)?),
        2 | 3 => ByteOrder::Little.unsigned(&take(4)?),
        version => {
            let what = format!("{} is of version {version} of the format; known are 1 to 3", called(name));
            return Err(RecordError::damaged(what));
        }
    };
    let text = take(length)?;
    let text = match String::from_utf8(text) {
        Ok(text) => text,
        Err(error) => error.as_bytes().iter().copied().map(char::from).collect(),
    };
    Literal { rest: &text }.header(name)
}

/// The array in words: a file of a single array gives it no name.
fn called(name: &str) -> String {
    if name.is_empty() { "the array".to_owned() } else { format!("the array \"{name}\"") }
}

/// An array that promises more bytes than are there.
pub(super) fn truncated(name: &str, promised: u64, present: usize) -> RecordError {
    let array = called(name);
    let what = format!("{array} is cut off: it promises {promised} bytes, but {present} are there");
    RecordError::damaged(what)
}

/// A header that contradicts the format.
fn damaged(name: &str, what: &str) -> RecordError {
    RecordError::damaged(format!("the header of {} is damaged: {what}", called(name)))
}

/// Numbers that are not real, or no numbers.
fn unsupported(descr: &str) -> RecordError {
    RecordError::unsupported(format!(
        "of type {descr} (read are integers of up to 64 bits, and real numbers of 32 or 64)"
    ))
}

/// Goes through the Python literal of a header, a dictionary.
struct Literal<'a> {
    rest: &'a str,
}

impl<'a> Literal<'a> {
    /// Takes `token` if it comes next.
    fn take(&mut self, token: &str) -> Option<()> {
        self.rest = self.rest.trim_start().strip_prefix(token)?;
        Some(())
    }

    fn comes(&mut self, token: &str) -> bool {
        self.rest.trim_start().starts_with(token)
    }

    fn string(&mut self) -> Option<&'a str> {
        let text = self.rest.trim_start();
        let quote = text.chars().next().filter(|letter| matches!(letter, '\'' | '"'))?;
        let (string, rest) = text[1..].split_once(quote)?;
        self.rest = rest;
        Some(string)
    }

    /// Whole numbers in parentheses.
    fn tuple(&mut self) -> Option<Vec<usize>> {
        let mut numbers = Vec::new();
        self.take("(")?;
        while !self.comes(")") {
            let text = self.rest.trim_start();
            let digits = text.find(|letter: char| !letter.is_ascii_digit())?;
            numbers.push(text[..digits].parse().ok()?);
            // Python 2 writes long numbers with an L.
            self.rest = text[digits..].strip_prefix('L').unwrap_or(&text[digits..]);
            if !self.comes(")") {
                self.take(",")?;
            }
        }
        self.take(")")?;
        Some(numbers)
    }

    fn header(mut self, name: &str) -> Result<Header, RecordError> {
        let error = |what| damaged(name, what);
        let (mut descr, mut fortran, mut shape) = (None, None, None);
        self.take("{").ok_or(error("it is no dictionary"))?;
        while !self.comes("}") {
            let key = self.string().ok_or(error("a key is not text"))?;
            self.take(":").ok_or(error("a key has no value"))?;
            match key {
                "descr" if self.comes("[") => return Err(unsupported("[…] (structure)")),
                "descr" => descr = Some(self.string().ok_or(error("its type is not text"))?),
                "fortran_order" if self.take("True").is_some() => fortran = Some(true),
                "fortran_order" if self.take("False").is_some() => fortran = Some(false),
                "fortran_order" => return Err(error("its order is neither True nor False")),
                "shape" => shape = Some(self.tuple().ok_or(error("its shape is no tuple of whole numbers"))?),
                _ => return Err(error("it has a key that is none of descr, fortran_order, shape")),
            }
            if !self.comes("}") {
                self.take(",").ok_or(error("a comma is missing"))?;
            }
        }
        let (Some(descr), Some(fortran), Some(shape)) = (descr, fortran, shape) else {
            return Err(error("it needs descr, fortran_order and shape"));
        };
        let number = stored(descr).ok_or_else(|| unsupported(&descr.chars().take(20).collect::<String>()))?;
        let count = shape.iter().try_fold(1usize, |count, length| count.checked_mul(*length));
        let count = count
            .filter(|count| count.checked_mul(number.width).is_some())
            .ok_or(error("its shape is beyond all memory"))?;
        Ok(Header { number, fortran, shape, count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(text: &str) -> Result<Header, RecordError> {
        Literal { rest: text }.header("")
    }

    #[test]
    fn literals_as_python_writes_them() {
        for (text, shape, count) in [
            ("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }  \n", &[2, 3][..], 6),
            ("{\"shape\":(4,),\"descr\":\">f8\",\"fortran_order\":True}", &[4], 4),
            ("{'descr': '|u1', 'fortran_order': False, 'shape': (), }", &[], 1),
            ("{'descr': '<i4', 'fortran_order': False, 'shape': (3L, 0L), }", &[3, 0], 0),
        ] {
            let header = header(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!((&header.shape[..], header.count), (shape, count), "{text}");
        }
    }

    #[test]
    fn other_literals_are_refused() {
        for text in [
            "",
            "{",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3)",
            "{'descr': '<f8', 'fortran_order': 0, 'shape': (2, 3)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2 3)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (-2, 3)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2,,3)}",
            "{'descr': '<f8', 'fortran_order': False}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (1,), 'x': 1}",
            "{'descr': '<f8' 'fortran_order': False, 'shape': (1,)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (18446744073709551615, 2)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999,)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904,)}",
        ] {
            assert!(matches!(header(text), Err(RecordError::Damaged { .. })), "{text}");
        }
        for descr in
            ["'<c16'", "'<U5'", "'|O'", "'<f2'", "'<f16'", "'|f8'", "'=f8'", "'<M8[us]'", "''", "'ä'", "[('t', '<f8')]"]
        {
            let text = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': (1,)}}");
            assert!(matches!(header(&text), Err(RecordError::Unsupported { .. })), "{text}");
        }
    }
}
