//! A record of force and motion out of a table.

use std::error::Error;
use std::path::Path;

use clap::Args;
use fmm_identify::ForceRecord;
use fmm_record::{Column, DataFile, Label, Quantity, Reader};

/// Which columns of a table are what.
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
    /// Unit of position that the numbers are in, if the table does not say it
    #[arg(long, value_name = "UNIT", default_value = "m")]
    position_unit: String,
    /// Unit of force that the numbers are in, if the table does not say it
    #[arg(long, value_name = "UNIT", default_value = "N")]
    force_unit: String,
    /// Speed up to which the contact counts as at rest; unless given, a thousandth of the largest speed
    #[arg(long, value_name = "SPEED")]
    rest_speed: Option<f64>,
}

/// A column in SI units, as far as its unit is known.
struct Series {
    values: Vec<f64>,
    unit: Option<&'static str>,
}

impl Source {
    /// The record in the table at `path`.
    pub(crate) fn read(&self, path: &Path) -> Result<ForceRecord, Box<dyn Error>> {
        // Numbered samples stand for the clock, so that the times are a column like any other and their steps may differ.
        let file = Reader::default().rate(1.0).open(path)?;
        let first = file.channels()?.first().map_or(0, |channel| channel.position);
        let offered = file.channel(first)?;
        let names = offered.columns;
        let labels: Vec<Label> = names.iter().map(|name| Label::of(name)).collect();
        let column = |given: &Option<String>, meant: &dyn Fn(&Label) -> bool| match given {
            Some(name) => Some(Column::from(name.as_str())),
            None => labels.iter().position(meant).map(|place| Column::from(names[place].as_str())),
        };
        let of = |quantity: Quantity| move |label: &Label| label.quantity() == Some(quantity);
        let all = || names.join(", ");
        let missing = |what: &str| {
            format!("{}: no column is the {what}; name it by --{what}; there are: {}", path.display(), all())
        };
        let time = column(&self.time, &|_| false).or(offered.time.map(Column::Name)).ok_or_else(|| missing("time"))?;
        let times = file.channel(time)?.seconds()?;
        let forces = column(&self.force, &of(Quantity::Force)).ok_or_else(|| missing("force"))?;
        let forces = series(&file, forces)?;
        let positions =
            column(&self.position, &of(Quantity::Displacement)).map(|column| series(&file, column)).transpose()?;
        let velocities =
            column(&self.velocity, &of(Quantity::Velocity)).map(|column| series(&file, column)).transpose()?;
        let unit = positions.as_ref().and_then(|positions| positions.unit);
        let base = velocities.as_ref().and_then(|velocities| velocities.unit?.strip_suffix("/s"));
        let mut record = match (&positions, &velocities) {
            (Some(positions), _) => ForceRecord::of_positions(&times, &positions.values, &forces.values)?,
            (None, Some(velocities)) => ForceRecord::of_velocities(&times, &velocities.values, &forces.values)?,
            (None, None) => return Err(missing("position").into()),
        };
        if let (Some(_), Some(velocities)) = (&positions, &velocities) {
            record = record.with_velocities(&velocities.values)?;
        }
        if let Some(load) = column(&self.load, &|_| false) {
            record = record.under_loads(&series(&file, load)?.values)?;
        }
        for name in &self.channels {
            record = record.with_channel(name, &series(&file, Column::from(name.as_str()))?.values, self.average)?;
        }
        if let Some(speed) = self.rest_speed {
            record = record.resting_up_to(speed)?;
        }
        Ok(record.in_units(unit.or(base).unwrap_or(&self.position_unit), forces.unit.unwrap_or(&self.force_unit)))
    }
}

fn series(file: &DataFile, column: Column) -> Result<Series, Box<dyn Error>> {
    let reading = file.channel(column)?;
    let label = Label::from(&reading);
    if let Some(unit) = label.unknown_unit() {
        return Err(format!("{} is in \"{unit}\", which is no unit that is known; convert it", reading.channel).into());
    }
    let (factor, unit) = label.unit().map_or((1.0, None), |unit| (unit.factor(), Some(unit.si())));
    Ok(Series { values: reading.record.values().iter().map(|value| factor * value).collect(), unit })
}
