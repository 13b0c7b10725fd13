//! Machine: knowledge beside the records.

mod known;
pub(crate) mod term;
mod terms;

pub use known::Known;
pub use terms::Terms;

use fmm_model::{ModelError, Restoring};

/// Knowledge of the machine besides the records of its motion.
///
/// A free vibration shows the natural frequency, damping per mass and friction per mass; multiplying mass,
/// stiffness, damping and friction by one factor changes nothing in it. The *scale* (a mass or a stiffness) and
/// the normal load therefore have to come from elsewhere, with an uncertainty of their own.
///
/// | known | gives |
/// |---|---|
/// | nothing | natural frequency, damping and friction per mass |
/// | mass or stiffness | the other one, damping and friction force |
/// | normal load as well | friction coefficient |
///
/// ```
/// use fmm_identify::{Known, Machine};
///
/// let machine = Machine::of_mass(Known::new(10.391, 0.005)?)?.with_normal_load(Known::new(14.0, 0.02)?)?;
/// assert_eq!(machine.normal_load().map(|load| load.value()), Some(14.0));
/// assert!(Machine::of_mass(Known::exact(-1.0)?).is_err());
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Machine {
    scale: Scale,
    damping: Option<Known>,
    normal_load: Option<Known>,
    /// Standard uncertainty of the change of the friction for each half cycle (1).
    steadiness: Option<f64>,
    restoring: Restoring,
}

/// Scale of the equation of motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Scale {
    /// No scale: everything per unit mass.
    PerUnitMass,
    /// The mass is known (kg).
    Mass(Known),
    /// The stiffness is known (N/m).
    Stiffness(Known),
    /// Mass (kg) and stiffness (N/m) are both known.
    MassAndStiffness(Known, Known),
    /// Mass and stiffness are both to be found, which no free vibration can do; a fit says so.
    Unknown,
}

impl Scale {
    /// Mass (kg) and stiffness (N/m), as far as they are known.
    pub(crate) fn known(self) -> (Option<Known>, Option<Known>) {
        match self {
            Self::Mass(mass) => (Some(mass), None),
            Self::Stiffness(stiffness) => (None, Some(stiffness)),
            Self::MassAndStiffness(mass, stiffness) => (Some(mass), Some(stiffness)),
            Self::PerUnitMass | Self::Unknown => (None, None),
        }
    }

    /// The same with its known values changed.
    fn map(self, change: impl Fn(Known) -> Known) -> Self {
        match self {
            Self::Mass(mass) => Self::Mass(change(mass)),
            Self::Stiffness(stiffness) => Self::Stiffness(change(stiffness)),
            Self::MassAndStiffness(mass, stiffness) => Self::MassAndStiffness(change(mass), change(stiffness)),
            other => other,
        }
    }
}

impl Machine {
    /// Nothing is known: everything is found per unit mass.
    pub const fn per_unit_mass() -> Self {
        Self {
            scale: Scale::PerUnitMass,
            damping: None,
            normal_load: None,
            steadiness: None,
            restoring: Restoring::Linear,
        }
    }

    /// A machine of known `mass` (kg).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if the mass is zero or negative.
    pub fn of_mass(mass: Known) -> Result<Self, ModelError> {
        ModelError::require_positive("mass", mass.value(), "kg")?;
        Ok(Self { scale: Scale::Mass(mass), ..Self::per_unit_mass() })
    }

    /// A machine of known `stiffness` (N/m).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if the stiffness is zero or negative.
    pub fn of_stiffness(stiffness: Known) -> Result<Self, ModelError> {
        ModelError::require_positive("stiffness", stiffness.value(), "N/m")?;
        Ok(Self { scale: Scale::Stiffness(stiffness), ..Self::per_unit_mass() })
    }

    /// A machine of known `mass` (kg) and `stiffness` (N/m), such as one that is hit by a hammer: a measured force
    /// gives its motion a scale.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if one of them is zero or negative.
    pub fn of_mass_and_stiffness(mass: Known, stiffness: Known) -> Result<Self, ModelError> {
        ModelError::require_positive("mass", mass.value(), "kg")?;
        ModelError::require_positive("stiffness", stiffness.value(), "N/m")?;
        Ok(Self { scale: Scale::MassAndStiffness(mass, stiffness), ..Self::per_unit_mass() })
    }

    /// A machine whose mass *and* stiffness are to be found, which takes a measured force:
    /// [`Drive::force`](crate::Drive::force) or [`Experiment::impact`](crate::Experiment::impact).
    ///
    /// Free vibrations alone do not tell them, as the thesis' appendix A1 supposes: the fit then reports the direction
    /// in which mass, stiffness, damping and friction may be scaled together.
    pub const fn unknown() -> Self {
        Self { scale: Scale::Unknown, damping: None, normal_load: None, steadiness: None, restoring: Restoring::Linear }
    }

    /// The same machine with a linear damping of its own that is known, for instance from a ring-down without the
    /// contact, and held in the fit (N s/m; 1/s if no scale is known).
    ///
    /// # Errors
    /// [`ModelError::Negative`] if the damping is negative.
    pub fn with_damping(mut self, damping: Known) -> Result<Self, ModelError> {
        ModelError::require_not_negative("linear damping", damping.value(), "N s/m")?;
        self.damping = Some(damping);
        Ok(self)
    }

    /// The same machine with a known normal load (N) on its contact.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if the load is zero or negative.
    pub fn with_normal_load(mut self, load: Known) -> Result<Self, ModelError> {
        ModelError::require_positive("normal load", load.value(), "N")?;
        self.normal_load = Some(load);
        Ok(self)
    }

    /// The same machine with friction that is known to change by no more than this standard uncertainty for each half
    /// cycle, relative to itself (1): each fit by a law of the sliding speed then has the term
    /// [change](Terms::with_change), of which this is known, and its uncertainty is in that of the findings. Laws with
    /// internal state do not take the term: for them it changes nothing.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if it is zero or negative.
    pub fn with_steady_friction(mut self, uncertainty: f64) -> Result<Self, ModelError> {
        ModelError::require_positive("steadiness of the friction", uncertainty, "(for each half cycle)")?;
        self.steadiness = Some(uncertainty);
        Ok(self)
    }

    /// The same machine with another restoring force than that of a linear spring. A length in it is in the unit of
    /// position that belongs to the record: for angles in radians the sine has length 1.
    #[must_use]
    pub const fn with_restoring(mut self, restoring: Restoring) -> Self {
        self.restoring = restoring;
        self
    }

    /// The restoring force.
    pub const fn restoring(&self) -> Restoring {
        self.restoring
    }

    /// Knowledge of mass and stiffness.
    pub(crate) const fn scale(&self) -> Scale {
        self.scale
    }

    /// The machine's own damping, if it is known.
    pub const fn damping(&self) -> Option<Known> {
        self.damping
    }

    /// Standard uncertainty of the change of the friction for each half cycle (1), if it is known.
    pub const fn steadiness(&self) -> Option<f64> {
        self.steadiness
    }

    /// The normal load, if it is known.
    pub const fn normal_load(&self) -> Option<Known> {
        self.normal_load
    }

    /// The same machine with another scale.
    pub(crate) const fn scaled(&self, scale: Scale) -> Self {
        Self { scale, ..*self }
    }

    /// The same machine with its scale and its normal load these standard uncertainties away, which stay positive.
    #[cfg(feature = "sampler")]
    pub(crate) fn with_scale_and_load_moved(&self, [scale, load]: [f64; 2]) -> Self {
        let moved = |known: Known, by: f64| {
            let value = known.value() + by * known.uncertainty();
            known.moved_to(if value > 0.0 { value } else { known.value() })
        };
        let scale = self.scale.map(|known| moved(known, scale));
        Self { scale, normal_load: self.normal_load.map(|known| moved(known, load)), ..*self }
    }

    /// The same machine with everything that is known of it taken as exact.
    pub(crate) fn exactly(&self) -> Self {
        let scale = self.scale.map(Known::exactly);
        let (damping, normal_load) = (self.damping.map(Known::exactly), self.normal_load.map(Known::exactly));
        Self { scale, damping, normal_load, ..*self }
    }
}
