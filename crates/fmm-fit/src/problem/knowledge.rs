//! Knowledge of parameters beside the data: fixed values, and values with a covariance.

use fmm_model::{Bounds, ModelError, Parameter};

use crate::algebra::definite;
use crate::error::FitError;
use crate::problem::block::Block;
use crate::problem::residuals::{Derivatives, EvaluationError, Residuals, forward_shape, forward_values};

/// A problem with some parameters fixed at values, whatever their bounds.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{WithFixed, Options, Residuals, solve};
/// use fmm_model::Parameter;
///
/// struct Line([Parameter; 2]);
/// # impl Residuals for Line {
/// #     fn parameters(&self) -> &[Parameter] { &self.0 }
/// #     fn len(&self) -> usize { 3 }
/// #     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
/// #         for (i, (r, data)) in residuals.iter_mut().zip([1.0, 3.0, 5.0]).enumerate() {
/// #             *r = p[0] + p[1] * i as f64 - data;
/// #         }
/// #         Ok(())
/// #     }
/// # }
/// // The line through (0, 1), (1, 3), (2, 5).
/// let line = Line([Parameter::new("offset", "a", "1"), Parameter::new("slope", "b", "1")]);
/// let through_origin = WithFixed::new(&line, [(0, 0.0)])?;
/// let fit = solve(&through_origin, &[0.0, 1.0], &Options::default())?;
/// assert_eq!(fit.values()[0], 0.0);
/// assert!((fit.values()[1] - 13.0 / 5.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct WithFixed<'a, P: ?Sized> {
    problem: &'a P,
    parameters: Vec<Parameter>,
}

impl<'a, P: Residuals + ?Sized> WithFixed<'a, P> {
    /// `problem` with the parameter at each index fixed at the value beside it; an index that it does not have is
    /// ignored.
    ///
    /// # Errors
    /// [`ModelError`] for a value that is not finite.
    pub fn new(problem: &'a P, values: impl IntoIterator<Item = (usize, f64)>) -> Result<Self, ModelError> {
        let mut parameters = problem.parameters().to_vec();
        for (index, value) in values {
            let fixed = Bounds::new(value, value)?;
            if let Some(parameter) = parameters.get_mut(index) {
                *parameter = parameter.clone().bounded(fixed);
            }
        }
        Ok(Self { problem, parameters })
    }

    /// `problem` with other bounds.
    pub(crate) const fn within(problem: &'a P, parameters: Vec<Parameter>) -> Self {
        Self { problem, parameters }
    }
}

impl<P: Residuals + ?Sized> Residuals for WithFixed<'_, P> {
    forward_shape!(self => self.problem);
    forward_values!(self => self.problem);
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
}

/// A problem with known values of some parameters as further residuals, so that a fit, its covariance and its profiles
/// contain that knowledge.
///
/// ```text
/// r = [ r_data(θ), L⁻¹ (θ_known − m) ],     Σ = L Lᵀ
/// ```
///
/// m are the known values and Σ is their covariance. The residuals of the data have to be of standard deviation 1, as
/// those of [`Weighted`](crate::Weighted) are, and [`Fit::unit_covariance`](crate::Fit::unit_covariance) is then the
/// covariance of the estimates; for residuals of another deviation there is
/// [`with_residual_deviation`](Self::with_residual_deviation).
///
/// ```
/// use fmm_fit::{Options, Weighted, WithPriors, curve, solve};
///
/// // Three readings of a line, 0.1 each, whose slope is known to be 2.0 ± 0.05 from elsewhere.
/// let line = curve(&[0.0, 1.0, 2.0], &[1.0, 3.1, 5.4], ["offset", "slope"], |x, [a, b]| a + b * x)?;
/// let line = Weighted::new(line, vec![0.1; 3])?;
/// let fit = solve(&WithPriors::new(&line, &[(1, 2.0, 0.05)])?, &[0.0, 1.0], &Options::default())?;
/// // The data alone say 2.2 with a variance of 1/200, the prior one of 1/400: the mean by weights of 1 and 2.
/// assert!((fit.values()[1] - (2.2 + 2.0 * 2.0) / 3.0).abs() < 1e-9);
/// assert!((fit.unit_covariance(1, 1).unwrap() - 1.0 / 600.0).abs() < 1e-9);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone)]
pub struct WithPriors<P> {
    problem: P,
    places: Vec<usize>,
    values: Vec<f64>,
    /// L⁻¹, by rows, times the standard deviation of the residuals of the data.
    weights: Vec<f64>,
    blocks: Vec<Block>,
}

impl<P: Residuals> WithPriors<P> {
    /// `problem` with independent knowledge: for each known parameter its index, its value and the standard uncertainty
    /// of the value, both in the unit of the parameter.
    ///
    /// # Errors
    /// Those of [`correlated`](Self::correlated).
    pub fn new(problem: P, known: &[(usize, f64, f64)]) -> Result<Self, FitError> {
        let count = known.len();
        let mut covariance = vec![0.0; count * count];
        for (row, (_, _, uncertainty)) in known.iter().enumerate() {
            covariance[row * (count + 1)] = uncertainty * uncertainty;
        }
        let places: Vec<usize> = known.iter().map(|(place, ..)| *place).collect();
        let values: Vec<f64> = known.iter().map(|(_, value, _)| *value).collect();
        Self::correlated(problem, &places, &values, &covariance)
    }

    /// `problem` with knowledge of the parameters of the indices `places`: their `values`, each in its unit, and the
    /// `covariance` of these, row by row.
    ///
    /// # Errors
    /// [`FitError::Count`] unless there is one value per place and a square covariance, [`FitError::Problem`] for a
    /// place twice or beyond the parameters and for a covariance that is not symmetric and positive definite,
    /// [`FitError::OutOfRange`] for a value that is not finite.
    pub fn correlated(problem: P, places: &[usize], values: &[f64], covariance: &[f64]) -> Result<Self, FitError> {
        let (count, parameters) = (places.len(), problem.parameters().len());
        if values.len() != count || covariance.len() != count * count {
            let (values, elements) = (values.len(), covariance.len());
            return Err(FitError::count(format!(
                "{count} known parameters have {values} values and a covariance of {elements} elements; give one value \
                 for each and a square covariance"
            )));
        }
        let is_wrong = |(row, place): (usize, &usize)| *place >= parameters || places[..row].contains(place);
        if let Some(place) = places.iter().enumerate().find(|place| is_wrong(*place)).map(|(_, place)| place) {
            return Err(FitError::problem(format!(
                "parameter {place} is said to be known; each of the {parameters} parameters may be once"
            )));
        }
        if let Some(value) = values.iter().find(|value| !value.is_finite()) {
            return Err(FitError::option("the known value of a parameter", "finite", *value));
        }
        let mut factored = covariance.to_vec();
        let is_symmetric = (0..count * count).all(|at| covariance[at] == covariance[at % count * count + at / count]);
        // A smaller share of the diagonal is rounding of a singular covariance.
        let least = |j: usize| 1e-12 * covariance[j * (count + 1)].abs();
        if !(is_symmetric && definite::factor(&mut factored, count, least)) {
            return Err(FitError::problem(
                "the covariance of known parameters must be symmetric and positive definite; leave out what follows \
                 from the others",
            ));
        }
        let mut blocks = problem.blocks().to_vec();
        if blocks.is_empty() {
            blocks.push(Block::new(problem.len(), (0..parameters).collect::<Vec<_>>()));
        }
        blocks.push(Block::new(count, places));
        let weights = definite::lower_inverse(&factored, count);
        Ok(Self { problem, places: places.to_vec(), values: values.to_vec(), weights, blocks })
    }

    /// The same for residuals of the data with this standard deviation, in their unit, instead of 1.
    #[must_use]
    pub fn with_residual_deviation(mut self, deviation: f64) -> Self {
        self.weights.iter_mut().for_each(|weight| *weight *= deviation);
        self
    }

    fn write_known(&self, p: &[f64], residuals: &mut [f64]) {
        let away: Vec<f64> = self.places.iter().zip(&self.values).map(|(&place, value)| p[place] - value).collect();
        for (residual, weights) in residuals.iter_mut().zip(self.weights.chunks_exact(away.len().max(1))) {
            *residual = weights.iter().zip(&away).map(|(weight, away)| weight * away).sum();
        }
    }
}

impl<P: Residuals> Residuals for WithPriors<P> {
    fn parameters(&self) -> &[Parameter] {
        self.problem.parameters()
    }
    fn len(&self) -> usize {
        self.problem.len() + self.places.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let (of_data, known) = residuals.split_at_mut(self.problem.len());
        self.write_known(p, known);
        let of_data_jacobian = jacobian.map(|jacobian| {
            let count = self.places.len();
            let (of_data, known) = jacobian.split_at_mut(jacobian.len() - count * count);
            for (at, element) in known.iter_mut().enumerate() {
                *element = self.weights[at % count * count + at / count];
            }
            of_data
        });
        self.problem.evaluate(p, of_data, of_data_jacobian)
    }
    fn derivatives(&self) -> Derivatives {
        self.problem.derivatives()
    }
    fn is_cheaper_combined(&self) -> bool {
        self.problem.is_cheaper_combined()
    }
    fn blocks(&self) -> &[Block] {
        &self.blocks
    }
    fn block_residuals(&self, block: usize, p: &[f64], residuals: &mut [f64]) -> Result<bool, EvaluationError> {
        if block + 1 == self.blocks.len() {
            self.write_known(p, residuals);
            return Ok(true);
        }
        if self.problem.blocks().is_empty() {
            self.problem.evaluate(p, residuals, None)?;
            return Ok(true);
        }
        self.problem.block_residuals(block, p, residuals)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::fitting::solve::solve;
    use crate::solver::options::Options;

    const COUNT: usize = 40;

    /// y = X θ of three columns, its derivatives given or not.
    #[derive(Debug)]
    struct Linear(DMatrix<f64>, DVector<f64>, Vec<Parameter>, Derivatives);

    impl Linear {
        fn new(derivatives: Derivatives) -> Self {
            let x = DMatrix::from_fn(COUNT, 3, |i, j| (0.1 * i as f64).powf(j as f64));
            let y = DVector::from_fn(COUNT, |i, _| 1.0 + 0.3 * i as f64 + ((i * 37 % 11) as f64 - 5.0));
            Self(x, y, ["a", "b", "c"].map(Parameter::from).to_vec(), derivatives)
        }
    }

    impl Residuals for Linear {
        fn parameters(&self) -> &[Parameter] {
            &self.2
        }
        fn len(&self) -> usize {
            COUNT
        }
        fn evaluate(&self, p: &[f64], r: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
            r.copy_from_slice((&self.0 * DVector::from_column_slice(p) - &self.1).as_slice());
            if let Some(jacobian) = jacobian {
                jacobian.copy_from_slice(self.0.as_slice());
            }
            Ok(())
        }
        fn derivatives(&self) -> Derivatives {
            self.3
        }
    }

    /// Correlated knowledge of the third and the first parameter.
    const PLACES: [usize; 2] = [2, 0];
    const KNOWN: [f64; 2] = [0.5, 2.0];
    const COVARIANCE: [f64; 4] = [0.04, 0.03, 0.03, 0.09];

    /// θ = (XᵀX + Σ⁻¹)⁻¹ (Xᵀy + Σ⁻¹m), with the inverse as covariance.
    #[test]
    fn a_gaussian_prior_on_a_linear_problem_is_generalised_least_squares() {
        for (derivatives, deviation) in [(Derivatives::All, 1.0), (Derivatives::None, 1.0), (Derivatives::All, 3.0)] {
            let linear = Linear::new(derivatives);
            let precision = DMatrix::from_row_slice(2, 2, &COVARIANCE).try_inverse().unwrap() * (deviation * deviation);
            let mut matrix = linear.0.transpose() * &linear.0;
            let mut right = linear.0.transpose() * &linear.1;
            for (a, &i) in PLACES.iter().enumerate() {
                for (b, &j) in PLACES.iter().enumerate() {
                    matrix[(i, j)] += precision[(a, b)];
                    right[i] += precision[(a, b)] * KNOWN[b];
                }
            }
            let covariance = matrix.try_inverse().unwrap();
            let expected = &covariance * right;
            let problem = WithPriors::correlated(&linear, &PLACES, &KNOWN, &COVARIANCE).unwrap();
            let problem = problem.with_residual_deviation(deviation);
            let fit = solve(&problem, &[0.0; 3], &Options::default()).unwrap();
            assert_eq!(fit.residuals().len(), COUNT + 2);
            for j in 0..3 {
                assert!((fit.values()[j] - expected[j]).abs() < 1e-8 * expected.norm(), "{j}: {}", fit.values()[j]);
                for i in 0..3 {
                    let found = fit.unit_covariance(i, j).unwrap();
                    assert!((found - covariance[(i, j)]).abs() < 1e-7 * covariance.norm(), "({i}, {j}): {found}");
                }
            }
        }
    }

    #[test]
    fn impossible_knowledge_is_refused() {
        let linear = Linear::new(Derivatives::All);
        let refusal = |places: &[usize], values: &[f64], covariance: &[f64]| {
            WithPriors::correlated(&linear, places, values, covariance).unwrap_err().to_string()
        };
        assert!(refusal(&[0], &[1.0, 2.0], &[1.0]).contains("1 known parameters have 2 values"));
        assert!(refusal(&[3], &[1.0], &[1.0]).contains("parameter 3 is said to be known"));
        assert!(refusal(&[1, 1], &KNOWN, &COVARIANCE).contains("may be once"));
        assert!(refusal(&PLACES, &KNOWN, &[1.0, 1.0, 1.0, 1.0]).contains("positive definite"));
        assert!(refusal(&PLACES, &KNOWN, &[1.0, 0.5, 0.4, 1.0]).contains("symmetric"));
        assert!(WithPriors::new(&linear, &[(0, f64::NAN, 1.0)]).unwrap_err().to_string().contains("must be finite"));
        assert!(WithPriors::new(&linear, &[(0, 1.0, 0.0)]).is_err());
    }
}
