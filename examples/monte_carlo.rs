//! The uncertainty of a coefficient of friction, after the thesis' Table 3:
//! `cargo run --release --example monte_carlo`.
//!
//! A ring-down of known truth is fitted again and again, each time on another machine: mass, stiffness and damping
//! drawn from what is known of them, one at a time and all together. The thesis' raw data are not published, so the
//! record is simulated, with the thesis' machine, load and initial velocity. Printed figures of the thesis stand beside
//! ours.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use fmm_cli::figure;
use fmm_fit::{Options, solve};
use fmm_sim::Exact;
use fmm_thesis::Found;
use fmm_thesis::printed::{MACHINE_DEVIATIONS, TABLE_3};
use fmm_thesis::table_3::{ROWS, Row, Sensitivities, TRUTH, VARIED, euler_rows, exact_rows, problem};
use fmm_uq::{Budget, validate};
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

/// More starts about the best values so far, for the thesis' Euler motion.
const KICKS: usize = 3;

/// Rows of `trials` fits each by `run`, which tells a bar how many fits are done.
fn watched(title: &str, trials: u64, run: impl FnOnce(&(dyn Fn(u64) + Sync)) -> Found<Vec<Row>>) -> Found<Vec<Row>> {
    let bar = ProgressBar::new(4 * trials);
    bar.set_style(ProgressStyle::with_template("{prefix} {wide_bar} {pos}/{len} fits, {eta} left")?);
    bar.set_prefix(title.to_owned());
    let rows = run(&|done| bar.set_position(done))?;
    bar.finish_and_clear();
    Ok(rows)
}

/// Everything that is shown.
struct Shown {
    sensitivities: Sensitivities,
    exact: Vec<Row>,
    parity: Vec<Row>,
    restarted: Vec<Row>,
    gum: Budget,
    extended: Budget,
    correlated: f64,
}

fn computed(arguments: &Arguments) -> Found<Shown> {
    let problem = problem(&Exact)?;
    let fit = solve(&problem, problem.values(), &Options::default())?;
    let sensitivities = Sensitivities::of(&problem, &fit)?;
    let (trials, parity_trials) =
        if arguments.quick { (2000, 200) } else { (arguments.trials, arguments.parity_trials) };
    let (seed, few) = (arguments.seed, parity_trials.div_ceil(10));
    let exact = watched("exact motion ", trials, |watch| exact_rows(&problem, &fit, trials, seed, watch))?;
    let parity = watched("thesis' motion", parity_trials, |watch| euler_rows([parity_trials; 4], seed, 0, watch))?;
    let restarted = watched("and restarts  ", few, |watch| euler_rows([few; 4], seed, KICKS, watch))?;
    Ok(Shown {
        sensitivities,
        exact,
        parity,
        restarted,
        gum: sensitivities.budget()?,
        extended: sensitivities.extended_budget(arguments.load_uncertainty, arguments.scale_uncertainty)?,
        correlated: sensitivities.correlated_budget()?.standard_uncertainty(),
    })
}

impl Shown {
    fn text(&self, arguments: &Arguments) -> Found<String> {
        let mut text = String::new();
        writeln!(text, "Standard uncertainty of μ = {TRUTH} (1), thesis' Table 3 beside ours\n")?;
        writeln!(
            text,
            "{:<10} {:>10} {:>12} {:>12} {:>12} {:>12} {:>13} {:>13}",
            "row", "thesis", "GUM", "Monte Carlo", "parity", "restarted", "mean", "parity mean"
        )?;
        let sampled = self.exact.iter().zip(&self.parity).zip(&self.restarted);
        let rows = TABLE_3.iter().zip(self.sensitivities.uncertainties()?).zip(sampled);
        for ((printed, linear), ((exact, parity), restarted)) in rows {
            let (u, euler) = (exact.sample.standard_uncertainty(0)?, parity.sample.standard_uncertainty(0)?);
            let restarted = restarted.sample.standard_uncertainty(0)?;
            let (mean, euler_mean) = (exact.sample.estimate(0)?, parity.sample.estimate(0)?);
            writeln!(
                text,
                "{:<10} {:>10.2e} {linear:>12.4e} {u:>12.4e} {euler:>12.4e} {restarted:>12.4e} {mean:>13.8} {euler_mean:>13.8}",
                exact.name, printed.deviation
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
        let known = VARIED.iter().zip(MACHINE_DEVIATIONS).zip(&TABLE_3);
        for ((((name, unit), u), printed), ours) in known.zip(self.sensitivities.machine) {
            let printed_value = printed.sensitivity_and_product.map_or(f64::NAN, |columns| columns[0]);
            let ratio = printed.deviation / u;
            writeln!(text, "{name:<12} {printed_value:>12.2e} {ours:>14.6e} {ratio:>16.3e}  1/({unit})")?;
        }
        writeln!(text, "{:<12} {:>12} {:>14.6e} {:>16}  1/N", "normal load", "-", self.sensitivities.load, "-")?;
        writeln!(
            text,
            "\nThe printed column is u(μ) times u(x), not a derivative. Only k/m, c/m and μ N/m show in a record: the\n\
             identity m ∂μ/∂m + k ∂μ/∂k + c ∂μ/∂c = μ gives {:.9}, and N ∂μ/∂N = {:.9}.\n",
            self.sensitivities.scale_identity(),
            self.sensitivities.load_identity()
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
        let uncertainties = self.sensitivities.uncertainties()?;
        let row = |index: usize| {
            let (printed, linear) = (TABLE_3[index], uncertainties[index]);
            let (exact, parity, restarted) = (&self.exact[index], &self.parity[index], &self.restarted[index]);
            let sample = &exact.sample;
            let interval = sample.symmetric_interval(0, 0.95)?;
            Ok(json!({
                "row": exact.name,
                "thesis": printed.deviation,
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
        let rows = (0..ROWS.len()).map(row);
        let [mass, stiffness, damping] = self.sensitivities.machine;
        Ok(json!({
            "rows": rows.collect::<Found<Vec<Value>>>()?,
            "sensitivities": {
                "mass": mass,
                "stiffness": stiffness,
                "damping": damping,
                "normal_load": self.sensitivities.load,
            },
            "scale_identity": self.sensitivities.scale_identity(),
            "with_correlation": self.correlated,
            "extended": self.extended.standard_uncertainty(),
        }))
    }
}

fn run(arguments: &Arguments) -> Found<()> {
    let table = computed(arguments)?;
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
        std::fs::write(&path, figure::histogram("coefficient of friction", "Monte Carlo", values))?;
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
