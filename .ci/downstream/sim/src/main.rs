//! Where does a machine come to rest, and how far does that move if its coefficient of friction rises by one percent?

use std::error::Error;

use fmm_friction::Coulomb;
use fmm_model::{Dual, Oscillator, Scalar};
use fmm_sim::{Engine, Exact, Sampling, Scenario};

fn main() -> Result<(), Box<dyn Error>> {
    // 10.391 kg, 1982 N/m, μ = 0.25 under 7 N, let go at 10 mm; watched for 3 s at 1 kHz.
    let constant = Dual::<1>::from;
    let machine = Oscillator::new(constant(10.391), constant(1982.0))?;
    let coefficient = Dual::variable(0.25, 0);
    let scenario = Scenario::new(machine, Coulomb::new(coefficient)?, constant(7.0))?;
    let motion = Exact.run(&scenario.starting_at(constant(0.010), constant(0.0))?, &Sampling::uniform(1e-3, 3000)?)?;

    let rest = motion.rest().ok_or("it swings longer than 3 s")?;
    println!(
        "{} half swings, at rest after {:.4} s at {:+.4} mm",
        motion.half_cycles(),
        rest.time.value(),
        1e3 * rest.position.value()
    );
    println!("1 % more friction moves where it stops by {:+.4} mm", 1e3 * 0.01 * 0.25 * rest.position.partial(0));

    // Every half swing loses 2 μN/k: after six of them x = x₀ − 12 μN/k, in whole half periods.
    let loss = 2.0 * 7.0 / 1982.0;
    assert_eq!(motion.half_cycles(), 6);
    assert!((rest.position.value() - (0.010 - 6.0 * 0.25 * loss)).abs() < 1e-12, "{} m", rest.position.value());
    assert!((rest.position.partial(0) + 6.0 * loss).abs() < 1e-12, "{} m", rest.position.partial(0));
    assert!(rest.time.partial(0).abs() < 1e-12, "a half swing takes as long with friction as without");
    Ok(())
}
