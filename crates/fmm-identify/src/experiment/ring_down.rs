//! Ring-down: a free vibration after a release.

use std::f64::consts::PI;
use std::ops::Range;

use fmm_model::ModelError;
use fmm_record::{
    Examination, Interruption, Peak, Quantity, Record, Swings, Upsampling, quantisation_step, saturation,
};

use super::acceleration::{jumps, velocity_of};
use super::{Experiment, usable};
use crate::error::IdentifyError;
use crate::experiment::first_guess::{FirstGuess, Oscillation};
use crate::experiment::nuisance::Nuisance;
use crate::experiment::preparation::COARSE;
use crate::experiment::{Offset, Preparation, RecordSummary};

/// Fewest half swings that show a period.
const FEWEST_HALF_SWINGS: usize = 2;

/// Standard deviations of a walk below which the integral of an acceleration shows no swing.
const WALKS: f64 = 5.0;

impl Experiment {
    /// A ring-down: the part of a `record` of displacement, velocity or acceleration in which the machine vibrates
    /// freely.
    ///
    /// If the record begins at rest, or the machine is moved slowly before, it is used from the first peak after the
    /// release on (of a displacement, from the first crossing), as whatever held the machine may act on for a while;
    /// otherwise from its beginning. If it is released or pushed again, it is used until shortly before that; if
    /// something else takes its motion, until then. Of samples that are held or interpolated, the measured ones are
    /// used. Spikes of one to three samples are left out, and where the steps of a converter exceed the noise, what
    /// follows the last turning point. Nothing is smoothed and nothing is subtracted: smoothing would correlate the
    /// noise, and the offset is a parameter. Swings, release, spikes and noise are looked for in the record less its
    /// hum.
    ///
    /// Samples that are unequally spaced are fitted at their times. What looks for swings, noise, spikes or hum sees
    /// the motion at equal intervals ([`Record::equally_spaced`]).
    ///
    /// An acceleration jumps where dry friction reverses. It is fitted as it is, but for the samples beside the
    /// reversals, if it jumps there: no accelerometer follows a jump. Its swings are looked for in its integral, less
    /// what drifts more slowly than the motion.
    ///
    /// # Errors
    /// [`IdentifyError`] if the record is no motion, too short, constant, or shows fewer than two half swings, if it
    /// has no samples over more than a quarter of a period, or if the preparation leaves nothing of it.
    pub fn ring_down(record: &Record, preparation: &Preparation) -> Result<Self, IdentifyError> {
        let quantity = record.quantity();
        if !matches!(quantity, Quantity::Displacement | Quantity::Velocity | Quantity::Acceleration) {
            let (subject, needed) = ("a ring-down", "a displacement, a velocity or an acceleration");
            return Err(IdentifyError::wrong_quantity(subject, needed, quantity));
        }
        let (record, gain_uncertainty, clock_uncertainty) = usable(record, preparation)?;
        let given = (!record.is_equally_spaced()).then(|| record.clone());
        let (record, upsampling) = measured(record.equally_spaced().into_owned())?;
        let (first, end) = (record.start(), record.end());
        let views = Views::of(record)?;
        if let Some(given) = &given {
            require_no_long_gap(given, views.seen().swings())?;
        }
        let is_acceleration = quantity == Quantity::Acceleration;
        let hum = views.record.hum().to_vec();
        let seen_quantity = views.seen().record().quantity();
        // One motion is fitted, the first.
        let further = views.seen().further_releases();
        let until = further.first().map_or(end, |next| next.sound_until);
        let views = views.crop(first, until)?;
        // Who says where to end knows what is there.
        let interruption = if preparation.to.is_none() { views.seen().interruption() } else { None };
        let until = interruption.map_or(until, |Interruption { sound_until, .. }| sound_until);
        let views = views.crop(first, until)?;
        let swings = views.seen().swings().clone();
        let release = views.cleaned.release();
        let held_offset = match preparation.offset {
            Offset::Fitted => None,
            Offset::Rest => Some(release.ok_or(IdentifyError::no_rest())?.offset),
            Offset::Fixed(value) => Some(ModelError::require_finite("offset", value, "in the unit of the record")?),
        };
        let released = release.map(|release| release.rest_end).or_else(|| pulled_until(&swings, first, seen_quantity));
        let begin = released.map_or(first, |released| beginning(&swings, released, seen_quantity));
        let views = views.crop(begin, until)?;
        let (record, seen, mut noise) = (views.record.record(), views.seen(), views.cleaned.noise());

        let start = record.start();
        // The integral of noise walks in the rest as well.
        let walk = WALKS * noise * (record.duration() * record.interval()).sqrt();
        let swung = Swung::of(&swings, seen_quantity, start - record.interval(), is_acceleration.then_some(walk));
        let Swung { peaks, times, heights, frequency } = swung;
        let oscillation = Oscillation {
            extrema: peaks.iter().map(|peak| ((peak.time - start).max(0.0), peak.value)).collect(),
            frequency,
        };
        let few = IdentifyError::too_few_half_swings(peaks.len(), FEWEST_HALF_SWINGS);
        let guess = FirstGuess::of(&oscillation, seen_quantity).ok_or(few)?;

        let spikes = views.cleaned.spikes();
        let mut kept = without(record.len(), spikes.iter().map(|spike| spike.index..spike.index + spike.count));
        if is_acceleration {
            let (jumps, less) = jumps(&times, noise, &guess, seen.record(), views.cleaned.record());
            noise = less;
            kept = kept.into_iter().flat_map(|range| between(range, &jumps)).collect();
        }
        let used = given.map(|given| given.crop(record.start(), record.end())).transpose()?;
        let (resolution, saturation) = match &used {
            Some(used) => {
                // What lies between measured samples has less noise than they.
                noise = used.noise();
                (quantisation_step(used.values()), saturation(used.values()))
            }
            None => (views.record.resolution(), views.record.saturation()),
        };
        if resolution.is_some_and(|step| step > COARSE * noise) {
            // What swings within a step or two is rounded to another motion.
            let last = peaks.last().map_or(0.0, |peak| (peak.time - start) / record.interval());
            kept = kept.into_iter().map(|range| range.start..range.end.min(last.max(0.0) as usize)).collect();
            kept.retain(|range| range.start < range.end);
        }
        if let Some(used) = &used {
            kept = same_times(&kept, record, used);
        }
        let amplitudes = &guess.amplitudes;
        let in_record = if is_acceleration { 2.0 * PI * guess.frequency() } else { 1.0 };
        let summary = RecordSummary {
            samples: kept.iter().map(Range::len).sum(),
            rate: used.as_ref().unwrap_or(record).rate(),
            quantity,
            held_offset,
            gain_uncertainty,
            clock_uncertainty,
            release: released,
            half_swings: peaks.len(),
            amplitudes: (in_record * amplitudes[0], in_record * amplitudes[amplitudes.len() - 1]),
            resolution,
            rest_from: rest_from(&views.cleaned, resolution.unwrap_or(0.0), guess.frequency()),
            spikes: spikes.iter().map(|spike| spike.count).sum(),
            saturation,
            offset_step: seen.offset_step(),
            period_change: Swings::period_change(&times, &heights),
            hum,
            further_releases: further.iter().map(|release| release.time).collect(),
            interruption,
            upsampling,
            second_mode: seen.second_mode(),
            ..RecordSummary::unseen(record, guess.frequency(), noise)
        };
        let peaks = peaks.iter().map(|peak| (peak.time, peak.value)).collect();
        let nuisances = Nuisance::of_hum(&summary.hum).collect();
        let record = used.unwrap_or_else(|| views.record.into_record());
        Ok(Self { peaks, ..Self::bare(record, kept, guess, summary) }.beside(nuisances))
    }
}

/// Examinations of one measurement.
struct Views {
    /// The record as it was measured, which is fitted.
    record: Examination<'static>,
    /// Without its hum, which must not be taken for the machine.
    cleaned: Examination<'static>,
    /// The velocity of an acceleration: its kinks are smaller than the jumps of the acceleration.
    velocity: Option<Examination<'static>>,
}

impl Views {
    fn of(record: Record) -> Result<Self, IdentifyError> {
        let record = Examination::of(record);
        let cleaned = Examination::of(record.without_hum());
        let velocity = if cleaned.record().quantity() == Quantity::Acceleration {
            let few = || IdentifyError::too_few_half_swings(0, FEWEST_HALF_SWINGS);
            Some(Examination::of(velocity_of(cleaned.record()).ok_or_else(few)?))
        } else {
            None
        };
        Ok(Self { record, cleaned, velocity })
    }

    /// The view that shows the swings.
    fn seen(&self) -> &Examination<'static> {
        self.velocity.as_ref().unwrap_or(&self.cleaned)
    }

    /// The parts of all views from `from` to `to` (s).
    fn crop(self, from: f64, to: f64) -> Result<Self, IdentifyError> {
        let velocity = self.velocity.map(|velocity| velocity.crop(from, to)).transpose()?;
        Ok(Self { record: self.record.crop(from, to)?, cleaned: self.cleaned.crop(from, to)?, velocity })
    }
}

/// The samples of `record` that were measured, and how they were multiplied.
fn measured(record: Record) -> Result<(Record, Option<Upsampling>), IdentifyError> {
    let upsampling = Examination::of(&record).upsampling();
    // Without a copy: a long record is held once.
    let record = match upsampling {
        Some(upsampling) => upsampling.measured(&record)?,
        None => record,
    };
    Ok((record, upsampling))
}

/// Oscillation after a time: turning points, the times at which the velocity is zero and the heights beside them, and
/// the frequency (Hz).
struct Swung {
    peaks: Vec<Peak>,
    times: Vec<f64>,
    heights: Vec<f64>,
    frequency: Option<f64>,
}

impl Swung {
    /// The part of `swings` of a `quantity` later than `after` (s), up to the first peak that does not exceed `least`,
    /// if that is given.
    fn of(swings: &Swings, quantity: Quantity, after: f64, least: Option<f64>) -> Self {
        let mut peaks: Vec<Peak> = swings.peaks().iter().copied().filter(|peak| peak.time > after).collect();
        let (times, heights) = swings.turns(quantity);
        let begun = times.iter().take_while(|time| **time <= after).count();
        let (mut times, mut heights) = (times[begun..].to_vec(), heights[begun..].to_vec());
        let mut frequency = swings.frequency();
        let swung = least.map_or(peaks.len(), |least| peaks.iter().take_while(|peak| peak.value.abs() > least).count());
        if swung < peaks.len() {
            peaks.truncate(swung);
            times.truncate(swung.saturating_sub(1));
            heights.truncate(swung.saturating_sub(1));
            let span = times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
            frequency = (times.len() > 1).then(|| 0.5 * (times.len() - 1) as f64 / span);
        }
        Self { peaks, times, heights, frequency }
    }
}

/// Time (s) from which on a record that is released at `rest_end` is used.
fn beginning(swings: &Swings, rest_end: f64, quantity: Quantity) -> f64 {
    let mut candidates: Box<dyn Iterator<Item = f64>> = if quantity == Quantity::Displacement {
        Box::new(swings.crossings().iter().map(|crossing| crossing.time))
    } else {
        Box::new(swings.peaks().iter().map(|peak| peak.time))
    };
    candidates.find(|time| *time > rest_end).unwrap_or(rest_end)
}

/// Release (s) of a machine that was moved otherwise since the `start` (s) of a record, such as pulled slowly, as its
/// `swings` in the record of `quantity` show it; `None` if it vibrates from the start on.
///
/// A free vibration turns in every half cycle. The first turning point that shows is then that of the release.
fn pulled_until(swings: &Swings, start: f64, quantity: Quantity) -> Option<f64> {
    /// Half cycles without a turning point (1). Origin: one before the first that shows, and one that may be missed.
    const QUIET: f64 = 2.0;
    let (first, half_cycle) = (swings.peaks().first()?, 0.5 / swings.frequency()?);
    // A velocity has its peak a quarter of a period after the turning point.
    let since = if quantity == Quantity::Displacement { 0.0 } else { 0.5 * half_cycle };
    (first.time - start > QUIET * half_cycle).then_some(first.time - since)
}

/// Refuses a record with a gap over which its `swings` cannot be followed.
fn require_no_long_gap(measured: &Record, swings: &Swings) -> Result<(), IdentifyError> {
    /// Longest gap over the period that is bridged (1). Origin: a cubic over a quarter of a period is off by less than
    /// a tenth of the amplitude, and hides no turning point.
    const LONGEST: f64 = 0.25;
    let steps = measured.times().zip(measured.times().skip(1)).map(|(before, after)| [before, after]);
    let longest = steps.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])));
    match longest.zip(swings.frequency()).map(|(gap, frequency)| (gap, frequency * (gap[1] - gap[0]))) {
        Some((gap, periods)) if periods > LONGEST => Err(IdentifyError::long_gap(gap, periods)),
        _ => Ok(()),
    }
}

/// The samples of `measured` within half an interval of those of `record` in these ranges.
fn same_times(ranges: &[Range<usize>], record: &Record, measured: &Record) -> Vec<Range<usize>> {
    let times: Vec<f64> = measured.times().collect();
    let place = |index: usize| {
        let time = record.time(index) - 0.5 * record.interval();
        times.partition_point(|measured| *measured < time)
    };
    ranges.iter().map(|range| place(range.start)..place(range.end)).filter(|range| !range.is_empty()).collect()
}

/// The parts of `range` between `holes`, which are in order.
fn between(range: Range<usize>, holes: &[Range<usize>]) -> Vec<Range<usize>> {
    let inside =
        holes.iter().map(|hole| hole.start.clamp(range.start, range.end)..hole.end.clamp(range.start, range.end));
    let shifted = inside.map(|hole| hole.start - range.start..hole.end - range.start);
    without(range.len(), shifted).into_iter().map(|part| part.start + range.start..part.end + range.start).collect()
}

/// Time at which `record` comes to rest (s): from there on its values stay within their noise and a `resolution` for at least
/// half a period of the motion; `None` if they do not.
fn rest_from(examination: &Examination, resolution: f64, frequency: f64) -> Option<f64> {
    /// Range of a thousand normal values, and what it is above 2 √(2 ln n) for n of them, in standard deviations, with
    /// some to spare.
    const RANGE: (f64, f64) = (8.0, 0.6);
    let record = examination.record();
    let values = record.values();
    let largest = values.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    let range = RANGE.0.max(2.0 * (2.0 * (values.len() as f64).ln()).sqrt() + RANGE.1);
    let band = range * examination.noise() + 1.5 * resolution + 1e-9 * largest;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let moves = |value: &f64| {
        (low, high) = (low.min(*value), high.max(*value));
        high - low > band
    };
    let begin = values.len() - values.iter().rev().position(moves)?;
    // A turning point may last half a period.
    let half_period = 0.5 * record.rate() / frequency;
    ((values.len() - begin) as f64 > half_period).then(|| record.start() + begin as f64 * record.interval())
}

/// The ranges of `0..count` between `holes`, which are in order.
pub(super) fn without(count: usize, holes: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
    let mut kept = Vec::new();
    let mut start = 0;
    for hole in holes {
        if hole.start > start {
            kept.push(start..hole.start);
        }
        start = hole.end;
    }
    if start < count {
        kept.push(start..count);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warning::Warning;

    /// A displacement whose amplitude falls on a line, with the zero of its sensor 5 mm off and in place.
    #[test]
    fn the_path_does_not_depend_on_the_zero_of_the_sensor() {
        let shares = |zero: f64| {
            let position = |t: f64| 0.02 * (1.0 - 0.4 * t) * (2.0 * PI * 3.0 * t).cos() + zero;
            let values = (0..2000).map(|i| position(1e-3 * f64::from(i))).collect();
            let record = Record::sampled(1000.0, values, Quantity::Displacement, "m").unwrap();
            Experiment::ring_down(&record, &Preparation::default()).unwrap().path_shares()
        };
        let (off, right) = (shares(0.005), shares(0.0));
        assert!(off.len() == right.len() && off.len() > 8, "{off:?}");
        for (off, right) in off.iter().zip(&right) {
            assert!((off.0 - right.0).abs() < 1e-3 && (off.1 - right.1).abs() < 1e-3, "{off:?}, {right:?}");
        }
        let mean: f64 = right.iter().map(|(time, share)| time * share).sum();
        // (∫ t (1 − 0.4 t) dt)/(∫ (1 − 0.4 t) dt) over 2 s, but for the ends.
        assert!((mean - 0.933 / 1.2).abs() < 0.06, "{mean} s");
    }

    #[test]
    fn holes_are_left_out() {
        assert_eq!(without(10, [2..4, 4..5, 9..10].into_iter()), [0..2, 5..9]);
        assert_eq!(without(3, std::iter::empty()), vec![0..3]);
        assert_eq!(without(3, std::iter::once(0..3)), Vec::<Range<usize>>::new());
    }

    /// The velocity of a mass of 10.391 kg on a spring of 1982 N/m, with friction of 0.25 under 14 N, released at 0 and
    /// 2 s.
    fn released(times: &[f64]) -> Record {
        let (angular, deadband) = (13.81, 1.766e-3);
        let velocity = |t: f64, amplitude: f64| {
            let half_swing = (t.max(0.0) * angular / PI).floor();
            let swing = amplitude - deadband * (1.0 + 2.0 * half_swing);
            if t > 0.0 && swing > 0.0 { -angular * swing * (angular * t).sin() } else { 0.0 }
        };
        let at = |t: f64| times.iter().map(|release| velocity(t - release, 0.0216)).sum();
        Record::sampled(1000.0, (0..4000).map(|i| at(f64::from(i) * 1e-3)).collect(), Quantity::Velocity, "m/s")
            .unwrap()
    }

    #[test]
    fn hum_changes_neither_swings_nor_release_and_stays_in_the_record() {
        let clean = released(&[0.3]);
        let expected = Experiment::ring_down(&clean, &Preparation::default()).unwrap();
        for (frequency, share) in [(50.0, 0.01), (50.0, 0.1), (60.0, 0.3), (100.0, 0.038)] {
            let hum = |t: f64| share * 0.27 * (2.0 * PI * frequency * t + 1.0).sin();
            let values = clean.times().zip(clean.values()).map(|(t, value)| value + hum(t)).collect();
            let record = Record::sampled(1000.0, values, Quantity::Velocity, "m/s").unwrap();
            let found = Experiment::ring_down(&record, &Preparation::default()).unwrap();
            let (found, summary) = (found.record(), found.summary());
            assert_eq!(summary.hum.len(), 1, "{frequency} Hz, {share}: {:?}", summary.hum);
            assert!((summary.hum[0].frequency - frequency).abs() < 0.01, "{frequency} Hz: {:?}", summary.hum);
            assert!(summary.half_swings.abs_diff(expected.summary().half_swings) <= 1, "{summary}");
            assert!((summary.frequency - 2.198).abs() < 0.03, "{summary}");
            assert!((summary.release.unwrap() - 0.3).abs() < 0.01, "{summary}");
            assert_eq!(found.values()[0], record.crop(found.start(), record.end()).unwrap().values()[0]);
        }
    }

    /// Held samples are used at the rate at which they were measured, and a warning says so.
    #[test]
    fn held_samples_are_used_once() {
        let at =
            |i: i32| (-0.004 * f64::from(i)).exp() * (0.1 * f64::from(i)).cos() + 1e-3 * (f64::from(i) * 77.7).sin();
        let values = (0..4000).map(|i| at(i / 5)).collect();
        let record = Record::sampled(1000.0, values, Quantity::Velocity, "m/s").unwrap();
        let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        assert!((decay.summary().rate - 200.0).abs() < 1e-9, "{}", decay.summary());
        assert!(decay.warnings().iter().any(|warning| matches!(warning, Warning::Upsampled { factor: 5, .. })));
    }

    /// A decay that somebody stops by hand is used up to there, and a warning says so; who gives an end has it.
    #[test]
    fn a_hand_ends_a_decay() {
        let held = |t: f64| if t < 4.0 { 1.0 } else { (-10.0 * (t - 4.0)).exp() };
        let at = |t: f64| held(t) * (-0.15 * t).exp() * (18.85 * t).cos();
        let values = (0..8000).map(|i| at(f64::from(i) * 1e-3)).collect();
        let record = Record::sampled(1000.0, values, Quantity::Velocity, "m/s").unwrap();
        let decay = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        assert!(
            (3.7..4.01).contains(&decay.summary().to) && decay.summary().interruption.is_some(),
            "{}",
            decay.summary()
        );
        assert!(decay.warnings().iter().any(|warning| matches!(warning, Warning::Interrupted { .. })));
        let asked = Experiment::ring_down(&record, &Preparation::default().to(5.0)).unwrap();
        assert!(
            (asked.summary().to - 5.0).abs() < 2e-3 && asked.summary().interruption.is_none(),
            "{}",
            asked.summary()
        );
    }

    /// A machine that is pulled slowly for two seconds and let go is used from its release on.
    #[test]
    fn a_slow_pull_is_no_vibration() {
        let free = released(&[2.0]);
        let pulled = |t: f64| if t < 2.0 { 0.02 * (1.1 * t).sin() + 2e-4 * (5.0 * t).cos() } else { 0.0 };
        let values = free.times().zip(free.values()).map(|(t, value)| value + pulled(t)).collect();
        let record = Record::sampled(1000.0, values, Quantity::Velocity, "m/s").unwrap();
        let experiment = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        let summary = experiment.summary();
        assert!(summary.release.is_some_and(|release| (release - 2.0).abs() < 0.02), "{summary}");
        assert!((2.0..2.2).contains(&summary.from), "{summary}");
    }

    #[test]
    fn only_the_first_of_two_releases_is_used() {
        let record = released(&[0.1, 2.0]);
        let first = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        let summary = first.summary();
        assert!(matches!(summary.further_releases[..], [time] if (time - 2.0).abs() < 0.02), "{summary:?}");
        assert!((1.5..2.0).contains(&summary.to), "{summary}");
        for preparation in [Preparation::default().to(1.9), Preparation::default().from(1.95)] {
            let one = Experiment::ring_down(&record, &preparation).unwrap();
            assert!(one.summary().further_releases.is_empty());
            assert_eq!((one.summary().second_mode, one.summary().period_change), (None, None));
        }
    }

    #[test]
    fn coarse_values_stay_at_a_step_and_the_last_swings_are_left_out() {
        const STEP: f64 = 0.02;
        let clean = released(&[0.3]);
        assert_eq!(Experiment::ring_down(&clean, &Preparation::default()).unwrap().stays(), []);
        let values = clean.values().iter().map(|value| (value / STEP).round() * STEP).collect();
        let record = Record::sampled(1000.0, values, Quantity::Velocity, "m/s").unwrap();
        let coarse = Experiment::ring_down(&record, &Preparation::default()).unwrap();
        assert!(coarse.summary().is_rounded());
        let kept: Vec<f64> =
            coarse.kept().iter().flat_map(|range| &coarse.record().values()[range.clone()]).copied().collect();
        let stays = coarse.stays();
        assert!(stays.len() > 20 && stays.len() < kept.len() / 2, "{} of {}", stays.len(), kept.len());
        assert_eq!((stays[0].start, stays[stays.len() - 1].end), (0, kept.len()));
        assert!(stays.windows(2).all(|pair| pair[0].end == pair[1].start));
        for stay in stays {
            let (low, high) = kept[stay]
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |range, value| (value.min(range.0), value.max(range.1)));
            assert!(high - low < 1.5 * STEP);
        }
        let (last, _) = coarse.peaks()[coarse.peaks().len() - 1];
        let end = coarse.kept().last().unwrap().end;
        assert!(coarse.record().start() + end as f64 * 1e-3 <= last + 1e-9);
    }

    fn file(name: &str, quantity: Quantity) -> Experiment {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../fmm-record/tests/data").join(name);
        let text = std::fs::read_to_string(path).unwrap();
        let values = text.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse().unwrap()).collect();
        let record = Record::sampled(1000.0, values, quantity, "1").unwrap();
        Experiment::ring_down(&record, &Preparation::default()).unwrap()
    }

    #[test]
    fn records_of_others_are_used_as_a_reader_would() {
        let humming = file("hum7.csv", Quantity::Velocity);
        let summary = humming.summary();
        assert_eq!(summary.hum.len(), 1);
        assert!((summary.frequency - 2.198).abs() < 0.02 && (4..=6).contains(&summary.half_swings), "{summary}");
        let twice = file("two_v.csv", Quantity::Velocity);
        assert!(twice.summary().to < 2.0 && twice.summary().further_releases.len() == 1, "{:?}", twice.summary());
        let pendulum = file("small_pendulum_1khz.csv", Quantity::Displacement);
        let summary = pendulum.summary();
        assert!(summary.period_change.is_some_and(|change| (-0.12..-0.04).contains(&change)), "{summary:?}");
        assert!(summary.hum.is_empty() && summary.further_releases.is_empty() && summary.second_mode.is_none());
    }
}
