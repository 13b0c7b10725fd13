//! Following a path that something outside prescribes.

use fmm_friction::BristleLaw;
use fmm_model::{Oscillator, Scalar};

use super::field::Field;
use super::run::Run;
use crate::drive::Drive;
use crate::recorder::Recorder;
use crate::{Direction, Sampling, SimulationError, State, Trajectory};

/// Well below what a law can be told apart by, and well above rounding.
const TOLERANCE: f64 = 1e-13;

/// Slides along straight lines through the positions of `path` at `speed`, and gives `visit` the force and the states at
/// each of them.
pub(crate) fn follow<D: Scalar, L: BristleLaw<D>>(
    law: &L,
    normal_load: D,
    path: &[D],
    speed: D,
    mut visit: impl FnMut(D, &[D]),
) -> Result<(), SimulationError> {
    // The machine does not matter: the velocity is kept.
    let oscillator = Oscillator::new(D::from(1.0), D::from(1.0))?;
    let mut field = Field::new(&oscillator, law, normal_load, D::from(0.0));
    field.guided = true;
    let drive = Drive::new(&[], oscillator.mass());
    let piece = drive.piece(0);
    let mut scratch = Trajectory::new();
    // Nothing is sampled; the recorder counts the events.
    let sampling = Sampling::at([f64::MAX])?;
    let recorder = Recorder::new("bristle", law.states(), &sampling, &mut scratch)?;
    let start = State { position: path.first().copied().unwrap_or(D::from(0.0)), velocity: speed };
    let mut run = Run::new(field, start, TOLERANCE, recorder);
    let mut direction = None;
    for (index, position) in path.iter().enumerate() {
        let displacement = *position - path[index.saturating_sub(1)];
        let along = if displacement.value() == 0.0 { direction } else { Some(Direction::of(displacement.value())) };
        let Some(along) = along else {
            visit(D::from(0.0), &run.step.begin[2..]);
            continue;
        };
        if direction != Some(along) {
            direction = Some(along);
            run.step.begin[1] = speed * along.sign();
            run.go(direction);
        }
        let duration = displacement * along.sign() / speed;
        run.time = 0.0;
        while run.time < duration.value() {
            run.advance(&piece, duration.value())?;
        }
        // The steps end after a number of seconds; the path does where its derivatives say.
        run.field.rates(D::from(0.0), run.branch, &run.step.begin, &mut run.before);
        for (y, rate) in run.step.begin.iter_mut().zip(&run.before) {
            *y = *y + *rate * (duration - duration.value());
        }
        let force = run.field.friction(run.branch, &run.step.begin);
        if !force.value().is_finite() {
            return Err(SimulationError::NotFinite { time: run.time });
        }
        visit(force, &run.step.begin[2..]);
    }
    Ok(())
}
