//! Single samples that do not belong to the motion: spikes and drop-outs.

use std::ops::Range;

use crate::examination::Examination;
use crate::numerics::{quantile, range};
use crate::record::Record;
use crate::units::Quantity;

/// Spike or drop-out: up to three samples in a row that stand off the motion around them.
///
/// A sample is off if it differs from the median of the seven samples around it by more than eight standard deviations
/// of the noise, three steps of the converter, 0.1 % of the record's range, and four times the difference that all but
/// one sample in 200 have. The last limit passes a fast motion or its sharp onset. The first or last samples, up to
/// three, are off if they lie as far from the straight line through the two samples beside them, and jump there by four
/// times as much as the values move beside; those of an acceleration or a force, which may jump, are not judged. A
/// pulse of up to three samples in a force record is a spike in this sense.
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
    let mut values = record.values().to_vec();
    let mut found: Vec<Spike> = Vec::new();
    // Large spikes, and the medians that they shift, hide smaller ones.
    let is_known = |found: &[Spike], run: &Range<usize>| {
        found.iter().any(|spike| spike.index < run.end && run.start < spike.index + spike.count)
    };
    loop {
        let limit = limit(&values, examination.noise(), examination.step());
        let [begin, end] = match record.quantity() {
            Quantity::Displacement | Quantity::Velocity => ends(&values, limit),
            _ => [0..0, values.len()..values.len()],
        };
        let inner = runs(&values[begin.end..end.start], limit).into_iter();
        let inner = inner.map(|run| run.start + begin.end..run.end + begin.end);
        let all = [begin.clone()].into_iter().chain(inner).chain([end]);
        let runs: Vec<_> = all.filter(|run| !run.is_empty() && !is_known(&found, run)).collect();
        if runs.is_empty() {
            found.sort_unstable_by_key(|spike| spike.index);
            return found;
        }
        for run in runs {
            let bridge: Vec<f64> = run.clone().map(|i| between(&values, &run, i)).collect();
            let height = |(i, bridge): (usize, &f64)| values[i] - bridge;
            let larger = |most: f64, height: f64| if height.abs() > most.abs() { height } else { most };
            let height = run.clone().zip(&bridge).map(height).fold(0.0, larger);
            found.push(Spike { time: record.time(run.start), index: run.start, count: run.len(), height });
            values[run].copy_from_slice(&bridge);
        }
    }
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

/// The straight line across a run of samples, at sample `i`; at an end of the values, the line through the two samples
/// beside the run.
fn between(values: &[f64], run: &Range<usize>, i: usize) -> f64 {
    let (before, after) = if run.start == 0 {
        (run.end, run.end + 1)
    } else if run.end == values.len() {
        (run.start - 2, run.start - 1)
    } else {
        (run.start - 1, run.end)
    };
    let part = (i as f64 - before as f64) / (after - before) as f64;
    values[before] + part * (values[after] - values[before])
}

/// Distance from the median around it beyond which a sample is off, in values of this noise and step of the converter;
/// infinite for too few values.
fn limit(values: &[f64], noise: f64, step: f64) -> f64 {
    const MOST: usize = 1 << 17;
    const COMMON: f64 = 0.995;
    const VISIBLE: f64 = 1e-3;
    if values.len() < 4 * (2 * SIDE + 1) {
        return f64::INFINITY;
    }
    let judged = SIDE..values.len() - SIDE;
    let mut some: Vec<f64> = judged.clone().step_by(judged.len().div_ceil(MOST)).map(|i| off(values, i)).collect();
    let (low, high) = range(values);
    (8.0 * noise).max(3.0 * step).max(4.0 * quantile(&mut some, COMMON)).max(VISIBLE * (high - low))
}

/// Distance of sample `i` from the median around it.
fn off(values: &[f64], i: usize) -> f64 {
    (values[i] - median_around(values, i)).abs()
}

/// Samples at the beginning and at the end that are off.
fn ends(values: &[f64], limit: f64) -> [Range<usize>; 2] {
    let count = values.len();
    let begin = off_beginning(|i| values[i], limit);
    let end = off_beginning(|i| values[count - 1 - i], limit);
    [0..begin, count - end..count]
}

/// Number of samples at the beginning of the values `at`, up to the longest spike, that are off.
fn off_beginning(at: impl Fn(usize) -> f64, limit: f64) -> usize {
    /// Steps from sample to sample beside a jump (1). Origin: a motion that sets in, or turns, changes its steps by a
    /// factor of two or three.
    const JUMP: f64 = 4.0;
    if limit.is_infinite() {
        return 0;
    }
    let jumps = |first: &usize| {
        let first = *first;
        let step = |i: usize| (at(i + 1) - at(i)).abs();
        let beside = (first..first + LONGEST).map(step).fold(0.0, f64::max);
        let jump = at(first - 1) - (2.0 * at(first) - at(first + 1));
        jump.abs() > limit && step(first - 1) > JUMP * beside
    };
    (1..=LONGEST).rev().find(jumps).unwrap_or(0)
}

/// Runs of samples farther off than `limit`, but for the first and last three.
fn runs(values: &[f64], limit: f64) -> Vec<Range<usize>> {
    if limit.is_infinite() {
        return Vec::new();
    }
    let mut suspects: Vec<Range<usize>> = Vec::new();
    for i in (SIDE..values.len() - SIDE).filter(|i| off(values, *i) > limit) {
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
    // A spike jumps away and jumps back, much farther than the samples beside it move, or move off their straight
    // lines. A motion that stops or sets in does one of the two, and a smooth peak neither.
    let jumps = |away: f64, back: f64, beside: f64| {
        away * back > 0.0 && away.abs().min(back.abs()) > (0.5 * limit).max(2.0 * beside)
    };
    let step = |from: usize, to: usize| values[to] - values[from];
    let bend = |i: usize, towards: usize, next: usize| values[i] - 2.0 * values[towards] + values[next];
    let returns = |run: &Range<usize>| {
        let (first, last) = (run.start, run.end - 1);
        let before = if first > 2 { bend(first - 1, first - 2, first - 3).abs() } else { 0.0 };
        let after = if last + 3 < values.len() { bend(last + 1, last + 2, last + 3).abs() } else { 0.0 };
        let beside = step(first - 2, first - 1).abs().max(step(last + 2, last + 1).abs());
        jumps(step(first - 1, first), step(last + 1, last), beside)
            || jumps(bend(first, first - 1, first - 2), bend(last, last + 1, last + 2), before.max(after))
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

    /// Drop-outs on the steepest part of a motion, where a straight line and a median lead far off, and nonsense in the
    /// first and the last samples.
    #[test]
    fn drop_outs_on_a_slope_and_nonsense_at_the_ends_are_found() {
        let decay = CoulombDecay { frequency: 2.2, amplitude: 10.0, deadband: 0.13, release: 0.0 };
        let mut values: Vec<f64> = (0..1200).map(|i| decay.state(f64::from(i) * 4e-3).1).collect();
        let clean = values.clone();
        let crossing = (200..400).find(|i| clean[*i] * clean[i + 1] <= 0.0).unwrap();
        values[crossing - 5..crossing - 3].fill(0.0);
        values[600] = 0.0;
        values[..3].copy_from_slice(&[30.0, 55.0, 41.0]);
        values[1199] = -80.0;
        let record = Record::sampled(250.0, values, Quantity::Velocity, "mm/s").unwrap();
        let found: Vec<_> = spikes(&record).iter().map(|spike| (spike.index, spike.count)).collect();
        assert_eq!(found, [(0, 3), (crossing - 5, 2), (600, 1), (1199, 1)]);
        let bridged = without_spikes(&Examination::of(&record));
        for (bridged, clean) in bridged.values().iter().zip(&clean) {
            assert!((bridged - clean).abs() < 1.0, "{bridged} for {clean}");
        }
    }

    /// Two spikes with two samples between them.
    #[test]
    fn spikes_next_to_each_other_are_found() {
        let mut values: Vec<f64> = (0..1000).map(|i| (f64::from(i) * 0.02).sin()).collect();
        values[400..403].iter_mut().for_each(|value| *value -= 0.8);
        values[405] += 0.8;
        let record = Record::sampled(1000.0, values, Quantity::Velocity, "m/s").unwrap();
        let found: Vec<_> = spikes(&record).iter().map(|spike| (spike.index, spike.count)).collect();
        assert_eq!(found, [(400, 3), (405, 1)]);
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
