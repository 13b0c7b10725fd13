//! Prior density of one parameter.

use fmm_model::{Bounds, Parameter, Rounded};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::error::FitError;

/// Values drawn in search of one within the bounds.
const TRIES: usize = 10_000;

/// Knowledge of a parameter before the data: a density over its values, in the unit of the parameter.
///
/// | prior | density | states |
/// |---|---|---|
/// | [`FLAT`](Self::FLAT) | 1 within the bounds of the parameter | nothing but the bounds |
/// | [`normal`](Self::normal) | exp(−(θ − m)²/2u²) | a value m with its standard uncertainty u, as from a budget |
/// | [`log_normal`](Self::log_normal) | exp(−(ln θ/m)²/2s²)/θ | a positive value known to a factor exp s |
/// | [`uniform`](Self::uniform) | 1 between two values | limits, such as those of a tolerance |
///
/// The bounds of the parameter cut every prior. A flat prior over a parameter without bounds has no integral; the
/// posterior has one if the data determine the parameter.
///
/// ```
/// use fmm_fit::posterior::Prior;
///
/// let load = Prior::normal(14.0, 0.1)?; // N
/// assert!(load.log_density(14.0) > load.log_density(14.2));
/// assert_eq!(Prior::uniform(0.0, 1.0)?.log_density(2.0), f64::NEG_INFINITY);
/// assert_eq!(Prior::normal(14.0, 0.0).unwrap_err().to_string(), "a prior's standard uncertainty must be above 0, but is 0");
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior(Kind);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Flat,
    Normal { mean: f64, deviation: f64 },
    LogNormal { logarithm: f64, deviation: f64 },
    Uniform(Bounds),
}

/// ln of a density, its derivative by the parameter, and the second one with the sign turned, where it is positive.
#[derive(Debug, Clone, Copy)]
pub(super) struct LogDensity {
    pub(super) value: f64,
    pub(super) slope: f64,
    pub(super) curvature: f64,
}

impl Prior {
    /// Nothing but the bounds of the parameter: the density is the same everywhere.
    pub const FLAT: Self = Self(Kind::Flat);

    /// A value with its standard uncertainty, both in the unit of the parameter.
    ///
    /// # Errors
    /// [`FitError::OutOfRange`] unless both are finite and the uncertainty is positive.
    pub fn normal(mean: f64, standard_uncertainty: f64) -> Result<Self, FitError> {
        let mean = finite("mean", mean)?;
        Ok(Self(Kind::Normal { mean, deviation: positive("standard uncertainty", standard_uncertainty)? }))
    }

    /// A positive value: its logarithm is normal about that of `median` (unit of the parameter), with the standard
    /// deviation `log_deviation` (1), which for a small one is the relative standard uncertainty.
    ///
    /// # Errors
    /// [`FitError::OutOfRange`] unless both are finite and positive.
    pub fn log_normal(median: f64, log_deviation: f64) -> Result<Self, FitError> {
        let logarithm = positive("median", median)?.ln();
        Ok(Self(Kind::LogNormal {
            logarithm,
            deviation: positive("standard deviation of a logarithm", log_deviation)?,
        }))
    }

    /// The same density from `lower` to `upper` (unit of the parameter), and none beyond.
    ///
    /// # Errors
    /// [`FitError::OutOfRange`] unless both are finite and in ascending order.
    pub fn uniform(lower: f64, upper: f64) -> Result<Self, FitError> {
        let (lower, upper) = (finite("lower end", lower)?, finite("upper end", upper)?);
        let bounds = Bounds::new(lower, upper).ok().filter(|bounds| !bounds.is_fixed());
        let bounds = bounds.ok_or_else(|| {
            let [from, to] = [lower, upper].map(Rounded::every_digit);
            let what = format!("a uniform prior must end above its beginning, but reaches from {from} to {to}");
            FitError::out_of_range(what, upper)
        })?;
        Ok(Self(Kind::Uniform(bounds)))
    }

    /// The logarithm of the density at `value`, without a constant; −∞ where the prior rules the value out.
    pub fn log_density(&self, value: f64) -> f64 {
        if self.support().contains(value) { self.at(value).value } else { f64::NEG_INFINITY }
    }

    /// A value at random, within the bounds of `parameter`.
    pub(super) fn draw(&self, parameter: &Parameter, random: &mut ChaCha8Rng) -> Result<f64, FitError> {
        let bounds = parameter.bounds();
        let within = bounds.at_least(self.support().lower()).at_most(self.support().upper());
        if bounds.is_fixed() {
            return Ok(bounds.lower());
        }
        for _ in 0..TRIES {
            let value = match self.0 {
                Kind::Flat | Kind::Uniform(_) => {
                    let width = within.upper() - within.lower();
                    if !width.is_finite() {
                        let what = "needs a prior to be drawn from; give one with a width";
                        return Err(FitError::undetermined(format!("{} {what}", parameter.name())));
                    }
                    within.lower() + width * random.random::<f64>()
                }
                Kind::Normal { mean, deviation } => mean + deviation * standard_normal(random),
                Kind::LogNormal { logarithm, deviation } => (logarithm + deviation * standard_normal(random)).exp(),
            };
            if within.contains(value) {
                return Ok(value);
            }
        }
        Err(outside_bounds(parameter))
    }

    /// The interval outside of which the density is zero.
    pub(super) fn support(&self) -> Bounds {
        match self.0 {
            Kind::Flat | Kind::Normal { .. } => Bounds::UNBOUNDED,
            Kind::LogNormal { .. } => Bounds::POSITIVE,
            Kind::Uniform(bounds) => bounds,
        }
    }

    /// The density at a value within the support.
    pub(super) fn at(&self, value: f64) -> LogDensity {
        match self.0 {
            Kind::Flat | Kind::Uniform(_) => LogDensity { value: 0.0, slope: 0.0, curvature: 0.0 },
            Kind::Normal { mean, deviation } => {
                let away = (value - mean) / deviation;
                LogDensity {
                    value: -0.5 * away * away,
                    slope: -away / deviation,
                    curvature: 1.0 / (deviation * deviation),
                }
            }
            Kind::LogNormal { logarithm, deviation } => {
                let away = (value.ln() - logarithm) / deviation;
                LogDensity {
                    value: -value.ln() - 0.5 * away * away,
                    slope: -(1.0 + away / deviation) / value,
                    curvature: (value * deviation).powi(-2),
                }
            }
        }
    }
}

fn finite(what: &str, value: f64) -> Result<f64, FitError> {
    let refused = || FitError::option(&format!("a prior's {what}"), "finite", value);
    value.is_finite().then_some(value).ok_or_else(refused)
}

fn positive(what: &str, value: f64) -> Result<f64, FitError> {
    let refused = || FitError::option(&format!("a prior's {what}"), "above 0", value);
    (value > 0.0 && value.is_finite()).then_some(value).ok_or_else(refused)
}

/// A prior that rules out all values that the bounds of its parameter allow.
pub(super) fn outside_bounds(parameter: &Parameter) -> FitError {
    let [lower, upper] = [parameter.bounds().lower(), parameter.bounds().upper()].map(Rounded::every_digit);
    let name = parameter.name();
    FitError::problem(format!("the prior of {name} has no value within its bounds, [{lower}, {upper}]"))
}

pub(super) fn standard_normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_differences() {
        let priors = [Prior::normal(2.0, 0.5), Prior::log_normal(2.0, 0.3), Prior::uniform(-1.0, 5.0)];
        for prior in priors.map(Result::unwrap) {
            for value in [0.7, 2.0, 3.1] {
                let difference = (prior.log_density(value + 1e-5) - prior.log_density(value - 1e-5)) / 2e-5;
                // Truncation 1e-10/6 of third derivatives of up to 400, rounding 1e-15/1e-5.
                assert!((prior.at(value).slope - difference).abs() < 1e-8, "{prior:?} at {value}");
            }
        }
    }

    #[test]
    fn what_is_no_density_is_refused() {
        let nan = f64::NAN;
        for refused in [
            Prior::normal(nan, 1.0),
            Prior::normal(0.0, nan),
            Prior::normal(0.0, f64::INFINITY),
            Prior::log_normal(0.0, 1.0),
            Prior::log_normal(1.0, -1.0),
            Prior::uniform(1.0, 1.0),
            Prior::uniform(2.0, 1.0),
            Prior::uniform(0.0, f64::INFINITY),
        ] {
            assert!(matches!(refused, Err(FitError::OutOfRange { .. })), "{refused:?}");
        }
    }
}
