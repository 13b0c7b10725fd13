//! Friction out of a ring-down record: `cargo run --release --example identify -- FILE`.
//!
//! Reads a velocity or displacement record (CSV, TSV, MATLAB v5 to v7 or UFF58), prepares it, fits it by one law or by
//! several, and prints what was found, how sure it is, and what the record could not tell. Without FILE it runs
//! on the bundled record of a bicycle fork swinging as a pendulum. `--help` lists the options.

#[path = "common/figure.rs"]
#[expect(dead_code, reason = "other examples draw curves of other roles")]
mod figure;

use std::error::Error;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::{Parser, ValueEnum};
use figure::{Layer, Panel, Role};
use fmm_fit::{Options, Progress};
use fmm_identify::{Candidate, Comparison, Known, Machine, Preparation, RingDown, Search};
use fmm_identify::{compare_observed, search_observed};
use fmm_model::Restoring;
use fmm_record::{Column, Quantity, Record};
use indicatif::{ProgressBar, ProgressStyle};

/// Identifies the friction of a machine from the record of its free vibration.
#[derive(Debug, Parser)]
#[command(name = "identify", allow_negative_numbers = true)]
struct Arguments {
    /// The record: .csv, .tsv, .txt, .mat, .uff or .unv; without it, the bundled record of a bicycle fork
    file: Option<PathBuf>,
    /// The channel with the motion, by name or by number counted from 0
    #[arg(long, value_name = "NAME|INDEX")]
    channel: Option<Column>,
    /// The channel with the time (s)
    #[arg(long, value_name = "NAME|INDEX", conflicts_with = "rate")]
    time: Option<Column>,
    /// The sampling rate, if there is no time channel
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// What the channel measures
    #[arg(long, value_enum, default_value = "velocity")]
    quantity: Measured,
    /// Factor that turns the channel into SI units; a unit in the channel's name, as in "v [mm/s]", does so by itself
    #[arg(long, value_name = "FACTOR")]
    scale: Option<f64>,
    /// Relative standard uncertainty of that factor, or of the gain of the instrument
    #[arg(long, value_name = "RELATIVE", default_value_t = 0.0)]
    scale_u: f64,
    /// Unit of the channel after scaling; m/s or m unless the channel's name says another
    #[arg(long)]
    unit: Option<String>,
    /// The laws to compare, such as coulomb,berger+quadratic: names with damping of the machine beside them (linear,
    /// quadratic, any sign), or all (viscous, coulomb and both); without it, as many as the record asks for. An unknown name is
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
    /// Use the record from this time on
    #[arg(long, value_name = "S")]
    from: Option<f64>,
    /// Use the record up to this time
    #[arg(long, value_name = "S")]
    to: Option<f64>,
    /// Print one JSON document instead of the report
    #[arg(long)]
    json: bool,
    /// Write SVG figures into this folder
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Measured {
    Velocity,
    Displacement,
}

impl From<Measured> for Quantity {
    fn from(measured: Measured) -> Self {
        match measured {
            Measured::Velocity => Self::Velocity,
            Measured::Displacement => Self::Displacement,
        }
    }
}

/// The record to identify, and how it was read.
struct Input {
    record: Record,
    origin: String,
}

fn bundled() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/BrowserForkCompoundFirst1.mat")
}

fn read(arguments: &Arguments) -> Result<Input, Box<dyn Error>> {
    let quantity = Quantity::from(arguments.quantity);
    let path = arguments.file.clone().unwrap_or_else(bundled);
    let is_one_of = |known: &[&str]| {
        path.extension().is_some_and(|extension| known.iter().any(|known| extension.eq_ignore_ascii_case(known)))
    };
    let reading = if is_one_of(&["uff", "unv"]) {
        if arguments.time.is_some() || arguments.rate.is_some() {
            return Err("a Universal File has its own time; leave out --time and --rate".into());
        }
        let file = fmm_record::uff::UffFile::read(&path)?;
        for warning in file.warnings() {
            eprintln!("warning: {warning}");
        }
        let mut reading = match &arguments.channel {
            Some(channel) => file.channel(channel.clone())?,
            None => file.reading()?,
        };
        let (measured, unit) = (reading.record.quantity(), reading.record.unit());
        if measured != Quantity::Other && measured != quantity {
            return Err(format!("the file says that \"{}\" is a record of {measured}", reading.channel).into());
        }
        if !unit.is_empty() && unit_in(&format!("[{unit}]")).is_none() && arguments.scale.is_none() {
            return Err(format!("the unit \"{unit}\" of the file is not known; give --scale and --unit").into());
        }
        reading.record = reading.record.with_quantity(quantity);
        reading
    } else if is_one_of(&["mat"]) {
        let file = fmm_record::mat::MatFile::read(&path)?;
        let mut reader = fmm_record::mat::MatReader::default().quantity(quantity);
        if let Some(channel) = &arguments.channel {
            reader = reader.channel(variable(&file, channel)?);
        }
        if let Some(time) = &arguments.time {
            reader = reader.time(variable(&file, time)?);
        }
        if let Some(rate) = arguments.rate {
            reader = reader.rate(rate);
        }
        reader.read_from(&file)?
    } else {
        let mut reader = fmm_record::csv::CsvReader::default().quantity(quantity);
        if let Some(channel) = &arguments.channel {
            reader = reader.channel(channel.clone());
        }
        if let Some(time) = &arguments.time {
            reader = reader.time(time.clone());
        }
        if let Some(rate) = arguments.rate {
            reader = reader.rate(rate);
        }
        reader.read(&path)?
    };
    let name = path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
    let origin = format!("{name}, channel {}; the sampling rate was {}", reading.channel, reading.sampling);
    let stated = unit_in(&reading.channel).or_else(|| unit_in(&format!("[{}]", reading.record.unit())));
    let (factor, unit) = match (&arguments.unit, arguments.scale, stated, &arguments.file) {
        (Some(unit), factor, ..) => (factor, unit.as_str()),
        (None, None, Some((factor, unit)), _) => (Some(factor), unit),
        // The gain of the fork's gyro was not published.
        (None, None, None, None) => (None, "V"),
        (None, factor, ..) if quantity == Quantity::Displacement => (factor, "m"),
        (None, factor, ..) => (factor, "m/s"),
    };
    let record = match factor {
        Some(factor) => reading.record.scaled(factor, unit)?,
        None => reading.record.with_unit(unit),
    };
    Ok(Input { record, origin })
}

/// The unit in brackets at the end of a channel's name, as a factor to SI and the SI unit: `v [mm/s]`, `theta (deg)`.
fn unit_in(channel: &str) -> Option<(f64, &'static str)> {
    let name = channel.trim();
    let inside = name.strip_suffix(']').map(|rest| rest.rsplit_once('['));
    let inside = inside.or_else(|| name.strip_suffix(')').map(|rest| rest.rsplit_once('(')))?;
    let degree = std::f64::consts::PI / 180.0;
    Some(match inside?.1.trim() {
        "m/s" => (1.0, "m/s"),
        "cm/s" => (1e-2, "m/s"),
        "mm/s" => (1e-3, "m/s"),
        "µm/s" | "um/s" => (1e-6, "m/s"),
        "m" => (1.0, "m"),
        "cm" => (1e-2, "m"),
        "mm" => (1e-3, "m"),
        "µm" | "um" => (1e-6, "m"),
        "rad/s" => (1.0, "rad/s"),
        "deg/s" | "°/s" => (degree, "rad/s"),
        "rad" => (1.0, "rad"),
        "deg" | "°" => (degree, "rad"),
        "V" => (1.0, "V"),
        _ => return None,
    })
}

/// A MATLAB channel by the name of its variable, or by number: of the arrays in the file, or, if it has but one
/// matrix, of the columns of that.
fn variable(file: &fmm_record::mat::MatFile, column: &Column) -> Result<fmm_record::mat::Channel, Box<dyn Error>> {
    use fmm_record::mat::Channel;
    let index = match column {
        Column::Name(name) => return Ok(Channel::from(name.as_str())),
        Column::Index(index) => *index,
    };
    let arrays: Vec<_> = file.arrays().iter().filter(|array| array.values().len() > 1).collect();
    if let [array] = arrays[..]
        && array.dimensions().iter().all(|length| *length > 1)
    {
        return Ok(Channel::column(array.name(), index + 1));
    }
    match arrays.get(index) {
        Some(array) => Ok(Channel::variable(array.name())),
        None => {
            Err(format!("there is no channel {index}; the file has {} arrays, counted from 0", arrays.len()).into())
        }
    }
}

fn machine(arguments: &Arguments) -> Result<Machine, Box<dyn Error>> {
    let mut machine = match (arguments.mass, arguments.stiffness) {
        (Some(mass), _) => Machine::of_mass(Known::new(mass, arguments.mass_u)?)?,
        (None, Some(stiffness)) => Machine::of_stiffness(Known::new(stiffness, arguments.stiffness_u)?)?,
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
        let (name, value) = held.split_once('=').ok_or("--hold wants NAME=VALUE or LAW.NAME=VALUE, such as exponent=2")?;
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
        let limit = Duration::try_from_secs_f64(seconds).map_err(|_| format!("--time-limit {seconds}: give seconds"))?;
        search = search.within(limit);
    }
    Ok(search)
}

/// Fits all candidates while a line on standard error shows how far they are.
fn identify(arguments: &Arguments, decay: &RingDown) -> Result<Comparison, Box<dyn Error>> {
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
fn draw(folder: &Path, decay: &RingDown, comparison: &Comparison) -> Result<(), Box<dyn Error>> {
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
    let input = read(arguments)?;
    let mut preparation = Preparation::default().gain_uncertainty(arguments.scale_u);
    if let Some(from) = arguments.from {
        preparation = preparation.from(from);
    }
    if let Some(to) = arguments.to {
        preparation = preparation.to(to);
    }
    if let Some(folder) = &arguments.figures {
        std::fs::create_dir_all(folder).map_err(|error| format!("cannot create {}: {error}", folder.display()))?;
    }
    let decay = RingDown::prepare(&input.record, &preparation)?;
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
