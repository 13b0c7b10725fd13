//! From a file of velocities to a coefficient of friction with a 95 % interval, and what a hammer would have shown.
//!
//! `csv_to_coefficient [FILE]` takes the file to be of this machine: 10.391 kg, and 14 N on the contact.

use std::error::Error;
use std::path::PathBuf;

use fmm_fit::effective_count;
use fmm_frf::{SingleDegreeOfFreedom, coulomb_impact_duration};
use fmm_friction::CoulombViscous;
use fmm_identify::{Experiment, Known, Machine, Preparation, identify};
use fmm_record::{Quantity, Reader, Swings};
use fmm_uq::{Input, Inputs, propagate};

mod stand_in;

/// Mass (kg) and normal load (N), each with its standard uncertainty.
const MASS: (f64, f64) = (10.391, 0.005);
const LOAD: (f64, f64) = (14.0, 0.14);

fn main() -> Result<(), Box<dyn Error>> {
    let given = std::env::args_os().nth(1).map(PathBuf::from);
    let path = given.clone().unwrap_or_else(|| std::env::temp_dir().join("fmm_ring_down.csv"));
    if given.is_none() {
        stand_in::write(&path)?;
    }

    // The file, and what was found in it.
    let reading = Reader::default().quantity(Quantity::Velocity).unit("m/s").read(&path)?;
    let swings = Swings::of(&reading.record);
    println!("{}: {} peaks, rate {}\n", reading.channel, swings.peaks().len(), reading.sampling);

    // The friction force, as far as the record and the mass determine it.
    let decay = Experiment::ring_down(&reading.record, &Preparation::default())?;
    let machine = Machine::of_mass(Known::new(MASS.0, MASS.1)?)?;
    let found = identify::<CoulombViscous>(&machine, &[decay])?;
    println!("{found}");
    let residuals = found.fit().residuals();
    let independent = effective_count(residuals).ok_or("the residuals have a scatter")?;
    println!("{} residuals count as {independent:.0} independent ones\n", residuals.len());
    let force = found.finding("friction_force").ok_or("the law has a friction force")?;
    let uncertainty = force.uncertainty().ok_or("the record does not determine the friction force")?;

    // μ = F/N, with what force and load contribute.
    let inputs = Inputs::new([
        Input::new("friction_force", force.value(), uncertainty, "N")?,
        Input::new("normal_load", LOAD.0, LOAD.1, "N")?,
    ])?;
    let budget = propagate(&inputs, |x| x[0] / x[1])?.named("friction_coefficient", "1");
    let interval = budget.expanded(0.95)?.interval();
    println!("{budget}\nμ lies between {:.4} and {:.4} with 95 %", interval.low, interval.high);

    // A hammer of 1.42 N s would show the same friction in another way.
    let omega = std::f64::consts::TAU * found.finding("natural_frequency_hz").ok_or("every fit has one")?.value();
    let machine = SingleDegreeOfFreedom::new(MASS.0, 0.0, MASS.0 * omega * omega)?;
    let peak = machine.peak_after_impact(1.42, force.value())?;
    let duration = coulomb_impact_duration(1.42, force.value())?;
    println!("a blow of 1.42 N s would ring for {duration:.2} s, with a receptance of {peak:.2e} m/N");

    if given.is_none() {
        assert!(interval.low < 0.25 && 0.25 < interval.high, "μ = 0.25 is not in {interval:?}");
        // The load alone leaves one percent.
        assert!((budget.standard_uncertainty() / budget.estimate() - 0.01).abs() < 1e-4, "{budget}");
    }
    Ok(())
}
