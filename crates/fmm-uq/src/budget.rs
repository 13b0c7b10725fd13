//! The uncertainty of a result and where it comes from.

use crate::{Input, Inputs, UncertaintyError, coverage_factor};

/// The result of a propagation: estimate, combined standard uncertainty, and the share of every input.
///
/// | symbol | method | meaning |
/// |---|---|---|
/// | y | [`Budget::estimate`] | the model at the estimates of the inputs |
/// | u(y) | [`Budget::standard_uncertainty`] | combined standard uncertainty, first order |
/// | ν_eff | [`Budget::effective_degrees_of_freedom`] | how well u(y) is known |
/// | c_i, c_i u_i | [`Budget::contributions`] | sensitivity and signed contribution of each input |
/// | U | [`Budget::expanded`] | half width of an interval of given coverage probability |
///
/// It prints as a table, with a line of warning where [`Budget::linearisation_suspect`].
///
/// ```
/// use fmm_uq::{Input, Inputs, propagate};
///
/// let inputs = Inputs::new([
///     Input::new("force", 1.75, 0.03, "N")?.with_degrees_of_freedom(8.0)?,
///     Input::new("load", 7.0, 0.07, "N")?,
/// ])?;
/// let budget = propagate(&inputs, |x| x[0] / x[1])?.named("friction_coefficient", "1");
/// assert_eq!(budget.to_string(), "\
/// friction_coefficient = 0.25, u = 0.00496, ν_eff = 14.4
///
/// input  value     u  unit  ν  sensitivity    |c| u   share
/// force   1.75  0.03     N  8       0.1429  0.00429  74.6 %
/// load       7  0.07     N  ∞     -0.03571   0.0025  25.4 %
/// ");
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    inputs: Inputs,
    estimate: f64,
    sensitivities: Vec<f64>,
    standard_uncertainty: f64,
    name: String,
    unit: String,
}

/// What one input contributes to the uncertainty of the result.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Contribution<'a> {
    /// The input.
    pub input: &'a Input,
    /// c, derivative of the result with respect to the input (unit of the result by unit of the input).
    pub sensitivity: f64,
    /// |c| u, standard uncertainty of the result due to this input alone (unit of the result).
    pub uncertainty: f64,
    /// Share of the variance (1): `c_i u_i Σⱼ r_ij c_j u_j / u²(y)`. The shares add up to 1; that of an input
    /// whose correlation lowers the uncertainty may be negative. All are 0 if u(y) is 0.
    pub share: f64,
}

/// A symmetric coverage interval y ± U.
#[derive(Debug, Clone, Copy, PartialEq)]
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
}

impl Budget {
    /// Combines sensitivities, one for each input.
    pub(crate) fn new(inputs: Inputs, estimate: f64, sensitivities: Vec<f64>) -> Result<Self, UncertaintyError> {
        let (name, unit) = ("result".to_owned(), String::new());
        let mut budget = Self { inputs, estimate, sensitivities, standard_uncertainty: 0.0, name, unit };
        budget.standard_uncertainty = budget.combined();
        if budget.standard_uncertainty.is_finite() {
            Ok(budget)
        } else {
            let (value, unit) = (budget.standard_uncertainty, "(unit of the result)".to_owned());
            Err(UncertaintyError::UncertaintyOutOfRange { input: "the result".to_owned(), value, unit })
        }
    }

    /// The same budget with a name and a unit for the result, `"1"` for a pure number; both appear in the table.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>, unit: impl Into<String>) -> Self {
        self.name = name.into();
        self.unit = unit.into();
        self
    }

    /// Name of the result, "result" unless given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Unit of the result, empty unless given.
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// The inputs that the budget rests on.
    pub fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// y, estimate of the result.
    pub fn estimate(&self) -> f64 {
        self.estimate
    }

    /// u(y), combined standard uncertainty to first order; a sum that cancels to within its rounding is 0.
    pub fn standard_uncertainty(&self) -> f64 {
        self.standard_uncertainty
    }

    /// The contributions of all inputs, in their order.
    pub fn contributions(&self) -> impl Iterator<Item = Contribution<'_>> {
        self.inputs.as_slice().iter().enumerate().map(|(i, input)| {
            let scale = self.standard_uncertainty;
            let share = |j| self.inputs.correlation_at(i, j) * (self.signed(j) / scale);
            Contribution {
                input,
                sensitivity: self.sensitivities[i],
                uncertainty: self.signed(i).abs(),
                share: if scale > 0.0 {
                    self.signed(i) / scale * (0..self.sensitivities.len()).map(share).sum::<f64>()
                } else {
                    0.0
                },
            }
        })
    }

    /// Whether u(y) is zero although an input is uncertain.
    ///
    /// The model is then flat at the estimates, or its slopes cancel, and a linear approximation cannot see what
    /// the inputs do to the result: x² at x = 0 is the plainest case. The true uncertainty is of second order
    /// and not zero, unless the model does not depend on its uncertain inputs at all.
    pub fn linearisation_suspect(&self) -> bool {
        self.standard_uncertainty == 0.0
            && self.inputs.as_slice().iter().any(|input| input.standard_uncertainty() > 0.0)
    }

    /// ν_eff, effective degrees of freedom of u(y) (1), possibly infinite.
    ///
    /// ```text
    /// ν_eff = u⁴(y) / Σᵢ (c_i u_i)⁴/ν_i                                (JCGM 100:2008, Eq. G.2b)
    /// ```
    ///
    /// None where the Welch–Satterthwaite formula does not hold: if an input of finite degrees of freedom is
    /// correlated with another, both with a contribution; and if [`Budget::linearisation_suspect`]. Correlation
    /// among inputs of infinite degrees of freedom does no harm.
    pub fn effective_degrees_of_freedom(&self) -> Option<f64> {
        let inputs = self.inputs.as_slice();
        let mut pairs = self.inputs.correlated_pairs();
        let correlated = pairs.any(|(i, j)| {
            let finite = [i, j].iter().any(|&at| inputs[at].degrees_of_freedom().is_finite());
            finite && self.signed(i) != 0.0 && self.signed(j) != 0.0
        });
        if correlated || self.linearisation_suspect() {
            return None;
        }
        let contributing = inputs.iter().enumerate().filter(|&(i, _)| self.signed(i) != 0.0);
        let terms = contributing
            .map(|(i, input)| (self.signed(i) / self.standard_uncertainty).powi(4) / input.degrees_of_freedom());
        // The sum of no term at all is −0, whose reciprocal would be −∞.
        Some(1.0 / terms.sum::<f64>().abs())
    }

    /// The expanded uncertainty for a coverage probability `level`, from Student's t at ν_eff.
    ///
    /// ν_eff is truncated to the next lower whole number, as JCGM 100:2008, G.4.1 and example H.1 do, which never
    /// makes the interval too short; [`coverage_factor`] at ν_eff itself interpolates instead.
    ///
    /// # Errors
    /// [`UncertaintyError::LevelOutOfRange`] unless 0 < level < 1; [`UncertaintyError::LinearisationSuspect`] and
    /// [`UncertaintyError::DegreesOfFreedomUndefined`] where there is no ν_eff.
    pub fn expanded(&self, level: f64) -> Result<Expanded, UncertaintyError> {
        if self.linearisation_suspect() {
            return Err(UncertaintyError::LinearisationSuspect);
        }
        let effective = self.effective_degrees_of_freedom().ok_or(UncertaintyError::DegreesOfFreedomUndefined)?;
        // A whole ν_eff may come out of the sum a rounding error too low, and must not lose a whole one for it.
        let degrees_of_freedom = (effective * (1.0 + 1e-12)).floor().max(1.0);
        let coverage_factor = coverage_factor(level, degrees_of_freedom)?;
        let uncertainty = coverage_factor * self.standard_uncertainty;
        Ok(Expanded { level, coverage_factor, uncertainty, degrees_of_freedom })
    }

    /// Covariance with another result of the same inputs (product of the two units).
    ///
    /// ```text
    /// u(y, z) = Σᵢ Σⱼ c_i d_j u_i u_j r_ij                             (JCGM 100:2008, Eq. H.9)
    /// ```
    ///
    /// Divided by both standard uncertainties it is their correlation coefficient.
    ///
    /// # Errors
    /// [`UncertaintyError::DifferentInputs`] if the inputs or their correlations differ.
    pub fn covariance_with(&self, other: &Self) -> Result<f64, UncertaintyError> {
        if self.inputs != other.inputs {
            return Err(UncertaintyError::DifferentInputs);
        }
        let n = self.sensitivities.len();
        let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        Ok(pairs.map(|(i, j)| self.signed(i) * self.inputs.correlation_at(i, j) * other.signed(j)).sum())
    }

    /// c_i u_i with its sign, which matters where inputs are correlated.
    fn signed(&self, i: usize) -> f64 {
        self.sensitivities[i] * self.inputs.as_slice()[i].standard_uncertainty()
    }

    fn combined(&self) -> f64 {
        let n = self.sensitivities.len();
        // Squares of very large or very small contributions stay in range when these are divided by the largest.
        let scale = (0..n).map(|i| self.signed(i).abs()).fold(0.0, f64::max);
        if scale == 0.0 {
            return 0.0;
        }
        let own: f64 = (0..n).map(|i| (self.signed(i) / scale).powi(2)).sum();
        let mutual: f64 = self
            .inputs
            .correlated_pairs()
            .map(|(i, j)| 2.0 * self.inputs.correlation_at(i, j) * (self.signed(i) / scale) * (self.signed(j) / scale))
            .sum();
        let variance = own + mutual;
        if variance > self.inputs.rounding() * own { scale * variance.sqrt() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dual, propagate};

    fn inputs(uncertainties: &[(&str, f64, f64)]) -> Inputs {
        let input = |&(name, u, nu): &(&str, f64, f64)| {
            Input::new(name, 0.0, u, "m").unwrap().with_degrees_of_freedom(nu).unwrap()
        };
        Inputs::new(uncertainties.iter().map(input)).unwrap()
    }

    fn sum(x: &[Dual]) -> Dual {
        x.iter().copied().sum()
    }

    #[test]
    fn contributions_add_in_squares() {
        let budget = propagate(&inputs(&[("a", 3.0, 5.0), ("b", 4.0, f64::INFINITY)]), |x| x[0] - x[1]).unwrap();
        assert_eq!(budget.standard_uncertainty(), 5.0);
        let rows: Vec<_> = budget.contributions().map(|row| (row.sensitivity, row.uncertainty)).collect();
        assert_eq!(rows, [(1.0, 3.0), (-1.0, 4.0)]);
        // (5/3)⁴ · 5 by hand.
        assert!((budget.effective_degrees_of_freedom().unwrap() - 3125.0 / 81.0).abs() < 1e-12);
    }

    #[test]
    fn shares_add_up_to_one_and_may_be_negative() {
        let correlated = inputs(&[("a", 3.0, f64::INFINITY), ("b", 1.0, f64::INFINITY)])
            .with_correlations(&[("a", "b", -0.6)])
            .unwrap();
        let budget = propagate(&correlated, sum).unwrap();
        // u² = 9 + 1 − 2·0.6·3 = 6.4, of which a has 9 − 1.8 and b 1 − 1.8.
        assert!((budget.standard_uncertainty().powi(2) - 6.4).abs() < 1e-14);
        let shares: Vec<f64> = budget.contributions().map(|row| row.share).collect();
        assert!((shares[0] - 1.125).abs() < 1e-15 && (shares[1] + 0.125).abs() < 1e-15, "{shares:?}");
    }

    #[test]
    fn a_flat_model_is_flagged() {
        // JCGM 101:2008, 9.4 with x₁ = x₂ = 0: the true uncertainty is 5e-5, and the first-order one is zero.
        let flat = inputs(&[("x1", 0.005, f64::INFINITY), ("x2", 0.005, f64::INFINITY)]);
        let budget = propagate(&flat, |x| x[0] * x[0] + x[1] * x[1]).unwrap();
        assert!(budget.linearisation_suspect());
        assert_eq!((budget.standard_uncertainty(), budget.effective_degrees_of_freedom()), (0.0, None));
        assert!(matches!(budget.expanded(0.95), Err(UncertaintyError::LinearisationSuspect)));
        assert!(budget.to_string().contains("linear approximation"), "{budget}");
    }

    #[test]
    fn constants_have_no_uncertainty_and_no_flag() {
        let budget = propagate(&inputs(&[("a", 0.0, 5.0)]), |x| x[0] + 2.0).unwrap();
        assert!(!budget.linearisation_suspect());
        assert_eq!(budget.effective_degrees_of_freedom(), Some(f64::INFINITY));
        assert_eq!(budget.expanded(0.95).unwrap().uncertainty, 0.0);
    }

    #[test]
    fn cancellation_to_rounding_is_zero_and_flagged() {
        let full = inputs(&[("a", 0.1, f64::INFINITY), ("b", 0.3, f64::INFINITY)])
            .with_correlations(&[("a", "b", 1.0)])
            .unwrap();
        let budget = propagate(&full, |x| x[0] * 3.0 - x[1]).unwrap();
        assert_eq!(budget.standard_uncertainty(), 0.0);
        assert!(budget.linearisation_suspect());
    }

    #[test]
    fn correlated_inputs_of_finite_degrees_of_freedom_have_no_effective_ones() {
        let three = [("a", 1.0, 4.0), ("b", 1.0, f64::INFINITY), ("c", 1.0, f64::INFINITY)];
        let harmful = inputs(&three).with_correlations(&[("a", "b", 0.1)]).unwrap();
        let budget = propagate(&harmful, sum).unwrap();
        assert_eq!(budget.effective_degrees_of_freedom(), None);
        assert!(matches!(budget.expanded(0.95), Err(UncertaintyError::DegreesOfFreedomUndefined)));
        // b has no part in the result, so that its correlation has none either.
        assert_eq!(propagate(&harmful, |x| x[0]).unwrap().effective_degrees_of_freedom(), Some(4.0));
        let harmless = inputs(&three).with_correlations(&[("b", "c", 0.5)]).unwrap();
        // u² = 1 + 1 + 1 + 2·0.5 = 4, so ν_eff = 4²/(1/4) = 64.
        let effective = propagate(&harmless, sum).unwrap().effective_degrees_of_freedom().unwrap();
        assert!((effective - 64.0).abs() < 1e-12, "{effective}");
    }

    #[test]
    fn whole_degrees_of_freedom_survive_truncation() {
        for nu in 1..=200 {
            let alone = inputs(&[("a", 0.1, f64::from(nu)), ("b", 0.0, 1.0)]);
            let expanded = propagate(&alone, |x| x[0] * 0.3 + x[1]).unwrap().expanded(0.95).unwrap();
            assert_eq!(expanded.degrees_of_freedom, f64::from(nu));
        }
    }

    #[test]
    fn squares_of_extreme_contributions_stay_in_range() {
        for size in [1e-200, 1e200] {
            let extreme = inputs(&[("a", 3.0 * size, 5.0), ("b", 4.0 * size, 5.0)]);
            let u = propagate(&extreme, sum).unwrap().standard_uncertainty();
            assert!((u / size - 5.0).abs() < 1e-14, "u = {u} m");
        }
    }

    #[test]
    fn an_uncertainty_out_of_range_is_refused() {
        let huge = inputs(&[("a", 1.5e308, 5.0), ("b", 1.5e308, 5.0)]);
        let message = propagate(&huge, sum).unwrap_err().to_string();
        assert!(message.starts_with("the standard uncertainty of the result"), "{message}");
    }

    #[test]
    fn covariance_needs_the_same_inputs() {
        let one = inputs(&[("a", 3.0, f64::INFINITY), ("b", 4.0, f64::INFINITY)]);
        let (plus, minus) = (propagate(&one, sum).unwrap(), propagate(&one, |x| x[0] - x[1]).unwrap());
        assert_eq!(plus.covariance_with(&minus).unwrap(), 9.0 - 16.0);
        let other = propagate(&inputs(&[("a", 3.0, 5.0), ("b", 4.0, 5.0)]), sum).unwrap();
        assert!(matches!(plus.covariance_with(&other), Err(UncertaintyError::DifferentInputs)));
    }
}
