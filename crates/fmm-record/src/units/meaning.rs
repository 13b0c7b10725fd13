//! The meaning of a channel's numbers, and why it may not be known.

use crate::Quantity;

/// Meaning of the numbers of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Meaning {
    /// Measured quantity; never [`Quantity::Other`].
    pub quantity: Quantity,
    /// Factor from its numbers to the unit below (that unit per unit of the file).
    pub factor: f64,
    /// The unit of the numbers times the factor: the SI unit, or `counts`.
    pub unit: &'static str,
    /// Whether this unit is written nowhere, but taken as the SI unit of the quantity that was said.
    pub is_assumed: bool,
}

/// As `velocity in m/s`.
impl std::fmt::Display for Meaning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let taken = if self.is_assumed { ", taken to be" } else { "" };
        write!(f, "{}{taken} in {}", self.quantity, self.unit)?;
        if self.factor == 1.0 { Ok(()) } else { write!(f, " after a factor of {}", self.factor) }
    }
}

/// Reason why quantity, unit or channel are not clear.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeaningError {
    /// The unit as written is not known.
    #[error("the unit \"{unit}\" of channel \"{channel}\" is not known")]
    UnknownUnit {
        /// Name of the channel.
        channel: String,
        /// Unit as written.
        unit: String,
    },
    /// The channel is in counts of an instrument, whose size is not known.
    #[error("channel \"{channel}\" is in {unit}, whose size is not known")]
    Counts {
        /// Name of the channel.
        channel: String,
        /// The unit as written.
        unit: String,
    },
    /// The quantity is known, a unit is written nowhere.
    #[error("channel \"{channel}\" is a record of {quantity}, but its unit is written nowhere")]
    NoUnit {
        /// Name of the channel.
        channel: String,
        /// The quantity.
        quantity: Quantity,
        /// The SI unit that it probably leads to.
        likely: &'static str,
    },
    /// A unit is known that any quantity may have.
    #[error("channel \"{channel}\" is in {unit}, which does not tell what it measured")]
    NoQuantity {
        /// Name of the channel.
        channel: String,
        /// The unit.
        unit: String,
    },
    /// Neither a unit nor a word for the quantity.
    #[error("channel \"{channel}\" has neither a unit nor a name that tells what it measured")]
    Nothing {
        /// Name of the channel.
        channel: String,
    },
    /// The unit in the file is one of another quantity than the one said.
    #[error("channel \"{channel}\" is in {unit}, which is a unit of {measured}, not of {said}")]
    OtherQuantity {
        /// Name of the channel.
        channel: String,
        /// The unit as written in the file.
        unit: String,
        /// The quantity of that unit.
        measured: Quantity,
        /// The quantity said.
        said: Quantity,
    },
    /// The name or the format tells another quantity than the unit or the user.
    #[error("the file says that channel \"{channel}\" is a record of {told}, but {}", basis(unit.as_deref(), *other))]
    Contradiction {
        /// Name of the channel.
        channel: String,
        /// Quantity by the name or the format.
        told: Quantity,
        /// The unit in use, if the other quantity is that of it; else it was said.
        unit: Option<String>,
        /// The other quantity.
        other: Quantity,
    },
    /// The unit said is not the one in the file.
    #[error("channel \"{channel}\" is in {written}, not in {said}")]
    OtherUnit {
        /// Name of the channel.
        channel: String,
        /// The unit as written in the file.
        written: String,
        /// The unit said.
        said: String,
    },
    /// A factor was said that is not that of the unit in the file, and no unit that it leads to.
    #[error("channel \"{channel}\" is in {written}; a factor of {scale} leads to a unit that was not said")]
    ScaleAlone {
        /// Name of the channel.
        channel: String,
        /// The unit as written in the file.
        written: String,
        /// The factor said.
        scale: f64,
    },
    /// The quantity and the unit that were said contradict each other.
    #[error("{unit} is a unit of {measured}, not of {said}")]
    Said {
        /// The unit said.
        unit: String,
        /// The quantity of that unit.
        measured: Quantity,
        /// The quantity said.
        said: Quantity,
    },
    /// More than one channel may be meant, or none of several.
    #[error("it is not clear which channel is the {}; there are: {}", said.map_or("motion".into(), |said| said.to_string()), channels.join(", "))]
    WhichChannel {
        /// The quantity said.
        said: Option<Quantity>,
        /// The channels, each with its known quantity and unit.
        channels: Vec<String>,
    },
}

/// Origin of a quantity that differs from that of the file.
fn basis(unit: Option<&str>, other: Quantity) -> String {
    match unit {
        Some(unit) => format!("{unit} is a unit of {other}"),
        None => format!("it was said to be one of {other}"),
    }
}
