//! The measurement whose uncertainty is wanted; all that another one has to replace.

use std::error::Error;
use std::sync::LazyLock;

use fmm_fit::{Options, Refit, solve};
use fmm_friction::Coulomb;
use fmm_identify::Problem;
use fmm_model::{Damping, Oscillator};
use fmm_record::{Quantity, Record};
use fmm_sim::{Engine, Exact, Sampling, Scenario};
use fmm_uq::{Input, Inputs, UncertaintyError};

/// Names and units of the outputs.
pub(crate) const OUTPUTS: [(&str, &str); 2] = [("coefficient", "1"), ("position", "m")];

/// Mass, stiffness and damping with the uncertainties of the thesis' Table 2.
pub(crate) fn inputs() -> Result<Inputs, UncertaintyError> {
    Inputs::new([
        Input::new("mass", 10.391, 0.0049, "kg")?,
        Input::new("stiffness", 1982.0, 1.3, "N/m")?,
        Input::new("damping", 0.275, 0.0341, "N s/m")?,
    ])
}

/// The fit of a simulated ring-down: coefficient of friction 0.15 at 7.2 N, and initial position.
static PROBLEM: LazyLock<Result<Problem<'static>, String>> =
    LazyLock::new(|| problem().map_err(|error| error.to_string()));

/// The same, prepared to be repeated with other machines.
static REFIT: LazyLock<Result<Refit<'static, Problem<'static>>, String>> = LazyLock::new(|| {
    let problem = PROBLEM.as_ref().map_err(String::clone)?;
    let fit = solve(problem, problem.values(), &Options::default()).map_err(|error| error.to_string())?;
    let refit = Refit::prepare(problem, &fit).map_err(|error| error.to_string())?;
    refit.varying(&["mass", "stiffness", "damping"]).map_err(|error| error.to_string())
});

fn problem() -> Result<Problem<'static>, Box<dyn Error>> {
    let machine = Oscillator::new(10.391, 1982.0)?.with_damping(Damping::linear(0.275)?);
    let scenario = Scenario::new(machine, Coulomb::new(0.15)?, 7.2)?.starting_at(0.0, 0.101)?;
    let velocity = Exact.run(&scenario, &Sampling::uniform(1e-3, 1501)?)?.velocity().values().to_vec();
    let record = Record::new(0.0, 1e-3, velocity, Quantity::Velocity, "m/s")?;
    let values = [
        ("mass", 10.391),
        ("stiffness", 1982.0),
        ("damping", 0.275),
        ("normal_load", 7.2),
        ("coefficient", 0.15),
        ("initial_velocity", 0.101),
    ];
    Ok(Problem::declared::<Coulomb>(&record, &values)?.free("coefficient")?.free("initial_position")?)
}

/// Coefficient and position that the record gives on a machine of this mass, stiffness and damping.
pub(crate) fn evaluate(x: &[f64]) -> Result<Vec<f64>, Box<dyn Error + Send + Sync>> {
    Ok(REFIT.as_ref().map_err(String::as_str)?.estimates(x)?)
}
