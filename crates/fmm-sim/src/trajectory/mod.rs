//! Engines, and the result of every engine: samples and events.

pub(crate) mod recorder;
mod samples;
mod work;

use fmm_model::Scalar;

use crate::error::SimulationError;
use crate::scenario::{Channels, Direction, Event, EventKind, Mode, Sampling, Scenario};

pub(crate) use recorder::Recorder;
pub use samples::Samples;
pub(crate) use work::Power;
pub use work::{Energy, Work};

/// A way to simulate a scenario whose contact obeys a law of type `L`, at number type `D`.
///
/// The bounds of an implementation state the laws that an engine takes; nothing is decided at run time. An
/// implementor promises:
///
/// 1. every sample asked for is written, and a sample at the time of an event holds the state after it;
/// 2. events are in order of time, begin with [`Start`](crate::EventKind::Start), and end with the last one
///    before or at the last sample;
/// 3. at a dual number the derivatives include those of the event times;
/// 4. the result depends on the arguments only, and all its numbers are finite.
pub trait Engine<D: Scalar, L: ?Sized> {
    /// Simulates `scenario` into `trajectory`, whose memory is used again.
    ///
    /// # Errors
    /// [`SimulationError`] if the engine has no answer for this scenario; `trajectory` is then unspecified.
    fn run_into(
        &self,
        scenario: &Scenario<D, L>,
        sampling: &Sampling,
        trajectory: &mut Trajectory<D>,
    ) -> Result<(), SimulationError>;

    /// Simulates `scenario` into a trajectory of its own.
    ///
    /// # Errors
    /// [`SimulationError`] in the cases of [`run_into`](Self::run_into).
    fn run(&self, scenario: &Scenario<D, L>, sampling: &Sampling) -> Result<Trajectory<D>, SimulationError> {
        let mut trajectory = Trajectory::new();
        self.run_into(scenario, sampling, &mut trajectory)?;
        Ok(trajectory)
    }
}

/// A simulated motion: sampled position, velocity and acceleration, and the events that shaped it.
///
/// Samples at the time of an event hold the state right after it. At a dual number `D` all samples and events
/// carry their exact partial derivatives, the change of event times included.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory<D = f64> {
    pub(crate) position: Samples<D>,
    pub(crate) velocity: Samples<D>,
    pub(crate) acceleration: Samples<D>,
    pub(crate) events: Vec<Event<D>>,
    pub(crate) states: Vec<Samples<D>>,
    work: [Samples<D>; 3],
    engine: &'static str,
    /// True if the contact, which holds at the last sample, holds for good.
    pub(crate) rests: bool,
    sampling: Option<Sampling>,
}

impl<D: Scalar> Default for Trajectory<D> {
    fn default() -> Self {
        Self::new()
    }
}

impl<D: Scalar> Trajectory<D> {
    /// An empty trajectory, to be filled and refilled by [`Engine::run_into`](crate::Engine::run_into).
    pub const fn new() -> Self {
        Self {
            position: Samples::new(),
            velocity: Samples::new(),
            acceleration: Samples::new(),
            events: Vec::new(),
            states: Vec::new(),
            work: [Samples::new(), Samples::new(), Samples::new()],
            engine: "",
            rests: false,
            sampling: None,
        }
    }

    /// Clears the trajectory and makes room for the samples asked for, for the work only if the engine records `work`.
    ///
    /// # Errors
    /// [`SimulationError::Exhausted`] if there is no such room.
    pub(crate) fn reset(
        &mut self,
        engine: &'static str,
        states: usize,
        work: bool,
        sampling: &Sampling,
    ) -> Result<(), SimulationError> {
        self.engine = engine;
        self.rests = false;
        self.sampling = Some(sampling.clone());
        let count = |wanted: bool| if wanted { sampling.count() } else { 0 };
        self.position.reset(count(sampling.channels().position()))?;
        self.velocity.reset(count(sampling.channels().velocity()))?;
        self.acceleration.reset(count(sampling.channels().acceleration()))?;
        self.events.clear();
        self.states.resize_with(states, Samples::new);
        for state in &mut self.states {
            state.reset(sampling.count())?;
        }
        for samples in &mut self.work {
            samples.reset(count(work && sampling.wants_work()))?;
        }
        Ok(())
    }

    pub(crate) fn set_work(&mut self, index: usize, work: &Work<D>) {
        for (samples, value) in self.work.iter_mut().zip([work.friction, work.viscous, work.external]) {
            samples.set(index, value);
        }
    }

    /// Changes the direction of the events at `time` (s) that have begun the present half cycle to `direction`.
    pub(crate) fn redirect(&mut self, time: f64, direction: Direction) {
        for index in (0..self.events.len()).rev() {
            let before = index.checked_sub(1).map(|before| self.events[before].next);
            let event = &mut self.events[index];
            if event.time.value() != time || event.next == Mode::Stick {
                break;
            }
            event.next = Mode::Slip(direction);
            match event.kind {
                EventKind::Yield(_) => {}
                EventKind::Reversal => {
                    event.grazing |= before == Some(event.next);
                    break;
                }
                _ => break,
            }
        }
    }

    /// Writes the accelerations `constant` + `per_position` x + `per_velocity` x′ at every index of `range`.
    pub(crate) fn accelerate(&mut self, range: std::ops::Range<usize>, constant: D, per_position: D, per_velocity: D) {
        let terms = [(&self.position, per_position), (&self.velocity, per_velocity)];
        self.acceleration.combine(range, constant, terms);
    }

    /// Writes the state at sample `index` into the channels that are kept.
    pub(crate) fn set(&mut self, index: usize, channels: Channels, position: D, velocity: D) {
        if channels.position() {
            self.position.set(index, position);
        }
        if channels.velocity() {
            self.velocity.set(index, velocity);
        }
    }

    /// Time of each sample (s).
    pub fn times(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        let sampling = self.sampling.as_ref();
        (0..sampling.map_or(0, Sampling::count)).map(move |index| sampling.map_or(0.0, |sampling| sampling.time(index)))
    }

    /// Sampled position (m); empty if it was not asked for.
    pub const fn position(&self) -> &Samples<D> {
        &self.position
    }

    /// Sampled velocity (m/s); empty if it was not asked for.
    pub const fn velocity(&self) -> &Samples<D> {
        &self.velocity
    }

    /// Sampled acceleration (m/s²), the time derivative of the velocity; empty unless [`Channels::All`] asked for it.
    ///
    /// It is the equation of motion at the sampled position and velocity, or its closed form. It jumps with
    /// friction: a sample at the time of such an event holds the value after it, and a derivative is that of the smooth
    /// piece on which the sample lies. While the contact sticks it is zero.
    ///
    /// An accelerometer on a machine whose base shakes ([`Excitation::base`](crate::Excitation::base)) feels the
    /// acceleration of the base as well; this one is relative to the base, as position and velocity are.
    pub const fn acceleration(&self) -> &Samples<D> {
        &self.acceleration
    }

    /// Sampled internal states of a bristle law, in the law's order; `None` for other laws.
    pub fn states(&self) -> &[Samples<D>] {
        &self.states
    }

    /// Work done up to sample `index` (J); `None` without [`Sampling::with_work`], and for the methods of fixed step,
    /// which do not record it.
    pub fn work(&self, index: usize) -> Option<Work> {
        let [friction, viscous, external] = &self.work;
        let at = |samples: &Samples<D>| samples.values().get(index).copied();
        Some(Work { friction: at(friction)?, viscous: at(viscous)?, external: at(external)? })
    }

    /// Name of the engine that made it.
    pub const fn engine(&self) -> &'static str {
        self.engine
    }

    /// The events up to the last sample, in order; the first is the start.
    pub fn events(&self) -> &[Event<D>] {
        &self.events
    }

    /// The event with which the motion ended for good, if it ended before the last sample.
    ///
    /// A contact that holds on a moving counterface is not at rest, nor is one that the force will break away after the
    /// last sample. Several waves of different frequencies count by the sum of their amplitudes.
    pub fn rest(&self) -> Option<&Event<D>> {
        self.events.last().filter(|event| self.rests && event.next == Mode::Stick)
    }

    /// Number of times that the velocity reached zero.
    pub fn half_cycles(&self) -> usize {
        self.events.iter().filter(|event| matches!(event.kind, EventKind::Reversal | EventKind::Stop)).count()
    }
}
