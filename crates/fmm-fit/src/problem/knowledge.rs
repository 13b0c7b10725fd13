//! A problem with some of its parameters held.

use fmm_model::{Bounds, ModelError, Parameter};

use crate::problem::residuals::{Residuals, forward_shape, forward_values};

/// A problem with some parameters held at values, whatever their bounds.
///
/// ```
/// # use fmm_fit::EvaluationError;
/// use fmm_fit::{Held, Options, Residuals, solve};
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
/// let through_origin = Held::new(&line, [(0, 0.0)])?;
/// let fit = solve(&through_origin, &[0.0, 1.0], &Options::default())?;
/// assert_eq!(fit.values()[0], 0.0);
/// assert!((fit.values()[1] - 13.0 / 5.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Held<'a, P: ?Sized> {
    problem: &'a P,
    parameters: Vec<Parameter>,
}

impl<'a, P: Residuals + ?Sized> Held<'a, P> {
    /// `problem` with the parameter at each index held at the value beside it; an index that it does not have is
    /// ignored.
    ///
    /// # Errors
    /// [`ModelError`] for a value that is not finite.
    pub fn new(problem: &'a P, values: impl IntoIterator<Item = (usize, f64)>) -> Result<Self, ModelError> {
        let mut parameters = problem.parameters().to_vec();
        for (index, value) in values {
            let held = Bounds::new(value, value)?;
            if let Some(parameter) = parameters.get_mut(index) {
                *parameter = parameter.clone().bounded(held);
            }
        }
        Ok(Self { problem, parameters })
    }

    /// `problem` with other bounds.
    pub(crate) const fn within(problem: &'a P, parameters: Vec<Parameter>) -> Self {
        Self { problem, parameters }
    }
}

impl<P: Residuals + ?Sized> Residuals for Held<'_, P> {
    forward_shape!(self => self.problem);
    forward_values!(self => self.problem);
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }
}
