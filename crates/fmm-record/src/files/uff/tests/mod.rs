//! Files of others, files with faults, and files written here.

mod faults;
mod files;
mod writing;

use super::*;
use crate::files::reading::{Column, Reading};
use crate::record::Span;

/// A file of the tests.
fn file(name: &str) -> Vec<u8> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The data sets of a file without warnings.
fn sets(bytes: &[u8]) -> Vec<DataSet> {
    let file = UffFile::parse(bytes).unwrap();
    assert!(file.warnings().is_empty());
    file.sets().to_vec()
}

/// A header of type `form` with `points` behind it, and the delimiters.
fn block(identifier: &str, form: &str, points: &[u8]) -> Vec<u8> {
    let mut block = format!(
        "    -1\n{identifier}\nvelocity\nNONE\n07-Jun-24 12:00:00\nNONE\nNONE\n    \
         1         0    0         0 NONE               3  -1 NONE               1   1\n{form}\n        \
         17    0    0    0 Time                 s\n        \
         11    0    0    0 NONE                 m/s\n         \
         0    0    0    0 NONE                 NONE\n         \
         0    0    0    0 NONE                 NONE\n"
    )
    .into_bytes();
    block.extend_from_slice(points);
    block.extend_from_slice(b"    -1\n");
    block
}

fn ascii(form: &str, points: &str) -> Vec<u8> {
    block("    58", form, points.as_bytes())
}

fn real(set: &DataSet) -> &[f64] {
    match set.ordinate() {
        Ordinate::Real(values) => values,
        Ordinate::Complex(_) => panic!("complex"),
    }
}

fn complex(set: &DataSet) -> &[[f64; 2]] {
    match set.ordinate() {
        Ordinate::Complex(values) => values,
        Ordinate::Real(_) => panic!("real"),
    }
}

/// The reading of a channel of a file, or of the only record over time.
fn channel(file: &UffFile, channel: impl Into<Column>) -> Result<Reading, RecordError> {
    file.part(Some(&channel.into()), Span::default())
}

fn reading(file: &UffFile) -> Result<Reading, RecordError> {
    file.part(None, Span::default())
}
