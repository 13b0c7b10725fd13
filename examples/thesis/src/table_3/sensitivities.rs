//! The table by the law of propagation of uncertainty.

use fmm_fit::{Fit, Sensitivity};
use fmm_uq::{Budget, Input, Inputs, Observations, Taylor, propagate};

use super::problem::LOAD;
use super::{Problem, TRUTH, VARIED, inputs, quantities};
use crate::Found;
use crate::printed::{self, FreeVibration, TABLE_1};

/// Derivatives of the fitted coefficient of friction by what the fit holds, from the implicit function theorem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivities {
    /// By mass (1/kg), stiffness (m/N) and damping (m/(N s)).
    pub machine: [f64; 3],
    /// By normal load (1/N).
    pub load: f64,
}

impl Sensitivities {
    /// Those at the minimum `fit` of `problem`.
    ///
    /// # Errors
    /// If the minimum does not determine the coefficient.
    pub fn of(problem: &Problem, fit: &Fit) -> Found<Self> {
        let sensitivity = Sensitivity::of(problem, fit)?;
        let by =
            |input: &str| sensitivity.coefficient_of("coefficient", input).ok_or("the coefficient is not determined");
        Ok(Self { machine: [by("mass")?, by("stiffness")?, by("damping")?], load: by("normal_load")? })
    }

    /// m ∂μ/∂m + k ∂μ/∂k + c ∂μ/∂c, which is μ: a record shows only k/m, c/m and μ N/m.
    pub fn scale_identity(&self) -> f64 {
        printed::MACHINE.iter().zip(self.machine).map(|(value, derivative)| value * derivative).sum()
    }

    /// N ∂μ/∂N, which is −μ.
    pub fn load_identity(&self) -> f64 {
        LOAD * self.load
    }

    /// u(μ) by each of mass, stiffness and damping, and by all of them without correlation.
    ///
    /// # Errors
    /// As [`budget`](Self::budget).
    pub fn uncertainties(&self) -> Found<[f64; 4]> {
        let [mass, stiffness, damping] = [0, 1, 2].map(|j| (self.machine[j] * printed::MACHINE_DEVIATIONS[j]).abs());
        Ok([mass, stiffness, damping, self.budget()?.standard_uncertainty()])
    }

    /// Eq. 5.4.
    ///
    /// # Errors
    /// If a derivative is not finite.
    pub fn budget(&self) -> Found<Budget> {
        Ok(propagate(&inputs("all")?, |x| self.coefficient(x))?.named("μ", "1"))
    }

    /// Eq. 5.4 with the correlations of Table 1.
    ///
    /// # Errors
    /// As [`budget`](Self::budget).
    pub fn correlated_budget(&self) -> Found<Budget> {
        let inputs = inputs("all")?.with_correlations(&correlations()?)?;
        Ok(propagate(&inputs, |x| self.coefficient(x))?.named("μ", "1"))
    }

    /// The same with relative standard uncertainties of the normal load, and of the common scale of mass, stiffness and
    /// damping, which no record shows: they move μ in proportion.
    ///
    /// # Errors
    /// As [`budget`](Self::budget), and for a negative uncertainty.
    pub fn extended_budget(&self, load: f64, scale: f64) -> Found<Budget> {
        let mut quantities = quantities(|_| true)?;
        quantities.push(Input::new("normal load", 1.0, load, "1")?);
        quantities.push(Input::new("common scale", 1.0, scale, "1")?);
        let inputs = Inputs::new(quantities)?.with_correlations(&correlations()?)?;
        Ok(propagate(&inputs, |x| self.coefficient(&x[..3]) * x[4] / x[3])?.named("μ", "1"))
    }

    /// μ on a machine of mass, stiffness and damping `x`, to first order.
    fn coefficient(&self, x: &[Taylor]) -> Taylor {
        let moved = x.iter().zip(printed::MACHINE).map(|(x, value)| *x - value);
        moved.zip(self.machine).fold(Taylor::from(TRUTH), |sum, (change, derivative)| sum + change * derivative)
    }
}

/// The correlations between the columns of Table 1.
fn correlations() -> Found<[(&'static str, &'static str, f64); 3]> {
    let column = |of: fn(&FreeVibration) -> f64| Observations::new(&TABLE_1.each_ref().map(of));
    let [mass, stiffness, damping] =
        [column(|row| row.mass)?, column(|row| row.stiffness)?, column(|row| row.damping)?];
    let [m, k, c] = VARIED.map(|(name, _)| name);
    Ok([
        (m, k, mass.correlation(&stiffness)?),
        (m, c, mass.correlation(&damping)?),
        (k, c, stiffness.correlation(&damping)?),
    ])
}
