//! The sampling rate, where a scalar beside the data tells it.

use crate::{RecordError, Sampling};

/// Names of scalars that hold a rate (Hz), in lower case and without underscores.
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

/// Names of scalars that hold an interval (s), in lower case and without underscores.
const INTERVALS: [&str; 10] = [
    "dt",
    "ts",
    "deltat",
    "deltax",
    "xincrement",
    "tsample",
    "sampletime",
    "samplingtime",
    "sampleinterval",
    "samplinginterval",
];

/// Largest difference of two statements of the rate, relative.
const AGREEMENT: f64 = 1e-3;

/// Sampling rate by scalars with their names (Hz); `None` if none of them states a rate.
pub(crate) fn stated<'a>(
    scalars: impl Iterator<Item = (&'a str, f64)>,
) -> Result<Option<(f64, Sampling)>, RecordError> {
    let mut found: Option<(f64, Sampling, &str)> = None;
    for (name, value) in scalars {
        // A field is called as its structure is, with its own name behind a point.
        let own = name.rsplit('.').next().unwrap_or(name);
        let plain = own.replace(['_', ' '], "").to_lowercase();
        let is_interval = INTERVALS.contains(&&plain[..]);
        if !is_interval && !RATES.contains(&&plain[..]) {
            continue;
        }
        let (rate, sampling) = if is_interval {
            (value.recip(), Sampling::IntervalVariable { name: name.into(), interval: value })
        } else {
            (value, Sampling::RateVariable { name: name.into(), rate: value })
        };
        match &found {
            Some((first_rate, _, first)) if (rate - first_rate).abs() > AGREEMENT * first_rate.abs() => {
                let what = format!("\"{first}\" says {first_rate} Hz, but \"{name}\" says {rate} Hz; give the rate");
                return Err(RecordError::time(None, what));
            }
            Some(_) => {}
            None => found = Some((rate, sampling, name)),
        }
    }
    Ok(found.map(|(rate, sampling, _)| (rate, sampling)))
}
