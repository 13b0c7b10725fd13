//! A record of force and motion out of a table.

use std::error::Error;
use std::path::Path;

use clap::Args;
use fmm_identify::ForceRecord;
use fmm_record::{Column, DataFile, Label, Reader, RecordError, WrittenUnit};

use crate::force::columns::{Columns, FORCE, LOAD, POSITION, Role, VELOCITY};
use crate::force::series::Series;
use crate::host::Host;
use crate::input::Layout;
use crate::refusal::{Kind, placed};

/// Columns of a table by their meaning.
#[derive(Debug, Clone, Args)]
pub(crate) struct Source {
    /// The column of times (s), by name or number; found by its name unless given
    #[arg(long, value_name = "NAME|INDEX")]
    time: Option<String>,
    /// Unit of the times, such as ms, if the name of their column does not tell it; s unless given
    #[arg(long, value_name = "UNIT", conflicts_with = "rate")]
    time_unit: Option<String>,
    /// The sampling rate, if there is no column of times
    #[arg(long, value_name = "HZ", conflicts_with = "time")]
    rate: Option<f64>,
    /// Use the record from this time on
    #[arg(long, value_name = "S")]
    from: Option<f64>,
    /// Use the record up to this time
    #[arg(long, value_name = "S")]
    to: Option<f64>,
    /// The column of positions
    #[arg(long, value_name = "NAME|INDEX")]
    position: Option<String>,
    /// The column of velocities; without it, they follow from the positions
    #[arg(long, value_name = "NAME|INDEX")]
    velocity: Option<String>,
    /// The column of forces or torques
    #[arg(long, value_name = "NAME|INDEX")]
    force: Option<String>,
    /// Turn the sign of the force: it was measured as the reaction of the contact
    #[arg(long)]
    turn_sign: bool,
    /// The column of normal loads, so that levels are coefficients
    #[arg(long, value_name = "NAME|INDEX")]
    load: Option<String>,
    /// Reading of that column without a load, in its unit, to be taken off
    #[arg(long, value_name = "LOAD", default_value_t = 0.0, requires = "load", allow_negative_numbers = true)]
    tare: f64,
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

/// A record, and the columns of its file that it is of.
pub(crate) struct Table {
    pub(crate) record: ForceRecord,
    pub(crate) columns: Columns,
}

/// The part of a table that is used, with its times (s); none for steady states.
struct Part {
    file: DataFile,
    times: Vec<f64>,
    /// Times of all samples of the file, by which errors are named.
    all: Vec<f64>,
}

impl Source {
    /// The record in the table at `path`.
    pub(crate) fn read(&self, path: &Path, host: &Host<'_>) -> Result<Table, Box<dyn Error>> {
        self.table(path, host).map_err(|error| placed(path.display())(error).into())
    }

    /// The record in the table at `path`. The first sample alone tells the columns: gaps further on matter where they
    /// are used.
    fn table(&self, path: &Path, host: &Host<'_>) -> Result<Table, Box<dyn Error>> {
        // Numbered samples stand for the clock, so that the times are a column like any other and their steps may
        // differ.
        let reader = self.layout.reader().rate(1.0);
        let head = host.open(&reader.clone().to(0.0), path)?;
        let mut readings = head.channels()?.into_iter().map(|channel| head.channel(channel.position));
        let is_empty = |reading: &Result<_, RecordError>| matches!(reading, Err(RecordError::Values { .. }));
        let offered = readings.find(|reading| !is_empty(reading)).ok_or("the first sample has no number")??;
        let names = offered.columns;
        let labels: Vec<Label> = names.iter().map(|name| Label::of(name)).collect();
        let missing =
            |what: &str| format!("no column is the {what}; name it by --{what}; there are: {}", names.join(", "));
        let no_column = |what: String| Kind::Channel.refusal(what);
        let mut columns = Columns::default();
        let remarks = &mut columns.remarks;
        let force = FORCE.column(self.force.as_ref(), &labels, remarks)?.ok_or_else(|| no_column(missing("force")))?;
        let position = POSITION.column(self.position.as_ref(), &labels, remarks)?;
        let velocity = VELOCITY.column(self.velocity.as_ref(), &labels, remarks)?;
        if position.is_none() && velocity.is_none() {
            return Err(no_column(format!(
                "no column is a position or a velocity, along which friction acts; name one by --position or \
                 --velocity; there are: {}",
                names.join(", ")
            ))
            .into());
        }
        let time = self.time.as_deref().map(Column::from).or(offered.time.map(Column::Name));
        let time = time.filter(|_| self.rate.is_none());
        let is_timeless = time.is_none() && self.rate.is_none();
        if is_timeless && (position.is_some() || self.from.is_some() || self.to.is_some()) {
            return Err(no_column(format!("{}; or say the sampling rate by --rate", missing("time"))).into());
        }
        if is_timeless {
            remarks.push(
                "no column is the time, so that the rows are taken for steady states; give --time or --rate if they \
                 are not"
                    .to_owned(),
            );
        }
        let Part { file, times, all } = self.part(&reader, path, time.as_ref(), &force, host)?;
        let series = |column: &Column, role: &Role, said| read(&file, column, &all, |label| role.unit(label, said));
        let forces = series(&force, &FORCE, self.force_unit.as_ref())?;
        let said = self.position_unit.as_ref();
        let positions = position.map(|column| series(&column, &POSITION, said)).transpose()?;
        let positions = positions.map(|positions| positions.going_on(&times, &mut columns.remarks));
        let velocities = velocity.map(|column| series(&column, &VELOCITY, None)).transpose()?;
        let unit = position_unit(positions.as_ref(), velocities.as_ref(), said)?;
        let per_second = said.map_or(1.0, WrittenUnit::factor);
        let speeds = velocities.as_ref().map(|velocities| velocities.or_by(per_second));
        let mut record = match (&positions, &speeds) {
            (Some(positions), _) => ForceRecord::of_positions(&times, &positions.values, &forces.values)?,
            (None, Some(speeds)) if is_timeless => ForceRecord::of_speeds(speeds, &forces.values)?,
            (None, Some(speeds)) => ForceRecord::of_velocities(&times, speeds, &forces.values)?,
            (None, None) => return Err(missing("position").into()),
        };
        if let (Some(_), Some(speeds)) = (&positions, &speeds) {
            record = record.with_velocities(speeds)?;
        }
        if self.turn_sign {
            record = record.with_turned_sign();
        }
        let name = |column: &Column| Some(file.channel(column.clone()).ok()?.channel);
        columns.time = time.as_ref().and_then(name);
        let said_of =
            |series: &Option<Series>| series.as_ref().map(|series| (series.name.clone(), series.unit.is_some()));
        columns.note_units([
            columns
                .time
                .clone()
                .map(|time| (states_unit(&time) || self.time_unit.is_some(), time, "s".to_owned(), "--time-unit")),
            said_of(&positions).map(|(name, said)| (said, name, unit.clone(), "--position-unit")),
            said_of(&velocities).map(|(name, said)| (said, name, format!("{unit}/s"), "--position-unit")),
            Some((forces.unit.is_some(), forces.name.clone(), "N".to_owned(), "--force-unit")),
        ]);
        for series in positions.iter().chain(&velocities).chain([&forces]) {
            columns.remarks.extend(series.doubts(&times));
        }
        columns.position = positions.map(|series| series.name);
        columns.velocity = velocities.map(|series| series.name);
        if let Some(load) = &self.load {
            let load = series(&Column::from(load.as_str()), &LOAD, None)?;
            let load = load.pressing(self.tare, &mut columns.remarks);
            let negative = |error| {
                format!(
                    "{error}; take the reading without a load off by --tare, or leave its samples out by --from and \
                     --to"
                )
            };
            record = record.under_loads(&load.values).map_err(negative)?;
            columns.load = Some(load.name);
        }
        for name in &self.channels {
            let channel = read(&file, &Column::from(name.as_str()), &all, |label| Ok(label.unit().cloned()))?;
            record = record.with_channel(name, &channel.values, self.average)?;
            columns.channels.push(channel.name);
        }
        if let Some(speed) = self.rest_speed {
            record = record.resting_up_to(speed)?;
        }
        record = record.in_units(&unit, forces.unit.as_ref().map_or("N", WrittenUnit::si));
        columns.force = Some(forces.name);
        columns.leave(&labels);
        Ok(Table { record, columns })
    }

    /// The samples from --from to --to, by the column of `time` or by --rate.
    fn part(
        &self,
        reader: &Reader,
        path: &Path,
        time: Option<&Column>,
        force: &Column,
        host: &Host<'_>,
    ) -> Result<Part, Box<dyn Error>> {
        let file = host.open(reader, path)?;
        let times = match (time, self.rate) {
            (Some(time), _) => {
                let mut read = file.channel(time.clone()).map_err(|error| at_its_time(time, error, &[]))?;
                if let Some(unit) = &self.time_unit {
                    if states_unit(&read.channel) {
                        return Err(
                            format!("the name \"{}\" tells the unit; leave --time-unit out", read.channel).into()
                        );
                    }
                    read.channel = format!("time [{unit}]");
                }
                read.seconds()?
            }
            (None, Some(rate)) => {
                if !(rate > 0.0 && rate.is_finite()) {
                    return Err(Kind::Option.refusal(format!("--rate {rate}: give a positive number of Hz")).into());
                }
                // A gap leaves the number of samples as it is.
                let count =
                    file.channels()?.iter().find_map(|channel| Some(file.channel(channel.position).ok()?.record.len()));
                let count = count.ok_or_else(|| format!("channel {force} has no sample"))?;
                (0..count).map(|number| number as f64 / rate).collect()
            }
            (None, None) => Vec::new(),
        };
        if self.from.is_none() && self.to.is_none() {
            return Ok(Part { file, all: times.clone(), times });
        }
        let (from, to) = (self.from.unwrap_or(f64::NEG_INFINITY), self.to.unwrap_or(f64::INFINITY));
        let (first, end) = (times.partition_point(|time| *time < from), times.partition_point(|time| *time <= to));
        if first >= end {
            let [begin, last] = [times.first(), times.last()].map(|time| time.copied().unwrap_or(0.0));
            return Err(
                format!("no sample lies between --from and --to; the record goes from {begin} s to {last} s").into()
            );
        }
        let reader = reader.clone().from(first as f64).to((end - 1) as f64);
        Ok(Part { file: host.open(&reader, path)?, times: times[first..end].to_vec(), all: times })
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

/// True if the name of a column of times has a unit behind it.
fn states_unit(name: &str) -> bool {
    name.contains(['[', '(', '/', '_'])
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
        let what = format!("{} is in \"{unit}\", which is no unit that is known; convert it", reading.channel);
        return Err(Kind::Unclear.refusal(what).into());
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
