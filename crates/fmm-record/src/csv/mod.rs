//! Records from comma, semicolon or tab separated text.
//!
//! The reader finds out by itself what text files of measuring software differ in: the separator, whether there
//! is a header row, decimal points or commas, which column is time. Lines that begin with `#` or `%` and blank
//! lines are skipped wherever they stand. What it chose is in the [`Reading`].
//!
//! Memory goes to the two columns in use only, so that a file may be larger than the memory.
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
