//! The response of a linear oscillator in closed form.

use std::f64::consts::TAU;

use fmm_model::ModelError;
use fmm_record::Complex64;

use crate::error::FrfError;
use crate::response::{FrequencyResponse, ResponseForm};

/// A linear oscillator with viscous damping, as a response to compare a measured one with.
///
/// ```text
/// m x″ + c x′ + k x = f,   H(ω) = 1/(k − m ω² + i c ω)
/// ```
///
/// | symbol | field | unit | meaning |
/// |---|---|---|---|
/// | m | `mass` | kg | moving mass |
/// | c | `damping` | N s/m | viscous coefficient, possibly 0 |
/// | k | `stiffness` | N/m | stiffness |
///
/// ```
/// use fmm_frf::SingleDegreeOfFreedom;
///
/// let machine = SingleDegreeOfFreedom::new(10.391, 0.275, 1982.0)?;
/// let receptance = machine.receptance(2.2)?;
/// assert!((receptance.norm() - 0.194_393).abs() < 1e-6);
/// assert!(receptance.im < 0.0);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingleDegreeOfFreedom {
    mass: f64,
    damping: f64,
    stiffness: f64,
}

impl SingleDegreeOfFreedom {
    /// An oscillator of `mass` m (kg), `damping` c (N s/m) and `stiffness` k (N/m).
    ///
    /// # Errors
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for mass or stiffness,
    /// [`ModelError::Negative`](crate::ModelError::Negative) for the damping.
    pub fn new(mass: f64, damping: f64, stiffness: f64) -> Result<Self, FrfError> {
        ModelError::require_positive("mass", mass, "kg")?;
        ModelError::require_not_negative("damping", damping, "N s/m")?;
        ModelError::require_positive("stiffness", stiffness, "N/m")?;
        Ok(Self { mass, damping, stiffness })
    }

    /// m (kg).
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// c (N s/m).
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// k (N/m).
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// ω₀ = √(k/m), undamped natural angular frequency (rad/s).
    pub fn natural_angular_frequency(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// H, receptance at `frequency` (Hz), in m/N.
    ///
    /// Near resonance k − m ω² cancels, and the relative error of H grows to about (k + m ω²) |H| roundings; so does
    /// that of the frequency itself.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`](crate::ModelError::NotFinite) for the frequency, [`FrfError::NotDefined`] for c = 0 at
    /// ω₀.
    pub fn receptance(&self, frequency: f64) -> Result<Complex64, FrfError> {
        let omega = TAU * ModelError::require_finite("frequency", frequency, "Hz")?;
        let dynamic_stiffness = Complex64::new(self.stiffness - self.mass * omega * omega, self.damping * omega);
        // `finv` divides by the magnitude twice, which neither overflows nor underflows where the result does not.
        let receptance = dynamic_stiffness.finv();
        if receptance.is_finite() {
            return Ok(receptance);
        }
        let what = "the oscillator has no finite receptance";
        let why = "where it is in resonance without damping";
        Err(FrfError::not_defined(format!("{what} at {frequency} Hz, {why}"), frequency))
    }

    /// The response at `frequency` (Hz) in any `form`, in its SI unit.
    ///
    /// # Errors
    /// Those of [`SingleDegreeOfFreedom::receptance`].
    pub fn response(&self, form: ResponseForm, frequency: f64) -> Result<Complex64, FrfError> {
        ResponseForm::Receptance.convert(form, self.receptance(frequency)?, frequency)
    }

    /// The response at all `frequencies` (Hz) in any `form`.
    ///
    /// # Errors
    /// Those of [`SingleDegreeOfFreedom::receptance`] and [`FrequencyResponse::new`].
    pub fn frequency_response(&self, form: ResponseForm, frequencies: &[f64]) -> Result<FrequencyResponse, FrfError> {
        let values = frequencies.iter().map(|&frequency| self.response(form, frequency));
        FrequencyResponse::new(form, frequencies.to_vec(), values.collect::<Result<_, _>>()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_the_response() {
        let machine = SingleDegreeOfFreedom::new(10.391, 8.0, 1982.0).unwrap();
        assert_eq!(machine.receptance(0.0).unwrap(), Complex64::new(1.0 / 1982.0, 0.0));
        // Far above resonance only the mass is left; the stiffness still takes ω₀²/ω² = 5e-10 of it.
        let accelerance = machine.response(ResponseForm::Accelerance, 1e5).unwrap();
        assert!((accelerance.re * 10.391 - 1.0).abs() < 1e-9, "{accelerance} 1/kg");
        // At resonance only the damping is left.
        let mobility = machine.response(ResponseForm::Mobility, machine.natural_angular_frequency() / TAU).unwrap();
        assert!((mobility - 1.0 / 8.0).norm() < 1e-13, "{mobility} m/(N s)");
    }

    #[test]
    fn undamped_resonance_is_refused_and_nothing_else() {
        // ω² = k/m exactly, with the angular frequency as the square root of a square.
        let frequency = 1.0;
        let undamped = SingleDegreeOfFreedom::new(1.0, 0.0, TAU * TAU).unwrap();
        assert!(matches!(undamped.receptance(frequency), Err(FrfError::NotDefined { frequency: 1.0, .. })));
        assert!(undamped.receptance(1.5).unwrap().re < 0.0);
        assert!(undamped.receptance(f64::NAN).is_err());
    }

    #[test]
    fn impossible_oscillators_are_refused() {
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(SingleDegreeOfFreedom::new(bad, 1.0, 1.0).is_err());
            assert!(SingleDegreeOfFreedom::new(1.0, bad, 1.0).is_err());
            assert!(SingleDegreeOfFreedom::new(1.0, 1.0, bad).is_err());
        }
        assert!(SingleDegreeOfFreedom::new(0.0, 1.0, 1.0).is_err());
    }
}
