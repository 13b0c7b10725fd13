//! Estimate: a number with its standard uncertainty, or with an interval that covers it, and its rounded text.

use alloc::borrow::ToOwned;
use alloc::format;
use alloc::string::String;
use core::fmt;

use crate::math;

/// An estimate with its standard uncertainty, both in the unit that stands beside the field.
///
/// `Display` rounds it to its significant digits.
///
/// ```
/// use fmm_model::Estimated;
///
/// let friction = Estimated::new(0.029_918, 6.1e-4);
/// assert_eq!(friction.to_string(), "0.02992 ± 0.00061");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimated {
    /// The estimate.
    pub value: f64,
    /// u, its standard uncertainty.
    pub uncertainty: f64,
}

impl Estimated {
    /// `value` with its standard `uncertainty`, in the same unit.
    pub const fn new(value: f64, uncertainty: f64) -> Self {
        Self { value, uncertainty }
    }

    /// Both times `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { value: self.value * factor, uncertainty: self.uncertainty * factor.abs() }
    }
}

impl fmt::Display for Estimated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&Rounded::new(self.value, Some(self.uncertainty)), f)
    }
}

/// A coverage interval.
///
/// ```
/// use fmm_model::Interval;
///
/// let interval = Interval { low: 1.02, high: 2.98, level: 0.95 };
/// assert_eq!(format!("{interval:.1}"), "[1.0, 3.0] (95 %)");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Interval {
    /// Lower end (unit of the result).
    pub low: f64,
    /// Upper end (unit of the result).
    pub high: f64,
    /// p, coverage probability (1).
    pub level: f64,
}

impl Interval {
    /// Distance of the ends (unit of the result).
    pub const fn width(&self) -> f64 {
        self.high - self.low
    }
}

impl fmt::Display for Interval {
    /// "[1.47, 2.58] (95 %)", with all digits unless a precision is given.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Without the rounding of 100 p, which is 99.72999999999999 for 0.9973.
        let percent = Rounded::every_digit(math::round(1e10 * self.level) / 1e8);
        match f.precision() {
            Some(decimals) => write!(f, "[{:.decimals$}, {:.decimals$}] ({percent} %)", self.low, self.high),
            None => write!(f, "[{}, {}] ({percent} %)", self.low, self.high),
        }
    }
}

/// A value, written with two significant digits of its standard uncertainty (JCGM 100:2008, 7.2.6), or with six
/// digits if it has none.
///
/// ```
/// use fmm_model::Rounded;
///
/// assert_eq!(Rounded::new(190.740_316_97, Some(0.005_601)).to_string(), "190.7403 ± 0.0056");
/// assert_eq!(Rounded::new(0.25, None).to_string(), "0.25");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounded {
    value: f64,
    uncertainty: Option<f64>,
}

impl Rounded {
    /// `value` with its standard `uncertainty`, in the same unit, if there is one.
    pub const fn new(value: f64, uncertainty: Option<f64>) -> Self {
        Self { value, uncertainty }
    }

    /// Every digit of `value`, for messages that have to tell it from its neighbours; large and small ones with a power
    /// of ten instead of zeros.
    ///
    /// ```
    /// use fmm_model::Rounded;
    ///
    /// assert_eq!(Rounded::every_digit(-1.000_000_1), "-1.0000001");
    /// assert_eq!(Rounded::every_digit(f64::MIN_POSITIVE), "2.2250738585072014e-308");
    /// ```
    pub fn every_digit(value: f64) -> String {
        let magnitude = value.abs();
        if magnitude == 0.0 || !magnitude.is_finite() || (1e-5..1e16).contains(&magnitude) {
            format!("{value}")
        } else {
            format!("{value:e}")
        }
    }

    /// `value` to so many significant digits, of which there is at least one.
    ///
    /// ```
    /// use fmm_model::Rounded;
    ///
    /// assert_eq!(Rounded::significant(0.012_345, 2), "0.012");
    /// ```
    pub fn significant(value: f64, digits: usize) -> String {
        Self::every_digit(format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value))
    }

    /// The ends of an interval, in the same unit, as text in brackets, to the same decimal place as the value.
    ///
    /// ```
    /// use fmm_model::Rounded;
    ///
    /// assert_eq!(Rounded::new(0.250_31, Some(0.000_52)).interval(0.249_29, 0.251_33), "[0.24929, 0.25133]");
    /// assert_eq!(Rounded::new(1.6e-5, Some(1.9e-5)).interval(-2.1e-5, 5.3e-5), "[-2.1, 5.3]e-5");
    /// ```
    pub fn interval(&self, low: f64, high: f64) -> String {
        let uncertainty = self.uncertainty.filter(|u| *u > 0.0 && u.is_finite() && self.value.is_finite());
        match uncertainty.map(|uncertainty| Notation::of(self.value, uncertainty)) {
            None => format!("[{}, {}]", plain(low), plain(high)),
            Some(Notation::Plain { place }) => format!("[{}, {}]", at_place(low, place), at_place(high, place)),
            Some(Notation::Scaled { place, exponent }) => {
                let (scale, decimals) = (math::powi(10.0, exponent), (exponent - place) as usize);
                format!("[{}, {}]e{exponent}", signed(low / scale, decimals), signed(high / scale, decimals))
            }
        }
    }
}

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.value;
        let Some(uncertainty) = self.uncertainty else {
            return f.pad(&plain(value));
        };
        if !(uncertainty > 0.0 && uncertainty.is_finite() && value.is_finite()) {
            return f.pad(&format!("{} ± {}", plain(value), plain(uncertainty)));
        }
        match Notation::of(value, uncertainty) {
            Notation::Plain { place } => {
                // Digits that the value does not have, or zeros that nobody counts.
                let is_apart = decade(uncertainty) <= place || place <= -12;
                let text = if is_apart { Self::significant(uncertainty, 2) } else { at_place(uncertainty, place) };
                f.pad(&format!("{} ± {text}", at_place(value, place)))
            }
            Notation::Scaled { place, exponent } if decade(uncertainty) <= place => {
                let decimals = (exponent - place) as usize;
                f.pad(&format!("{value:.decimals$e} ± {}", Self::significant(uncertainty, 2)))
            }
            Notation::Scaled { place, exponent } => {
                let (scale, decimals) = (math::powi(10.0, exponent), (exponent - place) as usize);
                let (value, uncertainty) = (signed(value / scale, decimals), signed(uncertainty / scale, decimals));
                f.pad(&format!("({value} ± {uncertainty})e{exponent}"))
            }
        }
    }
}

/// Notation of a value and its uncertainty.
enum Notation {
    /// Plain numbers, down to the decimal `place`.
    Plain { place: i32 },
    /// Multiples of a power of ten, down to the decimal `place`.
    Scaled { place: i32, exponent: i32 },
}

/// Decimal digits of a number of 64 bits that mean anything (1).
const DIGITS: i32 = 16;

impl Notation {
    fn of(value: f64, uncertainty: f64) -> Self {
        let exponent = decade(value.abs().max(uncertainty));
        // The decimal place of the second digit of the uncertainty, or of the last one that the value has; rounding up
        // to 100 is harmless.
        let place = (decade(uncertainty) - 1).max(exponent + 1 - DIGITS);
        if (-4..6).contains(&exponent) { Self::Plain { place } } else { Self::Scaled { place, exponent } }
    }
}

/// The power of ten that a positive number begins with.
fn decade(value: f64) -> i32 {
    math::floor(math::log10(value)) as i32
}

/// `value` down to a decimal `place`; digits behind the last known place before the point are zeros.
fn at_place(value: f64, place: i32) -> String {
    let step = math::powi(10.0, place.max(0));
    let value = if place > 0 { math::round(value / step) * step } else { value };
    signed(value, place.min(0).unsigned_abs() as usize)
}

/// `value` with so many decimals, and without the sign of a zero.
fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|digit| matches!(digit, '0' | '.')) => digits.to_owned(),
        _ => text,
    }
}

/// Six digits, short where the value is round.
fn plain(value: f64) -> String {
    let magnitude = value.abs();
    // A value on a bound that excludes zero is the smallest number that is, and reads as zero.
    if magnitude <= f64::MIN_POSITIVE {
        "0".to_owned()
    } else if (1e-3..1e6).contains(&magnitude) {
        let decimals = (5 - decade(magnitude)).max(0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.5e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_rounded_to_their_uncertainty() {
        let text = |value, uncertainty| Rounded::new(value, Some(uncertainty)).to_string();
        assert_eq!(text(0.1, 3.4e-5), "0.100000 ± 0.000034");
        assert_eq!(text(238.942, 2.707), "238.9 ± 2.7");
        assert_eq!(text(238.942, 27.07), "239 ± 27");
        assert_eq!(text(238_942.0, 270.7), "238940 ± 270");
        assert_eq!(text(20.0, 112.0), "20 ± 110");
        assert_eq!(text(-1e-9, 0.2), "0.00 ± 0.20");
        assert_eq!(text(5.5e-7, 2.0e-9), "(5.500 ± 0.020)e-7");
        assert_eq!(text(1.0, 0.0), "1 ± 0");
        assert_eq!(text(1e-9, 0.2), "0.00 ± 0.20");
        assert_eq!(text(1.591_549_430_918_953_5, 1.24e-13), "1.59154943091895 ± 1.2e-13");
        assert_eq!(text(1.591_549_430_918_953_5, 1.24e-17), "1.591549430918954 ± 1.2e-17");
        assert_eq!(text(1.5, 1.24e-13), "1.50000000000000 ± 1.2e-13");
        assert_eq!(text(123_456.0, 1e-20), "123456.0000000000 ± 1e-20");
        assert_eq!(text(5.5e-7, 1.0e-30), "5.500000000000000e-7 ± 1e-30");
        assert_eq!(Rounded::new(1.5, Some(1e-20)).interval(0.0, 2.0), "[0.000000000000000, 2.000000000000000]");
    }

    #[test]
    fn plain_values_are_short() {
        let text = |value| Rounded::new(value, None).to_string();
        assert_eq!(text(0.27), "0.27");
        assert_eq!(text(1980.0), "1980");
        assert_eq!(text(f64::MIN_POSITIVE), "0");
        assert_eq!(text(-1.234_567_89e-7), "-1.23457e-7");
        assert_eq!(format!("{:>6}|", Rounded::new(0.5, None)), "   0.5|");
    }
}
