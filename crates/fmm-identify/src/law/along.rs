//! Friction of a law along a motion that was measured.

use fmm_fit::EvaluationError;
use fmm_friction::{BristleLaw, LawFamily, LawVisitor, Regime, SlidingLaw};
use fmm_model::Scalar;
use fmm_sim::{PrescribedMotion, State, friction_from};

/// A motion that was measured: one value a sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct MeasuredMotion {
    /// s.
    pub(crate) times: Vec<f64>,
    /// m.
    pub(crate) positions: Vec<f64>,
    /// m/s.
    pub(crate) velocities: Vec<f64>,
    /// m/s².
    pub(crate) accelerations: Vec<f64>,
    /// Speed up to which the contact is taken to rest (m/s).
    pub(crate) rest_speed: f64,
}

/// A measured motion, seen some time earlier than the force.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Alignment<'a, D> {
    pub(crate) motion: &'a MeasuredMotion,
    /// Delay of the force behind the motion (s).
    pub(crate) delay: D,
    /// True with such a delay, known or to be found.
    pub(crate) has_delay: bool,
    /// Deflection of all bristles at the first sample, as a share of their bounds (1).
    pub(crate) deflection: D,
    /// The first sample that is compared; the others follow it.
    pub(crate) first: usize,
    /// One for each sample that is compared.
    pub(crate) locations: &'a [SampleLocation],
}

/// Place in the motion at which the force of a sample acted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SampleLocation {
    /// The sample before it, or at it.
    pub(crate) node: usize,
    /// True if the contact slides there for certain: it does not rest, nor turn before the next sample.
    pub(crate) slides: bool,
}

/// Friction of family `F` by these `values`.
pub(crate) fn along<F: LawFamily, D: Scalar>(
    values: &[D],
    alignment: Alignment<'_, D>,
    friction: &mut Vec<D>,
) -> Result<(), EvaluationError> {
    friction.clear();
    let law = F::at(values)?;
    F::visit(Following { law: &law, alignment, friction })
}

/// A way of so many largest deflections makes bristles slide.
const LONG: f64 = 20.0;
/// Share of the largest speed (1) at which they are made to, if the record begins at rest.
const SLOWEST: f64 = 1e-2;

impl MeasuredMotion {
    /// Largest speed (m/s).
    fn fastest(&self) -> f64 {
        self.velocities.iter().fold(f64::MIN_POSITIVE, |most, velocity| most.max(velocity.abs()))
    }
}

/// Places of the samples `rows` for a `delay` (s).
pub(crate) fn locations(
    motion: &MeasuredMotion,
    rows: std::ops::Range<usize>,
    delay: f64,
    locations: &mut Vec<SampleLocation>,
) {
    locations.clear();
    let (times, velocities) = (&motion.times, &motion.velocities);
    let mut node = 0;
    for row in rows {
        let time = times[row] - delay;
        while node + 2 < times.len() && times[node + 1] <= time {
            node += 1;
        }
        let elapsed = time - times[node];
        let [begin, end] = [velocities[node], velocities[node + 1]];
        let velocity = begin + (end - begin) * elapsed / (times[node + 1] - times[node]);
        let turns = elapsed > 0.0 && begin * end <= 0.0;
        let rests = velocity.abs() <= motion.rest_speed;
        locations.push(SampleLocation { node, slides: !turns && !rests });
    }
}

impl<D: Scalar> Alignment<'_, D> {
    /// The time (s) from the node of a location to the motion at sample `row`.
    pub(crate) fn elapsed(&self, row: usize, location: SampleLocation) -> D {
        D::from(self.motion.times[row] - self.motion.times[location.node]) - self.delay
    }

    /// Value of a measured `series` between two samples.
    #[inline]
    pub(crate) fn between(&self, series: &[f64], location: SampleLocation, elapsed: D) -> D {
        let (node, times) = (location.node, &self.motion.times);
        if !self.has_delay && elapsed.value() == 0.0 {
            return D::from(series[node]);
        }
        let slope = (series[node + 1] - series[node]) / (times[node + 1] - times[node]);
        D::from(series[node]) + elapsed * slope
    }

    /// Friction of a law without a closed form, which is followed from sample to sample; between them it is taken to be
    /// straight.
    fn stepped(&self, law: &dyn BristleLaw<D>, friction: &mut Vec<D>) -> Result<(), EvaluationError> {
        let MeasuredMotion { times, positions, .. } = self.motion;
        let at_rest = || vec![D::from(0.0); law.states()];
        let (mut path, mut first, mut approach) = (Vec::new(), at_rest(), 0.0);
        if law.states() == 1 {
            first[0] = law.bound(0) * self.deflection;
        } else {
            // Several bristles are at first as after a long way in the direction in which the record begins, as fast as
            // it begins.
            let mut slopes = at_rest();
            law.rate(D::from(1.0), &at_rest(), Regime::ALL_HOLD, &mut slopes);
            let lengths = slopes.iter().enumerate().map(|(index, slope)| law.bound(index).value() / slope.value());
            let way = lengths.fold(0.0, f64::max) * LONG;
            let speed = self.motion.velocities[0].abs().max(SLOWEST * self.motion.fastest());
            let direction = self.deflection.value().signum();
            approach = way / speed;
            path.push((0.0, (positions[0] - direction * way, direction * speed)));
            path.push((approach, (positions[0], direction * speed)));
        }
        let before = path.len();
        let since = |node: usize| approach + (times[node] - times[0]);
        for node in 0..times.len() - 1 {
            let segment = Segment::of(self.motion, node);
            path.push((since(node), (positions[node], segment.velocity)));
            let end = segment.velocity + segment.acceleration * segment.duration;
            path.push((since(node + 1), (positions[node + 1], end)));
        }
        let state =
            |(position, velocity): (f64, f64)| State { position: D::from(position), velocity: D::from(velocity) };
        let (since, states): (Vec<D>, Vec<_>) = path.into_iter().map(|(since, at)| (D::from(since), state(at))).unzip();
        let points = friction_from(law, D::from(1.0), &PrescribedMotion::through(&since, &states)?, &first)?;
        friction.clear();
        for (row, location) in (self.first..).zip(self.locations) {
            let node = location.node.min(times.len() - 2);
            let share = self.elapsed(row, SampleLocation { node, ..*location }) / (times[node + 1] - times[node]);
            let [begin, end] = [0, 1].map(|point| points[before + 2 * node + point].force);
            friction.push(begin + (end - begin) * share);
        }
        Ok(())
    }
}

/// The motion between two samples: the velocity changes in proportion to time, and what the positions differ by from
/// that is spread evenly.
struct Segment {
    duration: f64,
    /// Velocity at the beginning, with what is spread.
    velocity: f64,
    acceleration: f64,
    /// Time from the beginning to its turn (s), if it turns.
    turn: Option<f64>,
}

impl Segment {
    fn of(motion: &MeasuredMotion, node: usize) -> Self {
        let change = |series: &[f64]| series[node + 1] - series[node];
        let (duration, [begin, end]) = (change(&motion.times), [0, 1].map(|next| motion.velocities[node + next]));
        let velocity = change(&motion.positions) / duration - 0.5 * (end - begin);
        let acceleration = (end - begin) / duration;
        let turn = -velocity / acceleration;
        Self { duration, velocity, acceleration, turn: Some(turn).filter(|turn| *turn > 0.0 && *turn < duration) }
    }

    /// The mean velocity up to a time after the beginning.
    fn mean<D: Scalar>(&self, elapsed: D) -> D {
        D::from(self.velocity) + elapsed * (0.5 * self.acceleration)
    }

    /// Carries the state of a law through the first `elapsed` of it (s); whether the law has a closed form for that.
    fn carry<D: Scalar>(&self, law: &dyn BristleLaw<D>, elapsed: D, state: &mut [D]) -> bool {
        let go =
            |velocity: D, duration: D, state: &mut [D]| velocity.value() == 0.0 || law.carry(velocity, duration, state);
        match self.turn.filter(|turn| *turn < elapsed.value()) {
            None => go(self.mean(elapsed), elapsed, state),
            Some(turn) => {
                let turn = D::from(turn);
                // From the turn on it goes back from rest.
                go(self.mean(turn), turn, state)
                    && go((elapsed - turn) * (0.5 * self.acceleration), elapsed - turn, state)
            }
        }
    }
}

/// Friction of a `law` of the sliding speed.
pub(crate) fn along_sliding<D: Scalar>(law: &dyn SlidingLaw<D>, alignment: Alignment<'_, D>, friction: &mut Vec<D>) {
    friction.clear();
    let leaps = law.coefficient(D::from(0.0)).value() > 0.0;
    for (row, location) in (alignment.first..).zip(alignment.locations) {
        if leaps && !location.slides {
            friction.push(D::from(0.0));
            continue;
        }
        let elapsed = alignment.elapsed(row, *location);
        let velocity = alignment.between(&alignment.motion.velocities, *location, elapsed);
        let acceleration = alignment.between(&alignment.motion.accelerations, *location, elapsed);
        let losing = velocity.value() * acceleration.value() < 0.0;
        let speed = velocity.abs();
        let size = if losing { law.coefficient_losing_speed(speed) } else { law.coefficient(speed) };
        friction.push(if velocity.value() < 0.0 { -size } else { size });
    }
}

struct Following<'a, 'g, D, L> {
    law: &'a L,
    alignment: Alignment<'g, D>,
    friction: &'a mut Vec<D>,
}

impl<D: Scalar, L> LawVisitor<D, L> for Following<'_, '_, D, L> {
    type Output = Result<(), EvaluationError>;

    fn sliding(self) -> Self::Output
    where
        L: SlidingLaw<D>,
    {
        let Self { law, alignment, friction } = self;
        along_sliding(law, alignment, friction);
        Ok(())
    }

    fn bristle(self) -> Self::Output
    where
        L: BristleLaw<D>,
    {
        let Self { law, alignment, friction } = self;
        let mut state: Vec<D> = (0..law.states()).map(|index| law.bound(index) * alignment.deflection).collect();
        let (mut here, mut rate) = (state.clone(), state.clone());
        let mut at = 0;
        for (row, location) in (alignment.first..).zip(alignment.locations) {
            while at < location.node {
                let segment = Segment::of(alignment.motion, at);
                if !segment.carry(law, D::from(segment.duration), &mut state) {
                    return alignment.stepped(law, friction);
                }
                at += 1;
            }
            let elapsed = alignment.elapsed(row, *location);
            here.copy_from_slice(&state);
            // A delay has its derivative even where no time has passed.
            let is_later = alignment.has_delay || elapsed.value() != 0.0;
            if is_later && !Segment::of(alignment.motion, at).carry(law, elapsed, &mut here) {
                return alignment.stepped(law, friction);
            }
            let velocity = alignment.between(&alignment.motion.velocities, *location, elapsed);
            law.rate(velocity, &here, Regime::ALL_HOLD, &mut rate);
            friction.push(law.coefficient(velocity, &here, &rate));
        }
        Ok(())
    }
}
