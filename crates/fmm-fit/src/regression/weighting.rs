//! Weights of the observations of a regression.

use crate::regression::regression_error::RegressionError;

/// What is known of the standard uncertainties of the observations, one per observation, in their unit.
///
/// ```text
/// minimise  Σᵢ ((yᵢ − ŷᵢ)/uᵢ)²
/// ```
///
/// | | u | covariance of the coefficients |
/// |---|---|---|
/// | [`Equal`](Self::Equal) | all 1 | s² (XᵀX)⁻¹ |
/// | [`Relative`](Self::Relative) | known up to a common factor | s² (Xᵀ U⁻² X)⁻¹ |
/// | [`Absolute`](Self::Absolute) | known | (Xᵀ U⁻² X)⁻¹ |
///
/// With s² = S/ν from the residuals, quantiles are those of Student's t with ν degrees of freedom; with absolute
/// uncertainties they are the normal ones, and S itself tells, by a χ² with ν degrees of freedom, whether model and
/// uncertainties fit together.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Weighting<'a> {
    /// Equal and unknown.
    #[default]
    Equal,
    /// Known up to a common factor, which the residuals tell.
    Relative(&'a [f64]),
    /// Known.
    Absolute(&'a [f64]),
}

impl Weighting<'_> {
    /// Whether the uncertainties are known.
    pub const fn is_absolute(&self) -> bool {
        matches!(self, Self::Absolute(_))
    }

    /// The factors 1/uᵢ of `count` observations; `None` if all are 1.
    pub(crate) fn factors(&self, count: usize) -> Result<Option<Vec<f64>>, RegressionError> {
        let (Self::Relative(uncertainties) | Self::Absolute(uncertainties)) = self else { return Ok(None) };
        check_length("standard uncertainties", uncertainties, count)?;
        let factor = |(index, &value): (usize, &f64)| {
            let factor = 1.0 / value;
            if value > 0.0 && value.is_finite() && factor.is_finite() {
                Ok(factor)
            } else {
                Err(RegressionError::BadUncertainty { index, value })
            }
        };
        uncertainties.iter().enumerate().map(factor).collect::<Result<_, _>>().map(Some)
    }
}

/// Checks that there are `count` values, all of them finite.
pub(crate) fn check_finite(name: &str, values: &[f64], count: usize) -> Result<(), RegressionError> {
    check_length(name, values, count)?;
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(RegressionError::NotFinite { name: name.to_owned(), index, value: values[index] }),
        None => Ok(()),
    }
}

fn check_length(name: &str, values: &[f64], count: usize) -> Result<(), RegressionError> {
    if values.len() == count {
        Ok(())
    } else {
        Err(RegressionError::DifferentLengths { name: name.to_owned(), values: values.len(), observations: count })
    }
}
