//! The command line of the report.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

use super::{Outcome, Report};
use crate::{CHAPTERS, Computation, Found, Settings, Target};

/// All numbers of the thesis beside ours, as one page and one document.
#[derive(Debug, Parser)]
struct Arguments {
    /// Folder for report.html and report.json
    #[arg(long, value_name = "DIR", default_value = "target/thesis")]
    out: PathBuf,
    /// Fewer repetitions
    #[arg(long)]
    quick: bool,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Computes all chapters, writes the report, and fails if a chapter fails or a target is missed.
pub fn program() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Found<bool> {
    // Before the work, so that a folder that cannot be made costs no time.
    let at = |error: std::io::Error| format!("{}: {error}", arguments.out.display());
    std::fs::create_dir_all(&arguments.out).map_err(at)?;
    let outcomes = CHAPTERS.iter().map(|&(name, chapter)| computed(arguments, name, chapter)).collect::<Found<_>>()?;
    let report = Report { outcomes, seed: arguments.seed, quick: arguments.quick };

    let page = arguments.out.join("report.html");
    std::fs::write(&page, report.html()).map_err(at)?;
    let document = format!("{}\n", serde_json::to_string_pretty(&report.json())?);
    std::fs::write(arguments.out.join("report.json"), document).map_err(at)?;
    println!("{}", page.display());
    Ok(report.passes())
}

/// One chapter, with a progress line while it runs and a line that stays when it is done.
fn computed(arguments: &Arguments, name: &'static str, chapter: Computation) -> Found<Outcome> {
    let width = CHAPTERS.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let bar = ProgressBar::new(1000).with_prefix(format!("{name:width$}"));
    bar.set_style(ProgressStyle::with_template("{prefix}  {wide_bar} {percent:>3} %, {eta} left")?);
    let watch = |share: f64| bar.set_position((1000.0 * share) as u64);
    let settings = Settings::new().quick(arguments.quick).with_seed(arguments.seed).with_progress(&watch);
    let start = Instant::now();
    let result = chapter(&settings).map_err(|error| error.to_string());
    let outcome = Outcome { name, seconds: start.elapsed().as_secs_f64(), result };
    bar.finish_and_clear();

    let seconds = outcome.seconds;
    let (met, all) = (outcome.targets().iter().filter(|target| target.passes()).count(), outcome.targets().len());
    match &outcome.result {
        Ok(_) => eprintln!("{name:width$}  {met} of {all} targets, {seconds:.1} s"),
        Err(reason) => eprintln!("{name:width$}  failed after {seconds:.1} s: {reason}"),
    }
    for target in outcome.targets().iter().filter(|target| !target.passes()) {
        let [id, quantity, _, ours, _, required, ..] = Target::cells(target);
        eprintln!("  missed: {id} {quantity}: {ours}, required {required}");
    }
    Ok(outcome)
}
