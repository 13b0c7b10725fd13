//! Friction out of a measured force along a measured motion: `cargo run --release --example force -- FILE`.
//!
//! Reads time, position or velocity, and force (or torque) of a joint, a tribometer or a damper, at equal or unequal steps; fits each
//! model and prints what was found, or with `--json` one document. `--validate` tells how well a model says a record to which it was not
//! fitted. Without a file it runs on a bundled friction damper. `--help` lists the options.

#[path = "common/figure.rs"]
#[expect(dead_code, reason = "other examples draw histograms and points")]
mod figure;
#[path = "force/source.rs"]
mod source;

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use figure::{Layer, Panel, Role, label};
use fmm_identify::{Estimated, ForceIdentification, ForceModel, ForceRecord, SpeedBin, identify_force};
use serde_json::{Value, json};
use source::Source;

/// Fits friction to a measured force along a measured motion.
#[derive(Debug, Parser)]
#[command(name = "force", allow_negative_numbers = true)]
struct Arguments {
    /// Records that are fitted together: tables with time, position or velocity, and force; without any, a bundled friction damper
    files: Vec<PathBuf>,
    #[command(flatten)]
    source: Source,
    /// Models to fit, separated by commas: a law, then after plus signs damping (linear, quadratic, cubic, any sign) and what else acts
    /// or is measured (zero, inertia, stiffness, gravity, asymmetry, load offset, channels, delay)
    #[arg(long, value_delimiter = ',')]
    model: Vec<String>,
    /// Hold a parameter at a value, in the unit in which it is fitted
    #[arg(long, value_name = "NAME=VALUE", value_parser = held)]
    hold: Vec<(String, f64)>,
    /// The longest delay between motion and force that is looked for, in s; twenty samples unless given
    #[arg(long, value_name = "SECONDS")]
    longest_delay: Option<f64>,
    /// Records to which nothing is fitted, but whose forces are predicted
    #[arg(long, value_name = "FILE")]
    validate: Vec<PathBuf>,
    /// Print one JSON document instead of the report
    #[arg(long)]
    json: bool,
    /// Write SVG figures into this folder
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

fn held(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or_else(|| format!("{text:?} is not NAME=VALUE"))?;
    let value = value.trim().parse().map_err(|_| format!("{value:?} is no number"))?;
    Ok((name.trim().to_owned(), value))
}

/// The bundled records: a band brake moved by 25 mm to and fro, fitted and predicted.
const BUNDLED: [&str; 2] = ["damper_1Hz_36lb_1amplitude.csv", "damper_1Hz_30lb_1amplitude.csv"];
/// Models that are fitted unless others are given.
const MODELS: [&str; 2] = ["coulomb + linear + asymmetry", "dahl + linear + asymmetry"];
/// The model of a band brake: its two bands hold, each on one way of the motion.
const BRAKE: &str = "coulomb + linear + zero + inertia + channels";

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let bundled = BUNDLED.map(|name| Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data").join(name));
    let (files, validated) = match arguments.files.as_slice() {
        [] => (vec![bundled[0].clone()], vec![bundled[1].clone()]),
        files => (files.to_vec(), arguments.validate.clone()),
    };
    let source =
        if arguments.files.is_empty() { arguments.source.clone().of_brake() } else { arguments.source.clone() };
    let read = |files: &[PathBuf]| files.iter().map(|file| source.read(file)).collect::<Result<Vec<_>, _>>();
    let (records, others) = (read(&files)?, read(&validated)?);
    let mut models: Vec<&str> = arguments.model.iter().map(String::as_str).collect();
    if models.is_empty() {
        models.extend(MODELS);
        models.extend(arguments.files.is_empty().then_some(BRAKE));
    }
    let mut found = Vec::with_capacity(models.len());
    for name in models {
        let mut model = ForceModel::named(name)?;
        for (parameter, value) in &arguments.hold {
            model = model.holding(parameter, *value)?;
        }
        if let Some(longest) = arguments.longest_delay {
            model = model.with_delay_up_to(longest)?;
        }
        found.push(identify_force(&model, &records)?);
    }
    if let Some(folder) = &arguments.figures {
        std::fs::create_dir_all(folder)?;
        for (index, found) in found.iter().enumerate() {
            figure::stacked(&folder.join(format!("force_{}.svg", index + 1)), &panels(&records[0], found)?)?;
        }
    }
    let mut out = std::io::stdout().lock();
    if arguments.json {
        let bins: Vec<Value> = records
            .iter()
            .map(|record| {
                let bins = record.friction_over_speed(BINS);
                let pair = |estimated: Estimated| [estimated.value, estimated.uncertainty];
                let bin = |bin: &SpeedBin| {
                    json!({
                        "speed": bin.speed,
                        "friction_u": pair(bin.friction),
                        "offset_u": pair(bin.offset),
                        "samples": bin.samples,
                    })
                };
                bins.iter().map(bin).collect()
            })
            .collect();
        let models = found.iter().map(|found| document(found, &validated, &others)).collect::<Result<Vec<_>, _>>()?;
        writeln!(
            out,
            "{:#}",
            json!({ "samples": records.iter().map(ForceRecord::len).sum::<usize>(), "friction_over_speed": bins, "models": models })
        )?;
        return Ok(());
    }
    for (file, record) in files.iter().zip(&records) {
        let unit = record.force_unit();
        writeln!(out, "{}: {} samples, forces in {unit}", file.display(), record.len())?;
    }
    for found in &found {
        writeln!(out, "\n{found}")?;
        for (file, record) in validated.iter().zip(&others) {
            let said = found.validate_on(record)?;
            let (rms, unit) = (said.rms, record.force_unit());
            let share = said.share().map_or_else(String::new, |share| format!(", {:.1} % of the force", 100.0 * share));
            writeln!(out, "  not fitted: {}: rms {rms:.4e} {unit}{share}", file.display())?;
        }
    }
    Ok(())
}

fn document(found: &ForceIdentification, files: &[PathBuf], others: &[ForceRecord]) -> Result<Value, Box<dyn Error>> {
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
            })
        })
        .collect();
    let mut validated = Vec::new();
    for (file, record) in files.iter().zip(others) {
        let said = found.validate_on(record)?;
        validated.push(json!({ "file": file.display().to_string(), "rms": said.rms, "share_of_force": said.share() }));
    }
    Ok(json!({
        "model": found.model(),
        "rms_residual": found.rms_residual(),
        "share_of_force": found.rms_residual() / found.force_deviation(),
        "findings": findings,
        "not_fitted": validated,
        "warnings": found.warnings().iter().map(ToString::to_string).collect::<Vec<_>>(),
    }))
}

/// Bins of the friction over the speed.
const BINS: usize = 24;

/// Force over position and over velocity with the fit in, friction over the speed without a law, and what is left over time.
fn panels(record: &ForceRecord, found: &ForceIdentification) -> Result<Vec<Panel>, Box<dyn Error>> {
    let said = found.predict(record)?;
    let velocity = format!("{}/s", record.position_unit());
    let against = |abscissae: &[f64], name: &str, unit: &str| {
        let measured = abscissae.iter().copied().zip(record.forces().iter().copied()).collect();
        let fitted = abscissae.iter().zip(&said).filter_map(|(x, said)| Some((*x, (*said)?))).collect();
        Panel::new(label(name, unit), label("force", record.force_unit()), 420.0)
            .with(Layer::new(Role::Measured, "measured", measured))
            .with(Layer::new(Role::Fitted, found.model(), fitted))
    };
    let bins = record.friction_over_speed(BINS);
    let bins = bins.iter().map(|bin| (bin.speed, bin.friction.value)).collect();
    let left = record.times().iter().zip(record.forces()).zip(&said);
    let left = left.filter_map(|((time, force), said)| Some((*time, (*said)? - force))).collect();
    let text = format!("fit − measured, {:.3e} {} rms", found.rms_residual(), record.force_unit());
    Ok(vec![
        against(record.positions(), "position", record.position_unit()),
        against(record.velocities(), "velocity", &velocity),
        Panel::new(label("speed", &velocity), label("friction", record.force_unit()), 260.0).with(Layer::new(
            Role::Points,
            "half the difference of the directions, medians",
            bins,
        )),
        Panel::new("time / s", label("residual", record.force_unit()), 260.0).with(Layer::new(
            Role::Residual,
            text,
            left,
        )),
    ])
}
