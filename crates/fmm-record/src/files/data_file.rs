//! Open file: its format, its channels, and their records.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::format::{is_archive, utf_16};
use super::packed;
use super::{Format, Reader};
use crate::error::RecordError;
#[cfg(any(feature = "mat", feature = "npy"))]
use crate::files::arrays::{Array, ArrayFile, Slice};
use crate::files::reading::{Column, Reading};
#[cfg(any(feature = "json", feature = "wav", feature = "workbook"))]
use crate::files::tables;
use crate::files::uff;
use crate::units::label::Label;
use crate::units::request::Request;
use crate::units::seconds_in;

/// Length of the part of a file that tells its format (bytes).
const HEAD: usize = 1 << 16;

/// A file that has been opened: its format, its channels, and their records.
///
/// ```
/// use fmm_record::{Format, Quantity, Reader, Request};
///
/// let file = Reader::default().parse("t [ms];x [mm];v [mm/s]\n0;1;5\n2;2;6\n4;1;7\n")?;
/// assert_eq!(file.format(), Format::Text);
/// let channels = file.channels()?;
/// assert_eq!((channels.len(), channels[1].label.name(), channels[1].rate), (2, "v [mm/s]", Some(500.0)));
/// assert_eq!(channels[1].label.unit().map(|unit| unit.factor()), Some(1e-3));
///
/// assert_eq!(file.channel("v [mm/s]")?.record.values(), [5.0, 6.0, 7.0]);
/// let displacement = file.choose(&Request::default().quantity(Quantity::Displacement))?;
/// assert_eq!(displacement.channel, "x [mm]");
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Debug, Clone)]
pub struct DataFile {
    reader: Reader,
    format: Format,
    content: Content,
    /// Choices in the file as a whole, in sentences.
    remarks: Vec<String>,
}

#[derive(Debug, Clone)]
enum Content {
    /// Text is read when a channel is asked for, as it may be larger than the memory.
    Text(Source),
    #[cfg(any(feature = "mat", feature = "npy"))]
    Arrays(ArrayFile),
    Universal(uff::UffFile),
}

/// Place of the text of a file.
#[derive(Debug, Clone)]
enum Source {
    Path(std::path::PathBuf),
    Bytes(Vec<u8>),
}

impl Source {
    fn open(&self) -> Result<Box<dyn Read + '_>, RecordError> {
        Ok(match self {
            Self::Path(path) => Box::new(File::open(path).map_err(|source| RecordError::io("read", path, source))?),
            Self::Bytes(bytes) => Box::new(&bytes[..]),
        })
    }
}

/// A channel that a file offers.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Channel {
    /// Its name, and its quantity and unit if the file states them.
    pub label: Label,
    /// Position by which [`DataFile::channel`] reads it, even if names are alike. The time counts as well.
    pub position: usize,
    /// Its sampling rate (Hz); `None` if the file does not tell it, or if the channel is no record over time.
    pub rate: Option<f64>,
}

impl Reader {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// [`RecordError::Io`], otherwise as [`Reader::parse`].
    pub fn open(&self, path: impl AsRef<Path>) -> Result<DataFile, RecordError> {
        let path = path.as_ref();
        let failed = |source| RecordError::io("read", path, source);
        let mut file = File::open(path).map_err(failed)?;
        let mut bytes = Vec::new();
        file.by_ref().take(HEAD as u64).read_to_end(&mut bytes).map_err(failed)?;
        // A pipe is read once.
        let is_file = file.metadata().is_ok_and(|metadata| metadata.is_file());
        if is_file && utf_16(&bytes).is_none() && matches!(Format::of(&bytes), Ok(Format::Text)) {
            return self.checked(Format::Text, Content::Text(Source::Path(path.into())));
        }
        file.read_to_end(&mut bytes).map_err(failed)?;
        self.parse(bytes)
    }

    /// Opens the bytes of a file, or of the largest one in a ZIP archive.
    ///
    /// # Errors
    /// [`RecordError::UnknownFormat`] and [`RecordError::MissingFeature`] for the format; [`RecordError::Damaged`] and
    /// [`RecordError::Unsupported`] for the file as a whole; [`RecordError::Options`] for an option that the format
    /// itself decides. A fault of a channel is an error only when the channel is asked for.
    pub fn parse(&self, bytes: impl Into<Vec<u8>>) -> Result<DataFile, RecordError> {
        let mut bytes = bytes.into();
        if bytes.starts_with(b"\x1F\x8B") {
            bytes = packed::unpacked(&bytes)?;
        }
        if is_archive(&bytes[..bytes.len().min(HEAD)]) {
            let (inside, remark) = packed::largest(&bytes)?;
            // An archive in an archive may hold itself.
            let mut file = self.parse_unpacked(inside)?;
            file.remarks.extend(remark);
            return Ok(file);
        }
        self.parse_unpacked(bytes)
    }

    /// [`Reader::parse`] of bytes that are not compressed as a whole.
    fn parse_unpacked(&self, mut bytes: Vec<u8>) -> Result<DataFile, RecordError> {
        let head = &bytes[..bytes.len().min(HEAD)];
        let format = Format::of(head)?;
        if let (Format::Text, Some(order)) = (format, utf_16(head)) {
            let units: Vec<u16> = bytes.chunks(2).map(|pair| order.unsigned(pair) as u16).collect();
            bytes = String::from_utf16_lossy(&units).into_bytes();
        }
        let content = match format {
            Format::Text => Content::Text(Source::Bytes(bytes)),
            #[cfg(feature = "workbook")]
            Format::Workbook => {
                let (text, remark) = tables::workbook::text(bytes, self.table)?;
                let reader = Self { table: None, ..self.clone() };
                let mut file = reader.checked(format, Content::Text(Source::Bytes(text)))?;
                file.remarks.extend(remark);
                return Ok(file);
            }
            #[cfg(feature = "json")]
            Format::Json => Content::Text(Source::Bytes(tables::json::text(&bytes)?)),
            #[cfg(feature = "wav")]
            Format::Wav => Content::Text(Source::Bytes(tables::wav::text(&bytes)?)),
            #[cfg(feature = "mat")]
            Format::Matlab => Content::Arrays(crate::files::mat::parse(&bytes)?),
            #[cfg(feature = "hdf5")]
            Format::Hdf5 => Content::Arrays(crate::files::mat::parse_hdf5(&bytes)?),
            #[cfg(feature = "npy")]
            Format::Numpy => Content::Arrays(crate::files::npy::parse(&bytes)?),
            Format::Universal => Content::Universal(uff::UffFile::parse(&bytes)?),
            #[cfg(not(all(
                feature = "hdf5",
                feature = "npy",
                feature = "workbook",
                feature = "json",
                feature = "wav"
            )))]
            _ => return Err(format.missing()),
        };
        self.checked(format, content)
    }

    /// The open file; refuses options that the format itself decides.
    fn checked(&self, format: Format, content: Content) -> Result<DataFile, RecordError> {
        let Self { separator, skip, time, rate, .. } = self;
        if let Some(unit) = self.time_unit.as_deref().filter(|unit| unit.is_empty() || seconds_in(unit).is_none()) {
            return Err(RecordError::options(format!("\"{unit}\" is no unit of time; give s, ms, us, ns, min or h")));
        }
        let is_universal = format == Format::Universal;
        if is_universal && (time.is_some() || rate.is_some()) {
            return Err(RecordError::options(
                "a Universal File states its own sampling; leave out the rate and the time",
            ));
        }
        let is_text = matches!(content, Content::Text(_));
        let is_laid_out = separator.is_some() || *skip > 0;
        if !is_text && (is_laid_out || self.table.is_some() || self.repairs) {
            let both = if is_laid_out { "the separator and the lines to skip" } else { "the table and the repair" };
            return Err(RecordError::options(format!("the file is of format {format}, and no text: leave out {both}")));
        }
        if time.is_some() && rate.is_some() {
            return Err(RecordError::options("both time stamps and a rate were given; give one of them"));
        }
        Ok(DataFile { reader: self.clone(), format, content, remarks: Vec::new() })
    }
}

impl DataFile {
    /// The format, as the content tells it.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Faults of the file that did not prevent reading it. Variables that cannot be read are
    /// named, with the reason.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.remarks.clone();
        match &self.content {
            Content::Text(_) => {}
            #[cfg(any(feature = "mat", feature = "npy"))]
            Content::Arrays(file) => {
                let warning = |(name, reason): &(String, RecordError)| format!("{name} cannot be read: {reason}");
                warnings.extend(file.damaged.iter().map(warning));
            }
            Content::Universal(file) => warnings.extend_from_slice(file.warnings()),
        }
        warnings
    }

    /// The real numeric arrays of a MATLAB, HDF5 or NumPy file, in the order of the file; empty for other files.
    #[cfg(any(feature = "mat", feature = "npy"))]
    pub fn arrays(&self) -> &[Array] {
        match &self.content {
            Content::Arrays(file) => &file.arrays,
            _ => &[],
        }
    }

    /// The array called `name` in a MATLAB, HDF5 or NumPy file, with or without its unit.
    ///
    /// # Errors
    /// [`RecordError::Channel`] without such an array or with several, [`RecordError::Unsupported`] if it is not a real
    /// numeric array, [`RecordError::Damaged`] if it cannot be read.
    #[cfg(any(feature = "mat", feature = "npy"))]
    pub fn array(&self, name: &str) -> Result<&Array, RecordError> {
        if let Content::Arrays(file) = &self.content {
            return file.array(name);
        }
        let what = format!("there is no variable \"{name}\"; the file is of format {}", self.format);
        Err(RecordError::channel(what))
    }

    /// The channels other than time, in the order of the file: columns of text, vectors, rows or columns of matrices
    /// (whichever are longer), functions of any kind in a Universal File. Numbers that count samples are no channel.
    ///
    /// # Errors
    /// Those of the table of a text file.
    pub fn channels(&self) -> Result<Vec<Channel>, RecordError> {
        match &self.content {
            Content::Text(source) => {
                let columns = self.reader.text_channels(source.open()?)?;
                // All columns have one time.
                let first = columns.first().and_then(|(first, _)| self.channel(*first).ok());
                let rate = first.map(|reading| reading.record.rate());
                let channel = |(position, name): (usize, String)| Channel { label: Label::of(&name), position, rate };
                Ok(columns.into_iter().map(channel).collect())
            }
            #[cfg(any(feature = "mat", feature = "npy"))]
            Content::Arrays(file) => {
                let offers = file.offers();
                let readings: Vec<Option<Reading>> = (0..offers.len()).map(|at| self.channel(at).ok()).collect();
                // Time stamps are a channel like any other until another one is read with them.
                let times: Vec<&String> =
                    readings.iter().flatten().filter_map(|reading| reading.time.as_ref()).collect();
                let channel = |(position, (offer, reading)): (usize, (&Slice, &Option<Reading>))| {
                    let name = offer.written(file.notation);
                    let is_time = offer.is_called_time() || times.contains(&&name);
                    let rate = reading.as_ref().map(|reading| reading.record.rate());
                    let label = || Label::of(&name).with_unit(file.unit(&offer.array));
                    (!is_time).then(|| Channel { label: label(), position, rate })
                };
                Ok(offers.iter().zip(&readings).enumerate().filter_map(channel).collect())
            }
            Content::Universal(file) => {
                let channel = |(position, set): (usize, &uff::DataSet)| {
                    let axis = &set.header.ordinate;
                    let label = Label::of(&set.name()).with_unit(&axis.unit).with_quantity(axis.data_type.quantity());
                    let rate = self.channel(position).ok().map(|reading| reading.record.rate());
                    Channel { label, position, rate }
                };
                Ok(file.sets().iter().enumerate().map(channel).collect())
            }
        }
    }

    /// The record of a channel, by name or by position.
    ///
    /// # Errors
    /// [`RecordError::Channel`] if no channel has the name or position, or several have the name; the errors of the
    /// channel or its time.
    pub fn channel(&self, channel: impl Into<Column>) -> Result<Reading, RecordError> {
        self.read(&self.reader.clone().channel(channel))
    }

    /// The record of the channel that the reader names, or else of the one that is found by default.
    ///
    /// # Errors
    /// Those of [`DataFile::channel`].
    pub fn reading(&self) -> Result<Reading, RecordError> {
        self.read(&self.reader)
    }

    /// The record of the channel that is meant: the only one, or else the one that a request tells out by its quantity
    /// and unit ([`Request::choose`]).
    ///
    /// # Errors
    /// [`RecordError::Unclear`] if it is not clear which channel is meant, otherwise as [`DataFile::channel`].
    pub fn choose(&self, request: &Request) -> Result<Reading, RecordError> {
        let mut channels = self.channels()?;
        if channels.iter().any(|channel| channel.rate.is_some()) {
            channels.retain(|channel| channel.rate.is_some());
        }
        if channels.len() < 2 {
            return self.reading();
        }
        let labels: Vec<Label> = channels.iter().map(|channel| channel.label.clone()).collect();
        self.channel(channels[request.choose(&labels)?].position)
    }

    fn read(&self, reader: &Reader) -> Result<Reading, RecordError> {
        let mut reading = match &self.content {
            Content::Text(source) => reader.read_text(source.open()?)?,
            #[cfg(any(feature = "mat", feature = "npy"))]
            Content::Arrays(file) => file.read(reader)?,
            Content::Universal(file) => file.part(reader.channel.as_ref(), reader.span)?,
        };
        if reading.record.quantity() == crate::units::Quantity::Other {
            reading.record = reading.record.with_quantity(reader.quantity);
        }
        if reading.record.unit().is_empty() {
            reading.record = reading.record.with_unit(&*reader.unit);
        }
        Ok(reading)
    }
}
