//! The average over trials, from which every estimate follows.

mod estimator;
mod options;
mod sums;
mod transform;
mod window;

pub use estimator::{Coherence, Estimator};
pub use options::AverageOptions;
pub use window::{ExponentialWindow, ForceWindow, Taper};

use std::ops::Range;
use std::sync::Arc;

use fmm_model::ModelError;
use fmm_record::{Quantity, Record};

use crate::average::estimator::{Spectra, Undefined};
use crate::average::sums::{RatioSums, SpectralSums, Trial};
use crate::average::transform::{SLOTS, TrialTransform};
use crate::channel::Channel;
use crate::error::FrfError;
use crate::response::{FrequencyResponse, ResponseForm};

/// Spectra of a test, averaged over its trials.
///
/// ```text
/// S_ff = ⟨F* F⟩,   S_vv = ⟨V* V⟩,   S_fv = ⟨F* V⟩                                                     (1)
/// ```
///
/// F and V are the discrete transforms, with e^{−iωt}, of force and response. A trial can be added at any time, also
/// after estimates have been read; it is either added as a whole or, with an error, not at all. After the construction
/// nothing is allocated by adding; [`TrialAverage::clear`] begins a new test in the same memory, and a clone shares the
/// plan of the transform.
///
/// ```
/// use fmm_frf::{AverageOptions, Estimator, ResponseForm, TrialAverage};
///
/// // An impact on a machine that answers half as much, one sample later.
/// let mut average = TrialAverage::new(ResponseForm::Mobility, 8.0, 8, &AverageOptions::default())?;
/// average.add(&[0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], &[0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
/// average.add(&[0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], &[0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0])?;
/// let mobility = average.estimate(Estimator::H1)?.without_delay(1.0 / 8.0)?;
/// assert_eq!(mobility.frequencies(), [0.0, 1.0, 2.0, 3.0, 4.0]);
/// assert!(mobility.values().iter().all(|value| (value - 0.5).norm() < 1e-15));
/// assert_eq!(average.coherence()?.averages(), 2.0);
/// # Ok::<(), fmm_frf::FrfError>(())
/// ```
///
/// # References
/// J. S. Bendat, A. G. Piersol, *Random Data*, 4th ed., Wiley 2010, chapters 6, 7 and 9.
#[derive(Debug, Clone)]
pub struct TrialAverage {
    form: ResponseForm,
    rate: f64,
    length: usize,
    lines: Range<usize>,
    frequencies: Arc<[f64]>,
    decay_rate: f64,
    transform: TrialTransform,
    spectra: SpectralSums,
    /// Number of the last trials that are not in the sums yet.
    waiting: usize,
    ratios: Option<RatioSums>,
    trials: usize,
}

impl TrialAverage {
    /// An average of no trials yet, for trials of `length` samples at `rate` (Hz), whose response divided by force has
    /// the `form`.
    ///
    /// Any length will do, as the transforms are for all lengths; those with small prime factors are fastest.
    ///
    /// # Errors
    /// [`ModelError::NotPositive`](crate::ModelError::NotPositive) for the rate, [`FrfError::TooFew`] for a length
    /// below 2, [`FrfError::Outside`] if no line lies in the band of the options, and for a force
    /// window that covers no sample.
    pub fn new(form: ResponseForm, rate: f64, length: usize, options: &AverageOptions) -> Result<Self, FrfError> {
        ModelError::require_positive("the sampling rate", rate, "Hz")?;
        let interval = ModelError::require_positive("the sampling interval", rate.recip(), "s")?;
        if length < 2 {
            return Err(FrfError::too_few_samples(length));
        }
        let mut lines = 0..length / 2 + 1;
        if let Some((low, high)) = options.band {
            // Rounding must not drop a line that is asked for by name.
            let position = |frequency: f64| frequency * length as f64 / rate;
            let first = (position(low) - 1e-9 * position(low).abs()).ceil().max(0.0) as usize;
            let last = (position(high) + 1e-9 * position(high)).floor() as usize;
            lines = first..lines.end.min(last.saturating_add(1));
            if lines.is_empty() {
                return Err(FrfError::empty_band(low, high));
            }
        }
        Ok(Self {
            form,
            rate,
            length,
            decay_rate: options.decay_rate(),
            transform: TrialTransform::new(length, interval, options)?,
            frequencies: lines.clone().map(|line| line as f64 * rate / length as f64).collect(),
            spectra: SpectralSums::new(lines.len()),
            waiting: 0,
            ratios: options.keeps_ratios.then(|| RatioSums::new(lines.len())),
            lines,
            trials: 0,
        })
    }

    /// Adds a trial: its `force` (N) and its `response` (SI unit), sample by sample at the same times.
    ///
    /// # Errors
    /// [`FrfError::Mismatch`] for channels of another length, [`FrfError::Values`] for samples that are not finite,
    /// [`FrfError::Values`] for a force that is zero throughout, [`FrfError::Outside`] for a baseline or window
    /// outside the record, and [`FrfError::NotDefined`] if ratios are kept and the force is zero at a line. The average
    /// is then unchanged.
    pub fn add(&mut self, force: &[f64], response: &[f64]) -> Result<(), FrfError> {
        let slot = self.waiting;
        self.transform.run(slot, force, response)?;
        let (force, response) = self.transform.spectra(slot, &self.lines);
        if let (Some(_), Some(line)) = (&self.ratios, force.iter().position(|force| force.norm_sqr() == 0.0)) {
            return Err(FrfError::no_force_at(self.frequencies[line]));
        }
        if let Some(ratios) = &mut self.ratios {
            ratios.add(force, response);
        }
        self.waiting += 1;
        if self.waiting == SLOTS {
            let [first, second] = [0, 1].map(|slot| trial(&self.transform, &self.lines, slot));
            self.spectra.add(first, second);
            self.waiting = 0;
        }
        self.trials += 1;
        Ok(())
    }

    /// Adds a trial of two records, whose quantities, rates and beginnings must fit. Units are not converted: the force
    /// must be in N and the response in its SI unit.
    ///
    /// # Errors
    /// Those of [`TrialAverage::add`]; [`FrfError::Mismatch`] for other quantities, rates that differ by more than 1e-6
    /// of theirs, or records that do not begin within 1e-3 of an interval of each other.
    pub fn add_records(&mut self, force: &Record, response: &Record) -> Result<(), FrfError> {
        Channel::Force.require(force, Quantity::Force, self.rate)?;
        Channel::Response.require(response, self.form.quantity(), self.rate)?;
        Channel::require_together(force, response)?;
        self.add(force.values(), response.values())
    }

    /// Adds a long record in segments that `overlap` by a number of samples, each as one trial (Welch's method), and
    /// gives the number of segments. Samples left over at the end are not used. Trials that overlap are not
    /// independent: uncertainties and the number of averages count them as if they were.
    ///
    /// # Errors
    /// Those of [`TrialAverage::add`] at the first segment that it refuses, with the segments before it added;
    /// [`FrfError::Outside`] for an overlap of a whole segment, and [`FrfError::Mismatch`] for a record shorter than
    /// one, or channels of different length.
    pub fn add_segments(&mut self, force: &[f64], response: &[f64], overlap: usize) -> Result<usize, FrfError> {
        if overlap >= self.length {
            let length = self.length;
            let what = format!("segments of {length} samples must overlap by less than that, but should by {overlap}");
            return Err(FrfError::outside(what));
        }
        if force.len() < self.length {
            return Err(FrfError::sample_count(Channel::Force, self.length, force.len()));
        }
        if response.len() != force.len() {
            return Err(FrfError::sample_count(Channel::Response, force.len(), response.len()));
        }
        let step = self.length - overlap;
        let segments = (force.len() - self.length) / step + 1;
        for segment in 0..segments {
            let samples = segment * step..segment * step + self.length;
            self.add(&force[samples.clone()], &response[samples])?;
        }
        Ok(segments)
    }

    /// Forgets all trials but keeps plan and memory, for the next test of the same kind.
    pub fn clear(&mut self) {
        self.trials = 0;
        self.spectra.clear();
        self.waiting = 0;
        if let Some(ratios) = &mut self.ratios {
            ratios.clear();
        }
    }

    /// Number of trials added so far.
    pub fn trials(&self) -> usize {
        self.trials
    }

    /// Form of the estimates.
    pub fn form(&self) -> ResponseForm {
        self.form
    }

    /// Frequencies (Hz) of the lines: whole multiples of rate/length up to half the rate, as far as they lie in the
    /// band.
    pub fn frequencies(&self) -> &[f64] {
        &self.frequencies
    }

    /// The response by `estimator`.
    ///
    /// # Errors
    /// [`FrfError::TooFew`] without a trial; [`FrfError::NotDefined`] at a line where the estimator would divide by
    /// zero; [`FrfError::Outside`] for the mean of ratios; [`FrfError::Values`] if it overflows.
    pub fn estimate(&self, estimator: Estimator) -> Result<FrequencyResponse, FrfError> {
        if self.trials == 0 {
            return Err(no_trials());
        }
        // The estimator is chosen outside the loop over the lines.
        let values = match estimator {
            Estimator::H1 => self.spectra.map(&self.waiting(), |spectra| Estimator::H1.quotient(&spectra)),
            Estimator::H2 => self.spectra.map(&self.waiting(), |spectra| Estimator::H2.quotient(&spectra)),
            Estimator::Hv => self.spectra.map(&self.waiting(), |spectra| Estimator::Hv.quotient(&spectra)),
            Estimator::MeanOfRatios => self.ratios()?.means(self.trials as f64),
        };
        FrequencyResponse::at_shared(self.form, &self.frequencies, values, self.decay_rate)
            .map_err(|not_finite| self.undefined(|spectra| estimator.of(spectra)).unwrap_or(not_finite))
    }

    /// Standard uncertainty of real and imaginary part of the response by `estimator`, each, at each line, from the
    /// scatter of the trials.
    ///
    /// ```text
    /// H1, H2, Hv:      u² = |H|² (1/γ² − 1)/(2(n − 1))                                                  (2)
    /// mean of ratios:  u² = (⟨|V/F|²⟩ − |⟨V/F⟩|²)/(2(n − 1))                                            (3)
    /// ```
    ///
    /// n is the number of trials. For H1, (2) is the residual scatter of the regression of V on F through the
    /// origin; for H2 that of F on V, which is relatively the same. It contains the differences between trials and
    /// nothing that they share: gains, delays, leakage, or the bias of H1 by noise of the force. With friction, trials
    /// of different impulse differ because the machine does. The phase has u/|H| (rad). With two or three trials, u
    /// itself is hardly known.
    ///
    /// # Errors
    /// Those of [`TrialAverage::estimate`]; [`FrfError::TooFew`] for fewer than two trials.
    pub fn uncertainty(&self, estimator: Estimator) -> Result<Vec<f64>, FrfError> {
        if self.trials == 0 {
            return Err(no_trials());
        }
        if self.trials == 1 {
            return Err(FrfError::too_few("scatter needs more than one trial, but there is 1"));
        }
        let freedom = (self.trials - 1) as f64;
        self.lines(|line| {
            let scatter = match estimator {
                Estimator::MeanOfRatios => self.ratios()?.variance(line, self.trials as f64).sqrt(),
                other => {
                    let at = |undefined: Undefined| undefined.at(self.frequencies[line]);
                    other.scatter(&self.line(line)).map_err(at)?
                }
            };
            Ok(scatter / (2.0 * freedom).sqrt())
        })
    }

    /// γ² = |S_fv|²/(S_ff S_vv), the share of the response that is a multiple of the force.
    ///
    /// # Errors
    /// [`FrfError::TooFew`] without a trial, and [`FrfError::NotDefined`] at a line where one channel is zero in all
    /// trials.
    pub fn coherence(&self) -> Result<Coherence, FrfError> {
        if self.trials == 0 {
            return Err(no_trials());
        }
        let values = self.spectra.map(&self.waiting(), |spectra| spectra.coherence().unwrap_or(f64::NAN));
        // The line to blame is looked for only if there is one.
        if values.iter().any(|value| value.is_nan())
            && let Some(undefined) = self.undefined(Spectra::coherence)
        {
            return Err(undefined);
        }
        Ok(Coherence { frequencies: Arc::clone(&self.frequencies), values, averages: self.trials as f64 })
    }

    /// One-sided power spectral density of the force (N²/Hz) at each line; it integrates to the mean square of the
    /// force.
    ///
    /// # Errors
    /// [`FrfError::TooFew`] without a trial.
    pub fn force_density(&self) -> Result<Vec<f64>, FrfError> {
        let energy = self.transform.weight_energies().0;
        self.lines(|line| Ok(self.line(line).force * self.density_factor(line, energy)))
    }

    /// One-sided power spectral density of the response (its unit squared by Hz) at each line.
    ///
    /// # Errors
    /// [`FrfError::TooFew`] without a trial.
    pub fn response_density(&self) -> Result<Vec<f64>, FrfError> {
        let energy = self.transform.weight_energies().1;
        self.lines(|line| Ok(self.line(line).response * self.density_factor(line, energy)))
    }

    /// The trials that are not in the sums yet.
    fn waiting(&self) -> impl Iterator<Item = Trial<'_>> + Clone {
        (0..self.waiting).map(|slot| trial(&self.transform, &self.lines, slot))
    }

    /// The sums at `line`, with those of the trials that wait.
    fn line(&self, line: usize) -> Spectra {
        self.spectra.line(line, self.waiting())
    }

    /// First line at which `rule` has no value, and the reason, if there is one.
    fn undefined<T>(&self, rule: impl Fn(&Spectra) -> Result<T, Undefined>) -> Option<FrfError> {
        let mut lines = self.frequencies.iter().enumerate();
        lines.find_map(|(line, frequency)| Some(rule(&self.line(line)).err()?.at(*frequency)))
    }

    /// From a sum of squared transforms to a density: 1/(f_s Σw²) per trial, twice that where a line stands for two.
    fn density_factor(&self, line: usize, weight_energy: f64) -> f64 {
        let line = self.lines.start + line;
        let sides = if line == 0 || 2 * line == self.length { 1.0 } else { 2.0 };
        sides / (self.rate * weight_energy * self.trials as f64)
    }

    fn ratios(&self) -> Result<&RatioSums, FrfError> {
        let what = "the ratios of the single trials were not kept; ask for them with AverageOptions::keeping_ratios";
        self.ratios.as_ref().ok_or_else(|| FrfError::outside(what))
    }

    /// Values of `rule` at each line.
    fn lines<T>(&self, rule: impl Fn(usize) -> Result<T, FrfError>) -> Result<Vec<T>, FrfError> {
        if self.trials == 0 {
            return Err(no_trials());
        }
        // Collecting results would not know how many there are.
        let mut values = Vec::with_capacity(self.lines.len());
        for line in 0..self.lines.len() {
            values.push(rule(line)?);
        }
        Ok(values)
    }
}

/// The spectra of a slot.
fn trial<'a>(transform: &'a TrialTransform, lines: &Range<usize>, slot: usize) -> Trial<'a> {
    let (force, response) = transform.spectra(slot, lines);
    Trial { force, response }
}

/// Error of an estimate without a trial.
fn no_trials() -> FrfError {
    FrfError::too_few("there is no trial to average over yet")
}
