//! One blow, made ready to be fitted.

use std::ops::Range;
use std::sync::Arc;

use fmm_frf::{Baseline, Channel, Hit, Pulse};
use fmm_record::{Quantity, Record, noise, quantisation_step, saturation};

use crate::error::IdentifyError;
use crate::experiment::impact_motion::{FEWEST_QUIET, Motion, bridged, mean};
use crate::experiment::sampled_pulse::SampledPulse;
use fmm_model::{Estimated, ModelError};

/// A pulse stands this far above the noise (standard deviations),
const SIGNIFICANT: f64 = 20.0;
/// and ends where the force has fallen to this, or to that share of its level.
const SPENT: f64 = 2.0;
const SPENT_SHARE: f64 = 1e-6;

/// A blow: the force of its pulse and the velocity that it caused.
///
/// The force is set to zero outside the pulse, as the noise of a hammer between blows has no effect on the machine: 0.5
/// N rms over 33 s at 10 kHz disturb every line of the spectrum of a blow of 1.4 N s by 2 %, within the pulse by 0.02
/// %. Offsets of both channels are taken from where they are quiet, and removed; isolated spikes of the velocity are
/// bridged by straight lines. What was done stands in the [`summary`](Self::summary).
///
/// ```
/// use fmm_identify::ImpactTrial;
/// use fmm_record::{Quantity, Record};
///
/// // A half sine of 20 N over 10 ms on an offset of 0.1 N, and a velocity that dies out.
/// let pulse = |i: i32| if (100..=110).contains(&i) { 20.0 * (f64::from(i - 100) * 0.314_159_265).sin() } else { 0.0 };
/// let force: Vec<f64> = (0..4000).map(|i| 0.1 + pulse(i)).collect();
/// let swing = |t: f64| if t > 0.0 { (-5.0 * t).exp() * (40.0 * t).cos() } else { 0.0 };
/// let velocity: Vec<f64> = (0..4000).map(|i| 0.002 + 0.05 * swing(f64::from(i - 105) * 1e-3)).collect();
///
/// let force = Record::new(0.0, 1e-3, force, Quantity::Force, "N")?;
/// let velocity = Record::new(0.0, 1e-3, velocity, Quantity::Velocity, "m/s")?;
/// let trial = ImpactTrial::prepare(&force, &velocity)?;
/// assert!((trial.summary().force_offset.value - 0.1).abs() < 1e-9);
/// assert!((trial.summary().velocity_offset.value - 0.002).abs() < 1e-5);
/// // Δt F₀ cot(π/20), by the trapezoid rule.
/// assert!((trial.summary().impulse.value - 0.126_275).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ImpactTrial {
    interval: f64,
    velocity: Vec<f64>,
    force: Arc<[f64]>,
    /// Indices within the force of the samples in which the hammer is in contact.
    pub(crate) hits: Vec<Range<usize>>,
    begin: usize,
    end: usize,
    calibration_uncertainty: f64,
    summary: ImpactSummary,
}

/// Description of an impact and of its preparation. Times are on the time axis of the records.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ImpactSummary {
    /// Number of samples of each channel.
    pub samples: usize,
    /// Sampling rate (Hz).
    pub rate: f64,
    /// Time at which the blow begins (s).
    pub begin: f64,
    /// J, impulse (N s) by the trapezoid rule, further hits included; its uncertainty is that of what lies between the
    /// samples, of the noise in the pulse and of the offset. Of a half sine over n intervals the first is J 0.67/n², by
    /// where the samples lie.
    pub impulse: Estimated,
    /// Standard uncertainty (s) of when the impulse acts, for the same reasons.
    pub time_uncertainty: f64,
    /// Largest force (N).
    pub level: f64,
    /// Duration of the force (s).
    pub duration: f64,
    /// Intervals between samples in the pulse.
    pub intervals: usize,
    /// Further hits of the hammer; the fit includes them.
    pub further_hits: Vec<Hit>,
    /// Samples of force and velocity cut off at the limits of the converter.
    pub overloads: (usize, usize),
    /// Offset (N) that was removed from the force.
    pub force_offset: Estimated,
    /// Standard deviation of the noise of the force (N).
    pub force_noise: f64,
    /// Offset (m/s) that was removed from the velocity.
    pub velocity_offset: Estimated,
    /// Standard deviation of the noise of the velocity (m/s).
    pub velocity_noise: f64,
    /// Largest velocity (m/s).
    pub speed: f64,
    /// Samples of the velocity that were bridged, as isolated ones far off their neighbours.
    pub spikes: usize,
    /// Time at which motion is last seen above the noise (s); `None` if that is so near the end of the record that it may go on.
    pub rest: Option<f64>,
}

impl ImpactTrial {
    /// Prepares a trial of a `force` (N) and the `velocity` (m/s) that it causes, recorded together; a positive force
    /// must push towards positive velocities.
    ///
    /// # Errors
    /// [`IdentifyError::Impact`] with what is wrong between the two: quantity, number of samples, rate or beginning;
    /// [`IdentifyError::WrongRecord`] for a channel of another quantity or unit, [`IdentifyError::TooFew`] if one is
    /// never quiet, and [`IdentifyError::NotSeen`] without a blow, without motion, or for motion against the force.
    pub fn prepare(force: &Record, velocity: &Record) -> Result<Self, IdentifyError> {
        let (force, velocity) = (&*force.equally_spaced(), &*velocity.equally_spaced());
        require_together(force, velocity)?;
        let interval = velocity.interval();
        let force_noise = noise(force.values());
        let blow = Blow::of(force.values(), interval, force_noise)?;
        let (velocity_values, spikes) = bridged(velocity);
        let motion = Motion::of(velocity_values, blow.begin)?;
        let impulse = interval * blow.force.iter().sum::<f64>();
        let swing = motion.velocity[blow.begin..motion.end].iter().find(|v| v.abs() > 0.25 * motion.speed);
        if let Some(first) = swing.filter(|first| *first * impulse < 0.0) {
            return Err(IdentifyError::not_seen(format!(
                "the force pushes one way ({impulse} N s) and the machine moves the other ({first} m/s); turn the sign \
                 of one channel"
            )));
        }
        let samples = blow.hits.iter().map(Range::len).sum::<usize>() as f64;
        // A converter step counts as the noise of its rounding.
        let of_force = force_noise.hypot(quantisation_step(force.values()).unwrap_or(0.0) / 12f64.sqrt());
        let sampled = SampledPulse::of(&blow.force, &blow.hits, interval, of_force);
        let mut further_hits = blow.pulse.further_hits;
        for hit in &mut further_hits {
            hit.time += velocity.start();
        }
        let summary = ImpactSummary {
            samples: velocity.len(),
            rate: velocity.rate(),
            begin: velocity.time(blow.begin),
            impulse: Estimated {
                value: impulse,
                uncertainty: sampled.impulse.hypot(interval * blow.offset.uncertainty * samples),
            },
            time_uncertainty: sampled.time,
            level: blow.pulse.level,
            duration: interval * (blow.force.len() - 1) as f64,
            intervals: blow.pulse.samples.len().saturating_sub(1),
            further_hits,
            overloads: (
                blow.pulse.overload.map_or(0, |overload| overload.samples),
                saturation(velocity.values()).map_or(0, |overload| overload.samples),
            ),
            force_offset: blow.offset,
            force_noise,
            velocity_offset: motion.offset,
            velocity_noise: motion.noise,
            speed: motion.speed,
            spikes,
            rest: motion.last.map(|last| velocity.time(last)),
        };
        let (velocity, end) = (motion.velocity, motion.end);
        Ok(Self {
            interval,
            velocity,
            force: blow.force.into(),
            hits: blow.hits,
            begin: blow.begin,
            end,
            calibration_uncertainty: 0.0,
            summary,
        })
    }

    /// The same measured by a hammer of which the calibration has this relative standard uncertainty (1). Impacts that
    /// are fitted together share it.
    ///
    /// # Errors
    /// [`IdentifyError::InvalidInput`] for one that is negative or not finite.
    pub fn with_calibration_uncertainty(self, uncertainty: f64) -> Result<Self, IdentifyError> {
        let calibration_uncertainty =
            ModelError::require_not_negative("uncertainty of the calibration of a hammer", uncertainty, "1")?;
        Ok(Self { calibration_uncertainty, ..self })
    }

    /// Relative standard uncertainty of the calibration of the hammer (1).
    pub fn calibration_uncertainty(&self) -> f64 {
        self.calibration_uncertainty
    }

    /// Description of the impact and of its preparation.
    pub fn summary(&self) -> &ImpactSummary {
        &self.summary
    }

    /// Velocity (m/s), one value per sample, less its offset.
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Force (N) of the samples from [`begin`](Self::begin) on, less its offset; it is zero everywhere else.
    pub fn force(&self) -> &[f64] {
        &self.force
    }

    /// Index of the first sample of the force of the blow. There the machine is still at rest.
    pub fn begin(&self) -> usize {
        self.begin
    }

    /// Indices of the samples from the beginning of the blow until a while after the motion was last seen.
    pub fn motion(&self) -> Range<usize> {
        self.begin..self.end
    }

    /// Time between samples (s).
    pub fn interval(&self) -> f64 {
        self.interval
    }
}

/// Refuses records other than a force and a velocity in SI units, sampled at the same times.
fn require_together(force: &Record, velocity: &Record) -> Result<(), IdentifyError> {
    Channel::Force.require(force, Quantity::Force, force.rate())?;
    if velocity.quantity() != Quantity::Velocity {
        return Err(IdentifyError::wrong_record(format!(
            "the fit of impacts needs a velocity, but the record is: {}",
            velocity.quantity()
        )));
    }
    for (channel, record, expected) in [(Channel::Force, force, "N"), (Channel::Response, velocity, "m/s")] {
        if record.unit() != expected {
            return Err(IdentifyError::wrong_record(format!(
                "the {channel} of a blow must be in {expected}, but is in {}; scale the record",
                record.unit()
            )));
        }
    }
    Channel::Response.require(velocity, Quantity::Velocity, force.rate())?;
    Ok(Channel::require_together(force, velocity)?)
}

/// The force of a blow.
struct Blow {
    /// Index of its first sample.
    begin: usize,
    force: Vec<f64>,
    /// Ranges of it in which the hammer is in contact.
    hits: Vec<Range<usize>>,
    offset: Estimated,
    pulse: Pulse,
}

impl Blow {
    fn of(force: &[f64], interval: f64, noise: f64) -> Result<Self, IdentifyError> {
        let found = Pulse::of(force, interval, Baseline::Mean)?;
        // Before the blow, as many sensors take seconds to recover from one.
        let width = found.samples.len();
        let before = 0..found.samples.start.saturating_sub(width);
        let after = found.further_hits.iter().map(|hit| (hit.time / interval).round() as usize).max();
        let after = (after.unwrap_or(0).max(found.samples.end) + width).min(force.len())..force.len();
        let quiet = if before.len() >= FEWEST_QUIET { before } else { after };
        if quiet.len() < FEWEST_QUIET {
            return Err(IdentifyError::no_quiet(Channel::Force, quiet.len(), FEWEST_QUIET));
        }
        let offset = mean(force[quiet].iter(), noise);
        let pulse = Pulse::of(force, interval, Baseline::Offset(offset.value))?;
        if !(pulse.level.abs() > SIGNIFICANT * noise) {
            let level = pulse.level;
            return Err(IdentifyError::not_seen(format!(
                "there is no blow in the force: its largest value is {level} N in a noise of {noise} N"
            )));
        }
        let spent = (SPENT * noise).max(SPENT_SHARE * pulse.level.abs());
        let push = |i: usize| (force[i] - offset.value) * pulse.level.signum();
        let hits = pulse.further_hits.iter().map(|hit| hit.time).chain([pulse.time]);
        let mut windows: Vec<Range<usize>> = hits
            .map(|time| {
                let peak = ((time / interval).round() as usize).min(force.len() - 1);
                let begin = (0..peak).rev().find(|&i| push(i) <= spent).map_or(0, |i| i + 1);
                let end = (peak + 1..force.len()).find(|&i| push(i) <= spent).unwrap_or(force.len());
                begin..end
            })
            .collect();
        windows.sort_by_key(|window| window.start);
        windows.dedup();
        let (first, last) = (windows[0].start, windows.iter().map(|window| window.end).max().unwrap_or(0));
        // A zero at either end, between which and the first sample the force rises along a straight line.
        let (begin, end) = (first.saturating_sub(1), (last + 1).min(force.len()));
        let mut kept = vec![0.0; end - begin];
        for i in windows.iter().cloned().flatten() {
            kept[i - begin] = force[i] - offset.value;
        }
        let hits = windows.into_iter().map(|window| window.start - begin..window.end - begin).collect();
        Ok(Self { begin, force: kept, hits, offset, pulse })
    }
}

#[cfg(test)]
mod tests {
    use fmm_frf::FrfError;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Normal};

    use super::*;

    const INTERVAL: f64 = 1e-3;

    fn half_sine(begin: usize, level: f64, i: usize) -> f64 {
        let inside = (begin..=begin + 10).contains(&i);
        if inside { level * (std::f64::consts::PI * (i - begin) as f64 / 10.0).sin() } else { 0.0 }
    }

    fn records(force: impl Fn(usize) -> f64, velocity: impl Fn(usize) -> f64, count: usize) -> (Record, Record) {
        let force = Record::new(2.0, INTERVAL, (0..count).map(force).collect(), Quantity::Force, "N").unwrap();
        let velocity = Record::new(2.0, INTERVAL, (0..count).map(velocity).collect(), Quantity::Velocity, "m/s");
        (force, velocity.unwrap())
    }

    /// A decaying swing from sample 105 on.
    fn swing(i: usize) -> f64 {
        let t = (i as f64 - 105.0) * INTERVAL;
        if t > 0.0 { 0.05 * (-4.0 * t).exp() * (30.0 * t).cos() } else { 0.0 }
    }

    #[test]
    fn a_bounce_is_kept_and_told() {
        let force = |i| half_sine(100, 20.0, i) + half_sine(130, 4.0, i) - 0.5;
        let (force, velocity) = records(force, swing, 4000);
        let trial = ImpactTrial::prepare(&force, &velocity).unwrap();
        let summary = trial.summary();
        assert_eq!((trial.begin(), trial.force().len(), summary.further_hits.len()), (100, 41, 1));
        assert!((summary.force_offset.value + 0.5).abs() < 1e-12);
        let cot = 1.0 / (std::f64::consts::PI / 20.0).tan();
        assert!((summary.impulse.value - INTERVAL * 24.0 * cot).abs() < 1e-12, "{:?}", summary.impulse);
        assert_eq!(trial.force()[11..30], [0.0; 19]);
        assert!((summary.begin - 2.1).abs() < 1e-12 && summary.rest.is_some());
    }

    #[test]
    fn a_motion_that_goes_on_has_no_rest() {
        let (force, velocity) = records(|i| half_sine(100, 20.0, i), swing, 600);
        let trial = ImpactTrial::prepare(&force, &velocity).unwrap();
        assert_eq!((trial.summary().rest, trial.motion()), (None, 100..600));
    }

    #[test]
    fn spikes_are_bridged() {
        let drop_out = |i| if (400..402).contains(&i) { 0.1 } else { swing(i) };
        let (force, velocity) = records(|i| half_sine(100, 20.0, i), drop_out, 4000);
        let trial = ImpactTrial::prepare(&force, &velocity).unwrap();
        assert_eq!(trial.summary().spikes, 2);
        assert!((trial.velocity()[400] - swing(400)).abs() < 1e-4, "{} m/s", trial.velocity()[400]);
    }

    #[test]
    fn impossible_trials_are_refused() {
        let hit = |i: usize| half_sine(100, 20.0, i);
        let (force, velocity) = records(hit, swing, 4000);
        let prepare = ImpactTrial::prepare;
        let short = velocity.crop(2.0, 3.0).unwrap();
        assert!(
            matches!(prepare(&force, &short), Err(IdentifyError::Impact(FrfError::Mismatch { what })) if what.contains("samples"))
        );
        let late = velocity.clone().starting_at(2.1).unwrap();
        assert!(
            matches!(prepare(&force, &late), Err(IdentifyError::Impact(FrfError::Mismatch { what })) if what.contains("begin together"))
        );
        let slow = Record::new(2.0, 2e-3, velocity.values().to_vec(), Quantity::Velocity, "m/s").unwrap();
        assert!(
            matches!(prepare(&force, &slow), Err(IdentifyError::Impact(FrfError::Mismatch { what })) if what.contains("sampled at"))
        );
        assert!(
            matches!(prepare(&velocity, &velocity), Err(IdentifyError::Impact(FrfError::Mismatch { what })) if what.contains("must be a record of"))
        );
        assert!(matches!(prepare(&force, &force), Err(IdentifyError::WrongRecord { what }) if what.contains("needs a \
                velocity")));
        let other_unit = velocity.clone().with_unit("mm/s");
        assert!(
            matches!(prepare(&force, &other_unit), Err(IdentifyError::WrongRecord { what }) if what.contains("scale \
                the record"))
        );

        let white = Normal::new(0.0, 0.5).unwrap().sample_iter(ChaCha8Rng::seed_from_u64(1));
        let white: Vec<f64> = white.take(4000).collect();
        let (silent, _) = records(|i| white[i], swing, 4000);
        assert!(
            matches!(prepare(&silent, &velocity), Err(IdentifyError::NotSeen { what }) if what.contains("no blow"))
        );
        let (zero, still) = records(|_| 0.0, |_| 0.3, 4000);
        assert!(matches!(prepare(&zero, &velocity), Err(IdentifyError::Impact(FrfError::Values { .. }))));
        assert!(
            matches!(prepare(&force, &still), Err(IdentifyError::NotSeen { what }) if what.contains("nothing moves"))
        );
        let (_, against) = records(hit, |i| -swing(i), 4000);
        assert!(
            matches!(prepare(&force, &against), Err(IdentifyError::NotSeen { what }) if what.contains("turn the sign"))
        );
        let (early, moving) = records(|i| half_sine(0, 20.0, i), |i| swing(i + 100), 400);
        assert!(
            matches!(prepare(&early, &moving), Err(IdentifyError::TooFew { what, .. }) if what.contains("offset of the \
                response"))
        );
    }
}
