//! A record of force and motion out of a table.

use std::error::Error;
use std::path::Path;

use clap::Args;
use fmm_identify::ForceRecord;
use fmm_record::{Column, DataFile, Label, Quantity, RecordError, WrittenUnit};

use crate::files::{self, named};
use crate::input::Layout;

/// Columns of a table by their meaning.
#[derive(Debug, Clone, Args)]
pub(crate) struct Source {
    /// The column of times (s), by name or number; found by its name unless given
    #[arg(long, value_name = "NAME|INDEX")]
    time: Option<String>,
    /// The column of positions
    #[arg(long, value_name = "NAME|INDEX")]
    position: Option<String>,
    /// The column of velocities; without it, they follow from the positions
    #[arg(long, value_name = "NAME|INDEX")]
    velocity: Option<String>,
    /// The column of forces or torques
    #[arg(long, value_name = "NAME|INDEX")]
    force: Option<String>,
    /// The column of normal loads, so that levels are coefficients
    #[arg(long, value_name = "NAME|INDEX")]
    load: Option<String>,
    /// Columns of what else was measured, of which a model with channels has a share: the actuators of a brake
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    channels: Vec<String>,
    /// Time over which hum and noise of these columns are averaged, in s
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0)]
    average: f64,
    /// Unit of position that the numbers are in, if the table does not say it; m unless given. Velocities whose unit it
    /// does not say either are in this unit per second
    #[arg(long, value_name = "UNIT")]
    position_unit: Option<WrittenUnit>,
    /// Unit of force or torque that the numbers are in, if the table does not say it; N unless given
    #[arg(long, value_name = "UNIT")]
    force_unit: Option<WrittenUnit>,
    /// Speed up to which the contact counts as at rest, in m/s or rad/s; unless given, a thousandth of the largest
    /// speed
    #[arg(long, value_name = "SPEED")]
    rest_speed: Option<f64>,
    #[command(flatten)]
    layout: Layout,
}

/// Meaning of a column.
struct Role {
    option: &'static str,
    quantity: Quantity,
    /// Required dimension in words, and its SI units.
    needed: &'static str,
    units: &'static [&'static str],
}

// Volts, amperes and counts can stand for any quantity, and friction can be given in them.
const POSITION: Role = Role {
    option: "--position",
    quantity: Quantity::Displacement,
    needed: "length or angle, such as mm or deg",
    units: &["m", "rad", "V", "A", "counts"],
};
const VELOCITY: Role = Role {
    option: "--velocity",
    quantity: Quantity::Velocity,
    needed: "velocity, such as mm/s or deg/s",
    units: &["m/s", "rad/s", "V", "A", "counts"],
};
const FORCE: Role = Role {
    option: "--force",
    quantity: Quantity::Force,
    needed: "force or torque, such as N or N m",
    units: &["N", "N m", "V", "A", "counts"],
};
const LOAD: Role = Role { option: "--load", quantity: Quantity::Force, needed: "force, such as N", units: &["N"] };

impl Role {
    /// The unit of a column: the one in its name, or else the one `said` by an option.
    fn unit(&self, label: &Label, said: Option<&WrittenUnit>) -> Result<Option<WrittenUnit>, String> {
        let (name, option) = (label.name(), self.option);
        if let (Some(written), Some(said)) = (label.unit(), said)
            && !said.is_same_as(written)
        {
            return Err(format!(
                "channel \"{name}\" is in {written}, not in {said} as {option}-unit says; leave that out"
            ));
        }
        let unit = label.unit().or(said).cloned();
        unit.map(|unit| self.accepted(&format!("channel \"{name}\" is in"), unit)).transpose()
    }

    /// A unit that can be that of such a column; `origin` says whose it is.
    fn accepted(&self, origin: &str, unit: WrittenUnit) -> Result<WrittenUnit, String> {
        if self.units.contains(&unit.si()) {
            return Ok(unit);
        }
        Err(format!("{origin} {unit}, but {} needs a unit of {}", self.option, self.needed))
    }
}

/// A column in SI units, as far as its unit is known.
struct Series {
    name: String,
    values: Vec<f64>,
    unit: Option<WrittenUnit>,
}

impl Series {
    /// The values where a unit that is not known is of this `factor`.
    fn or_by(&self, factor: f64) -> Vec<f64> {
        let factor = if self.unit.is_some() { 1.0 } else { factor };
        self.values.iter().map(|value| factor * value).collect()
    }
}

impl Source {
    /// The record in the table at `path`.
    pub(crate) fn read(&self, path: &Path) -> Result<ForceRecord, Box<dyn Error>> {
        // Numbered samples stand for the clock, so that the times are a column like any other and their steps may
        // differ.
        let reader = self.layout.reader().rate(1.0);
        let (file, head) = (files::open(&reader, path)?, files::open(&reader.to(0.0), path)?);
        self.record(&file, &head).map_err(|error| named(path)(error).into())
    }

    /// The record of a `file`, of which the first sample alone, the `head`, tells the columns: gaps further on matter
    /// where they are used.
    fn record(&self, file: &DataFile, head: &DataFile) -> Result<ForceRecord, Box<dyn Error>> {
        let mut readings = head.channels()?.into_iter().map(|channel| head.channel(channel.position));
        let is_empty = |reading: &Result<_, RecordError>| matches!(reading, Err(RecordError::Values { .. }));
        let offered = readings.find(|reading| !is_empty(reading)).ok_or("the first sample has no number")??;
        let names = offered.columns;
        let labels: Vec<Label> = names.iter().map(|name| Label::of(name)).collect();
        let column = |given: &Option<String>, meant: Option<&Role>| match (given, meant) {
            (Some(name), _) => Some(Column::from(name.as_str())),
            (None, Some(Role { quantity, .. })) => {
                let place = labels.iter().position(|label| label.quantity() == Some(*quantity))?;
                Some(Column::from(names[place].as_str()))
            }
            (None, None) => None,
        };
        let missing =
            |what: &str| format!("no column is the {what}; name it by --{what}; there are: {}", names.join(", "));
        let time = column(&self.time, None).or(offered.time.map(Column::Name)).ok_or_else(|| missing("time"))?;
        let times = file.channel(time.clone()).map_err(|error| at_its_time(&time, error, &[]))?.seconds()?;
        let series = |column: &Column, role: &Role, said| read(file, column, &times, |label| role.unit(label, said));
        let forces = column(&self.force, Some(&FORCE)).ok_or_else(|| missing("force"))?;
        let forces = series(&forces, &FORCE, self.force_unit.as_ref())?;
        let said = self.position_unit.as_ref();
        let positions = column(&self.position, Some(&POSITION));
        let positions = positions.map(|column| series(&column, &POSITION, said)).transpose()?;
        let velocities = column(&self.velocity, Some(&VELOCITY));
        let velocities = velocities.map(|column| series(&column, &VELOCITY, None)).transpose()?;
        let unit = position_unit(positions.as_ref(), velocities.as_ref(), said)?;
        let per_second = said.map_or(1.0, WrittenUnit::factor);
        let velocities = velocities.map(|velocities| velocities.or_by(per_second));
        let mut record = match (&positions, &velocities) {
            (Some(positions), _) => ForceRecord::of_positions(&times, &positions.values, &forces.values)?,
            (None, Some(velocities)) => ForceRecord::of_velocities(&times, velocities, &forces.values)?,
            (None, None) => return Err(missing("position").into()),
        };
        if let (Some(_), Some(velocities)) = (&positions, &velocities) {
            record = record.with_velocities(velocities)?;
        }
        if let Some(load) = column(&self.load, None) {
            record = record.under_loads(&series(&load, &LOAD, None)?.values)?;
        }
        for name in &self.channels {
            let channel = read(file, &Column::from(name.as_str()), &times, |label| Ok(label.unit().cloned()))?;
            record = record.with_channel(name, &channel.values, self.average)?;
        }
        if let Some(speed) = self.rest_speed {
            record = record.resting_up_to(speed)?;
        }
        Ok(record.in_units(&unit, forces.unit.as_ref().map_or("N", WrittenUnit::si)))
    }
}

/// The SI unit of the positions of a motion, in which its velocities have to be as well.
fn position_unit(
    positions: Option<&Series>,
    velocities: Option<&Series>,
    said: Option<&WrittenUnit>,
) -> Result<String, String> {
    let told = |series: &Series| series.unit.clone().map(|unit| (series.name.clone(), unit));
    let (position, velocity) = (positions.and_then(told), velocities.and_then(told));
    let base = velocity
        .as_ref()
        .map(|(_, unit)| unit.si().strip_suffix("/s").map_or_else(|| format!("{} s", unit.si()), str::to_owned));
    // An option that no column of positions takes is one for the velocities.
    let said = said.cloned().map(|unit| POSITION.accepted("--position-unit is", unit)).transpose()?;
    let position = position.map(|(_, unit)| unit).or(said);
    match (&position, &velocity, base) {
        (Some(unit), Some((name, of_velocity)), Some(base))
            if unit.si() != base || (positions.is_none() && unit.factor() != of_velocity.factor()) =>
        {
            let stated = if positions.is_none() { "--position-unit says" } else { "belongs to the positions" };
            Err(format!("channel \"{name}\" is in {of_velocity}, not in {unit} per second as {stated}"))
        }
        (Some(unit), ..) => Ok(unit.si().to_owned()),
        (None, _, base) => Ok(base.unwrap_or_else(|| "m".to_owned())),
    }
}

/// A column whose `unit` follows from its label.
fn read(
    file: &DataFile,
    column: &Column,
    times: &[f64],
    unit: impl Fn(&Label) -> Result<Option<WrittenUnit>, String>,
) -> Result<Series, Box<dyn Error>> {
    let reading = file.channel(column.clone()).map_err(|error| at_its_time(column, error, times))?;
    let label = Label::from(&reading);
    if let Some(unit) = label.unknown_unit() {
        return Err(format!("{} is in \"{unit}\", which is no unit that is known; convert it", reading.channel).into());
    }
    let unit = unit(&label)?;
    let factor = unit.as_ref().map_or(1.0, WrittenUnit::factor);
    let values = reading.record.values().iter().map(|value| factor * value).collect();
    Ok(Series { name: reading.channel, values, unit })
}

/// The error of a `column` with the time (s) of its sample, of which the file knows the number only.
fn at_its_time(column: &Column, error: RecordError, times: &[f64]) -> Box<dyn Error> {
    let RecordError::Values { index, .. } = error else { return error.into() };
    let at = times.get(index).map_or_else(String::new, |time| format!(" (at {time} s)"));
    format!("channel {column} is not finite at sample {index}{at}; cut the record there, or fill the gap").into()
}
