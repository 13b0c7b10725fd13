//! Trials from files: two channels of each, as records of force and response.

use std::error::Error;
use std::path::Path;

use clap::Args;
use fmm_record::{Channel, Column, Label, Quantity, Reading, Record};

use crate::files;
use crate::host::Host;
use crate::input::{Layout, in_options, is_motion, motion};
use crate::refusal::Kind;

/// One blow.
pub(crate) struct Trial {
    pub(crate) name: String,
    pub(crate) force: Record,
    pub(crate) response: Record,
    /// Names of the channels, and the origin of the sampling rate.
    pub(crate) origin: String,
    /// Faults of the file.
    pub(crate) warnings: Vec<String>,
}

/// Channels to read, and their units.
#[derive(Debug, Args)]
pub(crate) struct Channels {
    /// The channel with the force, by name or by number counted from 0 without time; as in data(:,2) for a matrix of
    /// MATLAB, data[1] or data[:,1] for one of NumPy
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) force: Option<String>,
    /// The channel with the response
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) response: Option<String>,
    /// Quantity of the response, if neither the file nor the name of the channel says it
    #[arg(long, value_parser = motion())]
    pub(crate) quantity: Option<Quantity>,
    /// Factor that turns the force into N; needed if the file states another unit
    #[arg(long, value_name = "FACTOR")]
    pub(crate) force_scale: Option<f64>,
    /// Factor that turns the response into SI units; needed if the file states others
    #[arg(long, value_name = "FACTOR")]
    pub(crate) response_scale: Option<f64>,
    /// The sampling rate, if there is no time channel
    #[arg(long, value_name = "HZ")]
    pub(crate) rate: Option<f64>,
    #[command(flatten)]
    pub(crate) layout: Layout,
}

impl Channels {
    /// Reads the two channels of a file.
    pub(crate) fn read(&self, path: &Path, host: &Host<'_>) -> Result<Trial, Box<dyn Error>> {
        let mut reader = self.layout.reader();
        if let Some(rate) = self.rate {
            reader = reader.rate(rate);
        }
        let file = host.open(&reader, path)?;
        let (force, response, quantity) = self.channels(&file.channels()?)?;
        let (force, response) = (file.channel(force)?, file.channel(response)?);
        let origin = format!("{} and {}; the sampling rate was {}", force.channel, response.channel, force.sampling);
        Ok(Trial {
            name: files::name(path),
            origin,
            force: in_si(&force, Quantity::Force, self.force_scale, "--force-scale")?,
            response: in_si(&response, quantity, self.response_scale, "--response-scale")?,
            warnings: file.warnings().iter().chain(&force.remarks).map(|remark| in_options(remark)).collect(),
        })
    }

    /// The two channels, and what the response measured.
    ///
    /// A channel is as given by name or number, else the first that is said to measure it, else the first that is
    /// called so, else the first free one of which it is not known; but a response of which nothing is known is
    /// refused.
    fn channels(&self, offers: &[Channel]) -> Result<(Column, Column, Quantity), Box<dyn Error>> {
        let all = || offers.iter().map(|offer| offer.label.name()).collect::<Vec<_>>().join(", ");
        // A spectrum, or a record with faults, is not to be taken unless it is asked for.
        let is_known = offers.iter().any(|offer| offer.rate.is_some());
        let is_series = |offer: &Channel| offer.rate.is_some() || !is_known;
        let missing = |what: String| Kind::Channel.refusal(what);
        let given = |choice: &str| {
            if let Ok(index) = choice.parse::<usize>() {
                return offers.get(index).map(key).ok_or_else(|| {
                    missing(format!("there is no channel {index}; there are, counted from 0: {}", all()))
                });
            }
            let called: Vec<&Channel> = offers.iter().filter(|offer| offer.label.name() == choice).collect();
            // What is not on offer may still be another way to write it; if not, the reader says what there is.
            Ok(if let [offer] = called[..] { key(offer) } else { Column::Name(choice.to_owned()) })
        };
        let found = |quantity: Quantity, taken: Option<&Column>| {
            let word = quantity.to_string();
            let free = || offers.iter().filter(|offer| Some(&key(offer)) != taken);
            let measured = free().find(|offer| is_series(offer) && offer.label.stated_quantity() == Some(quantity));
            let mut unknown = free().filter(|offer| is_series(offer) && offer.label.stated_quantity().is_none());
            let called = || unknown.clone().find(|offer| offer.label.name().to_lowercase().contains(&word));
            let found = measured.or_else(called).or_else(|| unknown.next()).map(key);
            found.ok_or_else(|| {
                missing(format!(
                    "which channel is the {word}? Name it, or say with --quantity what the response is; there are: {}",
                    all()
                ))
            })
        };
        let force = self.force.as_deref().map_or_else(|| found(Quantity::Force, None), given)?;
        let moves = |offer: &&Channel| {
            key(offer) != force && is_series(offer) && told(offer).is_some_and(|told| told != Quantity::Force)
        };
        let moving = || offers.iter().find(moves).map(key);
        let silent = || {
            Kind::Unclear.refusal(format!(
                "no channel says what the response measured; give --quantity; there are, counted from 0: {}",
                all()
            ))
        };
        let response = match (self.response.as_deref(), self.quantity) {
            (Some(choice), _) => given(choice)?,
            (None, Some(quantity)) => found(quantity, Some(&force))?,
            (None, None) => moving().ok_or_else(silent)?,
        };
        if force == response {
            let name = offers.iter().find(|offer| key(offer) == force).map(|offer| offer.label.name().to_owned());
            let name = name.or(self.force.clone()).unwrap_or_default();
            return Err(Kind::Contradiction
                .refusal(format!("channel {name} cannot be both force and response"))
                .into());
        }
        let written =
            || self.response.as_deref().and_then(|name| Label::of(name).quantity()).filter(|told| is_motion(*told));
        let offered = || offers.iter().find(|offer| key(offer) == response).and_then(told);
        let quantity = self.quantity.or_else(|| offered().or_else(written)).ok_or_else(silent)?;
        Ok((force, response, quantity))
    }
}

/// Number of a channel, as names in Universal Files need not differ.
fn key(channel: &Channel) -> Column {
    Column::Index(channel.position)
}

/// The motion, or the force, that the file or the name of the channel says it measured.
fn told(channel: &Channel) -> Option<Quantity> {
    let told = channel.label.stated_quantity().or_else(|| Label::of(channel.label.name()).quantity());
    told.filter(|told| is_motion(*told) || *told == Quantity::Force)
}

/// The record of a reading in SI units, by the `scale` that its `option` gave.
fn in_si(reading: &Reading, quantity: Quantity, scale: Option<f64>, option: &str) -> Result<Record, Box<dyn Error>> {
    let (channel, found) = (&reading.channel, reading.record.quantity());
    // A file that does not say what it measured leaves it to the caller.
    if found != quantity && found != Quantity::Other {
        let what = format!("the file says that {channel} is a {found}, and no {quantity}");
        return Err(Kind::Contradiction.refusal(what).into());
    }
    let (unit, label) = (unit(quantity), Label::from(reading));
    let stated = label.unit().map(ToString::to_string).or_else(|| label.unknown_unit().map(str::to_owned));
    let is_si = stated.is_none() || label.unit().is_some_and(|stated| stated.si() == unit && stated.factor() == 1.0);
    let stated = stated.unwrap_or_default();
    if scale.is_none() && !is_si {
        return Err(
            format!("{channel} is in \"{stated}\"; give the factor that turns it into {unit} as {option}").into()
        );
    }
    Ok(reading.record.scaled(scale.unwrap_or(1.0), unit)?.with_quantity(quantity))
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
