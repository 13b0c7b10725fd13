//! Records from comma, semicolon or tab separated text.
//!
//! The reader finds out by itself what text files of measuring software differ in: the separator, where the table
//! begins below a preamble, the names of the columns and a row of units below them, decimal points or commas, which
//! column is time. Lines that begin with `#` or `%` and blank lines are skipped wherever they stand, but for names in a
//! comment right above the first row. What it chose is in the [`Reading`](crate::Reading). Files of LabVIEW (`.lvm`),
//! Tektronix, Rigol, PicoScope and catman and the `sep=` of Excel need nothing more; for others,
//! [`Reader::skip`](crate::Reader::skip) passes over lines.
//!
//! Memory goes to the two columns in use only, so that a file may be larger than the memory. A quote is closed on its
//! own line or is a sign like others.

mod faults;
mod fields;
mod header;
mod layout;
mod lines;
mod number;
mod reader;
mod row;
mod table;
#[cfg(test)]
mod tests;
