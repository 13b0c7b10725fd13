//! Text of a budget: table and statement.

use std::fmt;

use crate::error::UncertaintyError;
use crate::gum::budget::{Budget, Contribution};
use crate::gum::second_order::Linearisation;
use crate::rounding::{Rounding, degrees, percent, significant, suffix, with_uncertainty};

/// Significant digits of uncertainties and shares, and of a value down to its uncertainty.
const DIGITS: i32 = 3;
/// Significant digits of a sensitivity, which carries no uncertainty of its own to round it by.
const SENSITIVITY_DIGITS: i32 = 4;
/// Coverage probability of the statement below a printed budget; [`Budget::at_level`] prints others.
const LEVEL: f64 = 0.95;
/// Columns that hold words, which begin on the left.
const WORDS: [usize; 5] = [0, 2, 3, 4, 9];

/// Headings of the columns.
const HEADER: [&str; 12] =
    ["quantity", "estimate", "unit", "distribution", "type", "divisor", "u", "ν", "c", "unit of c", "|c| u", "share"];

/// The result of a budget with its expanded uncertainty.
///
/// It prints with all figures rounded to the second digit of u, and k and ν_eff beside them.
///
/// ```
/// use fmm_uq::{Input, Inputs, propagate};
///
/// let inputs = Inputs::new([
///     Input::new("force", 1.75, 0.03, "N")?.with_degrees_of_freedom(8.0)?,
///     Input::new("load", 7.0, 0.07, "N")?,
/// ])?;
/// let budget = propagate(&inputs, |x| x[0] / x[1])?.named("friction_coefficient", "1");
/// assert_eq!(budget.statement(0.95)?.to_string(), "\
/// friction_coefficient = 0.2500, u = 0.0050
/// U = 0.0106 (k = 2.14, 95 %, ν_eff = 14.4)");
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Statement {
    /// Name of the result.
    pub name: String,
    /// Unit of the result.
    pub unit: String,
    /// y (unit of the result).
    pub estimate: f64,
    /// u(y) (unit of the result).
    pub standard_uncertainty: f64,
    /// k (1).
    pub coverage_factor: f64,
    /// p, coverage probability (1).
    pub level: f64,
    /// ν_eff (1), `None` where it is infinite.
    pub effective_degrees_of_freedom: Option<f64>,
    /// U = k u(y) (unit of the result).
    pub expanded_uncertainty: f64,
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let expanded = Rounding::of(self.standard_uncertainty).number(self.expanded_uncertainty);
        let nu = degrees(self.effective_degrees_of_freedom.unwrap_or(f64::INFINITY));
        let (k, level) = (self.coverage_factor, percent(self.level));
        writeln!(f, "{}", with_uncertainty(&self.name, self.estimate, self.standard_uncertainty, &self.unit))?;
        write!(f, "U = {expanded}{} (k = {k:.2}, {level}, ν_eff = {nu})", suffix(&self.unit))
    }
}

impl fmt::Display for Budget {
    /// The inputs as an aligned table, their correlations, the result with its expanded uncertainty at 95 %, and any
    /// warning.
    ///
    /// Values are rounded where their uncertainty is, so that the table never shows more than is known.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(f, LEVEL)
    }
}

impl Budget {
    /// The printed budget with the expanded uncertainty for a coverage probability other than 95 %; without U unless
    /// 0 < level < 1.
    ///
    /// ```
    /// use fmm_uq::{Input, Inputs, propagate};
    ///
    /// let inputs = Inputs::new([Input::new("mass", 2.0, 0.01, "kg")?])?;
    /// let budget = propagate(&inputs, |x| x[0] * 9.81)?.named("weight", "N");
    /// assert!(budget.at_level(0.99).ends_with("U = 0.253 N (k = 2.58, 99 %, ν_eff = ∞)\n"));
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    pub fn at_level(&self, level: f64) -> String {
        let mut text = String::new();
        // A string takes all that is written to it.
        let _ = self.write(&mut text, level);
        text
    }

    fn write(&self, f: &mut impl fmt::Write, level: f64) -> fmt::Result {
        self.table(f)?;
        let inputs = self.inputs().as_slice();
        for (i, j) in self.inputs().correlated_pairs() {
            let coefficient = significant(self.inputs().correlation_at(i, j), DIGITS);
            writeln!(f, "r({}, {}) = {coefficient}", inputs[i].name(), inputs[j].name())?;
        }
        writeln!(f)?;
        let unit = suffix(self.unit());
        if let Ok(statement) = self.statement(level) {
            writeln!(f, "{statement}")?;
        } else {
            let stated = with_uncertainty(self.name(), self.estimate(), self.standard_uncertainty(), self.unit());
            writeln!(f, "{stated}\nno U: ν_eff undefined")?;
        }
        let digits = |value| significant(value, DIGITS);
        let warning = match self.linearisation() {
            Linearisation::Adequate | Linearisation::Unchecked => return Ok(()),
            Linearisation::ZeroUncertainty => {
                "u is zero although inputs are uncertain; the linear approximation cannot see their effect".to_owned()
            }
            Linearisation::UncertaintyDiffers(terms) => {
                format!("the model is curved; to second order u = {}{unit}", digits(terms.standard_uncertainty))
            }
            Linearisation::EstimateShifts(terms) => {
                format!("the model is curved and moves the estimate by {}{unit}", digits(terms.correction))
            }
            Linearisation::NotExpandable => {
                "within the uncertainties of its inputs the model departs from its derivatives".to_owned()
            }
        };
        writeln!(f, "warning: {warning}")
    }

    /// The result with its expanded uncertainty for a coverage probability.
    ///
    /// # Errors
    /// Those of [`Budget::expanded`].
    pub fn statement(&self, level: f64) -> Result<Statement, UncertaintyError> {
        let expanded = self.expanded(level)?;
        Ok(Statement {
            name: self.name().to_owned(),
            unit: self.unit().to_owned(),
            estimate: self.estimate(),
            standard_uncertainty: self.standard_uncertainty(),
            coverage_factor: expanded.coverage_factor,
            level,
            effective_degrees_of_freedom: self.effective_degrees_of_freedom().filter(|nu| nu.is_finite()),
            expanded_uncertainty: expanded.uncertainty,
        })
    }

    /// Unit of the result by that of an input.
    pub(crate) fn unit_of_sensitivity(&self, input: &str) -> String {
        let one = |unit: &str| matches!(unit, "" | "1");
        match (self.unit(), input) {
            (y, x) if one(x) && one(y) => "1".to_owned(),
            (y, x) if one(x) => y.to_owned(),
            (y, x) if y == x => "1".to_owned(),
            (y, x) => {
                let above = if one(y) { "1" } else { y };
                let composed = |unit: &str| unit.contains(|sign: char| "/·* ".contains(sign));
                match x.strip_prefix("1/") {
                    Some(below) if !composed(below) && one(y) => below.to_owned(),
                    Some(below) if !composed(below) => format!("{above}·{below}"),
                    _ if composed(x) => format!("{above}/({x})"),
                    _ => format!("{above}/{x}"),
                }
            }
        }
    }

    fn table(&self, f: &mut impl fmt::Write) -> fmt::Result {
        let rows = self.contributions().map(|row| self.cells(&row));
        let lines: Vec<[String; 12]> = std::iter::once(HEADER.map(str::to_owned)).chain(rows).collect();
        let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
        let widths: [usize; 12] = std::array::from_fn(width);
        for line in &lines {
            let pad = |(column, (cell, &width)): (usize, (&String, &usize))| {
                if WORDS.contains(&column) { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            };
            let cells: Vec<String> = line.iter().zip(&widths).enumerate().map(pad).collect();
            writeln!(f, "{}", cells.join("  ").trim_end())?;
        }
        Ok(())
    }

    fn cells(&self, row: &Contribution<'_>) -> [String; 12] {
        let input = row.input;
        [
            input.name().to_owned(),
            rounded_by(input.value(), input.standard_uncertainty()),
            input.unit().to_owned(),
            input.distribution().name().to_owned(),
            input.evaluation().to_string(),
            divisor(input.distribution().divisor()),
            significant(input.standard_uncertainty(), DIGITS),
            degrees(input.degrees_of_freedom()),
            significant(row.sensitivity, SENSITIVITY_DIGITS),
            self.unit_of_sensitivity(input.unit()),
            significant(row.uncertainty, DIGITS),
            format!("{:.1} %", 100.0 * row.share),
        ]
    }
}

/// "√3" where a divisor is the root of a small whole number.
fn divisor(value: f64) -> String {
    let square = (value * value).round();
    if value != value.round() && (2.0..=24.0).contains(&square) && (square.sqrt() / value - 1.0).abs() < 1e-12 {
        format!("√{square}")
    } else {
        significant(value, SENSITIVITY_DIGITS)
    }
}

/// `value` down to the last significant digit of its `uncertainty`; with ten digits if that is zero.
fn rounded_by(value: f64, uncertainty: f64) -> String {
    if value == 0.0 || uncertainty == 0.0 {
        return significant(value, 10);
    }
    let digits = value.abs().log10().floor() - uncertainty.log10().floor() + f64::from(DIGITS);
    significant(value, (digits as i32).clamp(1, 15))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gum::propagate;
    use crate::inputs::{Input, Inputs};

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
    fn divisors_are_roots_where_they_are() {
        assert_eq!([3_f64.sqrt(), 1.0, 24_f64.sqrt(), 1.7, 2.0].map(divisor), ["√3", "1", "√24", "1.7", "2"]);
    }

    #[test]
    fn sensitivities_have_the_unit_of_a_quotient() {
        let inputs = Inputs::new([Input::new("a", 1.0, 0.1, "m").unwrap()]).unwrap();
        let unit = |result: &str, input: &str| {
            propagate(&inputs, |x| x[0]).unwrap().named("y", result).unit_of_sensitivity(input)
        };
        assert_eq!(unit("mg", "kg/m³"), "mg/(kg/m³)");
        assert_eq!([unit("1", "N"), unit("nm", "1/K"), unit("1", "1/K")], ["1/N", "nm·K", "K"]);
        assert_eq!([unit("N", "N"), unit("N", "1"), unit("", "1")], ["1", "N", "1"]);
    }
}
