//! Statements above a table: a name, its number, and perhaps a unit of time or frequency.

use super::fields::{Row, Separator, number, text};
use crate::units::label::without_groups;
use crate::units::seconds_in;

/// The names and numbers that a line states: `Sample Rate: 500 Hz`, `dt [ms];2`, `Sample Interval,0.002,s`. Numbers
/// with a unit of time or frequency are in s or Hz; with any other they state nothing.
pub(super) fn statements(line: &[u8], separator: Separator) -> Vec<(String, f64)> {
    let row = Row::of(line, separator);
    let fields: Vec<String> = (0..row.len()).map(|column| text(row.field(column))).collect();
    let apart = fields.split_first().and_then(|(name, rest)| {
        let (first, value) = rest.iter().enumerate().find_map(|(at, field)| Some((at, measured(field)?)))?;
        let mut units = rest.iter().enumerate().filter(|(at, field)| *at != first && measured(field).is_none());
        let scale = units.try_fold(1.0, |scale, (_, unit)| Some(scale * scale_of(unit)?))?;
        named(name, value * scale)
    });
    let together = fields.iter().filter_map(|field| {
        let (name, value) = field.split_once([':', '='])?;
        named(name, measured(value)?)
    });
    apart.into_iter().chain(together).collect()
}

/// A statement by its name, which may have the unit in brackets.
fn named(name: &str, value: f64) -> Option<(String, f64)> {
    let (bare, groups) = without_groups(name.trim().trim_end_matches([':', '=']));
    let scale = groups.first().map_or(Some(1.0), |group| scale_of(&group.text))?;
    let bare = bare.trim_start_matches(['#', '%', ';', '/']).trim().to_owned();
    (!bare.is_empty()).then_some((bare, value * scale))
}

/// The number that a text begins with, by the unit behind it.
fn measured(text: &str) -> Option<f64> {
    let text = text.trim();
    if let Some((value, _)) = number(text.as_bytes()) {
        return Some(value);
    }
    let begins_unit = |(at, sign): (usize, char)| {
        let is_exponent =
            matches!(sign, 'e' | 'E') && text[at + 1..].starts_with(|next: char| "+-0123456789".contains(next));
        (!(sign.is_ascii_digit() || "+-.,".contains(sign) || is_exponent)).then_some(at)
    };
    let (value, unit) = text.split_at(text.char_indices().find_map(begins_unit)?);
    let unit = unit.split_whitespace().next()?.trim_end_matches(['.', ',']);
    Some(number(value.trim().as_bytes())?.0 * scale_of(unit).filter(|_| !unit.is_empty())?)
}

/// Seconds in a unit of time, or hertz in one of frequency; 1 for none.
fn scale_of(unit: &str) -> Option<f64> {
    let unit = unit.trim();
    let lower = unit.to_lowercase();
    match &*lower {
        "" | "hz" | "s/s" | "sa/s" | "sps" | "1/s" => Some(1.0),
        "khz" | "ks/s" | "ksa/s" => Some(1e3),
        // Programs that write capitals mean a second by them.
        _ => seconds_in(unit).or_else(|| seconds_in(&lower)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_stated_in_many_ways() {
        let (comma, tab) = (Separator::Sign(b','), Separator::Sign(b'\t'));
        for (line, separator, name, value) in [
            ("Sample Rate: 500 Hz. Sample values on linear scale.", tab, "Sample Rate", 500.0),
            ("Sampling Rate = 0.5 kHz", tab, "Sampling Rate", 500.0),
            ("# fs=500", Separator::Blanks, "fs", 500.0),
            ("Delta-X:0,002", tab, "Delta-X", 0.002),
            ("Time interval :,2000.00000uS", comma, "Time interval", 0.002),
            ("SampleTime[ms],2", comma, "SampleTime", 0.002),
            ("Sample Interval,2.0e-03,s", comma, "Sample Interval", 0.002),
            ("Delta X: 2e-3 Sec", tab, "Delta X", 0.002),
        ] {
            let found = statements(line.as_bytes(), separator);
            let is_near = |value: f64, other: f64| (value - other).abs() <= 1e-15 * other;
            assert!(found.iter().any(|(other, found)| other == name && is_near(*found, value)), "{line}: {found:?}");
        }
        for line in ["Length processed: 1500 samples 3.0 seconds", "Date: 02.05.2024", "Rate: 5 mm/min", "fs", "", ":"]
        {
            assert_eq!(statements(line.as_bytes(), tab), [], "{line}");
        }
    }
}
