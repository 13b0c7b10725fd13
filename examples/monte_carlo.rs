//! The uncertainty of a coefficient of friction, after the thesis' Table 3: `cargo run --release --example monte_carlo`.
//!
//! A ring-down of known truth is fitted again and again, each time on another machine: mass, stiffness and damping drawn
//! from what is known of them, one at a time and all together. The thesis' raw data are not published, so the record is
//! simulated, with the thesis' machine, load and initial velocity. Printed figures of the thesis stand beside ours.

#[path = "common/figure.rs"]
#[expect(dead_code, reason = "other examples draw curves")]
mod figure;

use std::error::Error;
use std::fmt::Write as _;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use fmm_fit::{Held, MultiStart, Options, Refit, Residuals, Sensitivity, solve};
use fmm_friction::Coulomb;
use fmm_identify::MachineProblem;
use fmm_model::{Bounds, Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario, Thesis};
use fmm_uq::{Budget, Input, Inputs, MonteCarlo, Observations, OutputSample, propagate, validate};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

/// Monte Carlo uncertainty of a coefficient of friction (Table 3 of the thesis).
#[derive(Debug, Parser)]
#[command(name = "monte_carlo")]
struct Arguments {
    /// Fits per row with the exact motion
    #[arg(long, default_value_t = 100_000)]
    trials: u64,
    /// Fits per row with the thesis' Euler motion
    #[arg(long, default_value_t = 20_000)]
    parity_trials: u64,
    /// Few fits: 2000 and 200 per row
    #[arg(long)]
    quick: bool,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 3)]
    seed: u64,
    /// Relative standard uncertainty of the normal load, which the thesis leaves out
    #[arg(long, default_value_t = 0.001)]
    load_uncertainty: f64,
    /// Relative standard uncertainty of the common scale of mass, stiffness and damping, which no record shows
    #[arg(long, default_value_t = 0.001)]
    scale_uncertainty: f64,
    /// Print one JSON document instead of the tables
    #[arg(long)]
    json: bool,
    /// Write the histogram (the thesis' Fig. 11) as an SVG file into this folder
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

/// The fixed values of the fit with their standard uncertainties, as the thesis' Table 2 prints them.
const MACHINE: [(&str, f64, f64, &str); 3] =
    [("mass", 10.391, 0.0049, "kg"), ("stiffness", 1982.0, 1.3, "N/m"), ("damping", 0.275, 0.0341, "N s/m")];
/// Normal load of the thesis' Monte Carlo program (N).
const LOAD: f64 = 7.2;
/// The coefficient of friction that the record is made with.
const TRUTH: f64 = 0.15;
/// Initial velocity, which the thesis does not fit (m/s).
const VELOCITY: f64 = 0.101;
/// More starts about the best values so far, for the thesis' Euler motion.
const KICKS: usize = 3;
/// What the thesis prints: standard uncertainty, and "sensitivity" in the product of its own two columns before.
const PRINTED: [(&str, f64, Option<f64>); 4] = [
    ("mass", 6.39e-5, Some(3.12e-7)),
    ("stiffness", 2.09e-5, Some(2.64e-5)),
    ("damping", 2.36e-4, Some(8.04e-6)),
    ("all", 2.48e-4, None),
];
/// Mass (kg), stiffness (N/m) and damping (N s/m) at nine amplitudes: the thesis' Table 1.
const TABLE_1: [[f64; 9]; 3] = [
    [10.394, 10.395, 10.393, 10.397, 10.392, 10.389, 10.389, 10.385, 10.382],
    [1981.0, 1981.0, 1981.0, 1982.0, 1982.0, 1983.0, 1984.0, 1984.0, 1984.0],
    [0.222, 0.235, 0.245, 0.256, 0.278, 0.288, 0.299, 0.313, 0.327],
];

type Found<T> = Result<T, Box<dyn Error>>;
/// Why one fit of many failed.
type Failure = Box<dyn Error + Send + Sync>;

/// The fit of coefficient and initial position, to a record that `engine` makes.
fn problem(engine: &impl Engine<f64, Coulomb>) -> Found<MachineProblem<Coulomb>> {
    let [mass, stiffness, damping] = MACHINE.map(|(_, value, ..)| value);
    let machine = Oscillator::new(mass, stiffness)?.with_damping(Damping::linear(damping)?);
    let scenario = Scenario::new(machine, Coulomb::new(TRUTH)?, LOAD)?.starting_at(0.0, VELOCITY)?;
    let motion = engine.run(&scenario, &Sampling::uniform(1e-3, 1501)?)?;
    let record = Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s")?;
    let mut values = MACHINE.map(|(name, value, ..)| (name, value)).to_vec();
    values.extend([("normal_load", LOAD), ("coefficient", TRUTH)]);
    values.extend([("initial_position", 1e-4), ("initial_velocity", VELOCITY)]);
    Ok(MachineProblem::new(&record, &values)?
        .free_within("coefficient", Bounds::new(0.1, 1.0)?)?
        .free_within("initial_position", Bounds::new(-3e-3, 3e-3)?)?)
}

/// The inputs of one row of Table 3: one of them uncertain, or all.
fn inputs(row: &str) -> Found<Inputs> {
    let input = |(name, value, u, unit): (&str, f64, f64, &str)| {
        if row == name || row == "all" { Input::new(name, value, u, unit) } else { Input::new(name, value, 0.0, unit) }
    };
    Ok(Inputs::new(MACHINE.map(input).into_iter().collect::<Result<Vec<_>, _>>()?)?)
}

/// One row by Monte Carlo, and how long it took (s).
struct Row {
    name: &'static str,
    sample: OutputSample,
    seconds: f64,
}

/// All rows with `model`, which gives coefficient and initial position.
fn rows(
    title: &str,
    trials: u64,
    seed: u64,
    model: impl Fn(&[f64]) -> Result<Vec<f64>, Failure> + Sync,
) -> Found<Vec<Row>> {
    let bar = ProgressBar::new(4 * trials);
    bar.set_style(ProgressStyle::with_template("{prefix} {wide_bar} {pos}/{len} fits, {eta} left")?);
    bar.set_prefix(title.to_owned());
    let mut rows = Vec::new();
    for (index, (name, ..)) in PRINTED.into_iter().enumerate() {
        let watch = |progress: fmm_uq::Progress| {
            bar.set_position(index as u64 * trials + progress.done);
            ControlFlow::Continue(())
        };
        let began = Instant::now();
        let run = MonteCarlo::new(&inputs(name)?, trials)?.with_seed(seed).with_progress(&watch);
        let sample = run.run(&model)?;
        rows.push(Row { name, sample, seconds: began.elapsed().as_secs_f64() });
    }
    bar.finish_and_clear();
    Ok(rows)
}

/// Coefficient and initial position by the thesis' Euler motion. Its sum of squares jumps wherever a stop moves to
/// another sample, so that one start alone, the thesis' own, ends beside the minimum; `kicks` more find it.
fn parity_model(problem: &MachineProblem<Coulomb>, kicks: usize, values: &[f64]) -> Result<Vec<f64>, Failure> {
    let held = Held::new(problem, values.iter().copied().enumerate())?;
    let mut start = problem.values().to_vec();
    start[..values.len()].copy_from_slice(values);
    let reach = problem.parameters().iter().map(|parameter| match parameter.name() {
        "coefficient" => 5e-4,
        "initial_position" => 5e-5,
        _ => 0.0,
    });
    // A search that ends at a jump does not get further with another radius, but from another start.
    let options =
        Options::default().with_restarts(0).with_polish_steps(0).with_cost_tolerance(1e-9).with_step_tolerance(1e-8);
    let search =
        MultiStart::default().with_starts(1).with_kicks(1, kicks).with_reach(reach.collect()).with_options(options);
    let minima = search.solve(&held, &start)?;
    let best = minima.best().or(minima.unfinished()).ok_or("no fit came to an end")?;
    let found = |name| best.estimate(name).map(fmm_fit::Estimate::value).ok_or("no such parameter");
    Ok(vec![found("coefficient")?, found("initial_position")?])
}

/// Everything that is shown.
struct Table3 {
    coefficients: [f64; 4],
    exact: Vec<Row>,
    parity: Vec<Row>,
    restarted: Vec<Row>,
    gum: Budget,
    extended: Budget,
    correlated: f64,
}

fn table_3(arguments: &Arguments) -> Found<Table3> {
    let exact = problem(&Exact)?;
    let fit = solve(&exact, exact.values(), &Options::default())?;
    let sensitivity = Sensitivity::of(&exact, &fit)?;
    let by = |input: &str| sensitivity.coefficient_of("coefficient", input).ok_or("the coefficient is not determined");
    let coefficients = [by("mass")?, by("stiffness")?, by("damping")?, by("normal_load")?];
    let refit = Refit::prepare(&exact, &fit)?.varying(&MACHINE.map(|(name, ..)| name))?;
    let (trials, parity_trials) =
        if arguments.quick { (2000, 200) } else { (arguments.trials, arguments.parity_trials) };
    let found = rows("exact motion ", trials, arguments.seed, |x| Ok(refit.estimates(x)?))?;
    let euler = problem(&Thesis::A3)?.by_thesis();
    let parity = rows("thesis' motion", parity_trials, arguments.seed, |x| parity_model(&euler, 0, x))?;
    let restarted =
        rows("and restarts  ", parity_trials.div_ceil(10), arguments.seed, |x| parity_model(&euler, KICKS, x))?;

    let linear = |x: &[fmm_uq::Taylor]| {
        let moved = x.iter().zip(MACHINE).map(|(x, (_, value, ..))| *x - value);
        moved.zip(coefficients).fold(fmm_uq::Taylor::from(TRUTH), |sum, (change, c)| sum + change * c)
    };
    let gum = propagate(&inputs("all")?, linear)?.named("μ", "1");
    let [mass, stiffness, damping] = TABLE_1.map(|column| Observations::new(&column));
    let (mass, stiffness, damping) = (mass?, stiffness?, damping?);
    let correlations = [
        ("mass", "stiffness", mass.correlation(&stiffness)?),
        ("mass", "damping", mass.correlation(&damping)?),
        ("stiffness", "damping", stiffness.correlation(&damping)?),
    ];
    let correlated = inputs("all")?.with_correlations(&correlations)?;
    let correlated = propagate(&correlated, linear)?.standard_uncertainty();
    // What no record shows moves μ in proportion.
    let quantities = MACHINE.map(|(name, value, u, unit)| Input::new(name, value, u, unit));
    let scales = [("normal load", arguments.load_uncertainty), ("common scale", arguments.scale_uncertainty)];
    let scales = scales.map(|(name, u)| Input::new(name, 1.0, u, "1"));
    let all = Inputs::new(quantities.into_iter().chain(scales).collect::<Result<Vec<_>, _>>()?)?;
    let extended =
        propagate(&all.with_correlations(&correlations)?, |x| linear(&x[..3]) * x[4] / x[3])?.named("μ", "1");
    Ok(Table3 { coefficients, exact: found, parity, restarted, gum, extended, correlated })
}

impl Table3 {
    /// Standard uncertainty by the sensitivities, row by row.
    fn linear(&self) -> Vec<f64> {
        let mut parts: Vec<f64> = self.gum.contributions().map(|part| part.uncertainty).collect();
        parts.push(self.gum.standard_uncertainty());
        parts
    }

    fn text(&self, arguments: &Arguments) -> Found<String> {
        let mut text = String::new();
        writeln!(text, "Standard uncertainty of μ = {TRUTH} (1), thesis' Table 3 beside ours\n")?;
        writeln!(
            text,
            "{:<10} {:>10} {:>12} {:>12} {:>12} {:>12} {:>13} {:>13}",
            "row", "thesis", "GUM", "Monte Carlo", "parity", "restarted", "mean", "parity mean"
        )?;
        let sampled = self.exact.iter().zip(&self.parity).zip(&self.restarted);
        for ((printed, linear), ((exact, parity), restarted)) in PRINTED.iter().zip(self.linear()).zip(sampled) {
            let (u, euler) = (exact.sample.standard_uncertainty(0)?, parity.sample.standard_uncertainty(0)?);
            let restarted = restarted.sample.standard_uncertainty(0)?;
            let (mean, euler_mean) = (exact.sample.estimate(0)?, parity.sample.estimate(0)?);
            writeln!(
                text,
                "{:<10} {:>10.2e} {linear:>12.4e} {u:>12.4e} {euler:>12.4e} {restarted:>12.4e} {mean:>13.8} {euler_mean:>13.8}",
                exact.name, printed.1
            )?;
        }
        writeln!(
            text,
            "\nGUM: implicit function theorem at the fit. Monte Carlo: {} fits a row of the exact motion. Parity: {} of the\n\
             thesis' Euler motion, whose sum of squares jumps, from its start; restarted: {} of them, best of {} starts.\n\
             The record is simulated, as the thesis' own are not published.\n",
            self.exact[0].sample.values(0)?.len(),
            self.parity[0].sample.values(0)?.len(),
            self.restarted[0].sample.values(0)?.len(),
            KICKS + 1
        )?;
        writeln!(text, "Sensitivity of μ\n")?;
        writeln!(text, "{:<12} {:>12} {:>14} {:>16}  unit of ours", "by", "thesis", "ours", "u(thesis)/u(x)")?;
        for (((name, _, u, unit), printed), ours) in MACHINE.iter().zip(PRINTED).zip(self.coefficients) {
            let printed_value = printed.2.unwrap_or(f64::NAN);
            writeln!(text, "{name:<12} {printed_value:>12.2e} {ours:>14.6e} {:>16.3e}  1/({unit})", printed.1 / u)?;
        }
        writeln!(text, "{:<12} {:>12} {:>14.6e} {:>16}  1/N", "normal load", "-", self.coefficients[3], "-")?;
        writeln!(
            text,
            "\nThe printed column is u(μ) times u(x), not a derivative. Only k/m, c/m and μ N/m show in a record: the\n\
             identity m ∂μ/∂m + k ∂μ/∂k + c ∂μ/∂c = μ gives {:.9}, and N ∂μ/∂N = {:.9}.\n",
            self.identity(),
            LOAD * self.coefficients[3]
        )?;
        let validation = self.validation()?;
        writeln!(text, "{}", self.gum)?;
        writeln!(text, "{validation}\n")?;
        writeln!(
            text,
            "With the correlation that Table 1 shows between m, k and c: {:.4e}, {:+.1} %.\n",
            self.correlated,
            100.0 * (self.correlated / self.gum.standard_uncertainty() - 1.0)
        )?;
        writeln!(
            text,
            "Extended by that, by the load ({} %) and by the scale ({} %), both assumed here:\n",
            100.0 * arguments.load_uncertainty,
            100.0 * arguments.scale_uncertainty
        )?;
        writeln!(text, "{}", self.extended)?;
        let rate = |rows: &[Row]| {
            let fits: usize = rows.iter().map(|row| row.sample.values(0).map_or(0, <[f64]>::len)).sum();
            fits as f64 / rows.iter().map(|row| row.seconds).sum::<f64>()
        };
        writeln!(
            text,
            "{:.0} exact fits a second, {:.0} of the thesis' motion.",
            rate(&self.exact),
            rate(&self.parity)
        )?;
        Ok(text)
    }

    fn identity(&self) -> f64 {
        MACHINE.iter().zip(self.coefficients).map(|((_, value, ..), c)| value * c).sum()
    }

    /// JCGM 101:2008, clause 8, in words.
    fn validation(&self) -> Found<String> {
        let all = &self.exact[3].sample;
        let (linear, found) = (self.gum.expanded(0.95)?.interval(), all.symmetric_interval(0, 0.95)?);
        let validation = validate(linear, found, all.standard_uncertainty(0)?, 2)?;
        let verdict = if validation.is_valid() { "agrees" } else { "does not agree" };
        Ok(format!(
            "The 95 % interval of the GUM, {:.6} to {:.6}, {verdict} with that of the Monte Carlo, {:.6} to {:.6}, within {:.0e}.",
            linear.low, linear.high, found.low, found.high, validation.tolerance
        ))
    }

    fn document(&self) -> Found<Value> {
        let row = |index: usize| {
            let (printed, linear) = (PRINTED[index], self.linear()[index]);
            let (exact, parity, restarted) = (&self.exact[index], &self.parity[index], &self.restarted[index]);
            let sample = &exact.sample;
            let interval = sample.symmetric_interval(0, 0.95)?;
            Ok(json!({
                "row": exact.name,
                "thesis": printed.1,
                "gum": linear,
                "monte_carlo": sample.standard_uncertainty(0)?,
                "mean": sample.estimate(0)?,
                "interval_95": [interval.low, interval.high],
                "trials": sample.values(0)?.len(),
                "seconds": exact.seconds,
                "parity": parity.sample.standard_uncertainty(0)?,
                "parity_mean": parity.sample.estimate(0)?,
                "parity_trials": parity.sample.values(0)?.len(),
                "parity_seconds": parity.seconds,
                "restarted": restarted.sample.standard_uncertainty(0)?,
                "restarted_trials": restarted.sample.values(0)?.len(),
            }))
        };
        let rows = (0..PRINTED.len()).map(row);
        let sensitivities: serde_json::Map<String, Value> = MACHINE
            .iter()
            .map(|machine| machine.0)
            .chain(["normal_load"])
            .map(str::to_owned)
            .zip(self.coefficients.map(Value::from))
            .collect();
        Ok(json!({
            "rows": rows.collect::<Found<Vec<Value>>>()?,
            "sensitivities": sensitivities,
            "scale_identity": self.identity(),
            "with_correlation": self.correlated,
            "extended": self.extended.standard_uncertainty(),
        }))
    }
}

fn run(arguments: &Arguments) -> Found<()> {
    let table = table_3(arguments)?;
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&table.document()?)?)?;
    } else {
        write!(out, "{}", table.text(arguments)?)?;
    }
    if let Some(folder) = &arguments.figures {
        std::fs::create_dir_all(folder)?;
        let path = folder.join("monte_carlo.svg");
        let values = table.exact[3].sample.values(0)?;
        figure::histogram(&path, "coefficient of friction", "Monte Carlo", values)?;
        writeln!(std::io::stderr(), "figure: {}", path.display())?;
    }
    Ok(())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("monte_carlo: {error}");
            ExitCode::FAILURE
        }
    }
}
