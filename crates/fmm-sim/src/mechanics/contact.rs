//! Contact of a machine: friction levels, the load that is left for friction, and rest for good.

use fmm_friction::{Affine, SlidingLaw};
use fmm_model::{Oscillator, Restoring, Scalar};

use crate::mechanics::{Curve, Forcing, Piece, ROUNDING, Wave};
use crate::scenario::{LoadOverPosition, State};

/// Friction levels of a law, in the form that the automaton needs.
pub(crate) trait Levels<D> {
    /// Coefficient while the speed grows, and the only one unless there are two branches.
    fn gaining(&self, speed: D) -> D;
    /// Coefficient while the speed falls.
    fn losing(&self, speed: D) -> D;
    fn breakaway(&self) -> D;
    fn has_branches(&self) -> bool;
}

/// A [`SlidingLaw`] as levels.
pub(crate) struct Sliding<'a, L: ?Sized>(pub(crate) &'a L);

impl<D: Scalar, L: SlidingLaw<D> + ?Sized> Levels<D> for Sliding<'_, L> {
    fn gaining(&self, speed: D) -> D {
        self.0.coefficient(speed)
    }
    fn losing(&self, speed: D) -> D {
        self.0.coefficient_losing_speed(speed)
    }
    fn breakaway(&self) -> D {
        self.0.breakaway()
    }
    fn has_branches(&self) -> bool {
        self.0.depends_on_acceleration()
    }
}

/// The two branches of a piecewise linear law as levels.
#[derive(Clone, Copy)]
pub(crate) struct Branches<D> {
    pub(crate) gaining: Affine<D>,
    pub(crate) losing: Affine<D>,
    pub(crate) differ: bool,
}

impl<D: Scalar> Levels<D> for Branches<D> {
    fn gaining(&self, speed: D) -> D {
        self.gaining.coefficient(speed)
    }
    fn losing(&self, speed: D) -> D {
        self.losing.coefficient(speed)
    }
    fn breakaway(&self) -> D {
        self.gaining.breakaway
    }
    fn has_branches(&self) -> bool {
        self.differ
    }
}

/// Normal load (N) at `time` in `state`, and its slope at constant velocity (N/s).
pub(crate) fn normal_load<D: Scalar>(
    piece: &Piece<D>,
    over_position: LoadOverPosition<D>,
    time: D,
    state: State<D>,
) -> (D, D) {
    let (load, slope) = piece.normal_load(time);
    if over_position.is_constant() {
        return (load, slope);
    }
    let factor = over_position.factor(state.position);
    (load * factor, slope * factor + load * over_position.slope(state.position) * state.velocity)
}

/// Load left for friction at constant velocity from `state` at `time` on (N): L = f − F_c − F_k.
pub(crate) fn load<D: Scalar>(
    oscillator: &Oscillator<D>,
    piece: &Piece<D>,
    time: D,
    state: State<D>,
) -> Curve<'static, D> {
    let State { position, velocity } = state;
    let mut load = Curve::force(piece, time);
    load.constant -= oscillator.damping_force(velocity);
    match oscillator.restoring() {
        Restoring::Sine { length } if velocity.value() != 0.0 => {
            // −k ℓ sin((x + v τ)/ℓ) is a wave.
            let (sin, cos) = (position / length).sin_cos();
            let force = oscillator.stiffness() * length;
            let sign = velocity.value().signum();
            let angular = velocity.abs() / length;
            load.waves.push(Wave { angular, cosine: -(force * sin), sine: -(force * cos) * sign });
        }
        restoring => {
            // Of a spring that is not linear the slope holds for this instant.
            load.constant -= oscillator.restoring_force(position);
            if velocity.value() != 0.0 {
                load.slope -= restoring.slope(oscillator.stiffness(), position).0 * velocity;
            }
        }
    }
    load
}

/// Rounding (N) that `load` carries, the load at `state` and `time`: that of its terms, and of the time itself.
pub(crate) fn rounding<D: Scalar, E: Scalar>(
    oscillator: &Oscillator<D>,
    load: &Curve<E>,
    time: D,
    state: State<D>,
) -> f64 {
    let position = state.position;
    // Next to a corner of the spring the force is a small difference of large terms.
    let terms = oscillator.restoring().slope(oscillator.stiffness(), position).0.value() * position.value();
    let spring = 2.0 * oscillator.restoring_force(position).value().abs().max(terms.abs());
    let (mut force, mut rate) = (load.constant.value().abs() + spring, load.slope.value().abs());
    for wave in &load.waves {
        let amplitude = wave.cosine.value().hypot(wave.sine.value());
        force += amplitude;
        rate += amplitude * wave.angular.value();
    }
    ROUNDING * (force + rate * time.value())
}

/// True if a contact that holds in `state` at `time`, in the piece of this `index`, is at rest, and its `breakaway`
/// force over the normal load in the force-free position holds all forces to come.
pub(crate) fn holds_for_good<D: Scalar>(
    oscillator: &Oscillator<D>,
    drive: &Forcing<D>,
    index: usize,
    time: D,
    state: State<D>,
    breakaway: f64,
) -> bool {
    // A moving counterface loads the spring.
    if state.velocity.value() != 0.0 {
        return false;
    }
    let holds = |piece: &Piece<D>, begin: D| {
        let load = load(oscillator, piece, begin, state).plain_without_decay();
        let (normal_load, load_slope) = piece.normal_load(begin);
        let level = normal_load.value() * breakaway;
        let slack = level * 4.0 * f64::EPSILON + rounding(oscillator, &load, begin, state);
        let span = piece.end - begin.value();
        // A load that varies has an end.
        let change = if load_slope.value() == 0.0 { 0.0 } else { load_slope.value() * breakaway * span };
        let levels = [level + slack, level + change + slack];
        let (begin, end) = if span.is_finite() {
            (load.constant, load.constant + load.slope * span)
        } else if load.slope == 0.0 {
            (load.constant, load.constant)
        } else {
            return false;
        };
        // Waves of one frequency are one wave; those of several meet sooner or later.
        let mut waves: Vec<Wave<f64>> = Vec::new();
        for wave in load.waves {
            match waves.iter_mut().find(|other| other.angular == wave.angular) {
                Some(other) => (other.cosine, other.sine) = (other.cosine + wave.cosine, other.sine + wave.sine),
                None => waves.push(wave),
            }
        }
        let reach = waves.iter().map(|wave| wave.cosine.hypot(wave.sine)).sum::<f64>();
        // Between the ends load and level are lines.
        begin.abs() + reach <= levels[0] && end.abs() + reach <= levels[1]
    };
    (index..drive.pieces()).all(|later| {
        let piece = drive.piece(later);
        let begin = if later == index { time } else { D::from(piece.start) };
        holds(&piece, begin)
    })
}
