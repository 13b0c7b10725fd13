//! The physical quantity that a channel measured.

use crate::RecordError;

/// The physical quantity of a record.
///
/// Displacement, velocity and acceleration stand for linear or angular motion alike; the unit of the record says
/// which (`"m/s"`, `"rad/s"`, or `"V"` for a sensor whose gain is not known).
///
/// ```
/// use fmm_record::Quantity;
///
/// assert_eq!(Quantity::Velocity.integral()?, Quantity::Displacement);
/// assert_eq!(Quantity::Velocity.derivative()?, Quantity::Acceleration);
/// assert!(Quantity::Force.derivative().is_err());
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Quantity {
    /// Position or angle.
    Displacement,
    /// Its first derivative in time.
    Velocity,
    /// Its second derivative in time.
    Acceleration,
    /// Force or torque.
    Force,
    /// Anything else, or not known.
    #[default]
    Other,
}

impl Quantity {
    /// The quantity of the integral over time.
    ///
    /// # Errors
    /// [`RecordError::Unsupported`] unless this is an acceleration or a velocity.
    pub fn integral(self) -> Result<Self, RecordError> {
        match self {
            Self::Acceleration => Ok(Self::Velocity),
            Self::Velocity => Ok(Self::Displacement),
            quantity => Err(RecordError::unsupported(format!(
                "a record of {quantity} cannot be integrated; only acceleration and velocity can"
            ))),
        }
    }

    /// The quantity of the derivative in time.
    ///
    /// # Errors
    /// [`RecordError::Unsupported`] unless this is a displacement or a velocity.
    pub fn derivative(self) -> Result<Self, RecordError> {
        match self {
            Self::Displacement => Ok(Self::Velocity),
            Self::Velocity => Ok(Self::Acceleration),
            quantity => Err(RecordError::unsupported(format!(
                "a record of {quantity} cannot be differentiated; only displacement and velocity can"
            ))),
        }
    }
}

impl std::fmt::Display for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Force => "force",
            Self::Other => "other quantity",
        })
    }
}
