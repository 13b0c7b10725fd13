//! Friction out of the record of a free vibration, in a few lines: `cargo run --release --example identify`.
//!
//! The program `fmm identify` does the same for any file.

use std::error::Error;
use std::path::Path;

use fmm_identify::{Experiment, Machine, Preparation, search};
use fmm_record::{Quantity, Reader};

fn main() -> Result<(), Box<dyn Error>> {
    // A bicycle fork that swings as a pendulum, seen by a gyro of unknown gain.
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/BrowserForkCompoundFirst1.mat");
    let reader = Reader::default().channel("data").quantity(Quantity::Velocity).unit("V");
    let decay = Experiment::ring_down(&reader.read(file)?.record, &Preparation::default())?;
    println!("{}\n", decay.summary());

    let comparison = search(&Machine::per_unit_mass(), &[decay])?;
    for finding in comparison.preferred().findings() {
        println!("{} = {finding}", finding.parameter().name());
    }
    println!("\n{}", comparison.headline());
    for warning in comparison.warnings() {
        println!("warning: {warning}");
    }
    Ok(())
}
