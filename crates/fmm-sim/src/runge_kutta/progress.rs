//! Progress of a stretch of sliding.

use super::guard::Side;
use crate::State;

/// The state at a time that is a plain number, with the side of the capture speed.
#[derive(Clone, Copy)]
pub(super) struct Progress<D> {
    pub(super) time: f64,
    pub(super) state: State<D>,
    pub(super) acceleration: D,
    pub(super) side: Side,
}
