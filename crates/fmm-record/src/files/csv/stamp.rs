//! Times of day as text, with or without a date: `10:00:00.002`, `2024-05-02T10:00:00.002Z`, `5/2/2024 1:00:00 PM`,
//! `20240502T100000.002Z`; and durations with their unit: `0.002 sec`.

use crate::units::seconds_in;

/// A time of day and the date as it is written; days are told apart by their text, whatever its order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stamp {
    date: String,
    /// Since midnight (s).
    seconds: f64,
}

impl Stamp {
    /// The stamp that a field is; `None` for any other text.
    ///
    /// Two numbers are hours and minutes, or, if the second has a fraction, minutes and seconds; a fourth is a
    /// fraction. A zone counts for nothing.
    pub(super) fn of(field: &[u8]) -> Option<Self> {
        const HOUR: f64 = 3600.0;
        let text = std::str::from_utf8(field).ok()?.trim();
        let Some(colon) = text.find(':') else { return Self::basic(text).or_else(|| Self::duration(text)) };
        let begin = text[..colon].rfind(['T', ' ']).map_or(0, |at| at + 1);
        let date = text[..begin].trim_end_matches(['T', ' ']);
        let is_date = |sign: char| sign.is_ascii_alphanumeric() || "-/., ".contains(sign);
        if begin > 0 && !(date.starts_with(|sign: char| sign.is_ascii_digit()) && date.chars().all(is_date)) {
            return None;
        }
        let clock = text[begin..].trim_end_matches('Z');
        let lower = clock.to_ascii_lowercase();
        let is_afternoon = lower.ends_with("pm");
        let is_halved = is_afternoon || lower.ends_with("am");
        let clock = if is_halved { clock[..clock.len() - 2].trim_end() } else { clock };
        let clock = clock.split(['+', '-']).next().unwrap_or_default().replace(',', ".");
        let parts: Vec<&str> = clock.split(':').collect();
        let is_number = |part: &&str| {
            part.starts_with(|sign: char| sign.is_ascii_digit())
                && part.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
        };
        let whole = |part: &&str| part.bytes().all(|byte| byte.is_ascii_digit());
        if !parts.iter().all(is_number) || !parts[..parts.len() - 1].iter().all(whole) {
            return None;
        }
        let number = |part: &str| part.parse::<f64>().ok();
        let sixty = |part: &str| number(part).filter(|number| *number < 60.0);
        let seconds = match parts[..] {
            [minutes, seconds] if seconds.contains('.') => 60.0 * number(minutes)? + sixty(seconds)?,
            [hours, minutes] => HOUR * number(hours)? + 60.0 * sixty(minutes)?,
            [hours, minutes, seconds] => HOUR * number(hours)? + 60.0 * sixty(minutes)? + sixty(seconds)?,
            [hours, minutes, seconds, fraction] => {
                HOUR * number(hours)? + 60.0 * sixty(minutes)? + sixty(seconds)? + number(&format!("0.{fraction}"))?
            }
            _ => return None,
        };
        let noon = match (is_halved, seconds >= 12.0 * HOUR) {
            (true, true) if !is_afternoon => -12.0 * HOUR,
            (true, false) if is_afternoon => 12.0 * HOUR,
            _ => 0.0,
        };
        Some(Self { date: date.to_owned(), seconds: seconds + noon })
    }

    /// The basic format of ISO 8601, which has no marks inside of date and time.
    fn basic(text: &str) -> Option<Self> {
        let (date, clock) = text.trim_end_matches('Z').split_once(['T', ' '])?;
        let are_digits =
            |text: &str, count: usize| text.len() == count && text.bytes().all(|byte| byte.is_ascii_digit());
        let (whole, fraction) = clock.split_once('.').unwrap_or((clock, ""));
        if !are_digits(date, 8) || !are_digits(whole, 6) || !are_digits(fraction, fraction.len()) {
            return None;
        }
        let clock = format!("{}:{}:{}.{fraction}", &whole[..2], &whole[2..4], &whole[4..]);
        let stamp = Self::of(clock.as_bytes())?;
        Some(Self { date: date.to_owned(), ..stamp })
    }

    /// A number and a unit of time behind a blank.
    fn duration(text: &str) -> Option<Self> {
        let (number, unit) = text.split_once(' ')?;
        let number: f64 = number.parse().ok()?;
        let seconds = number * seconds_in(unit).filter(|_| number.is_finite() && !unit.trim().is_empty())?;
        Some(Self { date: String::new(), seconds })
    }
}

/// Stamps of a column one after the other, as times since the first (s).
#[derive(Debug, Clone, Default)]
pub(super) struct Stamps {
    first: Option<f64>,
    /// The last one, and the seconds of all days before its own.
    last: Option<(Stamp, f64)>,
}

impl Stamps {
    /// Time since the first stamp (s). A date that changes, or a clock without a date that falls back by more than half
    /// a day, begins the next day.
    pub(super) fn elapsed(&mut self, stamp: Stamp) -> f64 {
        const DAY: f64 = 86_400.0;
        let days = self.last.as_ref().map_or(0.0, |(last, days)| {
            let is_next =
                if stamp.date.is_empty() { stamp.seconds < last.seconds - DAY / 2.0 } else { stamp.date != last.date };
            if is_next { days + DAY } else { *days }
        });
        let first = *self.first.get_or_insert(stamp.seconds);
        let elapsed = days + stamp.seconds - first;
        self.last = Some((stamp, days));
        elapsed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks_are_read_with_and_without_a_date() {
        for (text, seconds) in [
            ("10:00:00.002", 36_000.002),
            ("2024-05-02T10:00:00.002Z", 36_000.002),
            ("2024-05-02 10:00:00,002", 36_000.002),
            ("2024-05-02T10:00:00.5+02:00", 36_000.5),
            ("02.05.2024 10:00:00", 36_000.0),
            ("5/2/2024 1:00:00.25 PM", 46_800.25),
            ("12:00:01 am", 1.0),
            ("12:00:01 PM", 43_201.0),
            ("10:00:00:250", 36_000.25),
            ("00:01.5", 1.5),
            ("10:30", 37_800.0),
            ("46085 10:00:00.5", 36_000.5),
            ("20240502T100000.002Z", 36_000.002),
            ("20240502 100000", 36_000.0),
            ("0.002 sec", 0.002),
            ("1.5 min", 90.0),
        ] {
            assert_eq!(Stamp::of(text.as_bytes()).map(|stamp| stamp.seconds), Some(seconds), "{text}");
        }
        for text in [
            "",
            ":",
            "1:",
            ":1",
            "a:b",
            "Start 10:00",
            "1:99",
            "x T1:2:3:4:5",
            "10:00:61",
            "1,5:2",
            "12 am",
            "é:1",
            "20240502T10",
            "2 m",
            "NaN s",
        ] {
            assert_eq!(Stamp::of(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn midnight_begins_the_next_day() {
        for stamps in
            [["23:59:59.5", "00:00:00.5", "00:00:01.5"], ["1.5.24 23:59:59.5", "2.5.24 0:00:00.5", "2.5.24 0:00:01.5"]]
        {
            let mut all = Stamps::default();
            let elapsed = stamps.map(|text| all.elapsed(Stamp::of(text.as_bytes()).unwrap()));
            assert_eq!(elapsed, [0.0, 1.0, 2.0]);
        }
    }
}
