//! A platform on equal leaf springs: the guide of the machine, and how straight it is.

use crate::{LeafSpring, ModelError, Scalar};

/// A parallelogram flexure: a platform that several equal leaf springs carry side by side, so that it moves along x
/// without turning, and a little along the leaves, y.
///
/// ```text
/// k = n E b t³/L³                                                  (n leaves in parallel)
/// δ_y = −3 δ_x²/(5 L)                                              (thesis Eq. 4.3)
/// v_y = −6 δ_x v_x/(5 L)                                           (its derivative in time)
/// v = √(v_x² + v_y²)
/// ```
///
/// The parasitic motion δ_y points towards the clamps at the base whichever way the platform moves; it has twice the
/// frequency of an oscillation, and its velocity vanishes both at the turning points and at the centre.
///
/// ```
/// use fmm_model::{Flexure, LeafSpring};
///
/// let flexure = Flexure::new(4, LeafSpring::new(0.552, 0.1016, 0.001_587_5, 205e9)?)?;
/// assert!((flexure.stiffness() - 1981.7).abs() < 0.05);
/// assert!((flexure.parasitic_motion(0.004) + 17.39e-6).abs() < 5e-9);
/// assert!((flexure.motion_ratio(0.022) - 41.8).abs() < 0.05);
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flexure<D = f64> {
    leaves: u32,
    leaf: LeafSpring<D>,
}

impl<D: Scalar> Flexure<D> {
    /// A platform on `leaves` springs like `leaf`.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if there is no leaf.
    pub fn new(leaves: u32, leaf: LeafSpring<D>) -> Result<Self, ModelError> {
        ModelError::require_positive("number of leaf springs", f64::from(leaves), "(dimensionless)")?;
        Ok(Self { leaves, leaf })
    }

    /// n, the number of leaf springs.
    pub fn leaves(&self) -> u32 {
        self.leaves
    }

    /// One of the leaf springs; bending stress and allowed deflection of the flexure are those of each leaf.
    pub fn leaf(&self) -> LeafSpring<D> {
        self.leaf
    }

    /// k, stiffness of all leaf springs together (N/m).
    pub fn stiffness(&self) -> D {
        self.leaf.stiffness() * f64::from(self.leaves)
    }

    /// δ_y, motion across the guided direction (m) at `deflection` δ_x (m); zero or negative.
    pub fn parasitic_motion(&self, deflection: D) -> D {
        -self.leaf.shortening(deflection)
    }

    /// v_y, velocity across the guided direction (m/s) at `deflection` δ_x (m) and `velocity` v_x (m/s).
    pub fn parasitic_velocity(&self, deflection: D, velocity: D) -> D {
        -(self.leaf.shortening_slope(deflection) * velocity)
    }

    /// v, speed of the platform along its path (m/s) at `deflection` δ_x (m) and `velocity` v_x (m/s).
    pub fn resultant_speed(&self, deflection: D, velocity: D) -> D {
        let slope = self.leaf.shortening_slope(deflection);
        // |v_x| times the length of the path per deflection: differentiable in the deflection also where v_x vanishes.
        velocity.abs() * (slope * slope + 1.0).sqrt()
    }

    /// |δ_x/δ_y| = 5 L/(3 |δ_x|), how many times smaller the parasitic motion is than `deflection` δ_x (m); infinite at the
    /// centre (1).
    pub fn motion_ratio(&self, deflection: D) -> D {
        self.leaf.length() / (deflection.abs() * 0.6)
    }

    /// The length of leaf springs (m) with which the parasitic motion is `ratio` times smaller than `deflection` (m),
    /// the inverse of [`motion_ratio`](Self::motion_ratio).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if the magnitude of the deflection or the ratio is zero or not finite, or the ratio
    /// negative.
    pub fn length_for_motion_ratio(deflection: D, ratio: D) -> Result<D, ModelError> {
        ModelError::require_positive("magnitude of a deflection", deflection.value().abs(), "m")?;
        ModelError::require_positive("ratio of deflection to parasitic motion", ratio.value(), "(dimensionless)")?;
        Ok(deflection.abs() * ratio * 0.6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    fn flexure() -> Flexure {
        Flexure::new(4, LeafSpring::new(0.552, 0.1016, 0.001_587_5, 205e9).unwrap()).unwrap()
    }

    /// v_y is the derivative of δ_y in time, here by the chain rule of dual numbers; rounding only.
    #[test]
    fn parasitic_velocity_is_the_derivative_of_the_parasitic_motion() {
        let leaf = LeafSpring::new(0.552.into(), 0.1016.into(), 0.001_587_5.into(), 205e9.into()).unwrap();
        let dual = Flexure::<Dual<1>>::new(4, leaf).unwrap();
        for (deflection, velocity) in [(0.022, 0.3), (-0.006, 0.08), (0.01, -0.1), (0.0, 0.3)] {
            let along_time = Dual::variable(deflection, 0);
            let expected = dual.parasitic_motion(along_time).partial(0) * velocity;
            let found = flexure().parasitic_velocity(deflection, velocity);
            assert!((found - expected).abs() <= 1e-17, "{found} m/s against {expected} m/s");
            let speed = flexure().resultant_speed(deflection, velocity);
            assert!((speed - velocity.hypot(found)).abs() < 1e-16, "{speed} m/s");
        }
        assert_eq!(flexure().parasitic_motion(-0.01), flexure().parasitic_motion(0.01));
        // A platform at rest has no speed, and the derivative of that is a number.
        assert_eq!(dual.resultant_speed(Dual::variable(0.01, 0), Dual::from(0.0)).partial(0), 0.0);
    }

    #[test]
    fn the_length_follows_from_the_ratio() {
        let ratio = flexure().motion_ratio(-0.004);
        assert!((ratio - 230.0).abs() < 1e-12, "{ratio}");
        let length = Flexure::length_for_motion_ratio(-0.004, ratio).unwrap();
        assert!((length - 0.552).abs() < 1e-15, "{length} m");
        for (deflection, ratio) in
            [(0.0, 230.0), (f64::NAN, 230.0), (0.004, 0.0), (0.004, -1.0), (0.004, f64::INFINITY)]
        {
            assert!(Flexure::length_for_motion_ratio(deflection, ratio).is_err(), "{deflection} m, {ratio}");
        }
    }

    #[test]
    fn a_flexure_needs_a_leaf() {
        let message = Flexure::new(0, flexure().leaf()).unwrap_err().to_string();
        assert_eq!(message, "number of leaf springs must be positive and finite, but is 0 (dimensionless)");
        assert_eq!(flexure().stiffness(), 4.0 * flexure().leaf().stiffness());
    }
}
