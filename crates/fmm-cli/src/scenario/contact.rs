//! A law whose type is known only at run time, with the engines that take it.

use std::marker::PhantomData;
use std::rc::Rc;

use fmm_friction::{BristleLaw, Gms, LawFamily, LawVisitor, PiecewiseLinearLaw, Regime, SlidingLaw, Smoothed};
use fmm_model::Oscillator;
use fmm_sim::{
    Bristle, Engine, Exact, Excitation, RungeKutta, Sampling, Scenario, SimulationError, State, Trajectory,
    simulate_into,
};

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
/// An implementor promises that [`simulate`](Self::simulate) answers exactly the engines of [`engines`](Self::engines).
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

    /// Friction coefficient (1), with its sign, at a `velocity` (m/s) relative to the counterface and internal
    /// `states`; `losing` tells that the speed falls.
    fn coefficient(&self, velocity: f64, states: &[f64], losing: bool) -> f64;

    /// The law as one of the sliding speed alone, if it is one.
    fn into_sliding(self: Box<Self>) -> Option<Box<dyn SlidingLaw<f64>>>;
}

/// What a law of type `L` is: its kind, and the engine that suits it.
pub(crate) trait Kind<L> {
    /// What `visitor` does with laws of this kind.
    fn visit<V: LawVisitor<f64, L>>(visitor: V) -> V::Output;

    /// The motion by the engine that suits a law that is not one of the speed alone, or is a level plus a slope.
    ///
    /// # Errors
    /// [`SimulationError`] if the engine has no answer.
    fn automatic(scenario: &Scenario<f64, L>, sampling: &Sampling) -> Result<Trajectory, SimulationError>;
}

impl<F: LawFamily> Kind<F::At<f64>> for F {
    fn visit<V: LawVisitor<f64, F::At<f64>>>(visitor: V) -> V::Output {
        <F as LawFamily>::visit(visitor)
    }

    fn automatic(scenario: &Scenario<f64, F::At<f64>>, sampling: &Sampling) -> Result<Trajectory, SimulationError> {
        let mut trajectory = Trajectory::new();
        simulate_into::<F, _>(scenario, sampling, None, &mut trajectory)?;
        Ok(trajectory)
    }
}

/// The kind of [`Gms`].
pub(crate) struct OfGms;

impl Kind<Gms> for OfGms {
    fn visit<V: LawVisitor<f64, Gms>>(visitor: V) -> V::Output {
        visitor.bristle()
    }

    fn automatic(scenario: &Scenario<f64, Gms>, sampling: &Sampling) -> Result<Trajectory, SimulationError> {
        Bristle::default().run(scenario, sampling)
    }
}

/// The kind of a law that is made smooth.
pub(crate) struct OfSmoothed;

impl Kind<Smoothed<AnySliding>> for OfSmoothed {
    fn visit<V: LawVisitor<f64, Smoothed<AnySliding>>>(visitor: V) -> V::Output {
        visitor.sliding()
    }

    fn automatic(
        scenario: &Scenario<f64, Smoothed<AnySliding>>,
        sampling: &Sampling,
    ) -> Result<Trajectory, SimulationError> {
        let scenario: &Scenario<f64, dyn SlidingLaw<f64>> = scenario;
        RungeKutta::default().run(scenario, sampling)
    }
}

/// A law `L` of kind `K`.
pub(crate) struct Law<K, L> {
    law: L,
    kind: PhantomData<K>,
}

impl<K, L> Law<K, L> {
    /// That law.
    pub(crate) const fn new(law: L) -> Self {
        Self { law, kind: PhantomData }
    }
}

impl<K: Kind<L>, L: Clone + 'static> Contact for Law<K, L> {
    fn engines(&self) -> &'static [EngineName] {
        K::visit(Engines(&self.law))
    }

    fn simulate(
        &self,
        setting: &Setting,
        choice: Choice,
        sampling: &Sampling,
    ) -> Result<Option<Trajectory>, SimulationError> {
        K::visit(Run { law: self.law.clone(), kind: self.kind, setting, choice, sampling })
    }

    fn coefficient(&self, velocity: f64, states: &[f64], losing: bool) -> f64 {
        K::visit(Coefficient { law: &self.law, velocity, states, losing })
    }

    fn into_sliding(self: Box<Self>) -> Option<Box<dyn SlidingLaw<f64>>> {
        K::visit(IntoSliding(self.law))
    }
}

/// Asks for the engines that take a law.
struct Engines<'a, L>(&'a L);

impl<L> LawVisitor<f64, L> for Engines<'_, L> {
    type Output = &'static [EngineName];

    fn sliding(self) -> Self::Output
    where
        L: SlidingLaw<f64>,
    {
        // Time stepping has one level only.
        let engines = &[EngineName::Auto, EngineName::RungeKutta, EngineName::Thesis, EngineName::Moreau];
        if self.0.depends_on_acceleration() { &engines[..3] } else { engines }
    }

    fn piecewise_linear(self) -> Self::Output
    where
        L: PiecewiseLinearLaw<f64> + SlidingLaw<f64>,
    {
        let engines =
            &[EngineName::Auto, EngineName::Exact, EngineName::RungeKutta, EngineName::Thesis, EngineName::Moreau];
        if self.0.depends_on_acceleration() { &engines[..4] } else { engines }
    }

    fn bristle(self) -> Self::Output
    where
        L: BristleLaw<f64>,
    {
        &[EngineName::Auto, EngineName::Bristle]
    }

    fn elements(self) -> Self::Output
    where
        L: PiecewiseLinearLaw<f64> + BristleLaw<f64>,
    {
        &[EngineName::Auto, EngineName::Exact, EngineName::Bristle]
    }
}

/// Runs the engine that is chosen by name, or the one that suits the law; `None` if it does not take the law.
struct Run<'a, K, L> {
    law: L,
    kind: PhantomData<K>,
    setting: &'a Setting,
    choice: Choice,
    sampling: &'a Sampling,
}

impl<K: Kind<L>, L> LawVisitor<f64, L> for Run<'_, K, L> {
    type Output = Result<Option<Trajectory>, SimulationError>;

    fn sliding(self) -> Self::Output
    where
        L: SlidingLaw<f64>,
    {
        self.choice.sliding(&self.setting.with(self.law)?, self.sampling)
    }

    fn piecewise_linear(self) -> Self::Output
    where
        L: PiecewiseLinearLaw<f64> + SlidingLaw<f64>,
    {
        match self.choice.engine {
            EngineName::Auto => K::automatic(&self.setting.with(self.law)?, self.sampling).map(Some),
            EngineName::Exact => Exact.run(&self.setting.with(self.law)?, self.sampling).map(Some),
            _ => self.sliding(),
        }
    }

    fn bristle(self) -> Self::Output
    where
        L: BristleLaw<f64>,
    {
        let scenario = self.setting.with(self.law)?;
        match self.choice.engine {
            EngineName::Auto => K::automatic(&scenario, self.sampling).map(Some),
            EngineName::Bristle => self.choice.bristle(&scenario, self.sampling).map(Some),
            _ => Ok(None),
        }
    }

    fn elements(self) -> Self::Output
    where
        L: PiecewiseLinearLaw<f64> + BristleLaw<f64>,
    {
        match self.choice.engine {
            EngineName::Exact => Exact.run(&self.setting.with(self.law)?, self.sampling).map(Some),
            _ => self.bristle(),
        }
    }
}

/// Asks a law for its coefficient (1), with its sign, at a velocity (m/s) of either sign.
struct Coefficient<'a, L> {
    law: &'a L,
    velocity: f64,
    states: &'a [f64],
    losing: bool,
}

impl<L> LawVisitor<f64, L> for Coefficient<'_, L> {
    type Output = f64;

    fn sliding(self) -> f64
    where
        L: SlidingLaw<f64>,
    {
        let Self { law, velocity, losing, .. } = self;
        let speed = velocity.abs();
        let coefficient = if losing { law.coefficient_losing_speed(speed) } else { law.coefficient(speed) };
        if velocity == 0.0 { 0.0 } else { coefficient * velocity.signum() }
    }

    fn bristle(self) -> f64
    where
        L: BristleLaw<f64>,
    {
        // Which elements slide does not matter to the coefficient.
        let mut rate = vec![0.0; self.law.states()];
        self.law.rate(self.velocity, self.states, Regime::ALL_HOLD, &mut rate);
        self.law.coefficient(self.velocity, self.states, &rate)
    }
}

/// Makes a law one of the sliding speed alone, if it is one.
struct IntoSliding<L>(L);

impl<L: 'static> LawVisitor<f64, L> for IntoSliding<L> {
    type Output = Option<Box<dyn SlidingLaw<f64>>>;

    fn sliding(self) -> Self::Output
    where
        L: SlidingLaw<f64>,
    {
        Some(Box::new(self.0))
    }

    fn bristle(self) -> Self::Output
    where
        L: BristleLaw<f64>,
    {
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
