//! The free damped vibration in closed form.

use std::f64::consts::PI;

use fmm_model::Scalar;

/// x″ + 2β x′ + ω₀² x = 0 from an initial state, below critical damping.
///
/// ```text
/// x = e^{−βt} (x₀ cos ω_d t + (v₀ + β x₀)/ω_d sin ω_d t)
/// v = e^{−βt} (v₀ cos ω_d t − (β v₀ + ω₀² x₀)/ω_d sin ω_d t),        β = c/2m,   ω_d² = ω₀² − β²
/// ```
#[derive(Debug, Clone, Copy)]
pub(crate) struct FreeVibration<D> {
    rate: D,
    angular: D,
    position: (D, D),
    velocity: (D, D),
}

impl<D: Scalar> FreeVibration<D> {
    /// From f₀ (Hz), c/m (1/s) and the initial state; `None` at or above critical damping.
    pub(crate) fn new(frequency: D, damping: D, position: D, velocity: D) -> Option<Self> {
        let (natural, rate) = (frequency * (2.0 * PI), damping * 0.5);
        let square = natural * natural - rate * rate;
        let angular = (square.value() > 0.0).then(|| square.sqrt())?;
        Some(Self {
            rate,
            angular,
            position: (position, (velocity + rate * position) / angular),
            velocity: (velocity, -(rate * velocity + natural * natural * position) / angular),
        })
    }

    /// Position and velocity after `time` (s).
    pub(crate) fn state(&self, time: f64) -> (D, D) {
        let (decay, angle) = ((-self.rate * time).exp(), self.angular * time);
        let (sin, cos) = angle.sin_cos();
        let at = |(a, b): (D, D)| decay * (a * cos + b * sin);
        (at(self.position), at(self.velocity))
    }

    /// Height of the envelope of the velocity after `time` (s).
    pub(crate) fn velocity_amplitude(&self, time: f64) -> f64 {
        let (a, b) = (self.velocity.0.value(), self.velocity.1.value());
        (-self.rate.value() * time).exp() * a.hypot(b)
    }
}
