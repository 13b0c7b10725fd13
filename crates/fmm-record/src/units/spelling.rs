//! The spellings of units, one by one and as lengths or angles per time.

use std::f64::consts::{PI, TAU};

use crate::Quantity;

/// A factor to the SI unit, that unit, and the quantity it measures.
type Meaning = (f64, &'static str, Quantity);

/// The unit of counts, whose size in SI units nobody has said.
pub(crate) const COUNTS: &str = "counts";

/// Derivatives of motion by their order: the quantity, and its unit for lengths and for angles.
pub(crate) const MOTIONS: [(Quantity, [&str; 2]); 3] = [
    (Quantity::Displacement, ["m", "rad"]),
    (Quantity::Velocity, ["m/s", "rad/s"]),
    (Quantity::Acceleration, ["m/s²", "rad/s²"]),
];

/// Standard acceleration of free fall (m/s²).
const FREE_FALL: f64 = 9.806_65;
const INCH: f64 = 0.0254;
const FOOT: f64 = 0.3048;
const DEGREE: f64 = PI / 180.0;

/// Lengths (m).
const LENGTHS: [(&str, f64); 20] = [
    ("m", 1.0),
    ("km", 1e3),
    ("dm", 1e-1),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("mic", 1e-6),
    ("micron", 1e-6),
    ("microns", 1e-6),
    ("nm", 1e-9),
    ("in", INCH),
    ("inch", INCH),
    ("inches", INCH),
    ("mil", 1e-3 * INCH),
    ("mils", 1e-3 * INCH),
    ("thou", 1e-3 * INCH),
    ("ft", FOOT),
    ("foot", FOOT),
    ("feet", FOOT),
    ("mi", 1609.344),
];

/// Prefixes of metres in full.
const PREFIXES: [(&str, f64); 7] =
    [("", 1.0), ("kilo", 1e3), ("deci", 1e-1), ("centi", 1e-2), ("milli", 1e-3), ("micro", 1e-6), ("nano", 1e-9)];

/// Angles (rad).
const ANGLES: [(&str, f64); 18] = [
    ("rad", 1.0),
    ("rads", 1.0),
    ("radian", 1.0),
    ("radians", 1.0),
    ("mrad", 1e-3),
    ("urad", 1e-6),
    ("deg", DEGREE),
    ("degs", DEGREE),
    ("degree", DEGREE),
    ("degrees", DEGREE),
    ("mdeg", 1e-3 * DEGREE),
    ("arcmin", DEGREE / 60.0),
    ("arcsec", DEGREE / 3600.0),
    ("rev", TAU),
    ("revs", TAU),
    ("revolution", TAU),
    ("revolutions", TAU),
    ("turns", TAU),
];

/// Times that a motion is counted per (s).
const TIMES: [(&str, f64); 11] = [
    ("s", 1.0),
    ("sec", 1.0),
    ("second", 1.0),
    ("seconds", 1.0),
    ("ms", 1e-3),
    ("min", 60.0),
    ("minute", 60.0),
    ("minutes", 60.0),
    ("h", 3600.0),
    ("hr", 3600.0),
    ("hour", 3600.0),
];

/// Units of motion with a name of their own.
const NAMED: [(&str, Meaning); 12] = [
    ("mps", (1.0, "m/s", Quantity::Velocity)),
    ("kph", (1e3 / 3600.0, "m/s", Quantity::Velocity)),
    ("kmh", (1e3 / 3600.0, "m/s", Quantity::Velocity)),
    ("mph", (1609.344 / 3600.0, "m/s", Quantity::Velocity)),
    ("ips", (INCH, "m/s", Quantity::Velocity)),
    ("rpm", (TAU / 60.0, "rad/s", Quantity::Velocity)),
    ("dps", (DEGREE, "rad/s", Quantity::Velocity)),
    ("mdps", (1e-3 * DEGREE, "rad/s", Quantity::Velocity)),
    ("g", (FREE_FALL, "m/s²", Quantity::Acceleration)),
    ("gn", (FREE_FALL, "m/s²", Quantity::Acceleration)),
    ("g0", (FREE_FALL, "m/s²", Quantity::Acceleration)),
    ("mg", (1e-3 * FREE_FALL, "m/s²", Quantity::Acceleration)),
];

/// Symbols of other units, in which capitals matter.
const SYMBOLS: [(&str, Meaning); 18] = [
    ("N", (1.0, "N", Quantity::Force)),
    ("kN", (1e3, "N", Quantity::Force)),
    ("MN", (1e6, "N", Quantity::Force)),
    ("daN", (1e1, "N", Quantity::Force)),
    ("mN", (1e-3, "N", Quantity::Force)),
    ("uN", (1e-6, "N", Quantity::Force)),
    ("lbf", (4.448_221_615_260_5, "N", Quantity::Force)),
    ("kgf", (FREE_FALL, "N", Quantity::Force)),
    ("Nm", (1.0, "N m", Quantity::Force)),
    ("mNm", (1e-3, "N m", Quantity::Force)),
    ("kNm", (1e3, "N m", Quantity::Force)),
    ("Nmm", (1e-3, "N m", Quantity::Force)),
    ("V", (1.0, "V", Quantity::Other)),
    ("mV", (1e-3, "V", Quantity::Other)),
    ("uV", (1e-6, "V", Quantity::Other)),
    ("kV", (1e3, "V", Quantity::Other)),
    ("A", (1.0, "A", Quantity::Other)),
    ("mA", (1e-3, "A", Quantity::Other)),
];

/// Words for other units, in any case.
const WORDS: [(&str, Meaning); 13] = [
    ("newton", (1.0, "N", Quantity::Force)),
    ("newtons", (1.0, "N", Quantity::Force)),
    ("volt", (1.0, "V", Quantity::Other)),
    ("volts", (1.0, "V", Quantity::Other)),
    ("count", (1.0, COUNTS, Quantity::Other)),
    ("counts", (1.0, COUNTS, Quantity::Other)),
    ("cts", (1.0, COUNTS, Quantity::Other)),
    ("tick", (1.0, COUNTS, Quantity::Other)),
    ("ticks", (1.0, COUNTS, Quantity::Other)),
    ("pulse", (1.0, COUNTS, Quantity::Other)),
    ("pulses", (1.0, COUNTS, Quantity::Other)),
    ("lsb", (1.0, COUNTS, Quantity::Other)),
    ("lsbs", (1.0, COUNTS, Quantity::Other)),
];

/// Units of motion in small letters that are no such units in capitals: gauss, megagram, newton metre.
const SMALL_ONLY: [&str; 4] = ["g", "gn", "mg", "nm"];

/// Meaning of a spelling, if it is one of a unit.
pub(crate) fn meaning(text: &str) -> Option<Meaning> {
    let text = tidy(text);
    let lower = text.to_lowercase();
    let joined: String = text.split_whitespace().collect();
    motion(&text)
        .or_else(|| entry(&SYMBOLS, &joined))
        .or_else(|| entry(&WORDS, &lower))
        .or_else(|| if SMALL_ONLY.contains(&lower.trim()) { None } else { motion(&lower) })
}

fn entry<T: Copy>(table: &[(&str, T)], text: &str) -> Option<T> {
    table.iter().find(|(known, _)| *known == text).map(|(_, found)| *found)
}

/// Signs in one spelling: `u` for micro, `2` for squares, `-` for minus, `deg` for °, a space for products.
fn tidy(text: &str) -> String {
    let mut tidy = String::with_capacity(text.len());
    for sign in text.replace("**", "^").replace(" per ", "/").trim().chars() {
        match sign {
            'µ' | 'μ' => tidy.push('u'),
            '²' => tidy.push('2'),
            '¹' => tidy.push('1'),
            '⁻' | '−' => tidy.push('-'),
            '∕' | '⁄' => tidy.push('/'),
            '°' | 'º' => tidy.push_str("deg"),
            '^' | '(' | ')' => {}
            '·' | '⋅' | '*' | '.' => tidy.push(' '),
            sign => tidy.push(sign),
        }
    }
    tidy
}

/// A length or an angle, alone, per time or per time squared.
fn motion(tidy: &str) -> Option<Meaning> {
    if let Some(named) = entry(&NAMED, tidy) {
        return Some(named);
    }
    let parts: Vec<&str> = tidy.split('/').map(str::trim).collect();
    let (base, per, order) = match parts[..] {
        // Products, as m s-2 or ms-2.
        [whole] => match (whole.strip_suffix("s-1"), whole.strip_suffix("s-2")) {
            (Some(base), _) => (base, "s", 1),
            (_, Some(base)) => (base, "s", 2),
            _ => (whole, "s", 0),
        },
        [base, per] => per.strip_suffix('2').map_or((base, per, 1), |per| (base, per, 2)),
        [base, per, again] if per == again => (base, per, 2),
        _ => return None,
    };
    let base = base.trim_end();
    let (size, angular) = match (length(base), entry(&ANGLES, base)) {
        (Some(length), _) => (length, false),
        (None, Some(angle)) => (angle, true),
        (None, None) => return None,
    };
    let (quantity, units) = MOTIONS[order];
    let time = entry(&TIMES, per.trim_end())?;
    Some((size / [1.0, time, time * time][order], units[usize::from(angular)], quantity))
}

/// A length (m) by its symbol or its name.
fn length(base: &str) -> Option<f64> {
    let in_full = || {
        let stem = base.strip_suffix('s').unwrap_or(base);
        let prefix = stem.strip_suffix("meter").or_else(|| stem.strip_suffix("metre"))?;
        entry(&PREFIXES, prefix)
    };
    entry(&LENGTHS, base).or_else(in_full)
}
