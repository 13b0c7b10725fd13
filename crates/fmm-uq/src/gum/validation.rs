//! Validation of an interval of the GUM by a Monte Carlo.

use crate::{Interval, UncertaintyError, numerical_tolerance};

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
    /// Whether the interval of the GUM may be used.
    pub fn is_valid(&self) -> bool {
        self.low <= self.tolerance && self.high <= self.tolerance
    }
}

/// Compares an interval of the GUM with one of a Monte Carlo, for a standard uncertainty stated to so many digits.
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
/// Those of [`numerical_tolerance`]; [`UncertaintyError::OutOfRange`] if the intervals differ in coverage
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
    let tolerance = numerical_tolerance(standard_uncertainty, digits)?;
    Ok(Validation { tolerance, low: (gum.low - monte_carlo.low).abs(), high: (gum.high - monte_carlo.high).abs() })
}
