//! The frequency response of an impact test, in a few lines: `cargo run --release --example frf`.
//!
//! The program `fmm frf` does the same for any files, and draws it.

use std::error::Error;
use std::path::Path;

use fmm_frf::{AverageOptions, Estimator, ResponseForm, TrialAverage};
use fmm_record::{Quantity, open};

fn main() -> Result<(), Box<dyn Error>> {
    // Three blows on a structure, with force and acceleration as columns of a matrix.
    let mut average = None;
    for blow in 1..=3 {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/data/hammer_{blow}.mat"));
        let file = open(file)?;
        let force = file.channel("force")?.record.with_quantity(Quantity::Force).with_unit("N");
        let response = file.channel("acceleration")?.record.with_quantity(Quantity::Acceleration).with_unit("m/s²");
        let (form, options) = (ResponseForm::Accelerance, AverageOptions::default());
        let empty = || TrialAverage::new(form, force.rate(), force.len(), &options);
        average.get_or_insert(empty()?).add_records(&force, &response)?;
    }
    let average = average.ok_or("no blow")?;
    let (response, coherence) = (average.estimate(Estimator::H1)?, average.coherence()?);
    for peak in response.resonances(20.0) {
        println!("{:8.2} Hz: |H| = {:.2} {}", peak.frequency, peak.magnitude, response.form().unit());
    }
    println!("median coherence {:?}", coherence.median(1.0, 1000.0));
    Ok(())
}
