//! The sampling rate by scalars beside the data.

use crate::error::RecordError;
use crate::sampling::Sampling;
use crate::units::word::is_in;

/// Names of scalars that hold a rate (Hz), plain.
const RATES: &str = "\
    fs rate actualrate samplerate samplingrate samplefrequency samplingfrequency fsample fsampling srate sfreq \
    scanrate datarate outputdatarate outputrate storagerate odr measuringrate acquisitionrate messrate \
    abtastrate abtastfrequenz framerate fps";

/// Names of scalars that hold an interval (s), plain.
const INTERVALS: &str = "\
    dt ts deltat deltax increment tinterval abtastintervall abtastzeit xincrement xinc xincr tinc tsample \
    sampletime samplingtime sampleinterval samplinginterval sampleperiod samplingperiod timeinterval timestep \
    timeincrement hresolution";

/// Names of scalars that tell of how many samples one was kept, plain.
const KEPT: &str = "decimation decimationfactor downsampling downsample downsamplingfactor";

/// A name in lower case, without what parts its words.
fn plain(name: &str) -> String {
    name.replace(['_', ' ', '-'], "").to_lowercase()
}

/// True for the name of a scalar that states a rate or an interval.
#[cfg(feature = "hdf5")]
pub(crate) fn is_rate(name: &str) -> bool {
    let plain = plain(name);
    is_in(RATES, &plain) || is_in(INTERVALS, &plain)
}

/// Largest difference of two statements of the rate, relative.
const AGREEMENT: f64 = 1e-3;

/// Sampling rate by scalars with their names (Hz); `None` if none of them states a rate.
pub(crate) fn stated<'a>(
    scalars: impl Iterator<Item = (&'a str, f64)>,
) -> Result<Option<(f64, Sampling)>, RecordError> {
    let mut found: Option<(f64, Sampling, &str)> = None;
    let mut kept = None;
    for (name, value) in scalars {
        // A field is called as its structure is, with its own name behind a point.
        let own = name.rsplit('.').next().unwrap_or(name);
        let plain = plain(own);
        let is_interval = is_in(INTERVALS, &plain);
        if is_in(KEPT, &plain) && value != 1.0 {
            kept = Some((name, value));
        }
        if !is_interval && !is_in(RATES, &plain) {
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
    if let (Some((rate, _, rated)), Some((name, value))) = (&found, kept) {
        let what = format!(
            "\"{rated}\" says {rate} Hz, and \"{name}\" says {value}, by which the samples may or may not be fewer; \
             give the rate"
        );
        return Err(RecordError::time(None, what));
    }
    Ok(found.map(|(rate, sampling, _)| (rate, sampling)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_that_leave_the_rate_open_are_refused() {
        let of = |stated: &[(&'static str, f64)]| stated_rate(stated).map(|found| found.map(|(rate, _)| rate));
        assert_eq!(of(&[("n", 3.0), ("Sample Rate", 500.0), ("Delta-X", 0.002), ("Decimation", 1.0)]), Ok(Some(500.0)));
        assert_eq!(of(&[("Decimation", 2.0)]), Ok(None));
        for second in [("Output data rate", 250.0), ("Decimation", 2.0)] {
            let error = of(&[("Sample Rate", 500.0), second]).unwrap_err();
            assert!(error.contains(second.0) && error.contains("give the rate"), "{error}");
        }
    }

    fn stated_rate(scalars: &[(&'static str, f64)]) -> Result<Option<(f64, Sampling)>, String> {
        stated(scalars.iter().copied()).map_err(|error| error.to_string())
    }
}
