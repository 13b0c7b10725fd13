//! Friction out of a ring-down record: `cargo run --release --example identify -- FILE`.
//!
//! Reads a record of displacement, velocity or acceleration (CSV, TSV, MATLAB v5 to v7 or UFF58), prepares it, fits it by one law or by
//! several, and prints what was found, how sure it is, and what the record could not tell. Without FILE it runs
//! on the bundled record of a bicycle fork swinging as a pendulum. What a channel measured is told by its unit, or by a word
//! in its name, or by options; what would be a guess is refused. `--help` lists the options.

#[path = "identify/arguments.rs"]
mod arguments;
#[path = "common/figure.rs"]
#[expect(dead_code, reason = "other examples draw curves of other roles")]
mod figure;
#[path = "identify/source.rs"]
mod source;

use std::error::Error;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use arguments::{Given, ModeWanted, mode_wanted};
use clap::Parser;
use figure::{Layer, Panel, Role};
use fmm_fit::{Options, Progress};
use fmm_frf::IsolatedMode;
use fmm_identify::{Candidate, Comparison, Drive, Experiment, Known, Machine, Preparation, Search, Sensor};
use fmm_identify::{compare_observed, search_observed};
use fmm_model::Restoring;
use fmm_record::{Column, Quantity, Record, Request};
use indicatif::{ProgressBar, ProgressStyle};
use source::Choice;

/// Identifies the friction of a machine from the record of its free vibration.
#[derive(Debug, Parser)]
#[command(name = "identify", allow_negative_numbers = true)]
struct Arguments {
    #[command(flatten)]
    given: Given,
    /// Identify one mode of several, the so many-th strongest, from 1 on, or, with a unit, as in 150Hz, the one nearest to a frequency;
    /// the others are filtered out
    #[arg(long, value_name = "N|F Hz", value_parser = mode_wanted)]
    mode: Option<ModeWanted>,
    /// Relative standard uncertainty of that factor, or of the gain of the instrument
    #[arg(long, value_name = "RELATIVE", default_value_t = 0.0)]
    scale_u: f64,
    /// The laws to compare, such as coulomb,berger+quadratic: names with terms of the machine beside them (linear, quadratic,
    /// cubic, power, any sign; cubic spring, quintic spring, stop, gap), or all (viscous, coulomb and both); without it, as many as the record asks for. An unknown name is
    /// answered with the list of laws
    #[arg(long, value_name = "NAME,..|all", value_delimiter = ',')]
    law: Vec<String>,
    /// Begin no further law after so many seconds
    #[arg(long, value_name = "S", conflicts_with = "law")]
    time_limit: Option<f64>,
    /// Hold a fitted parameter of the laws at a value, as in exponent=2; of one law alone as in stribeck.exponent=2
    #[arg(long, value_name = "[LAW.]NAME=VALUE")]
    hold: Vec<String>,
    /// The machine is a pendulum; for a record that is no angle in radians, with the length of the arc that makes one radian
    #[arg(long, value_name = "LENGTH", num_args = 0..=1, default_missing_value = "1")]
    pendulum: Option<f64>,
    /// The moving mass
    #[arg(long, value_name = "KG", conflicts_with = "stiffness")]
    mass: Option<f64>,
    /// Standard uncertainty of the mass
    #[arg(long, value_name = "KG", requires = "mass", default_value_t = 0.0)]
    mass_u: f64,
    /// The stiffness
    #[arg(long, value_name = "N/M")]
    stiffness: Option<f64>,
    /// Standard uncertainty of the stiffness
    #[arg(long, value_name = "N/M", requires = "stiffness", default_value_t = 0.0)]
    stiffness_u: f64,
    /// The machine's own linear damping (N s/m; 1/s if neither mass nor stiffness is given)
    #[arg(long, value_name = "N S/M")]
    damping: Option<f64>,
    /// Standard uncertainty of the damping
    #[arg(long, value_name = "N S/M", requires = "damping", default_value_t = 0.0)]
    damping_u: f64,
    /// The normal load on the contact
    #[arg(long, value_name = "N")]
    normal_load: Option<f64>,
    /// Standard uncertainty of the normal load
    #[arg(long, value_name = "N", requires = "normal_load", default_value_t = 0.0)]
    normal_load_u: f64,
    /// The channel with the measured force (N) that drives the machine; without it and --base, the machine vibrates freely. Without
    /// mass and stiffness, both are found
    #[arg(long, value_name = "NAME|INDEX", conflicts_with = "base")]
    force: Option<Column>,
    /// The channel with the measured motion of the base that drives the machine, best its acceleration
    #[arg(long, value_name = "NAME|INDEX")]
    base: Option<Column>,
    /// The sensor filters by a Butterworth low-pass filter of this order, with its corner frequency or, without it, one that is
    /// fitted
    #[arg(long, value_name = "ORDER[:HZ]", value_parser = low_pass)]
    low_pass: Option<(usize, Option<f64>)>,
    /// The sensor is late by this time
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    delay: f64,
    /// Print one JSON document instead of the report
    #[arg(long)]
    json: bool,
    /// Write SVG figures into this folder
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

/// Order and corner frequency (Hz) of a filter.
fn low_pass(text: &str) -> Result<(usize, Option<f64>), String> {
    let (order, corner) = text.split_once(':').map_or((text, None), |(order, corner)| (order, Some(corner)));
    let order =
        order.trim().parse().map_err(|_| format!("{order:?} is no order; give ORDER or ORDER:HZ, such as 2:44"))?;
    let corner = corner.map(|corner| corner.trim().parse().map_err(|_| format!("{corner:?} is no frequency in Hz")));
    Ok((order, corner.transpose()?))
}

/// What drives the machine, if something does.
fn drive(arguments: &Arguments) -> Result<Option<Drive>, Box<dyn Error>> {
    let (channel, quantity) = match (&arguments.force, &arguments.base) {
        (Some(channel), _) => (channel, Some(Quantity::Force)),
        (None, Some(channel)) => (channel, None),
        (None, None) => return Ok(None),
    };
    let file = arguments.given.file.as_ref().ok_or("the bundled record is one of a free vibration; give a file")?;
    let request = quantity.map_or_else(Request::default, |quantity| Request::default().quantity(quantity));
    let (time, rate) = (arguments.given.time.clone(), arguments.given.rate);
    let choice = Choice { channel: Some(channel.clone()), time, rate, request, is_drive: true };
    let record = choice.read(file)?.record;
    Ok(Some(if quantity.is_some() { Drive::force(&record)? } else { Drive::base(&record)? }))
}

/// The experiment of the record, with its drive and its sensor.
fn experiment(arguments: &Arguments, record: &Record, preparation: &Preparation) -> Result<Experiment, Box<dyn Error>> {
    let experiment = match drive(arguments)? {
        Some(drive) => Experiment::driven(record, drive, preparation)?,
        None => Experiment::ring_down(record, preparation)?,
    };
    let mut sensor = Sensor::default().with_delay(arguments.delay)?;
    sensor = match arguments.low_pass {
        Some((order, Some(corner))) => sensor.with_low_pass(order, corner)?,
        Some((order, None)) => sensor.with_free_low_pass(order)?,
        None => sensor,
    };
    Ok(experiment.seen_by(sensor)?)
}

fn machine(arguments: &Arguments) -> Result<Machine, Box<dyn Error>> {
    let mut machine = match (arguments.mass, arguments.stiffness) {
        (Some(mass), _) => Machine::of_mass(Known::new(mass, arguments.mass_u)?)?,
        (None, Some(stiffness)) => Machine::of_stiffness(Known::new(stiffness, arguments.stiffness_u)?)?,
        (None, None) if arguments.force.is_some() => Machine::unknown(),
        (None, None) => Machine::per_unit_mass(),
    };
    if let Some(damping) = arguments.damping {
        machine = machine.with_damping(Known::new(damping, arguments.damping_u)?)?;
    }
    if let Some(load) = arguments.normal_load {
        machine = machine.with_normal_load(Known::new(load, arguments.normal_load_u)?)?;
    }
    if let Some(length) = arguments.pendulum {
        machine = machine.with_restoring(Restoring::sine(length)?);
    }
    Ok(machine)
}

fn candidates(arguments: &Arguments) -> Result<Vec<Candidate>, Box<dyn Error>> {
    let mut candidates = Vec::new();
    for law in &arguments.law {
        if law == "all" {
            candidates.extend(Candidate::standard());
        } else {
            candidates.push(Candidate::named(law)?);
        }
    }
    for Held { law, name, value } in held(arguments)? {
        let mut is_meant = false;
        for candidate in &mut candidates {
            if law.as_ref().is_none_or(|law| law == candidate.law_name()) {
                *candidate = candidate.clone().holding(&name, value)?;
                is_meant = true;
            }
        }
        if let (false, Some(law)) = (is_meant, law) {
            return Err(format!("--hold {law}.{name}: {law} is none of the laws to compare").into());
        }
    }
    Ok(candidates)
}

/// A parameter that is held, of one law or of all.
struct Held {
    law: Option<String>,
    name: String,
    value: f64,
}

fn held(arguments: &Arguments) -> Result<Vec<Held>, Box<dyn Error>> {
    let parse = |held: &String| {
        let (name, value) =
            held.split_once('=').ok_or("--hold wants NAME=VALUE or LAW.NAME=VALUE, such as exponent=2")?;
        let value: f64 = value.trim().parse().map_err(|_| format!("--hold {held}: {value:?} is no number"))?;
        let (law, name) = match name.split_once('.') {
            Some((law, name)) => (Some(law.trim().to_owned()), name),
            None => (None, name),
        };
        Ok(Held { law, name: name.trim().to_owned(), value })
    };
    arguments.hold.iter().map(parse).collect()
}

fn searched(arguments: &Arguments) -> Result<Search, Box<dyn Error>> {
    let mut search = Search::default();
    for Held { law, name, value } in held(arguments)? {
        search = search.holding(law.as_deref(), &name, value);
    }
    if let Some(seconds) = arguments.time_limit {
        let limit =
            Duration::try_from_secs_f64(seconds).map_err(|_| format!("--time-limit {seconds}: give seconds"))?;
        search = search.within(limit);
    }
    Ok(search)
}

/// Fits all candidates while a line on standard error shows how far they are.
fn identify(arguments: &Arguments, decay: &Experiment) -> Result<Comparison, Box<dyn Error>> {
    let bar = ProgressBar::new_spinner().with_style(ProgressStyle::with_template("{spinner} {msg}")?);
    bar.enable_steady_tick(Duration::from_millis(100));
    let decays = std::slice::from_ref(decay);
    let samples = decay.summary().samples as f64;
    let show = |law: &str, progress: &Progress<'_>| {
        let rms = (progress.sum_of_squares() / samples).sqrt();
        bar.set_message(format!("{law}: step {}, rms residual {rms:.4e}", progress.iterations()));
        ControlFlow::Continue(())
    };
    let (machine, options) = (machine(arguments)?, Options::default());
    let comparison = if arguments.law.is_empty() {
        search_observed(&machine, decays, &searched(arguments)?, &options, show)
    } else {
        compare_observed(&machine, decays, &candidates(arguments)?, &options, show)
    };
    bar.finish_and_clear();
    Ok(comparison?)
}

/// Draws the record with the preferred fit, the decay of its amplitude, and the residuals.
fn draw(folder: &Path, decay: &Experiment, comparison: &Comparison) -> Result<(), Box<dyn Error>> {
    let preferred = comparison.preferred();
    let record = decay.record();
    let model = preferred.model(std::slice::from_ref(decay), 0).ok_or("the fitted motion cannot be drawn")?;
    let (unit, quantity) = (record.unit(), record.quantity());
    let curve = |values: &[f64]| record.times().zip(values.iter().copied()).collect::<Vec<_>>();
    let residuals: Vec<f64> = record.values().iter().zip(&model).map(|(measured, model)| measured - model).collect();

    let motion = Panel::new("", figure::label(quantity, unit), 330.0)
        .with(Layer::new(Role::Measured, "measured", curve(record.values())))
        .with(Layer::new(Role::Fitted, format!("fit by {}", preferred.law()), curve(&model)));
    let remainder = Panel::new("time / s", figure::label("residual", unit), 210.0).with(Layer::new(
        Role::Residual,
        "measured − fit",
        curve(&residuals),
    ));
    figure::stacked(&folder.join("fit.svg"), &[motion, remainder])?;

    let offset = preferred.finding("offset").map_or(0.0, fmm_identify::Finding::value);
    let measured = decay.peaks().iter().map(|(time, value)| (*time, (value - offset).abs())).collect();
    let swings = fmm_record::Swings::of(&Record::new(record.start(), record.interval(), model, quantity, unit)?);
    let fitted = swings.peaks().iter().map(|peak| (peak.time, (peak.value - offset).abs())).collect();
    let amplitudes = Panel::new("time / s", figure::label("amplitude of each half swing", unit), 380.0)
        .with(Layer::new(Role::Points, "measured", measured))
        .with(Layer::new(Role::Fitted, format!("envelope of {}", preferred.law()), fitted));
    figure::stacked(&folder.join("amplitude.svg"), &[amplitudes])?;

    figure::histogram(&folder.join("residuals.svg"), &figure::label("residual", unit), "residuals", &residuals)?;
    Ok(())
}

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
    let mut input = arguments.given.read()?;
    if let Some(mode) = arguments.mode {
        let isolated = IsolatedMode::of(&input.record, &mode.options(&input.record)?)?;
        let (frequency, edge) = (isolated.frequency, isolated.edge);
        let how = format!(
            "the mode at {frequency:.4} Hz, by a filter that looks {edge:.4} s in both directions, which are left out at both ends"
        );
        input.origin = format!("{}; {how}", input.origin);
        input.record = isolated.record;
    }
    let preparation = arguments.given.preparation().gain_uncertainty(arguments.scale_u);
    if let Some(folder) = &arguments.figures {
        std::fs::create_dir_all(folder).map_err(|error| format!("cannot create {}: {error}", folder.display()))?;
    }
    let decay = experiment(arguments, &input.record, &preparation)?;
    let comparison = identify(arguments, &decay)?;
    let report = if arguments.json {
        serde_json::to_string_pretty(&comparison)?
    } else {
        format!("{}\n{comparison}", input.origin)
    };
    match writeln!(std::io::stdout(), "{report}") {
        // Whoever reads may stop reading.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => {}
        written => written?,
    }
    if let Some(folder) = &arguments.figures {
        draw(folder, &decay, &comparison)?;
        eprintln!("figures: {}", folder.join("{fit,amplitude,residuals}.svg").display());
    }
    Ok(())
}
