//! Trials from files: two channels of each, as records of force and response.

use std::error::Error;
use std::path::{Path, PathBuf};

use fmm_record::csv::CsvReader;
use fmm_record::mat::{Array, Channel, MatFile, MatReader};
use fmm_record::{Column, Quantity, Reading, Record};

/// One blow.
pub(crate) struct Trial {
    pub(crate) name: String,
    pub(crate) force: Record,
    pub(crate) response: Record,
    /// Which channels they are and how the rate was found.
    pub(crate) origin: String,
}

/// Which channels to read, and in which unit.
pub(crate) struct Choice<'a> {
    pub(crate) force: Option<&'a str>,
    pub(crate) response: Option<&'a str>,
    pub(crate) quantity: Quantity,
    pub(crate) force_scale: f64,
    pub(crate) response_scale: f64,
    pub(crate) rate: Option<f64>,
}

/// The hammer records that come with the examples.
pub(crate) fn bundled() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data");
    (1..=3).map(|hit| folder.join(format!("hammer_{hit}.mat"))).collect()
}

impl Choice<'_> {
    /// Reads a file of comma, semicolon or tab separated text, or of MATLAB v5 to v7.
    pub(crate) fn read(&self, path: &Path) -> Result<Trial, Box<dyn Error>> {
        let is_mat = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mat"));
        let (force, response) = if is_mat { self.read_mat(path)? } else { self.read_text(path)? };
        let name = path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into());
        let origin = format!("{} and {}; the sampling rate was {}", force.channel, response.channel, force.sampling);
        Ok(Trial {
            name,
            origin,
            force: force.record.scaled(self.force_scale, "N")?,
            response: response.record.scaled(self.response_scale, unit(self.quantity))?,
        })
    }

    fn read_text(&self, path: &Path) -> Result<(Reading, Reading), Box<dyn Error>> {
        let reader = || match self.rate {
            Some(rate) => CsvReader::default().rate(rate),
            None => CsvReader::default(),
        };
        let first = reader().read(path)?;
        let time = first.time.as_deref();
        let names: Vec<&str> = first.columns.iter().map(String::as_str).filter(|name| Some(*name) != time).collect();
        let (force, response) = self.channels(&names)?;
        let channel = |name: &str, quantity| reader().channel(Column::from(name)).quantity(quantity).read(path);
        Ok((channel(&force, Quantity::Force)?, channel(&response, self.quantity)?))
    }

    fn read_mat(&self, path: &Path) -> Result<(Reading, Reading), Box<dyn Error>> {
        let file = MatFile::read(path)?;
        // Vectors by name, matrices column by column as MATLAB writes it; scalars are no channels.
        let columns = |array: &Array| match array.dimensions() {
            [rows, columns] if *rows > 1 && *columns > 1 => {
                (1..=*columns).map(|column| Channel::column(array.name(), column).to_string()).collect()
            }
            _ => vec![array.name().to_owned()],
        };
        let names: Vec<String> =
            file.arrays().iter().filter(|array| array.values().len() > 1).flat_map(columns).collect();
        let (force, response) = self.channels(&names.iter().map(String::as_str).collect::<Vec<_>>())?;
        let channel = |name: &str, quantity| {
            let reader = MatReader::default().channel(name).quantity(quantity);
            let reader = if let Some(rate) = self.rate { reader.rate(rate) } else { reader };
            reader.read_from(&file)
        };
        Ok((channel(&force, Quantity::Force)?, channel(&response, self.quantity)?))
    }

    /// The names of the two channels: as given by name or number, else the one that is called so, else the first free one.
    fn channels(&self, names: &[&str]) -> Result<(String, String), Box<dyn Error>> {
        let called = |word: &str| names.iter().find(|name| name.to_lowercase().contains(word));
        let given = |choice: &str| match choice.parse::<usize>() {
            Ok(index) => names
                .get(index)
                .map(|name| (*name).to_owned())
                .ok_or_else(|| format!("there is no channel {index}; there are, counted from 0: {}", names.join(", "))),
            Err(_) => Ok(choice.to_owned()),
        };
        let missing = |what: &str| format!("which channel is the {what}? There are: {}", names.join(", "));
        let force = match self.force {
            Some(choice) => given(choice)?,
            None => (*called("force").or(names.first()).ok_or_else(|| missing("force"))?).to_owned(),
        };
        let response = if let Some(choice) = self.response {
            given(choice)?
        } else {
            let word = self.quantity.to_string();
            let free = || names.iter().find(|name| **name != force);
            (*called(&word).or_else(free).ok_or_else(|| missing(&word))?).to_owned()
        };
        if force == response {
            return Err(format!("channel {force} cannot be both force and response").into());
        }
        Ok((force, response))
    }
}

/// SI unit of a response.
fn unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Displacement => "m",
        Quantity::Acceleration => "m/s²",
        _ => "m/s",
    }
}
