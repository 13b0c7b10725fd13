//! Statement of a result found by trials.

use std::fmt;

use fmm_model::Interval;

use crate::error::UncertaintyError;
use crate::monte_carlo::MonteCarlo;
use crate::monte_carlo::adaptive::IntervalKind;
use crate::monte_carlo::output_sample::OutputSample;
use crate::rounding::{Rounding, percent, significant, suffix, with_uncertainty};

/// The result of a Monte Carlo for one of its outputs.
///
/// It prints with all figures rounded to the second digit of u, and with all that it takes to make the run again.
///
/// ```
/// use fmm_uq::{Adaptive, Input, Inputs, IntervalKind, MonteCarlo};
///
/// let inputs = Inputs::new([Input::new("a", 1.0, 0.1, "m")?, Input::new("b", 2.0, 0.2, "m")?])?;
/// let run = MonteCarlo::adaptive(&inputs, Adaptive::to_tolerance(0.005)?).with_seed(4);
/// let trials = run.run(|x| x[0] * x[1])?;
/// let statement = run.statement(&trials, 0, IntervalKind::Symmetric, 0.95)?.named("area", "m²");
/// assert_eq!(statement.to_string(), "\
/// area = 2.00 m², u = 0.28 m²
/// 95 % interval [1.47, 2.58] m² (symmetric)
/// 150000 trials, seed 4, stable to 0.005 m²");
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct TrialStatement {
    /// Name of the result, "result" unless given.
    pub name: String,
    /// Unit of the result, empty unless given.
    pub unit: String,
    /// y (unit of the result).
    pub estimate: f64,
    /// u(y) (unit of the result).
    pub standard_uncertainty: f64,
    /// Standard errors of y and of u(y) from the limited number of trials (unit of the result).
    pub standard_errors: [f64; 2],
    /// Ends and coverage probability (unit of the result).
    pub interval: Interval,
    /// Kind of the interval.
    pub kind: IntervalKind,
    /// Number of trials, failed ones included.
    pub trials: u64,
    /// Number of trials that failed; all figures are conditional on success.
    pub failed: u64,
    /// Seed of the run.
    pub seed: u64,
    /// Tolerance of an adaptive run (unit of the result); `None` for a fixed number of trials.
    pub tolerance: Option<f64>,
}

impl MonteCarlo<'_> {
    /// The result of a sample of this run, for one output (counted from 0) and an interval of given kind and coverage
    /// probability.
    ///
    /// # Errors
    /// Those of [`OutputSample::standard_uncertainty`] and of [`OutputSample::symmetric_interval`].
    pub fn statement(
        &self,
        sample: &OutputSample,
        output: usize,
        kind: IntervalKind,
        level: f64,
    ) -> Result<TrialStatement, UncertaintyError> {
        let standard_uncertainty = sample.standard_uncertainty(output)?;
        let interval = match kind {
            IntervalKind::Symmetric => sample.symmetric_interval(output, level)?,
            IntervalKind::Shortest => sample.shortest_interval(output, level)?,
        };
        let rule = self.rule().filter(|_| standard_uncertainty > 0.0);
        Ok(TrialStatement {
            name: "result".to_owned(),
            unit: String::new(),
            estimate: sample.estimate(output)?,
            standard_uncertainty,
            standard_errors: sample.standard_errors(output)?,
            interval,
            kind,
            trials: sample.trials(),
            failed: sample.failures().count(),
            seed: self.seed,
            tolerance: rule.map(|rule| rule.tolerance(standard_uncertainty)).transpose()?,
        })
    }
}

impl TrialStatement {
    /// The same with a name and a unit for the result, `"1"` for a pure number.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>, unit: impl Into<String>) -> Self {
        (self.name, self.unit) = (name.into(), unit.into());
        self
    }
}

impl fmt::Display for TrialStatement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (rounding, unit) = (Rounding::of(self.standard_uncertainty), suffix(&self.unit));
        let [low, high] = [self.interval.low, self.interval.high].map(|value| rounding.number(value));
        writeln!(f, "{}", with_uncertainty(&self.name, self.estimate, self.standard_uncertainty, &self.unit))?;
        let kind = match self.kind {
            IntervalKind::Symmetric => "symmetric",
            IntervalKind::Shortest => "shortest",
        };
        writeln!(f, "{} interval [{low}, {high}]{unit} ({kind})", percent(self.interval.level))?;
        write!(f, "{} trials, ", self.trials)?;
        if self.failed > 0 {
            write!(f, "{} of them failed, ", self.failed)?;
        }
        write!(f, "seed {}, ", self.seed)?;
        if let Some(tolerance) = self.tolerance {
            return write!(f, "stable to {}{unit}", significant(tolerance, 3));
        }
        let [y, u] = self.standard_errors.map(|error| significant(error, 2));
        write!(f, "standard errors of y and u {y}{unit} and {u}{unit}")
    }
}
