//! Header of a data set 58, and the numbers by which the format calls functions and quantities.

use crate::units::Quantity;

/// Labels, place and axes of a function. Texts are empty where the file says `NONE`.
///
/// The fields are free; [`write()`](super::write()) refuses what does not fit into the columns of the format.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Header {
    /// Five lines of text, of 80 characters at most: the description of the function, a second line, the date
    /// (`07-Jun-24 12:00:00`), two more.
    pub lines: [String; 5],
    /// The kind of function.
    pub function: FunctionType,
    /// Number of the function.
    pub identification: i32,
    /// Version or sequence number.
    pub version: i32,
    /// Load case; 0 for excitation at one point.
    pub load_case: i32,
    /// Place and direction of the measured response.
    pub response: Freedom,
    /// Place and direction of the excitation, or the reference of the response.
    pub reference: Freedom,
    /// Value on the z axis, 0 if there is none.
    pub z: f64,
    /// The axis of the abscissa.
    pub abscissa: Axis,
    /// The axis of the ordinate, or of its numerator.
    pub ordinate: Axis,
    /// The axis of the denominator of the ordinate.
    pub denominator: Axis,
    /// The z axis.
    pub z_axis: Axis,
}

/// A point of a structure and a direction there.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Freedom {
    /// Name of the part, of 10 characters at most.
    pub entity: String,
    /// Number of the point.
    pub node: i32,
    /// Direction: ±1, ±2, ±3 along x, y, z, ±4, ±5, ±6 about them, 0 for a scalar.
    pub direction: i32,
}

/// Text such as `3+Z` or `part:3-RX`; a scalar has no direction.
impl std::fmt::Display for Freedom {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        const DIRECTIONS: [&str; 6] = ["X", "Y", "Z", "RX", "RY", "RZ"];
        if !self.entity.is_empty() {
            write!(f, "{}:", self.entity)?;
        }
        write!(f, "{}", self.node)?;
        let axis = self.direction.unsigned_abs() as usize;
        match DIRECTIONS.get(axis.wrapping_sub(1)) {
            Some(name) => write!(f, "{}{name}", if self.direction < 0 { '-' } else { '+' }),
            None => Ok(()),
        }
    }
}

/// An axis of a function.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Axis {
    /// Quantity on the axis.
    pub data_type: DataType,
    /// Exponents of length, force and temperature in its unit, meant only for [`DataType::GENERAL`].
    pub exponents: [i32; 3],
    /// Its label, of 20 characters at most.
    pub label: String,
    /// Its unit, of 20 characters at most.
    pub unit: String,
}

impl Axis {
    /// An axis without exponents.
    pub fn new(data_type: DataType, label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { data_type, exponents: [0; 3], label: label.into(), unit: unit.into() }
    }
}

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
    /// Frequency response function.
    pub const FREQUENCY_RESPONSE: Self = Self(4);

    /// Names in the order of their numbers, from 0 on.
    const NAMES: &str = "\
        general function|time response|auto spectrum|cross spectrum|frequency response|transmissibility|\
        coherence|auto correlation|cross correlation|power spectral density|energy spectral density|\
        probability density|spectrum|cumulative frequency distribution|peaks and valleys|stress over cycles|\
        strain over cycles|orbit|mode indicator function|force pattern|partial power|partial coherence|\
        eigenvalue|eigenvector|shock response spectrum|finite impulse response filter|multiple coherence|\
        order function|phase compensation";
}

impl std::fmt::Display for FunctionType {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match usize::try_from(self.0).ok().and_then(|code| Self::NAMES.split('|').nth(code)) {
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
        MEASURED.iter().find(|(data_type, _)| *data_type == self).map_or(Quantity::Other, |(_, quantity)| *quantity)
    }
}

/// Data types with the quantity that each stands for; of two for one quantity, the first is written.
const MEASURED: [(DataType, Quantity); 5] = [
    (DataType::DISPLACEMENT, Quantity::Displacement),
    (DataType::VELOCITY, Quantity::Velocity),
    (DataType::ACCELERATION, Quantity::Acceleration),
    (DataType::EXCITATION_FORCE, Quantity::Force),
    (DataType::REACTION_FORCE, Quantity::Force),
];

impl From<Quantity> for DataType {
    fn from(quantity: Quantity) -> Self {
        MEASURED.iter().find(|(_, other)| *other == quantity).map_or(Self::UNKNOWN, |(data_type, _)| *data_type)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_read_as_engineers_write_them() {
        let freedom = |entity: &str, node, direction| Freedom { entity: entity.into(), node, direction }.to_string();
        assert_eq!(freedom("", 3, 3), "3+Z");
        assert_eq!(freedom("frame", 12, -4), "frame:12-RX");
        assert_eq!(freedom("", 0, 0), "0");
        assert_eq!(freedom("", 1, i32::MIN), "1");
    }
}
