//! Recorder of a run: it writes samples, events and work into a trajectory.

use fmm_model::Scalar;

use crate::error::SimulationError;
use crate::scenario::{Event, Sampling, State};
use crate::trajectory::work::PIECE_BUDGET;
use crate::trajectory::{Power, Trajectory, Work};

/// Greatest number of events in one run; no record resolves more.
pub(crate) const EVENT_BUDGET: usize = 1_000_000;

/// Samples written in one go from one polynomial.
const LONGEST_RUN: usize = 1 << 16;

/// A trajectory in the making.
pub(crate) struct Recorder<'a, D> {
    pub(crate) sampling: &'a Sampling,
    pub(crate) trajectory: &'a mut Trajectory<D>,
    /// Samples written so far.
    pub(crate) written: usize,
    work: Work<D>,
    /// Samples whose work is written.
    worked: usize,
    /// Pieces of time over which work may still be added up.
    pieces: usize,
}

impl<'a, D: Scalar> Recorder<'a, D> {
    pub(crate) fn new(
        engine: &'static str,
        states: usize,
        sampling: &'a Sampling,
        trajectory: &'a mut Trajectory<D>,
    ) -> Result<Self, SimulationError> {
        trajectory.reset(engine, states, true, sampling)?;
        Ok(Self { sampling, trajectory, written: 0, work: Work::none(), worked: 0, pieces: PIECE_BUDGET })
    }

    /// Adds an event.
    ///
    /// Inline, like a free half cycle of the exact engine: the copy of an event took 4 % of a ring-down in either
    /// place.
    #[inline]
    pub(crate) fn push(&mut self, event: Event<D>) -> Result<(), SimulationError> {
        let finite = event.time.value().is_finite()
            && event.position.value().is_finite()
            && event.velocity.value().is_finite()
            && event.load.is_finite();
        if !finite {
            return Err(SimulationError::NotFinite { time: event.time.value() });
        }
        if self.trajectory.events().len() >= EVENT_BUDGET {
            return Err(SimulationError::event_budget(EVENT_BUDGET, self.sampling.end()));
        }
        self.trajectory.events.push(event);
        Ok(())
    }

    /// Writes the samples before `end`, `state` giving the state at a sample's time.
    pub(crate) fn samples(&mut self, end: f64, mut state: impl FnMut(f64) -> State<D>) -> Result<(), SimulationError> {
        self.samples_with_states(end, &mut [], |time, _| state(time))
    }

    /// Writes the samples before `end`, `state` giving the state at a sample's time and, from the third entry of
    /// `unknowns` on, the internal states.
    pub(crate) fn samples_with_states(
        &mut self,
        end: f64,
        unknowns: &mut [D],
        mut state: impl FnMut(f64, &mut [D]) -> State<D>,
    ) -> Result<(), SimulationError> {
        let stop = self.sampling.index_at_or_after(end);
        let channels = self.sampling.channels();
        while self.written < stop {
            let time = self.sampling.time(self.written);
            let State { position, velocity } = state(time, unknowns);
            if !(position.value().is_finite() && velocity.value().is_finite()) {
                return Err(SimulationError::NotFinite { time });
            }
            self.trajectory.set(self.written, channels, position, velocity);
            for (index, unknown) in unknowns.iter().skip(2).enumerate() {
                self.trajectory.states[index].set(self.written, *unknown);
            }
            self.written += 1;
        }
        Ok(())
    }

    /// Writes the accelerations of the samples from `first` to the last that is written, `of` giving that at a sample's
    /// time and state.
    pub(crate) fn accelerations(
        &mut self,
        first: usize,
        mut of: impl FnMut(f64, State<D>) -> D,
    ) -> Result<(), SimulationError> {
        let of = |time: f64, unknowns: &[D]| of(time, State { position: unknowns[0], velocity: unknowns[1] });
        self.accelerations_with_states(first, &mut [D::from(0.0); 2], of)
    }

    /// Like [`accelerations`](Self::accelerations), with internal states; `unknowns` is room for position, velocity and
    /// the states that `of` needs.
    pub(crate) fn accelerations_with_states(
        &mut self,
        first: usize,
        unknowns: &mut [D],
        mut of: impl FnMut(f64, &[D]) -> D,
    ) -> Result<(), SimulationError> {
        if !self.sampling.channels().acceleration() {
            return Ok(());
        }
        for index in first..self.written {
            let motion = [self.trajectory.position(), self.trajectory.velocity()];
            for (unknown, samples) in unknowns.iter_mut().zip(motion.into_iter().chain(self.trajectory.states())) {
                *unknown = samples.get(index);
            }
            let time = self.sampling.time(index);
            let acceleration = of(time, unknowns);
            if !acceleration.value().is_finite() {
                return Err(SimulationError::NotFinite { time });
            }
            self.trajectory.acceleration.set(index, acceleration);
        }
        Ok(())
    }

    /// Writes rest at `position` into the samples before `end`.
    pub(crate) fn hold(&mut self, end: f64, position: D) {
        let range = self.written..self.sampling.index_at_or_after(end).max(self.written);
        let channels = self.sampling.channels();
        if channels.position() {
            self.trajectory.position.fill(range.clone(), position);
        }
        if channels.velocity() {
            self.trajectory.velocity.fill(range.clone(), D::from(0.0));
        }
        let first = self.written;
        self.written = range.end;
        self.at_constant_speed(first);
    }

    /// Writes the samples before `end` of a motion at this `velocity`; `position` gives the position at a time.
    pub(crate) fn constant_velocity(
        &mut self,
        end: f64,
        velocity: D,
        mut position: impl FnMut(f64) -> D,
    ) -> Result<(), SimulationError> {
        let first = self.written;
        self.samples(end, |time| State { position: position(time), velocity })?;
        self.at_constant_speed(first);
        Ok(())
    }

    /// Writes an acceleration of zero into the samples from `first` to the last that is written.
    pub(crate) fn at_constant_speed(&mut self, first: usize) {
        if self.sampling.channels().acceleration() {
            self.trajectory.acceleration.fill(first..self.written, D::from(0.0));
        }
    }

    /// True if there are samples left before `end`.
    pub(crate) fn has_samples_before(&self, end: f64) -> bool {
        self.written < self.sampling.count() && self.sampling.time(self.written) < end
    }

    /// Writes the derivatives anew of the samples from `first` to the last that is written, `state` giving the state at
    /// a sample's time.
    pub(crate) fn partials(&mut self, first: usize, mut state: impl FnMut(f64) -> State<D>) {
        let channels = self.sampling.channels();
        for index in first..self.written {
            let State { position, velocity } = state(self.sampling.time(index));
            if channels.position() {
                self.trajectory.position.set_partials(index, position);
            }
            if channels.velocity() {
                self.trajectory.velocity.set_partials(index, velocity);
            }
        }
    }

    /// Writes the samples before `end`: polynomials in the time since `origin` in units of `unit` (s), `of` giving the
    /// coefficients for position, velocity and, from 2 on, the internal states.
    pub(crate) fn polynomials<const N: usize>(
        &mut self,
        end: f64,
        origin: f64,
        unit: f64,
        of: impl Fn(usize) -> [D; N],
    ) -> Result<(), SimulationError> {
        let stop = self.sampling.index_at_or_after(end);
        if stop <= self.written {
            return Ok(());
        }
        let sampling = self.sampling;
        let per_unit = 1.0 / unit;
        let polynomials: [[D; N]; 2] = [of(0), of(1)];
        for index in [self.written, stop - 1] {
            let theta = (sampling.time(index) - origin) * per_unit;
            let at = |polynomial: &[D; N]| polynomial.iter().rev().fold(0.0, |sum, c| sum * theta + c.value());
            if !polynomials.iter().all(|polynomial| at(polynomial).is_finite()) {
                return Err(SimulationError::NotFinite { time: sampling.time(index) });
            }
        }
        let states = self.trajectory.states().len();
        while self.written < stop {
            let range = self.written..stop.min(self.written + LONGEST_RUN);
            let start = range.start;
            if let Some(interval) = sampling.interval() {
                let first = (sampling.first() + start) as f64;
                let theta = |index: u32| ((first + f64::from(index)) * interval - origin) * per_unit;
                self.write_polynomials(range.clone(), states, &of, theta);
            } else {
                let theta = |index: u32| (sampling.time(start + index as usize) - origin) * per_unit;
                self.write_polynomials(range.clone(), states, &of, theta);
            }
            self.written = range.end;
        }
        Ok(())
    }

    fn write_polynomials<const N: usize>(
        &mut self,
        range: std::ops::Range<usize>,
        states: usize,
        of: impl Fn(usize) -> [D; N],
        theta: impl Fn(u32) -> f64,
    ) {
        let channels = self.sampling.channels();
        if channels.position() {
            self.trajectory.position.polynomial(range.clone(), &of(0), &theta);
        }
        if channels.velocity() {
            self.trajectory.velocity.polynomial(range.clone(), &of(1), &theta);
        }
        for state in 0..states {
            self.trajectory.states[state].polynomial(range.clone(), &of(2 + state), &theta);
        }
    }

    /// Adds the work of a contact that takes its `relative` velocity (m/s) from a body of this `mass` (kg) at once,
    /// beside a counterface of velocity `belt` (m/s): the impulse is that of friction.
    pub(crate) fn catch(&mut self, mass: D, relative: D, belt: D) {
        self.work.friction += mass * relative * relative * 0.5;
        self.work.external -= mass * relative * belt;
    }

    /// Adds the work done from `begin` to `end`, of which the samples at or after `begin` and before `end` get their
    /// part; `power` gives the power at a time, which must be smooth and vary little within `scale` (s).
    pub(crate) fn work(
        &mut self,
        begin: f64,
        end: f64,
        scale: f64,
        mut power: impl FnMut(f64) -> Power<D>,
    ) -> Result<(), SimulationError> {
        if !self.sampling.wants_work() {
            return Ok(());
        }
        let end = end.min(self.sampling.end());
        let mut from = begin;
        let stop = self.sampling.index_at_or_after(end);
        while self.worked < stop {
            let time = self.sampling.time(self.worked).max(begin);
            self.work.add(from, time, scale, &mut self.pieces, &mut power)?;
            self.trajectory.set_work(self.worked, &self.work);
            from = from.max(time);
            self.worked += 1;
        }
        self.work.add(from, end, scale, &mut self.pieces, &mut power)?;
        // The last sample is at the end itself.
        if end == self.sampling.end() {
            while self.worked < self.sampling.count() {
                self.trajectory.set_work(self.worked, &self.work);
                self.worked += 1;
            }
        }
        // A work that is infinite stays infinite.
        if self.work.is_finite() { Ok(()) } else { Err(SimulationError::NotFinite { time: end }) }
    }
}
