//! Files of every format, behind one door: [`open`] and [`Reader`].

#[cfg(any(feature = "mat", feature = "npy"))]
pub(crate) mod arrays;
pub(crate) mod clock;
mod csv;
mod data_file;
mod format;
#[cfg(feature = "mat")]
mod mat;
#[cfg(feature = "npy")]
mod npy;
mod number;
mod packed;
mod rate;
pub(crate) mod reading;
#[cfg(any(feature = "json", feature = "wav", feature = "workbook"))]
mod tables;
#[cfg(all(test, feature = "hdf5", feature = "npy"))]
mod tests;
pub mod uff;

use std::path::Path;

use crate::error::RecordError;
use crate::files::reading::{Column, Reading};
use crate::record::Span;
use crate::units::Quantity;

pub use data_file::{Channel, DataFile};
pub use format::Format;

/// Opens a file of measured channels of any format and name: [`Reader::open`] without further statements.
///
/// # Errors
/// Those of [`Reader::open`].
pub fn open(path: impl AsRef<Path>) -> Result<DataFile, RecordError> {
    Reader::default().open(path)
}

/// Opens and reads files of every format. The content shows the format, the name of the file does not matter. A reader
/// holds the statements that the file lacks; a statement that the format makes itself, or has no place for, is refused
/// ([`RecordError::Options`]).
///
/// ```
/// use fmm_record::{Quantity, Reader};
///
/// let text = "# gyro, 500 Hz\ntime;rate\n0,000;1,5\n0,002;1,25\n0,004;0,75\n";
/// let reading = Reader::default().quantity(Quantity::Velocity).unit("rad/s").read_from(text)?;
/// assert_eq!(reading.record.values(), [1.5, 1.25, 0.75]);
/// assert_eq!(reading.record.rate(), 500.0);
/// assert_eq!(reading.channel, "rate");
/// assert_eq!(reading.sampling.to_string(), "found from the time stamps in \"time\"");
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
///
/// # Text
///
/// Separated by commas, semicolons, tabs or bars, or aligned by blanks, in UTF-8 or UTF-16. Files of LabVIEW (`.lvm`),
/// SignalExpress, Tektronix, Rigol, PicoScope and catman, the `sep=` of Excel, and lines of a serial port with a time
/// of day before an arrow or a name before each number need nothing said. Of a ZIP archive the largest file is read.
/// Sheets of workbooks, JSON and sound are read by the same rules; the whole numbers of a sound are counts.
///
/// | what | found by default |
/// |---|---|
/// | separator | semicolon, tab or bar if the rows have one, else blanks between nothing but numbers, else comma; what a first line `sep=;` says |
/// | first row | the first line with as many fields as the last ones have, and numbers where they have numbers |
/// | names | the line above the first row, with the units of a row of units below or above it, also over a row of remarks; or a comment there, if it names the time |
/// | decimal comma | where it is used throughout, between quotes if commas separate columns; one column of whole numbers with commas is refused if it may be two |
/// | thousands | points, commas, blanks or apostrophes between groups of three digits, beside another decimal mark |
/// | time of day | `10:00:00.002` with or without a date; the record begins at 0 s, as it does by the day numbers of spreadsheets and MATLAB, by ms, µs or ns since 1970, and by durations such as `0.002 sec` |
/// | time | the column called `t`, `time`, `Zeit`, `timestamp` or the like, in seconds unless its name tells another unit (ms, µs, ns, min, h, in any usual spelling); else the first column, if it increases uniformly, but not by whole numbers without a unit |
/// | channel | the first column that is neither the time nor called a number of samples |
///
/// If no column is time, a number above the table or in a comment there that is called an interval or a rate (`Sample
/// Interval`, `Delta_X`, `Sample rate: 0.5 kHz`) tells the rate. With a rate, time stamps are not looked at, and the record begins at 0 s.
///
/// # MATLAB (versions 4 to 7.3, HDF5) and NumPy (npy, npz)
///
/// A channel is written as the program writes it: `data`, `run.v` for a field of a structure; `m(:,2)` for the second
/// column of a matrix in MATLAB, `m[:,1]` in NumPy; `m(2,:)` and `m[1]` for the second row. The array of an npy file
/// has no name: `[1]`. A position counts all vectors, and the rows or columns of matrices (whichever are longer), from
/// 0. Where none is named, the file must have exactly one array that can be it: a vector, or a matrix of time and one
///    more series.
///
/// The rate comes from the first of these that exists:
///
/// 1. the rate given;
/// 2. the time stamps given;
/// 3. the first column or row of the channel's own matrix, if it increases uniformly and not by whole numbers;
/// 4. a vector called `t`, `time` or the like of the same length, in the unit of time that its name tells;
/// 5. a scalar whose name means rate or interval, such as `fs`, `ActualRate`, `sample_rate`, `dt`, `Ts`, in upper or
///    lower case.
///
/// Variables of the same structure come before those around it; attributes of HDF5 count like variables. The unit is an
/// attribute or a text called `unit` or `units` of the array or beside it, `v_unit`, or the label of a quantity of
/// Testlab.
///
/// # Universal Files
///
/// A channel is a data set 58, by its description or its position. Its header states time, quantity and unit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reader {
    pub(crate) separator: Option<u8>,
    pub(crate) skip: u64,
    pub(crate) table: Option<usize>,
    pub(crate) repairs: bool,
    pub(crate) time: Option<Column>,
    pub(crate) time_unit: Option<String>,
    pub(crate) channel: Option<Column>,
    pub(crate) rate: Option<f64>,
    pub(crate) span: Span,
    pub(crate) quantity: Quantity,
    pub(crate) unit: String,
}

impl Reader {
    /// Passes over the first `lines` lines of a text, which may hold anything.
    #[must_use]
    pub fn skip(mut self, lines: u64) -> Self {
        self.skip = lines;
        self
    }

    /// The table to read, counted from 1: a segment of LabVIEW, a table below another one with the same names, a sheet.
    /// By default tables whose times go on are one record, and otherwise the first is read, with a remark; of sheets,
    /// the one with most cells.
    #[must_use]
    pub fn table(mut self, table: usize) -> Self {
        self.table = Some(table);
        self
    }

    /// Reads around damaged lines of a text, each with a remark: one at the beginning or the end is left out, and a
    /// straight line between its neighbours stands for one inside.
    #[must_use]
    pub fn repair(mut self) -> Self {
        self.repairs = true;
        self
    }

    /// The byte between columns of a text: comma, semicolon, tab, `|` or `:`; a space stands for blanks, as many as
    /// there are.
    #[must_use]
    pub fn separator(mut self, separator: u8) -> Self {
        self.separator = Some(separator);
        self
    }

    /// The channel to read.
    #[must_use]
    pub fn channel(mut self, column: impl Into<Column>) -> Self {
        self.channel = Some(column.into());
        self
    }

    /// The column of time stamps, in seconds unless its name tells another unit; one that is not known is an error.
    #[must_use]
    pub fn time(mut self, column: impl Into<Column>) -> Self {
        self.time = Some(column.into());
        self
    }

    /// The unit of the time stamps, such as `ms`, whatever their name tells.
    #[must_use]
    pub fn time_unit(mut self, unit: impl Into<String>) -> Self {
        self.time_unit = Some(unit.into());
        self
    }

    /// The sampling rate (Hz).
    #[must_use]
    pub fn rate(mut self, rate: f64) -> Self {
        self.rate = Some(rate);
        self
    }

    /// Leave out the samples before this time (s), whatever they are: values that are not finite are an error only
    /// inside the part that is used.
    #[must_use]
    pub fn from(mut self, time: f64) -> Self {
        self.span.from = Some(time);
        self
    }

    /// Leave out the samples after this time (s), as [`Reader::from`] those before.
    #[must_use]
    pub fn to(mut self, time: f64) -> Self {
        self.span.to = Some(time);
        self
    }

    /// Takes time stamps that are unequally spaced as they are ([`Record::at_times`](crate::Record::at_times)), which
    /// are an error otherwise.
    #[must_use]
    pub fn any_spacing(mut self) -> Self {
        self.span.is_any_spacing = true;
        self
    }

    /// States the quantity of the channel, if the file does not.
    #[must_use]
    pub fn quantity(mut self, quantity: Quantity) -> Self {
        self.quantity = quantity;
        self
    }

    /// Unit of the numbers in the channel, if the file does not state it in a place of its own.
    #[must_use]
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = unit.into();
        self
    }

    /// Reads the channel from the file at `path`: [`Reader::open`] and [`DataFile::reading`].
    ///
    /// # Errors
    /// Those of both.
    pub fn read(&self, path: impl AsRef<Path>) -> Result<Reading, RecordError> {
        self.open(path)?.reading()
    }

    /// Reads the channel from the bytes of a file: [`Reader::parse`] and [`DataFile::reading`].
    ///
    /// # Errors
    /// Those of both.
    pub fn read_from(&self, bytes: impl Into<Vec<u8>>) -> Result<Reading, RecordError> {
        self.parse(bytes)?.reading()
    }
}
