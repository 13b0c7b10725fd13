//! Friction out of a measured force along a measured motion, in a few lines: `cargo run --release --example force`.
//!
//! The program `fmm force` does the same for any table, and draws it.

use std::error::Error;

use fmm_identify::{Candidate, ForceRecord, Machine, compare};

fn main() -> Result<(), Box<dyn Error>> {
    // A joint with friction of 4 Nm and damping of 0.3 Nm s/rad, moved to and fro.
    let times: Vec<f64> = (0..4000).map(|i| f64::from(i) * 1e-3).collect();
    let positions: Vec<f64> = times.iter().map(|t| 0.5 * (3.0 * t).sin()).collect();
    let velocities: Vec<f64> = times.iter().map(|t| 1.5 * (3.0 * t).cos()).collect();
    let noise = |i: usize| 0.05 * ((i * i % 1009) as f64 / 504.5 - 1.0);
    let torques: Vec<f64> = velocities.iter().enumerate().map(|(i, v)| 4.0 * v.signum() + 0.3 * v + noise(i)).collect();
    let record = ForceRecord::of_positions(&times, &positions, &torques)?.in_units("rad", "N m");

    let models = ["viscous", "coulomb", "coulomb + linear"].map(Candidate::named);
    let models = models.into_iter().collect::<Result<Vec<_>, _>>()?;
    let compared = compare(&Machine::per_unit_mass(), &[record], &models)?;
    println!("{}\n\n{compared}", compared.preferred());
    Ok(())
}
