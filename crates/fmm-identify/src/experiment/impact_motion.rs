//! The velocity after a blow: its offset, its noise, and when the motion ends.

use fmm_frf::Channel;
use fmm_record::{Examination, Record, noise, quantisation_step};

use crate::error::IdentifyError;
use fmm_model::Estimated;

/// Fewer samples than this are too few to know an offset from.
pub(crate) const FEWEST_QUIET: usize = 16;
/// Smallest velocity of a motion that is seen: standard deviations of the noise, or a share of its largest velocity.
const SEEN: f64 = 6.0;
const SEEN_SHARE: f64 = 1e-3;
/// Means that show motion below the noise are over this part of the motion, and no more samples than that, so that
/// drift and hum are not taken for motion.
const SWINGS: usize = 32;
const LONGEST_MEAN: usize = 64;
/// Share of an offset that may be rounding.
const ROUNDING: f64 = 1e-12;
/// Time over which a motion is followed after it was last seen, as a share of its duration.
const AFTER: f64 = 0.1;

/// Mean of the samples with its uncertainty if they have white noise of this standard deviation.
pub(crate) fn mean<'a>(samples: impl Iterator<Item = &'a f64>, deviation: f64) -> Estimated {
    let (sum, count) = samples.fold((0.0, 0.0), |(sum, count), sample| (sum + sample, count + 1.0));
    Estimated::new(sum / count, deviation / f64::sqrt(count))
}

/// The values of a record with its spikes bridged by straight lines, and how many samples those are.
pub(crate) fn bridged(record: &Record) -> (Vec<f64>, usize) {
    let (mut values, mut count) = (record.values().to_vec(), 0);
    for spike in Examination::of(record).spikes() {
        let (before, after) = (spike.index - 1, (spike.index + spike.count).min(values.len() - 1));
        let (from, to) = (values[before], values[after]);
        for (step, value) in (1..).zip(&mut values[spike.index..after]) {
            *value = from + (to - from) * f64::from(step) / (after - before) as f64;
        }
        count += spike.count;
    }
    (values, count)
}

/// The last sample in which a mean over a small part of the motion, which runs from `begin` to `last` at least, is off
/// the `rough` offset by more than [`SEEN`] times its uncertainty, for samples of this `deviation`. The last swing is
/// often below the noise of single samples, and all of it to one side, which would make an offset of it.
fn last_in_means(velocity: &[f64], begin: usize, last: usize, rough: &Estimated, deviation: f64) -> Option<usize> {
    let span = ((last - begin) / SWINGS).clamp(1, LONGEST_MEAN);
    let seen = SEEN * (deviation / (span as f64).sqrt()).hypot(rough.uncertainty);
    let is_seen = |start: &usize| {
        let sum: f64 = velocity[*start..start + span].iter().map(|v| v - rough.value).sum();
        sum.abs() > seen * span as f64
    };
    (last + 1..(velocity.len() + 1).saturating_sub(span)).rev().find(is_seen).map(|start| start + span / 2)
}

/// The velocity that a blow causes.
pub(crate) struct Motion {
    pub(crate) velocity: Vec<f64>,
    pub(crate) offset: Estimated,
    pub(crate) noise: f64,
    pub(crate) speed: f64,
    /// Index of the last sample in which motion is seen, if it ends in the record.
    pub(crate) last: Option<usize>,
    /// Index after the last sample that may move.
    pub(crate) end: usize,
}

impl Motion {
    pub(crate) fn of(mut velocity: Vec<f64>, begin: usize) -> Result<Self, IdentifyError> {
        let length = velocity.len();
        // A converter step counts as the noise of its rounding.
        let noise = noise(&velocity).hypot(quantisation_step(&velocity).unwrap_or(0.0) / 12f64.sqrt());
        let before = velocity[..begin].iter();
        // A machine that was not watched before the blow is at rest again at the end, if anywhere.
        let rough = if begin >= FEWEST_QUIET {
            mean(before, noise)
        } else {
            mean(velocity[length - length / 10 - 1..].iter(), noise)
        };
        let speed_about = |offset: f64| velocity[begin..].iter().fold(0.0f64, |most, v| most.max((v - offset).abs()));
        // The mean of equal numbers is off by rounding.
        let seen = (SEEN * noise).max(SEEN_SHARE * speed_about(rough.value)).max(ROUNDING * rough.value.abs());
        let last = (begin..length).rev().find(|&i| (velocity[i] - rough.value).abs() > seen);
        let last = last.ok_or_else(|| IdentifyError::no_motion(rough.value, "m/s"))?;
        let last = last_in_means(&velocity, begin, last, &rough, seen / SEEN).unwrap_or(last);
        let follow = ((AFTER * (last - begin) as f64) as usize).max(FEWEST_QUIET);
        let end = (last + 1 + follow).min(length);
        let is_at_rest = length - end >= FEWEST_QUIET;
        let after = if is_at_rest { end..length } else { length..length };
        if begin.max(after.len()) < FEWEST_QUIET {
            return Err(IdentifyError::no_quiet(Channel::Response, begin, FEWEST_QUIET));
        }
        let offset = mean(velocity[..begin].iter().chain(&velocity[after]), noise);
        let speed = speed_about(offset.value);
        for v in &mut velocity {
            *v -= offset.value;
        }
        Ok(Self { velocity, offset, noise, speed, last: is_at_rest.then_some(last), end })
    }
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, Normal};

    use super::*;

    /// Half a swing below the noise of single samples, to one side, is motion and not offset.
    #[test]
    fn a_last_swing_below_the_noise_is_no_offset() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let white = Normal::new(0.0, 1e-3).unwrap();
        let swing = |i: usize| match i {
            // Friction takes as much from every half swing of 250 samples; the last has 4 standard deviations of noise.
            100..1350 => {
                let (number, part) = ((i - 100) / 250, (i - 100) % 250);
                let height = [0.1, -0.076, 0.052, -0.028, 0.004][number];
                height * (std::f64::consts::PI * part as f64 / 250.0).sin()
            }
            _ => 0.0,
        };
        let velocity: Vec<f64> = (0..2500).map(|i| 0.01 + swing(i) + white.sample(&mut random)).collect();
        let motion = Motion::of(velocity, 100).unwrap();
        assert!((1270..1370).contains(&motion.last.unwrap()), "last seen at {:?}", motion.last);
        let off = (motion.offset.value - 0.01) / motion.offset.uncertainty;
        assert!(off.abs() < 3.0, "the offset is off by {off} standard uncertainties");
    }
}
