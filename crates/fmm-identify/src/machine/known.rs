//! A quantity that is known from elsewhere.

use fmm_model::ModelError;

/// A value that the record does not determine but somebody measured: an estimate and its standard uncertainty.
///
/// ```
/// use fmm_identify::Known;
///
/// let mass = Known::new(10.391, 0.005)?;
/// assert_eq!((mass.value(), mass.uncertainty()), (10.391, 0.005));
/// assert_eq!(Known::exact(14.0)?.uncertainty(), 0.0);
/// assert!(Known::new(1.0, -0.1).is_err());
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    value: f64,
    uncertainty: f64,
}

impl Known {
    /// Zero without uncertainty.
    pub(crate) const NOTHING: Self = Self { value: 0.0, uncertainty: 0.0 };

    /// `value` with its standard `uncertainty`, both in the same unit.
    ///
    /// # Errors
    /// [`ModelError`] if the value is not finite or the uncertainty is negative or not finite.
    pub fn new(value: f64, uncertainty: f64) -> Result<Self, ModelError> {
        let value = ModelError::require_finite("known value", value, "(in its own unit)")?;
        let uncertainty =
            ModelError::require_not_negative("standard uncertainty", uncertainty, "(in the unit of the value)")?;
        Ok(Self { value, uncertainty })
    }

    /// `value` without uncertainty.
    ///
    /// # Errors
    /// [`ModelError`] if the value is not finite.
    pub fn exact(value: f64) -> Result<Self, ModelError> {
        Self::new(value, 0.0)
    }

    /// The estimate.
    pub const fn value(&self) -> f64 {
        self.value
    }

    /// u, its standard uncertainty, in the unit of the value.
    pub const fn uncertainty(&self) -> f64 {
        self.uncertainty
    }

    /// The same value without uncertainty.
    pub(crate) const fn exactly(self) -> Self {
        Self { uncertainty: 0.0, ..self }
    }

    /// The same uncertainty about another value.
    pub(crate) const fn moved_to(self, value: f64) -> Self {
        Self { value, ..self }
    }
}
