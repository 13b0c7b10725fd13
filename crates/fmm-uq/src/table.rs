//! A budget as text.

use std::fmt;

use crate::{Budget, Linearisation};

/// Significant digits of uncertainties and shares, and of a value down to its uncertainty.
const DIGITS: i32 = 3;
/// Significant digits of a sensitivity, which carries no uncertainty of its own to round it by.
const SENSITIVITY_DIGITS: i32 = 4;

impl fmt::Display for Budget {
    /// The result on one line, then the inputs as an aligned table, then their correlations and any warning.
    ///
    /// Values are rounded where their uncertainty is, so that the table never shows more than is known.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = if matches!(self.unit(), "" | "1") { String::new() } else { format!(" {}", self.unit()) };
        let (estimate, uncertainty) = (self.estimate(), self.standard_uncertainty());
        let value = rounded_by(estimate, uncertainty);
        write!(f, "{} = {value}{unit}, u = {}{unit}", self.name(), rounded(uncertainty, DIGITS))?;
        match self.effective_degrees_of_freedom() {
            Some(nu) => writeln!(f, ", ν_eff = {}\n", degrees(nu))?,
            None => writeln!(f, ", ν_eff undefined\n")?,
        }
        self.table(f)?;
        let inputs = self.inputs().as_slice();
        for (i, j) in self.inputs().correlated_pairs() {
            let coefficient = rounded(self.inputs().correlation_at(i, j), DIGITS);
            writeln!(f, "r({}, {}) = {coefficient}", inputs[i].name(), inputs[j].name())?;
        }
        let digits = |value| rounded(value, DIGITS);
        match self.linearisation() {
            Linearisation::Adequate | Linearisation::Unchecked => Ok(()),
            Linearisation::ZeroUncertainty => writeln!(
                f,
                "warning: u is zero although inputs are uncertain; the linear approximation cannot see what they do"
            ),
            Linearisation::UncertaintyDiffers(terms) => {
                writeln!(
                    f,
                    "warning: the model is curved; to second order u = {}{unit}",
                    digits(terms.standard_uncertainty)
                )
            }
            Linearisation::EstimateShifts(terms) => {
                writeln!(f, "warning: the model is curved and moves the estimate by {}{unit}", digits(terms.correction))
            }
            Linearisation::NotExpandable => {
                writeln!(f, "warning: within the uncertainties of its inputs the model is not what its derivatives say")
            }
        }
    }
}

impl Budget {
    fn table(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let header = ["input", "value", "u", "unit", "ν", "sensitivity", "|c| u", "share"].map(str::to_owned);
        let rows = self.contributions().map(|row| {
            [
                row.input.name().to_owned(),
                rounded_by(row.input.value(), row.input.standard_uncertainty()),
                rounded(row.input.standard_uncertainty(), DIGITS),
                row.input.unit().to_owned(),
                degrees(row.input.degrees_of_freedom()),
                rounded(row.sensitivity, SENSITIVITY_DIGITS),
                rounded(row.uncertainty, DIGITS),
                format!("{:.1} %", 100.0 * row.share),
            ]
        });
        let lines: Vec<[String; 8]> = std::iter::once(header).chain(rows).collect();
        let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
        let widths: [usize; 8] = std::array::from_fn(width);
        for line in &lines {
            write!(f, "{:<width$}", line[0], width = widths[0])?;
            for (cell, width) in line.iter().zip(widths).skip(1) {
                write!(f, "  {cell:>width$}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

fn degrees(nu: f64) -> String {
    if nu.is_infinite() { "∞".to_owned() } else { rounded(nu, DIGITS) }
}

/// `value` down to the last significant digit of its `uncertainty`; with ten digits if that is zero.
fn rounded_by(value: f64, uncertainty: f64) -> String {
    if value == 0.0 || uncertainty == 0.0 {
        return rounded(value, 10);
    }
    let digits = value.abs().log10().floor() - uncertainty.log10().floor() + f64::from(DIGITS);
    rounded(value, (digits as i32).clamp(1, 15))
}

/// `value` to `digits` significant digits without trailing zeros, with an exponent where it would be long.
fn rounded(value: f64, digits: i32) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_by_their_uncertainty() {
        assert_eq!(rounded_by(50_000_838.04, 31.711), "50000838");
        assert_eq!(rounded_by(219.846_511_9, 0.295_58), "219.847");
        assert_eq!(rounded_by(1.15e-5, 1.2e-6), "1.15e-5");
        assert_eq!(rounded_by(0.01, 25.0), "0.01");
        assert_eq!(rounded_by(-0.1, 0.41), "-0.1");
        assert_eq!(rounded_by(9.806_65, 0.0), "9.80665");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(rounded(-0.0, 3), "0");
        assert_eq!(rounded(-575.0072, 4), "-575");
        assert_eq!(rounded(1.234e-7, 3), "1.23e-7");
        assert_eq!(degrees(f64::INFINITY), "∞");
        assert_eq!(degrees(16.656), "16.7");
    }
}
