//! Restoring force: a linear spring, one that hardens or softens, one with a stop or a gap, or the sine of a pendulum.

use crate::error::ModelError;
use crate::scalar::Scalar;

/// Restoring force over the position; its slope at the origin is the stiffness k, except for a spring with a gap.
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
    /// F = k (a x + (b − a)(|x| − g)₊ sgn x), a spring with a corner on both sides: a stop, a preload or a gap.
    #[non_exhaustive]
    Bilinear {
        /// g, the distance of the corners from the origin (m).
        corner: D,
        /// a, the slope inside as a multiple of k (1).
        inner: D,
        /// b, the slope outside as a multiple of k (1).
        outer: D,
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

    /// A spring that hardens or softens, F = k (x + k₃ x³ + k₅ x⁵), of k₃ `cubic` (1/m²) and k₅ `quintic` (1/m⁴). Where
    /// the bracket has another sign than x it restores nothing; engines refuse a motion that gets there.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`] for either term.
    pub fn polynomial(cubic: D, quintic: D) -> Result<Self, ModelError> {
        ModelError::require_finite("cubic term of the spring", cubic.value(), "1/m²")?;
        ModelError::require_finite("quintic term of the spring", quintic.value(), "1/m⁴")?;
        Ok(Self::Polynomial { cubic, quintic })
    }

    /// A spring of the stiffness k up to the `distance` g (m) from the origin on both sides, and of `ratio` b times k
    /// (1) beyond: a flexure that meets a stop (b > 1), or a preloaded joint that opens (b < 1).
    ///
    /// ```text
    /// F = k x for |x| ≤ g,   F = k (g + b (|x| − g)) sgn x beyond
    /// ```
    ///
    /// ```
    /// use fmm_model::Restoring;
    ///
    /// // 2000 N/m up to 15 mm, five times as stiff beyond: 30 N at the stop, 60 N 3 mm behind it.
    /// let spring = Restoring::stop(0.015, 5.0)?;
    /// assert!((spring.force(2000.0, 0.015) - 30.0).abs() < 1e-12);
    /// assert!((spring.force(2000.0, -0.018) + 60.0).abs() < 1e-12);
    /// # Ok::<(), fmm_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] for the distance, [`ModelError::Negative`] for the ratio.
    pub fn stop(distance: D, ratio: D) -> Result<Self, ModelError> {
        ModelError::require_positive("distance of the stop", distance.value(), "m")?;
        ModelError::require_not_negative("stiffness ratio of the stop", ratio.value(), "(dimensionless)")?;
        Ok(Self::Bilinear { corner: distance, inner: D::from(1.0), outer: ratio })
    }

    /// A spring with backlash, F = k (|x| − g)₊ sgn x: no force within the `gap` g (m) on either side of the origin.
    /// The stiffness k and the natural frequency of the [oscillator](crate::Oscillator) are those beyond the gap.
    ///
    /// # Errors
    /// [`ModelError::Negative`] unless the gap is zero or positive.
    pub fn gap(gap: D) -> Result<Self, ModelError> {
        ModelError::require_not_negative("gap", gap.value(), "m")?;
        Ok(Self::Bilinear { corner: gap, inner: D::from(0.0), outer: D::from(1.0) })
    }

    /// The distance from the origin (m) at which the slope of the force leaps on either side, if it does.
    pub fn corner(&self) -> Option<D> {
        match self {
            Self::Bilinear { corner, .. } => Some(*corner),
            Self::Linear | Self::Sine { .. } | Self::Polynomial { .. } => None,
        }
    }

    /// The same spring with every number made one of another kind.
    pub fn map<E: Scalar>(self, mut number: impl FnMut(D) -> E) -> Restoring<E> {
        match self {
            Self::Linear => Restoring::Linear,
            Self::Sine { length } => Restoring::Sine { length: number(length) },
            Self::Polynomial { cubic, quintic } => {
                Restoring::Polynomial { cubic: number(cubic), quintic: number(quintic) }
            }
            Self::Bilinear { corner, inner, outer } => {
                Restoring::Bilinear { corner: number(corner), inner: number(inner), outer: number(outer) }
            }
        }
    }

    /// True if the force at `position` (m) points back to the origin. A pendulum that goes over the top turns on; a
    /// spring does not.
    pub fn restores(&self, position: D) -> bool {
        match self {
            Self::Linear | Self::Sine { .. } | Self::Bilinear { .. } => true,
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
            Self::Bilinear { corner, inner, outer } => {
                let is_outside = position.value().abs() > corner.value();
                (stiffness * if is_outside { *outer } else { *inner }, D::from(0.0))
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
            Self::Bilinear { inner, outer, .. } => {
                stiffness * (*inner * position + (*outer - *inner) * self.beyond(position))
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
            Self::Bilinear { inner, outer, .. } => {
                let beyond = self.beyond(position);
                stiffness * (*inner * position * position + (*outer - *inner) * beyond * beyond) * 0.5
            }
        }
    }

    /// (|x| − g)₊ sgn x, how far `position` (m) is beyond a corner.
    fn beyond(&self, position: D) -> D {
        match self.corner() {
            Some(corner) if position.value().abs() > corner.value() => position - corner * position.value().signum(),
            _ => D::from(0.0),
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

    /// Force and energy on either side of the corners, by hand.
    #[test]
    fn corners_are_on_both_sides() {
        let (stop, gap) = (Restoring::stop(0.5, 3.0).unwrap(), Restoring::gap(0.5).unwrap());
        for side in [-1.0, 1.0] {
            assert_eq!((stop.force(8.0, 0.5 * side), stop.force(8.0, 0.75 * side)), (4.0 * side, 10.0 * side));
            assert_eq!((stop.energy(8.0, 0.5 * side), stop.energy(8.0, 0.75 * side)), (1.0, 2.75));
            assert_eq!((gap.force(8.0, 0.4 * side), gap.force(8.0, 0.75 * side)), (0.0, 2.0 * side));
            assert_eq!((gap.energy(8.0, 0.4 * side), gap.energy(8.0, 0.75 * side)), (0.0, 0.25));
            assert_eq!((stop.slope(8.0, 0.4 * side).0, stop.slope(8.0, 0.6 * side).0), (8.0, 24.0));
            assert_eq!((gap.slope(8.0, 0.4 * side).0, gap.slope(8.0, 0.6 * side).0), (0.0, 8.0));
        }
        assert_eq!(stop.map(|number| number), stop);
        assert!(Restoring::stop(0.0, 1.0).is_err() && Restoring::stop(1.0, -0.1).is_err());
        assert!(Restoring::gap(-1.0).is_err() && Restoring::gap(f64::NAN).is_err());
    }
}
