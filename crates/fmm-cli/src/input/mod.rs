//! Input of a command: the record, a mode of it, the machine, the laws.

mod question;
mod source;
#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::error::Error;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fmm_frf::{BackboneOptions, IsolatedMode, decay_modes};
use fmm_identify::Preparation;
use fmm_record::{Column, Quantity, Record, Request, WrittenUnit};

use crate::files;
pub(crate) use question::{Held, Question};
use source::BUNDLED;
pub(crate) use source::{Choice, Input};

/// File, channel, and measured quantity.
#[derive(Debug, Args)]
pub(crate) struct Given {
    /// The record, in a format that `fmm formats` lists; without it, the bundled record of a bicycle fork
    pub(crate) file: Option<PathBuf>,
    /// The channel with the motion, by name, with or without its unit, or by number counted from 0. Without it: the
    /// only channel, or the one that fits --quantity and --unit, or the one whose unit is that of a velocity or else of
    /// a displacement
    #[arg(long, value_name = "NAME|INDEX")]
    pub(crate) channel: Option<Column>,
    /// The channel with the time (s)
    #[arg(long, value_name = "NAME|INDEX", conflicts_with = "rate")]
    pub(crate) time: Option<Column>,
    /// The sampling rate, if there is no time channel
    #[arg(long, value_name = "HZ")]
    pub(crate) rate: Option<f64>,
    /// Quantity of the channel; found by its unit, as in "v [mm/s]" or "theta_rad", or by a word in its name
    #[arg(long, value_enum)]
    pub(crate) quantity: Option<Measured>,
    /// Factor that turns the numbers of the channel into --unit; both count instead of a unit in the file. A unit in
    /// the name, as in "v [mm/s]", needs no factor
    #[arg(long, value_name = "FACTOR")]
    pub(crate) scale: Option<f64>,
    /// Unit of the channel, such as mm/s, rad or V, after scaling by --scale; needed if the file tells none. With
    /// --quantity but no unit anywhere, SI units are taken
    #[arg(long)]
    pub(crate) unit: Option<WrittenUnit>,
    /// Use the record from this time on
    #[arg(long, value_name = "S")]
    from: Option<f64>,
    /// Use the record up to this time
    #[arg(long, value_name = "S")]
    to: Option<f64>,
    /// The mode that is meant, if the record shows several: 1 is the strongest, 2 the next, and 150Hz the one nearest
    /// to that frequency. Where a law is fitted, the others are filtered out
    #[arg(long, value_name = "N|F Hz", value_parser = mode_wanted)]
    pub(crate) mode: Option<ModeWanted>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Measured {
    Velocity,
    Displacement,
    Acceleration,
}

/// Chosen mode of a decay.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ModeWanted {
    /// Place in the order of strength, from 1 on.
    Number(usize),
    /// The one nearest to this frequency (Hz), if it is within a fifth of it.
    Near(f64),
}

/// A number of a mode, or a frequency with its unit, Hz.
fn mode_wanted(text: &str) -> Result<ModeWanted, String> {
    let refused = || format!("{text:?} is no mode; give a number from 1 on, or a frequency with its unit, as in 150Hz");
    match text.trim().strip_suffix("Hz") {
        Some(frequency) => {
            let frequency = frequency.trim().parse().ok().filter(|frequency: &f64| *frequency > 0.0);
            frequency.filter(|frequency| frequency.is_finite()).map(ModeWanted::Near)
        }
        None => text.trim().parse().ok().filter(|number| *number > 0).map(ModeWanted::Number),
    }
    .ok_or_else(refused)
}

impl ModeWanted {
    /// Options of a backbone of this mode of `record`.
    pub(crate) fn options(self, record: &Record) -> Result<BackboneOptions, Box<dyn Error>> {
        let frequency = match self {
            Self::Near(frequency) => frequency,
            Self::Number(number) => {
                let modes = decay_modes(record);
                let missing = || format!("there is no mode number {number}; the record shows {}", modes.len());
                modes.get(number - 1).ok_or_else(missing)?.frequency
            }
        };
        Ok(BackboneOptions::default().at(frequency)?)
    }
}

impl From<Measured> for Quantity {
    fn from(measured: Measured) -> Self {
        match measured {
            Measured::Velocity => Self::Velocity,
            Measured::Displacement => Self::Displacement,
            Measured::Acceleration => Self::Acceleration,
        }
    }
}

impl Given {
    /// The preparation of the part that is used.
    pub(crate) fn preparation(&self) -> Preparation {
        let from = self.from.map_or_else(Preparation::default, |from| Preparation::default().from(from));
        self.to.map_or(from, |to| from.to(to))
    }

    /// The bytes of the file.
    pub(crate) fn bytes(&self) -> Result<Cow<'static, [u8]>, Box<dyn Error>> {
        Ok(match &self.file {
            None => Cow::Borrowed(BUNDLED.1),
            Some(file) => Cow::Owned(files::bytes(file)?),
        })
    }

    /// The record.
    pub(crate) fn read(&self) -> Result<Input, Box<dyn Error>> {
        let mut request = Request::default();
        if let Some(quantity) = self.quantity {
            request = request.quantity(quantity.into());
        }
        if let Some(unit) = &self.unit {
            request = request.unit(unit.clone());
        }
        if let Some(scale) = self.scale {
            request = request.scale(scale);
        }
        let (channel, time, rate) = (self.channel.clone(), self.time.clone(), self.rate);
        let choice = Choice { channel, time, rate, from: self.from, to: self.to, request, is_drive: false };
        match &self.file {
            Some(file) => choice.read(file),
            None => choice.read_bundled(),
        }
    }

    /// The record less all modes but the one that is meant, if one is.
    pub(crate) fn read_mode(&self) -> Result<Input, Box<dyn Error>> {
        let mut input = self.read()?;
        if let Some(mode) = self.mode {
            let isolated = IsolatedMode::of(&input.record, &mode.options(&input.record)?)?;
            let (frequency, edge) = (isolated.frequency, isolated.edge);
            let how = format!(
                "the mode at {frequency:.4} Hz, by a filter that looks {edge:.4} s in both directions, which are left out at both ends"
            );
            input.origin = format!("{}; {how}", input.origin);
            input.record = isolated.record;
        }
        Ok(input)
    }
}
