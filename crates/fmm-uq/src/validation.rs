//! Numerical tolerance of a result, and the validation of an interval of the GUM by a Monte Carlo.

use fmm_model::Interval;

use crate::error::UncertaintyError;
use crate::rounding::last_place;

pub(crate) fn valid_digits(digits: u32) -> Result<u32, UncertaintyError> {
    if (1..=15).contains(&digits) {
        Ok(digits)
    } else {
        let (option, must_be) = ("number of significant digits", "between 1 and 15");
        Err(UncertaintyError::out_of_range(option, f64::from(digits), must_be))
    }
}

/// The comparison of an interval of the GUM with one of a Monte Carlo (JCGM 101:2008, 8.1).
///
/// ```text
/// d_low = |y − U − y_low|,   d_high = |y + U − y_high|,   valid if both ≤ δ
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Validation {
    /// δ, numerical tolerance (unit of the result).
    pub tolerance: f64,
    /// d_low, distance of the lower ends (unit of the result).
    pub low: f64,
    /// d_high, distance of the upper ends (unit of the result).
    pub high: f64,
}

impl Validation {
    /// δ, half a unit of the last digit of an uncertainty stated to `digits` significant digits (JCGM 101:2008, 7.9.2).
    ///
    /// ```text
    /// u ≈ c · 10^ℓ with c of n digits,   δ = ½ · 10^ℓ
    /// ```
    ///
    /// ```
    /// assert_eq!(fmm_uq::Validation::tolerance_of(0.000_35, 2)?, 5e-6);
    /// assert_eq!(fmm_uq::Validation::tolerance_of(9.96, 2)?, 0.5);
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless there are 1 to 15 digits and the uncertainty is positive and finite.
    pub fn tolerance_of(standard_uncertainty: f64, digits: u32) -> Result<f64, UncertaintyError> {
        let digits = valid_digits(digits)?;
        if !(standard_uncertainty > 0.0 && standard_uncertainty.is_finite()) {
            let (option, must_be) = ("uncertainty to take a tolerance from", "positive and finite");
            return Err(UncertaintyError::out_of_range(option, standard_uncertainty, must_be));
        }
        let last = last_place(standard_uncertainty, digits);
        Ok(last.and_then(|last| format!("5e{}", last - 1).parse().ok()).unwrap_or(f64::MIN_POSITIVE))
    }

    /// True if the interval of the GUM may be used.
    pub fn is_valid(&self) -> bool {
        self.low <= self.tolerance && self.high <= self.tolerance
    }
}

/// Compares an interval of the GUM with one of a Monte Carlo, for a standard uncertainty stated to `digits` significant
/// digits.
///
/// The Monte Carlo should be stable to a fifth of δ: [`Adaptive::for_validation`](crate::Adaptive::for_validation).
///
/// ```
/// use fmm_uq::{Distribution, Input, Inputs, MonteCarlo, propagate, validate};
///
/// // JCGM 101:2008, 9.2.4: one of four rectangular quantities is ten times as wide.
/// let quantity = |name: &str, half: f64| Input::of(name, Distribution::rectangular(-half, half)?, "1");
/// let (narrow, wide) = (3f64.sqrt(), 300f64.sqrt());
/// let inputs = Inputs::new([
///     quantity("X1", narrow)?,
///     quantity("X2", narrow)?,
///     quantity("X3", narrow)?,
///     quantity("X4", wide)?,
/// ])?;
/// let gum = propagate(&inputs, |x| x[0] + x[1] + x[2] + x[3])?;
/// let trials = MonteCarlo::new(&inputs, 100_000)?.run(|x| x[0] + x[1] + x[2] + x[3])?;
/// let (linear, found) = (gum.expanded(0.95)?.interval(), trials.symmetric_interval(0, 0.95)?);
/// let validation = validate(linear, found, trials.standard_uncertainty(0)?, 2)?;
/// assert!(!validation.is_valid(), "±19.9 and ±17.0 differ by more than {}", validation.tolerance);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
///
/// # Errors
/// Those of [`Validation::tolerance_of`]; [`UncertaintyError::Invalid`] if the intervals differ in coverage
/// probability.
pub fn validate(
    gum: Interval,
    monte_carlo: Interval,
    standard_uncertainty: f64,
    digits: u32,
) -> Result<Validation, UncertaintyError> {
    if gum.level != monte_carlo.level {
        let (option, must_be) = ("coverage probability of the second interval", "that of the first");
        return Err(UncertaintyError::out_of_range(option, monte_carlo.level, must_be));
    }
    let tolerance = Validation::tolerance_of(standard_uncertainty, digits)?;
    Ok(Validation { tolerance, low: (gum.low - monte_carlo.low).abs(), high: (gum.high - monte_carlo.high).abs() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// JCGM 101:2008, 7.9.2 and clause 9: each uncertainty, its digits, and the tolerance.
    #[test]
    fn tolerances_of_the_guide() {
        for (u, digits, delta) in
            [(0.000_35, 2, 5e-6), (2.0, 2, 0.05), (10.1, 2, 0.5), (0.0754, 1, 0.005), (36.0, 2, 0.5), (50e-6, 1, 5e-6)]
        {
            assert_eq!(Validation::tolerance_of(u, digits).unwrap(), delta, "{u} to {digits} digits");
        }
        assert!(Validation::tolerance_of(1.0, 0).is_err() && Validation::tolerance_of(1.0, 16).is_err());
        assert!(Validation::tolerance_of(0.0, 2).is_err() && Validation::tolerance_of(f64::NAN, 2).is_err());
    }
}
