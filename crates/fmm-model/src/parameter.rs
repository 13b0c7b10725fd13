//! Parameter: name, symbol, unit and bounds of an unknown number.

use alloc::borrow::Cow;

use crate::Bounds;

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

impl core::fmt::Display for Parameter {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{} {} ({})", self.name, self.symbol, self.unit)
    }
}
