//! Friction out of a measured force along a measured motion: `fmm force FILES...`.
//!
//! Reads time, position or velocity, and force (or torque) of a joint, a tribometer or a damper, at equal or unequal
//! steps; fits each model and gives out what was found. `--validate` tells how well a model predicts a record to which
//! it was not fitted.

mod columns;
mod source;

use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;

use crate::figure::{Panel, Role, drawn, ends, label};
use crate::files::named;
use crate::input::{Held, limit};
use crate::output::{Output, of_size, pair, print, print_json, while_busy};
use clap::Args;
use columns::Columns;
use fmm_identify::{
    Candidate, Comparison, ForceLoop, ForceRecord, Identification, IdentifyError, Inquiry, Machine, Onset, SpeedBin,
    Validation, Warning,
};
use fmm_model::Rounded;
use serde_json::{Value, json};
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
    output: Output,
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

pub(crate) fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let read = |files: &[PathBuf]| -> Result<(Vec<ForceRecord>, Vec<Columns>), Box<dyn Error>> {
        let tables = files.iter().map(|file| arguments.source.read(file)).collect::<Result<Vec<_>, _>>()?;
        Ok(tables.into_iter().map(|Table { record, columns }| (record, columns)).unzip())
    };
    let ((records, columns), (others, columns_of_others)) = (read(&arguments.files)?, read(&arguments.validate)?);
    let described = described(arguments, &records)?;
    let compared = compared(arguments, &records, &others, &described)?;
    let found = compared.identifications();
    let picture = |(found, number): (&Identification, usize)| {
        Ok((format!("force_{number}.svg"), drawn(&panels(&records[0], found)?)))
    };
    arguments.output.draw("force_*.svg", || found.iter().zip(1..).map(picture).collect())?;
    let validations = |number: usize| compared.validations().get(number).map_or(&[][..], Vec::as_slice);
    let all_files = || arguments.files.iter().chain(&arguments.validate);
    let all_columns = || columns.iter().chain(&columns_of_others);
    let driven = arguments.validate.iter().zip(&others).filter_map(|(file, record)| {
        let (friction, unit) = (record.driving_friction()?, record.force_unit().to_owned());
        Some(named(file)(Warning::DrivesMotion { friction, unit }))
    });
    let remarks: Vec<String> = all_files()
        .zip(all_columns())
        .flat_map(|(file, columns)| columns.remarks.iter().map(|remark| named(file)(remark)))
        .chain(driven)
        .collect();
    if arguments.output.json {
        let models = found.iter().zip(0..).map(|(found, i)| document(found, &arguments.validate, validations(i)));
        let columns =
            |(file, columns): (&PathBuf, &Columns)| json!({ "file": file.display().to_string(), "columns": columns });
        let warnings: Vec<String> =
            remarks.into_iter().chain(compared.warnings().iter().map(ToString::to_string)).collect();
        let document = json!({
            "columns": all_files().zip(all_columns()).map(columns).collect::<Vec<_>>(),
            "samples": records.iter().map(ForceRecord::len).sum::<usize>(),
            "friction_over_speed": records.iter().map(speeds).collect::<Vec<_>>(),
            "loops": records.iter().map(loops).collect::<Vec<_>>(),
            "onsets": records.iter().map(onsets).collect::<Vec<_>>(),
            "models": models.collect::<Vec<_>>(),
            "preferred": compared.preferred().law(),
            "preferred_by": if others.is_empty() { "fit" } else { "prediction" },
            "is_decided": compared.is_decided(),
            "warnings": warnings,
        });
        return print_json(&document);
    }
    let mut out = String::new();
    for (file, columns) in all_files().zip(all_columns()).skip(records.len()) {
        writeln!(out, "{}, not fitted: {columns}", file.display())?;
    }
    for ((file, record), columns) in arguments.files.iter().zip(&records).zip(&columns) {
        let unit = record.force_unit();
        writeln!(out, "{}: {} samples, forces in {unit}", file.display(), record.len())?;
        writeln!(out, "  columns: {columns}")?;
        for line in without_a_law(record) {
            writeln!(out, "  {line}")?;
        }
    }
    for remark in remarks {
        writeln!(out, "note: {remark}")?;
    }
    for (found, number) in found.iter().zip(0..) {
        writeln!(out, "\n{found}")?;
        for ((file, record), said) in arguments.validate.iter().zip(&others).zip(validations(number)) {
            let (rms, unit) = (said.rms, record.force_unit());
            let share = said.share().map_or_else(String::new, |share| format!(", {:.1} % of the force", 100.0 * share));
            writeln!(out, "  not fitted: {}: rms {rms:.4e} {unit}{share}", file.display())?;
            if let Some(warning) = said.warning(found.law()) {
                writeln!(out, "  - {warning}")?;
            }
        }
    }
    if described.len() > 1 {
        writeln!(out, "\n{compared}")?;
    }
    print(out.trim_end())
}

/// The models that the arguments describe.
fn described(arguments: &Arguments, records: &[ForceRecord]) -> Result<Vec<Candidate>, Box<dyn Error>> {
    let mut models: Vec<&str> = arguments.model.iter().map(String::as_str).collect();
    if models.is_empty() {
        models.extend(models_for(records));
    }
    let law_of = |model: &str| model.split(['+', ',']).next().unwrap_or_default().trim().to_owned();
    let stray = |held: &&Held| held.law.as_ref().is_some_and(|law| models.iter().all(|model| law_of(model) != *law));
    if let Some(Held { law: Some(law), name, .. }) = arguments.hold.iter().find(stray) {
        return Err(format!("--hold {law}.{name}: {law} is the law of no model").into());
    }
    let mut described = Vec::with_capacity(models.len());
    for name in &models {
        let mut model = Candidate::named(name)?;
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
) -> Result<Comparison, Box<dyn Error>> {
    let mut inquiry = Inquiry::of(&Machine::per_unit_mass(), records).validated_by(others);
    if let Some(seconds) = arguments.time_limit {
        inquiry = inquiry.within(limit(seconds)?);
    }
    let names: Vec<String> = models.iter().map(Candidate::name).collect();
    let found = while_busy(&format!("fitting {}", names.join(", ")), || inquiry.among(models))?;
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
            "onsets of sliding: {count}, in the median {stiffness:.4e} {force}/{position} of presliding stiffness, breakaway at \
             {breakaway:.4e} {force}"
        ));
    }
    lines
}

fn speeds(record: &ForceRecord) -> Value {
    let bin = |bin: &SpeedBin| {
        json!({
            "speed": bin.speed,
            "friction_u": pair(bin.friction),
            "offset_u": bin.offset.map(pair),
            "load": bin.load,
            "coefficient_u": bin.coefficient().map(pair),
            "samples": bin.samples,
        })
    };
    record.friction_over_speed_and_load(BINS, LOADS).iter().map(bin).collect()
}

fn loops(record: &ForceRecord) -> Value {
    let cycle = |cycle: &ForceLoop| {
        json!({
            "span": cycle.span,
            "range": cycle.range,
            "energy_u": pair(cycle.energy),
            "friction_u": pair(cycle.friction),
            "stiffness_u": pair(cycle.stiffness),
        })
    };
    record.loops().iter().map(cycle).collect()
}

fn onsets(record: &ForceRecord) -> Value {
    let onset = |onset: &Onset| {
        json!({
            "begin": onset.begin,
            "direction": onset.direction,
            "stiffness_u": pair(onset.stiffness),
            "breakaway_u": pair(onset.breakaway),
            "sliding_u": pair(onset.sliding),
            "displacement": onset.displacement,
        })
    };
    record.onsets().iter().map(onset).collect()
}

fn document(found: &Identification, files: &[PathBuf], validations: &[Validation]) -> Value {
    let findings: Vec<Value> = found
        .findings()
        .iter()
        .map(|finding| {
            json!({
                "name": finding.parameter().name(),
                "unit": finding.parameter().unit(),
                "value": finding.value(),
                "u": finding.uncertainty(),
                "interval_95": finding.interval(0.95).map(|(low, high)| [low, high]),
                "no_interval": finding.without_interval(),
            })
        })
        .collect();
    let validated = |(file, said): (&PathBuf, &Validation)| {
        let (file, share) = (file.display().to_string(), said.share());
        json!({ "file": file, "rms": said.rms, "share_of_force": share })
    };
    let predicted = validations.iter().filter_map(|said| said.warning(found.law()));
    let warnings: Vec<String> =
        found.warnings().iter().map(ToString::to_string).chain(predicted.map(|w| w.to_string())).collect();
    json!({
        "model": found.law(),
        "samples": found.samples(),
        "rms_residual": found.rms_residual(),
        "share_of_force": found.share_of_force(),
        "findings": findings,
        "not_fitted": files.iter().zip(validations).map(validated).collect::<Vec<_>>(),
        "warnings": warnings,
    })
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
    let dots = bins.iter().map(|(speed, friction)| (*speed, friction.value));
    let medians = Panel::new(label(of_speed, &speed), friction, 260.0).with(
        Role::Points,
        format!("{what}, with two standard uncertainties"),
        dots,
    );
    let medians = bins.iter().fold(medians, |panel, (speed, friction)| {
        let end = |sign: f64| (*speed, friction.value + sign * 2.0 * friction.uncertainty);
        panel.with(Role::Measured, "", [end(-1.0), end(1.0)])
    });
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
