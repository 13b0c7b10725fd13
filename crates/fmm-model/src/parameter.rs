//! Parameter: name, symbol, unit of an unknown number, and the interval in which it may lie.

use alloc::borrow::Cow;
use alloc::format;
use core::fmt;

use crate::error::ModelError;
use crate::estimate::Rounded;

/// A parameter: its name in words, its symbol in formulas, its SI unit and the interval in which it may lie.
///
/// Laws list theirs as constants; problems that make parameters up at run time (one initial velocity per
/// record) use owned strings.
///
/// ```
/// use fmm_model::{Bounds, Parameter};
///
/// const STIFFNESS: Parameter = Parameter::new("stiffness", "k", "N/m").bounded(Bounds::POSITIVE);
/// assert_eq!(STIFFNESS.to_string(), "stiffness k (N/m)");
///
/// let velocity = Parameter::named(format!("initial_velocity_{}", 2), "v₀", "m/s");
/// assert_eq!(velocity.name(), "initial_velocity_2");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    name: Cow<'static, str>,
    symbol: Cow<'static, str>,
    unit: Cow<'static, str>,
    bounds: Bounds,
}

impl Parameter {
    /// An unbounded parameter; `unit` is `"1"` for a pure number.
    pub const fn new(name: &'static str, symbol: &'static str, unit: &'static str) -> Self {
        Self {
            name: Cow::Borrowed(name),
            symbol: Cow::Borrowed(symbol),
            unit: Cow::Borrowed(unit),
            bounds: Bounds::UNBOUNDED,
        }
    }

    /// An unbounded parameter whose texts are made at run time.
    pub fn named(
        name: impl Into<Cow<'static, str>>,
        symbol: impl Into<Cow<'static, str>>,
        unit: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self { name: name.into(), symbol: symbol.into(), unit: unit.into(), bounds: Bounds::UNBOUNDED }
    }

    /// The same parameter, confined to `bounds`.
    #[must_use]
    pub const fn bounded(mut self, bounds: Bounds) -> Self {
        self.bounds = bounds;
        self
    }

    /// Name in words, `snake_case`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Symbol as formulas write it.
    pub fn symbol(&self) -> &str {
        &self.symbol
    }

    /// SI unit, `"1"` for a pure number.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// The interval in which the value may lie.
    pub const fn bounds(&self) -> Bounds {
        self.bounds
    }
}

/// An unbounded pure number with this name, which is its symbol too.
///
/// ```
/// use fmm_model::Parameter;
///
/// assert_eq!(Parameter::from("ratio"), Parameter::new("ratio", "ratio", "1"));
/// ```
impl From<&'static str> for Parameter {
    fn from(name: &'static str) -> Self {
        Self::new(name, name, "1")
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} ({})", self.name, self.symbol, self.unit)
    }
}

/// A closed interval `lower ≤ value ≤ upper`; either end may be infinite.
///
/// ```
/// use fmm_model::Bounds;
///
/// let bounds = Bounds::new(0.0, 1.0)?;
/// assert!(bounds.contains(1.0) && !bounds.contains(1.5));
/// assert_eq!(bounds.clamp(1.5), 1.0);
/// assert!(Bounds::new(1.0, 0.0).is_err());
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    lower: f64,
    upper: f64,
}

impl Bounds {
    /// Every real number.
    pub const UNBOUNDED: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
    /// Zero and all positive numbers.
    pub const NOT_NEGATIVE: Self = Self { lower: 0.0, upper: f64::INFINITY };
    /// All positive numbers down to the smallest normal one: an interval must be closed, and zero is not positive.
    pub const POSITIVE: Self = Self { lower: f64::MIN_POSITIVE, upper: f64::INFINITY };

    /// The interval from `lower` to `upper`; equal ends fix a parameter.
    ///
    /// # Errors
    /// [`ModelError::InvertedBounds`] if `lower > upper`, if an end is NaN, or if no finite value fits between them.
    pub fn new(lower: f64, upper: f64) -> Result<Self, ModelError> {
        let bounds = Self { lower, upper };
        if bounds.is_empty() { Err(ModelError::InvertedBounds { lower, upper }) } else { Ok(bounds) }
    }

    /// The same interval from `lower` on. It is [empty](Self::is_empty) if `lower` is NaN or beyond the upper end.
    ///
    /// With [`at_most`](Self::at_most) this makes bounds that are constants:
    ///
    /// ```
    /// use fmm_model::Bounds;
    ///
    /// const EXPONENT: Bounds = Bounds::POSITIVE.at_least(0.5).at_most(2.0);
    /// assert_eq!(EXPONENT, Bounds::new(0.5, 2.0)?);
    /// # Ok::<(), fmm_model::ModelError>(())
    /// ```
    #[must_use]
    pub const fn at_least(self, lower: f64) -> Self {
        Self { lower: if self.lower >= lower { self.lower } else { lower }, upper: self.upper }
    }

    /// The same interval up to `upper`. It is [empty](Self::is_empty) if `upper` is NaN or below the lower end.
    ///
    /// ```
    /// use fmm_model::Bounds;
    ///
    /// let nowhere = Bounds::UNBOUNDED.at_least(3.0).at_most(1.0);
    /// assert!(nowhere.is_empty() && !nowhere.contains(2.0));
    /// ```
    #[must_use]
    pub const fn at_most(self, upper: f64) -> Self {
        Self { lower: self.lower, upper: if self.upper <= upper { self.upper } else { upper } }
    }

    /// The lower end, possibly −∞.
    pub const fn lower(&self) -> f64 {
        self.lower
    }

    /// The upper end, possibly +∞.
    pub const fn upper(&self) -> f64 {
        self.upper
    }

    /// True if no finite value lies in the interval, because its ends exclude each other; a fit refuses such bounds by
    /// the name of their parameter.
    pub const fn is_empty(&self) -> bool {
        !(self.lower <= self.upper && self.lower < f64::INFINITY && self.upper > f64::NEG_INFINITY)
    }

    /// True if `value` lies in the interval; NaN never does.
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }

    /// The point of the interval nearest to `value`; meaningless for an empty one.
    pub fn clamp(&self, value: f64) -> f64 {
        value.max(self.lower).min(self.upper)
    }

    /// True if the interval is a single point, at which the parameter is fixed.
    pub fn is_fixed(&self) -> bool {
        self.lower == self.upper && !self.is_empty()
    }
}

/// Condition of a value that lies in the interval: "greater than 0", "at least 0.5", "in (0, 1]", "finite".
///
/// A lower end that is the smallest normal number stands for an excluded zero, and is written so.
///
/// ```
/// use fmm_model::Bounds;
///
/// assert_eq!(Bounds::POSITIVE.to_string(), "greater than 0");
/// assert_eq!(Bounds::POSITIVE.at_most(1.0).to_string(), "in (0, 1]");
/// assert_eq!(Bounds::new(-1.0, 1e300)?.to_string(), "in [-1, 1e300]");
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [lower, upper] = [self.lower, self.upper].map(Rounded::every_digit);
        let is_positive = self.lower == f64::MIN_POSITIVE;
        let text: Cow<'_, str> = match (self.lower > f64::NEG_INFINITY, self.upper < f64::INFINITY) {
            (false, false) => "finite".into(),
            (false, true) => format!("at most {upper}").into(),
            (true, false) if is_positive => "greater than 0".into(),
            (true, false) => format!("at least {lower}").into(),
            (true, true) if is_positive => format!("in (0, {upper}]").into(),
            (true, true) => format!("in [{lower}, {upper}]").into(),
        };
        f.pad(&text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_condition_is_stated_in_few_digits() {
        for (bounds, text) in [
            (Bounds::UNBOUNDED, "finite"),
            (Bounds::NOT_NEGATIVE, "at least 0"),
            (Bounds::POSITIVE, "greater than 0"),
            (Bounds::POSITIVE.at_most(2.0), "in (0, 2]"),
            (Bounds::UNBOUNDED.at_most(-1e-300), "at most -1e-300"),
            (Bounds::NOT_NEGATIVE.at_least(0.5).at_most(2.0), "in [0.5, 2]"),
        ] {
            assert_eq!(bounds.to_string(), text);
        }
    }

    #[test]
    fn ends_that_exclude_each_other_leave_nothing() {
        let apart = [
            Bounds::UNBOUNDED.at_least(3.0).at_most(1.0),
            Bounds::UNBOUNDED.at_most(1.0).at_least(3.0),
            Bounds::NOT_NEGATIVE.at_most(-1.0),
            Bounds::UNBOUNDED.at_least(f64::NAN),
            Bounds::UNBOUNDED.at_most(f64::NAN),
            Bounds::UNBOUNDED.at_least(f64::INFINITY),
        ];
        for bounds in apart {
            assert!(bounds.is_empty() && !bounds.is_fixed(), "{bounds:?}");
            assert!([-1.0, 0.0, 1.0, 2.0, 3.0].iter().all(|value| !bounds.contains(*value)), "{bounds:?}");
        }
        let some = Bounds::UNBOUNDED.at_least(1.0).at_least(0.5).at_most(3.0).at_most(4.0);
        assert_eq!(some, Bounds::new(1.0, 3.0).unwrap());
        assert!(!some.is_empty() && Bounds::new(3.0, 1.0).is_err());
    }
}
