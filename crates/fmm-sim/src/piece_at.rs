//! The force at times that ascend, for methods of fixed step.

use crate::drive::{Drive, Piece};

/// The force at times that ascend.
pub(crate) struct PieceAt<'a> {
    drive: &'a Drive<'a, f64>,
    piece: Piece<f64>,
    index: usize,
}

impl<'a> PieceAt<'a> {
    pub(crate) fn new(drive: &'a Drive<'a, f64>) -> Self {
        Self { drive, piece: drive.piece(0), index: 0 }
    }

    pub(crate) fn force(&mut self, time: f64) -> f64 {
        while time >= self.piece.end {
            self.index += 1;
            self.piece = self.drive.piece(self.index);
        }
        if self.piece.is_free() { 0.0 } else { self.piece.force(time) }
    }
}
