//! Header of a data set 58 beside the form of its points.

use super::{DataType, FunctionType};

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
pub struct Freedom {
    /// Name of the part, of 10 characters at most.
    pub entity: String,
    /// Number of the point.
    pub node: i32,
    /// Direction: ±1, ±2, ±3 along x, y, z, ±4, ±5, ±6 about them, 0 for a scalar.
    pub direction: i32,
}

/// As `3+Z` or `part:3-RX`; a scalar has no direction.
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
