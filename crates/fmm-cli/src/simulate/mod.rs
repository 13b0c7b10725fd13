//! Motion of a machine under a law: `fmm simulate SCENARIO.json`.
//!
//! Reads a scenario (machine, damping, law of friction, forces, initial state, sampling; all SI), simulates it, and
//! gives out its events and energies, or everything.

mod figures;
mod text;

use std::error::Error;
use std::path::PathBuf;

use clap::Args;

use crate::output::{Output, drawn, print};
use crate::scenario::Simulation;

pub(crate) use text::HELP;

/// Simulates a machine with a sliding contact.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The scenario, a file of JSON
    scenario: PathBuf,
    #[command(flatten)]
    output: Output,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let path = &arguments.scenario;
    let text = std::fs::read_to_string(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    let named = |error| format!("{}: {error}", path.display());
    let scenario = Simulation::read(&text).map_err(named)?;
    let motion = scenario.run().map_err(named)?;
    if let Some(folder) = arguments.output.folder()? {
        figures::draw(folder, &scenario, &motion)?;
        drawn(folder, "{motion,friction}.svg");
    }
    if arguments.output.json {
        print(serde_json::to_string(&motion)?)
    } else {
        print(text::Report { scenario: &scenario, motion: &motion }.to_string().trim_end())
    }
}
