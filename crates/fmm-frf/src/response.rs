//! Response per force as a function of frequency, and its three forms.

use std::f64::consts::TAU;
use std::fmt;

use num_complex::Complex64;

use crate::FrfError;

/// What the response to a force is counted in.
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
    /// [`FrfError::NotFinite`] for the frequency, [`FrfError::ValueNotFinite`] for the value, and
    /// [`FrfError::NoFiniteForm`] for a division at zero frequency or any overflow.
    pub fn convert(self, to: Self, value: Complex64, frequency: f64) -> Result<Complex64, FrfError> {
        let omega = TAU * FrfError::require_finite("frequency", frequency, "Hz")?;
        if !value.is_finite() {
            return Err(FrfError::ValueNotFinite { form: self, frequency });
        }
        let Complex64 { re, im } = value;
        let converted = match to.derivatives() - self.derivatives() {
            -2 => Complex64::new(-re / omega / omega, -im / omega / omega),
            -1 => Complex64::new(im / omega, -re / omega),
            1 => Complex64::new(-im * omega, re * omega),
            2 => Complex64::new(-re * omega * omega, -im * omega * omega),
            _ => value,
        };
        if converted.is_finite() { Ok(converted) } else { Err(FrfError::NoFiniteForm { from: self, to, frequency }) }
    }

    /// How often the displacement is differentiated.
    const fn derivatives(self) -> i8 {
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

/// A response at increasing frequencies, all of it finite and in one form.
///
/// ```
/// use fmm_frf::{Complex64, FrequencyResponse, ResponseForm};
///
/// let lines = [0.0, 3e-3, -2e-2, -1e-3].map(|re| Complex64::new(re, -2.0 * re.abs()));
/// let mobility = FrequencyResponse::new(ResponseForm::Mobility, vec![0.0, 1.0, 2.0, 3.0], lines.to_vec())?;
/// let receptance = mobility.without_zero_frequency().converted(ResponseForm::Receptance)?;
/// let (frequency, magnitude) = receptance.peak().unwrap();
/// assert_eq!(frequency, 2.0);
/// assert!((magnitude - 3.559e-3).abs() < 1e-6);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyResponse {
    form: ResponseForm,
    frequencies: Vec<f64>,
    values: Vec<Complex64>,
}

impl FrequencyResponse {
    /// A response of the given `form`, one value (SI unit of the form) for each frequency (Hz).
    ///
    /// # Errors
    /// [`FrfError::LengthMismatch`], [`FrfError::FrequenciesNotIncreasing`] or [`FrfError::ValueNotFinite`].
    pub fn new(form: ResponseForm, frequencies: Vec<f64>, values: Vec<Complex64>) -> Result<Self, FrfError> {
        if frequencies.len() != values.len() {
            return Err(FrfError::LengthMismatch { frequencies: frequencies.len(), values: values.len() });
        }
        // Zero itself is a frequency, and the largest number below it is not.
        let mut above = (-0.0f64).next_down();
        for (index, (&frequency, value)) in frequencies.iter().zip(&values).enumerate() {
            if !(frequency > above && frequency.is_finite()) {
                return Err(FrfError::FrequenciesNotIncreasing { index, frequency });
            }
            if !value.is_finite() {
                return Err(FrfError::ValueNotFinite { form, frequency });
            }
            above = frequency;
        }
        Ok(Self { form, frequencies, values })
    }

    /// Form of all values.
    pub fn form(&self) -> ResponseForm {
        self.form
    }

    /// Frequencies (Hz), increasing, none negative.
    pub fn frequencies(&self) -> &[f64] {
        &self.frequencies
    }

    /// Values (SI unit of the form), one for each frequency.
    pub fn values(&self) -> &[Complex64] {
        &self.values
    }

    /// The response in another form, line by line as [`ResponseForm::convert`].
    ///
    /// # Errors
    /// [`FrfError::NoFiniteForm`] at a line of zero frequency on the way towards receptance; see
    /// [`FrequencyResponse::without_zero_frequency`].
    pub fn converted(&self, form: ResponseForm) -> Result<Self, FrfError> {
        let lines = self.frequencies.iter().zip(&self.values);
        let values = lines.map(|(&frequency, &value)| self.form.convert(form, value, frequency));
        Ok(Self { form, frequencies: self.frequencies.clone(), values: values.collect::<Result<_, _>>()? })
    }

    /// The response without its line at zero frequency, if there is one.
    #[must_use]
    pub fn without_zero_frequency(mut self) -> Self {
        if self.frequencies.first() == Some(&0.0) {
            self.frequencies.remove(0);
            self.values.remove(0);
        }
        self
    }

    /// Frequency (Hz) and magnitude (SI unit of the form) of the line of largest magnitude, the first of equals;
    /// none if there are no lines.
    pub fn peak(&self) -> Option<(f64, f64)> {
        let lines = self.frequencies.iter().zip(&self.values).map(|(&frequency, value)| (frequency, value.norm()));
        lines.reduce(|highest, line| if line.1 > highest.1 { line } else { highest })
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
                    Err(error) => assert_eq!(error, FrfError::NoFiniteForm { from, to, frequency: 0.0 }),
                }
                assert_eq!(from.convert(to, value, 0.0).is_err(), from > to);
            }
        }
        let zero = ResponseForm::Mobility.convert(ResponseForm::Receptance, Complex64::ZERO, 0.0);
        assert!(zero.is_err(), "0/0 is as unknown as 1/0: {zero:?}");
    }

    #[test]
    fn impossible_responses_are_refused() {
        let new = |frequencies: &[f64], values: &[f64]| {
            let values = values.iter().map(|&re| Complex64::new(re, 0.0)).collect();
            FrequencyResponse::new(ResponseForm::Mobility, frequencies.to_vec(), values)
        };
        assert_eq!(new(&[1.0], &[]), Err(FrfError::LengthMismatch { frequencies: 1, values: 0 }));
        for frequencies in [[1.0, 1.0], [2.0, 1.0], [0.0, f64::NAN], [1.0, f64::INFINITY]] {
            let frequency = frequencies[1];
            match new(&frequencies, &[1.0, 1.0]) {
                Err(FrfError::FrequenciesNotIncreasing { index: 1, .. }) => (),
                other => panic!("{frequency} Hz: {other:?}"),
            }
        }
        assert!(new(&[-1.0], &[1.0]).is_err());
        assert!(matches!(new(&[1.0], &[f64::NAN]), Err(FrfError::ValueNotFinite { .. })));
        assert!(new(&[0.0, 1.0], &[1.0, 1.0]).unwrap().converted(ResponseForm::Receptance).is_err());
    }

    #[test]
    fn the_peak_is_the_first_of_the_largest() {
        let values = [1.0, -2.0, 2.0].map(|re| Complex64::new(re, 0.0)).to_vec();
        let response = FrequencyResponse::new(ResponseForm::Mobility, vec![1.0, 2.0, 3.0], values).unwrap();
        assert_eq!(response.peak(), Some((2.0, 2.0)));
        let empty = FrequencyResponse::new(ResponseForm::Mobility, Vec::new(), Vec::new()).unwrap();
        assert_eq!(empty.without_zero_frequency().peak(), None);
    }
}
