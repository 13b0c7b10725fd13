//! Trajectories between two evaluations of a problem: their memory is used again, on each thread that needs one.

use std::sync::{Mutex, PoisonError};

use fmm_model::{Dual, Scalar};
use fmm_sim::Trajectory;

use crate::law::{DIRECTIONS, FEW};

/// Trajectories of a problem that nobody uses, by the derivatives that they carry. A clone has none.
#[derive(Debug, Default)]
pub(super) struct Idle {
    plain: Pool<f64>,
    few: Pool<Dual<FEW>>,
    more: Pool<Dual<DIRECTIONS>>,
}

type Pool<D> = Mutex<Vec<Trajectory<D>>>;

/// A number type by which a problem simulates.
pub(super) trait Simulated: Scalar {
    /// The trajectories of this type.
    fn pool(idle: &Idle) -> &Pool<Self>;
}

impl Simulated for f64 {
    fn pool(idle: &Idle) -> &Pool<Self> {
        &idle.plain
    }
}

impl Simulated for Dual<FEW> {
    fn pool(idle: &Idle) -> &Pool<Self> {
        &idle.few
    }
}

impl Simulated for Dual<DIRECTIONS> {
    fn pool(idle: &Idle) -> &Pool<Self> {
        &idle.more
    }
}

impl Idle {
    /// Result of `work` with a trajectory, which holds an earlier motion.
    pub(super) fn lend<D: Simulated, R>(&self, work: impl FnOnce(&mut Trajectory<D>) -> R) -> R {
        let pool = || D::pool(self).lock().unwrap_or_else(PoisonError::into_inner);
        let taken = pool().pop();
        let mut trajectory = taken.unwrap_or_default();
        let result = work(&mut trajectory);
        pool().push(trajectory);
        result
    }
}

impl Clone for Idle {
    fn clone(&self) -> Self {
        Self::default()
    }
}
