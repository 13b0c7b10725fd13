//! Two Maxwell elements as a family of laws, so that they can be fitted: a law of one's own.

use fmm_friction::{LawError, LawFamily, LawParameter, MaxwellSlip, Role};
use fmm_model::{Bounds, Parameter, Scalar};
use fmm_sim::{Bristle, Engine, Exact, Sampling, Scenario, Simulated, SimulationError, Trajectory};

/// Two springs in parallel, each of which slides at a level of its own.
///
/// ```text
/// F = N (κ₁ z₁ + κ₂ z₂),   |zᵢ| ≤ wᵢ/κᵢ
/// ```
///
/// The first is the stiff one.
#[derive(Debug, Clone, Copy)]
pub(super) struct MaxwellPair;

const fn positive(name: &'static str, symbol: &'static str, unit: &'static str, typical: f64) -> LawParameter {
    LawParameter::new(Parameter::new(name, symbol, unit).bounded(Bounds::POSITIVE), Role::Level).typically(typical)
}

impl LawFamily for MaxwellPair {
    const NAME: &'static str = "maxwell_slip";
    const PARAMETERS: &'static [LawParameter] = &[
        positive("coefficient", "w₁", "1", 0.6),
        positive("stiffness", "κ₁", "1/m", 100.0),
        positive("second_coefficient", "w₂", "1", 0.4),
        positive("second_stiffness", "κ₂", "1/m", 20.0),
    ];
    type At<D: Scalar> = MaxwellSlip<D>;

    fn at<D: Scalar>(values: &[D]) -> Result<MaxwellSlip<D>, LawError> {
        let [first, stiff, second, soft] = Self::checked(values)?;
        MaxwellSlip::new(&[(stiff, first), (soft, second)])
    }
}

impl Simulated for MaxwellPair {
    fn simulate_into<D: Scalar>(
        scenario: &Scenario<D, MaxwellSlip<D>>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError> {
        match Exact.run_into(scenario, sampling, trajectory) {
            Err(SimulationError::NotLinear { .. }) => Bristle::default().run_into(scenario, sampling, trajectory),
            other => other,
        }
    }
}
