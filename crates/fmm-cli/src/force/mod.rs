//! Friction out of a measured force along a measured motion: `fmm force FILES...`.
//!
//! Reads time, position or velocity, and force (or torque) of a joint, a tribometer or a damper, at equal or unequal
//! steps; fits each model and gives out what was found. `--validate` tells how well a model predicts a record to which
//! it was not fitted.

mod columns;
mod document;
mod series;
mod source;

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use crate::answer::{Answer, Detail, Document, FittedRecord};
use crate::figure::{Panel, Role, drawn, ends, label};
use crate::files::named;
use crate::host::Host;
use crate::input::{Held, limit};
use crate::output::{Output, of_size};
use crate::refusal::Kind;
use clap::Args;
use columns::Columns;
pub(crate) use document::Content;
use fmm_fit::Minimizer;
use fmm_identify::{
    Candidate, Comparison, ForceLoop, ForceRecord, Identification, IdentifyError, Inquiry, Machine, Onset, SpeedBin,
    Validation, Warning,
};
use fmm_model::Rounded;
use source::{Source, Table};

/// Fits friction to a measured force along a measured motion.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Records that are fitted together: tables with time, position or velocity, and force
    #[arg(required = true)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    source: Source,
    /// Models to fit, separated by commas: a law, then after plus signs damping (linear, quadratic, cubic, any sign)
    /// and what else acts or is measured (zero, inertia, stiffness, gravity, asymmetry, load offset, channels, delay);
    /// unless given, coulomb and dahl, each with linear and asymmetry; along a motion that goes one way coulomb with
    /// linear, and with quadratic as well; for steady states coulomb and berger
    #[arg(long, value_delimiter = ',')]
    model: Vec<String>,
    /// Hold a parameter at a value, in the unit in which it is fitted, as in exponent=2; of one law alone as in
    /// stribeck.exponent=2
    #[arg(long, value_name = "[LAW.]NAME=VALUE")]
    hold: Vec<Held>,
    /// The longest delay between motion and force that is looked for, in s; twenty samples unless given
    #[arg(long, value_name = "SECONDS")]
    longest_delay: Option<f64>,
    /// Records to which nothing is fitted, but whose forces are predicted; the model that predicts them best is
    /// preferred
    #[arg(long, value_name = "FILE")]
    validate: Vec<PathBuf>,
    /// Stop the fits after this time, an equal share for each model, and give the best so far, in s
    #[arg(long, value_name = "SECONDS")]
    time_limit: Option<f64>,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// Models that are fitted unless others are given.
const MODELS: [&str; 2] = ["coulomb + linear + asymmetry", "dahl + linear + asymmetry"];
/// The same along motions that go one way, which show no levels that differ by direction and little presliding.
const MODELS_ONE_WAY: [&str; 2] = ["coulomb + linear", "coulomb + linear + quadratic"];
/// The same for steady states, which show no presliding, of both directions or of one.
const MODELS_STEADY: [&str; 2] = ["coulomb + linear + asymmetry", "berger + linear + asymmetry"];
const MODELS_STEADY_ONE_WAY: [&str; 2] = ["coulomb + linear", "berger + linear"];

/// Models for these records, if none is given.
fn models_for(records: &[ForceRecord]) -> [&'static str; 2] {
    let is_steady = records.iter().any(ForceRecord::is_timeless);
    match (is_steady, records.iter().all(ForceRecord::goes_one_way)) {
        (true, true) => MODELS_STEADY_ONE_WAY,
        (true, false) => MODELS_STEADY,
        (false, true) => MODELS_ONE_WAY,
        (false, false) => MODELS,
    }
}

/// A record that was read from a file.
struct Read {
    file: PathBuf,
    record: ForceRecord,
    columns: Columns,
}

/// Records, and the models that were fitted to them.
pub(crate) struct Found {
    fitted: Vec<Read>,
    /// Records to which nothing was fitted.
    others: Vec<Read>,
    compared: Comparison,
    /// Sentences about columns and motions, with their files.
    remarks: Vec<String>,
}

pub(crate) fn force(arguments: &Arguments, host: &Host<'_>) -> Result<Found, Box<dyn Error>> {
    let read = |file: &PathBuf| -> Result<Read, Box<dyn Error>> {
        let Table { record, columns } = arguments.source.read(file, host)?;
        Ok(Read { file: file.clone(), record, columns })
    };
    let read = |files: &[PathBuf]| files.iter().map(read).collect::<Result<Vec<Read>, _>>();
    let (fitted, others) = (read(&arguments.files)?, read(&arguments.validate)?);
    let records = |read: &[Read]| read.iter().map(|read| read.record.clone()).collect::<Vec<_>>();
    let (records, records_of_others) = (records(&fitted), records(&others));
    let described = described(arguments, &records, host)?;
    let compared = compared(arguments, &records, &records_of_others, &described, host)?;
    let of_columns = fitted.iter().chain(&others).flat_map(|read| read.columns.remarks.iter().map(named(&read.file)));
    let driven = others.iter().filter_map(|read| {
        let (friction, unit) = (read.record.driving_friction()?, read.record.force_unit().to_owned());
        Some(named(&read.file)(Warning::DrivesMotion { friction, unit }))
    });
    let remarks = of_columns.chain(driven).collect();
    Ok(Found { fitted, others, compared, remarks })
}

impl Found {
    fn all(&self) -> impl Iterator<Item = &Read> {
        self.fitted.iter().chain(&self.others)
    }

    /// The models with how they predict the records to which they were not fitted.
    fn models(&self) -> impl Iterator<Item = (&Identification, &[Validation])> {
        let validations = self.compared.validations();
        let of_model = move |(number, found)| (found, validations.get(number).map_or(&[][..], Vec::as_slice));
        self.compared.identifications().iter().enumerate().map(of_model)
    }
}

impl Answer for Found {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        let mut out = String::new();
        for Read { file, columns, .. } in &self.others {
            writeln!(out, "{}, not fitted: {columns}", file.display())?;
        }
        for Read { file, record, columns } in &self.fitted {
            let unit = record.force_unit();
            writeln!(out, "{}: {} samples, forces in {unit}", file.display(), record.len())?;
            writeln!(out, "  columns: {columns}")?;
            for line in without_a_law(record) {
                writeln!(out, "  {line}")?;
            }
        }
        for remark in &self.remarks {
            writeln!(out, "note: {remark}")?;
        }
        for (found, validations) in self.models() {
            writeln!(out, "\n{found}")?;
            for (Read { file, record, .. }, said) in self.others.iter().zip(validations) {
                let (rms, unit) = (said.rms, record.force_unit());
                let share =
                    said.share().map_or_else(String::new, |share| format!(", {:.1} % of the force", 100.0 * share));
                writeln!(out, "  not fitted: {}: rms {rms:.4e} {unit}{share}", file.display())?;
                if let Some(warning) = said.warning(found.law()) {
                    writeln!(out, "  - {warning}")?;
                }
            }
        }
        if self.compared.identifications().len() > 1 {
            writeln!(out, "\n{}", self.compared)?;
        }
        Ok(out.trim_end().to_owned())
    }

    fn document(&self, detail: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("force-1", Content::of(self, detail)?).pretty()
    }

    fn fits(&self) -> Result<Vec<FittedRecord>, Box<dyn Error>> {
        let fit = |Read { record, .. }: &Read| {
            let fitted = self.compared.preferred().predict(record)?;
            Ok(FittedRecord {
                unit: record.force_unit().to_owned(),
                time: record.times().to_vec(),
                measured: record.forces().to_vec(),
                fitted: fitted.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect(),
            })
        };
        self.fitted.iter().map(fit).collect()
    }

    fn pictures(&self) -> Result<Vec<(String, String)>, Box<dyn Error>> {
        let picture = |(found, number): (&Identification, usize)| {
            Ok((format!("force_{number}.svg"), drawn(&panels(&self.fitted[0].record, found)?)))
        };
        self.compared.identifications().iter().zip(1..).map(picture).collect()
    }
}

/// The models that the arguments describe.
fn described(
    arguments: &Arguments,
    records: &[ForceRecord],
    host: &Host<'_>,
) -> Result<Vec<Candidate>, Box<dyn Error>> {
    let mut models: Vec<&str> = arguments.model.iter().map(String::as_str).collect();
    if models.is_empty() {
        models.extend(models_for(records));
    }
    let law_of = |model: &str| model.split(['+', ',']).next().unwrap_or_default().trim().to_owned();
    let stray = |held: &&Held| held.law.as_ref().is_some_and(|law| models.iter().all(|model| law_of(model) != *law));
    if let Some(Held { law: Some(law), name, .. }) = arguments.hold.iter().find(stray) {
        return Err(Kind::Name.refusal(format!("--hold {law}.{name}: {law} is the law of no model")).into());
    }
    let mut described = Vec::with_capacity(models.len());
    for name in &models {
        let mut model = host.candidate(name)?;
        let is_meant = |held: &&Held| held.law.as_ref().is_none_or(|law| law_of(name) == *law);
        for held in arguments.hold.iter().filter(is_meant) {
            model = model.holding(&held.name, held.value)?;
        }
        if let Some(longest) = arguments.longest_delay {
            model = model.with_delay_up_to(longest)?;
        }
        described.push(model);
    }
    Ok(described)
}

/// The comparison of the `models` by their fits to `records` and their predictions of `others`.
fn compared(
    arguments: &Arguments,
    records: &[ForceRecord],
    others: &[ForceRecord],
    models: &[Candidate],
    host: &Host<'_>,
) -> Result<Comparison, Box<dyn Error>> {
    let machine = Machine::per_unit_mass();
    let limit = arguments.time_limit.map(limit).transpose()?;
    let found = host.while_working(|tell| {
        let show = |law: &str, progress: &Minimizer| tell(format!("{law}: step {}", progress.iterations()));
        let inquiry = Inquiry::of(&machine, records).validated_by(others).observed_by(show);
        match limit {
            Some(limit) => inquiry.within(limit).among(models),
            None => inquiry.among(models),
        }
    })?;
    found.map_err(|error| match error {
        IdentifyError::NotPredicted { record, source } => named(&arguments.validate[record - 1])(source).into(),
        error => error.into(),
    })
}

/// Loops and onsets in lines of text.
fn without_a_law(record: &ForceRecord) -> Vec<String> {
    let (force, position) = (record.force_unit(), record.position_unit());
    let mut lines = Vec::new();
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let bins = record.friction_over_speed(BINS);
    if let (Some(slowest), Some(fastest)) = (bins.first(), bins.last()) {
        let at = |bin: &SpeedBin| {
            let friction = Rounded::new(bin.friction.value, Some(bin.friction.uncertainty));
            let speed = of_size(bin.speed);
            format!("{friction} {force} at {speed} {position}/s")
        };
        lines.push(format!("friction over speed, no law assumed: {}, {}", at(slowest), at(fastest)));
    }
    let loops = record.loops();
    let of_loops = |value: fn(&ForceLoop) -> f64| median(loops.iter().map(value).collect());
    if let (Some(energy), Some(friction)) = (of_loops(|a| a.energy.value), of_loops(|a| a.friction.value)) {
        let count = loops.len();
        lines.push(format!(
            "loops: {count}, in the median {energy:.4e} {force} {position} each, {friction:.4e} {force} in the mean of \
             the way"
        ));
    }
    let onsets = record.onsets();
    let of_onsets = |value: fn(&Onset) -> f64| median(onsets.iter().map(value).collect());
    if let (Some(stiffness), Some(breakaway)) = (of_onsets(|a| a.stiffness.value), of_onsets(|a| a.breakaway.value)) {
        let count = onsets.len();
        lines.push(format!(
            "onsets of sliding: {count}, in the median {stiffness:.4e} {force}/{position} of presliding stiffness, \
             breakaway at {breakaway:.4e} {force}"
        ));
    }
    lines
}

/// Bins of the friction over the speed.
const BINS: usize = 24;
/// Groups of the normal load, where it was measured.
const LOADS: usize = 3;

/// Force over position and over velocity with the fit in, friction over the speed without a law, and what is left over
/// time and over the phase of the motion.
fn panels(record: &ForceRecord, found: &Identification) -> Result<Vec<Panel>, Box<dyn Error>> {
    let said = found.predict(record)?;
    let velocity = format!("{}/s", record.position_unit());
    let against = |abscissae: &[f64], name: &str, unit: &str| {
        let measured = abscissae.iter().copied().zip(record.forces().iter().copied());
        let fitted = abscissae.iter().zip(&said).filter_map(|(x, said)| Some((*x, (*said)?)));
        Panel::new(label(name, unit), label("force", record.force_unit()), 420.0)
            .with(Role::Measured, "measured", measured)
            .with(Role::Fitted, found.law(), fitted)
    };
    let bins = record.friction_over_speed_and_load(BINS, LOADS);
    let (speed, friction, bins): (_, _, Vec<_>) = if bins.iter().any(|bin| bin.coefficient().is_some()) {
        let point = |bin: &SpeedBin| Some((bin.speed_by_load()?, bin.coefficient()?));
        (format!("{velocity}/N"), label("friction by load", "1"), bins.iter().filter_map(point).collect())
    } else {
        let points = bins.iter().map(|bin| (bin.speed, bin.friction)).collect();
        (velocity.clone(), label("friction", record.force_unit()), points)
    };
    let of_speed = if speed == velocity { "speed" } else { "speed by load" };
    let what = if record.goes_one_way() { "medians" } else { "half the difference of the directions, medians" };
    let bars: Vec<_> = bins.iter().map(|(speed, friction)| (*speed, friction.value, friction.uncertainty)).collect();
    let medians = Panel::new(label(of_speed, &speed), friction, 260.0).with_bars(what, &bars);
    let residuals: Vec<Option<f64>> =
        record.forces().iter().zip(&said).map(|(force, said)| Some((*said)? - force)).collect();
    let left = |abscissae: &[f64]| -> Vec<(f64, f64)> {
        abscissae.iter().zip(&residuals).filter_map(|(at, left)| Some((*at, (*left)?))).collect()
    };
    let text = format!("fit − measured, {:.3e} {} rms", found.rms_residual(), record.force_unit());
    let along = against(record.velocities(), "velocity", &velocity);
    let of_time = !record.is_timeless();
    let motion = of_time.then(|| against(record.positions(), "position", record.position_unit()));
    let panels = vec![
        medians,
        Panel::new("time / s", label("residual", record.force_unit()), 260.0).with(
            Role::Residual,
            text,
            left(record.times()),
        ),
        Panel::new("phase of the motion / °", label("residual", record.force_unit()), 260.0).with(
            Role::ResidualPoints,
            "0° at the greatest velocity, 90° at the greatest position",
            left(&phases(record)),
        ),
    ];
    // Steady states have neither times nor phases.
    let shown = if of_time { panels.len() } else { 1 };
    Ok(motion.into_iter().chain([along]).chain(panels.into_iter().take(shown)).collect())
}

/// The phase of the motion at each sample (°), from 0 to 360: the angle of velocity and position, each as a share of
/// its half range.
fn phases(record: &ForceRecord) -> Vec<f64> {
    let (low, high) = ends(record.positions().iter().copied());
    let (slow, fast) = ends(record.velocities().iter().copied());
    let share = |value: f64, centre: f64, half: f64| if half > 0.0 { (value - centre) / half } else { 0.0 };
    let reach = fast.max(-slow);
    let phase = |(x, v): (&f64, &f64)| {
        let position = share(*x, 0.5 * (low + high), 0.5 * (high - low));
        position.atan2(share(*v, 0.0, reach)).to_degrees().rem_euclid(360.0)
    };
    record.positions().iter().zip(record.velocities()).map(phase).collect()
}
