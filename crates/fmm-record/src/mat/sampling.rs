//! The sampling rate, where a variable of the file tells it.

use super::{MatError, MatFile};
use crate::Sampling;

/// Names of variables that hold a rate (Hz), in lower case and without underscores.
const RATES: [&str; 9] = [
    "fs",
    "rate",
    "actualrate",
    "samplerate",
    "samplingrate",
    "samplefrequency",
    "samplingfrequency",
    "fsample",
    "fsampling",
];

/// Names of variables that hold an interval (s), in lower case and without underscores.
const INTERVALS: [&str; 8] =
    ["dt", "ts", "deltat", "tsample", "sampletime", "samplingtime", "sampleinterval", "samplinginterval"];

/// How far two statements of the rate may differ, relative.
const AGREEMENT: f64 = 1e-3;

/// What the scalars of the file say about the rate; none if they say nothing.
pub(super) fn stated(file: &MatFile) -> Result<Option<(f64, Sampling)>, MatError> {
    let mut found: Option<(f64, Sampling, &str)> = None;
    for array in file.arrays() {
        let name = array.name();
        let plain = name.replace('_', "").to_lowercase();
        let is_interval = INTERVALS.contains(&&plain[..]);
        let Some(value) = array.scalar().filter(|_| is_interval || RATES.contains(&&plain[..])) else { continue };
        let (rate, sampling) = if is_interval {
            (value.recip(), Sampling::IntervalVariable { name: name.into(), interval: value })
        } else {
            (value, Sampling::RateVariable { name: name.into(), rate: value })
        };
        match &found {
            Some((first_rate, _, first)) if (rate - first_rate).abs() > AGREEMENT * first_rate.abs() => {
                return Err(MatError::ConflictingRates {
                    first: (*first).into(),
                    first_rate: *first_rate,
                    second: name.into(),
                    second_rate: rate,
                });
            }
            Some(_) => {}
            None => found = Some((rate, sampling, name)),
        }
    }
    Ok(found.map(|(rate, sampling, _)| (rate, sampling)))
}
