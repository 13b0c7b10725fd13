//! The force that drives the machine back: a linear spring, or the sine of a pendulum.

use crate::{ModelError, Scalar};

/// How the restoring force depends on the position; its slope at the origin is the stiffness k.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Restoring<D = f64> {
    /// F = k x.
    #[default]
    Linear,
    /// F = k ℓ sin(x/ℓ), a pendulum. With x an angle (rad), `length` is 1; with x a distance along the arc, it is the
    /// radius (m).
    Sine {
        /// ℓ, the position that makes one radian (m, or 1 for an angle).
        length: D,
    },
}

impl<D: Scalar> Restoring<D> {
    /// A pendulum, F = k ℓ sin(x/ℓ), whose position `length` ℓ makes one radian (m, or 1 for an angle).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if the length is zero, negative or not finite.
    pub fn sine(length: D) -> Result<Self, ModelError> {
        ModelError::require_positive("length per radian", length.value(), "m")?;
        Ok(Self::Sine { length })
    }

    /// The restoring force (N) at `position` (m) of a spring of `stiffness` k (N/m) at the origin.
    pub fn force(&self, stiffness: D, position: D) -> D {
        match self {
            Self::Linear => stiffness * position,
            Self::Sine { length } => stiffness * *length * (position / *length).sin_cos().0,
        }
    }

    /// The energy (J) stored at `position` (m), zero at the origin.
    pub fn energy(&self, stiffness: D, position: D) -> D {
        match self {
            Self::Linear => stiffness * position * position * 0.5,
            Self::Sine { length } => {
                // 1 − cos φ = 2 sin²(φ/2) does not cancel at small angles.
                let half = (position / *length * 0.5).sin_cos().0;
                stiffness * *length * *length * half * half * 2.0
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pendulum_is_a_spring_at_small_angles_and_softer_beyond() {
        let (spring, pendulum) = (Restoring::Linear, Restoring::sine(0.5).unwrap());
        assert!((pendulum.force(8.0, 1e-4) / spring.force(8.0, 1e-4) - 1.0).abs() < 1e-8);
        assert!((pendulum.energy(8.0, 1e-4) / spring.energy(8.0, 1e-4) - 1.0).abs() < 1e-8);
        // Hanging out sideways: F = k ℓ, E = k ℓ².
        let quarter = 0.5 * std::f64::consts::FRAC_PI_2;
        assert!((pendulum.force(8.0, quarter) - 4.0).abs() < 1e-15);
        assert!((pendulum.energy(8.0, quarter) - 2.0).abs() < 1e-15);
        assert!(Restoring::sine(0.0).is_err() && Restoring::sine(f64::NAN).is_err());
    }
}
