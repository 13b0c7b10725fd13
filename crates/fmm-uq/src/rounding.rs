//! Numbers as they are stated: to the digits that their uncertainty leaves them.

/// Significant digits of a stated uncertainty (JCGM 100:2008, 7.2.6: at most two).
const STATED: u32 = 2;

/// The decimal place that a result is rounded to: that of the second digit of its standard uncertainty.
///
/// Estimate, uncertainty, expanded uncertainty and the ends of intervals all end at it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rounding {
    /// Exponent of ten of the last digit; `None` for an uncertainty of zero, which rounds nothing.
    last: Option<i32>,
}

impl Rounding {
    /// The place for a standard uncertainty.
    pub(crate) fn of(standard_uncertainty: f64) -> Self {
        let is_stated = standard_uncertainty > 0.0 && standard_uncertainty.is_finite();
        Self { last: if is_stated { last_place(standard_uncertainty, STATED) } else { None } }
    }

    /// A number rounded to the place, with zeros up to it.
    pub(crate) fn number(self, value: f64) -> String {
        let text = match self.last {
            None => significant(value, 10),
            Some(last @ -9..=0) => format!("{value:.*}", last.unsigned_abs() as usize),
            Some(last @ 1..=9) => {
                let unit = 10_f64.powi(last);
                format!("{:.0}", (value / unit).round() * unit)
            }
            Some(last) => {
                let exponent = if value == 0.0 { last } else { value.abs().log10().floor() as i32 };
                format!("{value:.*e}", usize::try_from(exponent - last).unwrap_or(0))
            }
        };
        // A number that rounds to nothing has no sign.
        if text.starts_with('-') && text.parse::<f64>().is_ok_and(|number| number == 0.0) {
            text.trim_start_matches('-').to_owned()
        } else {
            text
        }
    }
}

/// Exponent of ten of the last of so many significant digits of a finite number.
pub(crate) fn last_place(value: f64, digits: u32) -> Option<i32> {
    // The exponent is that of the rounded number: 0.996 to two digits is 1.0.
    let text = format!("{value:.*e}", digits as usize - 1);
    let exponent: i32 = text.split_once('e')?.1.parse().ok()?;
    Some(exponent + 1 - digits.cast_signed())
}

/// "area = 2.00 m², u = 0.28 m²".
pub(crate) fn with_uncertainty(name: &str, estimate: f64, standard_uncertainty: f64, unit: &str) -> String {
    let (rounding, unit) = (Rounding::of(standard_uncertainty), suffix(unit));
    let [y, u] = [estimate, standard_uncertainty].map(|value| rounding.number(value));
    format!("{name} = {y}{unit}, u = {u}{unit}")
}

/// `value` to `digits` significant digits without trailing zeros, with an exponent where it would be long.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    let decimals = usize::try_from(digits - 1).unwrap_or(0);
    let near: f64 = format!("{value:.decimals$e}").parse().unwrap_or(value);
    if near == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e9).contains(&near.abs()) {
        format!("{near}")
    } else {
        format!("{near:e}")
    }
}

/// Degrees of freedom, "∞" for infinite ones.
pub(crate) fn degrees(nu: f64) -> String {
    if nu.is_infinite() { "∞".to_owned() } else { significant(nu, 3) }
}

/// " nm", or nothing for a pure number.
pub(crate) fn suffix(unit: &str) -> String {
    if matches!(unit, "" | "1") { String::new() } else { format!(" {unit}") }
}

/// "95 %" for 0.95.
pub(crate) fn percent(level: f64) -> String {
    format!("{} %", significant(100.0 * level, 10))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_ends_at_the_second_digit_of_its_uncertainty() {
        for (u, value, stated) in [
            (0.004_959, 0.25, "0.2500"),
            (0.004_959, 0.010_81, "0.0108"),
            (31.71, 50_000_838.04, "50000838"),
            (0.996, 12.345_6, "12.3"),
            (1234.0, 56_789.0, "56800"),
            (1.2e-12, 3.456_78e-9, "3.4568e-9"),
            (0.29, -0.04, "-0.04"),
            (0.29, -0.004, "0.00"),
            (0.0, 9.806_65, "9.80665"),
        ] {
            assert_eq!(Rounding::of(u).number(value), stated, "{value} with u = {u}");
        }
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(significant(-0.0, 3), "0");
        assert_eq!(significant(-575.0072, 4), "-575");
        assert_eq!(significant(1.234e-7, 3), "1.23e-7");
        assert_eq!(degrees(f64::INFINITY), "∞");
        assert_eq!(degrees(16.656), "16.7");
        assert_eq!([percent(0.95), percent(0.9973)], ["95 %", "99.73 %"]);
        assert_eq!([suffix("1"), suffix("nm")], ["", " nm"]);
    }
}
