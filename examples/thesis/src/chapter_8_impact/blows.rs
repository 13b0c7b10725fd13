//! Simulated blows, and what two noisy channels make of them.

use std::f64::consts::{FRAC_PI_2, PI};

use fmm_frf::{
    AverageOptions, Baseline, Estimator, ForceWindow, FrequencyResponse, ResponseForm, TrialAverage, impulse,
};
use fmm_friction::Coulomb;
use fmm_identify::ImpactTrial;
use fmm_record::{Quantity, Record};
use fmm_sim::{Channels, Excitation, Sampling, Trajectory};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::{COEFFICIENT, LOAD};
use crate::Found;
use crate::ring_down::{Viscous, machine, motion, scenario, with_noise};

/// Sampling rate (Hz) and duration of a record (s).
pub(super) const RATE: f64 = 1e4;
pub(super) const DURATION: f64 = 33.0;
/// Time between samples (s).
pub(super) const INTERVAL: f64 = 1.0 / RATE;
/// Samples of a record.
pub(super) const SAMPLES: usize = (DURATION * RATE) as usize;
/// Samples before the blow, 10 ms.
const BEFORE: usize = 100;
/// Standard deviations of the noise of force (N) and velocity (m/s).
pub(super) const FORCE_NOISE: f64 = 0.5;
pub(super) const NOISE: f64 = 5e-4;
/// How far the peak of a blow may be from its level (N).
pub(super) const SPREAD: f64 = 50.0;
/// Band of the spectra that is kept (Hz).
const BAND: (f64, f64) = (0.5, 20.5);

/// A level of the hammer: its nominal peak (N) and the mean impulse of its trials (N s), as printed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Level {
    pub(super) name: &'static str,
    pub(super) peak: f64,
    pub(super) impulse: f64,
}

/// Low, medium and high.
pub(super) const LEVELS: [Level; 3] = [
    Level { name: "low", peak: 450.0, impulse: 0.98 },
    Level { name: "medium", peak: 1000.0, impulse: 1.42 },
    Level { name: "high", peak: 1450.0, impulse: 1.64 },
];

impl Level {
    /// How long a half sine of this peak and impulse lasts (s).
    pub(super) fn duration(self) -> f64 {
        FRAC_PI_2 * self.impulse / self.peak
    }

    /// A blow of another peak (N), whose impulse follows it as from the lowest to the highest level.
    fn at_peak(self, peak: f64) -> Self {
        let [low, _, high] = LEVELS;
        let exponent = (high.impulse / low.impulse).ln() / (high.peak / low.peak).ln();
        Self { peak, impulse: self.impulse * (peak / self.peak).powf(exponent), ..self }
    }

    /// A half sine at 10 kHz, up to its end, whose samples joined by straight lines have the impulse.
    fn force(self) -> Found<Vec<f64>> {
        let intervals = (self.duration() / INTERVAL).ceil() as usize;
        let sine = |i: usize| (PI * i as f64 * INTERVAL / self.duration()).sin();
        let mut force = vec![0.0; BEFORE + intervals + 1];
        for i in 1..intervals {
            force[BEFORE + i] = self.peak * sine(i);
        }
        let scale = self.impulse / impulse(&force, INTERVAL, Baseline::Keep)?;
        Ok(force.into_iter().map(|sample| scale * sample).collect())
    }
}

/// A blow and the motion after it, without noise.
#[derive(Debug)]
pub(super) struct Blow {
    pub(super) level: Level,
    /// Force (N) of every sample.
    pub(super) force: Vec<f64>,
    pub(super) motion: Trajectory,
}

impl Blow {
    /// A blow on the machine with this coefficient of friction.
    pub(super) fn of(level: Level, coefficient: f64) -> Found<Self> {
        let mut force = level.force()?;
        let scenario = scenario::<Coulomb>(machine(Viscous::Mean)?, &[coefficient], LOAD, (0.0, 0.0))?
            .driven_by(Excitation::sampled_force(INTERVAL, force.clone())?);
        let sampling = Sampling::uniform(INTERVAL, SAMPLES)?.keeping(Channels::Velocity);
        let motion = motion::<Coulomb>(&scenario, &sampling)?;
        force.resize(SAMPLES, 0.0);
        Ok(Self { level, force, motion })
    }

    /// When the blow begins (s).
    pub(super) fn begin() -> f64 {
        BEFORE as f64 * INTERVAL
    }

    /// Velocity (m/s) of every sample.
    pub(super) fn velocity(&self) -> &[f64] {
        self.motion.velocity().values()
    }

    /// Force and velocity as two channels record them: with white noise, and offsets of up to 0.5 N and 2 mm/s.
    fn records(&self, seed: u64) -> Found<(Record, Record)> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut channel = |values: &[f64], offset: f64, noise: f64| -> Found<Vec<f64>> {
            let offset = random.random_range(-offset..offset);
            let noisy = with_noise(values, noise, random.random())?;
            Ok(noisy.into_iter().map(|value| value + offset).collect())
        };
        let force = channel(&self.force, 0.5, FORCE_NOISE)?;
        let velocity = channel(self.velocity(), 2e-3, NOISE)?;
        Ok((
            Record::new(0.0, INTERVAL, force, Quantity::Force, "N")?,
            Record::new(0.0, INTERVAL, velocity, Quantity::Velocity, "m/s")?,
        ))
    }
}

/// Mobilities from discrete transforms of whole records, with the force windowed about its pulse.
#[derive(Debug)]
pub(super) struct Spectra(TrialAverage);

impl Spectra {
    pub(super) fn new() -> Found<Self> {
        Ok(Self(Self::average(AverageOptions::default())?))
    }

    /// The average of one level, of the ratios of single trials as in the thesis.
    fn of_ratios() -> Found<TrialAverage> {
        Self::average(AverageOptions::default().keeping_ratios())
    }

    fn average(options: AverageOptions) -> Found<TrialAverage> {
        let quiet = || Baseline::MeanOf(0..BEFORE - 10);
        let options = options
            .force_window(ForceWindow::new(Blow::begin() - 1e-3, Blow::begin() + 5e-3)?)
            .force_baseline(quiet())
            .response_baseline(quiet())
            .within(BAND.0, BAND.1)?;
        Ok(TrialAverage::new(ResponseForm::Mobility, RATE, SAMPLES, &options)?)
    }

    /// Frequencies (Hz) of the lines that are kept.
    pub(super) fn frequencies(&self) -> &[f64] {
        self.0.frequencies()
    }

    /// Velocity by force of one trial, given as samples of both channels.
    pub(super) fn mobility(&mut self, force: &[f64], velocity: &[f64]) -> Found<FrequencyResponse> {
        self.0.clear();
        self.0.add(force, velocity)?;
        Ok(self.0.estimate(Estimator::H1)?)
    }

    /// The same of the pulse of a trial with another velocity, such as that of a fit.
    pub(super) fn mobility_of_pulse(&mut self, trial: &ImpactTrial, velocity: &[f64]) -> Found<FrequencyResponse> {
        let mut force = vec![0.0; SAMPLES];
        force[trial.begin()..trial.begin() + trial.force().len()].copy_from_slice(trial.force());
        self.mobility(&force, velocity)
    }
}

/// The trials of one level.
#[derive(Debug)]
pub(super) struct Test {
    pub(super) level: Level,
    pub(super) trials: Vec<ImpactTrial>,
    /// Mobility of each trial.
    pub(super) mobilities: Vec<FrequencyResponse>,
    /// Their mean.
    pub(super) mean: FrequencyResponse,
}

impl Test {
    /// `count` trials whose peaks are anywhere within 50 N of the level.
    pub(super) fn of(level: Level, count: usize, seed: u64, spectra: &mut Spectra) -> Found<Self> {
        let mut average = Spectra::of_ratios()?;
        let (mut trials, mut mobilities) = (Vec::new(), Vec::new());
        for trial in 0..count as u64 {
            let mut random = ChaCha8Rng::seed_from_u64(seed.wrapping_add(trial));
            let peak = level.peak + random.random_range(-SPREAD..SPREAD);
            let (force, velocity) = Blow::of(level.at_peak(peak), COEFFICIENT)?.records(random.random())?;
            average.add_records(&force, &velocity)?;
            mobilities.push(spectra.mobility(force.values(), velocity.values())?);
            trials.push(ImpactTrial::prepare(&force, &velocity)?);
        }
        Ok(Self { level, trials, mobilities, mean: average.estimate(Estimator::MeanOfRatios)? })
    }

    /// Impulse (N s) of each trial, by the trapezoid rule.
    pub(super) fn impulses(&self) -> Vec<f64> {
        self.trials.iter().map(|trial| trial.summary().impulse.value).collect()
    }

    /// Largest receptance (m/N) of each trial.
    pub(super) fn peaks(&self) -> Found<Vec<f64>> {
        self.mobilities.iter().map(|mobility| Ok(peak_receptance(mobility)?.1)).collect()
    }
}

/// Frequency (Hz) and value (m/N) of the largest receptance.
pub(super) fn peak_receptance(mobility: &FrequencyResponse) -> Found<(f64, f64)> {
    Ok(mobility.converted(ResponseForm::Receptance)?.peak().ok_or("the spectrum has no lines")?)
}
