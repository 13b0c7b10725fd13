//! The numbers by which the format calls functions and quantities.

use crate::Quantity;

/// Kind of function of a data set, by its number in the format.
///
/// ```
/// use fmm_record::uff::FunctionType;
///
/// assert_eq!(FunctionType(4), FunctionType::FREQUENCY_RESPONSE);
/// assert_eq!(FunctionType(4).to_string(), "frequency response");
/// assert_eq!(FunctionType(99).to_string(), "function of type 99");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct FunctionType(pub i32);

impl FunctionType {
    /// General, or not known.
    pub const GENERAL: Self = Self(0);
    /// A record over time.
    pub const TIME_RESPONSE: Self = Self(1);
    /// Auto spectrum.
    pub const AUTO_SPECTRUM: Self = Self(2);
    /// Cross spectrum.
    pub const CROSS_SPECTRUM: Self = Self(3);
    /// Frequency response function.
    pub const FREQUENCY_RESPONSE: Self = Self(4);
    /// Transmissibility.
    pub const TRANSMISSIBILITY: Self = Self(5);
    /// Coherence.
    pub const COHERENCE: Self = Self(6);
    /// Power spectral density.
    pub const POWER_SPECTRAL_DENSITY: Self = Self(9);
    /// Spectrum.
    pub const SPECTRUM: Self = Self(12);

    /// Names in the order of their numbers.
    const NAMES: [&str; 29] = [
        "general function",
        "time response",
        "auto spectrum",
        "cross spectrum",
        "frequency response",
        "transmissibility",
        "coherence",
        "auto correlation",
        "cross correlation",
        "power spectral density",
        "energy spectral density",
        "probability density",
        "spectrum",
        "cumulative frequency distribution",
        "peaks and valleys",
        "stress over cycles",
        "strain over cycles",
        "orbit",
        "mode indicator function",
        "force pattern",
        "partial power",
        "partial coherence",
        "eigenvalue",
        "eigenvector",
        "shock response spectrum",
        "finite impulse response filter",
        "multiple coherence",
        "order function",
        "phase compensation",
    ];
}

impl std::fmt::Display for FunctionType {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match usize::try_from(self.0).ok().and_then(|code| Self::NAMES.get(code)) {
            Some(name) => f.write_str(name),
            None => write!(f, "function of type {}", self.0),
        }
    }
}

/// Quantity on an axis of a data set, by its number in the format.
///
/// ```
/// use fmm_record::Quantity;
/// use fmm_record::uff::DataType;
///
/// assert_eq!(DataType(11), DataType::VELOCITY);
/// assert_eq!(DataType::VELOCITY.quantity(), Quantity::Velocity);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct DataType(pub i32);

impl DataType {
    /// Not known, or no axis.
    pub const UNKNOWN: Self = Self(0);
    /// Something general, to be told from its exponents or its labels.
    pub const GENERAL: Self = Self(1);
    /// Displacement.
    pub const DISPLACEMENT: Self = Self(8);
    /// Reaction force.
    pub const REACTION_FORCE: Self = Self(9);
    /// Velocity.
    pub const VELOCITY: Self = Self(11);
    /// Acceleration.
    pub const ACCELERATION: Self = Self(12);
    /// Excitation force.
    pub const EXCITATION_FORCE: Self = Self(13);
    /// Time.
    pub const TIME: Self = Self(17);
    /// Frequency.
    pub const FREQUENCY: Self = Self(18);

    /// The quantity of a record with such an ordinate.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::DISPLACEMENT => Quantity::Displacement,
            Self::VELOCITY => Quantity::Velocity,
            Self::ACCELERATION => Quantity::Acceleration,
            Self::REACTION_FORCE | Self::EXCITATION_FORCE => Quantity::Force,
            _ => Quantity::Other,
        }
    }
}

impl From<Quantity> for DataType {
    fn from(quantity: Quantity) -> Self {
        match quantity {
            Quantity::Displacement => Self::DISPLACEMENT,
            Quantity::Velocity => Self::VELOCITY,
            Quantity::Acceleration => Self::ACCELERATION,
            Quantity::Force => Self::EXCITATION_FORCE,
            Quantity::Other => Self::UNKNOWN,
        }
    }
}
