//! A law whose type is known only at run time, with the engines that take it.

use std::rc::Rc;

use fmm_friction::{
    BristleLaw, Gms, LawError, LawFamily, MaxwellSlip, PiecewiseLinearLaw, Regime, SlidingLaw, Smoothed,
};
use fmm_model::Oscillator;
use fmm_sim::{Engine, Exact, Excitation, Sampling, Scenario, Simulated, SimulationError, State, Trajectory};

use super::EngineName;
use super::engine::Choice;

/// Everything about a scenario but the law.
#[derive(Debug, Clone)]
pub(crate) struct Setting {
    pub(crate) oscillator: Oscillator,
    /// N.
    pub(crate) normal_load: f64,
    pub(crate) initial: State,
    pub(crate) excitations: Vec<Excitation>,
}

impl Setting {
    fn with<L>(&self, law: L) -> Result<Scenario<f64, L>, SimulationError> {
        let State { position, velocity } = self.initial;
        let scenario = Scenario::new(self.oscillator, law, self.normal_load)?.starting_at(position, velocity)?;
        Ok(self.excitations.iter().cloned().fold(scenario, Scenario::driven_by))
    }
}

/// A law of any type.
///
/// There is one implementation for each set of engines that take a law, generic in the law. An implementor promises
/// that [`simulate`](Self::simulate) answers exactly the engines of [`engines`](Self::engines).
pub(crate) trait Contact {
    /// The engines that take the law.
    fn engines(&self) -> &'static [EngineName];

    /// The motion by the engine chosen; none if that is not among [`engines`](Self::engines).
    ///
    /// # Errors
    /// [`SimulationError`] if the engine has no answer.
    fn simulate(
        &self,
        setting: &Setting,
        choice: Choice,
        sampling: &Sampling,
    ) -> Result<Option<Trajectory>, SimulationError>;

    /// Friction coefficient (1), with its sign, at a `velocity` (m/s) relative to the counterface and internal `states`;
    /// `losing` tells that the speed falls.
    fn coefficient(&self, velocity: f64, states: &[f64], losing: bool) -> f64;

    /// The law as one of the sliding speed alone, if it is one.
    fn into_sliding(self: Box<Self>) -> Option<Box<dyn SlidingLaw<f64>>>;
}

/// The engines of a law of the sliding speed.
fn of_the_speed(law: &impl SlidingLaw<f64>) -> &'static [EngineName] {
    // Time stepping has one level only.
    let engines = &[EngineName::Auto, EngineName::RungeKutta, EngineName::Thesis, EngineName::Moreau];
    if law.depends_on_acceleration() { &engines[..3] } else { engines }
}

/// The engines of such a law that is a level plus a slope.
fn of_levels(law: &impl SlidingLaw<f64>) -> &'static [EngineName] {
    let engines =
        &[EngineName::Auto, EngineName::Exact, EngineName::RungeKutta, EngineName::Thesis, EngineName::Moreau];
    if law.depends_on_acceleration() { &engines[..4] } else { engines }
}

/// Friction against a velocity of either sign.
fn against(law: &(impl SlidingLaw<f64> + ?Sized), velocity: f64, losing: bool) -> f64 {
    let speed = velocity.abs();
    let coefficient = if losing { law.coefficient_losing_speed(speed) } else { law.coefficient(speed) };
    if velocity == 0.0 { 0.0 } else { coefficient * velocity.signum() }
}

/// Friction of a law with internal states; which elements slide does not matter to it.
fn carried(law: &impl BristleLaw<f64>, velocity: f64, states: &[f64]) -> f64 {
    let mut rate = vec![0.0; law.states()];
    law.rate(velocity, states, Regime::ALL_HOLD, &mut rate);
    law.coefficient(velocity, states, &rate)
}

/// The family's own choice of an engine.
fn automatic<F: Simulated>(
    scenario: &Scenario<f64, F::At<f64>>,
    sampling: &Sampling,
) -> Result<Trajectory, SimulationError> {
    let mut trajectory = Trajectory::new();
    F::simulate_into(scenario, sampling, &mut trajectory)?;
    Ok(trajectory)
}

/// A law that is a level plus a slope.
pub(crate) struct Affine<F: LawFamily>(F::At<f64>);

/// Any other law of the sliding speed.
pub(crate) struct Sliding<F: LawFamily>(F::At<f64>);

/// A law with an internal state.
pub(crate) struct Bristled<F: LawFamily>(F::At<f64>);

macro_rules! of_values {
    ($($wrapper:ident),+) => {$(
        impl<F: LawFamily> $wrapper<F> {
            /// The law with these parameter values, in the order of [`LawFamily::PARAMETERS`].
            pub(crate) fn of(values: &[f64]) -> Result<Self, LawError> {
                F::at(values).map(Self)
            }
        }
    )+};
}

of_values!(Affine, Sliding, Bristled);

impl<F: Simulated> Contact for Affine<F>
where
    F::At<f64>: PiecewiseLinearLaw<f64> + SlidingLaw<f64> + 'static,
{
    fn engines(&self) -> &'static [EngineName] {
        of_levels(&self.0)
    }

    fn simulate(
        &self,
        setting: &Setting,
        choice: Choice,
        sampling: &Sampling,
    ) -> Result<Option<Trajectory>, SimulationError> {
        let scenario = setting.with(self.0.clone())?;
        match choice.engine {
            EngineName::Auto => automatic::<F>(&scenario, sampling).map(Some),
            EngineName::Exact => Exact.run(&scenario, sampling).map(Some),
            _ => choice.sliding(&scenario, sampling).transpose(),
        }
    }

    fn coefficient(&self, velocity: f64, _states: &[f64], losing: bool) -> f64 {
        against(&self.0, velocity, losing)
    }

    fn into_sliding(self: Box<Self>) -> Option<Box<dyn SlidingLaw<f64>>> {
        Some(Box::new(self.0))
    }
}

impl<F: Simulated> Contact for Sliding<F>
where
    F::At<f64>: SlidingLaw<f64> + 'static,
{
    fn engines(&self) -> &'static [EngineName] {
        of_the_speed(&self.0)
    }

    fn simulate(
        &self,
        setting: &Setting,
        choice: Choice,
        sampling: &Sampling,
    ) -> Result<Option<Trajectory>, SimulationError> {
        let scenario = setting.with(self.0.clone())?;
        match choice.engine {
            EngineName::Auto => automatic::<F>(&scenario, sampling).map(Some),
            _ => choice.sliding(&scenario, sampling).transpose(),
        }
    }

    fn coefficient(&self, velocity: f64, _states: &[f64], losing: bool) -> f64 {
        against(&self.0, velocity, losing)
    }

    fn into_sliding(self: Box<Self>) -> Option<Box<dyn SlidingLaw<f64>>> {
        Some(Box::new(self.0))
    }
}

impl<F: Simulated> Contact for Bristled<F>
where
    F::At<f64>: BristleLaw<f64> + 'static,
{
    fn engines(&self) -> &'static [EngineName] {
        &[EngineName::Auto, EngineName::Bristle]
    }

    fn simulate(
        &self,
        setting: &Setting,
        choice: Choice,
        sampling: &Sampling,
    ) -> Result<Option<Trajectory>, SimulationError> {
        let scenario = setting.with(self.0.clone())?;
        match choice.engine {
            EngineName::Auto => automatic::<F>(&scenario, sampling).map(Some),
            EngineName::Bristle => choice.bristle(&scenario, sampling).map(Some),
            _ => Ok(None),
        }
    }

    fn coefficient(&self, velocity: f64, states: &[f64], _losing: bool) -> f64 {
        carried(&self.0, velocity, states)
    }

    fn into_sliding(self: Box<Self>) -> Option<Box<dyn SlidingLaw<f64>>> {
        None
    }
}

impl Contact for MaxwellSlip {
    fn engines(&self) -> &'static [EngineName] {
        &[EngineName::Auto, EngineName::Exact, EngineName::Bristle]
    }

    fn simulate(
        &self,
        setting: &Setting,
        choice: Choice,
        sampling: &Sampling,
    ) -> Result<Option<Trajectory>, SimulationError> {
        let scenario = setting.with(self.clone())?;
        match choice.engine {
            EngineName::Auto => match Exact.run(&scenario, sampling) {
                Err(SimulationError::NotLinear { .. } | SimulationError::Resonance { .. }) => {
                    choice.bristle(&scenario, sampling).map(Some)
                }
                other => other.map(Some),
            },
            EngineName::Exact => Exact.run(&scenario, sampling).map(Some),
            EngineName::Bristle => choice.bristle(&scenario, sampling).map(Some),
            _ => Ok(None),
        }
    }

    fn coefficient(&self, _velocity: f64, states: &[f64], _losing: bool) -> f64 {
        self.coefficient_at(states)
    }

    fn into_sliding(self: Box<Self>) -> Option<Box<dyn SlidingLaw<f64>>> {
        None
    }
}

impl Contact for Gms {
    fn engines(&self) -> &'static [EngineName] {
        &[EngineName::Auto, EngineName::Bristle]
    }

    fn simulate(
        &self,
        setting: &Setting,
        choice: Choice,
        sampling: &Sampling,
    ) -> Result<Option<Trajectory>, SimulationError> {
        let scenario = setting.with(self.clone())?;
        match choice.engine {
            EngineName::Auto | EngineName::Bristle => choice.bristle(&scenario, sampling).map(Some),
            _ => Ok(None),
        }
    }

    fn coefficient(&self, velocity: f64, states: &[f64], _losing: bool) -> f64 {
        carried(self, velocity, states)
    }

    fn into_sliding(self: Box<Self>) -> Option<Box<dyn SlidingLaw<f64>>> {
        None
    }
}

/// A law of the sliding speed of any type.
#[derive(Clone)]
pub(crate) struct AnySliding(Rc<dyn SlidingLaw<f64>>);

impl AnySliding {
    /// That law.
    pub(crate) fn new(law: Box<dyn SlidingLaw<f64>>) -> Self {
        Self(law.into())
    }
}

impl SlidingLaw<f64> for AnySliding {
    fn coefficient(&self, speed: f64) -> f64 {
        self.0.coefficient(speed)
    }

    fn breakaway(&self) -> f64 {
        self.0.breakaway()
    }

    fn depends_on_acceleration(&self) -> bool {
        self.0.depends_on_acceleration()
    }

    fn coefficient_losing_speed(&self, speed: f64) -> f64 {
        self.0.coefficient_losing_speed(speed)
    }

    fn capture_speed(&self) -> f64 {
        self.0.capture_speed()
    }
}

impl Contact for Smoothed<AnySliding> {
    fn engines(&self) -> &'static [EngineName] {
        of_the_speed(self)
    }

    fn simulate(
        &self,
        setting: &Setting,
        choice: Choice,
        sampling: &Sampling,
    ) -> Result<Option<Trajectory>, SimulationError> {
        let scenario = setting.with(self.clone())?;
        match choice.engine {
            EngineName::Auto => choice.runge_kutta(&scenario, sampling).map(Some),
            _ => choice.sliding(&scenario, sampling).transpose(),
        }
    }

    fn coefficient(&self, velocity: f64, _states: &[f64], losing: bool) -> f64 {
        against(self, velocity, losing)
    }

    fn into_sliding(self: Box<Self>) -> Option<Box<dyn SlidingLaw<f64>>> {
        Some(self)
    }
}
