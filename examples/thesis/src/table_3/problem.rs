//! The record, and the fit that is repeated.

use fmm_friction::Coulomb;
use fmm_identify::Problem as Declared;
use fmm_model::{Bounds, Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Sampling, Scenario};

use crate::{Found, printed};

/// The fit of coefficient of friction and initial position.
pub type Problem = Declared<'static>;

/// The coefficient of friction that the record is made with.
pub const TRUTH: f64 = 0.15;
/// Normal load of A3 (N).
pub(super) const LOAD: f64 = printed::LOADS[2];
/// Initial velocity of A3, which is not fitted (m/s).
const VELOCITY: f64 = 0.101;

/// The fit of coefficient and initial position, in the bounds of A3, to a record of 1.5 s at 1 kHz that `engine` makes.
///
/// # Errors
/// None that the printed values could raise.
pub fn problem(engine: &impl Engine<f64, Coulomb>) -> Found<Problem> {
    let [mass, stiffness, damping] = printed::MACHINE;
    let machine = Oscillator::new(mass, stiffness)?.with_damping(Damping::linear(damping)?);
    let scenario = Scenario::new(machine, Coulomb::new(TRUTH)?, LOAD)?.starting_at(0.0, VELOCITY)?;
    let motion = engine.run(&scenario, &Sampling::uniform(1e-3, 1501)?)?;
    let record = Record::new(0.0, 1e-3, motion.velocity().values().to_vec(), Quantity::Velocity, "m/s")?;
    let values = [
        ("mass", mass),
        ("stiffness", stiffness),
        ("damping", damping),
        ("normal_load", LOAD),
        ("coefficient", TRUTH),
        ("initial_position", 1e-4),
        ("initial_velocity", VELOCITY),
    ];
    Ok(Problem::declared::<Coulomb>(&record, &values)?
        .free_within("coefficient", Bounds::new(0.1, 1.0)?)?
        .free_within("initial_position", Bounds::new(-3e-3, 3e-3)?)?)
}
