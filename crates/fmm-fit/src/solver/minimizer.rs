//! The solver and its state.

use std::time::Instant;

use fmm_model::{Parameter, Rounded};

use crate::algebra::triangle::Triangle;
use crate::error::FitError;
use crate::problem::residuals::{Derivatives, Residuals};
use crate::solver::evaluation::{Evaluator, Point, Scheme};
use crate::solver::jacobian_check::JacobianMismatch;
use crate::solver::options::Options;
use crate::solver::outcome::{NonFinite, Outcome, worst};
use crate::solver::trust_region::TrustRegion;

/// The square of the rounding of a smaller residual, √10⁻³⁰⁸/ε, is no normal number.
const SMALLEST_RESIDUAL: f64 = 1e-138;

/// The solver without its trimmings: what a Monte Carlo calculation with many small fits calls, as it keeps its
/// buffers from one fit to the next. [`solve`](crate::solve) is the short way to one fit.
///
/// A Levenberg–Marquardt method in a box. Each step minimises the linear model of the residuals within the trust
/// region *and* the bounds, so that active bounds are met exactly; a search that ends where the gradient does not
/// vanish begins again with another radius; a search that ends well is followed by Gauss–Newton steps that are
/// accepted for lowering the gradient, as the sum of squares can no longer tell them apart, and, if these do not end,
/// by Newton steps with differences of exact derivatives. Where the residuals do not determine all directions, the fit
/// looks once for one in which the sum of squares falls, as from a saddle, which symmetric starts lead to.
///
/// ```
/// use fmm_fit::{EvaluationError, Minimizer, Options, Residuals};
/// use fmm_model::Parameter;
///
/// struct Line<'a>(&'a [f64], [Parameter; 2]);
/// impl Residuals for Line<'_> {
///     fn parameters(&self) -> &[Parameter] {
///         &self.1
///     }
///     fn len(&self) -> usize {
///         self.0.len()
///     }
///     fn evaluate(&self, p: &[f64], residuals: &mut [f64], _: Option<&mut [f64]>) -> Result<(), EvaluationError> {
///         for (i, r) in residuals.iter_mut().enumerate() {
///             *r = p[0] + p[1] * i as f64 - self.0[i];
///         }
///         Ok(())
///     }
/// }
///
/// let mut minimizer = Minimizer::new(Options::default());
/// for shift in [0.0, 1.0, 2.0] {
///     let data = [1.0 + shift, 3.0 + shift, 5.0 + shift];
///     let line = Line(&data, [Parameter::new("offset", "a", "1"), Parameter::new("slope", "b", "1")]);
///     assert!(minimizer.minimize(&line, &[0.0, 0.0])?.is_success());
///     assert!((minimizer.values()[0] - 1.0 - shift).abs() < 1e-9);
/// }
/// # Ok::<(), fmm_fit::FitError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Minimizer {
    pub(crate) options: Options,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) start: Vec<f64>,
    pub(crate) current: Point,
    pub(crate) trial: Point,
    pub(crate) evaluator: Evaluator,
    pub(crate) region: TrustRegion,
    pub(crate) gaps: (Vec<f64>, Vec<f64>),
    pub(crate) phase: Phase,
    pub(crate) attempt: usize,
    pub(crate) best: Option<Attempt>,
    /// True if the fit has left a point where the gradient vanishes and the sum of squares falls all the same.
    pub(crate) is_saddle_left: bool,
    pub(crate) mismatches: Vec<JacobianMismatch>,
    pub(crate) iterations: usize,
    pub(crate) began: Option<Instant>,
}
#[derive(Debug, Clone, Copy, Default)]
pub(crate) enum Phase {
    #[default]
    Idle,
    Search,
    /// Sharpening after a search that ended with `reason`; `level` is the norm to lower.
    Polish {
        reason: Outcome,
        level: f64,
        left: usize,
    },
    Done(Outcome),
}

/// End of a search that is not to be trusted.
#[derive(Debug, Clone)]
pub(crate) struct Attempt {
    pub(crate) sum_of_squares: f64,
    pub(crate) values: Vec<f64>,
    pub(crate) reason: Outcome,
}

impl Minimizer {
    /// A solver with the given options.
    pub fn new(options: Options) -> Self {
        Self { options, ..Self::default() }
    }

    /// Fits `problem` from `start`, one value per parameter within its bounds.
    ///
    /// # Errors
    /// [`FitError`] if the start, the problem or the options do not allow a fit to begin.
    pub fn minimize<P: Residuals + ?Sized>(&mut self, problem: &P, start: &[f64]) -> Result<Outcome, FitError> {
        self.begin(problem, start)?;
        loop {
            if let Some(outcome) = self.iterate(problem) {
                return Ok(outcome);
            }
        }
    }

    /// The present values, one per parameter. A search that stalls begins again at the start; those at the end are the
    /// best.
    pub fn values(&self) -> &[f64] {
        &self.current.values
    }

    /// The residuals at [`values`](Self::values).
    pub fn residuals(&self) -> &[f64] {
        &self.current.residuals
    }

    /// Σᵢ rᵢ² at [`values`](Self::values).
    pub fn sum_of_squares(&self) -> f64 {
        self.current.sum_of_squares
    }

    /// Trial steps taken, accepted or not.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Evaluations of the residuals, those for differences included.
    pub fn residual_evaluations(&self) -> usize {
        self.evaluator.residual_evaluations
    }

    /// Evaluations of the Jacobian by the problem itself.
    pub fn jacobian_evaluations(&self) -> usize {
        self.evaluator.jacobian_evaluations
    }

    /// The trusted length of a step, in the unit of the residuals.
    pub fn radius(&self) -> f64 {
        self.region.radius
    }

    /// The end of the fit; `None` before.
    pub fn outcome(&self) -> Option<Outcome> {
        if let Phase::Done(outcome) = self.phase { Some(outcome) } else { None }
    }

    /// Σᵢ rᵢ² of the best values so far, those of earlier searches of this fit among them.
    pub(crate) fn lowest(&self) -> f64 {
        self.best.as_ref().map_or(f64::INFINITY, |best| best.sum_of_squares).min(self.current.sum_of_squares)
    }

    pub(crate) fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    pub(crate) fn start(&self) -> &[f64] {
        &self.start
    }

    pub(crate) fn scheme(&self) -> Scheme {
        self.evaluator.scheme
    }

    pub(crate) fn free(&self) -> &[usize] {
        &self.evaluator.free
    }

    pub(crate) fn factor_of_jacobian(&self) -> &Triangle {
        &self.current.triangle
    }

    pub(crate) fn non_finite(&self) -> Option<&NonFinite> {
        self.evaluator.non_finite.as_ref()
    }

    /// Checks the start and evaluates it.
    pub(crate) fn begin<P: Residuals + ?Sized>(&mut self, problem: &P, start: &[f64]) -> Result<(), FitError> {
        self.phase = Phase::Idle;
        self.options.validate()?;
        let parameters = problem.parameters();
        if self.parameters != parameters {
            check_parameters(parameters)?;
            self.parameters = parameters.to_vec();
        }
        check_start(parameters, start)?;
        self.began = self.options.time_limit.map(|_| Instant::now());
        (self.iterations, self.attempt, self.best, self.is_saddle_left) = (0, 0, None, false);
        self.mismatches.clear();
        self.start.clear();
        self.start.extend_from_slice(start);
        let bounds = parameters.iter().map(|parameter| (parameter.bounds().lower(), parameter.bounds().upper()));
        self.evaluator.begin(problem, bounds, start)?;
        let free = self.evaluator.free.len();
        if problem.len() < free {
            return Err(FitError::undetermined(format!(
                "{} residuals cannot determine {free} free parameters; give at least as many residuals",
                problem.len()
            )));
        }
        self.current.values.clone_from(&self.start);
        if !self.evaluator.residuals(problem, &mut self.current) {
            return Err(self.bad_start(problem));
        }
        let largest = worst(&self.current.residuals).1.abs();
        if largest > 0.0 && largest < SMALLEST_RESIDUAL {
            let what = format!(
                "the residuals at the start are at most {largest:e}, so that their squares underflow; give them in a \
                 smaller unit, or divide them by their uncertainties"
            );
            return Err(FitError::out_of_range(what, largest));
        }
        if free == 0 {
            self.current.triangle.reset(0);
            self.phase = Phase::Done(Outcome::NoFreeParameters);
            return Ok(());
        }
        if !self.evaluator.factor(problem, &mut self.current) {
            return Err(self.bad_start(problem));
        }
        self.begin_search(problem);
        Ok(())
    }

    fn bad_start<P: Residuals + ?Sized>(&self, problem: &P) -> FitError {
        if let Some(NonFinite::Model(_)) = self.evaluator.non_finite {
            // Ask again for the error itself: a pure function fails in the same way.
            let mut residuals = vec![0.0; problem.len()];
            let mut jacobian = vec![0.0; self.evaluator.structure.len()];
            let jacobian = (problem.derivatives() != Derivatives::None).then_some(jacobian.as_mut_slice());
            if let Err(error) = problem.evaluate(&self.start, &mut residuals, jacobian) {
                return FitError::model_failed(error.into_boxed());
            }
        }
        if let Some(NonFinite::Derivative { parameter }) = &self.evaluator.non_finite {
            return FitError::no_model(format!(
                "the derivative of the residuals by {parameter} is not finite at the start"
            ));
        }
        let (index, value) = worst(&self.current.residuals);
        let value = Rounded::every_digit(value);
        FitError::no_model(format!(
            "residual {index} is {value} at the start, so that the sum of squares is not finite"
        ))
    }
}

pub(crate) fn check_parameters(parameters: &[Parameter]) -> Result<(), FitError> {
    for (j, parameter) in parameters.iter().enumerate() {
        let (name, bounds) = (parameter.name(), parameter.bounds());
        if bounds.is_empty() {
            let [lower, upper] = [bounds.lower(), bounds.upper()].map(Rounded::every_digit);
            return Err(FitError::problem(format!(
                "the bounds of {name} exclude each other: at least {lower} and at most {upper}"
            )));
        }
        if parameters[..j].iter().any(|other| other.name() == name) {
            return Err(FitError::problem(format!("two parameters are called {name}; give each a name of its own")));
        }
    }
    Ok(())
}

pub(crate) fn check_start(parameters: &[Parameter], start: &[f64]) -> Result<(), FitError> {
    if start.len() != parameters.len() {
        let (values, count) = (start.len(), parameters.len());
        return Err(FitError::count(format!("the start has {values} values, but the problem has {count} parameters")));
    }
    for (parameter, &value) in parameters.iter().zip(start) {
        let bounds = parameter.bounds();
        if !value.is_finite() {
            return Err(FitError::option(&format!("the start value of {}", parameter.name()), "finite", value));
        }
        if !bounds.contains(value) {
            let [shown, lower, upper] = [value, bounds.lower(), bounds.upper()].map(Rounded::every_digit);
            let name = parameter.name();
            let what = format!("the start value of {name} is {shown}, outside its bounds [{lower}, {upper}]");
            return Err(FitError::out_of_range(what, value));
        }
    }
    Ok(())
}
