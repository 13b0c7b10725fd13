//! Information of measurements about parameters, which adds up over independent measurements.

use std::f64::consts::TAU;

use fmm_model::Parameter;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::algebra::definite::add_square;
use crate::algebra::spectrum::singular_triples;
use crate::algebra::triangle::Triangle;
use crate::error::FitError;
use crate::problem::block::Scratch;
use crate::problem::residuals::Residuals;
use crate::result::null_direction::{NullDirection, null_directions};
use crate::solver::evaluation::Evaluator;

/// Fisher's information of measurements about p parameters, a symmetric matrix.
///
/// ```text
/// M = Σᵢ (∂rᵢ/∂θ)ᵀ (∂rᵢ/∂θ) / σ²,        V = M⁻¹,        u²(gᵀθ) = gᵀ M⁻¹ g
/// ```
///
/// Independent measurements [add](Self::add) up, and what is known beforehand is information as well
/// ([`with_known`](Self::with_known)). Parameters of one measurement alone, such as its offset, are eliminated before
/// by the Schur complement ([`of_problem`](Self::of_problem)): what is left adds up.
///
/// ```
/// use fmm_fit::design::Information;
///
/// // A straight line a + b x, measured at 0, 1 and 2 with u = 0.1.
/// let rows: Vec<f64> = [0.0, 1.0, 2.0].iter().flat_map(|x| [1.0, *x]).collect();
/// let line = Information::of_rows(2, &rows)?.scaled(1.0 / 0.01)?;
/// // u²(b) = σ²/Σ(x − x̄)².
/// assert!((line.variance(&[0.0, 1.0])?.unwrap() - 0.01 / 2.0).abs() < 1e-15);
/// // One measurement at 1 tells a + b and nothing else.
/// let one = Information::of_rows(2, &[1.0, 1.0])?;
/// assert_eq!((one.rank(), one.variance(&[1.0, 0.0])?), (1, None));
/// assert!((one.variance(&[1.0, 1.0])?.unwrap() - 1.0).abs() < 1e-15);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
///
/// # References
/// V. V. Fedorov, "Theory of Optimal Experiments", Academic Press 1972; A. C. Atkinson, A. N. Donev, R. D. Tobias,
/// "Optimum Experimental Designs, with SAS", Oxford University Press 2007, sections 9.1 and 17.2.
#[derive(Debug, Clone, PartialEq)]
pub struct Information {
    order: usize,
    /// Row by row.
    elements: Vec<f64>,
}

/// An eigenvalue of the matrix of unit diagonal below this share of the largest is rounding.
const ROUNDING: f64 = 1e-12;
/// A combination is not determined if this share of it lies along directions that are not.
const ALONG: f64 = 1e-5;

impl Information {
    /// Nothing is known about `order` parameters.
    pub fn none(order: usize) -> Self {
        Self { order, elements: vec![0.0; order * order] }
    }

    /// The matrix of these elements, row by row.
    pub(crate) const fn of_elements(order: usize, elements: Vec<f64>) -> Self {
        Self { order, elements }
    }

    /// Information of measurements of unit variance whose derivatives by the `order` parameters are `rows`, one after
    /// the other.
    ///
    /// # Errors
    /// [`FitError::Count`] if the rows are not whole, [`FitError::OutOfRange`] for a derivative that is not
    /// finite.
    pub fn of_rows(order: usize, rows: &[f64]) -> Result<Self, FitError> {
        if order == 0 || !rows.len().is_multiple_of(order) {
            return Err(mismatch("derivatives in whole rows", rows.len(), order));
        }
        require_finite("derivatives", rows)?;
        let mut information = Self::none(order);
        rows.chunks_exact(order).for_each(|row| add_square(&mut information.elements, row, 1.0));
        Ok(information)
    }

    /// Information of the residuals of `problem`, each of unit variance, at `values` about its first `shared`
    /// parameters, while all others are found beside them. Fixed parameters are known.
    ///
    /// ```text
    /// M = J_sᵀ (1 − J_o (J_oᵀ J_o)⁻¹ J_oᵀ) J_s
    /// ```
    ///
    /// # Errors
    /// [`FitError::Count`] for a wrong number of values or more `shared` parameters than there are, and
    /// [`FitError::NoModel`].
    pub fn of_problem<P: Residuals + ?Sized>(problem: &P, values: &[f64], shared: usize) -> Result<Self, FitError> {
        let count = problem.parameters().len();
        if values.len() != count {
            return Err(mismatch("values of the parameters", values.len(), count));
        }
        if shared > count {
            return Err(mismatch("shared parameters", shared, count));
        }
        let linearised = Evaluator::linearise(problem, values).ok_or_else(no_derivatives)?;
        let is_free = |j: &usize| !problem.parameters()[*j].bounds().is_fixed();
        let free: Vec<usize> = (0..count).filter(is_free).collect();
        let (mut whole, mut scratch) = (Triangle::default(), Scratch::default());
        linearised.structure.factor(&linearised.jacobian, &free, &linearised.residuals, &mut whole, &mut scratch);
        // With its own parameters first, the triangle left of the others has lost them. One without influence takes
        // nothing.
        let kept = free.iter().filter(|j| **j < shared).count();
        let own = (kept..free.len()).filter(|column| whole.column_norm(*column) > 0.0);
        let order: Vec<usize> = own.chain(0..kept).collect();
        let mut sorted = Triangle::default();
        sorted.select(&whole, &order, |_| 0.0, &mut scratch.block);
        if !sorted.is_finite() {
            return Err(no_derivatives());
        }
        let mut information = Self::none(shared);
        for row in order.len() - kept..order.len() {
            let mut line = vec![0.0; shared];
            for column in row..order.len() {
                line[free[order[column]]] = sorted.r(row, column);
            }
            add_square(&mut information.elements, &line, 1.0);
        }
        Ok(information)
    }

    /// Number of parameters.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Element of the matrix, in the reciprocal product of the units of the two parameters.
    ///
    /// # Panics
    /// If there is no such parameter.
    pub fn element(&self, row: usize, column: usize) -> f64 {
        self.elements[row * self.order + column]
    }

    /// The same times `factor`: residuals of standard deviation σ give 1/σ², three repeats 3.
    ///
    /// # Errors
    /// [`FitError::OutOfRange`] for a factor that is negative or not finite.
    pub fn scaled(mut self, factor: f64) -> Result<Self, FitError> {
        if !(factor >= 0.0 && factor.is_finite()) {
            let what = format!("an information is multiplied by 0 or more, not by {factor}");
            return Err(FitError::out_of_range(what, factor));
        }
        self.elements.iter_mut().for_each(|element| *element *= factor);
        Ok(self)
    }

    /// Adds what an independent measurement tells about the same parameters.
    ///
    /// # Errors
    /// [`FitError::Count`] for another number of parameters.
    pub fn add(&mut self, other: &Self) -> Result<(), FitError> {
        if other.order != self.order {
            return Err(mismatch("parameters of an information", other.order, self.order));
        }
        self.elements.iter_mut().zip(&other.elements).for_each(|(sum, element)| *sum += element);
        Ok(())
    }

    /// The same with a parameter that is known with standard `uncertainty` beside the measurements.
    ///
    /// # Errors
    /// [`FitError::Count`] if there is no such parameter, [`FitError::OutOfRange`] unless the uncertainty is
    /// positive.
    pub fn with_known(mut self, parameter: usize, uncertainty: f64) -> Result<Self, FitError> {
        if parameter >= self.order {
            return Err(mismatch("place of a known parameter", parameter, self.order));
        }
        let precision = uncertainty.powi(-2);
        if !(uncertainty > 0.0 && precision.is_finite()) {
            let what = format!("the standard uncertainty of a known parameter must be positive, not {uncertainty}");
            return Err(FitError::out_of_range(what, uncertainty));
        }
        self.elements[parameter * (self.order + 1)] += precision;
        Ok(self)
    }

    /// Information of the same measurements about parameters φ on which these depend: TᵀMT with T = ∂θ/∂φ, given row by
    /// row, one row for each of these parameters.
    ///
    /// # Errors
    /// [`FitError::Count`] if the rows are not whole, [`FitError::OutOfRange`] for a derivative that is not
    /// finite.
    pub fn transformed(&self, derivatives: &[f64]) -> Result<Self, FitError> {
        if derivatives.is_empty() || !derivatives.len().is_multiple_of(self.order.max(1)) {
            return Err(mismatch("derivatives in whole rows", derivatives.len(), self.order));
        }
        require_finite("derivatives", derivatives)?;
        let order = derivatives.len() / self.order;
        let mut transformed = Self::none(order);
        for i in 0..self.order {
            for j in 0..self.order {
                let weight = self.element(i, j);
                if weight == 0.0 {
                    continue;
                }
                let (left, right) = (&derivatives[i * order..][..order], &derivatives[j * order..][..order]);
                for (line, a) in transformed.elements.chunks_exact_mut(order).zip(left) {
                    line.iter_mut().zip(right).for_each(|(element, b)| *element += weight * a * b);
                }
            }
        }
        Ok(transformed)
    }

    /// Number of directions about which something is known.
    pub fn rank(&self) -> usize {
        Eigen::of(self).rank()
    }

    /// u²(gᵀθ) for a combination of the parameters; `None` if it is not determined.
    ///
    /// # Errors
    /// [`FitError::Count`] for another number of factors than parameters.
    pub fn variance(&self, combination: &[f64]) -> Result<Option<f64>, FitError> {
        self.covariance(combination, combination)
    }

    /// u(gᵀθ, hᵀθ), the covariance of two combinations; `None` if one of them is not determined.
    ///
    /// # Errors
    /// [`FitError::Count`] for another number of factors than parameters.
    pub fn covariance(&self, first: &[f64], second: &[f64]) -> Result<Option<f64>, FitError> {
        for combination in [first, second] {
            self.require(combination)?;
        }
        let spectrum = Eigen::of(self);
        let along = |combination: &[f64]| spectrum.along(combination);
        let Some((a, b)) = along(first).zip(along(second)) else { return Ok(None) };
        Ok(Some(spectrum.values.iter().zip(a.iter().zip(&b)).map(|(value, (a, b))| a * b / value).sum()))
    }

    /// Directions of the `parameters` about which nothing is known, near these `values`.
    ///
    /// # Errors
    /// [`FitError::Count`] for another number of parameters or values.
    pub fn null_directions(&self, parameters: &[Parameter], values: &[f64]) -> Result<Vec<NullDirection>, FitError> {
        for count in [parameters.len(), values.len()] {
            if count != self.order {
                return Err(mismatch("parameters of an information", count, self.order));
            }
        }
        let spectrum = Eigen::of(self);
        let columns: Vec<usize> = (0..self.order).collect();
        let names: Vec<&str> = parameters.iter().map(Parameter::name).collect();
        let null = &spectrum.vectors[spectrum.rank()..];
        Ok(null_directions(null, &columns, &spectrum.scales, values, &names, ROUNDING.sqrt()))
    }

    /// `count` draws of the parameters about these `values`, normal with the covariance that the information leaves;
    /// along directions about which nothing is known they do not move. The same `seed` gives the same draws.
    ///
    /// # Errors
    /// [`FitError::Count`] for another number of values than parameters.
    pub fn draws(&self, values: &[f64], count: usize, seed: u64) -> Result<Vec<Vec<f64>>, FitError> {
        self.require(values)?;
        let spectrum = Eigen::of(self);
        let known = &spectrum.values[..spectrum.rank()];
        let draw = |number: usize| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream(number as u64);
            let mut drawn = values.to_vec();
            for (eigenvalue, vector) in known.iter().zip(&spectrum.vectors) {
                let step = normal(&mut random) / eigenvalue.sqrt();
                for ((value, component), scale) in drawn.iter_mut().zip(vector).zip(&spectrum.scales) {
                    *value += step * component / scale;
                }
            }
            drawn
        };
        Ok((0..count).map(draw).collect())
    }

    pub(crate) fn elements(&self) -> &[f64] {
        &self.elements
    }

    pub(crate) fn require(&self, combination: &[f64]) -> Result<(), FitError> {
        if combination.len() != self.order {
            return Err(mismatch("factors of a combination", combination.len(), self.order));
        }
        require_finite("factors of a combination", combination)
    }
}

/// A standard normal number (Box and Muller, <https://doi.org/10.1214/aoms/1177706645>).
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (first, second): (f64, f64) = (random.random(), random.random());
    // 1 − u lies in (0, 1].
    (-2.0 * (1.0 - first).ln()).sqrt() * (TAU * second).cos()
}

/// Lists that do not belong together.
pub(crate) fn mismatch(subject: &str, found: usize, expected: usize) -> FitError {
    FitError::count(format!("{subject}: {found} given, {expected} needed"))
}

fn no_derivatives() -> FitError {
    FitError::no_model("the problem has no derivatives at the values given")
}

fn require_finite(subject: &str, numbers: &[f64]) -> Result<(), FitError> {
    match numbers.iter().find(|number| !number.is_finite()) {
        Some(number) => Err(FitError::out_of_range(format!("{subject} must be finite, but one is {number}"), *number)),
        None => Ok(()),
    }
}

/// Eigenvalues and eigenvectors of an information whose diagonal is scaled to one.
struct Eigen {
    /// √Mⱼⱼ; 1 for a parameter about which nothing is known.
    scales: Vec<f64>,
    /// Eigenvalues in descending order, those of rounding included.
    values: Vec<f64>,
    vectors: Vec<Vec<f64>>,
}

impl Eigen {
    fn of(information: &Information) -> Self {
        let order = information.order;
        let scale = |j: usize| Some(information.element(j, j).sqrt()).filter(|norm| *norm > 0.0).unwrap_or(1.0);
        let scales: Vec<f64> = (0..order).map(scale).collect();
        // The singular values of a positive semidefinite matrix are its eigenvalues.
        let triples = singular_triples(order, |i, j| information.element(i, j) / (scales[i] * scales[j]));
        let (values, vectors) = triples.into_iter().map(|(value, _, vector)| (value, vector)).unzip();
        Self { scales, values, vectors }
    }

    fn rank(&self) -> usize {
        let largest = self.values.first().copied().unwrap_or(0.0);
        self.values.iter().filter(|value| **value > ROUNDING * largest && **value > 0.0).count()
    }

    /// Components of a combination along the directions that are determined; `None` if it has others.
    fn along(&self, combination: &[f64]) -> Option<Vec<f64>> {
        let scaled: Vec<f64> = combination.iter().zip(&self.scales).map(|(g, scale)| g / scale).collect();
        let along = |vector: &Vec<f64>| -> f64 { vector.iter().zip(&scaled).map(|(v, g)| v * g).sum() };
        let (known, unknown) = self.vectors.split_at(self.rank());
        let length = scaled.iter().map(|g| g * g).sum::<f64>().sqrt();
        let is_known = unknown.iter().all(|vector| along(vector).abs() <= ALONG * length);
        is_known.then(|| known.iter().map(along).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::solve::solve;
    use crate::solver::options::Options;
    use fmm_model::{Dual, Scalar};

    /// The information that a joint problem keeps when its own parameters are eliminated is the inverse of the
    /// covariance of the others.
    #[test]
    fn eliminated_parameters_cost_what_the_covariance_says() {
        let (t, y) = ([0.0, 1.0, 2.0, 3.0, 4.0, 5.0], [2.01, 1.2, 0.75, 0.44, 0.28, 0.15]);
        let model = |t: f64, [a, b, c]: [Dual<3>; 3]| a * (-b * t).exp() + c;
        let problem = crate::curve(&t, &y, ["amplitude", "rate", "offset"], model).unwrap();
        let fit = solve(&problem, &[2.0, 0.5, 0.0], &Options::default()).unwrap();
        let information = Information::of_problem(&problem, fit.values(), 2).unwrap();
        let s2 = fit.sum_of_squares() / 3.0;
        for i in 0..2 {
            for j in 0..2 {
                let unit = |k: usize| [0, 1].map(|l| f64::from(l == k));
                let ours = s2 * information.covariance(&unit(i), &unit(j)).unwrap().unwrap();
                let theirs = fit.covariance(i, j).unwrap();
                assert!((ours / theirs - 1.0).abs() < 1e-10, "({i}, {j}): {ours} against {theirs}");
            }
        }
    }

    #[test]
    fn what_is_not_known_has_a_direction_in_words() {
        let sum = Information::of_rows(3, &[1.0, 1.0, 0.0]).unwrap();
        let parameters = ["a", "b", "c"].map(|name| Parameter::new(name, name, "m"));
        let directions = sum.null_directions(&parameters, &[2.0, 3.0, 1.0]).unwrap();
        let texts: Vec<String> = directions.iter().map(ToString::to_string).collect();
        assert!(texts.iter().any(|text| text.contains("c has no influence")), "{texts:?}");
        assert!(texts.iter().any(|text| text.contains("only their sum is determined")), "{texts:?}");
        let known = sum.with_known(0, 0.1).unwrap();
        assert_eq!(known.rank(), 2);
        // b = sum − a: variances add up.
        assert!((known.variance(&[0.0, 1.0, 0.0]).unwrap().unwrap() - 1.01).abs() < 1e-12);
    }

    #[test]
    fn a_change_of_parameters_changes_nothing_that_is_measured() {
        let rows = [1.0, 0.5, 0.3, 2.0, -1.0, 0.7];
        let (derivatives, combination) = ([2.0, 1.0, -0.5, 3.0], [0.4, 1.3]);
        let information = Information::of_rows(2, &rows).unwrap();
        let other = information.transformed(&derivatives).unwrap();
        // θ = T φ: gᵀθ = (Tᵀg)ᵀ φ.
        let turned = [0, 1].map(|k| (0..2).map(|i| derivatives[2 * i + k] * combination[i]).sum::<f64>());
        let (a, b) = (information.variance(&combination).unwrap(), other.variance(&turned).unwrap());
        assert!((a.unwrap() - b.unwrap()).abs() < 1e-14);
    }

    /// Means, variances and correlation of draws; a direction that nothing tells stays.
    #[test]
    fn draws_have_the_covariance() {
        let information = Information::of_rows(3, &[1.0, 0.5, 0.0, 0.0, 2.0, 0.0]).unwrap();
        let count = 20_000;
        let draws = information.draws(&[1.0, -2.0, 7.0], count, 3).unwrap();
        let mean = |of: &dyn Fn(&Vec<f64>) -> f64| draws.iter().map(of).sum::<f64>() / count as f64;
        for (i, j) in [(0, 0), (0, 1), (1, 1)] {
            let unit = |k: usize| [0, 1, 2].map(|l| f64::from(l == k));
            let expected = information.covariance(&unit(i), &unit(j)).unwrap().unwrap();
            let found = mean(&|draw| (draw[i] - [1.0, -2.0][i]) * (draw[j] - [1.0, -2.0][j]));
            let size = |k: usize| information.variance(&unit(k)).unwrap().unwrap();
            // Five standard deviations of the mean of a product of two normal numbers.
            let tolerance = 5.0 * ((size(i) * size(j) + expected * expected) / count as f64).sqrt();
            assert!((found - expected).abs() < tolerance, "({i}, {j}): {found} for {expected}");
        }
        assert!(draws.iter().all(|draw| draw[2] == 7.0));
        assert_eq!(draws[5], information.draws(&[1.0, -2.0, 7.0], 6, 3).unwrap()[5]);
    }

    #[test]
    fn impossible_input_is_refused() {
        let information = Information::of_rows(2, &[1.0, 2.0]).unwrap();
        assert!(Information::of_rows(2, &[1.0]).is_err() && Information::of_rows(0, &[]).is_err());
        assert!(Information::of_rows(1, &[f64::NAN]).is_err());
        assert!(information.variance(&[1.0]).is_err() && information.variance(&[1.0, f64::INFINITY]).is_err());
        assert!(information.clone().scaled(-1.0).is_err() && information.clone().with_known(2, 1.0).is_err());
        assert!(information.clone().with_known(0, 0.0).is_err() && information.transformed(&[1.0]).is_err());
        assert!(information.clone().add(&Information::none(3)).is_err());
    }
}
