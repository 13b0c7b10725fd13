//! A mode: its natural frequency and damping.

use std::f64::consts::TAU;
use std::fmt;

use crate::least_squares::variance_of;
use crate::{Estimated, FrfError};

/// Natural frequency and damping of a mode, with the damping of an exponential window taken out.
///
/// ```text
/// pole s = −ζω₀ ± iω₀√(1 − ζ²),   f₀ = ω₀/2π
/// ```
///
/// Uncertainties are those of the scatter of the lines about the fit. They do not contain what all lines share:
/// leakage, a delay between the channels, other modes in the band.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Mode {
    /// f₀, undamped natural frequency (Hz).
    pub natural_frequency: Estimated,
    /// ζ, damping ratio (1).
    pub damping_ratio: Estimated,
}

impl Mode {
    /// The mode of s² + q₁ s + q₀ with the covariance of (q₀, q₁), both in units of powers of `unit` (rad/s), less an
    /// exponential window of `decay_rate` σ (1/s).
    ///
    /// ```text
    /// s → s − σ:   q₁ → q₁ − 2σ,   q₀ → q₀ − σ q₁ + σ²
    /// ```
    pub(super) fn new(
        [q0, q1]: [f64; 2],
        covariance: &[[f64; 2]; 2],
        unit: f64,
        decay_rate: f64,
        none: impl FnOnce() -> FrfError,
    ) -> Result<Self, FrfError> {
        let sigma = decay_rate / unit;
        let (p0, p1) = (q0 - sigma * q1 + sigma * sigma, q1 - 2.0 * sigma);
        if !(p0 > 0.0 && p0.is_finite() && p1.is_finite()) {
            return Err(none());
        }
        let root = p0.sqrt();
        let ratio = p1 / (2.0 * root);
        // Gradients with respect to (q₀, q₁).
        let of_frequency = [0.5 / root, -0.5 * sigma / root];
        let of_ratio = [-0.5 * ratio / p0, 0.5 / root + 0.5 * ratio * sigma / p0];
        let hertz = unit / TAU;
        Ok(Self {
            natural_frequency: Estimated::new(hertz * root, hertz * variance_of(of_frequency, covariance).sqrt()),
            damping_ratio: Estimated::new(ratio, variance_of(of_ratio, covariance).sqrt()),
        })
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "f₀ = {} Hz, ζ = {}", self.natural_frequency, self.damping_ratio)
    }
}
