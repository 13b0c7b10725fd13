//! Prediction of the findings of a set of tests.

use std::fmt;

use fmm_fit::design::Information;
use fmm_fit::{EstimateStatus, NullDirection};
use fmm_model::Parameter;

use crate::design::{Guess, local};
use crate::error::IdentifyError;
use crate::finding::{Finding, Origin, Source};

/// A quantity that tests would find, as a combination of shared parameters and errors of inputs.
#[derive(Debug, Clone)]
pub(crate) struct Quantity {
    pub(crate) parameter: Parameter,
    pub(crate) value: f64,
    pub(crate) gradient: Vec<f64>,
    /// It is a parameter of the fit.
    pub(crate) is_fitted: bool,
}

/// Prediction for a set of tests: guessed values with the standard uncertainties that the tests would give them.
///
/// `Display` gives a table, close correlations, and directions that stay free.
#[derive(Debug, Clone)]
pub struct DesignPrediction {
    findings: Vec<Finding>,
    quantities: Vec<Quantity>,
    information: Information,
    free: Vec<NullDirection>,
    law: &'static str,
}

/// Correlation above which a pair is named (1). Chosen.
const CLOSE: f64 = 0.9;

impl DesignPrediction {
    pub(crate) fn new(
        guess: &Guess,
        quantities: Vec<Quantity>,
        information: Information,
    ) -> Result<Self, IdentifyError> {
        let law = guess.model.law_name();
        let failed = |source| local::design_error(law, source);
        let mut findings = Vec::with_capacity(quantities.len());
        for quantity in &quantities {
            let variance = information.variance(&quantity.gradient).map_err(failed)?;
            let is_held = quantity.is_fitted && quantity.parameter.bounds().is_fixed();
            let origin = match (quantity.is_fitted, variance) {
                _ if is_held => Origin::Fitted(EstimateStatus::Fixed),
                (true, Some(_)) => Origin::Fitted(EstimateStatus::Determined),
                (true, None) => Origin::Fitted(EstimateStatus::Undetermined),
                (false, _) => Origin::Derived,
            };
            // Noise and errors of inputs together: a prediction does not separate them.
            let variances = variance.filter(|_| !is_held).map(|variance| vec![(Source::Residuals, variance)]);
            let Quantity { parameter, value, .. } = quantity;
            findings.push(Finding::new(parameter.clone(), *value, variances, f64::INFINITY, origin, false));
        }
        let inputs = information.order() - guess.parameters.len();
        let errors = (0..inputs).map(|_| Parameter::new("error of an input", "ξ", "1"));
        let parameters: Vec<Parameter> = guess.parameters.iter().cloned().chain(errors).collect();
        let values: Vec<f64> = guess.values.iter().copied().chain((0..inputs).map(|_| 0.0)).collect();
        let free = information.null_directions(&parameters, &values).map_err(failed)?;
        Ok(Self { findings, quantities, information, free, law })
    }

    /// All findings: parameters that the tests share, then quantities that follow from them and the machine.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// The finding of this name, such as `"mu"`.
    pub fn finding(&self, name: &str) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.parameter().name() == name)
    }

    /// u/|value| of the finding of this name (1); `None` if the tests do not determine it or it is zero.
    pub fn relative_uncertainty(&self, name: &str) -> Option<f64> {
        let finding = self.finding(name)?;
        finding.uncertainty().map(|u| u / finding.value().abs()).filter(|relative| relative.is_finite())
    }

    /// r, the correlation of two findings (1); `None` if the tests do not determine both.
    ///
    /// # Errors
    /// [`IdentifyError::UnknownName`] for a name that no finding has.
    pub fn correlation(&self, first: &str, second: &str) -> Result<Option<f64>, IdentifyError> {
        let [a, b] = [self.quantity(first)?, self.quantity(second)?];
        let covariance = |a: &Quantity, b: &Quantity| {
            let covariance = self.information.covariance(&a.gradient, &b.gradient);
            covariance.map_err(|source| local::design_error(self.law, source))
        };
        let Some(both) = covariance(a, b)? else { return Ok(None) };
        let variances = covariance(a, a)?.zip(covariance(b, b)?);
        Ok(variances.map(|(a, b)| both / (a * b).sqrt()).filter(|r| r.is_finite()))
    }

    fn quantity(&self, name: &str) -> Result<&Quantity, IdentifyError> {
        let found = self.quantities.iter().find(|quantity| quantity.parameter.name() == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = self.quantities.iter().map(|quantity| quantity.parameter.name()).collect();
            IdentifyError::unknown_parameter(name, &names.join(", "))
        })
    }

    /// Pairs of parameters of the fit that the tests hardly separate, with their correlation, the closest first.
    pub fn close_pairs(&self) -> Vec<(&str, &str, f64)> {
        let fitted: Vec<&Quantity> = self.quantities.iter().filter(|quantity| quantity.is_fitted).collect();
        let names = fitted.iter().map(|quantity| quantity.parameter.name());
        let names: Vec<&str> = names.collect();
        let pairs = (0..names.len()).flat_map(|i| (i + 1..names.len()).map(move |j| (i, j)));
        let correlated = pairs.filter_map(|(i, j)| {
            let r = self.correlation(names[i], names[j]).ok().flatten()?;
            (r.abs() > CLOSE).then_some((names[i], names[j], r))
        });
        let mut close: Vec<(&str, &str, f64)> = correlated.collect();
        close.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
        close
    }

    /// Number of directions of the shared parameters that the tests and prior knowledge determine.
    pub fn rank(&self) -> usize {
        self.quantities.iter().filter(|quantity| quantity.is_fitted).count() - self.free.len()
    }

    /// Directions of the parameters that stay free.
    pub fn null_directions(&self) -> &[NullDirection] {
        &self.free
    }
}

impl fmt::Display for DesignPrediction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for finding in &self.findings {
            let (name, symbol) = (finding.parameter().name(), finding.parameter().symbol());
            write!(f, "  {name} {symbol} = {}", finding.quantity())?;
            match (finding.uncertainty(), finding.origin()) {
                (_, Origin::Fitted(EstimateStatus::Fixed)) => writeln!(f, " (held)")?,
                (None, _) => writeln!(f, " (not determined)")?,
                (Some(u), _) if finding.value() != 0.0 => {
                    writeln!(f, " ({:.2} %)", 100.0 * u / finding.value().abs())?;
                }
                _ => writeln!(f)?,
            }
        }
        for (first, second, r) in self.close_pairs() {
            writeln!(f, "  hardly separable: {first} and {second}, r = {r:.4}")?;
        }
        for direction in &self.free {
            writeln!(f, "  stays free: {direction}")?;
        }
        Ok(())
    }
}
