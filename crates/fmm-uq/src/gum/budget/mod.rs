//! The uncertainty of a result and where it comes from.

#[cfg(feature = "serde")]
mod document;

use crate::model::derivatives::place;
use crate::{Input, Inputs, Linearisation, SecondOrder, UncertaintyError};

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
/// [`Linearisation`] is suspect; [`Budget::to_csv`] has all digits.
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

impl Budget {
    /// Combines sensitivities, one for each input.
    pub(crate) fn new(inputs: Inputs, estimate: f64, sensitivities: Vec<f64>) -> Result<Self, UncertaintyError> {
        let (name, unit) = ("result".to_owned(), String::new());
        let (second_order, linearisation) = (None, Linearisation::Unchecked);
        let mut budget = Self {
            inputs,
            estimate,
            sensitivities,
            standard_uncertainty: 0.0,
            second_order,
            linearisation,
            name,
            unit,
        };
        for (i, &sensitivity) in budget.sensitivities.iter().enumerate() {
            if !(sensitivity.is_finite() && budget.signed(i).is_finite()) {
                let inputs = budget.inputs.as_slice();
                let (input, at) = (inputs[i].name(), place(&budget.inputs, inputs.iter().map(Input::value)));
                return Err(UncertaintyError::sensitivity_not_finite(input, sensitivity, &at));
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

    /// Whether the linear approximation holds within the uncertainties of the inputs.
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
    /// [`UncertaintyError::Inputs`] if the inputs or their correlations differ.
    pub fn covariance_with(&self, other: &Self) -> Result<f64, UncertaintyError> {
        if self.inputs != other.inputs {
            return Err(UncertaintyError::different_inputs());
        }
        let n = self.sensitivities.len();
        let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        Ok(pairs.map(|(i, j)| self.signed(i) * self.inputs.correlation_at(i, j) * other.signed(j)).sum())
    }

    /// c_i u_i with its sign, which matters where inputs are correlated.
    pub(crate) fn signed(&self, i: usize) -> f64 {
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
mod tests;
