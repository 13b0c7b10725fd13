//! Estimate of one parameter.

use fmm_model::Parameter;

/// Status of a parameter after a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum EstimateStatus {
    /// The residuals determine the value.
    Determined,
    /// The value can change, together with others, without changing the residuals.
    Undetermined,
    /// The value lies on its lower bound; without it the residuals would be smaller.
    AtLowerBound,
    /// The value lies on its upper bound; without it the residuals would be smaller.
    AtUpperBound,
    /// The bounds are equal and hold the value.
    Fixed,
}

impl EstimateStatus {
    /// True if the value lies on a bound.
    pub const fn is_at_bound(self) -> bool {
        matches!(self, Self::AtLowerBound | Self::AtUpperBound)
    }
}

/// The estimate of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    pub(crate) parameter: Parameter,
    pub(crate) value: f64,
    pub(crate) start: f64,
    pub(crate) status: EstimateStatus,
    pub(crate) standard_uncertainty: Option<f64>,
    pub(crate) multiplier: Option<f64>,
}

impl Estimate {
    /// The parameter: name, symbol, unit and bounds.
    pub fn parameter(&self) -> &Parameter {
        &self.parameter
    }

    /// Name of the parameter.
    pub fn name(&self) -> &str {
        self.parameter.name()
    }

    /// The estimate, in the unit of the parameter.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// The value that the fit began with.
    pub fn start(&self) -> f64 {
        self.start
    }

    /// The status of the parameter after the fit.
    pub fn status(&self) -> EstimateStatus {
        self.status
    }

    /// Standard uncertainty, in the unit of the parameter; `None` unless the value is determined and there are more
    /// residuals than determined parameters.
    pub fn standard_uncertainty(&self) -> Option<f64> {
        self.standard_uncertainty
    }

    /// The derivative of half the sum of squares by the bound that the value lies on; `None` for a
    /// value that is not at a bound.
    ///
    /// ```text
    /// μ = ∂(½ S)/∂θ = Σᵢ rᵢ ∂rᵢ/∂θ
    /// ```
    pub fn multiplier(&self) -> Option<f64> {
        self.multiplier
    }
}
