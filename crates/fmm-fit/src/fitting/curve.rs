//! Problems out of closures, with exact derivatives.

use fmm_model::{Dual, Parameter, Scalar};

use crate::error::FitError;
use crate::fitting::solve::solve;
use crate::problem::residuals::{Derivatives, EvaluationError, Residuals};
use crate::result::fit::Fit;
use crate::solver::options::Options;

/// Residuals that a closure gives in numbers that carry the derivatives by all `N` parameters along.
///
/// [`curve`] makes one of a curve and its data. It takes options, weights, losses and a place in a joint problem. A
/// closure that fails says so by a residual that is not finite; a type that implements [`Model`](crate::Model) can say
/// why.
///
/// ```
/// use fmm_fit::{ClosureProblem, Dual, Loss, Options, Robust, solve};
///
/// // The mean of five readings, one of them wrong.
/// let readings = [1.0, 1.1, 0.9, 1.05, 8.0];
/// let mean = ClosureProblem::new(["mean"], 5, |[mean], residuals: &mut [Dual<1>]| {
///     residuals.iter_mut().zip(readings).for_each(|(r, y)| *r = mean - y);
/// });
/// let fit = solve(&Robust::new(mean, Loss::Tukey, 1.0)?, &[1.5], &Options::default())?;
/// assert!((fit.values()[0] - 1.0125).abs() < 1e-3);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ClosureProblem<F, const N: usize> {
    parameters: [Parameter; N],
    count: usize,
    residuals: F,
}

impl<F: Fn([Dual<N>; N], &mut [Dual<N>]), const N: usize> ClosureProblem<F, N> {
    /// The problem of these parameters (a name alone makes an unbounded pure number) and `count` residuals, all of
    /// which the closure fills, model minus data.
    pub fn new(parameters: [impl Into<Parameter>; N], count: usize, residuals: F) -> Self {
        Self { parameters: parameters.map(Into::into), count, residuals }
    }
}

impl<F: Fn([Dual<N>; N], &mut [Dual<N>]), const N: usize> Residuals for ClosureProblem<F, N> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
    fn len(&self) -> usize {
        self.count
    }
    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let mut carried = vec![Dual::from(0.0); self.count];
        (self.residuals)(std::array::from_fn(|j| Dual::variable(p[j], j)), &mut carried);
        residuals.iter_mut().zip(&carried).for_each(|(out, r)| *out = r.value());
        if let Some(jacobian) = jacobian.filter(|_| self.count > 0) {
            for (j, column) in jacobian.chunks_exact_mut(self.count).enumerate() {
                column.iter_mut().zip(&carried).for_each(|(element, r)| *element = r.partial(j));
            }
        }
        Ok(())
    }
    /// A closure over one number type costs the same with and without derivatives.
    fn is_cheaper_combined(&self) -> bool {
        true
    }
    fn derivatives(&self) -> Derivatives {
        Derivatives::All
    }
}

/// The problem of a curve through data, rᵢ = f(xᵢ, θ) − yᵢ, for [`Weighted`](crate::Weighted), options or a loss.
///
/// ```
/// use fmm_fit::{Options, Weighted, curve, solve};
///
/// // A line through two readings of different uncertainty and one of none too many.
/// let line = curve(&[0.0, 1.0, 2.0], &[1.0, 3.1, 5.0], ["offset", "slope"], |x, [a, b]| a + b * x)?;
/// let fit = solve(&Weighted::new(line, vec![0.1, 0.5, 0.1])?, &[0.0, 1.0], &Options::default())?;
/// assert!((fit.values()[1] - 2.0).abs() < 1e-9);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
///
/// # Errors
/// [`FitError::Count`] unless there is one abscissa per ordinate.
#[expect(clippy::type_complexity, reason = "the type of a closure has no name")]
pub fn curve<'a, X: Copy, const N: usize>(
    x: &'a [X],
    y: &'a [f64],
    parameters: [impl Into<Parameter>; N],
    model: impl Fn(X, [Dual<N>; N]) -> Dual<N> + 'a,
) -> Result<ClosureProblem<impl Fn([Dual<N>; N], &mut [Dual<N>]) + 'a, N>, FitError> {
    if x.len() != y.len() {
        let (abscissae, ordinates) = (x.len(), y.len());
        return Err(FitError::count(format!(
            "there are {abscissae} abscissae for {ordinates} ordinates; give one for each"
        )));
    }
    Ok(ClosureProblem::new(parameters, y.len(), move |p: [Dual<N>; N], residuals: &mut [Dual<N>]| {
        for ((r, x), y) in residuals.iter_mut().zip(x).zip(y) {
            *r = model(*x, p) - *y;
        }
    }))
}

/// Fits a curve y = f(x, θ) to data, with exact derivatives, from a start value for each parameter.
///
/// The abscissa may be of any type that can be copied, such as `[f64; 2]` for two predictors. A parameter is a name, or
/// a [`Parameter`] with symbol, unit and bounds.
///
/// ```
/// use fmm_fit::{Scalar, curve_fit};
///
/// let (t, x) = ([0.0, 10.0, 20.0, 30.0], [80.1, 48.4, 29.5, 17.8]);
/// let fit = curve_fit(&t, &x, [("amplitude", 50.0), ("rate", 0.01)], |t, [a, b]| a * (-b * t).exp())?;
/// assert!(fit.outcome().is_success() && fit.has_exact_jacobian());
/// assert!((fit.values()[1] - 0.0501).abs() < 1e-4);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
///
/// [`Scalar`] brings the functions, such as `exp`, into scope.
///
/// # Errors
/// [`FitError::Count`], and as for [`solve`].
pub fn curve_fit<X: Copy, const N: usize>(
    x: &[X],
    y: &[f64],
    start: [(impl Into<Parameter>, f64); N],
    model: impl Fn(X, [Dual<N>; N]) -> Dual<N>,
) -> Result<Fit, FitError> {
    let values = start.each_ref().map(|(_, value)| *value);
    solve(&curve(x, y, start.map(|(parameter, _)| parameter), model)?, &values, &Options::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::automatic::{Automatic, Model};

    struct Decay([Parameter; 3]);

    fn decay<S: Scalar>(t: f64, p: [S; 3]) -> S {
        p[0] * (-(p[1] * t)).exp() + p[2]
    }

    fn data() -> (Vec<f64>, Vec<f64>) {
        let t = |i: u32| 0.1 * f64::from(i);
        let y = |i: u32| decay(t(i), [2.0, 0.7, 0.3]) + 0.01 * (f64::from(i * 37 % 11) - 5.0);
        ((0..40).map(t).collect(), (0..40).map(y).collect())
    }

    impl Model for Decay {
        fn parameters(&self) -> &[Parameter] {
            &self.0
        }
        fn len(&self) -> usize {
            40
        }
        fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError> {
            let (t, y) = data();
            for ((r, t), y) in residuals.iter_mut().zip(t).zip(y) {
                *r = decay(t, [p[0], p[1], p[2]]) - y;
            }
            Ok(())
        }
    }

    #[test]
    fn a_closure_gives_the_fit_of_a_model() {
        let (t, y) = data();
        let start = [("a", 1.0), ("b", 1.0), ("c", 0.1)];
        let model = Decay(start.map(|(name, _)| Parameter::from(name)));
        let expected = solve(&Automatic::<_, 3>::new(model), &[1.0, 1.0, 0.1], &Options::default()).unwrap();
        let by_curve = curve_fit(&t, &y, start, decay::<Dual<3>>).unwrap();
        let problem = ClosureProblem::new(["a", "b", "c"], 40, |p, residuals: &mut [Dual<3>]| {
            for ((r, t), y) in residuals.iter_mut().zip(&t).zip(&y) {
                *r = decay(*t, p) - *y;
            }
        });
        let by_residuals = solve(&problem, &[1.0, 1.0, 0.1], &Options::default()).unwrap();
        for found in [by_curve, by_residuals] {
            assert!(found.outcome().is_success() && found.has_exact_jacobian());
            assert_eq!(found.values(), expected.values());
            assert_eq!(found.residuals(), expected.residuals());
        }
        let refused = curve_fit(&t[1..], &y, start, decay::<Dual<3>>).unwrap_err();
        assert_eq!(refused.to_string(), "there are 39 abscissae for 40 ordinates; give one for each");
        let missing = curve_fit(&t, &y, [("a", 1.0), ("b", 1.0), ("c", f64::NAN)], decay::<Dual<3>>).unwrap_err();
        assert!(missing.to_string().contains("start value of c"), "{missing}");
    }

    #[test]
    fn an_abscissa_may_have_several_numbers_and_a_closure_no_residual() {
        let x = [[0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0]];
        let plane = curve_fit(&x, &[3.0, 2.0, 5.0, 7.0], [("a", 0.0), ("b", 0.0)], |x, [a, b]| a * x[0] + b * x[1]);
        let plane = plane.unwrap();
        assert!((plane.values()[0] - 2.0).abs() < 1e-12 && (plane.values()[1] - 3.0).abs() < 1e-12);
        let fit = |parameter: Parameter| {
            let empty = ClosureProblem::new([parameter], 0, |_: [Dual<1>; 1], _: &mut [Dual<1>]| {});
            solve(&empty, &[1.0], &Options::default())
        };
        assert!(matches!(fit(Parameter::from("a")), Err(FitError::Undetermined { .. })));
        assert!(fit(Parameter::from("a").bounded(fmm_model::Bounds::new(1.0, 1.0).unwrap())).is_ok());
    }
}
