//! Machine that is hit: all that is known of it.

use fmm_model::{ModelError, Oscillator};

use crate::machine::Known;

/// What is known of a machine that is hit: all of it, as a measured force gives the motion its scale.
///
/// The damping is 0 and the normal load 1 N until they are given; with a load of 1 N the law's coefficients are forces.
///
/// ```
/// use fmm_identify::{ImpactMachine, Known};
///
/// // The machine of the thesis.
/// let machine = ImpactMachine::new(Known::new(10.391, 0.0049)?, Known::new(1982.0, 1.3)?)?
///     .with_damping(Known::new(0.275, 0.034)?)?
///     .with_normal_load(Known::new(6.67, 0.01)?)?;
/// assert!((machine.natural_frequency_hz() - 2.1981).abs() < 1e-4);
/// assert!(ImpactMachine::new(Known::exact(0.0)?, Known::exact(1982.0)?).is_err());
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImpactMachine {
    mass: Known,
    stiffness: Known,
    damping: Known,
    normal_load: Known,
    natural_frequency: f64,
}

impl ImpactMachine {
    /// A machine of this `mass` (kg) and `stiffness` (N/m).
    ///
    /// # Errors
    /// [`ModelError`] if one of them is zero or negative, or if they have no natural frequency together.
    pub fn new(mass: Known, stiffness: Known) -> Result<Self, ModelError> {
        let oscillator = Oscillator::new(mass.value(), stiffness.value())?;
        let natural_frequency = oscillator.natural_angular_frequency() / std::f64::consts::TAU;
        ModelError::require_positive("natural frequency", natural_frequency, "Hz")?;
        let (damping, normal_load) = (Known::exact(0.0)?, Known::exact(1.0)?);
        Ok(Self { mass, stiffness, damping, normal_load, natural_frequency })
    }

    /// The same machine with a linear `damping` of its own (N s/m).
    ///
    /// # Errors
    /// [`ModelError::Negative`] if it is negative.
    pub fn with_damping(mut self, damping: Known) -> Result<Self, ModelError> {
        ModelError::require_not_negative("linear damping", damping.value(), "N s/m")?;
        self.damping = damping;
        Ok(self)
    }

    /// The same machine with a normal `load` (N) on its contact.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if it is zero or negative.
    pub fn with_normal_load(mut self, load: Known) -> Result<Self, ModelError> {
        ModelError::require_positive("normal load", load.value(), "N")?;
        self.normal_load = load;
        Ok(self)
    }

    /// m (kg).
    pub const fn mass(&self) -> Known {
        self.mass
    }

    /// k (N/m).
    pub const fn stiffness(&self) -> Known {
        self.stiffness
    }

    /// c (N s/m).
    pub const fn damping(&self) -> Known {
        self.damping
    }

    /// N (N).
    pub const fn normal_load(&self) -> Known {
        self.normal_load
    }

    /// √(k/m)/2π (Hz).
    pub const fn natural_frequency_hz(&self) -> f64 {
        self.natural_frequency
    }
}
