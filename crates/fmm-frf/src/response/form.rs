//! The three forms of a response: receptance, mobility, accelerance.

use std::f64::consts::TAU;
use std::fmt;

use fmm_model::ModelError;
use fmm_record::{Complex64, Quantity};

use crate::error::FrfError;

/// Kind of frequency response, by the quantity of the response per force.
///
/// | form | response | unit | of the receptance H |
/// |---|---|---|---|
/// | receptance | displacement | m/N | H |
/// | mobility | velocity | m/(N s) | iω H |
/// | accelerance | acceleration | 1/kg | (iω)² H |
///
/// The time dependence is e^{+iωt} with ω = 2π f, as a discrete Fourier transform with e^{−iωt} gives it. A passive
/// machine then has Im H < 0 and Re(iω H) > 0 for f > 0; conjugate a response of the other convention first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum ResponseForm {
    /// Displacement by force (m/N).
    Receptance,
    /// Velocity by force (m/(N s)).
    Mobility,
    /// Acceleration by force (1/kg).
    Accelerance,
}

impl ResponseForm {
    /// The same response `value` at `frequency` (Hz) in the form `to`: times (iω)ⁿ, with n the number of
    /// derivatives from this form to that.
    ///
    /// At zero frequency mobility and accelerance of a finite receptance are zero, and the way back does not exist:
    /// the static receptance cannot be had from a velocity.
    ///
    /// ```
    /// use fmm_frf::{Complex64, FrfError, ResponseForm};
    ///
    /// let mobility = Complex64::new(0.0, 0.5);
    /// let receptance = ResponseForm::Mobility.convert(ResponseForm::Receptance, mobility, 1.0)?;
    /// assert!((receptance - 0.5 / std::f64::consts::TAU).norm() < 1e-16);
    /// assert!(ResponseForm::Mobility.convert(ResponseForm::Receptance, mobility, 0.0).is_err());
    /// # Ok::<(), FrfError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::NotFinite`](crate::ModelError::NotFinite) for the frequency, [`FrfError::Values`] for the value,
    /// and [`FrfError::NotDefined`] for a division at zero frequency or any overflow.
    pub fn convert(self, to: Self, value: Complex64, frequency: f64) -> Result<Complex64, FrfError> {
        let omega = TAU * ModelError::require_finite("frequency", frequency, "Hz")?;
        if !value.is_finite() {
            return Err(FrfError::value_not_finite(self, frequency));
        }
        let Complex64 { re, im } = value;
        let converted = match to.derivatives() - self.derivatives() {
            -2 => Complex64::new(-re / omega / omega, -im / omega / omega),
            -1 => Complex64::new(im / omega, -re / omega),
            1 => Complex64::new(-im * omega, re * omega),
            2 => Complex64::new(-re * omega * omega, -im * omega * omega),
            _ => value,
        };
        self.require_finite(to, converted, frequency)
    }

    /// [`ResponseForm::convert`] for a response at s = σ + iω instead of iω, with σ the `decay_rate` (1/s) of an
    /// exponential window: times sⁿ.
    pub(crate) fn convert_damped(
        self,
        to: Self,
        value: Complex64,
        frequency: f64,
        decay_rate: f64,
    ) -> Result<Complex64, FrfError> {
        if decay_rate == 0.0 {
            return self.convert(to, value, frequency);
        }
        let s = Complex64::new(decay_rate, TAU * frequency);
        let converted = match to.derivatives() - self.derivatives() {
            -2 => value / s / s,
            -1 => value / s,
            1 => value * s,
            2 => value * s * s,
            _ => value,
        };
        self.require_finite(to, converted, frequency)
    }

    /// Refuses a division by iω at zero `frequency` (Hz), or a factor so extreme that the value overflows.
    fn require_finite(self, to: Self, converted: Complex64, frequency: f64) -> Result<Complex64, FrfError> {
        let what = || format!("no finite {to} follows from the {self} at {frequency} Hz");
        if converted.is_finite() { Ok(converted) } else { Err(FrfError::not_defined(what(), frequency)) }
    }

    /// The quantity of the response.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Receptance => Quantity::Displacement,
            Self::Mobility => Quantity::Velocity,
            Self::Accelerance => Quantity::Acceleration,
        }
    }

    /// Unit of the form, for a response in SI units and a force in N.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Receptance => "m/N",
            Self::Mobility => "m/(N s)",
            Self::Accelerance => "1/kg",
        }
    }

    /// Number of differentiations of the displacement.
    pub(crate) const fn derivatives(self) -> i8 {
        match self {
            Self::Receptance => 0,
            Self::Mobility => 1,
            Self::Accelerance => 2,
        }
    }
}

impl fmt::Display for ResponseForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Receptance => "receptance",
            Self::Mobility => "mobility",
            Self::Accelerance => "accelerance",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMS: [ResponseForm; 3] = [ResponseForm::Receptance, ResponseForm::Mobility, ResponseForm::Accelerance];

    #[test]
    fn conversion_there_and_back_is_the_identity() {
        let value = Complex64::new(-0.3, 1.7);
        for from in FORMS {
            for to in FORMS {
                let there = from.convert(to, value, 2.2).unwrap();
                let back = to.convert(from, there, 2.2).unwrap();
                // Four products or quotients of 1.1e-16 each.
                assert!((back - value).norm() < 5e-16 * value.norm(), "{from} to {to}: {back}");
                let expected = Complex64::new(0.0, TAU * 2.2).powi(i32::from(to.derivatives() - from.derivatives()));
                assert!((there / value - expected).norm() < 1e-14 * expected.norm(), "{from} to {to}: {there}");
            }
        }
    }

    #[test]
    fn zero_frequency_goes_up_but_not_down() {
        let value = Complex64::new(1.0, 0.0);
        for from in FORMS {
            for to in FORMS {
                match from.convert(to, value, 0.0) {
                    Ok(converted) if from == to => assert_eq!(converted, value),
                    Ok(converted) => assert!(from < to && converted.norm() == 0.0, "{from} to {to}: {converted}"),
                    Err(error) => assert!(matches!(error, FrfError::NotDefined { frequency: 0.0, .. }), "{error}"),
                }
                assert_eq!(from.convert(to, value, 0.0).is_err(), from > to);
            }
        }
        let zero = ResponseForm::Mobility.convert(ResponseForm::Receptance, Complex64::ZERO, 0.0);
        assert!(zero.is_err(), "0/0 is as unknown as 1/0: {zero:?}");
    }
}
