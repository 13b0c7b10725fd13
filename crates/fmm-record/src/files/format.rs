//! Format of a file by its first bytes.

use crate::error::RecordError;
use crate::files::number::ByteOrder;

/// A format of files that hold records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Columns of numbers as text (CSV, TSV, LVM, …).
    Text,
    /// Workbook of a spreadsheet (XLS, XLSX, XLSB, ODS).
    Workbook,
    /// JSON: arrays, or one object a line.
    Json,
    /// Sound (WAV).
    Wav,
    /// MATLAB, versions 4 to 7.
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
            what: format!(
                "this file is {what}; text, workbooks, JSON, WAV, MATLAB, HDF5, NumPy and Universal Files are read"
            ),
        })
    }

    /// Error of a file whose reader was not compiled.
    #[cfg(not(all(feature = "hdf5", feature = "npy", feature = "workbook", feature = "json", feature = "wav")))]
    pub(super) fn missing(self) -> RecordError {
        let (format, feature) = match self {
            Self::Workbook => ("a workbook", "workbook"),
            Self::Json => ("JSON", "json"),
            Self::Wav => ("a WAV file", "wav"),
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
        let has = |part: &[u8]| head.windows(part.len()).any(|window| window == part);
        if head.starts_with(b"PK") {
            return match () {
                () if has(b"xl/") || has(b"opendocument.spreadsheet") => Ok(Self::Workbook),
                () if has(b".npy") => Ok(Self::Numpy),
                () => Err(ARCHIVE),
            };
        }
        if head.starts_with(b"\x93NUMPY") {
            return Ok(Self::Numpy);
        }
        if head.starts_with(b"\xD0\xCF\x11\xE0") {
            return Ok(Self::Workbook);
        }
        if head.starts_with(b"RIFF") && head.get(8..12) == Some(b"WAVE") {
            return Ok(Self::Wav);
        }
        let is_binary = head.iter().any(|byte| *byte < b'\t');
        let is_that = |begin: &[u8]| head.starts_with(begin) && (is_binary || matches!(begin[0], b'%' | b'<'));
        if let Some((_, what)) = OTHERS.iter().find(|(begin, _)| is_that(begin)) {
            return Err(what);
        }
        if is_json(head) {
            return Ok(Self::Json);
        }
        if is_universal(head) {
            return Ok(Self::Universal);
        }
        if is_catman(head) {
            return Err("a binary file of catman; export it as ASCII or to MATLAB");
        }
        if head.get(257..262) == Some(b"ustar") {
            return Err("a tar archive; unpack it");
        }
        if OF_OCTAVE.iter().any(|begin| head.starts_with(begin)) && has(b"\n# name: ") {
            return Err("a text file of Octave; save it by save -v7");
        }
        if head.starts_with(b"IGOR") {
            return Err("a text of Igor; save its waves as delimited text, with the time as one of them");
        }
        // UTF-16 is text.
        if head.contains(&0) && utf_16(head).is_none() {
            return Err("neither text nor a binary format that is known; export its numbers as CSV");
        }
        Ok(Self::Text)
    }
}

/// Beginnings of other files, what they are, and how their numbers come out of them.
const OTHERS: [(&[u8], &str); 24] = [
    (
        b"TDSm",
        "a TDMS file of LabVIEW; export it as text (LVM) or to MATLAB, or by npTDMS in Python: \
         TdmsFile.read(\"FILE\").as_dataframe(time_index=True).to_csv(\"record.csv\")",
    ),
    (b"|CF,", "a file of imc FAMOS; export it as ASCII or to MATLAB"),
    (b"WAVEDESC", "a waveform of LeCroy; save it as text or to MATLAB"),
    (b":WFM", "a waveform of Tektronix (ISF or WFM); save it as a spreadsheet (CSV)"),
    (b":CURV", "a waveform of Tektronix (ISF); save it as a spreadsheet (CSV)"),
    (b"MDF     ", "an MDF file; export it as CSV or to MATLAB, as asammdf does"),
    (b"PAR1", "a Parquet file; save it as CSV, as pandas does by to_csv"),
    (b"ARROW1", "a Feather file; save it as CSV, as pandas does by to_csv"),
    (b"\x80\x03", PICKLE),
    (b"\x80\x04", PICKLE),
    (b"\x80\x05", PICKLE),
    (b"SQLite format 3", "a database (SQLite); export its table as CSV"),
    (b"\x1F\x8B", "compressed by gzip inside of an archive; unpack it"),
    (b"7z\xBC\xAF", "a 7z archive; unpack it"),
    (b"Rar!", "a RAR archive; unpack it"),
    (b"\xFD7zXZ", "compressed by xz; unpack it"),
    (b"BZh", "compressed by bzip2; unpack it"),
    (b"\x28\xB5\x2F\xFD", "compressed by zstd; unpack it"),
    (b"%PDF-", "a PDF, which has no numbers to read; export the record itself as CSV"),
    (b"\x89PNG", "a picture; export the record itself as CSV"),
    (b"\xFF\xD8\xFF", "a picture; export the record itself as CSV"),
    (b"<?xml", DOCUMENT),
    (b"<!DOCTYPE", DOCUMENT),
    (b"<html", DOCUMENT),
];

/// First lines of texts of Octave, which have one array below another.
const OF_OCTAVE: [&[u8]; 2] = [b"# Created by Octave", b"# Octave"];

const ARCHIVE: &str = "a ZIP archive in an archive; unpack it";

const DOCUMENT: &str = "a document of XML or HTML; export its table as CSV";

const PICKLE: &str = "a pickle of Python; save its arrays by numpy.savez or as CSV";

/// True for an archive that is no workbook and holds no arrays.
pub(super) fn is_archive(head: &[u8]) -> bool {
    head.starts_with(b"PK\x03\x04") && Format::found(head) == Err(ARCHIVE)
}

/// True for a binary file of catman: the number of its version, the place of its data, and the length of a comment.
fn is_catman(head: &[u8]) -> bool {
    let number = |at: usize| head.get(at..at + 2).map_or(0, |bytes| u16::from_le_bytes([bytes[0], bytes[1]]));
    (5001..=5020).contains(&number(0)) && head.get(4..6) == Some(&[0, 0])
}

/// The order of bytes in UTF-16 text: by its mark, or by zeros in every second place; `None` for other text.
pub(super) fn utf_16(head: &[u8]) -> Option<ByteOrder> {
    let every_second = |zeros: usize| {
        let mut bytes = head.iter().take(64).enumerate();
        head.len() > 7 && bytes.all(|(place, byte)| (place % 2 == zeros) == (*byte == 0))
    };
    match head {
        [0xFF, 0xFE, ..] => Some(ByteOrder::Little),
        [0xFE, 0xFF, ..] => Some(ByteOrder::Big),
        _ if every_second(1) => Some(ByteOrder::Little),
        _ if every_second(0) => Some(ByteOrder::Big),
        _ => None,
    }
}

/// True for the beginning of a list or an object of JSON: a bracket may also begin a title, and a brace a formula.
fn is_json(head: &[u8]) -> bool {
    let head = head.strip_prefix("\u{FEFF}".as_bytes()).unwrap_or(head).trim_ascii_start();
    let Some((open, rest)) = head.split_first() else { return false };
    match (open, rest.trim_ascii_start().first()) {
        (b'{', Some(next)) => matches!(next, b'"' | b'}'),
        (b'[', Some(next)) => matches!(next, b'[' | b'{' | b'-' | b'"' | b'0'..=b'9'),
        _ => false,
    }
}

impl std::fmt::Display for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Text => "separated text",
            Self::Workbook => "workbook",
            Self::Json => "JSON",
            Self::Wav => "WAV",
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
        assert_eq!(Format::found(b"t\0,\0v\0\r\0\n\0"), Ok(Format::Text), "UTF-16 without its mark");
        assert_eq!(Format::found(b"\0t\0,\0v\0\n"), Ok(Format::Text));
        for begin in ["{\"t\": [0, 1]}", "[[0, 1]]", "\u{FEFF}\n[{}]", "[1, 2]", "{}"] {
            assert_eq!(Format::found(begin.as_bytes()), Ok(Format::Json), "{begin}");
        }
        for begin in ["[Header]\n0,1\n", "{title}\n", "[s],[m/s]\n0,1\n"] {
            assert_eq!(Format::found(begin.as_bytes()), Ok(Format::Text), "{begin}");
        }
        assert_eq!(Format::found(b"PK\x03\x04\0\0[Content_Types].xml\0xl/workbook.xml"), Ok(Format::Workbook));
        assert_eq!(Format::found(b"RIFF\0\0\0\0WAVE"), Ok(Format::Wav));
        for (head, word) in [
            (&b"\x94\x13\x90\x01\0\0\x04\0cat1"[..], "catman"),
            (b"|CF,2,1,1;|CK,1,3,1,1;\0", "FAMOS"),
            (b":WFMPRE:BYT_NR 2;ENC BIN;:CURVE #43000\0\x01", "Tektronix"),
            (b"PK\x03\x04\0\0word/document.xml", "ZIP"),
            (b"TDSm\x0E\0", "npTDMS"),
            (b"# Created by Octave 8.4.0\n# name: t\n# type: matrix\n", "-v7"),
            (b"IGOR\nWAVES/D\tv\nBEGIN\n", "delimited"),
            (b"%PDF-1.7", "PDF"),
            (b"PAR1\x15\0", "Parquet"),
            (b"<?xml version", "XML"),
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
