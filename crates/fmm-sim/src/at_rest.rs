//! Contact at rest: whether it stays so for good.

use fmm_model::{Oscillator, Scalar};

use crate::State;
use crate::curve::Wave;
use crate::drive::{Drive, Piece};
use crate::load::{load, rounding};

/// Whether a contact that holds in `state` at `time`, in the piece of this `index`, is at rest and no force to come
/// exceeds what its `breakaway` coefficient holds.
pub(crate) fn holds_for_good<D: Scalar>(
    oscillator: &Oscillator<D>,
    drive: &Drive<D>,
    index: usize,
    time: D,
    state: State<D>,
    breakaway: f64,
) -> bool {
    // What takes the contact along loads the spring.
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
