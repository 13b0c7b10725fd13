//! Exact derivatives of a model that is written once.

use fmm_model::{Dual, Parameter, Scalar};

use crate::problem::residuals::{Derivatives, EvaluationError, Residuals};

/// Residuals as a formula that is generic in its number type; [`Automatic`] makes a problem of it.
pub trait Model {
    /// The parameters: names, units and bounds.
    fn parameters(&self) -> &[Parameter];

    /// n, the number of residuals.
    fn len(&self) -> usize;

    /// True without residuals.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the `n` residuals at `p`, as [`Residuals::evaluate`] does.
    ///
    /// # Errors
    /// Whatever keeps the model from having a value at `p`.
    fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError>;
}

/// A [`Model`] with its exact derivatives, by numbers that carry `N` of them along.
///
/// With `N` at least the number of parameters one pass gives all derivatives; with fewer directions it takes several
/// passes, and less memory: a pass holds n (N + 1) numbers. The columns of fixed parameters are filled too.
///
/// ```
/// use fmm_fit::{Automatic, EvaluationError, Model, Options, solve};
/// use fmm_model::{Parameter, Scalar};
///
/// /// A cooling cup, T = a exp(−b t).
/// struct Cooling<'a> {
///     data: &'a [(f64, f64)],
///     parameters: [Parameter; 2],
/// }
///
/// impl Model for Cooling<'_> {
///     fn parameters(&self) -> &[Parameter] {
///         &self.parameters
///     }
///     fn len(&self) -> usize {
///         self.data.len()
///     }
///     fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError> {
///         for (r, &(t, temperature)) in residuals.iter_mut().zip(self.data) {
///             *r = p[0] * (-p[1] * t).exp() - temperature;
///         }
///         Ok(())
///     }
/// }
///
/// let cooling = Cooling {
///     data: &[(0.0, 80.1), (10.0, 48.4), (20.0, 29.5), (30.0, 17.8)],
///     parameters: [Parameter::new("amplitude", "a", "K"), Parameter::new("rate", "b", "1/s")],
/// };
/// let fit = solve(&Automatic::<_, 2>::new(cooling), &[50.0, 0.01], &Options::default())?;
/// assert!(fit.has_exact_jacobian());
/// assert!((fit.values()[1] - 0.0501).abs() < 1e-4);
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Automatic<M, const N: usize> {
    model: M,
}

impl<M: Model, const N: usize> Automatic<M, N> {
    /// The problem of `model`.
    pub const fn new(model: M) -> Self {
        const { assert!(N > 0, "at least one direction of derivative is needed") };
        Self { model }
    }

    /// The model.
    pub const fn model(&self) -> &M {
        &self.model
    }
}

impl<M: Model, const N: usize> Residuals for Automatic<M, N> {
    fn parameters(&self) -> &[Parameter] {
        self.model.parameters()
    }

    fn len(&self) -> usize {
        self.model.len()
    }

    fn evaluate(&self, p: &[f64], residuals: &mut [f64], jacobian: Option<&mut [f64]>) -> Result<(), EvaluationError> {
        let Some(jacobian) = jacobian else { return self.model.residuals(p, residuals) };
        let rows = self.model.len();
        let mut carried = vec![Dual::<N>::from(0.0); rows];
        for first in (0..p.len()).step_by(N) {
            // A direction below `first` wraps to one that no number carries, which makes it a constant.
            let variable = |(j, value): (usize, &f64)| Dual::variable(*value, j.wrapping_sub(first));
            let variables: Vec<Dual<N>> = p.iter().enumerate().map(variable).collect();
            self.model.residuals(&variables, &mut carried)?;
            for (direction, j) in (first..p.len().min(first + N)).enumerate() {
                for (element, r) in jacobian[j * rows..(j + 1) * rows].iter_mut().zip(&carried) {
                    *element = r.partial(direction);
                }
            }
        }
        for (out, r) in residuals.iter_mut().zip(&carried) {
            *out = r.value();
        }
        Ok(())
    }

    fn derivatives(&self) -> Derivatives {
        Derivatives::All
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fitting::solve::solve;
    use crate::solver::options::Options;

    /// A decay over an offset, with an exponent: four parameters.
    struct Decay([Parameter; 4]);

    impl Model for Decay {
        fn parameters(&self) -> &[Parameter] {
            &self.0
        }
        fn len(&self) -> usize {
            40
        }
        fn residuals<S: Scalar>(&self, p: &[S], residuals: &mut [S]) -> Result<(), EvaluationError> {
            if p[1].value() < 0.0 {
                return Err(EvaluationError::message("the rate is negative"));
            }
            for (i, r) in residuals.iter_mut().enumerate() {
                let t = 0.1 * (i + 1) as f64;
                let data = 2.0 * (-0.7 * t).exp() + 0.3 + 0.01 * ((i * 37 % 11) as f64 - 5.0);
                *r = p[0] * (-(p[1] * t).powf(p[2])).exp() + p[3] - data;
            }
            Ok(())
        }
    }

    fn decay() -> Decay {
        Decay(["a", "b", "n", "c"].map(|name| Parameter::new(name, name, "1")))
    }

    #[test]
    fn any_number_of_directions_gives_the_same_fit() {
        let start = [1.0, 1.0, 1.0, 0.1];
        let fit = solve(&Automatic::<_, 4>::new(decay()), &start, &Options::default()).unwrap();
        assert!(fit.outcome().is_success() && fit.has_exact_jacobian());
        let others = [
            solve(&Automatic::<_, 1>::new(decay()), &start, &Options::default()).unwrap(),
            solve(&Automatic::<_, 3>::new(decay()), &start, &Options::default()).unwrap(),
            solve(&Automatic::<_, 6>::new(decay()), &start, &Options::default()).unwrap(),
        ];
        for other in others {
            // The derivatives are equal to the last bit.
            assert_eq!(other.values(), fit.values());
        }
    }

    #[test]
    fn derivatives_are_those_of_differences_and_one_pass_gives_all() {
        let problem = Automatic::<_, 3>::new(decay());
        let (p, h) = ([1.5, 0.8, 1.2, 0.2], 1e-6);
        let (mut residuals, mut jacobian) = (vec![0.0; 40], vec![0.0; 160]);
        problem.evaluate(&p, &mut residuals, Some(&mut jacobian)).unwrap();
        let at = |p: &[f64]| {
            let mut r = vec![0.0; 40];
            problem.evaluate(p, &mut r, None).unwrap();
            r
        };
        assert_eq!(residuals, at(&p));
        for j in 0..4 {
            let moved = |by: f64| {
                let mut q = p;
                q[j] += by;
                at(&q)
            };
            for (i, (above, below)) in moved(h).iter().zip(moved(-h)).enumerate() {
                let slope = (above - below) / (2.0 * h);
                // h² plus ε/h on numbers of order one.
                assert!((jacobian[j * 40 + i] - slope).abs() < 1e-8, "∂r{i}/∂p{j}: {}", jacobian[j * 40 + i]);
            }
        }
        let error = problem.evaluate(&[1.0, -1.0, 1.0, 0.0], &mut residuals, Some(&mut jacobian)).unwrap_err();
        assert_eq!(error.to_string(), "the rate is negative");
    }
}
