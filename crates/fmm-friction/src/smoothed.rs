//! A law made smooth through zero speed, for hosts that demand it.

use fmm_model::Scalar;

use crate::{LawError, LawParameter, Role, SlidingLaw};

/// A sliding law times tanh(v/ε): a smooth function of the velocity that never sticks.
///
/// ```text
/// F = N μ(|v|) tanh(v/ε)
/// ```
///
/// | symbol | field | unit | meaning |
/// |---|---|---|---|
/// | μ | `law` | - | the law to smooth |
/// | ε | `width` | m/s | speed below which it is smoothed |
///
/// It is for optimisers, other solvers and harmonic balance that need a smooth right-hand side. It is no default:
/// the contact creeps under any load instead of resting, equations become stiff as ε shrinks, and the motion is wrong
/// in proportion to ε. In a free decay of the thesis' Monte Carlo case the velocity is off by
///
/// | ε (m/s) | 1e-2 | 1e-3 | 1e-4 | 1e-5 | 1e-6 |
/// |---|---|---|---|---|---|
/// | error (m/s) | 3.8e-3 | 3.3e-4 | 3.4e-5 | 3.4e-6 | 3.4e-7 |
///
/// ```
/// use fmm_friction::{Coulomb, SlidingLaw, Smoothed};
///
/// let law = Smoothed::new(Coulomb::new(0.2)?, 1e-3)?;
/// assert_eq!(law.force_coefficient(-1.0), -0.2);
/// assert_eq!((law.coefficient(0.0), law.breakaway()), (0.0, 0.0));
/// # Ok::<(), fmm_friction::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothed<L, D = f64> {
    law: L,
    width: D,
}

const WIDTH: LawParameter = LawParameter::positive("smoothing_width", "ε", "m/s", Role::Shape);

impl<D: Scalar, L: SlidingLaw<D>> Smoothed<L, D> {
    /// `law`, smoothed below a speed of `width` ε (m/s).
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] if the width is not positive or not finite, [`LawError::DependsOnAcceleration`] if the
    /// law has two values at one speed.
    pub fn new(law: L, width: D) -> Result<Self, LawError> {
        if law.depends_on_acceleration() {
            return Err(LawError::DependsOnAcceleration);
        }
        Ok(Self { law, width: WIDTH.check(width)? })
    }

    /// Friction coefficient (1) at `velocity` (m/s) of either sign, with the sign of the velocity.
    pub fn force_coefficient(&self, velocity: D) -> D {
        let smooth = saturation(velocity.abs() / self.width);
        let smooth = if velocity.value() < 0.0 { -smooth } else { smooth };
        self.law.coefficient(velocity.abs()) * smooth
    }
}

impl<D: Scalar, L: SlidingLaw<D>> SlidingLaw<D> for Smoothed<L, D> {
    fn coefficient(&self, speed: D) -> D {
        self.force_coefficient(speed)
    }

    fn breakaway(&self) -> D {
        D::from(0.0)
    }
}

/// tanh of a `ratio` ≥ 0 that may be so large that its derivatives overflow, where those of tanh have vanished.
pub(crate) fn saturation<D: Scalar>(ratio: D) -> D {
    // 1/cosh² 400 is zero in f64.
    if ratio.value() > 400.0 { D::from(1.0) } else { ratio.tanh() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AccelerationCoulomb, Coulomb, ExponentialPair, Stribeck};

    #[test]
    fn is_odd_and_smooth_through_zero() {
        let law = Smoothed::new(Stribeck::new(0.1, 0.2, 0.01, 2.0, 0.0).unwrap(), 1e-3).unwrap();
        for velocity in [1e-9, 1e-4, 0.01, 0.7, 1e300] {
            assert_eq!(law.force_coefficient(-velocity), -law.force_coefficient(velocity), "at {velocity} m/s");
        }
        // tanh r = r − r³/3: 3e-7 of r at r = 1e-3, on either side of zero.
        for velocity in [-1e-6, 1e-6] {
            let slope = law.force_coefficient(velocity) / velocity;
            assert!((slope / (0.2 / 1e-3) - 1.0).abs() < 1e-6, "{slope} s/m at {velocity} m/s");
        }
    }

    #[test]
    fn laws_with_two_values_at_one_speed_are_refused() {
        let steps = AccelerationCoulomb::new(0.2, 0.1).unwrap();
        let pair = ExponentialPair::new(0.1, 0.2, 10.0, 10.0).unwrap();
        assert_eq!(Smoothed::new(steps, 1e-3), Err(LawError::DependsOnAcceleration));
        assert_eq!(Smoothed::new(pair, 1e-3), Err(LawError::DependsOnAcceleration));
        let flat = Smoothed::new(Coulomb::new(0.2).unwrap(), 0.0).unwrap_err();
        assert!(flat.to_string().starts_with("smoothing_width must be"), "{flat}");
    }
}
