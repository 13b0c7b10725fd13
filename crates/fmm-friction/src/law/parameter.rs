//! Parameters of a law: name, unit, bounds, role and a start for fits.

use fmm_model::{Bounds, Parameter, Scalar};

use crate::law::LawError;

/// Role of a parameter in the friction force. It says in which form the parameter remains when the normal
/// load and the mass are unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Role {
    /// A coefficient, or one per length or power of the speed: the force is proportional to it and to the normal load.
    Level,
    /// A coefficient that the law adds to its first [`Level`](Self::Level) at rest, and which vanishes with speed.
    Excess,
    /// A coefficient that may not lie below the first [`Level`](Self::Level) of the law. A fit takes their difference,
    /// which has a simple bound.
    LevelAbove,
    /// A coefficient per speed: proportional to the load, and inseparable from linear damping of the machine.
    Slope,
    /// A coefficient that the load must exceed to leave rest, not below the sliding level. A free decay depends on it
    /// only in where it stops.
    Breakaway,
    /// Anything that does not scale with the force, such as a speed at which the law bends.
    Shape,
}

/// A parameter of a law and its role.
#[derive(Debug, Clone, PartialEq)]
pub struct LawParameter {
    parameter: Parameter,
    role: Role,
    typical: f64,
}

impl LawParameter {
    /// A parameter with its role.
    pub const fn new(parameter: Parameter, role: Role) -> Self {
        Self { parameter, role, typical: 1.0 }
    }

    /// The parameter with a start value for fits, relative to a scale of the motion (1); 1 if none is given. The scale
    /// is the Coulomb coefficient with equal losses for a coefficient or its excess, the largest speed for a speed, the
    /// amplitude for a length, and 1 for a pure number.
    #[must_use]
    pub const fn typically(mut self, relative: f64) -> Self {
        self.typical = relative;
        self
    }

    /// A coefficient, not negative (1).
    pub(crate) const fn level(name: &'static str, symbol: &'static str) -> Self {
        Self::not_negative(name, symbol, "1", Role::Level)
    }

    /// A coefficient that is not below the first level (1).
    pub(crate) const fn level_above(name: &'static str, symbol: &'static str) -> Self {
        Self::not_negative(name, symbol, "1", Role::LevelAbove)
    }

    /// A static level, not negative (1).
    pub(crate) const fn breakaway(name: &'static str, symbol: &'static str) -> Self {
        Self::not_negative(name, symbol, "1", Role::Breakaway)
    }

    /// A coefficient per speed, not negative (s/m).
    pub(crate) const fn slope(name: &'static str, symbol: &'static str) -> Self {
        Self::not_negative(name, symbol, "s/m", Role::Slope)
    }

    /// A parameter of unit `unit` that is not negative.
    pub(crate) const fn not_negative(name: &'static str, symbol: &'static str, unit: &'static str, role: Role) -> Self {
        Self::new(Parameter::new(name, symbol, unit).bounded(Bounds::NOT_NEGATIVE), role)
    }

    /// A parameter of unit `unit` that is positive.
    pub(crate) const fn positive(name: &'static str, symbol: &'static str, unit: &'static str, role: Role) -> Self {
        Self::new(Parameter::new(name, symbol, unit).bounded(Bounds::POSITIVE), role)
    }

    /// Name, symbol, unit and bounds.
    pub const fn parameter(&self) -> &Parameter {
        &self.parameter
    }

    /// Role in the friction force.
    pub const fn role(&self) -> Role {
        self.role
    }

    /// A value to begin a fit at, relative to the scales of the motion (1).
    pub const fn typical(&self) -> f64 {
        self.typical
    }

    /// The `value`, if it lies within the parameter's bounds.
    ///
    /// # Errors
    /// [`LawError::OutOfBounds`] otherwise, and for NaN and infinity.
    pub fn check<D: Scalar>(&self, value: D) -> Result<D, LawError> {
        let bounds = self.parameter.bounds();
        if value.value().is_finite() && bounds.contains(value.value()) {
            Ok(value)
        } else {
            Err(LawError::out_of_bounds(&self.parameter, value.value()))
        }
    }
}

/// Takes exactly as many values as the law has parameters.
pub(crate) fn exactly<const N: usize, D: Scalar>(law: &'static str, values: &[D]) -> Result<[D; N], LawError> {
    <[D; N]>::try_from(values).map_err(|_| LawError::wrong_count(law, N, values.len()))
}

/// The values, each within the bounds of its parameter.
pub(crate) fn checked<const N: usize, D: Scalar>(
    parameters: &[LawParameter],
    values: [D; N],
) -> Result<[D; N], LawError> {
    for (parameter, value) in parameters.iter().zip(values) {
        parameter.check(value)?;
    }
    Ok(values)
}

/// Checks that there is one value for each parameter, and within its bounds.
pub(crate) fn all_checked<D: Scalar>(law: &str, parameters: &[LawParameter], values: &[D]) -> Result<(), LawError> {
    if values.len() != parameters.len() {
        return Err(LawError::wrong_count(law, parameters.len(), values.len()));
    }
    parameters.iter().zip(values).try_for_each(|(parameter, value)| parameter.check(*value).map(drop))
}

/// Checks that a static level is not below the sliding level at zero speed.
pub(crate) fn static_not_below<D: Scalar>(sliding: D, breakaway: D) -> Result<(), LawError> {
    if breakaway.value() < sliding.value() {
        return Err(LawError::static_below_sliding(breakaway.value(), sliding.value()));
    }
    Ok(())
}
