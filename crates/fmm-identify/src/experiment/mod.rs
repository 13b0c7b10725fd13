//! Experiments on a machine: what was done to it and the record of its response, made ready for identification.

mod acceleration;
pub(crate) mod clock;
pub(crate) mod deflections;
mod drive;
mod driven;
mod experiments;
pub(crate) mod first_guess;
pub(crate) mod force;
mod impact;
pub(crate) mod impact_motion;
mod impact_trial;
mod limits;
mod lines;
pub(crate) mod nuisance;
pub(crate) mod parts;
mod planned;
mod preparation;
mod ring_down;
pub(crate) mod run_down;
mod sampled_pulse;
mod sensor;
pub(crate) mod sight;

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use fmm_model::{Bounds, ModelError, Restoring};
use fmm_record::{Quantity, Record};
use fmm_sim::{Sampling, SimulationError};

pub use drive::Drive;
pub(crate) use driven::DrivenGuess;
pub use experiments::Experiments;
pub use impact_trial::{ImpactSummary, ImpactTrial};
pub use preparation::{Offset, Preparation, RecordSummary};
pub(crate) use sensor::Filter;
pub use sensor::Sensor;

use crate::error::IdentifyError;
use crate::experiment::deflections::Deflections;
use crate::experiment::first_guess::{Dissipation, FirstGuess};
use crate::experiment::lines::Lines;
use crate::experiment::nuisance::Nuisance;
use crate::experiment::run_down::RunDownGuess;
use crate::machine::Machine;
use crate::warning::Warning;

/// Steps of an engine in a period of the machine at most (1). Origin: 66 are the rule at full accuracy; with 1000 the
/// search of a record of a contact that creeps took 2.4 times as long, to the same law.
const STEPS_OF_PERIOD: f64 = 300.0;

/// Periods of which the steps are allowed beside those of the record (1). Origin: chosen, for short records.
const FURTHER_PERIODS: f64 = 20.0;

/// Steps in the interval of two samples of a drive at most (1). Origin: one is the rule.
const STEPS_OF_PIECE: f64 = 8.0;

/// An experiment on a machine: a ring-down ([`ring_down`](Self::ring_down)), a hammer blow ([`impact`](Self::impact)),
/// a motion that is driven by a measured force or by a measured motion of the base ([`driven`](Self::driven)), or a
/// run-down of a machine without a spring ([`run_down`](Self::run_down)).
///
/// Experiments of all kinds are fitted together: they share the machine and the law, and each has its own initial state
/// and offset, its own normal load ([`with_load_factor`](Self::with_load_factor)) and its own sensor
/// ([`seen_by`](Self::seen_by)).
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    record: Record,
    kept: Vec<Range<usize>>,
    pub(crate) guess: FirstGuess,
    peaks: Vec<(f64, f64)>,
    /// The disturbances that are fitted beside the motion.
    pub(crate) nuisances: Vec<Nuisance>,
    /// The shape (1) of each of them at every sample.
    pub(crate) shapes: Vec<Vec<f64>>,
    summary: RecordSummary,
    sensor: Sensor,
    /// Normal load over that of the machine.
    load_factor: f64,
    driven: Option<Driven>,
    /// Start values of a run-down; `None` for a machine with a spring.
    run_down: Option<RunDownGuess>,
    /// The impact that it begins with.
    pub(crate) impact: Option<ImpactSummary>,
    /// The lines of its spectrum that are compared in place of its samples.
    lines: Option<Arc<Lines>>,
}

/// Drive of an experiment, and start values of a fit.
#[derive(Debug, Clone, PartialEq)]
struct Driven {
    drive: Drive,
    guess: DrivenGuess,
    /// True if the machine is at rest where its spring is free of force until the drive begins.
    is_at_rest: bool,
}

/// Fewest samples that can show two half cycles.
const FEWEST_SAMPLES: usize = 16;

impl Experiment {
    /// A free vibration by a `record` of which these ranges are used, without disturbances and by an ideal sensor.
    fn bare(record: Record, kept: Vec<Range<usize>>, guess: FirstGuess, summary: RecordSummary) -> Self {
        Self {
            record,
            kept,
            guess,
            peaks: Vec::new(),
            nuisances: Vec::new(),
            shapes: Vec::new(),
            summary,
            sensor: Sensor::default(),
            load_factor: 1.0,
            driven: None,
            run_down: None,
            impact: None,
            lines: None,
        }
    }

    /// The same under `factor` times the normal load of the machine.
    ///
    /// # Errors
    /// [`IdentifyError::OutOfRange`] for a factor that is negative or not finite.
    pub fn with_load_factor(mut self, factor: f64) -> Result<Self, IdentifyError> {
        if !(factor >= 0.0 && factor.is_finite()) {
            let subject = "the normal load of an experiment";
            return Err(IdentifyError::not_allowed(subject, factor, "a multiple from 0 on"));
        }
        self.load_factor = factor;
        Ok(self)
    }

    /// The same with the contact lifted: the law is not part of it, the damping of the machine is.
    #[must_use]
    pub fn without_contact(self) -> Self {
        Self { load_factor: 0.0, ..self }
    }

    /// The same seen by `sensor`. What its filter remembers of the time before the record is left out of the fit.
    ///
    /// # Errors
    /// [`IdentifyError::OutOfRange`] for a corner above half the sampling rate or, behind a drive, a delay longer than
    /// that, [`IdentifyError::TooFew`] if the filter leaves nothing, [`IdentifyError::Contradiction`] for a filter
    /// over samples that are unequally spaced.
    pub fn seen_by(mut self, sensor: Sensor) -> Result<Self, IdentifyError> {
        let frequency = self.guess.frequency();
        let limit = 0.5 * self.record.rate();
        if let Some(value) = sensor.low_pass().and_then(|(_, corner)| corner).filter(|corner| *corner > limit) {
            let subject = "the corner frequency of a sensor (Hz)";
            let allowed = format!("below half the sampling rate, {limit} Hz");
            return Err(IdentifyError::not_allowed(subject, value, &allowed));
        }
        if let Some(drive) = self.drive() {
            drive.require_delay(sensor.delay())?;
        }
        if sensor.low_pass().is_some() && !self.record.is_equally_spaced() {
            return Err(IdentifyError::contradiction(
                "a low-pass filter in the sensor needs samples at equal intervals, and those of the record are not: \
                 resample them, state the rate if only their times are wrong, or leave out the filter",
            ));
        }
        let settled = (sensor.settling(frequency) * self.record.rate()).ceil() as usize;
        for range in &mut self.kept {
            range.start = range.start.max(settled).min(range.end);
        }
        self.kept.retain(|range| !range.is_empty());
        self.summary.samples = self.kept.iter().map(Range::len).sum();
        if self.summary.samples < FEWEST_SAMPLES {
            return Err(match sensor.settling(frequency) {
                time if time > 0.0 => IdentifyError::settling(self.summary.samples, FEWEST_SAMPLES, time),
                _ => IdentifyError::too_short(self.summary.samples, FEWEST_SAMPLES),
            });
        }
        self.sensor = sensor;
        Ok(self)
    }

    /// Its sensor.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// Its normal load over that of the machine.
    pub fn load_factor(&self) -> f64 {
        self.load_factor
    }

    /// Its drive; `None` if it vibrates freely.
    pub fn drive(&self) -> Option<&Drive> {
        self.driven.as_ref().map(|driven| &driven.drive)
    }

    /// True if a measured force drives it.
    pub(crate) fn is_forced(&self) -> bool {
        self.drive().is_some_and(Drive::is_force)
    }

    /// The lines of its spectrum that are compared; `None` if its samples are compared instead.
    pub(crate) fn lines(&self) -> Option<&Lines> {
        self.lines.as_deref()
    }

    /// Residuals that it makes: one for each sample that is used, or two for each line.
    pub(crate) fn rows(&self) -> usize {
        self.lines.as_ref().map_or(self.summary.samples, |lines| lines.rows())
    }

    /// Standard deviation of what cannot be fitted: white noise and the rounding of the converter, at least that of
    /// doubles, in the unit of the record.
    pub(crate) fn least_noise(&self) -> f64 {
        self.white_noise().max(1e-9 * self.summary.amplitudes.0)
    }

    /// True if it begins at rest where the spring is free of force.
    pub(crate) fn begins_at_rest(&self) -> bool {
        self.driven.as_ref().is_some_and(|driven| driven.is_at_rest)
    }

    /// The same, begun at rest where the spring is free of force if it is driven.
    pub(crate) fn begun_neutral(mut self) -> Self {
        if let Some(driven) = &mut self.driven {
            driven.guess = driven.guess.neutral();
        }
        self
    }

    /// Start values of a driven motion.
    pub(crate) fn driven_guess(&self) -> Option<&DrivenGuess> {
        self.driven.as_ref().map(|driven| &driven.guess)
    }

    /// Losses to begin a fit with.
    pub(crate) fn hypotheses(&self) -> Vec<Dissipation> {
        match (&self.driven, &self.run_down) {
            (Some(driven), _) => driven.guess.hypotheses(),
            (None, Some(run_down)) => run_down.hypotheses.clone(),
            (None, None) => self.guess.hypotheses(),
        }
    }

    /// Offset to begin a fit with, given what the contact loses.
    pub(crate) fn first_offset(&self, dissipation: Dissipation) -> f64 {
        match (&self.driven, self.record.quantity()) {
            (Some(driven), _) => driven.guess.offset,
            _ if self.is_run_down() => 0.0,
            (None, Quantity::Acceleration) => self.record.mean(),
            (None, _) => self.guess.offset(dissipation),
        }
    }

    /// Initial position and velocity to begin a fit with, given what the contact loses.
    pub(crate) fn first_state(&self, dissipation: Dissipation) -> (f64, f64) {
        if self.begins_at_rest() {
            return (0.0, 0.0);
        }
        match (&self.driven, &self.run_down) {
            (Some(driven), _) => driven.guess.initial,
            (None, Some(run_down)) => run_down.initial,
            (None, None) => self.guess.initial_state(dissipation),
        }
    }

    /// Corner frequency of the sensor (Hz), or where a fit of it begins; `None` without a filter.
    pub(crate) fn first_corner(&self) -> Option<f64> {
        let corner = self.sensor.first_corner(self.guess.frequency())?;
        Some(if self.sensor.has_free_corner() { self.corner_bounds().clamp(corner) } else { corner })
    }

    /// Bounds of the corner frequency of the sensor (Hz).
    pub(crate) fn corner_bounds(&self) -> Bounds {
        Bounds::new(2.0 * self.guess.frequency(), 0.5 * self.record.rate()).unwrap_or(Bounds::POSITIVE)
    }

    /// The same with further disturbances to be fitted beside the motion.
    pub(crate) fn beside(mut self, nuisances: Vec<Nuisance>) -> Self {
        let (start, end) = (self.record.start(), self.record.end());
        for nuisance in nuisances {
            self.shapes.push(self.record.times().map(|time| nuisance.at(time, start, end)).collect());
            self.nuisances.push(nuisance);
        }
        self
    }

    /// True if a slow drift is among them.
    pub(crate) fn drifts(&self) -> bool {
        self.nuisances.iter().any(|part| matches!(part, Nuisance::Drift(_)))
    }

    /// The part of the record that is used, as it was measured.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// The times of the record after its beginning, for motions that are followed in as many steps as a record can need.
    pub(crate) fn sampling(&self) -> Result<Sampling, SimulationError> {
        let sampling = match self.record.elapsed() {
            Some(times) => Sampling::at(times.clone()),
            None => Sampling::uniform(self.record.interval(), self.record.len()),
        }?;
        // Each sample of a drive begins a piece of it, and without a spring samples alone give a scale.
        let frequency = self.guess.frequency();
        let is_free = self.drive().is_none() && frequency > 0.0;
        let pieces = if is_free { 0.0 } else { STEPS_OF_PIECE * self.record.len() as f64 };
        let periods = FURTHER_PERIODS + frequency * self.record.duration();
        Ok(sampling.in_steps((STEPS_OF_PERIOD * periods + pieces) as usize))
    }

    /// Description of the record and of everything seen in it.
    pub fn summary(&self) -> &RecordSummary {
        &self.summary
    }

    /// Limits of its record, whatever is fitted to it: findings at its beginning, on its way and at
    /// its end.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        Warning::of_record(self.summary(), false, &mut warnings);
        warnings
    }

    /// Time (s) and value of the turning points, maxima and minima by turns.
    pub fn peaks(&self) -> &[(f64, f64)] {
        &self.peaks
    }

    /// Times after the beginning of the record (s) and shares of the path slid (1) of its half cycles: that of a half
    /// cycle is in proportion to its peak above the zero of the sensor. Of a record with fewer than three peaks, the
    /// beginning and the end.
    pub(crate) fn path_shares(&self) -> Vec<(f64, f64)> {
        // Where peaks fall on a line to both sides of the zero, each triple has it.
        let zeros = self.peaks.windows(3).map(|peaks| 0.25 * (peaks[0].1 + 2.0 * peaks[1].1 + peaks[2].1));
        let zero = zeros.sum::<f64>() / self.peaks.len().saturating_sub(2) as f64;
        let path: f64 = self.peaks.iter().map(|(_, value)| (value - zero).abs()).sum();
        // A zero of fewer peaks is no number.
        if !(path > 0.0) {
            return vec![(0.0, 0.5), (self.record.duration(), 0.5)];
        }
        self.peaks.iter().map(|(time, value)| (time - self.record.start(), (value - zero).abs() / path)).collect()
    }

    /// Deflections along the path slid.
    pub(crate) fn deflections(&self) -> Deflections {
        Deflections::of(&self.path_shares(), self.scales().0)
    }

    /// Ranges of samples that are fitted; what lies between them is left out.
    pub fn kept(&self) -> &[Range<usize>] {
        &self.kept
    }

    /// Samples in a row among those that are kept over which the values stay within one step of the converter; empty if
    /// the steps do not exceed the noise.
    pub(crate) fn stays(&self) -> Vec<Range<usize>> {
        let Some(step) = self.summary.resolution.filter(|_| self.summary.is_rounded()) else { return Vec::new() };
        let mut stays: Vec<Range<usize>> = Vec::new();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let values = self.kept.iter().flat_map(|range| &self.record.values()[range.clone()]);
        for (row, value) in values.enumerate() {
            (low, high) = (low.min(*value), high.max(*value));
            match stays.last_mut() {
                Some(stay) if high - low < 1.5 * step => stay.end = row + 1,
                _ => {
                    stays.push(row..row + 1);
                    (low, high) = (*value, *value);
                }
            }
        }
        stays
    }

    /// Largest displacement and velocity of the motion, in the units of the record and its integral or derivative.
    pub(crate) fn scales(&self) -> (f64, f64) {
        if let Some(run_down) = &self.run_down {
            return (run_down.path, run_down.speed);
        }
        let (largest, angular) = (self.summary.amplitudes.0, 2.0 * PI * self.guess.frequency());
        match self.record.quantity() {
            Quantity::Displacement => (largest, angular * largest),
            Quantity::Acceleration => (largest / (angular * angular), largest / angular),
            _ => (largest / angular, largest),
        }
    }

    /// f₀ (Hz) of small vibrations of an undamped `machine`, given what its contact loses: a pendulum swings more
    /// slowly the farther it swings, by φ²/16.
    pub(crate) fn natural_frequency(&self, dissipation: Dissipation, machine: &Machine) -> f64 {
        let frequency = self.guess.natural_frequency(dissipation);
        let Restoring::Sine { length } = machine.restoring() else { return frequency };
        let amplitudes = &self.guess.amplitudes;
        let square = amplitudes.iter().map(|a| a * a).sum::<f64>() / amplitudes.len().max(1) as f64;
        let unit = self.scales().0 / amplitudes[0] / length;
        frequency * (1.0 + square * unit * unit / 16.0)
    }

    /// Standard deviation of the part of the record that no model fits: white noise and the rounding of the converter,
    /// in the unit of the record.
    pub(crate) fn white_noise(&self) -> f64 {
        self.summary.noise.hypot(self.summary.resolution.unwrap_or(0.0) / 12f64.sqrt())
    }

    /// Two octaves either way of what the crossings of a ring-down show: wide enough for any law, and no fit that
    /// leaves it describes this record. What drives a machine shows less of it.
    pub(crate) fn frequency_bounds(&self) -> Bounds {
        if self.driven.is_some() {
            return Bounds::POSITIVE;
        }
        let frequency = self.guess.frequency();
        Bounds::new(0.25 * frequency, 4.0 * frequency).unwrap_or(Bounds::POSITIVE)
    }
}

/// The experiment that shows the machine best, by which a fit begins: the first ring-down with the contact closed, or
/// else the first ring-down, or the first of all.
///
/// # Panics
/// Without an experiment, which is refused before.
pub(crate) fn reference(experiments: &[Experiment]) -> &Experiment {
    let is_free = |experiment: &&Experiment| experiment.driven.is_none();
    let is_loaded = |experiment: &&Experiment| is_free(experiment) && experiment.load_factor > 0.0;
    let all = || experiments.iter();
    all().find(is_loaded).or_else(|| all().find(is_free)).unwrap_or(&experiments[0])
}

/// Each experiment with the factor by which its residuals are multiplied (1): the noise of the first over its own, if
/// they are not all of one quantity and kind, else 1.
pub(crate) fn scaled(experiments: &[Experiment]) -> impl Iterator<Item = (&Experiment, f64)> {
    let kind = |one: &Experiment| (one.record.quantity(), one.driven.is_some(), one.lines.is_some());
    let first = experiments.first();
    let is_one_kind = experiments.iter().all(|experiment| first.is_some_and(|first| kind(first) == kind(experiment)));
    let weight = move |experiment: &Experiment| match first {
        Some(first) if !is_one_kind => first.least_noise() / experiment.least_noise(),
        _ => 1.0,
    };
    experiments.iter().map(move |experiment| (experiment, weight(experiment)))
}

/// The part of a `record` that its `preparation` keeps, and the relative standard uncertainties of its gain and of its
/// clock (1).
fn usable(record: &Record, preparation: &Preparation) -> Result<(Record, f64, f64), IdentifyError> {
    let gain_uncertainty = ModelError::require_not_negative("gain uncertainty", preparation.gain_uncertainty, "")?;
    let clock_uncertainty = ModelError::require_not_negative("clock uncertainty", preparation.clock_uncertainty, "")?;
    let (from, to) = (preparation.from.unwrap_or(record.start()), preparation.to.unwrap_or(record.end()));
    let record = record.crop(from, to)?;
    if record.len() < FEWEST_SAMPLES {
        return Err(IdentifyError::too_short(record.len(), FEWEST_SAMPLES));
    }
    let first = record.values()[0];
    if record.values().iter().all(|value| *value == first) {
        return Err(IdentifyError::no_motion(first, record.unit()));
    }
    Ok((record, gain_uncertainty, clock_uncertainty))
}
