//! The channels of a file, whatever its format.

use std::collections::HashSet;
use std::error::Error;
use std::path::{Path, PathBuf};

use fmm_record::csv::CsvReader;
use fmm_record::mat::{self, MatFile, MatReader};
use fmm_record::npy::{self, NpyFile, NpyReader, Series};
use fmm_record::uff::{DataSet, UffFile};
use fmm_record::{Column, Quantity, Reading};

/// A file that has been opened, and the sampling rate (Hz) that it is to have if one was given.
pub(crate) struct Source {
    file: File,
    rate: Option<f64>,
}

enum File {
    Text(PathBuf),
    Matlab(MatFile),
    Numpy(NpyFile),
    Universal(UffFile),
}

/// A channel that a file offers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Offer {
    /// What it is called.
    pub(crate) name: String,
    /// What reads it, as names in Universal Files need not differ.
    pub(crate) key: String,
    /// What it measured, if the file says so; another quantity than all that are known is no record.
    pub(crate) quantity: Option<Quantity>,
}

impl Offer {
    fn named(name: String) -> Self {
        Self { key: name.clone(), name, quantity: None }
    }
}

impl Source {
    /// Opens a file, whose format its name tells: `.mat`, `.npy`, `.npz`, `.uff`, `.unv`, `.uf` or `.58`, and separated text
    /// otherwise.
    pub(crate) fn open(path: &Path, rate: Option<f64>) -> Result<Self, Box<dyn Error>> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let file = match extension.as_deref() {
            Some("mat") => File::Matlab(MatFile::read(path)?),
            Some("npy" | "npz") => File::Numpy(NpyFile::read(path)?),
            Some("uff" | "unv" | "uf" | "58") => {
                if rate.is_some() {
                    return Err("a Universal File states its own sampling; leave --rate out".into());
                }
                File::Universal(UffFile::read(path)?)
            }
            _ => File::Text(path.into()),
        };
        Ok(Self { file, rate })
    }

    /// The channels other than time, in the order of the file. Of a Universal File all functions count, whatever they are.
    pub(crate) fn offers(&self) -> Result<Vec<Offer>, Box<dyn Error>> {
        let names = match &self.file {
            File::Text(path) => {
                let first = self.text().read(path)?;
                let time = first.time.as_deref();
                return Ok(first.columns.into_iter().filter(|name| Some(&**name) != time).map(Offer::named).collect());
            }
            File::Universal(file) => {
                let offer = |(index, set): (usize, &DataSet)| Offer {
                    name: set.name(),
                    key: index.to_string(),
                    quantity: match set.record() {
                        Ok(record) if record.quantity() == Quantity::Other => None,
                        Ok(record) => Some(record.quantity()),
                        // A spectrum, or a record with faults: not to be taken unless it is asked for.
                        Err(_) => Some(Quantity::Other),
                    },
                };
                return Ok(file.sets().iter().enumerate().map(offer).collect());
            }
            File::Matlab(file) => matlab_names(file),
            File::Numpy(file) => numpy_names(file),
        };
        // Time stamps are a channel like any other until another one is read with them.
        let read = |name: &String| self.read(name, Quantity::Other).ok()?.time;
        let times: HashSet<String> = names.iter().filter_map(read).collect();
        Ok(names.into_iter().filter(|name| !times.contains(name)).map(Offer::named).collect())
    }

    /// Reads the channel of that `key`, or of that name.
    pub(crate) fn read(&self, key: &str, quantity: Quantity) -> Result<Reading, Box<dyn Error>> {
        match &self.file {
            File::Text(path) => Ok(self.text().channel(Column::from(key)).quantity(quantity).read(path)?),
            File::Matlab(file) => {
                let reader = MatReader::default().channel(key).quantity(quantity);
                Ok(if let Some(rate) = self.rate { reader.rate(rate) } else { reader }.read_from(file)?)
            }
            File::Numpy(file) => {
                let reader = NpyReader::default().channel(key).quantity(quantity);
                Ok(if let Some(rate) = self.rate { reader.rate(rate) } else { reader }.read_from(file)?)
            }
            File::Universal(file) => {
                let mut reading = file.channel(key)?;
                // A file that does not say what it measured leaves it to the caller.
                if reading.record.quantity() == Quantity::Other {
                    reading.record = reading.record.with_quantity(quantity);
                }
                Ok(reading)
            }
        }
    }

    /// What was not as it should be in the file.
    pub(crate) fn warnings(&self) -> Vec<String> {
        match &self.file {
            File::Universal(file) => file.warnings().iter().map(ToString::to_string).collect(),
            _ => Vec::new(),
        }
    }

    fn text(&self) -> CsvReader {
        self.rate.map_or_else(CsvReader::default, |rate| CsvReader::default().rate(rate))
    }
}

/// Vectors by name, matrices by their columns or rows, whichever are longer; scalars are no channels.
fn matlab_names(file: &MatFile) -> Vec<String> {
    let arrays = file.arrays().iter().filter(|array| array.values().len() > 1);
    let names = arrays.flat_map(|array| match array.dimensions() {
        [rows, columns] if *rows > 1 && *columns > 1 => {
            let is_wide = rows < columns;
            let series = |number| {
                if is_wide {
                    mat::Channel::row(array.name(), number)
                } else {
                    mat::Channel::column(array.name(), number)
                }
            };
            (1..=*if is_wide { rows } else { columns }).map(|number| series(number).to_string()).collect()
        }
        _ => vec![array.name().to_owned()],
    });
    names.collect()
}

/// Vectors by name, matrices by their rows or columns, whichever are longer; scalars are no channels.
fn numpy_names(file: &NpyFile) -> Vec<String> {
    let arrays = file.arrays().iter().filter(|array| array.values().len() > 1);
    let names = arrays.flat_map(|array| {
        let series: Vec<Series> = match array.shape() {
            [rows, columns] if *rows > 1 && *columns > 1 => {
                if rows < columns {
                    (0..*rows).map(Series::Row).collect()
                } else {
                    (0..*columns).map(Series::Column).collect()
                }
            }
            // The vector of an npy file has no name by which to call it.
            _ if array.name().is_empty() => vec![Series::Row(0)],
            _ => vec![Series::Whole],
        };
        let channel = |series| npy::Channel { array: array.name().to_owned(), series }.to_string();
        series.into_iter().map(channel).collect::<Vec<_>>()
    });
    names.collect()
}
