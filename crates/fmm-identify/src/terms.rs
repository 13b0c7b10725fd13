//! What is fitted beside the law, and what of it is held.

use std::fmt::Write as _;

use fmm_model::{Bounds, ModelError, Parameter};

/// Damping of the machine that is fitted beside the law, and parameters that are held.
///
/// ```
/// use fmm_identify::Terms;
///
/// // A pendulum: air drag beside whatever the law is, and the exponent of a Stribeck curve held at 2.
/// let terms = Terms::default().with_quadratic_damping().holding("exponent", 2.0)?;
/// assert_eq!(terms.held().collect::<Vec<_>>(), [("exponent", 2.0)]);
/// # Ok::<(), fmm_model::ModelError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Terms {
    linear: bool,
    quadratic: bool,
    any_sign: bool,
    held: Vec<(String, f64)>,
}

/// Name of the linear damping among the parameters, of the machine or of the law: a record determines their sum only.
pub(crate) const LINEAR: &str = "damping_per_mass";
/// Name of the quadratic damping among the parameters.
pub(crate) const QUADRATIC: &str = "quadratic_damping_per_mass";

impl Terms {
    /// No term but the law, and nothing held.
    pub(crate) const NONE: Self = Self { linear: false, quadratic: false, any_sign: false, held: Vec::new() };

    /// The same with a linear damping of the machine, c/m, not negative. Not for laws that have a viscous part.
    #[must_use]
    pub fn with_linear_damping(self) -> Self {
        Self { linear: true, ..self }
    }

    /// The same with a quadratic damping of the machine, such as the drag of air, not negative.
    #[must_use]
    pub fn with_quadratic_damping(self) -> Self {
        Self { quadratic: true, ..self }
    }

    /// The same with damping that may come out negative. A negative damper is no damper; it says that the law lacks friction that
    /// falls with speed.
    #[must_use]
    pub fn with_damping_of_any_sign(self) -> Self {
        Self { any_sign: true, ..self }
    }

    /// The same with the fitted parameter called `name` held at `value`, in the unit in which it would be fitted.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`] if the value is not finite. Whether there is such a parameter shows when the law is known.
    pub fn holding(mut self, name: impl Into<String>, value: f64) -> Result<Self, ModelError> {
        let value = ModelError::require_finite("held value", value, "(in the unit of its parameter)")?;
        self.held.push((name.into(), value));
        Ok(self)
    }

    /// Whether there is none, and nothing is held.
    pub(crate) fn is_plain(&self) -> bool {
        *self == Self::NONE
    }

    /// Whether a linear damping of the machine is fitted.
    pub const fn has_linear_damping(&self) -> bool {
        self.linear
    }

    /// Whether a quadratic damping of the machine is fitted.
    pub const fn has_quadratic_damping(&self) -> bool {
        self.quadratic
    }

    /// Names and values of the parameters that are held.
    pub fn held(&self) -> impl Iterator<Item = (&str, f64)> {
        self.held.iter().map(|(name, value)| (name.as_str(), *value))
    }

    /// The parameters of the damping, for positions in units of `position`.
    pub(crate) fn parameters(&self, position: &str) -> impl Iterator<Item = Parameter> {
        let bounds = if self.any_sign { Bounds::UNBOUNDED } else { Bounds::NOT_NEGATIVE };
        let linear = self.linear.then(|| Parameter::new(LINEAR, "c/m", "1/s"));
        let unit = format!("1/{position}");
        let quadratic = self.quadratic.then(|| Parameter::named(QUADRATIC, "c₂/m", unit));
        linear.into_iter().chain(quadratic).map(move |parameter| parameter.bounded(bounds))
    }

    /// The name of `law` with these terms.
    pub(crate) fn name(&self, law: &str) -> String {
        let mut name = law.to_owned();
        for (has, term) in [(self.linear, "linear"), (self.quadratic, "quadratic")] {
            if has {
                name.push_str(" + ");
                name.push_str(term);
            }
        }
        if self.any_sign && (self.linear || self.quadratic) {
            name.push_str(" of any sign");
        }
        for (index, (held, value)) in self.held.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(name, "{} {held} = {value}", if index == 0 { "," } else { " and" });
        }
        name
    }
}
