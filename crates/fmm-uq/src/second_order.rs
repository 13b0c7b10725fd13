//! What the curvature of a model does to its result.

use crate::derivatives::{Derivatives, Expansion};
use crate::factor::correlation_root;
use crate::{Input, Inputs, UncertaintyError};

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
    /// ½ tr(H U), what the curvature adds to the estimate (unit of the result). It is reported, not applied.
    pub correction: f64,
    /// u(y), standard uncertainty to second order (unit of the result).
    pub standard_uncertainty: f64,
}

/// The second-order terms of every output; none where they are not finite or make a variance negative.
pub(crate) fn second_order(
    inputs: &Inputs,
    model: &impl Derivatives,
    outputs: usize,
) -> Result<Vec<Option<SecondOrder>>, UncertaintyError> {
    let directions = directions(inputs);
    let mut sums = vec![Sums::default(); outputs];
    let mut along = Vec::with_capacity(directions.len());
    for direction in &directions {
        let own = model.expand(direction, None)?;
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
    Ok(sums.into_iter().map(Sums::finish).collect())
}

/// The columns of D that are not zero, in units of the inputs.
fn directions(inputs: &Inputs) -> Vec<Vec<f64>> {
    let uncertainties: Vec<f64> = inputs.as_slice().iter().map(Input::standard_uncertainty).collect();
    let all: Vec<usize> = (0..uncertainties.len()).collect();
    let root = correlation_root(inputs, &all);
    let column = |m: usize| -> Vec<f64> { all.iter().map(|&i| uncertainties[i] * root[i][m]).collect() };
    all.iter().map(|&m| column(m)).filter(|column| column.iter().any(|&step| step != 0.0)).collect()
}

#[derive(Clone, Default)]
struct Sums {
    correction: f64,
    variance: f64,
    /// Sum of the magnitudes, against which a sum that cancels is nothing but rounding.
    size: f64,
}

impl Sums {
    fn alone(&mut self, e: &Expansion) {
        self.correction += 0.5 * e.aa;
        self.add(e.a * e.a);
        self.add(0.5 * e.aa * e.aa);
        self.add(e.a * e.aaa);
    }

    fn together(&mut self, e: &Expansion, first: f64, second: f64) {
        self.add(e.ab * e.ab);
        self.add(first * e.abb);
        self.add(second * e.aab);
    }

    fn add(&mut self, term: f64) {
        self.variance += term;
        self.size += term.abs();
    }

    fn finish(self) -> Option<SecondOrder> {
        let negative = self.variance < -1e-12 * self.size;
        let terms = SecondOrder { correction: self.correction, standard_uncertainty: self.variance.max(0.0).sqrt() };
        (!negative && self.size.is_finite() && terms.correction.is_finite()).then_some(terms)
    }
}
