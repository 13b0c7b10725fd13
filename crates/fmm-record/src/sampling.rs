//! Sampling of a record: the uniform grid behind its time stamps, and the source of its rate.

use fmm_model::Rounded;

use crate::error::RecordError;
use crate::numerics::mean;

/// Largest distance of a time stamp from the uniform grid, over the interval (1).
const JITTER: f64 = 0.01;

/// Largest relative distance of a rate from a whole number of hertz to which it is rounded (1).
const RATE_ROUNDING: f64 = 1e-5;

/// Start and interval (s) of the uniform grid on which `times` (s) lie, as [`Record::from_times`](crate::Record)
/// defines it.
pub(crate) fn uniform_grid(times: &[f64]) -> Result<(f64, f64), RecordError> {
    let (Some(&start), Some(&end), count @ 2..) = (times.first(), times.last(), times.len()) else {
        let count = times.len();
        let what = format!("{count} time stamps do not give a sampling interval; at least 2 are needed");
        return Err(RecordError::time(None, what));
    };
    if let Some((index, &time)) = times.iter().enumerate().find(|(_, time)| !time.is_finite()) {
        return Err(RecordError::time(Some(index), format!("time stamp {index} is {time} s; it must be finite")));
    }
    if times.windows(2).any(|pair| pair[1] <= pair[0]) {
        return Err(odd_stamp(times, 0.0).unwrap_or_else(|| RecordError::interval(0.0)));
    }
    let interval = (end - start) / (count - 1) as f64;
    if !(interval > 0.0 && interval.is_finite()) {
        return Err(RecordError::interval(interval));
    }
    let rounding = visible_rounding(times, interval);
    let tolerance = JITTER * interval + rounding;
    let mut previous = start;
    for (index, &time) in times.iter().enumerate() {
        let expected = start + interval * index as f64;
        let deviation = time - expected;
        if deviation.abs() > tolerance || time - previous > 1.5 * interval + rounding {
            // One gap bends the grid, which all stamps before it then miss.
            let drifted = not_uniform(index, time, expected, interval);
            return Err(odd_stamp(times, tolerance).unwrap_or(drifted));
        }
        previous = time;
    }
    Ok((start, whole_hertz(interval)))
}

/// The error of the first stamp that comes early or late after the one before it, by more than `tolerance` (s) and by
/// more than half of the worst one; `None` if all steps are alike. The right step is the mean of all other steps.
fn odd_stamp(times: &[f64], tolerance: f64) -> Option<RecordError> {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut sorted = steps.clone();
    let middle = sorted.len() / 2;
    let usual = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let worst = steps.iter().map(|step| (step - usual).abs()).fold(0.0, f64::max);
    let is_odd = |step: f64| (step - usual).abs() > (0.5 * worst).max(tolerance);
    let repeated = steps.iter().filter(|step| **step == 0.0).count();
    if usual <= worst && steps.iter().all(|step| *step >= 0.0) && 2 * repeated > steps.len() && steps.len() > 9 {
        let [rate, worst] = [slope(times).recip(), worst].map(in_six_digits);
        let what = format!(
            "time stamps repeat, {repeated} of {}: they are rounded to {worst} s, more than an interval; a line \
             through them says about {rate} Hz; give the rate",
            times.len()
        );
        let index = steps.iter().position(|step| *step == 0.0).map(|before| before + 1);
        return Some(RecordError::time(index, what));
    }
    let Some(before) = steps.iter().position(|step| is_odd(*step)) else {
        let before = steps.iter().position(|step| *step <= 0.0)?;
        let (time, previous) = (times[before + 1], times[before]);
        return Some(RecordError::not_increasing(before + 1, time, previous));
    };
    let (index, time, previous) = (before + 1, times[before + 1], times[before]);
    if time <= previous {
        return Some(RecordError::not_increasing(index, time, previous));
    }
    let (sum, count) =
        steps.iter().filter(|step| !is_odd(**step)).fold((0.0, 0.0), |(sum, count), step| (sum + step, count + 1.0));
    let interval = if count > 0.0 { sum / count } else { usual };
    let expected = previous + interval;
    let missing = ((time - previous) / interval).round() - 1.0;
    let is_gap = missing >= 1.0 && (time - previous - (missing + 1.0) * interval).abs() <= 0.1 * interval;
    match not_uniform(index, time, expected, interval) {
        RecordError::TimeAxis { index, what } if is_gap => {
            let what = what.split(';').next().unwrap_or_default();
            let [previous, time] = [previous, time].map(in_six_digits);
            Some(RecordError::time(
                index,
                format!(
                    "{what}; missing samples: {missing}, and nothing is put in their place; use the record up to \
                     {previous} s or from {time} s on"
                ),
            ))
        }
        error => Some(error),
    }
}

/// True for `times` at which something may have been measured, though not at equal intervals: they go on, and repeat
/// themselves hardly ever, as those that are rounded to more than an interval do.
pub(crate) fn is_clock(times: &[f64]) -> bool {
    /// Largest part of the steps that may be none (1). Origin: chosen; rows that are written twice are fewer.
    const REPEATED: f64 = 0.05;
    let repeated = times.windows(2).filter(|pair| pair[0] == pair[1]).count();
    times.iter().all(|time| time.is_finite())
        && times.windows(2).all(|pair| pair[0] <= pair[1])
        && repeated as f64 <= REPEATED * times.len() as f64
}

/// Slope of the line through `times` (s) of equally spaced samples by least squares: their interval (s), of which
/// rounding changes less than of their span.
fn slope(times: &[f64]) -> f64 {
    let (middle, center) = (0.5 * (times.len() - 1) as f64, mean(times));
    let sums = times.iter().enumerate().map(|(index, time)| (index as f64 - middle, time - center));
    let (product, square) = sums.fold((0.0, 0.0), |(product, square), (i, t)| (product + i * t, square + i * i));
    product / square
}

/// A time stamp (s) off a uniform grid, which would have it at `expected` (s).
fn not_uniform(index: usize, time: f64, expected: f64, interval: f64) -> RecordError {
    let [stamp, step, place, deviation] = [time, interval, expected, time - expected].map(in_six_digits);
    let what = format!(
        "sampling is not uniform: time stamp {index} is {stamp} s, but a uniform interval of {step} s puts it at \
         {place} s ({deviation} s off); give the rate if the samples are uniform and only their stamps are not, or \
         else resample them first"
    );
    RecordError::time(Some(index), what)
}

/// A number for the eye, in six significant digits or fewer.
pub(crate) fn in_six_digits(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

/// `interval` (s), or that of the nearest whole number of hertz if it is the same within [`RATE_ROUNDING`].
pub(crate) fn whole_hertz(interval: f64) -> f64 {
    let whole = interval.recip().round();
    if whole >= 1.0 && (whole * interval - 1.0).abs() <= RATE_ROUNDING { whole.recip() } else { interval }
}

/// One unit of the last decimal of `times` if their steps of about `interval` are uneven because of it, else 0.
fn visible_rounding(times: &[f64], interval: f64) -> f64 {
    let unit = last_decimal(times);
    let usual = (interval / unit).round() * unit;
    let odd = times.windows(2).filter(|pair| (pair[1] - pair[0] - usual).abs() > 0.5 * unit).count();
    if odd > 2 && odd as f64 > 0.01 * times.len() as f64 { unit } else { 0.0 }
}

/// One unit of the last decimal that any of `times` carries, found by scaling until all are whole numbers; nine
/// decimals at most, beyond which rounding does not matter for any sampling rate in use.
fn last_decimal(times: &[f64]) -> f64 {
    const MOST: i32 = 9;
    let mut decimals = 0;
    for &time in times {
        while decimals < MOST {
            let scaled = time * 10f64.powi(decimals);
            // A decimal number read from text is off by rounding only: relative to its own size, or to one unit.
            if (scaled - scaled.round()).abs() <= 1e-9 * scaled.abs().max(1.0) {
                break;
            }
            decimals += 1;
        }
    }
    10f64.powi(-decimals)
}

/// Source of the sampling interval of a record.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Sampling {
    /// The caller gave the rate (Hz).
    Given {
        /// The rate (Hz).
        rate: f64,
    },
    /// Sampling from a column or variable of time stamps.
    Times {
        /// Its name.
        name: String,
    },
    /// Sampling from a column of times of day; the record begins at 0 s.
    TimesOfDay {
        /// Its name.
        name: String,
        /// The first of them.
        first: String,
    },
    /// Sampling from a column that counts the days of a calendar; the record begins at 0 s.
    Days {
        /// Its name.
        name: String,
        /// The first of them.
        first: f64,
    },
    /// Sampling from a column that counts the time since 1970 in a part of a second; the record begins at 0 s.
    Epoch {
        /// Its name.
        name: String,
        /// The unit: `ms`, `µs` or `ns`.
        unit: &'static str,
        /// The first of its numbers.
        first: f64,
    },
    /// Sampling from a scalar variable in the file that holds the rate (Hz).
    RateVariable {
        /// Its name.
        name: String,
        /// The rate it holds (Hz).
        rate: f64,
    },
    /// Sampling from a scalar variable in the file that holds the interval (s).
    IntervalVariable {
        /// Its name.
        name: String,
        /// The interval it holds (s).
        interval: f64,
    },
    /// Sampling from the header of the data.
    Header {
        /// The interval it states (s).
        interval: f64,
        /// The rate that this was taken for (Hz).
        rate: f64,
    },
}

/// A rate (Hz) to the digits that a reader compares.
fn hertz(rate: f64) -> Rounded {
    Rounded::new(rate, None)
}

/// Reads as the end of the sentence "the sampling rate was …".
impl std::fmt::Display for Sampling {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Given { rate } => write!(f, "given as {} Hz", hertz(*rate)),
            Self::Times { name } => write!(f, "found from the time stamps in \"{name}\""),
            Self::TimesOfDay { name, first } => {
                write!(f, "found from the times of day in \"{name}\", counted from the first, {first}")
            }
            Self::Days { name, first } => {
                write!(
                    f,
                    "found from the days in \"{name}\", which are those of a calendar, counted from the first, {first}"
                )
            }
            Self::Epoch { name, unit, first } => {
                write!(f, "found from the {unit} since 1970 in \"{name}\", counted from the first, {first}")
            }
            Self::RateVariable { name, rate } => write!(f, "read as {} Hz from the variable \"{name}\"", hertz(*rate)),
            Self::IntervalVariable { name, interval } => {
                write!(f, "found from the interval of {interval} s in the variable \"{name}\"")
            }
            Self::Header { interval, rate } => {
                write!(f, "taken as {} Hz from the interval of {interval} s in the header of the data", hertz(*rate))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::says;

    fn stamps(rate: f64, decimals: i32, count: u32) -> Vec<f64> {
        let unit = 10f64.powi(decimals);
        (0..count).map(|i| (f64::from(i) / rate * unit).round() / unit).collect()
    }

    #[test]
    fn stamps_with_few_digits_are_uniform() {
        for (rate, decimals) in [(1000.0, 3), (600.0, 3), (1024.0, 4), (25_600.0, 5), (500.0, 15), (1000.0, 15)] {
            let grid = uniform_grid(&stamps(rate, decimals, 60_001)).unwrap();
            assert_eq!(grid.1, 1.0 / rate, "{rate} Hz with {decimals} decimals");
        }
    }

    #[test]
    fn the_rate_is_rounded_to_whole_hertz_only_within_the_stated_limit() {
        let near = [0.0, 1.0 / (1000.0 * (1.0 + 9e-6))];
        let far = [0.0, 1.0 / (1000.0 * (1.0 + 1.1e-5))];
        assert_eq!(uniform_grid(&near).unwrap().1, 1e-3);
        assert_eq!(uniform_grid(&far).unwrap().1, far[1]);
    }

    #[test]
    fn jitter_is_tolerated_up_to_its_limit() {
        for (jitter, uniform) in [(0.0099e-3, true), (0.0101e-3, false)] {
            let mut times = stamps(1000.0, 15, 1000);
            times[500] += jitter;
            assert_eq!(uniform_grid(&times).is_ok(), uniform, "jitter of {jitter} s");
        }
    }

    #[test]
    fn gaps_are_found() {
        for (rate, decimals, count, gap) in [(1000.0, 3, 10_000, 1e-3), (1000.0, 3, 40, 1e-3), (600.0, 3, 10_000, 0.01)]
        {
            let mut times = stamps(rate, decimals, count);
            for time in &mut times[count as usize / 3..] {
                *time += gap;
            }
            let found = uniform_grid(&times);
            assert!(says(&found, "sampling is not uniform"), "{gap} s in {count} stamps: {found:?}");
        }
    }

    #[test]
    fn the_error_points_to_the_stamp_that_is_wrong() {
        for (rate, decimals, gap) in [(1000.0, 3, 1e-3), (600.0, 3, 0.01), (1000.0, 15, 1e-4)] {
            let mut times = stamps(rate, decimals, 10_000);
            times[3333..].iter_mut().for_each(|time| *time += gap);
            let error = uniform_grid(&times).unwrap_err();
            let RecordError::TimeAxis { index: Some(3333), what } = error else {
                panic!("{rate} Hz with {decimals} decimals: {error}")
            };
            let deviation = what.split_once("s (").and_then(|(_, rest)| rest.split_once(" s off")).unwrap().0;
            let deviation: f64 = deviation.parse().unwrap();
            assert!((deviation - gap).abs() < 0.6e-3, "{deviation} s for {gap} s");
        }
        let error = uniform_grid(&[0.0, 1.0, 2.0, 300.0, 4.0, 5.0]).unwrap_err();
        assert!(matches!(error, RecordError::TimeAxis { index: Some(3), .. }));
        assert!(error.to_string().contains("is 300 s, but a uniform interval of 1 s puts it at 3 s"), "{error}");
        let back = uniform_grid(&[0.0, 1.0, 2.0, -7.0, 4.0, 5.0]).unwrap_err();
        assert_eq!(back.to_string(), "time must increase, but time stamp 3 is -7 s after 2 s");
    }

    #[test]
    fn the_error_says_what_to_do_in_few_digits() {
        let mut times = stamps(1000.0, 15, 1000);
        for time in &mut times {
            *time += 0.123_456_789;
        }
        times[700] += 3e-4 / 7.0;
        assert_eq!(
            uniform_grid(&times).unwrap_err().to_string(),
            "sampling is not uniform: time stamp 700 is 0.8235 s, but a uniform interval of 0.001 s puts it at \
             0.823457 s (0.0000428571 s off); give the rate if the samples are uniform and only their stamps are not, \
             or else resample them first"
        );
    }

    #[test]
    fn time_that_does_not_increase_is_its_own_error() {
        let error = uniform_grid(&[0.0, 1.0, 1.0, 2.0]).unwrap_err();
        assert_eq!(error.to_string(), "time must increase, but time stamp 2 is 1 s after 1 s");
        assert!(says(&uniform_grid(&[0.0]), "1 time stamps do not give a sampling interval"));
        assert!(says(&uniform_grid(&[0.0, f64::NAN, 2.0]), "it must be finite"));
        assert!(says(&uniform_grid(&[-1.7e308, 1.7e308]), "the sampling interval must be positive"));
    }

    #[test]
    fn sampling_reads_as_a_sentence() {
        let sampling = Sampling::RateVariable { name: "ActualRate".into(), rate: 1000.0 };
        assert_eq!(sampling.to_string(), "read as 1000 Hz from the variable \"ActualRate\"");
    }
}
