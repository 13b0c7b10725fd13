//! Knowledge of parameters beside the data: fixed values, and values with an uncertainty.

use fmm_model::{Bounds, Parameter};

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
    /// `problem` with the parameter at each index fixed at the value beside it.
    ///
    /// # Errors
    /// [`FitError::Problem`] for an index beyond the parameters, [`FitError::OutOfRange`] for a value that is no
    /// number.
    pub fn new(problem: &'a P, values: impl IntoIterator<Item = (usize, f64)>) -> Result<Self, FitError> {
        let mut parameters = problem.parameters().to_vec();
        for (index, value) in values {
            let count = parameters.len();
            let Some(parameter) = parameters.get_mut(index) else {
                return Err(FitError::problem(format!(
                    "parameter {index} is said to be fixed; the problem has {count} parameters, counted from 0"
                )));
            };
            let wrong = |_| FitError::option(&format!("the fixed value of {}", parameter.name()), "a number", value);
            *parameter = parameter.clone().bounded(Bounds::new(value, value).map_err(wrong)?);
        }
        Ok(Self { problem, parameters })
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
/// r = [ r_data(θ), (θⱼ − mⱼ)/uⱼ ]     for each known parameter j
/// ```
///
/// m are the known values and u their standard uncertainties. The residuals of the data have to be of standard
/// deviation 1, as those of [`Weighted`](crate::Weighted) are, and
/// [`Fit::unit_covariance`](crate::Fit::unit_covariance) is then the covariance of the estimates.
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
    known: Vec<(usize, f64, f64)>,
    blocks: Vec<Block>,
}

impl<P: Residuals> WithPriors<P> {
    /// `problem` with independent knowledge: for each known parameter its index, its value and the standard uncertainty
    /// of the value, both in the unit of the parameter.
    ///
    /// # Errors
    /// [`FitError::Problem`] for a parameter twice or beyond those of the problem, [`FitError::OutOfRange`] for a value
    /// that is not finite or an uncertainty that is not positive.
    pub fn new(problem: P, known: &[(usize, f64, f64)]) -> Result<Self, FitError> {
        let parameters = problem.parameters().len();
        for (row, &(place, value, uncertainty)) in known.iter().enumerate() {
            if place >= parameters || known[..row].iter().any(|(before, ..)| *before == place) {
                return Err(FitError::problem(format!(
                    "parameter {place} is said to be known; each of the {parameters} parameters may be once"
                )));
            }
            if !value.is_finite() {
                return Err(FitError::option("the known value of a parameter", "finite", value));
            }
            // The inverse of a subnormal number overflows.
            if !(uncertainty > 0.0 && uncertainty.is_finite() && uncertainty.recip().is_finite()) {
                let of = "the standard uncertainty of a known value";
                return Err(FitError::option(of, "positive and finite", uncertainty));
            }
        }
        let mut blocks = problem.blocks().to_vec();
        if blocks.is_empty() {
            blocks.push(Block::new(problem.len(), (0..parameters).collect::<Vec<_>>()));
        }
        blocks.extend(known.iter().map(|(place, ..)| Block::new(1, [*place])));
        Ok(Self { problem, known: known.to_vec(), blocks })
    }
}

impl<P: Residuals> Residuals for WithPriors<P> {
    fn parameters(&self) -> &[Parameter] {
        self.problem.parameters()
    }
    fn len(&self) -> usize {
        self.problem.len() + self.known.len()
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let (of_data, of_known) = residuals.split_at_mut(self.problem.len());
        for (residual, (place, value, uncertainty)) in of_known.iter_mut().zip(&self.known) {
            *residual = (p[*place] - value) / uncertainty;
        }
        let jacobian_of_data = jacobian.map(|jacobian| {
            let (of_data, of_known) = jacobian.split_at_mut(jacobian.len() - self.known.len());
            of_known.iter_mut().zip(&self.known).for_each(|(element, (.., u))| *element = u.recip());
            of_data
        });
        self.problem.evaluate(p, of_data, jacobian_of_data)
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
        let of_data = self.blocks.len() - self.known.len();
        if block >= of_data {
            let (place, value, uncertainty) = self.known[block - of_data];
            residuals[0] = (p[place] - value) / uncertainty;
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

    /// Knowledge of the third and the first parameter.
    const KNOWN: [(usize, f64, f64); 2] = [(2, 0.5, 0.2), (0, 2.0, 0.3)];

    /// θ = (XᵀX + Σ⁻¹)⁻¹ (Xᵀy + Σ⁻¹m), with the inverse as covariance.
    #[test]
    fn a_gaussian_prior_on_a_linear_problem_is_generalised_least_squares() {
        for derivatives in [Derivatives::All, Derivatives::None] {
            let linear = Linear::new(derivatives);
            let mut matrix = linear.0.transpose() * &linear.0;
            let mut right = linear.0.transpose() * &linear.1;
            for (j, value, uncertainty) in KNOWN {
                matrix[(j, j)] += uncertainty.powi(-2);
                right[j] += value * uncertainty.powi(-2);
            }
            let covariance = matrix.try_inverse().unwrap();
            let expected = &covariance * right;
            let problem = WithPriors::new(&linear, &KNOWN).unwrap();
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
        let refusal = |known: &[(usize, f64, f64)]| WithPriors::new(&linear, known).unwrap_err().to_string();
        assert!(refusal(&[(3, 1.0, 1.0)]).contains("parameter 3 is said to be known"));
        assert!(refusal(&[(1, 1.0, 1.0), (1, 2.0, 1.0)]).contains("may be once"));
        assert!(refusal(&[(0, f64::NAN, 1.0)]).contains("must be finite"));
        assert!(refusal(&[(0, 1.0, 0.0)]).contains("must be positive"));
    }
}
