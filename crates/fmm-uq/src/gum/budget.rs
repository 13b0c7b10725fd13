//! Budget: the uncertainty of a result, its sources, and the intervals that follow.

use std::fmt;

use fmm_model::{Interval, coverage_factor};

use crate::error::UncertaintyError;
use crate::gum::derivatives::place;
use crate::gum::second_order::{Linearisation, SecondOrder};
use crate::inputs::{Ensemble, Input, Inputs};
use crate::rounding::{Rounding, degrees, percent};

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
/// It prints as a table with the [`Statement`](crate::Statement) for 95 % below, and a line of warning where the
/// [`Linearisation`] is suspect; with the feature `serde` it is a document with all digits.
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
/// quantity  estimate  unit  distribution  type  divisor     u  ν         c  unit of c    |c| u   share
/// force         1.75  N     t             B           1  0.03  8    0.1429  1/N        0.00429  74.6 %
/// load             7  N     normal        B           1  0.07  ∞  -0.03571  1/N         0.0025  25.4 %
///
/// friction_coefficient = 0.2500, u = 0.0050
/// U = 0.0106 (k = 2.14, 95 %, ν_eff = 14.4)
/// ");
/// # Ok::<(), fmm_uq::UncertaintyError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    inputs: Inputs,
    estimate: f64,
    sensitivities: Vec<f64>,
    standard_uncertainty: f64,
    second_order: Option<SecondOrder>,
    linearisation: Linearisation,
    name: String,
    unit: String,
}

/// Contribution of one input to the uncertainty of the result.
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
    /// The budget of an `estimate` of which the `sensitivities` are known, one for each input: of a fit, for example,
    /// or of a calculation elsewhere. Its linearisation is [`Linearisation::Unchecked`].
    ///
    /// ```
    /// use fmm_uq::{Budget, Input, Inputs};
    ///
    /// // A fitted coefficient: the noise of the fit, and the load, in which it has the slope −μ/N.
    /// let inputs = Inputs::new([
    ///     Input::new("noise of the fit", 0.0, 0.0004, "1")?.with_degrees_of_freedom(50.0)?,
    ///     Input::new("load", 6.67, 0.05, "N")?,
    /// ])?;
    /// let budget = Budget::new(inputs, 0.25, vec![1.0, -0.25 / 6.67])?.named("mu", "1");
    /// assert!((budget.standard_uncertainty() - 0.0004_f64.hypot(0.25 * 0.05 / 6.67)).abs() < 1e-15);
    /// # Ok::<(), fmm_uq::UncertaintyError>(())
    /// ```
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] for another number of sensitivities than inputs, or if the sum of finite
    /// contributions overflows; [`UncertaintyError::Model`] for a sensitivity that is not finite;
    /// [`UncertaintyError::NoAnswer`] if all contributions vanish by underflow.
    pub fn new(inputs: Inputs, estimate: f64, sensitivities: Vec<f64>) -> Result<Self, UncertaintyError> {
        if sensitivities.len() != inputs.as_slice().len() {
            let (found, needed) = (sensitivities.len(), inputs.as_slice().len());
            return Err(UncertaintyError::invalid(format!("{needed} inputs have {needed} sensitivities, not {found}")));
        }
        let mut budget = Self {
            inputs,
            estimate,
            sensitivities,
            standard_uncertainty: 0.0,
            second_order: None,
            linearisation: Linearisation::Unchecked,
            name: "result".to_owned(),
            unit: String::new(),
        };
        for (i, &sensitivity) in budget.sensitivities.iter().enumerate() {
            if !(sensitivity.is_finite() && budget.signed(i).is_finite()) {
                let inputs = budget.inputs.as_slice();
                let (input, at) = (inputs[i].name(), place(&budget.inputs, inputs.iter().map(Input::value)));
                let what = format!("the sensitivity to {input} is {sensitivity}, which cannot be propagated, at {at}");
                return Err(UncertaintyError::model(what));
            }
        }
        let acts = |(i, c): (usize, &f64)| *c != 0.0 && budget.inputs.as_slice()[i].standard_uncertainty() > 0.0;
        let largest = (0..budget.sensitivities.len()).map(|i| budget.signed(i).abs()).fold(0.0, f64::max);
        if largest < f64::MIN_POSITIVE && budget.sensitivities.iter().enumerate().any(acts) {
            return Err(UncertaintyError::too_small("the result"));
        }
        budget.standard_uncertainty = budget.combined();
        if budget.standard_uncertainty.is_finite() {
            Ok(budget)
        } else {
            let (value, unit) = (budget.standard_uncertainty, "(unit of the result)");
            Err(UncertaintyError::uncertainty_out_of_range("the result", value, unit))
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

    /// The second-order terms; `None` if they were not asked for or are not finite.
    pub const fn second_order(&self) -> Option<SecondOrder> {
        self.second_order
    }

    /// Validity of the linear approximation within the uncertainties of the inputs.
    pub const fn linearisation(&self) -> Linearisation {
        self.linearisation
    }

    pub(crate) fn set_curvature(&mut self, second_order: Option<SecondOrder>, verdict: Linearisation) {
        (self.second_order, self.linearisation) = (second_order, verdict);
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
    /// [`UncertaintyError::Invalid`] if the inputs or their correlations differ.
    pub fn covariance_with(&self, other: &Self) -> Result<f64, UncertaintyError> {
        if self.inputs != other.inputs {
            let what = "the two budgets do not rest on the same inputs, so that their covariance is not known";
            return Err(UncertaintyError::invalid(what));
        }
        let n = self.sensitivities.len();
        let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        Ok(pairs.map(|(i, j)| self.signed(i) * self.inputs.correlation_at(i, j) * other.signed(j)).sum())
    }

    /// c_i u_i with its sign, which matters where inputs are correlated.
    pub(crate) fn signed(&self, i: usize) -> f64 {
        self.sensitivities[i] * self.inputs.as_slice()[i].standard_uncertainty()
    }

    /// ν_eff, effective degrees of freedom of u(y) (1), possibly infinite.
    ///
    /// ```text
    /// ν_eff = u⁴(y) / Σᵢ (c_i u_i)⁴/ν_i                                (JCGM 100:2008, Eq. G.2b)
    /// ```
    ///
    /// An ensemble ([`Inputs::with_ensemble`]) counts as one contribution, correlations
    /// within it included, which is exact: any linear function of simultaneous means has n − 1 degrees of freedom.
    ///
    /// `None` where the Welch–Satterthwaite formula does not hold: if an input of finite degrees of freedom is
    /// correlated with another outside its ensemble, both with a contribution; and if u(y) is zero although
    /// inputs are uncertain. Correlation among inputs of infinite degrees of freedom does no harm.
    pub fn effective_degrees_of_freedom(&self) -> Option<f64> {
        if self.standard_uncertainty == 0.0 && self.linearisation != Linearisation::ZeroUncertainty {
            return Some(f64::INFINITY);
        }
        let inputs = self.inputs.as_slice();
        let ensembles = self.inputs.ensembles();
        let ensemble = |i: usize| ensembles.iter().position(|e| e.members.contains(&i));
        let mut pairs = self.inputs.correlated_pairs();
        let correlated = pairs.any(|(i, j)| {
            let finite = [i, j].iter().any(|&at| inputs[at].degrees_of_freedom().is_finite());
            let together = ensemble(i).is_some() && ensemble(i) == ensemble(j);
            finite && !together && self.signed(i) != 0.0 && self.signed(j) != 0.0
        });
        if correlated || self.linearisation == Linearisation::ZeroUncertainty {
            return None;
        }
        let relative = |i: usize| self.signed(i) / self.standard_uncertainty;
        let alone = (0..inputs.len()).filter(|&i| self.signed(i) != 0.0 && ensemble(i).is_none());
        let alone: f64 = alone.map(|i| relative(i).powi(4) / inputs[i].degrees_of_freedom()).sum();
        let joint = |e: &Ensemble| {
            let pairs = e.members.iter().flat_map(|&i| e.members.iter().map(move |&j| (i, j)));
            let used = pairs.filter(|&(i, j)| self.signed(i) != 0.0 && self.signed(j) != 0.0);
            let share: f64 = used.map(|(i, j)| relative(i) * self.inputs.correlation_at(i, j) * relative(j)).sum();
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
    /// [`UncertaintyError::Invalid`] unless 0 < level < 1; [`UncertaintyError::NoAnswer`] if u(y) is zero although
    /// inputs are uncertain, or if there is no ν_eff.
    pub fn expanded(&self, level: f64) -> Result<Expanded, UncertaintyError> {
        if self.linearisation == Linearisation::ZeroUncertainty {
            return Err(UncertaintyError::no_answer(
                "the first-order uncertainty is zero although inputs are uncertain: the linear approximation cannot \
                 see them, and no coverage interval follows from it",
            ));
        }
        self.expand(level, self.standard_uncertainty, self.known_degrees_of_freedom()?)
    }

    /// The expanded uncertainty from u(y) to second order, about the uncorrected estimate; at the ν_eff of the
    /// first order, or infinite degrees of freedom if u(y) is zero to first order.
    ///
    /// # Errors
    /// [`UncertaintyError::Invalid`] unless 0 < level < 1; [`UncertaintyError::NoAnswer`] where there is no ν_eff.
    pub fn expanded_to_second_order(&self, level: f64) -> Result<Expanded, UncertaintyError> {
        let none =
            "there is no uncertainty to second order: it was not asked for, or the model cannot be expanded so far";
        let terms = self.second_order.ok_or_else(|| UncertaintyError::no_answer(none))?;
        let effective = if self.linearisation == Linearisation::ZeroUncertainty {
            f64::INFINITY
        } else {
            self.known_degrees_of_freedom()?
        };
        self.expand(level, terms.standard_uncertainty, effective)
    }

    fn known_degrees_of_freedom(&self) -> Result<f64, UncertaintyError> {
        self.effective_degrees_of_freedom().ok_or_else(|| {
            UncertaintyError::no_answer(
                "inputs of finite degrees of freedom are correlated, where the Welch-Satterthwaite formula does not \
                 hold; choose the degrees of freedom and use coverage_factor",
            )
        })
    }

    fn expand(&self, level: f64, standard_uncertainty: f64, effective: f64) -> Result<Expanded, UncertaintyError> {
        // A whole ν_eff may come out of the sum a rounding error too low, and must not lose a whole one for it.
        let degrees_of_freedom = (effective * (1.0 + 1e-12)).floor().max(1.0);
        let factor = coverage_factor(level, degrees_of_freedom);
        let coverage_factor = factor.ok_or_else(|| UncertaintyError::level(level))?;
        let uncertainty = coverage_factor * standard_uncertainty;
        Ok(Expanded { level, coverage_factor, uncertainty, degrees_of_freedom, estimate: self.estimate })
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
    use crate::gum::propagate;
    use crate::model::Taylor;

    fn inputs(uncertainties: &[(&str, f64, f64)]) -> Inputs {
        let input = |&(name, u, nu): &(&str, f64, f64)| {
            Input::new(name, 0.0, u, "m").unwrap().with_degrees_of_freedom(nu).unwrap()
        };
        Inputs::new(uncertainties.iter().map(input)).unwrap()
    }

    fn sum(x: &[Taylor]) -> Taylor {
        x.iter().fold(Taylor::from(0.0), |sum, &x| sum + x)
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
        assert!((budget.linearisation() == Linearisation::ZeroUncertainty));
        assert_eq!((budget.standard_uncertainty(), budget.effective_degrees_of_freedom()), (0.0, None));
        assert!(matches!(budget.expanded(0.95), Err(UncertaintyError::NoAnswer { what }) if what.contains("linear \
                approximation")));
        assert!(budget.to_string().contains("linear approximation"), "{budget}");
    }

    #[test]
    fn constants_have_no_uncertainty_and_no_flag() {
        let budget = propagate(&inputs(&[("a", 0.0, 5.0)]), |x| x[0] + 2.0).unwrap();
        assert!(!(budget.linearisation() == Linearisation::ZeroUncertainty));
        assert_eq!(budget.effective_degrees_of_freedom(), Some(f64::INFINITY));
        assert_eq!(budget.expanded(0.95).unwrap().uncertainty, 0.0);
    }

    #[test]
    fn cancellation_to_rounding_is_zero() {
        let full = inputs(&[("a", 0.1, f64::INFINITY), ("b", 0.3, f64::INFINITY)])
            .with_correlations(&[("a", "b", 1.0)])
            .unwrap();
        let budget = propagate(&full, |x| x[0] * 3.0 - x[1]).unwrap();
        assert_eq!((budget.standard_uncertainty(), budget.linearisation()), (0.0, Linearisation::Adequate));
        // What else they do keeps the flag: it is not seen along the one direction in which these two vary.
        let more = inputs(&[("a", 0.1, f64::INFINITY), ("b", 0.3, f64::INFINITY), ("c", 0.2, f64::INFINITY)]);
        let more = more.with_correlations(&[("a", "b", 1.0)]).unwrap();
        let budget = propagate(&more, |x| x[0] * 3.0 - x[1] + x[0] * x[1] * x[2] * x[2]).unwrap();
        assert_eq!((budget.standard_uncertainty(), budget.linearisation()), (0.0, Linearisation::ZeroUncertainty));
    }

    #[test]
    fn correlated_inputs_of_finite_degrees_of_freedom_have_no_effective_ones() {
        let three = [("a", 1.0, 4.0), ("b", 1.0, f64::INFINITY), ("c", 1.0, f64::INFINITY)];
        let harmful = inputs(&three).with_correlations(&[("a", "b", 0.1)]).unwrap();
        let budget = propagate(&harmful, sum).unwrap();
        assert_eq!(budget.effective_degrees_of_freedom(), None);
        assert!(
            matches!(budget.expanded(0.95), Err(UncertaintyError::NoAnswer { what }) if what.contains("Welch-Satterthwaite"))
        );
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
        assert!(matches!(plus.covariance_with(&other), Err(UncertaintyError::Invalid { .. })));
    }
}
