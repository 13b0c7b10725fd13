//! Single samples that do not belong to the motion: spikes and drop-outs.

use std::ops::Range;

use crate::examination::Examination;
use crate::numerics::{quantile, range};
use crate::record::Record;

/// Spike or drop-out: up to three samples in a row that stand off the motion around them.
///
/// A sample is off if it differs from the median of the seven samples around it by more than eight standard
/// deviations of the noise, three steps of the converter, 0.1 % of the record's range, and four times the difference
/// that all but one sample in 200 have. The last limit passes a fast motion or its sharp onset. The first and last
/// three samples are not judged. A pulse of up to three samples in a force record is a spike in this sense.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Spike {
    /// Time of its first sample (s).
    pub time: f64,
    /// Index of its first sample.
    pub index: usize,
    /// Number of its samples, one to three.
    pub count: usize,
    /// Largest distance of its samples from their neighbours, in the unit of the record; negative below.
    pub height: f64,
}

/// Samples to either side in the running median; one more than half of the window survives three bad samples.
const SIDE: usize = 3;
/// Longest spike (samples). Anything longer may be motion.
const LONGEST: usize = SIDE;

/// Spikes of a record.
pub(crate) fn spikes(examination: &Examination) -> Vec<Spike> {
    let record = examination.record();
    let values = record.values();
    runs(values, examination.noise(), examination.step())
        .into_iter()
        .map(|run| {
            let height = run
                .clone()
                .map(|i| values[i] - between(values, &run, i))
                .fold(0.0f64, |most, height| if height.abs() > most.abs() { height } else { most });
            Spike { time: record.time(run.start), index: run.start, count: run.len(), height }
        })
        .collect()
}

/// The record of an examination with its spikes bridged by straight lines.
pub(crate) fn without_spikes(examination: &Examination) -> Record {
    let record = examination.record();
    let mut values = record.values().to_vec();
    for Spike { index, count, .. } in examination.spikes() {
        let run = *index..index + count;
        for i in run.clone() {
            values[i] = between(record.values(), &run, i);
        }
    }
    record.derived(record.start(), values)
}

/// The straight line across a run of samples, at sample `i`. The run touches neither end of the values.
fn between(values: &[f64], run: &Range<usize>, i: usize) -> f64 {
    let (before, after) = (run.start - 1, run.end);
    let part = (i - before) as f64 / (after - before) as f64;
    values[before] + part * (values[after] - values[before])
}

/// Runs of samples that are off, in values of this noise and step of the converter.
fn runs(values: &[f64], noise: f64, step: f64) -> Vec<Range<usize>> {
    const MOST: usize = 1 << 17;
    const COMMON: f64 = 0.995;
    const VISIBLE: f64 = 1e-3;
    if values.len() < 4 * (2 * SIDE + 1) {
        return Vec::new();
    }
    let judged = SIDE..values.len() - SIDE;
    let off = |i: usize| (values[i] - median_around(values, i)).abs();
    let mut some: Vec<f64> = judged.clone().step_by(judged.len().div_ceil(MOST)).map(off).collect();
    let (low, high) = range(values);
    let limit = (8.0 * noise).max(3.0 * step).max(4.0 * quantile(&mut some, COMMON)).max(VISIBLE * (high - low));
    let mut suspects: Vec<Range<usize>> = Vec::new();
    for i in judged.filter(|i| off(*i) > limit) {
        match suspects.last_mut() {
            Some(run) if i <= run.end + 1 => run.end = i + 1,
            _ => suspects.push(i..i + 1),
        }
    }
    suspects.into_iter().filter_map(|suspect| culprit(values, suspect, limit)).collect()
}

/// The shortest run within `suspect` which, bridged, leaves nothing that is off. On a slope a spike shifts the
/// medians of its neighbours, which become suspects too. `None` if the longest spike does not explain the suspects.
fn culprit(values: &[f64], suspect: Range<usize>, limit: f64) -> Option<Range<usize>> {
    if suspect.len() > LONGEST + 2 * SIDE {
        return None;
    }
    let (from, to) = (suspect.start.saturating_sub(2 * SIDE), (suspect.end + 2 * SIDE).min(values.len()));
    let explains = |run: &Range<usize>| {
        let mut bridged = values[from..to].to_vec();
        for i in run.clone() {
            bridged[i - from] = between(values, run, i);
        }
        (suspect.start - from..suspect.end - from).all(|i| (bridged[i] - median_around(&bridged, i)).abs() <= limit)
    };
    // A spike jumps away and jumps back, much farther than the samples beside it move. A motion that stops or sets in
    // does one of the two, and a smooth peak neither.
    let returns = |run: &Range<usize>| {
        let step = |from: usize, to: usize| values[to] - values[from];
        let (away, back) = (step(run.start - 1, run.start), step(run.end, run.end - 1));
        let beside = step(run.start - 2, run.start - 1).abs().max(step(run.end + 1, run.end).abs());
        away * back > 0.0 && away.abs().min(back.abs()) > (0.5 * limit).max(2.0 * beside)
    };
    (1..=LONGEST.min(suspect.len())).find_map(|length| {
        let runs = (suspect.start..=suspect.end - length).map(|start| start..start + length);
        runs.filter(returns).find(explains)
    })
}

/// Median of the seven samples around `i`, which must not be one of the first or last three.
fn median_around(values: &[f64], i: usize) -> f64 {
    let mut window = [0.0; 2 * SIDE + 1];
    window.copy_from_slice(&values[i - SIDE..=i + SIDE]);
    window.sort_unstable_by(f64::total_cmp);
    window[SIDE]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::synthetic::{CoulombDecay, pendulum, pendulum_velocity, sampled, wheel};
    use crate::units::Quantity;

    fn spikes(record: &Record) -> Vec<Spike> {
        Examination::of(record).spikes().to_vec()
    }

    #[test]
    fn a_stop_an_onset_or_a_peak_is_no_spike() {
        // Eight samples of a velocity that falls at a constant rate, then rest; and the reverse.
        let stop: Vec<f64> = (0..60).map(|i| if i < 8 { 8.0 - f64::from(i) } else { 0.0 }).collect();
        let onset: Vec<f64> = stop.iter().rev().copied().collect();
        // A smooth peak in a record that is at rest nearly always.
        let peak: Vec<f64> = (0..5000).map(|i| if i < 30 { (f64::from(i) * 0.1).sin() } else { 0.0 }).collect();
        for values in [stop, onset, peak] {
            let record = Record::sampled(100.0, values, crate::units::Quantity::Velocity, "m/s").unwrap();
            assert_eq!(spikes(&record), []);
        }
    }

    #[test]
    fn measured_records_have_none() {
        #[cfg(feature = "mat")]
        assert_eq!(spikes(&crate::tests::synthetic::fork()), []);
        for record in [wheel(), pendulum()] {
            assert_eq!(spikes(&record), []);
        }
    }

    #[test]
    fn spikes_are_found_with_their_lengths_and_heights() {
        let decay = CoulombDecay { frequency: 2.2, amplitude: 10.0, deadband: 0.3, release: 0.5 };
        let clean = sampled(1000.0, 10.0, Quantity::Velocity, 0.1, |t| decay.state(t).1);
        assert_eq!(spikes(&clean), [], "the release and the stop are no spikes");
        let mut values = clean.values().to_vec();
        for (index, count, height) in [(777, 1, 5.0), (3000, 3, -20.0), (9000, 2, 3.0)] {
            for value in &mut values[index..index + count] {
                *value += height;
            }
        }
        let record = Record::sampled(1000.0, values, Quantity::Velocity, "mm/s").unwrap();
        let found: Vec<_> = spikes(&record).iter().map(|s| (s.index, s.count, (s.height / 5.0).round())).collect();
        assert_eq!(found, [(777, 1, 1.0), (3000, 3, -4.0), (9000, 2, 1.0)]);
    }

    #[test]
    fn coarse_sampling_and_short_records_give_no_false_alarm() {
        let coarse = sampled(10.0, 100.0, Quantity::Velocity, 0.0, |t| (7.0 * t).sin());
        assert_eq!(spikes(&coarse), []);
        let short = sampled(10.0, 2.0, Quantity::Velocity, 0.0, |t| if t == 1.0 { 1.0 } else { 0.0 });
        assert_eq!(spikes(&short), []);
        assert!(spikes(&pendulum_velocity()).len() < 10);
    }
}
