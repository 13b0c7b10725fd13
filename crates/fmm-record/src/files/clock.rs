//! Time of a series by its name and its numbers.

use crate::error::RecordError;
use crate::files::reading::Reading;
use crate::sampling::Sampling;
use crate::units::label::{is_remark, without_groups};
use crate::units::seconds_in;
use crate::units::word::{is_in, words};

/// Statement of a name about time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Clock {
    /// True if it is called time.
    pub(crate) is_time: bool,
    /// True if it is called a number of samples.
    pub(crate) is_counter: bool,
    /// True if it has no name, as the column of row numbers in many tables has none.
    pub(crate) is_nameless: bool,
    unit: Written,
}

/// The unit that is written.
#[derive(Debug, Clone, PartialEq)]
enum Written {
    Nothing,
    /// A unit of time (s).
    Seconds(f64),
    /// Something else where a unit belongs.
    Other(String),
}

/// Words for time.
const TIMES: &str = "time times zeit timestamp timestamps zeitstempel elapsed uptime temps tiempo datetime";

/// Words for the steps of a clock, which are time only in a unit of time.
const TICKS: &str = "tick ticks clock";

/// Words that may stand beside one for time.
const FILLERS: &str = "\
    stamp stamps rel relative abs absolute total since start system device sensor axis vector values in date datum";

/// Words for a number of samples.
const COUNTERS: &str = "\
    sample samples index idx ind frame frames row rows scan scans sweep point points sequence seq number num no \
    nr id counter record line unnamed messwert datensatz";

impl Clock {
    /// Clock of a column without a name.
    #[cfg(any(feature = "mat", feature = "npy"))]
    pub(crate) fn nameless() -> Self {
        Self { is_time: false, is_counter: false, is_nameless: true, unit: Written::Nothing }
    }

    /// Clock by its name.
    pub(crate) fn of(name: &str) -> Self {
        let (stem, unit, in_brackets) = unit_of_time(name);
        let stem_words = words(&stem);
        let has_time = stem_words.iter().any(|word| is_in(TIMES, word));
        let only_time = has_time && stem_words.iter().all(|word| is_in(TIMES, word) || is_in(FILLERS, word));
        let is_known = matches!(unit, Written::Seconds(_));
        // A letter may stand for temperature or torque, which have other units.
        let is_letter = stem.trim().eq_ignore_ascii_case("t") && !matches!(unit, Written::Other(_));
        let begins = stem_words.first().is_some_and(|word| is_in(TIMES, word));
        let is_bare_unit = is_known && stem_words.is_empty();
        let ticks = is_known && !stem_words.is_empty() && stem_words.iter().all(|word| is_in(TICKS, word));
        let is_time = only_time || is_letter || is_bare_unit || ticks || (begins && is_known && in_brackets);
        let is_nameless = matches!(stem.trim(), "" | "#");

        let all_count = |words: &[String]| !words.is_empty() && words.iter().all(|word| is_in(COUNTERS, word));
        let unit_counts = matches!(&unit, Written::Other(unit) if all_count(&words(unit)));
        let is_counter = !is_time && !is_known && !is_nameless && (all_count(&stem_words) || unit_counts);
        Self { is_time, is_counter, is_nameless: is_nameless && unit == Written::Nothing, unit }
    }

    /// The same of a column whose unit was given, if it was.
    pub(crate) fn in_unit(self, given: Option<&str>) -> Self {
        match given.and_then(seconds_in) {
            Some(seconds) => Self { is_counter: false, unit: Written::Seconds(seconds), ..self },
            None => self,
        }
    }

    /// True if it is called time, in a unit that is known or not written.
    pub(crate) fn is_known_time(&self) -> bool {
        self.is_time && !matches!(self.unit, Written::Other(_))
    }

    /// True if it may be time under another name.
    pub(crate) fn may_be_time(&self) -> bool {
        self.is_time || self.is_counter || !matches!(self.unit, Written::Other(_))
    }

    /// True if uniform numbers count samples: whole ones in no unit, unless they are the time since 1970.
    pub(crate) fn counts(&self, numbers: &[f64]) -> bool {
        self.unit == Written::Nothing && are_whole(numbers) && epoch(numbers).is_none()
    }

    /// True if a column so called is no motion: it counts, or has no name.
    pub(crate) fn is_no_motion(&self) -> bool {
        self.is_counter || self.is_nameless
    }

    /// Brings the time stamps of the series called `name` to seconds, and tells what they were; `by_nature` is true if
    /// it is time only because it increases uniformly.
    ///
    /// # Errors
    /// [`RecordError::TimeAxis`] if something else is written where the unit belongs, or if they
    /// count samples: by their name, or as whole numbers of which nobody said that they are time.
    pub(crate) fn to_seconds(&self, name: &str, by_nature: bool, times: &mut [f64]) -> Result<Sampling, RecordError> {
        // A stamp of a computer is a whole number of whatever its clock counts.
        let is_vague = by_nature || (self.is_time && name.to_lowercase().contains("stamp"));
        let since = epoch(times).filter(|_| self.unit == Written::Nothing && !self.is_counter);
        if let (Some((unit, seconds)), Some(&first)) = (since, times.first()) {
            for time in times.iter_mut() {
                *time = seconds * (*time - first);
            }
            return Ok(Sampling::Epoch { name: name.into(), unit, first });
        }
        match &self.unit {
            Written::Other(unit) if !self.is_counter => {
                let what = format!(
                    "the time stamps \"{name}\" are in \"{unit}\", which is no unit of time that is known; give the \
                     sampling rate"
                );
                return Err(RecordError::time(None, what));
            }
            _ if self.is_counter => return Err(counter(name, times)),
            Written::Nothing if is_vague && self.counts(times) => return Err(counter(name, times)),
            Written::Nothing if are_days(times) => {
                let first = times[0];
                for time in times.iter_mut() {
                    *time = DAY * (*time - first);
                }
                return Ok(Sampling::Days { name: name.into(), first });
            }
            Written::Seconds(scale) if *scale != 1.0 => times.iter_mut().for_each(|time| *time *= scale),
            _ => {}
        }
        Ok(Sampling::Times { name: name.into() })
    }
}

/// The unit of stamps that count time since 1970 in parts of a second, by their size, with its seconds; of the years
/// 2000 to 2100, of which those in one unit are no year in another.
fn epoch(times: &[f64]) -> Option<(&'static str, f64)> {
    const YEARS: std::ops::Range<f64> = 946_684_800.0..4_102_444_800.0;
    let ends = [*times.first()?, *times.last()?];
    let units = [("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)];
    units.into_iter().find(|(_, seconds)| ends.iter().all(|time| YEARS.contains(&(time * seconds))))
}

/// Seconds of a day.
const DAY: f64 = 86_400.0;

/// True for stamps that count the days of a calendar, of the years 1970 to 2100: those of spreadsheets from 1900 on,
/// those of MATLAB from the year 0 on. Steps so small would be 200 kHz or more if they were seconds; as days they are
/// at most 0.4 s.
fn are_days(times: &[f64]) -> bool {
    const LARGEST_STEP: f64 = 5e-6;
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return false };
    let is_date = |days: &f64| (25_569.0..73_051.0).contains(days) || (719_529.0..767_011.0).contains(days);
    let step = (last - first) / (times.len() as f64 - 1.0);
    is_date(first) && is_date(last) && step > 0.0 && step < LARGEST_STEP
}

impl Reading {
    /// The values of a column of time stamps in s, as the unit in its name says: for a table whose times are not
    /// equally spaced, of which no [`Record`](crate::Record) is made. Read it at any [`rate`](crate::Reader::rate).
    ///
    /// ```
    /// use fmm_record::Reader;
    ///
    /// let table = "t [ms],force [N]\n0,1.5\n10,1.7\n25,1.6\n";
    /// let file = Reader::default().rate(1.0).parse(table)?;
    /// let name = file.channel("force [N]")?.time.expect("a column that is called time");
    /// assert_eq!(file.channel(&*name)?.seconds()?, [0.0, 0.01, 0.025]);
    /// # Ok::<(), fmm_record::RecordError>(())
    /// ```
    ///
    /// # Errors
    /// [`RecordError::TimeAxis`] if the unit is not one of time, or if the column counts samples.
    pub fn seconds(&self) -> Result<Vec<f64>, RecordError> {
        let mut times = self.record.values().to_vec();
        Clock::of(&self.channel).to_seconds(&self.channel, false, &mut times)?;
        Ok(times)
    }
}

/// A series that counts samples and tells no time; one in other steps than 1 may be time in a unit that nobody said.
pub(crate) fn counter(name: &str, counts: &[f64]) -> RecordError {
    let step = counts.get(..2).map_or(1.0, |pair| pair[1] - pair[0]);
    let unit = if step == 1.0 || step.fract() != 0.0 {
        String::new()
    } else {
        format!("; in steps of {step} it may be milliseconds, say their unit")
    };
    let what = format!(
        "\"{name}\" counts samples and tells no time; give the sampling rate, or time stamps with their unit{unit}"
    );
    RecordError::time(None, what)
}

/// True if all numbers are whole, like those that count samples.
pub(crate) fn are_whole(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.fract() == 0.0)
}

/// The name without its unit, the unit, and whether that stood in brackets.
fn unit_of_time(name: &str) -> (String, Written, bool) {
    let (bare, groups) = without_groups(name);
    let known = groups.iter().rev().find_map(|group| seconds_in(&group.text).filter(|_| !group.text.is_empty()));
    if let Some(seconds) = known {
        return (bare, Written::Seconds(seconds), true);
    }
    if let Some(group) = groups.iter().rev().find(|group| !is_remark(&group.text)) {
        return (bare, Written::Other(group.text.clone()), true);
    }
    let is_behind = |unit: &str| !words(unit).iter().all(|word| is_in(TIMES, word));
    if let Some((stem, unit)) = bare.split_once('/').filter(|(stem, unit)| !stem.trim().is_empty() && is_behind(unit)) {
        let unit = unit.trim();
        let written = seconds_in(unit).map_or_else(|| Written::Other(unit.to_owned()), Written::Seconds);
        return (stem.trim().to_owned(), written, false);
    }
    if seconds_in(&bare).is_some() && bare.chars().count() > 1 && !["min", "std"].contains(&&*bare.to_lowercase()) {
        // Called by nothing but its unit, which a single letter may not be.
        return (String::new(), seconds_in(&bare).map_or(Written::Nothing, Written::Seconds), false);
    }
    let parts = words(&bare);
    if let [_, .., last] = &parts[..]
        && let Some(seconds) = seconds_in(last)
        && bare.to_lowercase().ends_with(last.as_str())
    {
        let stem = bare[..bare.len() - last.len()].trim_end_matches(|sign: char| !sign.is_alphanumeric());
        // Of anything but time these are other things: `v_ms` is a velocity, `x_min` a minimum.
        if stem.eq_ignore_ascii_case("t") || words(stem).iter().any(|word| is_in(TIMES, word) || is_in(TICKS, word)) {
            return (stem.to_owned(), Written::Seconds(seconds), false);
        }
    }
    (bare, Written::Nothing, false)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(name: &str) -> Option<f64> {
        let clock = Clock::of(name);
        let mut times = [0.0, 0.5];
        clock.is_time.then(|| clock.to_seconds(name, false, &mut times).ok().map(|_| 2.0 * times[1]))?
    }

    #[test]
    fn names_of_time_are_known_with_their_units() {
        for name in
            ["t", "T", "time", "t_s", "time_s", "Time (s)", "t [s]", "t/s", "Zeit", " Zeit [s] ", "TIME", "Time, s"]
        {
            assert_eq!(seconds(name), Some(1.0), "{name}");
        }
        for name in ["Time  1 - default sample rate [s]", "Timestamp", "time stamp", "relative time (secs)", "times"] {
            assert_eq!(seconds(name), Some(1.0), "{name}");
        }
        for (name, unit) in [
            ("time_ms", 1e-3),
            ("t [µs]", 1e-6),
            ("t [μs]", 1e-6),
            ("Time (Min.)", 60.0),
            ("time_min", 60.0),
            ("timeMs", 1e-3),
            ("t_ns", 1e-9),
            ("Zeit [h]", 3600.0),
            ("time_millis", 1e-3),
            ("elapsed_ms", 1e-3),
        ] {
            assert_eq!(seconds(name), Some(unit), "{name}");
        }
        for name in ["theta", "t_coil", "velocity", "timer", "", "trial", "time constant", "T [K]", "T1", "s", "min"] {
            assert!(!Clock::of(name).is_time, "{name}");
        }
    }
}
