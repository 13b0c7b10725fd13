//! Input of a command: the record, a mode of it, the machine, the laws.

mod question;
mod source;
#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::error::Error;
use std::path::PathBuf;

use clap::Args;
use fmm_frf::{BackboneOptions, IsolatedMode, decay_modes};
use fmm_identify::Preparation;
use fmm_record::Record;

use crate::host::Host;
pub(crate) use question::{Held, Question, limit};
use source::BUNDLED;
pub(crate) use source::{Choice, Input, Layout, in_options, is_motion, motion, motion_called};

/// Group of the options by which a machine is driven, of which a record has one at most, and their names.
pub(crate) const DRIVE: &str = "drive";
pub(crate) const DRIVES: [&str; 3] = ["force", "base", "impact"];

/// File, channel, and measured quantity.
#[derive(Debug, Clone, Args)]
pub(crate) struct Given {
    /// The record, in a format that `fmm formats` lists, or - for standard input; without it, the bundled record of a
    /// bicycle fork
    pub(crate) file: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) choice: Choice,
    /// The mode that is meant, if the record shows several: 1 is the strongest, 2 the next, and 150Hz the one nearest
    /// to that frequency. Where a law is fitted, the others are filtered out
    #[arg(long, value_name = "N|F Hz", value_parser = mode_wanted)]
    pub(crate) mode: Option<ModeWanted>,
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

impl Given {
    /// The preparation of the part that is used.
    pub(crate) fn preparation(&self) -> Preparation {
        let from = self.choice.from.map_or_else(Preparation::default, |from| Preparation::default().from(from));
        self.choice.to.map_or(from, |to| from.to(to)).clock_uncertainty(self.choice.rate_u)
    }

    /// The file, in words.
    pub(crate) fn name(&self) -> String {
        self.file.as_ref().map_or_else(|| "the bundled record".to_owned(), |file| file.display().to_string())
    }

    /// The bytes of the file.
    pub(crate) fn bytes(&self, host: &Host<'_>) -> Result<Cow<'static, [u8]>, Box<dyn Error>> {
        Ok(match &self.file {
            None => Cow::Borrowed(BUNDLED.1),
            Some(file) => Cow::Owned(host.bytes(file)?),
        })
    }

    /// The record.
    pub(crate) fn read(&self, host: &Host<'_>) -> Result<Input, Box<dyn Error>> {
        match &self.file {
            Some(file) => self.choice.read(file, host),
            None => self.choice.read_bundled(),
        }
    }

    /// The record less all modes but the one that is meant, if one is.
    pub(crate) fn read_mode(&self, host: &Host<'_>) -> Result<Input, Box<dyn Error>> {
        let mut input = self.read(host)?;
        if let Some(mode) = self.mode {
            let isolated = IsolatedMode::of(&input.record, &mode.options(&input.record)?)?;
            let (frequency, edge) = (isolated.frequency, isolated.edge);
            let how = format!(
                "the mode at {frequency:.4} Hz, by a filter that looks {edge:.4} s in both directions, which are left \
                 out at both ends"
            );
            input.origin = format!("{}; {how}", input.origin);
            input.record = isolated.record;
        }
        Ok(input)
    }
}
