//! The tilt of a shaft from displacements measured at two places.

use crate::{ModelError, Scalar};

/// The angle by which a straight shaft leans, from its sideways displacement at two places along it.
///
/// ```text
/// φ = arctan((x₁ − x₂)/s)                                          (thesis 4.3)
/// ```
///
/// ```
/// use fmm_model::Tilt;
///
/// // 1.6 µm between two sensors 10.8 cm apart.
/// let tilt: Tilt = Tilt::from_displacements(1.6e-6, 0.0, 0.108)?;
/// assert!((tilt.degrees() - 8.488e-4).abs() < 5e-8);
/// assert!((tilt.arcseconds() - 3.056).abs() < 5e-4);
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tilt<D = f64> {
    radians: D,
}

impl<D: Scalar> Tilt<D> {
    /// The tilt at which two sensors, `spacing` s (m) apart along the shaft, show the displacements `first` x₁ and
    /// `second` x₂ (m).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if the spacing is zero, negative or not finite, [`ModelError::NotFinite`] if the
    /// difference of the displacements is not finite.
    pub fn from_displacements(first: D, second: D, spacing: D) -> Result<Self, ModelError> {
        ModelError::require_positive("spacing of two sensors", spacing.value(), "m")?;
        let difference = first - second;
        ModelError::require_finite("difference of two displacements", difference.value(), "m")?;
        Ok(Self { radians: difference.atan2(spacing) })
    }

    /// φ (rad), positive if the first displacement is the larger one.
    pub fn radians(&self) -> D {
        self.radians
    }

    /// φ in degrees.
    pub fn degrees(&self) -> D {
        self.radians * 1f64.to_degrees()
    }

    /// φ in seconds of arc, 3600 to the degree.
    pub fn arcseconds(&self) -> D {
        self.degrees() * 3600.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    #[test]
    fn tilts_have_their_sign_and_units() {
        let tilt = |first: f64, second| Tilt::from_displacements(first, second, 0.5).unwrap();
        assert!((tilt(0.7, 0.2).degrees() - 45.0).abs() < 1e-13);
        assert!((tilt(0.2, 0.7).arcseconds() + 162_000.0).abs() < 1e-9);
        assert_eq!(tilt(0.3, 0.3).radians(), 0.0);
        let sensitive = Tilt::from_displacements(Dual::<1>::variable(0.0, 0), 0.0.into(), 0.5.into()).unwrap();
        assert_eq!(sensitive.radians().partial(0), 2.0);
    }

    #[test]
    fn impossible_tilts_are_refused() {
        for bad in [0.0, -0.1, f64::NAN, f64::INFINITY] {
            assert!(Tilt::from_displacements(1e-6, 0.0, bad).is_err(), "spacing {bad} m");
        }
        assert!(Tilt::from_displacements(f64::NAN, 0.0, 0.1).is_err());
        assert!(Tilt::from_displacements(f64::MAX, -f64::MAX, 0.1).is_err());
    }
}
