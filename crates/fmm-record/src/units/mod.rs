//! Quantities and units of channels.

pub(crate) mod label;
pub(crate) mod request;
pub(crate) mod word;

use std::fmt;
use std::str::FromStr;

use fmm_model::{Dimension, Unit};

use crate::error::RecordError;

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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
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

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Force => "force",
            Self::Other => "other quantity",
        })
    }
}

/// Unit of a channel as a person or an instrument wrote it, with its SI unit.
///
/// | measures | spellings, for example |
/// |---|---|
/// | length | `m`, `mm`, `µm`, `um`, `micron`, `in`, `mil`, `ft`, `millimetres` |
/// | angle | `rad`, `mrad`, `deg`, `°`, `rev` |
/// | velocity | a length or an angle per time: `mm/s`, `m s^-1`, `ms⁻¹`, `km/h`, `deg/sec`, `°/s`; `rpm`, `1/min`, `U/min`, `dps`, `ips`, `mph` |
/// | acceleration | one per time squared: `m/s^2`, `m/s²`, `m/s**2`, `mm/s/s`, `rad/s2`; `g`, `gn`, `mg` |
/// | force, torque | `N`, `kN`, `mN`, `lbf`, `lb`, `kip`, `kgf`, `N m`, `N mm`, `lb ft` |
/// | anything | `V`, `mV`, `A`, `mA`; `counts`, `ticks`, `LSB`, of unknown size |
///
/// The micro sign may be U+00B5, U+03BC or `u`. Capitals matter where a prefix or a unit would be another with them:
/// `mN` and `MN`, `g` and `G`; words and other units of motion may be in any case, as in `MM/S`.
///
/// ```
/// use fmm_record::{Quantity, WrittenUnit};
///
/// let unit: WrittenUnit = "mm/s²".parse()?;
/// assert_eq!((unit.factor(), unit.si(), unit.quantity()), (1e-3, "m/s²", Quantity::Acceleration));
/// assert_eq!("mV".parse::<WrittenUnit>()?.quantity(), Quantity::Other);
/// assert_eq!("furlong".parse::<WrittenUnit>().unwrap_err().to_string(), "the unit \"furlong\" is not known");
/// # Ok::<(), fmm_record::RecordError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenUnit {
    written: String,
    si: &'static str,
    factor: f64,
    quantity: Quantity,
}

/// Unit of counts, whose size is not known.
const COUNTS: &str = "counts";

/// The SI units of channels with their quantities, those of motion in the order of its derivatives.
const MEASURED: [(&str, Quantity); 11] = [
    ("m", Quantity::Displacement),
    ("m/s", Quantity::Velocity),
    ("m/s²", Quantity::Acceleration),
    ("rad", Quantity::Displacement),
    ("rad/s", Quantity::Velocity),
    ("rad/s²", Quantity::Acceleration),
    ("N", Quantity::Force),
    ("N m", Quantity::Force),
    ("V", Quantity::Other),
    ("A", Quantity::Other),
    (COUNTS, Quantity::Other),
];

impl WrittenUnit {
    /// The SI unit: `m`, `rad`, `m/s`, `rad/s`, `m/s²`, `rad/s²`, `N`, `N m`, `V`, `A`; or `counts`, which has none.
    pub fn si(&self) -> &'static str {
        self.si
    }

    /// Factor from a number in this unit to one in the SI unit (SI unit per unit); 1 for counts.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// The quantity that has such a unit; [`Quantity::Other`] for volts, amperes and counts, which may be of any.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// The quantity, if the unit shows it: not that of volts, amperes and counts.
    pub(crate) fn shown_quantity(&self) -> Option<Quantity> {
        Some(self.quantity).filter(|quantity| *quantity != Quantity::Other)
    }

    /// True for the steps of an instrument, whose size the unit does not show.
    pub fn is_counts(&self) -> bool {
        self.si == COUNTS
    }

    /// True if both mean the same, however they are spelled.
    pub fn is_same_as(&self, other: &Self) -> bool {
        self.si == other.si && self.factor == other.factor
    }
}

/// The SI unit of a quantity of linear motion, or of the angular one; `None` for other quantities.
pub(crate) fn unit_of_motion(quantity: Quantity, angular: bool) -> Option<&'static str> {
    let [linear, angles] = [&MEASURED[..3], &MEASURED[3..6]];
    let motions = if angular { angles } else { linear };
    motions.iter().find(|(_, other)| *other == quantity).map(|(unit, _)| *unit)
}

/// Number of seconds in a unit of time as files write it; no unit means seconds.
pub(crate) fn seconds_in(unit: &str) -> Option<f64> {
    let unit = if unit.trim().is_empty() { "s" } else { unit };
    let found = of_number(&Unit::written(unit)?)?;
    found.is_alike(&of_number(&Unit::of("s"))?).then(|| found.factor())
}

/// Dimension of a unit whose powers are numbers.
fn of_number(unit: &Unit) -> Option<Dimension> {
    unit.dimension(|_| None)
}

/// The written text.
impl fmt::Display for WrittenUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.written)
    }
}

/// Spellings of turns a minute, of which "one" and letters of other languages are units nowhere else.
const TURNS_A_MINUTE: [&str; 8] = ["1/min", "min-1", "min^-1", "min⁻¹", "u/min", "tr/min", "r/min", "umdr/min"];

impl FromStr for WrittenUnit {
    type Err = RecordError;

    fn from_str(text: &str) -> Result<Self, RecordError> {
        let written = text.trim().to_owned();
        let is_turns = TURNS_A_MINUTE.contains(&written.to_lowercase().as_str());
        let found = Unit::written(if is_turns { "rpm" } else { &written }).and_then(|unit| of_number(&unit)).and_then(
            |found| {
                let is_alike = |si: &str| of_number(&Unit::of(si)).is_some_and(|other| other.is_alike(&found));
                MEASURED.iter().find(|(si, _)| is_alike(si)).map(|measured| (found.factor(), *measured))
            },
        );
        match found {
            Some((factor, (si, quantity))) => Ok(Self { written, si, factor, quantity }),
            None => Err(RecordError::unclear(
                format!("the unit \"{written}\" is not known"),
                "write an SI unit, such as m/s",
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all_mean(spellings: &[&str], factor: f64, si: &str, quantity: Quantity) {
        for spelling in spellings {
            let unit: WrittenUnit = spelling.parse().unwrap_or_else(|error| panic!("{error}"));
            assert_eq!((unit.si(), unit.quantity()), (si, quantity), "{spelling}");
            assert!((unit.factor() / factor - 1.0).abs() < 1e-12, "{spelling}: {} against {factor}", unit.factor());
            assert_eq!(unit.to_string(), spelling.trim());
        }
    }

    #[test]
    fn lengths_and_angles() {
        let all = |spellings: &[&str], factor| all_mean(spellings, factor, "m", Quantity::Displacement);
        all(&["m", " m ", "M", "metre", "Meters", "meter", "metres"], 1.0);
        all(&["km", "kilometer"], 1e3);
        all(&["cm", "centimetres"], 1e-2);
        all(&["mm", "MM", "Mm", "millimeter", "Millimetres"], 1e-3);
        all(&["µm", "μm", "um", "mic", "micron", "microns", "micrometre"], 1e-6);
        all(&["nm"], 1e-9);
        all(&["in", "inch", "inches", "IN"], 0.0254);
        all(&["mil", "mils", "thou"], 25.4e-6);
        all(&["ft", "feet", "foot"], 0.3048);
        let all = |spellings: &[&str], factor| all_mean(spellings, factor, "rad", Quantity::Displacement);
        all(&["rad", "Rad", "radians", "RAD"], 1.0);
        all(&["mrad"], 1e-3);
        all(&["µrad", "μrad", "urad"], 1e-6);
        all(&["deg", "°", "º", "degrees", "Degree"], 0.017_453_292_519_943_295);
        all(&["rev", "revolutions"], std::f64::consts::TAU);
    }

    #[test]
    fn velocities() {
        let all = |spellings: &[&str], factor| all_mean(spellings, factor, "m/s", Quantity::Velocity);
        all(&["m/s", "m / s", "M/S", "m/sec", "m per s", "m·s⁻¹", "m s-1", "m s^-1", "ms^-1", "m*s^-1", "mps"], 1.0);
        all(&["metres per second", "(m/s)", "m.s-1", "mm/ms"], 1.0);
        all(&["mm/s", "mm/sec", "MM/S", "mm s⁻¹", "mms-1"], 1e-3);
        all(&["cm/s"], 1e-2);
        all(&["µm/s", "μm/s", "um/s", "micron/s"], 1e-6);
        all(&["in/s", "ips", "inch/sec"], 0.0254);
        all(&["ft/min"], 0.00508);
        all(&["km/h", "kph", "kmh", "km/hr"], 1.0 / 3.6);
        all(&["mph", "mi/h"], 0.447_04);
        let all = |spellings: &[&str], factor| all_mean(spellings, factor, "rad/s", Quantity::Velocity);
        all(&["rad/s", "rad/sec", "radians per second", "rad s^-1", "rads-1", "Rad/s"], 1.0);
        all(&["deg/s", "°/s", "deg/sec", "deg s^-1", "dps", "DPS", "degrees/second"], 0.017_453_292_519_943_295);
        all(&["mdps"], 17.453_292_519_943_295e-6);
        all(&["rev/s"], std::f64::consts::TAU);
        all(
            &["rpm", "RPM", "rev/min", "1/min", "min^-1", "min⁻¹", "U/min", "tr/min", "r/min"],
            0.104_719_755_119_659_77,
        );
    }

    #[test]
    fn accelerations_forces_and_signals() {
        let all = |spellings: &[&str], factor| all_mean(spellings, factor, "m/s²", Quantity::Acceleration);
        all(
            &["m/s^2", "m/s²", "m/s2", "m/s**2", "m/s/s", "m/sec^2", "m s^-2", "m·s⁻²", "ms-2", "m/(s^2)", "M/S^2"],
            1.0,
        );
        all(&["mm/s²", "mm/s^2", "mm/s2"], 1e-3);
        all(&["m/min²", "m/min/min"], 1.0 / 3600.0);
        all(&["g", "gn", "g0"], 9.806_65);
        all(&["mg"], 9.806_65e-3);
        let all = |spellings: &[&str], factor| all_mean(spellings, factor, "rad/s²", Quantity::Acceleration);
        all(&["rad/s²", "rad/s^2", "rad/sec/sec"], 1.0);
        all(&["deg/s²", "°/s^2"], 0.017_453_292_519_943_295);
        all_mean(&["N", "newton", "Newtons"], 1.0, "N", Quantity::Force);
        all_mean(&["kN"], 1e3, "N", Quantity::Force);
        all_mean(&["MN"], 1e6, "N", Quantity::Force);
        all_mean(&["mN"], 1e-3, "N", Quantity::Force);
        all_mean(&["lbf", "lb", "lbs"], 4.448_221_615_260_5, "N", Quantity::Force);
        all_mean(&["kip", "kips", "klbf"], 4_448.221_615_260_5, "N", Quantity::Force);
        all_mean(&["lbf ft", "lb ft", "ft lb"], 1.355_817_948_331_4, "N m", Quantity::Force);
        all_mean(&["Nm", "N m", "N·m", "N*m"], 1.0, "N m", Quantity::Force);
        all_mean(&["V", "volts", "Volt"], 1.0, "V", Quantity::Other);
        all_mean(&["mV"], 1e-3, "V", Quantity::Other);
        all_mean(&["counts", "Counts", "count", "ticks", "LSB"], 1.0, "counts", Quantity::Other);
    }

    #[test]
    fn what_is_no_unit_or_another_with_capitals_is_not_known() {
        let unknown = [
            "",
            " ",
            "-",
            "/",
            "//",
            "m/",
            "/s",
            "s",
            "Hz",
            "1/s",
            "furlong",
            "G",
            "Mg",
            "NM",
            "MV",
            "n",
            "v",
            "a",
            "kn",
            "m/s3",
            "m/s/s/s",
            "m/s/min",
            "N/s",
            "V/s",
            "m/m",
            "g/s",
            "rpm/s",
            "degC",
            "°C",
            "m s",
            "%",
            "counts/rev",
            "2",
            "s-1",
            "s-2",
            "mmm",
            "raw",
            "filtered",
            "\u{0}",
            "[m]",
        ];
        for text in unknown {
            let error = text.parse::<WrittenUnit>().unwrap_err();
            assert_eq!(error.to_string(), format!("the unit \"{}\" is not known", text.trim()), "{text:?}");
        }
    }

    #[test]
    fn the_same_unit_in_two_spellings() {
        let unit = |text: &str| text.parse::<WrittenUnit>().unwrap();
        assert!(unit("µm/s").is_same_as(&unit("um/sec")) && !unit("mm/s").is_same_as(&unit("m/s")));
        assert!(!unit("m").is_same_as(&unit("rad")) && !unit("V").is_same_as(&unit("counts")));
        assert!(unit("ticks").is_counts() && !unit("V").is_counts());
    }
}
