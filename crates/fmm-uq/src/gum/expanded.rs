//! From a budget to a coverage interval.

use std::fmt;

use crate::report::rounding::{Rounding, degrees, percent};
use crate::{Budget, Interval, Linearisation, UncertaintyError, coverage_factor};

/// A symmetric coverage interval y ± U.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Expanded {
    /// p, coverage probability (1).
    pub level: f64,
    /// k, coverage factor (1).
    pub coverage_factor: f64,
    /// U = k u(y), half width of the interval (unit of the result).
    pub uncertainty: f64,
    /// ν, degrees of freedom that the factor was taken at (1): ν_eff truncated to a whole number, or infinite.
    pub degrees_of_freedom: f64,
    /// y, centre of the interval (unit of the result).
    pub estimate: f64,
}

impl fmt::Display for Expanded {
    /// "838 ± 93 (k = 2.92, 99 %, ν = 16)", to the second digit of u.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounding = Rounding::of(self.uncertainty / self.coverage_factor);
        let [y, expanded] = [self.estimate, self.uncertainty].map(|value| rounding.number(value));
        let (k, level, nu) = (self.coverage_factor, percent(self.level), degrees(self.degrees_of_freedom));
        write!(f, "{y} ± {expanded} (k = {k:.2}, {level}, ν = {nu})")
    }
}

impl Expanded {
    /// The interval from y − U to y + U.
    pub const fn interval(&self) -> Interval {
        let (low, high) = (self.estimate - self.uncertainty, self.estimate + self.uncertainty);
        Interval { low, high, level: self.level }
    }
}

impl Budget {
    /// ν_eff, effective degrees of freedom of u(y) (1), possibly infinite.
    ///
    /// ```text
    /// ν_eff = u⁴(y) / Σᵢ (c_i u_i)⁴/ν_i                                (JCGM 100:2008, Eq. G.2b)
    /// ```
    ///
    /// An ensemble ([`Inputs::with_ensemble`](crate::Inputs::with_ensemble)) counts as one contribution, correlations
    /// within it included, which is exact: any linear function of simultaneous means has n − 1 degrees of freedom.
    ///
    /// `None` where the Welch–Satterthwaite formula does not hold: if an input of finite degrees of freedom is
    /// correlated with another outside its ensemble, both with a contribution; and if u(y) is zero although
    /// inputs are uncertain. Correlation among inputs of infinite degrees of freedom does no harm.
    pub fn effective_degrees_of_freedom(&self) -> Option<f64> {
        if self.standard_uncertainty() == 0.0 && self.linearisation() != Linearisation::ZeroUncertainty {
            return Some(f64::INFINITY);
        }
        let inputs = self.inputs().as_slice();
        let ensembles = self.inputs().ensembles();
        let ensemble = |i: usize| ensembles.iter().position(|e| e.members.contains(&i));
        let mut pairs = self.inputs().correlated_pairs();
        let correlated = pairs.any(|(i, j)| {
            let finite = [i, j].iter().any(|&at| inputs[at].degrees_of_freedom().is_finite());
            let together = ensemble(i).is_some() && ensemble(i) == ensemble(j);
            finite && !together && self.signed(i) != 0.0 && self.signed(j) != 0.0
        });
        if correlated || self.linearisation() == Linearisation::ZeroUncertainty {
            return None;
        }
        let relative = |i: usize| self.signed(i) / self.standard_uncertainty();
        let alone = (0..inputs.len()).filter(|&i| self.signed(i) != 0.0 && ensemble(i).is_none());
        let alone: f64 = alone.map(|i| relative(i).powi(4) / inputs[i].degrees_of_freedom()).sum();
        let joint = |e: &crate::inputs::Ensemble| {
            let pairs = e.members.iter().flat_map(|&i| e.members.iter().map(move |&j| (i, j)));
            let used = pairs.filter(|&(i, j)| self.signed(i) != 0.0 && self.signed(j) != 0.0);
            let share: f64 = used.map(|(i, j)| relative(i) * self.inputs().correlation_at(i, j) * relative(j)).sum();
            share * share / e.degrees_of_freedom
        };
        let joint: f64 = ensembles.iter().map(joint).sum();
        // The sum of no term at all is −0, whose reciprocal would be −∞.
        Some(1.0 / (alone + joint).abs())
    }

    /// The expanded uncertainty for a coverage probability `level`, from Student's t at ν_eff.
    ///
    /// ν_eff is truncated to the next lower whole number, as JCGM 100:2008, G.4.1 and example H.1 do, which never
    /// makes the interval too short; [`coverage_factor`] at ν_eff itself interpolates instead.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless 0 < level < 1; [`UncertaintyError::NoAnswer`] if u(y) is zero although
    /// inputs are uncertain, or if there is no ν_eff.
    pub fn expanded(&self, level: f64) -> Result<Expanded, UncertaintyError> {
        if self.linearisation() == Linearisation::ZeroUncertainty {
            return Err(UncertaintyError::linearisation_suspect());
        }
        let effective =
            self.effective_degrees_of_freedom().ok_or_else(UncertaintyError::degrees_of_freedom_undefined)?;
        self.expand(level, self.standard_uncertainty(), effective)
    }

    /// The expanded uncertainty from u(y) to second order, about the uncorrected estimate; at the ν_eff of the
    /// first order, or infinite degrees of freedom if u(y) is zero to first order.
    ///
    /// # Errors
    /// [`UncertaintyError::OutOfRange`] unless 0 < level < 1; [`UncertaintyError::NoAnswer`] where there is no ν_eff.
    pub fn expanded_to_second_order(&self, level: f64) -> Result<Expanded, UncertaintyError> {
        let terms = self.second_order().ok_or_else(UncertaintyError::no_second_order)?;
        let effective = if self.linearisation() == Linearisation::ZeroUncertainty {
            f64::INFINITY
        } else {
            self.effective_degrees_of_freedom().ok_or_else(UncertaintyError::degrees_of_freedom_undefined)?
        };
        self.expand(level, terms.standard_uncertainty, effective)
    }

    fn expand(&self, level: f64, standard_uncertainty: f64, effective: f64) -> Result<Expanded, UncertaintyError> {
        // A whole ν_eff may come out of the sum a rounding error too low, and must not lose a whole one for it.
        let degrees_of_freedom = (effective * (1.0 + 1e-12)).floor().max(1.0);
        let coverage_factor =
            coverage_factor(level, degrees_of_freedom).ok_or_else(|| UncertaintyError::level_out_of_range(level))?;
        let uncertainty = coverage_factor * standard_uncertainty;
        Ok(Expanded { level, coverage_factor, uncertainty, degrees_of_freedom, estimate: self.estimate() })
    }
}
