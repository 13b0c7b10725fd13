//! The measurement whose uncertainty is wanted; all that another one has to replace.

use std::error::Error;

use fmm_friction::Coulomb;
use fmm_model::{Damping, Oscillator};
use fmm_sim::{Channels, Engine, Exact, Sampling, Scenario};
use fmm_uq::{Input, Inputs, UncertaintyError};

/// Names and units of the outputs.
pub(crate) const OUTPUTS: [(&str, &str); 2] = [("stop_time", "s"), ("rest_position", "m")];

/// Mass, stiffness and damping of the machine, as nine records at different amplitudes have them together.
pub(crate) fn inputs() -> Result<Inputs, UncertaintyError> {
    Inputs::new([
        Input::new("mass", 10.391, 0.0049, "kg")?,
        Input::new("stiffness", 1982.0, 1.3, "N/m")?,
        Input::new("damping", 0.275, 0.0341, "N s/m")?,
    ])?
    .with_correlations(&[
        ("mass", "stiffness", -0.84),
        ("mass", "damping", -0.89),
        ("stiffness", "damping", 0.95),
    ])
}

/// When and where Coulomb friction of μ = 0.15 at 7.2 N stops the machine that passes its middle at 0.101 m/s.
pub(crate) fn evaluate(x: &[f64]) -> Result<[f64; 2], Box<dyn Error + Send + Sync>> {
    let &[mass, stiffness, damping] = x else { return Err("the model takes mass, stiffness and damping".into()) };
    let machine = Oscillator::new(mass, stiffness)?.with_damping(Damping::linear(damping)?);
    let scenario = Scenario::new(machine, Coulomb::new(0.15)?, 7.2)?.starting_at(0.0, 0.101)?;
    let sampling = Sampling::uniform(1e-3, 2501)?.keeping(Channels::Velocity);
    let motion = Exact.run(&scenario, &sampling)?;
    let rest = motion.rest().ok_or("the machine is still moving after 2.5 s")?;
    Ok([rest.time, rest.position])
}
