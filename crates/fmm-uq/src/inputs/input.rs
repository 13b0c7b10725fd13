//! One input quantity of a measurement.

use std::fmt;

use fmm_model::Rounded;

use crate::distributions::Distribution;
use crate::error::UncertaintyError;
use crate::inputs::observations::Observations;

/// Type A or type B evaluation (JCGM 100:2008, 4.2 and 4.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Evaluation {
    /// Evaluation by a series of observations.
    TypeA,
    /// Evaluation by anything else: a certificate, limits, experience.
    #[default]
    TypeB,
}

impl fmt::Display for Evaluation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TypeA => "A",
            Self::TypeB => "B",
        })
    }
}

/// An input quantity: its estimate, the standard uncertainty of that, and how well the uncertainty is known.
///
/// | symbol | field | unit | meaning |
/// |---|---|---|---|
/// | x | `value` | `unit` | estimate |
/// | u | `standard_uncertainty` | `unit` | standard deviation attributed to the estimate |
/// | ν | `degrees_of_freedom` | 1 | n − 1 for the mean of n observations; infinite if u is known exactly |
/// | | `distribution` | `unit` | source of the trials of a Monte Carlo |
///
/// The unit is a label and is not converted: the model sees the bare values, so that all must belong to one
/// coherent system. Uncertainty exactly zero is allowed and describes a constant.
///
/// ```
/// use fmm_uq::Input;
///
/// let length = Input::new("l", 50_000_623.0, 25.0, "nm")?.with_degrees_of_freedom(18.0)?;
/// assert_eq!(length.standard_uncertainty(), 25.0);
/// assert!(Input::new("l", 50_000_623.0, -25.0, "nm").is_err());
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    name: String,
    value: f64,
    standard_uncertainty: f64,
    unit: String,
    degrees_of_freedom: f64,
    distribution: Distribution,
    evaluation: Evaluation,
}

impl Input {
    /// A normally distributed input of infinite degrees of freedom; `unit` is `"1"` for a pure number.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an empty name, a value that is not finite, or an uncertainty that is negative
    /// or not finite.
    pub fn new(
        name: impl Into<String>,
        value: f64,
        standard_uncertainty: f64,
        unit: impl Into<String>,
    ) -> Result<Self, UncertaintyError> {
        let (name, unit) = (name.into(), unit.into());
        if name.trim().is_empty() {
            let value = Rounded::every_digit(value);
            let what = format!("an input needs a name, but the one of value {value} {unit} has none");
            return Err(UncertaintyError::invalid(what));
        }
        if !value.is_finite() {
            let value = Rounded::every_digit(value);
            return Err(UncertaintyError::invalid(format!(
                "the value of {name} must be finite, but is {value} {unit}"
            )));
        }
        if !(standard_uncertainty >= 0.0 && standard_uncertainty.is_finite()) {
            return Err(UncertaintyError::uncertainty_out_of_range(&name, standard_uncertainty, &unit));
        }
        let distribution = if standard_uncertainty == 0.0 {
            Distribution::of_constant(value)
        } else {
            Distribution::of_normal(value, standard_uncertainty)
        };
        let (degrees_of_freedom, evaluation) = (f64::INFINITY, Evaluation::TypeB);
        Ok(Self { name, value, standard_uncertainty, unit, degrees_of_freedom, distribution, evaluation })
    }

    /// An input of the given distribution, with its mean, standard uncertainty and degrees of freedom.
    ///
    /// ```
    /// use fmm_uq::{Distribution, Input};
    ///
    /// let density = Input::of("ρ_W", Distribution::rectangular(7000.0, 9000.0)?, "kg/m³")?;
    /// assert_eq!((density.value(), density.standard_uncertainty()), (8000.0, 2000.0 / 12f64.sqrt()));
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an empty name.
    pub fn of(
        name: impl Into<String>,
        distribution: Distribution,
        unit: impl Into<String>,
    ) -> Result<Self, UncertaintyError> {
        let mut input = Self::new(name, distribution.mean(), distribution.standard_uncertainty(), unit)?;
        input.degrees_of_freedom = distribution.degrees_of_freedom();
        input.distribution = distribution;
        Ok(input)
    }

    /// The mean of repeated observations, an uncertainty of type A: u = s/√n, ν = n − 1, Student's t.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for an empty name.
    pub fn mean_of(
        name: impl Into<String>,
        observations: &Observations,
        unit: impl Into<String>,
    ) -> Result<Self, UncertaintyError> {
        Self::new(name, observations.mean(), observations.standard_uncertainty(), unit)?
            .evaluated_as(Evaluation::TypeA)
            .with_degrees_of_freedom(observations.degrees_of_freedom())
    }

    /// The same input with its uncertainty of type A or B, which a budget shows: B unless it is the
    /// [mean of observations](Input::mean_of).
    #[must_use]
    pub const fn evaluated_as(mut self, evaluation: Evaluation) -> Self {
        self.evaluation = evaluation;
        self
    }

    /// The same input with ν degrees of freedom, which need not be whole.
    ///
    /// A normal input thereby becomes one of Student's t (JCGM 101:2008, 6.4.9.7): an uncertainty that is not known
    /// exactly leaves heavier tails. Inputs of other distributions keep theirs, and ν only counts in ν_eff.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] if they are below 1 or NaN.
    pub fn with_degrees_of_freedom(mut self, degrees_of_freedom: f64) -> Result<Self, UncertaintyError> {
        self.degrees_of_freedom = UncertaintyError::require_degrees_of_freedom(&self.name, degrees_of_freedom)?;
        if self.distribution.is_normal_or_t() {
            self.distribution = Distribution::student_t(self.value, self.standard_uncertainty, degrees_of_freedom)?;
        }
        Ok(self)
    }

    /// Name, unique in its set.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// x, estimate (in [`Input::unit`]).
    pub const fn value(&self) -> f64 {
        self.value
    }

    /// u, standard uncertainty of the estimate (in [`Input::unit`]).
    pub const fn standard_uncertainty(&self) -> f64 {
        self.standard_uncertainty
    }

    /// Unit of the value and of its uncertainty.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// ν, degrees of freedom of the standard uncertainty (1), at least 1, possibly infinite.
    pub const fn degrees_of_freedom(&self) -> f64 {
        self.degrees_of_freedom
    }

    /// Evaluation of the uncertainty: from observations (type A) or from elsewhere (type B).
    pub const fn evaluation(&self) -> Evaluation {
        self.evaluation
    }

    /// Distribution that a Monte Carlo draws from.
    pub const fn distribution(&self) -> &Distribution {
        &self.distribution
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_inputs_are_refused_by_name() {
        let message = |input: Result<Input, UncertaintyError>| input.unwrap_err().to_string();
        assert_eq!(message(Input::new(" ", 1.0, 0.1, "m")), "an input needs a name, but the one of value 1 m has none");
        assert_eq!(message(Input::new("a", f64::NAN, 0.1, "m")), "the value of a must be finite, but is NaN m");
        for bad in [-0.1, f64::NAN, f64::INFINITY] {
            let error = Input::new("a", 1.0, bad, "m").unwrap_err();
            assert!(error.to_string().starts_with("the standard uncertainty of"), "u = {bad} m: {error}");
        }
        for bad in [0.0, 0.999, -1.0, f64::NAN] {
            assert!(Input::new("a", 1.0, 0.1, "m").unwrap().with_degrees_of_freedom(bad).is_err(), "ν = {bad}");
        }
    }

    #[test]
    fn degrees_of_freedom_are_infinite_unless_given() {
        let input = Input::new("a", 1.0, 0.0, "m").unwrap();
        assert_eq!(input.degrees_of_freedom(), f64::INFINITY);
        assert_eq!(input.with_degrees_of_freedom(25.6).unwrap().degrees_of_freedom(), 25.6);
    }
}
