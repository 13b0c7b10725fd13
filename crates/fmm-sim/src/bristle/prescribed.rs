//! Friction along a prescribed motion: hysteresis loops, and force at constant velocity.

use fmm_friction::{BristleLaw, Regime};
use fmm_model::{ModelError, Oscillator, Scalar};

use crate::bristle::field::{Field, require_odd};
use crate::bristle::run::Run;
use crate::error::SimulationError;
use crate::mechanics::Piece;
use crate::scenario::{Direction, Sampling, State};
use crate::trajectory::{Recorder, Trajectory};

/// Friction at one point of a prescribed motion.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionPoint<D = f64> {
    /// Position (m).
    pub position: D,
    /// Friction force (N) on arrival there, positive if it opposes a motion towards greater positions.
    pub force: D,
    /// States of the law, in its order and units.
    pub states: Vec<D>,
}

/// A prescribed motion, at any force.
#[derive(Debug, Clone, PartialEq)]
pub struct PrescribedMotion<D = f64> {
    pub(crate) first: Option<D>,
    pub(crate) segments: Vec<Segment<D>>,
}

/// Segment from one point of the motion to the next: the acceleration grows in proportion to time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Segment<D> {
    pub(crate) duration: D,
    pub(crate) begin: State<D>,
    pub(crate) end: State<D>,
    /// Acceleration at the beginning (m/s²) and its slope (m/s³).
    pub(crate) acceleration: D,
    pub(crate) jerk: D,
}

impl<D: Scalar> PrescribedMotion<D> {
    /// Straight lines from each of `positions` (m) to the next at constant `speed` (m/s); the velocity jumps where the
    /// direction changes.
    ///
    /// # Errors
    /// [`SimulationError::Quantity`] if the speed is not positive or a number not finite.
    pub fn at_speed(positions: &[D], speed: D) -> Result<Self, SimulationError> {
        ModelError::require_positive("speed", speed.value(), "m/s")?;
        for position in positions {
            ModelError::require_finite("position", position.value(), "m")?;
        }
        let zero = D::from(0.0);
        let segment = |pair: &[D]| {
            let displacement = pair[1] - pair[0];
            let sign = if displacement.value() < 0.0 { -1.0 } else { 1.0 };
            let moves = displacement.value() != 0.0;
            let velocity = if moves { speed * sign } else { zero };
            Segment {
                duration: if moves { displacement * sign / speed } else { zero },
                begin: State { position: pair[0], velocity },
                end: State { position: pair[1], velocity },
                acceleration: zero,
                jerk: zero,
            }
        };
        Ok(Self { first: positions.first().copied(), segments: positions.windows(2).map(segment).collect() })
    }

    /// Straight lines through `positions` (m) at `times` (s), at constant velocity between each two of them: a motion
    /// of which only positions were measured.
    ///
    /// ```
    /// use fmm_friction::Dahl;
    /// use fmm_sim::{PrescribedMotion, friction_along};
    ///
    /// // Force (N) at 10 N and µ = 0.3 after 2 µm, where bristles of 0.1 per µm have given way to 3 µm (1 − e^(−2/3)).
    /// let motion = PrescribedMotion::lines(&[0.0, 1.0, 3.0], &[0.0, 2e-6, -2e-6])?;
    /// let points = friction_along(&Dahl::new(0.3, 1e5, 1.0)?, 10.0, &motion)?;
    /// assert!((points[1].force - 3.0 * (1.0 - f64::exp(-2.0 / 3.0))).abs() < 1e-12);
    /// assert!(points[2].force < 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SimulationError::OutOfRange`] if the times do not ascend from 0, two are equal, or there are not as many as
    /// positions, [`SimulationError::Quantity`] if a number is not finite.
    pub fn lines(times: &[D], positions: &[D]) -> Result<Self, SimulationError> {
        require_times(times, positions.len())?;
        for position in positions {
            ModelError::require_finite("position", position.value(), "m")?;
        }
        let mut segments = Vec::with_capacity(times.len().saturating_sub(1));
        for (index, (times, positions)) in times.windows(2).zip(positions.windows(2)).enumerate() {
            let (duration, zero) = (times[1] - times[0], D::from(0.0));
            if duration.value() == 0.0 {
                return Err(SimulationError::times(index + 1, times[1].value(), times[0].value()));
            }
            let velocity = (positions[1] - positions[0]) / duration;
            ModelError::require_finite("velocity", velocity.value(), "m/s")?;
            let [begin, end] = [0, 1].map(|at| State { position: positions[at], velocity });
            segments.push(Segment { duration, begin, end, acceleration: zero, jerk: zero });
        }
        Ok(Self { first: positions.first().copied(), segments })
    }

    /// A motion through `states` (m, m/s) at `times` (s): the cubic between each two of them that has their positions
    /// and velocities. Between samples h (s) apart of a smooth motion it is off by up to h⁴/384 times the fourth
    /// derivative. Two states at the same time make the velocity jump.
    ///
    /// ```
    /// use fmm_friction::LuGre;
    /// use fmm_sim::{PrescribedMotion, State, friction_along};
    ///
    /// // One cycle of 1 mm at 1 Hz, in 200 steps.
    /// let times: Vec<f64> = (0..=200).map(|i| f64::from(i) / 200.0).collect();
    /// let turn = std::f64::consts::TAU;
    /// let state = |t: &f64| State { position: 1e-3 * (turn * t).sin(), velocity: 1e-3 * turn * (turn * t).cos() };
    /// let states: Vec<_> = times.iter().map(state).collect();
    /// let law = LuGre::new(0.2, 0.25, 1e-3, 2.0, 1e5, 300.0, 0.1)?;
    /// let points = friction_along(&law, 10.0, &PrescribedMotion::through(&times, &states)?)?;
    /// // On the way back, at full speed, friction of steady sliding acts the other way: 2 N and σ₂ v N = 6.3 mN.
    /// assert!((points[100].force + 2.006_283).abs() < 1e-5, "{} N", points[100].force);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SimulationError::OutOfRange`] if the times do not ascend from 0 or there are not as many as states,
    /// [`SimulationError::Quantity`] if a number is not finite or the position jumps.
    pub fn through(times: &[D], states: &[State<D>]) -> Result<Self, SimulationError> {
        require_times(times, states.len())?;
        for State { position, velocity } in states {
            ModelError::require_finite("position", position.value(), "m")?;
            ModelError::require_finite("velocity", velocity.value(), "m/s")?;
        }
        let mut segments = Vec::with_capacity(times.len().saturating_sub(1));
        for (times, states) in times.windows(2).zip(states.windows(2)) {
            let (duration, [begin, end]) = (times[1] - times[0], [states[0], states[1]]);
            let rise = end.position - begin.position;
            let zero = D::from(0.0);
            let (mut acceleration, mut jerk) = (zero, zero);
            if duration.value() > 0.0 {
                // x = x₀ + v₀ τ + a τ²/2 + j τ³/6 with the position and velocity of the end at its time.
                let lack = rise - begin.velocity * duration;
                let gain = end.velocity - begin.velocity;
                acceleration = (lack * 3.0 - gain * duration) * 2.0 / (duration * duration);
                jerk = (gain * duration - lack * 2.0) * 6.0 / (duration * duration * duration);
            } else if rise.value() != 0.0 {
                ModelError::require_finite("velocity of a jump", f64::INFINITY, "m/s")?;
            }
            ModelError::require_finite("acceleration", acceleration.value(), "m/s²")?;
            ModelError::require_finite("jerk", jerk.value(), "m/s³")?;
            segments.push(Segment { duration, begin, end, acceleration, jerk });
        }
        Ok(Self { first: states.first().map(|state| state.position), segments })
    }
}

/// Checks that `times` ascend from 0, and are as many as there are points.
fn require_times<D: Scalar>(times: &[D], points: usize) -> Result<(), SimulationError> {
    let mut before = 0.0;
    for (index, time) in times.iter().map(|time| time.value()).enumerate() {
        if !(time.is_finite() && time >= before) || index >= points {
            return Err(SimulationError::times(index, time, before));
        }
        before = time;
    }
    if points > times.len() {
        return Err(SimulationError::times(times.len(), f64::NAN, before));
    }
    Ok(())
}

/// Friction of a `law` with internal state under `normal_load` (N) along a `motion`: one entry for each of its points.
/// Bristles are not deflected at the first.
///
/// Laws such as [`Dahl`](fmm_friction::Dahl), [`BoucWen`](fmm_friction::BoucWen) and
/// [`MaxwellSlip`](fmm_friction::MaxwellSlip) depend on the positions only, so that any speed gives the quasi-static
/// loop. At constant velocity the laws that can ([`BristleLaw::carry`]) are followed in closed form. Forces
/// and states are good to about 1e-12; at a dual number they have their derivatives, those in positions, velocities and
/// times included.
///
/// ```
/// use fmm_friction::Dahl;
/// use fmm_sim::{PrescribedMotion, friction_along};
///
/// // Out and back: on the way out F = μ N (1 − exp(−σ x/μ)), and at the end of the way back the loop is open.
/// let motion = PrescribedMotion::at_speed(&[0.0, 2e-5, 0.0], 1e-3)?;
/// let points = friction_along(&Dahl::new(0.25, 1e4, 1.0)?, 7.0, &motion)?;
/// assert!((points[1].force - 1.75 * (1.0 - (-0.8f64).exp())).abs() < 1e-12);
/// assert!(points[2].force < -0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SimulationError::Quantity`] if the load is negative or not finite, and the errors of an integration by
/// [`Bristle`](crate::Bristle).
pub fn friction_along<D: Scalar, L: BristleLaw<D> + ?Sized>(
    law: &L,
    normal_load: D,
    motion: &PrescribedMotion<D>,
) -> Result<Vec<FrictionPoint<D>>, SimulationError> {
    friction_from(law, normal_load, motion, &vec![D::from(0.0); law.states()])
}

/// Like [`friction_along`], with bristles that have these `states` at the first point, each within its
/// [bound](BristleLaw::bound).
///
/// ```
/// use fmm_friction::Dahl;
/// use fmm_sim::{PrescribedMotion, friction_from};
///
/// // Bristles of 0.1 per µm that have given way to 3 N keep it.
/// let motion = PrescribedMotion::at_speed(&[0.0, 2e-6], 1e-6)?;
/// let points = friction_from(&Dahl::new(0.3, 1e5, 1.0)?, 10.0, &motion, &[3e-6])?;
/// assert!((points[0].force - 3.0).abs() < 1e-12 && (points[1].force - 3.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of [`friction_along`], and [`SimulationError::OutOfRange`] for a state beyond its bound, or another number of
/// states than the law has.
pub fn friction_from<D: Scalar, L: BristleLaw<D> + ?Sized>(
    law: &L,
    normal_load: D,
    motion: &PrescribedMotion<D>,
    states: &[D],
) -> Result<Vec<FrictionPoint<D>>, SimulationError> {
    ModelError::require_not_negative("normal load", normal_load.value(), "N")?;
    for index in 0..states.len().max(law.states()) {
        let bound = if index < law.states() { law.bound(index).value() } else { 0.0 };
        let state = states.get(index).map_or(f64::NAN, |state| state.value());
        if !(state.abs() <= bound) || index >= law.states() {
            return Err(SimulationError::deflection(index, state, bound));
        }
    }
    let mut points = Vec::with_capacity(motion.segments.len() + 1);
    let mut positions = motion.first.into_iter().chain(motion.segments.iter().map(|segment| segment.end.position));
    follow(law, normal_load, motion, states, |force, states| {
        points.extend(positions.next().map(|position| FrictionPoint { position, force, states: states.to_vec() }));
    })?;
    Ok(points)
}

/// Relative tolerance (1): well below the accuracy of any measurement, and well above rounding.
const TOLERANCE: f64 = 1e-13;

/// Follows `motion` from these `states` and gives `visit` the force and the states at each of its points.
fn follow<D: Scalar, L: BristleLaw<D> + ?Sized>(
    law: &L,
    normal_load: D,
    motion: &PrescribedMotion<D>,
    states: &[D],
    mut visit: impl FnMut(D, &[D]),
) -> Result<(), SimulationError> {
    require_odd(law)?;
    let zero = D::from(0.0);
    // A machine of unit mass that the motion accelerates.
    let oscillator = Oscillator::new(D::from(1.0), D::from(1.0))?;
    let mut field = Field::new(&oscillator, law, normal_load, zero);
    field.guided = true;
    let mut scratch = Trajectory::new();
    // Nothing is sampled; the recorder counts the events.
    let sampling = Sampling::at([f64::MAX])?;
    let recorder = Recorder::new("bristle", law.states(), &sampling, &mut scratch)?;
    let Some(first) = motion.first else { return Ok(()) };
    let mut begin = vec![zero; field.size()];
    begin[0] = first;
    begin[2..].copy_from_slice(states);
    let mut run = Run::new(field, begin, TOLERANCE, recorder);
    let (mut before, mut rates) = (0.0, vec![zero; law.states()]);
    law.rate(zero, states, Regime::ALL_HOLD, &mut rates);
    visit(normal_load * law.coefficient(zero, states, &rates), &run.step.begin[2..]);
    for segment in &motion.segments {
        let duration = segment.duration.value();
        let piece = Piece::line_from_zero(segment.acceleration, segment.jerk);
        run.time = 0.0;
        run.step.begin[0] = segment.begin.position;
        run.step.begin[1] = segment.begin.velocity;
        let velocity = segment.begin.velocity.value();
        let is_uniform = segment.acceleration.value() == 0.0 && segment.jerk.value() == 0.0 && velocity != 0.0;
        if is_uniform && law.carry(segment.begin.velocity, segment.duration, &mut run.step.begin[2..]) {
            let states = &run.step.begin[2..];
            law.rate(segment.end.velocity, states, Regime::ALL_HOLD, &mut rates);
            let force = normal_load * law.coefficient(segment.end.velocity, states, &rates);
            if !force.value().is_finite() {
                return Err(SimulationError::NotFinite { time: duration });
            }
            visit(force, states);
            // The next segment begins anew.
            before = 0.0;
            continue;
        }
        if velocity == 0.0 || velocity * before <= 0.0 {
            // From rest the acceleration decides the direction.
            let direction = if velocity == 0.0 { run.departure(&piece) } else { Some(Direction::of(velocity)) };
            run.go(direction);
        } else {
            run.collocation.forget();
        }
        while run.time < duration && !run.resting {
            run.advance(&piece, duration)?;
        }
        // The steps end after a number of seconds; the end of the segment has derivatives.
        let force = piece.force(duration);
        run.field.rates(force, run.branch, &run.step.begin, &mut run.before);
        for (y, rate) in run.step.begin.iter_mut().zip(&run.before) {
            *y += *rate * (segment.duration - duration);
        }
        before = if duration > 0.0 { run.branch.direction.sign() * f64::from(u8::from(!run.resting)) } else { before };
        let force = run.field.friction(run.branch, &run.step.begin);
        if !force.value().is_finite() {
            return Err(SimulationError::NotFinite { time: run.time });
        }
        visit(force, &run.step.begin[2..]);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmm_friction::{GmsOf, LawFamily};
    use fmm_model::Dual;

    /// Elements that slide steadily do not show their approach to the curve, but their derivatives do: these decay
    /// within milliseconds here, and steps of a second would let them grow.
    #[test]
    fn derivatives_of_a_steady_slide_stay_constant() {
        let values = [0.2, 0.3, 0.02, 2.0, 0.1, 20.0, 6000.0, 800.0, 0.5];
        let at = |direction: usize| {
            let law: Vec<Dual<1>> =
                values.iter().enumerate().map(|(j, value)| Dual::variable(*value, j.wrapping_sub(direction))).collect();
            let times = [0.0, 20.0, 20.1].map(Dual::from);
            let motion = PrescribedMotion::lines(&times, &[0.0, 80.0, 80.4].map(Dual::from)).unwrap();
            let points = friction_along(&GmsOf::<2>::at(&law).unwrap(), Dual::from(3.0), &motion).unwrap();
            points[2].force
        };
        // F = N (μ_c + β v): the curve has fallen to its end.
        for (direction, slope) in [(0, 3.0), (1, 0.0), (4, 12.0), (5, 0.0), (6, 0.0), (8, 0.0)] {
            let force = at(direction);
            assert!((force.value() - 1.8).abs() < 1e-10, "{}", force.value());
            assert!((force.partial(0) - slope).abs() < 1e-8, "direction {direction}: {}", force.partial(0));
        }
    }
}
