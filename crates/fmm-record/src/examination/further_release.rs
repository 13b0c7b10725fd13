//! Further releases, which set the machine in motion again during a free vibration.

use crate::calculus::{EndRule, averaged};
use crate::examination::Examination;
use crate::examination::second_mode::beats;
use crate::examination::swings::Swings;
use crate::numerics::{median, range};
use crate::record::Record;

/// A second release, or a push: a time at which the motion becomes clearly larger again after a ring-down.
///
/// A free motion of one mode never grows. A release shows where the range of the values in the period that follows is
/// twice that in the period before, by 5 % of the largest range and by noise, and stays 1.5 times as large after it.
/// Before it there must be a ring-down: three peaks that span 15 % of the range of the record. What moves the machine
/// to where it is held before the first release is none. Neither are rises of half cycles that a beat of two modes
/// describes, or three rises at regular distances.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct FurtherRelease {
    /// Time at which the values leave their earlier pattern (s), within about a tenth of a period after rest, half of
    /// one in motion. If a hand draws the machine to its point of release, that may be the time at which the hand takes
    /// it.
    pub time: f64,
    /// Up to here, the record shows the motion before (s): the machine has not yet been taken hold of.
    pub sound_until: f64,
}

// Limits "by judgement" have no derivation: they were set on measured and simulated records, and the tests pin them.

/// Least ratio of the range in one period to that in the period before, at a release (1), by judgement.
const RISE: f64 = 2.0;
/// Least ratio half a period later (1), by judgement: a jump of the offset does not last.
const LASTING: f64 = 1.5;
/// Least rise over the largest range of the motion before (1), by judgement.
const VISIBLE: f64 = 0.05;
/// Range that noise alone does not reach, in its standard deviations (1): ten million normal values lie within ±5.
const ABOVE_NOISE: f64 = 10.0;
/// Least share of the range of the record that a ring-down has (1), by judgement: handling has less.
const LARGE: f64 = 0.15;
/// Fewest peaks of a ring-down, by judgement: handling before a release has fewer.
const FEWEST_PEAKS: usize = 3;
/// Largest relative difference of the distances between the rises of a beat (1), by judgement.
const REGULAR: f64 = 0.25;
/// Range before a release from rest over the range after it, at most (1), by judgement.
const REST: f64 = 0.2;
/// Margin around the range before a release (1), by judgement.
const MARGIN: f64 = 0.1;
/// Fewest samples of a period, and fewest periods of a record.
const FEWEST: (usize, usize) = (8, 4);

impl Examination<'_> {
    /// Further releases and pushes, in order.
    pub fn further_releases(&self) -> Vec<FurtherRelease> {
        let Some(envelope) = Envelope::of(self) else { return Vec::new() };
        let found = envelope.releases(self.record());
        if is_beat(&found) || (!found.is_empty() && beats(self)) { Vec::new() } else { found }
    }
}

/// True if rises follow each other like those of a beat.
fn is_beat(found: &[FurtherRelease]) -> bool {
    let distances: Vec<f64> = found.windows(2).map(|pair| pair[1].time - pair[0].time).collect();
    let typical = median(&mut distances.clone());
    distances.len() >= 2 && distances.iter().all(|distance| (distance - typical).abs() < REGULAR * typical)
}

/// The values smoothed, and how long a period is.
struct Envelope {
    values: Vec<f64>,
    /// Samples in a period.
    period: usize,
    /// Largest change that noise and resolution alone make.
    floor: f64,
}

impl Envelope {
    fn of(examination: &Examination) -> Option<Self> {
        let (record, swings) = (examination.record(), examination.swings());
        let (first, last) = (swings.peaks().first()?, swings.peaks().last()?);
        let half_cycle = (last.time - first.time) / (swings.peaks().len() - 1) as f64;
        let period = (2.0 * half_cycle * record.rate()).round() as usize;
        if period < FEWEST.0 || record.len() < FEWEST.1 * period {
            return None;
        }
        let clean = examination.bridged();
        let half = period / 32;
        let averaged_noise = clean.noise() / ((2 * half + 1) as f64).sqrt();
        let floor = (ABOVE_NOISE * averaged_noise).max(2.0 * clean.step());
        Some(Self { values: averaged(clean.record().values(), half, EndRule::Shrinking), period, floor })
    }

    /// Lowest and highest value from sample `from` to `to`, within the record.
    fn band(&self, from: usize, to: usize) -> (f64, f64) {
        let count = self.values.len();
        range(&self.values[from.min(count)..to.min(count)])
    }

    fn extent(&self, from: usize, to: usize) -> f64 {
        let (low, high) = self.band(from, to);
        high - low
    }

    fn releases(&self, record: &Record) -> Vec<FurtherRelease> {
        let (period, count) = (self.period, self.values.len());
        let whole = self.extent(0, count);
        let stride = (period / 16).max(1);
        let mut found = Vec::new();
        // First sample of the part looked at, and where something disturbs its rest, if anything does.
        let (mut begin, mut disturbed) = (0, None);
        let mut largest = 0.0f64;
        let mut i = period;
        while i + period / 2 < count {
            let before = self.extent(i - period, i);
            largest = largest.max(before);
            let limit = (RISE * before).max(before + self.floor.max(VISIBLE * largest));
            if self.extent(i, i + period) <= limit {
                i += stride;
                continue;
            }
            let start = self.departure(i, period);
            let rang = rang(record, begin, disturbed.unwrap_or(i), whole);
            let lasting = self.extent(start + period / 2, start + 3 * period / 2) > LASTING * before.max(self.floor);
            if rang && lasting && start + period / 2 < count {
                let sound = disturbed.unwrap_or_else(|| self.sound_until(i, start));
                found.push(FurtherRelease { time: record.time(start), sound_until: record.time(sound) });
            }
            if rang && !lasting {
                disturbed = disturbed.or(Some(self.sound_until(i, start)));
            } else {
                (begin, disturbed, largest) = (start, None, 0.0);
            }
            i = (start + period).max(i + stride);
        }
        found
    }

    /// Index at which the values after sample `i` leave the band of the period before.
    fn departure(&self, i: usize, period: usize) -> usize {
        let (low, high) = self.band(i - period, i);
        let margin = (MARGIN * (high - low)).max(0.5 * self.floor);
        let outside = |value: &f64| *value > high + margin || *value < low - margin;
        let end = (i + period).min(self.values.len());
        self.values[i..end].iter().position(outside).map_or(end, |k| i + k)
    }

    /// The last sample before a motion that leaves its band at `start`, and has not done so by `i`, that nothing
    /// disturbs.
    fn sound_until(&self, i: usize, start: usize) -> usize {
        let is_rest = self.extent(i - self.period, i) < REST * self.extent(i, i + self.period);
        // From rest the band is left soon; in motion a push shows after half a swing.
        start.saturating_sub(if is_rest { self.period / 8 } else { self.period / 2 })
    }
}

/// True if samples `begin..end` of `record`, whose values have the range `whole`, show a ring-down.
fn rang(record: &Record, begin: usize, end: usize, whole: f64) -> bool {
    let Ok(part) = record.crop(record.time(begin), record.time(end)) else { return false };
    let swings = Swings::of(&part);
    let largest = swings.heights().into_iter().fold(0.0, f64::max);
    swings.peaks().len() >= FEWEST_PEAKS && largest > LARGE * whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::synthetic::{CoulombDecay, Recorded, measured_records, released_twice, sampled, with_hum};
    use crate::units::Quantity;

    fn further_releases(record: &Record) -> Vec<FurtherRelease> {
        Examination::of(record).further_releases()
    }

    #[test]
    fn single_ring_downs_have_none() {
        for record in measured_records() {
            assert_eq!(further_releases(&record), []);
        }
        let record = with_hum();
        assert_eq!(further_releases(&Examination::of(&record).without_hum()), []);
        // None in 3000 such records.
        for seed in 0..300 {
            assert_eq!(further_releases(&Recorded::random(seed).record), [], "seed {seed}");
        }
    }

    #[test]
    fn a_second_release_after_rest_is_found() {
        let found = further_releases(&released_twice());
        assert_eq!(found.len(), 1);
        assert!((found[0].time - 2.0).abs() < 0.02 && (1.4..2.0).contains(&found[0].sound_until), "{found:?}");
    }

    #[test]
    fn pushes_and_later_releases_of_any_size_are_found() {
        for quantity in [Quantity::Velocity, Quantity::Displacement] {
            for noise in [1e-3, 0.03] {
                for (deadband, later, size) in [(0.05, 5.0, 1.5), (0.1, 4.0, 0.5), (0.02, 8.0, 1.0), (0.02, 8.0, 4.0)] {
                    let [first, second] = [(0.5, 1.0), (later, size)].map(|(release, amplitude)| CoulombDecay {
                        frequency: 2.2,
                        amplitude,
                        deadband,
                        release,
                    });
                    let end = first.state(later);
                    let value = |(x, v): (f64, f64)| if quantity == Quantity::Velocity { v / 13.8 } else { x };
                    let record = sampled(500.0, later + 5.0, quantity, noise, |t| {
                        if t < later {
                            return value(first.state(t));
                        }
                        // Held where it is released.
                        value(second.state(t))
                    });
                    let found = further_releases(&record);
                    let times: Vec<f64> = found.iter().map(|release| release.time).collect();
                    assert_eq!(times.len(), 1, "{quantity}, noise {noise}, at {later} s from {end:?}: {times:?}");
                    assert!((times[0] - later).abs() < 0.25, "{quantity}, noise {noise}, at {later} s: {times:?}");
                    assert!(found[0].sound_until < later + 0.03, "{quantity}, noise {noise}, {later}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn a_push_in_motion_is_found() {
        let ring = |t: f64| if t > 0.0 { (-0.5 * t).exp() * (13.8 * t).sin() } else { 0.0 };
        for phase in 0..8 {
            let push = 3.0 + f64::from(phase) * 0.45 / 8.0;
            let record = sampled(500.0, 8.0, Quantity::Velocity, 0.01, |t| ring(t + 0.1) + 0.8 * ring(t - push + 0.11));
            let found = further_releases(&record);
            assert_eq!(found.len(), 1, "{push} s: {found:?}");
            // The push begins with a step of all it is, 0.11 s before `push`.
            let late = found[0].time - push + 0.11;
            assert!((-0.05..0.3).contains(&late) && found[0].sound_until < push - 0.1, "{push} s: {found:?}");
        }
    }

    /// A displacement that is drawn to where it is held, released, comes to rest, is drawn there again and released.
    #[test]
    fn handling_before_a_release_is_none_and_ends_what_is_sound() {
        let decay = CoulombDecay { frequency: 2.2, amplitude: 1.0, deadband: 0.06, release: 0.0 };
        let drawn = |t: f64, from: f64| from + (1.0 - from) * (t / 0.7).clamp(0.0, 1.0);
        let stopped = decay.state(100.0).0;
        let record = sampled(500.0, 14.0, Quantity::Displacement, 0.002, |t| match t {
            ..2.0 => drawn(t - 0.5, 0.0),
            2.0..7.0 => decay.state(t - 2.0).0,
            7.0..9.0 => drawn(t - 7.0, stopped),
            _ => decay.state(t - 9.0).0,
        });
        let found = further_releases(&record);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((7.0..9.1).contains(&found[0].time), "{found:?}");
        assert!((4.0..7.05).contains(&found[0].sound_until), "{found:?}");
    }
}
