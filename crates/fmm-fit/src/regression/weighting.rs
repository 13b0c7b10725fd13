//! Weights of the observations of a regression.

use crate::error::FitError;
use crate::problem::weighted::bad_uncertainty;

/// Knowledge of the standard uncertainties of the observations, one per observation, in their unit.
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
    /// True if the uncertainties are known.
    pub const fn is_absolute(&self) -> bool {
        matches!(self, Self::Absolute(_))
    }

    /// The factors 1/uᵢ of `count` observations; `None` if all are 1.
    pub(crate) fn factors(&self, count: usize) -> Result<Option<Vec<f64>>, FitError> {
        let (Self::Relative(uncertainties) | Self::Absolute(uncertainties)) = self else { return Ok(None) };
        check_length("standard uncertainties", uncertainties, count)?;
        let factor = |(index, &value): (usize, &f64)| {
            let factor = 1.0 / value;
            if value > 0.0 && value.is_finite() && factor.is_finite() {
                Ok(factor)
            } else {
                Err(bad_uncertainty("observation", index, value))
            }
        };
        uncertainties.iter().enumerate().map(factor).collect::<Result<_, _>>().map(Some)
    }
}

/// Checks that there are `count` values, all of them finite.
pub(crate) fn check_finite(name: &str, values: &[f64], count: usize) -> Result<(), FitError> {
    check_length(name, values, count)?;
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(FitError::option(&format!("value {index} of {name}"), "finite", values[index])),
        None => Ok(()),
    }
}

fn check_length(name: &str, values: &[f64], count: usize) -> Result<(), FitError> {
    if values.len() == count {
        Ok(())
    } else {
        let given = values.len();
        Err(FitError::count(format!("{name} has {given} values for {count} observations; give one for each")))
    }
}

pub(crate) fn no_column() -> FitError {
    FitError::count("a regression needs at least one column")
}

pub(crate) fn too_few_observations(observations: usize, coefficients: usize) -> FitError {
    FitError::undetermined(format!(
        "{observations} observations cannot determine {coefficients} coefficients; give at least as many"
    ))
}

pub(crate) fn too_few_abscissae(distinct: usize, coefficients: usize) -> FitError {
    FitError::undetermined(format!(
        "{distinct} different values of x cannot determine {coefficients} coefficients; give at least as many"
    ))
}

pub(crate) fn overflow() -> FitError {
    FitError::problem("the data span too many orders of magnitude; change the units")
}
