//! The times of zero velocity that bound the half swings of a ring-down.

use std::ops::Range;

use fmm_record::{Quantity, Record, Swings};

use crate::error::IdentifyError;
use crate::experiment::Experiment;

/// Shortest piece of a half swing at an end of the record that is worth having, in half swings.
const SHORTEST: f64 = 0.25;

/// Times (s) between which the velocity keeps its sign, on the time axis of the record.
///
/// They are the crossings of a velocity and the peaks of a displacement. The first interval may begin within a half
/// swing, at the first sample. The last half swing of a velocity ends half a period after it began, as every half
/// swing on a linear spring does, dry friction or not.
pub(crate) fn reversals(decay: &Experiment) -> Vec<f64> {
    let record = decay.record();
    let is_displacement = record.quantity() == Quantity::Displacement;
    let mut times: Vec<f64> = if is_displacement {
        decay.peaks().iter().map(|(time, _)| *time).collect()
    } else {
        Swings::of(record).crossings().iter().map(|crossing| crossing.time).collect()
    };
    times.retain(|time| (record.start()..=record.end()).contains(time));
    let [first, second, ..] = times[..] else { return times };
    let (before, last) = (times[times.len() - 2], times[times.len() - 1]);
    let begin = record.start().max(first - (second - first));
    let end = record.end().min(last + (last - before));
    if first - begin > SHORTEST * (second - first) {
        times.insert(0, begin);
    }
    if !is_displacement && end - last > SHORTEST * (last - before) {
        times.push(end);
    }
    times
}

/// Refuses times that do not increase or lie outside of the record.
pub(crate) fn check_reversals(record: &Record, times: &[f64]) -> Result<(), IdentifyError> {
    let (start, end) = (record.start(), record.end());
    let rounding = 1e-6 * record.interval();
    let mut previous = f64::NEG_INFINITY;
    for (index, &time) in times.iter().enumerate() {
        if !(time > previous && time >= start - rounding && time <= end + rounding) {
            let what = format!(
                "times of zero velocity must increase and lie within {start} s and {end} s, but number {index} is {time} s"
            );
            return Err(IdentifyError::OutOfRange { what, value: time });
        }
        previous = time;
    }
    Ok(())
}

/// The values of a ring-down with straight lines over the samples that are left out.
pub(crate) fn bridged(decay: &Experiment) -> Vec<f64> {
    let mut values = decay.record().values().to_vec();
    let ends = |kept: &Range<usize>| (kept.start, kept.end - 1);
    for pair in decay.kept().windows(2) {
        let ((_, from), (to, _)) = (ends(&pair[0]), ends(&pair[1]));
        let (first, step) = (values[from], (values[to] - values[from]) / (to - from) as f64);
        for (k, value) in values[from + 1..to].iter_mut().enumerate() {
            *value = first + step * (k + 1) as f64;
        }
    }
    values
}
