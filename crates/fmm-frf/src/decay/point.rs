//! Point of a backbone, as measured and without the bias of its window.

use std::f64::consts::TAU;

use fmm_model::Estimated;

use crate::decay::spring::bend;

/// Amplitude, frequency and damping of a decay around one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackbonePoint {
    /// The middle of its window (s).
    pub time: f64,
    /// A, of the displacement (m, or the unit of the record times a power of s).
    pub amplitude: Estimated,
    /// f (Hz), of the spring: without the effect of the loss on the period.
    pub frequency: Estimated,
    /// c_eq/m, the viscous damping that takes as much from the amplitude (1/s).
    pub damping: Estimated,
}

/// Share of a correction that is added to the uncertainty, for terms of higher order (1).
const HIGHER_ORDERS: f64 = 0.15;
/// Relative uncertainty of damping and frequency by terms of second order, over (c/ω)² (1).
const SECOND_ORDER: (f64, f64) = (0.15, 0.04);

/// Point as measured, on a straight spring.
pub(crate) struct Row {
    pub(crate) point: BackbonePoint,
    /// Twice the factor of the second derivative of a rate, in that rate as measured (s²).
    pub(crate) reach: f64,
    /// Factor of n in the frequency 1 − (1 + lag n)/8 (c/ω)² as measured over that of the spring.
    pub(crate) lag: f64,
    /// Number of times that the displacement was differentiated.
    pub(crate) orders: f64,
    /// Twice the part of the amplitude as measured that higher multiples make, over the bend of the spring.
    pub(crate) harmonic: f64,
}

impl Row {
    /// The point on a `spring`, without what a loss c_eq ~ Aⁿ changes within its window.
    ///
    /// ```text
    /// c + c″ reach/6,    c″ = ½ q c³,             q = ½ (n² + d²c/(c d ln A²))
    /// ω + ω″ reach/6,    ω″ = ¼ (2 + n) c² dω/d ln A
    /// ```
    ///
    /// The action, not the square of the amplitude, decays with c/m, and a derivative does not go with the amplitude.
    pub(crate) fn unbiased(&self, [power, second]: [Estimated; 2], spring: &[Estimated]) -> BackbonePoint {
        let mut point = self.point;
        let (n, u, c, f) = (power.value, power.uncertainty, point.damping.value, point.frequency.value);
        let (lost, curved) = ((c / (TAU * f)).powi(2), self.reach * c * c / 12.0);
        let bend = bend(spring, point.amplitude.value);
        let window = second.scaled(curved);
        let of_spring = (1.0 + 0.5 * bend) / (1.0 + (self.orders + self.harmonic) * bend);
        let factor = if of_spring > 0.0 { of_spring } else { 1.0 } / (1.0 + window.value);
        let of_window = window.uncertainty.hypot(HIGHER_ORDERS * window.value);
        point.amplitude = point.amplitude.scaled(1.0 - 0.5 * self.harmonic * bend);
        let u_damping = point.damping.uncertainty.hypot(c * of_window.hypot(SECOND_ORDER.0 * lost));
        point.damping = Estimated::new(c, u_damping).scaled(factor);
        let mut change = |by: f64, u: f64| {
            point.frequency.value += f * by;
            point.frequency.uncertainty = point.frequency.uncertainty.hypot(f * u.hypot(HIGHER_ORDERS * by));
        };
        change((1.0 + self.lag * n) / 8.0 * lost, lost * SECOND_ORDER.1.hypot(self.lag * u / 8.0));
        change(-0.5 * (2.0 + n) * bend * curved, 0.5 * u * bend * curved);
        point
    }
}
