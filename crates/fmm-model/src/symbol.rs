//! Table of the symbols of units: size in the SI unit, dimension, prefixes, and names in files.

use crate::dimension::Dimension;

/// A symbol and the names under which files write it.
struct Row {
    symbol: &'static str,
    /// Size in the SI unit (1).
    size: f64,
    /// Powers of length, time, mass, angle, voltage, current and counts.
    powers: Powers,
    /// Prefixes that may stand before it, as in [`PREFIXES`].
    prefixes: &'static [&'static str],
    /// Names in files; those in small letters count in any case, and those of three letters or more take a plural s.
    /// Without a name, it is no unit of a measured channel.
    names: &'static [&'static str],
}

type Powers = [f64; 7];

const NONE: Powers = [0.0; 7];
const LENGTH: Powers = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const TIME: Powers = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const FREQUENCY: Powers = [0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const MASS: Powers = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
const ANGLE: Powers = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
const VELOCITY: Powers = [1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const ROTATION: Powers = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0];
const ACCELERATION: Powers = [1.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const FORCE: Powers = [1.0, -2.0, 1.0, 0.0, 0.0, 0.0, 0.0];
const ENERGY: Powers = [2.0, -2.0, 1.0, 0.0, 0.0, 0.0, 0.0];
const VOLTAGE: Powers = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
const CURRENT: Powers = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
const COUNTS: Powers = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Standard acceleration of free fall (m/s²).
const FREE_FALL: f64 = 9.806_65;
/// Degree (rad).
const DEGREE: f64 = core::f64::consts::PI / 180.0;
/// Turn (rad).
const TURN: f64 = core::f64::consts::TAU;
/// Inch (m).
const INCH: f64 = 0.0254;
/// Mile (m).
const MILE: f64 = 1609.344;

/// Prefixes: symbol, factor (1), and how files write it.
const PREFIXES: [(&str, f64, &[&str]); 9] = [
    ("", 1.0, &[""]),
    ("k", 1e3, &["k", "kilo"]),
    ("M", 1e6, &["M", "mega"]),
    ("da", 1e1, &["da"]),
    ("d", 1e-1, &["d", "deci"]),
    ("c", 1e-2, &["c", "centi"]),
    ("m", 1e-3, &["m", "milli"]),
    ("µ", 1e-6, &["µ", "μ", "u", "micro"]),
    ("n", 1e-9, &["n", "nano"]),
];

const TABLE: [Row; 43] = [
    row("1", 1.0, NONE, &[], &[]),
    row("%", 1e-2, NONE, &[], &[]),
    row("m", 1.0, LENGTH, &["k", "d", "c", "m", "µ", "n"], &["m", "metre", "meter"]),
    row("micron", 1e-6, LENGTH, &[], &["micron", "mic"]),
    row("in", INCH, LENGTH, &[], &["in", "inch", "inches"]),
    row("mil", 1e-3 * INCH, LENGTH, &[], &["mil", "thou"]),
    row("ft", 0.3048, LENGTH, &[], &["ft", "foot", "feet"]),
    row("mi", MILE, LENGTH, &[], &["mi"]),
    row("s", 1.0, TIME, &["m", "µ", "n"], &["s", "sec", "second", "sekunde", "sekunden"]),
    row("milli", 1e-3, TIME, &[], &["milli"]),
    row("micro", 1e-6, TIME, &[], &["micro"]),
    row("nano", 1e-9, TIME, &[], &["nano"]),
    row("min", 60.0, TIME, &[], &["min", "minute", "minuten"]),
    row("h", 3600.0, TIME, &[], &["h", "hr", "hrs", "hour", "std", "stunden"]),
    row("d", 86_400.0, TIME, &[], &["d", "day", "tage"]),
    row("Hz", 1.0, FREQUENCY, &["k", "M", "m"], &[]),
    row("kg", 1.0, MASS, &[], &[]),
    row("g", 1e-3, MASS, &[], &[]),
    row("rad", 1.0, ANGLE, &["m", "µ", "n"], &["rad", "radian"]),
    row("deg", DEGREE, ANGLE, &["m"], &["deg", "°", "º", "degree"]),
    row("arcmin", DEGREE / 60.0, ANGLE, &[], &["arcmin"]),
    row("arcsec", DEGREE / 3600.0, ANGLE, &[], &["arcsec"]),
    row("rev", TURN, ANGLE, &[], &["rev", "revolution", "turn"]),
    row("mps", 1.0, VELOCITY, &[], &["mps"]),
    row("kph", 1e3 / 3600.0, VELOCITY, &[], &["kph", "kmh"]),
    row("mph", MILE / 3600.0, VELOCITY, &[], &["mph"]),
    row("ips", INCH, VELOCITY, &[], &["ips"]),
    row("rpm", TURN / 60.0, ROTATION, &[], &["rpm"]),
    row("dps", DEGREE, ROTATION, &["m"], &["dps"]),
    // In a file, g is free fall and not gram.
    row("gn", FREE_FALL, ACCELERATION, &["m"], &["g", "gn", "g0"]),
    row("N", 1.0, FORCE, &["k", "M", "da", "m", "µ"], &["N", "newton"]),
    // In a file, lb is a force and not a mass.
    row("lbf", 4.448_221_615_260_5, FORCE, &["k"], &["lbf", "lb", "lbs"]),
    row("kip", 4_448.221_615_260_5, FORCE, &[], &["kip"]),
    row("kgf", FREE_FALL, FORCE, &[], &["kgf"]),
    row("Nm", 1.0, ENERGY, &["k", "m"], &["Nm"]),
    row("Nmm", 1e-3, ENERGY, &[], &["Nmm"]),
    row("J", 1.0, ENERGY, &["k", "m", "µ"], &[]),
    row("V", 1.0, VOLTAGE, &["k", "m", "µ"], &["V", "volt"]),
    row("A", 1.0, CURRENT, &["m", "µ"], &["A"]),
    row("counts", 1.0, COUNTS, &[], &["count", "cts"]),
    row("ticks", 1.0, COUNTS, &[], &["tick"]),
    row("pulses", 1.0, COUNTS, &[], &["pulse"]),
    row("LSB", 1.0, COUNTS, &[], &["lsb"]),
];

const fn row(
    symbol: &'static str,
    size: f64,
    powers: Powers,
    prefixes: &'static [&'static str],
    names: &'static [&'static str],
) -> Row {
    Row { symbol, size, powers, prefixes, names }
}

/// The prefix (symbol and factor) and the row of a text, of which the part behind the prefix `is_called` so.
fn find(text: &str, is_called: impl Fn(&Row, &str) -> bool) -> Option<((&'static str, f64), &'static Row)> {
    PREFIXES.iter().find_map(|(prefix, factor, written)| {
        let rests = written.iter().filter_map(|written| text.strip_prefix(written));
        let row = |rest: &str| {
            let takes = |row: &&Row| prefix.is_empty() || row.prefixes.contains(prefix);
            TABLE.iter().filter(takes).find(|row| is_called(row, rest))
        };
        rests.into_iter().find_map(row).map(|row| ((*prefix, *factor), row))
    })
}

/// Symbol of the unit that a file calls `name`; `None` if no channel has such a unit.
pub(crate) fn named(name: &str) -> Option<(&'static str, &'static str)> {
    let is_called = |row: &Row, name: &str| {
        let singular = name.strip_suffix('s').filter(|stem| stem.len() > 2);
        row.names.contains(&name) || singular.is_some_and(|stem| row.names.contains(&stem))
    };
    find(name, is_called).map(|((prefix, _), row)| (prefix, row.symbol))
}

/// Dimension of one symbol; `None` for one that is not in the table.
pub(crate) fn dimension(symbol: &str) -> Option<Dimension> {
    let by_symbol = find(symbol, |row, symbol| row.symbol == symbol);
    let ((_, factor), row) = by_symbol.or_else(|| find(symbol, |row, name| row.names.contains(&name)))?;
    Some(Dimension::new(factor * row.size, row.powers))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_rows_have_one_name() {
        let mut names: alloc::vec::Vec<&str> = TABLE.iter().flat_map(|row| row.names).copied().collect();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
        assert!(TABLE.iter().all(|row| dimension(row.symbol) == Some(Dimension::new(row.size, row.powers))));
    }
}
