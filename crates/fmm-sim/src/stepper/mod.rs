//! One step of a machine with a sliding contact, for a simulation or a controller that owns the loop.

mod closed_form;
mod response;

use fmm_friction::{BristleLaw, FamilyMember, LawFamily, LawVisitor, PiecewiseLinearLaw, SlidingLaw};
use fmm_model::{ModelError, Oscillator, Scalar};

use crate::error::SimulationError;
use crate::runge_kutta::RungeKutta;
use crate::scenario::{Mode, Sampling, Scenario, State};
use crate::stepper::closed_form::ClosedForm;
use crate::trajectory::{Engine, Trajectory};

/// The force (N) on the machine over one step: a straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force<D = f64> {
    /// Force at the beginning (N).
    pub begin: D,
    /// Force at the end (N).
    pub end: D,
}

impl<D: Scalar> Force<D> {
    /// A force (N) that is held over the step.
    pub const fn held(force: D) -> Self {
        Self { begin: force, end: force }
    }

    /// A force (N) that changes in proportion to time from `begin` to `end`.
    pub const fn line(begin: D, end: D) -> Self {
        Self { begin, end }
    }

    /// Slope (N/s) over a step of `duration` (s).
    fn slope(&self, duration: f64) -> D {
        (self.end - self.begin) / duration
    }
}

/// Result of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stepped<D = f64> {
    /// The state at the end.
    pub state: State<D>,
    /// The mode in which the contact goes on.
    pub mode: Mode,
    /// Number of stops, reversals and breakaways within the step.
    pub events: usize,
}

/// A machine with a sliding contact that is moved step by step, as a controller or the simulation of a larger machine
/// does.
///
/// ```text
/// m x″ + c x′ + k x + N μ(|x′|) sgn x′ = f,   f held or a straight line over the step
/// ```
///
/// A step goes through every stop, reversal and breakaway on its way, at the time at which they happen, so that its
/// length does not matter: two half steps are one whole step. The contact holds exactly and for as long as its load
/// permits; there is no dead zone, no smoothed signum and no drift. State and force go in, the new state comes out, and
/// nothing else is remembered: a step can be taken again from any state, as a predictive controller does.
///
/// | law | machine | method | a step |
/// |---|---|---|---|
/// | a level plus a slope | linear, with or without a spring | closed form from event to event, to rounding | 0.1 µs |
/// | any other of the sliding speed | any | that of [`RungeKutta`], to its default tolerance | 0.9 µs |
///
/// The times are those of steps of 1 ms, of a machine of 2 Hz that slides, stops and holds, with Stribeck's law in the second row; [`simulate`](crate::simulate) is faster where the force is known
/// beforehand. Steps allocate nothing, unless a step has more events than any before it.
///
/// At a dual number the new state has its derivatives: by the old state, by both ends of the force and by every
/// parameter, those of the event times included.
///
/// ```
/// use fmm_friction::CoulombStatic;
/// use fmm_model::{Dual, Oscillator, Scalar};
/// use fmm_sim::{Force, Mode, State, Stepper};
///
/// // A slide of 2 kg against 3 N, 4 N from rest, without a spring.
/// let law = CoulombStatic::new(3.0, 4.0)?;
/// let mut stepper = Stepper::new(Oscillator::new(2.0, 0.0)?, law, 1.0)?;
/// let rest = State { position: 0.0, velocity: 0.0 };
/// let held = stepper.step(rest, Force::held(3.9), 1e-3)?;
/// assert_eq!((held.state, held.mode), (rest, Mode::Stick));
/// // 5 N leave 1 m/s² for 1 ms.
/// let moved = stepper.step(rest, Force::held(5.0), 1e-3)?;
/// assert!((moved.state.velocity - 1e-3).abs() < 1e-18 && (moved.state.position - 0.5e-6).abs() < 1e-21);
///
/// // The same with derivatives by velocity, force and level: what a linear controller is designed with.
/// let (constant, input) = (Dual::<3>::from, Dual::<3>::variable);
/// let law = CoulombStatic::new(input(3.0, 2), constant(4.0))?;
/// let mut stepper = Stepper::new(Oscillator::new(constant(2.0), constant(0.0))?, law, constant(1.0))?;
/// let sliding = State { position: constant(0.0), velocity: input(0.1, 0) };
/// let moved = stepper.step(sliding, Force::held(input(5.0, 1)), 1e-3)?.state.velocity;
/// assert_eq!(moved.partial(0), 1.0);
/// assert!((moved.partial(1) - 0.5e-3).abs() < 1e-18 && (moved.partial(2) + 0.5e-3).abs() < 1e-18);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Which laws
///
/// Those of the sliding speed. A law of two branches that is higher while the speed *falls* is refused: on which branch
/// it is depends on the past. Laws with internal state are followed along a prescribed velocity by
/// [`FeedForward`](fmm_friction::FeedForward), and simulated by [`Bristle`](crate::Bristle).
///
/// # References
/// The motion in responses to an impulse, a step and a ramp, which no weak spring makes a small difference of large
/// numbers, is that of exponential integrators: M. Hochbruck, A. Ostermann, "Exponential integrators", Acta Numerica 19
/// (2010) 209, doi 10.1017/S0962492910000048.
#[derive(Debug, Clone)]
pub struct Stepper<L: FamilyMember> {
    scenario: Scenario<L::Number, L>,
    method: Method<L::Number>,
}

/// Method of a step.
#[derive(Debug, Clone)]
enum Method<D> {
    ClosedForm(ClosedForm<D>),
    /// Integration, with the memory of the last step.
    Integration(Box<Trajectory<D>>),
}

impl<D: Scalar, L: FamilyMember<Number = D>> Stepper<L> {
    /// A machine with a contact of the given `law` under `normal_load` (N).
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the load is negative or not finite, [`SimulationError::NotSupported`] for a law
    /// that [has a past](Self#which-laws).
    pub fn new(oscillator: Oscillator<D>, law: L, normal_load: D) -> Result<Self, SimulationError> {
        let scenario = Scenario::new(oscillator, law, normal_load)?;
        let method = L::Family::visit(Choice(&scenario))?;
        let mut stepper = Self { scenario, method };
        if matches!(stepper.method, Method::Integration(_)) {
            // Takes the memory that steps need.
            let rest = State { position: D::from(0.0), velocity: D::from(0.0) };
            stepper.step(rest, Force::held(D::from(0.0)), 1e-3)?;
        }
        Ok(stepper)
    }

    /// The state of the machine `duration` (s) after `state`, under `force`.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the duration is not positive or a number is not finite;
    /// [`SimulationError::NotFinite`], [`SimulationError::Exhausted`] and, for a spring that pushes away where the
    /// machine is, [`SimulationError::OutOfRange`] like an engine. The stepper remains usable.
    pub fn step(&mut self, state: State<D>, force: Force<D>, duration: f64) -> Result<Stepped<D>, SimulationError> {
        ModelError::require_positive("duration of a step", duration, "s")?;
        ModelError::require_finite("position", state.position.value(), "m")?;
        ModelError::require_finite("velocity", state.velocity.value(), "m/s")?;
        ModelError::require_finite("force at the beginning of a step", force.begin.value(), "N")?;
        ModelError::require_finite("force at the end of a step", force.end.value(), "N")?;
        match &mut self.method {
            Method::ClosedForm(machine) => machine.step(state, force, duration),
            Method::Integration(trajectory) => {
                let slope = force.slope(duration);
                self.scenario.begin(state, force.begin, slope);
                let stepped = L::Family::visit(Integration { scenario: &self.scenario, trajectory, duration })?;
                let holds = trajectory.events().first().is_some_and(|start| start.next == Mode::Stick);
                if !holds || (0..D::DIRECTIONS).all(|direction| state.velocity.partial(direction) == 0.0) {
                    return Ok(stepped);
                }
                // A push ends before the static level is reached, and leaves nothing.
                self.scenario.begin(State { velocity: D::from(0.0), ..state }, force.begin, slope);
                L::Family::visit(Integration { scenario: &self.scenario, trajectory, duration })
            }
        }
    }

    /// The machine.
    pub fn oscillator(&self) -> &Oscillator<D> {
        self.scenario.oscillator()
    }

    /// The contact's law.
    pub fn law(&self) -> &L {
        self.scenario.law()
    }

    /// N, normal load (N).
    pub fn normal_load(&self) -> D {
        self.scenario.normal_load()
    }
}

const PAST: &str = "a law with internal state: follow it by FeedForward, or simulate it by the Bristle engine";

/// Chooses the method for a law of its kind.
struct Choice<'a, D: Scalar, L>(&'a Scenario<D, L>);

impl<D: Scalar, L> LawVisitor<D, L> for Choice<'_, D, L> {
    type Output = Result<Method<D>, SimulationError>;

    fn sliding(self) -> Self::Output
    where
        L: SlidingLaw<D>,
    {
        Ok(Method::Integration(Box::default()))
    }

    fn piecewise_linear(self) -> Self::Output
    where
        L: PiecewiseLinearLaw<D> + SlidingLaw<D>,
    {
        let Self(scenario) = self;
        let friction = scenario.law().affine();
        if let Some(losing) = scenario.law().affine_losing_speed() {
            if losing.level.value() > friction.level.value() || losing.slope.value() > friction.slope.value() {
                let what = "a law whose level is higher while the speed falls, as its branch depends on the past";
                return Err(SimulationError::NotSupported { engine: "stepping", what });
            }
            return self.sliding();
        }
        if !scenario.oscillator().is_linear() {
            return self.sliding();
        }
        Ok(Method::ClosedForm(ClosedForm::new(scenario.oscillator(), friction, scenario.normal_load())))
    }

    fn bristle(self) -> Self::Output
    where
        L: BristleLaw<D>,
    {
        Err(SimulationError::NotSupported { engine: "stepping", what: PAST })
    }
}

/// A step by the engine that integrates.
struct Integration<'a, D: Scalar, L> {
    scenario: &'a Scenario<D, L>,
    trajectory: &'a mut Trajectory<D>,
    duration: f64,
}

impl<D: Scalar, L> LawVisitor<D, L> for Integration<'_, D, L> {
    type Output = Result<Stepped<D>, SimulationError>;

    fn sliding(self) -> Self::Output
    where
        L: SlidingLaw<D>,
    {
        let Self { scenario, trajectory, duration } = self;
        let scenario: &Scenario<D, dyn SlidingLaw<D> + '_> = scenario;
        RungeKutta::default().run_into(scenario, &Sampling::one(duration), trajectory)?;
        let state = State { position: trajectory.position().get(0), velocity: trajectory.velocity().get(0) };
        let mode = trajectory.events().last().map_or(Mode::Stick, |event| event.next);
        Ok(Stepped { state, mode, events: trajectory.events().len() - 1 })
    }

    fn bristle(self) -> Self::Output
    where
        L: BristleLaw<D>,
    {
        Err(SimulationError::NotSupported { engine: "stepping", what: PAST })
    }
}
