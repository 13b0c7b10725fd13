//! A ring-down with stick and slip, exact through every event, in a few lines:
//! `cargo run --release --example simulate`.
//!
//! The program `fmm simulate` does the same for a scenario in a file, and draws it.

use std::error::Error;

use fmm_friction::Berger;
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Sampling, Scenario, simulate};

fn main() -> Result<(), Box<dyn Error>> {
    // The thesis' machine, released 16 mm from the middle with a contact under 14 N.
    let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::new(0.2005, 0.437)?);
    let scenario = Scenario::new(machine, Berger::new(0.228, 0.261, 2.852)?, 14.0)?.starting_at(0.016, 0.0)?;
    let motion = simulate(&scenario, &Sampling::uniform(1e-3, 2001)?)?;
    for event in motion.events() {
        println!("{:.6} s: {:?} at {:+.4} mm", event.time, event.kind, 1e3 * event.position);
    }
    Ok(())
}
