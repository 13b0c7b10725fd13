//! Methods of fixed step: events on the grid, and the force at times that ascend.

mod moreau;
mod thesis;

use fmm_model::Oscillator;

use crate::mechanics::{Forcing, Piece, holds_for_good};
use crate::scenario::{Event, EventKind, Mode, State};

pub use moreau::Moreau;
pub use thesis::Thesis;

/// The grid of a method of fixed step: its events, and the force at times that ascend.
struct Grid<'a> {
    /// Δt (s).
    step: f64,
    /// N μ_s (N).
    static_level: f64,
    drive: &'a Forcing<'a, f64>,
    piece: Piece<f64>,
    index: usize,
}

impl<'a> Grid<'a> {
    fn new(step: f64, static_level: f64, drive: &'a Forcing<'a, f64>) -> Self {
        Self { step, static_level, drive, piece: drive.piece(0), index: 0 }
    }

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

    /// True if a contact of `oscillator` that holds in `state` (m, m/s) at `time` with this `breakaway` coefficient
    /// holds for good.
    fn holds_for_good(&self, oscillator: &Oscillator, time: f64, state: (f64, f64), breakaway: f64) -> bool {
        let state = State { position: state.0, velocity: state.1 };
        holds_for_good(oscillator, self.drive, self.index, time, state, breakaway)
    }

    /// The force (N) at step `index`.
    fn force(&mut self, index: usize) -> f64 {
        let time = index as f64 * self.step;
        while time >= self.piece.end {
            self.index += 1;
            self.piece = self.drive.piece(self.index);
        }
        if self.piece.is_free() { 0.0 } else { self.piece.force(time) }
    }
}
