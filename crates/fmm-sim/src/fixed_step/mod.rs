//! Methods of fixed step: events on the grid, and the force at times that ascend.

mod moreau;
mod thesis;

use fmm_model::Oscillator;

use crate::mechanics::{Forcing, Piece, holds_for_good};
use crate::scenario::{Event, EventKind, Mode, State};

pub use moreau::Moreau;
pub use thesis::Thesis;

/// Events at multiples of a step.
struct GridEvents {
    /// Δt (s).
    step: f64,
    /// N μ_s (N).
    static_level: f64,
}

impl GridEvents {
    /// An event at step `index` in `state` (m, m/s), the force beside friction being `balance` (N).
    fn event(&self, kind: EventKind, index: usize, state: (f64, f64), next: Mode, balance: f64) -> Event {
        Event {
            kind,
            time: index as f64 * self.step,
            position: state.0,
            velocity: state.1,
            next,
            load: balance.abs(),
            static_level: self.static_level,
            grazing: false,
        }
    }
}

/// The force at times that ascend.
struct PieceAt<'a> {
    drive: &'a Forcing<'a, f64>,
    piece: Piece<f64>,
    index: usize,
}

impl<'a> PieceAt<'a> {
    fn new(drive: &'a Forcing<'a, f64>) -> Self {
        Self { drive, piece: drive.piece(0), index: 0 }
    }

    /// True if a contact of `oscillator` that holds in `state` at `time` with this `breakaway` coefficient holds for
    /// good.
    fn holds_for_good(&self, oscillator: &Oscillator, time: f64, state: State, breakaway: f64) -> bool {
        holds_for_good(oscillator, self.drive, self.index, time, state, breakaway)
    }

    fn force(&mut self, time: f64) -> f64 {
        while time >= self.piece.end {
            self.index += 1;
            self.piece = self.drive.piece(self.index);
        }
        if self.piece.is_free() { 0.0 } else { self.piece.force(time) }
    }
}
