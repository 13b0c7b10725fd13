//! Friction of a campaign against the load, against the amplitude of the release, and against columns of numbers.

use fmm_fit::{RandomEffectsLine, UncertainPoint};
use fmm_identify::FrictionOverLoad;
use fmm_model::{Estimated, Rounded};
use serde::Serialize;

use super::row::{Row, Told, in_unit, quantities};
use super::table::probability;
use crate::figure::ends;
use crate::output::of_size;

/// Coverage probability of intervals (1).
const LEVEL: f64 = 0.95;
/// Release amplitudes that differ by less than this factor (1) say nothing of what friction does with them.
const WIDE: f64 = 1.1;
/// Below this p a dependence counts as shown (1).
const SHOWN: f64 = 0.05;
/// Pieces in which the band about a line is drawn.
const PIECES: u32 = 40;

/// Ends of an interval.
type Ends = (f64, f64);

/// The column of the normal load.
pub(super) const LOAD: &str = "normal_load";
/// Ends of the names of measures of friction, in the order of their information.
pub(crate) const FRICTION: [&str; 3] = ["mu", "friction_force", "friction_per_mass"];

/// A measure of friction against something that differs between records.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Dependence {
    pub(crate) quantity: String,
    pub(crate) unit: String,
    pub(crate) against: String,
    /// Empty for a column, whose unit is not known.
    pub(crate) against_unit: String,
    /// Records that tell both.
    pub(crate) records: usize,
    /// The judgement in a sentence, or why there is no line.
    pub(crate) statement: String,
    pub(crate) line: Option<Line>,
    /// Each record's place, value and standard uncertainty.
    #[serde(skip)]
    pub(crate) points: Vec<(f64, f64, f64)>,
}

/// intercept + slope · x, with an effect of each record beside it.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct Line {
    pub(crate) intercept: f64,
    pub(crate) intercept_u: f64,
    pub(crate) intercept_interval_95: Option<(f64, f64)>,
    pub(crate) slope: f64,
    pub(crate) slope_u: f64,
    pub(crate) slope_interval_95: Option<(f64, f64)>,
    /// Standard deviation between records beyond their uncertainties: of the slope where the line is over the load,
    /// else of the quantity.
    pub(crate) between: f64,
    /// p, probability of an intercept as far from zero if there were none, where the line is over the load; else of a
    /// slope.
    pub(crate) p: f64,
    /// Places with the value of the line and the ends of its interval, for the eye.
    #[serde(skip)]
    pub(crate) band: Vec<(f64, f64, f64, f64)>,
}

/// The number in this column of a record, whether the name is written with hyphens or underscores.
pub(super) fn number_in(row: &Row, column: &str) -> Option<f64> {
    let plain = |name: &str| name.replace('-', "_");
    let (_, cell) = row.description.iter().find(|(name, _)| plain(name) == plain(column))?;
    cell.parse().ok().filter(|number: &f64| number.is_finite())
}

/// True for a record under a load (N) between these ends.
pub(super) fn is_under(row: &Row, (low, high): (f64, f64)) -> bool {
    number_in(row, LOAD).is_some_and(|load| (low..=high).contains(&load))
}

/// The normal load (N) of a record.
pub(super) fn load_of(row: &Row) -> Option<Estimated> {
    Some(Estimated::new(number_in(row, LOAD)?, number_in(row, "normal_load_u").unwrap_or(0.0)))
}

/// All dependences that the records can show, and those on `columns`.
pub(super) fn dependences(rows: &[&Row], columns: &[String]) -> Vec<Dependence> {
    let load = force_over_load(rows);
    let amplitude = over_amplitude(rows);
    let columns = columns.iter().map(|column| {
        let place = |row: &Row| number_in(row, column);
        let unit = if column.replace('-', "_") == LOAD { "N" } else { "" };
        Dependence::by_line(rows, column, unit, place).unwrap_or_else(|| {
            let why = format!("{}: no record tells friction with an uncertainty", words(column));
            Dependence::new(("", ""), (column, ""), why, None, Vec::new())
        })
    });
    load.into_iter().chain(amplitude).chain(columns).collect()
}

/// The first quantity of `rows` whose name ends so.
fn quantity<'a>(rows: &[&'a Row], ending: &str) -> Option<(&'a str, &'a str)> {
    quantities(rows).into_iter().find(|(name, _)| name.ends_with(ending))
}

/// Value and standard uncertainty, if it has one.
fn estimated(told: &Told) -> Option<Estimated> {
    Some(Estimated::new(told.value, told.u.filter(|u| *u > 0.0)?))
}

/// Friction force of the law against the load, where records state different ones.
fn force_over_load(rows: &[&Row]) -> Option<Dependence> {
    let quantity = quantity(rows, "friction_force")?;
    let run = |row: &&Row| Some((load_of(row)?, estimated(row.told(quantity)?)?));
    over_load(quantity, &rows.iter().filter_map(run).collect::<Vec<_>>())
}

/// Friction force of runs, each with its load, against the load; `None` where it does not differ.
pub(super) fn over_load(quantity: (&str, &str), runs: &[(Estimated, Estimated)]) -> Option<Dependence> {
    let (first, _) = runs.first()?;
    if runs.iter().all(|(load, _)| load.value == first.value) {
        return None;
    }
    let found = FrictionOverLoad::of(runs);
    let line = found.as_ref().ok().map(|found| {
        let (intercept, slope) = (found.intercept(), found.coefficient());
        let at = |load: f64| {
            let ends = if load == 0.0 { found.intercept_interval(LEVEL) } else { found.force_interval(load, LEVEL) };
            (found.force(load), ends)
        };
        Line {
            intercept: intercept.value,
            intercept_u: intercept.uncertainty,
            intercept_interval_95: found.intercept_interval(LEVEL),
            slope: slope.value,
            slope_u: slope.uncertainty,
            slope_interval_95: found.coefficient_interval(LEVEL),
            between: found.between(),
            p: found.intercept_p_value(),
            band: band((0.0, found.loads().1), at),
        }
    });
    let statement = match &found {
        Ok(found) => found.to_string(),
        Err(error) => format!("{} against normal load: {error}", words(quantity.0)),
    };
    let points = runs.iter().map(|(load, force)| (load.value, force.value, force.uncertainty)).collect();
    Some(Dependence::new(quantity, (LOAD, "N"), statement, line, points))
}

/// A name as words.
fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// Places between two ends, with the value and the interval there.
fn band((low, high): (f64, f64), at: impl Fn(f64) -> (f64, Option<Ends>)) -> Vec<(f64, f64, f64, f64)> {
    let place = |piece: u32| {
        let x = low + (high - low) * f64::from(piece) / f64::from(PIECES);
        let (value, interval) = at(x);
        let (below, above) = interval.unwrap_or((value, value));
        (x, value, below, above)
    };
    (0..=PIECES).map(place).collect()
}

/// Friction against the amplitude of the release, where amplitudes of one unit differ by enough.
fn over_amplitude(rows: &[&Row]) -> Option<Dependence> {
    let found = || rows.iter().filter_map(|row| row.found());
    let unit = &found().next()?.unit;
    let (low, high) = ends(found().map(|found| found.amplitude));
    if high < WIDE * low || found().any(|found| found.unit != *unit) {
        return None;
    }
    Dependence::by_line(rows, "amplitude", unit, |row| Some(row.found()?.amplitude))
        .filter(|found| found.line.is_some())
}

impl Dependence {
    fn new(
        (quantity, unit): (&str, &str),
        (against, against_unit): (&str, &str),
        statement: String,
        line: Option<Line>,
        points: Vec<(f64, f64, f64)>,
    ) -> Self {
        let [quantity, unit, against, against_unit] = [quantity, unit, against, against_unit].map(str::to_owned);
        Self { quantity, unit, against, against_unit, records: points.len(), statement, line, points }
    }

    /// The measure of friction that tells most against what is at a `place` in each record.
    fn by_line(rows: &[&Row], against: &str, against_unit: &str, place: impl Fn(&Row) -> Option<f64>) -> Option<Self> {
        let (name, unit) = FRICTION.iter().find_map(|ending| quantity(rows, ending))?;
        let point = |row: &&Row| {
            let friction = estimated(row.told((name, unit))?)?;
            Some((place(row)?, friction.value, friction.uncertainty))
        };
        let points: Vec<(f64, f64, f64)> = rows.iter().filter_map(point).collect();
        let found = if points.iter().all(|point| point.0 == points[0].0) {
            Err(format!("fewer than two different values of it stand beside a {}", words(name)))
        } else {
            let points: Vec<UncertainPoint> =
                points.iter().map(|(x, y, u)| UncertainPoint::new(*x, *y, 0.0, *u)).collect();
            RandomEffectsLine::fit(&points).map_err(|error| error.to_string())
        };
        let (low, high) = ends(points.iter().map(|point| point.0));
        let (friction, place) = (words(name), words(against));
        let (line, statement) = match found {
            Ok(found) => {
                let line = Line::of(&found, low, high);
                let axis = if against_unit.is_empty() { String::new() } else { format!(" {against_unit}") };
                let per = if axis.is_empty() { format!(" unit of {place}") } else { axis.clone() };
                let verb = if line.p < SHOWN { "depends on" } else { "does not show to depend on" };
                let [slope, low, high] = [(line.slope, Some(line.slope_u)), (low, None), (high, None)]
                    .map(|(value, u)| Rounded::new(value, u).to_string());
                let statement = format!(
                    "{friction} {verb} {place} between {low} and {high}{axis}: it changes by {} per{per} (p {}), from \
                     {} records that scatter about the line by {} beyond their uncertainties",
                    in_unit(slope, unit),
                    probability(line.p),
                    points.len(),
                    in_unit(of_size(line.between), unit),
                );
                (Some(line), statement)
            }
            Err(why) => (None, format!("{friction} against {place}: {why}")),
        };
        Some(Self::new((name, unit), (against, against_unit), statement, line, points))
    }
}

impl Line {
    /// Drawn between these places.
    fn of(found: &RandomEffectsLine, low: f64, high: f64) -> Self {
        Self {
            intercept: found.intercept(),
            intercept_u: found.intercept_uncertainty(),
            intercept_interval_95: found.intercept_interval(LEVEL),
            slope: found.slope(),
            slope_u: found.slope_uncertainty(),
            slope_interval_95: found.slope_interval(LEVEL),
            between: found.between(),
            p: found.slope_p_value(),
            band: band((low, high), |x| (found.value(x), found.value_interval(x, LEVEL))),
        }
    }
}
