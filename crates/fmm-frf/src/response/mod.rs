//! Response per force as a function of frequency.

mod form;
mod oscillator;
mod resonances;

pub use form::ResponseForm;
pub use oscillator::SingleDegreeOfFreedom;
pub use resonances::Resonance;

use std::f64::consts::TAU;
use std::sync::Arc;

use fmm_model::ModelError;
use fmm_record::Complex64;

use crate::error::FrfError;

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
    frequencies: Arc<[f64]>,
    values: Vec<Complex64>,
    decay_rate: f64,
}

impl FrequencyResponse {
    /// A response of the given `form`, one value (SI unit of the form) for each frequency (Hz).
    ///
    /// # Errors
    /// [`FrfError::Mismatch`] for another number of values than frequencies; [`FrfError::Values`] for frequencies that
    /// are negative, not finite or not increasing, and for values that are not finite.
    pub fn new(form: ResponseForm, frequencies: Vec<f64>, values: Vec<Complex64>) -> Result<Self, FrfError> {
        if frequencies.len() != values.len() {
            let (frequencies, values) = (frequencies.len(), values.len());
            let what = "a response needs one value for each of its frequencies";
            return Err(FrfError::mismatch(format!("{what}, but has {frequencies} and {values}")));
        }
        // Zero itself is a frequency, and the largest number below it is not.
        let mut above = (-0.0f64).next_down();
        for (index, (&frequency, value)) in frequencies.iter().zip(&values).enumerate() {
            if !(frequency > above && frequency.is_finite()) {
                let what = "frequencies must be finite, not negative and increasing";
                return Err(FrfError::values(format!("{what}, but line {index} is at {frequency} Hz")));
            }
            if !value.is_finite() {
                return Err(FrfError::value_not_finite(form, frequency));
            }
            above = frequency;
        }
        Ok(Self { form, frequencies: frequencies.into(), values, decay_rate: 0.0 })
    }

    /// A response at `frequencies` that are known to increase, shared with others.
    pub(crate) fn at_shared(
        form: ResponseForm,
        frequencies: &Arc<[f64]>,
        values: Vec<Complex64>,
        decay_rate: f64,
    ) -> Result<Self, FrfError> {
        if let Some(line) = values.iter().position(|value| !value.is_finite()) {
            return Err(FrfError::value_not_finite(form, frequencies[line]));
        }
        Ok(Self { form, frequencies: Arc::clone(frequencies), values, decay_rate })
    }

    /// A response at `frequencies` that are known to increase, of values that are known to be finite.
    #[cfg(feature = "modes")]
    pub(crate) fn at_lines(form: ResponseForm, frequencies: &[f64], values: Vec<Complex64>, decay_rate: f64) -> Self {
        Self { form, frequencies: frequencies.into(), values, decay_rate }
    }

    /// The same behind an exponential window of this decay rate (1/s).
    #[cfg(feature = "serde")]
    pub(crate) fn behind_window(self, decay_rate: f64) -> Self {
        Self { decay_rate, ..self }
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

    /// σ, decay rate (1/s) of the exponential window behind the values; 0 without one.
    pub fn decay_rate(&self) -> f64 {
        self.decay_rate
    }

    /// The response in another form, line by line as [`ResponseForm::convert`]; after an exponential window, with
    /// σ + iω in place of iω.
    ///
    /// # Errors
    /// [`FrfError::NotDefined`] at a line of zero frequency on the way towards receptance, unless a window has moved
    /// it; see [`FrequencyResponse::without_zero_frequency`].
    pub fn converted(&self, form: ResponseForm) -> Result<Self, FrfError> {
        let lines = self.frequencies.iter().zip(&self.values);
        let values =
            lines.map(|(&frequency, &value)| self.form.convert_damped(form, value, frequency, self.decay_rate));
        let values = values.collect::<Result<_, _>>()?;
        Ok(Self { form, frequencies: Arc::clone(&self.frequencies), values, decay_rate: self.decay_rate })
    }

    /// The response with the delay d of the response channel behind the force channel, `delay` (s), taken out: times
    /// e^{sd}. A negative delay is one of the force channel.
    ///
    /// A delay of 1 ms is 0.8° at 2.2 Hz and 36° at 100 Hz; it looks like damping where there is none.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`](crate::ModelError::NotFinite) for the delay, [`FrfError::Values`] if a window and a
    /// long delay overflow.
    pub fn without_delay(mut self, delay: f64) -> Result<Self, FrfError> {
        ModelError::require_finite("the delay of a channel", delay, "s")?;
        for (value, &frequency) in self.values.iter_mut().zip(&*self.frequencies) {
            *value *= (Complex64::new(self.decay_rate, TAU * frequency) * delay).exp();
            if !value.is_finite() {
                return Err(FrfError::value_not_finite(self.form, frequency));
            }
        }
        Ok(self)
    }

    /// The lines from `low` to `high` (Hz), both ends included.
    ///
    /// # Errors
    /// [`FrfError::Outside`] if there are none.
    pub fn within(&self, low: f64, high: f64) -> Result<Self, FrfError> {
        let first = self.frequencies.partition_point(|&frequency| frequency < low);
        let end = self.frequencies.partition_point(|&frequency| frequency <= high);
        if !(first < end && low <= high) {
            return Err(FrfError::empty_band(low, high));
        }
        let (frequencies, values) = (self.frequencies[first..end].into(), self.values[first..end].to_vec());
        Ok(Self { form: self.form, frequencies, values, decay_rate: self.decay_rate })
    }

    /// The response without its line at zero frequency, if there is one.
    #[must_use]
    pub fn without_zero_frequency(mut self) -> Self {
        if self.frequencies.first() == Some(&0.0) {
            self.frequencies = self.frequencies[1..].into();
            self.values.remove(0);
        }
        self
    }

    /// Frequency (Hz) and magnitude (SI unit of the form) of the line of largest magnitude, the first of equals;
    /// `None` if there are no lines.
    pub fn peak(&self) -> Option<(f64, f64)> {
        let lines = self.frequencies.iter().zip(&self.values).map(|(&frequency, value)| (frequency, value.norm()));
        lines.reduce(|highest, line| if line.1 > highest.1 { line } else { highest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::SingleDegreeOfFreedom;

    #[test]
    fn impossible_responses_are_refused() {
        let new = |frequencies: &[f64], values: &[f64]| {
            let values = values.iter().map(|&re| Complex64::new(re, 0.0)).collect();
            FrequencyResponse::new(ResponseForm::Mobility, frequencies.to_vec(), values)
        };
        assert!(matches!(new(&[1.0], &[]), Err(FrfError::Mismatch { what }) if what.ends_with("has 1 and 0")));
        for frequencies in [[1.0, 1.0], [2.0, 1.0], [0.0, f64::NAN], [1.0, f64::INFINITY]] {
            let frequency = frequencies[1];
            match new(&frequencies, &[1.0, 1.0]) {
                Err(FrfError::Values { what }) if what.contains("line 1 ") => (),
                other => panic!("{frequency} Hz: {other:?}"),
            }
        }
        assert!(new(&[-1.0], &[1.0]).is_err());
        assert!(matches!(new(&[1.0], &[f64::NAN]), Err(FrfError::Values { .. })));
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

    /// A delayed channel is an exact phase, and a band is a slice.
    #[test]
    fn delays_and_bands() {
        let machine = SingleDegreeOfFreedom::new(10.391, 8.0, 1982.0).unwrap();
        let lines: Vec<f64> = (0..40).map(|i| 0.25 * f64::from(i)).collect();
        let truth = machine.frequency_response(ResponseForm::Mobility, &lines).unwrap();
        let delay = 3.7e-3;
        let late = |(value, f): (&Complex64, &f64)| value * Complex64::new(0.0, -TAU * f * delay).exp();
        let late = truth.values().iter().zip(&lines).map(late).collect();
        let late = FrequencyResponse::new(ResponseForm::Mobility, lines.clone(), late).unwrap();
        for (found, expected) in late.without_delay(delay).unwrap().values().iter().zip(truth.values()) {
            // Two exponentials and two products.
            assert!((found - expected).norm() < 1e-15 * expected.norm().max(1.0), "{found}, not {expected}");
        }
        let band = truth.within(1.0, 2.0).unwrap();
        assert_eq!(band.frequencies(), [1.0, 1.25, 1.5, 1.75, 2.0]);
        assert_eq!(band.values(), &truth.values()[4..9]);
        for (low, high) in [(2.0, 1.0), (1.01, 1.2), (50.0, 60.0), (f64::NAN, 2.0), (1.0, f64::NAN)] {
            assert!(truth.within(low, high).is_err(), "{low} Hz to {high} Hz");
        }
        assert!(truth.without_delay(f64::NAN).is_err());
    }

    /// Behind an exponential window the static receptance can be had from a velocity, as s = σ is not zero.
    #[test]
    fn a_window_moves_the_line_of_zero_frequency() {
        let values = vec![Complex64::new(0.5, 0.0), Complex64::new(1.0, 1.0)];
        let mobility = FrequencyResponse::new(ResponseForm::Mobility, vec![0.0, 1.0], values).unwrap();
        let receptance = FrequencyResponse { decay_rate: 2.0, ..mobility }.converted(ResponseForm::Receptance).unwrap();
        assert_eq!(receptance.values()[0], Complex64::new(0.25, 0.0));
        let back = receptance.converted(ResponseForm::Mobility).unwrap();
        assert!((back.values()[1] - Complex64::new(1.0, 1.0)).norm() < 1e-15);
        let (there, back) = (receptance.converted(ResponseForm::Accelerance).unwrap(), receptance);
        let again = there.converted(ResponseForm::Receptance).unwrap();
        assert!((again.values()[1] - back.values()[1]).norm() < 1e-16);
    }
}
