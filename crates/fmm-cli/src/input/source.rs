//! A ring-down from a file: which channel, what it measured, in which unit.

use std::error::Error;
use std::path::Path;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgAction, Args};
use fmm_model::Rounded;
use fmm_record::{
    Column, DataFile, Format, Label, Quantity, Reader, Reading, Record, RecordError, Request, WrittenUnit,
};

use crate::files;
use crate::host::Host;
use crate::refusal::{Kind, Remedied};

/// The record to identify, and how it was read.
pub(crate) struct Input {
    /// The record, in SI units unless those are not known.
    pub(crate) record: Record,
    /// The file, the channel, what it was taken for, and how its sampling rate was found.
    pub(crate) origin: String,
    /// Faults of the file.
    pub(crate) warnings: Vec<String>,
}

/// Layout of a file, where the table is not all of it.
#[derive(Debug, Default, Clone, Args)]
pub(crate) struct Layout {
    /// Pass over the first lines of a text
    #[arg(long, value_name = "LINES", default_value_t = 0)]
    pub(crate) skip: u64,
    /// The table in the file, counted from 1: a sheet of a workbook, a segment of LabVIEW, a table below another
    #[arg(long, value_name = "N")]
    pub(crate) table: Option<usize>,
    /// Use the text around damaged lines: those at its ends are left out, straight lines stand for those inside
    // A manifest states it as `true`.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", default_value_t = false)]
    #[arg(action = ArgAction::Set, hide_possible_values = true, hide_default_value = true)]
    pub(crate) repair: bool,
}

impl Layout {
    /// A reader of files of this layout.
    pub(crate) fn reader(&self) -> Reader {
        let reader = Reader::default().skip(self.skip);
        let reader = if self.repair { reader.repair() } else { reader };
        self.table.map_or(reader.clone(), |table| reader.table(table))
    }
}

/// Channel, quantity and unit, as far as the user says them; the rest is found in the file.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Choice {
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
    /// Relative standard uncertainty of the sampling rate, or of the clock behind the times
    #[arg(long, value_name = "RELATIVE", default_value_t = 0.0)]
    pub(crate) rate_u: f64,
    /// Unit of the times, such as ms, if their name does not tell it or tells another
    #[arg(long, value_name = "UNIT", conflicts_with = "rate")]
    pub(crate) time_unit: Option<String>,
    #[command(flatten)]
    pub(crate) layout: Layout,
    /// Quantity of the channel; found by its unit, as in "v [mm/s]" or "theta_rad", or by a word in its name
    #[arg(long, value_parser = motion())]
    pub(crate) quantity: Option<Quantity>,
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
    pub(crate) from: Option<f64>,
    /// Use the record up to this time
    #[arg(long, value_name = "S")]
    pub(crate) to: Option<f64>,
    /// True for the channel that drives the machine.
    #[arg(skip)]
    pub(crate) is_drive: bool,
}

/// Quantities to which a law can be fitted, or that a response can have, by their names.
const MOTIONS: [(&str, Quantity); 3] = [
    ("velocity", Quantity::Velocity),
    ("displacement", Quantity::Displacement),
    ("acceleration", Quantity::Acceleration),
];

/// True for a quantity of a motion.
pub(crate) fn is_motion(quantity: Quantity) -> bool {
    MOTIONS.iter().any(|(_, motion)| *motion == quantity)
}

/// Quantity of a motion by its name.
pub(crate) fn motion_called(name: &str) -> Option<Quantity> {
    MOTIONS.iter().find(|(called, _)| *called == name).map(|(_, quantity)| *quantity)
}

/// Parser of the name of a motion.
pub(crate) fn motion() -> impl TypedValueParser<Value = Quantity> {
    PossibleValuesParser::new(MOTIONS.map(|(name, _)| name)).map(|name| motion_called(&name).unwrap_or_default())
}

/// A bicycle fork that swings as a pendulum, for those who have no record at hand.
pub(super) const BUNDLED: (&str, &[u8]) =
    ("BrowserForkCompoundFirst1.mat", include_bytes!("../../data/BrowserForkCompoundFirst1.mat"));

/// A sentence in the words of the options: the statement `unit` of a request or a reader is --unit here.
pub(crate) fn in_options(sentence: &str) -> String {
    let parts = sentence.split('`').enumerate();
    parts.flat_map(|(i, part)| [if i % 2 == 0 { "" } else { "--" }, part]).collect()
}

impl Choice {
    /// Quantity, unit and scale of the channel.
    fn request(&self) -> Request {
        let mut request = Request::default();
        if let Some(quantity) = self.quantity {
            request = request.quantity(quantity);
        }
        if let Some(unit) = &self.unit {
            request = request.unit(unit.clone());
        }
        if let Some(scale) = self.scale {
            request = request.scale(scale);
        }
        request
    }

    /// Reads the record of a bicycle fork that comes with the program.
    pub(crate) fn read_bundled(&self) -> Result<Input, Box<dyn Error>> {
        let (name, bytes) = BUNDLED;
        let (reading, _) = self.reading(|reader| reader.parse(bytes))?;
        // A gyro whose gain was not published.
        let label = Label::from(&reading).with_unit("V").with_quantity(Quantity::Velocity);
        self.input(Path::new(name), &label, &reading, Vec::new())
    }

    /// Reads a file of any format.
    pub(crate) fn read(&self, path: &Path, host: &Host<'_>) -> Result<Input, Box<dyn Error>> {
        if path.is_dir() {
            let what = format!("{} is a folder; `fmm batch` takes the records in one", path.display());
            return Err(Kind::Unreadable.refusal(what).into());
        }
        let (reading, file) = self.reading(|reader| host.open(reader, path))?;
        let mut warnings: Vec<String> =
            file.warnings().iter().chain(&reading.remarks).map(|remark| in_options(remark)).collect();
        warnings.extend(self.other_rate(path, &reading, host));
        self.input(path, &Label::from(&reading), &reading, warnings)
    }

    /// Warning of a file that states another sampling rate than the user.
    fn other_rate(&self, path: &Path, reading: &Reading, host: &Host<'_>) -> Option<String> {
        /// Relative difference that counts as one.
        const OTHER: f64 = 1e-3;
        let rate = self.rate?;
        let file = host.open(&self.reader(), path).ok()?;
        let stated = file.channel(reading.channel.as_str()).ok()?.record.rate();
        let is_other = (stated / rate - 1.0).abs() > OTHER;
        is_other.then(|| format!("the {rate} Hz of --rate were taken, though the file says {stated} Hz"))
    }

    /// The reader of the part that is used, without its clock.
    fn reader(&self) -> Reader {
        let reader = self.layout.reader();
        // A drive is read between its samples.
        let reader = if self.is_drive { reader } else { reader.any_spacing() };
        let reader = self.from.map_or(reader.clone(), |from| reader.from(from));
        self.to.map_or(reader.clone(), |to| reader.to(to))
    }

    /// The channel that was named, or else the one that the request tells out, and its file.
    fn reading(
        &self,
        open: impl FnOnce(&Reader) -> Result<DataFile, RecordError>,
    ) -> Result<(Reading, DataFile), Box<dyn Error>> {
        let mut reader = self.reader();
        if let Some(unit) = &self.time_unit {
            reader = reader.time_unit(unit);
        }
        if let Some(time) = &self.time {
            reader = reader.time(time.clone());
        }
        if let Some(rate) = self.rate {
            reader = reader.rate(rate);
        }
        let file = open(&reader)?;
        let reading = match &self.channel {
            Some(channel) => file.channel(channel.clone()),
            None => file.choose(&self.request()),
        };
        let reading = reading.map_err(|error| {
            let remedy = match &error {
                RecordError::TimeAxis { .. } => {
                    "here the rate is --rate, the time is --time, its unit is --time-unit, and --from and --to cut the \
                     record"
                }
                RecordError::Damaged { line: Some(_), .. } if file.format() != Format::Universal => {
                    "--repair uses the record around damaged lines, and --skip passes over lines above the table"
                }
                _ => return self.with_remedy(error),
            };
            Remedied::new(error, remedy).into()
        })?;
        Ok((reading, file))
    }

    /// The record with the quantity and the unit that follow from the file and the request.
    fn input(
        &self,
        path: &Path,
        label: &Label,
        reading: &Reading,
        warnings: Vec<String>,
    ) -> Result<Input, Box<dyn Error>> {
        let meaning = self.request().meaning(label).map_err(|error| self.with_remedy(error))?;
        if !is_motion(meaning.quantity) && !self.is_drive {
            let what = format!(
                "channel \"{}\" is a record of {}, and friction is fitted to a velocity, a displacement or an \
                 acceleration: give one of these by --channel",
                label.name(),
                meaning.quantity
            );
            return Err(Kind::Channel.refusal(what).into());
        }
        let (file, channel) = (files::name(path), label.name());
        let spacing = spacing(&reading.record);
        let origin =
            format!("{file}, channel {channel}: {meaning}; the sampling rate was {}{spacing}", reading.sampling);
        let record = reading.record.scaled(meaning.factor, meaning.unit)?.with_quantity(meaning.quantity);
        Ok(Input { record, origin, warnings })
    }

    /// The error with its remedy, in the words of the options.
    fn with_remedy(&self, error: RecordError) -> Box<dyn Error> {
        let (RecordError::Unclear { remedy, .. } | RecordError::Contradiction { remedy, .. }) = &error else {
            return error.into();
        };
        let remedy = match &error {
            _ if !self.is_drive => in_options(remedy),
            // The options speak of the motion.
            RecordError::Contradiction { .. } => "name another channel".to_owned(),
            _ => "write the unit into the name of the channel, as in \"base [m/s^2]\"".to_owned(),
        };
        Remedied::new(error, remedy).into()
    }
}

/// The end of a sentence about the rate of a record that is unequally spaced; nothing for others.
fn spacing(record: &Record) -> String {
    if record.is_equally_spaced() {
        return String::new();
    }
    let steps = record.times().zip(record.times().skip(1));
    let longest = steps.max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)));
    let (before, after) = longest.unwrap_or((record.start(), record.end()));
    let digits = |value: f64| format!("{value:.5e}").parse().map_or_else(|_| value.to_string(), Rounded::every_digit);
    let [shortest, longest, before, after] = [record.steps().0, record.steps().1, before, after].map(digits);
    format!(
        "; the times are {shortest} to {longest} s apart (the longest step from {before} to {after} s) and are fitted \
         as they are, while swings, noise and spikes are looked for at equal steps; --rate takes the samples as uniform"
    )
}
