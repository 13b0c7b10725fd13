//! A ring-down goes in, its friction comes out, with the uncertainty that load and mass leave.

use std::error::Error;

use fmm_friction::CoulombViscous;
use fmm_identify::{Experiment, Known, Machine, Preparation, identify};
use fmm_model::Oscillator;
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario};

fn main() -> Result<(), Box<dyn Error>> {
    // A stand-in for a measurement: 10.391 kg, 1982 N/m, μ = 0.25 under 14 N, let go at 15 mm, 1 kHz.
    let law = CoulombViscous::new(0.25, 0.02)?;
    let scenario = Scenario::new(Oscillator::new(10.391, 1982.0)?, law, 14.0)?.starting_at(0.015, 0.0)?;
    let velocity = Exact.run(&scenario, &Sampling::uniform(1e-3, 1500)?)?.velocity().values().to_vec();
    let record = Record::sampled(1000.0, velocity, Quantity::Velocity, "m/s")?;

    let decay = Experiment::ring_down(&record, &Preparation::default())?;
    let machine = Machine::of_mass(Known::new(10.391, 0.005)?)?.with_normal_load(Known::new(14.0, 0.014)?)?;
    let found = identify::<CoulombViscous>(&machine, &[decay])?;
    println!("{found}");

    let mu = found.finding("mu").ok_or("the law has a coefficient")?;
    let uncertainty = mu.uncertainty().ok_or("the record determines it")?;
    assert!((mu.value() - 0.25).abs() < 1e-9, "μ = {}", mu.value());
    // Without noise only mass and load are uncertain: 0.25 · √((0.005/10.391)² + 0.001²).
    assert!((uncertainty - 2.774e-4).abs() < 1e-6, "u(μ) = {uncertainty}");
    let (low, high) = mu.interval(0.95).ok_or("what is uncertain has an interval")?;
    println!("μ lies between {low:.4} and {high:.4} with 95 %");
    assert!((high - low - 2.0 * 1.96 * uncertainty).abs() < 1e-6, "{low} to {high}");

    #[cfg(feature = "serde")]
    {
        let document = serde_json::to_value(&found)?;
        assert_eq!(document["parameters"]["mu"]["value"].as_f64(), Some(mu.value()));
    }
    Ok(())
}
