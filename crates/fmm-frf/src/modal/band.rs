//! The lines of a mode, as the fits take them.

use std::f64::consts::TAU;

use fmm_record::Complex64;

use crate::{FrequencyResponse, FrfError, ResponseForm};

/// Lines of a band in one form, without the line at zero frequency.
#[derive(Debug, Clone)]
pub(super) struct Band {
    /// Angular frequencies by that of the highest line (1).
    pub(super) ratios: Vec<f64>,
    pub(super) values: Vec<Complex64>,
    /// Angular frequency (rad/s) of the highest line.
    pub(super) unit: f64,
    /// Index of the line of largest magnitude.
    pub(super) highest: usize,
    pub(super) decay_rate: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Band {
    /// The lines of `response` from `low` to `high` (Hz), at least `needed` of them.
    pub(super) fn of(response: &FrequencyResponse, low: f64, high: f64, needed: usize) -> Result<Self, FrfError> {
        let lines = response.within(low, high)?.without_zero_frequency();
        let found = lines.frequencies().len();
        let magnitudes = lines.values().iter().map(|value| value.norm()).enumerate();
        let highest = magnitudes.reduce(|best, line| if line.1 > best.1 { line } else { best });
        let Some((highest, magnitude)) = highest.filter(|_| found >= needed) else {
            return Err(FrfError::too_few_points(needed, found));
        };
        if magnitude == 0.0 {
            return Err(FrfError::no_mode("fit of a mode", low, high));
        }
        let unit = TAU * lines.frequencies()[highest];
        let ratios = lines.frequencies().iter().map(|frequency| TAU * frequency / unit).collect();
        let values = lines.values().to_vec();
        Ok(Self { ratios, values, unit, highest, decay_rate: lines.decay_rate(), low, high })
    }

    /// The same lines as they would be without a window, of the machine that seems to be there: form `to` of
    /// H(σ + iω), taken for a function of iω.
    ///
    /// A machine (m, c, k) at s = σ + iω is exactly the machine (m, c + 2mσ, k + cσ + mσ²) at iω.
    pub(super) fn apparent(response: &FrequencyResponse, to: ResponseForm) -> Result<FrequencyResponse, FrfError> {
        let response = response.clone().without_zero_frequency();
        if response.decay_rate() == 0.0 {
            return response.converted(to);
        }
        let decay_rate = response.decay_rate();
        let receptance = response.converted(ResponseForm::Receptance)?;
        let (frequencies, values) = (receptance.frequencies().to_vec(), receptance.values().to_vec());
        let apparent = FrequencyResponse::new(ResponseForm::Receptance, frequencies, values)?.converted(to)?;
        apparent.with_decay_rate(decay_rate)
    }
}
