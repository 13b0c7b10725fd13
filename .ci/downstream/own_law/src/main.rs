//! One law in one file: its motion, the derivatives of that, and its parameters back with their uncertainty.

use std::error::Error;

use fmm_friction::LawFamily;
use fmm_identify::{Experiment, Machine, Preparation, identify};
use fmm_model::{Dual, Oscillator, Scalar};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, RungeKutta, Sampling, Scenario};

mod law;

use law::Logarithmic;

/// μ₀ and a.
const TRUTH: [f64; 2] = [0.20, 0.03];

fn main() -> Result<(), Box<dyn Error>> {
    // Motion and gradient: 2 Hz, a load of 1 N per kg, let go at 30 mm. Direction 0 is μ₀, direction 1 is a.
    let constant = Dual::<2>::from;
    let law = Logarithmic::at(&[Dual::variable(TRUTH[0], 0), Dual::variable(TRUTH[1], 1)])?;
    let scenario = Scenario::new(Oscillator::per_unit_mass(constant(2.0))?, law, constant(1.0))?;
    let scenario = scenario.starting_at(constant(0.030), constant(0.0))?;
    let motion = RungeKutta::default().run(&scenario, &Sampling::uniform(1e-3, 3000)?)?;
    let rest = motion.rest().ok_or("it moves for longer than 3 s")?;
    println!(
        "at rest after {:.4} s at {:+.3} mm; ∂x/∂μ₀ = {:+.4} m, ∂x/∂a = {:+.4} m",
        rest.time.value(),
        1e3 * rest.position.value(),
        rest.position.partial(0),
        rest.position.partial(1)
    );

    // A record of it, in steps of 0.1 mm/s, and the parameters back from that.
    let rounded = motion.velocity().values().iter().map(|velocity| (velocity * 1e4).round() * 1e-4).collect();
    let record = Record::sampled(1000.0, rounded, Quantity::Velocity, "m/s")?;
    let decay = Experiment::ring_down(&record, &Preparation::default())?;
    let found = identify::<Logarithmic>(&Machine::per_unit_mass(), &[decay])?;
    println!("{found}");

    for (name, truth) in ["at_rest_friction_per_mass", "increase_friction_per_mass"].into_iter().zip(TRUTH) {
        let finding = found.finding(name).ok_or(name)?;
        let uncertainty = finding.uncertainty().ok_or("the record determines it")?;
        let error = (finding.value() - truth) / uncertainty;
        assert!(error.abs() < 3.0, "{name} is {error:.2} standard uncertainties off");
    }
    Ok(())
}
