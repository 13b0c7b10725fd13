//! Numerical tolerance: the digits to which a result is meant.

use crate::UncertaintyError;

/// δ, half a unit of the last digit of an uncertainty stated to `digits` significant digits (JCGM 101:2008, 7.9.2).
///
/// ```text
/// u ≈ c · 10^ℓ with c of n digits,   δ = ½ · 10^ℓ
/// ```
///
/// ```
/// assert_eq!(fmm_uq::numerical_tolerance(0.000_35, 2)?, 5e-6);
/// assert_eq!(fmm_uq::numerical_tolerance(9.96, 2)?, 0.5);
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
///
/// # Errors
/// [`UncertaintyError::OutOfRange`] unless there are 1 to 15 digits and the uncertainty is positive and finite.
pub fn numerical_tolerance(standard_uncertainty: f64, digits: u32) -> Result<f64, UncertaintyError> {
    let digits = valid_digits(digits)?;
    if !(standard_uncertainty > 0.0 && standard_uncertainty.is_finite()) {
        let (option, must_be) = ("uncertainty to take a tolerance from", "positive and finite");
        return Err(UncertaintyError::out_of_range(option, standard_uncertainty, must_be));
    }
    // The exponent is that of the rounded number: 9.96 to two digits is 10, not 9.9.
    let decimals = digits as usize - 1;
    let rounded = format!("{standard_uncertainty:.decimals$e}");
    let exponent = rounded.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()).unwrap_or(0);
    let text = format!("5e{}", exponent - digits.cast_signed());
    Ok(text.parse().unwrap_or(f64::MIN_POSITIVE))
}

pub(crate) fn valid_digits(digits: u32) -> Result<u32, UncertaintyError> {
    if (1..=15).contains(&digits) {
        Ok(digits)
    } else {
        let (option, must_be) = ("number of significant digits", "between 1 and 15");
        Err(UncertaintyError::out_of_range(option, f64::from(digits), must_be))
    }
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
            assert_eq!(numerical_tolerance(u, digits).unwrap(), delta, "{u} to {digits} digits");
        }
        assert!(numerical_tolerance(1.0, 0).is_err() && numerical_tolerance(1.0, 16).is_err());
        assert!(numerical_tolerance(0.0, 2).is_err() && numerical_tolerance(f64::NAN, 2).is_err());
    }
}
