//! Format of a file by its first bytes.

use crate::error::RecordError;

/// A format of files that hold records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Columns of numbers as text (CSV, TSV, LVM, …).
    Text,
    /// MATLAB, versions 5 to 7; version 4 is recognised and refused.
    Matlab,
    /// HDF5, which MATLAB writes as version 7.3.
    Hdf5,
    /// NumPy, npy or npz.
    Numpy,
    /// Universal File.
    Universal,
}

impl Format {
    /// The format of a file that begins with `head`, of which 64 KB are enough.
    pub(super) fn of(head: &[u8]) -> Result<Self, RecordError> {
        Self::found(head).map_err(|what| RecordError::UnknownFormat {
            what: format!("this file is {what}; text, MATLAB, HDF5, NumPy and Universal Files are read"),
        })
    }

    /// Error of a file whose reader was not compiled.
    #[cfg(not(all(feature = "hdf5", feature = "npy")))]
    pub(super) fn missing(self) -> RecordError {
        let (format, feature) = match self {
            Self::Hdf5 => ("a MATLAB version 7.3 file (HDF5)", "hdf5"),
            Self::Numpy => ("a file of NumPy", "npy"),
            _ => ("a MATLAB file", "mat"),
        };
        let remedy = if self == Self::Hdf5 { "; or load it in MATLAB and save it with -v7" } else { "" };
        let what = format!("{format} is read with the feature \"{feature}\" of fmm-record, which is off{remedy}");
        RecordError::MissingFeature { what }
    }

    /// The format, or what else it is.
    fn found(head: &[u8]) -> Result<Self, &'static str> {
        const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
        // HDF5 allows a user block before its signature; MATLAB puts its own header there.
        let hdf5_at = |offset: usize| head.get(offset..).is_some_and(|rest| rest.starts_with(HDF5));
        let is_matlab_7_3 = head.starts_with(b"MATLAB 7.3")
            || matches!(head.get(124..128), Some([0, 2, b'I', b'M'] | [2, 0, b'M', b'I']));
        if is_matlab_7_3 || [0, 512, 1024, 2048].into_iter().any(hdf5_at) {
            return Ok(Self::Hdf5);
        }
        let is_matlab = matches!(head.get(124..128), Some([_, 1..=8, b'I', b'M'] | [1..=8, _, b'M', b'I']));
        if is_matlab || is_matlab_4(head) {
            return Ok(Self::Matlab);
        }
        let is_workbook = head.windows(3).any(|window| window == b"xl/");
        if head.starts_with(b"\x93NUMPY") || (head.starts_with(b"PK") && !is_workbook) {
            return Ok(Self::Numpy);
        }
        if is_universal(head) {
            return Ok(Self::Universal);
        }
        match head {
            [b'P', b'K', ..] | [0xD0, 0xCF, 0x11, 0xE0, ..] => Err("a workbook; save its table as CSV"),
            [0x1F, 0x8B, ..] => Err("compressed by gzip; unpack it"),
            [b'R', b'I', b'F', b'F', ..] => Err("a WAV file; convert it to CSV with its rate"),
            [b'T', b'D', b'S', b'm', ..] => Err("a TDMS file of LabVIEW; export it as text (LVM) or to MATLAB"),
            // UTF-16 is text, and is refused as such with a remedy.
            [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => Ok(Self::Text),
            _ if head.contains(&0) => Err("neither text nor a binary format that is known"),
            _ => Ok(Self::Text),
        }
    }
}

impl std::fmt::Display for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Text => "separated text",
            Self::Matlab => "MATLAB",
            Self::Hdf5 => "HDF5 (MATLAB version 7.3)",
            Self::Numpy => "NumPy",
            Self::Universal => "Universal File",
        })
    }
}

/// A version 4 file begins with five numbers: type (decimal digits M, O, P, T), rows, columns, complex or not,
/// length of the name that follows, with its terminating zero.
pub(crate) fn is_matlab_4(head: &[u8]) -> bool {
    let Some(begin) = head.first_chunk::<20>() else { return false };
    [u32::from_le_bytes, u32::from_be_bytes].into_iter().any(|number_in| {
        let number = |i: usize| number_in([begin[4 * i], begin[4 * i + 1], begin[4 * i + 2], begin[4 * i + 3]]);
        let (kind, complex, name) = (number(0), number(3), number(4) as usize);
        let digits = kind / 1000 <= 4 && kind / 100 % 10 == 0 && kind / 10 % 10 <= 5 && kind % 10 <= 2;
        digits && complex <= 1 && (2..=64).contains(&name) && head.get(19 + name) == Some(&0)
    })
}

/// True if a data set begins here: behind a line of -1 in its six columns the number of a data set, or behind any line
/// of -1 the number 58. A column of numbers has neither.
fn is_universal(head: &[u8]) -> bool {
    let mut lines = head.split(|byte| matches!(byte, b'\n' | b'\r')).filter(|line| !line.trim_ascii().is_empty());
    let mut before: &[u8] = b"";
    lines.any(|line| {
        let delimiter = std::mem::replace(&mut before, line).trim_ascii_end();
        let number = line.trim_ascii().split(u8::is_ascii_whitespace).next().unwrap_or_default();
        let is_number = number.first().is_some_and(u8::is_ascii_digit);
        (delimiter == b"    -1" && is_number)
            || (delimiter.trim_ascii_start() == b"-1" && matches!(number, b"58" | b"58b" | b"58B"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_file_is_not() {
        assert_eq!(Format::found(b"-1\n5\n7\n8\n"), Ok(Format::Text), "a column of whole numbers");
        assert_eq!(Format::found(b"    -1\n   151\nname\n"), Ok(Format::Universal));
        assert_eq!(Format::found(b""), Ok(Format::Text), "whose reader says that it is empty");
        assert_eq!(Format::found(b"\xFF\xFEt\0,\0v\0"), Ok(Format::Text));
        for (head, word) in [
            (&b"PK\x03\x04\0\0[Content_Types].xml\0xl/workbook.xml"[..], "workbook"),
            (b"\x1F\x8B\x08\0", "gzip"),
            (b"RIFF\0\0\0\0WAVE", "WAV"),
            (b"TDSm\x0E\0", "LabVIEW"),
            (&[0; 500], "binary"),
        ] {
            assert!(Format::found(head).unwrap_err().contains(word), "{word}");
        }
    }

    #[cfg(not(feature = "npy"))]
    #[test]
    fn a_format_that_is_off_is_refused_with_its_feature() {
        let error = crate::files::Reader::default().parse(*b"\x93NUMPY").unwrap_err();
        assert!(matches!(error, RecordError::MissingFeature { .. }), "{error}");
        assert_eq!(error.to_string(), "a file of NumPy is read with the feature \"npy\" of fmm-record, which is off");
        #[cfg(not(feature = "hdf5"))]
        {
            let error = crate::files::Reader::default().parse(*b"\x89HDF\r\n\x1a\n").unwrap_err().to_string();
            assert!(error.contains("the feature \"hdf5\"") && error.ends_with("save it with -v7"), "{error}");
        }
    }
}
