//! Files in files that were compressed.

use crate::error::RecordError;

/// The file in a file that gzip compressed.
#[cfg(feature = "gzip")]
pub(super) fn unpacked(bytes: &[u8]) -> Result<Vec<u8>, RecordError> {
    use std::io::Read;

    use crate::files::reading::{MOST_INFLATED, too_large};
    let mut inside = Vec::new();
    let mut decoder = flate2::read::MultiGzDecoder::new(bytes).take(MOST_INFLATED as u64 + 1);
    decoder.read_to_end(&mut inside).map_err(|error| RecordError::undecoded("the gzip file is damaged", error))?;
    if inside.len() > MOST_INFLATED { Err(too_large()) } else { Ok(inside) }
}

#[cfg(not(feature = "gzip"))]
pub(super) fn unpacked(_: &[u8]) -> Result<Vec<u8>, RecordError> {
    let what =
        "a file that gzip compressed is read with the feature \"gzip\" of fmm-record, which is off; or unpack it";
    Err(RecordError::MissingFeature { what: what.into() })
}

/// The largest file in a ZIP archive, as phones export a record beside what describes it, and a sentence if there are
/// several.
#[cfg(any(feature = "npy", feature = "workbook"))]
pub(super) fn largest(bytes: &[u8]) -> Result<(Vec<u8>, Option<String>), RecordError> {
    use std::io::{Cursor, Read};

    use zip::ZipArchive;

    use crate::error::listed;
    use crate::files::reading::{MOST_INFLATED, too_large};
    let damaged = |error| RecordError::undecoded("the ZIP archive cannot be read; unpack it", error);
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let mut files: Vec<(u64, usize, String)> = Vec::new();
    for index in 0..archive.len() {
        let part = archive.by_index(index).map_err(damaged)?;
        if part.is_file() {
            files.push((part.size(), index, format!("\"{}\"", String::from_utf8_lossy(part.name_raw()))));
        }
    }
    let Some((_, index, name)) = files.iter().max_by_key(|(size, index, _)| (*size, usize::MAX - index)) else {
        return Err(RecordError::damaged("the ZIP archive is empty"));
    };
    let mut inside = Vec::new();
    let mut part = archive.by_index(*index).map_err(damaged)?.take(MOST_INFLATED as u64 + 1);
    part.read_to_end(&mut inside).map_err(|error| RecordError::undecoded("the ZIP archive is damaged", error))?;
    if inside.len() > MOST_INFLATED {
        return Err(too_large());
    }
    let names: Vec<String> = files.iter().map(|(_, _, name)| name.clone()).collect();
    let listed = listed(&names);
    let remark = (files.len() > 1).then(|| format!("the archive holds {listed}; the largest, {name}, was read"));
    Ok((inside, remark))
}

#[cfg(not(any(feature = "npy", feature = "workbook")))]
pub(super) fn largest(_: &[u8]) -> Result<(Vec<u8>, Option<String>), RecordError> {
    let what = "a ZIP archive is read with the feature \"workbook\" of fmm-record, which is off; or unpack it";
    Err(RecordError::MissingFeature { what: what.into() })
}

#[cfg(all(test, any(feature = "npy", feature = "workbook")))]
mod tests {
    use std::io::{Cursor, Write};

    use zip::write::{SimpleFileOptions, ZipWriter};

    use crate::error::says;
    use crate::files::Reader;

    fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in files {
            archive.start_file(*name, SimpleFileOptions::default()).unwrap();
            archive.write_all(content).unwrap();
        }
        archive.finish().unwrap().into_inner()
    }

    /// The export of a phone: the record, and folders that describe it.
    #[test]
    fn the_largest_file_of_an_archive_is_read() {
        let record = b"\"Time (s)\",\"Velocity (m/s)\"\n0.00,1.5E0\n0.01,2.5E0\n0.02,0.5E0\n";
        let phone = archive(&[("meta/device.csv", b"\"property\",\"value\"\n"), ("Raw Data.csv", record)]);
        let file = Reader::default().parse(phone).unwrap();
        assert_eq!(file.reading().unwrap().record.values(), [1.5, 2.5, 0.5]);
        let remark = "the archive holds \"meta/device.csv\", \"Raw Data.csv\"; the largest, \"Raw Data.csv\", was read";
        assert_eq!(file.warnings(), [remark]);
        assert!(Reader::default().parse(archive(&[("v.csv", record)])).unwrap().warnings().is_empty());
        let twice = archive(&[("inner.zip", &archive(&[("v.csv", record)]))]);
        assert!(says(&Reader::default().parse(twice), "a ZIP archive in an archive"));
        assert!(says(&Reader::default().parse(archive(&[])), "ZIP archive"));
        assert!(says(&Reader::default().parse(archive(&[("v.csv", record)])[..60].to_vec()), "ZIP archive"));
    }
}
