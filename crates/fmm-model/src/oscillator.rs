//! The machine as a single-degree-of-freedom oscillator.

use core::f64::consts::PI;

use crate::damping::Damping;
use crate::error::ModelError;
use crate::restoring::Restoring;
use crate::scalar::Scalar;

/// Mass, stiffness and damping of a machine that moves in one direction.
///
/// ```text
/// m x″ + c₁ x′ + c₂ |x′| x′ + … + k x = f                          (thesis Eq. 5.1)
/// ```
///
/// | symbol | field | unit | per unit mass |
/// |---|---|---|---|
/// | m | `mass` | kg | 1 |
/// | k | `stiffness` | N/m | 1/s² |
/// | c₁, c₂ | `damping` | N s/m, N s²/m² | 1/s, 1/m |
///
/// A free velocity record determines k/m and c/m only; [`Oscillator::per_unit_mass`] is the machine as such a
/// record sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillator<D = f64> {
    mass: D,
    stiffness: D,
    damping: Damping<D>,
    restoring: Restoring<D>,
}

impl<D: Scalar> Oscillator<D> {
    /// An undamped oscillator of `mass` (kg) and `stiffness` (N/m); a stiffness of zero is a mass without a spring.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if the mass is zero, negative or not finite, [`ModelError::Negative`] if the
    /// stiffness is negative or not finite.
    pub fn new(mass: D, stiffness: D) -> Result<Self, ModelError> {
        ModelError::require_positive("mass", mass.value(), "kg")?;
        ModelError::require_not_negative("stiffness", stiffness.value(), "N/m")?;
        Ok(Self { mass, stiffness, damping: Damping::none(), restoring: Restoring::Linear })
    }

    /// The oscillator of unit mass with an undamped `natural_frequency` (Hz).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`] if the frequency is zero, negative or not finite.
    pub fn per_unit_mass(natural_frequency: D) -> Result<Self, ModelError> {
        ModelError::require_positive("natural frequency", natural_frequency.value(), "Hz")?;
        let angular = natural_frequency * (2.0 * PI);
        Self::new(D::from(1.0), angular * angular)
    }

    /// The same oscillator with `damping`.
    #[must_use]
    pub fn with_damping(mut self, damping: Damping<D>) -> Self {
        self.damping = damping;
        self
    }

    /// The same oscillator with another `restoring` force; the stiffness is then its slope at the origin.
    #[must_use]
    pub fn with_restoring(mut self, restoring: Restoring<D>) -> Self {
        self.restoring = restoring;
        self
    }

    /// True if both the damping and the restoring force are linear, so that the motion has a closed form.
    pub fn is_linear(&self) -> bool {
        self.damping.is_linear() && matches!(self.restoring, Restoring::Linear)
    }

    /// Restoring force over the position.
    pub fn restoring(&self) -> Restoring<D> {
        self.restoring
    }

    /// The restoring force (N) at `position` (m); it has the sign of the position.
    pub fn restoring_force(&self, position: D) -> D {
        self.restoring.force(self.stiffness, position)
    }

    /// Potential energy (J) at `position` (m).
    pub fn potential_energy(&self, position: D) -> D {
        self.restoring.energy(self.stiffness, position)
    }

    /// Kinetic energy (J) at `velocity` (m/s).
    pub fn kinetic_energy(&self, velocity: D) -> D {
        self.mass * velocity * velocity * 0.5
    }

    /// m, mass (kg).
    pub fn mass(&self) -> D {
        self.mass
    }

    /// k, stiffness (N/m).
    pub fn stiffness(&self) -> D {
        self.stiffness
    }

    /// The damping force (N) at `velocity` (m/s), that of [`Damping::force`]. In a loop it costs less than
    /// `damping().force(velocity)`, which copies the damping.
    pub fn damping_force(&self, velocity: D) -> D {
        self.damping.force(velocity)
    }

    /// Damping of the machine itself.
    pub fn damping(&self) -> Damping<D> {
        self.damping
    }

    /// ω₀ = √(k/m), undamped natural angular frequency (rad/s).
    pub fn natural_angular_frequency(&self) -> D {
        (self.stiffness / self.mass).sqrt()
    }

    /// f₀ = ω₀/2π, undamped natural frequency (Hz).
    pub fn natural_frequency(&self) -> D {
        self.natural_angular_frequency() / (2.0 * PI)
    }

    /// ζ = c₁/(2√(k m)), ratio of the linear damping to critical damping (1); without a spring infinite, and zero
    /// without damping.
    pub fn damping_ratio(&self) -> D {
        if self.stiffness.value() == 0.0 && self.damping.linear_coefficient().value() == 0.0 {
            return D::from(0.0);
        }
        self.damping.linear_coefficient() / ((self.stiffness * self.mass).sqrt() * 2.0)
    }

    /// ω_d = √(ω₀² − (c₁/2m)²), angular frequency of the damped free vibration (rad/s); `None` at or above critical
    /// damping, where nothing oscillates.
    pub fn damped_angular_frequency(&self) -> Option<D> {
        let rate = self.damping.linear_coefficient() / (self.mass * 2.0);
        let square = self.stiffness / self.mass - rate * rate;
        (square.value() > 0.0).then(|| square.sqrt())
    }

    /// ω_d/2π, frequency of the damped free vibration (Hz); `None` at or above critical damping.
    pub fn damped_frequency(&self) -> Option<D> {
        self.damped_angular_frequency().map(|angular| angular / (2.0 * PI))
    }

    /// δ = π c₁/(m ω_d), natural logarithm of the ratio of successive maxima, for the linear damping (1); `None` at
    /// or above critical damping.
    pub fn logarithmic_decrement(&self) -> Option<D> {
        let damped = self.damped_angular_frequency()?;
        Some(self.damping.linear_coefficient() * PI / (self.mass * damped))
    }

    /// Q = 1/(2ζ), quality factor of the linear damping (1); `None` without damping.
    pub fn quality_factor(&self) -> Option<D> {
        let ratio = self.damping_ratio();
        (ratio.value() != 0.0).then(|| D::from(0.5) / ratio)
    }

    /// τ = 2m/c₁, time in which the amplitude falls by a factor of e under the linear damping alone (s); `None` without
    /// damping.
    pub fn time_constant(&self) -> Option<D> {
        let linear = self.damping.linear_coefficient();
        (linear.value() != 0.0).then(|| self.mass * 2.0 / linear)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::Dual;

    fn thesis() -> Oscillator {
        Oscillator::new(10.391, 1982.0).unwrap().with_damping(Damping::linear(0.275).unwrap())
    }

    /// Reference values printed with 13 digits by the 256-bit oracle `coulomb_viscous_free_decay_mc`.
    #[test]
    fn thesis_machine() {
        assert!((thesis().natural_angular_frequency() - 13.810_937_269_391_616).abs() < 1e-14);
        assert!((thesis().damping_ratio() - 0.000_958_125_062_836_199_5).abs() < 1e-18);
        assert!((thesis().damped_angular_frequency().unwrap() - 13.810_930_930_144_846).abs() < 1e-14);
        let half_swing_ratio: f64 = 0.996_994_485_588_368_1;
        let decrement = thesis().logarithmic_decrement().unwrap();
        assert!((decrement + 2.0 * half_swing_ratio.ln()).abs() < 1e-15);
    }

    #[test]
    fn nothing_oscillates_above_critical_damping() {
        let critical = 2.0 * (10.391f64 * 1982.0).sqrt();
        let machine = thesis().with_damping(Damping::linear(critical * 1.01).unwrap());
        assert!(machine.damping_ratio() > 1.0);
        assert_eq!(machine.damped_frequency(), None);
        assert_eq!(machine.logarithmic_decrement(), None);
    }

    /// A mass without a spring is a machine that does not swing.
    #[test]
    fn a_mass_needs_no_spring() {
        let block = Oscillator::new(2.0, 0.0).unwrap();
        assert_eq!(
            (block.natural_frequency(), block.restoring_force(3.0), block.potential_energy(3.0)),
            (0.0, 0.0, 0.0)
        );
        assert_eq!((block.damping_ratio(), block.damped_frequency(), block.logarithmic_decrement()), (0.0, None, None));
        let damped = block.with_damping(Damping::linear(0.1).unwrap());
        assert_eq!((damped.damping_ratio(), damped.damped_frequency()), (f64::INFINITY, None));
    }

    #[test]
    fn natural_frequency_has_its_derivatives() {
        let machine = Oscillator::new(Dual::<2>::variable(10.391, 0), Dual::variable(1982.0, 1)).unwrap();
        let f = machine.natural_frequency();
        assert!((f.partial(0) + f.value() / (2.0 * 10.391)).abs() < 1e-15);
        assert!((f.partial(1) - f.value() / (2.0 * 1982.0)).abs() < 1e-18);
    }

    #[test]
    fn impossible_machines_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Oscillator::new(bad, 1982.0).is_err());
            assert!(bad == 0.0 || Oscillator::new(10.0, bad).is_err());
            assert!(Oscillator::<f64>::per_unit_mass(bad).is_err());
        }
        let message = Oscillator::new(-1.0, 1982.0).unwrap_err().to_string();
        assert_eq!(message, "mass must be positive and finite, but is -1 kg");
    }
}
