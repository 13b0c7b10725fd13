//! Summary of all diagnostics of the residuals of a fit, on one screen.

use std::fmt;

use crate::diagnostics::normality::{NormalityTest, anderson_darling};
use crate::diagnostics::residual_diagnostics::{autocorrelation_time, durbin_watson, effective_count};
use crate::diagnostics::runs_test::{RunsTest, runs_test};
use crate::result::fit::Fit;

/// What the residuals of a fit, in their order, say of the model that left them.
///
/// `Display` gives the figures and what they mean.
///
/// ```
/// use fmm_fit::ResidualDiagnostics;
///
/// let wave: Vec<f64> = (0..100).map(|i| (0.1 * f64::from(i)).sin()).collect();
/// let diagnostics = ResidualDiagnostics::of(&wave).unwrap();
/// assert!(diagnostics.runs().unwrap().p_value < 1e-15);
/// assert!(diagnostics.to_string().contains("the model misses something"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualDiagnostics {
    count: usize,
    mean: f64,
    rms: f64,
    largest: (usize, f64),
    durbin_watson: Option<f64>,
    autocorrelation_time: Option<f64>,
    effective_count: Option<f64>,
    runs: Option<RunsTest>,
    normality: Option<NormalityTest>,
}

/// Probabilities below this are called unlikely.
const UNLIKELY: f64 = 0.01;

impl ResidualDiagnostics {
    /// Looks at `residuals` in their order; `None` if there are none, or if one is not finite.
    pub fn of(residuals: &[f64]) -> Option<Self> {
        let count = residuals.len();
        let squares = residuals.iter().map(|r| r * r).sum::<f64>();
        if count == 0 || !squares.is_finite() {
            return None;
        }
        let larger = |largest: (usize, f64), next: (usize, f64)| {
            if next.1.abs() > largest.1.abs() { next } else { largest }
        };
        Some(Self {
            count,
            mean: residuals.iter().sum::<f64>() / count as f64,
            rms: (squares / count as f64).sqrt(),
            largest: residuals.iter().copied().enumerate().fold((0, 0.0), larger),
            durbin_watson: durbin_watson(residuals),
            autocorrelation_time: autocorrelation_time(residuals),
            effective_count: effective_count(residuals),
            runs: runs_test(residuals),
            normality: anderson_darling(residuals),
        })
    }

    /// Number of residuals.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Mean, in the unit of the residuals.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Root mean square, in the unit of the residuals.
    pub fn rms(&self) -> f64 {
        self.rms
    }

    /// Index and value of the residual of largest magnitude.
    pub fn largest(&self) -> (usize, f64) {
        self.largest
    }

    /// Durbin and Watson's statistic, see [`durbin_watson`].
    pub fn durbin_watson(&self) -> Option<f64> {
        self.durbin_watson
    }

    /// Integrated autocorrelation time in samples, see [`autocorrelation_time`].
    pub fn autocorrelation_time(&self) -> Option<f64> {
        self.autocorrelation_time
    }

    /// Number of independent residuals that tell as much, see [`effective_count`].
    pub fn effective_count(&self) -> Option<f64> {
        self.effective_count
    }

    /// The test of the runs of equal sign, see [`runs_test`].
    pub fn runs(&self) -> Option<RunsTest> {
        self.runs
    }

    /// The test of normality, see [`anderson_darling`].
    pub fn normality(&self) -> Option<NormalityTest> {
        self.normality
    }
}

impl Fit {
    /// What the residuals say of the model; `None` if the fit has no residuals.
    pub fn residual_diagnostics(&self) -> Option<ResidualDiagnostics> {
        ResidualDiagnostics::of(self.residuals())
    }
}

impl fmt::Display for ResidualDiagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (index, value) = self.largest;
        let multiple = if self.rms > 0.0 { value.abs() / self.rms } else { 0.0 };
        writeln!(f, "[[residuals]] {} residuals, rms {:.6e}, mean {:.3e}", self.count, self.rms, self.mean)?;
        writeln!(f, "  largest: number {index}, {value:.3e}, {multiple:.1} times the rms")?;
        if let (Some(d), Some(time), Some(count)) =
            (self.durbin_watson, self.autocorrelation_time, self.effective_count)
        {
            writeln!(f, "  Durbin–Watson {d:.3}, correlated over {time:.1} samples: they tell as {count:.0} would")?;
        }
        if let Some(test) = self.runs {
            let verdict = match (test.p_value < UNLIKELY, (test.runs as f64) < test.expected) {
                (false, _) => "as noise has",
                (true, true) => "too few: the model misses something, or the noise is correlated",
                (true, false) => "too many: neighbours alternate",
            };
            let (runs, expected, p) = (test.runs, test.expected, test.p_value);
            writeln!(f, "  {runs} runs of equal sign, {expected:.1} expected (p = {p:.2e}), {verdict}")?;
        }
        if let Some(test) = self.normality {
            let verdict = if test.p_value < UNLIKELY { "not normal" } else { "normal as far as can be told" };
            writeln!(f, "  Anderson–Darling {:.3} (p = {:.2e}), {verdict}", test.statistic, test.p_value)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_those_of_the_single_functions() {
        let values: Vec<f64> = (0..60).map(|i| (1.3 * f64::from(i * i)).sin()).collect();
        let diagnostics = ResidualDiagnostics::of(&values).unwrap();
        assert_eq!(diagnostics.runs(), runs_test(&values));
        assert_eq!(diagnostics.normality(), anderson_darling(&values));
        assert_eq!(diagnostics.durbin_watson(), durbin_watson(&values));
        let (index, value) = diagnostics.largest();
        assert_eq!(values[index], value);
        assert!(values.iter().all(|other| other.abs() <= value.abs()));
        assert!(diagnostics.to_string().contains("as noise has"), "{diagnostics}");
    }

    #[test]
    fn what_is_not_finite_is_refused() {
        assert_eq!(ResidualDiagnostics::of(&[]), None);
        assert_eq!(ResidualDiagnostics::of(&[1.0, f64::INFINITY]), None);
        let zeros = ResidualDiagnostics::of(&[0.0; 3]).unwrap();
        assert_eq!((zeros.rms(), zeros.runs(), zeros.normality()), (0.0, None, None));
        assert!(zeros.to_string().contains("rms 0"), "{zeros}");
    }
}
