//! A record made ready for identification.

use std::f64::consts::PI;
use std::ops::Range;

use fmm_model::{Bounds, ModelError, Restoring};
use fmm_record::{
    OffsetStep, Peak, Quantity, Record, Release, SecondMode, Swings, further_releases, hum, noise, period_change,
    quantisation_step, saturation, spikes, without_lines,
};

use crate::first_guess::{Dissipation, FirstGuess, Oscillation};
use crate::nuisance::Nuisance;
use crate::preparation::COARSE;
use crate::{IdentifyError, Machine, Offset, Preparation, RecordSummary};

/// A prepared ring-down: the part of a record in which a machine vibrates freely, and what was seen in it.
///
/// If the record begins at rest, it is used from the first peak after the release on (of a displacement, from the
/// first crossing), as whatever held the machine may act on for a while; otherwise from its beginning. If it is released or
/// pushed again, it is used until shortly before that. Spikes of
/// one to three samples are left out, and where the steps of a converter exceed the noise, what follows the last turning point. Nothing is smoothed and nothing is subtracted: smoothing would correlate the
/// noise, and the offset is a parameter. Swings, release, spikes and noise are looked for in the record less its hum.
#[derive(Debug, Clone, PartialEq)]
pub struct RingDown {
    record: Record,
    kept: Vec<Range<usize>>,
    guess: FirstGuess,
    peaks: Vec<(f64, f64)>,
    nuisances: Vec<Nuisance>,
    /// The shape of each of them at every sample.
    shapes: Vec<Vec<f64>>,
    summary: RecordSummary,
}

/// Fewest samples that can show two half swings.
const FEWEST_SAMPLES: usize = 16;
/// Fewest half swings that show a period.
const FEWEST_HALF_SWINGS: usize = 2;

impl RingDown {
    /// Prepares `record`.
    ///
    /// # Errors
    /// [`IdentifyError`] if the record is neither displacement nor velocity, too short, constant, or shows fewer
    /// than two half swings, or if the preparation leaves nothing of it.
    pub fn prepare(record: &Record, preparation: &Preparation) -> Result<Self, IdentifyError> {
        let quantity = record.quantity();
        if !matches!(quantity, Quantity::Displacement | Quantity::Velocity) {
            return Err(IdentifyError::Quantity { quantity });
        }
        let gain_uncertainty = ModelError::require_not_negative("gain uncertainty", preparation.gain_uncertainty, "")?;
        let (from, to) = (preparation.from.unwrap_or(record.start()), preparation.to.unwrap_or(record.end()));
        let record = record.crop(from, to)?;
        if record.len() < FEWEST_SAMPLES {
            return Err(IdentifyError::TooShort { samples: record.len(), needed: FEWEST_SAMPLES });
        }
        let first = record.values()[0];
        if record.values().iter().all(|value| *value == first) {
            return Err(IdentifyError::NoMotion { value: first, unit: record.unit().to_owned() });
        }
        // Hum must not be taken for the machine; what is fitted is the record as it was measured.
        let hum = hum(&record);
        let cleaned = without_lines(&record, &hum);
        // One motion is fitted, the first.
        let further = further_releases(&cleaned);
        let until = further.first().map_or(record.end(), |next| next.sound_until);
        let (record, cleaned) = (record.crop(record.start(), until)?, cleaned.crop(record.start(), until)?);
        let swings = Swings::of(&cleaned);
        let release = Release::of(&cleaned);
        let held_offset = match preparation.offset {
            Offset::Fitted => None,
            Offset::Rest => Some(release.ok_or(IdentifyError::NoRest)?.offset),
            Offset::Fixed(value) => Some(ModelError::require_finite("offset", value, "in the unit of the record")?),
        };
        let begin = release.map_or(record.start(), |release| beginning(&swings, release.rest_end, quantity));
        let record = record.crop(begin, record.end())?;
        let cleaned = cleaned.crop(begin, cleaned.end())?;

        let start = record.start();
        let after = |time: f64| time > start - record.interval();
        let peaks: Vec<Peak> = swings.peaks().iter().copied().filter(|peak| after(peak.time)).collect();
        let oscillation = Oscillation {
            extrema: peaks.iter().map(|peak| ((peak.time - start).max(0.0), peak.value)).collect(),
            frequency: swings.frequency(),
        };
        let (times, heights) = swings.turns(quantity);
        let begun = times.iter().take_while(|time| !after(**time)).count();
        let few = IdentifyError::TooFewHalfSwings { found: peaks.len(), needed: FEWEST_HALF_SWINGS };
        let guess = FirstGuess::of(&oscillation, quantity).ok_or(few)?;

        let spikes = spikes(&cleaned);
        let mut kept = without(record.len(), spikes.iter().map(|spike| spike.index..spike.index + spike.count));
        let resolution = quantisation_step(record.values());
        let noise = noise(cleaned.values());
        if resolution.is_some_and(|step| step > COARSE * noise) {
            // What swings within a step or two is rounded to another motion.
            let last = peaks.last().map_or(0.0, |peak| (peak.time - start) / record.interval());
            for range in &mut kept {
                range.end = range.end.min((last.max(0.0) as usize).max(range.start));
            }
            kept.retain(|range| !range.is_empty());
        }
        let amplitudes = guess.amplitudes();
        let summary = RecordSummary {
            from: record.start(),
            to: record.end(),
            samples: kept.iter().map(Range::len).sum(),
            rate: record.rate(),
            quantity,
            unit: record.unit().to_owned(),
            held_offset,
            gain_uncertainty,
            release: release.map(|release| release.rest_end),
            half_swings: peaks.len(),
            amplitudes: (amplitudes[0], amplitudes[amplitudes.len() - 1]),
            frequency: guess.frequency(),
            noise,
            resolution,
            rest_from: rest_from(&cleaned, resolution.unwrap_or(0.0), guess.frequency()),
            spikes: spikes.iter().map(|spike| spike.count).sum(),
            saturation: saturation(record.values()),
            offset_step: OffsetStep::of(&cleaned),
            period_change: period_change(&times[begun..], &heights[begun..]),
            hum,
            further_releases: further.iter().map(|release| release.time).collect(),
            second_mode: SecondMode::of(&cleaned),
        };
        let peaks = peaks.iter().map(|peak| (peak.time, peak.value)).collect();
        let nuisances = Nuisance::of_hum(&summary.hum).collect();
        Ok(Self { record, kept, guess, peaks, nuisances: Vec::new(), shapes: Vec::new(), summary }.beside(nuisances))
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

    /// The disturbances that are fitted beside the motion.
    pub(crate) fn nuisances(&self) -> &[Nuisance] {
        &self.nuisances
    }

    /// The shape of each of them (1) at every sample.
    pub(crate) fn shapes(&self) -> &[Vec<f64>] {
        &self.shapes
    }

    /// The part of the record that is used, as it was measured.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// What the record is and what was seen in it.
    pub fn summary(&self) -> &RecordSummary {
        &self.summary
    }

    /// Time (s) and value of the turning points, maxima and minima by turns.
    pub fn peaks(&self) -> &[(f64, f64)] {
        &self.peaks
    }

    /// Ranges of samples that are fitted; what lies between them is left out.
    pub fn kept(&self) -> &[Range<usize>] {
        &self.kept
    }

    /// Samples in a row among those that are kept over which the values stay within one step of the converter; none if the steps do
    /// not exceed the noise.
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

    /// The same ring-down up to its last peak; none if that leaves nothing out or too little.
    ///
    /// In the displacement a stop one swing too early or too late shows as a jump, over which no gradient leads. Without
    /// the end of the motion there is no such jump.
    pub(crate) fn up_to_last_peak(&self) -> Option<Self> {
        let (last, _) = *self.peaks.last()?;
        self.up_to(last)
    }

    /// The first `share` of the ring-down (1), as much of it as can be fitted.
    pub(crate) fn beginning(&self, share: f64) -> Self {
        let end = self.record.start() + share * self.record.duration();
        // Three periods tell a frequency.
        let end = end.max(self.record.start() + 3.0 / self.guess.frequency());
        self.up_to(end).unwrap_or_else(|| self.clone())
    }

    /// The part up to `end` (s); none if that leaves nothing out or too little.
    fn up_to(&self, end: f64) -> Option<Self> {
        let record = self.record.crop(self.record.start(), end).ok()?;
        let count = record.len();
        if count < FEWEST_SAMPLES || count == self.record.len() {
            return None;
        }
        let kept: Vec<Range<usize>> = self.kept.iter().map(|range| range.start..range.end.min(count)).collect();
        let kept: Vec<Range<usize>> = kept.into_iter().filter(|range| !range.is_empty()).collect();
        let summary =
            RecordSummary { to: record.end(), samples: kept.iter().map(Range::len).sum(), ..self.summary.clone() };
        Some(Self { record, kept, summary, ..self.clone() })
    }

    /// Every `stride`-th sample, for a search that need not see them all.
    pub(crate) fn thinned(&self, stride: usize) -> Option<Self> {
        let values: Vec<f64> = self.record.values().iter().copied().step_by(stride).collect();
        let interval = self.record.interval() * stride as f64;
        let record =
            Record::new(self.record.start(), interval, values, self.record.quantity(), self.record.unit()).ok()?;
        let thin = |range: &Range<usize>| range.start.div_ceil(stride)..range.end.div_ceil(stride);
        let kept: Vec<Range<usize>> = self.kept.iter().map(thin).filter(|range| !range.is_empty()).collect();
        let summary = RecordSummary { samples: kept.iter().map(Range::len).sum(), ..self.summary.clone() };
        let shapes = self.shapes.iter().map(|shape| shape.iter().copied().step_by(stride).collect()).collect();
        Some(Self { record, kept, shapes, summary, ..self.clone() })
    }

    /// Largest displacement and velocity of the motion, in the units of the record and its integral or derivative.
    pub(crate) fn scales(&self) -> (f64, f64) {
        let (largest, angular) = (self.summary.amplitudes.0, 2.0 * PI * self.guess.frequency());
        match self.record.quantity() {
            Quantity::Displacement => (largest, angular * largest),
            _ => (largest / angular, largest),
        }
    }

    /// f₀ (Hz) of small vibrations of an undamped `machine`, given what its contact loses: a pendulum swings more slowly the
    /// farther it swings, by φ²/16.
    pub(crate) fn natural_frequency(&self, dissipation: Dissipation, machine: &Machine) -> f64 {
        let frequency = self.guess.natural_frequency(dissipation);
        let Restoring::Sine { length } = machine.restoring() else { return frequency };
        let amplitudes = self.guess.amplitudes();
        let square = amplitudes.iter().map(|a| a * a).sum::<f64>() / amplitudes.len().max(1) as f64;
        let unit = self.scales().0 / amplitudes[0] / length;
        frequency * (1.0 + square * unit * unit / 16.0)
    }

    pub(crate) fn guess(&self) -> &FirstGuess {
        &self.guess
    }

    /// The offset, if it is held.
    pub(crate) fn fixed_offset(&self) -> Option<f64> {
        self.summary.held_offset
    }

    /// Two octaves either way of what the crossings show: wide enough for any law, and no fit that leaves it
    /// describes this record.
    pub(crate) fn frequency_bounds(&self) -> Bounds {
        let frequency = self.guess.frequency();
        Bounds::new(0.25 * frequency, 4.0 * frequency).unwrap_or(Bounds::POSITIVE)
    }
}

/// Where to begin in a record that is released at `rest_end`.
fn beginning(swings: &Swings, rest_end: f64, quantity: Quantity) -> f64 {
    let mut candidates: Box<dyn Iterator<Item = f64>> = if quantity == Quantity::Displacement {
        Box::new(swings.crossings().iter().map(|crossing| crossing.time))
    } else {
        Box::new(swings.peaks().iter().map(|peak| peak.time))
    };
    candidates.find(|time| *time > rest_end).unwrap_or(rest_end)
}

/// When `record` comes to rest (s): from there on its values stay within their noise and a `resolution` for at least half a period of
/// the motion; none if they do not.
fn rest_from(record: &Record, resolution: f64, frequency: f64) -> Option<f64> {
    /// The range of a thousand normal values, in standard deviations, with some to spare.
    const RANGE: f64 = 8.0;
    let values = record.values();
    let largest = values.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    let band = RANGE * noise(values) + 1.5 * resolution + 1e-9 * largest;
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
fn without(count: usize, holes: impl Iterator<Item = Range<usize>>) -> Vec<Range<usize>> {
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

    #[test]
    fn holes_are_left_out() {
        assert_eq!(without(10, [2..4, 4..5, 9..10].into_iter()), [0..2, 5..9]);
        assert_eq!(without(3, std::iter::empty()), vec![0..3]);
        assert_eq!(without(3, std::iter::once(0..3)), Vec::<Range<usize>>::new());
    }

    /// The velocity of a mass of 10.391 kg on a spring of 1982 N/m, with friction of 0.25 under 14 N, released at 0 and 2 s.
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
        let expected = RingDown::prepare(&clean, &Preparation::default()).unwrap();
        for (frequency, share) in [(50.0, 0.01), (50.0, 0.1), (60.0, 0.3), (100.0, 0.038)] {
            let hum = |t: f64| share * 0.27 * (2.0 * PI * frequency * t + 1.0).sin();
            let values = clean.times().zip(clean.values()).map(|(t, value)| value + hum(t)).collect();
            let record = Record::sampled(1000.0, values, Quantity::Velocity, "m/s").unwrap();
            let found = RingDown::prepare(&record, &Preparation::default()).unwrap();
            let (found, summary) = (found.record(), found.summary());
            assert_eq!(summary.hum.len(), 1, "{frequency} Hz, {share}: {:?}", summary.hum);
            assert!((summary.hum[0].frequency - frequency).abs() < 0.01, "{frequency} Hz: {:?}", summary.hum);
            assert!(summary.half_swings.abs_diff(expected.summary().half_swings) <= 1, "{summary}");
            assert!((summary.frequency - 2.198).abs() < 0.03, "{summary}");
            assert!((summary.release.unwrap() - 0.3).abs() < 0.01, "{summary}");
            assert_eq!(found.values()[0], record.crop(found.start(), record.end()).unwrap().values()[0]);
        }
    }

    #[test]
    fn only_the_first_of_two_releases_is_used() {
        let record = released(&[0.1, 2.0]);
        let first = RingDown::prepare(&record, &Preparation::default()).unwrap();
        let summary = first.summary();
        assert!(matches!(summary.further_releases[..], [time] if (time - 2.0).abs() < 0.02), "{summary:?}");
        assert!((1.5..2.0).contains(&summary.to), "{summary}");
        for preparation in [Preparation::default().to(1.9), Preparation::default().from(1.95)] {
            let one = RingDown::prepare(&record, &preparation).unwrap();
            assert_eq!(one.summary().further_releases, []);
            assert_eq!((one.summary().second_mode, one.summary().period_change), (None, None));
        }
    }

    #[test]
    fn coarse_values_stay_at_a_step_and_the_last_swings_are_left_out() {
        const STEP: f64 = 0.02;
        let clean = released(&[0.3]);
        assert_eq!(RingDown::prepare(&clean, &Preparation::default()).unwrap().stays(), []);
        let values = clean.values().iter().map(|value| (value / STEP).round() * STEP).collect();
        let record = Record::sampled(1000.0, values, Quantity::Velocity, "m/s").unwrap();
        let coarse = RingDown::prepare(&record, &Preparation::default()).unwrap();
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

    fn file(name: &str, quantity: Quantity) -> RingDown {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../fmm-record/tests/data").join(name);
        let text = std::fs::read_to_string(path).unwrap();
        let values = text.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse().unwrap()).collect();
        let record = Record::sampled(1000.0, values, quantity, "1").unwrap();
        RingDown::prepare(&record, &Preparation::default()).unwrap()
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
