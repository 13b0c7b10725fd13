//! Following a motion that something outside prescribes.

use fmm_friction::{BristleLaw, Regime};
use fmm_model::{Oscillator, Scalar};

use super::field::Field;
use super::odd::require_odd;
use super::run::Run;
use crate::drive::Piece;
use crate::recorder::Recorder;
use crate::{Direction, PrescribedMotion, Sampling, SimulationError, Trajectory};

/// Well below what a law can be told apart by, and well above rounding.
const TOLERANCE: f64 = 1e-13;

/// Follows `motion` and gives `visit` the force and the states at each of its points.
pub(crate) fn follow<D: Scalar, L: BristleLaw<D> + ?Sized>(
    law: &L,
    normal_load: D,
    motion: &PrescribedMotion<D>,
    mut visit: impl FnMut(D, &[D]),
) -> Result<(), SimulationError> {
    require_odd(law)?;
    let zero = D::from(0.0);
    // The machine does not matter: of unit mass, it is accelerated as the motion says.
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
    let mut run = Run::new(field, begin, TOLERANCE, recorder);
    visit(zero, &run.step.begin[2..]);
    let (mut before, mut rates) = (0.0, vec![zero; law.states()]);
    for leg in &motion.legs {
        let duration = leg.duration.value();
        let piece = Piece::line_from_zero(leg.acceleration, leg.jerk);
        run.time = 0.0;
        run.step.begin[0] = leg.begin.position;
        run.step.begin[1] = leg.begin.velocity;
        let velocity = leg.begin.velocity.value();
        let is_uniform = leg.acceleration.value() == 0.0 && leg.jerk.value() == 0.0 && velocity != 0.0;
        if is_uniform && law.carry(leg.begin.velocity, leg.duration, &mut run.step.begin[2..]) {
            let states = &run.step.begin[2..];
            law.rate(leg.end.velocity, states, Regime::ALL_HOLD, &mut rates);
            let force = normal_load * law.coefficient(leg.end.velocity, states, &rates);
            if !force.value().is_finite() {
                return Err(SimulationError::NotFinite { time: duration });
            }
            visit(force, states);
            // What follows begins anew.
            before = 0.0;
            continue;
        }
        if velocity == 0.0 || velocity * before <= 0.0 {
            // From rest the acceleration says where it goes.
            let direction = if velocity == 0.0 { run.departure(&piece) } else { Some(Direction::of(velocity)) };
            run.go(direction);
        } else {
            run.collocation.forget();
        }
        while run.time < duration && !run.resting {
            run.advance(&piece, duration)?;
        }
        // The steps end after a number of seconds; the leg does where its derivatives say.
        let force = piece.force(duration);
        run.field.rates(force, run.branch, &run.step.begin, &mut run.before);
        for (y, rate) in run.step.begin.iter_mut().zip(&run.before) {
            *y += *rate * (leg.duration - duration);
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
