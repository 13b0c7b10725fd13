//! Lines of several responses that are fitted together.

use std::f64::consts::TAU;

use fmm_record::Complex64;

use super::measured::MeasuredResponse;
use super::options::ModalOptions;
use crate::error::FrfError;
use crate::response::{FrequencyResponse, ResponseForm};

/// Lines behind the uncertainty of one, all averages counted, at least: the number of degrees of freedom that makes a
/// variance known to a quarter. Origin: a variance of ν degrees of freedom has a relative u of √(2/ν).
const VARIANCE_FREEDOM: f64 = 32.0;
/// Share of the median uncertainty that each line has at least, so that a line of coherence 1 does not outweigh all
/// others. Origin: chosen; no sensor is a hundred times better at one line than at its neighbours.
const LEAST_UNCERTAINTY: f64 = 1e-2;

/// The responses at common lines, each in units of its own root mean square.
#[derive(Debug)]
pub(super) struct Band {
    pub(super) form: ResponseForm,
    /// Frequencies (Hz).
    pub(super) frequencies: Vec<f64>,
    /// Rate of an exponential window (1/s).
    pub(super) decay_rate: f64,
    pub(super) channels: Vec<Channel>,
}

/// One response of a [`Band`].
#[derive(Debug)]
pub(super) struct Channel {
    /// Values by `size`.
    pub(super) values: Vec<Complex64>,
    /// Root mean square (unit of the form).
    pub(super) size: f64,
    /// Standard uncertainty of real and imaginary part by `size`, above zero.
    pub(super) uncertainty: Option<Vec<f64>>,
}

impl Band {
    /// The lines of `responses` within the band of the options, without that at zero frequency.
    pub(super) fn of(responses: &[MeasuredResponse], options: &ModalOptions) -> Result<Self, FrfError> {
        let first = responses.first().ok_or_else(|| FrfError::too_few("a modal fit needs at least one response"))?;
        let first = first.values();
        let mut channels = Vec::with_capacity(responses.len());
        let (low, high) = options.band.unwrap_or((0.0, f64::INFINITY));
        for (index, measured) in responses.iter().enumerate() {
            let values = measured.values();
            let differs = if values.form() != first.form() {
                Some("form")
            } else if values.frequencies() != first.frequencies() {
                Some("frequencies")
            } else if values.decay_rate() != first.decay_rate() {
                Some("exponential window")
            } else {
                None
            };
            if let Some(what) = differs {
                let what = format!("response {index} must have the {what} of response 0 to be fitted with it");
                return Err(FrfError::mismatch(what));
            }
            let lines = lines(values, low, high)?;
            let (values, uncertainty) = (&values.values()[lines.clone()], measured.uncertainty());
            let largest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
            // Divided first, so that squares neither underflow nor overflow.
            let mean = values.iter().map(|value| (value / largest).norm_sqr()).sum::<f64>() / values.len() as f64;
            let size = largest * mean.sqrt();
            if !(size > 0.0 && size.is_finite() && size.recip().is_finite()) {
                let what = "is zero at all lines, or so small that it cannot be divided by; leave it out";
                return Err(FrfError::values(format!("response {index} {what}")));
            }
            let values = values.iter().map(|value| value / size).collect();
            let uncertainty = uncertainty.and_then(|u| smooth(&u[lines], size, measured.averages()));
            channels.push(Channel { values, size, uncertainty });
        }
        // With uncertainties of some only, all are weighed by what their fits leave.
        if channels.iter().any(|channel| channel.uncertainty.is_none()) {
            for channel in &mut channels {
                channel.uncertainty = None;
            }
        }
        let frequencies = first.frequencies()[lines(first, low, high)?].to_vec();
        Ok(Self { form: first.form(), frequencies, decay_rate: first.decay_rate(), channels })
    }

    /// Number of lines.
    pub(super) fn len(&self) -> usize {
        self.frequencies.len()
    }

    /// The first and the last frequency (Hz).
    pub(super) fn ends(&self) -> (f64, f64) {
        (self.frequencies[0], self.frequencies[self.len() - 1])
    }

    /// Angular frequency (rad/s) of the last line, in units of which poles are fitted.
    pub(super) fn unit(&self) -> f64 {
        TAU * self.ends().1
    }

    /// s of each line in that unit.
    pub(super) fn arguments(&self) -> impl Iterator<Item = Complex64> + Clone + '_ {
        let unit = self.unit();
        self.frequencies.iter().map(move |frequency| Complex64::new(self.decay_rate, TAU * frequency) / unit)
    }
}

/// Positions of the lines of `response` from `low` to `high` (Hz), above zero.
fn lines(response: &FrequencyResponse, low: f64, high: f64) -> Result<std::ops::Range<usize>, FrfError> {
    let frequencies = response.frequencies();
    let first = frequencies.partition_point(|frequency| *frequency < low || *frequency == 0.0);
    let end = frequencies.partition_point(|frequency| *frequency <= high);
    if first < end && low <= high { Ok(first..end) } else { Err(FrfError::empty_band(low, high)) }
}

/// Uncertainties by `size`, each the mean over so many neighbours that its own error does not matter; none if all are
/// zero.
fn smooth(uncertainty: &[f64], size: f64, averages: f64) -> Option<Vec<f64>> {
    let freedom = 2.0 * (averages - 1.0);
    let reach = (0.5 * (VARIANCE_FREEDOM / freedom - 1.0)).ceil().clamp(0.0, uncertainty.len() as f64) as usize;
    let squares: Vec<f64> = uncertainty.iter().map(|u| (u / size).powi(2)).collect();
    let mean = |line: usize| {
        let near = &squares[line.saturating_sub(reach)..(line + reach + 1).min(squares.len())];
        // The reciprocal of a variance with ν degrees of freedom is too large by ν/(ν − 2) in the mean.
        let bias = (1.0 - 2.0 / (freedom * near.len() as f64)).max(0.5);
        (near.iter().sum::<f64>() / near.len() as f64 / bias).sqrt()
    };
    let smooth: Vec<f64> = (0..squares.len()).map(mean).collect();
    let mut sorted = smooth.clone();
    sorted.sort_by(f64::total_cmp);
    let least = LEAST_UNCERTAINTY * sorted[sorted.len() / 2];
    let all = smooth.into_iter().map(|u| u.max(least)).collect();
    // If more than half of the lines are said to be exact, the statement is none.
    (least > 0.0 && least.is_finite()).then_some(all)
}
