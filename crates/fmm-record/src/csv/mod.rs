//! Records from comma, semicolon or tab separated text.
//!
//! The reader finds out by itself what text files of measuring software differ in: the separator, where the table begins
//! below a preamble, the names of the columns and a row of units below them, decimal points or commas, which column is
//! time. Lines that begin with `#` or `%` and blank lines are skipped wherever they stand, but for names in a comment right
//! above the first row. What it chose is in the [`Reading`]. Files of LabVIEW (`.lvm`), Tektronix, Rigol, PicoScope and
//! catman and the `sep=` of Excel need nothing more; for others, [`CsvReader::skip`] passes over lines.
//!
//! Memory goes to the two columns in use only, so that a file may be larger than the memory. A quote is closed on its own
//! line or is a sign like others.
//!
//! ```
//! use fmm_record::{Quantity, csv::CsvReader};
//!
//! let text = "# gyro, 500 Hz\ntime;rate\n0,000;1,5\n0,002;1,25\n0,004;0,75\n";
//! let reading = CsvReader::default().quantity(Quantity::Velocity).unit("rad/s").read_from(text.as_bytes())?;
//! assert_eq!(reading.record.values(), [1.5, 1.25, 0.75]);
//! assert_eq!(reading.record.rate(), 500.0);
//! assert_eq!(reading.channel, "rate");
//! assert_eq!(reading.sampling.to_string(), "found from the time stamps in \"time\"");
//! # Ok::<(), fmm_record::csv::CsvError>(())
//! ```

mod error;
mod fields;
mod header;
mod layout;
mod lines;
mod number;
mod reader;
mod table;
#[cfg(test)]
mod tests;

use std::path::Path;

pub use error::CsvError;
pub use lines::LONGEST_LINE;
pub use reader::CsvReader;

use crate::Reading;

/// Reads a file with everything found out by itself: [`CsvReader::default`] and [`CsvReader::read`].
///
/// # Errors
/// As [`CsvReader::read`].
pub fn read(path: impl AsRef<Path>) -> Result<Reading, CsvError> {
    CsvReader::default().read(path)
}
