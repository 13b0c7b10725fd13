//! Restoring force: a linear spring, one that hardens or softens, or the sine of a pendulum.

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
    /// F = k (x + k₃ x³ + k₅ x⁵), a spring that hardens (positive) or softens (negative).
    Polynomial {
        /// k₃ (1/m²).
        cubic: D,
        /// k₅ (1/m⁴).
        quintic: D,
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

    /// A spring that hardens or softens, F = k (x + k₃ x³ + k₅ x⁵), of k₃ `cubic` (1/m²) and k₅ `quintic` (1/m⁴). Where the bracket has
    /// another sign than x it restores nothing; engines refuse a motion that gets there.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`].
    pub fn polynomial(cubic: D, quintic: D) -> Result<Self, ModelError> {
        ModelError::require_finite("cubic term of the spring", cubic.value(), "1/m²")?;
        ModelError::require_finite("quintic term of the spring", quintic.value(), "1/m⁴")?;
        Ok(Self::Polynomial { cubic, quintic })
    }

    /// Whether the force at `position` (m) points back to the origin. A pendulum that goes over the top turns on; a spring does not.
    pub fn restores(&self, position: D) -> bool {
        match self {
            Self::Linear | Self::Sine { .. } => true,
            Self::Polynomial { cubic, quintic } => {
                let square = position.value() * position.value();
                (quintic.value() * square + cubic.value()) * square > -1.0
            }
        }
    }

    /// The slope of the force (N/m) at `position` (m), and the rate at which it changes (N/m²).
    pub fn slope(&self, stiffness: D, position: D) -> (D, D) {
        match self {
            Self::Linear => (stiffness, D::from(0.0)),
            Self::Sine { length } => {
                let (sin, cos) = (position / *length).sin_cos();
                (stiffness * cos, -(stiffness / *length * sin))
            }
            Self::Polynomial { cubic, quintic } => {
                let square = position * position;
                let slope = (*quintic * square * 5.0 + *cubic * 3.0) * square + 1.0;
                let bend = (*quintic * square * 20.0 + *cubic * 6.0) * position;
                (stiffness * slope, stiffness * bend)
            }
        }
    }

    /// The restoring force (N) at `position` (m) of a spring of `stiffness` k (N/m) at the origin.
    pub fn force(&self, stiffness: D, position: D) -> D {
        match self {
            Self::Linear => stiffness * position,
            Self::Sine { length } => stiffness * *length * (position / *length).sin_cos().0,
            Self::Polynomial { cubic, quintic } => {
                let square = position * position;
                stiffness * position * ((*quintic * square + *cubic) * square + 1.0)
            }
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
            Self::Polynomial { cubic, quintic } => {
                let square = position * position;
                stiffness * square * ((*quintic * square * (1.0 / 6.0) + *cubic * 0.25) * square + 0.5)
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
        let quarter = 0.5 * core::f64::consts::FRAC_PI_2;
        assert!((pendulum.force(8.0, quarter) - 4.0).abs() < 1e-15);
        assert!((pendulum.energy(8.0, quarter) - 2.0).abs() < 1e-15);
        let polynomial = Restoring::polynomial(-1.0 / 6.0, 1.0 / 120.0).unwrap();
        let unit = Restoring::sine(1.0).unwrap();
        // The next terms are x⁷/5040 and its integral.
        let x: f64 = 0.3;
        assert!((polynomial.force(8.0, x) - unit.force(8.0, x)).abs() < 8.0 * x.powi(7) / 5000.0);
        assert!((polynomial.energy(8.0, x) - unit.energy(8.0, x)).abs() < 8.0 * x.powi(8) / 40_000.0);
        let (slope, bend) = polynomial.slope(8.0, x);
        let (expected, bends) = unit.slope(8.0, x);
        assert!((slope - expected).abs() < 8.0 * x.powi(6) / 700.0 && (bend - bends).abs() < 8.0 * x.powi(5) / 100.0);
        let soft = Restoring::polynomial(-4.0, 0.0).unwrap();
        assert!(soft.restores(0.4) && !soft.restores(0.6) && soft.restores(0.0) && unit.restores(4.0));
        assert!(Restoring::polynomial(f64::NAN, 0.0).is_err());
        assert!(Restoring::sine(0.0).is_err() && Restoring::sine(f64::NAN).is_err());
    }
}
