//! Second order: effect of the curvature of a model on its result, and validity of the first order.

use crate::error::UncertaintyError;
use crate::gum::budget::Budget;
use crate::gum::derivatives::{Derivatives, Expansion};
use crate::gum::excursion::{Departure, Excursion};
use crate::inputs::{Input, Inputs};

/// Largest effect of the curvature, relative to u(y), at which the linear approximation is still accepted (1). An
/// uncertainty is stated to two digits, so that rounding changes it by up to 5 % as well.
const TOLERATED: f64 = 0.05;

/// The second-order terms of the GUM.
///
/// With z independent standard normal and x − x̄ = D z, D the root of the covariance matrix, derivatives g are those
/// by z:
///
/// ```text
/// E(y) ≈ f + ½ Σ g_mm                                              (JCGM 100:2008/Amd.1:2026)
/// u²(y) ≈ Σ g_m² + Σ_m Σ_n (½ g_mn² + g_m g_mnn)                   (JCGM 100:2008, 5.1.2, note)
/// ```
///
/// For uncorrelated inputs D is diagonal and this is the formula of the note. The fourth moments in it are those of the
/// normal distribution; rectangular inputs have smaller ones.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SecondOrder {
    /// ½ tr(H U), shift of the estimate by the curvature (unit of the result). It is reported, not applied.
    pub correction: f64,
    /// u(y), standard uncertainty to second order (unit of the result).
    pub standard_uncertainty: f64,
}

/// Known curvature of an output.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Curvature {
    /// The second-order terms; `None` where they are not finite, make a variance negative, or are not those of the
    /// model within the uncertainties of its inputs.
    pub(crate) terms: Option<SecondOrder>,
    /// True if the output stands still though its inputs move and its slopes do not vanish: their effects cancel.
    pub(crate) cancels: bool,
}

/// The curvature of every output.
pub(crate) fn second_order(
    inputs: &Inputs,
    model: &impl Derivatives,
    budgets: &[Budget],
    (values, sensitivities): (&[f64], &[Vec<f64>]),
) -> Result<Vec<Curvature>, UncertaintyError> {
    let directions = directions(inputs);
    let mut sums: Vec<Sums> = budgets.iter().map(|budget| Sums::new(budget.standard_uncertainty())).collect();
    let mut along = Vec::with_capacity(directions.len());
    let excursion = Excursion::new(inputs, model, values, sensitivities);
    let (mut departures, mut asked) = (vec![Departure::default(); budgets.len()], true);
    for direction in &directions {
        let own = model.expand(direction, None)?;
        asked &= excursion.along(direction, &own, &mut departures);
        for (sums, e) in sums.iter_mut().zip(&own) {
            sums.alone(e);
        }
        along.push(own);
    }
    for n in 1..directions.len() {
        for m in 0..n {
            let both = model.expand(&directions[m], Some(&directions[n]))?;
            for (k, (sums, e)) in sums.iter_mut().zip(&both).enumerate() {
                sums.together(e, along[m][k].a, along[n][k].a);
            }
        }
    }
    let flat = budgets.iter().any(|budget| budget.standard_uncertainty() == 0.0);
    asked &= !flat || excursion.together(&directions, &mut departures);
    let finish = |(k, sums): (usize, Sums)| {
        let (u, departure) = (budgets[k].standard_uncertainty(), departures[k]);
        let terms = sums.finish(excursion.rounding(k)).filter(|_| asked && departure.is_tolerable(u, TOLERATED));
        let slopes = (0..inputs.as_slice().len()).any(|i| budgets[k].signed(i) != 0.0);
        let size = |terms: SecondOrder| terms.correction.abs().max(terms.standard_uncertainty);
        let still = asked && departure.moved == 0.0 && terms.is_some_and(|terms| size(terms) <= excursion.rounding(k));
        Curvature { terms, cancels: u == 0.0 && slopes && still }
    };
    Ok(sums.into_iter().enumerate().map(finish).collect())
}

/// The columns of D that are not zero, in units of the inputs.
fn directions(inputs: &Inputs) -> Vec<Vec<f64>> {
    let uncertainties: Vec<f64> = inputs.as_slice().iter().map(Input::standard_uncertainty).collect();
    let all: Vec<usize> = (0..uncertainties.len()).collect();
    let root = inputs.correlation_root(&all);
    let column = |m: usize| -> Vec<f64> { all.iter().map(|&i| uncertainties[i] * root[i][m]).collect() };
    all.iter().map(|&m| column(m)).filter(|column| column.iter().any(|&step| step != 0.0)).collect()
}

#[derive(Clone)]
struct Sums {
    /// A power of two near the uncertainty, in units of which variances are summed lest they vanish.
    unit: f64,
    correction: f64,
    variance: f64,
    /// Sum of the magnitudes, against which a sum that cancels is nothing but rounding.
    size: f64,
}

impl Sums {
    fn new(standard_uncertainty: f64) -> Self {
        let usual = (1e-100..1e100).contains(&standard_uncertainty) || standard_uncertainty == 0.0;
        let unit = if usual { 1.0 } else { standard_uncertainty.log2().floor().exp2() };
        Self { unit, correction: 0.0, variance: 0.0, size: 0.0 }
    }

    fn alone(&mut self, e: &Expansion) {
        let e = e.in_units_of(self.unit);
        self.correction += 0.5 * e.aa;
        self.add(e.a * e.a);
        self.add(0.5 * e.aa * e.aa);
        self.add(e.a * e.aaa);
    }

    fn together(&mut self, e: &Expansion, first: f64, second: f64) {
        let (e, first, second) = (e.in_units_of(self.unit), first / self.unit, second / self.unit);
        self.add(e.ab * e.ab);
        self.add(first * e.abb);
        self.add(second * e.aab);
    }

    fn add(&mut self, term: f64) {
        self.variance += term;
        self.size += term.abs();
    }

    /// The sums, if they are possible, for an output with this `rounding`.
    fn finish(self, rounding: f64) -> Option<SecondOrder> {
        let negative = self.variance < -1e-12 * self.size - (rounding / self.unit).powi(2);
        let (correction, u) = (self.unit * self.correction, self.unit * self.variance.max(0.0).sqrt());
        let terms = SecondOrder { correction, standard_uncertainty: u };
        (!negative && self.size.is_finite() && terms.correction.is_finite()).then_some(terms)
    }
}

/// The verdict on the linear approximation of a model within the uncertainties of its inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Linearisation {
    /// Curvature changes neither u(y) nor y by as much as 5 % of u(y), and neither do the values of the model √3
    /// standard uncertainties away along each of its inputs (or at their limits). It holds also for a result that
    /// cannot vary, such as the difference of two fully correlated inputs of the same uncertainty.
    ///
    /// The model was evaluated at points: effects between them, or of several inputs far away together, are not seen.
    Adequate,
    /// u(y) is zero to first order although inputs are uncertain: the model is flat at the estimates or its slopes
    /// cancel, and a linear approximation cannot see their effect. x² at x = 0 is the plainest case.
    ZeroUncertainty,
    /// The second-order terms change u(y) by 5 % or more.
    UncertaintyDiffers(SecondOrder),
    /// The second-order terms move the estimate by 5 % of u(y) or more.
    EstimateShifts(SecondOrder),
    /// The model departs from its expansion within the uncertainties of its inputs: a kink, a high power or a range
    /// that ends there; or the second-order terms are not finite, or so large that they make the variance negative.
    NotExpandable,
    /// The second-order terms were not asked for.
    Unchecked,
}

impl Linearisation {
    /// True if a Monte Carlo should confirm the uncertainty before it is reported.
    pub const fn is_suspect(self) -> bool {
        !matches!(self, Self::Adequate | Self::Unchecked)
    }

    /// The verdict; the curvature is known if it was asked for.
    pub(crate) fn judge(first_order: f64, inputs_vary: bool, curvature: Option<Curvature>) -> Self {
        if first_order == 0.0 && inputs_vary && !curvature.is_some_and(|curvature| curvature.cancels) {
            return Self::ZeroUncertainty;
        }
        match curvature.map(|curvature| curvature.terms) {
            None => Self::Unchecked,
            Some(None) => Self::NotExpandable,
            Some(Some(_)) if first_order == 0.0 => Self::Adequate,
            Some(Some(terms)) => {
                let tolerated = TOLERATED * first_order;
                if (terms.standard_uncertainty - first_order).abs() > tolerated {
                    Self::UncertaintyDiffers(terms)
                } else if terms.correction.abs() > tolerated {
                    Self::EstimateShifts(terms)
                } else {
                    Self::Adequate
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::gum::{Gum, Propagation};
    use crate::inputs::{Input, Inputs};
    use crate::model::{ModelOutput, Taylor};

    fn inputs() -> Inputs {
        let (a, b) = (Input::new("a", 2.0, 0.5, "").unwrap(), Input::new("b", 3.0, 0.1, "").unwrap());
        Inputs::new([a, b]).unwrap()
    }

    fn both<R: ModelOutput<Taylor>, S: ModelOutput<f64>>(
        exact: impl Fn(&[Taylor]) -> R,
        stepped: impl Fn(&[f64]) -> S,
    ) -> [(&'static str, Propagation); 2] {
        let inputs = inputs();
        let gum = Gum::new(&inputs);
        [
            ("by derivatives", gum.propagate(exact).unwrap()),
            ("by differences", gum.propagate_by_differences(stepped).unwrap()),
        ]
    }

    /// The result must have this correction and variance, which follow from the sum in the note of JCGM 100:2008,
    /// 5.1.2.
    fn check(propagations: [(&str, Propagation); 2], correction: f64, variance: f64) {
        for (how, propagation) in propagations {
            let terms = propagation.single().unwrap().second_order().unwrap();
            // Differences of numbers of about 50 are exact for cubic functions but for rounding, 50 ε over 0.25.
            let found = terms.standard_uncertainty.powi(2);
            assert!((found - variance).abs() < 1e-11 * variance, "{how}: u² = {found}, and not {variance}");
            let shift = terms.correction;
            assert!((shift - correction).abs() < 1e-11, "{how}: a shift of {shift}, and not {correction}");
        }
    }

    #[test]
    fn the_mixed_third_derivative_goes_with_the_slope_of_the_other_input() {
        // y = a b²: slopes 9 and 12, f_bb = 4, f_ab = 6, f_abb = 2. u² = (9·0.5)² + (12·0.1)² + 4² 0.1⁴/2
        // + (6² + 9·2) 0.5² 0.1² = 20.25 + 1.44 + 0.0008 + 0.135.
        check(both(|x| x[0] * x[1] * x[1], |x| x[0] * x[1] * x[1]), 0.02, 21.8258);
        // y = a² b: slopes 12 and 4, f_aa = 6, f_ab = 4, f_aab = 2. u² = (12·0.5)² + (4·0.1)² + 6² 0.5⁴/2
        // + (4² + 4·2) 0.5² 0.1² = 36 + 0.16 + 1.125 + 0.06.
        check(both(|x| x[0] * x[0] * x[1], |x| x[0] * x[0] * x[1]), 0.75, 37.345);
    }

    #[test]
    fn the_third_derivative_of_an_input_goes_with_its_slope() {
        // y = a³: slope 12, f_aa = 12, f_aaa = 6. u² = 6² + (12² / 2 + 12·6) 0.5⁴ = 36 + 9.
        check(both(|x| x[0] * x[0] * x[0], |x| x[0] * x[0] * x[0]), 1.5, 45.0);
    }
}
