//! Friction along a motion that is given: hysteresis loops, and what a contact does at constant velocity.

use fmm_friction::BristleLaw;
use fmm_model::{ModelError, Scalar};

use crate::SimulationError;
use crate::bristle;

/// The contact at one point of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathPoint<D = f64> {
    /// Position (m).
    pub position: D,
    /// Friction force (N) on arrival there, positive if it opposes a motion towards greater positions.
    pub force: D,
    /// States of the law, in its order and units.
    pub states: Vec<D>,
}

/// Friction of a `law` with internal state under `normal_load` (N) along straight lines from each position of `path` (m) to
/// the next, at constant `speed` (m/s). Bristles are not deflected at the first position.
///
/// Laws such as [`Dahl`](fmm_friction::Dahl), [`BoucWen`](fmm_friction::BoucWen) and
/// [`MaxwellSlip`](fmm_friction::MaxwellSlip) depend on the path only, so that any speed gives the quasi-static loop. Forces
/// and states are good to about 1e-12; at a dual number they have their derivatives, those in positions and speed included.
///
/// ```
/// use fmm_friction::Dahl;
/// use fmm_sim::friction_along;
///
/// // Out and back: on the way out F = μ N (1 − exp(−σ x/μ)), and at the end of the way back the loop is open.
/// let points = friction_along(&Dahl::new(0.25, 1e4, 1.0)?, 7.0, &[0.0, 2e-5, 0.0], 1e-3)?;
/// assert!((points[1].force - 1.75 * (1.0 - (-0.8f64).exp())).abs() < 1e-12);
/// assert!(points[2].force < -0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SimulationError::Quantity`] if the load is negative, the speed not positive or a number not finite, and what an
/// integration can end with ([`Bristle`](crate::Bristle)).
pub fn friction_along<D: Scalar, L: BristleLaw<D>>(
    law: &L,
    normal_load: D,
    path: &[D],
    speed: D,
) -> Result<Vec<PathPoint<D>>, SimulationError> {
    ModelError::require_not_negative("normal load", normal_load.value(), "N")?;
    ModelError::require_positive("speed", speed.value(), "m/s")?;
    for position in path {
        ModelError::require_finite("position", position.value(), "m")?;
    }
    let mut points = Vec::with_capacity(path.len());
    let mut positions = path.iter();
    bristle::follow(law, normal_load, path, speed, |force, states| {
        points.extend(positions.next().map(|position| PathPoint {
            position: *position,
            force,
            states: states.to_vec(),
        }));
    })?;
    Ok(points)
}
