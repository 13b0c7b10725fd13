//! What would happen: `cargo run --release --example simulate -- SCENARIO.json`.
//!
//! Reads a scenario (machine, damping, law of friction, forces, initial state, sampling; all SI), simulates it, and
//! prints its events and energies, or with `--json` one document with everything. `examples/scenarios` holds a dozen.
//! `--laws` lists the laws and their parameters.

#[path = "common/figure.rs"]
#[expect(dead_code, reason = "other examples draw histograms and measured curves")]
mod figure;
#[path = "simulate/figures.rs"]
mod figures;
#[path = "simulate/mod.rs"]
mod simulation;
#[path = "simulate/text.rs"]
mod text;

use std::error::Error;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use simulation::Simulation;

/// Simulates a machine with a sliding contact.
#[derive(Debug, Parser)]
#[command(name = "simulate", after_help = text::HELP)]
struct Arguments {
    /// The scenario
    #[arg(required_unless_present = "laws")]
    scenario: Option<PathBuf>,
    /// Print one JSON document instead of the tables
    #[arg(long)]
    json: bool,
    /// Write SVG figures into this folder
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// List the laws with their parameters, and stop
    #[arg(long)]
    laws: bool,
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
    let mut out = BufWriter::new(std::io::stdout().lock());
    let Some(path) = arguments.scenario.as_ref().filter(|_| !arguments.laws) else {
        return Ok(until_closed(write!(out, "{}", text::Laws).and_then(|()| out.flush()))?);
    };
    let text = std::fs::read_to_string(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    let scenario = Simulation::read(&text)?;
    let motion = scenario.run()?;
    if let Some(folder) = &arguments.figures {
        std::fs::create_dir_all(folder).map_err(|error| format!("cannot create {}: {error}", folder.display()))?;
        figures::draw(folder, &scenario, &motion)?;
        eprintln!("figures: {}", folder.join("{motion,friction}.svg").display());
    }
    let written = if arguments.json {
        serde_json::to_writer(&mut out, &motion).map_err(std::io::Error::from).and_then(|()| writeln!(out))
    } else {
        write!(out, "{}", text::Report { scenario: &scenario, motion: &motion })
    };
    Ok(until_closed(written.and_then(|()| out.flush()))?)
}

/// Whoever reads may stop reading.
fn until_closed(written: std::io::Result<()>) -> std::io::Result<()> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}
