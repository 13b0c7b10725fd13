//! Measured response with its places and what is known of its noise.

use fmm_record::uff::Freedom;

use crate::average::Coherence;
use crate::error::FrfError;
use crate::response::FrequencyResponse;

/// A response measured between two places of a structure, with the uncertainty of its lines if it is known.
///
/// ```
/// use fmm_frf::{MeasuredResponse, ResponseForm, SingleDegreeOfFreedom};
///
/// let lines: Vec<f64> = (1..100).map(|i| f64::from(i) / 16.0).collect();
/// let response = SingleDegreeOfFreedom::new(10.391, 8.0, 1982.0)?.frequency_response(ResponseForm::Mobility, &lines)?;
/// let measured = MeasuredResponse::new(response).with_coherence_values(&[0.98; 99], 5.0)?;
/// // |H| √((1 − γ²)/(2 n γ²)), for real and imaginary part each.
/// let (u, size) = (measured.uncertainty().unwrap()[0], measured.values().values()[0].norm());
/// assert!((u / size - (0.02f64 / (10.0 * 0.98)).sqrt()).abs() < 1e-12);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredResponse {
    values: FrequencyResponse,
    response: Freedom,
    reference: Freedom,
    uncertainty: Option<Vec<f64>>,
    averages: f64,
}

impl MeasuredResponse {
    /// A response of which nothing is known but its values.
    pub fn new(values: FrequencyResponse) -> Self {
        let (response, reference) = (Freedom::default(), Freedom::default());
        Self { values, response, reference, uncertainty: None, averages: f64::INFINITY }
    }

    /// The same, measured at the place `response` with the force at `reference`.
    #[must_use]
    pub fn between(mut self, response: Freedom, reference: Freedom) -> Self {
        (self.response, self.reference) = (response, reference);
        self
    }

    /// The same with the standard uncertainty (unit of the response) of real and imaginary part, each, at each line,
    /// taken from the scatter of a number of `averages`, or known from elsewhere if that is infinite.
    ///
    /// # Errors
    /// [`FrfError::Mismatch`] for another number of uncertainties than lines, and [`FrfError::Values`] if one is
    /// negative or not finite, or for fewer than two averages.
    pub fn with_uncertainty(mut self, uncertainty: Vec<f64>, averages: f64) -> Result<Self, FrfError> {
        let (lines, found) = (self.values.values().len(), uncertainty.len());
        if found != lines {
            return Err(FrfError::mismatch(format!(
                "{lines} lines need as many uncertainties, but {found} were given"
            )));
        }
        if let Some(line) = uncertainty.iter().position(|u| !(*u >= 0.0 && u.is_finite())) {
            let (value, frequency) = (uncertainty[line], self.values.frequencies()[line]);
            let what = "an uncertainty must be finite and not negative";
            return Err(FrfError::values(format!("{what}, but that at {frequency} Hz is {value}")));
        }
        if !(averages >= 2.0) {
            return Err(FrfError::values(format!(
                "scatter is that of two averages at least, but there were {averages}"
            )));
        }
        (self.uncertainty, self.averages) = (Some(uncertainty), averages);
        Ok(self)
    }

    /// The same with the uncertainty that follows from γ² at each line and the number n of independent `averages`.
    ///
    /// ```text
    /// u² = |H|² (1 − γ²)/(2 n γ²)                                                                       (1)
    /// ```
    ///
    /// # Errors
    /// Those of [`MeasuredResponse::with_uncertainty`], and [`FrfError::Values`] for a coherence that is not above 0
    /// and at most 1.
    ///
    /// # References
    /// J. S. Bendat, A. G. Piersol, *Random Data*, 4th ed., Wiley 2010, equation 9.90.
    pub fn with_coherence_values(self, coherence: &[f64], averages: f64) -> Result<Self, FrfError> {
        if let Some(line) = coherence.iter().position(|value| !(*value > 0.0 && *value <= 1.0)) {
            let what = format!("a coherence must be above 0 and at most 1, but line {line} has {}", coherence[line]);
            return Err(FrfError::values(what));
        }
        let lines = self.values.values().iter().zip(coherence);
        let mut u: Vec<f64> =
            lines.map(|(value, square)| value.norm() * ((1.0 - square) / (2.0 * averages * square)).sqrt()).collect();
        // The count is checked where the uncertainties are.
        u.resize(coherence.len(), 0.0);
        self.with_uncertainty(u, averages)
    }

    /// The same with a [`Coherence`] at the same lines.
    ///
    /// # Errors
    /// Those of [`MeasuredResponse::with_coherence_values`].
    pub fn with_coherence(self, coherence: &Coherence) -> Result<Self, FrfError> {
        self.with_coherence_values(coherence.values(), coherence.averages())
    }

    /// The values.
    pub fn values(&self) -> &FrequencyResponse {
        &self.values
    }

    /// Place and direction of the response.
    pub fn response(&self) -> &Freedom {
        &self.response
    }

    /// Place and direction of the force.
    pub fn reference(&self) -> &Freedom {
        &self.reference
    }

    /// Standard uncertainty (unit of the response) of real and imaginary part, each, at each line.
    pub fn uncertainty(&self) -> Option<&[f64]> {
        self.uncertainty.as_deref()
    }

    /// Number of averages behind the uncertainty; infinite without one, or if it is known from elsewhere.
    pub(crate) fn averages(&self) -> f64 {
        self.averages
    }
}
