//! Motion of a machine under a law: `fmm simulate SCENARIO.json`.
//!
//! Reads a scenario (machine, damping, law of friction, forces, initial state, sampling; all SI), simulates it, and
//! gives out its events and energies, or everything.

mod figures;
mod record;

use std::error::Error;
use std::fmt::{self, Write as _};
use std::path::PathBuf;

use clap::Args;
use fmm_friction::OwnLaw;

use crate::answer::{Answer, Detail, Document};
use crate::figure::{ends, label};
use crate::host::Host;
use crate::output::Output;
use crate::refusal::{Kind, placed};
use crate::scenario::{Motion, Simulation};

/// Simulates a machine with a sliding contact.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The scenario, a file of JSON
    scenario: PathBuf,
    #[command(flatten)]
    record: record::Record,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// A scenario and its motion.
pub(crate) struct Simulated {
    /// Text of the scenario, which is read again where it is drawn: a law is at home in one thread.
    scenario: String,
    laws: Vec<&'static OwnLaw>,
    motion: Motion,
    written: Option<String>,
}

pub(crate) fn simulate(arguments: &Arguments, host: &Host<'_>) -> Result<Simulated, Box<dyn Error>> {
    let path = &arguments.scenario;
    let text = host.text(path)?;
    let wrong = |error: Box<dyn Error>| Kind::Document.unless_known(placed(path.display())(error));
    let scenario = Simulation::read(&text, host.laws()).map_err(wrong)?;
    let motion = host.while_busy("simulating", || scenario.run().map_err(placed(path.display())))??;
    let written = arguments.record.write(&scenario, &motion)?;
    Ok(Simulated { scenario: text, laws: host.laws().to_vec(), motion, written })
}

impl Simulated {
    fn simulation(&self) -> Result<Simulation, Box<dyn Error>> {
        Simulation::read(&self.scenario, &self.laws)
    }
}

impl Answer for Simulated {
    fn text(&self) -> Result<String, Box<dyn Error>> {
        Ok(text(&self.simulation()?, &self.motion)?.trim_end().to_owned())
    }

    fn document(&self, _: Detail) -> Result<String, Box<dyn Error>> {
        Document::new("simulate-1", &self.motion).compact()
    }

    fn pictures(&self) -> Result<Vec<(String, String)>, Box<dyn Error>> {
        figures::pictures(&self.simulation()?, &self.motion)
    }

    fn written(&self) -> Option<String> {
        self.written.clone()
    }
}

/// Events printed at most; the document of `--json` has them all.
const MOST_EVENTS: usize = 60;

/// Fields of a scenario.
pub(crate) const HELP: &str = include_str!("help.txt");

/// A motion for the eye.
fn text(scenario: &Simulation, motion: &Motion) -> Result<String, fmt::Error> {
    let mut text = String::new();
    for line in [&scenario.title, &scenario.description] {
        if !line.is_empty() {
            writeln!(text, "{line}")?;
        }
    }
    writeln!(text, "law {}, engine {}\n", scenario.law, motion.engine)?;

    let [position, velocity, _] = scenario.units();
    let head = [label("x", position), label("v", velocity)];
    writeln!(text, "{:>16}  {:13} {:>15} {:>15}  {:10} {:>10}", "t / s", "event", head[0], head[1], "next", "margin")?;
    for event in motion.events.iter().take(MOST_EVENTS) {
        let next = event.phase.map_or_else(|| event.next.to_owned(), |phase| format!("{} {phase}", event.next));
        // Only where the velocity is zero is anything decided, and neither bristles nor a contact without a level
        // decide.
        let decided =
            motion.samples.z.is_empty() && matches!(event.kind.as_str(), "zero_velocity" | "breakaway+" | "breakaway-");
        let margin =
            if decided && event.margin.is_finite() { format!("{:+.2e}", event.margin) } else { "-".to_owned() };
        writeln!(
            text,
            "{:16.12}  {:13} {:+15.8e} {:+15.8e}  {next:10} {margin:>10}",
            event.t, event.kind, event.x, event.v
        )?;
    }
    if let Some(more) = motion.events.len().checked_sub(MOST_EVENTS).filter(|more| *more > 0) {
        writeln!(text, "… and {more} more")?;
    }

    let (samples, energy) = (&motion.samples, &motion.energy);
    let last = |values: &[f64]| values.last().copied().unwrap_or(0.0);
    writeln!(text, "\nenergy at {} s (J)", last(&samples.t))?;
    let mut energies = vec![("kinetic", &energy.kinetic), ("potential", &energy.potential)];
    if let Some(work) = &energy.work {
        energies.extend([
            ("lost to friction", &work.friction),
            ("lost to damping", &work.viscous),
            ("brought from outside", &work.external),
            ("balance", &work.balance),
        ]);
    }
    for (name, values) in energies {
        writeln!(text, "{name:>22} {:+.10e}", last(values))?;
    }
    if energy.work.is_none() {
        writeln!(text, "{:>22} not kept by this engine", "work")?;
    }

    let count = samples.t.len();
    let first = samples.t.first().copied().unwrap_or(0.0);
    writeln!(text, "\n{count} samples from {first} s to {} s", last(&samples.t))?;
    let states = samples.z.iter().enumerate().map(|(index, values)| (format!("state z{index}"), values, ""));
    let motions = [("position".to_owned(), &samples.x, position), ("velocity".to_owned(), &samples.v, velocity)];
    for (name, values, unit) in motions.into_iter().chain(states) {
        let (low, high) = ends(values.iter().copied());
        writeln!(text, "{}", format!("{name:>22} {low:+.6e} to {high:+.6e} {unit}").trim_end())?;
    }
    Ok(text)
}
