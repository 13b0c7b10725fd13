//! Intervals from the profile of the sum of squares.

use fmm_model::coverage_factor;

use crate::result::fit::Fit;

/// Knowledge of the variance of the residuals.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ResidualVariance {
    /// Nothing: it is s² = S/ν, and the quantile is Student's.
    Estimated,
    /// It is 1, each residual being divided by its standard uncertainty, and the quantile is the normal one.
    Unit,
    /// It was estimated otherwise, with these degrees of freedom, of which the quantile is Student's.
    ///
    /// If residuals are correlated, V/C of the parameter makes the profile as wide as its variance V says, C being
    /// the [unit covariance](crate::Fit::unit_covariance) (Chandler and Bate, <https://doi.org/10.1093/biomet/asm015>).
    Effective {
        /// s², in the unit of the residuals squared.
        variance: f64,
        /// ν (1), infinite if s² is known.
        degrees_of_freedom: f64,
    },
}

impl ResidualVariance {
    /// s and the quantile for probability `level`; `None` if a `fit` does not have them.
    pub(crate) fn scale(self, fit: &Fit, level: f64) -> Option<(f64, f64)> {
        let (deviation, degrees_of_freedom) = match self {
            Self::Estimated => (fit.residual_standard_deviation()?, fit.degrees_of_freedom() as f64),
            Self::Unit => (1.0, f64::INFINITY),
            Self::Effective { variance, degrees_of_freedom } => (variance.sqrt(), degrees_of_freedom),
        };
        let is_usable = deviation > 0.0 && deviation.is_finite();
        coverage_factor(level, degrees_of_freedom).filter(|_| is_usable).map(|quantile| (deviation, quantile))
    }
}

/// One end of a profile interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ProfileEnd {
    /// The residuals rule out values beyond this one.
    At(f64),
    /// The residuals rule nothing out up to the bound of the parameter, which is this value.
    Bound(f64),
    /// The residuals rule nothing out up to about this value, beyond which the model has no finite value.
    Edge(f64),
    /// The residuals rule nothing out however far the value goes.
    Open,
}

impl ProfileEnd {
    /// The value at which the interval ends; `None` if it is open.
    pub fn value(self) -> Option<f64> {
        match self {
            Self::At(value) | Self::Bound(value) | Self::Edge(value) => Some(value),
            Self::Open => None,
        }
    }
}

/// An interval from the profile of the sum of squares, and the profile as far as it was needed.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileInterval {
    pub(crate) level: f64,
    /// Index of the parameter.
    pub(crate) index: usize,
    /// s and t.
    pub(crate) scale: (f64, f64),
    pub(crate) lower: ProfileEnd,
    pub(crate) upper: ProfileEnd,
    pub(crate) points: Vec<(f64, f64)>,
    pub(crate) residual_evaluations: usize,
}

impl ProfileInterval {
    /// The probability with which the interval covers the parameter.
    pub fn level(&self) -> f64 {
        self.level
    }

    /// The lower end, in the unit of the parameter.
    pub fn lower(&self) -> ProfileEnd {
        self.lower
    }

    /// The upper end, in the unit of the parameter.
    pub fn upper(&self) -> ProfileEnd {
        self.upper
    }

    /// t², which (S_k − S_min)/s² does not exceed within the interval (1).
    pub fn threshold(&self) -> f64 {
        self.scale.1.powi(2)
    }

    /// The profile where it was computed: values of the parameter, ascending, and the smallest sum of squares there.
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// Evaluations of the residuals.
    pub fn residual_evaluations(&self) -> usize {
        self.residual_evaluations
    }
}
