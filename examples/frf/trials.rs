//! Trials from files: two channels of each, as records of force and response.

use std::error::Error;
use std::path::{Path, PathBuf};

use fmm_record::{Quantity, Reading, Record, Unit};

use super::source::{Offer, Source};

/// One blow.
pub(crate) struct Trial {
    pub(crate) name: String,
    pub(crate) force: Record,
    pub(crate) response: Record,
    /// Which channels they are and how the rate was found.
    pub(crate) origin: String,
    /// What was not as it should be in the file.
    pub(crate) warnings: Vec<String>,
}

/// Which channels to read, and in which unit.
pub(crate) struct Choice<'a> {
    pub(crate) force: Option<&'a str>,
    pub(crate) response: Option<&'a str>,
    pub(crate) quantity: Quantity,
    /// From what the file holds to SI units; without a factor it must be in these.
    pub(crate) force_scale: Option<f64>,
    pub(crate) response_scale: Option<f64>,
    pub(crate) rate: Option<f64>,
}

/// The hammer records that come with the examples.
pub(crate) fn bundled() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data");
    (1..=3).map(|hit| folder.join(format!("hammer_{hit}.mat"))).collect()
}

impl Choice<'_> {
    /// Reads the two channels of a file.
    pub(crate) fn read(&self, path: &Path) -> Result<Trial, Box<dyn Error>> {
        let source = Source::open(path, self.rate)?;
        let (force, response) = self.channels(&source.offers()?)?;
        let (force, response) = (source.read(&force, Quantity::Force)?, source.read(&response, self.quantity)?);
        let origin = format!("{} and {}; the sampling rate was {}", force.channel, response.channel, force.sampling);
        let name = path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into());
        Ok(Trial {
            name,
            origin,
            force: in_si(&force, Quantity::Force, self.force_scale, "--force-scale")?,
            response: in_si(&response, self.quantity, self.response_scale, "--response-scale")?,
            warnings: source.warnings(),
        })
    }

    /// The keys of the two channels: as given by name or number, else the first that is said to measure it, else the first
    /// that is called so, else the first free one of which it is not known.
    fn channels(&self, offers: &[Offer]) -> Result<(String, String), Box<dyn Error>> {
        let all = || offers.iter().map(|offer| &offer.name[..]).collect::<Vec<_>>().join(", ");
        let given = |choice: &str| {
            if let Ok(index) = choice.parse::<usize>() {
                let offer = offers.get(index).map(|offer| offer.key.clone());
                return offer
                    .ok_or_else(|| format!("there is no channel {index}; there are, counted from 0: {}", all()));
            }
            let called: Vec<&Offer> = offers.iter().filter(|offer| offer.name == choice).collect();
            // What is not on offer may still be another way to write it; if not, the reader says what there is.
            Ok(if let [offer] = called[..] { offer.key.clone() } else { choice.to_owned() })
        };
        let found = |quantity: Quantity, taken: Option<&str>| {
            let word = quantity.to_string();
            let free = || offers.iter().filter(|offer| Some(&offer.key[..]) != taken);
            let measured = free().find(|offer| offer.quantity == Some(quantity));
            let mut unknown = free().filter(|offer| offer.quantity.is_none());
            let called = || unknown.clone().find(|offer| offer.name.to_lowercase().contains(&word));
            let found = measured.or_else(called).or_else(|| unknown.next()).map(|offer| offer.key.clone());
            found.ok_or_else(|| {
                format!(
                    "which channel is the {word}? Name it, or say with --quantity what the response is; there are: {}",
                    all()
                )
            })
        };
        let force = self.force.map_or_else(|| found(Quantity::Force, None), given)?;
        let response = self.response.map_or_else(|| found(self.quantity, Some(&force)), given)?;
        if force == response {
            let name = offers.iter().find(|offer| offer.key == force).map_or(&force, |offer| &offer.name);
            return Err(format!("channel {name} cannot be both force and response").into());
        }
        Ok((force, response))
    }
}

/// The record of a reading in SI units, by the `scale` that its `option` gave.
fn in_si(reading: &Reading, quantity: Quantity, scale: Option<f64>, option: &str) -> Result<Record, Box<dyn Error>> {
    let (channel, found) = (&reading.channel, reading.record.quantity());
    if found != quantity {
        return Err(format!("the file says that {channel} is a {found}, and no {quantity}").into());
    }
    let (unit, stated) = (unit(quantity), reading.record.unit());
    let is_si = stated.trim().is_empty()
        || stated.parse().is_ok_and(|stated: Unit| stated.si() == unit && stated.factor() == 1.0);
    if scale.is_none() && !is_si {
        return Err(
            format!("{channel} is in \"{stated}\"; give the factor that turns it into {unit} as {option}").into()
        );
    }
    Ok(reading.record.scaled(scale.unwrap_or(1.0), unit)?)
}

/// SI unit of a force or a response.
fn unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Force => "N",
        Quantity::Displacement => "m",
        Quantity::Acceleration => "m/s²",
        _ => "m/s",
    }
}
